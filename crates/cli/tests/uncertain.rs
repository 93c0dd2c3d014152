//! `flagred eval --uncertain`.

#![allow(clippy::unwrap_used, clippy::panic)]

use std::{
    fs,
    io::{ErrorKind, Write},
    path::{Path, PathBuf},
    process::{Command, Output, Stdio},
    sync::LazyLock,
};

const RULES: &str = "fuzzy: 1
name: fan
inputs:
  heat: {range: [0, 40], terms: {low: {left_shoulder: [10, 30]}, high: {right_shoulder: [10, 30]}}}
outputs:
  speed: {range: [0, 8], defuzzifier: weighted_average, terms: {slow: {constant: 0}, fast: {constant: 8}}}
  alarm: {range: [0, 1], defuzzifier: weighted_average, terms: {on: {constant: 1}}}
rules:
  - IF heat IS low THEN speed IS slow
  - IF heat IS high THEN speed IS fast AND alarm IS on
";

/// The file with the rules, which is written once.
fn rules() -> &'static Path {
    static FILE: LazyLock<PathBuf> = LazyLock::new(|| {
        let file = Path::new(env!("CARGO_TARGET_TMPDIR")).join("uncertain.yaml");
        fs::write(&file, RULES).unwrap();
        file
    });
    &FILE
}

fn eval(options: &[&str], points: &str) -> (Output, String) {
    let rules = rules();
    let mut child = Command::new(env!("CARGO_BIN_EXE_flagred"))
        .args(["eval".as_ref(), rules.as_os_str(), "-".as_ref()])
        .args(options)
        .stdin(Stdio::piped())
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .unwrap();
    let written = child.stdin.take().unwrap().write_all(points.as_bytes());
    // The command may end before it reads the table, for example because of a wrong option.
    if let Err(error) = written {
        assert_eq!(error.kind(), ErrorKind::BrokenPipe);
    }
    let output = child.wait_with_output().unwrap();
    let text = String::from_utf8(output.stdout.clone()).unwrap();
    (output, text)
}

fn numbers(line: &str) -> Vec<Option<f64>> {
    line.split(',').map(|cell| cell.parse().ok()).collect()
}

#[test]
fn half_widths_are_numbers_or_columns() {
    let (output, text) = eval(&["--uncertain", "heat=2"], "heat\n20\n");
    assert!(output.status.success());
    let mut lines = text.lines();
    assert_eq!(
        lines.next(),
        Some("heat,speed,speed_low,speed_high,alarm,alarm_low,alarm_high")
    );
    let row = numbers(lines.next().unwrap());
    let [heat, speed, low, high, ..] = row[..] else {
        panic!("{row:?}")
    };
    assert_eq!((heat, speed), (Some(20.0), Some(4.0)));
    assert!((low.unwrap() - 3.2).abs() < 0.01 && (high.unwrap() - 4.8).abs() < 0.01);
    let points = "heat,error_c\n20,2\n20,0\n20,\n20,-1\n";
    let (output, text) = eval(&["--uncertain", "heat=error_c", "--with", "error"], points);
    let rows: Vec<Vec<Option<f64>>> = text.lines().skip(1).map(numbers).collect();
    assert_eq!(rows[0][3..5], [low, high]);
    assert_eq!(rows[1][2..5], [Some(4.0); 3]);
    assert_eq!(rows[2][2..5], [Some(4.0), None, None]);
    assert_eq!(rows[3][2..5], [None; 3]);
    assert!(text.contains("the half-width of `heat` is unknown"));
    assert!(text.contains("column `error_c`: the half-width -1 is negative"));
    assert_eq!(output.status.code(), Some(1));
}

#[test]
fn a_row_reports_that_no_rule_may_fire() {
    let (output, text) = eval(&["--uncertain", "heat=2", "--with", "error"], "heat\n11\n");
    assert!(output.status.success());
    let line = text.lines().nth(1).unwrap();
    assert!(
        line.ends_with(",no rule fires for `alarm` for some values within the half-widths"),
        "{line}"
    );
}

#[test]
fn mistakes_are_explained() {
    for (option, message) in [
        ("cold=2", "there is no input `cold`"),
        (
            "heat=-2",
            "the half-width -2 of `heat` is not a number of at least 0",
        ),
        (
            "heat=error_c",
            "there is no column `error_c` with the half-widths of `heat`",
        ),
        ("heat", "write a name and a value: `NAME=VALUE`"),
    ] {
        let (output, _) = eval(&["--uncertain", option], "heat\n20\n");
        let said = String::from_utf8_lossy(&output.stderr);
        assert!(said.contains(message), "{said}");
        assert_eq!(output.status.code(), Some(2));
    }
}
