//! Commands that read tables in addition to a rule set: `eval`, `explain --rows`, `map --check`, `learn`, `tune`.
#![allow(clippy::unwrap_used)]

mod common;

use std::fs;

use common::{flagred, folder};

const FAN: &str = "fuzzy: 1
name: fan
inputs: {heat: {range: [0, 40], partition: {cool: 5, hot: 35}}}
outputs: {speed: {range: [0, 10], terms: {slow: {constant: 0}, fast: {constant: 10}}, defuzzifier: weighted_average}}
rules: [IF heat IS cool THEN speed IS slow, IF heat IS hot THEN speed IS fast]
";

#[test]
fn eval_copies_cells_as_they_are() {
    let table = "heat,-note,=place\n5,-,=A1+2\n35,@x,\"+1, \u{fc}\u{a0}\"\n";
    let folder = folder(&[("fan.yaml", FAN), ("points.csv", table)]);
    let expected = "heat,-note,=place,speed\n5,-,=A1+2,0\n35,@x,\"+1, \u{fc}\u{a0}\",10\n";
    let (code, out, err) = flagred(folder.path(), &["eval", "fan.yaml", "points.csv"]);
    assert_eq!((code, out.as_str(), err.as_str()), (Some(0), expected, ""));
    let arguments = ["explain", "fan.yaml", "--rows", "points.csv"];
    let (code, out, _) = flagred(folder.path(), &arguments);
    assert_eq!(code, Some(0));
    assert!(
        out.contains("\n5,-,=A1+2,0,1,1=1\n35,@x,\"+1, \u{fc}\u{a0}\",10,"),
        "{out}"
    );
}

#[test]
fn map_check_compares_the_columns_that_eval_wrote() {
    let measured = "h;speed\n5;1\n20;4\n35;9\n";
    let folder = folder(&[("fan.yaml", FAN), ("measured.csv", measured)]);
    let layout = [
        "--suffix",
        "_rules",
        "--column",
        "heat=h",
        "--delimiter",
        ";",
    ];
    let eval = ["eval", "fan.yaml", "measured.csv", "-o", "compared.csv"];
    let (code, ..) = flagred(folder.path(), &[&eval[..], &layout].concat());
    assert_eq!(code, Some(0));
    let check = ["map", "fan.yaml", "--check", "compared.csv"];
    let (code, out, err) = flagred(folder.path(), &[&check[..], &layout].concat());
    let same = "compared.csv: `speed_rules` is the same at 3 points\n";
    assert_eq!((code, out.as_str(), err.as_str()), (Some(0), same, ""));
    // Without `--suffix`, `map --check` compares the column with the measured values.
    let (code, out, err) = flagred(folder.path(), &[&check[..], &layout[2..]].concat());
    assert_eq!(code, Some(1));
    insta::assert_snapshot!(out + &err, @r"
    compared.csv: `speed` differs at 3 of 3 points, most in line 2, at heat = 5: 1 before, 0 now
    help: if `eval --suffix _rules` wrote the table, add `--suffix _rules`: the columns without it contain measured values
    ");
    // The columns of explanations have the same names.
    let explain = ["explain", "fan.yaml", "--rows", "measured.csv"];
    let (code, out, _) = flagred(folder.path(), &[&explain[..], &layout].concat());
    assert_eq!(code, Some(0));
    assert!(
        out.starts_with("h;speed;speed_rules;speed_rules_rule;speed_rules_shares\n5;1;0;1;1=1\n"),
        "{out}"
    );
    flagred(
        folder.path(),
        &["map", "fan.yaml", "--values", "-o", "map.txt"],
    );
    let (code, _, err) = flagred(folder.path(), &["map", "fan.yaml", "--check", "map.txt"]);
    assert_eq!(code, Some(3));
    assert!(err.contains("`map --csv` writes such a table"), "{err}");
    let (code, _, err) = flagred(folder.path(), &["map", "fan.yaml", "--suffix", "_rules"]);
    assert_eq!(code, Some(2));
    assert!(err.contains("name a table with `--check`"), "{err}");
}

#[test]
fn rows_with_too_few_cells_are_skipped_by_every_command() {
    let table = "heat,speed\n0,0\n10\n20,5\nmuch,1\n30,8\n40,10\n";
    let folder = folder(&[("fan.yaml", FAN), ("rows.csv", table)]);
    let run = |arguments: &[&str]| flagred(folder.path(), arguments);
    for command in [
        &[
            "learn",
            "fan.yaml",
            "rows.csv",
            "-o",
            "out.yaml",
            "--no-validation",
        ][..],
        &[
            "tune",
            "fan.yaml",
            "rows.csv",
            "-o",
            "out.yaml",
            "--no-validation",
        ],
        &["simplify", "fan.yaml", "rows.csv", "-o", "out.yaml"],
        &[
            "identify",
            "rows.csv",
            "--target",
            "speed",
            "-o",
            "out.yaml",
            "--no-validation",
        ],
        &[
            "explain", "fan.yaml", "--rows", "rows.csv", "--suffix", "_rules",
        ],
    ] {
        let force = &["--force"][..usize::from(command[0] != "explain")];
        let (code, _, err) = run(&[command, force].concat());
        assert_eq!(code, Some(3), "{command:?}");
        assert!(
            err.contains("`rows.csv`, line 3: 1 cell, but the header has 2"),
            "{err}"
        );
        assert!(err.contains("`--skip-bad-rows`"), "{err}");
        let (code, out, err) = run(&[command, force, &["--skip-bad-rows"]].concat());
        assert_eq!(code, Some(0), "{command:?}: {err}");
        let reported = out + &err;
        let counted = ["2 refused", "2 rows refused", "left out 2 of 6 rows"];
        assert!(
            counted.iter().any(|count| reported.contains(count)) || command[0] == "simplify",
            "{reported}"
        );
    }
}

#[test]
fn tune_reports_the_error_that_eval_reports() {
    // Two targets are outside the range of the output, and one input is outside its range.
    let table = "heat,speed\n0,-3\n10,1\n20,5\n30,8\n45,14\n";
    let folder = folder(&[("fan.yaml", FAN), ("rows.csv", table)]);
    let tune = [
        "tune",
        "fan.yaml",
        "rows.csv",
        "-o",
        "tuned.yaml",
        "--clamp",
        "--no-validation",
        "--json",
    ];
    let (code, out, err) = flagred(folder.path(), &tune);
    assert_eq!(code, Some(0), "{err}");
    assert!(
        err.contains("`heat` is outside its range from 0 to 40 in 1 of 5 rows"),
        "{err}"
    );
    assert!(!err.contains("`speed` is outside"), "{err}");
    let report: serde_json::Value = serde_json::from_str(&out).unwrap();
    let after = report["after"].as_f64().unwrap();
    let eval = ["eval", "tuned.yaml", "rows.csv", "--suffix", "_rules"];
    let (_, _, err) = flagred(folder.path(), &eval);
    let rms = err.split_once("RMS error ").unwrap().1;
    let rms: f64 = rms.split_once(',').unwrap().0.parse().unwrap();
    assert!((after - rms).abs() < 1e-5, "{after} {rms}");
}

#[test]
fn long_lists_of_rows_report_how_many_are_not_shown() {
    let mut table = String::from("heat,speed\n20,5\n");
    table.extend((0..20).map(|i| format!("{},5\n", 41 + i)));
    let folder = folder(&[("fan.yaml", FAN), ("rows.csv", &table)]);
    for command in ["learn", "tune"] {
        let arguments = [
            command,
            "fan.yaml",
            "rows.csv",
            "-o",
            "out.yaml",
            "--force",
            "--skip-bad-rows",
            "--no-validation",
        ];
        let (code, out, err) = flagred(folder.path(), &arguments);
        assert_eq!(code, Some(0), "{err}");
        let first = "`rows.csv`, line 3";
        assert!(out.contains(first) && out.contains("41"), "{out}");
        assert!(out.contains(" and 8 more\n"), "{out}");
    }
}

#[test]
fn written_rule_sets_have_the_layout_of_fmt() {
    let rows = "heat,speed\n0,0\n10,1\n20,5\n30,8\n40,10\n";
    let folder = folder(&[("fan.yaml", FAN), ("rows.csv", rows)]);
    let run = |arguments: &[&str]| {
        let (code, out, err) = flagred(folder.path(), arguments);
        assert_eq!(code, Some(0), "{arguments:?}: {out}{err}");
    };
    run(&["learn", "fan.yaml", "rows.csv", "-o", "learned.yaml"]);
    run(&["tune", "learned.yaml", "rows.csv", "-o", "tuned.yaml"]);
    run(&["simplify", "tuned.yaml", "-o", "simplified.yaml"]);
    run(&[
        "identify",
        "rows.csv",
        "--target",
        "speed",
        "-o",
        "identified.yaml",
    ]);
    run(&["new", "battery", "--profile", "flagred-battery"]);
    run(&["new", "paper", "--from", "flagred-paper"]);
    run(&[
        "fmt",
        "--check",
        "learned.yaml",
        "tuned.yaml",
        "simplified.yaml",
        "identified.yaml",
        "battery.yaml",
        "paper.yaml",
    ]);
    // The layout of an author's file does not change.
    let text = FAN.replace("fuzzy: 1", "fuzzy:   1");
    fs::write(folder.path().join("own.yaml"), &text).unwrap();
    run(&["tune", "own.yaml", "rows.csv", "-o", "own-tuned.yaml"]);
    let tuned = fs::read_to_string(folder.path().join("own-tuned.yaml")).unwrap();
    assert!(
        tuned.starts_with("fuzzy:   1\nname: fan\ninputs: {heat: "),
        "{tuned}"
    );
}

#[test]
fn an_inner_output_without_rules_is_named() {
    let chain = "fuzzy: 1
name: chain
inputs: {heat: {range: [0, 40], partition: [low, high]}}
outputs:
  stress: {range: [0, 1], partition: [low, high]}
  risk: {range: [0, 1], partition: [low, high]}
rules: [IF stress IS high THEN risk IS high, IF stress IS low THEN risk IS low]
";
    let folder = folder(&[("chain.yaml", chain), ("rows.csv", "heat,risk\n1,1\n")]);
    let arguments = ["learn", "chain.yaml", "rows.csv", "-o", "out.yaml"];
    let (code, _, err) = flagred(folder.path(), &arguments);
    assert_eq!(code, Some(3));
    insta::assert_snapshot!(err, @r"
    error: `chain.yaml`: the outputs before the last one cannot be computed: no rule concludes `stress`
      help: correct the rules of the outputs that the last output reads
    ");
}

#[test]
fn values_are_printed_at_all_requested_points() {
    let folder = folder(&[("fan.yaml", FAN)]);
    let map = |points: &[&str]| {
        let (code, out, _) = flagred(
            folder.path(),
            &[&["map", "fan.yaml", "--values"], points].concat(),
        );
        assert_eq!(code, Some(0));
        out.split_once("\n\n")
            .map_or(String::new(), |(_, table)| table.to_owned())
    };
    insta::assert_snapshot!(map(&["--points", "9"]) + &map(&[]), @r"
    0 to 9: tenths of 0 to 10

             |       0       5      10      15      20      25      30      35      40
             |   0.000   0.000   1.667   3.333   5.000   6.667   8.333  10.000  10.000
    coverage below 0.5: 0 of 9 cells
    0 to 9: tenths of 0 to 10

             |       0       8      16      24      32      40
             |   0.000   1.000   3.667   6.333   9.000  10.000
    coverage below 0.5: 0 of 51 cells
    ");
}
