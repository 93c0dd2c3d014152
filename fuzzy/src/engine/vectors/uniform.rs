//! The firing strengths of a uniform table of three or four inputs.

use alloc::vec::Vec;

use fearless_simd::Level;
use fearless_simd::prelude::*;

use super::{Cuts, Lines, VectorConjunction, fires, four, lines, splat};
use crate::engine::arrays::OwnedTable;
use crate::table::operators::larger;
use crate::table::{Arrays as _, Conjunctions, Line, StrongestRule, has_cells_alone};

/// A uniform table with one action per cell and one output.
#[derive(Debug, Clone)]
pub(in super::super) struct Uniform {
    level: Level,
    axes: Vec<Axis>,
    cells: Vec<Cell>,
    and: VectorConjunction,
    /// The least firing strength: smaller ones count as 0.
    least: f64,
}

/// An input.
#[derive(Debug, Clone)]
struct Axis {
    input: usize,
    cuts: Cuts,
    /// The two lines of each interval.
    intervals: Vec<[Line; 2]>,
}

/// The action of the rule of a cell: see [`Action`](crate::table::Action).
#[derive(Debug, Clone)]
struct Cell {
    weight: f64,
    strength: u32,
    rule: u32,
}

/// The maximum number of cells that an evaluation visits.
const MAX_VISITED: usize = 16;
/// The maximum number of firing strengths.
const MAX_STRENGTHS: usize = 16;

impl Uniform {
    /// Prepares a table for vector instructions; `None` if it is not supported.
    pub(in super::super) fn new(table: &OwnedTable) -> Option<Self> {
        let Conjunctions::Uniform {
            actions_per_cell: 1,
            first_action,
            sums: false,
        } = table.conjunctions
        else {
            return None;
        };
        let fits = table.outputs.len() == 1
            && table.sizes.strengths as usize <= MAX_STRENGTHS
            && (3..=4).contains(&table.axes.len());
        if !fits || !has_cells_alone(table) {
            return None;
        }
        let mut axes = Vec::new();
        for axis in &table.axes {
            let cuts = Cuts::new(table, axis)?;
            let intervals = (0..cuts.intervals()).map(|interval| lines(table, axis, interval));
            axes.push(Axis {
                input: axis.input as usize,
                intervals: intervals.collect::<Option<_>>()?,
                cuts,
            });
        }
        let actions = table.actions.get(first_action as usize..)?.iter();
        Some(Uniform {
            level: Level::new(),
            axes,
            cells: actions
                .map(|action| Cell {
                    weight: action.weight,
                    strength: action.strength,
                    rule: action.rule,
                })
                .collect(),
            and: VectorConjunction::of(table)?,
            least: table.least_strength(),
        })
    }

    /// Computes the firing strengths at the values of the inputs, and returns the strongest rule.
    #[inline(always)]
    pub(in super::super) fn fire(
        &self,
        values: &[[f64; 1]],
        strengths: &mut [[f64; 1]],
    ) -> StrongestRule {
        let strongest = fearless_simd::dispatch!(self.level, simd => match &*self.axes {
            [a, b, c] => self.fire_by(simd, ([a, b], [c]), values, strengths),
            [a, b, c, d] => self.fire_by(simd, ([a, b], [c, d]), values, strengths),
            _ => None,
        });
        strongest.unwrap_or_else(|| {
            // Unreachable: there is a line for each interval, and a cell for each combination of lines.
            strengths.fill([0.0]);
            StrongestRule::NONE
        })
    }

    #[inline(always)]
    fn fire_by<S: Simd, const MORE: usize>(
        &self,
        simd: S,
        ([first, second], more): ([&Axis; 2], [&Axis; MORE]),
        values: &[[f64; 1]],
        strengths: &mut [[f64; 1]],
    ) -> Option<StrongestRule> {
        let at = |axis: &Axis| values.get(axis.input).map(|[x]| *x);
        let at = [at(first)?, at(second)?];
        let [x, y] = at;
        let ([a, b], [c, d]) = (*first.lines(simd, x)?, *second.lines(simd, y)?);
        let degrees = Lines::new([a, b, c, d]).degrees(simd, at);
        let of_cells = self.and.cells(simd, degrees);
        let [a, b, c, d] = [a, b, c, d].map(|line| line.literal);
        let mut visited = [of_cells; MAX_VISITED / 4];
        let mut cells = [a + c; MAX_VISITED];
        (cells[1], cells[2], cells[3]) = (b + c, a + d, b + d);
        let mut vectors = 1;
        for axis in more {
            let [x] = *values.get(axis.input)?;
            let [a, b] = *axis.lines(simd, x)?;
            let degrees = Lines::new([a, b, a, b]).degrees(simd, [x, x]);
            let [low, high, ..] = degrees.to_array();
            for i in 0..vectors {
                visited[vectors + i] = self.and.both(visited[i], splat(simd, high));
                visited[i] = self.and.both(visited[i], splat(simd, low));
            }
            for i in 0..4 * vectors {
                cells[4 * vectors + i] = cells[i] + b.literal;
                cells[i] += a.literal;
            }
            vectors *= 2;
        }
        let mut top = splat(simd, 0.0);
        // Adjacent cells often act on the same strength; with separate banks, no update waits for the previous one.
        let mut banks = [[0.0; MAX_STRENGTHS]; 4];
        for (i, degrees) in visited.iter_mut().enumerate().take(vectors) {
            let cell = |of: usize| self.cells.get(cells[4 * i + of] as usize);
            let four_cells = [cell(0)?, cell(1)?, cell(2)?, cell(3)?];
            let weights = four(simd, &four_cells.map(|cell| cell.weight));
            *degrees = fires(simd, weights * *degrees, self.least);
            top = top.max(*degrees);
            let of_cells = four_cells.into_iter().zip(degrees.to_array());
            for ((cell, strength), bank) in of_cells.zip(&mut banks) {
                let kept = &mut bank[cell.strength as usize % MAX_STRENGTHS];
                *kept = larger(*kept, strength);
            }
        }
        for (i, strength) in strengths.iter_mut().enumerate().take(MAX_STRENGTHS) {
            let [a, b, c, d] = [banks[0][i], banks[1][i], banks[2][i], banks[3][i]];
            *strength = [larger(larger(a, b), larger(c, d))];
        }
        let [a, b, c, d] = top.to_array();
        let coverage = larger(larger(a, b), larger(c, d));
        let mut strongest = 0;
        for (i, strengths) in visited.iter().enumerate().take(vectors) {
            strongest |= strengths.simd_eq(splat(simd, coverage)).to_bitmask() << (4 * i);
        }
        let mut rule = u32::MAX;
        while coverage > 0.0 && strongest != 0 {
            let cell = cells[strongest.trailing_zeros() as usize % MAX_VISITED];
            rule = rule.min(self.cells.get(cell as usize)?.rule);
            strongest &= strongest - 1;
        }
        Some(StrongestRule::of(coverage, rule))
    }
}

impl Axis {
    #[inline(always)]
    fn lines<S: Simd>(&self, simd: S, x: f64) -> Option<&[Line; 2]> {
        self.intervals.get(self.cuts.interval(simd, x))
    }
}
