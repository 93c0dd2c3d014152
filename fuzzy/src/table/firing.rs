//! Firing of all rules: those that a table or a trie finds, and those that are programs.

use core::ops::DerefMut;

use super::actions::{FiringConsumer, FiringStrengths, StrongestRule, fires};
use super::blocks::fire_blocks;
use super::conjunctions::{Cells, PartialConjunction, fire_dense, fire_trie, fire_uniform};
use super::input::degrees_in_rows;
use super::operators::{larger, smaller};
use super::rules::{AntecedentStep, Op};
use super::{Arrays, Buffers, Conjunction, Conjunctions, Disjunction};
use crate::rows::{change, join};

/// Returns whether a uniform table contains all rules.
pub(crate) fn has_cells_alone<A: Arrays>(table: &A) -> bool {
    let is_uniform = matches!(table.conjunctions(), Conjunctions::Uniform { .. });
    is_uniform && table.programs().is_empty()
}

/// Fires all rules for the values in the scratch memory, and writes the firing strengths and strongest rules there.
/// `CELLS` must be the result of [`has_cells_alone`]. It is a constant because the code for other tables would
/// otherwise take registers from the code for cells.
#[inline(always)]
pub(crate) fn fire<A, N, P, S, const L: usize, const CELLS: bool>(
    table: &A,
    scratch: &mut Buffers<N, P, S>,
) where
    A: Arrays,
    N: DerefMut<Target = [[f64; L]]>,
    P: DerefMut<Target = [PartialConjunction<L>]>,
    S: DerefMut<Target = [StrongestRule<L>]>,
{
    let (search, mut firing) = ready(table, scratch);
    fire_into::<A, L, CELLS>(table, search, &mut firing);
    if !CELLS {
        firing.end();
    }
}

/// Works like [`fire`], for rules of any kind in one row.
#[inline(always)]
pub(crate) fn fire_row<A, N, P, S>(table: &A, scratch: &mut Buffers<N, P, S>)
where
    A: Arrays,
    N: DerefMut<Target = [[f64; 1]]>,
    P: DerefMut<Target = [PartialConjunction]>,
    S: DerefMut<Target = [StrongestRule]>,
{
    let (search, mut firing) = ready(table, scratch);
    fire_row_into(table, search, &mut firing);
    firing.end();
}

/// Clears the firing strengths and the strongest rules, and splits the memory.
#[inline(always)]
fn ready<'m, A, N, P, S, const L: usize>(
    table: &A,
    scratch: &'m mut Buffers<N, P, S>,
) -> (RuleSearch<'m, L>, FiringStrengths<'m, L>)
where
    A: Arrays,
    N: DerefMut<Target = [[f64; L]]>,
    P: DerefMut<Target = [PartialConjunction<L>]>,
    S: DerefMut<Target = [StrongestRule<L>]>,
{
    // Models with one output are the most common; this avoids a call of `fill` for them.
    match &mut *scratch.strongest {
        [one] => *one = StrongestRule::NONE,
        all => all.fill(StrongestRule::NONE),
    }
    let (search, strengths, strongest) = scratch.split();
    clear(strengths);
    let firing = FiringStrengths::new(table.least_strength(), strengths, strongest);
    (search, firing)
}

/// Sets all strengths to 0. The first eight, if there are as many, are written inline, because a call of `memset` takes
/// longer.
#[inline(always)]
fn clear<const L: usize>(strengths: &mut [[f64; L]]) {
    match strengths.split_first_chunk_mut::<8>() {
        Some((first, rest)) => {
            *first = [[0.0; L]; 8];
            if !rest.is_empty() {
                rest.fill([0.0; L]);
            }
        }
        None => strengths.fill([0.0; L]),
    }
}

/// The memory used to find the rules that fire.
pub(super) struct RuleSearch<'m, const L: usize> {
    values: &'m [[f64; L]],
    degrees: &'m mut [[f64; L]],
    alive: &'m mut [PartialConjunction<L>],
    partial: &'m mut [PartialConjunction<L>],
    next: &'m mut [PartialConjunction<L>],
    stack: &'m mut [[f64; L]],
}

impl<'m, const L: usize> RuleSearch<'m, L> {
    pub(super) fn values(&self) -> &'m [[f64; L]] {
        self.values
    }

    /// Writes the degrees of all literals, if rules read them by index.
    #[inline(always)]
    fn find_degrees<A: Arrays>(&mut self, table: &A) {
        if self.degrees.is_empty() {
            return;
        }
        if !table.lines().is_empty() {
            self.degrees.fill([0.0; L]);
        }
        for (input, values) in table.inputs().iter().zip(self.values) {
            // In a damaged table an input without literals may have any index.
            let of_input = self.degrees.get_mut(input.first_literal as usize..);
            degrees_in_rows(table, input, values, of_input.unwrap_or_default());
        }
    }
}

impl<N, P, S> Buffers<N, P, S> {
    /// Splits the memory into the part used to find rules, the firing strengths, and the strongest rules.
    #[inline(always)]
    pub(super) fn split<const L: usize>(
        &mut self,
    ) -> (RuleSearch<'_, L>, &mut [[f64; L]], &mut [StrongestRule<L>])
    where
        N: DerefMut<Target = [[f64; L]]>,
        P: DerefMut<Target = [PartialConjunction<L>]>,
        S: DerefMut<Target = [StrongestRule<L>]>,
    {
        let search = RuleSearch {
            values: &self.values,
            degrees: &mut self.degrees,
            alive: &mut self.alive,
            partial: &mut self.partial,
            next: &mut self.next,
            stack: &mut self.stack,
        };
        (search, &mut self.strengths, &mut self.strongest)
    }
}

/// Finds the rules of any kind that fire in one row, and passes them to `firing`.
#[inline(always)]
pub(super) fn fire_row_into<A: Arrays>(
    table: &A,
    search: RuleSearch<'_, 1>,
    firing: &mut impl FiringConsumer<1>,
) {
    match table.blocks().is_empty() {
        true => fire_into::<A, 1, false>(table, search, firing),
        false => fire_in_blocks(table, search, firing),
    }
}

/// Works like [`fire_row_into`], but is compiled only once for all operators; for rare calls.
pub(super) fn fire_row_by_any<A: Arrays>(
    table: &A,
    mut search: RuleSearch<'_, 1>,
    firing: &mut impl FiringConsumer<1>,
) {
    if !table.blocks().is_empty() {
        return fire_in_blocks(table, search, firing);
    }
    search.find_degrees(table);
    let (and, or) = (table.and(), table.or());
    let (and, or) = (|a, b| and.of(a, b), |a, b| or.of(a, b));
    fire_with::<A, 1, false>(table, and, or, search, firing);
}

#[inline(always)]
fn fire_in_blocks<A: Arrays>(
    table: &A,
    mut search: RuleSearch<'_, 1>,
    firing: &mut impl FiringConsumer<1>,
) {
    search.find_degrees(table);
    let RuleSearch {
        degrees,
        partial,
        stack,
        ..
    } = search;
    fire_blocks(table, degrees, partial, stack, firing);
}

/// Finds the rules that fire if there are no blocks, and passes them to `firing`.
#[inline(always)]
fn fire_into<A: Arrays, const L: usize, const CELLS: bool>(
    table: &A,
    mut search: RuleSearch<'_, L>,
    firing: &mut impl FiringConsumer<L>,
) {
    if !CELLS {
        search.find_degrees(table);
    }
    // The common operators get their own instances, so that the loops do not branch on the operator.
    match (table.and(), table.or()) {
        (Conjunction::Minimum, Disjunction::Maximum) => {
            fire_with::<A, L, CELLS>(table, smaller, larger, search, firing);
        }
        (Conjunction::Product, or) => {
            fire_with::<A, L, CELLS>(table, |a, b| a * b, |a, b| or.of(a, b), search, firing);
        }
        (and, or) => {
            fire_with::<A, L, CELLS>(
                table,
                |a, b| and.of(a, b),
                |a, b| or.of(a, b),
                search,
                firing,
            );
        }
    }
}

#[inline(always)]
fn fire_with<A: Arrays, const L: usize, const CELLS: bool>(
    table: &A,
    and: impl Fn(f64, f64) -> f64,
    or: impl Fn(f64, f64) -> f64,
    search: RuleSearch<'_, L>,
    firing: &mut impl FiringConsumer<L>,
) {
    let RuleSearch {
        values,
        degrees,
        alive,
        partial,
        next,
        stack,
    } = search;
    match table.conjunctions() {
        Conjunctions::Uniform {
            actions_per_cell,
            first_action,
            sums,
        } => {
            let cells = Cells {
                actions: &table.actions()[first_action as usize..],
                actions_per_cell: actions_per_cell as usize,
                sums,
            };
            fire_uniform(table, &cells, values, partial, &and, firing);
        }
        Conjunctions::Dense if !CELLS => {
            fire_dense(table, values, (alive, partial, next), &and, firing);
        }
        Conjunctions::Trie if !CELLS && !table.nodes().is_empty() => {
            for row in 0..L {
                fire_trie(table, row, degrees, partial, &and, firing);
            }
        }
        _ => {}
    }
    if CELLS {
        return;
    }
    let least = table.least_strength();
    let mut degree = [0.0; L];
    for program in table.programs() {
        let steps = &table.steps()[program.first_step as usize..program.end_step as usize];
        let actions = &table.actions()[program.first_action as usize..program.end_action as usize];
        let hedges = &table.hedges()[program.first_hedge as usize..program.end_hedge as usize];
        let strength = |degree: f64| fires(program.weight * degree, least);
        match steps {
            // The most common rule takes a single pass over the rows.
            [first, second] if L > 1 && second.op == Op::AND_LITERAL && hedges.is_empty() => {
                let first = &degrees[first.literal as usize];
                let second = &degrees[second.literal as usize];
                firing.act_with(actions, |row| {
                    strength(into_unit(and(first[row], second[row])))
                });
            }
            _ => {
                run(steps, degrees, (&and, &or), stack, &mut degree);
                change(&mut degree, strength);
                for hedge in hedges {
                    change(&mut degree, |strength| hedge.of(strength));
                }
                firing.act_with(actions, |row| degree[row]);
            }
        }
    }
}

/// Clamps to [0, 1] a degree that rounding may have moved slightly outside.
#[inline(always)]
fn into_unit(degree: f64) -> f64 {
    larger(0.0, smaller(1.0, degree))
}

/// Computes the degrees of an antecedent into `top`. `stack` must be at least as long as the depth of the program.
#[inline(always)]
pub(super) fn run<const L: usize>(
    steps: &[AntecedentStep],
    degrees: &[[f64; L]],
    (and, or): (impl Fn(f64, f64) -> f64, impl Fn(f64, f64) -> f64),
    stack: &mut [[f64; L]],
    top: &mut [f64; L],
) {
    let degree = |step: &AntecedentStep| &degrees[step.literal as usize];
    let mut rest = steps;
    match steps.split_first() {
        Some((first, after)) if first.op == Op::PUSH => {
            *top = *degree(first);
            rest = after;
        }
        _ => top.fill(0.0),
    }
    let mut depth = 0;
    for step in rest {
        match step.op {
            Op::AND_LITERAL => join(top, degree(step), &and),
            Op::OR_LITERAL => join(top, degree(step), &or),
            Op::PUSH => {
                stack[depth] = *top;
                depth += 1;
                *top = *degree(step);
            }
            Op::AND => {
                depth -= 1;
                join(top, &stack[depth], |top, below| and(below, top));
            }
            Op::OR => {
                depth -= 1;
                join(top, &stack[depth], |top, below| or(below, top));
            }
            _ => change(top, |top| 1.0 - top),
        }
    }
    change(top, into_unit);
}
