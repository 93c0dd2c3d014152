//! Documents as trees: scalars, lists and mappings, each with its position in the text.
//!
//! YAML, JSON and all other formats that serde supports are converted to this tree; [`crate::Model`] is read from it
//! and written to it. All findings in a tree are reported together, each with its position, whereas direct
//! deserialization stops at the first error.

use alloc::{format, string::String, vec::Vec};
use core::ops::Range;

mod number;
mod read;
#[cfg(feature = "serde")]
mod serde_impl;

pub use number::{number_advice, percentage_advice, percentage_of_share, share_of_percentage};
pub use read::{Entry, Fields};

/// A value with its position in the text.
#[derive(Debug, Clone, PartialEq)]
pub struct Node {
    /// The value.
    pub value: Value,
    /// The byte range in the text; `0..0` if there is no text.
    pub span: Range<usize>,
}

/// A value of a document.
#[derive(Debug, Clone, PartialEq)]
pub enum Value {
    /// Text, a number, a boolean or null.
    Scalar(Scalar),
    /// `[a, b]`
    List(Vec<Node>),
    /// `{a: b}`, in the order of the text, including repeated keys.
    Mapping(Vec<(Node, Node)>),
}

/// A scalar as it was written. Whether it is a number depends on how it is read.
#[derive(Debug, Clone, PartialEq)]
pub struct Scalar {
    /// The text, with escapes and line breaks resolved.
    pub text: String,
    /// Whether it was marked as text (quotes, `|`, `>`); then it is not a number even if it looks like one.
    pub quoted: bool,
    /// The offset in the document of each byte of `text`.
    pub(crate) offsets: Offsets,
}

/// The offsets in the document of the bytes of a scalar.
#[derive(Debug, Clone, PartialEq)]
pub(crate) enum Offsets {
    /// The bytes are contiguous, starting at this offset.
    From(usize),
    #[cfg_attr(
        not(feature = "yaml"),
        allow(dead_code, reason = "only text has escapes")
    )]
    /// The position of each character, because escapes, line breaks and indentation were resolved.
    Each(Vec<ScalarCharacter>),
}

/// A character of a scalar: the index of its first byte in the text of the scalar, and its byte range in the document.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct ScalarCharacter {
    pub(crate) text: usize,
    pub(crate) document: Range<usize>,
}

impl Scalar {
    /// Returns the byte range in the document that corresponds to `part`, a byte range in the text of this scalar.
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
    /// Creates a text, without a position.
    pub fn text(text: impl Into<String>) -> Self {
        Self::scalar(text.into(), true)
    }

    /// Creates a number, without a position.
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

    /// Creates a scalar, without a position.
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

    /// Creates a list, without a position.
    #[must_use]
    pub fn list(items: Vec<Node>) -> Self {
        Node {
            value: Value::List(items),
            span: 0..0,
        }
    }

    /// Creates a mapping, without a position.
    pub fn mapping<K: Into<String>>(entries: impl IntoIterator<Item = (K, Node)>) -> Self {
        let entries = entries
            .into_iter()
            .map(|(key, value)| (Node::text(key), value));
        Node {
            value: Value::Mapping(entries.collect()),
            span: 0..0,
        }
    }

    /// Returns the text of a scalar.
    #[must_use]
    pub fn as_text(&self) -> Option<&str> {
        match &self.value {
            Value::Scalar(scalar) => Some(&scalar.text),
            _ => None,
        }
    }

    /// Returns the text of a number, as it is written.
    #[must_use]
    pub fn as_number_text(&self) -> Option<&str> {
        match &self.value {
            Value::Scalar(scalar) => scalar.as_number().map(|_| scalar.text.as_str()),
            _ => None,
        }
    }

    /// Formats the value on one line: `{triangle: [0, 2, 4]}`.
    pub(crate) fn to_line(&self) -> String {
        match &self.value {
            Value::Scalar(scalar) => scalar.text.clone(),
            Value::List(items) => {
                let items: Vec<String> = items.iter().map(Node::to_line).collect();
                format!("[{}]", items.join(", "))
            }
            Value::Mapping(pairs) => {
                let pairs = pairs.iter();
                let pairs: Vec<String> = pairs
                    .map(|(key, value)| format!("{}: {}", key.to_line(), value.to_line()))
                    .collect();
                format!("{{{}}}", pairs.join(", "))
            }
        }
    }

    /// Returns the value of a key of a mapping.
    #[must_use]
    pub fn child(&self, key: &str) -> Option<&Node> {
        let Value::Mapping(pairs) = &self.value else {
            return None;
        };
        let pair = pairs.iter().find(|(name, _)| name.as_text() == Some(key));
        pair.map(|(_, value)| value)
    }

    /// Returns the number of entries of a mapping, including repeated keys.
    #[must_use]
    pub fn children(&self) -> usize {
        match &self.value {
            Value::Mapping(pairs) => pairs.len(),
            _ => 0,
        }
    }

    /// Returns whether the value is null.
    #[must_use]
    pub fn is_null(&self) -> bool {
        matches!(&self.value, Value::Scalar(scalar) if scalar.is_null())
    }
}
