//! Terms that are defined by their limits: `steps: {fine: 36, stretched: 43, over: }`.

use alloc::{format, string::String, vec::Vec};

use super::{TermSpans, VariableSpans, terms::unread};
use crate::{
    diagnostic::{Diagnostic, Severity},
    model::{Variable, between_limits},
    tree::{Entry, Node, Value},
};

const HELP: &str =
    "give each term except the last its upper limit: `steps: {low: 10, medium: 20, high: }`";

/// Reads the terms of a variable that are defined by limits.
pub(super) fn read(
    what: &str,
    node: &Node,
    variable: &mut Variable,
    spans: &mut VariableSpans,
    findings: &mut Vec<Diagnostic>,
) {
    spans.steps = node.span.clone();
    let Value::Mapping(_) = &node.value else {
        let finding = node.unexpected(&format!(
            "a mapping from terms to their upper limits for `steps` of {what}"
        ));
        let help = of_names(node, variable);
        findings.push(finding.help(help.unwrap_or_else(|| HELP.into())));
        return;
    };
    let before = findings.len();
    let entries = node
        .entries(what, "term", HELP, findings)
        .unwrap_or_default();
    let mut steps: Vec<(Entry<'_>, Option<f64>)> = Vec::with_capacity(entries.len());
    for entry in entries {
        let limit = limit(what, &entry, findings);
        steps.push((entry, limit));
    }
    if findings.len() == before {
        order(what, node, &steps, variable, findings);
    }
    if findings.len() == before {
        // Formats that sort keys do not preserve the order in which the terms were written.
        let by_limit = |limit: Option<f64>| limit.unwrap_or(f64::INFINITY);
        steps.sort_by(|(_, a), (_, b)| by_limit(*a).total_cmp(&by_limit(*b)));
        check(what, node, &steps, variable, findings);
    }
    let has_errors = {
        let mut found = findings.iter().skip(before);
        found.any(|finding| finding.severity == Severity::Error)
    };
    let has_range = variable.low < variable.high;
    for (entry, limit) in &steps {
        spans.terms.push(TermSpans {
            name: entry.key_span.clone(),
            numbers: limit
                .iter()
                .map(|_| number(entry.value).span.clone())
                .collect(),
            unread: has_errors || !has_range,
            ..TermSpans::default()
        });
    }
    let names = steps.iter().map(|(entry, _)| entry.key);
    variable.terms = match steps.split_last() {
        Some(((last, _), below)) if !has_errors && has_range => {
            let below = below.iter();
            let below = below.filter_map(|(entry, limit)| Some((entry.key, (*limit)?)));
            let below: Vec<(&str, f64)> = below.collect();
            between_limits(variable.low, variable.high, &below, last.key)
        }
        _ => names.map(unread).collect(),
    };
    spans.terms_unread = variable.terms.is_empty();
}

/// Returns a suggestion for a list of names, `[low, high]`, with evenly spaced limits.
fn of_names(node: &Node, variable: &Variable) -> Option<String> {
    let Value::List(items) = &node.value else {
        return None;
    };
    let names: Vec<&str> = items.iter().map(Node::as_text).collect::<Option<_>>()?;
    if items.iter().any(|item| item.as_number_text().is_some()) {
        return None;
    }
    let (last, below) = names.split_last()?;
    let width = (variable.high - variable.low) / names.len() as f64;
    let limit = |i: usize| libm::round(1e3 * (variable.low + width * (i + 1) as f64)) / 1e3;
    let terms = below.iter().enumerate();
    let terms: Vec<String> = terms
        .map(|(i, name)| format!("{name}: {}", limit(i)))
        .collect();
    (width > 0.0 && width.is_finite() && !terms.is_empty()).then(|| {
        let terms = terms.join(", ");
        format!("give each term except the last its upper limit: `steps: {{{terms}, {last}: }}`")
    })
}

/// Reads the limit of a term: a number, null, or `{below: 36}` as in the lists of serde.
fn limit(what: &str, entry: &Entry<'_>, findings: &mut Vec<Diagnostic>) -> Option<f64> {
    let limit = format!("the limit of term `{}` of {what}", entry.key);
    let number = match &entry.value.value {
        Value::Mapping(_) => {
            let fields = entry.value.fields(&limit, &["below"], HELP, findings)?;
            fields.get("below")?
        }
        _ if entry.value.is_null() => return None,
        _ => entry.value,
    };
    let before = findings.len();
    let found = number.finite(&limit, findings);
    if let Some(finding) = findings.get_mut(before)
        && let Some(help) = advice(entry.key, number)
    {
        finding.help = Some(help);
    }
    found
}

/// Returns a suggestion for a limit such as `[0, 30]`, `<30` or `inf`.
fn advice(term: &str, limit: &Node) -> Option<String> {
    let Some(text) = limit.as_text() else {
        return matches!(limit.value, Value::List(_)).then(|| HELP.into());
    };
    // For example `30..60`: the end of the term is its limit.
    let range = text.rsplit_once("..").or_else(|| text.rsplit_once('-'));
    let end = range
        .filter(|(low, _)| low.trim().parse::<f64>().is_ok())
        .map(|(_, end)| end.trim());
    let number = end.unwrap_or(text).trim_start_matches(['<', '=', '≤', ' ']);
    let limit = number.parse::<f64>().ok();
    let is_open = text.starts_with(['>', '≥'])
        || limit.is_some_and(|limit| !limit.is_finite())
        || limit.is_none() && text.to_ascii_lowercase().contains("inf");
    match is_open {
        true => Some(format!(
            "the last term extends to the end of the range: write `{term}:` without a limit"
        )),
        false => limit.map(|_| format!("write `{term}: {number}`")),
    }
}

/// Returns the node that contains the number of a limit.
fn number(value: &Node) -> &Node {
    match &value.value {
        Value::Mapping(entries) => entries.first().map_or(value, |(_, number)| number),
        _ => value,
    }
}

/// Reports a term without a limit that is not the last one, a first limit that is not above the low end of the range,
/// and limits that decrease in the order of the text. In the first two cases, the author probably wrote where each
/// term begins instead of where it ends. Trees of formats that sort keys have no positions, and are not examined.
fn order(
    what: &str,
    node: &Node,
    steps: &[(Entry<'_>, Option<f64>)],
    variable: &Variable,
    findings: &mut Vec<Diagnostic>,
) {
    if node.span.is_empty() {
        return;
    }
    let mut error = |code, span, message| {
        let help = in_order(steps);
        findings.push(Diagnostic::error(code, span, message).help(help));
    };
    let last = steps.len().saturating_sub(1);
    let limits: Vec<f64> = steps.iter().filter_map(|(_, limit)| *limit).collect();
    let open = steps.iter().position(|(_, limit)| limit.is_none());
    if let (Some((entry, None)), 1..) = (steps.get(open.unwrap_or(last)), limits.len())
        && open != Some(last)
        && limits.len() == last
    {
        let message = format!(
            "the term `{}` in the steps of {what} has no limit, but only the last term may omit it",
            entry.key
        );
        error("wrong-parameter", entry.key_span.clone(), message);
    } else if let Some((entry, Some(limit))) = steps.first()
        && *limit <= variable.low
        && open.is_none()
    {
        let message = format!(
            "the limit {limit} of the first term `{}` of {what} is not above the minimum of the range, which leaves no room for the term",
            entry.key
        );
        error("wrong-parameter", entry.value.span.clone(), message);
    } else {
        for pair in steps.windows(2) {
            if let [(left, Some(high)), (right, Some(low))] = pair
                && low < high
            {
                let message = format!(
                    "the limit {low} of term `{}` of {what} is less than {high}, the limit of the term before it, `{}`",
                    right.key, left.key
                );
                let help = "write the terms in ascending order: each limit must be greater than the one before it";
                let span = right.value.span.clone();
                let finding = Diagnostic::error("inverted-parameters", span, message);
                findings.push(finding.help(help));
            }
        }
    }
}

/// Returns a suggestion for numbers that are the beginnings of terms: each number becomes the limit of the term before
/// it.
fn in_order(steps: &[(Entry<'_>, Option<f64>)]) -> String {
    let names = steps.iter().map(|(entry, _)| entry.key);
    let limits: Vec<f64> = steps.iter().filter_map(|(_, limit)| *limit).collect();
    let from = (limits.len() + 1).saturating_sub(steps.len());
    let mut ends = limits.iter().skip(from);
    let terms = names.map(|name| match ends.next() {
        Some(end) => format!("{name}: {end}"),
        None => format!("{name}: "),
    });
    let terms: Vec<String> = terms.collect();
    format!(
        "a limit is where its term ends, not where it begins: write `steps: {{{}}}`",
        terms.join(", ")
    )
}

/// Reports limits that do not divide the range into the terms; `steps` must be sorted.
fn check(
    what: &str,
    node: &Node,
    steps: &[(Entry<'_>, Option<f64>)],
    variable: &Variable,
    findings: &mut Vec<Diagnostic>,
) {
    let mut wrong = |span, code, message, help: &str| {
        findings.push(Diagnostic::error(code, span, message).help(help));
    };
    if steps.len() < 2 {
        let message = format!("the steps of {what} need at least two terms");
        let help =
            "add a term, and give each term except the last a limit: `steps: {low: 10, high: }`";
        wrong(node.span.clone(), "wrong-parameter", message, help);
        return;
    }
    if let Some((entry, Some(limit))) = steps.last() {
        let name = entry.key;
        let message = format!(
            "the last term `{name}` in the steps of {what} must not have a limit, but has {limit}"
        );
        let help = format!(
            "the last term extends to the end of the range: write `{name}:` without a limit, or add a term after it"
        );
        wrong(entry.value.span.clone(), "wrong-parameter", message, &help);
    }
    for pair in steps.windows(2) {
        let [(left, below), (right, above)] = pair else {
            continue;
        };
        let (name, other) = (right.key, left.key);
        let span = right.value.span.clone();
        match (below, above) {
            (None, None) => {
                let message = format!(
                    "the terms `{other}` and `{name}` of {what} have no limit, but only the last term may omit it"
                );
                let help = format!("write a limit for `{other}`");
                wrong(right.key_span.clone(), "wrong-parameter", message, &help);
                break;
            }
            (Some(below), Some(above)) if below == above => {
                let message = format!(
                    "the terms `{other}` and `{name}` of {what} have the same limit, {above}"
                );
                wrong(
                    span,
                    "inverted-parameters",
                    message,
                    "make each limit greater than the one before it",
                );
            }
            _ => {}
        }
    }
    let (low, high) = (variable.low, variable.high);
    for (entry, limit) in steps {
        if let Some(limit) = limit
            && low < high
            && (*limit <= low || *limit > high)
        {
            let message = format!(
                "the limit {limit} of term `{}` is not between the ends of the range [{low}, {high}] of {what}",
                entry.key
            );
            let span = entry.value.span.clone();
            wrong(
                span,
                "term-outside-range",
                message,
                "widen the range or move the limit",
            );
        }
    }
}
