//! From input values to a risk: the engine where rules apply, the filled map where none does.

use alloc::{string::String, vec, vec::Vec};

use fuzzy::{
    Engine, Model,
    diagnostic::Findings,
    engine::{EvaluateError, Outcome, Scratch},
    table::Set,
};

use crate::{
    board::Plan,
    channel::{Channel, Input},
    gap::Filling,
    lookup::Lookup,
    profile::Profile,
    source::channels,
};

pub use crate::assessment::Estimate;

/// A profile and its rule set, compiled: immutable, and shared by any number of monitors.
///
/// # Example: one for all flights
/// ```
/// # use flagred::shipped;
/// # let profile = shipped::profile("flagred-paper").ok_or("not shipped")??;
/// # let rules = shipped::rule_set(&profile.rules).ok_or("not shipped")??;
/// use flagred::{assessment::Sample, estimator::Estimator, monitor::Monitor};
///
/// let estimator = Estimator::new(&profile, &rules)?;
/// let (mut quad, mut octa) = (Monitor::new(&estimator, 4, &[])?, Monitor::new(&estimator, 8, &[])?);
/// for i in 0..100 {
///     let t_s = f64::from(i) * 0.04;
///     quad.push(&Sample { t_s, motors: &[0.5; 4], in_air: true, signals: &[] });
///     octa.push(&Sample { t_s, motors: &[0.5; 8], in_air: true, signals: &[] });
/// }
/// assert_eq!(quad.margin(), octa.margin()); // the number of motors does not matter
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug, Clone)]
pub struct Estimator {
    profile: Profile,
    engine: Engine,
    output: usize,
    filling: Filling,
    /// Which input of the profile each input of the model is.
    order: Vec<u32>,
    /// What is observed, where samples carry the signals of the profile in its order.
    channels: Vec<Channel>,
    inputs: Vec<Input>,
}

/// Why a profile and a rule set make no estimator.
///
/// # Example: a profile that forgets an input of its rules
/// ```
/// # use flagred::{estimator::Estimator, shipped};
/// # let mut profile = shipped::profile("flagred-paper").ok_or("not shipped")??;
/// # let rules = shipped::rule_set(&profile.rules).ok_or("not shipped")??;
/// use flagred::estimator::EstimatorError;
///
/// profile.inputs.retain(|input| input.name != "spread");
/// let refused = Estimator::new(&profile, &rules).unwrap_err();
/// assert_eq!(refused, EstimatorError::NoSource { input: "spread".into() });
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum EstimatorError {
    /// The rule set itself does not compile.
    #[error("the rule set cannot be used: {0}")]
    Rules(#[from] Findings),
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

/// The value of an output takes more than a table of numbers, so it cannot fly on board.
///
/// # Example: a bisector has none
/// ```
/// # use flagred::{estimator::Estimator, shipped};
/// # let profile = shipped::profile("flagred-paper").ok_or("not shipped")??;
/// # let mut rules = shipped::rule_set(&profile.rules).ok_or("not shipped")??;
/// use flagred::estimator::NoClosedForm;
/// use fuzzy::model::Defuzzifier;
///
/// rules.outputs[0].defuzzifier = Defuzzifier::Bisector;
/// let estimator = Estimator::new(&profile, &rules)?;
/// assert!(estimator.at(&[0.3, 0.1]).is_some(), "with the standard library there is an answer");
/// assert_eq!(estimator.plan().err(), Some(NoClosedForm { output: "risk".into() }));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("the value of output `{output}` has no closed form, so it cannot be written as a table")]
pub struct NoClosedForm {
    /// The output.
    pub output: String,
}

impl NoClosedForm {
    /// What has one.
    ///
    /// # Example
    /// ```
    /// use flagred::estimator::NoClosedForm;
    ///
    /// let refused = NoClosedForm { output: "risk".into() };
    /// assert!(refused.help().starts_with("closed forms have: the centroid"));
    /// ```
    pub fn help(&self) -> &'static str {
        "closed forms have: the centroid over straight terms that overlap only where one falls while the next one rises \
         (a `partition`), with minimum and maximum; the centroid with `implication: product` and `aggregation: sum`, over \
         any terms; the Takagi-Sugeno defuzzifiers. All of them without `samples`"
    }
}

impl Estimator {
    /// Compiles a rule set for a profile and fills the gaps of its map.
    ///
    /// # Errors
    ///
    /// Where the rule set does not compile, the two do not name the same inputs, or the output is no percentage.
    ///
    /// # Example: an output that is no percentage
    /// ```
    /// # use flagred::{estimator::Estimator, shipped};
    /// # let profile = shipped::profile("flagred-paper").ok_or("not shipped")??;
    /// # let mut rules = shipped::rule_set(&profile.rules).ok_or("not shipped")??;
    /// assert!(Estimator::new(&profile, &rules).is_ok());
    /// rules.outputs[0].variable.high = 200.0;
    /// let refused = Estimator::new(&profile, &rules).unwrap_err();
    /// assert_eq!(refused.to_string(), "output `risk` goes from 0 to 200, but a risk goes from 0 to 100 %");
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
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
                fed.map(|place| place as u32)
                    .ok_or_else(|| EstimatorError::NoSource {
                        input: input.name.clone(),
                    })
            })
            .collect::<Result<Vec<u32>, EstimatorError>>()?;
        let sources = profile.inputs.iter().map(|input| &input.source);
        let (channels, inputs) = channels(sources, &profile.signals())
            .map_err(|input| EstimatorError::NoSource { input })?;
        Ok(Estimator {
            profile: profile.clone(),
            filling: Filling::new(&engine, model, output, &profile.gap)?,
            engine,
            output,
            order,
            channels,
            inputs,
        })
    }

    /// The profile it was made of.
    ///
    /// # Example
    /// ```
    /// # use flagred::{estimator::Estimator, shipped};
    /// # let profile = shipped::profile("flagred-paper").ok_or("not shipped")??;
    /// # let rules = shipped::rule_set(&profile.rules).ok_or("not shipped")??;
    /// # let estimator = Estimator::new(&profile, &rules)?;
    /// assert_eq!(estimator.profile().name, "flagred-paper");
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn profile(&self) -> &Profile {
        &self.profile
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
        let Memory {
            scratch,
            point,
            outcomes,
        } = memory;
        let rules = |point: &[f64]| match self.engine.evaluate_with(scratch, point, outcomes) {
            // Where the author calls it an error that no rule fires, the map can still fill the gap.
            Ok(()) | Err(EvaluateError::NoRuleFired { .. }) => outcomes.get(self.output).copied(),
            Err(_) => None,
        };
        self.lookup().estimate(inputs, point, rules)
    }

    /// The profile and its rule set as plain data, to fly on board; samples carry the signals of
    /// [`Profile::signals`], in that order.
    ///
    /// # Errors
    ///
    /// The output has no closed form.
    ///
    /// # Example: how much memory the paper's profile needs for four motors
    ///
    /// ```
    /// use flagred::{estimator::Estimator, shipped};
    ///
    /// let profile = shipped::profile("flagred-paper").ok_or("not shipped")??;
    /// let rules = shipped::rule_set(&profile.rules).ok_or("not shipped")??;
    /// let estimator = Estimator::new(&profile, &rules)?;
    /// let plan = estimator.plan()?;
    /// assert_eq!(plan.check(), Ok(()));
    /// assert_eq!((plan.sizes().channels, plan.sizes().outputs), (2, 1));
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn plan(&self) -> Result<Plan<'_>, NoClosedForm> {
        let table = self.engine.table();
        let open = |output: &fuzzy::table::Output| output.set == Set::OPEN;
        if table.outputs.get(self.output).is_none_or(open) {
            return Err(NoClosedForm {
                output: self.profile.output.clone(),
            });
        }
        Ok(Plan {
            name: &self.profile.name,
            table,
            output: self.output as u32,
            order: &self.order,
            channels: &self.channels,
            inputs: &self.inputs,
            signals: self.profile.signals().len() as u32,
            settings: self.profile.settings(),
            coverage_below: self.filling.coverage_below(),
            filled: self.filling.lend(),
        })
    }

    fn lookup(&self) -> Lookup<'_> {
        Lookup {
            order: &self.order,
            coverage_below: self.filling.coverage_below(),
            filled: self.filling.lend(),
        }
    }
}

/// What an estimate needs beside the estimator: allocated once, used for every sample.
#[derive(Debug, Clone)]
pub(crate) struct Memory {
    scratch: Scratch,
    /// The inputs in the order of the model.
    point: Vec<f64>,
    outcomes: Vec<Outcome>,
}

impl Memory {
    pub(crate) fn of(estimator: &Estimator) -> Memory {
        let inputs = estimator.order.len();
        Memory {
            scratch: estimator.engine.scratch(),
            point: vec![0.0; inputs],
            outcomes: vec![Outcome::default(); estimator.engine.output_names().len()],
        }
    }
}
