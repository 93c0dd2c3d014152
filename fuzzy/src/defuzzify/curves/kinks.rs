//! Where an aggregated set of curves has a kink or a step.

use alloc::vec::Vec;

use super::super::maxima::{INSIDE, turns};
use super::super::sloped::activate;
use super::{Curves, Joint, Part, Strengths, sloped};
use crate::model::{Aggregation, Implication};
use crate::table::{LEAST_STRENGTH, numeric::root};

/// The cuts of one evaluation.
struct Cuts<'a> {
    cuts: &'a mut Vec<f64>,
    most: usize,
    /// Whether memory was short.
    is_full: bool,
    /// Two cuts next to each other, between which others are added.
    between: (f64, f64),
}

impl Curves {
    /// Fills `cuts` with the kinks and steps of the aggregated set, from left to right. Returns whether they are all known: not
    /// of formulas, and not where memory is short. A kink may be missed where curves meet twice between two cuts. Then the
    /// integration takes longer, and is as exact.
    pub(super) fn kinks(
        &self,
        strengths: Strengths<'_>,
        joint: Joint,
        cuts: &mut Vec<f64>,
        most: usize,
    ) -> bool {
        cuts.clear();
        let active = |term: usize| strengths.of(term).iter().any(|h| *h > 0.0);
        for &(x, term) in &self.cuts {
            if term.is_none_or(active) && cuts.last() != Some(&x) {
                cuts.push(x);
            }
        }
        let mut cuts = Cuts {
            cuts,
            most,
            is_full: false,
            between: (0.0, 0.0),
        };
        // Terms pass their levels first: between these each activated term is smooth.
        for kinks in [Curves::levels, Curves::crossings] {
            let landmarks = cuts.cuts.len();
            for i in 1..landmarks {
                if let (Some(&a), Some(&b)) = (cuts.cuts.get(i - 1), cuts.cuts.get(i)) {
                    // Just inside, past a step at the cut.
                    let inside = INSIDE * (b - a);
                    cuts.between = (a.next_up().max(a + inside), b.next_down().min(b - inside));
                    kinks(self, strengths, joint, &mut cuts);
                }
            }
            cuts.cuts.sort_unstable_by(f64::total_cmp);
        }
        !cuts.is_full && !self.has_formula
    }

    /// Cuts where a term passes a level of its implication.
    fn levels(&self, strengths: Strengths<'_>, joint: Joint, cuts: &mut Cuts<'_>) {
        self.activated(strengths, joint.implication, |part| {
            for level in levels(joint.implication, part.strength)
                .into_iter()
                .flatten()
            {
                if level != part.strength || self.cuts_off(part.term, part.strength) {
                    cuts.at_sign_change(|x| self.membership(part.term, x) - level);
                }
            }
        });
    }

    /// Cuts where two terms cross, where one comes to the least strength, or the sum of two reaches 1.
    fn crossings(&self, strengths: Strengths<'_>, joint: Joint, cuts: &mut Cuts<'_>) {
        let Joint {
            implication,
            aggregation,
        } = joint;
        let degree = |part: Part, x: f64| {
            let membership = self.membership(part.term, x);
            implication.of(part.strength, membership)
        };
        match aggregation {
            Aggregation::Maximum => self.pairs(strengths, implication, |first, second| {
                if first.term != second.term {
                    cuts.at_sign_change(|x| degree(first, x) - degree(second, x));
                }
            }),
            Aggregation::NilpotentMaximum => self.pairs(strengths, implication, |first, second| {
                cuts.at_sign_change(|x| degree(first, x) - degree(second, x));
                let sum = |x: f64| degree(first, x) + degree(second, x) - (1.0 - LEAST_STRENGTH);
                cuts.at_sign_changes(sum, |x, width| {
                    let slope = |part: Part| {
                        let term = self.terms.get(part.term)?;
                        let membership = sloped(term, x, width);
                        Some(activate(implication, part.strength, membership).slope)
                    };
                    slope(first).unwrap_or(0.0) + slope(second).unwrap_or(0.0)
                });
            }),
            Aggregation::Drastic => self.activated(strengths, implication, |part| {
                cuts.at_sign_change(|x| degree(part, x) - LEAST_STRENGTH);
            }),
            Aggregation::BoundedSum => {
                let unbounded = Joint {
                    aggregation: Aggregation::Sum,
                    ..joint
                };
                cuts.at_sign_change(|x| self.degree(strengths, unbounded, x) - 1.0);
            }
            _ => {}
        }
    }

    /// Calls `visit` with each two activated terms.
    fn pairs(
        &self,
        strengths: Strengths<'_>,
        implication: Implication,
        mut visit: impl FnMut(Part, Part),
    ) {
        let mut seen = 0;
        self.activated(strengths, implication, |first| {
            seen += 1;
            let mut index = 0;
            self.activated(strengths, implication, |second| {
                index += 1;
                if index > seen {
                    visit(first, second);
                }
            });
        });
    }
}

impl Cuts<'_> {
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
        _ => [None, None],
    }
}
