//! The messages for the first syntax error in a rule, with suggestions.

use alloc::{format, string::String, vec::Vec};

use nom::error::{ErrorKind, ParseError};

use super::parse::{DEEPEST_NESTING, keyword};
use crate::{
    diagnostic::{Diagnostic, either, nearest},
    tree::percentage_advice,
};

mod comparison;
mod conclusion;
mod condition;
mod words;

use conclusion::{after_conclusion, terms_of_conclusion, weight_advice};
use condition::{is_missing, than, two_words};
use words::{at_start, before_input, connective, found_here, joining, name_is_missing, sign};

/// The name of an input or output, and its terms in the order of their positions.
pub(crate) struct KnownVariable<'a> {
    pub(crate) name: &'a str,
    pub(crate) terms: Vec<&'a str>,
}

/// The inputs and outputs that a rule can name, for suggestions; empty if they are unknown.
#[derive(Clone, Copy, Default)]
pub(crate) struct KnownNames<'a> {
    pub(crate) inputs: &'a [KnownVariable<'a>],
    pub(crate) outputs: &'a [KnownVariable<'a>],
}

/// A function that returns the known names.
pub(crate) type Known<'a> = &'a dyn Fn() -> KnownNames<'a>;

impl<'a> KnownNames<'a> {
    /// Returns the terms of the input or output with this name; empty if it is unknown.
    fn terms(self, name: &str) -> &'a [&'a str] {
        self.variable(name).map_or(&[], |variable| &variable.terms)
    }

    /// Returns the input or output with this name.
    fn variable(self, name: &str) -> Option<&'a KnownVariable<'a>> {
        let mut variables = self.inputs.iter().chain(self.outputs);
        variables.find(|variable| variable.name == name)
    }

    fn is_output(self, name: &str) -> bool {
        self.outputs.iter().any(|output| output.name == name)
    }

    /// Returns the name of a variable that has a term; `kind` is `input` or `output`.
    fn owner(self, kind: &str, term: &str) -> Option<&'a str> {
        let variables = if kind == "output" {
            self.outputs
        } else {
            self.inputs
        };
        let found = variables
            .iter()
            .find(|variable| variable.terms.contains(&term));
        found.map(|variable| variable.name)
    }
}

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
    // nom's own parsers fail only while white space and comments are skipped. These errors end the skipping and are never
    // reported.
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

/// Returns the position of the phrase `more or less` if the name is its last word and the text before ends in `more or`.
fn more_or_less(before: &str, name: &str) -> Option<usize> {
    let mut words = before.split_whitespace().rev();
    let (or, more) = (words.next()?, words.next()?);
    let is = |word: &str, known: &str| word.eq_ignore_ascii_case(known);
    let is_phrase = is(more, "more") && is(or, "or") && is(name, "less");
    is_phrase.then(|| before.rfind(more)).flatten()
}

impl RuleMistake<'_> {
    /// Returns the diagnostic of the syntax error.
    pub(super) fn explain(self, text: &str, known: KnownNames<'_>) -> Diagnostic {
        let rest = self.rest.trim_start();
        let start = text.len() - rest.len();
        let found = found_here(rest);
        let span = start..start + found.len();
        let before = text.get(..start).unwrap_or("");
        let shown = match found {
            "" => String::from("the end of the rule"),
            "`" => String::from("a backtick"),
            found => format!("`{found}`"),
        };
        let syntax = |message: String| Diagnostic::error("rule-syntax", span.clone(), message);
        let expected = |what: &str, after: &str| {
            syntax(format!("expected {what} after {after}, found {shown}"))
        };
        match self.kind {
            RuleMistakeKind::Keyword(words, after) => {
                let diagnostic = match words {
                    [] => syntax(format!(
                        "expected the end of the rule {after}, found {shown}"
                    )),
                    _ => syntax(format!("expected {} {after}, found {shown}", either(words))),
                };
                let help = match nearest(found, words.iter().copied()) {
                    Some(word) => Some(format!("did you mean `{word}`?")),
                    None if words.contains(&"IF") => Some(at_start(rest)),
                    None if words.contains(&")") => {
                        sign(rest).or_else(|| connective(before, rest, known))
                    }
                    None => sign(rest).or_else(|| after_conclusion(before, rest, words.is_empty())),
                };
                with_help(diagnostic, help)
            }
            RuleMistakeKind::Connective => {
                let help = match nearest(found, CONNECTIVES) {
                    _ if found.eq_ignore_ascii_case("WITH") => {
                        let number = rest.split_whitespace().nth(1).unwrap_or("0.5");
                        Some(format!("move `{found} {number}` to the end of the rule"))
                    }
                    // For example `temperature IS more than mild`.
                    _ if found.eq_ignore_ascii_case("THAN") && let Some(help) = than(before, rest, known) => Some(help),
                    _ if let Some(word) = joining(found) => {
                        Some(format!("write `{word}` in place of `{found}`"))
                    }
                    _ if found.eq_ignore_ascii_case("IF") => {
                        Some("a rule can have only one `IF`: write `AND` in place of the second `IF`".into())
                    }
                    _ if found.eq_ignore_ascii_case("XOR") => Some(
                        "rules have no `XOR`: for conditions a and b, write `(a AND NOT b) OR (NOT a AND b)`"
                            .into(),
                    ),
                    _ if ["FOR", "DURING", "SINCE", "WITHIN"].iter().any(|word| found.eq_ignore_ascii_case(word)) => Some(
                        "a rule reads only the current values of its inputs: add an input for the duration, and use a term of that input".into(),
                    ),
                    // For example `IF x IS low: y IS high`.
                    _ if found == ":" => Some(match keyword(rest.get(1..).unwrap_or(""), "THEN") {
                        Some(_) => "remove the colon".into(),
                        None => "write `THEN` in place of the colon".into(),
                    }),
                    Some(word) => Some(format!("did you mean `{word}`?")),
                    None => sign(rest).or_else(|| connective(before, rest, known)),
                };
                with_help(expected(&either(&CONNECTIVES), "the condition"), help)
            }
            RuleMistakeKind::NoIs(kind, from) => {
                let from = from.trim_start();
                let name = found_here(from);
                let start = text.len() - from.len();
                let before = text.get(..start).unwrap_or("");
                let help = is_missing(kind, name, rest, before, known);
                let diagnostic = match more_or_less(before, name) {
                    Some(more) => {
                        let message = "there is no hedge `more or less`";
                        Diagnostic::error("rule-syntax", more..start + name.len(), message)
                    }
                    None => expected("`IS`", &format!("`{name}`")),
                };
                with_help(diagnostic, help)
            }
            RuleMistakeKind::Name(what) => {
                let help = name_is_missing(what, rest, before, known).or_else(|| sign(rest));
                with_help(syntax(format!("expected {what}, found {shown}")), help)
            }
            RuleMistakeKind::HedgeBeforeInput => syntax(format!(
                "the hedge {shown} must come before the term, not before the input"
            ))
            .help(before_input(rest)),
            RuleMistakeKind::HedgeInConsequent => {
                syntax(format!("`{found}` is not allowed after `THEN`"))
                    .help(terms_of_conclusion(before, known))
            }
            RuleMistakeKind::TwoWords(second) => {
                let whole = format!("{found} {second}");
                let is_term =
                    known.owner("input", found).is_some() && known.owner("input", &whole).is_none();
                if is_term || joining(second).is_some() {
                    // The first word is a term, so the second one is wrong.
                    let rest = rest.get(found.len()..).unwrap_or("");
                    let mistake = RuleMistake {
                        rest,
                        kind: RuleMistakeKind::Connective,
                    };
                    let diagnostic = mistake.explain(text, known);
                    let help = format!(
                        "`{second}` cannot follow the term `{found}`: write `AND`, `OR` or `THEN` after `{found}`"
                    );
                    let help = diagnostic.help.clone().unwrap_or(help);
                    return diagnostic.help(help);
                }
                two_words(span, (found, second), (before, rest), known)
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
            RuleMistakeKind::Number => {
                syntax(format!("expected a number after `WITH`, found {shown}"))
                    .help(weight_advice(rest))
            }
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
                format!("brackets and NOTs are nested more than {DEEPEST_NESTING} levels deep"),
            )
            .help("remove brackets that have no effect, or split the rule into several rules"),
        }
    }
}

fn with_help(diagnostic: Diagnostic, help: Option<String>) -> Diagnostic {
    Diagnostic { help, ..diagnostic }
}
