//! The messages for syntax errors of the YAML library.

use alloc::{boxed::Box, format, string::String, vec::Vec};

use granit_parser::{ErrorKind, ScanError};

use super::{DEEPEST, KEYS_OF_RULES, has_key};
use crate::diagnostic::Diagnostic;

/// A syntax error, with the kind of error that the library reported; `None` for an error that this program detected.
pub(super) struct SyntaxError {
    pub(super) finding: Diagnostic,
    pub(super) kind: Option<ErrorKind>,
}

impl From<Diagnostic> for Box<SyntaxError> {
    fn from(finding: Diagnostic) -> Self {
        let kind = None;
        Box::new(SyntaxError { finding, kind })
    }
}

/// Returns the specific suggestion, which repeats words of the text, if the text is a rule set or a profile; otherwise the
/// general one. Any file can be named by mistake, for example one with secrets, whose words must not be repeated.
pub(super) fn specific_or(text: &str, specific: String, general: &str) -> String {
    match has_key(text, &KEYS_OF_RULES) {
        true => specific,
        false => general.into(),
    }
}

/// Returns the finding for an error of the YAML library.
pub(super) fn syntax(text: &str, error: &ScanError) -> Box<SyntaxError> {
    let at = error.marker().byte_offset().unwrap_or(text.len());
    let kind = error.kind();
    let finding = quotes(text, at, kind)
        .or_else(|| brackets(text, at, kind))
        .or_else(|| comma(text, at, kind))
        .or_else(|| of_one_word(text, at, kind));
    let finding = finding.unwrap_or_else(|| {
        let (message, help) = message(text, at, kind);
        finding_at(text, at, &message, help)
    });
    let kind = Some(kind.clone());
    Box::new(SyntaxError { finding, kind })
}

fn finding_at(text: &str, at: usize, message: &str, help: impl Into<String>) -> Diagnostic {
    let letter = text.get(at..).and_then(|rest| rest.chars().next());
    let span = at..at + letter.map_or(0, char::len_utf8);
    Diagnostic::error("yaml-syntax", span, message).help(help)
}

/// Returns the rest of the line at this position.
fn rest_of_line(text: &str, at: usize) -> &str {
    let rest = text.get(at..).unwrap_or("");
    rest.lines().next().unwrap_or("").trim_end()
}

/// Returns the suggestion for quotes around a part of a rule; the text in quotes ends before `at`.
fn in_rule(text: &str, at: usize) -> Option<&'static str> {
    let line = text.get(..at)?.rsplit('\n').next()?;
    let quoted = line.trim_start_matches([' ', '-']);
    let is_rule = quoted
        .get(1..4)
        .is_some_and(|word| word.eq_ignore_ascii_case("IF "));
    is_rule.then_some("remove the quotes, or put the whole rule in quotes")
}

/// Returns the finding for an error in a text in quotes.
fn quotes(text: &str, at: usize, kind: &ErrorKind) -> Option<Diagnostic> {
    match kind {
        ErrorKind::UnclosedQuotedScalar
        | ErrorKind::DocumentIndicatorInQuotedScalar
        | ErrorKind::InvalidQuotedScalarIndent => {
            let open = OpenDelimiters::before(text, at).quote?;
            let rest = rest_of_line(text, open);
            let quote = rest.get(..1)?;
            let help = match rest.contains([',', '}', ']', '#', ':']) {
                true => "add the closing quote".into(),
                false => specific_or(
                    text,
                    format!("write `{rest}{quote}`"),
                    "add the closing quote",
                ),
            };
            Some(finding_at(text, open, "the quote is never closed", help))
        }
        ErrorKind::InvalidTrailingSingleQuotedScalar => {
            let message = "there is text after the closing single quote";
            let help = in_rule(text, at).unwrap_or(
                "write `''` for an apostrophe in single quotes, or put the text in double quotes",
            );
            Some(finding_at(text, at, message, help))
        }
        ErrorKind::InvalidTrailingDoubleQuotedScalar => {
            let message = "there is text after the closing double quote";
            let help = in_rule(text, at).unwrap_or(
                "write `\\\"` for a quote in double quotes, or put the text in single quotes",
            );
            Some(finding_at(text, at, message, help))
        }
        ErrorKind::UnknownQuotedScalarEscape => {
            let rest = text.get(at..)?;
            let is_known = |c: char| "0abtnvfre\"/\\N_LPxuU \t\r\n".contains(c);
            let mut letters = rest.char_indices();
            let (escape, letter) = loop {
                let (at, letter) = letters.next()?;
                if letter == '\\' {
                    let (_, next) = letters.next()?;
                    if !is_known(next) {
                        break (at, next);
                    }
                }
            };
            let start = at + escape;
            let message = format!("`\\{letter}` is not an escape sequence in double quotes");
            let span = start..start + 1 + letter.len_utf8();
            let help = "write `\\\\` for a backslash, or put the text in single quotes";
            Some(Diagnostic::error("yaml-syntax", span, message).help(help))
        }
        _ => None,
    }
}

/// Returns the finding for a bracket that is not closed, or that is closed by a bracket of the other kind.
fn brackets(text: &str, at: usize, kind: &ErrorKind) -> Option<Diagnostic> {
    let in_brackets = matches!(
        kind,
        ErrorKind::MismatchedFlowCollectionEnd { .. }
            | ErrorKind::UnclosedFlowCollection { .. }
            | ErrorKind::InvalidColonPlacement
            | ErrorKind::ExpectedFlowMappingSeparator
            | ErrorKind::ExpectedFlowSequenceSeparator
            | ErrorKind::UnexpectedEofFlowMapping
            | ErrorKind::UnexpectedEofFlowSequence
            | ErrorKind::UnexpectedEofImplicitFlowMapping
            | ErrorKind::BlockEntryInFlowCollection
            | ErrorKind::InvalidFlowScalarIndent
    );
    if !in_brackets {
        return None;
    }
    let open = match kind {
        ErrorKind::MismatchedFlowCollectionEnd { .. }
        | ErrorKind::UnclosedFlowCollection { .. }
            if text
                .get(at..)
                .is_some_and(|rest| rest.starts_with(['[', '{'])) =>
        {
            at
        }
        _ => *OpenDelimiters::before(text, at).brackets.last()?,
    };
    let is_here = !text.get(open..at)?.contains('\n');
    let is_open = matches!(
        kind,
        ErrorKind::MismatchedFlowCollectionEnd { .. } | ErrorKind::UnclosedFlowCollection { .. }
    );
    if is_here && !is_open {
        return None;
    }
    let (bracket, closing) = match text.get(open..)?.starts_with('[') {
        true => ('[', ']'),
        false => ('{', '}'),
    };
    let message = format!("the bracket `{bracket}` is never closed");
    Some(finding_at(
        text,
        open,
        &message,
        format!("add the closing bracket `{closing}`"),
    ))
}

/// Returns the finding for a missing comma, as in `{cold: 10 mild: 20}`.
fn comma(text: &str, at: usize, kind: &ErrorKind) -> Option<Diagnostic> {
    if !matches!(
        kind,
        ErrorKind::InvalidColonPlacement
            | ErrorKind::ExpectedFlowMappingSeparator
            | ErrorKind::ExpectedFlowSequenceSeparator
    ) {
        return None;
    }
    let before = text.get(..at)?;
    let from = before.rfind(['\n', ',', '{', '['])? + 1;
    let (value, key) = before.get(from..)?.rsplit_once(' ')?;
    let is_word = |c: char| c.is_alphanumeric() || c == '_';
    if !value.contains(": ") || key.is_empty() || !key.chars().all(is_word) {
        return None;
    }
    let span = at - key.len()..at;
    let finding = Diagnostic::error("yaml-syntax", span, "a comma is missing before this key");
    Some(finding.help("write a comma between the entries"))
}

/// Returns the finding for an error that a single word causes.
fn of_one_word(text: &str, at: usize, kind: &ErrorKind) -> Option<Diagnostic> {
    let rest = rest_of_line(text, at);
    match kind {
        ErrorKind::UnknownAnchor => {
            let end = rest.find([' ', ',', ']', '}']).unwrap_or(rest.len());
            let name = rest.get(1..end)?;
            let help = "write the value here, or define the alias before it is used";
            let specific = format!(
                "write the value here, or mark the intended value with the anchor `&{name}`"
            );
            let help = specific_or(text, specific, help);
            let span = at..at + end;
            Some(Diagnostic::error("yaml-syntax", span, "this alias has no anchor").help(help))
        }
        ErrorKind::MissingAnchorOrAliasName if rest.starts_with('*') => {
            let message = "a list entry must begin with `-`, not `*`";
            Some(finding_at(text, at, message, "write `-` in place of `*`"))
        }
        ErrorKind::UnexpectedCharacter { character } => {
            let end = rest.find([',', ']', '}', '#']).unwrap_or(rest.len());
            let word = rest.get(..end)?.trim_end();
            let message = format!("text without quotes cannot begin with `{character}`");
            // For example `risk: >67`.
            let number = word.trim_start_matches(['>', '=', ' ']);
            let specific = match number.parse::<f64>() {
                Ok(_) => format!("write only the number: `{number}`"),
                Err(_) => format!("put it in quotes: `\"{word}\"`"),
            };
            let help = specific_or(text, specific, "put it in quotes");
            Some(finding_at(text, at, &message, help))
        }
        _ => None,
    }
}

/// Returns the message and the suggestion for all other errors.
fn message(text: &str, at: usize, kind: &ErrorKind) -> (String, &'static str) {
    let content = rest_of_line(text, at);
    let (message, help) = match kind {
        ErrorKind::TabInBlockIndentation
        | ErrorKind::TabInIndentation
        | ErrorKind::TabAtBlockScalarStart => {
            ("the line is indented with a tab", "indent with spaces")
        }
        ErrorKind::TabNotAllowed | ErrorKind::TabInPlainScalar => (
            "a tab is not allowed here",
            "write spaces in place of the tab",
        ),
        ErrorKind::MappingValueNotAllowed => (
            "unexpected `: `",
            "if it is part of a text value, put the whole text in quotes; if it follows a key, begin the key in the same column as the keys above",
        ),
        ErrorKind::ExpectedBlockSequenceEntry => match content.ends_with(':') {
            true => (
                "this name has no `-` before it, but the name above has one",
                "remove the `-` before the name above, and indent the keys under each name: inputs, outputs and blocks have no `-`",
            ),
            false => (
                "this entry has no `-` before it, but the entry above has one",
                "begin each entry of a list with `-`",
            ),
        },
        ErrorKind::RecursionLimitExceeded => {
            let message = format!("lists and mappings are nested more than {DEEPEST} levels deep");
            return (message, "a rule set needs only a few levels");
        }
        ErrorKind::InvalidColonPlacement => (
            "unexpected `:`",
            "look for a missing comma or bracket before this point",
        ),
        ErrorKind::ExpectedFlowMappingSeparator => (
            "expected `,` or `}`",
            "look for a missing comma or bracket before this point",
        ),
        ErrorKind::ExpectedFlowSequenceSeparator => (
            "expected `,` or `]`",
            "look for a missing comma or bracket before this point",
        ),
        ErrorKind::MisplacedFlowCollectionEnd => (
            "this bracket closes nothing",
            "remove it, or add the opening bracket",
        ),
        ErrorKind::BlockEntryInFlowCollection => (
            "`-` does not begin an entry within brackets",
            "separate the entries by commas: `[a, b]`",
        ),
        ErrorKind::BlockSequenceEntryNotAllowed => (
            "a list cannot begin here",
            "begin the list on the next line",
        ),
        ErrorKind::InvalidIndentation => (
            "the line begins in the column of no line above it",
            "begin all keys of a mapping in the same column",
        ),
        ErrorKind::CommentNotSeparated => (
            "a space is missing before `#`",
            "write a space before `#`, which begins a comment",
        ),
        _ => (
            "this is not valid YAML",
            "check the indentation, and the quotes and brackets before this point",
        ),
    };
    (message.into(), help)
}

/// The brackets and the quote that are open at a position.
#[derive(Default)]
struct OpenDelimiters {
    brackets: Vec<usize>,
    quote: Option<usize>,
}

impl OpenDelimiters {
    /// Returns the brackets and the quote that are open before `end`.
    fn before(text: &str, end: usize) -> OpenDelimiters {
        let mut open = OpenDelimiters::default();
        // A quote or a bracket in the middle of a word has no meaning.
        let mut begins = true;
        let mut letters = text
            .char_indices()
            .take_while(|(at, _)| *at < end)
            .peekable();
        while let Some((at, letter)) = letters.next() {
            if let Some(start) = open.quote {
                let is_double = text.get(start..).is_some_and(|rest| rest.starts_with('"'));
                match letter {
                    '\\' if is_double => drop(letters.next()),
                    '"' if is_double => open.quote = None,
                    '\'' if !is_double => match letters.peek() {
                        Some((_, '\'')) => drop(letters.next()),
                        _ => open.quote = None,
                    },
                    _ => {}
                }
                continue;
            }
            match letter {
                '"' | '\'' if begins => open.quote = Some(at),
                '#' if begins => while letters.next_if(|(_, letter)| *letter != '\n').is_some() {},
                '[' | '{' if begins || !open.brackets.is_empty() => open.brackets.push(at),
                ']' | '}' => drop(open.brackets.pop()),
                _ => {}
            }
            begins = letter.is_whitespace() || matches!(letter, '[' | '{' | ',');
        }
        open
    }
}
