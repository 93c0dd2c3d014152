//! Where a rule set comes from: the step that a command writes into it, and whether it was edited since.

use fuzzy::{
    Model,
    diagnostic::{Diagnostic, Findings},
    drawing::short,
    format::Document,
    model::Step,
};
use sha2::{Digest as _, Sha256};

/// The rule set that a command made, under the comments that the one it began with has at its head.
pub fn rule_set(begun_with: &str, mut model: Model, step: Step) -> String {
    let head = begun_with.split_inclusive('\n');
    let head: String = head.take_while(|line| line.starts_with('#')).collect();
    model.provenance.push(Step {
        result: Some(fingerprint(&model)),
        ..step
    });
    head + &fuzzy::yaml::to_string(&model)
}

/// A step in a line: `flagred tune: 61 rows of rows.csv, RMS error 10.1 -> 9.2`.
pub fn words(step: &Step) -> String {
    let mut parts = Vec::new();
    let files: Vec<&str> = step.data.iter().map(|data| data.file.as_str()).collect();
    match (step.rows, files.is_empty()) {
        (Some(rows), false) => parts.push(format!("{rows} rows of {}", files.join(", "))),
        (Some(rows), true) => parts.push(format!("{rows} rows")),
        (None, false) => parts.push(files.join(", ")),
        (None, true) => {}
    }
    if let Some([before, after]) = step.rules {
        parts.push(format!("{before} rules -> {after}"));
    }
    if let Some(loss) = &step.loss {
        let [before, after] = [loss.before, loss.after].map(short);
        parts.push(format!("{} {before} -> {after}", loss.name));
    }
    match parts.is_empty() {
        true => step.command.clone(),
        false => format!("{}: {}", step.command, parts.join(", ")),
    }
}

/// Findings, and that the rule set was edited after a command made it, if it was.
pub fn with_edited(mut findings: Findings, document: &Document, text: &str) -> Findings {
    let edited = edited(document).into_iter().collect();
    findings.0.extend(Findings::locate(edited, text).0);
    findings
}

fn edited(document: &Document) -> Option<Diagnostic> {
    let last = document.model.provenance.last()?;
    let is_same = last.result.as_ref()? == &fingerprint(&document.model);
    let finding = Diagnostic::note(
        "edited-since",
        document.spans.provenance.clone(),
        format!("the rule set was edited after `{}` made it", last.command),
    );
    let help = "what `provenance` says is of the rule set before; run the command again, or add a step of your own";
    (!is_same).then(|| finding.help(help))
}

/// The first digits of a hash of what a rule set means: names, notes and where rules come from do not count.
fn fingerprint(model: &Model) -> String {
    const DIGITS: usize = 16;
    let mut bare = model.clone();
    bare.name.clear();
    bare.description = None;
    bare.provenance.clear();
    let outputs = bare.outputs.iter_mut().map(|output| &mut output.variable);
    for variable in bare.inputs.iter_mut().chain(outputs) {
        variable.description = None;
        variable.unit = None;
    }
    for block in &mut bare.blocks {
        block.description = None;
    }
    for rule in &mut bare.rules {
        rule.confidence = None;
        rule.support = None;
        rule.against.clear();
        rule.note = None;
    }
    let mut text = digits(&Sha256::digest(fuzzy::yaml::to_string(&bare)));
    text.truncate(DIGITS);
    text
}

/// Bytes in hexadecimal digits.
pub fn digits(hash: &[u8]) -> String {
    hash.iter().map(|byte| format!("{byte:02x}")).collect()
}
