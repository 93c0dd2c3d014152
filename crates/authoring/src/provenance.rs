//! The provenance of a rule set: the step that a command adds to it, and whether it was edited since.

use fuzzy::{
    Model,
    diagnostic::{Diagnostic, Findings},
    drawing::short,
    format::Document,
    model::ProvenanceStep,
};
use sha2::{Digest as _, Sha256};

use crate::{Edit, edited, layout::formatted, numbers, rewrite::head};

/// Returns the text of a rule set that a command created, including the provenance step of that command. If only
/// numbers differ from the original text, they are changed in that text. Otherwise the rule set is written anew,
/// below the comments at the top of that text, in the layout of `flagred fmt`.
///
/// # Errors
/// If the text would not be read back as this rule set, for example because of a number that is not finite.
pub fn rule_set(
    original_text: &str,
    mut model: Model,
    step: ProvenanceStep,
) -> Result<String, Findings> {
    let step = ProvenanceStep {
        result: Some(fingerprint(&model)),
        ..step
    };
    model.provenance.push(step);
    if let Some(text) = in_place(original_text, &model) {
        let was_formatted = formatted(original_text).is_ok_and(|text| text == original_text);
        return Ok(match was_formatted {
            true => laid_out(text),
            false => text,
        });
    }
    let text = laid_out(head(original_text) + &fuzzy::yaml::to_string(&model));
    match fuzzy::yaml::parse(&text)?.model == model {
        true => Ok(text),
        false => {
            let message = "the text of the new rule set does not read back as the same rule set";
            let finding = Diagnostic::error("read-back", 0..0, message);
            Err(Findings::locate(vec![finding], &text))
        }
    }
}

/// A text in the layout of `flagred fmt`, if it can be formatted.
fn laid_out(text: String) -> String {
    formatted(&text).unwrap_or(text)
}

/// Replaces the numbers and the last step in a text by those of a rule set; `None` if anything else
/// differs.
fn in_place(text: &str, model: &Model) -> Option<String> {
    let document = fuzzy::yaml::parse(text).ok()?;
    let mut edits = numbers::of_model(text, &document, model)?;
    edits.push(last_step(text, &document, model)?);
    let text = edited(text, &edits);
    let read = fuzzy::yaml::parse(&text).ok()?;
    (read.model == *model).then_some(text)
}

/// The edit that adds the last step of a rule set to a text that contains only the earlier steps.
fn last_step(text: &str, document: &Document, model: &Model) -> Option<Edit> {
    const KEY: &str = "provenance:\n";
    let only = Model {
        provenance: model.provenance.last().cloned().into_iter().collect(),
        ..document.model.clone()
    };
    let written = fuzzy::yaml::to_string(&only);
    let (_, step) = written.rsplit_once(&format!("\n{KEY}"))?;
    let key = document.spans.provenance.clone();
    let (at, added) = match key.is_empty() {
        true => (text.len(), format!("{KEY}{step}")),
        false => {
            let (at, indent) = end_of_list(text, key.end)?;
            let lines = step.split_inclusive('\n');
            let line = |line: &str| format!("{indent}{}", line.strip_prefix("  ").unwrap_or(line));
            (at, lines.map(line).collect())
        }
    };
    let ended = text.get(..at)?.ends_with('\n') || at == 0;
    let added = if ended { added } else { format!("\n{added}") };
    Some(Edit {
        span: at..at,
        text: match text.contains("\r\n") {
            true => added.replace('\n', "\r\n"),
            false => added,
        },
    })
}

/// The end of the block list of a top-level key, and the indentation of its items.
fn end_of_list(text: &str, key_end: usize) -> Option<(usize, &str)> {
    let mut at = key_end;
    let mut lines = text.get(key_end..)?.split_inclusive('\n');
    at += lines.next()?.len();
    let mut found = None;
    for line in lines {
        at += line.len();
        let inner = line.trim_start_matches(' ');
        if inner.trim_end().is_empty() || inner.starts_with('#') {
            continue;
        }
        let indent = line.get(..line.len() - inner.len())?;
        match (&mut found, inner.starts_with('-')) {
            (None, true) => found = Some((at, indent)),
            (Some((end, _)), is_item) if is_item || !indent.is_empty() => *end = at,
            _ => break,
        }
    }
    found
}

/// A step on one line: `flagred tune: 61 rows of rows.csv, RMS error 10.1 -> 9.2`.
pub fn words(step: &ProvenanceStep) -> String {
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

/// Adds a finding if the rule set was edited after a command created it.
pub fn with_edited(mut findings: Findings, document: &Document, text: &str) -> Findings {
    let edited = edited_since(document).into_iter().collect();
    findings.0.extend(Findings::locate(edited, text).0);
    findings
}

fn edited_since(document: &Document) -> Option<Diagnostic> {
    let last = document.model.provenance.last()?;
    let is_same = last.result.as_ref()? == &fingerprint(&document.model);
    let finding = Diagnostic::note(
        "edited-since",
        document.spans.provenance.clone(),
        format!("the rule set was edited after `{}` made it", last.command),
    );
    let help = "`provenance` describes an earlier version of the rule set; run the command again, or add a step that describes your edit";
    (!is_same).then(|| finding.help(help))
}

/// The first digits of a hash of the meaning of a rule set, excluding its name, notes and the origin of rules.
pub fn fingerprint(model: &Model) -> String {
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

#[cfg(test)]
mod tests {
    use super::*;

    const FAN: &str = "fuzzy: 1
name: fan # short
inputs: {heat: {range: [0, 40], partition: {cool: 5, hot: 35}}}
outputs: {speed: {range: [0, 10], partition: [slow, fast]}}
rules:
- IF heat IS cool THEN speed IS slow
- IF heat IS hot THEN speed IS fast
";

    fn step(note: &str) -> ProvenanceStep {
        ProvenanceStep {
            command: "flagred tune".into(),
            note: Some(note.into()),
            ..ProvenanceStep::default()
        }
    }

    /// A rule set whose peak of `hot` was moved to 30, with a provenance step.
    fn moved(text: &str, note: &str) -> String {
        let mut model = fuzzy::yaml::parse(text).unwrap().model;
        let mut heat = model.inputs.remove(0);
        heat.terms.clear();
        let heat = heat.partition_at([("cool", 5.0), ("hot", 30.0)]);
        model.inputs.insert(0, heat);
        let written = rule_set(text, model.clone(), step(note)).unwrap();
        let read = fuzzy::yaml::parse(&written).unwrap().model;
        assert_eq!(read.inputs, model.inputs);
        assert_eq!(read.provenance.len(), model.provenance.len() + 1);
        written
    }

    #[test]
    fn a_step_is_added_beside_the_others_in_the_text() {
        let expected = FAN.replace("hot: 35", "hot: 30");
        let once = moved(FAN, "one");
        assert!(once.starts_with(&expected), "{once}");
        let twice = moved(&once, "two");
        assert!(twice.starts_with(&once), "{twice}");
        assert!(moved(FAN.trim_end(), "one").starts_with(&expected));

        let lines = FAN.replace('\n', "\r\n");
        let written = moved(&lines, "one");
        assert!(
            written.starts_with(&expected.replace('\n', "\r\n")),
            "{written}"
        );
        assert_eq!(
            written.matches('\n').count(),
            written.matches("\r\n").count()
        );

        let steps =
            "provenance: # of before\n- command: by hand\n  note: first\n\n# the rules\nrules:";
        let middle = FAN.replace("rules:", steps);
        let written = moved(&middle, "two");
        let (before, after) = written.split_once("note: two").unwrap();
        assert!(before.contains("  note: first\n-"), "{written}");
        assert!(after.contains("\n\n# the rules\nrules:\n- IF"), "{written}");
    }

    #[test]
    fn a_text_without_room_for_a_step_is_rewritten() {
        let flow = FAN.replace("rules:", "provenance: [{command: by hand}]\nrules:");
        assert!(moved(&flow, "two").contains("command: by hand"));
        let json = "{\"fuzzy\": 1, \"name\": \"fan\", \"inputs\": {\"heat\": {\"range\": [0, 40], \"partition\": {\"cool\": 5, \"hot\": 35}}},
            \"outputs\": {\"speed\": {\"range\": [0, 10], \"partition\": [\"slow\", \"fast\"]}}, \"rules\": [\"IF heat IS hot THEN speed IS fast\"]}";
        assert!(moved(json, "one").starts_with("fuzzy: 1\n"));
    }

    #[test]
    fn text_that_does_not_read_back_is_refused() {
        let mut model = fuzzy::yaml::parse(FAN).unwrap().model;
        model.outputs[0].variable.high = f64::NAN;
        assert!(rule_set(FAN, model, step("one")).is_err());
    }
}
