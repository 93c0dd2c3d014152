//! A model that was parsed from a text, with the positions of its parts.

use alloc::{boxed::Box, vec::Vec};
use core::ops::Range;

use super::Model;
use crate::{diagnostic::Findings, rule::Name};

/// A parsed model, with the positions of its parts in the text.
///
/// # Example: the position of a rule
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
    /// The model.
    pub model: Model,
    /// The positions of the parts of the model.
    pub spans: Spans,
    /// Warnings: problems that do not prevent the model from being read.
    pub warnings: Findings,
}

impl Document {
    /// Creates a document from a model that was read from a text of another format.
    #[must_use]
    pub fn new(model: Model, spans: Spans, warnings: Findings) -> Self {
        Document {
            model,
            spans,
            warnings,
        }
    }
}

/// The positions (byte ranges) of the parts of a model in its text, in the order of the model. Empty for a model built
/// in code.
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
    /// Whether a rule could not be parsed and is missing from the model; a finding reports the error.
    pub(crate) rules_unread: bool,
    /// Whether an input or output may be missing because its name is repeated or its position is wrong; a finding
    /// reports the error.
    pub(crate) names_unread: bool,
}

/// The positions of the parts of a rule block.
#[derive(Debug, Clone, PartialEq, Default)]
#[non_exhaustive]
pub struct BlockSpans {
    /// The name.
    pub name: Range<usize>,
    /// The activation method.
    pub activation: Range<usize>,
}

/// The positions of the parts of a variable.
#[derive(Debug, Clone, PartialEq, Default)]
#[non_exhaustive]
pub struct VariableSpans {
    /// The name.
    pub name: Range<usize>,
    /// The limits of the range.
    pub range: Range<usize>,
    /// The value of `partition`: a list of names, or a mapping of names to peaks. Empty if the terms are written in
    /// another way.
    pub partition: Range<usize>,
    /// The value of `steps`: a mapping of names to limits. Empty if the terms are written in another way.
    pub steps: Range<usize>,
    /// The terms.
    pub terms: Vec<TermSpans>,
    /// The number of samples; outputs only.
    pub samples: Range<usize>,
    /// The value for inputs at which no rule fires; outputs only.
    pub default: Range<usize>,
    /// Whether the range could not be parsed; a finding reports the error.
    pub(crate) range_unread: bool,
    /// Whether the terms could not be parsed; a finding reports the error.
    pub(crate) terms_unread: bool,
}

/// The positions of the parts of a term.
#[derive(Debug, Clone, PartialEq, Default)]
#[non_exhaustive]
pub struct TermSpans {
    /// The name.
    pub name: Range<usize>,
    /// The parameters of the membership function; empty in `partition` and `steps`.
    pub parameters: Vec<Range<usize>>,
    /// The numbers of the membership function. For a piecewise function, these are the x and the degree of each point;
    /// for a partition with peaks, the peak; for `steps`, the limit; for a linear function, the coefficients and then
    /// the constant (`0..0` if it is omitted). Empty for a formula and in an even partition.
    pub numbers: Vec<Range<usize>>,
    /// Every occurrence of a variable in a formula or a linear function.
    pub names: Vec<Name>,
    /// The height.
    pub height: Range<usize>,
    /// The parts of the lower membership function of an interval type-2 term; the fields above are those of the upper
    /// one, except that `names` contains the names in both.
    pub lower: Option<Box<TermSpans>>,
    /// Whether the membership function could not be parsed; a finding reports the error.
    pub(crate) unread: bool,
}

/// The positions of the parts of a rule. The names in the rule have their own spans.
#[derive(Debug, Clone, PartialEq, Default)]
#[non_exhaustive]
pub struct RuleSpans {
    /// The whole rule.
    pub whole: Range<usize>,
    /// The confidence.
    pub confidence: Range<usize>,
    /// The number after WITH, or the empty range after the conclusion if there is none.
    pub weight: Range<usize>,
    /// The degrees of the consequents that were rejected in favour of the rule's consequent.
    pub against: Vec<Range<usize>>,
    /// The terms of the consequents that were rejected in favour of the rule's consequent.
    pub against_terms: Vec<Range<usize>>,
}
