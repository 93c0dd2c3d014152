//! The actions of rules that fire: firing strengths are combined, and the strongest rule of each output is recorded.

use core::hint::select_unpredictable;

use super::conjunctions::{Cells, PartialConjunction};
use super::operators::{larger, smaller};
use super::results::number_of;
use super::rules::Action;
use crate::rows::join;

/// The strongest rule of an output in each of `L` rows. Among equally strong rules, it is the first one in the model,
/// regardless of the order in which they fire.
#[derive(Debug, Clone, Copy)]
pub struct StrongestRule<const L: usize = 1> {
    pub(super) strength: [f64; L],
    /// The [number](number_of) of the rule; infinite if no rule has fired.
    pub(super) rule: [f64; L],
}

impl StrongestRule {
    /// Creates the entry of a rule, from its index and its firing strength.
    #[cfg(feature = "simd")]
    pub(crate) fn of(strength: f64, rule: u32) -> Self {
        StrongestRule {
            strength: [strength],
            rule: [number_of(rule)],
        }
    }
}

impl<const L: usize> StrongestRule<L> {
    /// The initial state, in which no rule has fired yet.
    pub const NONE: Self = StrongestRule {
        strength: [0.0; L],
        rule: [f64::INFINITY; L],
    };

    /// Updates the strongest rule with a rule that follows all previous ones in the model. Like [`StrongestRule::or`], it
    /// does not branch.
    #[inline(always)]
    fn or_later(&mut self, row: usize, strength: f64, rule: f64) {
        let (top, first) = (self.strength[row], self.rule[row]);
        self.rule[row] = select_unpredictable(strength > top, rule, first);
        self.strength[row] = larger(strength, top);
    }

    /// Updates the strongest rule, without a branch that a processor could mispredict.
    #[inline(always)]
    fn or(&mut self, row: usize, strength: f64, rule: f64) {
        let (top, first) = (self.strength[row], self.rule[row]);
        let of_equal = select_unpredictable(strength == top, smaller(rule, first), first);
        self.rule[row] = select_unpredictable(strength > top, rule, of_equal);
        self.strength[row] = larger(strength, top);
    }
}

/// Returns the firing strength, or 0 if it is below the minimum `least`.
#[inline(always)]
pub(super) fn fires(strength: f64, least: f64) -> f64 {
    if strength < least { 0.0 } else { strength }
}

/// A consumer of the rules that fire.
pub(super) trait FiringConsumer<const L: usize> {
    /// Performs the actions of rules in one row; `degree` is the degree of their antecedent.
    fn act(&mut self, actions: &[Action], row: usize, degree: f64);

    /// Performs the actions of a rule in all rows; `strength` returns its firing strength in a row. The weights of the
    /// actions are not used.
    fn act_with(&mut self, actions: &[Action], strength: impl Fn(usize) -> f64);

    /// Performs the actions of cells of a uniform table. The contents of `reached` are unspecified afterwards.
    #[inline(always)]
    fn act_in_cells(&mut self, cells: &Cells<'_>, reached: &mut [PartialConjunction<L>]) {
        for cell in reached {
            for row in 0..L {
                self.act(cells.actions_of(cell.at[row]), row, cell.degree[row]);
            }
        }
    }
}

/// The firing strengths and strongest rules that actions update.
#[repr(C, align(64))]
pub(super) struct FiringStrengths<'m, const L: usize> {
    /// The strongest program if there is one output. It is kept in registers, because otherwise each rule would wait
    /// for memory. It is separate from `strongest`, because a vector that spans two cache lines takes twice as long
    /// to access.
    one: StrongestRule<L>,
    least: f64,
    strengths: &'m mut [[f64; L]],
    strongest: &'m mut [StrongestRule<L>],
    /// The [number](number_of) of the program that comes last in the model among those that have fired.
    latest: f64,
}

impl<'m, const L: usize> FiringStrengths<'m, L> {
    /// Creates the state before any rule has fired. All firing strengths must be 0.
    #[inline(always)]
    pub(super) fn new(
        least: f64,
        strengths: &'m mut [[f64; L]],
        strongest: &'m mut [StrongestRule<L>],
    ) -> Self {
        FiringStrengths {
            one: StrongestRule::NONE,
            least,
            strengths,
            strongest,
            latest: 0.0,
        }
    }

    /// Merges `one` into the strongest rule of the only output, after all rules have fired.
    #[inline(always)]
    pub(super) fn end(self) {
        if let [strongest] = self.strongest {
            let mut all = self.one;
            for row in 0..L {
                all.or(row, strongest.strength[row], strongest.rule[row]);
            }
            *strongest = all;
        }
    }
}

impl<const L: usize> FiringConsumer<L> for FiringStrengths<'_, L> {
    #[inline(always)]
    fn act(&mut self, actions: &[Action], row: usize, degree: f64) {
        for action in actions {
            let strength = fires(action.weight * degree, self.least);
            let kept = &mut self.strengths[action.strength as usize][row];
            *kept = if action.sums != 0 {
                *kept + strength
            } else {
                larger(*kept, strength)
            };
            self.strongest[action.output as usize].or(row, strength, number_of(action.rule));
        }
    }

    #[inline(always)]
    fn act_with(&mut self, actions: &[Action], strength: impl Fn(usize) -> f64) {
        for action in actions {
            let kept = &mut self.strengths[action.strength as usize];
            let strongest = match &mut *self.strongest {
                [_] => &mut self.one,
                all => &mut all[action.output as usize],
            };
            let rule = number_of(action.rule);
            let is_later = rule > self.latest;
            self.latest = larger(rule, self.latest);
            match (action.sums, is_later) {
                (0, true) => take(
                    kept,
                    strongest,
                    &strength,
                    rule,
                    larger,
                    StrongestRule::or_later,
                ),
                (0, false) => take(kept, strongest, &strength, rule, larger, StrongestRule::or),
                _ => take(
                    kept,
                    strongest,
                    &strength,
                    rule,
                    |a, b| a + b,
                    StrongestRule::or,
                ),
            }
        }
    }

    #[inline(always)]
    fn act_in_cells(&mut self, cells: &Cells<'_>, reached: &mut [PartialConjunction<L>]) {
        if let ([one], 1, false) = (&mut *self.strongest, cells.actions_per_cell, cells.sums) {
            *one = fire_cells(cells, reached, self.strengths, self.least);
            return;
        }
        for cell in reached {
            for row in 0..L {
                self.act(cells.actions_of(cell.at[row]), row, cell.degree[row]);
            }
        }
    }
}

/// Combines the firing strengths of a rule with the stored ones by `join`, and updates the strongest rule by `or`.
#[inline(always)]
fn take<const L: usize>(
    kept: &mut [f64; L],
    strongest: &mut StrongestRule<L>,
    strength: impl Fn(usize) -> f64,
    rule: f64,
    join: impl Fn(f64, f64) -> f64,
    or: impl Fn(&mut StrongestRule<L>, usize, f64, f64),
) {
    for (row, kept) in kept.iter_mut().enumerate() {
        let strength = strength(row);
        *kept = join(*kept, strength);
        or(strongest, row, strength, rule);
    }
}

/// Fires the rules of cells that have one action each, all on one output, and returns the strongest rule.
#[inline(always)]
fn fire_cells<const L: usize>(
    cells: &Cells<'_>,
    reached: &mut [PartialConjunction<L>],
    strengths: &mut [[f64; L]],
    least: f64,
) -> StrongestRule<L> {
    let mut strongest = StrongestRule::NONE;
    for cell in &mut *reached {
        let rows = cell.degree.iter_mut().zip(&mut cell.at).enumerate();
        for (row, (degree, at)) in rows {
            let action = &cells.actions[*at as usize];
            let strength = fires(action.weight * *degree, least);
            let kept = &mut strengths[action.strength as usize][row];
            *kept = larger(*kept, strength);
            (*degree, *at) = (strength, action.rule);
        }
        join(&mut strongest.strength, &cell.degree, larger);
    }
    for cell in &*reached {
        for row in 0..L {
            let is_strongest = cell.degree[row] == strongest.strength[row];
            let rule = select_unpredictable(is_strongest, number_of(cell.at[row]), f64::INFINITY);
            strongest.rule[row] = smaller(rule, strongest.rule[row]);
        }
    }
    strongest
}
