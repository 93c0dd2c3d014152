//! The inverse of monotone membership functions, for Tsukamoto consequents.

#[cfg(feature = "alloc")]
use alloc::vec::Vec;

use libm::{log, sqrt};

#[cfg(feature = "alloc")]
use super::MembershipFunction;
use super::ShapeKind;

impl ShapeKind {
    /// Returns the value at which a monotone membership function takes the given degree in [0, 1], that is, the
    /// inverse of its formula. Where the degree is constant, the result is the end of the slope next to this
    /// plateau. A sigmoid reaches 0 and 1, and a concave shape reaches 0, only at infinity. NaN for shapes that are
    /// not monotone.
    pub(crate) fn inverse(self, parameters: &[f64; 4], points: &[[f64; 2]], degree: f64) -> f64 {
        let [a, b, ..] = *parameters;
        let along = |foot: f64, top: f64, part: f64| foot + (top - foot) * part;
        match self {
            ShapeKind::RIGHT_SHOULDER => along(a, b, degree),
            ShapeKind::LEFT_SHOULDER => along(b, a, degree),
            ShapeKind::S_SHAPE => smooth(a, b, degree),
            ShapeKind::Z_SHAPE => smooth(b, a, degree),
            ShapeKind::SIGMOID if b != 0.0 => a + log(degree / (1.0 - degree)) / b,
            ShapeKind::CONCAVE => 2.0 * b - a - (b - a) / degree,
            // The inverse of sqrt(t (2 - t)), without cancellation.
            ShapeKind::ARC => along(a, b, degree * degree / (1.0 + sqrt(1.0 - degree * degree))),
            ShapeKind::PIECEWISE => piecewise(points, degree),
            _ => f64::NAN,
        }
    }
}

#[cfg(feature = "alloc")]
impl MembershipFunction {
    /// Returns the value at which a monotone membership function takes the given degree: see [`ShapeKind::inverse`].
    pub(crate) fn inverse(&self, degree: f64) -> f64 {
        let (kind, parameters) = self.kind();
        match self {
            MembershipFunction::Piecewise { points } => {
                let points: Vec<[f64; 2]> = points.iter().map(|(x, y)| [*x, *y]).collect();
                kind.inverse(&parameters, &points, degree)
            }
            _ => kind.inverse(&parameters, &[], degree),
        }
    }

    /// Returns whether the degree only rises or only falls over all values and is not constant, so that each degree
    /// determines a value.
    pub(crate) fn is_monotone(&self) -> bool {
        match self {
            MembershipFunction::Piecewise { points } => {
                let degrees = || points.iter().map(|point| point.1);
                degrees().next() != degrees().next_back()
                    && (degrees().is_sorted() || degrees().is_sorted_by(|a, b| a >= b))
            }
            _ => !self.inverse(0.5).is_nan(),
        }
    }
}

/// Returns the value at which two parabolas, from 0 at `foot` to 1 at `top`, take the given degree. `top` may be below
/// `foot`.
fn smooth(foot: f64, top: f64, degree: f64) -> f64 {
    let width = top - foot;
    if degree <= 0.5 {
        foot + width * sqrt(0.5 * degree)
    } else {
        top - width * sqrt(0.5 * (1.0 - degree))
    }
}

/// Returns the value at which a piecewise linear function takes the given degree. The degrees of its points must only
/// rise or only fall. If several values have this degree, the result is the first one in the direction in which the
/// degrees rise. A degree below all of them gives the start of the slope, a degree above all of them its end.
fn piecewise(points: &[[f64; 2]], degree: f64) -> f64 {
    match (points.first(), points.last()) {
        (Some([_, first]), Some([_, last])) if first > last => {
            going_up(points.iter().rev(), degree)
        }
        _ => going_up(points.iter(), degree),
    }
}

fn going_up<'a>(points: impl Iterator<Item = &'a [f64; 2]>, degree: f64) -> f64 {
    let mut before: Option<[f64; 2]> = None;
    let mut top = f64::NAN;
    for &[x, y] in points {
        if let Some([left, low]) = before
            && y > low
        {
            if degree <= y {
                let part = (degree - low) / (y - low);
                return if part > 0.0 {
                    left + (x - left) * part
                } else {
                    left
                };
            }
            top = x;
        }
        before = Some([x, y]);
    }
    top
}
