//! A range of values along an axis.

/// A range of values along an axis; `low` is below `high`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Scale {
    /// The lower end.
    pub low: f64,
    /// The upper end.
    pub high: f64,
}

impl Scale {
    /// Creates a scale from one value to another.
    pub const fn new(low: f64, high: f64) -> Scale {
        Scale { low, high }
    }

    /// Returns the position of a value: 0 at the lower end, 1 at the upper end.
    pub fn share(self, value: f64) -> f64 {
        (value - self.low) / (self.high - self.low)
    }

    /// Returns the value at a position: the inverse of [`Scale::share`].
    pub fn value(self, share: f64) -> f64 {
        self.low + share * (self.high - self.low)
    }

    /// Returns the multiples of a round step within the range. The step divides the range into about `pieces` parts. An
    /// end of the range is included if it is such a multiple.
    pub fn ticks(self, pieces: f64) -> Vec<f64> {
        let rough = (self.high - self.low) / pieces;
        if rough <= 0.0 || !rough.is_finite() {
            return Vec::new();
        }
        let power = 10f64.powf(rough.log10().floor());
        let steps = [1.0, 2.0, 2.5, 5.0, 10.0].map(|step| step * power);
        let step = steps
            .into_iter()
            .find(|step| *step >= rough * 0.999)
            .unwrap_or(rough);
        let first = (self.low / step - 1e-9).ceil() as i64;
        let last = (self.high / step + 1e-9).floor() as i64;
        (first..=last).map(|i| i as f64 * step).collect()
    }
}

/// Returns the indices of at most `most` of `points` points, including the first and the last one.
pub(super) fn thinned(points: usize, most: usize) -> Vec<usize> {
    let shown = points.min(most).max(2);
    (0..shown)
        .map(|i| (i * points.saturating_sub(1) + (shown - 1) / 2) / (shown - 1))
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ticks_are_round_and_within() {
        let ticks = |low, high, pieces| Scale::new(low, high).ticks(pieces);
        assert_eq!(ticks(0.0, 100.0, 5.0), [0.0, 20.0, 40.0, 60.0, 80.0, 100.0]);
        assert_eq!(ticks(0.0, 100.0, 4.0), [0.0, 25.0, 50.0, 75.0, 100.0]);
        let found = ticks(0.0, 0.5, 5.0);
        assert_eq!(found.len(), 6);
        approx::assert_abs_diff_eq!(found[5], 0.5, epsilon = 1e-12);
        assert_eq!(ticks(-3.0, 9.0, 5.0), [-2.5, 0.0, 2.5, 5.0, 7.5]);
        assert_eq!(ticks(14.0, 16.8, 4.0), [14.0, 15.0, 16.0]);
        assert!(ticks(1.0, 1.0, 5.0).is_empty());
    }

    #[test]
    fn thinning_keeps_both_ends() {
        assert_eq!(thinned(3, 61), [0, 1, 2]);
        let few = thinned(1001, 61);
        assert_eq!((few.len(), few[0], few[60]), (61, 0, 1000));
    }
}
