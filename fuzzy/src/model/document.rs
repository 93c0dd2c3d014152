//! A model that was read from a text, and where its parts stand in it.

use alloc::vec::Vec;
use core::ops::Range;

use super::Model;
use crate::diagnostic::Findings;

/// A model as it was read, and where its parts stand in the text.
///
/// # Example: from a rule back to its place
/// ```
/// use fuzzy::format::{Document, VariablePlaces};
///
/// let text = "fuzzy: 1
/// name: fan
/// inputs: {heat: {range: [0, 100], partition: [low, high]}}
/// outputs: {speed: {range: [0, 9], partition: [slow, fast]}}
/// rules: [IF heat IS high THEN speed IS fast]";
/// let Document { model, places, warnings } = fuzzy::yaml::parse(text)?;
/// assert_eq!((model.rules.len(), warnings.0.len()), (1, 0));
/// assert_eq!(&text[places.rules[0].clone()], "IF heat IS high THEN speed IS fast");
/// let VariablePlaces { name, terms } = &places.inputs[0];
/// assert_eq!((&text[name.clone()], &text[terms[1].clone()]), ("heat", "high"));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct Document {
    /// What the author wrote.
    pub model: Model,
    /// Where its parts stand.
    pub places: Places,
    /// What does not keep the model from working.
    pub warnings: Findings,
}

/// Where the parts of a model stand in its text, in the order of the model.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Places {
    /// The inputs.
    pub inputs: Vec<VariablePlaces>,
    /// The outputs.
    pub outputs: Vec<VariablePlaces>,
    /// The key `rules`.
    pub rules_key: Range<usize>,
    /// The rules.
    pub rules: Vec<Range<usize>>,
}

/// Where the parts of a variable stand.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct VariablePlaces {
    /// Its name.
    pub name: Range<usize>,
    /// The names of its terms.
    pub terms: Vec<Range<usize>>,
}
