//! What an author wrote: variables, terms, operators and rules, as plain data.

use alloc::{string::String, vec::Vec};

use crate::rule;

mod allowed;
mod blocks;
mod builder;
pub(crate) mod chain;
pub(crate) mod document;
mod partition;
#[cfg(any(feature = "check", feature = "learn"))]
mod plateau;
mod provenance;
mod steps;
pub use crate::formula::Formula;
pub(crate) use crate::shape::{Form, Parts};
pub use crate::shape::{MembershipError, MembershipFunction, Role};
pub use crate::table::{
    Activation, Aggregation, Comparison, Conjunction, Disjunction, Implication, LEAST_STRENGTH,
};
pub use allowed::Allowed;
pub use blocks::Block;
pub(crate) use blocks::concludes;
pub use builder::ModelBuilder;
pub(crate) use partition::{between_peaks, even_peaks};
pub use provenance::{DataFile, LossChange, Step};
pub(crate) use steps::between_limits;

/// A rule set: inputs, outputs, operators and rules.
///
/// # Example: plain data, from a text and back
/// ```
/// let text = "fuzzy: 1
/// name: fan
/// inputs: {heat: {range: [0, 100], partition: [low, high]}}
/// outputs: {speed: {range: [0, 9], partition: [slow, fast]}}
/// rules: [IF heat IS high THEN speed IS fast]";
/// let mut model = fuzzy::yaml::parse(text)?.model;
/// model.rules[0].rule.weight = 0.5;
/// assert!(fuzzy::yaml::to_string(&model).contains("IF heat IS high THEN speed IS fast WITH 0.5"));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct Model {
    /// The name of the rule set.
    pub name: String,
    /// Its purpose, in the author's words.
    pub description: Option<String>,
    /// The inputs, in the order in which the engine takes their values.
    pub inputs: Vec<Variable>,
    /// The outputs, in the order in which the engine gives their values.
    pub outputs: Vec<Output>,
    /// The operators of all rules; of rules in blocks only the aggregation.
    pub operators: Operators,
    /// Which rules fire, where there are no blocks.
    pub activation: Activation,
    /// A firing strength below it counts as 0: such a rule does not fire. From [`LEAST_STRENGTH`], its default, up to 1.
    pub least_strength: f64,
    /// The rule blocks; empty where all rules share `operators` and `activation`.
    pub blocks: Vec<Block>,
    /// The rules; with blocks, in the order of the blocks.
    pub rules: Vec<Rule>,
    /// The findings of the analysis that the author accepts.
    pub allow: Vec<Allowed>,
    /// The commands that made it, the last one last.
    pub provenance: Vec<Step>,
}

/// A linguistic variable: a range of numbers and the terms that name its parts.
///
/// # Example: terms side by side
/// ```
/// use fuzzy::model::{MembershipFunction, Variable};
///
/// let heat = Variable::new("heat", 0.0, 100.0)
///     .unit("°C")
///     .term("low", MembershipFunction::LeftShoulder { top: 20.0, foot: 30.0 })
///     .term("high", MembershipFunction::RightShoulder { foot: 20.0, top: 30.0 });
/// let at_22: Vec<f64> = heat.terms.iter().map(|term| term.membership(22.0)).collect();
/// assert_eq!(at_22, [0.8, 0.2]);
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct Variable {
    /// Its name in rules.
    pub name: String,
    /// What it means, in the author's words.
    pub description: Option<String>,
    /// The unit of its values, for people: `"%"`, `"m/s"`.
    pub unit: Option<String>,
    /// The lower end of its range.
    pub low: f64,
    /// The upper end of its range.
    pub high: f64,
    /// Its terms.
    pub terms: Vec<Term>,
}

/// A term: the name of a fuzzy set over a variable's range.
#[derive(Debug, Clone, PartialEq)]
pub struct Term {
    /// Its name in rules.
    pub name: String,
    /// The membership function.
    pub membership_function: MembershipFunction,
    /// The height of the membership function, in (0, 1]; 1 where the author wrote none.
    pub height: f64,
}

/// An output variable, and how its fuzzy result becomes a number.
#[derive(Debug, Clone, PartialEq)]
pub struct Output {
    /// Name, range and terms.
    pub variable: Variable,
    /// How the aggregated set becomes a number.
    pub defuzzifier: Defuzzifier,
    /// Integrate by sampling, to reproduce other programs; `None` is exact.
    pub samples: Option<Sampling>,
    /// What the output is where no rule fires.
    pub when_no_rule_fires: NoRuleFires,
    /// How the consequents of this output are combined; `None` as the rule set says.
    pub aggregation: Option<Aggregation>,
    /// Whether a value outside the range is clamped to it. Only Takagi-Sugeno outputs can have one.
    pub clamp: bool,
}

/// What an output is where no rule fires.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum NoRuleFires {
    /// The output is undefined there, and says so.
    Undefined,
    /// Evaluation is an error there.
    Error,
    /// A value the author chose.
    Value(f64),
    /// The value of the evaluation before, in a `Sequence`. Before there is one, and for a single
    /// evaluation: the value given here, or undefined.
    Previous(Option<f64>),
}

/// How an aggregated fuzzy set becomes a number.
///
/// Of maxima, degrees that differ by at most 1e-12, relatively, are equally high: two plateaus or peaks of almost one degree both
/// count, a stretch between two kinks is a plateau if its degrees are so close to the highest, and a firing strength so close to
/// the highest degree of a term does not cut it off. The mean is that of all values on plateaus, or of the peaks where there is
/// no plateau.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Defuzzifier {
    /// The centre of gravity of the aggregated set.
    Centroid,
    /// The value that halves the area of the aggregated set.
    Bisector,
    /// The smallest value at which the aggregated set is highest.
    SmallestOfMaxima,
    /// The mean of all values at which the aggregated set is highest.
    MeanOfMaxima,
    /// The largest value at which the aggregated set is highest.
    LargestOfMaxima,
    /// Takagi-Sugeno: `sum(w z) / sum(w)` over the rules.
    WeightedAverage,
    /// Takagi-Sugeno: `sum(w z)` over the rules.
    WeightedSum,
    /// Tsukamoto: `sum(w z) / sum(w)` over the rules, with `z` the place where the monotone term of the rule has the degree `w`.
    Tsukamoto,
}

impl Defuzzifier {
    /// All defuzzifiers.
    pub const ALL: [Defuzzifier; 8] = [
        Defuzzifier::Centroid,
        Defuzzifier::Bisector,
        Defuzzifier::SmallestOfMaxima,
        Defuzzifier::MeanOfMaxima,
        Defuzzifier::LargestOfMaxima,
        Defuzzifier::WeightedAverage,
        Defuzzifier::WeightedSum,
        Defuzzifier::Tsukamoto,
    ];

    /// Whether its terms are numbers and functions, as Takagi-Sugeno consequents are, rather than fuzzy sets.
    pub(crate) fn takes_numbers(self) -> bool {
        match self {
            Defuzzifier::WeightedAverage | Defuzzifier::WeightedSum => true,
            Defuzzifier::Centroid
            | Defuzzifier::Bisector
            | Defuzzifier::SmallestOfMaxima
            | Defuzzifier::MeanOfMaxima
            | Defuzzifier::LargestOfMaxima
            | Defuzzifier::Tsukamoto => false,
        }
    }

    /// Whether it weights numbers, one for each rule: Takagi-Sugeno or Tsukamoto.
    pub(crate) fn is_weighted(self) -> bool {
        match self {
            Defuzzifier::WeightedAverage | Defuzzifier::WeightedSum | Defuzzifier::Tsukamoto => {
                true
            }
            Defuzzifier::Centroid
            | Defuzzifier::Bisector
            | Defuzzifier::SmallestOfMaxima
            | Defuzzifier::MeanOfMaxima
            | Defuzzifier::LargestOfMaxima => false,
        }
    }
}

/// Sampled integration, for parity with other programs only.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Sampling {
    /// The number of samples over the output's range.
    pub samples: usize,
    /// Where they lie.
    pub rule: SamplingRule,
}

/// Where the samples of a sampled integration lie.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum SamplingRule {
    /// `low + (i + 0.5) (high - low) / N`, i = 0..N.
    Midpoint,
    /// `low + i (high - low) / (N - 1)`, i = 0..N, equal weights at inner points, half at the ends.
    Trapezoid,
}

/// The operators that the rules of a model or of a block share.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Operators {
    /// AND.
    pub and: Conjunction,
    /// OR.
    pub or: Disjunction,
    /// How a firing strength cuts or scales a consequent.
    pub implication: Implication,
    /// How the consequents of one output are combined.
    pub aggregation: Aggregation,
}

/// A rule with its provenance.
#[derive(Debug, Clone, PartialEq)]
pub struct Rule {
    /// The rule itself, with its weight.
    pub rule: rule::Rule,
    /// The index of its block; 0 where the model has none.
    pub block: usize,
    /// The confidence of its source, in [0, 1]: provenance, not a weight.
    pub confidence: Option<f64>,
    /// How many samples support it.
    pub support: Option<u64>,
    /// The consequents that lost against this one when it was learned.
    pub against: Vec<Beaten>,
    /// The author's note.
    pub note: Option<String>,
}

/// A consequent that lost against the one in the rule, when the rule was learned.
#[derive(Debug, Clone, PartialEq)]
pub struct Beaten {
    /// The term that lost.
    pub term: String,
    /// Its degree.
    pub degree: f64,
    /// How many samples support it.
    pub support: u64,
}
