//! Inputs and outputs: ranges, partitions, terms.

use alloc::{
    format,
    string::{String, ToString},
    vec::Vec,
};

use super::{VariablePlaces, optional_text, shapes, words::DEFUZZIFIERS};
use crate::{
    diagnostic::Diagnostic,
    model::{Defuzzifier, NoRuleFires, Output, Sampling, SamplingRule, Shape, Term, Variable},
    tree::{Entry, Fields, Node, Value},
};

pub(super) const INPUT_KEYS: [&str; 5] = ["description", "unit", "range", "partition", "terms"];
pub(super) const OUTPUT_KEYS: [&str; 8] = [
    "description",
    "unit",
    "range",
    "partition",
    "terms",
    "defuzzifier",
    "samples",
    "when_no_rule_fires",
];

pub(super) fn inputs(
    node: &Node,
    places: &mut Vec<VariablePlaces>,
    findings: &mut Vec<Diagnostic>,
) -> Option<Vec<Variable>> {
    let entries = node.entries("`inputs`", "variable", findings)?;
    let read = |entry: &Entry<'_>| {
        let what = format!("input `{}`", entry.key);
        let fields = entry.fields(&what, &INPUT_KEYS, findings);
        variable(&what, entry, fields.as_ref(), places, findings)
    };
    Some(entries.iter().map(read).collect())
}

pub(super) fn outputs(
    node: &Node,
    places: &mut Vec<VariablePlaces>,
    findings: &mut Vec<Diagnostic>,
) -> Option<Vec<Output>> {
    let entries = node.entries("`outputs`", "variable", findings)?;
    if entries.is_empty() {
        findings.push(
            Diagnostic::error(
                "missing-key",
                node.span.clone(),
                "the rule set has no output",
            )
            .help("write a name, a range and terms for at least one output"),
        );
        return None;
    }
    let read = |entry: &Entry<'_>| {
        let what = format!("output `{}`", entry.key);
        let fields = entry.fields(&what, &OUTPUT_KEYS, findings);
        let variable = variable(&what, entry, fields.as_ref(), places, findings);
        let mut output = Output {
            variable,
            defuzzifier: Defuzzifier::Centroid,
            samples: None,
            when_no_rule_fires: NoRuleFires::Undefined,
        };
        let Some(fields) = fields else { return output };
        if let Some(node) = fields.get("defuzzifier") {
            let word = node.choice(
                &format!("the defuzzifier of {what}"),
                &DEFUZZIFIERS,
                findings,
            );
            output.defuzzifier = word.unwrap_or(output.defuzzifier);
        }
        output.samples = fields
            .get("samples")
            .and_then(|node| samples(node, findings));
        if let Some(node) = fields.get("when_no_rule_fires") {
            let found = no_rule_fires(&what, node, &output.variable, findings);
            output.when_no_rule_fires = found.unwrap_or(NoRuleFires::Undefined);
        }
        output
    };
    Some(entries.iter().map(read).collect())
}

/// `{midpoint: 1000}`
fn samples(node: &Node, findings: &mut Vec<Diagnostic>) -> Option<Sampling> {
    let fields = match &node.value {
        Value::Mapping(_) => node.fields("`samples`", &["midpoint", "trapezoid"], findings)?,
        _ => {
            let finding = node.unexpected("a sampling rule and its number of samples");
            findings.push(finding.help("write `samples: {midpoint: 1000}` or `{trapezoid: 1001}`"));
            return None;
        }
    };
    match (fields.get("midpoint"), fields.get("trapezoid")) {
        (Some(node), None) => sampling(node, SamplingRule::Midpoint, 1, findings),
        (None, Some(node)) => sampling(node, SamplingRule::Trapezoid, 2, findings),
        _ => {
            findings.push(
                Diagnostic::error(
                    "wrong-type",
                    node.span.clone(),
                    "`samples` has one sampling rule",
                )
                .help("write `samples: {midpoint: 1000}` or `{trapezoid: 1001}`"),
            );
            None
        }
    }
}

fn sampling(
    node: &Node,
    rule: SamplingRule,
    least: u64,
    findings: &mut Vec<Diagnostic>,
) -> Option<Sampling> {
    /// More samples than this help nobody and hang the engine.
    const MOST: u64 = 10_000_000;
    let samples = node.whole("the number of samples", least, findings)?;
    if samples > MOST {
        let message = format!("{samples} samples are more than {MOST}");
        findings.push(
            Diagnostic::error("wrong-parameter", node.span.clone(), message)
                .help("leave `samples` out: the result is exact then"),
        );
        return None;
    }
    let samples = usize::try_from(samples).ok()?;
    Some(Sampling { samples, rule })
}

fn no_rule_fires(
    what: &str,
    node: &Node,
    variable: &Variable,
    findings: &mut Vec<Diagnostic>,
) -> Option<NoRuleFires> {
    let key = format!("`when_no_rule_fires` of {what}");
    if let Value::Mapping(_) = &node.value {
        let fields = node.fields(&key, &["value"], findings)?;
        let node = fields.require("value", "write `{value: 50}`", findings)?;
        let value = node.finite(&key, findings)?;
        if value < variable.low || value > variable.high {
            let message = format!("the value {value} lies outside the range of {what}");
            findings.push(
                Diagnostic::error("value-outside-range", node.span.clone(), message).help(format!(
                    "write a value from {} to {}",
                    variable.low, variable.high
                )),
            );
        }
        return Some(NoRuleFires::Value(value));
    }
    let words = [
        ("undefined", NoRuleFires::Undefined),
        ("error", NoRuleFires::Error),
    ];
    if let Value::Scalar(scalar) = &node.value
        && scalar.as_number().is_some()
    {
        findings.push(
            node.unexpected(&format!("`undefined`, `error` or a mapping for {key}"))
                .help(format!("write `{{value: {}}}`", scalar.text)),
        );
        return None;
    }
    node.choice(&key, &words, findings)
}

/// The variable as far as it can be read: its name and those of its terms stand even where the rest is wrong.
fn variable(
    what: &str,
    entry: &Entry<'_>,
    fields: Option<&Fields<'_>>,
    places: &mut Vec<VariablePlaces>,
    findings: &mut Vec<Diagnostic>,
) -> Variable {
    let mut variable = Variable {
        name: entry.key.to_string(),
        description: None,
        unit: None,
        low: f64::NAN,
        high: f64::NAN,
        terms: Vec::new(),
    };
    let mut place = VariablePlaces {
        name: entry.key_span.clone(),
        terms: Vec::new(),
    };
    if entry.key.is_empty() {
        findings.push(
            Diagnostic::error(
                "empty-name",
                entry.key_span.clone(),
                "the variable has no name",
            )
            .help("write a name before the colon"),
        );
    }
    if let Some(fields) = fields {
        variable.description = optional_text(fields, "description", findings);
        variable.unit = optional_text(fields, "unit", findings);
        let help = "write the least and the greatest value: `range: [0, 1]`";
        let range = fields.require("range", help, findings);
        if let Some((low, high)) = range.and_then(|node| self::range(what, node, findings)) {
            (variable.low, variable.high) = (low, high);
        }
        match (fields.entry("partition"), fields.entry("terms")) {
            (Some(partition), None) => {
                self::partition(what, partition.value, &mut variable, &mut place, findings);
            }
            (None, Some(terms)) => {
                self::terms(what, terms.value, &mut variable, &mut place, findings);
            }
            (Some(_), Some(terms)) => findings.push(
                Diagnostic::error(
                    "duplicate-key",
                    terms.key_span.clone(),
                    format!("{what} has both `partition` and `terms`"),
                )
                .help("keep one; all terms of a variable stand together"),
            ),
            (None, None) => {
                let help =
                    "write `partition: [low, medium, high]`, or `terms` with a shape for each";
                fields.require("terms", help, findings);
            }
        }
    }
    places.push(place);
    variable
}

fn range(what: &str, node: &Node, findings: &mut Vec<Diagnostic>) -> Option<(f64, f64)> {
    let help = "write the least and the greatest value: `range: [0, 1]`";
    let Value::List(ends) = &node.value else {
        let finding = node.unexpected(&format!("two numbers for the range of {what}"));
        findings.push(finding.help(help));
        return None;
    };
    let [low, high] = ends.as_slice() else {
        let message = format!("the range of {what} takes 2 numbers, not {}", ends.len());
        findings.push(Diagnostic::error("wrong-type", node.span.clone(), message).help(help));
        return None;
    };
    let end = format!("the range of {what}");
    let (low, high) = (low.finite(&end, findings), high.finite(&end, findings));
    let (low, high) = (low?, high?);
    if low >= high {
        let message = format!("the range of {what} ends at {high}, not after its start at {low}");
        findings.push(
            Diagnostic::error("wrong-range", node.span.clone(), message)
                .help("the least value stands first, the greatest second"),
        );
        return None;
    }
    // Twice the width must be a number too, or spans within the range overflow.
    if !(2.0 * (high - low)).is_finite() {
        let message = format!("the range of {what} is wider than numbers reach");
        findings.push(
            Diagnostic::error("wrong-range", node.span.clone(), message)
                .help("write the values that can occur"),
        );
        return None;
    }
    Some((low, high))
}

/// Triangles between the peaks of their neighbours, shoulders at the ends: memberships sum to 1 everywhere.
pub(super) fn between_peaks<'a>(peaks: impl Iterator<Item = (&'a str, f64)>) -> Vec<Term> {
    let peaks: Vec<(&str, f64)> = peaks.collect();
    let at = |i: Option<usize>| i.and_then(|i| peaks.get(i)).map(|(_, peak)| *peak);
    let term = |(i, &(name, peak)): (usize, &(&str, f64))| {
        let (left, right) = (at(i.checked_sub(1)), at(Some(i + 1)));
        let shape = match (left, right) {
            (Some(left), Some(right)) => Shape::Triangle { left, peak, right },
            (None, Some(foot)) => Shape::LeftShoulder { top: peak, foot },
            (Some(foot), None) => Shape::RightShoulder { foot, top: peak },
            (None, None) => Shape::Constant { value: 1.0 },
        };
        Term {
            name: String::from(name),
            shape,
            height: 1.0,
        }
    };
    peaks.iter().enumerate().map(term).collect()
}

/// The peaks of `count` terms evenly spaced from `low` to `high`.
pub(super) fn even_peaks(low: f64, high: f64, count: usize) -> impl Iterator<Item = f64> {
    let last = count.saturating_sub(1).max(1) as f64;
    (0..count).map(move |i| {
        let part = i as f64 / last;
        low * (1.0 - part) + high * part
    })
}

/// `{low: 0, high: 1}` (peaks) or `[low, high]` (evenly spaced over the range)
fn partition(
    what: &str,
    node: &Node,
    variable: &mut Variable,
    place: &mut VariablePlaces,
    findings: &mut Vec<Diagnostic>,
) {
    let mut names: Vec<(&str, &Node)> = Vec::new();
    let mut peaks: Option<Vec<f64>> = None;
    match &node.value {
        Value::List(items) => {
            for item in items {
                let Some(name) = item.words(&format!("a term of {what}"), findings) else {
                    continue;
                };
                if let Some((_, first)) = names.iter().find(|(other, _)| *other == name.text) {
                    let (span, first) = (item.span.clone(), first.span.clone());
                    findings.push(crate::tree::duplicate(
                        "term", &name.text, what, span, first,
                    ));
                    continue;
                }
                names.push((&name.text, item));
                place.terms.push(item.span.clone());
            }
            if variable.low < variable.high {
                peaks = Some(even_peaks(variable.low, variable.high, names.len()).collect());
            }
        }
        Value::Mapping(_) => {
            let entries = node.entries(what, "term", findings).unwrap_or_default();
            let mut found = Vec::new();
            for entry in &entries {
                names.push((entry.key, entry.value));
                place.terms.push(entry.key_span.clone());
                let peak = format!("the peak of `{}` of {what}", entry.key);
                found.extend(entry.value.finite(&peak, findings));
            }
            if found.len() == names.len() && rising(what, &names, &found, variable, findings) {
                peaks = Some(found);
            }
        }
        Value::Scalar(_) => {
            let finding = node.unexpected(&format!("terms for the partition of {what}"));
            findings.push(finding.help(
                "write `[low, medium, high]` for even spacing, or peaks: `{low: 0, medium: 0.1, high: 1}`",
            ));
            return;
        }
    }
    if names.len() < 2 {
        let message = format!("the partition of {what} has fewer than two terms");
        findings.push(
            Diagnostic::error("wrong-parameter", node.span.clone(), message)
                .help("add a term, or spell the only one out under `terms`"),
        );
        peaks = None;
    }
    variable.terms = match peaks {
        Some(peaks) => between_peaks(names.iter().map(|(name, _)| *name).zip(peaks)),
        None => names.iter().map(|(name, _)| unreadable(name)).collect(),
    };
}

/// Whether the peaks of a partition rise and lie in the range.
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
            let message = format!(
                "the peak {peak} of `{name}` of {what} is not right of the peak {least} of `{other}`"
            );
            findings.push(
                Diagnostic::error("inverted-parameters", node.span.clone(), message)
                    .help("the terms of a partition stand from left to right, each with a peak of its own"),
            );
        }
        if peak < variable.low || peak > variable.high {
            let (low, high) = (variable.low, variable.high);
            let message = format!(
                "the peak {peak} of `{name}` lies outside the range [{low}, {high}] of {what}"
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

/// A term whose shape cannot be read: its name is known, so that rules that name it are not told off for it.
fn unreadable(name: &str) -> Term {
    Term {
        name: String::from(name),
        shape: Shape::Piecewise { points: Vec::new() },
        height: 1.0,
    }
}

/// `{low: {triangle: [0, 1, 2], height: 0.8}}`
fn terms(
    what: &str,
    node: &Node,
    variable: &mut Variable,
    place: &mut VariablePlaces,
    findings: &mut Vec<Diagnostic>,
) {
    let help =
        "write `terms: {low: {triangle: [0, 1, 2]}}`, or `partition: [low, high]` for even spacing";
    let before = findings.len();
    let Some(entries) = node.entries(what, "term", findings) else {
        if let Some(finding) = findings.get_mut(before) {
            finding.help = Some(String::from(help));
        }
        return;
    };
    if entries.is_empty() {
        let message = format!("{what} has no terms");
        findings.push(Diagnostic::error("missing-key", node.span.clone(), message).help(help));
    }
    for entry in &entries {
        place.terms.push(entry.key_span.clone());
        variable
            .terms
            .push(term(what, entry, findings).unwrap_or_else(|| unreadable(entry.key)));
    }
}

fn term(what: &str, entry: &Entry<'_>, findings: &mut Vec<Diagnostic>) -> Option<Term> {
    let term = format!("term `{}` of {what}", entry.key);
    let Value::Mapping(pairs) = &entry.value.value else {
        let finding = entry.value.unexpected(&format!("a shape for {term}"));
        findings.push(finding.help("write one: `{triangle: [0, 1, 2]}`"));
        return None;
    };
    // Which keys are known depends on the shape, so any key is let through here and looked at there.
    let keys: Vec<&str> = pairs
        .iter()
        .filter_map(|(key, _)| match &key.value {
            Value::Scalar(scalar) => Some(scalar.text.as_str()),
            _ => None,
        })
        .collect();
    let fields = entry.fields(&term, &keys, findings)?;
    let height = match fields.get("height") {
        Some(node) => height(&term, node, findings),
        None => Some(1.0),
    };
    let shape = shapes::read(&term, entry.key_span.clone(), &fields, findings);
    Some(Term {
        name: entry.key.to_string(),
        shape: shape?,
        height: height?,
    })
}

fn height(term: &str, node: &Node, findings: &mut Vec<Diagnostic>) -> Option<f64> {
    let height = node.finite(&format!("the height of {term}"), findings)?;
    if height <= 0.0 || height > 1.0 {
        let message = format!("the height {height} of {term} is outside (0, 1]");
        findings.push(
            Diagnostic::error("wrong-parameter", node.span.clone(), message)
                .help("a height is the largest degree of membership: over 0, at most 1"),
        );
        return None;
    }
    Some(height)
}
