//! From input values to a risk: the engine where rules apply, the filled map where none does.

use alloc::{string::String, vec, vec::Vec};

use fuzzy::{
    Engine, Model,
    engine::{CompileError, EvaluateError, Outcome, Scratch},
};

use crate::{gap::Filling, profile::Profile};

/// A profile and its rule set, compiled: immutable, and shared by any number of monitors.
#[derive(Debug, Clone)]
pub struct Estimator {
    profile: Profile,
    engine: Engine,
    output: usize,
    filling: Filling,
    /// Which input of the profile each input of the model is.
    order: Vec<usize>,
}

/// What is said about a moment whose inputs are known.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Estimate {
    /// The risk in %, from 0 to 100.
    pub risk_pct: f64,
    /// The largest firing strength of a rule, in [0, 1]: how well the rules know such inputs.
    pub coverage: f64,
    /// The distance to the nearest inputs that rules cover, in shares of the inputs' ranges, where the risk was
    /// filled in from there; `None` where rules gave it.
    pub filled_from: Option<f64>,
    /// The rule that fired most strongly, as its index in the model.
    pub dominant_rule: Option<usize>,
    /// Whether an input lay outside its range and was taken as the range's end.
    pub clamped: bool,
}

/// Why a profile and a rule set make no estimator.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum EstimatorError {
    /// The rule set itself does not compile.
    #[error("the rule set cannot be used: {0}")]
    Rules(#[from] CompileError),
    /// It cannot be evaluated at the places that gaps are filled from.
    #[error("the rule set cannot be evaluated everywhere: {0}")]
    Evaluate(#[from] EvaluateError),
    /// The rule set has an input that the profile does not feed.
    #[error("the profile does not say where input `{input}` of the rule set comes from")]
    NoSource {
        /// The input.
        input: String,
    },
    /// The profile feeds an input that the rule set does not have.
    #[error("the rule set has no input `{input}`")]
    NoSuchInput {
        /// The input.
        input: String,
    },
    /// The rule set does not have the output that the profile takes as the risk.
    #[error("the rule set has no output `{output}`")]
    NoSuchOutput {
        /// The output.
        output: String,
    },
    /// The output is no percentage.
    #[error("output `{output}` goes from {low} to {high}, but a risk goes from 0 to 100 %")]
    NoPercentage {
        /// The output.
        output: String,
        /// The lower end of its range.
        low: f64,
        /// The upper end of its range.
        high: f64,
    },
}

impl Estimator {
    /// Compiles a rule set for a profile and fills the gaps of its map.
    ///
    /// # Errors
    ///
    /// Where the rule set does not compile, the two do not name the same inputs, or the output is no percentage.
    pub fn new(profile: &Profile, model: &Model) -> Result<Estimator, EstimatorError> {
        let engine = Engine::new(model)?;
        let output =
            engine
                .output(&profile.output)
                .ok_or_else(|| EstimatorError::NoSuchOutput {
                    output: profile.output.clone(),
                })?;
        if let Some(variable) = model.outputs.get(output).map(|o| &o.variable)
            && (variable.low < 0.0 || variable.high > 100.0)
        {
            return Err(EstimatorError::NoPercentage {
                output: profile.output.clone(),
                low: variable.low,
                high: variable.high,
            });
        }
        if let Some(stray) = profile
            .inputs
            .iter()
            .find(|i| engine.input(&i.name).is_none())
        {
            return Err(EstimatorError::NoSuchInput {
                input: stray.name.clone(),
            });
        }
        let order = model
            .inputs
            .iter()
            .map(|input| {
                let fed = profile.inputs.iter().position(|i| i.name == input.name);
                fed.ok_or_else(|| EstimatorError::NoSource {
                    input: input.name.clone(),
                })
            })
            .collect::<Result<Vec<usize>, EstimatorError>>()?;
        Ok(Estimator {
            profile: profile.clone(),
            filling: Filling::new(&engine, model, output, &profile.gap)?,
            engine,
            output,
            order,
        })
    }

    /// The profile it was made of.
    pub fn profile(&self) -> &Profile {
        &self.profile
    }

    /// The compiled rule set.
    pub fn engine(&self) -> &Engine {
        &self.engine
    }

    /// The risk at the values of the inputs, in the order of the profile: what a monitor says at such a moment.
    /// `None` where rules say nothing and there is nothing to fill from, or a value is not finite.
    ///
    /// # Example: the corner of the paper's map that no rule covers
    ///
    /// ```
    /// use flagred::{estimator::Estimator, shipped};
    ///
    /// let profile = shipped::profile("flagred-paper").ok_or("not shipped")??;
    /// let rules = shipped::rule_set(&profile.rules).ok_or("not shipped")??;
    /// let estimator = Estimator::new(&profile, &rules)?;
    /// let saturated = estimator.at(&[0.0, 0.0]).ok_or("unknown")?;
    /// assert!(saturated.risk_pct > 75.0 && saturated.filled_from.is_some());
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn at(&self, inputs: &[f64]) -> Option<Estimate> {
        self.estimate(inputs, &mut Memory::of(self))
    }

    /// As [`Estimator::at`], without allocating.
    pub(crate) fn estimate(&self, inputs: &[f64], memory: &mut Memory) -> Option<Estimate> {
        for (value, from) in memory.inputs.iter_mut().zip(&self.order) {
            *value = *inputs.get(*from)?;
        }
        match self
            .engine
            .evaluate_with(&mut memory.scratch, &memory.inputs, &mut memory.outcomes)
        {
            // Where the author calls it an error that no rule fires, the map can still fill the gap.
            Ok(()) | Err(EvaluateError::NoRuleFired { .. }) => {}
            Err(_) => return None,
        }
        let outcome = memory.outcomes.get(self.output)?;
        let gap = self.filling.is_gap(outcome.coverage);
        let reading = gap.then(|| self.filling.read(&memory.inputs)).flatten();
        let risk_pct = reading
            .map(|reading| reading.value)
            .or_else(|| outcome.value())?;
        Some(Estimate {
            risk_pct: risk_pct.clamp(0.0, 100.0),
            coverage: outcome.coverage,
            filled_from: reading.map(|reading| reading.distance),
            dominant_rule: outcome.dominant,
            clamped: outcome.clamped,
        })
    }
}

/// What an estimate needs beside the estimator: allocated once, used for every sample.
#[derive(Debug, Clone)]
pub(crate) struct Memory {
    scratch: Scratch,
    /// In the order of the model.
    inputs: Vec<f64>,
    outcomes: Vec<Outcome>,
}

impl Memory {
    pub(crate) fn of(estimator: &Estimator) -> Memory {
        Memory {
            scratch: estimator.engine.scratch(),
            inputs: vec![0.0; estimator.order.len()],
            outcomes: vec![Outcome::default(); estimator.engine.output_names().len()],
        }
    }
}
