//! Suggestions for the terms and keys of a variable that are written in another notation.

use alloc::{format, string::String, vec::Vec};

use super::{TermSpans, VariableSpans, terms::unread};
use crate::{
    diagnostic::Diagnostic,
    model::{Defuzzifier, Term, Variable},
    tree::{Entry, Node, Value},
};

/// If all terms are plain numbers (`terms: {low: 0, high: 10}`), reports a single error and returns true.
pub(super) fn bare_numbers(
    what: &str,
    entry: &Entry<'_>,
    is_weighted: bool,
    variable: &mut Variable,
    spans: &mut VariableSpans,
    findings: &mut Vec<Diagnostic>,
) -> bool {
    let Value::Mapping(pairs) = &entry.value.value else {
        return false;
    };
    let numbers = pairs
        .iter()
        .filter_map(|(key, value)| Some((key, key.as_text()?, value.as_number_text()?)));
    let numbers: Vec<(&Node, &str, &str)> = numbers.collect();
    if entry.key != "terms" || numbers.is_empty() || numbers.len() != pairs.len() {
        return false;
    }
    let list = |part: fn(&str, &str) -> String| {
        let parts: Vec<String> = numbers
            .iter()
            .map(|(_, name, number)| part(name, number))
            .collect();
        parts.join(", ")
    };
    let peaks = list(|name, number| format!("{name}: {number}"));
    let help = match is_weighted {
        true => format!(
            "write `terms: {{{}}}`",
            list(|name, number| format!("{name}: {{constant: {number}}}"))
        ),
        false => format!(
            "for peaks write `partition: {{{peaks}}}`; a term is a membership function: `{{triangle: [0, 1, 2]}}`"
        ),
    };
    let message = format!("the terms of {what} are numbers, not membership functions");
    let span = entry.value.span.clone();
    findings.push(Diagnostic::error("wrong-type", span, message).help(help));
    for (key, name, _) in numbers {
        variable.terms.push(unread(name));
        spans.terms.push(TermSpans {
            name: key.span.clone(),
            unread: true,
            ..TermSpans::default()
        });
    }
    spans.terms_unread = false;
    true
}

/// Returns a suggestion for peaks in a list, `[cold: 10, hot: 35]`.
pub(super) fn peaks_in_list(items: &[Node]) -> Option<String> {
    let peaks = items.iter().map(|item| match &item.value {
        Value::Mapping(pairs) => match pairs.as_slice() {
            [(key, value)] => Some(format!("{}: {}", key.as_text()?, value.as_text()?)),
            _ => None,
        },
        _ => None,
    });
    let peaks: Vec<String> = peaks.collect::<Option<_>>()?;
    (!peaks.is_empty()).then(|| {
        format!(
            "write braces in place of brackets: `{{{}}}`",
            peaks.join(", ")
        )
    })
}

/// Returns a suggestion for a `partition` that contains membership functions, or intervals such as `{cold: [0, 10],
/// hot: [10, 40]}`.
pub(super) fn other_terms(entries: &[Entry<'_>]) -> Option<String> {
    if entries
        .iter()
        .all(|entry| matches!(entry.value.value, Value::Mapping(_)))
    {
        return (!entries.is_empty())
            .then(|| "for membership functions, write `terms` in place of `partition`".into());
    }
    if let Some(terms) = corners(entries) {
        return Some(format!(
            "write `terms: {{{terms}}}` in place of `partition`"
        ));
    }
    let ends = entries.iter().map(|entry| match &entry.value.value {
        Value::List(ends) => match ends.as_slice() {
            [low, high] => low.as_number_text().and(high.as_number_text()),
            _ => None,
        },
        _ => None,
    });
    let ends: Vec<&str> = ends.collect::<Option<_>>()?;
    let last = entries.len().checked_sub(1)?;
    let steps = entries
        .iter()
        .zip(ends)
        .enumerate()
        .map(|(i, (entry, end))| match i == last {
            true => format!("{}: ", entry.key),
            false => format!("{}: {end}", entry.key),
        });
    let steps: Vec<String> = steps.collect();
    Some(format!(
        "for intervals, write the upper limit of each term except the last: `steps: {{{}}}`",
        steps.join(", ")
    ))
}

/// Returns the terms whose corners are the lists of a partition such as `{cold: [0, 0, 20], hot: [20, 40, 40]}`.
fn corners(entries: &[Entry<'_>]) -> Option<String> {
    let terms = entries.iter().map(|entry| {
        let Value::List(items) = &entry.value.value else {
            return None;
        };
        let shape = match items.len() {
            3 => "triangle",
            4 => "trapezoid",
            _ => return None,
        };
        Some(format!(
            "{}: {{{shape}: {}}}",
            entry.key,
            entry.value.to_line()
        ))
    });
    let terms: Vec<String> = terms.collect::<Option<_>>()?;
    (!terms.is_empty()).then(|| terms.join(", "))
}

/// Returns a suggestion for a partition such as `{dry, wet}`, which YAML reads as names without peaks.
pub(super) fn without_peaks(entries: &[Entry<'_>]) -> Option<String> {
    let are_bare = entries.iter().all(|entry| entry.value.is_null());
    let names: Vec<&str> = entries.iter().map(|entry| entry.key).collect();
    (are_bare && !names.is_empty()).then(|| {
        let names = names.join(", ");
        format!("give each term a peak, or write a list for evenly spaced peaks: `[{names}]`")
    })
}

/// Returns a suggestion for peaks such as `{cold:10, hot: 35}` or `{cold=10, hot=35}`, which YAML reads as names.
pub(super) fn colons_without_space(entries: &[Entry<'_>]) -> Option<String> {
    let peaks = entries.iter().map(|entry| {
        if let Some(peak) = entry.value.as_number_text() {
            return Some(format!("{}: {peak}", entry.key));
        }
        let (name, peak) = entry.key.split_once([':', '='])?;
        peak.trim().parse::<f64>().ok()?;
        entry
            .value
            .is_null()
            .then(|| format!("{}: {}", name.trim(), peak.trim()))
    });
    let peaks: Vec<String> = peaks.collect::<Option<_>>()?;
    let has_joined = entries.iter().any(|entry| entry.value.is_null());
    has_joined.then(|| format!("write `{{{}}}`", peaks.join(", ")))
}

/// Returns the defuzzifier that fits the terms of a variable, for use in place of an unknown word.
pub(super) fn likely_defuzzifier(variable: &Variable) -> Option<Defuzzifier> {
    let is_number = |term: &Term| term.membership_function.number().is_some();
    let mut terms = variable.terms.iter();
    terms.any(is_number).then_some(Defuzzifier::WeightedAverage)
}

/// Returns a suggestion for a value of `when_no_rule_fires` that is a word of another program.
pub(super) fn suggestion_for_word(word: &str) -> Option<String> {
    let is = |words: &[&str]| words.iter().any(|known| word.eq_ignore_ascii_case(known));
    if is(&["keep", "hold", "last", "nc", "no_change"]) {
        return Some("did you mean `previous`?".into());
    }
    if is(&["none", "nan", "na", "unknown"]) {
        return Some("did you mean `undefined`?".into());
    }
    let number = word.strip_prefix("value")?.trim();
    number.parse::<f64>().ok()?;
    Some(format!("write `{{value: {number}}}`"))
}
