//! Compares the outputs of a rule set with those of the original.

use std::ops::Range;

use fuzzy::{
    Engine, Model,
    engine::{Outcome, State},
    model::Variable,
};

use super::{Difference, SimplifyError};

/// The number of points that are evaluated at once; one such chunk is enough to reject most candidates.
const CHUNK: usize = 4096;

/// The maximum number of points that are tried first, because earlier candidates failed at them.
const MAX_HARD: usize = 64;

/// The points at which models are compared, and the outputs of the original model at these points.
pub(crate) struct ReferenceOutputs {
    /// The names of the inputs, one for each column.
    names: Vec<String>,
    columns: Vec<Vec<f64>>,
    /// Row by row, the outcome of each output.
    outcomes: Vec<Outcome>,
    outputs: Vec<String>,
    /// The difference up to which each output counts as equal.
    equal: Vec<f64>,
    /// The tolerance of each output.
    tolerances: Vec<f64>,
    /// The rows at which candidates failed.
    hard: Vec<usize>,
}

impl ReferenceOutputs {
    pub(crate) fn new(
        model: &Model,
        columns: Vec<Vec<f64>>,
        tolerance: Option<f64>,
    ) -> Result<ReferenceOutputs, SimplifyError> {
        let outputs = || model.outputs.iter().map(|output| &output.variable);
        let equal = |output: &Variable| super::EQUAL_TOLERANCE * (output.high - output.low);
        let equal: Vec<f64> = outputs().map(equal).collect();
        let slices: Vec<&[f64]> = columns.iter().map(Vec::as_slice).collect();
        Ok(ReferenceOutputs {
            outcomes: Engine::new(model)?.evaluate_batch(&slices)?,
            names: model
                .inputs
                .iter()
                .map(|input| input.name.clone())
                .collect(),
            outputs: outputs().map(|output| output.name.clone()).collect(),
            tolerances: equal
                .iter()
                .map(|equal| tolerance.map_or(*equal, |tolerance| tolerance.max(*equal)))
                .collect(),
            equal,
            columns,
            hard: Vec::new(),
        })
    }

    /// The number of points.
    pub(crate) fn len(&self) -> usize {
        self.columns.first().map_or(0, Vec::len)
    }

    /// Whether the outputs of a model are equal to those of the original model at all points.
    pub(crate) fn is_equal(&mut self, model: &Model) -> bool {
        let equal = self.equal.clone();
        self.compare(model, &equal, self.len()).is_some()
    }

    /// The largest difference at the first [`CHUNK`] points and at those where earlier candidates failed, as a share of
    /// the tolerance; `None` if it exceeds the tolerance.
    pub(crate) fn sampled_difference(&mut self, model: &Model) -> Option<f64> {
        let tolerances = self.tolerances.clone();
        let difference = self.compare(model, &tolerances, CHUNK)?;
        Some(difference.map_or(0.0, |(share, _)| share))
    }

    /// The largest difference at all points and its location; the inner `None` means that there is no difference. The
    /// outer `None` means that a difference exceeds the tolerance, or that rules fire at a point in only one of the
    /// models.
    pub(crate) fn examine(&mut self, model: &Model) -> Option<Option<Difference>> {
        let tolerances = self.tolerances.clone();
        let difference = self.compare(model, &tolerances, self.len())?;
        Some(difference.map(|(_, difference)| difference))
    }

    fn compare(
        &mut self,
        model: &Model,
        tolerances: &[f64],
        most: usize,
    ) -> Option<Option<(f64, Difference)>> {
        let engine = Engine::new(model).ok()?;
        let column = |input: &Variable| {
            let index = self.names.iter().position(|name| *name == input.name)?;
            self.columns.get(index)
        };
        let columns: Option<Vec<&Vec<f64>>> = model.inputs.iter().map(column).collect();
        let columns = columns?;
        let hard = self.rows_at(&engine, &columns, &self.hard)?;
        let mut worst: Option<(f64, usize, usize, f64)> = None;
        if self
            .worst(self.hard.iter().copied(), &hard, tolerances, &mut worst)
            .is_err()
        {
            return None;
        }
        let mut first = 0;
        while first < most.min(self.len()) {
            let rows = first..(first + CHUNK).min(self.len());
            let outcomes = evaluate(&engine, &columns, rows.clone())?;
            if let Err(row) = self.worst(rows, &outcomes, tolerances, &mut worst) {
                self.hard.truncate(MAX_HARD - 1);
                self.hard.insert(0, row);
                return None;
            }
            first += CHUNK;
        }
        Some(worst.and_then(|(share, row, output, after)| {
            let before = self.outcome(row, output)?.value()?;
            Some((
                share,
                Difference {
                    output: self.outputs.get(output)?.clone(),
                    before,
                    after,
                    inputs: self
                        .columns
                        .iter()
                        .filter_map(|column| column.get(row).copied())
                        .collect(),
                },
            ))
        }))
    }

    fn rows_at(
        &self,
        engine: &Engine,
        columns: &[&Vec<f64>],
        rows: &[usize],
    ) -> Option<Vec<Outcome>> {
        let of = |column: &&Vec<f64>| {
            rows.iter()
                .filter_map(|row| column.get(*row).copied())
                .collect()
        };
        let columns: Vec<Vec<f64>> = columns.iter().map(of).collect();
        evaluate(engine, &columns.iter().collect::<Vec<_>>(), 0..rows.len())
    }

    fn outcome(&self, row: usize, output: usize) -> Option<&Outcome> {
        self.outcomes.get(row * self.outputs.len() + output)
    }

    /// Updates `worst` if a difference is larger. `worst` contains the largest difference so far, divided by the
    /// tolerance, and its row, its output, and the new value of the output. If a row has a difference above the
    /// tolerance, or an outcome of another kind than before, the first such row is returned as the error.
    fn worst(
        &self,
        rows: impl Iterator<Item = usize>,
        outcomes: &[Outcome],
        tolerances: &[f64],
        worst: &mut Option<(f64, usize, usize, f64)>,
    ) -> Result<(), usize> {
        for (row, now) in rows.zip(outcomes.chunks(self.outputs.len().max(1))) {
            for (output, (now, tolerance)) in now.iter().zip(tolerances).enumerate() {
                let Some(before) = self.outcome(row, output) else {
                    return Err(row);
                };
                match (before.state, now.state) {
                    (State::Defined(before), State::Defined(after)) => {
                        let difference = (after - before).abs();
                        if difference > *tolerance {
                            return Err(row);
                        }
                        let share = difference / tolerance.max(f64::MIN_POSITIVE);
                        if difference > 0.0 && worst.is_none_or(|(most, ..)| share > most) {
                            *worst = Some((share, row, output, after));
                        }
                    }
                    (before, now) if before == now => {}
                    _ => return Err(row),
                }
            }
        }
        Ok(())
    }
}

fn evaluate(engine: &Engine, columns: &[&Vec<f64>], rows: Range<usize>) -> Option<Vec<Outcome>> {
    let slices: Option<Vec<&[f64]>> = columns
        .iter()
        .map(|column| column.get(rows.clone()))
        .collect();
    engine.evaluate_batch(&slices?).ok()
}
