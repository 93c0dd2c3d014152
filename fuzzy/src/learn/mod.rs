//! Learning rules from data by the method of Wang and Mendel (1992): each sample votes for the rule with the highest
//! memberships.
//!
//! 1. Each value of a sample is assigned to the term with its highest membership (the first of equal ones). The terms of
//!    the inputs are the antecedent, the term of the output is the consequent, and the degree of the vote is the product
//!    of all memberships, times the weight of the sample. If all terms of the output are constants or singletons, a value
//!    belongs to its two neighbours, with degrees that decrease linearly with the distance: with terms 0 and 50, the value
//!    30 belongs to 0 with degree 0.4 and to 50 with degree 0.6. Values beyond the outermost terms belong to them with degree 1.
//! 2. If the samples of an antecedent disagree, [`Resolution`] selects the consequent.
//! 3. The rule stores the rejected consequents, the number of its samples (support) and its confidence.
//!
//! Sums use fixed-point arithmetic, so the result does not depend on the order of the samples.

use alloc::{boxed::Box, collections::BTreeMap, vec, vec::Vec};

use crate::{
    model::{Model, Variable},
    rule::{Condition, Name},
};

mod consequents;
mod last_stage;
mod monotone;
mod resolve;
mod settings;
mod sum;
#[cfg(test)]
mod tests;

use consequents::{Consequents, highest};
pub use last_stage::LastStage;
#[doc(hidden)]
pub use settings::bad_weight;
pub use settings::{Direction, LearnError, Resolution, SampleError, Settings, WEIGHTS};
use sum::Sum;

/// A learner, which collects samples and derives rules from them.
///
/// # Example: rules for a fan from three samples, two of which contradict each other
///
/// ```
/// use fuzzy::learn::{Learner, Settings};
///
/// let model = fuzzy::yaml::parse("
/// fuzzy: 1
/// name: fan
/// inputs:
///   heat: {range: [0, 100], partition: [low, high]}
/// outputs:
///   speed: {range: [0, 9], partition: [slow, fast]}
/// rules: []
/// ")?.model;
/// let mut learner = Learner::new(&model, Settings::default())?;
/// for sample in [[5.0, 1.0], [95.0, 8.5], [90.0, 2.0]] {
///     learner.add(&sample, 1.0)?;
/// }
/// let learned = learner.finish();
///
/// let rule = &learned.model.rules[1];
/// assert_eq!(rule.rule.to_string(), "IF heat IS high THEN speed IS fast");
/// assert_eq!(rule.against[0].term, "slow");
/// assert_eq!((learned.conflicts, learned.missing), (1, 0));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug, Clone)]
pub struct Learner {
    model: Model,
    settings: Settings,
    consequents: Consequents,
    samples: u64,
    /// The largest weight of a sample so far.
    heaviest: f64,
    cells: BTreeMap<Box<[u16]>, Cell>,
}

/// The learned rules, with statistics about the data.
#[derive(Debug, Clone, PartialEq)]
pub struct LearnResult {
    /// The model with its original rules, followed by the learned rules in the order of their
    /// antecedents.
    pub model: Model,
    /// The number of samples.
    pub samples: u64,
    /// The number of antecedents whose samples voted for different consequents.
    pub conflicts: u64,
    /// The number of antecedents without a rule.
    pub missing: u64,
    /// The first antecedents without a rule, at most [`LearnResult::SHOWN`].
    pub missing_antecedents: Vec<Condition>,
    /// The number of antecedents that have samples but fall below [`Settings::min_support`] or
    /// [`Settings::min_degree`].
    pub left_out: u64,
    /// The number of rules that were completed from their neighbours.
    pub completed: u64,
    /// The number of rules whose consequent was changed to satisfy [`Settings::monotone`].
    pub moved: u64,
}

impl LearnResult {
    /// The maximum length of [`LearnResult::missing_antecedents`].
    pub const SHOWN: usize = 100;
}

/// The votes of the samples of one antecedent.
#[derive(Debug, Clone, Default)]
struct Cell {
    samples: u64,
    /// The votes by the index of the output's term.
    votes: BTreeMap<u16, Votes>,
    /// The sum of the degrees of the antecedent.
    degrees: Sum,
    /// The sum of these degrees times the output value, as a fraction of the output's range.
    values: Sum,
}

#[derive(Debug, Clone, Copy, Default)]
struct Votes {
    samples: u64,
    strongest: f64,
    degrees: Sum,
}

impl Learner {
    /// Creates a learner for the variables of a model with one output.
    ///
    /// # Errors
    /// The model does not have exactly one output, or has rule blocks or type-2 terms; a variable has no terms; the
    /// settings name an input that the model does not have; or there are too many antecedents for the settings.
    pub fn new(model: &Model, settings: Settings) -> Result<Learner, LearnError> {
        let [output] = model.outputs.as_slice() else {
            return Err(LearnError::Outputs {
                outputs: model.outputs.len(),
            });
        };
        if !model.blocks.is_empty() {
            return Err(LearnError::Blocks);
        }
        if model.has_type2_terms() {
            return Err(LearnError::Type2);
        }
        let mut variables = model.inputs.iter().chain([&output.variable]);
        if let Some(bare) = variables.find(|v| v.terms.is_empty()) {
            return Err(LearnError::NoTerms {
                variable: bare.name.clone(),
            });
        }
        let reads = |term: &&crate::model::Term| {
            let reads = term.membership_function.reads();
            reads.iter().any(|name| *name != output.variable.name)
        };
        if let Some(term) = output.variable.terms.iter().find(reads) {
            return Err(LearnError::ReadsInputs {
                term: term.name.clone(),
            });
        }
        for (name, _) in &settings.monotone {
            if model.inputs.iter().all(|input| input.name != *name) {
                return Err(LearnError::NoInput { name: name.clone() });
            }
        }
        let (antecedents, max) = (resolve::antecedents(model), resolve::MAX_ANTECEDENTS);
        if antecedents > max && (settings.complete || !settings.monotone.is_empty()) {
            return Err(LearnError::TooManyAntecedents { antecedents, max });
        }
        Ok(Learner {
            model: model.clone(),
            settings,
            consequents: Consequents::of(&output.variable),
            samples: 0,
            heaviest: 0.0,
            cells: BTreeMap::new(),
        })
    }

    /// Adds a sample: a value for each input of the model, followed by the output value; and a weight inside
    /// [`WEIGHTS`].
    ///
    /// # Errors
    /// The sample is invalid. It is not added.
    pub fn add(&mut self, values: &[f64], weight: f64) -> Result<(), SampleError> {
        let Some((output, inputs)) = values
            .split_last()
            .filter(|(_, inputs)| inputs.len() == self.model.inputs.len())
        else {
            return Err(SampleError::WrongNumber {
                expected: self.model.inputs.len() + 1,
                got: values.len(),
            });
        };
        if !WEIGHTS.contains(&weight) {
            return Err(SampleError::Weight { weight });
        }
        let Some(consequent) = self.model.outputs.first().map(|o| &o.variable) else {
            return Ok(());
        };
        for (variable, value) in self.model.inputs.iter().chain([consequent]).zip(values) {
            check(variable, *value)?;
        }
        let mut degree = weight;
        let mut antecedent = vec![0; inputs.len()];
        let variables = self.model.inputs.iter().zip(inputs);
        for (index, (variable, value)) in antecedent.iter_mut().zip(variables) {
            let (term, membership) =
                highest(variable, *value).ok_or_else(|| SampleError::NoTerm {
                    variable: variable.name.clone(),
                    value: *value,
                })?;
            *index = term;
            degree *= membership;
        }
        let vote = match (
            self.consequents.highest(consequent, *output),
            self.settings.resolution,
        ) {
            // The sample votes for the term with the highest degree or, in a gap between terms, for the nearest term.
            (_, Resolution::Mean) => (self.consequents.nearest(consequent, *output), 1.0),
            (Some(vote), _) => vote,
            (None, _) => {
                return Err(SampleError::NoTerm {
                    variable: consequent.name.clone(),
                    value: *output,
                });
            }
        };
        self.samples += 1;
        self.heaviest = self.heaviest.max(weight);
        if degree <= 0.0 {
            return Ok(());
        }
        let cell = self.cells.entry(antecedent.into_boxed_slice()).or_default();
        cell.samples += 1;
        cell.degrees.add(degree);
        let share = (output - consequent.low) / (consequent.high - consequent.low);
        cell.values.add(degree * share);
        let (term, membership) = vote;
        let votes = cell.votes.entry(term).or_default();
        votes.samples += 1;
        votes.strongest = votes.strongest.max(degree * membership);
        votes.degrees.add(degree * membership);
        Ok(())
    }

    /// Returns the number of samples so far.
    pub fn samples(&self) -> u64 {
        self.samples
    }

    /// Derives the rules from the samples.
    pub fn finish(&self) -> LearnResult {
        resolve::resolve(self)
    }
}

fn check(variable: &Variable, value: f64) -> Result<(), SampleError> {
    if !value.is_finite() {
        return Err(SampleError::NotFinite {
            variable: variable.name.clone(),
        });
    }
    if value < variable.low || value > variable.high {
        return Err(SampleError::OutOfRange {
            variable: variable.name.clone(),
            value,
            low: variable.low,
            high: variable.high,
        });
    }
    Ok(())
}

/// Returns the condition `a IS x AND b IS y` for a term of each input.
fn antecedent(learner: &Learner, terms: &[u16]) -> Option<Condition> {
    let inputs = learner.model.inputs.iter();
    let parts: Vec<Condition> = inputs
        .zip(terms)
        .filter_map(|(input, term)| {
            let term = input.terms.get(usize::from(*term))?;
            Some(Condition::Is(crate::rule::Proposition {
                variable: Name::from(input.name.as_str()),
                hedges: Vec::new(),
                term: Some(Name::from(term.name.as_str())),
            }))
        })
        .collect();
    match parts.len() {
        0 => None,
        1 => parts.into_iter().next(),
        _ => Some(Condition::And(parts)),
    }
}
