//! The maxima of an aggregated set, from its pieces.

use super::piece::Piece;
use crate::model::Defuzzifier;
use crate::table::{SetDefuzzifier, numeric::root, set::Maxima as Values};

/// Degrees this close to the highest, relative to it, count as the highest. Rounding changes a plateau made of two slopes by
/// less.
const PLATEAU: f64 = 1e-12;

/// The highest degree seen.
#[derive(Debug, Default, Clone, Copy)]
pub(crate) struct Highest(pub(crate) f64);

impl Highest {
    pub(crate) fn see(&mut self, piece: &Piece<'_>) {
        self.0 = self.0.max(piece.left).max(piece.right);
        let mut highest = self.0;
        peaks(piece, self.0, &mut |_, degree| {
            highest = highest.max(degree)
        });
        self.0 = highest;
    }
}

/// The values where the set is highest.
#[derive(Debug, Default, Clone, Copy)]
pub(crate) struct Maxima {
    least_degree: f64,
    values: Values,
    /// The end of the piece before.
    before: End,
}

/// The end of a piece.
#[derive(Debug, Default, Clone, Copy)]
struct End {
    x: f64,
    degree: f64,
    /// Whether the piece rises towards it.
    rises: bool,
}

impl Maxima {
    pub(crate) fn of(highest: Highest) -> Self {
        Maxima {
            least_degree: highest.0 * (1.0 - PLATEAU),
            ..Maxima::default()
        }
    }

    pub(crate) fn see(&mut self, piece: &Piece<'_>) {
        let high = |degree: f64| degree >= self.least_degree;
        let (left, right) = (high(piece.left), high(piece.right));
        let flat = piece
            .curve
            .is_none_or(|curve| [0.25, 0.5, 0.75].into_iter().all(|part| high(curve(part))));
        let is_plateau = left && right && flat;
        let (mut rises_first, mut rises_last) =
            (piece.left < piece.right, piece.left < piece.right);
        let mut inside: Option<(f64, f64, f64)> = None;
        if !is_plateau {
            let least = self.least_degree;
            let ends = peaks(piece, least, &mut |x, degree| {
                if degree >= least {
                    let (first, last, count) = inside.unwrap_or((x, x, 0.0));
                    inside = Some((first.min(x), last.max(x), count + 1.0));
                }
            });
            (rises_first, rises_last) = ends.unwrap_or((rises_first, rises_last));
        }
        // Between two pieces that meet is a maximum where the set rises to it and falls from it; at a step, on the higher side.
        let before = self.before;
        let meet = before.x == piece.from;
        let falls = !is_plateau && !rises_first;
        let step = libm::fabs(before.degree - piece.left) > PLATEAU * before.degree;
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
        self.before = End {
            x: piece.to,
            degree: piece.right,
            rises: !is_plateau && rises_last && right,
        };
    }

    /// Counts the end of the piece before, unless the set goes on higher there.
    fn close(&mut self, goes_on_higher: bool) {
        if self.before.rises && !goes_on_higher {
            self.point(self.before.x);
        }
        self.before.rises = false;
    }

    fn point(&mut self, x: f64) {
        self.values.point(x);
    }

    /// The value; `None` of a set that is 0 everywhere.
    pub(crate) fn value(mut self, defuzzifier: Defuzzifier) -> Option<f64> {
        self.close(false);
        self.values.value(match defuzzifier {
            Defuzzifier::SmallestOfMaxima => SetDefuzzifier::SMALLEST_OF_MAXIMA,
            Defuzzifier::LargestOfMaxima => SetDefuzzifier::LARGEST_OF_MAXIMA,
            _ => SetDefuzzifier::MEAN_OF_MAXIMA,
        })
    }
}

/// The windows of a piece in which its slope is looked at.
const WINDOWS: usize = 8;

/// Calls `visit` with each maximum inside a curve, and its degree; parts of the curve far below `above` are left out. Returns
/// whether the curve rises at its beginning and towards its end; `None` of a straight piece.
fn peaks(piece: &Piece<'_>, above: f64, visit: &mut dyn FnMut(f64, f64)) -> Option<(bool, bool)> {
    let curve = piece.curve?;
    Some(turns(curve, 0.9 * above, &mut |part| {
        visit(piece.from + (piece.to - piece.from) * part, curve(part));
    }))
}

/// Calls `visit` with each place inside [0, 1] at which a smooth function has a maximum, unless it is below `above` all around.
/// Returns whether it rises at 0 and towards 1.
pub(super) fn turns(
    curve: &dyn Fn(f64) -> f64,
    above: f64,
    visit: &mut dyn FnMut(f64),
) -> (bool, bool) {
    let half = 0.5 / WINDOWS as f64;
    let (mut first, mut last) = (0.0, 0.0);
    for window in 0..WINDOWS {
        let middle = (2 * window + 1) as f64 * half;
        let slopes = Slopes::new(|t| curve(middle + half * t));
        let (left, right) = (slopes.at(-1.0), slopes.at(1.0));
        if window == 0 {
            first = left;
        } else if last > 0.0 && left <= 0.0 {
            visit(middle - half);
        }
        if left > 0.0 && right < 0.0 && slopes.highest > above {
            visit(middle + half * root(-1.0, 1.0, |t| slopes.at(t)));
        }
        last = right;
    }
    (first > 0.0, last > 0.0)
}

/// The slope of a smooth function on [-1, 1]: that of its interpolation at Chebyshev's nodes.
struct Slopes {
    nodes: [f64; Slopes::NODES],
    /// Newton's divided differences.
    differences: [f64; Slopes::NODES],
    highest: f64,
}

impl Slopes {
    const NODES: usize = 9;

    fn new(f: impl Fn(f64) -> f64) -> Self {
        let step = core::f64::consts::PI / (Self::NODES - 1) as f64;
        let nodes = core::array::from_fn(|i| -libm::cos(i as f64 * step));
        let mut differences = nodes.map(f);
        let highest = differences
            .iter()
            .copied()
            .fold(f64::NEG_INFINITY, f64::max);
        for order in 1..Self::NODES {
            for i in (order..Self::NODES).rev() {
                differences[i] =
                    (differences[i] - differences[i - 1]) / (nodes[i] - nodes[i - order]);
            }
        }
        Slopes {
            nodes,
            differences,
            highest,
        }
    }

    /// The derivative at `t`, by Horner's rule for Newton's form.
    fn at(&self, t: f64) -> f64 {
        let (mut value, mut slope) = (0.0, 0.0);
        for (node, difference) in self.nodes.iter().zip(&self.differences).rev() {
            slope = value + slope * (t - node);
            value = difference + value * (t - node);
        }
        slope
    }
}
