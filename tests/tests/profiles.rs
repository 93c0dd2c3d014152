//! Profiles as their authors meet them: template, schema, check, and what a profile that does not fit leads to.

use std::fs;

use flagred_tests::{Folder, STEADY, flagred, schema};
use serde_json::Value;

const ROOT: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/..");

/// A rule set that reaches 83.3 %.
const RULES: &str = "
fuzzy: 1
name: mine
inputs:
  margin: {range: [0, 0.5], partition: [low, high]}
outputs:
  risk: {range: [0, 100], partition: [low, medium, high]}
rules:
  - IF margin IS low THEN risk IS high
  - IF margin IS high THEN risk IS low
";

const PROFILE: &str = "flagred: 1
name: mine
rules: rules.yaml
inputs: {margin: {mean: motor_margin}}
verdict:
  warn: {risk: 60, until: {risk: 30}}
  fail: {risk: 80}
";

fn run(arguments: &[&str]) -> (Option<i32>, String, String) {
    let output = flagred().args(arguments).output().unwrap();
    (
        output.status.code(),
        String::from_utf8(output.stdout).unwrap(),
        String::from_utf8(output.stderr).unwrap(),
    )
}

fn template() -> String {
    let (code, text, _) = run(&["new", "mine", "--profile", "--output", "-"]);
    assert_eq!(code, Some(0));
    text
}

fn shipped() -> Vec<String> {
    ["multirotor", "flagred-paper", "flagred-battery"]
        .map(|name| format!("{ROOT}/rules/profiles/{name}.yaml"))
        .to_vec()
}

#[test]
fn the_shipped_profiles_and_the_template_have_no_findings() {
    let folder = Folder::new();
    let mine = folder.file("mine.yaml", template());
    for profile in shipped().iter().chain([&mine]) {
        let (code, told, _) = run(&["check", "--deny", "notes", profile]);
        assert_eq!((code, told), (Some(0), format!("{profile}: no findings\n")));
    }
    let (_, text, _) = run(&["check", "--json", &mine]);
    let document: Value = serde_json::from_str(&text).unwrap();
    assert_eq!(document["profile"], "mine");
    let errors = schema::errors(&schema::schema("check"), &document);
    assert_eq!(errors, Vec::<String>::new());
}

#[test]
fn the_schema_takes_what_the_reader_takes() {
    let schema = schema::schema("profile");
    let valid = |text: &str| {
        let profile: Value = serde_yaml::from_str(text).unwrap();
        schema::errors(&schema, &profile)
    };
    for path in shipped() {
        assert_eq!(
            valid(&fs::read_to_string(path).unwrap()),
            Vec::<String>::new()
        );
    }
    assert_eq!(valid(&template()), Vec::<String>::new());
    for (part, by) in [
        ("window_s: 2 ", "window_s: 0 "),
        ("risk: 67", "risk: 167"),
        ("mean: motor_margin", "meen: motor_margin"),
        ("flagred: 1", "flagred: 2"),
        ("idle_below", "idle_under"),
    ] {
        let text = template().replacen(part, by, 1);
        assert_ne!(text, template());
        assert_ne!(valid(&text), Vec::<String>::new(), "{by}");
        assert!(text.parse::<flagred::profile::Profile>().is_err(), "{by}");
    }

    // Each key of the schema is one of the reader.
    let keys = |part: &Value| -> Vec<String> {
        let fields = part["properties"].as_object().unwrap();
        fields.keys().cloned().collect()
    };
    let parts = &schema["properties"];
    let nested = |name: &str, part: &Value| -> Vec<String> {
        let keys = keys(part).into_iter();
        keys.map(|key| format!("{name}: {{{key}: }}")).collect()
    };
    let mut lines = keys(&schema);
    lines.iter_mut().for_each(|key| key.push(':'));
    lines.extend(nested("verdict", &parts["verdict"]));
    lines.extend(nested("elevated_risk", &parts["elevated_risk"]));
    lines.extend(nested("gap", &parts["gap"]));
    let input = &parts["inputs"]["additionalProperties"];
    lines.extend(nested("inputs: {x", input).iter().map(|l| l.clone() + "}"));
    assert!(lines.len() > 40, "{lines:?}");
    for line in lines {
        let found = line.parse::<flagred::profile::Profile>().unwrap_err();
        let unknown = found.0.iter().find(|one| one.code == "unknown-key");
        assert_eq!(unknown, None, "{line}");
    }
}

#[test]
fn what_does_not_fit_is_told_by_every_command_and_an_impossible_verdict_is_refused() {
    let folder = Folder::new();
    folder.file("rules.yaml", RULES);
    let profile = folder.file("mine.yaml", PROFILE.replace("risk: 80", "risk: 84"));
    let (code, told, _) = run(&["check", &profile]);
    assert_eq!(code, Some(0));
    assert!(
        told.contains("warning[out-of-reach]: `fail` at risk 84 is never reached"),
        "{told}"
    );
    let (code, _, _) = run(&["check", "--deny", "warnings", &profile]);
    assert_eq!(code, Some(1));
    for command in [
        &["assess", "--profile", &profile, STEADY][..],
        &["export", "--rust", &profile],
        &["map", &profile],
    ] {
        let (_, out, told) = run(command);
        assert!(told.contains("is never reached"), "{command:?}: {told}");
        assert!(!out.is_empty(), "{command:?}");
    }

    let never = PROFILE
        .replace("risk: 80", "risk: 90")
        .replace("risk: 60, until: {risk: 30}", "risk: 85");
    let profile = folder.file("mine.yaml", never);
    for command in [
        &["assess", "--profile", &profile, STEADY][..],
        &["watch", "--profile", &profile, "udpin:127.0.0.1:0"],
        &["export", "--rust", &profile],
    ] {
        let (code, out, told) = run(command);
        assert_eq!((code, out.as_str()), (Some(3), ""), "{command:?}: {told}");
        assert!(
            told.contains("neither `warn` nor `fail` can be reached"),
            "{told}"
        );
    }
    let (code, told, _) = run(&["check", &profile]);
    assert_eq!(code, Some(1));
    assert!(told.contains("mine.yaml: 1 error"), "{told}");
}

#[test]
fn a_mistake_in_the_rule_set_is_shown_in_the_rule_set() {
    let folder = Folder::new();
    folder.file("rules.yaml", RULES.replace("risk IS high", "risk IS hihg"));
    let profile = folder.file("mine.yaml", PROFILE);
    for command in [
        &["check", &profile][..],
        &["assess", "--profile", &profile, STEADY],
    ] {
        let (code, _, told) = run(command);
        assert_eq!(code, Some(3), "{told}");
        assert!(told.contains("rules.yaml:9"), "{told}");
        assert!(told.contains("did you mean `high`?"), "{told}");
    }
}

/// `docs/profiles.md` lists the signals that logs carry.
#[test]
fn the_page_lists_every_signal() {
    let page = fs::read_to_string(format!("{ROOT}/docs/profiles.md")).unwrap();
    for signal in flightlog::known_signals() {
        let formats: Vec<&str> = signal
            .formats
            .iter()
            .map(|format| match format {
                flightlog::Format::DataFlash => "DataFlash",
                flightlog::Format::ULog => "ULog",
                flightlog::Format::Tlog => "tlog",
                other => panic!("{other}"),
            })
            .collect();
        let line = format!(
            "| `{}` | {} | {} |",
            signal.name,
            signal.unit,
            formats.join(", ")
        );
        assert!(page.contains(&line), "{line}");
    }
}
