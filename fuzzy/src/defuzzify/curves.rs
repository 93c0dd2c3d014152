//! The aggregated set where a term is curved. It is cut where membership functions are not smooth, where they meet plateaus
//! and where they cross, and integrated between the cuts.

use alloc::vec::Vec;

use super::piece::Piece;
use super::polyline::Workspace;
use super::{Joint, Strengths};
use crate::model::{Aggregation, Implication, MembershipFunction, Term};
use crate::table::numeric::root;

/// A formula may have a kink anywhere: it is integrated between so many even cuts. What is narrower may be missed.
const EVENLY: u32 = 256;

/// The terms of one output and the cuts of its range.
#[derive(Debug, Clone)]
pub(crate) struct Curves {
    terms: Vec<Term>,
    /// Cuts and the terms they belong to, in ascending order; the ends of the range belong to no term.
    cuts: Vec<(f64, Option<usize>)>,
}

impl Curves {
    pub(crate) fn new(terms: &[Term], low: f64, high: f64) -> Self {
        let mut cuts = Vec::from([(low, None), (high, None)]);
        for (index, term) in terms.iter().enumerate() {
            let evenly = match term.membership_function {
                MembershipFunction::Function { .. } => EVENLY,
                _ => 0,
            };
            let even = (1..evenly).map(|i| low + (high - low) * (f64::from(i) / f64::from(evenly)));
            for x in term.membership_function.cuts().into_iter().chain(even) {
                if low < x && x < high {
                    cuts.push((x, Some(index)));
                }
            }
        }
        cuts.sort_by(|a, b| a.0.total_cmp(&b.0));
        Curves {
            terms: terms.to_vec(),
            cuts,
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
        let (cuts, most_cuts) = (&mut workspace.cuts, workspace.most_cuts);
        cuts.clear();
        let active = |term: usize| strengths.of(term).iter().any(|h| *h > 0.0);
        for &(x, term) in &self.cuts {
            if term.is_none_or(active) && cuts.last() != Some(&x) {
                cuts.push(x);
            }
        }
        // Terms pass their levels first: between these each activated term is smooth, and two cross once at most.
        for kinks in [Curves::levels, Curves::crossings] {
            let landmarks = cuts.len();
            for i in 1..landmarks {
                let (Some(&a), Some(&b)) = (cuts.get(i - 1), cuts.get(i)) else {
                    break;
                };
                let between = (a.next_up(), b.next_down());
                kinks(self, strengths, joint, &mut |f: &dyn Fn(f64) -> f64| {
                    let (a, b) = between;
                    let (fa, fb) = (f(a), f(b));
                    if fa * fb < 0.0 && cuts.len() < most_cuts {
                        cuts.push(root(a, b, f));
                    }
                });
            }
            cuts.sort_unstable_by(f64::total_cmp);
        }
        let degree = |x: f64| self.degree(strengths, joint, x);
        for (&from, &to) in cuts.iter().zip(cuts.iter().skip(1)) {
            if from < to {
                visit(&Piece {
                    from,
                    to,
                    // Just inside, past a step at the cut.
                    left: degree(from.next_up()),
                    right: degree(to.next_down()),
                    curve: Some(&|part| degree(from + (to - from) * part)),
                });
            }
        }
    }

    /// Cuts where a term passes a level of its implication.
    fn levels(&self, strengths: Strengths<'_>, joint: Joint, cut_at_sign_change: Cut<'_>) {
        for (index, term) in self.terms.iter().enumerate() {
            for &strength in strengths.of(index).iter().filter(|h| **h > 0.0) {
                for level in levels(joint.implication, strength).into_iter().flatten() {
                    cut_at_sign_change(&|x| term.membership(x) - level);
                }
            }
        }
    }

    /// Cuts where two terms cross, or the sum of two reaches 1. A kink may be missed, because curves meet twice between two cuts
    /// or because memory is short. Then the integration takes longer, and is as exact.
    fn crossings(&self, strengths: Strengths<'_>, joint: Joint, cut_at_sign_change: Cut<'_>) {
        let Joint {
            implication,
            aggregation,
        } = joint;
        let fired = |index: usize| strengths.of(index).iter().filter(|h| **h > 0.0).copied();
        let terms = || self.terms.iter().enumerate();
        if let Aggregation::Maximum | Aggregation::NilpotentMaximum = aggregation {
            let activated = |index: usize, term: &Term, x: f64| {
                let membership = term.membership(x);
                fired(index).fold(0.0, |most: f64, h| most.max(implication.of(h, membership)))
            };
            for (i, first) in terms() {
                for (j, second) in terms().skip(i + 1) {
                    cut_at_sign_change(&|x| activated(i, first, x) - activated(j, second, x));
                }
            }
        }
        if aggregation == Aggregation::NilpotentMaximum {
            let all = || terms().flat_map(|(i, term)| fired(i).map(move |h| (term, h)));
            for (i, (first, g)) in all().enumerate() {
                for (second, h) in all().skip(i + 1) {
                    cut_at_sign_change(&|x| {
                        let one = implication.of(g, first.membership(x));
                        one + implication.of(h, second.membership(x)) - 1.0
                    });
                }
            }
        }
        if aggregation == Aggregation::BoundedSum {
            let unbounded = Joint {
                aggregation: Aggregation::Sum,
                ..joint
            };
            cut_at_sign_change(&|x| self.degree(strengths, unbounded, x) - 1.0);
        }
    }
}

/// Adds a cut where a function changes its sign between two cuts.
type Cut<'a> = &'a mut dyn FnMut(&dyn Fn(f64) -> f64);

/// The degrees of membership at which an activated term has a kink or a step.
fn levels(implication: Implication, strength: f64) -> [Option<f64>; 2] {
    match implication {
        Implication::Minimum => [Some(strength), None],
        Implication::BoundedDifference => [Some(1.0 - strength), None],
        Implication::NilpotentMinimum => [Some(strength), Some(1.0 - strength)],
        _ => [None, None],
    }
}
