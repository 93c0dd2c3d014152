//! Suggestions for comparisons in conditions: `temperature > 30`, `temperature IS at least mild`, `BETWEEN cold AND hot`.

use alloc::{format, string::String, vec::Vec};

use super::{
    KnownNames,
    words::{found_here, quoted_name},
};
use crate::diagnostic::listed;

/// The side of a term on which the intended terms are.
#[derive(Clone, Copy, PartialEq)]
pub(super) enum Side {
    Below,
    AtMost,
    AtLeast,
    Above,
}

/// Returns the side that a sign refers to.
pub(super) fn side_of_sign(sign: &str) -> Option<Side> {
    Some(match sign {
        "<" => Side::Below,
        "<=" | "=<" | "≤" => Side::AtMost,
        ">=" | "=>" | "≥" => Side::AtLeast,
        ">" => Side::Above,
        _ => return None,
    })
}

/// Returns the side that words such as `at least` refer to, and the word after them.
pub(super) fn side_of_words<'a>(words: &[&'a str]) -> Option<(Side, &'a str)> {
    let is = |word: &str, known: &[&str]| known.iter().any(|one| word.eq_ignore_ascii_case(one));
    let side = |word: &str| match word {
        _ if is(word, &["above", "over", "more", "greater", "higher"]) => Some(Side::Above),
        _ if is(word, &["below", "under", "less", "smaller", "lower"]) => Some(Side::Below),
        _ => None,
    };
    match *words {
        [at, least, term, ..] if is(at, &["at"]) && is(least, &["least"]) => {
            Some((Side::AtLeast, term))
        }
        [at, most, term, ..] if is(at, &["at"]) && is(most, &["most"]) => {
            Some((Side::AtMost, term))
        }
        [more, than, term, ..] if is(than, &["than"]) => Some((side(more)?, term)),
        [above, term, ..] => Some((side(above)?, term)),
        _ => None,
    }
}

/// Returns the suggestion for a number in a condition.
pub(super) fn not_a_number(input: &str) -> String {
    format!(
        "a condition names a term, not a number: add a term to `{input}` that covers this value, and write `{input} IS` followed by the name of that term"
    )
}

/// Returns a suggestion for a comparison of an input with a term or a number.
pub(super) fn compared(input: &str, side: Side, term: &str, known: KnownNames<'_>) -> String {
    let terms = known.terms(input);
    let Some(at) = terms
        .iter()
        .position(|known| known.eq_ignore_ascii_case(term))
    else {
        return not_a_term(input, term, terms);
    };
    let (range, words) = match side {
        Side::Below => (0..at, "below"),
        Side::AtMost => (0..at + 1, "at most"),
        Side::AtLeast => (at..terms.len(), "at least"),
        Side::Above => (at + 1..terms.len(), "above"),
    };
    match terms.get(range).unwrap_or_default() {
        [] => format!(
            "no term of `{input}` is {words} `{term}`; its terms are {}",
            listed(terms)
        ),
        some => format!("write `{}`", any_of(input, some)),
    }
}

/// Returns a suggestion for `BETWEEN cold AND hot`.
pub(super) fn between(input: &str, low: &str, high: &str, known: KnownNames<'_>) -> String {
    let terms = known.terms(input);
    let high = found_here(high);
    let at = |term: &str| {
        terms
            .iter()
            .position(|known| known.eq_ignore_ascii_case(term))
    };
    match (at(low), at(high)) {
        (Some(low), Some(high)) => {
            let some = terms.get(low.min(high)..=low.max(high)).unwrap_or_default();
            format!("write `{}`", any_of(input, some))
        }
        (Some(_), None) => not_a_term(input, high, terms),
        _ => not_a_term(input, low, terms),
    }
}

/// Returns the suggestion for a word that is not a term of the input; `terms` are empty if they are unknown.
fn not_a_term(input: &str, word: &str, terms: &[&str]) -> String {
    match terms {
        _ if word.parse::<f64>().is_ok() => not_a_number(input),
        [] => format!("a condition names a term: write `{input} IS term`"),
        _ => format!(
            "`{input}` has no term `{word}`; its terms are {}",
            listed(terms)
        ),
    }
}

/// Formats a condition that any of the terms fulfils.
fn any_of(input: &str, terms: &[&str]) -> String {
    let parts = terms
        .iter()
        .map(|term| format!("{input} IS {}", quoted_name(term)));
    let parts: Vec<String> = parts.collect();
    match parts.as_slice() {
        [only] => only.clone(),
        parts => format!("({})", parts.join(" OR ")),
    }
}
