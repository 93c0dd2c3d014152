//! Functions for an editor of rule sets and profiles, independent of the program that shows the text: findings, completion,
//! descriptions of names, renaming, layout, adding and removing parts, and changing ranges, units, terms and numbers in place.
//!
//! It implements no protocol, opens no file and prints nothing. Positions are offsets in bytes, changes are [`Edit`]s.
//! If a profile names the file of a rule set, the caller provides its text.
//!
//! # Example: an open text
//! ```
//! use flagred_authoring::{Document, completion, names};
//!
//! let text = "fuzzy: 1
//! name: fan
//! inputs: {heat: {range: [0, 100], unit: °C, partition: [low, high]}}
//! outputs: {speed: {range: [0, 9], partition: [slow, fast]}}
//! rules:
//!   - IF heat IS high THEN speed IS fast
//! ";
//! let document = Document::new(text, |_| None);
//! assert!(document.findings().0.iter().any(|finding| finding.code == "uncovered"));
//!
//! let after_is = text.find("high THEN").ok_or("no rule")?;
//! let labels = completion::at(&document, after_is).into_iter().map(|item| item.label);
//! assert_eq!(labels.take(2).collect::<Vec<_>>(), ["low", "high"]);
//!
//! let hover = names::describe(&document, after_is).ok_or("no name")?;
//! assert_eq!(&text[hover.span], "high");
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

pub mod answers;
pub mod completion;
mod document;
pub mod handles;
pub mod layout;
pub mod names;
mod numbers;
pub mod provenance;
pub mod rewrite;
pub mod slice;
pub mod starter;
pub mod structure;
pub mod values;

pub use document::{Document, Examination, examine, unusable_rules};
pub use flagred::loaded::is_profile;

use std::ops::Range;

/// A change of a text.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Edit {
    /// The bytes to replace.
    pub span: Range<usize>,
    /// The replacement.
    pub text: String,
}

/// Applies edits that do not overlap to a text.
pub fn edited(text: &str, edits: &[Edit]) -> String {
    let mut edits: Vec<&Edit> = edits.iter().collect();
    edits.sort_by_key(|edit| (edit.span.start, edit.span.end));
    let mut changed = String::with_capacity(text.len());
    let mut at = 0;
    for edit in edits {
        changed += text.get(at..edit.span.start).unwrap_or("");
        changed += &edit.text;
        at = edit.span.end;
    }
    changed + text.get(at..).unwrap_or("")
}

/// Runs the example of the README.
#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct Readme;
