//! The aggregated set where a term is curved. It is cut where membership functions are not smooth or turn, where they meet
//! plateaus and where they cross, and integrated between the cuts.

use alloc::vec::Vec;

use super::maxima::{EQUAL, monotone};
use super::piece::{Curve, Piece};
use super::polyline::{STEPS_OF_A_CURVE, Workspace};
use super::sloped::{Sloped, activate, aggregate};
use super::{Joint, Strengths};
use crate::model::{Aggregation, Implication, MembershipFunction, Term};

mod kinks;

/// A formula may have a kink anywhere: it is integrated between so many even cuts. What is narrower may be missed.
const EVENLY: u32 = 256;

/// The terms of one output and the cuts of its range.
#[derive(Debug, Clone)]
pub(crate) struct Curves {
    terms: Vec<Term>,
    /// Cuts and the terms they belong to, in ascending order; the ends of the range belong to no term.
    cuts: Vec<(f64, Option<usize>)>,
    /// The highest degree of each term within the range.
    highest: Vec<f64>,
    /// Whether a term is a formula, whose kinks are not known.
    has_formula: bool,
}

/// A term under a firing strength, on a stretch.
#[derive(Debug, Clone, Copy)]
pub(super) struct Part {
    term: usize,
    strength: f64,
    implication: Implication,
    /// Its degree, where that is the same all over the stretch.
    level: Option<f64>,
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
            has_formula: terms.iter().any(is_formula),
        }
    }

    /// The most cuts of an evaluation.
    pub(crate) fn workspace(&self) -> usize {
        self.cuts.len() + 4 * self.terms.len() * self.terms.len()
    }

    /// Whether a term is 0 all over the range.
    pub(crate) fn is_empty(&self, term: usize) -> bool {
        let Some(shape) = self.terms.get(term) else {
            return true;
        };
        let inside = |x: f64| shape.membership(x) > 0.0;
        let mut intervals = self.cuts.iter().zip(self.cuts.iter().skip(1));
        intervals.all(|((a, _), (b, _))| !inside(*a) && !inside(0.5 * (a + b)) && !inside(*b))
    }

    /// The degree of the aggregated set at `x`.
    pub(crate) fn degree(&self, strengths: Strengths<'_>, joint: Joint, x: f64) -> f64 {
        let mut degree = 0.0;
        for (index, term) in self.terms.iter().enumerate() {
            let mut membership = None;
            for &strength in strengths.of(index) {
                if strength > 0.0 {
                    let membership = *membership.get_or_insert_with(|| term.membership(x));
                    let cut = joint.implication.of(strength, membership);
                    degree = joint.aggregation.of(degree, cut);
                }
            }
        }
        degree
    }

    /// Calls `visit` for each piece of the aggregated set, from left to right.
    pub(crate) fn pieces(
        &self,
        strengths: Strengths<'_>,
        joint: Joint,
        workspace: &mut Workspace,
        visit: &mut dyn FnMut(&Piece<'_>),
    ) {
        let all_known = self.kinks(strengths, joint, workspace);
        let (cuts, parts, steps) = (&workspace.cuts, &mut workspace.parts, &mut workspace.steps);
        for (&from, &to) in cuts.iter().zip(cuts.iter().skip(1)) {
            let width = to - from;
            if width <= 0.0 {
                continue;
            }
            let middle = from + 0.5 * width;
            self.parts(strengths, joint.implication, (from, to), all_known, parts);
            if !steps.take(strengths.strengths.len() + parts.len() * STEPS_OF_A_CURVE) {
                return;
            }
            let degree = self.joined(parts, joint.aggregation, middle);
            let has_step = all_known
                && matches!(
                    joint.aggregation,
                    Aggregation::Drastic | Aggregation::NilpotentMaximum
                );
            if parts.iter().all(|part| part.level.is_some()) || has_step && degree == 1.0 {
                visit(&Piece {
                    from,
                    to,
                    left: degree,
                    right: degree,
                    curve: None,
                });
                continue;
            }
            // The branch of an operator with a step is the same all over the piece.
            let aggregation = match has_step {
                true => Aggregation::Maximum,
                false => joint.aggregation,
            };
            let at = |part: f64| from + width * part;
            // Just inside, past a step at the cut.
            let inside = |x: f64| x.max(from.next_up()).min(to.next_down());
            visit(&Piece {
                from,
                to,
                left: self.joined(parts, aggregation, inside(from)),
                right: self.joined(parts, aggregation, inside(to)),
                curve: Some(Curve {
                    degree: &|part| self.joined(parts, aggregation, at(part)),
                    slope: &|part| self.slope(parts, aggregation, inside(at(part)), width),
                }),
            });
        }
    }

    /// Fills `parts` with the activated terms on a stretch, without those that are 0 there. Where the kinks of all terms are
    /// known, each has one form all over the stretch.
    fn parts(
        &self,
        strengths: Strengths<'_>,
        implication: Implication,
        (from, to): (f64, f64),
        all_known: bool,
        parts: &mut Vec<Part>,
    ) {
        parts.clear();
        for term in 0..self.terms.len() {
            for &strength in strengths.of(term).iter().filter(|h| **h > 0.0) {
                let part = Part {
                    term,
                    strength,
                    implication,
                    level: None,
                };
                if all_known {
                    parts.extend(self.on_piece(part, from + 0.5 * (to - from), to - from));
                } else {
                    parts.push(part);
                }
            }
        }
    }

    /// An activated term on a piece of this width around `middle`, where its implication has neither a kink nor a step; `None`
    /// where it is 0.
    fn on_piece(&self, part: Part, middle: f64, width: f64) -> Option<Part> {
        let membership = sloped(self.terms.get(part.term)?, middle, width);
        let mut here = activate(part.implication, part.strength, membership);
        if here.degree <= 0.0 {
            return None;
        }
        let mut part = part;
        // Where they are not level.
        if let Implication::Drastic | Implication::NilpotentMinimum = part.implication {
            part.implication = Implication::Minimum;
        }
        if part.implication == Implication::Minimum && !self.cuts_off(part.term, part.strength) {
            (part.strength, here) = (1.0, membership);
        }
        part.level = (here.slope == 0.0).then_some(here.degree);
        Some(part)
    }

    /// The degree of the aggregated set of parts.
    fn joined(&self, parts: &[Part], aggregation: Aggregation, x: f64) -> f64 {
        let (mut degree, mut known) = (0.0, None);
        for part in parts {
            let activated = part.level.unwrap_or_else(|| {
                let membership = match known {
                    Some((term, membership)) if term == part.term => membership,
                    _ => self.membership(part.term, x),
                };
                known = Some((part.term, membership));
                part.implication.of(part.strength, membership)
            });
            degree = aggregation.of(degree, activated);
        }
        degree
    }

    /// The slope of the aggregated set of parts on a piece of this width.
    fn slope(&self, parts: &[Part], aggregation: Aggregation, x: f64, width: f64) -> f64 {
        let mut set = Sloped::default();
        for part in parts {
            let activated = match (part.level, self.terms.get(part.term)) {
                (None, Some(term)) => {
                    activate(part.implication, part.strength, sloped(term, x, width))
                }
                (level, _) => Sloped {
                    degree: level.unwrap_or(0.0),
                    slope: 0.0,
                },
            };
            set = aggregate(aggregation, set, activated);
        }
        set.slope
    }

    fn membership(&self, term: usize, x: f64) -> f64 {
        self.terms.get(term).map_or(0.0, |term| term.membership(x))
    }

    /// Whether a minimum cuts a term off: not where it is its highest degree but for rounding.
    fn cuts_off(&self, term: usize, strength: f64) -> bool {
        let highest = self.highest.get(term);
        self.has_formula || highest.is_none_or(|highest| strength < highest * (1.0 - EQUAL))
    }
}

fn is_formula(term: &Term) -> bool {
    matches!(
        term.membership_function,
        MembershipFunction::Function { .. }
    )
}

/// The membership of a term at `x`, on a piece of this width.
fn sloped(term: &Term, x: f64, width: f64) -> Sloped {
    Sloped {
        degree: term.membership(x),
        slope: term.height * term.membership_function.slope(x, width),
    }
}
