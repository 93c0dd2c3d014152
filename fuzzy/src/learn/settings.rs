//! The settings and errors of a learner.

use alloc::{format, string::String, vec::Vec};
use core::ops::RangeInclusive;

/// The valid weights of rows. With other weights, weighted errors and their sums would overflow or underflow.
pub const WEIGHTS: RangeInclusive<f64> = 1e-50..=1e50;

/// Returns the message for a weight outside [`WEIGHTS`]. `wanted` describes the accepted values, such as "a number".
#[doc(hidden)]
#[must_use]
pub fn bad_weight(weight: f64, wanted: &str) -> String {
    let (least, most) = (WEIGHTS.start(), WEIGHTS.end());
    format!("the weight is {weight:?}, but must be {wanted} from {least:e} to {most:e}")
}

/// The method that selects the consequent if the samples of an antecedent disagree.
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
    /// The consequent of the vote with the highest degree (Wang and Mendel). A single outlier can decide. The
    /// confidence of the rule is that degree.
    #[default]
    Strongest,
    /// The consequent with the highest sum of degrees. The confidence is its fraction of the sum of all degrees.
    Heaviest,
    /// The term with the highest membership of the mean output, or the term with the nearest peak if all memberships
    /// are 0. The mean weights each sample of the antecedent by the product of its input memberships. The confidence is
    /// the fraction of the votes for that term.
    Mean,
}

/// The required direction of the output as an input increases.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Direction {
    /// The output must not decrease as the input increases.
    Rising,
    /// The output must not increase as the input increases.
    Falling,
}

/// The settings of a learner.
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
/// assert!(learned.model.rules[0].note.is_some()); // the note states that the rule was completed
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug, Clone, PartialEq, Default)]
#[non_exhaustive]
pub struct Settings {
    /// The method that selects the consequent if samples disagree.
    pub resolution: Resolution,
    /// The minimum number of samples of a rule.
    pub min_support: u64,
    /// The minimum confidence of a rule.
    pub min_degree: f64,
    /// Whether an antecedent without a rule gets the consequent of the nearest antecedent. The distance is the number
    /// of steps between terms; among equally near antecedents the one with the highest output is used. The note of
    /// the rule states that it was completed in this way. Requires at most 1,000,000 antecedents, as `monotone` does.
    pub complete: bool,
    /// The inputs along which the consequents are made monotone, each with the required direction. Neighbouring
    /// antecedents that violate the direction are pooled. Rules that the model already contains are not changed. The
    /// output may still not be monotone even if all rules are; `check::counterexamples` verifies the output.
    pub monotone: Vec<(String, Direction)>,
}

/// The error for a model and settings that cannot be used for learning.
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
    /// The rule set has interval type-2 terms.
    Type2,
    /// The outputs that the learned output reads cannot be computed.
    Chain {
        /// The message of the cause.
        message: String,
    },
    /// A term of the output is a function of inputs. Values of the output cannot be assigned to such a term.
    ReadsInputs {
        /// The name of the term.
        term: String,
    },
    /// A variable has no terms.
    NoTerms {
        /// The name of the variable.
        variable: String,
    },
    /// A setting names a variable that is not an input.
    NoInput {
        /// The unknown name.
        name: String,
    },
    /// There are too many antecedents to complete them or to make their consequents monotone.
    TooManyAntecedents {
        /// The number of antecedents: combinations of a term of each input.
        antecedents: u64,
        /// The maximum number of antecedents.
        max: u64,
    },
}

impl core::fmt::Display for LearnError {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        match self {
            LearnError::Outputs { outputs } => {
                write!(
                    f,
                    "the rules of {outputs} outputs cannot be learned together; learning needs exactly one output"
                )
            }
            LearnError::Chain { message } => {
                write!(
                    f,
                    "the outputs before the last one cannot be computed: {message}"
                )
            }
            LearnError::Type2 => {
                f.write_str("the rule set has type-2 terms, for which rules cannot be learned")
            }
            LearnError::Blocks => {
                f.write_str("the rule set has rule blocks, with which rules cannot be learned")
            }
            LearnError::ReadsInputs { term } => write!(
                f,
                "the term `{term}` of the output is a function of inputs; rules are learned for fuzzy sets and numbers"
            ),
            LearnError::NoTerms { variable } => write!(f, "`{variable}` has no terms"),
            LearnError::NoInput { name } => write!(f, "`{name}` is not an input to learn over"),
            LearnError::TooManyAntecedents { antecedents, max } => write!(
                f,
                "the inputs have {antecedents} combinations of terms, but rules can be completed or made monotone only for up to {max}"
            ),
        }
    }
}

impl core::error::Error for LearnError {}

impl LearnError {
    /// Returns a suggestion for how to fix the error.
    #[must_use]
    pub fn help(&self) -> &'static str {
        match self {
            LearnError::Outputs { .. } => {
                "keep one of these outputs, and the outputs that it reads"
            }
            LearnError::Chain { .. } => {
                "correct the rules of the outputs that the last output reads"
            }
            LearnError::Type2 => {
                "remove the keys that make terms type-2, such as `blur` or `lower`, for learning, and add them again afterwards"
            }
            LearnError::Blocks => "remove `blocks`, and add blocks again after learning",
            LearnError::ReadsInputs { .. } => {
                "replace it by a number, such as `{constant: 5}`; `tune` fits functions of inputs to rows, for rules that you write"
            }
            LearnError::NoTerms { .. } => "add terms, such as `partition: [low, medium, high]`",
            LearnError::NoInput { .. } => "name inputs of the rule set",
            LearnError::TooManyAntecedents { .. } => {
                "learn over fewer inputs or terms, or neither complete the rules nor make them monotone"
            }
        }
    }
}

/// The error for an invalid sample.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub enum SampleError {
    /// The number of values differs from the number of variables.
    WrongNumber {
        /// The number of inputs plus one for the output.
        expected: usize,
        /// The number of values.
        got: usize,
    },
    /// A value is NaN or infinite.
    NotFinite {
        /// The name of the variable.
        variable: String,
    },
    /// A value is outside the range of its variable.
    OutOfRange {
        /// The name of the variable.
        variable: String,
        /// The value.
        value: f64,
        /// The lower end of the range.
        low: f64,
        /// The upper end of the range.
        high: f64,
    },
    /// All terms of the variable are 0 at the value.
    NoTerm {
        /// The name of the variable.
        variable: String,
        /// The value.
        value: f64,
    },
    /// An output that the learned output reads has no value.
    NoValue {
        /// The name of the output.
        variable: String,
    },
    /// The weight is outside [`WEIGHTS`].
    Weight {
        /// The weight.
        weight: f64,
    },
}

impl core::fmt::Display for SampleError {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        match self {
            SampleError::WrongNumber { expected, got } => {
                write!(f, "{got} values for {expected} variables")
            }
            SampleError::NotFinite { variable } => write!(f, "`{variable}` is not a finite number"),
            SampleError::OutOfRange {
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
            SampleError::NoTerm { variable, value } => {
                write!(f, "every term of `{variable}` is 0 at {}", short(*value))
            }
            SampleError::NoValue { variable } => {
                write!(f, "no rule gives `{variable}` a value")
            }
            SampleError::Weight { weight } => f.write_str(&bad_weight(*weight, "a number")),
        }
    }
}

impl core::error::Error for SampleError {}

/// Formats a number; very small and very large ones in scientific notation.
fn short(x: f64) -> String {
    match x == 0.0 || (1e-5..1e15).contains(&libm::fabs(x)) {
        true => format!("{x}"),
        false => format!("{x:e}"),
    }
}
