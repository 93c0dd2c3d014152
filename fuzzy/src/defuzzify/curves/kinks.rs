//! Where an aggregated set of curves has a kink or a step.

use alloc::vec::Vec;

use super::super::maxima::{INSIDE, turns};
use super::{Curves, Joint, Part, Strengths, Workspace};
use crate::model::{Aggregation, Implication};
use crate::table::{LEAST_STRENGTH, numeric::root};

/// The cuts of one evaluation.
struct Cuts<'a> {
    cuts: &'a mut Vec<f64>,
    most: usize,
    /// Whether memory was short.
    is_full: bool,
    /// Just inside two cuts next to each other, between which others are added.
    between: (f64, f64),
}

impl Curves {
    /// Fills `workspace` with the cuts of the aggregated set, from left to right: its kinks and steps. Returns whether they are
    /// all known: not of formulas, and not where memory is short. A kink may be missed where curves meet twice between two cuts.
    /// Then the integration takes longer, and is as exact.
    pub(super) fn kinks(
        &self,
        strengths: Strengths<'_>,
        joint: Joint,
        workspace: &mut Workspace,
    ) -> bool {
        let (parts, steps) = (&mut workspace.parts, &mut workspace.steps);
        workspace.cuts.clear();
        let active = |term: usize| strengths.of(term).iter().any(|h| *h > 0.0);
        for &(x, term) in &self.cuts {
            if term.is_none_or(active) && workspace.cuts.last() != Some(&x) {
                workspace.cuts.push(x);
            }
        }
        let mut cuts = Cuts {
            cuts: &mut workspace.cuts,
            most: workspace.most_cuts,
            is_full: false,
            between: (0.0, 0.0),
        };
        cuts.each_stretch(|cuts, _| {
            if steps.take(2 * strengths.strengths.len()) {
                self.levels(strengths, joint.implication, cuts);
            }
        });
        let all_known = !cuts.is_full && !self.has_formula;
        // Between the levels each activated term is smooth.
        cuts.each_stretch(|cuts, stretch| {
            if !steps.take(strengths.strengths.len()) {
                return;
            }
            self.parts(strengths, joint.implication, stretch, all_known, parts);
            let pairs = match joint.aggregation {
                Aggregation::Maximum | Aggregation::NilpotentMaximum => parts.len(),
                _ => 1,
            };
            if steps.take(2 * pairs * parts.len()) {
                self.crossings(parts, joint.aggregation, cuts);
            }
        });
        !cuts.is_full && !self.has_formula
    }

    /// Cuts where a term passes a level of its implication.
    fn levels(&self, strengths: Strengths<'_>, implication: Implication, cuts: &mut Cuts<'_>) {
        for term in 0..self.terms.len() {
            for &strength in strengths.of(term).iter().filter(|h| **h > 0.0) {
                for level in levels(implication, strength).into_iter().flatten() {
                    if level != strength || self.cuts_off(term, strength) {
                        cuts.at_sign_change(|x| self.membership(term, x) - level);
                    }
                }
            }
        }
    }

    /// Cuts where two terms cross, where one comes to the least strength, or the sum of two reaches 1.
    fn crossings(&self, parts: &[Part], aggregation: Aggregation, cuts: &mut Cuts<'_>) {
        let degree = |part: &Part, x: f64| self.joined(&[*part], Aggregation::Maximum, x);
        for (i, first) in parts.iter().enumerate() {
            let others = parts.iter().skip(i + 1);
            match aggregation {
                Aggregation::Maximum => {
                    for second in others {
                        cuts.at_sign_change(|x| degree(first, x) - degree(second, x));
                    }
                }
                Aggregation::NilpotentMaximum => {
                    for second in others {
                        cuts.at_sign_change(|x| degree(first, x) - degree(second, x));
                        let pair = [*first, *second];
                        let sum = |x: f64| self.joined(&pair, Aggregation::Sum, x);
                        let slope =
                            |x: f64, width: f64| self.slope(&pair, Aggregation::Sum, x, width);
                        cuts.at_sign_changes(|x| sum(x) - (1.0 - LEAST_STRENGTH), slope);
                    }
                }
                Aggregation::Drastic => {
                    cuts.at_sign_change(|x| degree(first, x) - LEAST_STRENGTH);
                }
                // All together, below.
                Aggregation::BoundedSum => {}
                Aggregation::Sum
                | Aggregation::ProbabilisticSum
                | Aggregation::Einstein
                | Aggregation::Hamacher => {}
            }
        }
        if aggregation == Aggregation::BoundedSum {
            cuts.at_sign_change(|x| self.joined(parts, Aggregation::Sum, x) - 1.0);
        }
    }
}

impl Cuts<'_> {
    /// Calls `visit` for each stretch between two cuts, before others are added.
    fn each_stretch(&mut self, mut visit: impl FnMut(&mut Self, (f64, f64))) {
        for i in 1..self.cuts.len() {
            if let (Some(&a), Some(&b)) = (self.cuts.get(i - 1), self.cuts.get(i)) {
                // Past a step at the cut.
                let inside = INSIDE * (b - a);
                self.between = (a.next_up().max(a + inside), b.next_down().min(b - inside));
                visit(self, (a, b));
            }
        }
        self.cuts.sort_unstable_by(f64::total_cmp);
    }

    fn push(&mut self, x: f64) {
        if self.cuts.len() < self.most {
            self.cuts.push(x);
        } else {
            self.is_full = true;
        }
    }

    /// Adds a cut where a function changes its sign.
    fn at_sign_change(&mut self, f: impl Fn(f64) -> f64) {
        let (a, b) = self.between;
        if f(a) * f(b) < 0.0 {
            self.push(root(a, b, f));
        }
    }

    /// The same for a function that may also turn between, and change its sign twice. `slope` is that at `x`, on a stretch of a width.
    fn at_sign_changes(&mut self, f: impl Fn(f64) -> f64, slope: impl Fn(f64, f64) -> f64) {
        let (a, b) = self.between;
        let (fa, fb) = (f(a), f(b));
        if fa * fb <= 0.0 {
            return self.at_sign_change(f);
        }
        let sign = if fa < 0.0 { 1.0 } else { -1.0 };
        let width = b - a;
        turns(&|part| sign * slope(a + width * part, width), &mut |part| {
            let x = a + width * part;
            if sign * f(x) > 0.0 {
                self.push(root(a, x, &f));
                self.push(root(x, b, &f));
            }
        });
    }
}

/// The degrees of membership at which an activated term has a kink or a step.
fn levels(implication: Implication, strength: f64) -> [Option<f64>; 2] {
    match implication {
        Implication::Minimum => [Some(strength), None],
        Implication::BoundedDifference => [Some(1.0 - strength), None],
        Implication::NilpotentMinimum => [Some(strength), Some(1.0 - strength + LEAST_STRENGTH)],
        Implication::Product
        | Implication::Drastic
        | Implication::Einstein
        | Implication::Hamacher => [None, None],
    }
}
