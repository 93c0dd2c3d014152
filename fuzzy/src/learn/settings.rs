//! What is learned and how, and why something is not.

use alloc::{string::String, vec::Vec};

use crate::rule::Condition;

/// What decides between the consequents that samples of one antecedent vote for.
///
/// # Example: one sure sample against two
/// ```
/// # let text = "fuzzy: 1
/// # name: fan
/// # inputs: {heat: {range: [0, 100], partition: [low, high]}}
/// # outputs: {speed: {range: [0, 9], partition: [slow, fast]}}
/// # rules: []";
/// # let model = fuzzy::yaml::parse(text)?.model;
/// use fuzzy::learn::{Learner, Resolution, Settings};
///
/// let concluded = |resolution| -> Result<String, Box<dyn std::error::Error>> {
///     let mut learner = Learner::new(&model, Settings { resolution, ..Settings::default() })?;
///     for sample in [[90.0, 9.0], [70.0, 0.0], [80.0, 0.0]] {
///         learner.add(&sample, 1.0)?;
///     }
///     Ok(learner.finish().model.rules[0].rule.consequents[0].term.text.clone())
/// };
/// assert_eq!(concluded(Resolution::Strongest)?, "fast"); // 0.9 over 0.8
/// assert_eq!(concluded(Resolution::Heaviest)?, "slow"); // 0.9 under 0.7 + 0.8
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Resolution {
    /// The consequent of the one vote with the highest degree wins: Wang and Mendel's, and the FLAGRED paper's.
    /// One odd sample can decide. The confidence of a rule is that degree.
    #[default]
    Strongest,
    /// The consequent with the highest sum of degrees wins. The confidence is its share of the sum of all degrees.
    Heaviest,
    /// The mean of the output over the samples of the antecedent, each weighted with the product of its input
    /// memberships, decides: the term it belongs to most. Where no term holds it, the term whose peak is nearest. The
    /// confidence is the share of that weight whose own values say the same term.
    Mean,
}

/// Which way the output must go when an input rises.
///
/// # Example: a fan that never slows down in the heat
/// ```
/// # let text = "fuzzy: 1
/// # name: fan
/// # inputs: {heat: {range: [0, 100], partition: [low, high]}}
/// # outputs: {speed: {range: [0, 9], partition: [slow, fast]}}
/// # rules: []";
/// # let model = fuzzy::yaml::parse(text)?.model;
/// use fuzzy::learn::{Direction, Learner, Settings};
///
/// let monotone = vec![("heat".to_string(), Direction::Rising)];
/// let mut learner = Learner::new(&model, Settings { monotone, ..Settings::default() })?;
/// for sample in [[10.0, 9.0], [90.0, 0.0], [90.0, 0.0]] {
///     learner.add(&sample, 1.0)?;
/// }
/// let rules = learner.finish().model.rules;
/// assert_eq!(rules[0].rule.consequents, rules[1].rule.consequents); // averaged until they agree
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Direction {
    /// It never falls.
    Rising,
    /// It never rises.
    Falling,
}

/// What is learned, and how.
///
/// # Example: rules for what no sample says, too
/// ```
/// # let text = "fuzzy: 1
/// # name: fan
/// # inputs: {heat: {range: [0, 100], partition: [low, high]}}
/// # outputs: {speed: {range: [0, 9], partition: [slow, fast]}}
/// # rules: []";
/// # let model = fuzzy::yaml::parse(text)?.model;
/// use fuzzy::learn::{Learner, Settings};
///
/// let mut learner = Learner::new(&model, Settings { complete: true, ..Settings::default() })?;
/// learner.add(&[90.0, 9.0], 1.0)?;
/// let learned = learner.finish();
/// assert_eq!((learned.completed, learned.missing), (1, 0));
/// assert!(learned.model.rules.iter().any(|rule| rule.note.is_some()), "a completed rule says so");
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Settings {
    /// What decides where samples disagree.
    pub resolution: Resolution,
    /// An antecedent with fewer samples makes no rule; 0 and 1 take every one.
    pub min_support: u64,
    /// A rule with a lower confidence is left out.
    pub min_degree: f64,
    /// Complete the rules: an antecedent without one takes what the nearest one says (steps between terms counted,
    /// the highest of equally near ones), and says so in its note.
    pub complete: bool,
    /// Inputs on which the output must be monotone. Neighbouring antecedents that contradict it are averaged until
    /// none does.
    pub monotone: Vec<(String, Direction)>,
    /// A condition that every learned rule is joined to by AND; its inputs are not learned over, and a sample counts
    /// as much as it fulfils it.
    pub given: Option<Condition>,
}

/// Why nothing can be learned with a model and settings.
///
/// # Example
/// ```
/// use fuzzy::{Model, learn::{LearnError, Learner, Settings}};
///
/// let nothing = Learner::new(&Model::builder("empty").build(), Settings::default()).unwrap_err();
/// assert_eq!(nothing, LearnError::Outputs { outputs: 0 });
/// ```
#[derive(Debug, Clone, PartialEq, Eq)]
#[non_exhaustive]
pub enum LearnError {
    /// The model has not exactly one output.
    Outputs {
        /// How many it has.
        outputs: usize,
    },
    /// A variable without terms.
    NoTerms {
        /// The variable.
        variable: String,
    },
    /// A setting names what is no input of the model, or not one that is learned over.
    NoInput {
        /// The name.
        name: String,
    },
    /// The given condition names a term that its input does not have.
    NoTerm {
        /// The input.
        variable: String,
        /// The term.
        term: String,
    },
    /// The given condition is more than propositions joined by AND.
    Given,
}

impl core::fmt::Display for LearnError {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        match self {
            LearnError::Outputs { outputs } => {
                write!(
                    f,
                    "rules are learned for one output, but the model has {outputs}"
                )
            }
            LearnError::NoTerms { variable } => write!(f, "`{variable}` has no terms"),
            LearnError::NoInput { name } => {
                write!(f, "`{name}` is no input that rules are learned over")
            }
            LearnError::NoTerm { variable, term } => {
                write!(f, "`{variable}` has no term `{term}`")
            }
            LearnError::Given => {
                f.write_str("the given condition is not made of `input IS term` joined by AND")
            }
        }
    }
}

impl core::error::Error for LearnError {}

/// Why a sample was not learned from.
///
/// # Example: a speed that the fan does not have
/// ```
/// # let text = "fuzzy: 1
/// # name: fan
/// # inputs: {heat: {range: [0, 100], partition: [low, high]}}
/// # outputs: {speed: {range: [0, 9], partition: [slow, fast]}}
/// # rules: []";
/// # let model = fuzzy::yaml::parse(text)?.model;
/// use fuzzy::learn::{Learner, Refusal, Settings};
///
/// let mut learner = Learner::new(&model, Settings::default())?;
/// let refused = learner.add(&[90.0, 12.0], 1.0).unwrap_err();
/// assert!(matches!(&refused, Refusal::OutOfRange { variable, .. } if variable == "speed"));
/// assert_eq!(refused.to_string(), "`speed` is 12, outside its range from 0 to 9");
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub enum Refusal {
    /// Not one value for each variable.
    WrongNumber {
        /// Inputs and output.
        expected: usize,
        /// The values given.
        got: usize,
    },
    /// A value that is NaN or infinite.
    NotFinite {
        /// The variable.
        variable: String,
    },
    /// A value outside the range of its variable.
    OutOfRange {
        /// The variable.
        variable: String,
        /// The value.
        value: f64,
        /// The lower end of the range.
        low: f64,
        /// The upper end of the range.
        high: f64,
    },
    /// A value that belongs to no term.
    NoTerm {
        /// The variable.
        variable: String,
        /// The value.
        value: f64,
    },
    /// A weight that is not a finite number above 0.
    Weight {
        /// The weight.
        weight: f64,
    },
}

impl core::fmt::Display for Refusal {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        match self {
            Refusal::WrongNumber { expected, got } => {
                write!(f, "there are {got} values for {expected} variables")
            }
            Refusal::NotFinite { variable } => write!(f, "`{variable}` is not a finite number"),
            Refusal::OutOfRange {
                variable,
                value,
                low,
                high,
            } => write!(
                f,
                "`{variable}` is {value}, outside its range from {low} to {high}"
            ),
            Refusal::NoTerm { variable, value } => {
                write!(
                    f,
                    "`{variable}` is {value}, which belongs to none of its terms"
                )
            }
            Refusal::Weight { weight } => {
                write!(f, "the weight {weight} is not a finite number above 0")
            }
        }
    }
}

impl core::error::Error for Refusal {}
