//! Intervals that contain the value of an output for all firing strengths between two bounds, for every
//! defuzzifier.
//!
//! For the centroid and the weighted outputs, these are the intervals of the type reduction. For the other
//! defuzzifiers, the intervals follow from the same two sets: for any firing strengths between the bounds, the
//! aggregated set is nowhere below the lower set and nowhere above the upper set.

use alloc::vec::Vec;

use super::piece::{Integrals, Piece, unit};
use super::reduction::{Reduction, Set, has_area};
use super::workspace::Workspace;
use super::{ConsequentOperators, Strengths};
use crate::model::{Defuzzifier, Output, Term, TypeReduction};
use crate::table::{
    finite,
    operators::{larger, smaller},
    reduction::{WeightedNumber, average, sum},
};

/// The number of halvings in the search for a bisector.
const HALVINGS: usize = 60;

/// The relative difference up to which degrees count as equally high. It is larger than the constant of the same name
/// in `maxima`.
const EQUAL: f64 = 1e-9;

/// The method that computes an enclosure of the values of an output.
#[derive(Debug, Clone)]
pub(crate) struct EnclosureMethod {
    method: Method,
    /// Whether the lower bounds are ignored, so that an end may be anywhere in the support. This is necessary if the
    /// type reduction only approximates the interval.
    is_wide: bool,
    low: f64,
    high: f64,
}

#[derive(Debug, Clone)]
enum Method {
    /// The interval of the type reduction.
    Reduced(Reduction),
    /// The interval of a weighted average, or of a sum.
    Weighted {
        is_sum: bool,
    },
    Bisector(Set),
    Maxima(Set),
    /// The interval from the first to the last value with a degree above 0.
    Support(Reduction),
    Tsukamoto(Vec<Term>),
}

/// An interval of values. `is_certain` is true if all firing strengths between the bounds give a value.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct ValueEnclosure {
    pub(crate) low: f64,
    pub(crate) high: f64,
    pub(crate) is_certain: bool,
}

impl EnclosureMethod {
    /// Creates the method for an output of a valid model.
    pub(crate) fn new(output: &Output, operators: ConsequentOperators) -> Self {
        let reduction = Reduction::new(output, operators);
        let method = match (output.defuzzifier, reduction) {
            (Defuzzifier::Tsukamoto, _) => Method::Tsukamoto(output.variable.terms.clone()),
            (defuzzifier, None) => Method::Weighted {
                is_sum: defuzzifier == Defuzzifier::WeightedSum,
            },
            (_, Some(reduction)) if output.samples.is_some() => Method::Support(reduction),
            (Defuzzifier::Bisector, Some(Reduction::Set(set))) => Method::Bisector(*set),
            (
                Defuzzifier::SmallestOfMaxima
                | Defuzzifier::MeanOfMaxima
                | Defuzzifier::LargestOfMaxima,
                Some(Reduction::Set(set)),
            ) => Method::Maxima(*set),
            (Defuzzifier::Centroid, Some(reduction)) => Method::Reduced(reduction),
            (_, Some(reduction)) => Method::Support(reduction),
        };
        EnclosureMethod {
            method,
            is_wide: output.type_reduction == TypeReduction::WuMendel,
            low: output.variable.low,
            high: output.variable.high,
        }
    }

    /// Returns the maximum number of cuts of an evaluation, not counting a fixed number per firing strength.
    pub(crate) fn cuts(&self) -> usize {
        match &self.method {
            Method::Reduced(reduction) | Method::Support(reduction) => reduction.cuts(),
            Method::Bisector(set) | Method::Maxima(set) => set.cuts(),
            Method::Weighted { .. } | Method::Tsukamoto(_) => 0,
        }
    }

    /// Returns an interval that contains the values for all firing strengths between `lower` and `upper`; `None` if no
    /// rule fires. `number` returns the bounds of the number that a term of a Takagi-Sugeno output yields.
    pub(crate) fn interval(
        &self,
        lower: Strengths<'_>,
        upper: Strengths<'_>,
        number: impl Fn(usize) -> (f64, f64),
        workspace: &mut Workspace,
    ) -> Option<ValueEnclosure> {
        let found = |(low, high): (f64, f64), is_certain: bool| ValueEnclosure {
            low,
            high,
            is_certain,
        };
        let fires = |lower: Strengths<'_>| lower.strengths.iter().any(|strength| *strength > 0.0);
        let least = match self.method {
            Method::Support(_) => EMPTY,
            _ if self.is_wide => EMPTY,
            _ => lower,
        };
        match &self.method {
            Method::Weighted { is_sum } => {
                let terms = 0..upper.offsets.len().saturating_sub(1);
                let mut numbers = Vec::new();
                for term in terms {
                    let total = |all: &[f64]| all.iter().sum::<f64>();
                    let weights = (total(least.of(term)), total(upper.of(term)));
                    if weights.1 > 0.0 {
                        numbers.push((number(term), weights));
                    }
                }
                let ends = weighted(&numbers, *is_sum)?;
                Some(found(ends, fires(lower)))
            }
            Method::Reduced(reduction) | Method::Support(reduction) => {
                let ends = reduction.interval(TypeReduction::Exact, least, upper, workspace)?;
                if !(ends.0.is_finite() && ends.1.is_finite()) {
                    return None;
                }
                let is_certain = match (&self.method, reduction) {
                    // All samples may miss the set, which then has no value.
                    (Method::Support(_), Reduction::Set(_)) => false,
                    (_, Reduction::Set(set)) => set.lower_area(lower, workspace) > 0.0,
                    _ => fires(lower),
                };
                Some(found(ends, is_certain))
            }
            Method::Bisector(set) => {
                let support = set.interval(EMPTY, upper, workspace)?;
                let is_certain = set.lower_area(lower, workspace) > 0.0;
                if !is_certain {
                    return Some(found(support, false));
                }
                let low = set.bisector(true, support, (lower, upper), workspace);
                let high = set.bisector(false, support, (lower, upper), workspace);
                Some(found((low, high), true))
            }
            Method::Maxima(set) => {
                let is_certain = set.lower_area(lower, workspace) > 0.0;
                Some(found(set.maxima((lower, upper), workspace)?, is_certain))
            }
            Method::Tsukamoto(terms) => {
                let mut numbers = Vec::new();
                for (index, term) in terms.iter().enumerate() {
                    let place = |strength: f64| {
                        let part = smaller(1.0, strength / term.height);
                        finite(term.membership_function.inverse(part), self.low, self.high)
                    };
                    for (&lower, &upper) in lower.of(index).iter().zip(upper.of(index)) {
                        if upper > 0.0 {
                            let ends = (place(lower), place(upper));
                            let ends = (smaller(ends.0, ends.1), larger(ends.0, ends.1));
                            numbers.push((ends, (lower, upper)));
                        }
                    }
                }
                let is_certain = numbers.iter().any(|(_, (lower, _))| *lower > 0.0);
                Some(found(weighted(&numbers, false)?, is_certain))
            }
        }
    }
}

const EMPTY: Strengths<'static> = Strengths {
    strengths: &[],
    offsets: &[],
};

/// The bounds of a number, and the bounds of its weight.
type Number = ((f64, f64), (f64, f64));

/// Returns the bounds of the weighted averages or sums of numbers. Neither bound decreases when a number increases.
fn weighted(numbers: &[Number], is_sum: bool) -> Option<(f64, f64)> {
    let ends = |at: fn(&(f64, f64)) -> f64| {
        let points = numbers.iter().map(|(ends, (lower, upper))| WeightedNumber {
            at: at(ends),
            lower: *lower,
            upper: *upper,
        });
        match is_sum {
            true => sum(points),
            false => average(points),
        }
    };
    let are_finite = |at: fn(&(f64, f64)) -> f64| numbers.iter().all(|(z, _)| at(z).is_finite());
    // The search for an end needs finite numbers.
    let low = match are_finite(|z| z.0) {
        true => ends(|z| z.0)?.0,
        false => f64::NEG_INFINITY,
    };
    let high = match are_finite(|z| z.1) {
        true => ends(|z| z.1)?.1,
        false => f64::INFINITY,
    };
    (!numbers.is_empty()).then_some((low, high))
}

impl Set {
    fn cuts(&self) -> usize {
        self.lower.workspace().max(self.upper.workspace())
    }

    fn lower_area(&self, lower: Strengths<'_>, workspace: &mut Workspace) -> f64 {
        let mut whole = Integrals::about(self.low, unit(self.high - self.low));
        self.lower
            .pieces(lower, self.operators, workspace, &mut |piece| {
                whole.add(piece)
            });
        whole.area
    }

    /// Returns the first or the last bisector of all sets between the lower and the upper one. At the first bisector x,
    /// the area of the upper set left of x equals the area of the lower set right of x.
    fn bisector(
        &self,
        is_first: bool,
        (mut from, mut to): (f64, f64),
        (lower, upper): (Strengths<'_>, Strengths<'_>),
        workspace: &mut Workspace,
    ) -> f64 {
        let unit = unit(self.high - self.low);
        for _ in 0..HALVINGS {
            let x = from + 0.5 * (to - from);
            let below = (f64::NEG_INFINITY, x);
            let above = (x, f64::INFINITY);
            let mut left = Integrals::about(x, unit);
            let mut right = Integrals::about(x, unit);
            let (of_upper, of_lower) = match is_first {
                true => (below, above),
                false => (above, below),
            };
            let (upper_part, lower_part) = match is_first {
                true => (&mut left, &mut right),
                false => (&mut right, &mut left),
            };
            self.upper
                .pieces(upper, self.operators, workspace, &mut |piece| {
                    upper_part.add_between(piece, of_upper);
                });
            self.lower
                .pieces(lower, self.operators, workspace, &mut |piece| {
                    lower_part.add_between(piece, of_lower);
                });
            // If the left area is larger, the bisector is left of x.
            if left.area > right.area {
                to = x;
            } else {
                from = x;
            }
        }
        if is_first { from } else { to }
    }

    /// Returns the first and the last value at which a set between the lower and the upper one may be highest.
    fn maxima(
        &self,
        (lower, upper): (Strengths<'_>, Strengths<'_>),
        workspace: &mut Workspace,
    ) -> Option<(f64, f64)> {
        let mut level = 0.0;
        self.lower
            .pieces(lower, self.operators, workspace, &mut |piece| {
                level = larger(level, larger(piece.left, piece.right));
            });
        let level = level * (1.0 - EQUAL);
        let mut ends: Option<(f64, f64)> = None;
        self.upper
            .pieces(upper, self.operators, workspace, &mut |piece: &Piece<
                '_,
            >| {
                // The highest degree of a curve is not known, so every curve counts as high.
                let is_high = piece.curve.is_some() || larger(piece.left, piece.right) >= level;
                if has_area(piece) && is_high {
                    // The part of a line that is high enough.
                    let (left, right) = (piece.left, piece.right);
                    let at = |degree: f64| {
                        let part = (degree - left) / (right - left);
                        piece.from + smaller(1.0, larger(0.0, part)) * (piece.to - piece.from)
                    };
                    let (mut from, mut to) = (piece.from, piece.to);
                    if piece.curve.is_none() && left < level {
                        from = at(level);
                    }
                    if piece.curve.is_none() && right < level {
                        to = at(level);
                    }
                    let (low, high) = ends.unwrap_or((from, to));
                    ends = Some((smaller(low, from), larger(high, to)));
                }
            });
        ends
    }
}
