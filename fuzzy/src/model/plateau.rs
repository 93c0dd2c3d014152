//! The values at which a membership function is highest.

use super::{MembershipFunction, Variable};

impl Variable {
    /// Returns the first and the last value of the range at which a membership function is highest.
    pub(crate) fn plateau(&self, shape: &MembershipFunction) -> (f64, f64) {
        use MembershipFunction as Of;
        let (low, high) = (self.low, self.high);
        let (first, last) = match *shape {
            Of::Singleton { at: x } | Of::Triangle { peak: x, .. } => (x, x),
            Of::LeftShoulder { top, .. } => (low, top),
            Of::RightShoulder { top, .. } => (top, high),
            Of::Trapezoid {
                left_top: left,
                right_top: right,
                ..
            }
            | Of::Rectangle { left, right } => (left, right),
            _ => return self.sampled_plateau(shape),
        };
        let within = |x: f64| x.max(low).min(high);
        (within(first), within(last))
    }

    /// Returns the middle of the interval where a membership function is highest.
    pub(crate) fn peak(&self, shape: &MembershipFunction) -> f64 {
        let (first, last) = self.plateau(shape);
        (first + last) / 2.0
    }

    /// Finds the plateau by sampling, to within 1/2000 of the range.
    fn sampled_plateau(&self, shape: &MembershipFunction) -> (f64, f64) {
        const STEPS: u32 = 2000;
        let at = |i: u32| self.low + (self.high - self.low) * f64::from(i) / f64::from(STEPS);
        let mut highest = f64::NEG_INFINITY;
        let (mut first, mut last) = (self.low, self.low);
        for x in (0..=STEPS).map(at) {
            let membership = shape.membership(x);
            if membership > highest + 1e-12 {
                (highest, first, last) = (membership, x, x);
            } else if membership >= highest - 1e-12 {
                last = x;
            }
        }
        (first, last)
    }
}
