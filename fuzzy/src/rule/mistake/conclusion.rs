//! Suggestions for the text after a conclusion, and for weights.

use alloc::{format, string::String};

use super::{
    KnownNames,
    words::{found_here, last_input},
};
use crate::{diagnostic::either, rule::is_plain_name, tree::share_of_percentage};

/// Returns a suggestion for `NOT` or `any` after `THEN`; `before` ends with `THEN output IS`.
pub(super) fn terms_of_conclusion(before: &str, known: KnownNames<'_>) -> String {
    let output = last_input(before).and_then(|name| known.variable(name));
    match output {
        Some(output) => format!(
            "write one of the terms of `{}`: {}",
            output.name,
            either(&output.terms)
        ),
        None => "write one of the terms of the output, such as `IS low` or `IS very low`".into(),
    }
}

/// Returns the text of the condition, and the text after `THEN`.
fn parts(before: &str) -> Option<(&str, &str)> {
    let folded = before.to_ascii_lowercase();
    let then = folded.find(" then ")?;
    let condition = before.get(..then)?.trim().get(2..)?.trim();
    Some((condition, before.get(then + 6..)?.trim()))
}

/// Returns a suggestion for a weight such as `50%` or `weight 0.5`.
pub(super) fn weight_advice(rest: &str) -> String {
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

/// Returns a suggestion for text after a conclusion or after its weight.
pub(super) fn after_conclusion(before: &str, rest: &str, weighted: bool) -> Option<String> {
    let found = found_here(rest);
    let number_behind = |sign: &str| {
        let number = rest.strip_prefix(sign)?.split_whitespace().next()?;
        number.parse::<f64>().ok().map(|value| (number, value))
    };
    if let Some((number, value)) = number_behind("*")
        && (0.0..=1.0).contains(&value)
    {
        return Some(format!("write `WITH` before the weight: `WITH {number}`"));
    }
    if let Some((_, divisor)) = number_behind("/")
        && let Some(Ok(number)) = before.split_whitespace().next_back().map(str::parse::<f64>)
        && (0.0..=1.0).contains(&(number / divisor))
    {
        return Some(format!(
            "write the weight as a decimal number: `WITH {}`",
            number / divisor
        ));
    }
    let is = |word: &str| found.eq_ignore_ascii_case(word);
    let behind = rest.get(found.len()..).unwrap_or("").trim();
    if is("else") {
        return Some(match parts(before) {
            Some((condition, _)) => {
                format!(
                    "rules have no `ELSE`: write a second rule, `IF NOT ({condition}) THEN {behind}`"
                )
            }
            None => "rules have no `ELSE`: write a second rule with `NOT`".into(),
        });
    }
    if found == "-"
        && behind
            .get(..2)
            .is_some_and(|word| word.eq_ignore_ascii_case("if"))
    {
        return Some(
            "if this `-` is to begin a new rule, align it with the `-` of the rules above".into(),
        );
    }
    if is("or") {
        return Some(
            "conclusions can only be joined with `AND`; instead of `OR`, write two rules".into(),
        );
    }
    if is("if") || is("when") {
        let is_rule = behind.to_ascii_lowercase().contains(" then ");
        return Some(match parts(before).filter(|_| !is_rule) {
            Some((condition, conclusion)) => {
                format!(
                    "write all conditions before `THEN`: `IF {condition} AND {behind} THEN {conclusion}`"
                )
            }
            None => "begin the next rule on a line of its own: `- IF ...`".into(),
        });
    }
    if is("then") {
        return Some("join conclusions with `AND`, or write a second rule".into());
    }
    if is("unless") || is("except") {
        return Some(format!(
            "rules have no `{}`: write `AND NOT ({behind})` before `THEN`",
            found.to_ascii_uppercase()
        ));
    }
    if ["weight", "weighted", "weights", "confidence", "cf"]
        .iter()
        .any(|word| is(word))
    {
        let mut words = rest.split_whitespace().skip(1);
        let number = words
            .find(|word| word.parse::<f64>().is_ok())
            .unwrap_or("0.5");
        return Some(format!("write `WITH` before the weight: `WITH {number}`"));
    }
    let number = rest.trim_start_matches([',', '(', '[', ' ']);
    let end = number.find(|c: char| !c.is_ascii_digit() && c != '.');
    let number = number.get(..end.unwrap_or(number.len())).unwrap_or("");
    let whole = before.split_whitespace().next_back().unwrap_or("");
    if rest.starts_with(',') && !number.is_empty() && whole.parse::<u64>().is_ok() {
        return Some(format!("write a decimal point: `WITH {whole}.{number}`"));
    }
    match found {
        "," => Some("write `AND` in place of the comma".into()),
        ";" => Some("remove the semicolon".into()),
        "(" | "[" if number.parse::<f64>().is_ok() => {
            Some(format!("write `WITH` before the weight: `WITH {number}`"))
        }
        "(" | "%" | "[" => Some("write `WITH` before the weight: `WITH 0.8`".into()),
        _ if weighted => Some("remove everything after the weight".into()),
        _ if is_plain_name(found) => {
            let last = before.split_whitespace().next_back().unwrap_or("");
            Some(format!(
                "put a name with spaces in quotes: `\"{last} {found}\"`"
            ))
        }
        _ => None,
    }
}
