//! Suggestions for conditions: two words after `IS`, a missing `IS`, phrases of natural language.

use alloc::{format, string::String, vec::Vec};

use super::{
    CONNECTIVES, KnownNames,
    comparison::{between, compared, not_a_number, side_of_sign, side_of_words},
    more_or_less,
    words::{found_here, last_input, one_of, sign},
};
use crate::{
    diagnostic::{Diagnostic, likely_candidates, nearest, suggest},
    formula::Formula,
    rule::{Hedge, Rule, is_plain_name, parse::keyword},
};

/// Returns the diagnostic for two consecutive words such as `vrey hot`: the first word is a misspelt hedge, or both are
/// one name. `rest` begins with the two words.
pub(super) fn two_words(
    span: core::ops::Range<usize>,
    (first, second): (&str, &str),
    (before, rest): (&str, &str),
    known: KnownNames<'_>,
) -> Diagnostic {
    let input = last_input(before).unwrap_or("input");
    let is_number = second.parse::<f64>().is_ok();
    let phrase = phrase(input, rest, known);
    if let Some(help) = phrase.or_else(|| is_number.then(|| not_a_number(input))) {
        let message = format!("expected a term after `IS`, found `{first} {second}`");
        return Diagnostic::error("rule-syntax", span, message).help(help);
    }
    let hedges: Vec<&str> = Hedge::ALL.iter().map(|hedge| hedge.word()).collect();
    let message = format!("there is no hedge `{first}`");
    let mut help = suggest(first, hedges.iter().copied()).unwrap_or_default();
    if likely_candidates(first, &hedges).is_empty() {
        help += &format!("; put a name with spaces in quotes: `\"{first} {second}\"`");
    }
    Diagnostic::error("rule-syntax", span, message).help(help)
}

/// Returns a suggestion for words of natural language after `IS`, such as `EITHER cold OR hot` or `at least mild`.
fn phrase(input: &str, rest: &str, known: KnownNames<'_>) -> Option<String> {
    let words: Vec<&str> = rest.split_whitespace().collect();
    let is = |word: &str, known: &str| word.eq_ignore_ascii_case(known);
    let ends = |word: &str| is(word, "THEN") || word.ends_with(')');
    let phrase = words.iter().take_while(|word| !ends(word));
    let phrase: Vec<&str> = phrase.copied().collect();
    match phrase.as_slice() {
        [first, a, or, b] if is(first, "EITHER") && is(or, "OR") => {
            Some(format!("write `({input} IS {a} OR {input} IS {b})`"))
        }
        [first, a, nor, b] if is(first, "NEITHER") && (is(nor, "NOR") || is(nor, "OR")) => {
            Some(format!("write `{input} IS NOT {a} AND {input} IS NOT {b}`"))
        }
        [first, low, and, high, ..] if is(first, "BETWEEN") && is(and, "AND") => {
            Some(between(input, low, high, known))
        }
        _ => {
            let (side, term) = side_of_words(&phrase)?;
            Some(compared(input, side, term, known))
        }
    }
}

/// Returns a suggestion for `temperature IS more than mild`; `rest` begins with `than`.
pub(super) fn than(before: &str, rest: &str, known: KnownNames<'_>) -> Option<String> {
    let input = last_input(before)?;
    let more = before.split_whitespace().next_back()?;
    let words: Vec<&str> = core::iter::once(more)
        .chain(rest.split_whitespace())
        .collect();
    let (side, term) = side_of_words(&words)?;
    Some(compared(input, side, term, known))
}

/// Returns a suggestion if `IS` is missing after the name of an input or an output; `before` is the text before the
/// name.
pub(super) fn is_missing(
    kind: &str,
    name: &str,
    rest: &str,
    before: &str,
    known: KnownNames<'_>,
) -> Option<String> {
    let owner = |kind: &str, term: &str| known.owner(kind, term);
    let found = found_here(rest);
    // For example `IF "temperature IS cold" THEN`, and `IF temperature.cold THEN`.
    if name.starts_with(['"', '\'']) && name.to_ascii_lowercase().contains(" is ") {
        return Some("remove the quotes, which turn the condition into a single name".into());
    }
    let parts = name.match_indices(['.', '_']).find_map(|(at, _)| {
        let (of, term) = (name.get(..at)?, name.get(at + 1..)?);
        let term = term.trim_start_matches("is_");
        (owner(kind, term) == Some(of)).then_some((of, term))
    });
    if let Some((of, term)) = parts {
        return Some(format!("write `{of} IS {term}`"));
    }
    // For example `IF (temperature, cold) THEN`, and `IF temperature(cold) THEN`.
    let next = found_here(rest.trim_start_matches([',', '(', '[', '"', '\'', ' ']));
    if found.starts_with([',', '(', '[']) && owner(kind, next) == Some(name) {
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
            let input = known.inputs.first().map_or("input", |input| input.name);
            return Some(format!(
                "for a rule that always fires, write the condition `{input} IS any`"
            ));
        }
        if let Some(variable) = known.variable(name) {
            return Some(format!(
                "write `{name} IS` followed by a term: {}",
                one_of(&variable.terms)
            ));
        }
        // In `x IS low OR high`, the name is a term of the input in the previous condition, or of another input.
        let connective = before.split_whitespace().next_back().unwrap_or("");
        let of = owner(kind, name);
        return Some(match last_input(before) {
            _ if kind == "output"
                && let Some(of) = of =>
            {
                format!("write `{of} IS {name}`")
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
                None => format!("write `{name} IS` followed by a term"),
            },
        });
    }
    let is = |word: &str| found.eq_ignore_ascii_case(word);
    if let Some(help) = phrase_after_name(name, rest, before) {
        return Some(help);
    }
    if name.eq_ignore_ascii_case("ELSE") {
        return Some("remove `ELSE`".into());
    }
    let behind = rest.get(found.len()..).unwrap_or("").trim_start();
    let next = found_here(behind);
    if let Some(side) = side_of_sign(found) {
        return Some(compared(name, side, next, known));
    }
    // For example `x BETWEEN cold AND mild`.
    if is("BETWEEN") {
        let words: Vec<&str> = behind.split_whitespace().collect();
        return Some(match words.as_slice() {
            [low, and, high, ..] if and.eq_ignore_ascii_case("AND") => {
                between(name, low, high, known)
            }
            _ => not_a_number(name),
        });
    }
    // For example `temperature - humidity IS hot`.
    if found.starts_with(['-', '+', '*', '/'])
        && is_plain_name(next)
        && next.parse::<f64>().is_err()
    {
        return Some(format!(
            "a condition names one input: define an additional input for `{name} {found} {next}`, with its own range and terms, and use it here"
        ));
    }
    if found.starts_with(['-', '+', '*', '/']) {
        return Some(not_a_number(name));
    }
    if found.starts_with('[') {
        return Some(format!("write `{name} IS term`"));
    }
    // For example `fan = 2 * temperature` and `temperature = 30`.
    if found.starts_with('=') {
        let value = rest.trim_start_matches('=').trim();
        let value = value.split(" WITH ").next().unwrap_or(value);
        let first = value.split_whitespace().next().unwrap_or("");
        if kind == "input" && first.parse::<f64>().is_ok() {
            return Some(not_a_number(name));
        }
        if kind == "output" && !is_plain_name(value) || first.parse::<f64>().is_ok() {
            let is_formula = value.parse::<f64>().is_err() && value.parse::<Formula>().is_ok();
            let (given, term) = match is_formula {
                true => ("formula", format!("a term with `{{function: {value}}}`")),
                false => ("number", format!("a term for {first}")),
            };
            return Some(format!(
                "a conclusion names a term, not a {given}: add {term} to `{name}`, and write `{name} IS` followed by the name of that term"
            ));
        }
    }
    let behind = rest.get(found.len()..).unwrap_or("");
    if Hedge::ALL.iter().any(|hedge| is(hedge.word())) {
        let next = found_here(behind.trim_start());
        return Some(format!("write `{name} IS {found} {next}`"));
    }
    // For example `IF hot temperature THEN`.
    if owner(kind, name) == Some(found) {
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
            None if name.eq_ignore_ascii_case("SET") => {
                let term = behind_next.split_whitespace().next();
                match term.filter(|_| next.eq_ignore_ascii_case("TO")) {
                    Some(term) => format!("write `{found} IS {term}`"),
                    None => format!("write `{found} IS` followed by a term"),
                }
            }
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
            "put a name with spaces in quotes: `\"{name} {found}\"`"
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
            "a rule reads the current value of `{name}`, not how it changes: add an input for its rate of change, and use a term of that input"
        ));
    }
    if found.eq_ignore_ascii_case("IN") {
        return in_list(name, behind, false);
    }
    if found.eq_ignore_ascii_case("NOT")
        && let Some(list) = keyword(behind, "IN")
    {
        return in_list(name, list, true);
    }
    if found.eq_ignore_ascii_case("NOT")
        && let Some(behind) = keyword(behind, "IS")
    {
        let term = found_here(behind.trim_start());
        return Some(format!("write `{name} IS NOT {term}`"));
    }
    let input = last_input(before).unwrap_or("input");
    more_or_less(before, name).map(|_| format!("write `{input} IS somewhat {found}`"))
}

/// Returns a suggestion for `temperature IN (mild, hot)`; `list` begins with the bracket.
pub(super) fn in_list(input: &str, list: &str, negated: bool) -> Option<String> {
    let list = list.trim_start().strip_prefix(['(', '[', '{'])?;
    let terms = list
        .split([')', ']', '}'])
        .next()?
        .split(',')
        .map(str::trim);
    let terms = terms.filter(|term| is_plain_name(term));
    let parts: Vec<String> = terms.map(|term| format!("{input} IS {term}")).collect();
    let not = if negated { "NOT " } else { "" };
    (!parts.is_empty()).then(|| format!("write `{not}({})`", parts.join(" OR ")))
}
