//! Reading inputs and outputs: ranges, partitions, terms.

use alloc::{collections::BTreeMap, format, string::String, vec::Vec};
use core::ops::Range;

use super::{
    Spans, TermSpans, VariableSpans, footprints,
    notation::{
        bare_numbers, colons_without_space, likely_defuzzifier, other_terms, peaks_in_list,
        suggestion_for_word, without_peaks,
    },
    optional_text, steps,
    terms::{terms, unread},
    words::{AGGREGATIONS, DEFUZZIFIERS, TYPE_REDUCTIONS},
};
use crate::{
    diagnostic::{Diagnostic, all_of, duplicate},
    foreign,
    model::{
        Defuzzifier, NoRuleFires, Output, Sampling, SamplingRule, TypeReduction, Variable,
        between_peaks, even_peaks,
    },
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
    if let Some(finding) = split_range(what, fields) {
        // The second number is read as a key without a value.
        findings.retain(|other| other.span.end != finding.span.end);
        findings.push(finding);
    } else if let Some((finding, last)) = two_keys(what, fields) {
        findings.retain(|other| other.span != finding.span && other.span != last);
        findings.push(finding);
    } else if let Some(node) = fields.require("range", RANGE_HELP, findings)
        && let Some((low, high)) = range(what, node, findings)
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
                "partition" => partition,
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

const RANGE_HELP: &str = "write the minimum and the maximum, such as `range: [0, 1]`";

fn range(what: &str, node: &Node, findings: &mut Vec<Diagnostic>) -> Option<(f64, f64)> {
    let both = |[low, high]: [&str; 2]| format!("write `range: [{low}, {high}]`");
    let Value::List(ends) = &node.value else {
        let finding = node.unexpected(&format!("two numbers for the range of {what}"));
        let help = two_numbers(node).map(both).or_else(|| one_number(node));
        findings.push(finding.help(help.unwrap_or_else(|| RANGE_HELP.into())));
        return None;
    };
    let [low, high] = ends.as_slice() else {
        let message = format!(
            "the range of {what} must be a list of 2 numbers, but has {}",
            ends.len()
        );
        let help = Node::list_advice(ends, 2).or_else(|| match ends.as_slice() {
            [only] => two_numbers(only).map(both).or_else(|| one_number(only)),
            numbers => smallest_and_largest(numbers).map(both),
        });
        let help = help.unwrap_or_else(|| RANGE_HELP.into());
        findings.push(Diagnostic::error("wrong-type", node.span.clone(), message).help(help));
        return None;
    };
    let mut read = |node: &Node, end: &str, extreme: &str| {
        let before = findings.len();
        let number = node.finite(&format!("the {end} of the range of {what}"), findings);
        let finding = findings.get_mut(before);
        if let Some(finding) = finding.filter(|finding| finding.code == "not-finite") {
            finding.help = Some(format!("write the {extreme} value that you expect"));
        }
        number
    };
    let (low, high) = (
        read(low, "minimum", "smallest"),
        read(high, "maximum", "largest"),
    );
    Some((low?, high?))
}

/// Returns a suggestion for a range of one number, which is probably its maximum.
fn one_number(node: &Node) -> Option<String> {
    let text = node.as_number_text()?;
    let number = text.parse::<f64>().ok()?;
    let help = "write the minimum and the maximum, such as";
    (number.is_finite() && number > 0.0).then(|| format!("{help} `range: [0, {text}]`"))
}

/// Returns a finding for `min: 0` and `max: 40` in place of a range, and the position of the second key.
fn two_keys(what: &str, fields: &Fields<'_>) -> Option<(Diagnostic, Range<usize>)> {
    if fields.entry("range").is_some() {
        return None;
    }
    let pairs = [
        ("min", "max"),
        ("minimum", "maximum"),
        ("low", "high"),
        ("from", "to"),
    ];
    let number_at = |key: &str| {
        let mut unknown = fields.unknown();
        let entry = unknown.find(|entry| entry.key.eq_ignore_ascii_case(key))?;
        Some((entry, entry.value.as_number_text()?))
    };
    pairs.into_iter().find_map(|(low, high)| {
        let ((low, from), (high, to)) = (number_at(low)?, number_at(high)?);
        let message = format!("unknown keys `{}` and `{}` in {what}", low.key, high.key);
        let finding = Diagnostic::error("unknown-key", low.key_span.clone(), message);
        let finding = finding.help(format!("write `range: [{from}, {to}]`"));
        Some((finding, high.key_span.clone()))
    })
}

/// Improves the suggestions for unknown keys of a variable whose value does not suit the key that is meant.
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

/// Returns the smallest and the largest of at least two numbers, for example of `[start, stop, step]`.
fn smallest_and_largest(numbers: &[Node]) -> Option<[&str; 2]> {
    let numbers = numbers.iter().map(|node| {
        let text = node.as_number_text()?;
        Some((text.parse().ok()?, text))
    });
    let numbers: Vec<(f64, &str)> = numbers.collect::<Option<_>>()?;
    let order = |a: &&(f64, &str), b: &&(f64, &str)| a.0.total_cmp(&b.0);
    Some([
        numbers.iter().min_by(order)?.1,
        numbers.iter().max_by(order)?.1,
    ])
}

/// Returns a finding for a range without brackets in a mapping with braces, `range: 0, 40` or `range: (0, 40)`.
fn split_range(what: &str, fields: &Fields<'_>) -> Option<Diagnostic> {
    let mut entries = fields.entries().iter();
    let range = entries.find(|entry| entry.key == "range")?;
    let next = entries.next().filter(|entry| entry.value.is_null())?;
    let low = range.value.as_text()?.trim_start_matches(['(', '[']);
    let high = next.key.trim_end_matches([')', ']']);
    let is_number = |text: &str| text.parse::<f64>().is_ok();
    (is_number(low) && is_number(high)).then(|| {
        let message = format!("the range of {what} is not a list of two numbers");
        let span = range.value.span.start..next.key_span.end;
        Diagnostic::error("wrong-type", span, message)
            .help(format!("write `range: [{low}, {high}]`"))
    })
}

/// Returns the numbers of a range in another notation: `0..40`, `0 - 40`, `{min: 0, max: 40}`.
fn two_numbers(node: &Node) -> Option<[&str; 2]> {
    let numbers: Vec<&str> = match &node.value {
        Value::Mapping(pairs) => pairs
            .iter()
            .filter_map(|(_, value)| value.as_number_text())
            .collect(),
        Value::Scalar(scalar) => {
            let separators = ["..", " - ", " to ", ",", ";", "-", " "];
            let mut separators = separators.iter();
            let (low, high) = separators.find_map(|sign| {
                let (low, high) = scalar
                    .text
                    .trim_matches(['(', ')', '[', ']'])
                    .split_once(sign)?;
                let is_number = |text: &str| text.trim().parse::<f64>().is_ok();
                (is_number(low) && is_number(high)).then_some((low.trim(), high.trim()))
            })?;
            Vec::from([low, high])
        }
        Value::List(_) => return None,
    };
    <[&str; 2]>::try_from(numbers).ok()
}

const PARTITION_HELP: &str =
    "write `[low, medium, high]` for even spacing, or peaks: `{low: 0, medium: 0.1, high: 1}`";

/// Reads `{low: 0, high: 1}` (peaks) or `[low, high]` (evenly spaced over the range).
fn partition(
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
                let Some(name) = item.words(&format!("a term of {what}"), PARTITION_HELP, findings)
                else {
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
            let entries = node.entries(what, "term", PARTITION_HELP, findings);
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
            findings.push(finding.help(PARTITION_HELP));
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

/// Returns whether ascending peaks of a partition are distinct and in the range.
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
