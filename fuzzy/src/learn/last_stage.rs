//! Learning rules for the last output of a chain: the outputs that it reads are inputs of the learner.

use alloc::{collections::BTreeSet, string::String, vec::Vec};

use super::{LearnError, SampleError, check};
use crate::{
    engine::Engine,
    model::{Model, Rule},
};

/// The last output of a chain as a model of its own. The outputs that it reads are inputs of this model; their values
/// are computed from the inputs of the chain by its existing rules. A model without a chain is used unchanged.
///
/// # Example: a fan whose speed depends on the comfort, which the samples do not contain
/// ```
/// use fuzzy::learn::{Learner, Settings, LastStage};
///
/// let model = fuzzy::yaml::parse("
/// fuzzy: 1
/// name: fan
/// inputs: {heat: {range: [0, 40], partition: [cool, hot]}}
/// outputs:
///   comfort: {range: [0, 1], partition: [poor, good], defuzzifier: mean_of_maxima}
///   speed: {range: [0, 9], partition: [slow, fast]}
/// rules:
///   - IF heat IS cool THEN comfort IS good
///   - IF heat IS hot THEN comfort IS poor
/// ")?.model;
/// let chain = LastStage::new(&model)?;
/// let mut learner = Learner::new(chain.model(), Settings::default())?;
/// for sample in [[5.0, 1.0], [38.0, 8.5]] {
///     learner.add(&chain.values(&sample)?, 1.0)?;
/// }
/// let whole = chain.joined(&learner.finish().model);
/// assert_eq!(whole.rules[2].rule.to_string(), "IF comfort IS poor THEN speed IS fast");
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug, Clone)]
pub struct LastStage {
    whole: Model,
    target: usize,
    /// The other outputs with their rules.
    before: Option<Engine>,
    /// For each input of the model: the index of an input of the chain or, offset by the number of inputs, of an output
    /// of `before`.
    picks: Vec<usize>,
    model: Model,
}

impl LastStage {
    /// Separates the measured output of a model, [`Model::measured_output`], from its chain. The inputs of the learner
    /// are the variables that its rules read. If it has no rules, they are the outputs that no other output reads, and
    /// the inputs that those outputs do not depend on.
    ///
    /// # Errors
    /// The model has several outputs and none of them is the measured one, or the rules of the other outputs cannot be
    /// used.
    pub fn new(model: &Model) -> Result<LastStage, LearnError> {
        let outputs = LearnError::Outputs {
            outputs: model.last_outputs().len(),
        };
        let target = model.measured_output().ok_or(outputs)?;
        let mut last_stage = LastStage {
            whole: model.clone(),
            target,
            before: None,
            picks: (0..model.inputs.len()).collect(),
            model: model.clone(),
        };
        if model.outputs.len() == 1 {
            return Ok(last_stage);
        }
        let name = model.outputs.get(target).map(|o| &o.variable.name);
        let is_of_target = |output: &String| Some(output) == name;
        let mut before = model.clone();
        before.outputs.remove(target);
        before.rules = of_outputs(&model.rules, |output| !is_of_target(output));
        let own = of_outputs(&model.rules, is_of_target);

        let read = read_by(&own, &before);
        let variables = before.variables().enumerate();
        let (picks, inputs) = variables
            .filter(|(_, variable)| read.contains(&variable.name))
            .map(|(index, variable)| (index, variable.clone()))
            .unzip();
        last_stage.picks = picks;
        last_stage.model.inputs = inputs;
        last_stage
            .model
            .outputs
            .retain(|o| is_of_target(&o.variable.name));
        last_stage.model.rules = own;
        let engine = Engine::new(&before).map_err(|findings| LearnError::Chain {
            message: match (
                before.rules.is_empty(),
                before.outputs.first(),
                findings.0.first(),
            ) {
                (true, Some(output), _) => {
                    alloc::format!("no rule concludes `{}`", output.variable.name)
                }
                (_, _, Some(finding)) => finding.message.clone(),
                _ => "their rules have errors".into(),
            },
        })?;
        last_stage.before = Some(engine);
        Ok(last_stage)
    }

    /// Returns the model for the learner: the measured output, its rules, and the inputs of the learner.
    pub fn model(&self) -> &Model {
        &self.model
    }

    /// Converts a sample to one for [`model`](Self::model). `sample` has a value for each of
    /// [`Model::measured_variables`] of the chain.
    ///
    /// # Errors
    /// A value is not finite or outside its range, or an output that is read has no value.
    pub fn values(&self, sample: &[f64]) -> Result<Vec<f64>, SampleError> {
        let Some(before) = &self.before else {
            return Ok(sample.to_vec());
        };
        let wrong_number = || SampleError::WrongNumber {
            expected: self.whole.inputs.len() + 1,
            got: sample.len(),
        };
        let (target, inputs) = sample.split_last().ok_or_else(wrong_number)?;
        for (variable, value) in self.whole.inputs.iter().zip(inputs) {
            check(variable, *value)?;
        }
        let outcomes = before.evaluate(inputs).map_err(|_| wrong_number())?;
        let value = |pick: &usize| match inputs.get(*pick) {
            Some(value) => Ok(*value),
            None => {
                let output = *pick - inputs.len();
                let value = outcomes.get(output).and_then(|outcome| outcome.value());
                value.ok_or_else(|| SampleError::NoValue {
                    variable: before.output_names().nth(output).unwrap_or_default().into(),
                })
            }
        };
        let values = self.picks.iter().map(value);
        values.chain([Ok(*target)]).collect()
    }

    /// Returns the chain with the rules of the measured output replaced by those of a learned model.
    #[must_use]
    pub fn joined(&self, learned: &Model) -> Model {
        if self.before.is_none() {
            return learned.clone();
        }
        let mut whole = self.whole.clone();
        let target = whole.outputs.get(self.target);
        let target = target.map(|output| output.variable.name.clone());
        whole.rules = of_outputs(&whole.rules, |output| Some(output) != target.as_ref());
        whole.rules.extend(learned.rules.iter().cloned());
        whole
    }
}

/// Returns the rules, restricted to consequents about the selected outputs.
fn of_outputs(rules: &[Rule], is_kept: impl Fn(&String) -> bool) -> Vec<Rule> {
    let mut rules = rules.to_vec();
    for rule in &mut rules {
        rule.rule
            .consequents
            .retain(|consequent| is_kept(&consequent.output.text));
    }
    rules.retain(|rule| !rule.rule.consequents.is_empty());
    rules
}

/// Returns the names of the learner's inputs for an output with these rules.
fn read_by(own: &[Rule], before: &Model) -> BTreeSet<String> {
    let mut read = BTreeSet::new();
    for rule in own {
        rule.rule.condition.visit(&mut |proposition| {
            read.insert(proposition.variable.text.clone());
        });
    }
    if !read.is_empty() {
        return read;
    }
    let last = before.last_outputs().into_iter();
    let last: Vec<&str> = last
        .filter_map(|output| Some(before.outputs.get(output)?.variable.name.as_str()))
        .collect();
    let behind: BTreeSet<&str> = last
        .iter()
        .flat_map(|output| before.inputs_of(output))
        .collect();
    let inputs = before.inputs.iter().map(|input| input.name.as_str());
    let rest = inputs.filter(|input| !behind.contains(input));
    rest.chain(last.iter().copied()).map(String::from).collect()
}
