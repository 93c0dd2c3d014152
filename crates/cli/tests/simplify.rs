//! `flagred simplify` with files.
#![allow(clippy::unwrap_used)]

mod common;

use common::{flagred, folder};

const FAN: &str = "# A fan for the attic.
fuzzy: 1
name: fan
inputs:
  heat: {range: [0, 40], partition: [cool, warm, hot]}
  humidity: {range: [0, 100], partition: [dry, wet]}
outputs:
  speed: {range: [0, 10], terms: {slow: {singleton: 2}, slower: {singleton: 1}, fast: {singleton: 8}}}
operators: {and: product, implication: product, aggregation: sum}
rules:
  - {rule: IF heat IS cool AND humidity IS dry THEN speed IS slower, note: it is quiet}
  - IF heat IS cool AND humidity IS wet THEN speed IS slow
  - IF heat IS warm THEN speed IS fast
  - IF heat IS hot THEN speed IS fast
  - IF heat IS hot AND heat IS cool THEN speed IS slow
";

fn simplify(more: &[&str]) -> (Option<i32>, String, String, Option<String>) {
    let rows = "heat,humidity\n2,80\n3,90\n20,90\n38,95\n";
    let folder = folder(&[("fan.yaml", FAN), ("rows.csv", rows)]);
    let arguments = ["simplify", "fan.yaml", "-o", "out.yaml"];
    let (code, out, err) = flagred(folder.path(), &[&arguments[..], more].concat());
    let written = std::fs::read_to_string(folder.path().join("out.yaml")).ok();
    (code, out, err, written)
}

#[test]
fn changes_to_rules_are_printed_and_written() {
    let (code, out, err, written) = simplify(&[]);
    assert_eq!((code, err.as_str()), (Some(0), ""));
    insta::assert_snapshot!(out);
    let written = written.unwrap();
    assert!(
        written.starts_with("# A fan for the attic.\nfuzzy: 1\n"),
        "{written}"
    );
    insta::assert_snapshot!(written.split_once("provenance:").unwrap().1);
    assert!(written.contains("note: it is quiet"), "{written}");
}

#[test]
fn the_author_sets_the_tolerance() {
    let (code, out, _, written) = simplify(&["--tolerance", "1"]);
    assert_eq!(code, Some(0));
    insta::assert_snapshot!(out);
    assert!(!written.unwrap().contains("humidity"));
}

#[test]
fn rows_can_extend_or_replace_the_points() {
    let (_, out, _, _) = simplify(&["rows.csv"]);
    assert!(out.contains(" points, 4 of them rows;"), "{out}");
    let (_, out, _, written) = simplify(&["rows.csv", "--rows-only", "--tolerance", "0.2"]);
    assert!(out.contains(" at 4 rows; allowed is 0.2\n"), "{out}");
    assert!(!written.unwrap().contains("humidity"));
}

#[test]
fn wrong_usage_writes_nothing() {
    for wrong in [&["--rows-only"][..], &["--tolerance", "-1"]] {
        let (code, _, err, written) = simplify(wrong);
        assert_eq!((code, written), (Some(2), None), "{err}");
    }
    let (code, _, err, written) = simplify(&["rows.csv", "--column", "heat=hat"]);
    assert_eq!((code, written), (Some(3), None), "{err}");
}
