//! Reading inputs and outputs.

use alloc::{format, string::String, vec::Vec};
use core::ops::Range;

use super::{
    Spans, VariableSpans, footprints,
    notation::{bare_numbers, likely_defuzzifier, suggestion_for_word},
    optional_text, partition, range, steps,
    terms::terms,
    words::{AGGREGATIONS, DEFUZZIFIERS, TYPE_REDUCTIONS},
};
use crate::{
    diagnostic::{Diagnostic, all_of},
    foreign,
    model::{Defuzzifier, NoRuleFires, Output, Sampling, SamplingRule, TypeReduction, Variable},
    tree::{Entry, Fields, Node, Value},
    validate::TERMS_HELP,
};

pub(super) const INPUT_KEYS: [&str; 7] = [
    "description",
    "unit",
    "range",
    "partition",
    "blur",
    "steps",
    "terms",
];
pub(super) const OUTPUT_KEYS: [&str; 13] = [
    "description",
    "unit",
    "range",
    "partition",
    "blur",
    "steps",
    "terms",
    "defuzzifier",
    "samples",
    "when_no_rule_fires",
    "aggregation",
    "clamp",
    "type_reduction",
];

/// YAML's key for values that are taken from another mapping.
const MERGE: &str = "<<";

/// Returns the suggestion for how to write the inputs or the outputs; `key` is `inputs` or `outputs`.
fn variables_help(key: &str) -> String {
    format!(
        "write each by its name: `{key}: {{speed: {{range: [0, 10], partition: [low, high]}}}}`"
    )
}

/// Returns whether a word is a key of an input or an output.
#[cfg(feature = "yaml")]
pub(crate) fn is_key_of_variable(key: &str) -> bool {
    OUTPUT_KEYS.contains(&key)
}

/// Returns the suggestion for how to write a variable.
fn variable_help(name: &str) -> String {
    format!("write `{name}: {{range: [0, 10], partition: [low, high]}}`")
}

pub(super) fn inputs(
    node: &Node,
    spans: &mut Spans,
    findings: &mut Vec<Diagnostic>,
) -> Option<Vec<Variable>> {
    let entries = entries(("inputs", &INPUT_KEYS), node, spans, findings)?;
    let read = |entry: &Entry<'_>| {
        let (variable, here, _) = one(("input", &INPUT_KEYS), entry, spans, findings);
        spans.inputs.push(here);
        variable
    };
    Some(entries.iter().map(read).collect())
}

/// Returns the entries of `inputs` or `outputs`. `None` if they are the keys of a variable, or contain a key of the rule set.
fn entries<'n>(
    (key, keys): (&str, &[&str]),
    node: &'n Node,
    spans: &mut Spans,
    findings: &mut Vec<Diagnostic>,
) -> Option<Vec<Entry<'n>>> {
    let entries = node.entries(
        &format!("`{key}`"),
        "variable",
        &variables_help(key),
        findings,
    )?;
    // An entry with a repeated name is rejected. Its author probably meant another name, which rules may use, so
    // unknown variables are not reported.
    spans.names_unread |= entries.len() < node.children();
    let is_variable = |entry: &&Entry<'_>| matches!(entry.value.value, Value::Mapping(_));
    let has_range = |entry: &Entry<'_>| entry.value.child("range").is_some();
    let kind = key.trim_end_matches('s');
    let is_nameless = entries
        .iter()
        .any(|entry| entry.key == "range" && !is_variable(&entry));
    if let Some(first) = entries.first()
        && is_nameless
        && entries.iter().all(|entry| keys.contains(&entry.key))
    {
        let message =
            format!("the keys of an {kind} must be under its name, not directly under `{key}`");
        let help = format!(
            "nest the keys under the name of the {kind}, for example `{key}: {{speed: {{range: [0, 10], ...}}}}`"
        );
        findings.push(Diagnostic::error("missing-key", first.key_span.clone(), message).help(help));
        return None;
    }
    let of_rule_set = |entry: &&Entry<'_>| super::KEYS.contains(&entry.key) && !has_range(entry);
    if let Some(stray) = entries.iter().find(of_rule_set) {
        let message = format!(
            "`{}` must be at the top level, not under `{key}`",
            stray.key
        );
        let help = format!("align `{}:` with `{key}:`", stray.key);
        let finding = Diagnostic::error("unknown-key", stray.key_span.clone(), message);
        findings.push(finding.help(help));
        return None;
    }
    Some(entries)
}

/// Reads an input, or the part of an output that has the same keys as an input.
fn one<'n>(
    (kind, keys): (&str, &[&str]),
    entry: &Entry<'n>,
    spans: &mut Spans,
    findings: &mut Vec<Diagnostic>,
) -> (Variable, VariableSpans, Option<Fields<'n>>) {
    let what = format!("{kind} `{}`", entry.key);
    let before = findings.len();
    let fields = entry.fields(&what, keys, &variable_help(entry.key), findings);
    let (variable, here) = variable(&what, entry, fields.as_ref(), findings);
    // A variable may be written inside another one. If its keys are in the same column as the keys of the other
    // variable, they are reported as duplicates.
    let repeats = |finding: &Diagnostic| {
        finding.code == "duplicate-key" && finding.message.starts_with(&what)
    };
    let has_repeated = findings.iter().skip(before).any(repeats);
    let mut unknown = fields.iter().flat_map(Fields::unknown);
    let nested = unknown.find(|other| {
        other.key != MERGE
            && (other.value.child("range").is_some() || other.value.is_null() && has_repeated)
    });
    if let Some(nested) = nested {
        findings.truncate(before);
        let message = format!(
            "unknown key `{0}` in {what}; `{0}` looks like an {kind}",
            nested.key
        );
        let finding = Diagnostic::error("unknown-key", nested.key_span.clone(), message);
        findings.push(finding.help(format!("align `{}:` with `{}:`", nested.key, entry.key)));
        spans.names_unread = true;
    }
    drop(unknown);
    (variable, here, fields)
}

pub(super) fn outputs(
    node: &Node,
    spans: &mut Spans,
    findings: &mut Vec<Diagnostic>,
) -> Option<Vec<Output>> {
    let entries = entries(("outputs", &OUTPUT_KEYS), node, spans, findings)?;
    let read = |entry: &Entry<'_>| {
        let what = format!("output `{}`", entry.key);
        let (variable, mut here, fields) = one(("output", &OUTPUT_KEYS), entry, spans, findings);
        let mut output = Output {
            variable,
            defuzzifier: Defuzzifier::Centroid,
            samples: None,
            when_no_rule_fires: NoRuleFires::Undefined,
            aggregation: None,
            clamp: false,
            type_reduction: TypeReduction::Exact,
        };
        if let Some(fields) = fields {
            if let Some(node) = fields.get_or_misspelt("defuzzifier") {
                let key = format!("the defuzzifier of {what}");
                let word = node.choice(&key, &DEFUZZIFIERS, findings);
                // An unknown word is replaced by a defuzzifier that fits the terms, so that the terms are not reported
                // as well.
                let likely = || likely_defuzzifier(&output.variable);
                output.defuzzifier = word.or_else(likely).unwrap_or(output.defuzzifier);
            }
            if let Some(node) = fields.get("samples") {
                output.samples = samples(node, &mut here.samples, findings);
            }
            if let Some(node) = fields.get("when_no_rule_fires") {
                let found = no_rule_fires(&what, node, &mut here.default, findings);
                output.when_no_rule_fires = found.unwrap_or(NoRuleFires::Undefined);
            }
            if let Some(node) = fields.get("aggregation") {
                let key = format!("the aggregation of {what}");
                output.aggregation = node.choice(&key, &AGGREGATIONS, findings);
            }
            if let Some(node) = fields.get("clamp") {
                let clamp = node.boolean(&format!("`clamp` of {what}"), findings);
                output.clamp = clamp.unwrap_or(false);
            }
            if let Some(node) = fields.get("type_reduction") {
                let key = format!("the type reduction of {what}");
                let word = node.choice(&key, &TYPE_REDUCTIONS, findings);
                output.type_reduction = word.unwrap_or_default();
            }
        }
        spans.outputs.push(here);
        output
    };
    Some(entries.iter().map(read).collect())
}

/// Reads `{midpoint: 1000}`; `span` is set to the position of the number.
fn samples(
    node: &Node,
    span: &mut Range<usize>,
    findings: &mut Vec<Diagnostic>,
) -> Option<Sampling> {
    let number = node.as_number_text().unwrap_or("1000");
    let help = &format!(
        "write the sampling method and a whole number: `samples: {{midpoint: {number}}}` or `samples: {{trapezoid: {number}}}`"
    );
    let Value::Mapping(_) = &node.value else {
        let finding = node.unexpected("a sampling method and the number of samples");
        findings.push(finding.help(help));
        return None;
    };
    let fields = node.fields("`samples`", &["midpoint", "trapezoid"], help, findings)?;
    let (number, rule) = match (fields.get("midpoint"), fields.get("trapezoid")) {
        (Some(number), None) => (number, SamplingRule::Midpoint),
        (None, Some(number)) => (number, SamplingRule::Trapezoid),
        _ => {
            let message = "`samples` must have exactly one sampling rule";
            findings.push(Diagnostic::error("wrong-type", node.span.clone(), message).help(help));
            return None;
        }
    };
    *span = number.span.clone();
    let before = findings.len();
    let samples = number.whole("`samples`", 0, findings);
    if let Some(finding) = findings.get_mut(before) {
        finding.help = Some(help.into());
    }
    let samples = samples?;
    Some(Sampling {
        samples: usize::try_from(samples).unwrap_or(usize::MAX),
        rule,
    })
}

const NO_RULE_HELP: &str = "write `undefined`, `error`, a value as `{value: 50}`, or `previous` for the previous value: \
     with `{previous: 50}` it is 50 until there is a previous value";

/// Reads `undefined`, `error`, `previous`, `{value: 50}` or `{previous: 50}`; `span` is set to the position of the
/// value.
fn no_rule_fires(
    what: &str,
    node: &Node,
    span: &mut Range<usize>,
    findings: &mut Vec<Diagnostic>,
) -> Option<NoRuleFires> {
    let key = format!("`when_no_rule_fires` of {what}");
    if let Value::Mapping(_) = &node.value {
        let fields = node.fields(&key, &["value", "previous"], NO_RULE_HELP, findings)?;
        let [entry] = fields.entries() else {
            let message = format!("{key} takes one of `value` and `previous`");
            findings.push(
                Diagnostic::error("wrong-type", node.span.clone(), message).help(NO_RULE_HELP),
            );
            return None;
        };
        *span = entry.value.span.clone();
        let value = entry.value.finite(&key, findings)?;
        return Some(match entry.key {
            "previous" => NoRuleFires::Previous(Some(value)),
            _ => NoRuleFires::Value(value),
        });
    }
    let words = [
        ("undefined", NoRuleFires::Undefined),
        ("error", NoRuleFires::Error),
        ("previous", NoRuleFires::Previous(None)),
    ];
    if let Some(number) = node.as_number_text() {
        findings.push(
            node.unexpected(&format!(
                "`undefined`, `error`, `previous` or a mapping for {key}"
            ))
            .help(format!("write `{{value: {number}}}`")),
        );
        return None;
    }
    let before = findings.len();
    let found = node.choice(&key, &words, findings);
    if let Some(finding) = findings.get_mut(before) {
        let suggested = finding.help.take();
        let suggested = suggested.filter(|help| help.starts_with("did you mean"));
        let meant = node.as_text().and_then(suggestion_for_word).or(suggested);
        finding.help = Some(meant.unwrap_or_else(|| NO_RULE_HELP.into()));
    }
    found
}

/// Reads a variable as far as possible: its name and the names of its terms are included even if the rest is invalid.
fn variable(
    what: &str,
    entry: &Entry<'_>,
    fields: Option<&Fields<'_>>,
    findings: &mut Vec<Diagnostic>,
) -> (Variable, VariableSpans) {
    let mut variable = Variable::new(entry.key, f64::NAN, f64::NAN);
    let mut spans = VariableSpans {
        name: entry.key_span.clone(),
        range_unread: true,
        terms_unread: true,
        ..VariableSpans::default()
    };
    let Some(fields) = fields else {
        return (variable, spans);
    };
    variable.description = optional_text(fields, "description", findings);
    variable.unit = optional_text(fields, "unit", findings);
    refine(fields, findings);
    if let Some(finding) = range::split(what, fields) {
        // The second number is read as a key without a value.
        findings.retain(|other| other.span.end != finding.span.end);
        findings.push(finding);
    } else if let Some((finding, last)) = range::two_keys(what, fields) {
        findings.retain(|other| other.span != finding.span && other.span != last);
        findings.push(finding);
    } else if let Some(node) = fields.require("range", range::HELP, findings)
        && let Some((low, high)) = range::read(what, node, findings)
    {
        (variable.low, variable.high) = (low, high);
        (spans.range, spans.range_unread) = (node.span.clone(), false);
    }
    let forms = ["partition", "steps", "terms"].map(|key| fields.entry(key));
    let mut forms = forms.into_iter().flatten();
    match (forms.next(), forms.next()) {
        (Some(first), Some(second)) => findings.push(
            Diagnostic::error(
                "duplicate-key",
                second.key_span.clone(),
                format!(
                    "{what} defines its terms twice, in `{}` and in `{}`",
                    first.key, second.key
                ),
            )
            .help("keep one of the two keys, and define all terms of the variable in it"),
        ),
        (Some(entry), None) => {
            let read = match entry.key {
                "partition" => partition::read,
                "steps" => steps::read,
                _ => terms,
            };
            let is_weighted = fields.get_or_misspelt("defuzzifier").is_some_and(|node| {
                node.as_text()
                    .is_some_and(|word| word.starts_with("weighted"))
            });
            if !bare_numbers(
                what,
                entry,
                is_weighted,
                &mut variable,
                &mut spans,
                findings,
            ) {
                read(what, entry.value, &mut variable, &mut spans, findings);
            }
        }
        (None, _) if fields.misspells("partition") || fields.misspells("steps") => {}
        (None, _) => {
            let forms = ["partition", "steps", "terms"];
            let empty = fields
                .entries()
                .iter()
                .find(|entry| forms.contains(&entry.key));
            fields.require(
                empty.map_or("terms", |entry| entry.key),
                TERMS_HELP,
                findings,
            );
            let stray: Vec<&str> = fields.unknown().map(|entry| entry.key).collect();
            if let Some(empty) = empty
                && !stray.is_empty()
            {
                // The terms are in the same column as their key: a single finding suggests indenting them.
                fields.withdraw(findings);
                if let Some(finding) = findings.last_mut() {
                    finding.help =
                        Some(format!("indent {} under `{}:`", all_of(&stray), empty.key));
                }
            }
        }
    }
    if let Some(blur) = fields.entry("blur") {
        match fields.entry("partition") {
            Some(_) => {
                footprints::blur_partition(what, blur.value, &mut variable, &mut spans, findings);
            }
            None if fields.misspells("partition") => {}
            None => {
                let message = format!("{what} has `blur` but no `partition`");
                let finding = Diagnostic::error("unknown-key", blur.key_span.clone(), message);
                findings.push(
                    finding.help("write `blur` in each term: `{triangle: [0, 2, 4], blur: 0.1}`"),
                );
            }
        }
    }
    (variable, spans)
}

/// Improves the suggestion for an unknown key of a variable if the key that was probably meant does not accept the value.
fn refine(fields: &Fields<'_>, findings: &mut [Diagnostic]) {
    for entry in fields.unknown() {
        let is_meant = |key| !foreign::equivalents(entry.key, [key]).is_empty();
        let help = match &entry.value.value {
            Value::List(_) if is_meant("terms") => "did you mean `partition`?".into(),
            Value::Scalar(value)
                if is_meant("when_no_rule_fires") && value.as_number().is_some() =>
            {
                format!("write `when_no_rule_fires: {{value: {}}}`", value.text)
            }
            _ => continue,
        };
        let mut findings = findings.iter_mut();
        if let Some(finding) = findings.find(|finding| finding.span == entry.key_span) {
            finding.help = Some(help);
        }
    }
}
