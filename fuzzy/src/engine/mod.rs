//! The compiled model: immutable, evaluated without allocation.

use alloc::{sync::Arc, vec, vec::Vec};
use core::ops::Range;

use crate::defuzzify::polyline::Room;
use crate::defuzzify::{Defuzzify, Heights};
use crate::model::{Model, NoRuleFires};
use crate::table::{self, Partial, Rooms, Strongest, Table};
use arrays::Arrays;
use lanes::Lanes;

mod arrays;
mod batch;
mod compile;
mod condition;
mod error;
mod explain;
mod lanes;
mod literal;
mod named;
mod rules;
mod uniform;

pub(crate) use crate::table::{FROM_TINY, TINY, operators};
pub use crate::table::{Outcome, State};
pub use error::EvaluateError;
pub use explain::{Degree, ExplainedInput, ExplainedOutput, Explanation, FiredRule, Share};

/// A compiled model. It holds indices only, never changes, and can be shared between threads.
///
/// # Example: from a model to an answer
/// ```
/// use fuzzy::Engine;
///
/// # let model = fuzzy::yaml::parse(include_str!(concat!(env!("CARGO_MANIFEST_DIR"), "/../rules/flagred-paper.yaml")))?.model;
/// let engine = Engine::new(&model)?;
/// let outcome = engine.evaluate(&[0.1, 0.1])?[0];
/// assert!((outcome.value().unwrap() - 50.0).abs() < 1e-9);
/// assert_eq!(outcome.dominant, Some(7)); // IF margin IS low AND spread IS medium THEN risk IS medium
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug, Clone)]
pub struct Engine {
    /// What it was compiled from.
    model: Arc<Model>,
    inputs: Vec<Input>,
    outputs: Vec<CompiledOutput>,
    /// What is evaluated.
    arrays: Arrays,
    /// The batch form of a common kind of model.
    lanes: Option<Lanes>,
}

#[derive(Debug, Clone)]
struct Input {
    name: Arc<str>,
    low: f64,
    high: f64,
}

#[derive(Debug, Clone)]
struct CompiledOutput {
    name: Arc<str>,
    low: f64,
    high: f64,
    when_no_rule_fires: NoRuleFires,
    /// Where the heights of this output stand.
    heights: Range<usize>,
    /// Where, in these, the heights of each term begin, and where the last one's end.
    places: Vec<usize>,
    defuzzify: Defuzzify,
}

/// What an evaluation works in: made once by [`Engine::scratch`], used again and again.
///
/// # Example: many evaluations, no allocation
/// ```
/// use fuzzy::{Engine, engine::Outcome};
///
/// # let model = fuzzy::yaml::parse(include_str!(concat!(env!("CARGO_MANIFEST_DIR"), "/../rules/flagred-paper.yaml")))?.model;
/// let engine = Engine::new(&model)?;
/// let (mut scratch, mut outcomes) = (engine.scratch(), [Outcome::default()]);
/// for spread in [0.1, 0.2, 0.3] {
///     engine.evaluate_with(&mut scratch, &[0.1, spread], &mut outcomes)?;
///     assert!(outcomes[0].value().is_some());
/// }
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug, Clone)]
pub struct Scratch {
    table: Rooms<Vec<f64>, Vec<Partial>, Vec<Strongest>>,
    /// For outputs that have no closed form.
    room: Room,
}

impl Engine {
    /// The place of an input's value among the inputs.
    ///
    /// # Example
    /// ```
    /// # let model = fuzzy::yaml::parse(include_str!(concat!(env!("CARGO_MANIFEST_DIR"), "/../rules/flagred-paper.yaml")))?.model;
    /// let engine = fuzzy::Engine::new(&model)?;
    /// let mut values = [0.1; 2];
    /// values[engine.input("spread").ok_or("no such input")?] = 0.2;
    /// assert_eq!(values, [0.1, 0.2]);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn input(&self, name: &str) -> Option<usize> {
        self.inputs.iter().position(|input| &*input.name == name)
    }

    /// The place of an output among the outcomes.
    ///
    /// # Example
    /// ```
    /// # let model = fuzzy::yaml::parse(include_str!(concat!(env!("CARGO_MANIFEST_DIR"), "/../rules/flagred-paper.yaml")))?.model;
    /// let engine = fuzzy::Engine::new(&model)?;
    /// assert_eq!((engine.output("risk"), engine.output("margin")), (Some(0), None));
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn output(&self, name: &str) -> Option<usize> {
        self.outputs.iter().position(|output| &*output.name == name)
    }

    /// The names of the inputs, in the order of their values.
    ///
    /// # Example
    /// ```
    /// # let model = fuzzy::yaml::parse(include_str!(concat!(env!("CARGO_MANIFEST_DIR"), "/../rules/flagred-paper.yaml")))?.model;
    /// let engine = fuzzy::Engine::new(&model)?;
    /// assert!(engine.input_names().eq(["margin", "spread"]));
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn input_names(&self) -> impl ExactSizeIterator<Item = &str> {
        self.inputs.iter().map(|input| &*input.name)
    }

    /// The names of the outputs, in the order of their outcomes.
    ///
    /// # Example
    /// ```
    /// # let model = fuzzy::yaml::parse(include_str!(concat!(env!("CARGO_MANIFEST_DIR"), "/../rules/flagred-paper.yaml")))?.model;
    /// let engine = fuzzy::Engine::new(&model)?;
    /// assert!(engine.output_names().eq(["risk"]));
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn output_names(&self) -> impl ExactSizeIterator<Item = &str> {
        self.outputs.iter().map(|output| &*output.name)
    }

    /// The model it was compiled from.
    #[must_use]
    pub fn model(&self) -> &Model {
        &self.model
    }

    /// Name, lower and upper end of each input.
    pub(crate) fn ranges(&self) -> impl Iterator<Item = (&Arc<str>, f64, f64)> {
        self.inputs.iter().map(|v| (&v.name, v.low, v.high))
    }

    /// Name, lower and upper end of each output.
    pub(crate) fn output_ranges(&self) -> impl Iterator<Item = (&Arc<str>, f64, f64)> {
        self.outputs.iter().map(|v| (&v.name, v.low, v.high))
    }

    /// Room to evaluate in, for [`Engine::evaluate_with`]; one a thread.
    ///
    /// # Example
    /// ```
    /// # let model = fuzzy::yaml::parse(include_str!(concat!(env!("CARGO_MANIFEST_DIR"), "/../rules/flagred-paper.yaml")))?.model;
    /// let engine = fuzzy::Engine::new(&model)?;
    /// let mut scratch = engine.scratch();
    /// let mut outcomes = [Default::default()];
    /// engine.evaluate_with(&mut scratch, &[0.3, 0.1], &mut outcomes)?;
    /// assert!(outcomes[0].value().unwrap() < 10.0);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn scratch(&self) -> Scratch {
        let sizes = self.arrays.sizes;
        let places = sizes.heights as usize;
        let cuts = self.outputs.iter().map(|output| output.defuzzify.cuts());
        Scratch {
            table: Rooms {
                values: vec![0.0; self.inputs.len()],
                degrees: vec![0.0; sizes.degrees as usize],
                alive: vec![Partial::NONE; sizes.alive as usize],
                partial: vec![Partial::NONE; sizes.partial as usize],
                next: vec![Partial::NONE; sizes.partial as usize],
                stack: vec![0.0; sizes.stack as usize],
                heights: vec![0.0; places],
                strongest: vec![Strongest::NONE; self.outputs.len()],
            },
            room: Room::new(places, places + cuts.max().unwrap_or(0)),
        }
    }

    /// The compiled arrays, to be evaluated without this engine or written out: see [`table`]. Outputs whose set is
    /// [`Set::OPEN`](table::Set::OPEN) have no closed form, and only the engine knows their values.
    ///
    /// # Example: the tables of the paper's rules
    /// ```
    /// # let model = fuzzy::yaml::parse(include_str!(concat!(env!("CARGO_MANIFEST_DIR"), "/../rules/flagred-paper.yaml")))?.model;
    /// let engine = fuzzy::Engine::new(&model)?;
    /// let table = engine.table();
    /// assert_eq!((table.inputs.len(), table.outputs.len()), (2, 1));
    /// assert_eq!(table.check(), Ok(()));
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn table(&self) -> Table<'_> {
        self.arrays.table()
    }

    /// Evaluates one value for each input, and gives one outcome for each output.
    ///
    /// A value outside its input's range is taken as the range's end, and the outcome says so.
    /// A value that is NaN or infinite makes every outcome [`State::InputNotFinite`].
    ///
    /// # Errors
    /// Not one value for each input; or no rule fired for an output whose author made that an error.
    ///
    /// # Example: an answer, none, and a value out of range
    /// ```
    /// use fuzzy::engine::State;
    ///
    /// # let model = fuzzy::yaml::parse(include_str!(concat!(env!("CARGO_MANIFEST_DIR"), "/../rules/flagred-paper.yaml")))?.model;
    /// let engine = fuzzy::Engine::new(&model)?;
    /// let high = engine.evaluate(&[0.05, 0.2])?[0];
    /// assert!(high.value().unwrap() > 90.0 && !high.clamped);
    /// // Here the paper has no rule, and nothing is made up.
    /// assert_eq!(engine.evaluate(&[0.0, 0.0])?[0].state, State::NoRuleFired);
    /// // A value outside the range counts as its end.
    /// assert!(engine.evaluate(&[0.05, 7.0])?[0].clamped);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn evaluate(&self, inputs: &[f64]) -> Result<Vec<Outcome>, EvaluateError> {
        let mut outcomes = vec![Outcome::default(); self.outputs.len()];
        self.evaluate_with(&mut self.scratch(), inputs, &mut outcomes)?;
        Ok(outcomes)
    }

    /// [`Engine::evaluate`] without allocation: `outcomes` has one place for each output.
    ///
    /// # Errors
    /// As [`Engine::evaluate`]; and not one place for each output.
    ///
    /// # Example: in a loop that must not allocate
    /// ```
    /// use fuzzy::engine::Outcome;
    ///
    /// # let model = fuzzy::yaml::parse(include_str!(concat!(env!("CARGO_MANIFEST_DIR"), "/../rules/flagred-paper.yaml")))?.model;
    /// let engine = fuzzy::Engine::new(&model)?;
    /// let mut scratch = engine.scratch();
    /// let mut outcomes = [Outcome::default()];
    /// engine.evaluate_with(&mut scratch, &[0.05, 0.2], &mut outcomes)?;
    /// assert_eq!(outcomes[0], engine.evaluate(&[0.05, 0.2])?[0]);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn evaluate_with(
        &self,
        scratch: &mut Scratch,
        inputs: &[f64],
        outcomes: &mut [Outcome],
    ) -> Result<(), EvaluateError> {
        if inputs.len() != self.inputs.len() {
            return Err(EvaluateError::WrongNumberOfInputs {
                expected: self.inputs.len(),
                got: inputs.len(),
            });
        }
        if outcomes.len() != self.outputs.len() {
            return Err(EvaluateError::WrongNumberOfOutputs {
                expected: self.outputs.len(),
                got: outcomes.len(),
            });
        }
        self.outcomes(scratch, inputs, outcomes);
        for (output, outcome) in self.outputs.iter().zip(outcomes) {
            if output.when_no_rule_fires == NoRuleFires::Error
                && outcome.state == State::NoRuleFired
            {
                return Err(EvaluateError::NoRuleFired {
                    output: Arc::clone(&output.name),
                });
            }
        }
        Ok(())
    }

    /// Evaluates as many values as there are inputs into as many outcomes as there are outputs.
    #[inline(always)]
    fn outcomes(&self, scratch: &mut Scratch, inputs: &[f64], outcomes: &mut [Outcome]) {
        let Scratch { table: rooms, room } = scratch;
        table::evaluate(
            &self.arrays,
            rooms,
            inputs,
            outcomes,
            |index, heights, _| {
                let output = self.outputs.get(index)?;
                let heights = Heights {
                    heights,
                    places: &output.places,
                };
                output.defuzzify.value(heights, room)
            },
        );
    }
}

#[cfg(test)]
mod tests;
