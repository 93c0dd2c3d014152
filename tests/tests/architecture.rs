//! Verifies the statements of ARCHITECTURE.md about packages, modules and their dependencies.

use std::{
    collections::{BTreeMap, BTreeSet},
    fs,
    path::{Path, PathBuf},
};

/// The folders of the packages in Rust.
const PACKAGES: [&str; 9] = [
    "fuzzy",
    "flagred",
    "crates/flightlog",
    "crates/interchange",
    "crates/report",
    "crates/tuning",
    "crates/evaluation",
    "crates/authoring",
    "crates/cli",
];

fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("..")
}

/// The source files below a folder, with their paths from the root of the repository.
fn sources(folder: &str) -> Vec<(String, String)> {
    let mut found = Vec::new();
    let mut folders = vec![root().join(folder)];
    while let Some(folder) = folders.pop() {
        for entry in fs::read_dir(folder).unwrap() {
            let path = entry.unwrap().path();
            if path.is_dir() {
                folders.push(path);
            } else if path.extension().is_some_and(|e| e == "rs") {
                let name = path.strip_prefix(root()).unwrap().display().to_string();
                found.push((name, fs::read_to_string(&path).unwrap()));
            }
        }
    }
    found.sort();
    found
}

/// The code compiled into the package, without tests and comments.
fn code(folder: &str) -> Vec<(String, String)> {
    let is_test = |name: &str| name.ends_with("tests.rs") || name.contains("/tests/");
    let files = sources(folder).into_iter().filter(|(n, _)| !is_test(n));
    let code = files.map(|(name, text)| {
        let (text, _) = text
            .split_once("#[cfg(test)]\nmod tests {")
            .unwrap_or((&text, ""));
        let lines = text.lines().filter(|l| !l.trim_start().starts_with("//"));
        (name, lines.collect::<Vec<_>>().join("\n"))
    });
    code.collect()
}

/// The words of a text that can be identifiers.
fn words(text: &str) -> impl Iterator<Item = &str> {
    text.split(|c: char| !c.is_alphanumeric() && c != '_')
}

#[test]
fn every_package_depends_only_on_those_below_it() {
    for (package, below) in [
        ("fuzzy", ""),
        ("crates/flightlog", ""),
        ("crates/interchange", "fuzzy"),
        ("crates/tuning", "fuzzy"),
        ("flagred", "flightlog fuzzy"),
        ("crates/report", "flagred flightlog fuzzy"),
        ("crates/evaluation", "flagred flightlog fuzzy"),
        ("crates/authoring", "flagred flightlog fuzzy interchange"),
        (
            "crates/cli",
            "authoring evaluation flagred flightlog fuzzy interchange report tuning",
        ),
        ("bindings/c", "flagred"),
        (
            "bindings/python",
            "authoring cli evaluation flagred flightlog fuzzy interchange report tuning",
        ),
        (
            "bindings/web",
            "authoring flagred flightlog fuzzy interchange report tuning",
        ),
    ] {
        let manifest = fs::read_to_string(root().join(package).join("Cargo.toml")).unwrap();
        let (_, dependencies) = manifest.split_once("\n[dependencies]\n").unwrap();
        let dependencies = dependencies.split("\n[").next().unwrap();
        let names = dependencies
            .lines()
            .filter_map(|line| line.split(['.', ' ']).next());
        let names = names.map(|name| name.trim_start_matches("flagred-"));
        let is_ours = |name: &&str| {
            PACKAGES
                .iter()
                .any(|p| p.trim_start_matches("crates/") == *name)
        };
        let mut ours: Vec<&str> = names.filter(is_ours).collect();
        ours.sort_unstable();
        assert_eq!(ours.join(" "), below, "{package}");
    }
}

/// The package `flagred` measures neither the ground truth nor how well a risk predicts it: both are unknown on board
/// and in an assessment.
#[test]
fn the_package_flagred_does_not_evaluate_its_own_risks() {
    const SUBJECTS: [&str; 6] = ["attitude", "baseline", "bootstrap", "learn", "roc", "upset"];
    for (name, text) in code("flagred/src") {
        for word in words(&text) {
            assert!(!SUBJECTS.contains(&word), "{name} names `{word}`");
        }
    }
}

/// The top-level modules of the package that a text mentions: `crate::a`, or `crate::{a, b::{..}}`.
fn named(text: &str) -> BTreeSet<&str> {
    let mut found = BTreeSet::new();
    for (at, start) in text.match_indices("crate::") {
        let rest = &text[at + start.len()..];
        let Some(list) = rest.strip_prefix('{') else {
            found.extend(words(rest).next());
            continue;
        };
        let (mut depth, mut is_first) = (0, true);
        for word in list.split_inclusive(['{', '}', ',', ':']) {
            if depth == 0 && is_first {
                found.extend(words(word.trim_start()).next());
            }
            is_first = word.ends_with(',');
            depth += i32::from(word.ends_with('{')) - i32::from(word.ends_with('}'));
            if depth < 0 {
                break;
            }
        }
    }
    found
}

#[test]
fn the_modules_of_a_package_form_no_cycle() {
    for package in PACKAGES {
        let files = code(&format!("{package}/src"));
        let module = |name: &str| {
            let inside = name.strip_prefix(&format!("{package}/src/")).unwrap();
            let first = inside.split('/').next().unwrap();
            first.trim_end_matches(".rs").to_owned()
        };
        let modules: BTreeSet<String> = files.iter().map(|(name, _)| module(name)).collect();
        // Re-exported items count as their modules.
        let mut uses: BTreeMap<String, BTreeSet<String>> = BTreeMap::new();
        for (name, text) in &files {
            let here = module(name);
            let others = named(text).into_iter().map(|name| match name {
                "Engine" => "engine",
                "Model" => "model",
                name => name,
            });
            let others = others.filter(|name| modules.contains(*name) && *name != here);
            let others: Vec<String> = others.map(str::to_owned).collect();
            uses.entry(here).or_default().extend(others);
        }
        // Repeatedly remove the modules that use only removed modules, until no module is left.
        while !uses.is_empty() {
            let left: Vec<String> = uses.keys().cloned().collect();
            uses.retain(|_, used| used.iter().any(|name| left.contains(name)));
            assert!(uses.len() < left.len(), "{package}: a circle in {uses:#?}");
        }
    }
}

#[test]
fn the_engine_does_no_io_and_contains_nothing_about_drones() {
    const SUBJECTS: [&str; 7] = [
        "drone", "copter", "motor", "pwm", "mavlink", "flight", "flagred",
    ];
    // Comments and examples are searched too. Two things are excluded: the names of packages, and the comments of the
    // files in `paper`, whose examples still use the rules of the paper.
    let paper = ["map/", "learn/", "table/", "table.rs", "engine/batch.rs"];
    for (name, text) in sources("fuzzy/src") {
        let is_test = name.ends_with("tests.rs");
        let is_left = |line: &str| {
            let is_comment = line.trim_start().starts_with("//");
            is_comment && paper.iter().any(|part| name.contains(part))
        };
        for line in text.lines().filter(|line| !is_test && !is_left(line)) {
            let line = line
                .replace("flagred-fuzzy", "")
                .replace("crate `flagred`", "");
            for word in words(&line) {
                let lower = word.to_lowercase();
                let knows = SUBJECTS.iter().any(|subject| lower.contains(subject));
                assert!(!knows, "{name} names `{word}`: {line}");
            }
        }
    }
    for (name, text) in code("fuzzy/src") {
        for outside in [
            "std::fs",
            "std::io",
            "std::net",
            "std::env",
            "std::process",
            "std::time",
        ] {
            assert!(!text.contains(outside), "{name} names `{outside}`");
        }
    }
}

#[test]
fn an_evaluation_takes_no_lock_and_writes_no_log() {
    for folder in ["engine", "defuzzify", "model"] {
        for (name, text) in code(&format!("fuzzy/src/{folder}")) {
            for word in words(&text) {
                let waits = ["Mutex", "RwLock", "OnceLock", "RefCell", "log", "tracing"];
                // `libm::log` is a logarithm.
                let is_logarithm = word == "log" && text.contains("libm");
                assert!(
                    !waits.contains(&word) || is_logarithm,
                    "{name} names `{word}`"
                );
            }
        }
    }
}

#[test]
fn one_folder_names_the_yaml_library_and_one_package_the_bytes_of_logs() {
    for package in PACKAGES {
        for (name, text) in code(&format!("{package}/src")) {
            let yaml = text.contains("granit_parser");
            assert!(!yaml || name.starts_with("fuzzy/src/yaml/"), "{name}");
            let bytes = ["from_le_bytes", "from_be_bytes"]
                .iter()
                .any(|f| text.contains(f));
            // The state of a flight in progress is not a log.
            let may = name.starts_with("crates/flightlog/") || name == "flagred/src/state.rs";
            assert!(!bytes || may, "{name}");
        }
    }
}

/// ARCHITECTURE.md does not list modules, because each file describes its content.
#[test]
fn every_file_begins_with_a_description() {
    for (name, text) in PACKAGES
        .iter()
        .flat_map(|package| sources(&format!("{package}/src")))
    {
        let is_test = name.ends_with("tests.rs") || name.contains("/tests/");
        assert!(is_test || text.starts_with("//!"), "{name}");
    }
}

#[test]
fn architecture_md_names_only_files_that_exist() {
    let text = fs::read_to_string(root().join("ARCHITECTURE.md")).unwrap();
    let spans: BTreeSet<&str> = text.split('`').skip(1).step_by(2).collect();
    let known: String = PACKAGES
        .iter()
        .chain(&["tests"])
        .flat_map(|folder| sources(folder))
        .map(|(_, text)| text)
        .collect();
    for span in spans {
        let is_path = span.contains('/') && !span.contains([' ', ':', '<']);
        if is_path
            && PACKAGES
                .iter()
                .chain(&["tests", "scripts", "rules"])
                .any(|p| span.starts_with(p))
        {
            assert!(root().join(span).exists(), "`{span}` is not there");
        }
        let is_test = span.matches('_').count() >= 3 && words(span).count() == 1;
        if is_test {
            assert!(
                known.contains(&format!("fn {span}(")),
                "there is no test `{span}`"
            );
        }
    }
}

/// An invariant without a test or lint is not enforced.
#[test]
fn every_invariant_names_its_tests() {
    let text = fs::read_to_string(root().join("ARCHITECTURE.md")).unwrap();
    let (_, invariants) = text.split_once("\n## Invariants\n").unwrap();
    let invariants: Vec<&str> = invariants.split("\n- **").skip(1).collect();
    assert!(invariants.len() >= 10);
    for invariant in invariants {
        let (_, behind) = invariant
            .split_once("Enforced by")
            .unwrap_or_else(|| panic!("{invariant}"));
        let files = behind.split('`').skip(1).step_by(2);
        let held = files.filter(|file| root().join(file).is_file()).count();
        assert!(held > 0, "{invariant}");
    }
}
