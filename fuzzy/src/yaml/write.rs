//! A tree as YAML: short lists and mappings on one line, long ones in a block.

use alloc::string::String;

use crate::tree::{Node, Scalar, Value};

/// Lines that would grow longer than this are broken into a block.
const LINE_WIDTH: usize = 110;

/// The tree as YAML text; reading it again gives the same tree but for the places.
#[must_use]
pub fn to_text(node: &Node) -> String {
    let mut text = String::new();
    block(&mut text, node, 0);
    text
}

/// The tree on one line, as it stands behind a key.
#[must_use]
pub fn to_line(node: &Node) -> String {
    let mut line = String::new();
    flow(&mut line, node);
    line
}

/// Writes what stands behind `key:` or `-`, with the line break behind it.
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

/// Writes a value behind its key: on the same line where it fits, below otherwise.
fn nested(out: &mut String, node: &Node, indent: usize, deeper: usize) {
    let mut line = String::new();
    flow(&mut line, node);
    let is_leaf = match &node.value {
        Value::Scalar(_) => true,
        Value::List(items) => items.is_empty(),
        Value::Mapping(entries) => entries.is_empty(),
    };
    // The top of a file is always a block: that is what people expect of a rule set.
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
            // Line and paragraph separators and the byte order mark would be read as layout.
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

/// Whether text can stand without quotes: words that neither YAML nor an older YAML takes for something else.
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
