//! A document as a tree: scalars, lists and mappings, each with its span in the text.
//!
//! YAML, JSON and whatever else serde knows become this tree, and [`crate::Model`] is read from it and written to it. All
//! findings of a tree are reported at once, each with its span, where direct deserialization stops at the first one.

use alloc::{format, string::String, vec::Vec};
use core::ops::Range;

mod read;
#[cfg(feature = "serde")]
mod serde_impl;

pub use read::{Entry, Fields};

/// A value with its span in the text.
#[derive(Debug, Clone, PartialEq)]
pub struct Node {
    /// The value.
    pub value: Value,
    /// Its bytes in the text; `0..0` where there is no text.
    pub span: Range<usize>,
}

/// A value of a document.
#[derive(Debug, Clone, PartialEq)]
pub enum Value {
    /// Text, a number, a boolean or nothing.
    Scalar(Scalar),
    /// `[a, b]`
    List(Vec<Node>),
    /// `{a: b}`, in the order written, repeated keys included.
    Mapping(Vec<(Node, Node)>),
}

/// A scalar as it was written; whether it is a number is for its reader to decide.
#[derive(Debug, Clone, PartialEq)]
pub struct Scalar {
    /// What it says, escapes and line breaks resolved.
    pub text: String,
    /// Whether it was marked as text (quotes, `|`, `>`), so that it is no number even if it looks like one.
    pub quoted: bool,
    /// The offset of each of its bytes in the document.
    pub(crate) offsets: Offsets,
}

/// The offsets of a scalar's bytes in the document.
#[derive(Debug, Clone, PartialEq)]
pub(crate) enum Offsets {
    /// Contiguous from this offset on.
    From(usize),
    #[cfg_attr(
        not(feature = "yaml"),
        allow(dead_code, reason = "only text has escapes")
    )]
    /// Character by character, since escapes, line breaks and indentation are resolved in the text.
    Each(Vec<Letter>),
}

/// A character of a scalar's text: its first byte there, and its bytes in the document.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Letter {
    pub(crate) text: usize,
    pub(crate) document: Range<usize>,
}

impl Scalar {
    /// The bytes of the document that `part`, some bytes of this scalar's text, came from.
    #[must_use]
    pub fn span(&self, part: Range<usize>) -> Range<usize> {
        match &self.offsets {
            Offsets::From(start) => start + part.start..start + part.end,
            Offsets::Each(letters) => {
                let first = letters.partition_point(|letter| letter.text < part.start);
                let behind = letters.partition_point(|letter| letter.text < part.end);
                let end = behind.checked_sub(1).and_then(|last| letters.get(last));
                let end = end.map_or(0, |letter| letter.document.end);
                match letters.get(first) {
                    Some(letter) if part.is_empty() => letter.document.start..letter.document.start,
                    Some(letter) => letter.document.start..end.max(letter.document.start),
                    None => end..end,
                }
            }
        }
    }

    fn is_null(&self) -> bool {
        !self.quoted && matches!(self.text.as_str(), "" | "~" | "null" | "Null" | "NULL")
    }
}

impl Node {
    /// Text, without a span.
    pub fn text(text: impl Into<String>) -> Self {
        Self::scalar(text.into(), true)
    }

    /// A number, without a span.
    #[must_use]
    pub fn number(number: f64) -> Self {
        let text = if number.is_nan() {
            String::from(".nan")
        } else if number.is_infinite() {
            String::from(if number > 0.0 { ".inf" } else { "-.inf" })
        } else if number != 0.0 && !(1e-6..1e17).contains(&number.abs()) {
            format!("{number:e}")
        } else {
            format!("{number}")
        };
        Self::scalar(text, false)
    }

    /// A scalar, without a span.
    pub(crate) fn scalar(text: String, quoted: bool) -> Self {
        let offsets = Offsets::From(0);
        Node {
            value: Value::Scalar(Scalar {
                text,
                quoted,
                offsets,
            }),
            span: 0..0,
        }
    }

    /// A list, without a span.
    #[must_use]
    pub fn list(items: Vec<Node>) -> Self {
        Node {
            value: Value::List(items),
            span: 0..0,
        }
    }

    /// A mapping, without a span.
    pub fn mapping<K: Into<String>>(entries: impl IntoIterator<Item = (K, Node)>) -> Self {
        let entries = entries
            .into_iter()
            .map(|(key, value)| (Node::text(key), value));
        Node {
            value: Value::Mapping(entries.collect()),
            span: 0..0,
        }
    }

    /// Whether nothing is there.
    #[must_use]
    pub fn is_null(&self) -> bool {
        matches!(&self.value, Value::Scalar(scalar) if scalar.is_null())
    }
}
