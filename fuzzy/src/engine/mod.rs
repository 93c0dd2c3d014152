//! The compiled model: immutable, evaluated without allocation.

use alloc::{sync::Arc, vec, vec::Vec};

use crate::defuzzify::integrals::Integrals;
use crate::defuzzify::polyline::{Polylines, Room};
use crate::model::{NoRuleFires, Operators, Term};
use crate::rule::Hedge;
use condition::Step;

mod compile;
mod condition;
pub(crate) mod operators;
mod outcome;

pub use compile::{CompileError, Problem};
pub use outcome::{EvaluateError, Outcome, State};

/// A compiled model. It holds indices only, never changes, and can be shared between threads.
#[derive(Debug, Clone)]
pub struct Engine {
    inputs: Vec<Input>,
    literals: Vec<Literal>,
    steps: Vec<Step>,
    rules: Vec<CompiledRule>,
    actions: Vec<Action>,
    outputs: Vec<CompiledOutput>,
    operators: Operators,
    places: usize,
}

#[derive(Debug, Clone)]
struct Input {
    name: Arc<str>,
    low: f64,
    high: f64,
}

/// A hedged term of an input; hedges in the order in which they apply.
#[derive(Debug, Clone)]
struct Literal {
    input: usize,
    term: Term,
    hedges: Vec<Hedge>,
}

#[derive(Debug, Clone)]
struct CompiledRule {
    first_step: usize,
    end_step: usize,
    first_action: usize,
    end_action: usize,
    weight: f64,
    /// Its index in the model.
    index: usize,
}

/// A consequent: where its firing strength goes.
#[derive(Debug, Clone)]
struct Action {
    output: usize,
    place: usize,
}

#[derive(Debug, Clone)]
struct CompiledOutput {
    name: Arc<str>,
    low: f64,
    high: f64,
    when_no_rule_fires: NoRuleFires,
    /// Where the heights of this output begin.
    first_place: usize,
    /// Where, after `first_place`, the heights of each term begin.
    places: Vec<usize>,
    polylines: Polylines,
}

/// What an evaluation works in: made once by [`Engine::scratch`], used again and again.
#[derive(Debug, Clone)]
pub struct Scratch {
    clamped_inputs: Vec<f64>,
    degrees: Vec<f64>,
    stack: Vec<f64>,
    heights: Vec<f64>,
    room: Room,
}

impl Engine {
    /// The place of an input's value among the inputs.
    pub fn input(&self, name: &str) -> Option<usize> {
        self.inputs.iter().position(|input| &*input.name == name)
    }

    /// The place of an output among the outcomes.
    pub fn output(&self, name: &str) -> Option<usize> {
        self.outputs.iter().position(|output| &*output.name == name)
    }

    /// The names of the inputs, in the order of their values.
    pub fn input_names(&self) -> impl ExactSizeIterator<Item = &str> {
        self.inputs.iter().map(|input| &*input.name)
    }

    /// The names of the outputs, in the order of their outcomes.
    pub fn output_names(&self) -> impl ExactSizeIterator<Item = &str> {
        self.outputs.iter().map(|output| &*output.name)
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
    pub fn scratch(&self) -> Scratch {
        Scratch {
            clamped_inputs: vec![0.0; self.inputs.len()],
            degrees: vec![0.0; self.literals.len()],
            stack: Vec::with_capacity(self.steps.len()),
            heights: vec![0.0; self.places],
            room: Room::new(self.places),
        }
    }

    /// Evaluates one value for each input, and gives one outcome for each output.
    ///
    /// A value outside its input's range is taken as the range's end, and the outcome says so.
    /// A value that is NaN or infinite makes every outcome [`State::InputNotFinite`].
    ///
    /// # Errors
    /// Not one value for each input; or no rule fired for an output whose author made that an error.
    pub fn evaluate(&self, inputs: &[f64]) -> Result<Vec<Outcome>, EvaluateError> {
        let mut outcomes = vec![Outcome::default(); self.outputs.len()];
        self.evaluate_with(&mut self.scratch(), inputs, &mut outcomes)?;
        Ok(outcomes)
    }

    /// [`Engine::evaluate`] without allocation: `outcomes` has one place for each output.
    ///
    /// # Errors
    /// As [`Engine::evaluate`]; and not one place for each output.
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
        if inputs.iter().any(|x| !x.is_finite()) {
            outcomes.fill(Outcome {
                state: State::InputNotFinite,
                ..Outcome::default()
            });
            return Ok(());
        }
        let mut clamped = false;
        scratch.clamped_inputs.clear();
        for (&value, input) in inputs.iter().zip(&self.inputs) {
            let inside = value.max(input.low).min(input.high);
            clamped |= inside != value;
            scratch.clamped_inputs.push(inside);
        }
        outcomes.fill(Outcome {
            clamped,
            ..Outcome::default()
        });
        scratch.degrees.clear();
        for literal in &self.literals {
            let x = scratch.clamped_inputs.get(literal.input).copied();
            scratch.degrees.push(literal.degree(x.unwrap_or(f64::NAN)));
        }
        self.fire(scratch, outcomes);
        for (output, outcome) in self.outputs.iter().zip(outcomes) {
            outcome.state = self.defuzzify(output, scratch)?;
        }
        Ok(())
    }

    /// Fires all rules: heights of consequents, coverage and the dominant rule of each output.
    fn fire(&self, scratch: &mut Scratch, outcomes: &mut [Outcome]) {
        scratch.heights.fill(0.0);
        for rule in &self.rules {
            let steps = self.steps.get(rule.first_step..rule.end_step);
            let degree = condition::run(
                steps.unwrap_or_default(),
                &scratch.degrees,
                self.operators.and,
                self.operators.or,
                &mut scratch.stack,
            );
            let strength = rule.weight * degree;
            let actions = self.actions.get(rule.first_action..rule.end_action);
            for action in actions.unwrap_or_default() {
                if let Some(height) = scratch.heights.get_mut(action.place) {
                    *height = operators::larger(*height, strength);
                }
                if let Some(outcome) = outcomes.get_mut(action.output)
                    && strength > outcome.coverage
                {
                    outcome.coverage = strength;
                    outcome.dominant = Some(rule.index);
                }
            }
        }
    }

    fn defuzzify(
        &self,
        output: &CompiledOutput,
        scratch: &mut Scratch,
    ) -> Result<State, EvaluateError> {
        let heights = scratch.heights.get(output.first_place..);
        let mut integrals = Integrals::about(output.low + 0.5 * (output.high - output.low));
        output.polylines.pieces(
            heights.unwrap_or_default(),
            &output.places,
            self.operators.implication,
            self.operators.aggregation,
            &mut scratch.room,
            |piece| integrals.add(&piece),
        );
        if let Some(value) = integrals.centroid() {
            return Ok(State::Defined(value.max(output.low).min(output.high)));
        }
        match output.when_no_rule_fires {
            NoRuleFires::Undefined => Ok(State::NoRuleFired),
            NoRuleFires::Value(value) => Ok(State::Default(value)),
            NoRuleFires::Error => Err(EvaluateError::NoRuleFired {
                output: Arc::clone(&output.name),
            }),
        }
    }
}

impl Literal {
    fn degree(&self, x: f64) -> f64 {
        self.hedges
            .iter()
            .fold(self.term.membership(x), |degree, hedge| hedge.of(degree))
    }
}

#[cfg(test)]
mod tests;
