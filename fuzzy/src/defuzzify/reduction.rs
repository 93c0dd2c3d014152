//! Type reduction: the interval of the centroids of all sets between a lower and an upper aggregated set.
//!
//! The left end of the interval of a set between `lower(x)` and `upper(x)` is the smallest centroid. It is reached by the
//! set that is as high as possible left of its own centroid and as low as possible right of it. So the left end is the
//! root c of
//!
//! ```text
//! F(c) = integral of (c - x) upper(x) over x < c  +  integral of (c - x) lower(x) over x > c
//! ```
//!
//! F is convex and never decreases, since its derivative is the area of the upper set left of c plus the area of the lower
//! set right of c. Between the kinks of straight sets it is a cubic. Newton's method with the exact integrals of the
//! pieces therefore approaches the root from one side, without samples, and ends at the last digit. The right end is its
//! mirror image. For weighted numbers the integrals are sums, F is a polygon, and the search ends after finitely many
//! steps.
//!
//! If the lower set is empty, the centroid of a narrow set anywhere inside the upper one is possible: the interval is the
//! support of the upper set.

use alloc::{boxed::Box, vec::Vec};

use super::closed_reduction::{Summary, closed};
use super::curves::Curves;
use super::piece::{Integrals, Piece, unit};
use super::workspace::Workspace;
use super::{ConsequentOperators, Strengths};
use crate::model::{Defuzzifier, Output, Term, TypeReduction, type2::Bound};
use crate::table::operators::{larger, smaller};

/// The maximum number of steps of the search for an end. A few are enough, unless the lower set is almost empty. In
/// that case each step may reduce the distance to the end by only a third, but after this many steps the rest is far
/// below rounding.
const MAX_STEPS: usize = 250;

/// The type reduction of an output.
#[derive(Debug, Clone)]
pub(crate) enum Reduction {
    /// The centroid of a fuzzy set.
    Set(Box<Set>),
    /// The centroid of singletons.
    Singletons(Vec<Singleton>, ConsequentOperators),
    /// Takagi-Sugeno: the weighted average of numbers.
    Average,
    /// Takagi-Sugeno: the weighted sum of numbers.
    Sum,
}

/// The terms of a fuzzy output.
#[derive(Debug, Clone)]
pub(crate) struct Set {
    pub(super) low: f64,
    pub(super) high: f64,
    pub(super) operators: ConsequentOperators,
    pub(super) lower: Curves,
    pub(super) upper: Curves,
}

/// A term that is a single point.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Singleton {
    at: f64,
    term: usize,
    lower_height: f64,
    upper_height: f64,
}

/// A number with the bounds of its weight.
#[derive(Debug, Clone, Copy)]
pub(crate) struct WeightedNumber {
    pub(super) at: f64,
    pub(super) lower: f64,
    pub(super) upper: f64,
}

/// A straight piece: its ends, and the degrees there.
type Line = [f64; 4];

/// An end of the interval.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum IntervalEnd {
    Left,
    Right,
}

impl Reduction {
    /// Creates the type reduction of an output of a valid model.
    pub(crate) fn new(output: &Output, operators: ConsequentOperators) -> Self {
        let terms = &output.variable.terms;
        match output.defuzzifier {
            Defuzzifier::WeightedSum => return Reduction::Sum,
            Defuzzifier::WeightedAverage => return Reduction::Average,
            Defuzzifier::Centroid
            | Defuzzifier::Bisector
            | Defuzzifier::SmallestOfMaxima
            | Defuzzifier::MeanOfMaxima
            | Defuzzifier::LargestOfMaxima
            | Defuzzifier::Tsukamoto => {}
        }
        if output.is_discrete() {
            let points = terms.iter().enumerate().filter_map(|(index, term)| {
                Some(Singleton {
                    at: term.membership_function.at()?,
                    term: index,
                    lower_height: term.lower.as_ref().map_or(term.height, |it| it.height),
                    upper_height: term.height,
                })
            });
            let mut points: Vec<Singleton> = points.collect();
            points.sort_by(|a, b| a.at.total_cmp(&b.at).then(a.term.cmp(&b.term)));
            return Reduction::Singletons(points, operators);
        }
        let (low, high) = (output.variable.low, output.variable.high);
        let curves = |bound: Bound| {
            let terms: Vec<Term> = terms.iter().map(|term| term.only(bound)).collect();
            Curves::new(&terms, low, high)
        };
        let set = Set {
            low,
            high,
            operators,
            lower: curves(Bound::Lower),
            upper: curves(Bound::Upper),
        };
        Reduction::Set(Box::new(set))
    }

    /// Returns the maximum number of cuts of an evaluation, in addition to a fixed number per firing strength.
    pub(crate) fn cuts(&self) -> usize {
        match self {
            Reduction::Set(set) => set.lower.workspace().max(set.upper.workspace()),
            Reduction::Singletons(..) | Reduction::Average | Reduction::Sum => 0,
        }
    }

    /// Returns the ends of the interval; `None` if no rule fires or the ends are not finite. `number` returns the number
    /// of a term of a Takagi-Sugeno output. `points` is memory for one element per term.
    pub(crate) fn interval(
        &self,
        method: TypeReduction,
        lower: Strengths<'_>,
        upper: Strengths<'_>,
        number: impl Fn(usize) -> f64,
        workspace: &mut Workspace,
        points: &mut Vec<WeightedNumber>,
    ) -> Option<(f64, f64)> {
        points.clear();
        let (left, right) = match self {
            Reduction::Set(set) if method == TypeReduction::Exact => {
                set.interval(lower, upper, workspace)?
            }
            Reduction::Set(set) => {
                let summary = set.summary(lower, upper, workspace, &mut |_, _| {})?;
                closed(method, summary)?
            }
            Reduction::Singletons(singletons, operators) => {
                points.extend(singletons.chunk_by(|a, b| a.at == b.at).filter_map(|same| {
                    let degree = |strengths: Strengths<'_>, height: fn(&Singleton) -> f64| {
                        let of = |one| strengths.of(one).iter().filter(|h| **h > 0.0);
                        let parts = same.iter().flat_map(|one| {
                            of(one.term).map(|h| operators.implication.of(*h, height(one)))
                        });
                        parts.fold(0.0, |all, part| operators.aggregation.of(all, part))
                    };
                    Some(WeightedNumber {
                        at: same.first()?.at,
                        lower: degree(lower, |one| one.lower_height),
                        upper: degree(upper, |one| one.upper_height),
                    })
                }));
                ends_of(method, points)?
            }
            Reduction::Average | Reduction::Sum => {
                let total = |all: &[f64]| all.iter().sum::<f64>();
                let terms = 0..upper.offsets.len().saturating_sub(1);
                let terms = terms.filter(|term| total(upper.of(*term)) > 0.0);
                points.extend(terms.map(|term| WeightedNumber {
                    at: number(term),
                    lower: total(lower.of(term)),
                    upper: total(upper.of(term)),
                }));
                match self {
                    Reduction::Sum => sum(points)?,
                    _ => ends_of(method, points)?,
                }
            }
        };
        (left.is_finite() && right.is_finite()).then_some((left, right))
    }
}

impl Set {
    /// Returns the areas and centroids of both sets; `None` if the upper one is empty. Calls `visit` for the pieces of the
    /// upper set, and then for those of the lower one.
    fn summary(
        &self,
        lower: Strengths<'_>,
        upper: Strengths<'_>,
        workspace: &mut Workspace,
        visit: &mut dyn FnMut(Bound, &Piece<'_>),
    ) -> Option<Summary> {
        let Set { low, high, .. } = *self;
        let mut whole = [Integrals::about(low + 0.5 * (high - low), unit(high - low)); 2];
        let mut support = (high, low);
        self.upper
            .pieces(upper, self.operators, workspace, &mut |piece| {
                whole[1].add(piece);
                visit(Bound::Upper, piece);
                if has_area(piece) {
                    support = (smaller(support.0, piece.from), piece.to);
                }
            });
        self.lower
            .pieces(lower, self.operators, workspace, &mut |piece| {
                whole[0].add(piece);
                visit(Bound::Lower, piece);
            });
        let of_lower = whole[0].centroid();
        Some(Summary {
            lower: of_lower.map(|centroid| (whole[0].area, centroid)),
            upper: (whole[1].area, whole[1].centroid()?),
            support,
        })
    }

    pub(super) fn interval(
        &self,
        lower: Strengths<'_>,
        upper: Strengths<'_>,
        workspace: &mut Workspace,
    ) -> Option<(f64, f64)> {
        // The pieces do not depend on the position of the search. Straight ones are computed once.
        let mut lines = core::mem::take(&mut workspace.lines);
        lines.clear();
        let (mut of_upper, mut are_kept) = (0, true);
        let summary = self.summary(lower, upper, workspace, &mut |bound, piece| {
            are_kept &= piece.curve.is_none() && lines.len() < lines.capacity();
            if are_kept {
                lines.push([piece.from, piece.to, piece.left, piece.right]);
                of_upper += usize::from(bound == Bound::Upper);
            }
        });
        let kept = are_kept.then(|| lines.split_at(of_upper));
        let ends = summary.map(|summary| match summary.lower {
            None => summary.support,
            Some(_) => self.search(summary, (lower, upper), kept, workspace),
        });
        workspace.lines = lines;
        ends
    }

    /// Searches for both ends. `kept` contains the pieces of the upper and of the lower set if all are straight.
    fn search(
        &self,
        summary: Summary,
        (lower, upper): (Strengths<'_>, Strengths<'_>),
        kept: Option<(&[Line], &[Line])>,
        workspace: &mut Workspace,
    ) -> (f64, f64) {
        let range = (self.low, self.high);
        let unit = unit(self.high - self.low);
        let mut sums = |end: IntervalEnd, x: f64| {
            let mut sums = Integrals::about(x, unit);
            let below = (f64::NEG_INFINITY, x);
            let above = (x, f64::INFINITY);
            let (of_upper, of_lower) = match end {
                IntervalEnd::Left => (below, above),
                IntervalEnd::Right => (above, below),
            };
            if let Some((upper, lower)) = kept {
                for (lines, part) in [(upper, of_upper), (lower, of_lower)] {
                    for [from, to, left, right] in lines {
                        let piece = Piece {
                            from: *from,
                            to: *to,
                            left: *left,
                            right: *right,
                            curve: None,
                        };
                        sums.add_between(&piece, part);
                    }
                }
                return (sums.area, sums.moment);
            }
            self.upper
                .pieces(upper, self.operators, workspace, &mut |piece| {
                    sums.add_between(piece, of_upper);
                });
            self.lower
                .pieces(lower, self.operators, workspace, &mut |piece| {
                    sums.add_between(piece, of_lower);
                });
            (sums.area, sums.moment)
        };
        let start = summary.upper.1;
        let left = search(IntervalEnd::Left, start, range, |x| {
            sums(IntervalEnd::Left, x)
        });
        let right = search(IntervalEnd::Right, start, range, |x| {
            sums(IntervalEnd::Right, x)
        });
        (left, right)
    }
}

pub(super) fn has_area(piece: &Piece<'_>) -> bool {
    let inside = |curve: super::piece::Curve<'_>| (curve.degree)(0.5) > 0.0;
    piece.left > 0.0 || piece.right > 0.0 || piece.curve.is_some_and(inside)
}

/// Returns the interval of weighted numbers by a method of type reduction.
fn ends_of(method: TypeReduction, points: &[WeightedNumber]) -> Option<(f64, f64)> {
    if method == TypeReduction::Exact {
        return average(points);
    }
    let mut positive = points.iter().filter(|point| point.upper > 0.0);
    let origin = positive.next()?.at;
    let sums = |weight: fn(&WeightedNumber) -> f64| {
        let (mut total, mut moment) = (0.0, 0.0);
        for point in points {
            total += weight(point);
            moment += weight(point) * (point.at - origin);
        }
        (total > 0.0).then(|| (total, origin + moment / total))
    };
    let support = points.iter().filter(|point| point.upper > 0.0);
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

/// Returns the interval of `sum(w x) / sum(w)` over all weights between their bounds; `None` if all are 0.
pub(super) fn average(points: &[WeightedNumber]) -> Option<(f64, f64)> {
    let mut positive = points.iter().filter(|point| point.upper > 0.0);
    let first = positive.next()?.at;
    let (low, high) = positive.fold((first, first), |(low, high), point| {
        (smaller(low, point.at), larger(high, point.at))
    });
    if points.iter().all(|point| point.lower <= 0.0) {
        return Some((low, high));
    }
    let sums = |end: IntervalEnd, x: f64| {
        let (mut total, mut moment) = (0.0, 0.0);
        for point in points {
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
    let (range, start) = ((low, high), low + 0.5 * (high - low));
    let left = search(IntervalEnd::Left, start, range, |x| {
        sums(IntervalEnd::Left, x)
    });
    let right = search(IntervalEnd::Right, start, range, |x| {
        sums(IntervalEnd::Right, x)
    });
    Some((left, right))
}

/// Returns the interval of `sum(w x)` over all weights between their bounds; `None` if all are 0.
pub(super) fn sum(points: &[WeightedNumber]) -> Option<(f64, f64)> {
    let (mut low, mut high) = (0.0, 0.0);
    for point in points {
        let (one, other) = (point.lower * point.at, point.upper * point.at);
        low += smaller(one, other);
        high += larger(one, other);
    }
    (!points.is_empty()).then_some((low, high))
}

/// Returns an end of the interval by Newton's method. `sums` returns the area and the moment about x of the set that is
/// the upper one on the side of the end, and the lower one on the other side of x.
fn search(
    end: IntervalEnd,
    start: f64,
    (low, high): (f64, f64),
    mut sums: impl FnMut(f64) -> (f64, f64),
) -> f64 {
    let mut x = start;
    for step in 0..MAX_STEPS {
        let (area, moment) = sums(x);
        let next = larger(low, smaller(high, x + moment / area));
        // The first step may come from the wrong side; all later ones approach the root from inside the interval, up to
        // rounding.
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

    fn points(all: &[(f64, f64, f64)]) -> Vec<WeightedNumber> {
        let points = all
            .iter()
            .map(|&(at, lower, upper)| WeightedNumber { at, lower, upper });
        points.collect()
    }

    #[test]
    fn averages_by_hand() {
        // The weights of 0 and 10 lie in [1, 3]: 1 * 10 / 4 and 3 * 10 / 4.
        let two = points(&[(10.0, 1.0, 3.0), (0.0, 1.0, 3.0)]);
        assert_eq!(average(&two), Some((2.5, 7.5)));
        // Equal bounds give a number.
        let crisp = points(&[(4.0, 0.5, 0.5), (8.0, 0.5, 0.5)]);
        assert_eq!(average(&crisp), Some((6.0, 6.0)));
        // If all lower bounds are 0, the average can be any value from the smallest to the largest number whose upper
        // bound is above 0.
        let open = points(&[(4.0, 0.0, 0.5), (8.0, 0.0, 0.1), (9.0, 0.0, 0.0)]);
        assert_eq!(average(&open), Some((4.0, 8.0)));
        assert_eq!(average(&points(&[(4.0, 0.0, 0.0)])), None);
    }

    /// Returns the uncertainty bounds of the left end, first the lower and then the upper one, as printed by Wu and
    /// Mendel. The rules must be in ascending order.
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
            let (low, high) = average(&all).unwrap();
            let left = wu_mendel_left(&all);
            let right = wu_mendel_left(&mirrored);
            assert!(left.0 <= low + 1e-12 && low <= left.1 + 1e-12);
            assert!(-right.1 <= high + 1e-12 && high <= -right.0 + 1e-12);
            let (wu_low, wu_high) = ends_of(TypeReduction::WuMendel, &all).unwrap();
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
                let (value, same) = ends_of(method, &all).unwrap();
                assert!(value == same && (value - expected).abs() < 1e-12);
                assert!((low - 1e-12..=high + 1e-12).contains(&value));
            }
        }
    }

    #[test]
    fn sums_by_hand() {
        let two = points(&[(10.0, 0.25, 0.5), (-4.0, 0.0, 1.0)]);
        assert_eq!(sum(&two), Some((2.5 - 4.0, 5.0)));
        assert_eq!(sum(&[]), None);
    }

    #[test]
    fn an_almost_empty_lower_set_ends_near_the_support() {
        for tiny in [1e-6, 1e-12, 1e-100, 1e-300] {
            // The root of c^3 / 6 - tiny c = tiny / 2 (1 - c)^2 is close to that of c^3 = 3 tiny.
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
