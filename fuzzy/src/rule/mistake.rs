//! The messages for the first syntax error in a rule, with suggestions.

use alloc::{borrow::ToOwned, format, string::String, vec::Vec};

use nom::error::{ErrorKind, ParseError};

use super::{
    Hedge, Rule, is_plain_name,
    parse::{DEEPEST_NESTING, is_name_letter, keyword, quoted, word},
};
use crate::{
    diagnostic::{Diagnostic, either, is_curly_quote, meant, nearest, suggest},
    tree::{percentage_advice, share_of_percentage},
};

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
    // nom's own parsers are always optional here, so their errors are always replaced.
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
                    None => sign(rest).or_else(|| behind_conclusion(before, rest, words.is_empty())),
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
                let help = name_is_missing(what, found).or_else(|| sign(rest));
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
            RuleMistakeKind::TwoWords(second) => two_words(span, found, second),
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

/// Returns the diagnostic for two consecutive words such as `vrey hot`: the first word is a misspelt hedge, or both are
/// one name.
fn two_words(span: core::ops::Range<usize>, first: &str, second: &str) -> Diagnostic {
    let is = |word: &str, known: &[&str]| known.iter().any(|one| word.eq_ignore_ascii_case(one));
    let phrase = if is(second, &["UNLESS", "EXCEPT"]) {
        Some(format!("write `AND NOT` in place of `{second}`"))
    } else if is(second, &["BUT", "PLUS", "WHILE"]) {
        Some(format!("write `AND` in place of `{second}`"))
    } else if is(first, &["EITHER"]) {
        Some("write `(x IS a OR x IS b)` with the input x".to_owned())
    } else if is(first, &["NEITHER"]) {
        Some("write `x IS NOT a AND x IS NOT b` with the input x".to_owned())
    } else if is(
        first,
        &[
            "between", "below", "above", "under", "over", "at", "less", "more",
        ],
    ) || is(first, &["greater", "smaller", "higher", "lower"])
    {
        Some("a condition names a term: join the intended terms, `(x IS a OR x IS b)`, or give the input a term for these values".to_owned())
    } else {
        None
    };
    if let Some(help) = phrase {
        let message = format!("expected a term after `IS`, found `{first} {second}`");
        return Diagnostic::error("rule-syntax", span, message).help(help);
    }
    if second.parse::<f64>().is_ok() {
        let message = format!("expected a term after `IS`, found `{first} {second}`");
        return Diagnostic::error("rule-syntax", span, message)
            .help("a condition names a term of the input; give the input a term for these values");
    }
    let hedges: Vec<&str> = Hedge::ALL.iter().map(|hedge| hedge.word()).collect();
    let message = format!("there is no hedge `{first}`");
    let mut help = suggest(first, hedges.iter().copied()).unwrap_or_default();
    if meant(first, &hedges).is_empty() {
        help += &format!("; put a name of two words in quotes: `\"{first} {second}\"`");
    }
    Diagnostic::error("rule-syntax", span, message).help(help)
}

/// Returns the name of a variable that has a term. The first argument is `input` or `output`, the second is the name of
/// the term.
pub(crate) type Owner<'a> = &'a dyn Fn(&str, &str) -> Option<String>;

/// Returns the input of the last condition of a text: `x` of `IF x IS low OR`.
fn last_input(before: &str) -> Option<&str> {
    let words = before.split_whitespace().rev();
    let mut owners = words.clone().zip(words.skip(1));
    let after_then = |(word, _): &(&str, &str)| word.eq_ignore_ascii_case("THEN");
    let (_, owner) = owners
        .by_ref()
        .take_while(|pair| !after_then(pair))
        .find(|(word, _)| word.eq_ignore_ascii_case("IS"))?;
    Some(owner.trim_start_matches('('))
}

/// Returns a suggestion if `IS` is missing after the name of an input or an output; `before` is the text before the
/// name.
fn is_missing(
    kind: &str,
    name: &str,
    rest: &str,
    before: &str,
    owner: Owner<'_>,
) -> Option<String> {
    let found = found_here(rest);
    // For example `IF "temperature IS cold" THEN`, and `IF temperature.cold THEN`.
    if name.starts_with(['"', '\'']) && name.to_ascii_lowercase().contains(" is ") {
        return Some("remove the quotes: they make one name of the condition".into());
    }
    let parts = name.match_indices(['.', '_']).find_map(|(at, _)| {
        let (of, term) = (name.get(..at)?, name.get(at + 1..)?);
        let term = term.trim_start_matches("is_");
        (owner(kind, term).as_deref() == Some(of)).then_some((of, term))
    });
    if let Some((of, term)) = parts {
        return Some(format!("write `{of} IS {term}`"));
    }
    // For example `IF (temperature, cold) THEN`, and `IF temperature(cold) THEN`.
    let next = found_here(rest.trim_start_matches([',', '(', '[', '"', '\'', ' ']));
    if found.starts_with([',', '(', '[']) && owner(kind, next).as_deref() == Some(name) {
        return Some(format!("write `{name} IS {next}`"));
    }
    if found == "," && kind == "input" {
        return Some(format!(
            "write a condition for each input: `{name} IS term AND {next} IS term`"
        ));
    }
    if found.is_empty()
        || CONNECTIVES
            .iter()
            .chain(&["WITH", ")"])
            .any(|w| w.eq_ignore_ascii_case(found))
    {
        if ["TRUE", "ALWAYS"]
            .iter()
            .any(|word| name.eq_ignore_ascii_case(word))
        {
            return Some("for a rule that always fires write `input IS any`".into());
        }
        // In `x IS low OR high`, the name is a term of the input before it, or of another one.
        let connective = before.split_whitespace().next_back().unwrap_or("");
        let of = owner(kind, name);
        return Some(match last_input(before) {
            _ if kind == "output" && of.is_some() => {
                format!("write `{} IS {name}`", of.unwrap_or_default())
            }
            Some(_) if kind == "output" => {
                String::from("write an output and one term in each conclusion: `output IS term`")
            }
            Some(last) => match of {
                Some(other) if other != last => {
                    format!(
                        "name the input: `{} {other} IS {name}`",
                        connective.to_ascii_uppercase()
                    )
                }
                _ => {
                    format!(
                        "name the input again: `{} {last} IS {name}`",
                        connective.to_ascii_uppercase()
                    )
                }
            },
            None => match of {
                Some(of) => format!("write `{of} IS {name}`"),
                None => format!("write `{name} IS` and a term"),
            },
        });
    }
    let is = |word: &str| found.eq_ignore_ascii_case(word);
    if let Some(help) = spoken(name, rest, before) {
        return Some(help);
    }
    if name.eq_ignore_ascii_case("ELSE") {
        return Some("there is no `ELSE`: remove it, or write a second rule".into());
    }
    if found.starts_with(['<', '>', '≤', '≥'])
        && let next = found_here(rest.get(found.len()..).unwrap_or("").trim_start())
        && is_plain_name(next)
        && next.parse::<f64>().is_err()
    {
        return Some(format!(
            "a condition names a term: write `{name} IS {next}`"
        ));
    }
    // For example `x BETWEEN cold AND mild`.
    if is("BETWEEN")
        && let [_, low, connective, high, ..] =
            rest.split_whitespace().collect::<Vec<&str>>().as_slice()
        && connective.eq_ignore_ascii_case("AND")
        && [low, high]
            .iter()
            .all(|word| is_plain_name(word) && word.parse::<f64>().is_err())
    {
        return Some(format!("write `({name} IS {low} OR {name} IS {high})`"));
    }
    if found.starts_with(['<', '>', '≤', '≥', '-', '+', '*', '/']) || is("BETWEEN") {
        return Some(format!(
            "a condition names a term, not a number: give `{name}` a term for these values and write `{name} IS term`"
        ));
    }
    if found.starts_with('[') {
        return Some(format!("write `{name} IS term`"));
    }
    if found.starts_with('=')
        && let Some(value) = rest.trim_start_matches('=').split_whitespace().next()
        && value.parse::<f64>().is_ok()
    {
        let shape = match kind {
            "output" => "constant",
            _ => "singleton",
        };
        return Some(format!(
            "write `IS` and a term; for the number {value} give the {kind} a term, such as `{{{shape}: {value}}}`"
        ));
    }
    let behind = rest.get(found.len()..).unwrap_or("");
    if Hedge::ALL.iter().any(|hedge| is(hedge.word())) {
        let next = found_here(behind.trim_start());
        return Some(format!("write `{name} IS {found} {next}`"));
    }
    if is_plain_name(found) && keyword(behind, "IS").is_none() {
        let next = found_here(behind.trim_start());
        let behind_next = behind.trim_start().get(next.len()..).unwrap_or("");
        // For example `fan SHOULD BE fast`.
        if next.eq_ignore_ascii_case("BE") {
            return Some(format!(
                "write `{name} IS {}`",
                found_here(behind_next.trim_start())
            ));
        }
        // For example `fan BECOMES fast`, `temperature WAS hot`.
        let is_verb = is_plain_name(next) && !Rule::is_keyword(next);
        return Some(match nearest(found, ["IS"]) {
            Some(word) => format!("did you mean `{word}`?"),
            None if name.eq_ignore_ascii_case("SET") => format!("write `{found} IS` and a term"),
            None if is_verb => format!("write `{name} IS {next}`"),
            None => format!("write `{name} IS {found}`"),
        });
    }
    if ["ALL", "THE", "ANY", "EVERY"]
        .iter()
        .any(|word| name.eq_ignore_ascii_case(word))
    {
        return Some(format!("remove `{name}`"));
    }
    if is_plain_name(found) {
        return Some(format!(
            "put a name of several words in quotes: `\"{name} {found}\"`"
        ));
    }
    sign(rest)
}

/// Verbs that describe a change.
const CHANGES: [&str; 8] = [
    "RISES",
    "FALLS",
    "INCREASES",
    "DECREASES",
    "GROWS",
    "DROPS",
    "RISING",
    "FALLING",
];

/// Returns a suggestion for a phrase of natural language after the name of a variable: `IN (mild, hot)`, `NOT IS hot`,
/// and `IS more or less hot`, in which `less` was parsed as a name.
fn spoken(name: &str, rest: &str, before: &str) -> Option<String> {
    let found = found_here(rest);
    let behind = rest.get(found.len()..).unwrap_or("").trim_start();
    let is = |words: &[&str]| words.iter().any(|word| found.eq_ignore_ascii_case(word));
    if is(&["ISN", "ISNT"]) {
        let term = found_here(
            behind
                .trim_start_matches(['\'', '\u{2019}', 't', 'T'])
                .trim_start(),
        );
        return Some(format!("write `{name} IS NOT {term}`"));
    }
    if is(&CHANGES) {
        return Some(format!(
            "a rule sees the value of `{name}`, not its change: add an input with the rate of change, and use a term of that input"
        ));
    }
    if found.eq_ignore_ascii_case("IN") {
        let list = behind.strip_prefix(['(', '[', '{'])?;
        let terms = list
            .split([')', ']', '}'])
            .next()?
            .split(',')
            .map(str::trim);
        let terms = terms.filter(|term| is_plain_name(term));
        let parts: Vec<String> = terms.map(|term| format!("{name} IS {term}")).collect();
        return (!parts.is_empty()).then(|| format!("write `({})`", parts.join(" OR ")));
    }
    if found.eq_ignore_ascii_case("NOT")
        && let Some(behind) = keyword(behind, "IS")
    {
        let term = found_here(behind.trim_start());
        return Some(format!("write `{name} IS NOT {term}`"));
    }
    let mut words = before.split_whitespace().rev();
    let is_more_or = words
        .next()
        .is_some_and(|word| word.eq_ignore_ascii_case("or"))
        && words
            .next()
            .is_some_and(|word| word.eq_ignore_ascii_case("more"));
    (is_more_or && name.eq_ignore_ascii_case("less")).then(|| format!("write `somewhat {found}`"))
}

/// Returns a suggestion if a name was expected, but there is a keyword or the end of the rule.
fn name_is_missing(what: &str, found: &str) -> Option<String> {
    let is = |word: &str| found.eq_ignore_ascii_case(word);
    let input = what.contains("input");
    if input && found.starts_with('/') {
        return Some("write `AND` or `OR`".into());
    }
    if input && is("IS") {
        return Some("name the input again: `AND input IS term`".into());
    }
    if input && is("IF") {
        return Some("write `IF` once".into());
    }
    if input && (is("THEN") || is("AND") || is("OR")) {
        return Some(
            "add a condition before it, `input IS term`, or remove the word before it".into(),
        );
    }
    if found.is_empty() {
        return Some(match what {
            "the name of an output" => "add a conclusion: `THEN output IS term`".into(),
            _ if input => "add a condition: `input IS term`".into(),
            _ => "add a term".into(),
        });
    }
    if what == "the name of an output" && is("IF") {
        return Some("a rule has one `IF`: join the conditions by `AND` before `THEN`".into());
    }
    if what == "the name of an output" && found == "(" {
        return Some("write the conclusion without brackets, and a weight as `WITH 0.5`".into());
    }
    if !input && is("IS") {
        return Some("remove the second `IS`".into());
    }
    if what.contains("term") && found == "(" {
        return Some("write the term without brackets: `IS very low`".into());
    }
    if what == "the name of an output" && is(":") {
        return Some("remove the colon".into());
    }
    if what == "the name of an output" && is("THEN") {
        return Some("remove the second `THEN`".into());
    }
    if CONNECTIVES.iter().any(|connective| is(connective)) {
        return Some(format!("add a term before `{found}`"));
    }
    Rule::is_keyword(found).then(|| {
        format!(
            "`{found}` is a word of the rule language; put it in quotes as a name: `\"{found}\"`"
        )
    })
}

/// Returns a suggestion for a weight such as `50%` or `weight 0.5`.
fn weight_advice(rest: &str) -> String {
    let rest = rest.trim_start_matches(['=', ':', ' ']);
    let mut words = rest.split_whitespace();
    let first = words.next().unwrap_or("");
    if first
        .parse::<f64>()
        .is_ok_and(|weight| (0.0..=1.0).contains(&weight))
    {
        return format!("write `WITH {first}`");
    }
    let share = share_of_percentage(first);
    let named = words
        .next()
        .filter(|_| first.eq_ignore_ascii_case("weight"));
    match (share, named.filter(|number| number.parse::<f64>().is_ok())) {
        (Some(share), _) => format!("write `WITH {share}`"),
        (_, Some(number)) => format!("write `WITH {number}`"),
        _ => "a weight is a number from 0 to 1: `WITH 0.8`".into(),
    }
}

/// Returns a suggestion for a rule that does not start with IF.
fn at_start(rest: &str) -> String {
    if ["WHEN", "WHENEVER"]
        .iter()
        .any(|word| found_here(rest).eq_ignore_ascii_case(word))
    {
        return format!("write `IF` in place of `{}`", found_here(rest));
    }
    if let Some(help) = sign(rest).filter(|_| rest.starts_with(is_curly_quote)) {
        return help;
    }
    let numbered = rest
        .split_whitespace()
        .take(4)
        .any(|word| word.eq_ignore_ascii_case("IF"));
    if numbered {
        "begin with `IF`; rules have no names or numbers".into()
    } else {
        "a rule reads `IF input IS term THEN output IS term`".into()
    }
}

/// Returns a suggestion for a condition that is not followed by AND, OR or THEN.
fn connective(before: &str, rest: &str) -> Option<String> {
    let found = found_here(rest);
    let behind = rest.get(found.len()..).unwrap_or("").trim_start();
    let last = before.split_whitespace().next_back().unwrap_or("");
    // For example `temperature IS cold, mild`.
    let next = found_here(behind);
    if matches!(found, "," | "/")
        && is_plain_name(next)
        && keyword(behind.get(next.len()..).unwrap_or(""), "IS").is_none()
        && let Some(input) = last_input(before)
    {
        return Some(format!("write `OR {input} IS {next}`"));
    }
    if found.eq_ignore_ascii_case("IS") {
        return Some(match last_input(before) {
            Some(input) if input == last => format!("remove one `{input} IS`"),
            _ => format!("write `AND` or `OR` before `{last}`"),
        });
    }
    if last.parse::<f64>().is_ok() {
        let help = "a condition names a term of the input, not a number; give the input a term for these values";
        return Some(help.into());
    }
    match found {
        "," => return Some("write `AND` or `THEN`".into()),
        ";" => return Some("remove it".into()),
        ")" => return Some("there is no `(` before it; remove it, or add one".into()),
        "" => return Some("add a conclusion: `THEN output IS term`".into()),
        _ => {}
    }
    if Hedge::ALL
        .iter()
        .any(|hedge| hedge.word().eq_ignore_ascii_case(found))
    {
        return Some("write a hedge before the term: `input IS very low`".into());
    }
    let (behind, _) = word(rest).ok()?;
    if !is_plain_name(found) || keyword(behind, "IS").is_none() {
        return None;
    }
    let has_then = rest
        .split_whitespace()
        .any(|word| word.eq_ignore_ascii_case("THEN"));
    let connective = if has_then { "AND" } else { "THEN" };
    Some(format!("write `{connective}` before `{found}`"))
}

/// Returns a suggestion for text after a conclusion or after its weight.
fn behind_conclusion(before: &str, rest: &str, weighted: bool) -> Option<String> {
    let found = found_here(rest);
    let number_behind = |sign: &str| {
        let number = rest.strip_prefix(sign)?.split_whitespace().next()?;
        number.parse::<f64>().ok().map(|value| (number, value))
    };
    if let Some((number, value)) = number_behind("*")
        && (0.0..=1.0).contains(&value)
    {
        return Some(format!("write a weight after `WITH`: `WITH {number}`"));
    }
    if let Some((_, divisor)) = number_behind("/")
        && let Some(Ok(number)) = before.split_whitespace().next_back().map(str::parse::<f64>)
        && (0.0..=1.0).contains(&(number / divisor))
    {
        return Some(format!(
            "write a weight as a decimal number: `WITH {}`",
            number / divisor
        ));
    }
    let is = |word: &str| found.eq_ignore_ascii_case(word);
    if is("else") {
        return Some("there is no `ELSE`: write a second rule with `NOT`".into());
    }
    if is("or") {
        return Some("conclusions are joined by `AND`; for `OR` write two rules".into());
    }
    if is("if") {
        return Some("begin the next rule on a line of its own: `- IF ...`".into());
    }
    if is("when") {
        return Some("a rule has one `IF`: join conditions by `AND` before `THEN`".into());
    }
    if is("then") {
        return Some("join conclusions by `AND`, or write a second rule".into());
    }
    if is("unless") || is("except") {
        return Some("there is no `UNLESS`: write `AND NOT (condition)` before `THEN`".into());
    }
    if ["weight", "weighted", "weights", "confidence", "cf"]
        .iter()
        .any(|word| is(word))
    {
        let mut words = rest.split_whitespace().skip(1);
        let number = words
            .find(|word| word.parse::<f64>().is_ok())
            .unwrap_or("0.5");
        return Some(format!("write a weight after `WITH`: `WITH {number}`"));
    }
    let number = rest.trim_start_matches([',', '(', '[', ' ']);
    let end = number.find(|c: char| !c.is_ascii_digit() && c != '.');
    let number = number.get(..end.unwrap_or(number.len())).unwrap_or("");
    let whole = before.split_whitespace().next_back().unwrap_or("");
    if rest.starts_with(',') && !number.is_empty() && whole.parse::<u64>().is_ok() {
        return Some(format!("write a decimal point: `WITH {whole}.{number}`"));
    }
    match found {
        "," => Some("join conclusions by `AND`".into()),
        ";" => Some("remove it; each rule is an item of the list `rules`".into()),
        "(" | "[" if number.parse::<f64>().is_ok() => {
            Some(format!("write a weight after `WITH`: `WITH {number}`"))
        }
        "(" | "%" | "[" => Some("write a weight after `WITH`: `WITH 0.8`".into()),
        _ if weighted => Some("a weight is the end of its rule; remove everything after it".into()),
        _ if is_plain_name(found) => {
            Some("put a name of several words in quotes: `\"very low\"`".into())
        }
        _ => None,
    }
}

/// Returns a suggestion for an operator of another language.
fn sign(rest: &str) -> Option<String> {
    let found = found_here(rest);
    let found = found.trim_end_matches(['(', ')']);
    let text = match found {
        "&" | "&&" => "write `AND`",
        "|" | "||" => "write `OR`",
        "!" | "~" => "write `NOT`",
        "=" | "==" | ":" | ":=" => "write `IS`",
        "!=" | "<>" => "write `IS NOT`",
        "=>" | "->" => "write `THEN`",
        _ if found.starts_with("//") => "a comment begins with `#`",
        _ if found.starts_with(is_curly_quote) => "write straight quotes: `\"`",
        _ if found.starts_with('`') => "write a name without quotes, or in double quotes: `\"`",
        _ => return None,
    };
    Some(text.into())
}

/// Returns the token at this position as an author would quote it: a word, a quoted name, or an operator.
fn found_here(rest: &str) -> &str {
    const LONGEST: usize = 40;
    let end = |in_it: fn(char) -> bool| {
        let at = rest
            .char_indices()
            .take(LONGEST)
            .find(|&(_, c)| !in_it(c))
            .map(|(at, _)| at);
        let most = rest
            .char_indices()
            .nth(LONGEST)
            .map_or(rest.len(), |(at, _)| at);
        at.unwrap_or(most)
    };
    let Some(first) = rest.chars().next() else {
        return "";
    };
    let length = match first {
        '"' | '\'' => match quoted(rest, first) {
            Ok((after, _)) => rest.len() - after.len(),
            Err(_) => end(|c| c != '\n'),
        },
        '(' | ')' => 1,
        _ if is_name_letter(first) || first == '+' => end(|c| is_name_letter(c) || c == '+'),
        _ => end(|c| !is_name_letter(c) && !c.is_whitespace() && !matches!(c, '"' | '\'')),
    };
    rest.get(..length).unwrap_or(rest)
}

fn with_help(diagnostic: Diagnostic, help: Option<String>) -> Diagnostic {
    Diagnostic { help, ..diagnostic }
}
