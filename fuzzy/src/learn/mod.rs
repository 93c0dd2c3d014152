//! Rules from data, after Wang and Mendel (1992): every sample votes for the rule it lies nearest to.
//!
//! 1. Each value of a sample is given to the term with its highest membership (the first of equal ones). The terms of
//!    the inputs are the antecedent, the term of the output the consequent, and the degree of the vote is the product
//!    of all memberships, times the sample's weight.
//! 2. Where the samples of an antecedent disagree, [`Resolution`] decides.
//! 3. What was beaten, how many samples stand behind a rule and how sure they are is kept with the rule.
//!
//! Sums are made in fixed point, so the order of the samples changes nothing, not a bit.

use alloc::{boxed::Box, collections::BTreeMap, string::ToString, vec, vec::Vec};

use crate::{
    model::{MembershipFunction, Model, Variable},
    rule::{Condition, Name},
};

mod resolve;
mod settings;
#[cfg(test)]
mod tests;

pub use settings::{Direction, LearnError, Refusal, Resolution, Settings};

/// Collects samples, and makes rules of them.
///
/// # Example: one row of the FLAGRED paper's Table I, and the rule it makes
///
/// ```
/// use fuzzy::learn::{Learner, Settings};
///
/// let model = fuzzy::yaml::parse("
/// fuzzy: 1
/// name: flight
/// inputs:
///   margin: {range: [0, 0.5], partition: {very_low: 0, low: 0.1, medium: 0.2, high: 0.3}}
///   spread: {range: [0, 0.5], partition: {low: 0, medium: 0.1, high: 0.2}}
/// outputs:
///   risk: {range: [0, 100], partition: [very_low, low, medium, high, very_high]}
/// rules: []
/// ")?.model;
/// let mut learner = Learner::new(&model, Settings::default())?;
/// learner.add(&[0.007969, 0.226310, 65.679063], 1.0)?;
/// let learned = learner.finish();
///
/// let rule = &learned.model.rules[0];
/// assert_eq!(rule.rule.to_string(), "IF margin IS very_low AND spread IS high THEN risk IS high");
/// assert!((rule.confidence.unwrap_or(0.0) - 0.577186).abs() < 1e-5);
/// assert_eq!(learned.missing, 11);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug, Clone)]
pub struct Learner {
    model: Model,
    settings: Settings,
    /// The inputs that rules are learned over, as indices of the model's.
    learned: Vec<usize>,
    /// The given condition: inputs and terms.
    given: Vec<(usize, usize)>,
    /// Where the terms of the output stand.
    peaks: Vec<f64>,
    samples: u64,
    cells: BTreeMap<Box<[u16]>, Cell>,
}

/// The rules that were learned, and what was learned about the data.
///
/// # Example: two samples that disagree
/// ```
/// # let text = "fuzzy: 1
/// # name: fan
/// # inputs: {heat: {range: [0, 100], partition: [low, high]}}
/// # outputs: {speed: {range: [0, 9], partition: [slow, fast]}}
/// # rules: []";
/// # let model = fuzzy::yaml::parse(text)?.model;
/// use fuzzy::learn::{Learned, Learner, Settings};
///
/// let mut learner = Learner::new(&model, Settings::default())?;
/// learner.add(&[90.0, 9.0], 1.0)?;
/// learner.add(&[80.0, 0.0], 1.0)?;
/// let Learned { conflicts, missing, missing_antecedents, model, .. } = learner.finish();
/// assert_eq!((conflicts, missing), (1, 1));
/// assert_eq!(missing_antecedents[0].to_string(), "heat IS low");
/// assert_eq!(model.rules[0].against[0].term, "slow"); // 0.8 against 0.9
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct Learned {
    /// The model with the rules: those it came with, then the learned ones in the order of their antecedents.
    pub model: Model,
    /// The samples learned from.
    pub samples: u64,
    /// The antecedents whose samples voted for more than one consequent.
    pub conflicts: u64,
    /// The antecedents without a rule.
    pub missing: u64,
    /// The first [`Learned::SHOWN`] of them.
    pub missing_antecedents: Vec<Condition>,
    /// The antecedents that had samples, but too few or too unsure ones for a rule.
    pub left_out: u64,
    /// The rules that were completed from their neighbours.
    pub completed: u64,
}

impl Learned {
    /// How many antecedents without a rule are kept.
    pub const SHOWN: usize = 100;
}

/// What the samples of one antecedent say.
#[derive(Debug, Clone, Default)]
struct Cell {
    samples: u64,
    /// For each term of the output that samples voted for.
    votes: BTreeMap<u16, Votes>,
    /// Sum of the degrees of the antecedent.
    degrees: Fixed,
    /// Sum of these degrees times the share of the output's range below the value.
    values: Fixed,
}

#[derive(Debug, Clone, Copy, Default)]
struct Votes {
    samples: u64,
    strongest: f64,
    degrees: Fixed,
}

/// A sum of numbers from 0 to 2^40 in steps of 2^-64: the same in whatever order they come.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, PartialOrd, Ord)]
struct Fixed(u128);

impl Fixed {
    const ONE: f64 = 18_446_744_073_709_551_616.0;

    fn add(&mut self, x: f64) {
        self.0 = self.0.saturating_add((x * Fixed::ONE) as u128);
    }

    fn value(self) -> f64 {
        self.0 as f64 / Fixed::ONE
    }
}

impl Learner {
    /// A learner for the variables of a model with one output.
    ///
    /// # Errors
    ///
    /// Not one output, a variable without terms, or settings that name what the model does not have.
    ///
    /// # Example
    /// ```
    /// # let text = "fuzzy: 1
    /// # name: fan
    /// # inputs: {heat: {range: [0, 100], partition: [low, high]}}
    /// # outputs: {speed: {range: [0, 9], partition: [slow, fast]}}
    /// # rules: []";
    /// # let model = fuzzy::yaml::parse(text)?.model;
    /// use fuzzy::learn::{Learner, Settings};
    ///
    /// let learner = Learner::new(&model, Settings::default())?;
    /// assert_eq!(learner.samples(), 0);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn new(model: &Model, settings: Settings) -> Result<Learner, LearnError> {
        let [output] = model.outputs.as_slice() else {
            return Err(LearnError::Outputs {
                outputs: model.outputs.len(),
            });
        };
        let mut variables = model.inputs.iter().chain([&output.variable]);
        if let Some(bare) = variables.find(|v| v.terms.is_empty()) {
            return Err(LearnError::NoTerms {
                variable: bare.name.clone(),
            });
        }
        let given = match &settings.given {
            Some(condition) => given(model, condition)?,
            None => Vec::new(),
        };
        let learned: Vec<usize> = (0..model.inputs.len())
            .filter(|input| given.iter().all(|(known, _)| known != input))
            .collect();
        for (name, _) in &settings.monotone {
            let found = learned.iter().filter_map(|input| model.inputs.get(*input));
            if !found.into_iter().any(|input| input.name == *name) {
                return Err(LearnError::NoInput { name: name.clone() });
            }
        }
        Ok(Learner {
            model: model.clone(),
            settings,
            learned,
            given,
            peaks: output
                .variable
                .terms
                .iter()
                .map(|term| peak(&output.variable, &term.shape))
                .collect(),
            samples: 0,
            cells: BTreeMap::new(),
        })
    }

    /// Adds a sample: a value for each input of the model, then the output; and its weight.
    ///
    /// # Errors
    ///
    /// Why it was refused; the learner goes on without it.
    ///
    /// # Example
    /// ```
    /// # let text = "fuzzy: 1
    /// # name: fan
    /// # inputs: {heat: {range: [0, 100], partition: [low, high]}}
    /// # outputs: {speed: {range: [0, 9], partition: [slow, fast]}}
    /// # rules: []";
    /// # let model = fuzzy::yaml::parse(text)?.model;
    /// use fuzzy::learn::{Learner, Settings};
    ///
    /// let mut learner = Learner::new(&model, Settings::default())?;
    /// learner.add(&[95.0, 8.5], 1.0)?;
    /// let refusal = learner.add(&[95.0, 12.0], 1.0).unwrap_err();
    /// assert_eq!(refusal.to_string(), "`speed` is 12, outside its range from 0 to 9");
    /// assert_eq!(learner.samples(), 1);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn add(&mut self, values: &[f64], weight: f64) -> Result<(), Refusal> {
        let Some((output, inputs)) = values
            .split_last()
            .filter(|(_, inputs)| inputs.len() == self.model.inputs.len())
        else {
            return Err(Refusal::WrongNumber {
                expected: self.model.inputs.len() + 1,
                got: values.len(),
            });
        };
        if !(weight.is_finite() && weight > 0.0) {
            return Err(Refusal::Weight { weight });
        }
        let Some(consequent) = self.model.outputs.first().map(|o| &o.variable) else {
            return Ok(());
        };
        for (variable, value) in self.model.inputs.iter().chain([consequent]).zip(values) {
            check(variable, *value)?;
        }
        let mut degree = weight;
        let mut antecedent = vec![0; self.learned.len()];
        for (place, input) in antecedent.iter_mut().zip(&self.learned) {
            let (Some(variable), Some(value)) = (self.model.inputs.get(*input), inputs.get(*input))
            else {
                continue;
            };
            let (term, membership) = highest(variable, *value).ok_or_else(|| Refusal::NoTerm {
                variable: variable.name.clone(),
                value: *value,
            })?;
            *place = term;
            degree *= membership;
        }
        for (input, term) in &self.given {
            let term = self
                .model
                .inputs
                .get(*input)
                .and_then(|i| i.terms.get(*term));
            if let (Some(term), Some(value)) = (term, inputs.get(*input)) {
                degree *= term.height * term.shape.membership(*value);
            }
        }
        let vote = match (highest(consequent, *output), self.settings.resolution) {
            (Some(vote), Resolution::Mean) => (vote.0, 1.0),
            (Some(vote), _) => vote,
            // Between terms that leave gaps a value still lies nearest to one of them.
            (None, Resolution::Mean) => (resolve::nearest_peak(&self.peaks, *output), 1.0),
            (None, _) => {
                return Err(Refusal::NoTerm {
                    variable: consequent.name.clone(),
                    value: *output,
                });
            }
        };
        self.samples += 1;
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

    /// The number of samples learned from so far.
    ///
    /// # Example
    /// ```
    /// # let text = "fuzzy: 1
    /// # name: fan
    /// # inputs: {heat: {range: [0, 100], partition: [low, high]}}
    /// # outputs: {speed: {range: [0, 9], partition: [slow, fast]}}
    /// # rules: []";
    /// # let model = fuzzy::yaml::parse(text)?.model;
    /// use fuzzy::learn::{Learner, Settings};
    ///
    /// let mut learner = Learner::new(&model, Settings::default())?;
    /// learner.add(&[95.0, 8.5], 1.0)?;
    /// assert_eq!(learner.samples(), 1);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn samples(&self) -> u64 {
        self.samples
    }

    /// Makes the rules.
    ///
    /// # Example: two samples that contradict each other
    /// ```
    /// # let text = "fuzzy: 1
    /// # name: fan
    /// # inputs: {heat: {range: [0, 100], partition: [low, high]}}
    /// # outputs: {speed: {range: [0, 9], partition: [slow, fast]}}
    /// # rules: []";
    /// # let model = fuzzy::yaml::parse(text)?.model;
    /// use fuzzy::learn::{Learner, Settings};
    ///
    /// let mut learner = Learner::new(&model, Settings::default())?;
    /// for (heat, speed) in [(5.0, 1.0), (95.0, 8.5), (90.0, 2.0)] {
    ///     learner.add(&[heat, speed], 1.0)?;
    /// }
    /// let learned = learner.finish();
    /// assert_eq!((learned.model.rules.len(), learned.conflicts, learned.missing), (2, 1, 0));
    /// assert_eq!(learned.model.rules[1].rule.to_string(), "IF heat IS high THEN speed IS fast");
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn finish(&self) -> Learned {
        resolve::resolve(self)
    }
}

/// The inputs and terms of `a IS x AND b IS y`.
fn given(model: &Model, condition: &Condition) -> Result<Vec<(usize, usize)>, LearnError> {
    match condition {
        Condition::And(all) => {
            let parts = all.iter().map(|part| given(model, part));
            Ok(parts.collect::<Result<Vec<_>, _>>()?.concat())
        }
        Condition::Is(proposition) if proposition.hedges.is_empty() => {
            let name = &proposition.variable.text;
            let input = model.inputs.iter().position(|input| input.name == *name);
            let input = input.ok_or_else(|| LearnError::NoInput { name: name.clone() })?;
            let word = proposition.term.as_ref().map_or("", |term| &term.text);
            let terms = model.inputs.get(input).map(|i| i.terms.as_slice());
            let term = terms
                .unwrap_or_default()
                .iter()
                .position(|term| term.name == word);
            let term = term.ok_or_else(|| LearnError::NoTerm {
                variable: name.clone(),
                term: word.to_string(),
            })?;
            Ok(vec![(input, term)])
        }
        _ => Err(LearnError::Given),
    }
}

fn check(variable: &Variable, value: f64) -> Result<(), Refusal> {
    if !value.is_finite() {
        return Err(Refusal::NotFinite {
            variable: variable.name.clone(),
        });
    }
    if value < variable.low || value > variable.high {
        return Err(Refusal::OutOfRange {
            variable: variable.name.clone(),
            value,
            low: variable.low,
            high: variable.high,
        });
    }
    Ok(())
}

/// The term a value belongs to most, and its membership; the first of equal ones, `None` where it belongs to none.
fn highest(variable: &Variable, value: f64) -> Option<(u16, f64)> {
    let mut best: Option<(u16, f64)> = None;
    for (i, term) in (0..=u16::MAX).zip(&variable.terms) {
        let membership = term.height * term.shape.membership(value);
        if membership > best.map_or(0.0, |(_, highest)| highest) {
            best = Some((i, membership));
        }
    }
    best
}

/// Where a term stands on its variable: the middle of the part in which it is highest.
fn peak(variable: &Variable, shape: &MembershipFunction) -> f64 {
    // Shapes are many and few have a closed form; terms are told apart by far more than a thousandth of the range.
    const STEPS: u32 = 2000;
    let at =
        |i: u32| variable.low + (variable.high - variable.low) * f64::from(i) / f64::from(STEPS);
    let mut highest = f64::NEG_INFINITY;
    let (mut first, mut last) = (variable.low, variable.low);
    for x in (0..=STEPS).map(at) {
        let membership = shape.membership(x);
        if membership > highest + 1e-12 {
            (highest, first, last) = (membership, x, x);
        } else if membership >= highest - 1e-12 {
            last = x;
        }
    }
    (first + last) / 2.0
}

/// `a IS x AND b IS y` for terms of the learned inputs.
fn antecedent(learner: &Learner, terms: &[u16]) -> Option<Condition> {
    let model = &learner.model;
    let learned = learner
        .learned
        .iter()
        .zip(terms.iter().map(|t| usize::from(*t)));
    let given = learner.given.iter().map(|(input, term)| (input, *term));
    // In the order of the model's inputs, whatever was given.
    let mut all: Vec<(usize, usize)> = learned.chain(given).map(|(i, t)| (*i, t)).collect();
    all.sort_unstable();
    let parts: Vec<Condition> = all
        .into_iter()
        .filter_map(|(input, term)| {
            let input = model.inputs.get(input)?;
            let term = input.terms.get(term)?;
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
