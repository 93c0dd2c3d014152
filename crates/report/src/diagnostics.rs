//! Displays findings in a text, in the style of a compiler.

use std::{borrow::Cow, cmp::Reverse, ops::Range};

use annotate_snippets::{AnnotationKind, Group, Level, Origin, Renderer, Snippet};
use fuzzy::{
    diagnostic::{Diagnostic, Severity},
    drawing::{visible, visible_lines},
};

/// The maximum number of bytes between two locations of one finding on the same line.
const MAX_BETWEEN: usize = 1000;

/// The maximum number of findings that are displayed for a file, errors first; further findings are
/// counted.
const MAX_DRAWN: usize = 100;

/// Options for displaying findings.
#[derive(Debug, Clone, Copy)]
pub struct Style {
    /// Whether to use the colours of a terminal.
    pub colored: bool,
    /// Returns the calling program's advice for findings with a code, if there is any.
    pub advice: fn(&str) -> Option<&'static str>,
    /// Where to find all findings, if there are too many to display.
    pub all: &'static str,
    /// Whether a text is a rule set or a profile. Other files are not quoted, because they may contain secrets.
    pub is_quoted: fn(&str) -> bool,
}

/// Displays findings with their lines.
///
/// # Example
/// ```
/// use flagred_report::diagnostics::{Style, draw};
///
/// let text = "fuzzy: 1\nnam: kettle\n";
/// let findings = fuzzy::yaml::parse(text).unwrap_err();
/// let style = Style { colored: false, advice: |_| None, all: "", is_quoted: |_| true };
/// assert!(draw(&findings.0, "kettle.yaml", text, style).contains("--> kettle.yaml:2:1"));
/// ```
#[must_use]
pub fn draw(findings: &[Diagnostic], file: &str, text: &str, style: Style) -> String {
    let renderer = if style.colored {
        Renderer::styled()
    } else {
        Renderer::plain()
    };
    let (shown_file, shown_text) = (visible(file), visible_lines(text));
    let is_same = matches!(shown_text, Cow::Borrowed(_));
    let mut first: Vec<&Diagnostic> = findings.iter().collect();
    if first.len() > MAX_DRAWN {
        first.sort_by_key(|finding| Reverse(finding.severity));
        first.truncate(MAX_DRAWN);
        first.sort_by_key(|finding| finding.span.start);
    }
    let drawn = first.into_iter().map(|finding| {
        let finding = shown(finding, text, is_same);
        renderer.render(&report(&finding, &shown_file, &shown_text, style))
    });
    let mut drawn = drawn.collect::<Vec<_>>().join("\n\n");
    if !drawn.is_empty() {
        drawn.push('\n');
    }
    if findings.len() > MAX_DRAWN {
        let more = findings.len() - MAX_DRAWN;
        drawn += &format!("\nand {more} more findings; {}\n", style.all);
    }
    drawn
}

/// A finding with its locations in the displayed text; `is_same` is true if the displayed text equals `text`. Hidden
/// characters in the finding's messages are made visible.
fn shown(finding: &Diagnostic, text: &str, is_same: bool) -> Diagnostic {
    let at = |offset: usize| match text.get(..offset) {
        Some(before) if !is_same => visible_lines(before).len(),
        _ => offset,
    };
    let moved = |span: &Range<usize>| at(span.start)..at(span.end);
    let mut shown = finding.clone();
    shown.span = moved(&shown.span);
    shown.message = visible(&shown.message).into_owned();
    shown.help = shown.help.map(|help| visible(&help).into_owned());
    for related in &mut shown.related {
        related.span = moved(&related.span);
        related.message = visible(&related.message).into_owned();
    }
    shown
}

fn report<'a>(
    finding: &'a Diagnostic,
    file: &'a str,
    text: &'a str,
    style: Style,
) -> Vec<Group<'a>> {
    let level = match finding.severity {
        Severity::Error => Level::ERROR,
        Severity::Warning => Level::WARNING,
        Severity::Note => Level::NOTE,
    };
    let inside = |span: &Range<usize>| {
        let end = span.end.min(text.len());
        span.start.min(end)..end
    };
    let near = finding
        .related
        .iter()
        .filter(|related| is_drawn_with(text, &finding.span, &related.span));
    let related = near.map(|related| {
        AnnotationKind::Context
            .span(inside(&related.span))
            .label(related.message.as_str())
    });
    let snippet = Snippet::source(text)
        .path(file)
        .annotation(AnnotationKind::Primary.span(inside(&finding.span)))
        .annotations(related);
    let title = level
        .primary_title(finding.message.as_str())
        .id(finding.code);
    let mut group = match (style.is_quoted)(text) {
        true => title.element(snippet),
        false => {
            let before = text.get(..finding.span.start).unwrap_or(text);
            let column = before.chars().rev().take_while(|c| *c != '\n').count() + 1;
            let origin = Origin::path(file).line(before.matches('\n').count() + 1);
            title.element(origin.char_column(column))
        }
    };
    if let Some(help) = &finding.help {
        group = group.element(Level::HELP.message(help.as_str()));
    }
    if let Some(advice) = (style.advice)(finding.code) {
        group = group.element(Level::HELP.message(advice));
    }
    vec![group]
}

/// Whether a second location can be displayed: if it is far away on the same line, all the text between the two would
/// be displayed too.
fn is_drawn_with(text: &str, first: &Range<usize>, second: &Range<usize>) -> bool {
    let (from, to) = (first.end.min(second.end), first.start.max(second.start));
    to.saturating_sub(from) <= MAX_BETWEEN
        || text
            .get(from..to)
            .is_none_or(|between| between.contains('\n'))
}
