//! Conversion of a compiled table to the regions of a plane.

use alloc::vec::Vec;
use core::array::from_fn;

use fearless_simd::Level;

use super::plane::{Plane, PlaneInput, Region};
use super::{Cuts, Lines, VectorConjunction, lines};
use crate::engine::arrays::OwnedTable;
use crate::table::{
    Action, Arrays as _, Axis, ClosedForm, Coefficient, Conjunctions, Consequent, Line, Moment,
    Pair, has_cells_alone,
};

impl Plane {
    /// Converts a table to a plane; `None` if it does not have the form of a plane.
    pub(in super::super) fn new(table: &OwnedTable) -> Option<Self> {
        let ([first, second], [_, _], [output]) = (&*table.axes, &*table.inputs, &*table.outputs)
        else {
            return None;
        };
        let Conjunctions::Uniform {
            actions_per_cell: 1,
            first_action,
            sums,
        } = table.conjunctions
        else {
            return None;
        };
        let form = output.form();
        let sums_strengths = match form {
            ClosedForm::Partition | ClosedForm::ScaledPartition => false,
            ClosedForm::Moments | ClosedForm::WeightedAverage | ClosedForm::WeightedSum => true,
            ClosedForm::Integrated
            | ClosedForm::Tsukamoto
            | ClosedForm::Cut
            | ClosedForm::Scaled
            | ClosedForm::Layers => return None,
        };
        if sums != sums_strengths {
            return None;
        }
        if (first.input, second.input) != (0, 1) || !has_cells_alone(table) {
            return None;
        }
        let sides = [side(table, first)?, side(table, second)?];
        let span = output.first as usize..output.end as usize;
        let numbers = Numbers {
            pairs: table.pairs.get(span.clone()).unwrap_or_default(),
            moments: table.moments.get(span.clone()).unwrap_or_default(),
            consequents: table.consequents.get(span).unwrap_or_default(),
            coefficients: &table.coefficients,
            form,
        };
        let actions = table.actions.get(first_action as usize..)?;
        let mut regions = Vec::new();
        let [rows, columns] = [&sides[0], &sides[1]].map(|side| side.cuts.intervals());
        for row in 0..rows {
            for column in 0..columns {
                let [a, b] = lines(table, first, row)?;
                let [c, d] = lines(table, second, column)?;
                let cell = |one: &Line, other: &Line| {
                    let action = actions.get((one.literal + other.literal) as usize)?;
                    // Neither rules of weight 0 nor cells without a rule act on anything.
                    Some((*action, action.weight > 0.0))
                };
                let cells = [cell(&a, &c)?, cell(&b, &c)?, cell(&a, &d)?, cell(&b, &d)?];
                regions.push(numbers.region([a, b, c, d], cells)?);
            }
        }
        Some(Plane {
            level: Level::new(),
            sides,
            columns,
            regions,
            least: table.least_strength(),
            and: VectorConjunction::of(table)?,
            output: *output,
            form,
        })
    }
}

/// Returns an input of the table; `None` if it has too many cuts.
fn side(table: &OwnedTable, axis: &Axis) -> Option<PlaneInput> {
    let input = table.inputs.get(axis.input as usize)?;
    Some(PlaneInput {
        low: input.low,
        high: input.high,
        cuts: Cuts::new(table, axis)?,
    })
}

/// The arrays with the numbers of the closed form.
struct Numbers<'t> {
    pairs: &'t [Pair],
    moments: &'t [Moment],
    consequents: &'t [Consequent],
    coefficients: &'t [Coefficient],
    form: ClosedForm,
}

impl Numbers<'_> {
    /// Returns the region with these lines and cells. The flag of a cell states whether it acts on a firing strength.
    fn region(&self, lines: [Line; 4], cells: [(Action, bool); 4]) -> Option<Region> {
        let acting = cells.iter().filter(|(_, acts)| *acts);
        let mut slots: Vec<u32> = acting.map(|(action, _)| action.strength).collect();
        slots.sort_unstable();
        slots.dedup();
        let mut numbers = [[0.0; 4]; 7];
        for (slot, strength) in slots.iter().enumerate() {
            let next_is_there = slots.get(slot + 1) == Some(&(strength + 1));
            let of_slot = self.of(*strength as usize, next_is_there)?;
            for (numbers, number) in numbers.iter_mut().zip(of_slot) {
                numbers[slot] = number;
            }
        }
        let acts_on = |(action, acts): (Action, bool), slot: usize| {
            acts && slots.get(slot) == Some(&action.strength)
        };
        let first_rule = |set: usize| {
            let rules = (0..4).filter(|cell| set >> cell & 1 != 0);
            rules.map(|cell| cells[cell].0.rule).min().unwrap_or(0)
        };
        Some(Region {
            lines: Lines::new(lines),
            weights: cells.map(|(action, _)| action.weight),
            acts: cells.map(|cell| {
                from_fn(|slot| match acts_on(cell, slot) {
                    true => f64::INFINITY,
                    false => 0.0,
                })
            }),
            numbers,
            first_rules: from_fn(first_rule),
        })
    }

    /// Returns the numbers of the closed form for a firing strength; `None` if a plane cannot represent them.
    /// `next_is_there` states whether the next firing strength is in the same region.
    fn of(&self, strength: usize, next_is_there: bool) -> Option<[f64; 7]> {
        match self.form {
            ClosedForm::Partition | ClosedForm::ScaledPartition => {
                let (pair, side) = (self.pairs.get(strength / 2)?, strength % 2);
                let [a0, a1] = pair.area.map(|sides| sides[side]);
                let [m0, m1, m2] = pair.moment.map(|sides| sides[side]);
                let width = if next_is_there { pair.width[side] } else { 0.0 };
                Some([a0, a1, m0, m1, m2, width, pair.middle[side]])
            }
            ClosedForm::Moments => {
                let Moment { area, moment } = self.moments.get(strength)?;
                Some([*area, *moment, 0.0, 0.0, 0.0, 0.0, 0.0])
            }
            ClosedForm::WeightedAverage | ClosedForm::WeightedSum => {
                let consequent = self.consequents.get(strength)?;
                let span = consequent.first as usize..consequent.end as usize;
                let coefficients = self.coefficients.get(span)?;
                let mut of = [0.0; 2];
                // The coefficients must be in the order of the inputs, each input at most once: another order may give
                // different bits.
                if !coefficients.is_sorted_by(|a, b| a.input < b.input)
                    || consequent.first_code < consequent.end_code
                {
                    return None;
                }
                for c in coefficients {
                    *of.get_mut(c.input as usize)? = c.coefficient;
                }
                Some([consequent.constant, of[0], of[1], 0.0, 0.0, 0.0, 0.0])
            }
            ClosedForm::Integrated
            | ClosedForm::Tsukamoto
            | ClosedForm::Cut
            | ClosedForm::Scaled
            | ClosedForm::Layers => None,
        }
    }
}
