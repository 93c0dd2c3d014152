//! Flanks of output terms: their degree, its inverse, and the area below them.

use core::f64::consts::{PI, SQRT_2};

use libm::{atan2, erfc, log, pow, sqrt};

use super::ShapeKind;
use super::numeric::{gauss, root};
use super::operators::{larger, smaller};

/// A part of the output's range on which a term only rises, only falls or is level.
///
/// The foot of a flank is its lower end. The tail up to `x` is the area and first moment between the foot and `x`.
/// Because tails are measured from the foot, the area of a low tail is accurate to its last digits. The tail of a
/// Gaussian is `sd sqrt(pi/2) (erfc(z) - erfc(z_foot))` with `z = |x - mean| / (sd sqrt(2))`. The tail of a
/// straight flank is a trapezoid. The tail of any other flank is the tail up to a [`Knot`], plus a Gauss-Legendre
/// quadrature with 8 nodes between this knot and `x`.
#[doc(hidden)] // Exported data.
#[derive(Debug, Clone, Copy, PartialEq)]
#[repr(C)]
pub struct Flank {
    /// The parameters of the membership function.
    pub parameters: [f64; 4],
    /// The height of the term.
    pub height: f64,
    /// The lower end of the interval.
    pub from: f64,
    /// The upper end of the interval.
    pub to: f64,
    /// The degree just inside `from`.
    pub left: f64,
    /// The degree just inside `to`.
    pub right: f64,
    /// The area of the whole flank.
    pub area: f64,
    /// The first moment of the whole flank, relative to the middle of the range.
    pub moment: f64,
    /// The area beyond the foot; Gaussians only.
    pub beyond: f64,
    /// The kind of membership function; [`ShapeKind::PIECEWISE`] is a straight line from `left` to `right`.
    pub kind: ShapeKind,
    /// The index of the first knot.
    pub first_knot: u32,
    /// The index after the last knot.
    pub end_knot: u32,
}

/// A knot: a value at which the tail of a flank is tabulated. The first knot of a flank is at its foot.
#[doc(hidden)] // Exported data.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
#[repr(C)]
pub struct Knot {
    /// The value.
    pub x: f64,
    /// The area of the tail.
    pub area: f64,
    /// The first moment of the tail, relative to the middle of the range.
    pub moment: f64,
}

/// The origin of moments and the unit of length of areas, for the range of an output.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Measure {
    /// The middle of the range, to which moments are relative.
    pub(crate) origin: f64,
    /// The unit of length of areas.
    pub(crate) unit: f64,
}

impl Measure {
    /// Returns the area and moment of a rectangle.
    #[inline(always)]
    pub(crate) fn rectangle(self, from: f64, to: f64, degree: f64) -> (f64, f64) {
        let area = degree * ((to - from) / self.unit);
        (area, area * (from + 0.5 * (to - from) - self.origin))
    }

    /// Returns the area and moment below a straight line between two points, in any order.
    pub(crate) fn trapezoid(self, (from, left): (f64, f64), (to, right): (f64, f64)) -> (f64, f64) {
        let signed = to - from;
        let units = libm::fabs(signed) / self.unit;
        let area = units * 0.5 * (left + right);
        let moment = units * signed * (left + 2.0 * right) / 6.0;
        (area, (from - self.origin) * area + moment)
    }
}

impl Flank {
    #[inline(always)]
    pub(crate) fn rises(&self) -> bool {
        self.left < self.right
    }

    /// Returns whether the degree is exactly constant. A curve does not count as constant, even if the computed
    /// degrees at its ends are equal: the exact degrees may differ by less than the last digit.
    #[inline(always)]
    pub(crate) fn is_level(&self) -> bool {
        self.left == self.right && self.kind == ShapeKind::PIECEWISE
    }

    /// Returns the foot, and the degree there.
    #[inline(always)]
    pub(crate) fn foot(&self) -> (f64, f64) {
        if self.right < self.left {
            (self.to, self.right)
        } else {
            (self.from, self.left)
        }
    }

    /// Returns the summit, and the degree there.
    #[inline(always)]
    pub(crate) fn summit(&self) -> (f64, f64) {
        if self.right < self.left {
            (self.from, self.left)
        } else {
            (self.to, self.right)
        }
    }

    /// Returns the degree at `x`.
    pub(crate) fn degree(&self, x: f64) -> f64 {
        if self.kind == ShapeKind::PIECEWISE {
            let (left, right) = (x - self.from, self.to - x);
            // Measured from the nearer end, so that the degrees at the ends are exact.
            return if left < right {
                self.left + (self.right - self.left) * (left / (self.to - self.from))
            } else {
                self.right + (self.left - self.right) * (right / (self.to - self.from))
            };
        }
        self.height * self.kind.membership(&self.parameters, &[], x)
    }

    /// Returns the negated exponent of a Gaussian at `x`.
    pub(crate) fn exponent(&self, x: f64) -> f64 {
        let [mean, sd, ..] = self.parameters;
        let z = (x - mean) / sd;
        0.5 * z * z
    }

    /// Returns the value at which the flank has the given degree, which must be between the degrees of its ends.
    pub(crate) fn position_of_degree(&self, degree: f64) -> f64 {
        let [a, b, c, d] = self.parameters;
        let level = smaller(1.0, degree / self.height);
        // The side of the shape's middle on which the flank is: -1 for left, 1 for right.
        let side = if self.rises() { -1.0 } else { 1.0 };
        let x = match self.kind {
            ShapeKind::PIECEWISE => {
                let (low, high) = (degree - self.left, self.right - degree);
                if libm::fabs(low) < libm::fabs(high) {
                    self.from + (self.to - self.from) * (low / (low + high))
                } else {
                    self.to - (self.to - self.from) * (high / (low + high))
                }
            }
            ShapeKind::GAUSSIAN => a + side * b * sqrt(-2.0 * log(level)),
            ShapeKind::BELL => a + side * b * pow((1.0 - level) / level, 0.5 / c),
            ShapeKind::SIGMOID => a + log(level / (1.0 - level)) / b,
            ShapeKind::S_SHAPE => a + (b - a) * step(level),
            ShapeKind::Z_SHAPE => b - (b - a) * step(level),
            ShapeKind::PI_SHAPE if self.rises() => a + (b - a) * step(level),
            ShapeKind::PI_SHAPE => d - (d - c) * step(level),
            ShapeKind::COSINE => a + side * (b / PI) * atan2(sqrt(1.0 - level), sqrt(level)),
            ShapeKind::SPIKE => a - side * 0.1 * b * log(level),
            ShapeKind::CONCAVE => 2.0 * b - a - (b - a) / level,
            _ => root(self.from, self.to, |x| self.degree(x) - degree),
        };
        // NaN is replaced by the upper end.
        larger(self.from, smaller(x, self.to))
    }

    /// Returns the value at which the flank is cut off at a firing strength: the summit if the flank is nowhere higher,
    /// the foot if the flank is higher everywhere.
    pub(crate) fn clip(&self, strength: f64) -> f64 {
        let ((foot, low), (summit, high)) = (self.foot(), self.summit());
        match (high <= strength, low < strength) {
            (true, _) => summit,
            (false, true) => self.position_of_degree(strength),
            (false, false) => foot,
        }
    }

    /// Returns the area and moment of the tail up to `x`; `degree` is the degree of the flank at `x`.
    pub(crate) fn tail(&self, knots: &[Knot], measure: Measure, x: f64, degree: f64) -> (f64, f64) {
        let (foot, low) = self.foot();
        if self.kind == ShapeKind::PIECEWISE {
            return measure.trapezoid((foot, low), (x, degree));
        }
        if self.first_knot == self.end_knot {
            let area = self.beyond_of(x, measure) - self.beyond;
            let [mean, sd, ..] = self.parameters;
            let side = if self.rises() { -1.0 } else { 1.0 };
            let around = side * sd * (sd / measure.unit) * (degree - low);
            return (area, (mean - measure.origin) * area + around);
        }
        let knots = &knots[self.first_knot as usize..self.end_knot as usize];
        let passed = if self.right < self.left {
            knots.partition_point(|knot| knot.x >= x)
        } else {
            knots.partition_point(|knot| knot.x <= x)
        };
        let knot = knots[passed.saturating_sub(1)];
        let (from, to) = (smaller(knot.x, x), larger(knot.x, x));
        let (area, moment) = gauss(|x| self.degree(x), from, to, measure.origin);
        (
            knot.area + area / measure.unit,
            knot.moment + moment / measure.unit,
        )
    }

    /// Returns the area below a Gaussian beyond `x`, on the side away from the mean.
    pub(crate) fn beyond_of(&self, x: f64, measure: Measure) -> f64 {
        /// `sqrt(pi / 2)`.
        const HALF: f64 = 1.253_314_137_315_500_3;
        let [mean, sd, ..] = self.parameters;
        let z = (x - mean) / (sd * SQRT_2);
        let z = if self.rises() { -z } else { z };
        self.height * (sd / measure.unit) * HALF * erfc(z)
    }

    /// Returns the area and moment of the flank cut off at a firing strength.
    pub(crate) fn clipped(&self, knots: &[Knot], measure: Measure, strength: f64) -> (f64, f64) {
        let (summit, high) = self.summit();
        if high <= strength {
            return (self.area, self.moment);
        }
        let x = self.clip(strength);
        let (area, moment) = if x == self.foot().0 {
            (0.0, 0.0)
        } else {
            self.tail(knots, measure, x, strength)
        };
        let plateau = measure.rectangle(smaller(x, summit), larger(x, summit), strength);
        (area + plateau.0, moment + plateau.1)
    }
}

/// Returns the fraction `t` at which a smooth step of two parabolas reaches the given degree. The step is `2 t^2` up
/// to the middle and `1 - 2 (1 - t)^2` beyond.
fn step(degree: f64) -> f64 {
    if degree <= 0.5 {
        sqrt(0.5 * degree)
    } else {
        1.0 - sqrt(0.5 * (1.0 - degree))
    }
}
