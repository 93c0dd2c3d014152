//! The explanation of an evaluation, as data.

use alloc::{string::String, vec::Vec};

/// The explanation of an evaluation: degrees, rules that fired, and their contributions.
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[non_exhaustive]
pub struct Explanation {
    /// The inputs, with the degree of each of their terms.
    pub inputs: Vec<ExplainedInput>,
    /// The rules that fired, by decreasing firing strength.
    pub rules: Vec<FiredRule>,
    /// The outputs.
    pub outputs: Vec<ExplainedOutput>,
}

/// An input with the degrees of its terms.
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[non_exhaustive]
pub struct ExplainedInput {
    /// The name of the input.
    pub name: String,
    /// The value before clamping.
    pub given: f64,
    /// The value that was used: clamped to the range of the input.
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
    /// The name of the term.
    pub term: String,
    /// The degree, in [0, 1]; for an interval type-2 term, the upper degree.
    pub degree: f64,
    /// The lower degree of an interval type-2 term; absent for any other term.
    #[cfg_attr(feature = "serde", serde(skip_serializing_if = "Option::is_none"))]
    pub lower: Option<f64>,
}

/// A rule that fired.
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[non_exhaustive]
pub struct FiredRule {
    /// The index of the rule in the model; serialised as the rule number, which counts from 1.
    #[cfg_attr(
        feature = "serde",
        serde(serialize_with = "crate::serial::rule_number")
    )]
    #[cfg_attr(feature = "schema", schemars(range(min = 1)))]
    pub rule: usize,
    /// The text of the rule.
    pub text: String,
    /// The degree of the rule's condition.
    pub degree: f64,
    /// The degree of the condition times the weight of the rule, adjusted by the activation method. Hedges of its
    /// consequents are applied in [`Share::strength`]. If the condition reads an interval type-2 term, this is the upper
    /// bound, and so is `degree`.
    pub strength: f64,
    /// The lower bound of the strength, if the condition reads an interval type-2 term; otherwise absent.
    #[cfg_attr(feature = "serde", serde(skip_serializing_if = "Option::is_none"))]
    pub lower: Option<f64>,
}

/// An output with the rules that contribute to it.
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[non_exhaustive]
pub struct ExplainedOutput {
    /// The name of the output.
    pub name: String,
    /// The value; `None` if no rule fires and the output has no default.
    pub value: Option<f64>,
    /// The lower end of the interval whose middle is the value, if interval type-2 terms determine it; otherwise absent.
    #[cfg_attr(feature = "serde", serde(skip_serializing_if = "Option::is_none"))]
    pub low: Option<f64>,
    /// The upper end of the interval whose middle is the value, if interval type-2 terms determine it; otherwise
    /// absent.
    #[cfg_attr(feature = "serde", serde(skip_serializing_if = "Option::is_none"))]
    pub high: Option<f64>,
    /// Whether no rule fires and the value is the default of the output.
    pub is_default: bool,
    /// Whether the output keeps its previous value where no rule fires. An explanation covers a single point, which has
    /// no previous value.
    pub keeps_previous: bool,
    /// The outputs whose values this output reads. If one of them has no value, no rule of this output fires, and it
    /// has no value either.
    pub reads: Vec<String>,
    /// The largest firing strength of a rule of this output.
    pub coverage: f64,
    /// The rules that contribute to the output, by decreasing share.
    pub rules: Vec<Share>,
    /// The degree of the value in each term; empty for Takagi-Sugeno outputs.
    pub terms: Vec<Degree>,
    /// The aggregated set; with interval type-2 terms, the upper aggregated set. It is a list of `(value, degree)` at
    /// evenly spaced values over the range, or at the singletons. Empty for Takagi-Sugeno and Tsukamoto outputs.
    pub set: Vec<(f64, f64)>,
}

/// The contribution of a rule to an output.
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[non_exhaustive]
pub struct Share {
    /// The index of the rule in the model; serialised as the rule number, which counts from 1.
    #[cfg_attr(
        feature = "serde",
        serde(serialize_with = "crate::serial::rule_number")
    )]
    #[cfg_attr(feature = "schema", schemars(range(min = 1)))]
    pub rule: usize,
    /// The term that the rule concludes.
    pub term: String,
    /// The firing strength; if the condition reads an interval type-2 term, its upper bound.
    pub strength: f64,
    /// The lower bound of the firing strength, if the condition reads an interval type-2 term; otherwise absent.
    #[cfg_attr(feature = "serde", serde(skip_serializing_if = "Option::is_none"))]
    pub lower: Option<f64>,
    /// The rule's share of the result, in [0, 1]. With maximum as aggregation, it is the fraction of the aggregated
    /// set's area in which this rule is the highest; with sums, the rule's fraction of the area of all sets; in a
    /// Takagi-Sugeno or Tsukamoto output, its fraction of the weights. With interval type-2 terms, the share is
    /// computed from upper bounds.
    pub share: f64,
    /// The number that the consequent yields at these inputs; only for Takagi-Sugeno and Tsukamoto outputs and for
    /// singletons.
    pub value: Option<f64>,
    /// The implied set: `(value, degree)` at evenly spaced values over the range. Empty for Takagi-Sugeno and Tsukamoto
    /// outputs and for singletons. Not serialised.
    #[cfg_attr(feature = "serde", serde(skip))]
    pub implied: Vec<(f64, f64)>,
}
