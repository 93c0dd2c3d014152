//! `flagred tune` with files.
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

/// Rows of a fan that turns slowly up to 20 degrees, and fast from 30 degrees on. The column `room` has four values.
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
fn moved_numbers_are_printed_and_written() {
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
        out.contains("(4 folds of groups of `room`, 95 % intervals)"),
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
fn check_reports_the_provenance_and_later_edits() {
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
fn only_free_parameters_move() {
    let (_, _, _, written) = tune(
        &[],
        &["--only", "heat", "--fix", "heat.cool", "--no-validation"],
    );
    assert!(written.unwrap().contains("partition: {cool: 5, hot: "));
    let (code, _, err, written) = tune(&[], &["--only", "haet"]);
    assert_eq!((code, written), (Some(2), None));
    assert!(
        err.contains("the rule set has no variable and no term `haet`"),
        "{err}"
    );
}

#[test]
fn rows_that_do_not_fit_the_loss_are_refused() {
    let (code, _, err, written) = tune(&[], &["--loss", "log"]);
    assert_eq!((code, written), (Some(3), None));
    assert!(
        err.contains(
            "the values of `speed` are from 2 to 8, but `--loss log` is for outcomes of 0 and 1"
        ),
        "{err}"
    );
    let (code, out, _, written) = tune(&[], &["--loss", "log", "--column", "speed=is_loud"]);
    assert_eq!(code, Some(0));
    assert!(out.contains("log loss"), "{out}");
    assert!(written.is_some());
}

#[test]
fn a_checkpoint_is_the_starting_point_unless_it_is_of_another_rule_set() {
    let better = FAN.replace("cool: 5, hot: 35", "cool: 19, hot: 31");
    let (_, out, _, _) = tune(
        &[("best.yaml", &better)],
        &["--checkpoint", "best.yaml", "--no-validation"],
    );
    assert!(out.contains("started     with the checkpoint\n"), "{out}");
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
fn a_start_that_is_not_monotone_is_refused() {
    let (code, _, err, _) = tune(&[], &["--falling", "heat"]);
    assert_eq!(code, Some(3));
    assert!(
        err.contains("the output is not decreasing in `heat` before tuning"),
        "{err}"
    );
}

/// If all weights are 0, or values are so large that errors overflow, the existing file is kept.
#[test]
fn rows_without_information_or_with_overflow_are_refused() {
    let weightless = rows().replace(",1,", ",0,");
    let extreme = "heat,speed,w\n10,2,1\n30,1e308,1\n";
    let heavy = "heat,speed,w\n10,2,1e308\n30,8,1\n";
    for (rows, more, reported) in [
        (
            &*weightless,
            &["--weight", "is_loud"][..],
            "the weights of all rows are 0",
        ),
        (
            extreme,
            &[],
            "`rows.csv`, line 3: the value 1e308 is outside the range from -1e50 to 1e50",
        ),
        (
            heavy,
            &["--weight", "w"],
            "`rows.csv`, line 2: the weight is 1e308, but must be 0, or a number from 1e-50 to 1e50",
        ),
    ] {
        let files = [("rows.csv", rows), ("out.yaml", "good")];
        let (code, _, err, written) = tune(&files, &[more, &["--force"]].concat());
        assert_eq!((code, written.as_deref()), (Some(3), Some("good")), "{err}");
        assert!(err.contains(reported), "{err}");
    }
    // Some rows with weight 0 are allowed.
    let (code, _, err, written) = tune(&[], &["--weight", "is_loud", "--folds", "30"]);
    assert_eq!(code, Some(0), "{err}");
    assert!(!written.unwrap().contains(".nan"));
}

const CONSTANTS: &str = "fuzzy: 1
name: fan
inputs: {heat: {range: [0, 40], partition: {cool: 5, hot: 35}}}
outputs:
  speed:
    range: [0, 10]
    terms: {slow: {constant: 2}, fast: {constant: 8}}
    defuzzifier: weighted_average
rules:
  - IF heat IS cool THEN speed IS slow
  - IF heat IS hot THEN speed IS fast
";

/// The rows are on a line that would reach 14, beyond the range, at the peak of `hot`.
#[test]
fn constants_stay_in_the_range_by_default() {
    let mut rows = String::from("heat,speed\n");
    for heat in 5..=25 {
        writeln!(rows, "{heat},{}", 2.0 + 0.4 * f64::from(heat - 5)).unwrap();
    }
    let files = [("fan.yaml", CONSTANTS), ("rows.csv", &*rows)];
    let tuned = |more: &[&str]| {
        let arguments = [&["--only", "speed", "--no-validation"], more].concat();
        let (code, _, err, written) = tune(&files, &arguments);
        assert_eq!(code, Some(0), "{err}");
        written.unwrap()
    };
    let written = tuned(&[]);
    assert!(written.contains("fast: {constant: 10}"), "{written}");
    let written = tuned(&["--beyond-range"]);
    assert!(written.contains("fast: {constant: 14}"), "{written}");
    // The search without a closed form has the same bounds.
    let written = tuned(&["--rising", "heat"]);
    assert!(written.contains("fast: {constant: 10}"), "{written}");
}

/// The rows use a unit different from that of the range: the constants stop at the end of the range, and the report
/// explains why.
#[test]
fn constants_that_the_rows_pull_out_of_the_range_are_reported() {
    let rows = "heat,speed\n5,1400\n15,1500\n25,1600\n35,1700\n";
    let files = [("fan.yaml", CONSTANTS), ("rows.csv", rows)];
    let arguments = ["--only", "speed", "--no-validation"];
    let (code, out, err, written) = tune(&files, &arguments);
    assert_eq!(code, Some(0), "{err}");
    assert!(
        out.contains(
            "at bounds   speed.slow, speed.fast: the rows require values beyond the range;"
        ),
        "{out}"
    );
    let written = written.unwrap();
    assert!(
        written.contains("{slow: {constant: 10}, fast: {constant: 10}}"),
        "{written}"
    );
    let (_, out, ..) = tune(&files, &[&arguments[..], &["--json"]].concat());
    assert!(
        out.contains("\"at_bounds\": [\n    \"speed.slow\""),
        "{out}"
    );
    // When the tuned file is tuned again, nothing moves.
    let files = [("fan.yaml", &*written), ("rows.csv", rows)];
    let (_, out, ..) = tune(&files, &arguments);
    assert!(out.contains("nothing: no step within the range"), "{out}");
}

#[test]
fn numbers_are_rounded_to_three_digits_by_default() {
    let mut rows = String::from("heat,speed\n");
    for heat in 0..=40 {
        writeln!(rows, "{heat},{}", 3.123_456 + 0.123_456 * f64::from(heat)).unwrap();
    }
    let written = |more: &[&str]| {
        let (.., written) = tune(
            &[("rows.csv", &rows)],
            &[more, &["--no-validation"]].concat(),
        );
        let written = written.unwrap();
        let numbers = written.split_once("provenance").unwrap().0.to_owned();
        let digits = |word: &str| {
            word.trim_start_matches(['0', '.'])
                .bytes()
                .filter(u8::is_ascii_digit)
                .count()
        };
        numbers
            .split([' ', ',', '}', ']'])
            .map(digits)
            .max()
            .unwrap()
    };
    assert!(written(&[]) <= 3);
    assert!(written(&["--round", "all"]) > 5);
    let (code, _, err, _) = tune(&[], &["--round", "0"]);
    assert_eq!(code, Some(2));
    assert!(err.contains("from 1 to 17, or `all`"), "{err}");
}

const LAID_OUT: &str = "# A fan for the attic.
fuzzy: 1
name: fan   # short

inputs:
    heat: { range: [0, 40], unit: °C, partition: [ cool, mild, hot ] }  # even
    damp:
        range: [0, 1]   # a share
        terms:
            dry: {left_shoulder: [0.30, 0.60]}   # as measured
            wet: {right_shoulder: [ 0.3, 0.6 ]}

outputs:
    speed:
        range: [0, 10]
        terms:
            slow: {linear: {heat: 0.0}}   # no constant
            fast: {constant: 8.00}
        defuzzifier: weighted_average

rules:
    - if heat is cool or heat is mild then speed is slow      # small letters
    - \"IF (heat IS hot) AND damp IS wet THEN speed IS fast\"
    - rule: IF damp IS dry THEN speed IS slow WITH 0.50
      note: as the old one did
";

/// Returns the text without its digits.
fn shape(text: &str) -> String {
    text.chars()
        .filter(|c| !c.is_ascii_digit() && *c != '.' && *c != '-')
        .collect()
}

/// Comments, order, quotes and layout are kept.
#[test]
fn numbers_change_in_place_in_the_text() {
    let mut rows = String::from("heat,damp,speed\n");
    for i in 0..200 {
        let (heat, damp) = (f64::from(i * 7 % 41), f64::from(i * 13 % 20) / 20.0);
        let speed = if heat > 22.0 { 7.3 } else { 1.9 } + damp;
        writeln!(rows, "{heat},{damp},{speed}").unwrap();
    }
    let files = [("fan.yaml", LAID_OUT), ("rows.csv", &*rows)];
    let (code, _, err, written) = tune(&files, &["--rule-weights", "--no-validation"]);
    assert_eq!(code, Some(0), "{err}");
    let written = written.unwrap();
    let (rules, provenance) = written.split_once("provenance:\n").unwrap();
    let before: Vec<&str> = LAID_OUT.lines().collect();
    let after: Vec<&str> = rules.lines().collect();
    assert_eq!(before.len(), after.len(), "{written}");
    for (before, after) in before.iter().zip(&after) {
        let expected = shape(before).replace("{heat: }", "{constant: , heat: }");
        let weighted = shape(after)
            .replace("{ cool: , mild: , hot:  }", "[ cool, mild, hot ]")
            .replace(" WITH ", "");
        assert_eq!(weighted, expected.replace(" WITH ", ""), "{written}");
    }
    assert!(provenance.contains("command: flagred tune"), "{written}");

    // The provenance of a second tuning is appended to that of the first.
    let files = [("fan.yaml", &*written), ("rows.csv", &*rows)];
    let (code, _, err, again) = tune(&files, &["--only", "speed", "--no-validation"]);
    assert_eq!(code, Some(0), "{err}");
    let again = again.unwrap();
    assert_eq!(again.matches("command: flagred tune").count(), 2, "{again}");
    assert_eq!(
        shape(again.split_once("provenance:").unwrap().0),
        shape(rules)
    );
}

/// Two terms share an anchor: the whole rule set is written anew, with correct values.
#[test]
fn a_text_that_cannot_change_in_place_is_rewritten() {
    let shared = FAN.replace(
        "terms: {slow: {singleton: 2}, fast: {singleton: 8}}",
        "terms: {slow: &n {singleton: 3}, fast: {singleton: 8}, idle: *n}",
    );
    let (code, _, err, written) = tune(&[("fan.yaml", &shared)], &["--no-validation"]);
    assert_eq!(code, Some(0), "{err}");
    let written = written.unwrap();
    assert!(written.starts_with("# A fan for the attic.\nfuzzy: 1\n") && !written.contains("&n"));
}

/// Where files cannot grow beyond 512 bytes, as on a full disk, output to a pipe is still complete.
#[test]
#[cfg(unix)]
fn other_outputs_are_written_despite_a_full_disk() {
    let long = FAN.replace(
        "name: fan\n",
        &format!("name: fan\ndescription: {}\n", "x".repeat(600)),
    );
    let (rows, program) = (rows(), env!("CARGO_BIN_EXE_flagred"));
    let folder = folder(&[("fan.yaml", &*long), ("rows.csv", &*rows)]);
    let run = |limit: &str, arguments: &str| {
        let script = format!(
            "trap '' XFSZ; {limit} exec {program} tune fan.yaml rows.csv --no-validation {arguments}"
        );
        let output = std::process::Command::new("sh")
            .args(["-c", &script])
            .current_dir(folder.path())
            .output()
            .unwrap();
        let [out, err] =
            [output.stdout, output.stderr].map(|text| String::from_utf8(text).unwrap());
        (output.status.code(), out, err)
    };
    let (code, out, err) = run("ulimit -f 1;", "-o - --checkpoint best.yaml");
    assert_eq!(code, Some(2));
    assert!(out.contains("partition: {cool: 20, hot: 30}"), "{out}");
    assert!(err.contains("moved       heat.cool"), "{err}");
    assert!(
        err.contains("error: `best.yaml` cannot be written"),
        "{err}"
    );
    let (code, out, err) = run("", "-o /dev/full --svg moved.svg");
    assert_eq!(code, Some(2));
    assert!(out.contains("moved       heat.cool"), "{out}");
    assert!(
        err.contains("error: `/dev/full` cannot be written"),
        "{err}"
    );
    assert!(folder.path().join("moved.svg").exists());
}

/// A checkpoint must not change numbers that the user fixed.
#[test]
fn a_checkpoint_with_other_fixed_numbers_is_refused() {
    let moved = FAN.replace("{singleton: 8}", "{singleton: 7}");
    let weighted = FAN.replace("IS fast\n", "IS fast WITH 0.5\n");
    for (checkpoint, more, expected) in [
        (
            &moved,
            &["--fix", "speed"][..],
            "the checkpoint `best.yaml` changes `at` of `speed.fast` from 8 to 7, which must not change",
        ),
        (
            &moved,
            &["--only", "heat"],
            "changes `at` of `speed.fast` from 8 to 7, which must not change",
        ),
        (
            &weighted,
            &[],
            "changes `weight` of `rule 2` from 1 to 0.5, which must not change",
        ),
    ] {
        let arguments = [&["--checkpoint", "best.yaml", "--no-validation"], more].concat();
        let (code, _, err, written) = tune(&[("best.yaml", checkpoint)], &arguments);
        assert_eq!((code, written), (Some(2), None), "{err}");
        assert!(err.contains(expected), "{err}");
    }
    for (checkpoint, more) in [
        (&moved, &["--fix", "speed.slow"][..]),
        (&moved, &["--only", "speed.fast"]),
        (&weighted, &["--rule-weights"]),
    ] {
        let arguments = [&["--checkpoint", "best.yaml", "--no-validation"], more].concat();
        let (code, _, err, _) = tune(&[("best.yaml", checkpoint)], &arguments);
        assert_eq!(code, Some(0), "{err}");
    }
}

/// A regression test: at 1e15 the report named only one of two constants, and at 1e20 it claimed
/// that no step helps.
#[test]
fn targets_that_leave_no_digit_of_the_loss_are_refused() {
    for target in ["1e8", "-1e15", "1e20", "1e49"] {
        let rows = format!("heat,speed\n10,2\n30,{target}\n");
        let (code, _, err, written) = tune(&[("rows.csv", &rows)], &["--no-validation"]);
        assert_eq!((code, written), (Some(3), None), "{err}");
        let expected = format!(
            "the target {target} is farther from the output's range [0, 10] than 1000000 times its width"
        );
        assert!(err.contains(&expected), "{err}");
        assert!(err.contains("help: check the units"), "{err}");
    }
}

/// A checkpoint with other rules, another range or another operator does not belong to this rule set.
#[test]
fn a_checkpoint_that_differs_in_more_than_numbers_is_refused() {
    let rules = "  - IF heat IS cool THEN speed IS slow\n  - IF heat IS hot THEN speed IS fast\n";
    let crossed = "  - IF heat IS cool THEN speed IS fast\n  - IF heat IS hot THEN speed IS slow\n";
    for other in [
        FAN.replace(rules, crossed),
        FAN.replace("range: [0, 40]", "range: [0, 41]"),
        FAN.replace("rules:", "operators: {and: product}\nrules:"),
    ] {
        let (code, _, err, written) =
            tune(&[("best.yaml", &other)], &["--checkpoint", "best.yaml"]);
        assert_eq!((code, written), (Some(2), None));
        assert!(
            err.contains("`best.yaml` is a checkpoint of another rule set"),
            "{err}"
        );
    }
}

#[test]
fn a_header_without_names_is_reported() {
    let (code, _, err, _) = tune(&[("rows.csv", ",,\n1,2,3\n")], &[]);
    assert_eq!(code, Some(3));
    assert!(
        err.contains("the header of `rows.csv` does not name its 3 columns"),
        "{err}"
    );
    let (code, _, err, _) = tune(&[("rows.csv", "")], &[]);
    assert_eq!(code, Some(3));
    assert!(err.contains("`rows.csv` is empty"), "{err}");
}
