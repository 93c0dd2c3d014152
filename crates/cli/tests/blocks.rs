//! Commands with rule sets that use rule blocks, activation methods or previous values.
#![allow(clippy::unwrap_used, clippy::panic)]

mod common;

use std::fmt::Write as _;

use common::{flagred, folder};

/// No rule fires from 20 to 25 °C.
const FAN: &str = "
fuzzy: 1
name: fan
inputs: {heat: {range: [0, 40], terms: {low: {left_shoulder: [15, 20]}, high: {right_shoulder: [25, 30]}}}}
outputs:
  speed: {range: [0, 9], partition: [slow, fast], when_no_rule_fires: previous}
  lamp: {range: [0, 9], partition: [off, on], when_no_rule_fires: {previous: 4}}
rules: [IF heat IS low THEN speed IS slow AND lamp IS off, IF heat IS high THEN speed IS fast AND lamp IS on]
";

#[test]
fn eval_keeps_the_previous_value_from_row_to_row() {
    let mut points = String::from("heat\n22\n10\n");
    // More rows than fit into one block of rows.
    for _ in 0..9000 {
        points += "22\n";
    }
    points += "\n35\n24\n";
    let folder = folder(&[("fan.yaml", FAN), ("points.csv", &points)]);
    let (code, table, errors) = flagred(folder.path(), &["eval", "fan.yaml", "points.csv"]);
    let mut expected = String::from("heat,speed,lamp\n22,,4\n10,3,3\n");
    for _ in 0..9000 {
        expected += "22,3,3\n";
    }
    writeln!(expected, "35,6,6\n24,6,6").unwrap();
    assert_eq!(table, expected);
    // The first row has no value.
    assert_eq!(code, Some(1), "{errors}");
}

#[test]
fn explain_and_map_report_a_missing_previous_row() {
    let folder = folder(&[("fan.yaml", FAN)]);
    let (_, text, _) = flagred(folder.path(), &["explain", "fan.yaml", "heat=22"]);
    for reported in [
        "\nspeed keeps its previous value, and a single point has none: no rule fired\n",
        "\nlamp keeps its previous value, or 4 if there is none: no rule fired\n",
    ] {
        assert!(text.contains(reported), "{text}");
    }
    let (code, _, errors) = flagred(folder.path(), &["map", "fan.yaml", "--of", "speed"]);
    assert_eq!(code, Some(0), "{errors}");
    let note = "note: `speed` keeps its previous value where no rule fires; the cells of a map have no previous value";
    assert!(errors.contains(note), "{errors}");
}

/// The profile and the rules of the paper, with `more` before the rules.
fn paper(more: &str) -> tempfile::TempDir {
    let rules = include_str!("../../../rules/flagred-paper.yaml").replace("\nrules:\n", more);
    let profile = include_str!("../../../rules/profiles/flagred-paper.yaml")
        .replace("rules: flagred-paper ", "rules: rules.yaml ");
    folder(&[("rules.yaml", &rules), ("profile.yaml", &profile)])
}

#[test]
fn exports_have_blocks_and_the_script_refuses_them() {
    let folder = paper("\nactivation: {highest: 2}\nleast_strength: 1e-6\nrules:\n");
    let export = |language: &str| flagred(folder.path(), &["export", language, "profile.yaml"]);
    let (code, text, errors) = export("--rust");
    assert_eq!(code, Some(0), "{errors}");
    assert!(text.contains(
        "Block { strength: 0.0, method: Method(3), rules: 2, and_operator: 0, or_operator: 0,"
    ));
    assert!(text.contains("least_strength: 1e-6,"));
    let (code, text, errors) = export("--c");
    assert_eq!(code, Some(0), "{errors}");
    assert!(
        text.contains("static const flagred_block flagred_"),
        "{text}"
    );
    let (code, text, errors) = export("--lua");
    assert_eq!((code, text.as_str()), (Some(3), ""));
    assert!(
        errors.contains("activation methods or blocks with different operators"),
        "{errors}"
    );
}

#[test]
fn a_risk_does_not_keep_its_previous_value() {
    let folder = paper("\nrules:\n");
    let path = folder.path().join("rules.yaml");
    let text = std::fs::read_to_string(&path).unwrap();
    let keeping = text.replace(
        "when_no_rule_fires: undefined",
        "when_no_rule_fires: previous",
    );
    assert_ne!(text, keeping);
    std::fs::write(path, keeping).unwrap();
    let (code, found, errors) = flagred(folder.path(), &["check", "profile.yaml"]);
    assert_eq!(code, Some(1), "{errors}");
    let reported = "error[keeps-previous]: output `risk` keeps its previous value where no rule fires, which is not allowed for a risk";
    assert!(found.contains(reported), "{found}");
}

#[test]
fn learn_refuses_blocks() {
    let blocks = "
fuzzy: 1
name: fan
inputs: {heat: {range: [0, 40], partition: [low, high]}}
outputs: {speed: {range: [0, 9], partition: [slow, fast]}}
blocks: {only: {rules: [IF heat IS low THEN speed IS slow]}}
";
    let folder = folder(&[("fan.yaml", blocks), ("data.csv", "heat,speed\n1,2\n")]);
    let (code, _, errors) = flagred(
        folder.path(),
        &["learn", "fan.yaml", "data.csv", "-o", "new.yaml"],
    );
    assert_eq!(code, Some(3), "{errors}");
    assert!(
        errors.contains("the rule set has rule blocks, with which rules cannot be learned"),
        "{errors}"
    );
}
