//! The file format of rule sets, version 1: conversion between [`Model`]s and trees.
//!
//! This is the only reader for all text formats: `yaml::parse` passes it a tree with positions, serde a tree without
//! them. `docs/rule-sets.md` documents the keys.

use alloc::{format, string::String, vec::Vec};

use crate::{
    diagnostic::{Diagnostic, Findings, Severity, is_curly_quote},
    model::{MIN_STRENGTH, Model, Operators},
    tree::{Fields, Node, Value},
    validate::{missing_help, validate},
};

mod allow;
mod blocks;
mod footprints;
mod lists;
mod notation;
mod partition;
mod provenance;
mod range;
mod rules;
#[cfg(feature = "serde")]
mod schema;
mod shapes;
mod steps;
mod terms;
#[cfg(test)]
mod tests;
mod variables;
mod words;
mod write;

pub use crate::model::document::{
    BlockSpans, Document, RuleSpans, Spans, TermSpans, VariableSpans,
};
#[cfg(feature = "serde")]
pub use schema::schema;
#[doc(hidden)]
pub use shapes::text as shape_text;
#[cfg(feature = "yaml")]
pub(crate) use variables::is_key_of_variable;
#[doc(hidden)]
pub use words::word_of_or;

/// The version of the format that this library reads and writes.
pub const VERSION: u64 = 1;

/// Reads a model from a tree. All findings are reported together, except those that follow from another finding.
///
/// # Errors
/// All findings, if any of them is an error. Without a text they have no line and column.
#[doc(hidden)]
pub fn read(tree: &Node) -> Result<Document, Vec<Diagnostic>> {
    // A rule set may have no rules, because rules can be learned for it.
    read_lacking(tree, |model, finding| {
        model.rules.is_empty() && finding.code == "no-rules"
    })
}

/// Works like [`read`] for an unfinished rule set, which may have no outputs and no rules. If there are errors, only
/// these are returned.
#[doc(hidden)]
pub fn read_unfinished(tree: &Node) -> Result<Document, Vec<Diagnostic>> {
    read_lacking(tree, |model, finding| {
        (model.rules.is_empty() && finding.code == "no-rules")
            || (model.outputs.is_empty() && finding.code == "missing-key")
    })
    .map_err(|mut findings| {
        findings.retain(|finding| finding.severity == Severity::Error);
        findings
    })
}

/// Reads a model from a tree. Missing parts that `may_lack` accepts are reported as warnings.
fn read_lacking(
    tree: &Node,
    may_lack: fn(&Model, &Diagnostic) -> bool,
) -> Result<Document, Vec<Diagnostic>> {
    let mut findings = Vec::new();
    let mut spans = Spans::default();
    let tree = lists::to_mappings(tree, &mut findings);
    // Rules may use the name that an entry lacks, so unknown names in rules are not reported in this case.
    spans.names_unread = !findings.is_empty();
    let model = model(&tree, &mut spans, &mut findings);
    if let Some(model) = &model {
        let mut invalid = validate(model, &spans);
        for finding in invalid.iter_mut().filter(|f| may_lack(model, f)) {
            finding.severity = Severity::Warning;
        }
        findings.extend(invalid);
    }
    let failed = findings.iter().any(|f| f.severity == Severity::Error);
    match model {
        Some(model) if !failed => Ok(Document {
            model,
            spans,
            warnings: Findings(findings),
        }),
        _ => Err(findings),
    }
}

/// The part of a rule set that could be parsed, for editors.
#[doc(hidden)]
#[derive(Debug, Clone, PartialEq)]
pub struct PartialModel {
    /// The parts that could be read. Of a part that could not be read, only the name is included.
    pub model: Model,
    /// The positions of the parts of the model.
    pub spans: Spans,
    /// Whether a rule or a term with an explicit membership function could not be read, so that the names in it
    /// are unknown.
    pub names_unread: bool,
}

/// Reads as much of a model as possible from a tree; `None` if its inputs or its outputs cannot be read at all.
#[doc(hidden)]
pub fn read_partly(tree: &Node) -> Option<PartialModel> {
    let mut spans = Spans::default();
    let mut findings = Vec::new();
    let tree = lists::to_mappings(tree, &mut findings);
    let model = model(&tree, &mut spans, &mut findings)?;
    let mut variables = spans.inputs.iter().chain(&spans.outputs);
    let has_unread = |variable: &VariableSpans| {
        variable.partition.is_empty() && variable.terms.iter().any(|term| term.unread)
    };
    Some(PartialModel {
        model,
        names_unread: spans.rules_unread || variables.any(has_unread),
        spans,
    })
}

/// The keys of a rule set.
const KEYS: [&str; 12] = [
    "fuzzy",
    "name",
    "description",
    "inputs",
    "outputs",
    "operators",
    "activation",
    "least_strength",
    "rules",
    "blocks",
    "allow",
    "provenance",
];

/// Reads the model as far as possible. A part that cannot be read is reported, and only its name is included.
fn model(tree: &Node, spans: &mut Spans, findings: &mut Vec<Diagnostic>) -> Option<Model> {
    if !matches!(tree.value, Value::Mapping(_)) {
        findings.push(tree.unexpected_document("rule set", "fuzzy: 1"));
        return None;
    }
    let mut unknown_keys = Vec::new();
    let fields = tree.fields("the rule set", &KEYS, "", &mut unknown_keys)?;
    let before = findings.len();
    let version = fields.get("fuzzy").map(|node| {
        let version = node.whole("the format version in `fuzzy`", 0, findings);
        let is_open = |help: &String| help.starts_with("write a whole number");
        if let Some(finding) = findings.get_mut(before)
            && finding.help.as_ref().is_some_and(is_open)
        {
            finding.help = Some(format!("write `fuzzy: {VERSION}`"));
        }
        (node, version)
    });
    if let Some((node, version)) = version
        && version? != VERSION
    {
        let written = node.words("the version", "write `fuzzy: 1`", findings)?;
        let message = format!("format version `{}` is not supported", written.text);
        findings.push(
            Diagnostic::error("unsupported-version", node.span.clone(), message).help(format!(
                "this program reads format version {VERSION}; a newer release of the program may read this file"
            )),
        );
        // In another version, all other keys may have a different meaning.
        return None;
    }
    if let Some(finding) = outdented(&fields).or_else(|| other_first_key(&fields)) {
        findings.push(finding);
        return None;
    }
    findings.append(&mut unknown_keys);
    if let Some(finding) = outputs_among_inputs(&fields) {
        findings.push(finding);
        return None;
    }
    fields.require("fuzzy", "begin the file with `fuzzy: 1`", findings);
    let name = optional_text(&fields, "name", findings);
    let description = optional_text(&fields, "description", findings);
    if fields.get("name").is_none() {
        fields.require(
            "name",
            "give the rule set a name: `name: my-rules`",
            findings,
        );
    }
    let inputs = fields
        .require("inputs", &missing_help("inputs"), findings)
        .and_then(|node| variables::inputs(node, spans, findings));
    let outputs = fields
        .require("outputs", &missing_help("outputs"), findings)
        .and_then(|node| variables::outputs(node, spans, findings));
    let operators = fields.get("operators").and_then(|node| {
        let keys = ["and", "or", "implication", "aggregation"];
        words::operators(node, "`operators`", &keys, Operators::default(), findings)
    });
    let activation = fields.get("activation").and_then(|node| {
        blocks::activation("the activation", node, &mut spans.activation, findings)
    });
    let least_strength = fields.get("least_strength").and_then(|node| {
        spans.least_strength = node.span.clone();
        node.finite("`least_strength`", findings)
    });
    let mut model = Model {
        name: name.unwrap_or_default(),
        description,
        inputs: inputs?,
        outputs: outputs?,
        operators: operators.unwrap_or_default(),
        activation: activation.unwrap_or_default(),
        least_strength: least_strength.unwrap_or(MIN_STRENGTH),
        blocks: Vec::new(),
        rules: Vec::new(),
        allow: Vec::new(),
        provenance: Vec::new(),
    };
    if let Some(node) = fields.get("allow") {
        model.allow = allow::read(node, &mut spans.allow, findings);
    }
    if let Some(entry) = fields.entry("provenance") {
        spans.provenance = entry.key_span.clone();
        model.provenance = provenance::read(entry.value, findings);
    }
    let rules_help = "write `rules:` followed by a list of rules, such as `- IF input IS term THEN output IS term`; to learn the rules from data, write `rules: []`";
    let key = |key| {
        fields
            .entry(key)
            .map_or(0..0, |entry| entry.key_span.clone())
    };
    (spans.outputs_key, spans.rules_key) = (key("outputs"), key("rules"));
    let Some(node) = fields.get("blocks") else {
        let rules = match fields.misspells("blocks") {
            true => None,
            false => fields.require("rules", rules_help, findings),
        };
        let rules = rules.and_then(|node| rules::read(node, &model, spans, findings));
        spans.rules_unread |= rules.is_none();
        model.rules = rules.unwrap_or_default();
        return Some(model);
    };
    if fields.entry("rules").is_some() {
        let message = "a rule set can have `rules` or `blocks`, but not both";
        let help = "move all rules of `rules` into a block, and remove `rules`";
        findings.push(Diagnostic::error("duplicate-key", key("blocks"), message).help(help));
        spans.rules_unread = true;
    }
    spans.rules_key = key("blocks");
    blocks::read(node, &mut model, spans, findings);
    Some(model)
}

/// Returns a finding if an input or output is in the column of the keys of the rule set, not below `inputs` or `outputs`.
fn outdented(fields: &Fields<'_>) -> Option<Diagnostic> {
    let mut unknown = fields.unknown();
    let stray = unknown.find(|entry| {
        let has = |key: &str| entry.value.child(key).is_some();
        has("range") && (has("partition") || has("terms") || has("steps"))
    })?;
    let above = fields
        .entries()
        .iter()
        .take_while(|entry| entry.key != stray.key);
    let section = above
        .filter(|entry| ["inputs", "outputs"].contains(&entry.key))
        .last()?;
    let kind = section.key.trim_end_matches('s');
    let message = format!(
        "unknown key `{0}` at the top level; `{0}` looks like an {kind}",
        stray.key
    );
    let help = match &section.value.value {
        Value::Mapping(pairs) => {
            let (first, _) = pairs.first()?;
            format!("align `{}:` with `{}:`", stray.key, first.as_text()?)
        }
        _ if section.value.is_null() => format!(
            "indent `{}:` and its keys: each {kind} is nested under `{}:`",
            stray.key, section.key
        ),
        _ => return None,
    };
    Some(Diagnostic::error("unknown-key", stray.key_span.clone(), message).help(help))
}

/// Returns a finding for a file that begins with `key: 1` and an unknown key in place of `fuzzy`, as files of other kinds
/// do.
fn other_first_key(fields: &Fields<'_>) -> Option<Diagnostic> {
    let first = fields.entries().first()?;
    let is_version = first.value.as_number_text() == Some("1");
    if !is_version
        || fields.get("fuzzy").is_some()
        || !fields.unknown().any(|entry| entry.key == first.key)
    {
        return None;
    }
    let message = format!(
        "a rule set must begin with `fuzzy: 1`, not `{}: 1`",
        first.key
    );
    let finding = Diagnostic::error("unknown-key", first.key_span.clone(), message);
    Some(finding.help("write `fuzzy: 1` instead"))
}

/// Returns a finding if the outputs are below `inputs`, because `outputs:` is missing above them or the keys are swapped.
fn outputs_among_inputs(fields: &Fields<'_>) -> Option<Diagnostic> {
    let variables = |key: &str| match fields.get(key).map(|node| &node.value) {
        Some(Value::Mapping(pairs)) => pairs.as_slice(),
        _ => &[],
    };
    let keys_of_outputs = |(_, variable): &&(Node, Node)| {
        let Value::Mapping(pairs) = &variable.value else {
            return false;
        };
        pairs
            .iter()
            .filter_map(|(key, _)| key.as_text())
            .any(|key| {
                variables::OUTPUT_KEYS.contains(&key) && !variables::INPUT_KEYS.contains(&key)
            })
    };
    let (inputs, outputs) = (variables("inputs"), variables("outputs"));
    let (name, _) = inputs.iter().find(keys_of_outputs)?;
    let text = name.as_text()?;
    let all_exchanged = inputs.iter().all(|input| keys_of_outputs(&input))
        && !outputs.is_empty()
        && !outputs.iter().any(|output| keys_of_outputs(&output));
    let help = match () {
        () if fields.get("outputs").is_none() && !fields.misspells("outputs") => {
            format!("add the line `outputs:` above `{text}:`")
        }
        () if all_exchanged => "swap the keys `inputs` and `outputs`".into(),
        () => return None,
    };
    let message = format!("input `{text}` has keys that only outputs can have");
    Some(Diagnostic::error("unknown-key", name.span.clone(), message).help(help))
}

/// Converts the model to a tree; reading it gives the same model.
#[doc(hidden)]
#[must_use]
pub fn write(model: &Model) -> Node {
    write::model(model)
}

/// Works like [`write`], but uses lists of named entries for mappings whose order is significant, because many formats
/// sort keys.
#[cfg(feature = "serde")]
pub(crate) fn write_lists(model: &Model) -> Node {
    lists::from_mappings(write::model(model))
}

/// Returns the text of a key, if there is one.
fn optional_text(fields: &Fields<'_>, key: &str, findings: &mut Vec<Diagnostic>) -> Option<String> {
    let node = fields.get(key)?;
    let help = format!("write text: `{key}: ...`");
    let text = &node.words(&format!("`{key}`"), &help, findings)?.text;
    let inner = text.trim_matches(is_curly_quote);
    if text.starts_with(is_curly_quote) && text.ends_with(is_curly_quote) && !inner.is_empty() {
        let message = format!("the typographic quotes become part of the value of `{key}`");
        let finding = Diagnostic::warning("typographic-quotes", node.span.clone(), message);
        findings.push(finding.help(format!("write straight quotes: `{key}: \"{inner}\"`")));
    }
    Some(text.clone())
}
