//! `flagred tune` on files.
#![allow(clippy::unwrap_used)]

mod common;

use std::fmt::Write as _;

use common::{flagred, folder};

const FAN: &str = "# A fan for the attic.
fuzzy: 1
name: fan
inputs: {heat: {range: [0, 40], partition: {cool: 5, hot: 35}}}
outputs:
  speed: {range: [0, 10], terms: {slow: {singleton: 2}, fast: {singleton: 8}}}
rules:
  - IF heat IS cool THEN speed IS slow
  - IF heat IS hot THEN speed IS fast
";

/// The fan turns slowly up to 20 degrees, fast from 30 degrees on; four rooms.
fn rows() -> String {
    let mut rows = String::from("heat,speed,is_loud,room\n");
    for i in 0..=80 {
        let heat = f64::from(i) / 2.0;
        let speed = 2.0 + 6.0 * ((heat - 20.0) / 10.0).clamp(0.0, 1.0);
        writeln!(rows, "{heat},{speed},{},{}", u8::from(heat > 26.0), i % 4).unwrap();
    }
    rows
}

fn tune(files: &[(&str, &str)], more: &[&str]) -> (Option<i32>, String, String, Option<String>) {
    let rows = rows();
    let folder = folder(&[&[("fan.yaml", FAN), ("rows.csv", &rows)], files].concat());
    let arguments = ["tune", "fan.yaml", "rows.csv", "-o", "out.yaml"];
    let (code, out, err) = flagred(folder.path(), &[&arguments[..], more].concat());
    let written = std::fs::read_to_string(folder.path().join("out.yaml")).ok();
    (code, out, err, written)
}

#[test]
fn what_moved_is_told_and_written() {
    let (code, out, err, written) = tune(&[], &["--round", "2", "--group-by", "room"]);
    assert_eq!((code, err.as_str()), (Some(0), ""));
    assert!(
        out.contains("moved       heat.cool peak 5 -> 20\n"),
        "{out}"
    );
    assert!(
        out.contains("            heat.hot  peak 35 -> 30\n"),
        "{out}"
    );
    assert!(
        out.contains("(4 parts of groups of `room`, 95 % intervals)"),
        "{out}"
    );
    let written = written.unwrap();
    assert!(
        written.starts_with("# A fan for the attic.\nfuzzy: 1\n"),
        "{written}"
    );
    insta::assert_snapshot!(written.split_once("provenance:").unwrap().1);
    assert!(
        written.contains("partition: {cool: 20, hot: 30}"),
        "{written}"
    );
}

#[test]
fn check_tells_what_made_a_rule_set_and_whether_it_was_edited_since() {
    let (.., written) = tune(&[], &["--round", "2", "--no-validation"]);
    let written = written.unwrap();
    let described = written.replace("name: fan", "name: attic\ndescription: A fan");
    let edited = written.replace("hot: 30", "hot: 29");
    let files = [("described.yaml", &*described), ("edited.yaml", &*edited)];
    let folder = folder(&files);
    let check = |file: &str| flagred(folder.path(), &["check", file]).1;
    let out = check("described.yaml");
    let made =
        "described.yaml: made by flagred tune: 81 rows of rows.csv, RMS error 1.31562 -> 0\n";
    assert!(out.contains(made), "{out}");
    assert!(!out.contains("edited-since"), "{out}");
    let edited = "note[edited-since]: the rule set was edited after `flagred tune` made it";
    let out = check("edited.yaml");
    assert!(out.contains(edited), "{out}");
}

#[test]
fn only_what_may_move_does() {
    let (_, _, _, written) = tune(
        &[],
        &["--only", "heat", "--fix", "heat.cool", "--no-validation"],
    );
    assert!(written.unwrap().contains("partition: {cool: 5, hot: "));
    let (code, _, err, written) = tune(&[], &["--only", "haet"]);
    assert_eq!((code, written), (Some(2), None));
    assert!(
        err.contains("the model has no variable and no term `haet`"),
        "{err}"
    );
}

#[test]
fn rows_that_do_not_fit_the_loss_are_refused() {
    let (code, _, err, written) = tune(&[], &["--loss", "log"]);
    assert_eq!((code, written), (Some(3), None));
    assert!(
        err.contains(
            "`rows.csv`, line 2: the output's value is 2, but must be 0 or 1 for this loss"
        ),
        "{err}"
    );
    let (code, out, _, written) = tune(&[], &["--loss", "log", "--column", "speed=is_loud"]);
    assert_eq!(code, Some(0));
    assert!(out.contains("log loss"), "{out}");
    assert!(written.is_some());
}

#[test]
fn a_checkpoint_is_begun_with_and_another_rule_set_is_none() {
    let better = FAN.replace("cool: 5, hot: 35", "cool: 19, hot: 31");
    let (_, out, _, _) = tune(
        &[("best.yaml", &better)],
        &["--checkpoint", "best.yaml", "--no-validation"],
    );
    assert!(out.contains("begun       with the checkpoint\n"), "{out}");
    assert!(out.contains("moved       heat.cool peak 19 -> 20"), "{out}");
    let other = FAN.replace("hot", "warm");
    let (code, _, err, written) = tune(&[("best.yaml", &other)], &["--checkpoint", "best.yaml"]);
    assert_eq!((code, written), (Some(2), None));
    assert!(
        err.contains("`best.yaml` is a checkpoint of another rule set"),
        "{err}"
    );
}

#[test]
fn what_is_not_monotone_to_begin_with_is_refused() {
    let (code, _, err, _) = tune(&[], &["--falling", "heat"]);
    assert_eq!(code, Some(3));
    assert!(
        err.contains("the output is not decreasing in `heat` to begin with"),
        "{err}"
    );
}
