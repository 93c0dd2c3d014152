//! Commands with rule sets in which outputs read other outputs.
#![allow(clippy::unwrap_used, clippy::panic)]

mod common;

use common::{flagred, folder};

/// `fan` reads `comfort`, which has a value only below 30 °C.
const FAN: &str = "
fuzzy: 1
name: fan
inputs: {heat: {range: [0, 40], unit: °C, terms: {low: {left_shoulder: [10, 30]}}}}
outputs:
  fan: {range: [0, 9], partition: [slow, fast], when_no_rule_fires: {value: 0}}
  comfort: {range: [0, 1], partition: [poor, good]}
rules:
  - IF comfort IS good THEN fan IS slow
  - IF NOT comfort IS good THEN fan IS fast
  - IF heat IS low THEN comfort IS good
";

#[test]
fn explain_shows_the_chain_and_the_reason_for_its_end() {
    let folder = folder(&[("fan.yaml", FAN)]);
    let explain = |heat: &str| flagred(folder.path(), &["explain", "fan.yaml", heat]).1;
    let known = explain("heat=12");
    assert!(
        known.contains("\nfan = ") && known.contains("  reads comfort = "),
        "{known}"
    );
    let unknown = explain("heat=35");
    assert!(
        unknown.contains(
            "\nfan is undefined, because comfort is\n  reads comfort, which is undefined\n"
        ),
        "{unknown}"
    );
    assert!(
        unknown.contains("\ncomfort is undefined: no rule fired\n"),
        "{unknown}"
    );

    let (_, json, _) = flagred(folder.path(), &["explain", "fan.yaml", "heat=12", "--json"]);
    let json: serde_json::Value = serde_json::from_str(&json).unwrap();
    assert_eq!(json["outputs"][0]["reads"][0], "comfort");
    assert_eq!(
        json["outputs"][1]["reads"].as_array().map(Vec::len),
        Some(0)
    );

    let (_, svg, _) = flagred(
        folder.path(),
        &["explain", "fan.yaml", "heat=12", "--svg", "-"],
    );
    assert!(svg.contains("; reads comfort = "), "{svg}");
}

#[test]
fn a_map_has_the_values_of_eval() {
    let folder = folder(&[("fan.yaml", FAN), ("points.csv", "heat\n0\n10\n20\n")]);
    let mut map = vec!["map", "fan.yaml", "--csv", "--points", "5"];
    map.extend(["--of", "fan", "--fill", "none"]);
    let (code, map, errors) = flagred(folder.path(), &map);
    assert_eq!(code, Some(0), "{errors}");
    let (_, eval, _) = flagred(folder.path(), &["eval", "fan.yaml", "points.csv"]);
    let second = |row: &str| row.split(',').nth(1).unwrap().parse::<f64>().ok();
    let rows: Vec<_> = map.lines().zip(eval.lines()).skip(1).collect();
    assert_eq!(rows.len(), 3, "{map}");
    for (map, eval) in rows {
        let (map, eval) = (second(map).unwrap(), second(eval).unwrap());
        assert!((map - eval).abs() < 1e-6, "{map}, {eval}");
    }
    // Above 30 °C the fan has no value, although it has a default.
    assert_eq!(map.lines().last().and_then(second), None, "{map}");
}

#[test]
fn the_last_output_is_learned_from_its_own_column() {
    let data = "heat,fan\n5,1\n12,2\n";
    let folder = folder(&[("fan.yaml", FAN), ("data.csv", data)]);
    let learn = ["learn", "fan.yaml", "data.csv", "-o", "new.yaml"];
    let (code, report, errors) = flagred(folder.path(), &learn);
    assert_eq!(code, Some(0), "{errors}");
    assert!(report.contains("2 used, 0 refused"), "{report}");
    let learned = std::fs::read_to_string(folder.path().join("new.yaml")).unwrap();
    for rule in [
        "IF heat IS low THEN comfort IS good",
        "IF comfort IS good THEN fan IS slow",
    ] {
        assert!(learned.contains(rule), "{rule}: {learned}");
    }
    let (code, report, errors) = flagred(
        folder.path(),
        &[
            "tune",
            "new.yaml",
            "data.csv",
            "-o",
            "tuned.yaml",
            "--no-validation",
        ],
    );
    assert_eq!(code, Some(0), "{errors}");
    assert!(report.contains("2 used, 0 refused"), "{report}");
}

#[test]
fn a_chain_is_exported_to_every_language() {
    let paper = include_str!("../../../rules/flagred-paper.yaml").replace(
        "outputs:\n",
        "outputs:\n  strain: {range: [0, 1], partition: [low, high]}\n",
    ) + "  - IF margin IS low THEN strain IS high\n  - IF strain IS high THEN risk IS high\n";
    let profile = include_str!("../../../rules/profiles/flagred-paper.yaml")
        .replace("rules: flagred-paper ", "rules: chain.yaml ");
    let folder = folder(&[("chain.yaml", &*paper), ("profile.yaml", &*profile)]);
    for (language, part) in [("--rust", "stages"), ("--c", "stages"), ("--lua", "x[3] =")] {
        let (code, text, errors) = flagred(folder.path(), &["export", language, "profile.yaml"]);
        assert_eq!(code, Some(0), "{errors}");
        assert!(text.contains(part), "{text}");
    }
}
