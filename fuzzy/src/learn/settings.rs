//! The settings of a learner, and its errors.

use alloc::{format, string::String, vec::Vec};
use core::ops::RangeInclusive;

/// The weights that rows can have. Errors times weights, and their sums, would overflow or underflow beyond them.
pub const WEIGHTS: RangeInclusive<f64> = 1e-50..=1e50;

/// The message for a weight outside [`WEIGHTS`]. `wanted` is "a number", or what else is accepted.
#[doc(hidden)]
#[must_use]
pub fn bad_weight(weight: f64, wanted: &str) -> String {
    let (least, most) = (WEIGHTS.start(), WEIGHTS.end());
    format!("the weight is {weight:?}, but must be {wanted} from {least:e} to {most:e}")
}

/// How the consequent is chosen where samples of one antecedent disagree.
///
/// # Example: one clear sample against two
/// ```
/// use fuzzy::learn::{Learner, Resolution, Settings};
///
/// let model = fuzzy::yaml::parse("
/// fuzzy: 1
/// name: fan
/// inputs: {heat: {range: [0, 100], partition: [low, high]}}
/// outputs: {speed: {range: [0, 9], partition: [slow, fast]}}
/// rules: []
/// ")?.model;
/// let consequent = |resolution| -> Result<String, Box<dyn std::error::Error>> {
///     let mut settings = Settings::default();
///     settings.resolution = resolution;
///     let mut learner = Learner::new(&model, settings)?;
///     for sample in [[90.0, 9.0], [70.0, 0.0], [80.0, 0.0]] {
///         learner.add(&sample, 1.0)?;
///     }
///     Ok(learner.finish().model.rules[0].rule.consequents[0].term.text.clone())
/// };
/// assert_eq!(consequent(Resolution::Strongest)?, "fast"); // 0.9 over 0.8
/// assert_eq!(consequent(Resolution::Heaviest)?, "slow"); // 0.9 under 0.7 + 0.8
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Resolution {
    /// The consequent of the vote with the highest degree (Wang and Mendel). One outlier can decide. The confidence of a rule
    /// is that degree.
    #[default]
    Strongest,
    /// The consequent with the highest sum of degrees. The confidence is its share of the sum of all degrees.
    Heaviest,
    /// The term with the highest membership of the mean output, or the term with the nearest peak where all memberships are 0.
    /// The mean weights each sample of the antecedent with the product of its input memberships. The confidence is the share
    /// of the votes for that term.
    Mean,
}

/// How the output changes when an input rises.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Direction {
    /// It does not fall.
    Rising,
    /// It does not rise.
    Falling,
}

/// How rules are learned.
///
/// # Example: a rule for an antecedent without samples
/// ```
/// use fuzzy::learn::{Learner, Settings};
///
/// let model = fuzzy::yaml::parse("
/// fuzzy: 1
/// name: fan
/// inputs: {heat: {range: [0, 100], partition: [low, high]}}
/// outputs: {speed: {range: [0, 9], partition: [slow, fast]}}
/// rules: []
/// ")?.model;
/// let mut settings = Settings::default();
/// settings.complete = true;
/// let mut learner = Learner::new(&model, settings)?;
/// learner.add(&[90.0, 9.0], 1.0)?;
/// let learned = learner.finish();
/// assert_eq!((learned.completed, learned.missing), (1, 0));
/// assert!(learned.model.rules[0].note.is_some()); // the note names the completed rule
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug, Clone, PartialEq, Default)]
#[non_exhaustive]
pub struct Settings {
    /// How the consequent is chosen where samples disagree.
    pub resolution: Resolution,
    /// The fewest samples of a rule.
    pub min_support: u64,
    /// The lowest confidence of a rule.
    pub min_degree: f64,
    /// Whether an antecedent without a rule gets that of the nearest one: by the number of steps between terms, and the
    /// highest output of equally near ones. The note of the rule says so.
    pub complete: bool,
    /// Inputs in which the consequents are made monotone, by pooling neighbouring antecedents that contradict it. The rules of
    /// the model itself stay, and inference may bend monotone rules: `check::counterexamples`
    /// tells whether the output is monotone.
    pub monotone: Vec<(String, Direction)>,
}

/// Why a model and settings cannot be learned with.
#[derive(Debug, Clone, PartialEq, Eq)]
#[non_exhaustive]
pub enum LearnError {
    /// The model does not have exactly one output.
    Outputs {
        /// The number of outputs.
        outputs: usize,
    },
    /// The rule set has rule blocks.
    Blocks,
    /// The outputs that the learned one reads cannot be computed.
    Chain {
        /// Why.
        message: String,
    },
    /// A term of the output is a function of inputs, which no value of the output belongs to.
    ReadsInputs {
        /// Its name.
        term: String,
    },
    /// A variable without terms.
    NoTerms {
        /// The variable.
        variable: String,
    },
    /// A setting names something that is not an input.
    NoInput {
        /// The name.
        name: String,
    },
}

impl core::fmt::Display for LearnError {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        match self {
            LearnError::Outputs { outputs } => {
                write!(
                    f,
                    "the rule set has {outputs} outputs that no other output reads; learning needs exactly one"
                )
            }
            LearnError::Chain { message } => {
                write!(
                    f,
                    "the outputs before the last one cannot be computed: {message}"
                )
            }
            LearnError::Blocks => f.write_str("learned rules stand in no rule block"),
            LearnError::ReadsInputs { term } => write!(
                f,
                "the term `{term}` of the output is a function of inputs; rules are learned for fuzzy sets and numbers"
            ),
            LearnError::NoTerms { variable } => write!(f, "`{variable}` has no terms"),
            LearnError::NoInput { name } => write!(f, "`{name}` is not an input to learn over"),
        }
    }
}

impl core::error::Error for LearnError {}

impl LearnError {
    /// What to do about it.
    #[must_use]
    pub fn help(&self) -> &'static str {
        match self {
            LearnError::Outputs { .. } => "learn with one of these outputs and those that it reads",
            LearnError::Chain { .. } => "mend the rules of the outputs that the last one reads",
            LearnError::Blocks => "remove `blocks` and its rules; add blocks again after learning",
            LearnError::ReadsInputs { .. } => {
                "replace it by a number, such as `{constant: 5}`; `tune` fits functions of inputs to rows, for rules that you write"
            }
            LearnError::NoTerms { .. } => "add terms, such as `partition: [low, medium, high]`",
            LearnError::NoInput { .. } => "name inputs of the rule set",
        }
    }
}

/// Why a sample is invalid.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub enum Refusal {
    /// The number of values is not that of the variables.
    WrongNumber {
        /// The number of inputs and the output.
        expected: usize,
        /// The number of values.
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
    /// A value at which every term is 0.
    NoTerm {
        /// The variable.
        variable: String,
        /// The value.
        value: f64,
    },
    /// An output that the learned one reads has no value.
    NoValue {
        /// The output.
        variable: String,
    },
    /// A weight that is not one of [`WEIGHTS`].
    Weight {
        /// The weight.
        weight: f64,
    },
}

impl core::fmt::Display for Refusal {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        match self {
            Refusal::WrongNumber { expected, got } => {
                write!(f, "{got} values for {expected} variables")
            }
            Refusal::NotFinite { variable } => write!(f, "`{variable}` is not a finite number"),
            Refusal::OutOfRange {
                variable,
                value,
                low,
                high,
            } => write!(
                f,
                "`{variable}` is {}, outside its range from {} to {}",
                short(*value),
                short(*low),
                short(*high)
            ),
            Refusal::NoTerm { variable, value } => {
                write!(f, "every term of `{variable}` is 0 at {}", short(*value))
            }
            Refusal::NoValue { variable } => {
                write!(f, "no rule gives `{variable}` a value")
            }
            Refusal::Weight { weight } => f.write_str(&bad_weight(*weight, "a number")),
        }
    }
}

impl core::error::Error for Refusal {}

/// A number without rows of zeros.
fn short(x: f64) -> String {
    match x == 0.0 || (1e-5..1e15).contains(&libm::fabs(x)) {
        true => format!("{x}"),
        false => format!("{x:e}"),
    }
}
