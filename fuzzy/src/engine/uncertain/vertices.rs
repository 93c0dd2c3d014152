//! Outputs whose extremes over intervals of the inputs are at vertices, so that a few evaluations find them.
//!
//! Between two corners of straight terms, each degree is a linear function of its input. If a rule is an AND by product
//! of terms of different inputs, its firing strength is linear along each input. Weighted averages of constants, and
//! centroids of scaled terms that are added, are quotients of two sums of such strengths. A quotient of two linear
//! functions is monotone where its divisor is above 0. So between the corners the output is monotone along each input,
//! and its extremes are at the vertices of the grid of all corners and ends.

use alloc::{vec, vec::Vec};

use super::super::{Engine, arrays::OwnedTable};
use super::stage::RangedStage;
use super::{EndSearch, Interval, OutputBounds};
use crate::table::{ClosedForm, Output};

/// The maximum number of vertices that are evaluated.
const MAX_VERTICES: usize = 4096;

/// The outputs of an engine whose extremes are at vertices.
#[derive(Debug)]
pub(super) struct Vertices {
    /// The corners of the terms of each input.
    corners: Vec<Vec<f64>>,
    /// For each output of the model, the maximum error at a coverage of 1; the error is inversely proportional to the
    /// coverage. It arises because strengths below the least firing strength count as 0. `None` if the extremes may
    /// not be at vertices.
    errors: Vec<Option<f64>>,
}

impl Vertices {
    pub(super) fn new(engine: &Engine, first: &RangedStage) -> Self {
        let table = &engine.first.arrays;
        let mut errors = vec![None; engine.outputs.len()];
        let mut corners = vec![Vec::new(); engine.inputs.len()];
        for (place, (output, index)) in table.outputs.iter().zip(first.outputs()).enumerate() {
            let Some(ratio) = ratio_of_areas(table, output) else {
                continue;
            };
            let Some(of_rules) = first.linear(place, &mut corners) else {
                continue;
            };
            if let Some(error) = errors.get_mut(*index) {
                *error = Some(of_rules * ratio * (output.high - output.low));
            }
        }
        Vertices { corners, errors }
    }

    /// Returns the positions of the vertices along each input; `None` if there are too many vertices.
    fn grid(&self, inputs: &[Interval]) -> Option<Vec<Vec<f64>>> {
        let mut grid = Vec::with_capacity(inputs.len());
        let mut count = 1_usize;
        for (interval, corners) in inputs.iter().zip(&self.corners) {
            let inside = |x: &f64| interval.low < *x && *x < interval.high;
            let mut along: Vec<f64> = corners.iter().copied().filter(inside).collect();
            along.extend([interval.low, interval.high]);
            along.sort_by(f64::total_cmp);
            along.dedup();
            count = count.saturating_mul(along.len());
            grid.push(along);
        }
        (count <= MAX_VERTICES).then_some(grid)
    }
}

impl EndSearch<'_> {
    /// Evaluates all vertices. Returns the bounds of each output whose extremes are among them.
    pub(super) fn vertices(
        &mut self,
        vertices: &Vertices,
        inputs: &[Interval],
    ) -> Option<Vec<Option<OutputBounds>>> {
        if vertices.errors.iter().all(Option::is_none) {
            return None;
        }
        let grid = vertices.grid(inputs)?;
        let mut least = vec![f64::INFINITY; vertices.errors.len()];
        let mut place = vec![0; grid.len()];
        let mut point: Vec<f64> = inputs.iter().map(|input| input.low).collect();
        loop {
            self.point(&point);
            for (least, outcome) in least.iter_mut().zip(&self.outcomes) {
                // If the output has no value at a vertex, the coverage there counts as 0.
                let coverage = outcome.value().map_or(0.0, |_| outcome.coverage);
                *least = least.min(coverage);
            }
            // Moves to the next vertex.
            let mut is_last = true;
            for ((place, x), along) in place.iter_mut().zip(&mut point).zip(&grid) {
                *place = (*place + 1) % along.len();
                *x = along.get(*place).copied().unwrap_or(*x);
                if *place > 0 {
                    is_last = false;
                    break;
                }
            }
            if is_last {
                break;
            }
        }
        let bounds = vertices.errors.iter().zip(least).zip(&self.inner);
        let bounds = bounds.map(|((error, least), values)| {
            let error = (*error)? / least;
            let values = values.filter(|_| error.is_finite())?;
            let values = Interval::new(values.low - error, values.high + error);
            Some(OutputBounds {
                values: Some(values),
                may_be_undefined: false,
            })
        });
        Some(bounds.collect())
    }
}

/// Returns the ratio of the largest to the smallest area of the terms of an output, or 1 for a weighted average of
/// constants. `None` if the output is not a quotient of sums of its firing strengths.
fn ratio_of_areas(table: &OwnedTable, output: &Output) -> Option<f64> {
    let range = output.first as usize..output.end as usize;
    match output.form() {
        ClosedForm::Moments => {
            let areas = table.moments.get(range)?.iter().map(|moment| moment.area);
            let (least, most) = areas.fold((f64::INFINITY, 0.0), |(least, most), area| {
                (area.min(least), area.max(most))
            });
            Some(most / least).filter(|ratio| ratio.is_finite())
        }
        ClosedForm::WeightedAverage => {
            let mut consequents = table.consequents.get(range)?.iter();
            let are_constant = consequents.all(|consequent| {
                consequent.first == consequent.end && consequent.first_code == consequent.end_code
            });
            are_constant.then_some(1.0)
        }
        ClosedForm::Integrated
        | ClosedForm::Partition
        | ClosedForm::ScaledPartition
        | ClosedForm::WeightedSum
        | ClosedForm::Tsukamoto
        | ClosedForm::Cut
        | ClosedForm::Scaled
        | ClosedForm::Layers => None,
    }
}
