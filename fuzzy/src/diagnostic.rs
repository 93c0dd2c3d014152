//! Findings: problems in a text, each with its position and a suggestion.

use alloc::{
    borrow::Cow,
    format,
    string::{String, ToString},
    vec::Vec,
};
use core::{fmt, ops::Range};

use crate::foreign;

/// A finding: a problem in a text that an author wrote.
///
/// Messages start in lower case, do not end with a full stop, and quote the author's words in backticks. Suggestions
/// are separate, in `help`.
///
/// # Example: create and locate a finding
/// ```
/// use fuzzy::diagnostic::Diagnostic;
///
/// let finding = Diagnostic::warning("no-fuel", 4..8, "the tank `main` is empty")
///     .help("fill it, or take `spare`")
///     .related(0..3, "named here first");
/// assert_eq!(
///     finding.to_string(),
///     "warning[no-fuel]: the tank `main` is empty\n  help: fill it, or take `spare`"
/// );
/// assert_eq!(finding.related[0].span, 0..3);
/// ```
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[non_exhaustive]
pub struct Diagnostic {
    /// The severity.
    pub severity: Severity,
    /// A stable identifier, such as `unknown-term`.
    pub code: &'static str,
    /// The description of the problem.
    pub message: String,
    /// The byte range of the problem in the text; `0..0` for models built in code.
    pub span: Range<usize>,
    /// The line and column of the start of the span, if the text is known.
    pub position: Option<Position>,
    /// A suggestion for how to fix the problem.
    pub help: Option<String>,
    /// Other positions that explain the problem.
    pub related: Vec<RelatedSpan>,
}

/// The severity of a finding.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[cfg_attr(feature = "serde", serde(rename_all = "lowercase"))]
pub enum Severity {
    /// The finding is for information only; the model may be as intended.
    Note,
    /// The model works, but probably not as intended.
    Warning,
    /// The model cannot be used.
    Error,
}

/// Another position that explains a finding, such as the first of two equal names.
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[non_exhaustive]
pub struct RelatedSpan {
    /// The byte range in the text.
    pub span: Range<usize>,
    /// The explanation for this position.
    pub message: String,
}

/// A line and a column in a text. Both start at 1; the column counts characters.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Position {
    /// The line number.
    #[cfg_attr(feature = "schema", schemars(range(min = 1)))]
    pub line: usize,
    /// The number of the character in the line.
    #[cfg_attr(feature = "schema", schemars(range(min = 1)))]
    pub column: usize,
}

impl Position {
    /// Returns the position of a byte in a text; bytes after the end count as the end.
    #[must_use]
    pub fn of(text: &str, byte: usize) -> Self {
        let before = text.char_indices().take_while(|&(at, _)| at < byte);
        before.fold(Position { line: 1, column: 1 }, |here, (_, c)| {
            if c == '\n' {
                Position {
                    line: here.line + 1,
                    column: 1,
                }
            } else {
                Position {
                    line: here.line,
                    column: here.column + 1,
                }
            }
        })
    }
}

/// The maximum number of characters of a text that a message quotes.
const LONGEST_QUOTE: usize = 60;

/// The maximum number of characters of a text that a suggestion quotes; it is larger because the text may be a line to
/// insert.
const LONGEST_ADVICE: usize = 200;

/// Shortens a text from the input to quote it in a message: at most 60 characters followed by `...`.
///
/// ```
/// let digits = "1".repeat(1000);
/// assert_eq!(fuzzy::diagnostic::quoted(&digits).len(), 63);
/// assert_eq!(fuzzy::diagnostic::quoted("warm"), "warm");
/// ```
pub fn quoted(text: &str) -> Cow<'_, str> {
    cut(text, LONGEST_QUOTE)
}

fn cut(text: &str, most: usize) -> Cow<'_, str> {
    match text.char_indices().nth(most) {
        Some((end, _)) => Cow::Owned(format!("{}...", text.get(..end).unwrap_or_default())),
        None => Cow::Borrowed(text),
    }
}

/// Shortens the parts of a message that are quoted in backticks. A quoted text may contain backticks itself, so the
/// parts between the quotes are limited as well.
fn shortened(message: String, most: usize) -> String {
    const LONGEST_WORDS: usize = 1000;
    if message.len() <= most {
        return message;
    }
    let parts = message.split('`').enumerate();
    let parts = parts.map(|(i, part)| match i % 2 {
        0 => cut(part, LONGEST_WORDS),
        _ => cut(part, most),
    });
    // A text of many backticks has many short parts.
    const MAX_PARTS: usize = 1000;
    let parts: Vec<Cow<'_, str>> = parts.take(MAX_PARTS).collect();
    parts.join("`")
}

impl Diagnostic {
    /// Creates an error.
    pub fn error(code: &'static str, span: Range<usize>, message: impl Into<String>) -> Self {
        Diagnostic {
            severity: Severity::Error,
            code,
            message: shortened(message.into(), LONGEST_QUOTE),
            span,
            position: None,
            help: None,
            related: Vec::new(),
        }
    }

    /// Creates a warning.
    pub fn warning(code: &'static str, span: Range<usize>, message: impl Into<String>) -> Self {
        Diagnostic {
            severity: Severity::Warning,
            ..Self::error(code, span, message)
        }
    }

    /// Creates a note.
    pub fn note(code: &'static str, span: Range<usize>, message: impl Into<String>) -> Self {
        Diagnostic {
            severity: Severity::Note,
            ..Self::error(code, span, message)
        }
    }

    /// Adds a suggestion for how to fix the problem.
    #[must_use]
    pub fn help(mut self, help: impl Into<String>) -> Self {
        self.help = Some(shortened(help.into(), LONGEST_ADVICE));
        self
    }

    /// Adds another position that explains the problem.
    #[must_use]
    pub fn related(mut self, span: Range<usize>, message: impl Into<String>) -> Self {
        let message = shortened(message.into(), LONGEST_QUOTE);
        self.related.push(RelatedSpan { span, message });
        self
    }
}

/// Formats a finding as `3:12: error[unknown-term]: ...`, with the suggestion on a separate line.
impl fmt::Display for Diagnostic {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        if let Some(Position { line, column }) = self.position {
            write!(f, "{line}:{column}: ")?;
        }
        let severity = match self.severity {
            Severity::Error => "error",
            Severity::Warning => "warning",
            Severity::Note => "note",
        };
        write!(f, "{severity}[{}]: {}", self.code, self.message)?;
        match &self.help {
            Some(help) => write!(f, "\n  help: {help}"),
            None => Ok(()),
        }
    }
}

impl core::error::Error for Diagnostic {}

/// All findings of one text or model, in the order of their positions. This is the error type of parsing and compiling.
///
/// # Example: all errors of a text are reported together
/// ```
/// let findings = fuzzy::yaml::parse("fuzzy: 1\nnam: fan\n").unwrap_err();
/// let codes: Vec<&str> = findings.0.iter().map(|finding| finding.code).collect();
/// assert!(codes.starts_with(&["missing-key", "missing-key"]) && codes.contains(&"unknown-key"), "{codes:?}");
/// assert!(findings.has_errors());
/// ```
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
#[cfg_attr(feature = "serde", serde(transparent))]
pub struct Findings(pub Vec<Diagnostic>);

impl Findings {
    /// Sorts findings by position, and adds lines and columns.
    #[must_use]
    pub fn locate(mut findings: Vec<Diagnostic>, text: &str) -> Self {
        findings.sort_by_key(|finding| (finding.span.start, finding.span.end));
        let mut here = Position { line: 1, column: 1 };
        let mut at = 0;
        for finding in &mut findings {
            // A single pass over the text suffices for all findings: each search starts at the position of the previous
            // one.
            let start = (0..=finding.span.start.min(text.len()))
                .rev()
                .find(|&i| text.is_char_boundary(i))
                .unwrap_or(0);
            let step = Position::of(text.get(at..start).unwrap_or(""), start - at);
            here = Position {
                line: here.line + step.line - 1,
                column: if step.line > 1 {
                    step.column
                } else {
                    here.column + step.column - 1
                },
            };
            at = start;
            finding.position = Some(here);
        }
        Findings(findings)
    }

    /// Returns whether any finding is an error.
    #[must_use]
    pub fn has_errors(&self) -> bool {
        self.0.iter().any(|f| f.severity == Severity::Error)
    }
}

impl fmt::Display for Findings {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        for (i, finding) in self.0.iter().enumerate() {
            if i > 0 {
                f.write_str("\n")?;
            }
            finding.fmt(f)?;
        }
        Ok(())
    }
}

impl core::error::Error for Findings {}

/// Returns the candidate that an author who wrote `word` probably meant.
///
/// The distance is the number of letters to insert, delete, replace or swap (optimal string alignment), ignoring
/// the case of ASCII letters. For words of two to four letters it must not exceed 1; for longer words it must
/// not exceed a third of the length of the longer word, rounded up. Among candidates with the same distance the
/// first one is returned.
///
/// If the word has several parts, a candidate that contains all of them is preferred, unless another candidate
/// differs by at most one letter: `battery_remaining_pct` is returned for `battery_pct`. If no candidate is
/// near, a candidate that starts with the word is returned, provided that the word has at least three letters:
/// `min` is short for `minimum`.
pub fn nearest<'a>(
    word: &str,
    candidates: impl IntoIterator<Item = &'a str, IntoIter: Clone>,
) -> Option<&'a str> {
    // The maximum length of a word that is compared: the time of a comparison grows with the
    // product of the lengths, and longer words are not typing errors.
    const LONGEST: usize = 64;
    // Folds only ASCII letters, because tables for the other letters would add 20 kB to the code for browsers.
    let fold = |s: &str| {
        s.chars()
            .map(|c| c.to_ascii_lowercase())
            .collect::<Vec<char>>()
    };
    let word = fold(word);
    if word.len() > LONGEST {
        return None;
    }
    let mut candidates = candidates.into_iter();
    let mut best: Option<(usize, &str)> = None;
    for candidate in candidates.clone() {
        let other = fold(candidate);
        let longest = word.len().max(other.len());
        let allowed = match longest {
            // For single letters, every candidate of one letter would be near.
            0 | 1 => 0,
            // For short words only one edit is allowed: `mild` is not a misspelt `cold`.
            2..=4 => 1,
            _ => longest.div_ceil(3),
        };
        if other.len() > LONGEST || word.len().abs_diff(other.len()) > allowed {
            continue;
        }
        let distance = edit_distance(&word, &other);
        if distance <= allowed && best.is_none_or(|(least, _)| distance < least) {
            best = Some((distance, candidate));
        }
    }
    if best.is_none_or(|(distance, _)| distance > 1)
        && let Some(whole) = candidates
            .clone()
            .find(|candidate| has_parts(&fold(candidate), &word))
    {
        return Some(whole);
    }
    best.map(|(_, candidate)| candidate).or_else(|| {
        const SHORTEST: usize = 3;
        let begins = |candidate: &str| word.len() >= SHORTEST && fold(candidate).starts_with(&word);
        candidates.find(|candidate| begins(candidate))
    })
}

/// Returns whether `parts` consists of several parts separated by `_`, and the name contains all of them:
/// `battery_remaining_pct` contains the parts of `battery_pct`.
fn has_parts(name: &[char], parts: &[char]) -> bool {
    let mut parts = parts.split(|c| *c == '_').peekable();
    let several = parts
        .next()
        .is_some_and(|first| parts.peek().is_some() && has_part(name, first));
    several && parts.all(|part| has_part(name, part))
}

fn has_part(name: &[char], part: &[char]) -> bool {
    name.split(|c| *c == '_').any(|one| one == part)
}

/// Returns the optimal string alignment distance, keeping three rows of the matrix in memory.
fn edit_distance(a: &[char], b: &[char]) -> usize {
    let mut before: Vec<usize> = Vec::new();
    let mut last: Vec<usize> = (0..=b.len()).collect();
    for (i, &x) in a.iter().enumerate() {
        let mut row = Vec::with_capacity(b.len() + 1);
        row.push(i + 1);
        for (j, &y) in b.iter().enumerate() {
            let replace = last[j] + usize::from(x != y);
            let mut least = replace.min(last[j + 1] + 1).min(row[j] + 1);
            if i > 0 && j > 0 && x == b[j - 1] && a[i - 1] == y {
                least = least.min(before[j - 1] + 1);
            }
            row.push(least);
        }
        before = core::mem::replace(&mut last, row);
    }
    last.last().copied().unwrap_or(0)
}

/// Returns the finding for a repeated name.
pub(crate) fn duplicate(
    kind: &str,
    name: &str,
    what: &str,
    span: Range<usize>,
    first: Range<usize>,
) -> Diagnostic {
    let (code, help) = match kind {
        "variable" => (
            "duplicate-variable",
            "each input and output must have its own name: rename or remove one of the two",
        ),
        "term" => (
            "duplicate-term",
            "each term of a variable must have its own name: rename or remove one of the two",
        ),
        "finding" => (
            "duplicate-key",
            "keep one of the entries; if their reasons differ, write both in its `because`",
        ),
        "block" => (
            "duplicate-block",
            "each rule block must have its own name: rename one of the two",
        ),
        _ => ("duplicate-key", "keep one of them"),
    };
    Diagnostic::error(code, span, format!("{what} has the {kind} `{name}` twice"))
        .related(first, "first defined here")
        .help(help)
}

/// Returns the candidates that a word may refer to: the equivalent of another program's word, or else the nearest
/// candidate.
pub(crate) fn likely_candidates<'a>(word: &str, candidates: &[&'a str]) -> Vec<&'a str> {
    let mut meant = foreign::equivalents(word, candidates.iter().copied());
    if meant.is_empty() {
        meant.extend(nearest(word, candidates.iter().copied()));
    }
    meant
}

/// Returns ``did you mean `heat`?``, or else a list of the candidates: ``choose one of `heat` and `humidity` ``.
pub fn suggest<'a>(word: &str, candidates: impl IntoIterator<Item = &'a str>) -> Option<String> {
    let candidates: Vec<&str> = candidates.into_iter().collect();
    let meant = likely_candidates(word, &candidates);
    let bare = |name: &str| name.trim_matches(is_curly_quote) == word;
    match meant.as_slice() {
        [one] if *one != word && bare(one) => Some(format!(
            "the curly quotes are read as part of the name `{one}`; write straight quotes or no quotes"
        )),
        [] => match candidates.as_slice() {
            [] => None,
            [_] => Some(format!("the only one is {}", listed(&candidates))),
            _ => Some(format!("choose one of {}", listed(&candidates))),
        },
        words => Some(format!("did you mean {}?", either(words))),
    }
}

/// Returns whether a character is a quote as inserted by word processors.
pub(crate) fn is_curly_quote(c: char) -> bool {
    matches!(c, '\u{2018}'..='\u{201f}' | '«' | '»')
}

/// Formats words as `` `A`, `B` or `C` ``
pub(crate) fn either(words: &[&str]) -> String {
    joined(words, "or")
}

fn joined(words: &[&str], join: &str) -> String {
    let quoted: Vec<String> = words.iter().map(|w| format!("`{w}`")).collect();
    match quoted.split_last() {
        Some((last, first)) if !first.is_empty() => format!("{} {join} {last}", first.join(", ")),
        _ => quoted.join(""),
    }
}

/// Formats all words, without a limit, as `` `A`, `B` and `C` ``
pub(crate) fn all_of(words: &[&str]) -> String {
    joined(words, "and")
}

pub(crate) fn listed(words: &[&str]) -> String {
    const MAX_LISTED: usize = 12;
    let mut list = String::new();
    for (i, word) in words.iter().take(MAX_LISTED).enumerate() {
        if i > 0 {
            let last = i + 1 == words.len();
            list.push_str(if last { " and " } else { ", " });
        }
        list.push('`');
        list.push_str(&quoted(word));
        list.push('`');
    }
    if words.len() > MAX_LISTED {
        list.push_str(" and ");
        list.push_str(&(words.len() - MAX_LISTED).to_string());
        list.push_str(" more");
    }
    list
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn positions_follow_lines_and_characters() {
        let text = "añ: 1\nb: 2\n";
        for (at, _) in text.char_indices() {
            let lines: Vec<&str> = text[..at].split('\n').collect();
            let expected = Position {
                line: lines.len(),
                column: lines[lines.len() - 1].chars().count() + 1,
            };
            assert_eq!(Position::of(text, at), expected);
            let one = Diagnostic::error("x", at..at, "x");
            let found = Findings::locate(alloc::vec![one.clone(), one], text);
            assert_eq!(found.0[0].position, Some(expected));
            assert_eq!(found.0[1].position, Some(expected));
        }
    }

    #[test]
    fn similar_words_are_suggested_and_others_are_not() {
        for (word, meant) in [
            ("hihg", Some("high")),
            ("HIGH", Some("high")),
            ("very-low", Some("very_low")),
            ("veri low", Some("very_low")),
            ("x", None),
            ("ver", Some("very_low")),
            ("", None),
        ] {
            assert_eq!(nearest(word, ["low", "high", "very_low"]), meant, "{word}");
        }
        assert_eq!(nearest(&"a".repeat(100_000), ["low"]), None);
    }

    #[test]
    fn long_lists_are_cut_short() {
        let words: Vec<String> = (0..20).map(|i| i.to_string()).collect();
        let words: Vec<&str> = words.iter().map(String::as_str).collect();
        assert!(listed(&words).ends_with("`11` and 8 more"));
        assert_eq!(listed(&words[..3]), "`0`, `1` and `2`");
        assert_eq!(listed(&words[..1]), "`0`");
    }
}
