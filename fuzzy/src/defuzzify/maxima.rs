//! The maxima of an aggregated set, computed from its pieces.

use alloc::vec::Vec;

use super::piece::Piece;
use crate::model::MembershipFunction;
use crate::table::{OfMaxima, ShapeKind, numeric::root, set::Maxima as Values};

/// The relative difference up to which degrees count as equal; rounding errors are smaller.
pub(super) const EQUAL: f64 = 1e-12;

/// The highest degree so far.
#[derive(Debug, Default, Clone, Copy)]
pub(crate) struct HighestDegree(pub(crate) f64);

impl HighestDegree {
    pub(crate) fn see(&mut self, piece: &Piece<'_>) {
        self.0 = self.0.max(piece.left).max(piece.right);
        let mut highest = self.0;
        peaks(piece, &mut |_, degree| highest = highest.max(degree));
        self.0 = highest;
    }
}

/// The values at which the set is highest.
#[derive(Debug, Default, Clone, Copy)]
pub(crate) struct Maxima {
    least_degree: f64,
    values: Values,
    /// The end of the previous piece.
    before: PieceEnd,
}

/// The end of a piece.
#[derive(Debug, Default, Clone, Copy)]
struct PieceEnd {
    x: f64,
    degree: f64,
    /// Whether the piece rises towards its end.
    rises: bool,
}

impl Maxima {
    pub(crate) fn of(highest: HighestDegree) -> Self {
        Maxima {
            least_degree: highest.0 * (1.0 - EQUAL),
            ..Maxima::default()
        }
    }

    pub(crate) fn see(&mut self, piece: &Piece<'_>) {
        let high = |degree: f64| degree >= self.least_degree;
        let (left, right) = (high(piece.left), high(piece.right));
        let flat = piece.curve.is_none_or(|curve| {
            [0.25, 0.5, 0.75]
                .into_iter()
                .all(|part| high((curve.degree)(part)))
        });
        let is_plateau = left && right && flat;
        let (mut rises_first, mut rises_last) =
            (piece.left < piece.right, piece.left < piece.right);
        let mut inside: Option<(f64, f64, f64)> = None;
        if !is_plateau {
            let least = self.least_degree;
            let ends = peaks(piece, &mut |x, degree| {
                if degree >= least {
                    let (first, last, count) = inside.unwrap_or((x, x, 0.0));
                    inside = Some((first.min(x), last.max(x), count + 1.0));
                }
            });
            (rises_first, rises_last) = ends.unwrap_or((rises_first, rises_last));
        }
        // The boundary of two adjacent pieces is a maximum if the set rises to it and falls from it; at a step, only
        // the higher side counts.
        let before = self.before;
        let meet = before.x == piece.from;
        let falls = !is_plateau && !rises_first;
        let step = libm::fabs(before.degree - piece.left) > EQUAL * before.degree;
        if meet && !step {
            if before.rises && falls && left {
                self.point(piece.from);
            }
        } else {
            self.close(meet && before.degree < piece.left);
            if falls && left && (!meet || before.degree < piece.left) {
                self.point(piece.from);
            }
        }
        if is_plateau {
            self.values.plateau(piece.from, piece.to);
        }
        if let Some((first, last, count)) = inside {
            self.point(first);
            if count > 1.0 {
                self.point(last);
            }
        }
        self.before = PieceEnd {
            x: piece.to,
            degree: piece.right,
            rises: !is_plateau && rises_last && right,
        };
    }

    /// Counts the end of the previous piece as a maximum if the piece rises to it and the set is not higher beyond it.
    fn close(&mut self, goes_on_higher: bool) {
        if self.before.rises && !goes_on_higher {
            self.point(self.before.x);
        }
        self.before.rises = false;
    }

    fn point(&mut self, x: f64) {
        self.values.point(x);
    }

    /// Returns the smallest, mean or largest value at which the set is highest, as selected by `which`; `None` for a
    /// set that is 0 everywhere.
    pub(crate) fn value(mut self, which: OfMaxima) -> Option<f64> {
        self.close(false);
        self.values.value(which)
    }
}

/// Calls `visit` for each maximum inside a curve, with its degree. Returns whether the curve rises at its start, and
/// whether it rises at its end; `None` for a straight piece.
fn peaks(piece: &Piece<'_>, visit: &mut dyn FnMut(f64, f64)) -> Option<(bool, bool)> {
    let curve = piece.curve?;
    Some(turns(curve.slope, &mut |part| {
        visit(
            piece.from + (piece.to - piece.from) * part,
            (curve.degree)(part),
        );
    }))
}

/// The number of intervals of a piece at whose ends the slope is evaluated.
const STRETCHES: u32 = 32;

/// The distance from an end, as a fraction of the width, at which a function is evaluated, so that a kink or step at the
/// end itself has no effect.
pub(super) const INSIDE: f64 = 1e-12;

/// Calls `visit` for each position in [0, 1] at which a function has a maximum, that is, its slope falls through 0.
/// Returns whether the function rises at 0, and whether it rises at 1.
pub(super) fn turns(slope: &dyn Fn(f64) -> f64, visit: &mut dyn FnMut(f64)) -> (bool, bool) {
    let mut from = INSIDE;
    let first = slope(from);
    let mut before = first;
    for i in 1..=STRETCHES {
        let to = (f64::from(i) / f64::from(STRETCHES)).min(1.0 - INSIDE);
        let here = slope(to);
        if before > 0.0 && here <= 0.0 {
            visit(root(from, to, slope));
        }
        (from, before) = (to, here);
    }
    (first > 0.0, before > 0.0)
}

/// Returns the positions at which a shape is not smooth or has an extremum, and the ends of the range. Between these
/// positions the shape only rises, only falls or is level. The positions of a formula are unknown.
pub(super) fn monotone(shape: &MembershipFunction, low: f64, high: f64) -> Vec<f64> {
    let mut cuts = shape.cuts();
    let sort = |cuts: &mut Vec<f64>| {
        cuts.sort_by(f64::total_cmp);
        cuts.dedup();
    };
    cuts.retain(|x| low < *x && *x < high);
    cuts.extend([low, high]);
    sort(&mut cuts);
    // All other shapes have extrema only at their cuts.
    if let ShapeKind::SIGMOID_DIFFERENCE | ShapeKind::SIGMOID_PRODUCT | ShapeKind::GAUSSIAN2 =
        shape.kind().0
    {
        let mut turning = Vec::new();
        for (&from, &to) in cuts.iter().zip(cuts.iter().skip(1)) {
            let width = to - from;
            let mut found = |part: f64| turning.push(from + width * part);
            let slope = |part: f64| shape.slope(from + width * part, width);
            turns(&slope, &mut found);
            turns(&|part| -slope(part), &mut found);
        }
        cuts.extend(turning);
        sort(&mut cuts);
    }
    cuts
}
