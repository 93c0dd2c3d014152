//! The types of documents in the bindings agree with the schemas.
//!
//! `UPDATE_DOCUMENTS=1 cargo test --workspace --test bindings` writes the types of the npm package. The records of
//! Python are written by hand, since they have methods and their own docstrings.

use std::{collections::BTreeMap, env, fs, path::PathBuf};

use flagred_tests::{schema, typescript};
use serde_json::Value;

const HEAD: &str = "// Written by `UPDATE_DOCUMENTS=1 cargo test --workspace --test bindings` from the types in Rust.\n\n";

fn file(path: &str) -> PathBuf {
    PathBuf::from(env!("CARGO_MANIFEST_DIR"))
        .join("..")
        .join(path)
}

#[test]
fn the_npm_package_has_the_types_of_the_documents() {
    let path = file("bindings/web/js/documents.ts");
    let expected = HEAD.to_owned() + &typescript::declarations(&flagred_cli::npm_types());
    if env::var_os("UPDATE_DOCUMENTS").is_some() {
        fs::write(path, expected).unwrap();
        return;
    }
    assert!(
        fs::read_to_string(path).unwrap() == expected,
        "bindings/web/js/documents.ts: run UPDATE_DOCUMENTS=1 cargo test --workspace --test bindings"
    );
}

/// A record in Python, and the type of a document to which it corresponds.
const RECORDS: [(&str, &str, &str, &str); 34] = [
    ("_data.py", "Range", "assess", "Range"),
    ("_data.py", "Vehicle", "inspect", "Vehicle"),
    ("_data.py", "Motor", "assess", "Motor"),
    ("_data.py", "Geometry", "inspect", "Geometry"),
    ("_data.py", "Parameter", "assess", "Parameter"),
    ("_data.py", "Event", "inspect", "Event"),
    ("_data.py", "Interval", "inspect", "Interval"),
    ("_data.py", "Intervals", "inspect", "Intervals"),
    ("_data.py", "LeftOutCounts", "assess", "LeftOutCounts"),
    ("_data.py", "Report", "assess", "Report"),
    ("_data.py", "Gap", "inspect", "Gap"),
    ("_data.py", "MotorFinding", "assess", "MotorFinding"),
    ("_data.py", "Cause", "assess", "Cause"),
    ("_data.py", "Finding", "assess", "FlightFinding"),
    ("_data.py", "Peak", "assess", "Peak"),
    ("_data.py", "Summary", "assess", "Summary"),
    ("evaluation.py", "Band", "evaluate", "BandDocument"),
    ("evaluation.py", "Areas", "evaluate", "ScoresDocument"),
    ("evaluation.py", "Warnings", "evaluate", "ProfileWarnings"),
    (
        "evaluation.py",
        "NeedlessAlarms",
        "evaluate",
        "NeedlessAlarmsDocument",
    ),
    ("evaluation.py", "Upsets", "evaluate", "UpsetsDocument"),
    ("evaluation.py", "Alarms", "evaluate", "AlarmsDocument"),
    ("evaluation.py", "Span", "evaluate", "Span"),
    ("evaluation.py", "Episode", "evaluate", "EpisodeDocument"),
    (
        "evaluation.py",
        "WarningTime",
        "evaluate",
        "WarningDocument",
    ),
    (
        "evaluation.py",
        "ProfileResult",
        "evaluate",
        "ProfileResultDocument",
    ),
    (
        "evaluation.py",
        "EvaluatedFlight",
        "evaluate",
        "RecordDocument",
    ),
    ("evaluation.py", "LeftOutFile", "evaluate", "LeftOutFile"),
    (
        "_learning.py",
        "ChangedNumber",
        "tune",
        "ChangedNumberDocument",
    ),
    ("_learning.py", "Figure", "tune", "Interval"),
    (
        "_identify.py",
        "IdentifyStep",
        "identify",
        "IdentifyStepDocument",
    ),
    ("_core.pyi", "ExplainedInput", "explain", "ExplainedInput"),
    ("_core.pyi", "FiredRule", "explain", "FiredRule"),
    ("_core.pyi", "Share", "explain", "Share"),
];

/// The fields of a class, each with whether it may be None. In a stub of a native class, they are properties.
fn fields(text: &str, is_stub: bool, class: &str) -> BTreeMap<String, bool> {
    let mut lines = text.lines();
    let head = format!("class {class}");
    lines
        .find(|line| {
            line.strip_prefix(&head)
                .is_some_and(|rest| rest.starts_with([':', '(']))
        })
        .unwrap_or_else(|| panic!("no class {class}"));
    let body = lines.take_while(|line| line.is_empty() || line.starts_with(' '));
    let field = |line: &str| {
        let line = line
            .strip_prefix("    ")
            .filter(|line| !line.starts_with(' '))?;
        let (name, kind) = match line.strip_prefix("def ") {
            Some(property) if is_stub => property.split_once("(self) -> ")?,
            Some(_) => return None,
            None => line.split_once(": ")?,
        };
        let is_name = name.chars().all(|c| c.is_ascii_alphanumeric() || c == '_');
        let is_field = is_name && !name.starts_with('_');
        is_field.then(|| (name.to_owned(), kind.contains("None")))
    };
    body.filter_map(field).collect()
}

/// The properties of a type, each with whether it may be null or missing.
fn properties(schema: &Value, name: &str) -> BTreeMap<String, bool> {
    let of = &schema["$defs"][name];
    let required = of["required"].as_array().unwrap();
    let properties = of["properties"].as_object().unwrap().iter();
    let may_be_null = |part: &Value| part["type"] == "null";
    let property = |(name, part): (&String, &Value)| {
        let types = part["type"].as_array();
        let is_null = types.is_some_and(|types| types.iter().any(|one| one == "null"))
            || part["anyOf"]
                .as_array()
                .is_some_and(|all| all.iter().any(may_be_null));
        let is_left_out = !required.iter().any(|one| one == name);
        (name.clone(), is_null || is_left_out)
    };
    properties.map(property).collect()
}

#[test]
fn the_records_of_python_have_the_fields_of_the_documents() {
    let mut schemas: BTreeMap<&str, Value> = BTreeMap::new();
    for (path, class, document, name) in RECORDS {
        let is_stub = path.ends_with(".pyi");
        let path = file(&format!("bindings/python/python/flagred/{path}"));
        let text = fs::read_to_string(path).unwrap();
        let schema = schemas
            .entry(document)
            .or_insert_with(|| schema::printed(document));
        let mut expected = properties(schema, name);
        match class {
            // In Python, this field is called `is_false`.
            "WarningTime" => {
                let is_false = expected.remove("false").unwrap();
                expected.insert("is_false".to_owned(), is_false);
            }
            // The warnings by kind are a field of the estimator.
            "Warnings" => assert!(expected.remove("by_kind").is_some()),
            _ => {}
        }
        assert_eq!(fields(&text, is_stub, class), expected, "{class} of Python");
    }
}
