//! Reading the partition of a variable: names of terms, evenly spaced or with their peaks.

use alloc::{collections::BTreeMap, format, vec::Vec};
use core::ops::Range;

use super::{
    TermSpans, VariableSpans,
    notation::{colons_without_space, other_terms, peaks_in_list, without_peaks},
    terms::unread,
};
use crate::{
    diagnostic::{Diagnostic, duplicate},
    model::{Variable, between_peaks, even_peaks},
    tree::{Entry, Node, Value},
};

const HELP: &str =
    "write `[low, medium, high]` for even spacing, or peaks: `{low: 0, medium: 0.1, high: 1}`";

/// Reads `{low: 0, high: 1}` (peaks) or `[low, high]` (evenly spaced over the range).
pub(super) fn read(
    what: &str,
    node: &Node,
    variable: &mut Variable,
    spans: &mut VariableSpans,
    findings: &mut Vec<Diagnostic>,
) {
    spans.partition = node.span.clone();
    let mut count = node.children();
    let mut names: Vec<(&str, &Node)> = Vec::new();
    let mut seen: BTreeMap<&str, &Node> = BTreeMap::new();
    let mut peaks: Option<Vec<f64>> = None;
    match &node.value {
        Value::List(items) => {
            if let Some(help) = peaks_in_list(items) {
                let finding = node.unexpected(&format!("a mapping for the partition of {what}"));
                findings.push(finding.help(help));
                return;
            }
            count = items.len();
            for item in items {
                let Some(name) = item.words(&format!("a term of {what}"), HELP, findings) else {
                    continue;
                };
                if let Some(first) = seen.insert(&name.text, item) {
                    let (span, first) = (item.span.clone(), first.span.clone());
                    findings.push(duplicate("term", &name.text, what, span, first));
                    continue;
                }
                names.push((&name.text, item));
            }
            if variable.low < variable.high && (variable.high - variable.low).is_finite() {
                peaks = Some(even_peaks(variable.low, variable.high, names.len()).collect());
            }
            spans.terms = term_spans(names.iter().map(|(_, item)| &item.span));
        }
        Value::Mapping(_) => {
            let entries = node.entries(what, "term", HELP, findings);
            let mut entries = entries.unwrap_or_default();
            if let Some(help) = colons_without_space(&entries) {
                let message =
                    format!("a space is missing after a colon in the partition of {what}");
                let span = node.span.clone();
                findings.push(Diagnostic::error("yaml-syntax", span, message).help(help));
                return;
            }
            if let Some(help) = without_peaks(&entries).or_else(|| other_terms(&entries)) {
                let message = format!("each term in the partition of {what} needs a peak");
                let span = node.span.clone();
                findings.push(Diagnostic::error("wrong-type", span, message).help(help));
                spans.terms = term_spans(entries.iter().map(|entry| &entry.key_span));
                spans.terms.iter_mut().for_each(|term| term.unread = true);
                variable.terms = entries.iter().map(|entry| unread(entry.key)).collect();
                spans.terms_unread = false;
                return;
            }
            let mut found = Vec::new();
            for entry in &entries {
                let peak = format!("the peak of term `{}` of {what}", entry.key);
                let before = findings.len();
                found.extend(entry.value.finite(&peak, findings));
                if matches!(entry.value.value, Value::Mapping(_) | Value::List(_))
                    && let Some(finding) = findings.get_mut(before)
                {
                    finding.help = Some(format!(
                        "write a peak, such as `{}: 0`, or give each term a membership function and write `terms` in place of `partition`",
                        entry.key
                    ));
                }
                // `{warm: 20,5}` is parsed as a term `5` without a peak.
                if entry.is_rest_of_a_number()
                    && let Some(finding) = findings.get_mut(before)
                {
                    let whole = entries
                        .iter()
                        .take_while(|one| one.key_span != entry.key_span)
                        .last();
                    if let Some(whole) = whole
                        && let Some(number) = whole.value.as_text()
                    {
                        finding.message = format!("`{number},{}` is not a number", entry.key);
                        finding.help =
                            Some(format!("write a decimal point: `{number}.{}`", entry.key));
                        finding.span = whole.value.span.start..entry.key_span.end;
                    }
                }
            }
            if found.len() == entries.len() {
                let mut peaks_of: Vec<_> = entries.into_iter().zip(found).collect();
                falling(what, &peaks_of, findings);
                // Formats that sort keys do not preserve the order in which the terms were written.
                peaks_of.sort_by(|(_, a), (_, b)| a.total_cmp(b));
                (entries, found) = peaks_of.into_iter().unzip();
                names = entries.iter().map(|one| (one.key, one.value)).collect();
                if rising(what, &names, &found, variable, findings) {
                    peaks = Some(found);
                }
            } else {
                names = entries.iter().map(|one| (one.key, one.value)).collect();
            }
            spans.terms = term_spans(entries.iter().map(|entry| &entry.key_span));
            for (term, entry) in spans.terms.iter_mut().zip(&entries) {
                term.numbers.push(entry.value.span.clone());
            }
        }
        Value::Scalar(_) => {
            let finding = node.unexpected(&format!("terms for the partition of {what}"));
            findings.push(finding.help(HELP));
            return;
        }
    }
    if names.len() < 2 {
        peaks = None;
    }
    if count < 2 {
        let message = format!("the partition of {what} needs at least two terms");
        findings.push(
            Diagnostic::error("wrong-parameter", node.span.clone(), message).help(
                "add a term, or write a single term with its membership function under `terms`",
            ),
        );
    }
    let names = names.iter().map(|(name, _)| *name);
    match peaks {
        Some(peaks) => {
            variable.terms = between_peaks(&names.zip(peaks).collect::<Vec<_>>());
        }
        None => {
            variable.terms = names.map(unread).collect();
            spans.terms.iter_mut().for_each(|term| term.unread = true);
        }
    }
    spans.terms_unread = variable.terms.is_empty();
}

fn term_spans<'a>(names: impl Iterator<Item = &'a Range<usize>>) -> Vec<TermSpans> {
    let spans = names.map(|name| TermSpans {
        name: name.clone(),
        ..TermSpans::default()
    });
    spans.collect()
}

/// Warns about peaks that decrease in the order of the text, because one of them may be a mistake.
fn falling(what: &str, peaks: &[(Entry<'_>, f64)], findings: &mut Vec<Diagnostic>) {
    for pair in peaks.windows(2) {
        if let [(left, high), (right, low)] = pair
            && low < high
        {
            let (name, other) = (right.key, left.key);
            let message = format!(
                "the peak {low} of `{name}` of {what} is left of the peak {high} of `{other}`"
            );
            findings.push(
                Diagnostic::warning("inverted-parameters", right.value.span.clone(), message)
                    .help("write the terms of a partition from left to right; they count in the order of their peaks"),
            );
        }
    }
}

/// Reports ascending peaks of a partition that are equal or outside the range. Returns true if all peaks are valid.
fn rising(
    what: &str,
    names: &[(&str, &Node)],
    peaks: &[f64],
    variable: &Variable,
    findings: &mut Vec<Diagnostic>,
) -> bool {
    let before = findings.len();
    let mut last: Option<(&str, f64)> = None;
    for ((name, node), peak) in names.iter().zip(peaks.iter().copied()) {
        if let Some((other, least)) = last
            && peak <= least
        {
            let message =
                format!("the terms `{other}` and `{name}` of {what} have the same peak, {peak}");
            findings.push(
                Diagnostic::error("inverted-parameters", node.span.clone(), message)
                    .help("give each term of a partition a different peak"),
            );
        }
        // An inverted range is reported separately.
        let has_range = variable.low < variable.high;
        if has_range && (peak < variable.low || peak > variable.high) {
            let (low, high) = (variable.low, variable.high);
            let message = format!(
                "the peak {peak} of `{name}` is outside the range [{low}, {high}] of {what}"
            );
            findings.push(
                Diagnostic::error("term-outside-range", node.span.clone(), message)
                    .help("widen the range or move the peak"),
            );
        }
        last = Some((name, peak));
    }
    findings.len() == before
}
