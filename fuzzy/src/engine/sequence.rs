//! Evaluation of consecutive rows, in which outputs can keep their previous value.

use alloc::{vec, vec::Vec};

use super::{Engine, EvaluateError, Outcome, Scratch, State};
use crate::model::{Model, NoRuleFires, Output};

/// Evaluates rows in order. If no rule fires, an output with `when_no_rule_fires: previous` keeps the value of the previous
/// row, and outputs that read it use that value.
///
/// An engine has no memory: [`Engine::evaluate`] and the methods based on it treat every row as the first row.
///
/// # Example: a fan that keeps its speed while no rule fires
/// ```
/// use fuzzy::{Engine, Model, engine::{Sequence, State}};
///
/// let model: Model = "
/// fuzzy: 1
/// name: fan
/// inputs: {heat: {range: [0, 40], terms: {low: {left_shoulder: [15, 20]}, high: {right_shoulder: [25, 30]}}}}
/// outputs: {speed: {range: [0, 9], partition: [slow, fast], when_no_rule_fires: previous}}
/// rules: [IF heat IS low THEN speed IS slow, IF heat IS high THEN speed IS fast]
/// ".parse()?;
/// let engine = Engine::new(&model)?;
/// let mut rows = Sequence::new(&engine);
/// assert_eq!(rows.evaluate(&[22.0])?[0].value(), None); // no value yet
/// let fast = rows.evaluate(&[30.0])?[0].value().ok_or("no value")?;
/// assert_eq!(rows.evaluate(&[22.0])?[0].state, State::Previous(fast));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug, Clone)]
pub struct Sequence<'e> {
    engine: &'e Engine,
    scratch: Scratch,
    outcomes: Vec<Outcome>,
    previous: PreviousValues,
}

/// The values of the outputs in the previous row.
#[derive(Debug, Clone)]
pub(super) struct PreviousValues {
    /// Whether each output keeps its previous value.
    keeps: Vec<bool>,
    values: Vec<Option<f64>>,
}

impl PreviousValues {
    /// Replaces the outcome of an output by its previous value if no rule fires, and stores its value for the next row.
    #[inline(always)]
    pub(super) fn keep(&mut self, output: usize, outcome: &mut Outcome) {
        if !self.keeps[output] {
            return;
        }
        if let (State::NoRuleFired | State::Default(_), Some(value)) =
            (outcome.state, self.values[output])
        {
            outcome.state = State::Previous(value);
        }
        self.values[output] = outcome.value().or(self.values[output]);
    }
}

impl Model {
    /// Returns whether an output keeps its previous value where no rule fires. Such a model has to be evaluated in the
    /// order of the rows, by a [`Sequence`].
    pub fn keeps_previous(&self) -> bool {
        self.outputs.iter().any(Output::keeps_previous)
    }
}

impl Output {
    /// Returns whether the output keeps its previous value where no rule fires.
    pub fn keeps_previous(&self) -> bool {
        matches!(self.when_no_rule_fires, NoRuleFires::Previous(_))
    }
}

impl<'e> Sequence<'e> {
    /// Creates a sequence without a previous row.
    pub fn new(engine: &'e Engine) -> Self {
        let outputs = engine.model().outputs.iter();
        Sequence {
            engine,
            scratch: engine.scratch(),
            outcomes: vec![Outcome::default(); engine.outputs.len()],
            previous: PreviousValues {
                keeps: outputs.map(Output::keeps_previous).collect(),
                values: vec![None; engine.outputs.len()],
            },
        }
    }

    /// Evaluates the next row, without allocation. If an input is NaN or infinite, the previous values remain
    /// unchanged.
    ///
    /// # Errors
    /// Fails like [`Engine::evaluate`].
    pub fn evaluate(&mut self, inputs: &[f64]) -> Result<&[Outcome], EvaluateError> {
        self.engine.fits(inputs, &self.outcomes)?;
        self.next(inputs);
        self.engine.must_fire(&self.outcomes)?;
        Ok(&self.outcomes)
    }

    /// Evaluates rows, passed as one column per input, into one outcome per row and output. Unlike
    /// [`Engine::evaluate_batch_into`], this evaluates the rows in order and therefore on one core.
    ///
    /// # Errors
    /// Fails like [`Engine::evaluate_batch_into`].
    pub fn evaluate_batch_into(
        &mut self,
        columns: &[&[f64]],
        outcomes: &mut [Outcome],
    ) -> Result<(), EvaluateError> {
        let rows = self.engine.fits_columns(columns, outcomes)?;
        let mut inputs = vec![0.0; columns.len()];
        let outputs = self.outcomes.len();
        for (row, outcomes) in (0..rows).zip(outcomes.chunks_exact_mut(outputs)) {
            for (value, column) in inputs.iter_mut().zip(columns) {
                *value = column[row];
            }
            self.next(&inputs);
            outcomes.copy_from_slice(&self.outcomes);
        }
        Ok(())
    }

    fn next(&mut self, inputs: &[f64]) {
        let (engine, outcomes) = (self.engine, &mut self.outcomes);
        match &engine.chain {
            None => {
                engine
                    .first
                    .outcomes(&mut self.scratch.first, inputs, outcomes);
                for (output, outcome) in outcomes.iter_mut().enumerate() {
                    self.previous.keep(output, outcome);
                }
            }
            Some(chain) => {
                let previous = &mut self.previous;
                let keep = |output: usize, outcome: &mut Outcome| previous.keep(output, outcome);
                engine.chained(chain, &mut self.scratch, inputs, outcomes, keep);
            }
        }
    }

    /// Clears the previous values.
    pub fn reset(&mut self) {
        self.previous.values.fill(None);
    }
}
