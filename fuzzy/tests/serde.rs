//! Tests of a rule set inside the configuration of another program, which is read by the serde crate of the YAML
//! organisation, and a comparison of that crate with the YAML parser of this package.
#![allow(clippy::unwrap_used, reason = "a test")]

use std::{
    collections::BTreeMap,
    fs,
    path::{Path, PathBuf},
};

use fuzzy::{Engine, Model, yaml};
use serde::{Deserialize, Serialize};

/// An example configuration of a program that uses the engine.
#[derive(Debug, PartialEq, Serialize, Deserialize)]
struct Config {
    listen: String,
    every_s: u32,
    rules: Model,
    more: BTreeMap<String, Model>,
}

const CONFIG: &str = "
listen: localhost:80
every_s: 5
rules:
  fuzzy: 1
  name: fan
  inputs: {heat: {range: [0, 40], unit: °C, partition: [low, high]}}
  outputs: {speed: {range: [0, 9], partition: [slow, fast], when_no_rule_fires: {value: 0}}}
  rules:
    - IF heat IS low THEN speed IS slow
    - {rule: IF heat IS very high THEN speed IS fast WITH 0.5, note: 'it''s hot'}
more: {}
";

#[test]
fn a_model_is_part_of_another_configuration() {
    let config: Config = serde_yaml::from_str(CONFIG).unwrap();
    let engine = Engine::new(&config.rules).unwrap();
    assert!(engine.evaluate(&[40.0]).unwrap()[0].value() > Some(4.5));
    assert_eq!(config.rules.rules[1].note.as_deref(), Some("it's hot"));

    let written = serde_yaml::to_string(&config).unwrap();
    assert_eq!(serde_yaml::from_str::<Config>(&written).unwrap(), config);
    let json = serde_json::to_string(&config).unwrap();
    assert_eq!(serde_json::from_str::<Config>(&json).unwrap(), config);
}

#[test]
fn a_mistake_inside_a_configuration_is_explained() {
    let wrong = CONFIG.replace("IS very high", "IS very hihg");
    let error = serde_yaml::from_str::<Config>(&wrong)
        .unwrap_err()
        .to_string();
    assert!(error.contains("input `heat` has no term `hihg`"), "{error}");
    assert!(error.contains("did you mean `high`?"), "{error}");
}

#[test]
fn outcomes_and_explanations_are_serialised() {
    let config: Config = serde_yaml::from_str(CONFIG).unwrap();
    let engine = Engine::new(&config.rules).unwrap();
    let outcomes = engine.evaluate_named([("heat", 40.0)]).unwrap();
    let outcomes = serde_json::to_value(&outcomes).unwrap();
    assert_eq!(outcomes["speed"]["state"], "defined");
    assert_eq!(outcomes["speed"]["dominant_rule"], 2, "rules count from 1");
    assert_eq!(outcomes["speed"]["clamped"], false);
    let explanation = serde_json::to_value(engine.explain(&[40.0]).unwrap()).unwrap();
    assert_eq!(explanation["rules"][0]["rule"], 2);
    assert_eq!(explanation["outputs"][0]["rules"][0]["term"], "fast");
    let findings = "fuzzy: 2".parse::<Model>().unwrap_err();
    let findings = serde_json::to_value(&findings).unwrap();
    assert_eq!(findings[0]["code"], "unsupported-version");
    assert_eq!(findings[0]["position"]["line"], 1);
}

#[test]
fn structs_and_maps_serve_as_inputs() {
    #[derive(Serialize)]
    struct Reading {
        heat: Option<f32>,
    }
    let config: Config = serde_yaml::from_str(CONFIG).unwrap();
    let engine = Engine::new(&config.rules).unwrap();
    let by_name = engine.evaluate_named([("heat", 30.0)]).unwrap();
    let heat = Some(30.0);
    assert_eq!(engine.evaluate_struct(&Reading { heat }).unwrap(), by_name);
    let map = BTreeMap::from([("heat", 30)]);
    assert_eq!(engine.evaluate_struct(&map).unwrap(), by_name);
    let message = |error: fuzzy::engine::EvaluateError| error.to_string();
    let of = |value: serde_json::Value| engine.evaluate_struct(&value).map_err(message);
    assert_eq!(of(serde_json::json!({"heat": 30})).unwrap(), by_name);
    let refused = |value| of(value).unwrap_err();
    assert_eq!(
        refused(serde_json::json!([30])),
        "expected a struct or map of numbers"
    );
    assert_eq!(
        refused(serde_json::json!({"heat": "30"})),
        "input `heat`: expected a number"
    );
    assert_eq!(
        refused(serde_json::json!({"heat": null})),
        "input `heat` has no value"
    );
    assert_eq!(
        refused(serde_json::json!({"cold": 1})),
        "there is no input `cold`"
    );
    let heat = None;
    assert!(engine.evaluate_struct(&Reading { heat }).is_err());
    let twice = engine.evaluate_named([("heat", 1.0), ("heat", 1.0)]);
    assert_eq!(
        twice.map_err(message).unwrap_err(),
        "input `heat` has two values"
    );
}

/// Returns the YAML files below a folder of the repository.
fn files(folder: &str) -> Vec<PathBuf> {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"))
        .join("..")
        .join(folder);
    let mut found = Vec::new();
    let mut folders = vec![root];
    while let Some(folder) = folders.pop() {
        for entry in fs::read_dir(folder).unwrap() {
            let path = entry.unwrap().path();
            if path.is_dir() {
                folders.push(path);
            } else if path.extension().is_some_and(|e| e == "yaml") {
                found.push(path);
            }
        }
    }
    found
}

#[test]
fn both_parsers_read_every_rule_set_alike() {
    let (mut same, mut refused) = (0, 0);
    for path in [files("rules"), files("tests")].concat() {
        let name = path.file_name().unwrap().to_string_lossy().into_owned();
        let text = fs::read_to_string(&path).unwrap();
        let both = (text.parse::<Model>(), serde_yaml::from_str::<Model>(&text));
        match both {
            (Ok(ours), Ok(theirs)) => {
                assert_eq!(ours, theirs, "{name}");
                same += 1;
            }
            (Err(_), Err(_)) => refused += 1,
            (Ok(_), Err(error)) => panic!("{name}: only we read it: {error}"),
            (Err(findings), Ok(_)) => panic!("{name}: only they read it: {findings}"),
        }
    }
    assert!(
        same >= 15 && refused >= 80,
        "{same} read, {refused} refused"
    );
}

/// Tests texts that this parser and serde treat differently.
#[test]
fn tags_duplicates_and_numbers_are_handled() {
    let rule_set = |name: &str| {
        format!(
            "fuzzy: 1\nname: {name}\ninputs: {{x: {{range: [0, 1], partition: [a, b]}}}}\n\
             outputs: {{y: {{range: [0, 1], partition: [c, d]}}}}\nrules: [IF x IS a THEN y IS c]\n"
        )
    };
    let ours = |text: &str| text.parse::<Model>().map(|model| model.name);
    let theirs = |text: &str| serde_yaml::from_str::<Model>(text).map(|model| model.name);

    // This parser keeps a name that looks like a number as it is written; serde passes it on as a number.
    let number = rule_set("1.50");
    assert_eq!(
        (ours(&number).unwrap(), theirs(&number).unwrap()),
        ("1.50".into(), "1.5".into())
    );
    // Hexadecimal and octal numbers are read as text here, so that they are not used as a range by accident.
    let hexadecimal = rule_set("fan").replace("[0, 1], partition: [a", "[0x0, 0x1], partition: [a");
    assert!(ours(&hexadecimal).is_err() && theirs(&hexadecimal).is_ok());
    // Tags are not supported in rule sets.
    assert!(ours(&rule_set("!!str fan")).is_err() && theirs(&rule_set("!!str fan")).is_ok());
    // Both this parser and serde reject a repeated key; this parser also reports its position and all other findings.
    let twice = rule_set("fan\nname: fun\nunknown: 1");
    let findings = yaml::parse(&twice).unwrap_err();
    let codes: Vec<&str> = findings.0.iter().map(|finding| finding.code).collect();
    assert_eq!(codes, ["duplicate-key", "unknown-key"]);
    assert!(theirs(&twice).is_err());
}

/// A rule set whose names are not in alphabetical order.
const UNSORTED: &str = "
fuzzy: 1
name: unsorted
inputs:
  speed: {range: [0, 10], partition: {none: 1, much: 9}}
  load: {range: [0, 1], terms: {low: {left_shoulder: [0, 1]}, high: {right_shoulder: [0, 1]}}}
outputs:
  risk: {range: [0, 100], partition: [small, large]}
  alarm: {range: [0, 1], terms: {quiet: {constant: 0}, loud: {linear: {speed: 0.1, load: -0.5, constant: 1}}}, defuzzifier: weighted_average}
blocks:
  second: {rules: [IF speed IS much THEN risk IS large AND alarm IS loud]}
  first: {operators: {and: product}, rules: [IF speed IS none AND load IS low THEN risk IS small AND alarm IS quiet]}
";

/// Sorts the keys of all mappings alphabetically, as `serde_json` does without its feature `preserve_order`.
fn sorted(value: serde_json::Value) -> serde_json::Value {
    match value {
        serde_json::Value::Object(map) => {
            let entries: BTreeMap<String, _> = map.into_iter().collect();
            entries
                .into_iter()
                .map(|(key, value)| (key, sorted(value)))
                .collect()
        }
        serde_json::Value::Array(items) => items.into_iter().map(sorted).collect(),
        other => other,
    }
}

#[test]
fn every_format_keeps_the_order_of_inputs_outputs_terms_and_blocks() {
    let model: Model = UNSORTED.parse().unwrap();
    let json = sorted(serde_json::to_value(&model).unwrap());
    let through = [
        serde_json::from_value::<Model>(json).unwrap(),
        serde_json::from_str(&serde_json::to_string(&model).unwrap()).unwrap(),
        toml::from_str(&toml::to_string(&model).unwrap()).unwrap(),
        toml::Value::try_from(&model).unwrap().try_into().unwrap(),
        serde_yaml::from_str(&serde_yaml::to_string(&model).unwrap()).unwrap(),
        ron::from_str(&ron::to_string(&model).unwrap()).unwrap(),
        // Text written by serde can also be parsed like a rule set file.
        serde_json::to_string(&model).unwrap().parse().unwrap(),
    ];
    let engine = Engine::new(&model).unwrap();
    for (index, mut again) in through.into_iter().enumerate() {
        let values = |engine: &Engine| -> Vec<Option<u64>> {
            let outcomes = engine.evaluate(&[8.0, 0.75]).unwrap();
            outcomes
                .iter()
                .map(|one| Some(one.value()?.to_bits()))
                .collect()
        };
        assert_eq!(
            values(&Engine::new(&again).unwrap()),
            values(&engine),
            "{index}"
        );
        // The coefficients of a linear function are identified by name, so their order is not significant.
        for output in &mut again.outputs {
            for term in &mut output.variable.terms {
                if let fuzzy::model::MembershipFunction::Linear { coefficients, .. } =
                    &mut term.membership_function
                {
                    coefficients.sort_by(|(a, _), (b, _)| b.cmp(a));
                }
            }
        }
        assert_eq!(again, model, "{index}");
    }
}

/// An invalid entry in a list of variables, terms or blocks is reported by its position and the expected content,
/// together with all other findings.
#[test]
fn a_bad_entry_of_a_list_is_named() {
    let list: Model = UNSORTED.parse().unwrap();
    let json = serde_json::to_string(&list).unwrap();
    let cases = [
        (
            r#"{"name":"load","#,
            r#"{"nome":"load","#,
            "entry 2 of `inputs` has no `name`",
        ),
        (
            r#"{"name":"quiet","constant":0}"#,
            "5",
            "expected a mapping with a `name` for entry 1 of the terms of `alarm`, found `5`",
        ),
        (
            r#"{"name":"second","#,
            r#"["a"], {"name":"second","#,
            "expected a mapping with a `name` for entry 1 of `blocks`, found a list",
        ),
        (
            r#"{"name":"load","#,
            r#"{"name":"load","name":"mass","#,
            "unknown key `name`",
        ),
    ];
    for (before, after, expected) in cases {
        assert!(json.contains(before), "{json}");
        let reported = json.replacen(before, after, 1).parse::<Model>();
        let reported = reported.unwrap_err().to_string();
        assert!(reported.contains(expected), "{reported}");
    }
}

#[test]
fn sorted_mappings_of_earlier_versions_are_still_read() {
    // In the format of earlier versions, a partition is a mapping, and its terms are sorted by their peaks.
    let mut text = UNSORTED.replace("{none: 1, much: 9}", "{much: 9, none: 1}");
    let document = yaml::parse(&text).unwrap();
    assert_eq!(document.model, UNSORTED.parse::<Model>().unwrap());
    // In a text written by a person, the unsorted order may be a mistake.
    assert_eq!(document.warnings.0[0].code, "inverted-parameters");
    assert_eq!(document.warnings.0.len(), 1);
    text = text.replace("much: 9", "much: 1");
    let reported = text.parse::<Model>().unwrap_err().to_string();
    assert!(reported.contains("have the same peak, 1"), "{reported}");
}

#[test]
fn steps_survive_formats_without_null_and_with_sorted_keys() {
    let text = "fuzzy: 1\nname: credit\n\
                inputs: {dti: {range: [-10, 100], steps: {zero: 0, fine: 36, over: }}}\n\
                outputs: {risk: {range: [0, 1], partition: [low, high]}}\n\
                rules: [IF dti IS over THEN risk IS high]\n\
                allow: [{finding: jump, because: required by the regulation}]\n";
    let model: Model = text.parse().unwrap();
    assert_eq!(model.inputs[0].step_limits(), Some(vec![0.0, 36.0]));
    let json = serde_json::to_string(&model).unwrap();
    let steps = r#""steps":[{"name":"zero","below":0},{"name":"fine","below":36},{"name":"over"}]"#;
    assert!(json.contains(steps), "{json}");
    assert_eq!(serde_json::from_str::<Model>(&json).unwrap(), model);
    // With sorted keys, the order of the terms follows from the limits. In a text written by a person, this order is
    // an error, because it may be a mistake.
    let sorted = json.replace(steps, r#""steps":{"fine":36,"over":null,"zero":0}"#);
    assert_eq!(serde_json::from_str::<Model>(&sorted).unwrap(), model);
    let sorted = text.replace("{zero: 0, fine: 36, over: }", "{fine: 36, over: , zero: 0}");
    let error = sorted.parse::<Model>().unwrap_err().to_string();
    assert!(
        error.contains("`over` in the steps of input `dti` has no limit"),
        "{error}"
    );
    assert_eq!(yaml::to_string(&model).parse::<Model>().unwrap(), model);
}
