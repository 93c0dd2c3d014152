//! Rule sets of other programs on the command line.
#![allow(clippy::unwrap_used, clippy::panic)]

use std::{
    path::PathBuf,
    process::{Command, Output},
};

fn flagred(arguments: &[&str]) -> Output {
    let root = concat!(env!("CARGO_MANIFEST_DIR"), "/../..");
    let mut command = Command::new(env!("CARGO_BIN_EXE_flagred"));
    command.current_dir(root).args(arguments).output().unwrap()
}

fn text(bytes: &[u8]) -> &str {
    std::str::from_utf8(bytes).unwrap()
}

/// Exports the rule set `tipper` in the format with this file extension, and returns the path of the file.
fn tipper(folder: &tempfile::TempDir, ending: &str) -> PathBuf {
    let file = folder.path().join(format!("tipper.{ending}"));
    let option = format!("--{ending}");
    let output = flagred(&[
        "export",
        &option,
        "rules/tipper.yaml",
        "--output",
        file.to_str().unwrap(),
    ]);
    assert_eq!(output.status.code(), Some(0), "{}", text(&output.stderr));
    file
}

#[test]
fn commands_accept_files_of_other_programs() {
    let folder = tempfile::tempdir().unwrap();
    let point = ["service=8", "food=9"];
    let value = |file: &str| {
        let output = flagred(&["explain", "--json", file, point[0], point[1]]);
        assert_eq!(output.status.code(), Some(0), "{}", text(&output.stderr));
        let document: serde_json::Value = serde_json::from_slice(&output.stdout).unwrap();
        document["outputs"][0]["value"].as_f64().unwrap()
    };
    let expected = value("rules/tipper.yaml");
    for ending in ["fis", "fll", "fcl", "fml"] {
        let file = tipper(&folder, ending);
        let file = file.to_str().unwrap();
        // fuzzylite integrates numerically.
        let tolerance = if ending == "fll" { 1e-3 } else { 1e-9 };
        assert!(
            (value(file) - expected).abs() < tolerance,
            "{ending}: {}",
            value(file)
        );
        let imported = flagred(&["import", file]);
        assert_eq!(
            imported.status.code(),
            Some(0),
            "{}",
            text(&imported.stderr)
        );
        let model: fuzzy::Model = text(&imported.stdout)
            .parse()
            .unwrap_or_else(|f| panic!("{f}"));
        assert_eq!(model.rules.len(), 3, "{ending}");
    }
}

#[test]
fn features_that_a_format_lacks_are_refused_or_reported() {
    let refused = flagred(&["export", "--fis", "tests/onboard/blocks.yaml"]);
    assert_eq!(refused.status.code(), Some(3));
    assert!(refused.stdout.is_empty());
    let reported = text(&refused.stderr);
    // `--lossy` is advised only where it works.
    assert!(
        reported.contains("error[blocks]: the rules are in blocks")
            && !reported.contains("`--lossy`"),
        "{reported}"
    );
    let refused = flagred(&["export", "--fcl", "tests/onboard/blocks.yaml"]);
    assert!(text(&refused.stderr).contains("\n  help: `--lossy`"));
    // In a FIS an output has either numbers or fuzzy sets as terms, but this rule set uses both.
    let refused = flagred(&["export", "--fis", "--lossy", "tests/onboard/blocks.yaml"]);
    assert_eq!(refused.status.code(), Some(3));
    assert!(text(&refused.stderr).contains("error[two-defuzzifiers]"));
    let lossy = flagred(&["export", "--fcl", "--lossy", "tests/onboard/blocks.yaml"]);
    assert_eq!(lossy.status.code(), Some(0));
    assert!(text(&lossy.stdout).contains("FUNCTION_BLOCK blocks"));
    assert!(text(&lossy.stderr).contains("warning[activation]"));
}

#[test]
fn files_of_the_wrong_format_are_reported() {
    let output = flagred(&["import", "rules/tipper.yaml"]);
    assert_eq!(output.status.code(), Some(3));
    assert!(
        text(&output.stderr).contains("`rules/tipper.yaml` is not a FIS, FLL, FCL or FML file")
    );
}

#[test]
fn one_of_several_function_blocks_is_imported_by_its_name() {
    let folder = tempfile::tempdir().unwrap();
    let one = std::fs::read_to_string(tipper(&folder, "fcl")).unwrap();
    let file = folder.path().join("two.fcl");
    let other = one.replace("FUNCTION_BLOCK tipper", "FUNCTION_BLOCK other");
    std::fs::write(&file, one + &other).unwrap();
    let file = file.to_str().unwrap();
    let refused = flagred(&["check", file]);
    let reported = text(&refused.stdout);
    assert_eq!(refused.status.code(), Some(1), "{reported}");
    assert!(
        reported.contains("the file has the function blocks `tipper`, `other`")
            && reported.contains("help: `flagred import --block NAME` writes one"),
        "{reported}"
    );
    let imported = flagred(&["import", file, "--block", "other"]);
    let reported = text(&imported.stdout);
    assert!(
        reported.contains("\nname: other\n") && reported.ends_with("generous\n"),
        "{reported}"
    );
    let fis = tipper(&folder, "fis");
    let refused = flagred(&["import", fis.to_str().unwrap(), "--block", "other"]);
    assert_eq!(refused.status.code(), Some(2));
    assert!(text(&refused.stderr).contains("`--block` is for FCL"));
}
