//! Fires all rules: plain ANDs from a table of cells or a trie, all others as programs.
//!
//! A firing strength of 0 has no effect, and 0 AND anything is 0. So a plain AND is followed only while its degree is over 0:
//! with terms that sum to 1, that is 16 of the 625 rules of 4 inputs with 5 terms.

use core::ops::DerefMut;

use super::blocks::{act, fire_blocks};
use super::input::degrees;
use super::operators::{larger, smaller};
use super::rules::{Action, Axis, Dimension, Op, Step};
use super::{Arrays, Buffers, Conjunction, Conjunctions, Disjunction, Line};

/// The degree of the first literals of a plain AND, and the offset of the cell or the index of the node they lead to.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Partial {
    pub(super) degree: f64,
    pub(super) at: u32,
}

impl Line {
    /// Its degree at `x` and its offset among the cells.
    #[inline(always)]
    fn at(&self, x: f64) -> Partial {
        Partial {
            degree: self.degree(x),
            at: self.literal,
        }
    }
}

impl Partial {
    /// The strength of a rule and its index, as [`Activation`](super::Activation) takes them.
    pub(crate) fn new(degree: f64, at: u32) -> Self {
        Partial { degree, at }
    }

    /// The strength and the index.
    pub(crate) fn parts(&self) -> (f64, u32) {
        (self.degree, self.at)
    }

    /// No literal yet.
    pub const NONE: Partial = Partial { degree: 0.0, at: 0 };
}

/// The strongest rule of an output: the bits of its firing strength above those of `u32::MAX` less its index. The bits of
/// non-negative numbers are ordered as the numbers are. So the largest is the strongest rule, and the first in the model of
/// several equally strong rules, in whatever order they fire. Finding it takes no branch.
#[derive(Debug, Clone, Copy)]
pub struct Strongest(u128);

impl Strongest {
    /// No rule yet.
    pub const NONE: Strongest = Strongest(0);

    #[inline(always)]
    fn or(self, strength: f64, rule: u32) -> Self {
        let bits = u128::from(strength.to_bits()) << 32 | u128::from(u32::MAX - rule);
        Strongest(if bits > self.0 { bits } else { self.0 })
    }

    /// The firing strength, and the index of the rule where it is over 0.
    #[inline(always)]
    pub(super) fn rule(self) -> (f64, Option<usize>) {
        let strength = f64::from_bits((self.0 >> 32) as u64);
        let rule = u32::MAX - self.0 as u32;
        (strength, (strength > 0.0).then_some(rule as usize))
    }
}

impl Action {
    /// Updates the firing strength and returns the strongest rule so far.
    #[inline(always)]
    fn act<const SUMS: bool>(
        &self,
        degree: f64,
        least: f64,
        strengths: &mut [f64],
        strongest: Strongest,
    ) -> Strongest {
        self.act_with::<SUMS>(fires(self.weight * degree, least), strengths, strongest)
    }

    /// As [`Action::act`], with a firing strength.
    #[inline(always)]
    fn act_with<const SUMS: bool>(
        &self,
        strength: f64,
        strengths: &mut [f64],
        strongest: Strongest,
    ) -> Strongest {
        let kept = &mut strengths[self.strength as usize];
        *kept = if SUMS && self.sums != 0 {
            *kept + strength
        } else {
            larger(*kept, strength)
        };
        strongest.or(strength, self.rule)
    }
}

/// A firing strength, or 0 below the least one.
#[inline(always)]
pub(super) fn fires(strength: f64, least: f64) -> f64 {
    if strength < least { 0.0 } else { strength }
}

/// What is done with the rules that fire.
pub(super) trait Act {
    /// Takes rules with the degree of their antecedent.
    fn act(&mut self, actions: &[Action], degree: f64);

    /// Takes rules with their firing strength, whatever their weights.
    fn act_with(&mut self, actions: &[Action], strength: f64);

    /// Takes the rules of cells of a uniform table.
    #[inline(always)]
    fn act_in_cells(&mut self, cells: &Cells<'_>, reached: &[Partial]) {
        for cell in reached {
            self.act(cells.actions_of(cell), cell.degree);
        }
    }
}

/// The firing strengths and strongest rules that actions update.
struct Firing<'m> {
    least: f64,
    strengths: &'m mut [f64],
    strongest: &'m mut [Strongest],
}

impl Act for Firing<'_> {
    #[inline(always)]
    fn act(&mut self, actions: &[Action], degree: f64) {
        for action in actions {
            let strongest = &mut self.strongest[action.output as usize];
            *strongest = action.act::<true>(degree, self.least, self.strengths, *strongest);
        }
    }

    #[inline(always)]
    fn act_with(&mut self, actions: &[Action], strength: f64) {
        for action in actions {
            let strongest = &mut self.strongest[action.output as usize];
            *strongest = action.act_with::<true>(strength, self.strengths, *strongest);
        }
    }

    #[inline(always)]
    fn act_in_cells(&mut self, cells: &Cells<'_>, reached: &[Partial]) {
        if let ([strongest], 1, false) = (&mut *self.strongest, cells.actions_a_cell, cells.sums) {
            let mut top = *strongest;
            for cell in reached {
                let action = &cells.actions[cell.at as usize];
                top = action.act::<false>(cell.degree, self.least, self.strengths, top);
            }
            *strongest = top;
            return;
        }
        for cell in reached {
            self.act(cells.actions_of(cell), cell.degree);
        }
    }
}

/// Fires all rules on the values in the scratch memory into its firing strengths and strongest rules.
#[inline(always)]
pub(super) fn fire<A, N, P, S>(table: &A, scratch: &mut Buffers<N, P, S>)
where
    A: Arrays,
    N: DerefMut<Target = [f64]>,
    P: DerefMut<Target = [Partial]>,
    S: DerefMut<Target = [Strongest]>,
{
    // Models with one output are the common case; this saves the call of `fill`.
    match &mut *scratch.strongest {
        [one] => *one = Strongest::NONE,
        all => all.fill(Strongest::NONE),
    }
    let (finding, strengths, strongest) = scratch.split();
    strengths.fill(0.0);
    let mut firing = Firing {
        least: table.least_strength(),
        strengths,
        strongest,
    };
    fire_into(table, finding, &mut firing);
}

/// The memory in which the rules that fire are found.
pub(super) struct Finding<'m> {
    values: &'m [f64],
    degrees: &'m mut [f64],
    alive: &'m mut [Partial],
    partial: &'m mut [Partial],
    next: &'m mut [Partial],
    stack: &'m mut [f64],
}

impl<'m> Finding<'m> {
    pub(super) fn values(&self) -> &'m [f64] {
        self.values
    }
}

impl<N, P, S> Buffers<N, P, S>
where
    N: DerefMut<Target = [f64]>,
    P: DerefMut<Target = [Partial]>,
    S: DerefMut<Target = [Strongest]>,
{
    /// The memory in which rules are found, and that of what they do.
    #[inline(always)]
    pub(super) fn split(&mut self) -> (Finding<'_>, &mut [f64], &mut [Strongest]) {
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

/// Finds the rules that fire on the values, and gives them to `firing`.
#[inline(always)]
pub(super) fn fire_into<A: Arrays>(table: &A, finding: Finding<'_>, firing: &mut impl Act) {
    if !finding.degrees.is_empty() {
        finding.degrees.fill(0.0);
        for (input, &value) in table.inputs().iter().zip(finding.values) {
            degrees(table, input, value, |literal, degree| {
                finding.degrees[(input.first_literal + literal) as usize] = degree;
            });
        }
    }
    if !table.blocks().is_empty() {
        let Finding {
            degrees,
            partial,
            stack,
            ..
        } = finding;
        return fire_blocks(table, degrees, partial, stack, firing);
    }
    // The common operators, so that the loops do not branch on the operator.
    match (table.and(), table.or()) {
        (Conjunction::Minimum, Disjunction::Maximum) => {
            fire_with(table, smaller, larger, finding, firing);
        }
        (Conjunction::Product, or) => {
            fire_with(table, |a, b| a * b, |a, b| or.of(a, b), finding, firing);
        }
        (and, or) => {
            fire_with(
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
fn fire_with<A: Arrays>(
    table: &A,
    and: impl Fn(f64, f64) -> f64,
    or: impl Fn(f64, f64) -> f64,
    finding: Finding<'_>,
    firing: &mut impl Act,
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
        Conjunctions::Dense => {
            fire_dense(table, values, (alive, partial, next), &and, firing);
        }
        Conjunctions::Trie => fire_trie(table, degrees, partial, &and, firing),
    }
    for program in table.programs() {
        let steps = &table.steps()[program.first_step as usize..program.end_step as usize];
        let degree = run(steps, degrees, &and, &or, stack);
        let strength = fires(program.weight * degree, table.least_strength());
        if strength > 0.0 {
            act(table, program, strength, firing);
        }
    }
}

#[inline(always)]
fn fire_uniform<A: Arrays>(
    table: &A,
    cells: &Cells<'_>,
    values: &[f64],
    partial: &mut [Partial],
    and: impl Fn(f64, f64) -> f64,
    firing: &mut impl Act,
) {
    let both = |p: Partial, q: Partial| Partial {
        degree: and(p.degree, q.degree),
        at: p.at + q.at,
    };
    if let [first, second] = table.axes() {
        let [a, b] = at(table, first, values);
        let [c, d] = at(table, second, values);
        firing.act_in_cells(cells, &[both(a, c), both(b, c), both(a, d), both(b, d)]);
        return;
    }
    partial[0] = Partial { degree: 1.0, at: 0 };
    let mut count = 1;
    for axis in table.axes() {
        let [a, b] = at(table, axis, values);
        let (first, others) = partial.split_at_mut(count);
        for (cell, other) in first.iter_mut().zip(others) {
            *other = both(*cell, b);
            *cell = both(*cell, a);
        }
        count *= 2;
    }
    firing.act_in_cells(cells, &partial[..count]);
}

/// The degrees and offsets of the two lines on the interval that holds the axis' input.
#[inline(always)]
fn at<A: Arrays>(table: &A, axis: &Axis, values: &[f64]) -> [Partial; 2] {
    let x = values[axis.input as usize];
    let mut interval = 0;
    let cuts = &table.cuts()[axis.first_cut as usize..axis.end_cut as usize];
    for cuts in cuts.chunks_exact(4) {
        for cut in cuts {
            interval += usize::from(x >= *cut);
        }
    }
    let first = axis.first_line as usize + 2 * interval;
    let lines = &table.lines()[first..first + 2];
    [lines[0].at(x), lines[1].at(x)]
}

/// Extends partial ANDs input by input. The last input acts at once.
#[inline(always)]
fn fire_dense<A: Arrays>(
    table: &A,
    values: &[f64],
    (alive, mut partial, mut next): (&mut [Partial], &mut [Partial], &mut [Partial]),
    and: impl Fn(f64, f64) -> f64,
    firing: &mut impl Act,
) {
    let actions = |cell: usize| {
        let (start, end) = (table.cells()[cell], table.cells()[cell + 1]);
        &table.actions()[start as usize..end as usize]
    };
    let Some((last, others)) = table.dimensions().split_last() else {
        firing.act(actions(0), 1.0);
        return;
    };
    partial[0] = Partial { degree: 1.0, at: 0 };
    let mut count = 1;
    for dimension in others {
        let alive_here = alive_terms(table, dimension, values, alive);
        let mut widened = 0;
        for cell in &partial[..count] {
            for term in &alive[..alive_here] {
                // Always written, but counted only where it is over 0: a branch would be mispredicted.
                let degree = and(cell.degree, term.degree);
                next[widened] = Partial {
                    degree,
                    at: cell.at + term.at,
                };
                widened += usize::from(degree > 0.0);
            }
        }
        core::mem::swap(&mut partial, &mut next);
        count = widened;
    }
    let alive_here = alive_terms(table, last, values, alive);
    for cell in &partial[..count] {
        for term in &alive[..alive_here] {
            let degree = and(cell.degree, term.degree);
            firing.act(actions((cell.at + term.at) as usize), degree);
        }
    }
}

/// Writes the degrees over 0 and their offsets, and returns their number.
#[inline(always)]
fn alive_terms<A: Arrays>(
    table: &A,
    dimension: &Dimension,
    values: &[f64],
    alive: &mut [Partial],
) -> usize {
    let input = dimension.input as usize;
    let mut count = 0;
    degrees(
        table,
        &table.inputs()[input],
        values[input],
        |literal, degree| {
            alive[count] = Partial {
                degree,
                at: literal * dimension.stride,
            };
            count += usize::from(degree > 0.0);
        },
    );
    if dimension.any != Dimension::NONE {
        alive[count] = Partial {
            degree: 1.0,
            at: dimension.any * dimension.stride,
        };
        count += 1;
    }
    count
}

fn fire_trie<A: Arrays>(
    table: &A,
    degrees: &[f64],
    path: &mut [Partial],
    and: impl Fn(f64, f64) -> f64,
    firing: &mut impl Act,
) {
    path[0] = Partial { degree: 1.0, at: 0 };
    let mut open = 1usize;
    // In a tree no node is reached twice. Where a damaged table is no tree, time stays bounded.
    for _ in table.nodes() {
        let Some(left) = open.checked_sub(1) else {
            return;
        };
        open = left;
        let Partial { degree, at } = path[open];
        let node = &table.nodes()[at as usize];
        let range = node.first_action as usize..node.end_action as usize;
        firing.act(&table.actions()[range], degree);
        for edge in &table.edges()[node.first_edge as usize..node.end_edge as usize] {
            let both = and(degree, degrees[edge.literal as usize]);
            // In a damaged table there may be no room.
            if both > 0.0
                && let Some(next) = path.get_mut(open)
            {
                *next = Partial {
                    degree: both,
                    at: edge.node,
                };
                open += 1;
            }
        }
    }
}

/// The cells of a uniform table.
pub(super) struct Cells<'a> {
    actions: &'a [Action],
    actions_a_cell: usize,
    sums: bool,
}

impl Cells<'_> {
    #[inline(always)]
    fn actions_of(&self, cell: &Partial) -> &[Action] {
        let first = cell.at as usize * self.actions_a_cell;
        &self.actions[first..first + self.actions_a_cell]
    }
}

/// The degree of an antecedent. `stack` holds at least the depth of the program.
#[inline(always)]
pub(super) fn run(
    steps: &[Step],
    degrees: &[f64],
    and: impl Fn(f64, f64) -> f64,
    or: impl Fn(f64, f64) -> f64,
    stack: &mut [f64],
) -> f64 {
    let mut depth = 0;
    let mut top = 0.0;
    for step in steps {
        let degree = || degrees[step.literal as usize];
        top = match step.op {
            Op::PUSH => {
                stack[depth] = top;
                depth += 1;
                degree()
            }
            Op::AND_LITERAL => and(top, degree()),
            Op::OR_LITERAL => or(top, degree()),
            Op::AND => {
                depth -= 1;
                and(stack[depth], top)
            }
            Op::OR => {
                depth -= 1;
                or(stack[depth], top)
            }
            _ => 1.0 - top,
        };
    }
    larger(0.0, smaller(1.0, top))
}
