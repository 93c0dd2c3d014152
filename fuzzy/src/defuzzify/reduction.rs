//! Type reduction: the interval of the centroids of all sets between a lower and an upper aggregated set.
//!
//! The left end of the interval of a set between `lower(x)` and `upper(x)` is the smallest centroid. It is
//! reached by the set that is as high as possible left of its own centroid and as low as possible right of it.
//! So the left end is the root c of
//!
//! ```text
//! F(c) = integral of (c - x) upper(x) over x < c  +  integral of (c - x) lower(x) over x > c
//! ```
//!
//! F is convex and never decreases, since its derivative is the area of the upper set left of c plus the area of
//! the lower set right of c. Between the kinks of straight sets it is a cubic. Newton's method with the exact
//! integrals of the pieces therefore approaches the root from one side, without samples, and converges to the last
//! digit. The right end is the mirror image of the left end. The search is in `table/reduction.rs`, together with
//! the same search for weighted numbers.
//!
//! If the lower set is empty, a narrow set anywhere inside the upper set is possible, so the interval is the
//! support of the upper set.

use alloc::{boxed::Box, vec::Vec};

use super::curves::Curves;
use super::piece::{Integrals, Piece, unit};
use super::workspace::Workspace;
use super::{ConsequentOperators, Strengths};
use crate::model::{Defuzzifier, Output, Term, TypeReduction, type2::Bound};
use crate::table::closed_reduction::{Summary, closed};
use crate::table::operators::smaller;
use crate::table::reduction::{WeightedNumber, both_ends, ends_of};

/// The type reduction of an output that is not weighted.
#[derive(Debug, Clone)]
pub(crate) enum Reduction {
    /// The centroid of a fuzzy set.
    Set(Box<Set>),
    /// The centroid of singletons.
    Singletons(Vec<Singleton>, ConsequentOperators),
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

/// A straight piece: its ends, and the degrees there.
type Line = [f64; 4];

impl Reduction {
    /// Creates the type reduction of an output of a valid model; `None` if the output is weighted.
    pub(crate) fn new(output: &Output, operators: ConsequentOperators) -> Option<Self> {
        let terms = &output.variable.terms;
        match output.defuzzifier {
            Defuzzifier::WeightedSum | Defuzzifier::WeightedAverage => return None,
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
            return Some(Reduction::Singletons(points, operators));
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
        Some(Reduction::Set(Box::new(set)))
    }

    /// Returns the maximum number of cuts of an evaluation, not counting a fixed number per firing strength.
    pub(crate) fn cuts(&self) -> usize {
        match self {
            Reduction::Set(set) => set.lower.workspace().max(set.upper.workspace()),
            Reduction::Singletons(..) => 0,
        }
    }

    /// Returns the ends of the interval; `None` if no rule fires.
    pub(crate) fn interval(
        &self,
        method: TypeReduction,
        lower: Strengths<'_>,
        upper: Strengths<'_>,
        workspace: &mut Workspace,
    ) -> Option<(f64, f64)> {
        match self {
            Reduction::Set(set) if method == TypeReduction::Exact => {
                set.interval(lower, upper, workspace)
            }
            Reduction::Set(set) => {
                let summary = set.summary(lower, upper, workspace, &mut |_, _| {})?;
                closed(method, summary)
            }
            Reduction::Singletons(singletons, operators) => {
                let places = singletons.chunk_by(|a, b| a.at == b.at);
                let points = places.filter_map(|same| {
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
                });
                ends_of(method, points)
            }
        }
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
        // The pieces are the same in every step of the search, so straight pieces are computed only once.
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
        both_ends(summary.upper.1, range, |end, x| {
            let mut sums = Integrals::about(x, unit);
            let (of_upper, of_lower) = end.parts(x);
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
        })
    }
}

pub(super) fn has_area(piece: &Piece<'_>) -> bool {
    let inside = |curve: super::piece::Curve<'_>| (curve.degree)(0.5) > 0.0;
    piece.left > 0.0 || piece.right > 0.0 || piece.curve.is_some_and(inside)
}
