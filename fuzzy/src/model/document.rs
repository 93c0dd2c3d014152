//! A model that was read from a text, and where its parts stand in it.

use alloc::vec::Vec;
use core::ops::Range;

use super::Model;
use crate::diagnostic::Findings;

/// A model as it was read, and where its parts stand in the text.
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
