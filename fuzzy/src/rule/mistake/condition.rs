//! Suggestions for conditions: two words after `IS`, a missing `IS`, phrases of natural language.

use alloc::{borrow::ToOwned, format, string::String, vec::Vec};

use super::{
    CONNECTIVES, Owner,
    words::{found_here, last_input, sign},
};
use crate::{
    diagnostic::{Diagnostic, likely_candidates, nearest, suggest},
    rule::{Hedge, Rule, is_plain_name, parse::keyword},
};

/// Returns the diagnostic for two consecutive words such as `vrey hot`: the first word is a misspelt hedge, or both are
/// one name.
pub(super) fn two_words(span: core::ops::Range<usize>, first: &str, second: &str) -> Diagnostic {
    if let Some(help) = phrase(first, second) {
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
    if likely_candidates(first, &hedges).is_empty() {
        help += &format!("; put a name of two words in quotes: `\"{first} {second}\"`");
    }
    Diagnostic::error("rule-syntax", span, message).help(help)
}

/// Returns whether there is a suggestion for these two words of natural language.
pub(super) fn is_phrase(first: &str, second: &str) -> bool {
    phrase(first, second).is_some()
}

/// Returns a suggestion for two words of natural language after `IS`, such as `hot UNLESS` or `below 20`.
fn phrase(first: &str, second: &str) -> Option<String> {
    let is = |word: &str, known: &[&str]| known.iter().any(|one| word.eq_ignore_ascii_case(one));
    if is(second, &["UNLESS", "EXCEPT"]) {
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
    }
}

/// Returns a suggestion if `IS` is missing after the name of an input or an output; `before` is the text before the
/// name.
pub(super) fn is_missing(
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
        // In `x IS low OR high`, the name is a term of the input in the previous condition, or of another input.
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
    if let Some(help) = phrase_after_name(name, rest, before) {
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
    // For example `IF hot temperature THEN`.
    if owner(kind, name).as_deref() == Some(found) {
        return Some(format!("write `{found} IS {name}`"));
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
pub(super) fn phrase_after_name(name: &str, rest: &str, before: &str) -> Option<String> {
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
