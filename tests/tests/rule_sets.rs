//! The shipped rule sets: every one loads, compiles, and reads back the same after it is written.
#![allow(clippy::unwrap_used, clippy::panic)]

use std::{fs, path::Path};

fn shipped() -> Vec<(String, String)> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../rules");
    let mut found: Vec<_> = fs::read_dir(folder)
        .unwrap()
        .map(|entry| entry.unwrap().path())
        .filter(|path| path.extension().is_some_and(|e| e == "yaml"))
        .map(|path| {
            (
                path.display().to_string(),
                fs::read_to_string(&path).unwrap(),
            )
        })
        .collect();
    found.sort();
    assert!(found.len() >= 2);
    found
}

#[test]
fn every_rule_set_loads_without_a_finding_and_compiles() {
    for (path, text) in shipped() {
        let document = fuzzy::yaml::parse(&text).unwrap_or_else(|f| panic!("{path}:\n{f}"));
        assert!(
            document.warnings.0.is_empty(),
            "{path}:\n{}",
            document.warnings
        );
        fuzzy::Engine::new(&document.model).unwrap_or_else(|e| panic!("{path}: {e}"));
    }
}

#[test]
fn load_save_load_is_the_identity() {
    for (path, text) in shipped() {
        let model = fuzzy::yaml::parse(&text).unwrap().model;
        let saved = fuzzy::yaml::to_string(&model);
        let again = fuzzy::yaml::parse(&saved).unwrap_or_else(|f| panic!("{path}:\n{saved}\n{f}"));
        assert_eq!(again.model, model, "{path}");
        let json = serde_json::to_string(&model).unwrap();
        assert_eq!(
            serde_json::from_str::<fuzzy::Model>(&json).unwrap(),
            model,
            "{path}"
        );
    }
}
