//! Findings in a text, drawn as a compiler draws them.

use std::{
    borrow::Cow,
    cmp::Reverse,
    fs,
    io::{self, Read, Write},
    ops::Range,
    path::Path,
};

use annotate_snippets::{AnnotationKind, Group, Level, Origin, Renderer, Snippet};
use fuzzy::{
    diagnostic::{Diagnostic, Findings, Severity},
    drawing::{visible, visible_lines},
    yaml::LARGEST_BYTES,
};

use crate::failure::Failure;

/// Findings that are drawn of a file, errors first; the others are counted.
const MOST_DRAWN: usize = 100;

/// Draws findings with their lines. `colored` text goes through `anstream`, which drops colours that a terminal lacks.
pub(crate) fn draw(findings: &[Diagnostic], file: &str, text: &str, colored: bool) -> String {
    let renderer = if colored {
        Renderer::styled()
    } else {
        Renderer::plain()
    };
    let (shown_file, shown_text) = (visible(file), visible_lines(text));
    let is_same = matches!(shown_text, Cow::Borrowed(_));
    let mut first: Vec<&Diagnostic> = findings.iter().collect();
    if first.len() > MOST_DRAWN {
        first.sort_by_key(|finding| Reverse(finding.severity));
        first.truncate(MOST_DRAWN);
        first.sort_by_key(|finding| finding.span.start);
    }
    let drawn = first.into_iter().map(|finding| {
        let finding = shown(finding, text, is_same);
        renderer.render(&report(&finding, &shown_file, &shown_text))
    });
    let mut drawn = drawn.collect::<Vec<_>>().join("\n\n");
    if !drawn.is_empty() {
        drawn.push('\n');
    }
    if findings.len() > MOST_DRAWN {
        let more = findings.len() - MOST_DRAWN;
        drawn += &format!("\nand {more} more findings; `flagred check --json` lists them\n");
    }
    drawn
}

/// A finding in the text as it is shown, which may be the same.
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

fn report<'a>(finding: &'a Diagnostic, file: &'a str, text: &'a str) -> Vec<Group<'a>> {
    let level = match finding.severity {
        Severity::Error => Level::ERROR,
        Severity::Warning => Level::WARNING,
        Severity::Note => Level::NOTE,
    };
    let inside = |span: &Range<usize>| {
        let end = span.end.min(text.len());
        span.start.min(end)..end
    };
    let related = finding.related.iter().map(|related| {
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
    let mut group = match is_meant_as_rules(text) {
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
    if let Some(command) = command(finding.code) {
        group = group.element(Level::HELP.message(command));
    }
    vec![group]
}

/// Whether a text is a rule set of another program, or a line of it begins with a key that only rule sets and profiles have.
/// No other file is quoted: it may hold secrets, and be named by somebody else.
pub(crate) fn is_meant_as_rules(text: &str) -> bool {
    let mut lines = text.lines();
    interchange::Format::of(text).is_some()
        || lines.any(|line| {
            let line = line.trim_start_matches([' ', '-', '{', '"', '\'']);
            ["fuzzy", "flagred", "inputs", "outputs", "rules"]
                .iter()
                .any(|key| {
                    let rest = line.strip_prefix(key);
                    rest.is_some_and(|rest| {
                        rest.trim_start_matches(['"', '\'', ' ']).starts_with(':')
                    })
                })
        })
}

/// The command that helps with a finding: the engine knows no commands.
fn command(code: &str) -> Option<&'static str> {
    match code {
        "empty-file" => Some("`flagred new NAME` writes a rule set to start from"),
        "no-rules" => Some("`flagred learn` writes rules from data"),
        "several-blocks" => Some("`flagred import --block NAME` writes one in YAML"),
        "not-monotone" => Some("`flagred explain` shows the rules that fire at a point"),
        _ => None,
    }
}

/// Draws findings on standard error.
pub(crate) fn show(findings: &Findings, file: &str, text: &str) {
    let mut err = anstream::stderr().lock();
    // Nothing is left to tell a user whose standard error is closed.
    let _ = write!(err, "{}", draw(&findings.0, file, text, true));
}

/// Draws the findings that make a file unusable on standard error, and returns the exit code.
pub(crate) fn refuse(findings: &Findings, file: &str, text: &str) -> Failure {
    show(findings, file, text);
    Failure::shown(3)
}

/// Reads a rule set or a profile, or standard input for `-`.
pub(crate) fn read_text(path: &Path) -> Result<String, Failure> {
    let shown = path.display();
    let bytes = if path == Path::new("-") {
        read_up_to_limit(io::stdin().lock())
    } else {
        fs::File::open(path).and_then(read_up_to_limit)
    };
    let bytes = bytes.map_err(|error| {
        Failure::unreadable(format!("`{shown}` cannot be read: {error}")).help("check the path")
    })?;
    if bytes.len() > LARGEST_BYTES {
        let limit = LARGEST_BYTES / 1_000_000;
        return Err(
            Failure::unreadable(format!("`{shown}` is larger than {limit} MB"))
                .help("rule sets and profiles are small YAML files"),
        );
    }
    decoded(bytes).map_err(|error| error.failure(&shown.to_string()))
}

/// Why bytes are no text.
struct NoText {
    /// The line that holds the first byte that is none, and the byte; `None` in UTF-16.
    at: Option<(usize, u8)>,
}

impl NoText {
    fn failure(&self, file: &str) -> Failure {
        let failure = Failure::unreadable(match self.at {
            Some((line, byte)) => {
                format!("`{file}` is not UTF-8: line {line} holds the byte {byte:02X}")
            }
            None => format!("`{file}` is not UTF-16, which its first two bytes announce"),
        });
        failure.help(match self.at {
            // A control character in Latin-1, and so hardly a text in it.
            Some((_, byte)) if byte >= 0xa0 => {
                let letter = char::from(byte);
                format!("it may be Latin-1, where the byte is `{letter}`; save the file as UTF-8")
            }
            _ => String::from("save the file as UTF-8"),
        })
    }
}

/// The text of a file: UTF-8, or UTF-16 behind a byte order mark.
fn decoded(bytes: Vec<u8>) -> Result<String, NoText> {
    let low_first = match bytes.get(..2) {
        Some([0xff, 0xfe]) => true,
        Some([0xfe, 0xff]) => false,
        _ => {
            return String::from_utf8(bytes).map_err(|error| {
                let good = error.utf8_error().valid_up_to();
                let bytes = error.as_bytes();
                let lines = bytes
                    .iter()
                    .take(good)
                    .filter(|byte| **byte == b'\n')
                    .count();
                NoText {
                    at: bytes.get(good).map(|byte| (lines + 1, *byte)),
                }
            });
        }
    };
    let (units, rest) = bytes.get(2..).unwrap_or_default().as_chunks::<2>();
    let unit = |&[first, second]: &[u8; 2]| {
        let (low, high) = if low_first {
            (first, second)
        } else {
            (second, first)
        };
        u16::from(high) << 8 | u16::from(low)
    };
    let units: Vec<u16> = units.iter().map(unit).collect();
    match String::from_utf16(&units) {
        Ok(text) if rest.is_empty() => Ok(text),
        _ => Err(NoText { at: None }),
    }
}

/// All bytes, or one more than are allowed.
fn read_up_to_limit(source: impl Read) -> io::Result<Vec<u8>> {
    let mut bytes = Vec::new();
    source
        .take(LARGEST_BYTES as u64 + 1)
        .read_to_end(&mut bytes)?;
    Ok(bytes)
}
