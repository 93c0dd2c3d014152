//! Finding the kinks and steps of an aggregated set of curves.

use alloc::vec::Vec;

use super::super::calculus::{Kinks, levels};
use super::super::maxima::{INSIDE, turns};
use super::{ActivatedTerm, ConsequentOperators, Curves, Run, Strengths, Workspace};
use crate::model::{Aggregation, Implication};
use crate::table::{MIN_STRENGTH, numeric::root};

/// The cuts of one interval.
struct Cuts<'a> {
    cuts: &'a mut Vec<f64>,
    most: usize,
    /// Whether the memory for cuts was exhausted.
    is_full: bool,
    /// Positions just inside two adjacent cuts, between which further cuts are added.
    between: (f64, f64),
}

impl Curves {
    /// Fills `workspace.cuts` with the cuts of the aggregated set between `from` and `to`, in ascending order: the
    /// ends, kinks and steps. Returns whether all of them are known. Some are unknown if a term is a formula or the
    /// memory is exhausted. A kink may also be missed if curves meet twice between two cuts; the integration then takes
    /// longer but is equally accurate.
    pub(super) fn kinks(
        &self,
        strengths: Strengths<'_>,
        operators: ConsequentOperators,
        (from, to): (f64, f64),
        workspace: &mut Workspace,
    ) -> bool {
        let Workspace {
            cuts,
            most_cuts,
            runs,
            parts,
            steps,
            lines: _,
        } = workspace;
        cuts.clear();
        cuts.extend([from, to]);
        let mut cuts = Cuts {
            cuts,
            most: *most_cuts,
            is_full: false,
            between: (0.0, 0.0),
        };
        cuts.each_stretch(|cuts, _| {
            if steps.take(2 * strengths.strengths.len()) {
                self.levels(strengths, operators.implication, runs, cuts);
            }
        });
        let all_known = !cuts.is_full && !self.has_formula;
        // Each activated term is smooth between the levels.
        let kinks = Kinks::of(operators.aggregation);
        cuts.each_stretch(|cuts, stretch| {
            if kinks == Kinks::None || !steps.take(strengths.strengths.len()) {
                return;
            }
            self.parts(
                strengths,
                operators.implication,
                stretch,
                all_known,
                (runs, parts),
            );
            let pairs = match kinks {
                Kinks::Crossings | Kinks::CrossingsAndSteps => parts.len(),
                Kinks::None | Kinks::Steps | Kinks::Bound => 1,
            };
            if steps.take(2 * pairs * parts.len()) {
                self.crossings(parts, kinks, cuts);
            }
        });
        !cuts.is_full && !self.has_formula
    }

    /// Adds the values at which a term crosses a level of its implication.
    fn levels(
        &self,
        strengths: Strengths<'_>,
        implication: Implication,
        runs: &[Run],
        cuts: &mut Cuts<'_>,
    ) {
        for Run { term, line } in runs {
            for &strength in strengths.of(*term).iter().filter(|h| **h > 0.0) {
                for level in levels(implication, strength).into_iter().flatten() {
                    if level == strength && !self.cuts_off(*term, strength) {
                        continue;
                    }
                    match line {
                        Some(line) => cuts.at_sign_change(|x| line.at(x) - level, true),
                        None => cuts.at_sign_change(|x| self.membership(*term, x) - level, false),
                    }
                }
            }
        }
    }

    /// Adds the kinks and steps of the aggregation.
    fn crossings(&self, parts: &[ActivatedTerm], kinks: Kinks, cuts: &mut Cuts<'_>) {
        let degree = |part: &ActivatedTerm, x: f64| self.joined(&[*part], Aggregation::Maximum, x);
        let is_line = |part: &ActivatedTerm| part.line.is_some();
        let sum = |parts: &[ActivatedTerm], x: f64| self.joined(parts, Aggregation::Sum, x);
        for (i, first) in parts.iter().enumerate() {
            for second in parts.iter().skip(i + 1) {
                if let Kinks::Crossings | Kinks::CrossingsAndSteps = kinks {
                    let are_lines = is_line(first) && is_line(second);
                    cuts.at_sign_change(|x| degree(first, x) - degree(second, x), are_lines);
                }
                if kinks == Kinks::CrossingsAndSteps {
                    let pair = [*first, *second];
                    let slope = |x: f64, width: f64| self.slope(&pair, Aggregation::Sum, x, width);
                    cuts.at_sign_changes(|x| sum(&pair, x) - (1.0 - MIN_STRENGTH), slope);
                }
            }
            if kinks == Kinks::Steps {
                cuts.at_sign_change(|x| degree(first, x) - MIN_STRENGTH, is_line(first));
            }
        }
        if kinks == Kinks::Bound {
            let are_lines = parts.iter().all(is_line);
            cuts.at_sign_change(|x| sum(parts, x) - 1.0, are_lines);
        }
    }
}

impl Cuts<'_> {
    /// Calls `visit` for each interval between two of the current cuts; `visit` may add cuts.
    fn each_stretch(&mut self, mut visit: impl FnMut(&mut Self, (f64, f64))) {
        for i in 1..self.cuts.len() {
            if let (Some(&a), Some(&b)) = (self.cuts.get(i - 1), self.cuts.get(i)) {
                // Both positions are just inside the interval, so that a step at one of its ends has no effect.
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

    /// Adds a cut at the position where a function changes its sign, if there is such a position. `is_line` states
    /// whether the function is a straight line.
    fn at_sign_change(&mut self, f: impl Fn(f64) -> f64, is_line: bool) {
        let (a, b) = self.between;
        let (fa, fb) = (f(a), f(b));
        if fa * fb < 0.0 {
            self.push(match is_line {
                true => a + (b - a) * (fa / (fa - fb)),
                false => root(a, b, f),
            });
        }
    }

    /// Works like `at_sign_change` for a function that may have an extremum inside the interval, and therefore two sign
    /// changes. `slope` returns the slope of the function at `x`, given the width of the interval.
    fn at_sign_changes(&mut self, f: impl Fn(f64) -> f64, slope: impl Fn(f64, f64) -> f64) {
        let (a, b) = self.between;
        let (fa, fb) = (f(a), f(b));
        if fa * fb <= 0.0 {
            return self.at_sign_change(f, false);
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
