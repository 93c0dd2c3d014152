//! A compiled profile and rule set, which computes a risk from input values.

use alloc::{string::String, sync::Arc, vec, vec::Vec};

use fuzzy::{
    Engine, Model,
    diagnostic::Findings,
    engine::{AntecedentProposition, EvaluateError, Interval, Outcome, Scratch},
};

use crate::{
    board::Plan,
    cause::{Cause, Proposition, Propositions, RuleQuery},
    channel::{Channel, Input},
    craft::Craft,
    gap::Filling,
    lookup::{Lookup, UNREAD},
    plan::{PlanError, rules_for},
    profile::Profile,
    sample::Estimate,
};

/// A compiled profile and rule set. Clones share the compiled data, so cloning is cheap.
///
/// # Example
/// ```
/// use flagred::{monitor::{Craft, Monitor}, shipped};
///
/// let estimator = shipped::flagred();
/// let quad = Monitor::new(&estimator, Craft::new(4))?;
/// let octa = Monitor::new(&estimator, Craft::new(8))?;
/// # Ok::<(), flagred::monitor::MonitorError>(())
/// ```
#[derive(Debug, Clone)]
pub struct Estimator(Arc<Compiled>);

#[derive(Debug)]
struct Compiled {
    profile: Profile,
    engine: Engine,
    output: usize,
    filling: Filling,
    /// For each input of the model its index in the profile; [`UNREAD`] if the risk does not depend on it.
    order: Vec<u32>,
    /// The channels, for samples that have the signals of the profile in the order of the profile.
    channels: Vec<Channel>,
    inputs: Vec<Input>,
    propositions: Vec<Proposition>,
    /// The inputs and terms of the propositions, by name.
    antecedents: Vec<AntecedentProposition>,
    /// The estimators of the other risks of the profile, each compiled as if its risk were the only one.
    others: Vec<Estimator>,
}

/// The reason why a profile and a rule set cannot be compiled.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum EstimatorError {
    /// The rule set does not compile.
    #[error("the rule set cannot be used: {0}")]
    Rules(#[from] Findings),
    /// The rule set cannot be evaluated at the points from which gaps are filled.
    #[error("the rule set cannot be evaluated everywhere: {0}")]
    Evaluate(#[from] EvaluateError),
    /// The rule set has an input that the profile does not provide.
    #[error("the profile has no source for input `{input}` of the rule set")]
    NoSource {
        /// The input.
        input: String,
    },
    /// The profile provides an input that the rule set does not have.
    #[error("the rule set has no input `{input}`")]
    NoSuchInput {
        /// The input.
        input: String,
    },
    /// The rule set does not have the output that the profile names as the risk.
    #[error("the rule set has no output `{output}`")]
    NoSuchOutput {
        /// The output.
        output: String,
    },
    /// The range of the output is not a percentage.
    #[error("output `{output}` has the range [{low}, {high}], but a risk has the range [0, 100] %")]
    NoPercentage {
        /// The output.
        output: String,
        /// The lower end of the range of the output.
        low: f64,
        /// The upper end of the range.
        high: f64,
    },
    /// The value to assume for an input with a missing signal is outside the range of the input.
    #[error(
        "`if_missing` of input `{input}` is {value}, but the range of the input is {low} to {high}"
    )]
    IfMissingOutside {
        /// The input.
        input: String,
        /// The value.
        value: f64,
        /// The lower end of the input's range.
        low: f64,
        /// The upper end of the range.
        high: f64,
    },
    /// The output keeps its previous value where no rule fires, which conflicts with filling gaps.
    #[error(
        "output `{output}` keeps its previous value where no rule fires, which is not allowed for a risk"
    )]
    KeepsPrevious {
        /// The output.
        output: String,
    },
    /// The rule set has interval type-2 terms.
    #[error("the rule set has type-2 terms, which a profile does not support")]
    Type2,
}

impl Estimator {
    /// Compiles a rule set for a profile and fills the gaps of its map.
    ///
    /// # Errors
    ///
    /// If the rule set does not compile or has type-2 terms, if the profile and the rule set have different inputs, if
    /// the range of an output is not a percentage, or if an output keeps its previous value.
    pub fn new(profile: &Profile, model: &Model) -> Result<Estimator, EstimatorError> {
        Estimator::with_engine(profile, &Engine::new(model)?)
    }

    /// As [`new`](Self::new), with a compiled rule set.
    pub(crate) fn with_engine(
        profile: &Profile,
        engine: &Engine,
    ) -> Result<Estimator, EstimatorError> {
        let model = engine.model();
        if model.has_type2_terms() {
            return Err(EstimatorError::Type2);
        }
        let others = profile.other_risks.iter().map(|risk| {
            let profile = profile.of_risk(risk);
            Estimator::with_engine(&profile, engine)
        });
        let others = others.collect::<Result<Vec<Estimator>, EstimatorError>>()?;
        let output =
            engine
                .output(&profile.output)
                .ok_or_else(|| EstimatorError::NoSuchOutput {
                    output: profile.output.clone(),
                })?;
        if let Some(variable) = model.outputs.get(output).map(|o| &o.variable)
            && (variable.low, variable.high) != (0.0, 100.0)
        {
            return Err(EstimatorError::NoPercentage {
                output: profile.output.clone(),
                low: variable.low,
                high: variable.high,
            });
        }
        if let Some(output) = model.outputs.iter().find(|output| output.keeps_previous()) {
            return Err(EstimatorError::KeepsPrevious {
                output: output.variable.name.clone(),
            });
        }
        if let Some(stray) = profile
            .inputs
            .iter()
            .find(|i| engine.input(&i.name).is_none() && !profile.is_part(&i.name))
        {
            return Err(EstimatorError::NoSuchInput {
                input: stray.name.clone(),
            });
        }
        let fed = model
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
        for (variable, place) in model.inputs.iter().zip(&fed) {
            let (low, high) = (variable.low, variable.high);
            let input = profile.inputs.get(*place as usize);
            if let Some(value) = input.and_then(|input| input.if_missing)
                && !(low..=high).contains(&value)
            {
                let input = variable.name.clone();
                return Err(EstimatorError::IfMissingOutside {
                    input,
                    value,
                    low,
                    high,
                });
            }
        }
        let read = model.inputs_of(&profile.output);
        let order = model.inputs.iter().zip(&fed).map(|(input, place)| {
            match read.contains(&input.name.as_str()) {
                true => *place,
                false => UNREAD,
            }
        });
        let order = order.collect();
        let signals = profile.signals();
        // The signals that the vehicle will send are unknown when a plan is created.
        let craft = Craft::new(0).with_signals(&signals);
        let (channels, inputs) = profile
            .channels(&[], craft.with_optional(&signals))
            .map_err(|input| EstimatorError::NoSource { input })?;
        let antecedents = engine.propositions();
        let propositions = antecedents.iter().map(|antecedents| Proposition {
            rule: antecedents.evaluation_index as u32,
            input: match antecedents.input.checked_sub(fed.len()) {
                None => fed.get(antecedents.input).copied().unwrap_or_default(),
                Some(output) => (profile.inputs.len() + output) as u32,
            },
            literal: antecedents.literal as u32,
        });
        Ok(Estimator(Arc::new(Compiled {
            propositions: propositions.collect(),
            antecedents,
            others,
            profile: profile.clone(),
            filling: Filling::new(engine, model, output, &profile.gap)?,
            engine: engine.clone(),
            output,
            order,
            channels,
            inputs,
        })))
    }

    /// The profile.
    pub fn profile(&self) -> &Profile {
        &self.0.profile
    }

    /// The estimators of [`Profile::other_risks`], each as if it were the only risk.
    pub fn others(&self) -> &[Estimator] {
        &self.0.others
    }

    /// The rule set.
    pub fn model(&self) -> &Model {
        self.0.engine.model()
    }

    /// The compiled rule set.
    pub fn engine(&self) -> &Engine {
        &self.0.engine
    }

    /// The index of the output that is the risk.
    pub(crate) fn output(&self) -> usize {
        self.0.output
    }

    /// The smallest and the largest of the values that fill gaps while each input is within its interval. The inputs
    /// are in the order of the model.
    pub(crate) fn filled_within(&self, inputs: &[Interval]) -> Option<Interval> {
        self.0.filling.borrowed()?.within(inputs)
    }

    /// The indices of the inputs, as in [`Lookup::order`].
    pub(crate) fn order(&self) -> &[u32] {
        &self.0.order
    }

    /// The cause of a risk of `risk_pct` for given values of the inputs, in the order of the profile.
    pub(crate) fn cause(
        &self,
        inputs: &[f64],
        risk_pct: f64,
        memory: &mut Memory,
    ) -> Option<Cause> {
        let Memory { scratch, point, .. } = memory;
        self.lookup().reorder(inputs, point)?;
        let engine = &self.0.engine;
        let propositions = Propositions {
            all: &self.0.propositions,
        };
        let risk = (self.0.output, risk_pct);
        let outputs = engine.output_names().len();
        let cause = propositions.cause(inputs, risk, outputs, |output, requested, pick| {
            let rule = match requested {
                RuleQuery::Raises(value) => engine.raised_by(scratch, point, output, value),
                RuleQuery::Concludes(antecedents) => {
                    engine.concluded_by(scratch, point, self.0.antecedents.get(antecedents)?)
                }
            };
            pick(rule?, scratch.degrees())
        })?;
        let rule = self.0.antecedents.get(cause.proposition)?.rule;
        Some(Cause { rule, ..cause })
    }

    /// The input and the term, with its hedges, of each proposition of the rules, in the order of
    /// [`Plan::propositions`]. [`Cause::proposition`] is an index into them.
    pub fn propositions(&self) -> impl ExactSizeIterator<Item = (&str, &str)> {
        let all = self.0.propositions.iter().zip(&self.0.antecedents);
        all.map(|(antecedents, AntecedentProposition { term, .. })| {
            let inputs = &self.0.profile.inputs;
            let name = match (antecedents.input as usize).checked_sub(inputs.len()) {
                None => inputs
                    .get(antecedents.input as usize)
                    .map(|input| &*input.name),
                Some(output) => self.0.engine.output_names().nth(output),
            };
            (name.unwrap_or_default(), term.as_str())
        })
    }

    /// The risk for given values of the inputs, in the order of the profile, as a monitor computes it. `None` if no
    /// rule applies and nothing can be interpolated, or if a value that the risk depends on is not finite.
    pub fn at(&self, inputs: &[f64]) -> Option<Estimate> {
        self.estimate(inputs, &mut Memory::of(self))
    }

    /// As [`Estimator::at`], in memory that the caller reuses.
    pub(crate) fn estimate(&self, inputs: &[f64], memory: &mut Memory) -> Option<Estimate> {
        let Memory {
            scratch,
            point,
            outcomes,
        } = memory;
        let rules = |point: &[f64]| match self.0.engine.evaluate_with(scratch, point, outcomes) {
            // Even if the author declared it an error that no rule fires, the map can fill the gap.
            Ok(()) | Err(EvaluateError::NoRuleFired { .. }) => outcomes.get(self.0.output).copied(),
            Err(_) => None,
        };
        self.lookup().estimate(inputs, point, rules)
    }

    /// The profile and its rule set as plain data for a monitor on board. Samples must have the signals of
    /// [`Profile::signals`], in that order.
    ///
    /// # Errors
    ///
    /// If the output, or an output that it reads, has no closed form, or if the profile has several risks.
    pub fn plan(&self) -> Result<Plan<'_>, PlanError> {
        if let Some(other) = self.0.profile.other_risks.first() {
            return Err(PlanError::SeveralRisks {
                output: self.0.profile.output.clone(),
                other: other.output.clone(),
            });
        }
        Ok(Plan {
            name: &self.0.profile.name,
            rules: rules_for(&self.0.engine, self.0.output..self.0.output + 1)?,
            output: self.0.output as u32,
            order: &self.0.order,
            channels: &self.0.channels,
            inputs: &self.0.inputs,
            signals: self.0.profile.signals().len() as u32,
            settings: self.0.profile.settings(),
            coverage_below: self.0.filling.coverage_below(),
            filled: self.0.filling.borrowed(),
            propositions: &self.0.propositions,
        })
    }

    /// The values that fill gaps; empty if nothing is filled.
    pub(crate) fn filled(&self) -> &[f64] {
        self.0.filling.borrowed().map_or(&[], |knots| knots.values)
    }

    fn lookup(&self) -> Lookup<'_> {
        Lookup {
            order: &self.0.order,
            coverage_below: self.0.filling.coverage_below(),
            filled: self.0.filling.borrowed(),
        }
    }
}

/// The working memory of an estimate, allocated once and used for every sample.
#[derive(Debug, Clone)]
pub(crate) struct Memory {
    scratch: Scratch,
    /// The inputs in the order of the model. Inputs that the risk does not depend on are at the lower ends of their
    /// ranges.
    point: Vec<f64>,
    outcomes: Vec<Outcome>,
}

impl Memory {
    pub(crate) fn of(estimator: &Estimator) -> Memory {
        let inputs = estimator.model().inputs.iter();
        Memory {
            scratch: estimator.0.engine.scratch(),
            point: inputs.map(|input| input.low).collect(),
            outcomes: vec![Outcome::default(); estimator.0.engine.output_names().len()],
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{board::OwnedMemory, shipped};

    #[test]
    fn a_risk_is_a_percentage() {
        let profile = shipped::flagred_paper().profile().clone();
        for (range, is_percentage) in [
            ("[0, 1]", false),
            ("[0, 10]", false),
            ("[0, 100]", true),
            ("[0, 200]", false),
        ] {
            let text = shipped::RULE_SETS[1].text.replace("[0, 100]", range);
            let rules = fuzzy::yaml::parse(&text).unwrap().model;
            let made = Estimator::new(&profile, &rules);
            let is_refused = matches!(made, Err(EstimatorError::NoPercentage { .. }));
            assert_eq!(is_refused, !is_percentage, "{range}");
        }
    }

    #[test]
    fn a_risk_needs_only_the_inputs_that_its_rules_read() {
        let both = shipped::flagred_battery();
        let model = both.model();
        let battery = both.profile().of_risk(&both.profile().other_risks[0]);
        let battery = Estimator::new(&battery, model).unwrap();
        let mut motors = both.profile().clone();
        motors.other_risks.clear();
        let motors = Estimator::new(&motors, model).unwrap();
        let default = shipped::flagred();
        let known = [0.01, 0.02, 0.01, 0.3, 0.4, 0.1];
        let with = |battery: f64| [&known[..], &[battery]].concat();
        let risk = default.at(&known);
        assert!(risk.is_some());
        // The risk does not depend on this input, so unknown values and values outside its range do not matter.
        for level in [80.0, f64::NAN, 250.0] {
            assert_eq!(motors.at(&with(level)), risk, "{level}");
            let plan = motors.plan().unwrap();
            let mut memory = OwnedMemory::new(&plan, 4);
            let mut monitor = memory.monitor(&plan).unwrap();
            assert_eq!(monitor.at(&with(level)), risk, "{level}");
        }
        let unknown = [f64::NAN; 7];
        assert_eq!((motors.at(&unknown), battery.at(&unknown)), (None, None));
        let mut only_battery = unknown;
        only_battery[6] = 0.0;
        assert_eq!(battery.at(&only_battery).unwrap().risk_pct, 100.0);
        assert!(!battery.plan().unwrap().needs_motors());
        assert!(motors.plan().unwrap().needs_motors());
    }

    #[test]
    fn profile_and_rules_name_the_same_inputs() {
        let mut profile = shipped::flagred_paper().profile().clone();
        let rules = shipped::flagred_paper_rules();
        profile.inputs.retain(|input| input.name != "spread");
        let refused = Estimator::new(&profile, &rules).unwrap_err();
        let input = "spread".into();
        assert_eq!(refused, EstimatorError::NoSource { input });
    }
}
