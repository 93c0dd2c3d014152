//! Fires all rules: plain ANDs that a table or a trie finds, all others as programs.

use core::hint::select_unpredictable;
use core::ops::DerefMut;

use super::blocks::fire_blocks;
use super::conjunctions::{Cells, Partial, fire_dense, fire_trie, fire_uniform};
use super::input::degrees_in_rows;
use super::operators::{larger, smaller};
use super::results::number_of;
use super::rules::{Action, Op, Step};
use super::{Arrays, Buffers, Conjunction, Conjunctions, Disjunction};
use crate::rows::{change, join};

/// The strongest rule of an output in each of `L` rows: the first in the model of several equally strong rules, in whatever
/// order they fire.
#[derive(Debug, Clone, Copy)]
pub struct Strongest<const L: usize = 1> {
    pub(super) strength: [f64; L],
    /// Its [number](number_of), infinite where there is none.
    pub(super) rule: [f64; L],
}

impl Strongest {
    /// The rule of this index.
    #[cfg(feature = "simd")]
    pub(crate) fn of(strength: f64, rule: u32) -> Self {
        Strongest {
            strength: [strength],
            rule: [number_of(rule)],
        }
    }
}

impl<const L: usize> Strongest<L> {
    /// No rule yet.
    pub const NONE: Self = Strongest {
        strength: [0.0; L],
        rule: [f64::INFINITY; L],
    };

    /// Takes the firing strengths of a rule that stands behind all before it. As [`Strongest::or`], it takes no branch.
    #[inline(always)]
    fn or_later(&mut self, row: usize, strength: f64, rule: f64) {
        let (top, first) = (self.strength[row], self.rule[row]);
        self.rule[row] = select_unpredictable(strength > top, rule, first);
        self.strength[row] = larger(strength, top);
    }

    /// Takes no branch, which a processor could mispredict.
    #[inline(always)]
    fn or(&mut self, row: usize, strength: f64, rule: f64) {
        let (top, first) = (self.strength[row], self.rule[row]);
        let of_equal = select_unpredictable(strength == top, smaller(rule, first), first);
        self.rule[row] = select_unpredictable(strength > top, rule, of_equal);
        self.strength[row] = larger(strength, top);
    }
}

/// A firing strength, or 0 below the least one.
#[inline(always)]
pub(super) fn fires(strength: f64, least: f64) -> f64 {
    if strength < least { 0.0 } else { strength }
}

/// What is done with the rules that fire.
pub(super) trait Act<const L: usize> {
    /// Takes rules with the degree of their antecedent in a row.
    fn act(&mut self, actions: &[Action], row: usize, degree: f64);

    /// Takes rules with their firing strength in each row, whatever their weights.
    fn act_with(&mut self, actions: &[Action], strength: impl Fn(usize) -> f64);

    /// Takes the rules of cells of a uniform table, which are of no use afterwards.
    #[inline(always)]
    fn act_in_cells(&mut self, cells: &Cells<'_>, reached: &mut [Partial<L>]) {
        for cell in reached {
            for row in 0..L {
                self.act(cells.actions_of(cell.at[row]), row, cell.degree[row]);
            }
        }
    }
}

/// The firing strengths and strongest rules that actions update.
#[repr(C, align(64))]
struct Firing<'m, const L: usize> {
    /// The strongest program where there is one output, in registers: each rule would wait for memory.
    one: Strongest<L>,
    least: f64,
    strengths: &'m mut [[f64; L]],
    strongest: &'m mut [Strongest<L>],
    /// The [number](number_of) of the last rule in the model among the programs that have fired.
    latest: f64,
}

/// Calls `take` with what is kept of each row; the two are known to be apart.
#[inline(always)]
fn each_row<const L: usize>(
    kept: &mut [f64; L],
    strongest: &mut Strongest<L>,
    take: impl Fn(&mut f64, &mut Strongest<L>, usize),
) {
    for (row, kept) in kept.iter_mut().enumerate() {
        take(kept, strongest, row);
    }
}

impl<const L: usize> Firing<'_, L> {
    /// All rules have fired.
    #[inline(always)]
    fn end(self) {
        if let [strongest] = self.strongest {
            let mut all = self.one;
            for row in 0..L {
                all.or(row, strongest.strength[row], strongest.rule[row]);
            }
            *strongest = all;
        }
    }
}

impl<const L: usize> Act<L> for Firing<'_, L> {
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
                (0, true) => each_row(kept, strongest, |kept, strongest, row| {
                    let strength = strength(row);
                    *kept = larger(*kept, strength);
                    strongest.or_later(row, strength, rule);
                }),
                (0, false) => each_row(kept, strongest, |kept, strongest, row| {
                    let strength = strength(row);
                    *kept = larger(*kept, strength);
                    strongest.or(row, strength, rule);
                }),
                _ => each_row(kept, strongest, |kept, strongest, row| {
                    let strength = strength(row);
                    *kept += strength;
                    strongest.or(row, strength, rule);
                }),
            }
        }
    }

    #[inline(always)]
    fn act_in_cells(&mut self, cells: &Cells<'_>, reached: &mut [Partial<L>]) {
        if let ([one], 1, false) = (&mut *self.strongest, cells.actions_a_cell, cells.sums) {
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

/// Fires the rules of cells that have an action each, on one output, and returns the strongest.
#[inline(always)]
fn fire_cells<const L: usize>(
    cells: &Cells<'_>,
    reached: &mut [Partial<L>],
    strengths: &mut [[f64; L]],
    least: f64,
) -> Strongest<L> {
    let mut strongest = Strongest::NONE;
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

/// Whether a uniform table finds all rules.
pub(crate) fn has_cells_alone<A: Arrays>(table: &A) -> bool {
    let is_uniform = matches!(table.conjunctions(), Conjunctions::Uniform { .. });
    is_uniform && table.programs().is_empty()
}

/// Fires all rules on the values in the scratch memory into its firing strengths and strongest rules. `CELLS` is
/// [`has_cells_alone`]: the code for other tables would take registers from that of cells.
#[inline(always)]
pub(crate) fn fire<A, N, P, S, const L: usize, const CELLS: bool>(
    table: &A,
    scratch: &mut Buffers<N, P, S>,
) where
    A: Arrays,
    N: DerefMut<Target = [[f64; L]]>,
    P: DerefMut<Target = [Partial<L>]>,
    S: DerefMut<Target = [Strongest<L>]>,
{
    let (finding, mut firing) = ready(table, scratch);
    fire_into::<A, L, CELLS>(table, finding, &mut firing);
    if !CELLS {
        firing.end();
    }
}

/// As [`fire`], for rules of any kind in one row.
#[inline(always)]
pub(crate) fn fire_row<A, N, P, S>(table: &A, scratch: &mut Buffers<N, P, S>)
where
    A: Arrays,
    N: DerefMut<Target = [[f64; 1]]>,
    P: DerefMut<Target = [Partial]>,
    S: DerefMut<Target = [Strongest]>,
{
    let (finding, mut firing) = ready(table, scratch);
    fire_row_into(table, finding, &mut firing);
    firing.end();
}

/// Nothing has fired yet.
#[inline(always)]
fn ready<'m, A, N, P, S, const L: usize>(
    table: &A,
    scratch: &'m mut Buffers<N, P, S>,
) -> (Finding<'m, L>, Firing<'m, L>)
where
    A: Arrays,
    N: DerefMut<Target = [[f64; L]]>,
    P: DerefMut<Target = [Partial<L>]>,
    S: DerefMut<Target = [Strongest<L>]>,
{
    // Models with one output are the common case; this saves the call of `fill`.
    match &mut *scratch.strongest {
        [one] => *one = Strongest::NONE,
        all => all.fill(Strongest::NONE),
    }
    let (finding, strengths, strongest) = scratch.split();
    clear(strengths);
    let firing = Firing {
        least: table.least_strength(),
        strengths,
        strongest,
        one: Strongest::NONE,
        latest: 0.0,
    };
    (finding, firing)
}

/// Makes all 0. A few are written here, because a call of `memset` takes longer.
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

/// The memory in which the rules that fire are found.
pub(super) struct Finding<'m, const L: usize> {
    values: &'m [[f64; L]],
    degrees: &'m mut [[f64; L]],
    alive: &'m mut [Partial<L>],
    partial: &'m mut [Partial<L>],
    next: &'m mut [Partial<L>],
    stack: &'m mut [[f64; L]],
}

impl<'m, const L: usize> Finding<'m, L> {
    pub(super) fn values(&self) -> &'m [[f64; L]] {
        self.values
    }

    /// Writes the degrees of all literals, where rules read them by index.
    #[inline(always)]
    fn find_degrees<A: Arrays>(&mut self, table: &A) {
        if self.degrees.is_empty() {
            return;
        }
        if !table.lines().is_empty() {
            self.degrees.fill([0.0; L]);
        }
        for (input, values) in table.inputs().iter().zip(self.values) {
            // In a damaged table an input without literals may begin anywhere.
            let of_input = self.degrees.get_mut(input.first_literal as usize..);
            degrees_in_rows(table, input, values, of_input.unwrap_or_default());
        }
    }
}

impl<N, P, S> Buffers<N, P, S> {
    /// The memory in which rules are found, and that of what they do.
    #[inline(always)]
    pub(super) fn split<const L: usize>(
        &mut self,
    ) -> (Finding<'_, L>, &mut [[f64; L]], &mut [Strongest<L>])
    where
        N: DerefMut<Target = [[f64; L]]>,
        P: DerefMut<Target = [Partial<L>]>,
        S: DerefMut<Target = [Strongest<L>]>,
    {
        let finding = Finding {
            values: &self.values,
            degrees: &mut self.degrees,
            alive: &mut self.alive,
            partial: &mut self.partial,
            next: &mut self.next,
            stack: &mut self.stack,
        };
        (finding, &mut self.strengths, &mut self.strongest)
    }
}

/// Finds the rules of any kind that fire on one row, and gives them to `firing`.
#[inline(always)]
pub(super) fn fire_row_into<A: Arrays>(
    table: &A,
    mut finding: Finding<'_, 1>,
    firing: &mut impl Act<1>,
) {
    if table.blocks().is_empty() {
        return fire_into::<A, 1, false>(table, finding, firing);
    }
    finding.find_degrees(table);
    let Finding {
        degrees,
        partial,
        stack,
        ..
    } = finding;
    fire_blocks(table, degrees, partial, stack, firing);
}

/// Finds the rules that fire on the values where there are no blocks, and gives them to `firing`.
#[inline(always)]
fn fire_into<A: Arrays, const L: usize, const CELLS: bool>(
    table: &A,
    mut finding: Finding<'_, L>,
    firing: &mut impl Act<L>,
) {
    if !CELLS {
        finding.find_degrees(table);
    }
    // The common operators, so that the loops do not branch on the operator.
    match (table.and(), table.or()) {
        (Conjunction::Minimum, Disjunction::Maximum) => {
            fire_with::<A, L, CELLS>(table, smaller, larger, finding, firing);
        }
        (Conjunction::Product, or) => {
            fire_with::<A, L, CELLS>(table, |a, b| a * b, |a, b| or.of(a, b), finding, firing);
        }
        (and, or) => {
            fire_with::<A, L, CELLS>(
                table,
                |a, b| and.of(a, b),
                |a, b| or.of(a, b),
                finding,
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
    finding: Finding<'_, L>,
    firing: &mut impl Act<L>,
) {
    let Finding {
        values,
        degrees,
        alive,
        partial,
        next,
        stack,
    } = finding;
    match table.conjunctions() {
        Conjunctions::Uniform {
            actions_a_cell,
            first_action,
            sums,
        } => {
            let cells = Cells {
                actions: &table.actions()[first_action as usize..],
                actions_a_cell: actions_a_cell as usize,
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
            // The commonest rule, in one pass over the rows.
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

/// Rounding may have led out of [0, 1].
#[inline(always)]
fn into_unit(degree: f64) -> f64 {
    larger(0.0, smaller(1.0, degree))
}

/// Writes the degrees of an antecedent to `top`. `stack` holds at least the depth of the program.
#[inline(always)]
pub(super) fn run<const L: usize>(
    steps: &[Step],
    degrees: &[[f64; L]],
    (and, or): (impl Fn(f64, f64) -> f64, impl Fn(f64, f64) -> f64),
    stack: &mut [[f64; L]],
    top: &mut [f64; L],
) {
    let degree = |step: &Step| &degrees[step.literal as usize];
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
