//! The integrator, which supports any terms and operators. The aggregated set is split where membership functions are
//! not smooth or have an extremum, where they reach the level of a plateau, and where they cross. Between these cuts,
//! straight pieces are integrated by a formula and curved pieces by Gauss-Legendre quadrature.

use alloc::vec::Vec;

use super::calculus::{SlopedDegree, Smooth, activate, aggregate, between_levels, keeps_lines};
use super::maxima::{EQUAL, monotone};
use super::piece::{Curve, Piece};
use super::prepared::{corners, limits};
use super::workspace::{STEPS_OF_A_CURVE, Workspace};
use super::{ConsequentOperators, Strengths};
use crate::model::{Aggregation, Implication, MembershipFunction, Term};

mod kinks;

/// The number of evenly spaced cuts for a formula, which may have a kink anywhere. Details that are narrower than
/// the distance between cuts may be missed.
const EVENLY: u32 = 256;

/// The maximum number of mutually crossing terms for which memory is reserved.
const MAX_CROSSING: usize = 64;

/// The terms of one output, with the cuts of its range.
#[derive(Debug, Clone)]
pub(crate) struct Curves {
    terms: Vec<Term>,
    /// The cuts in ascending order, each with the term it belongs to; the ends of the range belong to no term.
    cuts: Vec<(f64, Option<usize>)>,
    /// The maximum degree of each term within the range.
    highest: Vec<f64>,
    /// The corners of each straight term.
    corners: Vec<Option<Vec<(f64, f64)>>>,
    /// Whether a term is a formula, whose kinks are unknown.
    has_formula: bool,
}

/// A term on an interval between two cuts.
#[derive(Debug, Clone, Copy)]
pub(super) struct Run {
    term: usize,
    /// The line; `None` if the term is curved.
    line: Option<Line>,
}

/// A term activated at a firing strength, on an interval.
#[derive(Debug, Clone, Copy)]
pub(super) struct ActivatedTerm {
    term: usize,
    strength: f64,
    implication: Implication,
    /// The line, if the activated term is known to be straight on the whole interval.
    line: Option<Line>,
}

/// A straight line over an interval, defined by its degrees just inside the ends.
#[derive(Debug, Clone, Copy)]
struct Line {
    from: f64,
    to: f64,
    left: f64,
    right: f64,
}

impl Line {
    fn at(&self, x: f64) -> f64 {
        if x <= self.from {
            self.left
        } else if x >= self.to {
            self.right
        } else {
            self.left + (self.right - self.left) * ((x - self.from) / (self.to - self.from))
        }
    }

    fn is_level(&self) -> bool {
        self.left == self.right
    }
}

impl Curves {
    pub(crate) fn new(terms: &[Term], low: f64, high: f64) -> Self {
        let mut cuts = Vec::from([(low, None), (high, None)]);
        let mut highest = Vec::new();
        for (index, term) in terms.iter().enumerate() {
            let evenly = if is_formula(term) { EVENLY } else { 0 };
            let even = (1..evenly).map(|i| low + (high - low) * (f64::from(i) / f64::from(evenly)));
            let own = monotone(&term.membership_function, low, high);
            let inside = own.iter().flat_map(|x| [x.next_down(), *x, x.next_up()]);
            let inside = inside.filter(|x| low <= *x && *x <= high);
            let most = inside.fold(0.0, |most: f64, x| most.max(term.membership(x)));
            highest.push(most);
            for x in own.into_iter().chain(even) {
                if low < x && x < high {
                    cuts.push((x, Some(index)));
                }
            }
        }
        cuts.sort_by(|a, b| a.0.total_cmp(&b.0));
        Curves {
            terms: terms.to_vec(),
            cuts,
            highest,
            corners: terms.iter().map(corners).collect(),
            has_formula: terms.iter().any(is_formula),
        }
    }

    /// Returns the maximum number of cuts that an evaluation adds between two cuts, not counting a fixed number per
    /// firing strength.
    pub(crate) fn workspace(&self) -> usize {
        let crossing = self.terms.len().min(MAX_CROSSING);
        4 * crossing * crossing
    }

    /// Returns whether all terms are 0 on the whole range.
    pub(crate) fn is_empty(&self) -> bool {
        let inside = |x: f64| self.terms.iter().any(|term| term.membership(x) > 0.0);
        let mut intervals = self.cuts.iter().zip(self.cuts.iter().skip(1));
        intervals.all(|((a, _), (b, _))| !inside(*a) && !inside(0.5 * (a + b)) && !inside(*b))
    }

    /// Returns the degree of the aggregated set at `x`.
    pub(crate) fn degree(
        &self,
        strengths: Strengths<'_>,
        operators: ConsequentOperators,
        x: f64,
    ) -> f64 {
        let mut degree = 0.0;
        for (index, term) in self.terms.iter().enumerate() {
            let mut membership = None;
            for &strength in strengths.of(index) {
                if strength > 0.0 {
                    let membership = *membership.get_or_insert_with(|| term.membership(x));
                    let cut = operators.implication.of(strength, membership);
                    degree = operators.aggregation.of(degree, cut);
                }
            }
        }
        degree
    }

    /// Calls `visit` for each piece of the aggregated set, from left to right.
    pub(crate) fn pieces(
        &self,
        strengths: Strengths<'_>,
        operators: ConsequentOperators,
        workspace: &mut Workspace,
        visit: &mut dyn FnMut(&Piece<'_>),
    ) {
        let is_active = |term: usize| strengths.of(term).iter().any(|h| *h > 0.0);
        let mut cuts = self.cuts.iter();
        let mut from = cuts.next().map_or(0.0, |cut| cut.0);
        for &(to, term) in cuts {
            if to > from && term.is_none_or(is_active) {
                self.stretch(strengths, operators, (from, to), workspace, visit);
                from = to;
            }
        }
    }

    /// Visits the pieces on an interval that contains no cut of an active term.
    fn stretch(
        &self,
        strengths: Strengths<'_>,
        operators: ConsequentOperators,
        (from, to): (f64, f64),
        workspace: &mut Workspace,
        visit: &mut dyn FnMut(&Piece<'_>),
    ) {
        self.runs(strengths, (from, to), &mut workspace.runs);
        let all_known = self.kinks(strengths, operators, (from, to), workspace);
        let Workspace {
            cuts,
            runs,
            parts,
            steps,
            ..
        } = workspace;
        let smooth = Smooth::of(operators.aggregation);
        let has_steps = all_known && smooth.has_steps;
        // No piece extends across a step of the aggregation, so the aggregation without steps gives the same degrees.
        // Pieces whose degree is 1 because of a step are visited separately.
        let aggregation = match has_steps {
            true => smooth.aggregation,
            false => operators.aggregation,
        };
        for (&from, &to) in cuts.iter().zip(cuts.iter().skip(1)) {
            let width = to - from;
            if width <= 0.0 {
                continue;
            }
            self.parts(
                strengths,
                operators.implication,
                (from, to),
                all_known,
                (runs, parts),
            );
            if !steps.take(strengths.strengths.len() + parts.len() * STEPS_OF_A_CURVE) {
                return;
            }
            let is_level = |part: &ActivatedTerm| part.line.is_some_and(|line| line.is_level());
            let are_level = parts.iter().all(is_level);
            if are_level || has_steps {
                let degree = self.joined(parts, operators.aggregation, from + 0.5 * width);
                if are_level || degree == 1.0 {
                    visit(&Piece {
                        from,
                        to,
                        left: degree,
                        right: degree,
                        curve: None,
                    });
                    continue;
                }
            }
            let is_straight = parts.iter().all(|part| part.line.is_some())
                && (smooth.keeps_lines || parts.len() == 1);
            let at = |part: f64| from + width * part;
            // Positions are taken just inside the piece, so that a step at a cut has no effect.
            let inside = |x: f64| x.max(from.next_up()).min(to.next_down());
            let curve = Curve {
                degree: &|part| self.joined(parts, aggregation, at(part)),
                slope: &|part| self.slope(parts, aggregation, inside(at(part)), width),
            };
            visit(&Piece {
                from,
                to,
                left: self.joined_at(parts, aggregation, from, inside(from)),
                right: self.joined_at(parts, aggregation, to, inside(to)),
                curve: (!is_straight).then_some(curve),
            });
        }
    }

    /// Fills `runs` with the active terms on an interval between two cuts, except straight terms that are 0 there.
    fn runs(&self, strengths: Strengths<'_>, (from, to): (f64, f64), runs: &mut Vec<Run>) {
        runs.clear();
        for (term, corners) in self.corners.iter().enumerate() {
            if strengths.of(term).iter().all(|h| *h <= 0.0) {
                continue;
            }
            let line = corners.as_ref().map(|corners| {
                let (left, right) = limits(corners, from, to);
                Line {
                    from,
                    to,
                    left,
                    right,
                }
            });
            if line.is_none_or(|line| line.left > 0.0 || line.right > 0.0) {
                runs.push(Run { term, line });
            }
        }
    }

    /// Fills `parts` with the activated terms that are not 0 on the interval `[from, to]`. This interval must be inside
    /// the one for which `runs` was filled. If the kinks of all terms are known, each activated term
    /// has the same form on the whole interval.
    fn parts(
        &self,
        strengths: Strengths<'_>,
        implication: Implication,
        (from, to): (f64, f64),
        all_known: bool,
        (runs, parts): (&[Run], &mut Vec<ActivatedTerm>),
    ) {
        parts.clear();
        for run in runs {
            for &strength in strengths.of(run.term).iter().filter(|h| **h > 0.0) {
                let part = ActivatedTerm {
                    term: run.term,
                    strength,
                    implication,
                    line: None,
                };
                if all_known {
                    parts.extend(self.on_piece(part, run, (from, to)));
                } else {
                    parts.push(part);
                }
            }
        }
    }

    /// Returns an activated term on a piece where its implication has neither a kink nor a step; `None` where it is 0.
    fn on_piece(
        &self,
        part: ActivatedTerm,
        run: &Run,
        (from, to): (f64, f64),
    ) -> Option<ActivatedTerm> {
        let ends = run.line.map(|line| (line.at(from), line.at(to)));
        let membership = match ends {
            Some((left, right)) => SlopedDegree {
                degree: 0.5 * (left + right),
                slope: right - left,
            },
            None => {
                let width = to - from;
                sloped(self.terms.get(part.term)?, from + 0.5 * width, width)
            }
        };
        let mut here = activate(part.implication, part.strength, membership);
        if here.degree <= 0.0 {
            return None;
        }
        let mut part = part;
        part.implication = between_levels(part.implication);
        if part.implication == Implication::Minimum && !self.cuts_off(part.term, part.strength) {
            (part.strength, here) = (1.0, membership);
        }
        let degrees = match ends {
            _ if here.slope == 0.0 => Some((here.degree, here.degree)),
            Some((left, right)) if keeps_lines(part.implication) => {
                let activated = |degree: f64| part.implication.of(part.strength, degree);
                Some((activated(left), activated(right)))
            }
            Some(_) | None => None,
        };
        part.line = degrees.map(|(left, right)| Line {
            from,
            to,
            left,
            right,
        });
        Some(part)
    }

    /// Returns the degree of the aggregated set of parts.
    fn joined(&self, parts: &[ActivatedTerm], aggregation: Aggregation, x: f64) -> f64 {
        self.joined_at(parts, aggregation, x, x)
    }

    /// Returns the degree at the end `x` of a piece. Lines are evaluated at `x`, curves at `inside`, a position just
    /// inside the piece.
    fn joined_at(
        &self,
        parts: &[ActivatedTerm],
        aggregation: Aggregation,
        x: f64,
        inside: f64,
    ) -> f64 {
        let (mut degree, mut known) = (0.0, None);
        for part in parts {
            let activated = match part.line {
                Some(line) => line.at(x),
                None => {
                    let membership = match known {
                        Some((term, membership)) if term == part.term => membership,
                        Some(_) | None => self.membership(part.term, inside),
                    };
                    known = Some((part.term, membership));
                    part.implication.of(part.strength, membership)
                }
            };
            degree = aggregation.of(degree, activated);
        }
        degree
    }

    /// Returns the slope of the aggregated set of parts; `width` is the width of the piece.
    fn slope(&self, parts: &[ActivatedTerm], aggregation: Aggregation, x: f64, width: f64) -> f64 {
        let mut set = SlopedDegree::default();
        for part in parts {
            let activated = match (part.line, self.terms.get(part.term)) {
                (Some(line), _) => SlopedDegree {
                    degree: line.at(x),
                    slope: (line.right - line.left) / (line.to - line.from),
                },
                (None, Some(term)) => {
                    activate(part.implication, part.strength, sloped(term, x, width))
                }
                (None, None) => SlopedDegree::default(),
            };
            set = aggregate(aggregation, set, activated);
        }
        set.slope
    }

    fn membership(&self, term: usize, x: f64) -> f64 {
        self.terms.get(term).map_or(0.0, |term| term.membership(x))
    }

    /// Returns whether the minimum with `strength` cuts a term off. A strength that equals the maximum degree of
    /// the term up to rounding does not cut it off.
    fn cuts_off(&self, term: usize, strength: f64) -> bool {
        let highest = self.highest.get(term);
        self.has_formula || highest.is_none_or(|highest| strength < highest * (1.0 - EQUAL))
    }
}

pub(super) fn is_formula(term: &Term) -> bool {
    matches!(
        term.membership_function,
        MembershipFunction::Function { .. }
    )
}

/// Returns the membership of a term at `x` with its slope; `width` is the width of the piece.
fn sloped(term: &Term, x: f64, width: f64) -> SlopedDegree {
    SlopedDegree {
        degree: term.membership(x),
        slope: term.height * term.membership_function.slope(x, width),
    }
}
