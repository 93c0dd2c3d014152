//! Pieces of an aggregated set, and integrals over them.

use crate::table::{
    centroid,
    numeric::{gauss, root},
    operators::{larger, smaller},
};

/// An interval on which the aggregated set is a straight line or a smooth curve.
pub(crate) struct Piece<'a> {
    /// The lower end.
    pub(crate) from: f64,
    /// The upper end.
    pub(crate) to: f64,
    /// The degree just inside `from`.
    pub(crate) left: f64,
    /// The degree just inside `to`.
    pub(crate) right: f64,
    /// The curve; `None` if the piece is straight.
    pub(crate) curve: Option<Curve<'a>>,
}

/// A smooth curve over a piece. Its argument is the fraction in [0, 1] of the distance from `from` to `to`, which has a
/// finer resolution than `x` in a narrow piece.
#[derive(Clone, Copy)]
pub(crate) struct Curve<'a> {
    /// The degree.
    pub(crate) degree: &'a dyn Fn(f64) -> f64,
    /// A number that is proportional to the slope and has the same sign.
    pub(crate) slope: &'a dyn Fn(f64) -> f64,
}

/// The area of a set, and its first moment about `origin`.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Integrals {
    pub(crate) area: f64,
    pub(crate) moment: f64,
    /// The origin of the moment: the middle of the range, to avoid cancellation.
    pub(crate) origin: f64,
    /// The unit of length of the area and the moment, see [`unit`].
    unit: f64,
}

/// Returns the unit of length for areas over a range with the given width. A moment, which is an area times a
/// distance, is proportional to the square of the width. For extreme ranges this square overflows or underflows. For
/// these, the unit is a power of two, so that it does not change digits; for all other ranges it is 1.
pub(crate) fn unit(width: f64) -> f64 {
    if (1e-100..1e100).contains(&width) {
        return 1.0;
    }
    power_of_two(width)
}

/// Returns the largest power of two up to a width.
pub(super) fn power_of_two(width: f64) -> f64 {
    f64::from_bits(width.to_bits() & f64::INFINITY.to_bits())
}

impl Integrals {
    pub(crate) fn about(origin: f64, unit: f64) -> Self {
        Integrals {
            area: 0.0,
            moment: 0.0,
            origin,
            unit,
        }
    }

    /// Adds a piece. A straight one has `area = d (ya + yb) / 2` and
    /// `moment = d (x0 (ya + yb) / 2 + d (ya + 2 yb) / 6)`; a curve is integrated numerically, accurate to the last
    /// digits.
    pub(crate) fn add(&mut self, piece: &Piece<'_>) {
        let width = piece.to - piece.from;
        let units = width / self.unit;
        if let Some(curve) = piece.curve {
            let known = if units > 0.0 { self.area / units } else { 0.0 };
            let (mean, moment) = integrate(curve.degree, 1.0, known);
            self.area += units * mean;
            self.moment += units * ((piece.from - self.origin) * mean + width * moment);
            return;
        }
        let (left, right) = (piece.left, piece.right);
        let mean = 0.5 * (left + right);
        self.area += units * mean;
        self.moment +=
            units * ((piece.from - self.origin) * mean + width * (left + 2.0 * right) / 6.0);
    }

    /// Adds the part of a piece between two values.
    pub(crate) fn add_between(&mut self, piece: &Piece<'_>, (from, to): (f64, f64)) {
        let (from, to) = (larger(from, piece.from), smaller(to, piece.to));
        if from >= to {
            return;
        }
        let width = piece.to - piece.from;
        let (start, length) = ((from - piece.from) / width, (to - from) / width);
        // The degree is computed from the nearer end, so that it is exact at both ends.
        let line = |x: f64| {
            let slope = (piece.right - piece.left) / width;
            if x - piece.from <= piece.to - x {
                piece.left + slope * (x - piece.from)
            } else {
                piece.right - slope * (piece.to - x)
            }
        };
        let degree = |part: f64| {
            piece
                .curve
                .map_or(0.0, |curve| (curve.degree)(start + length * part))
        };
        self.add(&Piece {
            from,
            to,
            left: line(from),
            right: line(to),
            curve: piece.curve.map(|curve| Curve {
                degree: &degree,
                slope: curve.slope,
            }),
        });
    }

    /// Returns the centroid; `None` if the area is 0.
    pub(crate) fn centroid(&self) -> Option<f64> {
        centroid(self.area, self.moment, self.origin)
    }
}

impl Piece<'_> {
    /// Returns the area of the piece.
    pub(crate) fn area(&self) -> f64 {
        let mean = match self.curve {
            Some(curve) => integrate(curve.degree, 1.0, 0.0).0,
            None => 0.5 * (self.left + self.right),
        };
        (self.to - self.from) * mean
    }

    /// Returns the position up to which the area of the piece is `area`. This must not exceed the area of the whole
    /// piece.
    pub(crate) fn position_of_area(&self, area: f64) -> f64 {
        let width = self.to - self.from;
        if let Some(curve) = self.curve {
            let mean = area / width;
            let area = |part: f64| integrate(curve.degree, part, 0.0).0;
            let part = root(0.0, 1.0, |part| area(part) - mean);
            return self.from + width * part;
        }
        // Solve area = left d + slope d^2 / 2 for d without cancellation.
        let slope = (self.right - self.left) / width;
        let root = libm::sqrt(libm::fmax(0.0, self.left * self.left + 2.0 * slope * area));
        let length = if area > 0.0 {
            2.0 * area / (self.left + root)
        } else {
            0.0
        };
        libm::fmin(self.from + length, self.to)
    }
}

/// The maximum number of successive halvings of an interval.
const DEEPEST: usize = 48;
/// The maximum total number of splits of a piece. This suffices to locate several missed kinks. The limit ends the
/// search if the parts never agree with the whole because of rounding.
const MAX_HALVINGS: usize = 400;

/// The relative difference up to which the integral over an interval agrees with the sum of the integrals over its two
/// parts. The result is then accurate to rounding where the curve is smooth, and to this difference at a missed kink.
const AGREEMENT: f64 = 1e-13;

/// Returns `(integral of f(t) dt, integral of t f(t) dt)` from 0 to `end`, by Gauss-Legendre quadrature. An interval
/// is split in two until its integral agrees with the sum over its parts. The error is measured relative to the
/// integral plus `known`, the area of the preceding pieces.
fn integrate(curve: &dyn Fn(f64) -> f64, end: f64, known: f64) -> (f64, f64) {
    let mut stack = [(0.0, 0.0, 0.0, 0.0); DEEPEST + 1];
    let (whole, moment) = gauss(curve, 0.0, end, 0.0);
    stack[0] = (0.0, end, whole, moment);
    let (mut open, mut halvings) = (1, 0);
    let (mut sum, mut sum_of_moments) = (0.0, 0.0);
    while open > 0 {
        open -= 1;
        let (a, b, area, moment) = stack[open];
        // Splitting at the middle is avoided, because the error of a symmetric kink would cancel
        // there.
        let middle = a + 0.43 * (b - a);
        let left = gauss(curve, a, middle, 0.0);
        let right = gauss(curve, middle, b, 0.0);
        let (halves, moments) = (left.0 + right.0, left.1 + right.1);
        let allowed = AGREEMENT * (known + larger(whole, sum + halves));
        let agree = libm::fabs(halves - area) <= allowed && libm::fabs(moments - moment) <= allowed;
        if agree || open + 2 > DEEPEST || halvings >= MAX_HALVINGS {
            sum += halves;
            sum_of_moments += moments;
        } else {
            stack[open] = (middle, b, right.0, right.1);
            stack[open + 1] = (a, middle, left.0, left.1);
            open += 2;
            halvings += 1;
        }
    }
    (sum, sum_of_moments)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn curve<'a>(from: f64, to: f64, f: &'a dyn Fn(f64) -> f64) -> Piece<'a> {
        Piece {
            from,
            to,
            left: f(0.0),
            right: f(1.0),
            curve: Some(Curve {
                degree: f,
                slope: &|_| f64::NAN,
            }),
        }
    }

    #[test]
    fn a_line_has_the_integral_of_its_curve() {
        let f = |t: f64| 0.3 + 0.3 * t;
        let line = Piece {
            curve: None,
            ..curve(1.0, 4.0, &f)
        };
        let (mut straight, mut curved) = (Integrals::about(2.0, 1.0), Integrals::about(2.0, 1.0));
        straight.add(&line);
        curved.add(&curve(1.0, 4.0, &f));
        assert!((straight.area - curved.area).abs() < 1e-15);
        assert!((straight.moment - curved.moment).abs() < 1e-15);
        assert!((straight.area - 1.35).abs() < 1e-15);
        assert!((line.area() - curve(1.0, 4.0, &f).area()).abs() < 1e-15);
        // 0.3 d + 0.05 d^2 = area.
        for (area, x) in [(0.0, 1.0), (0.35, 2.0), (1.35, 4.0)] {
            assert!((line.position_of_area(area) - x).abs() < 1e-15);
            let other = curve(1.0, 4.0, &f).position_of_area(area);
            assert!((line.position_of_area(area) - other).abs() < 1e-14);
        }
    }

    #[test]
    fn smooth_curves_kinks_and_steps_are_integrated() {
        let area = |f: &dyn Fn(f64) -> f64| {
            let mut integrals = Integrals::about(0.5, 1.0);
            integrals.add(&curve(0.0, 1.0, f));
            (integrals.area, integrals.centroid().unwrap())
        };
        let (exponential, centroid) = area(&|x| x.exp());
        assert!((exponential - (1f64.exp() - 1.0)).abs() < 1e-14);
        assert!((centroid - 1.0 / (1f64.exp() - 1.0)).abs() < 1e-14);
        let (kink, _) = area(&|x| (x - 0.3).abs());
        assert!((kink - 0.29).abs() < 1e-12, "{kink}");
        let (step, _) = area(&|x| if x < 0.3 { 1.0 } else { 0.5 });
        assert!((step - 0.65).abs() < 1e-12, "{step}");
    }

    #[test]
    fn integration_of_noise_terminates() {
        // A function for which the parts of an interval never agree with the whole, however often the interval is
        // split.
        let noise = |t: f64| ((t * 1e15) as u64 % 1000) as f64 / 1000.0;
        let counter = core::cell::Cell::new(0usize);
        let counted = |t: f64| {
            counter.set(counter.get() + 1);
            noise(t)
        };
        let area = curve(0.0, 1.0, &counted).area();
        assert!((0.3..0.7).contains(&area), "{area}");
        assert!(counter.get() < 50 * MAX_HALVINGS, "{}", counter.get());
    }
}
