//! The messages for the first syntax error in a rule, with suggestions.

use alloc::{format, string::String};

use nom::error::{ErrorKind, ParseError};

use super::parse::{DEEPEST_NESTING, keyword};
use crate::{
    diagnostic::{Diagnostic, either, nearest},
    tree::percentage_advice,
};

mod conclusion;
mod condition;
mod words;

use conclusion::{after_conclusion, weight_advice};
use condition::{is_missing, is_phrase, two_words};
use words::{at_start, connective, found_here, name_is_missing, sign};

/// A syntax error, with the remaining text at the position where it was detected.
pub(super) struct RuleMistake<'a> {
    pub(super) rest: &'a str,
    pub(super) kind: RuleMistakeKind<'a>,
}

pub(super) enum RuleMistakeKind<'a> {
    /// One of these keywords was expected; the second field describes what precedes it.
    Keyword(&'static [&'static str], &'static str),
    /// `AND`, `OR` or `THEN` was expected.
    Connective,
    /// `IS` is missing after the name of an input or an output. The second field is the text from that name on.
    NoIs(&'static str, &'a str),
    /// A name of this kind was expected.
    Name(&'static str),
    /// A hedge before the input.
    HedgeBeforeInput,
    /// A hedge that is not allowed in a conclusion.
    HedgeInConsequent,
    /// A second word after a term; the field is the second word.
    TwoWords(&'a str),
    /// An unclosed quote.
    OpenQuote,
    /// An unclosed bracket.
    OpenBracket,
    /// An empty name in quotes.
    EmptyName,
    /// A number is missing after `WITH`.
    Number,
    /// A weight outside [0, 1].
    Weight(f64),
    /// Nesting deeper than [`DEEPEST_NESTING`].
    TooDeep,
}

impl<'a> ParseError<&'a str> for RuleMistake<'a> {
    // nom's own parsers are used here only where they may fail, and their errors are always replaced by a more specific
    // one.
    fn from_error_kind(rest: &'a str, _: ErrorKind) -> Self {
        RuleMistake {
            rest,
            kind: RuleMistakeKind::Name("a word"),
        }
    }

    fn append(_: &'a str, _: ErrorKind, other: Self) -> Self {
        other
    }
}

const CONNECTIVES: [&str; 3] = ["AND", "OR", "THEN"];

impl RuleMistake<'_> {
    /// Returns the diagnostic of the syntax error.
    pub(super) fn explain(self, text: &str, owner: Owner<'_>) -> Diagnostic {
        let rest = self.rest.trim_start();
        let start = text.len() - rest.len();
        let found = found_here(rest);
        let span = start..start + found.len();
        let before = text.get(..start).unwrap_or("");
        let shown = match found {
            "" => String::from("the end of the rule"),
            found => format!("`{found}`"),
        };
        let syntax = |message: String| Diagnostic::error("rule-syntax", span.clone(), message);
        let expected = |what: &str, after: &str| {
            syntax(format!("expected {what} after {after}, found {shown}"))
        };
        match self.kind {
            RuleMistakeKind::Keyword(words, after) => {
                let diagnostic = match words {
                    [] => syntax(format!("expected the end of the rule {after}, found {shown}")),
                    _ => syntax(format!("expected {} {after}, found {shown}", either(words))),
                };
                let help = match nearest(found, words.iter().copied()) {
                    Some(word) => Some(format!("did you mean `{word}`?")),
                    None if words.contains(&"IF") => Some(at_start(rest)),
                    None if words.contains(&")") => sign(rest).or_else(|| connective(before, rest)),
                    None => sign(rest).or_else(|| after_conclusion(before, rest, words.is_empty())),
                };
                with_help(diagnostic, help)
            }
            RuleMistakeKind::Connective => {
                let help = match nearest(found, CONNECTIVES) {
                    _ if found.eq_ignore_ascii_case("WITH") => {
                        Some("write the weight at the end of the rule: `THEN output IS term WITH 0.5`".into())
                    }
                    _ if found.eq_ignore_ascii_case("XOR") => Some(
                        "there is no `XOR`: write `(a AND NOT b) OR (NOT a AND b)` with the conditions a and b"
                            .into(),
                    ),
                    _ if ["FOR", "DURING", "SINCE", "WITHIN"].iter().any(|word| found.eq_ignore_ascii_case(word)) => Some(
                        "a rule reads the inputs of one moment: add an input that measures the duration, and use a term of that input".into(),
                    ),
                    // For example `IF x IS low: y IS high`.
                    _ if found == ":" => Some(match keyword(rest.get(1..).unwrap_or(""), "THEN") {
                        Some(_) => "remove the colon".into(),
                        None => "write `THEN` in place of the colon".into(),
                    }),
                    Some(word) => Some(format!("did you mean `{word}`?")),
                    None => sign(rest).or_else(|| connective(before, rest)),
                };
                with_help(expected(&either(&CONNECTIVES), "the condition"), help)
            }
            RuleMistakeKind::NoIs(kind, from) => {
                let from = from.trim_start();
                let name = found_here(from);
                let start = text.len() - from.len();
                let help = is_missing(kind, name, rest, text.get(..start).unwrap_or(""), owner);
                with_help(expected("`IS`", &format!("the {kind}")), help)
            }
            RuleMistakeKind::Name(what) => {
                let help = name_is_missing(what, rest, before).or_else(|| sign(rest));
                with_help(syntax(format!("expected {what}, found {shown}")), help)
            }
            RuleMistakeKind::HedgeBeforeInput => {
                let diagnostic = syntax(format!("the hedge {shown} is before the input"));
                diagnostic.help(format!(
                    "write a hedge between `IS` and the term: `input IS {found} term`"
                ))
            }
            RuleMistakeKind::HedgeInConsequent => syntax(format!("`{found}` is not allowed after `THEN`"))
                .help("`NOT` and `any` belong in the condition; here name one term of the output, such as `IS low` or `IS very low`"),
            RuleMistakeKind::TwoWords(second) => {
                let whole = format!("{found} {second}");
                if owner("input", found).is_some() && owner("input", &whole).is_none() && !is_phrase(found, second) {
                    // The first word is a term, so the second one is wrong.
                    let rest = rest.get(found.len()..).unwrap_or("");
                    let mistake = RuleMistake { rest, kind: RuleMistakeKind::Connective };
                    let diagnostic = mistake.explain(text, owner);
                    let help = format!("`{found}` is a term: write `AND`, `OR` or `THEN` after it");
                    let help = diagnostic.help.clone().unwrap_or(help);
                    return diagnostic.help(help);
                }
                two_words(span, found, second)
            }
            RuleMistakeKind::OpenQuote => syntax(String::from("the quoted name is never closed"))
                .help("add the closing quote"),
            RuleMistakeKind::OpenBracket => Diagnostic::error(
                "rule-syntax",
                start..start + 1,
                "the bracket `(` is never closed",
            )
            .help("add the closing bracket `)`"),
            RuleMistakeKind::EmptyName => {
                Diagnostic::error("rule-syntax", start..start + 2, "the name is empty")
                    .help("write the name of a variable or a term between the quotes")
            }
            RuleMistakeKind::Number => syntax(format!("expected a weight after `WITH`, found {shown}"))
                .help(weight_advice(rest)),
            RuleMistakeKind::Weight(weight) => {
                let message = format!("the weight `{weight}` is outside [0, 1]");
                let help = percentage_advice(weight).unwrap_or_else(|| {
                    "a weight multiplies the firing strength of its rule; write a number from 0 to 1".into()
                });
                Diagnostic::error("weight-outside-range", span, message).help(help)
            }
            RuleMistakeKind::TooDeep => Diagnostic::error(
                "rule-too-deep",
                span,
                format!("brackets and NOTs are nested deeper than {DEEPEST_NESTING}"),
            )
            .help("split the rule into several rules with the same conclusion"),
        }
    }
}

/// A function that returns the name of an input or output that has a given term. Its first argument is `input` or
/// `output`, the second is the name of the term.
pub(crate) type Owner<'a> = &'a dyn Fn(&str, &str) -> Option<String>;

fn with_help(diagnostic: Diagnostic, help: Option<String>) -> Diagnostic {
    Diagnostic { help, ..diagnostic }
}
