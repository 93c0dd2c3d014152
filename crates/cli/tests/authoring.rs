//! Correct and wrong rule sets: every file of `tests/authoring` is a case, and its findings are a snapshot next to it.
//! To add a case, add a file; `INSTA_UPDATE=always cargo test -p flagred-cli --test authoring` writes its snapshot.
#![allow(clippy::unwrap_used, clippy::panic)]

use std::{
    fs,
    path::{Path, PathBuf},
    process::Command,
};

fn folder(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR"))
        .join("../../tests/authoring")
        .join(name)
}

fn cases(name: &str) -> Vec<(String, PathBuf)> {
    let mut cases: Vec<_> = fs::read_dir(folder(name))
        .unwrap()
        .map(|entry| entry.unwrap().path())
        .filter(|path| {
            path.extension()
                .is_some_and(|extension| extension == "yaml")
        })
        .map(|path| {
            (
                path.file_stem().unwrap().to_string_lossy().into_owned(),
                path,
            )
        })
        .collect();
    cases.sort();
    cases
}

/// Settings that put the snapshot next to the case, under its name.
fn snapshots_in(name: &str) -> insta::Settings {
    let mut settings = insta::Settings::clone_current();
    settings.set_snapshot_path(folder(name));
    settings.set_prepend_module_to_snapshot(false);
    settings.set_omit_expression(true);
    settings
}

#[test]
fn every_invalid_file_has_messages_with_positions_and_help() {
    let cases = cases("err");
    assert!(cases.len() >= 60);
    let mut poor = Vec::new();
    for (name, path) in cases {
        let run = Command::new(env!("CARGO_BIN_EXE_flagred"))
            .current_dir(folder("err"))
            .args(["check", &format!("{name}.yaml")])
            .output()
            .unwrap();
        assert_eq!(run.status.code(), Some(1), "{name}");
        assert!(run.stderr.is_empty(), "{name}");
        let drawn = String::from_utf8(run.stdout).unwrap();
        snapshots_in("err").bind(|| insta::assert_snapshot!(name.as_str(), drawn));

        let text = fs::read_to_string(path).unwrap();
        let findings = match fuzzy::yaml::parse(&text) {
            Err(findings) => findings,
            // A rule set without rules can be parsed, for learning, but is an error in `check`.
            Ok(document) if document.model.rules.is_empty() => document.warnings,
            Ok(_) => panic!("{name} reads well"),
        };
        for finding in &findings.0 {
            let message = &finding.message;
            let opening = message.trim_start_matches('`').chars().next().unwrap();
            if finding.help.is_none()
                || finding.position.is_none()
                || text.get(finding.span.clone()).is_none()
                || message.ends_with('.')
                || (opening.is_ascii_uppercase() && !message.starts_with('`'))
            {
                poor.push(format!("{name}: {finding}"));
            }
        }
    }
    assert!(
        poor.is_empty(),
        "without help or place, or not in style:\n{}",
        poor.join("\n")
    );
}

#[test]
fn every_valid_file_has_the_expected_tree() {
    for (name, path) in cases("ok") {
        let text = fs::read_to_string(path).unwrap();
        let document = fuzzy::yaml::parse(&text).unwrap_or_else(|f| panic!("{name}:\n{f}"));
        let tree = format!("{:#?}", document.model);
        snapshots_in("ok").bind(|| insta::assert_snapshot!(name.as_str(), tree));
        let saved = fuzzy::yaml::to_string(&document.model);
        let again = fuzzy::yaml::parse(&saved).unwrap_or_else(|f| panic!("{name}:\n{saved}\n{f}"));
        assert_eq!(again.model, document.model, "{name}:\n{saved}");
        fuzzy::Engine::new(&document.model).unwrap_or_else(|e| panic!("{name}: {e}"));
    }
}

#[test]
fn every_code_is_documented_and_the_documented_examples_load() {
    let docs = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../docs/rule-sets.md");
    let docs = fs::read_to_string(docs).unwrap();
    for (name, path) in cases("err") {
        let findings = fuzzy::yaml::parse(&fs::read_to_string(path).unwrap());
        for finding in findings.map(drop).err().map(|f| f.0).unwrap_or_default() {
            let code = finding.code;
            assert!(
                docs.contains(&format!("`{code}`")),
                "{name}: {code} stands in no docs"
            );
        }
    }
    let examples = docs
        .split("```yaml\n")
        .skip(1)
        .filter_map(|rest| rest.split("```").next());
    let whole: Vec<&str> = examples.filter(|text| text.starts_with("fuzzy:")).collect();
    assert!(!whole.is_empty());
    for text in whole {
        fuzzy::yaml::parse(text).unwrap_or_else(|f| panic!("{text}\n{f}"));
    }
}
