//! The values that fill the gaps of a rule set, where no rule applies.

use alloc::{vec, vec::Vec};

use fuzzy::{Engine, Model, engine::EvaluateError};

use super::{
    FilledKnots, GapMethod, GapSettings, Reading, complete::has_no_gap, field::Field, harmonic,
    inverse_distance, is_gap, knots::Knots, metric, neighbours::Tree, thin_plate,
};

/// The values that fill the gaps of a rule set, where no rule applies.
///
/// The rules are evaluated at knots: the peaks of the terms and the points halfway between them. Knots that are a gap
/// get their value from the covered knots by a [`GapMethod`], whose distances are scaled by the typical change of the
/// output. Between knots the value is interpolated linearly along each input. Beyond the outermost peaks, where the
/// rules cannot distinguish points, it is constant.
#[derive(Debug, Clone, PartialEq)]
pub struct Filling {
    /// See [`FilledKnots::coordinates`].
    coordinates: Vec<f64>,
    starts: Vec<u32>,
    /// See [`FilledKnots::values`]. Empty if the rules are proven to leave no gap, if no knot is covered, or if there are
    /// too many inputs.
    values: Vec<f64>,
    distances: Vec<f64>,
    coverage_below: f64,
}

impl Filling {
    /// Evaluates the rules at the knots and fills the knots that are a gap. `engine` is the compiled `model`, and
    /// `output` the index of an output.
    ///
    /// # Errors
    ///
    /// If there is no such output.
    pub fn new(
        engine: &Engine,
        model: &Model,
        output: usize,
        settings: &GapSettings,
    ) -> Result<Filling, EvaluateError> {
        let outputs = engine.output_names().len();
        let Some(modelled) = model.outputs.get(output).filter(|_| output < outputs) else {
            return Err(EvaluateError::UnknownOutput {
                index: output,
                outputs,
            });
        };
        let variable = &modelled.variable;
        let coverage_below = settings.coverage_below(model);
        let known_values = |knots: &Knots| -> Result<Vec<Option<f64>>, EvaluateError> {
            let columns = knots.columns();
            let columns: Vec<&[f64]> = columns.iter().map(Vec::as_slice).collect();
            let outcomes = engine.evaluate_batch(&columns)?;
            let outcomes = outcomes.iter().skip(output).step_by(outputs);
            let covered = outcomes.map(|outcome| match is_gap(outcome.coverage, coverage_below) {
                true => None,
                false => outcome.value(),
            });
            Ok(covered.collect())
        };
        let read = model.inputs_of(&variable.name);
        let is_needed = !has_no_gap(model, modelled, coverage_below);
        let Some(inner) = Knots::of(model, &read).filter(|_| is_needed) else {
            return Ok(Filling {
                coordinates: Vec::new(),
                starts: Vec::new(),
                values: Vec::new(),
                distances: Vec::new(),
                coverage_below,
            });
        };
        let known = known_values(&inner)?;
        let knots = inner.with_ends(model);
        let mut values = Vec::new();
        if known.iter().any(Option::is_some) {
            let range = (variable.low, variable.high);
            let filled = fill(&inner, &known, range, settings.method);
            let points = (0..knots.count()).map(|knot| knots.point(knot));
            values = points
                .filter_map(|point| inner.read(&filled, &point))
                .collect();
        }
        let mut starts = vec![0];
        for coordinates in &knots.axes {
            starts.push(starts.last().copied().unwrap_or(0) + coordinates.len() as u32);
        }
        Ok(Filling {
            coordinates: knots.axes.concat(),
            starts,
            values,
            distances: distances(&knots, &known_values(&knots)?),
            coverage_below,
        })
    }

    /// Whether a point with this coverage is a gap.
    pub fn is_gap(&self, coverage: f64) -> bool {
        is_gap(coverage, self.coverage_below)
    }

    /// The value at a point in a gap, with one coordinate for each input; beyond the outermost peaks it is constant.
    /// `None` if the rules leave no gap or cover nothing, if the output depends on too many inputs (more than 15
    /// inputs with two terms each), if the point has another number of coordinates, or if one is NaN.
    pub fn read(&self, point: &[f64]) -> Option<Reading> {
        self.borrowed()?.read(point)
    }

    /// The coverage below which a point is a gap.
    pub(crate) fn coverage_below(&self) -> f64 {
        self.coverage_below
    }

    /// The filled knots; `None` if nothing is filled.
    pub(crate) fn borrowed(&self) -> Option<FilledKnots<'_>> {
        (!self.values.is_empty()).then_some(FilledKnots {
            coordinates: &self.coordinates,
            starts: &self.starts,
            values: &self.values,
            distances: &self.distances,
        })
    }
}

/// The values at all knots, with the unknown ones filled within the `range` of the output. At least one must be known.
fn fill(knots: &Knots, known: &[Option<f64>], range: (f64, f64), method: GapMethod) -> Vec<f64> {
    let covered: Vec<bool> = known.iter().map(Option::is_some).collect();
    let values: Vec<f64> = known.iter().map(|value| value.unwrap_or(range.0)).collect();
    let mut field = Field {
        coordinates: metric::coordinates(knots, &values, &covered),
        knots,
        covered,
        values,
    };
    for (knot, (_, from)) in field.gap().into_iter().zip(nearest(&field)) {
        field.values[knot] = field.values[from];
    }
    // The values in the gap are now those of the nearest covered knots.
    match method {
        GapMethod::Nearest => {}
        GapMethod::InverseDistance { power, neighbours } => {
            inverse_distance::fill(&mut field, power, neighbours);
        }
        GapMethod::ThinPlate => thin_plate::fill(&mut field, range),
        GapMethod::Harmonic => harmonic::fill(&mut field),
    }
    field.values
}

/// The squared distance of each knot of the gap to the nearest covered knot, and the index of that knot.
fn nearest(field: &Field) -> Vec<(f64, usize)> {
    let known = field.known_highest_first();
    let mut tree = Tree::new(field.coordinates.len(), field.points(&known));
    let mut nearest = |knot: usize| {
        let found = tree.nearest(&field.point(knot), 1).first().copied();
        found.map(|(square, index)| (square, known[index]))
    };
    field.gap().into_iter().filter_map(&mut nearest).collect()
}

/// The distance of each knot to the nearest covered knot, in shares of the inputs' ranges; 0 for a covered knot.
fn distances(knots: &Knots, known: &[Option<f64>]) -> Vec<f64> {
    let shares = knots.axes.iter().zip(&knots.ranges);
    let shares = shares.map(|(coordinates, range)| coordinates.iter().map(|x| x / range).collect());
    let field = Field {
        coordinates: shares.collect(),
        knots,
        covered: known.iter().map(Option::is_some).collect(),
        values: vec![0.0; known.len()],
    };
    let mut distances = vec![0.0; known.len()];
    for (knot, (square, _)) in field.gap().into_iter().zip(nearest(&field)) {
        distances[knot] = libm::sqrt(square);
    }
    distances
}

#[cfg(test)]
mod tests;
