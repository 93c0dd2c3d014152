//! Type reduction without integration.
//!
//! For weighted numbers, the result is the interval of `sum(w x) / sum(w)` over all weights between their bounds.
//!
//! The left end is reached by weights that are as large as possible for the numbers left of it, and as small as
//! possible for the others. It is therefore the root c of
//!
//! ```text
//! F(c) = sum of w_upper (c - x) over x < c  +  sum of w_lower (c - x) over x > c
//! ```
//!
//! F is convex, piecewise linear and never decreases, so Newton's method approaches the root from one side and ends
//! after finitely many steps. The right end is found in the same way, with left and right exchanged. If all lower bounds
//! are 0, the interval extends from the smallest to the largest number. The same search is used for fuzzy sets, in
//! `set/between.rs` and, without a closed form, in `defuzzify/reduction.rs`.
//!
//! For fuzzy sets with a closed form, the type reductions that give a single value are computed from the areas and
//! centroids of the lower and the upper set. The methods that give an interval need prepared sets.

use super::closed::area_and_centroid;
use super::closed_reduction::{Summary, closed};
use super::operators::{larger, smaller};
use super::{Arrays, ClosedForm, Output, State, number};

/// The maximum number of steps of the search for an end. A few are enough, unless the lower set is almost empty. Each
/// step may then leave up to two thirds of the distance to the end, but after this number of steps the remaining
/// distance is far below rounding errors.
const MAX_STEPS: usize = 250;

/// A type reduction: the method that computes the interval, or the single value, of an output affected by
/// interval type-2 terms. docs/rule-sets.md has the formulas.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum TypeReduction {
    /// The exact interval of all centroids, which the algorithms of Karnik and Mendel approximate with samples.
    #[default]
    Exact,
    /// Nie and Tan: the centroid of the mean of the lower and the upper set. The interval is a single value.
    NieTan,
    /// Begian, Melek and Mendel: the mean of the centroids of the lower and the upper set. The interval is a single
    /// value.
    BegianMelekMendel,
    /// Wu and Mendel: an interval whose ends are the middles of the uncertainty bounds of the exact ends.
    WuMendel,
}

impl TypeReduction {
    /// All type reductions.
    pub const ALL: [TypeReduction; 4] = [
        TypeReduction::Exact,
        TypeReduction::NieTan,
        TypeReduction::BegianMelekMendel,
        TypeReduction::WuMendel,
    ];
}

/// A number with the bounds of its weight.
#[derive(Debug, Clone, Copy)]
pub(crate) struct WeightedNumber {
    pub(crate) at: f64,
    pub(crate) lower: f64,
    pub(crate) upper: f64,
}

/// An end of the interval.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum IntervalEnd {
    Left,
    Right,
}

impl IntervalEnd {
    /// Returns the intervals, one on each side of `x`, on which the set in [`search`] equals the upper set and the lower
    /// set.
    pub(crate) fn parts(self, x: f64) -> ((f64, f64), (f64, f64)) {
        let (below, above) = ((f64::NEG_INFINITY, x), (x, f64::INFINITY));
        match self {
            IntervalEnd::Left => (below, above),
            IntervalEnd::Right => (above, below),
        }
    }
}

impl TypeReduction {
    /// Returns the code in exported data; 0 is the code of outputs without a type reduction.
    #[cfg(feature = "alloc")]
    pub(crate) fn code(self) -> u32 {
        let index = Self::ALL.iter().position(|other| *other == self);
        index.unwrap_or(0) as u32 + 1
    }

    /// Returns whether the interval is a single value.
    pub(crate) fn is_number(self) -> bool {
        match self {
            TypeReduction::NieTan | TypeReduction::BegianMelekMendel => true,
            TypeReduction::Exact | TypeReduction::WuMendel => false,
        }
    }

    /// Returns the state of an output with the given ends.
    pub(crate) fn state(self, output: &Output, (low, high): (f64, f64)) -> State {
        let (low, high) = (output.clamped(low), output.clamped(high));
        match (low.is_finite() && high.is_finite(), self.is_number()) {
            (false, _) => State::NoRuleFired,
            (true, true) => State::Defined(low),
            (true, false) => State::Interval { low, high },
        }
    }
}

/// Returns the state of an output for which rules fired; `None` if the table cannot compute its interval. `bases` is memory
/// for the bases of a [`LayeredSet`](super::LayeredSet).
pub(super) fn reduced<A: Arrays>(
    table: &A,
    output: &Output,
    (inputs, strengths): (&[[f64; 1]], &[[f64; 1]]),
    bases: &mut [[f64; 1]],
) -> Option<State> {
    let method = *TypeReduction::ALL.get((output.reduction as usize).checked_sub(1)?)?;
    let lower = table.outputs().get(output.lower as usize)?;
    let of = |output: &Output| {
        strengths.get(output.first_strength as usize..output.end_strength as usize)
    };
    let consequents = output.first as usize..output.end as usize;
    let consequents = table.consequents().get(consequents);
    let ends = match output.form() {
        ClosedForm::WeightedAverage | ClosedForm::WeightedSum => {
            let terms = consequents?.iter().zip(of(lower)?).zip(of(output)?);
            let fired = terms.filter(|(_, [upper])| *upper > 0.0);
            let points = fired.map(|((consequent, [lower]), [upper])| WeightedNumber {
                at: number(table, consequent, inputs),
                lower: *lower,
                upper: *upper,
            });
            match output.form() {
                ClosedForm::WeightedSum => sum(points),
                _ => ends_of(method, points),
            }
        }
        ClosedForm::Cut | ClosedForm::Scaled if !method.is_number() => {
            // Both are prepared sets of the same form, unless the table is damaged.
            if lower.form() != output.form() {
                return None;
            }
            let with_strengths = |output| Some((output, of(output)?.as_flattened()));
            let (upper, lower) = (with_strengths(output)?, with_strengths(lower)?);
            super::set::between::interval(table, method, upper, lower)
        }
        ClosedForm::Integrated => return None,
        _ if !method.is_number() => return None,
        _ => {
            let upper = area_and_centroid(table, output, of(output)?, bases);
            let lower = area_and_centroid(table, lower, of(lower)?, bases);
            // These methods do not use the support.
            let support = (output.low, output.high);
            upper.and_then(|upper| {
                let summary = Summary {
                    lower,
                    upper,
                    support,
                };
                closed(method, summary)
            })
        }
    };
    Some(ends.map_or(State::NoRuleFired, |ends| method.state(output, ends)))
}

/// Returns the interval of weighted numbers by a method of type reduction.
pub(crate) fn ends_of(
    method: TypeReduction,
    points: impl Iterator<Item = WeightedNumber> + Clone,
) -> Option<(f64, f64)> {
    if method == TypeReduction::Exact {
        return average(points);
    }
    let support = points.clone().filter(|point| point.upper > 0.0);
    let origin = support.clone().next()?.at;
    let sums = |weight: fn(&WeightedNumber) -> f64| {
        let (mut total, mut moment) = (0.0, 0.0);
        for point in points.clone() {
            total += weight(&point);
            moment += weight(&point) * (point.at - origin);
        }
        (total > 0.0).then(|| (total, origin + moment / total))
    };
    let support = support.fold((origin, origin), |(low, high), point| {
        (smaller(low, point.at), larger(high, point.at))
    });
    let summary = Summary {
        lower: sums(|point| point.lower),
        upper: sums(|point| point.upper)?,
        support,
    };
    closed(method, summary)
}

/// Returns the interval of `sum(w x) / sum(w)` over all weights between their bounds; `None` if all upper bounds are 0.
pub(crate) fn average(points: impl Iterator<Item = WeightedNumber> + Clone) -> Option<(f64, f64)> {
    let mut positive = points.clone().filter(|point| point.upper > 0.0);
    let first = positive.next()?.at;
    let (low, high) = positive.fold((first, first), |(low, high), point| {
        (smaller(low, point.at), larger(high, point.at))
    });
    if points.clone().all(|point| point.lower <= 0.0) {
        return Some((low, high));
    }
    let sums = |end: IntervalEnd, x: f64| {
        let (mut total, mut moment) = (0.0, 0.0);
        for point in points.clone() {
            let below = point.at < x;
            let weight = if below == (end == IntervalEnd::Left) {
                point.upper
            } else {
                point.lower
            };
            total += weight;
            moment += weight * (point.at - x);
        }
        (total, moment)
    };
    Some(both_ends(low + 0.5 * (high - low), (low, high), sums))
}

/// Returns the interval of `sum(w x)` over all weights between their bounds; `None` if there are no points.
pub(crate) fn sum(points: impl Iterator<Item = WeightedNumber>) -> Option<(f64, f64)> {
    let (mut low, mut high, mut is_empty) = (0.0, 0.0, true);
    for point in points {
        is_empty = false;
        let (one, other) = (point.lower * point.at, point.upper * point.at);
        low += smaller(one, other);
        high += larger(one, other);
    }
    (!is_empty).then_some((low, high))
}

/// Searches for both ends of the interval. `sums` returns the same as the `sums` of [`search`], for the given end.
pub(crate) fn both_ends(
    start: f64,
    range: (f64, f64),
    mut sums: impl FnMut(IntervalEnd, f64) -> (f64, f64),
) -> (f64, f64) {
    let mut end = |end| search(end, start, range, |x| sums(end, x));
    (end(IntervalEnd::Left), end(IntervalEnd::Right))
}

/// Returns an end of the interval by Newton's method. `sums` returns the area and the moment about x of a set that
/// consists of two parts: on the side of x towards the requested end it equals the upper set, and on the other side the
/// lower set.
pub(crate) fn search(
    end: IntervalEnd,
    start: f64,
    (low, high): (f64, f64),
    mut sums: impl FnMut(f64) -> (f64, f64),
) -> f64 {
    let mut x = start;
    for step in 0..MAX_STEPS {
        let (area, moment) = sums(x);
        let next = larger(low, smaller(high, x + moment / area));
        // The starting point may be outside the interval, beyond the end that is computed. After the first step, all
        // steps approach that end from inside the interval, up to rounding.
        let approaches = match end {
            IntervalEnd::Left => next < x,
            IntervalEnd::Right => next > x,
        };
        if next.is_nan() || (step > 0 && !approaches) {
            break;
        }
        x = next;
    }
    x
}

#[cfg(test)]
mod tests {
    use super::*;

    fn points(all: &[(f64, f64, f64)]) -> impl Iterator<Item = WeightedNumber> + Clone {
        all.iter()
            .map(|&(at, lower, upper)| WeightedNumber { at, lower, upper })
    }

    #[test]
    fn averages_equal_values_computed_by_hand() {
        // The numbers 0 and 10 have weights in [1, 3]. The smallest average is 1 * 10 / 4, the largest 3 * 10 / 4.
        let two = points(&[(10.0, 1.0, 3.0), (0.0, 1.0, 3.0)]);
        assert_eq!(average(two), Some((2.5, 7.5)));
        // With equal bounds, the interval is a single number.
        let crisp = points(&[(4.0, 0.5, 0.5), (8.0, 0.5, 0.5)]);
        assert_eq!(average(crisp), Some((6.0, 6.0)));
        // If all lower bounds are 0, the average can be any value from the smallest to the largest number whose upper
        // bound is above 0.
        let open = points(&[(4.0, 0.0, 0.5), (8.0, 0.0, 0.1), (9.0, 0.0, 0.0)]);
        assert_eq!(average(open), Some((4.0, 8.0)));
        assert_eq!(average(points(&[(4.0, 0.0, 0.0)])), None);
    }

    /// Returns the uncertainty bounds of the left end, by the formulas printed by Wu and Mendel for rules in ascending
    /// order: the bound below the end and the bound above it.
    fn wu_mendel_left(points: &[WeightedNumber]) -> (f64, f64) {
        let sum = |f: &dyn Fn(&WeightedNumber) -> f64| points.iter().map(f).sum::<f64>();
        let (lower, upper) = (sum(&|p| p.lower), sum(&|p| p.upper));
        let (y_0, y_m) = (
            sum(&|p| p.lower * p.at) / lower,
            sum(&|p| p.upper * p.at) / upper,
        );
        let (first, last) = (points[0].at, points[points.len() - 1].at);
        let above = y_0.min(y_m);
        let a = sum(&|p| p.lower * (p.at - first));
        let b = sum(&|p| p.upper * (last - p.at));
        let gap = sum(&|p| p.upper - p.lower) / (upper * lower) * (a * b / (a + b));
        (above - gap, above)
    }

    #[test]
    fn the_uncertainty_bounds_enclose_the_exact_ends() {
        let mut state = 1_u64;
        let mut random = || {
            state = state
                .wrapping_mul(6_364_136_223_846_793_005)
                .wrapping_add(1);
            (state >> 11) as f64 / (1_u64 << 53) as f64
        };
        for _ in 0..2000 {
            let all: Vec<WeightedNumber> = (0..4)
                .map(|i| {
                    let upper = 0.1 + 0.9 * random();
                    WeightedNumber {
                        at: f64::from(i) + random(),
                        lower: upper * random(),
                        upper,
                    }
                })
                .collect();
            let mirrored: Vec<WeightedNumber> = all
                .iter()
                .rev()
                .map(|point| WeightedNumber {
                    at: -point.at,
                    ..*point
                })
                .collect();
            let (low, high) = average(all.iter().copied()).unwrap();
            let left = wu_mendel_left(&all);
            let right = wu_mendel_left(&mirrored);
            assert!(left.0 <= low + 1e-12 && low <= left.1 + 1e-12);
            assert!(-right.1 <= high + 1e-12 && high <= -right.0 + 1e-12);
            let (wu_low, wu_high) = ends_of(TypeReduction::WuMendel, all.iter().copied()).unwrap();
            let middle = |(a, b): (f64, f64)| 0.5 * (a + b);
            assert!((wu_low - middle(left).max(all[0].at)).abs() < 1e-12);
            assert!((wu_high + middle(right).max(-all[3].at)).abs() < 1e-12);
            let total = |f: &dyn Fn(&WeightedNumber) -> f64| all.iter().map(f).sum::<f64>();
            let nie_tan = total(&|p| (p.lower + p.upper) * p.at) / total(&|p| p.lower + p.upper);
            let begian = 0.5
                * (total(&|p| p.lower * p.at) / total(&|p| p.lower)
                    + total(&|p| p.upper * p.at) / total(&|p| p.upper));
            for (method, expected) in [
                (TypeReduction::NieTan, nie_tan),
                (TypeReduction::BegianMelekMendel, begian),
            ] {
                let (value, same) = ends_of(method, all.iter().copied()).unwrap();
                assert!(value == same && (value - expected).abs() < 1e-12);
                assert!((low - 1e-12..=high + 1e-12).contains(&value));
            }
        }
    }

    #[test]
    fn sums_equal_values_computed_by_hand() {
        let two = points(&[(10.0, 0.25, 0.5), (-4.0, 0.0, 1.0)]);
        assert_eq!(sum(two), Some((2.5 - 4.0, 5.0)));
        assert_eq!(sum(points(&[])), None);
    }

    #[test]
    fn an_almost_empty_lower_set_ends_near_the_support() {
        for tiny in [1e-6, 1e-12, 1e-100, 1e-300] {
            // The root of c^3 / 6 - tiny c = tiny / 2 (1 - c)^2 is close to the root of c^3 = 3 tiny.
            let upper = |x: f64| (0.5 * x * x, -x * x * x / 6.0);
            let lower = |x: f64| (tiny * (1.0 - x), 0.5 * tiny * (1.0 - x) * (1.0 - x));
            let left = search(IntervalEnd::Left, 2.0 / 3.0, (0.0, 1.0), |x| {
                (upper(x).0 + lower(x).0, upper(x).1 + lower(x).1)
            });
            let (upper, lower) = (upper(left).1, lower(left).1);
            let is_root = (upper + lower).abs() <= 1e-12 * lower;
            assert!(is_root || left < 1e-40, "{tiny} {left}");
        }
    }
}
