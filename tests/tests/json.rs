//! The JSON output of commands matches the schemas of `flagred schema`, which are derived from the same types.

use std::fmt::Write as _;

use flagred_tests::{
    Folder, STEADY, flagred, schema,
    vehicle::flight,
    watch::fly_udp,
    wire::{Link, Speed},
};
use serde_json::Value;

const PAPER: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/../rules/flagred-paper.yaml");

/// Fails if a document does not match its schema.
fn valid(name: &str, document: &Value) {
    let errors = schema::errors(&schema::schema(name), document);
    assert!(errors.is_empty(), "{name}: {}", errors.join("\n"));
}

fn json(arguments: &[&str]) -> Value {
    let output = flagred().args(arguments).output().unwrap();
    let reported = String::from_utf8_lossy(&output.stderr);
    serde_json::from_slice(&output.stdout).unwrap_or_else(|error| panic!("{error}: {reported}"))
}

/// A minute at 25 Hz with motors at their limits from 30 s on and a wrong attitude from 32 s on.
fn trouble() -> String {
    let mut text = String::from(
        "## pwm_low_us: 1000\n## pwm_high_us: 2000\n\
         t_s,pwm1,pwm2,pwm3,pwm4,roll_des_deg,roll_deg,pitch_des_deg,pitch_deg\n",
    );
    for i in 0..1500 {
        let t_s = f64::from(i) / 25.0;
        let motors = match t_s < 30.0 {
            true => "1500,1500,1500,1500",
            false => "2000,1000,2000,1000",
        };
        let roll_deg = if t_s < 32.0 { 0.1 } else { 20.0 };
        writeln!(text, "{t_s},{motors},0,{roll_deg},0,0").unwrap();
    }
    text
}

/// In every document, a name that its schema does not describe is an error.
#[test]
fn every_object_of_a_schema_is_closed() {
    fn open(schema: &Value, path: &str, found: &mut Vec<String>) {
        if schema.get("properties").is_some() && schema["additionalProperties"] != false {
            found.push(path.to_owned());
        }
        let fields = schema.as_object().into_iter().flatten();
        let items = schema.as_array().into_iter().flatten().enumerate();
        let items = items.map(|(i, item)| (i.to_string(), item));
        for (name, part) in fields.map(|(name, part)| (name.clone(), part)).chain(items) {
            open(part, &format!("{path}/{name}"), found);
        }
    }
    let mut found = Vec::new();
    for name in schema::DOCUMENTS {
        let schema = schema::printed(name);
        assert_eq!(schema["$id"], format!("flagred.{name}/1"));
        open(&schema, name, &mut found);
    }
    assert_eq!(found, Vec::<String>::new());
}

#[test]
fn documents_of_assess_match_their_schema() {
    let folder = Folder::new();
    let trouble = folder.file("trouble.csv", trouble());
    let ground = folder.file("ground.csv", "t_s,motor1,in_air\n0,0.1,0\n1,0.1,0\n");
    let documents = json(&["assess", "--json", STEADY, &trouble, &ground]);
    let verdicts: Vec<&Value> = documents
        .as_array()
        .unwrap()
        .iter()
        .inspect(|document| valid("assess", document))
        .map(|document| &document["verdict"])
        .collect();
    assert_eq!(verdicts, ["GOOD", "FAIL", "NA"]);
    let finding = &documents[1]["findings"][0];
    assert_eq!(finding["severity"], "FAIL");
    assert_eq!(finding["output"], "pwm1");
    assert_eq!(finding["motor"]["number"], 1);
}

#[test]
fn documents_of_evaluate_match_their_schema() {
    let folder = Folder::new();
    let trouble = folder.file("trouble.csv", trouble());
    let document = json(&["validate", "--json", STEADY, &trouble]);
    valid("evaluate", &document);
    assert!(document["estimators"][0]["auc"].is_number());
    assert!(document["records"][1]["critical"].as_u64() > Some(0));
}

#[test]
fn documents_of_learn_match_their_schema() {
    let folder = Folder::new();
    let rows = "margin,spread,risk\n0.1,0.1,50\n0.1,0.1,70\n0.3,0.2,10\n0.3,0.1,5\n";
    let (data, out) = (folder.file("data.csv", rows), folder.at("out.yaml"));
    let arguments = ["learn", PAPER, &data, "--output", &out, "--json", "--force"];
    let document = json(&arguments);
    valid("learn", &document);
    assert_eq!(document["gap_methods"], Value::Null);
    let document = json(&[&arguments[..], &["--compare-gaps"]].concat());
    valid("learn", &document);
    assert_eq!(document["rows"]["used"], 4);
    assert!(document["gap_methods"]["methods"][0]["method"].is_string());
    assert!(document["cross_validation"]["rmse"].is_number());
    let checked = json(&["check", "--json", &out]);
    valid("check", &checked);
    assert_eq!(checked["provenance"][0]["rows"], 4);
}

#[test]
fn documents_of_identify_match_their_schema() {
    let folder = Folder::new();
    let row = |i: i32| format!("{},{},car {i},{}\n", i % 7, i % 5, i % 7 * (i % 5));
    let rows: String = (0..70).map(row).collect();
    let data = folder.file("data.csv", format!("width,length,name,area\n{rows}"));
    let out = folder.at("out.yaml");
    let arguments = [
        "identify", &data, "--target", "area", "--output", &out, "--json", "--force",
    ];
    let document = json(&arguments);
    valid("identify", &document);
    assert_eq!(document["columns"]["without_numbers"][0], "name");
    assert_eq!(document["columns"]["used"].as_array().unwrap().len(), 2);
    assert!(document["validation"]["ratio"]["high"].as_f64().unwrap() < 0.5);
    let document = json(
        &[
            &arguments[..],
            &["--no-validation", "--clusters", "--lines"],
        ]
        .concat(),
    );
    valid("identify", &document);
    assert!(document["validation"].is_null() && document["steps"][0]["terms"].is_u64());
}

#[test]
fn documents_of_tune_match_their_schema() {
    let folder = Folder::new();
    let rows = "margin,spread,risk\n0.1,0.1,50\n0.1,0.1,70\n0.3,0.2,10\n0.3,0.1,5\n";
    let (data, out) = (folder.file("data.csv", rows), folder.at("out.yaml"));
    let arguments = ["tune", PAPER, &data, "--output", &out, "--json", "--force"];
    let document = json(&arguments);
    valid("tune", &document);
    assert!(document["validation"]["gain"]["low"].is_number());
    assert!(document["moved"][0]["after"].is_number());
    let document = json(&[&arguments[..], &["--no-validation"]].concat());
    valid("tune", &document);
    assert_eq!(document["rows"]["used"], 4);
    let rows =
        "margin,spread,risk\n0.1,0.1,1\n0.1,0.1,0\n0.3,0.2,0\n0.3,0.1,1\n0.2,0.1,1\n0.2,0.2,0\n";
    let data = folder.file("classes.csv", rows);
    let arguments = [
        "tune", PAPER, &data, "--output", &out, "--json", "--force", "--loss", "log",
    ];
    let document = json(&[&arguments[..], &["--learning-curve"]].concat());
    valid("tune", &document);
    assert_eq!(document["learning_curve"].as_array().unwrap().len(), 4);
    let bins = document["validation"]["reliability"].as_array().unwrap();
    let counted: u64 = bins.iter().map(|bin| bin["rows"].as_u64().unwrap()).sum();
    assert_eq!(counted, 6);
}

#[test]
fn documents_of_simplify_match_their_schema() {
    let folder = Folder::new();
    let out = folder.at("out.yaml");
    let arguments = ["simplify", PAPER, "--output", &out, "--json", "--force"];
    let document = json(&arguments);
    valid("simplify", &document);
    assert!(document["rules"]["after"].as_u64() < document["rules"]["before"].as_u64());
    assert_eq!(document["tolerance"], Value::Null);
    let document = json(&[&arguments[..], &["--tolerance", "20"]].concat());
    valid("simplify", &document);
    assert!(document["difference"]["size"].as_f64() > Some(0.1));
}

#[test]
fn documents_of_inspect_match_their_schema() {
    let folder = Folder::new();
    let ground = folder.file(
        "ground.csv",
        "# kind: idle\nt_s,motor1,in_air\n0,0.1,0\n1,0.1,0\n",
    );
    for log in [STEADY, &ground] {
        valid("inspect", &json(&["inspect", "--json", log]));
    }
}

#[test]
fn documents_of_explain_and_check_match_their_schema() {
    valid(
        "explain",
        &json(&["explain", "--json", PAPER, "margin=0.1", "spread=0.05"]),
    );
    valid("check", &json(&["check", "--json", PAPER]));
    let folder = Folder::new();
    let broken = folder.file("broken.yaml", "fuzzy: 1\nname: x\nrules: [nonsense]\n");
    let document = json(&["check", "--json", &broken]);
    valid("check", &document);
    assert_eq!(document["model"], Value::Null);
}

/// Verifies the parts of the SARIF 2.1.0 schema that a reader of findings needs.
#[test]
fn check_as_sarif() {
    let folder = Folder::new();
    let broken = folder.file(
        "br oken.yaml",
        "fuzzy: 1\nname: x\nname: y\nrules: [nonsense]\n",
    );
    let output = flagred()
        .args(["check", "--format", "sarif", PAPER, &broken])
        .output()
        .unwrap();
    assert_eq!(output.status.code(), Some(1));
    let document: Value = serde_json::from_slice(&output.stdout).unwrap();
    let text = serde_json::json!({"type": "object", "properties": {"text": {"type": "string"}}, "required": ["text"]});
    let number = serde_json::json!({"type": "integer", "minimum": 1});
    let place = serde_json::json!({
        "type": "object",
        "properties": {
            "artifactLocation": {"type": "object", "properties": {"uri": {"type": "string"}}, "required": ["uri"], "additionalProperties": false},
            "region": {
                "type": "object",
                "properties": {"startLine": number, "startColumn": number, "endLine": number, "endColumn": number},
                "required": ["startLine"],
                "additionalProperties": false,
            },
        },
        "required": ["artifactLocation", "region"],
        "additionalProperties": false,
    });
    let location = serde_json::json!({
        "type": "object",
        "properties": {"physicalLocation": place, "message": text},
        "required": ["physicalLocation"],
        "additionalProperties": false,
    });
    let result = serde_json::json!({
        "type": "object",
        "properties": {
            "ruleId": {"type": "string"},
            "level": {"enum": ["none", "note", "warning", "error"]},
            "message": text,
            "locations": {"type": "array", "items": location},
            "relatedLocations": {"type": "array", "items": location},
        },
        "required": ["message"],
        "additionalProperties": false,
    });
    let schema = serde_json::json!({
        "type": "object",
        "properties": {
            "$schema": {"type": "string"},
            "version": {"const": "2.1.0"},
            "runs": {"type": "array", "items": {
                "type": "object",
                "properties": {
                    "tool": {"type": "object", "properties": {"driver": {
                        "type": "object",
                        "properties": {
                            "name": {"type": "string"},
                            "version": {"type": "string"},
                            "rules": {"type": "array", "items": {"type": "object", "properties": {"id": {"type": "string"}}, "required": ["id"]}},
                        },
                        "required": ["name"],
                        "additionalProperties": false,
                    }}, "required": ["driver"], "additionalProperties": false},
                    "columnKind": {"enum": ["utf16CodeUnits", "unicodeCodePoints"]},
                    "results": {"type": "array", "items": result},
                },
                "required": ["tool"],
                "additionalProperties": false,
            }},
        },
        "required": ["version", "runs"],
        "additionalProperties": false,
    });
    let errors = schema::errors(&schema, &document);
    assert!(errors.is_empty(), "{}", errors.join("\n"));

    let run = &document["runs"][0];
    let results = run["results"].as_array().unwrap();
    let rules: Vec<&Value> = run["tool"]["driver"]["rules"]
        .as_array()
        .unwrap()
        .iter()
        .map(|r| &r["id"])
        .collect();
    assert!(
        results
            .iter()
            .all(|result| rules.contains(&&result["ruleId"]))
    );
    let has = |level: &str| results.iter().filter(|r| r["level"] == level).count();
    assert!(has("error") > 0 && has("warning") > 0);
    let twice = results
        .iter()
        .find(|r| r["ruleId"] == "duplicate-key")
        .unwrap();
    let place = &twice["locations"][0]["physicalLocation"];
    assert!(
        place["artifactLocation"]["uri"]
            .as_str()
            .unwrap()
            .ends_with("br%20oken.yaml")
    );
    assert_eq!(place["region"]["startLine"], 3);
    assert_eq!(
        twice["relatedLocations"][0]["physicalLocation"]["region"]["startLine"],
        2
    );

    // With `--format github`, there are as many lines as results.
    let output = flagred()
        .args(["check", "--format", "github", PAPER, &broken])
        .output()
        .unwrap();
    assert_eq!(output.status.code(), Some(1));
    let text = String::from_utf8(output.stdout).unwrap();
    assert_eq!(text.lines().count(), results.len());
    assert!(text.lines().all(|line| line.starts_with("::")), "{text}");
}

#[test]
fn documents_of_watch_match_their_schema() {
    let folder = Folder::new();
    let flight = flight(folder.file("trouble.csv", trouble()).as_ref());
    let (said, _) = fly_udp(&flight, Link::default(), &[], Speed::Fastest);
    for kind in [
        "started",
        "found",
        "ready",
        "took_off",
        "risk",
        "level",
        "finding",
        "left_in_air",
        "ended",
    ] {
        assert!(said.all(kind).next().is_some(), "no `{kind}`");
    }
    let schema = schema::schema("watch");
    for line in &said.events {
        assert_eq!(schema::errors(&schema, line), Vec::<String>::new());
    }
    assert_eq!(said.one("ended")["worst"], "FAIL");
}
