//! A model that was read from a text, and where its parts stand in it.

use alloc::vec::Vec;
use core::ops::Range;

use super::Model;
use crate::{diagnostic::Findings, rule::Name};

/// A model as it was read, and where its parts stand in the text.
///
/// # Example: where a rule stands
/// ```
/// let text = "fuzzy: 1
/// name: fan
/// inputs: {heat: {range: [0, 100], partition: [low, high]}}
/// outputs: {speed: {range: [0, 9], partition: [slow, fast]}}
/// rules: [IF heat IS high THEN speed IS fast]";
/// let document = fuzzy::yaml::parse(text)?;
/// assert_eq!(document.model.rules.len(), 1);
/// assert_eq!(&text[document.spans.rules[0].whole.clone()], "IF heat IS high THEN speed IS fast");
/// assert_eq!(&text[document.spans.inputs[0].terms[1].name.clone()], "high");
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub struct Document {
    /// What the author wrote.
    pub model: Model,
    /// Where its parts stand.
    pub spans: Spans,
    /// What does not keep the model from being read.
    pub warnings: Findings,
}

impl Document {
    /// A model that was read from a text of another format.
    #[must_use]
    pub fn new(model: Model, spans: Spans, warnings: Findings) -> Self {
        Document {
            model,
            spans,
            warnings,
        }
    }
}

/// Where the parts of a model stand in its text, in the order of the model. Empty for a model made in code.
#[derive(Debug, Clone, PartialEq, Default)]
#[non_exhaustive]
pub struct Spans {
    /// The inputs.
    pub inputs: Vec<VariableSpans>,
    /// The key `outputs`.
    pub outputs_key: Range<usize>,
    /// The outputs.
    pub outputs: Vec<VariableSpans>,
    /// The key `rules`, or `blocks`.
    pub rules_key: Range<usize>,
    /// The rules.
    pub rules: Vec<RuleSpans>,
    /// The activation method outside blocks.
    pub activation: Range<usize>,
    /// The least firing strength.
    pub least_strength: Range<usize>,
    /// The rule blocks.
    pub blocks: Vec<BlockSpans>,
    /// The entries of `allow`.
    pub allow: Vec<Range<usize>>,
    /// The key `provenance`.
    pub provenance: Range<usize>,
    /// Some rule could not be read, and is not in the model; a finding says why.
    pub(crate) rules_unread: bool,
}

/// Where the parts of a rule block stand.
#[derive(Debug, Clone, PartialEq, Default)]
#[non_exhaustive]
pub struct BlockSpans {
    /// Its name.
    pub name: Range<usize>,
    /// Its activation method.
    pub activation: Range<usize>,
}

/// Where the parts of a variable stand.
#[derive(Debug, Clone, PartialEq, Default)]
#[non_exhaustive]
pub struct VariableSpans {
    /// Its name.
    pub name: Range<usize>,
    /// The ends of its range.
    pub range: Range<usize>,
    /// The value of `partition`: a list of names, or a mapping of names to peaks. Empty where terms are spelt out.
    pub partition: Range<usize>,
    /// The value of `steps`: a mapping of names to limits. Empty where terms are given otherwise.
    pub steps: Range<usize>,
    /// Its terms.
    pub terms: Vec<TermSpans>,
    /// Of an output, the number of samples.
    pub samples: Range<usize>,
    /// Of an output, the value where no rule fires.
    pub default: Range<usize>,
    /// The range, or the terms, could not be read; a finding says why.
    pub(crate) range_unread: bool,
    pub(crate) terms_unread: bool,
}

/// Where the parts of a term stand.
#[derive(Debug, Clone, PartialEq, Default)]
#[non_exhaustive]
pub struct TermSpans {
    /// Its name.
    pub name: Range<usize>,
    /// The parameters of its membership function: empty in a partition and in `steps`.
    pub parameters: Vec<Range<usize>>,
    /// The numbers of its membership function, one by one: x and degree of each point of a piecewise one, the peak in a partition
    /// that gives it, the limit in `steps`, the coefficients of a linear function and then its constant (`0..0` where it is left out). Empty for a
    /// formula and in an even partition.
    pub numbers: Vec<Range<usize>>,
    /// The variables that a formula or a linear function names, at each place.
    pub names: Vec<Name>,
    /// Its height.
    pub height: Range<usize>,
    /// The membership function could not be read; a finding says why.
    pub(crate) unread: bool,
}

/// Where the parts of a rule stand. The names in it have their own spans.
#[derive(Debug, Clone, PartialEq, Default)]
#[non_exhaustive]
pub struct RuleSpans {
    /// All of it.
    pub whole: Range<usize>,
    /// Its confidence.
    pub confidence: Range<usize>,
    /// The number behind WITH; without one, the empty place behind the conclusion.
    pub weight: Range<usize>,
    /// The degrees of the consequents that it beat.
    pub against: Vec<Range<usize>>,
    /// The terms of the consequents that it beat.
    pub against_terms: Vec<Range<usize>>,
}
