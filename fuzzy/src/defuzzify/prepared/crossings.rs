//! The crossings of two flanks for any firing strengths of their terms.

use alloc::{vec, vec::Vec};

use super::{degree, stretches::LEVEL};
use crate::table::numeric::root;
use crate::table::{Flank, ShapeKind};

/// Two flanks on the interval that both cover.
pub(super) struct FlankPair<'f> {
    a: &'f Flank,
    b: &'f Flank,
    pub(super) from: f64,
    pub(super) to: f64,
}

/// The number of evenly spaced steps at whose ends two flanks with the same direction are compared, in addition to their
/// cuts.
const COMPARED: usize = 24;

impl<'f> FlankPair<'f> {
    pub(super) fn new(a: &'f Flank, b: &'f Flank) -> Self {
        FlankPair {
            a,
            b,
            from: a.from.max(b.from),
            to: a.to.min(b.to),
        }
    }

    /// Adds cuts such that the two flanks cross only at cuts (minimum), or at most once between two cuts (product).
    pub(super) fn cuts(&self, seeds: [&[f64]; 2], scales: bool, cuts: &mut Vec<f64>) {
        let direction = |flank: &Flank| match () {
            () if flank.is_level() => 0,
            () if flank.rises() => 1,
            () => -1,
        };
        let alike = direction(self.a) * direction(self.b) > 0;
        let is_straight = |flank: &Flank| flank.kind == ShapeKind::PIECEWISE;
        let points = if alike && !(is_straight(self.a) && is_straight(self.b)) {
            self.points(seeds)
        } else {
            vec![self.from, self.to]
        };
        match scales {
            true => self.turns_of_ratio(&points, cuts),
            false => self.crossings(&points, cuts),
        }
    }

    fn points(&self, seeds: [&[f64]; 2]) -> Vec<f64> {
        let (from, to) = (self.from, self.to);
        let even = |i: usize| from + (to - from) * (i as f64 / COMPARED as f64);
        let mut points: Vec<f64> = (1..COMPARED).map(even).collect();
        points.extend(seeds.into_iter().flatten());
        points.retain(|x| from < *x && *x < to);
        points.extend([from, to]);
        points.sort_by(f64::total_cmp);
        points.dedup();
        points
    }

    fn crossings(&self, points: &[f64], cuts: &mut Vec<f64>) {
        let mut before: Option<(f64, f64)> = None;
        for &x in points {
            let (a, b) = (degree(self.a, x), degree(self.b, x));
            let difference = a - b;
            if libm::fabs(difference) <= LEVEL * a.max(b) {
                continue;
            }
            if let Some((last, other)) = before
                && (other > 0.0) != (difference > 0.0)
            {
                cuts.push(root(last, x, |x| degree(self.a, x) - degree(self.b, x)));
            }
            before = Some((x, difference));
        }
    }

    fn turns_of_ratio(&self, points: &[f64], cuts: &mut Vec<f64>) {
        let ratio = |x: f64| libm::log(degree(self.a, x)) - libm::log(degree(self.b, x));
        let ratios: Vec<(f64, f64)> = points
            .iter()
            .map(|x| (*x, ratio(*x)))
            .filter(|(_, ratio)| ratio.is_finite())
            .collect();
        for window in ratios.windows(3) {
            let [(from, left), (_, middle), (to, right)] = *window else {
                continue;
            };
            let turns = (middle - left) * (right - middle) < 0.0;
            let clearly = libm::fabs(middle - left).min(libm::fabs(right - middle)) > 1e-12;
            if turns && clearly {
                cuts.push(turning_point(from, to, middle > left, ratio));
            }
        }
    }
}

/// Returns the extremum of a function with one maximum (or minimum) between two values, by golden-section search, to a
/// relative accuracy of one in a million.
fn turning_point(from: f64, to: f64, is_maximum: bool, f: impl Fn(f64) -> f64) -> f64 {
    const GOLDEN: f64 = 0.618_033_988_749_894_8;
    let f = |x: f64| if is_maximum { f(x) } else { -f(x) };
    let (mut from, mut to) = (from, to);
    for _ in 0..30 {
        let width = GOLDEN * (to - from);
        if f(to - width) > f(from + width) {
            to = from + width;
        } else {
            from = to - width;
        }
    }
    0.5 * (from + to)
}
