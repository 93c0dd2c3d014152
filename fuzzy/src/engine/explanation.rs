//! Why an output is what it is, as data.

use alloc::{string::String, vec::Vec};

/// Why an evaluation gives its values.
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[non_exhaustive]
pub struct Explanation {
    /// The inputs, with the degree of each of their terms.
    pub inputs: Vec<ExplainedInput>,
    /// The rules that fired, the strongest first.
    pub rules: Vec<FiredRule>,
    /// The outputs.
    pub outputs: Vec<ExplainedOutput>,
}

/// An input, and the degrees of its terms.
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[non_exhaustive]
pub struct ExplainedInput {
    /// Its name.
    pub name: String,
    /// The value that was given.
    pub given: f64,
    /// The value that was used: the end of the range where the given one lies outside.
    pub value: f64,
    /// The degree of each term.
    pub terms: Vec<Degree>,
}

/// The degree of membership of a value in a term.
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[non_exhaustive]
pub struct Degree {
    /// The term.
    pub term: String,
    /// The degree, in [0, 1].
    pub degree: f64,
}

/// A rule that fired.
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[non_exhaustive]
pub struct FiredRule {
    /// Its index in the model; serialised, rules count from 1.
    #[cfg_attr(
        feature = "serde",
        serde(serialize_with = "crate::serial::rule_number")
    )]
    #[cfg_attr(feature = "schema", schemars(range(min = 1)))]
    pub rule: usize,
    /// The rule as it is written.
    pub text: String,
    /// The degree of its condition.
    pub degree: f64,
    /// The degree times the weight, as the activation method leaves it; hedges of its consequents change it in
    /// [`Share::strength`].
    pub strength: f64,
}

/// An output, and the rules that contribute to it.
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[non_exhaustive]
pub struct ExplainedOutput {
    /// Its name.
    pub name: String,
    /// The value; none where no rule fires and the model has no default.
    pub value: Option<f64>,
    /// Whether no rule fires and the value is the model's default.
    pub is_default: bool,
    /// Whether it keeps its previous value where no rule fires. One point has none before it.
    pub keeps_previous: bool,
    /// The outputs whose values it reads. Where one of them has no value, no rule of this output fires, and it has none.
    pub reads: Vec<String>,
    /// The largest firing strength of a rule of this output.
    pub coverage: f64,
    /// The rules that contribute to it, the largest share first.
    pub rules: Vec<Share>,
    /// The degree of the value in each term; empty for Takagi-Sugeno outputs.
    pub terms: Vec<Degree>,
    /// The aggregated set: `(value, degree)` at even steps over the range, or at the places of singletons; empty for
    /// Takagi-Sugeno and Tsukamoto outputs.
    pub set: Vec<(f64, f64)>,
}

/// What a rule contributes to an output.
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[non_exhaustive]
pub struct Share {
    /// The rule's index in the model; serialised, rules count from 1.
    #[cfg_attr(
        feature = "serde",
        serde(serialize_with = "crate::serial::rule_number")
    )]
    #[cfg_attr(feature = "schema", schemars(range(min = 1)))]
    pub rule: usize,
    /// The term it concludes.
    pub term: String,
    /// Its firing strength.
    pub strength: f64,
    /// Its share of the result, in [0, 1]. With the maximum as aggregation, the part of the aggregated set's area where
    /// this rule is the highest; with sums, its part of the area of all sets; in a Takagi-Sugeno or Tsukamoto output, its
    /// part of the weights.
    pub share: f64,
    /// In a Takagi-Sugeno or Tsukamoto output, and one of singletons, the number that its consequent gives at these inputs.
    pub value: Option<f64>,
    /// The implied set: `(value, degree)` at even steps over the range; empty for Takagi-Sugeno and
    /// Tsukamoto outputs. Not serialised.
    #[cfg_attr(feature = "serde", serde(skip))]
    pub implied: Vec<(f64, f64)>,
}
