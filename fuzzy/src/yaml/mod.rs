//! Conversion between YAML text and [`Node`]s. This is the only module that uses the YAML library.
//!
//! The library is an event parser, not a deserializer: it reports every key, including repeated ones, with its span and
//! its style. A finding can therefore point to a wrong word in a rule in a folded scalar, and all findings of a file
//! are reported together. Aliases (`*name`) are expanded here within limits, so that small files cannot use much
//! memory.

use alloc::{boxed::Box, collections::BTreeMap, string::String, vec::Vec};
use core::{ops::Range, str::FromStr};

use granit_parser::{Event, Parser, ScalarStyle, Span};

use crate::{
    diagnostic::{Diagnostic, Findings},
    format::{self, Document},
    model::Model,
    tree::{Node, Offsets, Scalar, ScalarCharacter, Value},
};

mod cause;
mod foreign;
mod syntax;
#[cfg(test)]
mod tests;
mod write;

use syntax::{SyntaxError, syntax};
#[doc(hidden)]
pub use write::{to_line, to_text};

/// The maximum size of a text in bytes; larger texts are rejected. 100,000 short rules fit.
pub const LARGEST_BYTES: usize = 4_000_000;

/// The maximum nesting depth of lists and mappings; deeper nesting is an error.
const DEEPEST: usize = 64;

/// The maximum number of values that aliases may add to a document; more is an error. A scalar counts as one value for
/// itself and one for every 16 bytes of its text.
const MAX_FROM_ALIASES: usize = 100_000;

/// Parses one YAML document to a tree. It is public for the crate `flagred`, which parses its profiles with it; not
/// part of the API.
///
/// # Errors
/// The first syntax error; parsing stops there.
#[doc(hidden)]
pub fn read(text: &str) -> Result<Node, Findings> {
    if text.len() > LARGEST_BYTES {
        let message = alloc::format!("the text is larger than {} MB", LARGEST_BYTES / 1_000_000);
        let finding = Diagnostic::error("yaml-too-large", 0..0, message);
        let finding = finding.help("rule sets and profiles are small YAML files");
        return Err(Findings::locate(alloc::vec![finding], ""));
    }
    build(text).map_err(|error| {
        let finding = cause::cause(text)
            .or_else(|| cause::line(text, &error))
            .unwrap_or(error.finding);
        Findings::locate(alloc::vec![finding], text)
    })
}

/// The keys by which a text is recognised as a rule set.
#[doc(hidden)] // For the programs of this repository.
pub const KEYS_OF_RULES: [&str; 4] = ["fuzzy", "inputs", "outputs", "rules"];

/// Returns whether a line of a text begins with one of these keys.
#[doc(hidden)] // For the programs of this repository.
#[must_use]
pub fn has_key(text: &str, keys: &[&str]) -> bool {
    text.lines().any(|line| {
        let line = line.trim_start_matches([' ', '-', '{', '"', '\'']);
        keys.iter().any(|key| {
            let rest = line.strip_prefix(key);
            rest.is_some_and(|rest| rest.trim_start_matches(['"', '\'', ' ']).starts_with(':'))
        })
    })
}

/// Returns a finding if a text is recognised as a file of another program, or as another kind of file.
#[doc(hidden)] // For the programs of this repository.
#[must_use]
pub fn foreign(text: &str) -> Option<Diagnostic> {
    foreign::foreign(text)
}

/// Parses a rule set in YAML.
///
/// # Errors
/// All findings of the file, with line and column, if any of them is an error.
///
/// # Example
/// ```
/// let text = "
/// fuzzy: 1
/// name: kettle
/// inputs: {water: {range: [0, 100], unit: °C, partition: [cold, warm, hot]}}
/// outputs: {heat: {range: [0, 1], partition: [off, on]}}
/// rules:
///   - IF water IS hot THEN heat IS off
///   - IF water IS NOT hot THEN heat IS on
/// ";
/// let document = fuzzy::yaml::parse(text)?;
/// assert_eq!(document.model.rules.len(), 2);
/// assert_eq!(document.model.inputs[0].terms[2].name, "hot");
///
/// let mistakes = fuzzy::yaml::parse(&text.replace("IS hot", "IS hott")).unwrap_err();
/// assert_eq!(
///     mistakes.to_string(),
///     "7:17: error[unknown-term]: input `water` has no term `hott`\n  help: did you mean `hot`?"
/// );
/// # Ok::<(), fuzzy::diagnostic::Findings>(())
/// ```
pub fn parse(text: &str) -> Result<Document, Findings> {
    document(&read(text)?, text)
}

/// Reads the rule set from the tree of a text.
pub(crate) fn document(tree: &Node, text: &str) -> Result<Document, Findings> {
    match format::read(tree) {
        Ok(document) => Ok(Document {
            warnings: Findings::locate(document.warnings.0, text),
            ..document
        }),
        Err(findings) => {
            let mut findings = cause::cause(text).map_or(findings, |cause| alloc::vec![cause]);
            findings
                .iter_mut()
                .for_each(|finding| cause::comment(text, finding));
            Err(Findings::locate(findings, text))
        }
    }
}

/// Formats a rule set as YAML. [`parse`] reads the same model from it.
#[must_use]
pub fn to_string(model: &Model) -> String {
    to_text(&format::write(model))
}

impl FromStr for Model {
    type Err = Findings;

    /// Parses the model with [`parse`]; warnings are discarded.
    fn from_str(text: &str) -> Result<Self, Findings> {
        parse(text).map(|document| document.model)
    }
}

/// A list or mapping whose end has not been reached.
struct OpenCollection {
    start: usize,
    end: usize,
    anchor: usize,
    content: Content,
    /// The number of values in it, as [`MAX_FROM_ALIASES`] counts them.
    values: usize,
    /// The nesting depth of the values in it.
    depth: usize,
}

enum Content {
    List(Vec<Node>),
    Mapping(Vec<(Node, Node)>, Option<Node>),
}

/// A value, with the number of values in it and their nesting depth.
#[derive(Clone)]
struct SizedNode {
    node: Node,
    values: usize,
    depth: usize,
}

fn build(text: &str) -> Result<Node, Box<SyntaxError>> {
    let options = granit_parser::options! {
        flow_nesting_limit: DEEPEST,
        block_nesting_limit: DEEPEST,
    };
    let mut open: Vec<OpenCollection> = Vec::new();
    let mut anchors: BTreeMap<usize, SizedNode> = BTreeMap::new();
    let mut from_aliases = 0;
    let mut document = None;
    for event in Parser::new_from_str_with_options(text, options) {
        let (event, span) = event.map_err(|error| syntax(text, &error))?;
        let bytes = span.byte_range().unwrap_or(0..0);
        if document.is_some() && matches!(event, Event::DocumentStart(..)) {
            let from = bytes.start;
            let finding =
                Diagnostic::error("yaml-syntax", bytes, "a second YAML document begins here");
            let rest = text
                .get(from..)
                .unwrap_or("")
                .trim_start_matches('-')
                .trim_start();
            // A complete second file begins with the same key as the first one.
            let first_key = text.split(':').next().unwrap_or("");
            let is_complete = rest
                .strip_prefix(first_key)
                .is_some_and(|rest| rest.starts_with(':'));
            return Err(finding
                .help(match is_complete {
                    true => "a file can contain only one document: remove the line `---` and everything after it",
                    false => "a file can contain only one document: remove the line `---`",
                })
                .into());
        }
        let (done, anchor) = match event {
            Event::Scalar(value, style, anchor, tag) => {
                refuse_tag(&span, tag.is_some())?;
                let node = Node {
                    value: Value::Scalar(scalar(text, &value, style, &bytes)),
                    span: bytes,
                };
                let (values, depth) = (1 + value.len() / 16, 0);
                let done = SizedNode {
                    node,
                    values,
                    depth,
                };
                (done, anchor)
            }
            Event::SequenceStart(_, anchor, tag) => {
                refuse_tag(&span, tag.is_some())?;
                open.push(begin(&bytes, anchor, Content::List(Vec::new())));
                continue;
            }
            Event::MappingStart(_, anchor, tag) => {
                refuse_tag(&span, tag.is_some())?;
                open.push(begin(&bytes, anchor, Content::Mapping(Vec::new(), None)));
                continue;
            }
            Event::SequenceEnd | Event::MappingEnd => {
                let Some(mut ended) = open.pop() else {
                    continue;
                };
                // A flow collection ends with its bracket, a block collection with its last value.
                ended.end = ended.end.max(if bytes.is_empty() { 0 } else { bytes.end });
                let anchor = ended.anchor;
                (end(ended), anchor)
            }
            Event::Alias(id) => {
                let Some(target) = anchors.get(&id) else {
                    let message = "the alias is inside the value that it names";
                    let finding = Diagnostic::error("yaml-syntax", bytes, message);
                    return Err(finding.help("write the value out here").into());
                };
                from_aliases += target.values;
                let depth = target.depth + open.len();
                if from_aliases > MAX_FROM_ALIASES || depth > DEEPEST {
                    let message = alloc::format!(
                        "aliases expand to more than {MAX_FROM_ALIASES} values or more than {DEEPEST} levels of nesting"
                    );
                    let finding = Diagnostic::error("yaml-too-large", bytes, message);
                    let help = "write the values out, or use fewer aliases";
                    return Err(finding.help(help).into());
                }
                (target.clone(), 0)
            }
            _ => continue,
        };
        if anchor != 0 {
            anchors.insert(anchor, done.clone());
        }
        match open.last_mut() {
            Some(parent) => put(parent, done),
            None => document = Some(done.node),
        }
    }
    document.filter(|node| !node.is_null()).ok_or_else(|| {
        Diagnostic::error("empty-file", 0..0, "the file is empty")
            .help("write a rule set, which begins with `fuzzy: 1`")
            .into()
    })
}

fn begin(bytes: &Range<usize>, anchor: usize, content: Content) -> OpenCollection {
    OpenCollection {
        start: bytes.start,
        end: bytes.end,
        anchor,
        content,
        values: 1,
        depth: 0,
    }
}

fn end(ended: OpenCollection) -> SizedNode {
    let value = match ended.content {
        Content::List(items) => Value::List(items),
        Content::Mapping(entries, _) => Value::Mapping(entries),
    };
    SizedNode {
        node: Node {
            value,
            span: ended.start..ended.end,
        },
        values: ended.values,
        depth: ended.depth,
    }
}

fn put(parent: &mut OpenCollection, child: SizedNode) {
    parent.end = parent.end.max(child.node.span.end);
    parent.values += child.values;
    parent.depth = parent.depth.max(child.depth + 1);
    match &mut parent.content {
        Content::List(items) => items.push(child.node),
        Content::Mapping(entries, key) => match key.take() {
            Some(key) => entries.push((key, child.node)),
            None => *key = Some(child.node),
        },
    }
}

fn refuse_tag(span: &Span, tagged: bool) -> Result<(), Box<SyntaxError>> {
    if !tagged {
        return Ok(());
    }
    let tag = span.tag_span().unwrap_or(*span);
    let bytes = tag.byte_range().unwrap_or(0..0);
    let message = "this is a YAML tag, but tags are not supported";
    let finding = Diagnostic::error("yaml-syntax", bytes, message);
    Err(finding.help("remove the tag").into())
}

fn scalar(document: &str, value: &str, style: ScalarStyle, bytes: &Range<usize>) -> Scalar {
    let written = document.get(bytes.clone()).unwrap_or("");
    let inside = match style {
        ScalarStyle::SingleQuoted | ScalarStyle::DoubleQuoted => 1,
        _ => 0,
    };
    let in_a_row = written.get(inside..).is_some_and(|w| w.starts_with(value));
    let offsets = if in_a_row {
        Offsets::From(bytes.start + inside)
    } else {
        Offsets::Each(table(written, value, style, bytes.start))
    };
    // The YAML library reports a missing value after a key as `~` without a position.
    let text = if bytes.is_empty() { "" } else { value };
    Scalar {
        text: String::from(text),
        quoted: style != ScalarStyle::Plain,
        offsets,
    }
}

/// Returns the span of each character of a scalar's value. The value has the same characters as the written text,
/// except that folding changes white space, and that escapes are resolved in quoted text.
fn table(written: &str, value: &str, style: ScalarStyle, start: usize) -> Vec<ScalarCharacter> {
    let rest = |from: usize| written.get(from..).unwrap_or("");
    let quoted = matches!(style, ScalarStyle::SingleQuoted | ScalarStyle::DoubleQuoted);
    let mut here = usize::from(quoted);
    let mut letters = Vec::with_capacity(value.len());
    for (text, c) in value.char_indices() {
        if !c.is_whitespace() || is_escaped_break(rest(here), style) {
            here += blank(rest(here), style);
        }
        let first = rest(here).chars().next();
        let length = match (style, first) {
            (ScalarStyle::DoubleQuoted, Some('\\')) => escape(rest(here)),
            (ScalarStyle::SingleQuoted, Some('\'')) => 2,
            // White space whose written form differs because of folding gets an empty range.
            _ if c.is_whitespace() && first != Some(c) => 0,
            (_, first) => first.map_or(0, char::len_utf8),
        };
        let end = (here + length).min(written.len());
        let document = start + here..start + end;
        letters.push(ScalarCharacter { text, document });
        here = end;
    }
    letters
}

/// Returns the length of the white space at this position, including escaped line breaks.
fn blank(rest: &str, style: ScalarStyle) -> usize {
    let mut left = rest.trim_start();
    while is_escaped_break(left, style) {
        left = left.get(1..).unwrap_or("").trim_start();
    }
    rest.len() - left.len()
}

/// Returns whether there is an escaped line break in double quotes here: a backslash at the end of a line. YAML removes
/// the backslash, the line break and the following indentation.
fn is_escaped_break(rest: &str, style: ScalarStyle) -> bool {
    style == ScalarStyle::DoubleQuoted && (rest.starts_with("\\\n") || rest.starts_with("\\\r\n"))
}

/// Returns the length of the escape at this position in double quotes.
fn escape(rest: &str) -> usize {
    match rest.chars().nth(1) {
        Some('x') => 4,
        Some('u') => 6,
        Some('U') => 10,
        Some(other) => 1 + other.len_utf8(),
        None => 1,
    }
}
