//! Finding the plain ANDs that fire, in a table of cells or a trie.
//!
//! A firing strength of 0 has no effect, and 0 AND anything is 0. A plain AND is therefore evaluated only as long as
//! its degree is above 0. If the terms of each input sum to 1, this visits 16 of the 625 rules of 4 inputs with 5 terms
//! each.

use super::Arrays;
use super::actions::FiringConsumer;
use super::input::{along, curves, lines};
use super::rules::{Action, Axis, Dimension};

/// The degree of the first literals of a plain AND, with the offset of the cell or the index of the node that they lead
/// to, in each of `L` rows.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PartialConjunction<const L: usize = 1> {
    pub(super) degree: [f64; L],
    pub(super) at: [u32; L],
}

impl PartialConjunction {
    /// Creates an entry with the strength and the index of a rule, in the form that [`Activation`](super::Activation)
    /// expects.
    pub(crate) fn new(degree: f64, at: u32) -> Self {
        PartialConjunction {
            degree: [degree],
            at: [at],
        }
    }

    /// Returns the strength and the index.
    pub(crate) fn parts(&self) -> (f64, u32) {
        let ([degree], [at]) = (self.degree, self.at);
        (degree, at)
    }
}

impl<const L: usize> PartialConjunction<L> {
    /// The initial content of memory, with degree 0.
    pub const NONE: Self = PartialConjunction {
        degree: [0.0; L],
        at: [0; L],
    };

    /// The empty conjunction, with degree 1.
    const START: Self = PartialConjunction {
        degree: [1.0; L],
        at: [0; L],
    };

    /// Returns the conjunction of the two entries, combined by `and`.
    #[inline(always)]
    fn and(&self, other: &Self, and: impl Fn(f64, f64) -> f64) -> Self {
        let mut both = PartialConjunction::NONE;
        for row in 0..L {
            both.degree[row] = and(self.degree[row], other.degree[row]);
            both.at[row] = self.at[row] + other.at[row];
        }
        both
    }

    #[inline(always)]
    fn set(&mut self, row: usize, degree: f64, at: u32) {
        self.degree[row] = degree;
        self.at[row] = at;
    }
}

/// The cells of a uniform table.
pub(super) struct Cells<'a> {
    pub(super) actions: &'a [Action],
    pub(super) actions_per_cell: usize,
    pub(super) sums: bool,
}

impl Cells<'_> {
    #[inline(always)]
    pub(super) fn actions_of(&self, cell: u32) -> &[Action] {
        let first = cell as usize * self.actions_per_cell;
        &self.actions[first..first + self.actions_per_cell]
    }
}

#[inline(always)]
pub(super) fn fire_uniform<A: Arrays, const L: usize>(
    table: &A,
    cells: &Cells<'_>,
    values: &[[f64; L]],
    partial: &mut [PartialConjunction<L>],
    and: impl Fn(f64, f64) -> f64,
    firing: &mut impl FiringConsumer<L>,
) {
    if let [first, second] = table.axes() {
        let [a, b] = &at(table, first, values);
        let [c, d] = &at(table, second, values);
        let mut reached = [*a, *b, *a, *b];
        for (cell, other) in reached.iter_mut().zip([c, c, d, d]) {
            // Without this check between the pairs, the compiler combines the comparisons of the four pairs and selects
            // by branches that a processor mispredicts. The check fails only in a damaged table.
            if L == 1 && (cell.at[0] + other.at[0]) as usize >= cells.actions.len() {
                return;
            }
            *cell = cell.and(other, &and);
        }
        firing.act_in_cells(cells, &mut reached);
        return;
    }
    partial[0] = PartialConjunction::START;
    let mut count = 1;
    for axis in table.axes() {
        let [a, b] = &at(table, axis, values);
        let (first, others) = partial.split_at_mut(count);
        for (cell, other) in first.iter_mut().zip(others) {
            *other = cell.and(b, &and);
            *cell = cell.and(a, &and);
        }
        count *= 2;
    }
    firing.act_in_cells(cells, &mut partial[..count]);
}

/// Returns the degrees and offsets of the two lines on the interval that contains the value of the axis' input.
#[inline(always)]
fn at<A: Arrays, const L: usize>(
    table: &A,
    axis: &Axis,
    values: &[[f64; L]],
) -> [PartialConjunction<L>; 2] {
    let values = &values[axis.input as usize];
    let cuts = &table.cuts()[axis.first_cut as usize..axis.end_cut as usize];
    let mut intervals = [0u64; L];
    for cuts in cuts.chunks_exact(4) {
        for cut in cuts {
            for (interval, x) in intervals.iter_mut().zip(values) {
                *interval += u64::from(*x >= *cut);
            }
        }
    }
    // The parameters are gathered first, so that the arithmetic runs on whole rows.
    let mut gathered = [[[0.0; L]; 4]; 2];
    let mut reached = [PartialConjunction::NONE; 2];
    for row in 0..L {
        let first = axis.first_line as usize + 2 * intervals[row] as usize;
        let lines = &table.lines()[first..first + 2];
        for side in 0..2 {
            let line = &lines[side];
            let [foot, run, base, rise] = &mut gathered[side];
            (foot[row], run[row], base[row], rise[row]) =
                (line.foot, line.run, line.base, line.rise);
            reached[side].at[row] = line.literal;
        }
    }
    for side in 0..2 {
        let [foot, run, base, rise] = &gathered[side];
        for row in 0..L {
            let along = (values[row] - foot[row]) / run[row];
            reached[side].degree[row] = base[row] + rise[row] * along;
        }
    }
    reached
}

/// Extends partial ANDs input by input. The last input triggers the actions.
#[inline(always)]
pub(super) fn fire_dense<A: Arrays, const L: usize>(
    table: &A,
    values: &[[f64; L]],
    (alive, mut partial, mut next): (
        &mut [PartialConjunction<L>],
        &mut [PartialConjunction<L>],
        &mut [PartialConjunction<L>],
    ),
    and: impl Fn(f64, f64) -> f64,
    firing: &mut impl FiringConsumer<L>,
) {
    let actions = |cell: u32| {
        let cell = cell as usize;
        let (start, end) = (table.cells()[cell], table.cells()[cell + 1]);
        &table.actions()[start as usize..end as usize]
    };
    let Some((last, others)) = table.dimensions().split_last() else {
        for row in 0..L {
            firing.act(actions(0), row, 1.0);
        }
        return;
    };
    partial[0] = PartialConjunction::START;
    let mut counts = [1; L];
    for dimension in others {
        let alive_here = alive_terms(table, dimension, values, alive);
        for row in 0..L {
            let mut widened = 0;
            for cell in &partial[..counts[row]] {
                for term in &alive[..alive_here[row]] {
                    // The degree is always written, but counted only if it is above 0, because a branch would be
                    // mispredicted.
                    let degree = and(cell.degree[row], term.degree[row]);
                    next[widened].set(row, degree, cell.at[row] + term.at[row]);
                    widened += usize::from(degree > 0.0);
                }
            }
            counts[row] = widened;
        }
        core::mem::swap(&mut partial, &mut next);
    }
    let alive_here = alive_terms(table, last, values, alive);
    for row in 0..L {
        for cell in &partial[..counts[row]] {
            for term in &alive[..alive_here[row]] {
                let degree = and(cell.degree[row], term.degree[row]);
                firing.act(actions(cell.at[row] + term.at[row]), row, degree);
            }
        }
    }
}

/// Writes the degrees above 0 with their offsets. Returns how many there are in each row.
#[inline(always)]
fn alive_terms<A: Arrays, const L: usize>(
    table: &A,
    dimension: &Dimension,
    values: &[[f64; L]],
    alive: &mut [PartialConjunction<L>],
) -> [usize; L] {
    let input = &table.inputs()[dimension.input as usize];
    let values = &values[dimension.input as usize];
    let mut counts = [0; L];
    let mut add = |row: usize, literal: u32, degree: f64| {
        alive[counts[row]].set(row, degree, literal * dimension.stride);
        counts[row] += usize::from(degree > 0.0);
    };
    for (row, &x) in values.iter().enumerate() {
        for line in lines(table, input, x) {
            add(row, line.literal, line.degree(x));
        }
    }
    let mut degrees = [0.0; L];
    for curve in curves(table, input) {
        along(table, curve, values, &mut degrees);
        for (row, &degree) in degrees.iter().enumerate() {
            add(row, curve.literal, degree);
        }
    }
    if dimension.any != Dimension::NONE {
        for row in 0..L {
            add(row, dimension.any, 1.0);
        }
    }
    counts
}

/// Traverses the trie in one row.
#[inline(always)]
pub(super) fn fire_trie<A: Arrays, const L: usize>(
    table: &A,
    row: usize,
    degrees: &[[f64; L]],
    path: &mut [PartialConjunction<L>],
    and: impl Fn(f64, f64) -> f64,
    firing: &mut impl FiringConsumer<L>,
) {
    path[0] = PartialConjunction::START;
    let mut open = 1usize;
    // In a tree no node is reached twice. In a damaged table that is not a tree, this limit bounds the time.
    for _ in table.nodes() {
        let Some(left) = open.checked_sub(1) else {
            return;
        };
        open = left;
        let (degree, at) = (path[open].degree[row], path[open].at[row]);
        let node = &table.nodes()[at as usize];
        let range = node.first_action as usize..node.end_action as usize;
        firing.act(&table.actions()[range], row, degree);
        for edge in &table.edges()[node.first_edge as usize..node.end_edge as usize] {
            let both = and(degree, degrees[edge.literal as usize][row]);
            // In a damaged table there may not be enough room.
            if both > 0.0
                && let Some(next) = path.get_mut(open)
            {
                next.set(row, both, edge.node);
                open += 1;
            }
        }
    }
}
