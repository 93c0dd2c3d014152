//! Writing a tree as YAML: short lists and mappings on one line, long ones as blocks.

use alloc::string::String;

use crate::tree::{Node, Scalar, Value};

/// The maximum length of a line; longer lists and mappings are written as blocks.
const LINE_WIDTH: usize = 110;

/// Formats the tree as YAML text. Parsing it gives the same tree, except for the positions.
#[must_use]
pub fn to_text(node: &Node) -> String {
    let mut text = String::new();
    block(&mut text, node, 0);
    text
}

/// Formats the tree on one line, as the value of a key.
#[must_use]
pub fn to_line(node: &Node) -> String {
    let mut line = String::new();
    flow(&mut line, node);
    line
}

/// Writes the value after `key:` or `-`, including the line break.
fn block(out: &mut String, node: &Node, indent: usize) {
    match &node.value {
        Value::List(items) if !items.is_empty() => {
            for item in items {
                pad(out, indent);
                out.push('-');
                nested(out, item, indent, indent + 2);
            }
        }
        Value::Mapping(entries) if !entries.is_empty() => {
            for (key, value) in entries {
                pad(out, indent);
                flow(out, key);
                out.push(':');
                nested(out, value, indent, indent + 2);
            }
        }
        _ => {
            pad(out, indent);
            flow(out, node);
            out.push('\n');
        }
    }
}

/// Writes a value after its key: on the same line if it fits, otherwise below.
fn nested(out: &mut String, node: &Node, indent: usize, deeper: usize) {
    let mut line = String::new();
    flow(&mut line, node);
    let is_leaf = match &node.value {
        Value::Scalar(_) => true,
        Value::List(items) => items.is_empty(),
        Value::Mapping(entries) => entries.is_empty(),
    };
    // The values of top-level keys are written as blocks, as readers expect of a rule set, except lists of numbers.
    let fits =
        indent > 0 || matches!(&node.value, Value::List(items) if items.iter().all(is_number));
    if is_leaf || (fits && indent + line.len() < LINE_WIDTH && !line.contains('\n')) {
        out.push(' ');
        out.push_str(&line);
        out.push('\n');
    } else {
        out.push('\n');
        block(out, node, deeper);
    }
}

fn is_number(node: &Node) -> bool {
    matches!(&node.value, Value::Scalar(scalar) if scalar.as_number().is_some())
}

/// Writes a value on one line.
fn flow(out: &mut String, node: &Node) {
    match &node.value {
        Value::Scalar(scalar) => plain_or_quoted(out, scalar),
        Value::List(items) => {
            out.push('[');
            for (i, item) in items.iter().enumerate() {
                if i > 0 {
                    out.push_str(", ");
                }
                flow(out, item);
            }
            out.push(']');
        }
        Value::Mapping(entries) => {
            out.push('{');
            for (i, (key, value)) in entries.iter().enumerate() {
                if i > 0 {
                    out.push_str(", ");
                }
                flow(out, key);
                out.push_str(": ");
                flow(out, value);
            }
            out.push('}');
        }
    }
}

fn plain_or_quoted(out: &mut String, scalar: &Scalar) {
    let text = scalar.text.as_str();
    if !scalar.quoted || is_safe(text) {
        out.push_str(if text.is_empty() { "~" } else { text });
        return;
    }
    out.push('"');
    for c in text.chars() {
        match c {
            '"' => out.push_str("\\\""),
            '\\' => out.push_str("\\\\"),
            '\n' => out.push_str("\\n"),
            '\t' => out.push_str("\\t"),
            '\r' => out.push_str("\\r"),
            // Line and paragraph separators and the byte order mark would be parsed as layout.
            c if c.is_control()
                || matches!(
                    c,
                    '\u{2028}' | '\u{2029}' | '\u{feff}' | '\u{fffe}' | '\u{ffff}'
                ) =>
            {
                let code = u32::from(c);
                out.push_str(&alloc::format!("\\U{code:08X}"));
            }
            c => out.push(c),
        }
    }
    out.push('"');
}

/// Returns whether text needs no quotes: it must not be a word that YAML or an older version of YAML interprets
/// differently.
fn is_safe(text: &str) -> bool {
    let words = ["true", "false", "null", "yes", "no", "on", "off", "y", "n"];
    text.starts_with(|c: char| c.is_alphabetic() || c == '_')
        && !text.ends_with(' ')
        && text.chars().all(|c| {
            c.is_alphanumeric() || matches!(c, '_' | ' ' | '.' | '-' | '(' | ')' | '%' | '/' | '"')
        })
        && !words.iter().any(|word| word.eq_ignore_ascii_case(text))
}

fn pad(out: &mut String, indent: usize) {
    out.extend(core::iter::repeat_n(' ', indent));
}
