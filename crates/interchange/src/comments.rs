//! Comments that are kept: the comment at the start of a text becomes the description, and the comment after a rule on
//! its line becomes the rule's note.

use fuzzy::{format::Spans, model::Model};

/// The start of a comment, and its end if it may end before the line does.
const MARKS: [(&str, &str); 5] = [("#", ""), ("%", ""), ("//", ""), ("/*", "*/"), ("(*", "*)")];

/// The comment at the start of a text, and the rest after it.
fn first(text: &str) -> Option<(&str, &str)> {
    let (open, close) = MARKS.iter().find(|(open, _)| text.starts_with(open))?;
    let inner = text.get(open.len()..)?;
    let end = match close.is_empty() {
        true => inner.find('\n').unwrap_or(inner.len()),
        false => inner.find(close).unwrap_or(inner.len()),
    };
    let after = inner.get(end..)?;
    Some((
        inner.get(..end)?,
        after.strip_prefix(close).unwrap_or(after),
    ))
}

fn is_space(c: char) -> bool {
    c.is_whitespace() || c == '\u{feff}'
}

/// The text after the comments at its start.
pub(crate) fn after_comments(text: &str) -> &str {
    let mut rest = text.trim_start_matches(is_space);
    while let Some((_, after)) = first(rest) {
        rest = after.trim_start_matches(is_space);
    }
    rest
}

/// Stores the comments of a text in the model that was read from it.
pub(crate) fn keep(text: &str, model: &mut Model, spans: &Spans) {
    let mut rest = text.trim_start_matches(is_space);
    let mut lines = vec![];
    while let Some((comment, after)) = first(rest) {
        lines.push(comment);
        rest = after.trim_start_matches(is_space);
    }
    let leading = plain(&lines.join("\n"));
    if model.description.is_none() && !leading.is_empty() {
        model.description = Some(leading);
    }
    for (rule, spans) in model.rules.iter_mut().zip(&spans.rules) {
        let line = text
            .get(spans.whole.end..)
            .and_then(|rest| rest.lines().next());
        let behind = line.map(|line| line.trim_start_matches([' ', '\t', ';']));
        let note = behind.and_then(first).map(|(comment, _)| plain(comment));
        rule.note = note.filter(|note| !note.is_empty());
    }
}

/// The text of a comment on one line, without comment marks, lines of dashes or similar characters, and generated lines
/// such as `$Revision`.
fn plain(comment: &str) -> String {
    let lines = comment
        .lines()
        .map(|line| line.trim_matches(|c: char| is_space(c) || "#%*/=-".contains(c)));
    let lines = lines.filter(|line| {
        !line.starts_with("$Revision") && !line.starts_with("Code automatically generated")
    });
    let words = lines.flat_map(str::split_whitespace);
    words.collect::<Vec<_>>().join(" ")
}
