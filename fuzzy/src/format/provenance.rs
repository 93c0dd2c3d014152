//! The commands that produced a rule set: `provenance`.

use alloc::{format, string::String, vec::Vec};

use super::optional_text;
use crate::{
    diagnostic::Diagnostic,
    model::{DataFile, LossChange, ProvenanceStep},
    tree::{Fields, Node},
};

pub(super) const KEYS: [&str; 9] = [
    "command", "data", "rows", "seed", "loss", "rules", "moved", "note", "result",
];

pub(super) const DATA_KEYS: [&str; 2] = ["file", "sha256"];

pub(super) const LOSS_KEYS: [&str; 3] = ["name", "before", "after"];

pub(super) fn read(node: &Node, findings: &mut Vec<Diagnostic>) -> Vec<ProvenanceStep> {
    let help = "write an entry for each step: `provenance: [{command: tune rules.yaml}]`";
    let items = node
        .items("`provenance`", help, findings)
        .unwrap_or_default();
    let steps = items.iter().enumerate();
    let steps = steps.filter_map(|(i, item)| step(item, i + 1, findings));
    steps.collect()
}

fn step(node: &Node, number: usize, findings: &mut Vec<Diagnostic>) -> Option<ProvenanceStep> {
    let what = format!("step {number} of the provenance");
    let help = "write the command that made the rule set: `{command: tune rules.yaml}`";
    let fields = node.fields(&what, &KEYS, help, findings)?;
    fields.require("command", help, findings);
    let text = |node: &Node, key: &str, findings: &mut Vec<Diagnostic>| {
        let help = format!("write text: `{key}: ...`");
        let text = node.words(&format!("`{key}` of {what}"), &help, findings)?;
        Some(text.text.clone())
    };
    let mut step = ProvenanceStep {
        command: optional_text(&fields, "command", findings)?,
        note: optional_text(&fields, "note", findings),
        result: optional_text(&fields, "result", findings),
        ..ProvenanceStep::default()
    };
    for (key, number) in [("rows", &mut step.rows), ("seed", &mut step.seed)] {
        *number = fields
            .get(key)
            .and_then(|node| node.whole(&format!("`{key}` of {what}"), 0, findings));
    }
    let items = |key: &str, findings: &mut Vec<Diagnostic>| {
        let node = fields.get(key)?;
        let help = match key {
            "data" => "write `data: [{file: rows.csv}]`",
            _ => "write a list of texts: `moved: [a peak]`",
        };
        node.items(&format!("`{key}` of {what}"), help, findings)
    };
    for item in items("data", findings).unwrap_or_default() {
        let help = "write `{file: rows.csv}`";
        let of_file = item.fields(&format!("the data of {what}"), &DATA_KEYS, help, findings);
        let Some(of_file) = of_file else { continue };
        of_file.require("file", help, findings);
        step.data.push(DataFile {
            file: optional_text(&of_file, "file", findings).unwrap_or_default(),
            sha256: optional_text(&of_file, "sha256", findings),
        });
    }
    for item in items("moved", findings).unwrap_or_default() {
        step.moved.extend(text(item, "moved", findings));
    }
    step.rules = fields.get("rules").and_then(|node| {
        let what = format!("`rules` of {what}");
        let help = "write how many there were before and after: `[28, 9]`";
        let items = node.items(&what, help, findings)?;
        let counts = items.iter().map(|item| item.whole(&what, 0, findings));
        let counts: Vec<u64> = counts.collect::<Option<_>>()?;
        counts
            .try_into()
            .inspect_err(|_| {
                let finding = node.unexpected(&format!("two numbers for {what}"));
                findings.push(finding.help(help));
            })
            .ok()
    });
    step.loss = fields
        .get("loss")
        .and_then(|node| loss(&what, node, findings));
    Some(step)
}

fn loss(what: &str, node: &Node, findings: &mut Vec<Diagnostic>) -> Option<LossChange> {
    let what = format!("the loss of {what}");
    let help = "write `{name: RMS error, before: 3, after: 2}`";
    let fields = node.fields(&what, &LOSS_KEYS, help, findings)?;
    let number = |key: &str, findings: &mut Vec<Diagnostic>, fields: &Fields<'_>| {
        let node = fields.require(key, help, findings)?;
        node.finite(&format!("`{key}` of {what}"), findings)
    };
    fields.require("name", help, findings);
    let (before, after) = (
        number("before", findings, &fields),
        number("after", findings, &fields),
    );
    Some(LossChange {
        name: optional_text(&fields, "name", findings)?,
        before: before?,
        after: after?,
    })
}

/// Returns the steps in the format of a file; `None` if there are no steps.
pub(super) fn write(steps: &[ProvenanceStep]) -> Option<Node> {
    let steps: Vec<Node> = steps.iter().map(write_step).collect();
    (!steps.is_empty()).then(|| Node::list(steps))
}

fn write_step(step: &ProvenanceStep) -> Node {
    let text = |text: &String| Node::text(text.as_str());
    let mut entries: Vec<(&str, Node)> = Vec::from([("command", text(&step.command))]);
    if !step.data.is_empty() {
        let files = step.data.iter().map(|data| {
            let mut entries = Vec::from([("file", text(&data.file))]);
            entries.extend(data.sha256.as_ref().map(|hash| ("sha256", text(hash))));
            Node::mapping(entries)
        });
        entries.push(("data", Node::list(files.collect())));
    }
    entries.extend(step.rows.map(|rows| ("rows", super::rules::whole(rows))));
    entries.extend(step.seed.map(|seed| ("seed", super::rules::whole(seed))));
    entries.extend(step.loss.as_ref().map(|loss| {
        let numbers = [
            ("name", text(&loss.name)),
            ("before", Node::number(loss.before)),
            ("after", Node::number(loss.after)),
        ];
        ("loss", Node::mapping(numbers))
    }));
    entries.extend(step.rules.map(|rules| {
        let rules = rules.map(super::rules::whole);
        ("rules", Node::list(rules.into()))
    }));
    if !step.moved.is_empty() {
        let moved = step.moved.iter().map(text);
        entries.push(("moved", Node::list(moved.collect())));
    }
    entries.extend(step.note.as_ref().map(|note| ("note", text(note))));
    entries.extend(step.result.as_ref().map(|result| ("result", text(result))));
    Node::mapping(entries)
}
