//! The data model of a rule set: variables, terms, operators and rules as plain data.

use alloc::{string::String, vec::Vec};

use crate::rule;

mod allowed;
mod blocks;
mod builder;
pub(crate) mod chain;
pub(crate) mod document;
pub(crate) mod footprint;
mod partition;
mod plateau;
mod provenance;
mod steps;
pub(crate) mod type2;
pub use crate::formula::Formula;
pub use crate::shape::{MembershipError, MembershipFunction, Role};
pub(crate) use crate::shape::{ShapeForm, ShapeParts};
pub use crate::table::{
    Activation, Aggregation, Comparison, Conjunction, Disjunction, Implication, MIN_STRENGTH,
};
pub use allowed::AllowedFinding;
pub use blocks::Block;
pub(crate) use blocks::concludes;
pub use builder::ModelBuilder;
pub(crate) use partition::{between_peaks, even_peaks};
pub use provenance::{DataFile, LossChange, ProvenanceStep};
pub(crate) use steps::between_limits;
pub use type2::{LowerFunction, TypeReduction};

/// A rule set: inputs, outputs, operators and rules.
///
/// # Example: parse a rule set, change it and print it
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
    /// The purpose of the rule set, as free text.
    pub description: Option<String>,
    /// The inputs, in the order in which the engine takes their values.
    pub inputs: Vec<Variable>,
    /// The outputs, in the order in which the engine returns their values.
    pub outputs: Vec<Output>,
    /// The operators of all rules. If there are blocks, only the aggregation is used.
    pub operators: Operators,
    /// The activation method, which selects the rules that fire. Not used if there are blocks.
    pub activation: Activation,
    /// The least firing strength: a rule whose firing strength is below it does not fire. At least [`MIN_STRENGTH`],
    /// which is the default, and at most 1.
    pub least_strength: f64,
    /// The rule blocks; empty if all rules share `operators` and `activation`.
    pub blocks: Vec<Block>,
    /// The rules; if there are blocks, in the order of the blocks.
    pub rules: Vec<Rule>,
    /// The findings of the analysis that the author accepts.
    pub allow: Vec<AllowedFinding>,
    /// The commands that produced the rule set, in the order in which they ran.
    pub provenance: Vec<ProvenanceStep>,
}

/// A linguistic variable: a range of numbers and the terms that name parts of it.
///
/// # Example: two overlapping terms
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
    /// The name used in rules.
    pub name: String,
    /// The meaning of the variable, as free text.
    pub description: Option<String>,
    /// The unit of the values, for display: `"%"`, `"m/s"`.
    pub unit: Option<String>,
    /// The lower end of the range.
    pub low: f64,
    /// The upper end of the range.
    pub high: f64,
    /// The terms.
    pub terms: Vec<Term>,
}

/// A term: the name of a fuzzy set over a variable's range.
#[derive(Debug, Clone, PartialEq)]
pub struct Term {
    /// The name used in rules.
    pub name: String,
    /// The membership function; for an interval type-2 term, the upper one.
    pub membership_function: MembershipFunction,
    /// The height of the membership function, in (0, 1]; 1 by default.
    pub height: f64,
    /// The lower membership function of an interval type-2 term; `None` for an ordinary term.
    pub lower: Option<LowerFunction>,
}

/// An output variable, with the method that reduces its fuzzy result to a number.
#[derive(Debug, Clone, PartialEq)]
pub struct Output {
    /// The name, range and terms.
    pub variable: Variable,
    /// The defuzzifier, which reduces the aggregated set to a number.
    pub defuzzifier: Defuzzifier,
    /// Integration by sampling, to reproduce the results of other programs; `None` integrates exactly.
    pub samples: Option<Sampling>,
    /// The value of the output where no rule fires.
    pub when_no_rule_fires: NoRuleFires,
    /// The aggregation, which combines the consequents of this output; `None` uses the aggregation of the rule set.
    pub aggregation: Option<Aggregation>,
    /// Whether a value outside the range is clamped to it. Only Takagi-Sugeno and Tsukamoto outputs can leave their
    /// range.
    pub clamp: bool,
    /// The type reduction of an output that interval type-2 terms affect.
    pub type_reduction: TypeReduction,
}

/// The value of an output where no rule fires.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum NoRuleFires {
    /// The output is undefined.
    Undefined,
    /// Evaluation returns an error.
    Error,
    /// The output has this value.
    Value(f64),
    /// The output keeps the value of the previous evaluation in a `Sequence`. As long as there is no previous value,
    /// and in single evaluations, the output has the value given here, or is undefined.
    Previous(Option<f64>),
}

/// A defuzzifier: the method that reduces an aggregated fuzzy set to a number.
///
/// The three maxima methods treat degrees as equal if their relative difference is at most 1e-12. Two plateaus
/// or peaks of nearly equal degree therefore both count; the section between two kinks is a plateau if all its
/// degrees are equal to the maximum in this sense; and a firing strength that is equal in this sense to the
/// maximum degree of a term does not cut the term off. The mean is taken over all values on plateaus, or over
/// the peaks if there is no plateau.
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
    /// Tsukamoto: `sum(w z) / sum(w)` over the rules, where `z` is the value at which the rule's monotone term has the
    /// degree `w`.
    Tsukamoto,
}

/// The words for defuzzifiers in YAML and in messages.
pub(crate) const DEFUZZIFIERS: [(&str, Defuzzifier); Defuzzifier::ALL.len()] = [
    ("centroid", Defuzzifier::Centroid),
    ("bisector", Defuzzifier::Bisector),
    ("smallest_of_maxima", Defuzzifier::SmallestOfMaxima),
    ("mean_of_maxima", Defuzzifier::MeanOfMaxima),
    ("largest_of_maxima", Defuzzifier::LargestOfMaxima),
    ("weighted_average", Defuzzifier::WeightedAverage),
    ("weighted_sum", Defuzzifier::WeightedSum),
    ("tsukamoto", Defuzzifier::Tsukamoto),
];

impl Defuzzifier {
    /// Returns the word in YAML.
    pub(crate) fn word(self) -> &'static str {
        let found = DEFUZZIFIERS.iter().find(|(_, one)| *one == self);
        found.map_or("", |(word, _)| *word)
    }

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

    /// Returns whether the terms of the output are numbers and functions (Takagi-Sugeno consequents) rather than fuzzy
    /// sets.
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

    /// Returns whether the defuzzifier weights one number per rule: Takagi-Sugeno or Tsukamoto.
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

/// Sampled integration, only for agreement with other programs.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Sampling {
    /// The number of samples over the output's range.
    pub samples: usize,
    /// The positions of the samples.
    pub rule: SamplingRule,
}

/// The positions of the samples of a sampled integration.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum SamplingRule {
    /// `low + (i + 0.5) (high - low) / N` for i = 0..N.
    Midpoint,
    /// `low + i (high - low) / (N - 1)` for i = 0..N, with equal weights at inner points and half the weight at the
    /// ends.
    Trapezoid,
}

/// The operators shared by the rules of a model or of a block.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Operators {
    /// The conjunction for AND.
    pub and: Conjunction,
    /// The disjunction for OR.
    pub or: Disjunction,
    /// The implication, which cuts or scales a consequent by the firing strength.
    pub implication: Implication,
    /// The aggregation, which combines the consequents of one output.
    pub aggregation: Aggregation,
}

/// A rule with its provenance.
#[derive(Debug, Clone, PartialEq)]
pub struct Rule {
    /// The parsed rule, with its weight.
    pub rule: rule::Rule,
    /// The index of the rule's block; 0 if the model has no blocks.
    pub block: usize,
    /// The confidence that its source assigned, in [0, 1]. It is not a weight and does not affect evaluation.
    pub confidence: Option<f64>,
    /// The number of samples that support the rule.
    pub support: Option<u64>,
    /// The consequents that were rejected in favour of the rule's consequent when the rule was learned.
    pub against: Vec<RejectedConsequent>,
    /// A note of the author.
    pub note: Option<String>,
}

/// A consequent that was rejected in favour of the rule's consequent when the rule was learned.
#[derive(Debug, Clone, PartialEq)]
pub struct RejectedConsequent {
    /// The term of the rejected consequent.
    pub term: String,
    /// The degree of the rejected consequent.
    pub degree: f64,
    /// The number of samples that support this consequent.
    pub support: u64,
}
