//! A document as a tree: scalars, lists and mappings, each with its place in the text.
//!
//! Every file format of a rule set is this tree first. A tree can be read to its end whatever is wrong in it, so all
//! findings of a file are told at once, each with its bytes; types that are deserialized directly stop at the first
//! one. And there is one interpretation only: YAML, JSON or anything else that serde knows becomes this tree, and
//! [`crate::Model`] is read from it and written to it.

use alloc::{format, string::String, vec::Vec};
use core::ops::Range;

mod read;
#[cfg(feature = "serde")]
mod serde_impl;

pub use read::{Entry, Fields};

/// A value with its place in the text.
///
/// # Example: a file format of one's own
/// ```
/// use fuzzy::{diagnostic::Diagnostic, yaml};
///
/// let text = "fan: {speed: fast, blades: 5}";
/// let tree = yaml::read(text)?;
/// let mut findings: Vec<Diagnostic> = Vec::new();
/// let fan = tree.fields("the file", &["fan"], &mut findings).and_then(|file| file.get("fan"));
/// let fields = fan.and_then(|fan| fan.fields("the fan", &["speed", "blades"], &mut findings)).ok_or("no fan")?;
/// assert_eq!(fields.get("blades").and_then(|node| node.whole("`blades`", 1, &mut findings)), Some(5));
/// assert_eq!(fields.get("speed").and_then(|node| node.finite("`speed`", &mut findings)), None);
/// // What is wrong goes to the findings, with its place.
/// assert_eq!(&text[findings[0].span.clone()], "fast");
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct Node {
    /// The value.
    pub value: Value,
    /// Its bytes in the text; `0..0` where there is no text.
    pub span: Range<usize>,
}

/// A value of a document.
///
/// # Example: what a text is made of
/// ```
/// use fuzzy::tree::Value;
///
/// let Value::Mapping(entries) = fuzzy::yaml::read("{blades: [5, 7], blades: 9}")?.value else { return Err("no mapping".into()) };
/// assert_eq!(entries.len(), 2); // a double is for the reader to complain about
/// assert!(matches!(&entries[0].1.value, Value::List(items) if items.len() == 2));
/// assert!(matches!(&entries[1].1.value, Value::Scalar(scalar) if scalar.text == "9"));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
pub enum Value {
    /// Text, a number, yes or no, or nothing at all.
    Scalar(Scalar),
    /// `[a, b]`
    List(Vec<Node>),
    /// `{a: b}`, in the order written, doubles included.
    Mapping(Vec<(Node, Node)>),
}

/// A scalar as it was written; whether it is a number is for its reader to decide.
///
/// # Example: a number, and text that looks like one
/// ```
/// use fuzzy::tree::{Scalar, Value};
///
/// let Value::List(items) = fuzzy::yaml::read("[5, '5']")?.value else { return Err("no list".into()) };
/// let [Value::Scalar(number), Value::Scalar(text)] = [&items[0].value, &items[1].value] else { return Err("no scalars".into()) };
/// assert_eq!((number.text.as_str(), number.quoted), ("5", false));
/// assert_eq!((text.text.as_str(), text.quoted, text.as_number()), ("5", true, None));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct Scalar {
    /// What it says, escapes and line breaks resolved.
    pub text: String,
    /// Whether it was marked as text (quotes, `|`, `>`), so that it is no number even if it looks like one.
    pub quoted: bool,
    /// Where each of its bytes stands in the document.
    pub(crate) places: Places,
}

/// Where the bytes of a scalar's text stand in the document.
#[derive(Debug, Clone, PartialEq)]
pub(crate) enum Places {
    /// All in a row from here on.
    Row(usize),
    #[cfg_attr(
        not(feature = "yaml"),
        allow(dead_code, reason = "only text has escapes")
    )]
    /// Character by character, since escapes, line breaks and indentation are resolved in the text.
    Table(Vec<Letter>),
}

/// A character of a scalar's text: its first byte there, and its bytes in the document.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Letter {
    pub(crate) text: usize,
    pub(crate) document: Range<usize>,
}

impl Scalar {
    /// The bytes of the document that `part`, some bytes of this scalar's text, came from.
    ///
    /// # Example: behind an escape
    /// ```
    /// use fuzzy::tree::Value;
    ///
    /// let text = "rule: 'it''s on'";
    /// let tree = fuzzy::yaml::read(text)?;
    /// let Value::Mapping(entries) = &tree.value else { return Err("no mapping".into()) };
    /// let Value::Scalar(scalar) = &entries[0].1.value else { return Err("no scalar".into()) };
    /// assert_eq!(scalar.text, "it's on");
    /// assert_eq!(&text[scalar.span(5..7)], "on");
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    #[must_use]
    pub fn span(&self, part: Range<usize>) -> Range<usize> {
        match &self.places {
            Places::Row(start) => start + part.start..start + part.end,
            Places::Table(letters) => {
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
    /// Text, without a place.
    ///
    /// # Example
    /// ```
    /// use fuzzy::tree::Node;
    ///
    /// assert_eq!(fuzzy::yaml::to_text(&Node::text("5")), "\"5\"\n"); // quoted, so that it stays text
    /// ```
    pub fn text(text: impl Into<String>) -> Self {
        Self::scalar(text.into(), true)
    }

    /// A number, without a place.
    ///
    /// # Example
    /// ```
    /// use fuzzy::tree::Node;
    ///
    /// assert_eq!(fuzzy::yaml::to_text(&Node::number(5.0)), "5\n");
    /// ```
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

    /// A scalar, without a place.
    pub(crate) fn scalar(text: String, quoted: bool) -> Self {
        let places = Places::Row(0);
        Node {
            value: Value::Scalar(Scalar {
                text,
                quoted,
                places,
            }),
            span: 0..0,
        }
    }

    /// A list, without a place.
    ///
    /// # Example
    /// ```
    /// use fuzzy::tree::Node;
    ///
    /// assert_eq!(fuzzy::yaml::to_text(&Node::list(vec![])), "[]\n");
    /// ```
    #[must_use]
    pub fn list(items: Vec<Node>) -> Self {
        Node {
            value: Value::List(items),
            span: 0..0,
        }
    }

    /// A mapping, without a place.
    ///
    /// # Example
    /// ```
    /// use fuzzy::tree::Node;
    ///
    /// assert_eq!(fuzzy::yaml::to_text(&Node::mapping([("blades", Node::number(5.0))])), "blades: 5\n");
    /// ```
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
    ///
    /// # Example
    /// ```
    /// let tree = fuzzy::yaml::read("[~, 0]")?;
    /// let items = tree.items("the list", &mut Vec::new()).ok_or("no list")?;
    /// assert!(items[0].is_null() && !items[1].is_null());
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    #[must_use]
    pub fn is_null(&self) -> bool {
        matches!(&self.value, Value::Scalar(scalar) if scalar.is_null())
    }
}
