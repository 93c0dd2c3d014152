//! The firing strengths of a uniform table of three or four inputs.

use alloc::vec::Vec;

use fearless_simd::prelude::*;
use fearless_simd::{Level, f64x4};

use super::{And, Cuts, fires, four, lines, splat};
use crate::engine::arrays::OwnedTable;
use crate::table::operators::larger;
use crate::table::{Arrays as _, Conjunctions, Strongest, has_cells_alone};

/// A uniform table that has an action a cell, on one output.
#[derive(Debug, Clone)]
pub(in super::super) struct Uniform {
    level: Level,
    axes: Vec<Axis>,
    cells: Vec<Cell>,
    and: And,
    /// A firing strength below it counts as 0.
    least: f64,
}

/// An input, with an entry for each interval.
#[derive(Debug, Clone)]
struct Axis {
    input: usize,
    cuts: Cuts,
    spans: Vec<Span>,
}

/// Of the two [`Line`](crate::table::Line)s of an interval.
#[derive(Debug, Clone)]
struct Span {
    base: [f64; 2],
    rise: [f64; 2],
    foot: [f64; 2],
    run: [f64; 2],
    offset: [u32; 2],
}

/// What the rule of a cell does: [`Action`](crate::table::Action).
#[derive(Debug, Clone)]
struct Cell {
    weight: f64,
    strength: u32,
    rule: u32,
}

/// The most cells that a value of each input visits.
const MOST_VISITED: usize = 16;
/// The most firing strengths.
const MOST_STRENGTHS: usize = 16;

impl Uniform {
    /// `None` where the table is another one.
    pub(in super::super) fn new(table: &OwnedTable) -> Option<Self> {
        let Conjunctions::Uniform {
            actions_a_cell: 1,
            first_action,
            sums: false,
        } = table.conjunctions
        else {
            return None;
        };
        let fits = table.outputs.len() == 1
            && table.sizes.strengths as usize <= MOST_STRENGTHS
            && (3..=4).contains(&table.axes.len());
        if !fits || !has_cells_alone(table) {
            return None;
        }
        let mut axes = Vec::new();
        for axis in &table.axes {
            let cuts = Cuts::new(table, axis)?;
            let span = |interval: usize| {
                let lines = lines(table, axis, interval)?;
                Some(Span {
                    base: lines.map(|line| line.base),
                    rise: lines.map(|line| line.rise),
                    foot: lines.map(|line| line.foot),
                    run: lines.map(|line| line.run),
                    offset: lines.map(|line| line.literal),
                })
            };
            axes.push(Axis {
                input: axis.input as usize,
                spans: (0..cuts.intervals()).map(span).collect::<Option<_>>()?,
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
            and: And::of(table)?,
            least: table.least_strength(),
        })
    }

    /// Writes the firing strengths at the values of the inputs, and returns the strongest rule.
    #[inline(always)]
    pub(in super::super) fn fire(
        &self,
        values: &[[f64; 1]],
        strengths: &mut [[f64; 1]],
    ) -> Strongest {
        let strongest = fearless_simd::dispatch!(self.level, simd => match &*self.axes {
            [a, b, c] => self.fire_by(simd, ([a, b], [c]), values, strengths),
            [a, b, c, d] => self.fire_by(simd, ([a, b], [c, d]), values, strengths),
            _ => None,
        });
        strongest.unwrap_or(Strongest::NONE)
    }

    #[inline(always)]
    fn fire_by<S: Simd, const MORE: usize>(
        &self,
        simd: S,
        ([first, second], more): ([&Axis; 2], [&Axis; MORE]),
        values: &[[f64; 1]],
        strengths: &mut [[f64; 1]],
    ) -> Option<Strongest> {
        let at = |axis: &Axis| values.get(axis.input).map(|[x]| *x);
        let at = [at(first)?, at(second)?];
        let [x, y] = at;
        let spans = [first.span(simd, x)?, second.span(simd, y)?];
        let of_cells = self.and.cells(simd, degrees(simd, spans, at));
        let [[a, b], [c, d]] = spans.map(|span| span.offset);
        let mut visited = [of_cells; MOST_VISITED / 4];
        let mut cells = [a + c; MOST_VISITED];
        (cells[1], cells[2], cells[3]) = (b + c, a + d, b + d);
        let mut vectors = 1;
        for axis in more {
            let [x] = *values.get(axis.input)?;
            let span = axis.span(simd, x)?;
            let [low, high, ..] = degrees(simd, [span; 2], [x; 2]).to_array();
            for i in 0..vectors {
                visited[vectors + i] = self.and.both(visited[i], splat(simd, high));
                visited[i] = self.and.both(visited[i], splat(simd, low));
            }
            for i in 0..4 * vectors {
                cells[4 * vectors + i] = cells[i] + span.offset[1];
                cells[i] += span.offset[0];
            }
            vectors *= 2;
        }
        let mut top = splat(simd, 0.0);
        // Cells next to one another often act on the same strength, and would wait for each other.
        let mut banks = [[0.0; MOST_STRENGTHS]; 4];
        for (i, degrees) in visited.iter_mut().enumerate().take(vectors) {
            let cell = |of: usize| self.cells.get(cells[4 * i + of] as usize);
            let four_cells = [cell(0)?, cell(1)?, cell(2)?, cell(3)?];
            let weights = four(simd, &four_cells.map(|cell| cell.weight));
            *degrees = fires(simd, weights * *degrees, self.least);
            top = top.max(*degrees);
            let of_cells = four_cells.into_iter().zip(degrees.to_array());
            for ((cell, strength), bank) in of_cells.zip(&mut banks) {
                let kept = &mut bank[cell.strength as usize % MOST_STRENGTHS];
                *kept = larger(*kept, strength);
            }
        }
        for (i, strength) in strengths.iter_mut().enumerate().take(MOST_STRENGTHS) {
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
            let cell = cells[strongest.trailing_zeros() as usize % MOST_VISITED];
            rule = rule.min(self.cells.get(cell as usize)?.rule);
            strongest &= strongest - 1;
        }
        Some(Strongest::of(coverage, rule))
    }
}

impl Axis {
    #[inline(always)]
    fn span<S: Simd>(&self, simd: S, x: f64) -> Option<&Span> {
        self.spans.get(self.cuts.interval(simd, x))
    }
}

/// The degrees of the two lines of each of two inputs.
#[inline(always)]
fn degrees<S: Simd>(simd: S, [one, other]: [&Span; 2], [x, y]: [f64; 2]) -> f64x4<S> {
    let four = |of: fn(&Span) -> &[f64; 2]| {
        let ([a, b], [c, d]) = (of(one), of(other));
        four(simd, &[*a, *b, *c, *d])
    };
    let at = super::four(simd, &[x, x, y, y]);
    let along = (at - four(|span| &span.foot)) / four(|span| &span.run);
    four(|span| &span.base) + four(|span| &span.rise) * along
}
