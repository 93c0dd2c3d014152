//! Profiles from an author's point of view: template, schema, check, and profiles that do not fit.

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
    let (code, text, _) = run(&["new", "mine", "--profile", "flagred", "--output", "-"]);
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
        let (code, reported, _) = run(&["check", "--deny", "notes", profile]);
        assert_eq!(code, Some(0), "{reported}");
        assert!(
            reported.ends_with(&format!("{profile}: no findings\n")),
            "{reported}"
        );
    }
    let (_, text, _) = run(&["check", "--json", &mine]);
    let document: Value = serde_json::from_str(&text).unwrap();
    assert_eq!(document["profile"], "mine");
    let errors = schema::errors(&schema::schema("check"), &document);
    assert_eq!(errors, Vec::<String>::new());
}

#[test]
fn the_schema_accepts_what_the_reader_accepts() {
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
        ("risk: 60", "risk: 160"),
        ("room: {mean: ", "room: {meen: "),
        ("flagred: 1", "flagred: 2"),
        ("idle_below", "idle_under"),
    ] {
        let text = template().replacen(part, by, 1);
        assert_ne!(text, template());
        assert_ne!(valid(&text), Vec::<String>::new(), "{by}");
        assert!(text.parse::<flagred::profile::Profile>().is_err(), "{by}");
    }

    // The reader knows each key of the schema.
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
fn every_command_reports_a_profile_that_does_not_fit_and_refuses_an_impossible_verdict() {
    let folder = Folder::new();
    folder.file("rules.yaml", RULES);
    let profile = folder.file("mine.yaml", PROFILE.replace("risk: 80", "risk: 84"));
    let (code, reported, _) = run(&["check", &profile]);
    assert_eq!(code, Some(0));
    assert!(
        reported.contains("warning[out-of-reach]: `fail` at risk 84 is never reached"),
        "{reported}"
    );
    let (code, _, _) = run(&["check", "--deny", "warnings", &profile]);
    assert_eq!(code, Some(1));
    for command in [
        &["assess", "--profile", &profile, STEADY][..],
        &["export", "--rust", &profile],
        &["map", &profile],
    ] {
        let (_, out, reported) = run(command);
        assert!(
            reported.contains("is never reached"),
            "{command:?}: {reported}"
        );
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
        let (code, out, reported) = run(command);
        assert_eq!(
            (code, out.as_str()),
            (Some(3), ""),
            "{command:?}: {reported}"
        );
        assert!(
            reported.contains("neither `warn` nor `fail` can be reached"),
            "{reported}"
        );
    }
    let (code, reported, _) = run(&["check", &profile]);
    assert_eq!(code, Some(1));
    assert!(reported.contains("mine.yaml: 1 error"), "{reported}");
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
        let (code, _, reported) = run(command);
        assert_eq!(code, Some(3), "{reported}");
        assert!(reported.contains("rules.yaml:9"), "{reported}");
        assert!(reported.contains("did you mean `high`?"), "{reported}");
    }
}

/// `docs/profiles.md` lists the signals of logs.
#[test]
fn the_page_lists_every_signal() {
    let page = fs::read_to_string(format!("{ROOT}/docs/profiles.md")).unwrap();
    for signal in flagred_flightlog::known_signals() {
        let formats: Vec<&str> = signal
            .formats
            .iter()
            .map(|format| match format {
                flagred_flightlog::Format::DataFlash => "DataFlash",
                flagred_flightlog::Format::ULog => "ULog",
                flagred_flightlog::Format::Tlog => "tlog",
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

/// A flight of 60 s at 25 Hz, with the motors and the battery level at each time; `None` is unknown.
fn flight(
    motors: impl Fn(f64) -> [Option<f64>; 4],
    battery: impl Fn(f64) -> Option<f64>,
) -> String {
    let cell = |value: Option<f64>| value.map_or(String::new(), |value| format!("{value:.4}"));
    let mut rows = String::from("t_s,motor1,motor2,motor3,motor4,in_air,battery_remaining_pct\n");
    for i in 0..1500 {
        let t_s = f64::from(i) * 0.04;
        let motors = motors(t_s).map(cell).join(",");
        rows += &format!("{t_s:.2},{motors},1,{}\n", cell(battery(t_s)));
    }
    rows
}

/// The motor commands of a calm hover.
fn calm(t_s: f64) -> [Option<f64>; 4] {
    let swing = 0.001 * (7.0 * t_s).sin();
    let [a, b] = [0.5 + swing, 0.5 - swing];
    [a, b, a, b].map(Some)
}

fn hover(battery: impl Fn(f64) -> Option<f64>) -> String {
    flight(calm, battery)
}

#[test]
fn an_empty_battery_determines_the_risk_of_the_shipped_profile() {
    let folder = Folder::new();
    let assess = |battery: &dyn Fn(f64) -> Option<f64>| {
        let log = folder.file("hover.csv", hover(battery));
        let (code, reported, errors) = run(&["assess", "--profile", "flagred-battery", &log]);
        assert_eq!(errors, "");
        (code, reported)
    };
    for (level, code, verdict) in [
        (100.0, 0, "GOOD"),
        (25.0, 0, "GOOD"),
        (15.5, 1, "WARN"),
        (10.0, 1, "FAIL"),
        (0.0, 1, "FAIL"),
    ] {
        let (found, reported) = assess(&|_| Some(level));
        assert_eq!(found, Some(code), "{level}: {reported}");
        assert!(reported.starts_with(verdict), "{level}: {reported}");
        if verdict != "GOOD" {
            assert!(reported.contains("battery_risk"), "{reported}");
        }
    }
    // The battery runs empty during the flight.
    let (_, reported) = assess(&|t_s| Some((80.0 - 2.0 * t_s).max(0.0)));
    assert!(
        reported.starts_with("FAIL") && reported.contains("The battery was down to "),
        "{reported}"
    );
    // An unknown level never counts as GOOD.
    for known_s in [0.0, 20.0] {
        let (code, reported) = assess(&|t_s| (t_s < known_s).then_some(80.0));
        assert_eq!(code, Some(3), "{reported}");
        assert!(reported.starts_with("NA"), "{reported}");
    }
    let log = folder.file(
        "without.csv",
        hover(|_| Some(1.0)).replace("battery_remaining_pct", "x"),
    );
    let (code, reported, _) = run(&["assess", "--profile", "flagred-battery", &log]);
    assert_eq!(code, Some(3));
    assert!(
        reported.contains("needs the signal `battery_remaining_pct`"),
        "{reported}"
    );
    // Code for a board computes only one risk.
    for language in ["--rust", "--c", "--lua"] {
        let (code, out, reported) = run(&["export", language, "flagred-battery"]);
        assert_eq!((code, out.as_str()), (Some(3), ""), "{language}");
        assert!(reported.contains("`risk` and `battery_risk`"), "{reported}");
        assert!(
            reported.contains("write a profile for each risk"),
            "{reported}"
        );
    }
}

#[test]
fn another_risk_is_in_the_steps_and_a_line_of_the_chart() {
    let folder = Folder::new();
    // The battery is unknown from 30 s to 35 s, then nearly empty.
    let log = folder.file(
        "flight.csv",
        hover(|t_s| match t_s {
            ..30.0 => Some(90.0),
            30.0..35.0 => None,
            _ => Some(14.0),
        }),
    );
    let steps = |profile: &str| {
        let (_, document, _) = run(&["assess", "--json", "--profile", profile, &log]);
        let document: Value = serde_json::from_str(&document).unwrap();
        document["steps"].as_array().unwrap().clone()
    };
    let (two, one) = (steps("flagred-battery"), steps("flagred"));
    assert_eq!(two.len(), one.len());
    for (two, one) in two.iter().zip(&one) {
        let other = &two["other_risks"]["battery_risk"];
        let t_s = two["t_s"].as_f64().unwrap();
        match t_s {
            ..29.9 => assert_eq!(other, 0.0, "{t_s}"),
            30.1..34.9 => assert!(other.is_null(), "{t_s}: {other}"),
            36.0.. => assert!(other.as_f64().unwrap() > 60.0, "{t_s}: {other}"),
            _ => {}
        }
        assert_eq!(two["risk"], one["risk"], "{t_s}");
        assert!(one.get("other_risks").is_none());
    }

    let (_, table, _) = run(&["assess", "--csv", "--profile", "flagred-battery", &log]);
    let column = |row: &str| row.rsplit(',').next().unwrap().to_owned();
    let rows: Vec<String> = table.lines().map(column).collect();
    assert_eq!(rows[0], "other_risk_battery_risk");
    for (cell, step) in rows[1..].iter().zip(&two) {
        let known = step["other_risks"]["battery_risk"].as_f64();
        assert_eq!(cell.parse().ok(), known, "{step}");
    }

    let file = folder.at("report.html");
    run(&[
        "assess",
        "--html",
        &file,
        "--profile",
        "flagred-battery",
        &log,
    ]);
    let page = fs::read_to_string(file).unwrap();
    assert!(page.contains("<span class=\"key value\">battery risk "));
    let (_, line) = page.split_once("<path class=\"line value\" d=\"").unwrap();
    let (line, _) = line.split_once('"').unwrap();
    let highest = two
        .iter()
        .filter_map(|step| step["other_risks"]["battery_risk"].as_f64());
    let highest = highest.fold(0.0, f64::max);
    let drawn = line
        .split(['M', 'L'])
        .filter_map(|point| point.trim_end_matches("h0").split_once(' '));
    let drawn = drawn.map(|(_, risk)| risk.parse::<f64>().unwrap());
    assert!((drawn.fold(0.0, f64::max) - highest).abs() <= 0.051);
    // The line is interrupted while the battery is unknown.
    assert_eq!(line.matches('M').count(), 2);
}

#[test]
fn each_risk_needs_only_the_inputs_that_its_rules_read() {
    let folder = Folder::new();
    let assess = |log: String| {
        let log = folder.file("flight.csv", log);
        let (code, reported, errors) = run(&["assess", "--profile", "flagred-battery", &log]);
        assert_eq!(errors, "");
        (code, reported)
    };
    let failing = |t_s: f64| match t_s {
        20.0..40.0 => [1.0, 0.0, 1.0, 0.0].map(Some),
        _ => calm(t_s),
    };
    let lost = |t_s: f64| {
        let [a, b, _, d] = calm(t_s);
        [a, b, None, d]
    };
    let is_known = |from_s: f64| move |t_s: f64| (t_s < from_s).then_some(80.0);

    // The motors cause FAIL, whatever is known of the battery; a note reports that its risk is unknown.
    let without = |log: String| log.replace("battery_remaining_pct", "x");
    for (log, unknown) in [
        (
            flight(failing, |_| None),
            "the whole time: the signal of input `battery` has no known value",
        ),
        (
            flight(failing, is_known(5.0)),
            "% of the time: the signal of input `battery` has no known value",
        ),
        (
            without(flight(failing, |_| Some(80.0))),
            "the whole time: the profile needs the signal `battery_remaining_pct`, which the flight does not contain",
        ),
    ] {
        let (code, reported) = assess(log);
        assert_eq!(code, Some(1), "{reported}");
        assert!(reported.starts_with("FAIL"), "{reported}");
        let note = reported
            .lines()
            .find(|line| line.contains("`battery_risk` is unknown for "));
        assert!(
            note.is_some_and(|note| note.contains(unknown)),
            "{reported}"
        );
    }
    // Calm motors are not enough for GOOD, and the reason is the battery.
    for (log, why) in [
        (flight(calm, |_| None), "input `battery` has no known value"),
        (
            flight(calm, is_known(5.0)),
            "input `battery` has no known value",
        ),
        (
            without(flight(calm, |_| Some(80.0))),
            "needs the signal `battery_remaining_pct`",
        ),
    ] {
        let (code, reported) = assess(log);
        assert_eq!(code, Some(3), "{reported}");
        assert!(
            reported.starts_with("NA") && reported.contains(why),
            "{reported}"
        );
    }
    // The battery causes FAIL, whatever is known of the motors.
    let (code, reported) = assess(flight(lost, |_| Some(0.0)));
    assert_eq!(code, Some(1), "{reported}");
    assert!(
        reported.starts_with("FAIL") && reported.contains("battery_risk"),
        "{reported}"
    );
    let (code, reported) = assess(flight(lost, |_| Some(80.0)));
    assert_eq!(code, Some(3), "{reported}");
    assert!(
        reported.starts_with("NA") && reported.contains("motor 3"),
        "{reported}"
    );
}

/// The motors cause WARN or FAIL, so only a note can report that the battery was not assessed.
#[test]
fn a_risk_without_its_signal_is_named_beside_the_findings_of_another_risk() {
    let folder = Folder::new();
    let failing = |t_s: f64| match t_s {
        20.0..40.0 => [1.0, 0.0, 1.0, 0.0].map(Some),
        _ => calm(t_s),
    };
    let log = flight(failing, |_| Some(80.0)).replace("battery_remaining_pct", "x");
    let log = folder.file("flight.csv", log);
    let with =
        |more: &[&str]| run(&[&["assess", "--profile", "flagred-battery", &log], more].concat()).1;
    let missing =
        "the profile needs the signal `battery_remaining_pct`, which the flight does not contain";
    let note = format!("`battery_risk` is unknown for the whole time: {missing}");
    for more in [&[][..], &["-v"], &["--html", "-"], &[STEADY]] {
        let reported = with(more);
        assert!(reported.contains(&note), "{more:?}: {reported}");
    }
    let document: Value = serde_json::from_str(&with(&["--json"])).unwrap();
    let errors = schema::errors(&schema::schema("assess"), &document);
    assert_eq!(errors, Vec::<String>::new());
    let unknown = &document["unknown_risks"];
    let of_battery = unknown.as_array().unwrap().iter();
    let of_battery: Vec<&Value> = of_battery
        .filter(|risk| risk["output"] == "battery_risk")
        .collect();
    assert_eq!(of_battery.len(), 1, "{unknown}");
    assert_eq!(of_battery[0]["reason"], missing);
    let in_air_s = document["summary"]["in_air_s"].as_f64().unwrap();
    assert_eq!(
        of_battery[0]["unknown_s"].as_f64().unwrap().round(),
        in_air_s.round()
    );
}

/// Only one of every 25 rows contains the battery level.
#[test]
fn a_slow_signal_with_empty_cells_is_unknown_and_the_help_names_the_remedy() {
    let folder = Folder::new();
    let sparse = hover(|t_s| ((t_s / 0.04).round() % 25.0 == 0.0).then_some(80.0));
    let log = folder.file("flight.csv", sparse);
    let (code, reported, _) = run(&["assess", "--profile", "flagred-battery", &log]);
    assert_eq!(code, Some(3), "{reported}");
    assert!(
        reported.contains("the signal of input `battery` has no known value"),
        "{reported}"
    );
    assert!(
        reported.contains("help: an empty cell is an unknown value: if the signal"),
        "{reported}"
    );
    let (_, contents, _) = run(&["inspect", &log]);
    let signal = contents
        .lines()
        .find(|line| line.contains("battery_remaining_pct"));
    let signal = signal.unwrap();
    assert!(
        signal.contains("1.0 Hz") && signal.contains("more are unknown"),
        "{signal}"
    );
    // A lost sensor is another case.
    let log = folder.file("flight.csv", hover(|t_s| (t_s < 5.0).then_some(80.0)));
    let (_, reported, _) = run(&["assess", "--profile", "flagred-battery", &log]);
    assert!(
        reported.contains("help: `flagred inspect` shows how many values"),
        "{reported}"
    );
}

/// Writes a profile whose rules are the default rules and the given rule about the battery; returns its path.
fn voting(folder: &Folder, rule: &str) -> String {
    let read = |file: &str| fs::read_to_string(format!("{ROOT}/rules/{file}")).unwrap();
    let input =
        "inputs:\n  battery: {unit: \"%\", range: [0, 100], partition: {empty: 20, ok: 35}}\n";
    let rules = read("flagred.yaml").replacen("inputs:\n", input, 1);
    let rules = rules.replacen("\nrules:\n", &format!("\nrules:\n  - {rule}\n"), 1);
    folder.file("rules.yaml", rules);
    let profile = read("profiles/multirotor.yaml");
    let profile = profile.replacen("rules: flagred ", "rules: rules.yaml ", 1);
    let input = "inputs:\n  battery: {last: battery_remaining_pct}\n";
    folder.file("mine.yaml", profile.replacen("inputs:\n", input, 1))
}

#[test]
fn check_warns_about_an_input_that_is_outvoted() {
    let folder = Folder::new();
    let profile = voting(&folder, "IF battery IS empty THEN risk IS very_high");
    let (code, reported, _) = run(&["check", &profile]);
    assert_eq!(code, Some(0));
    let reported = reported.replace(&profile, "mine.yaml");
    insta::assert_snapshot!(reported);
    let (code, text, _) = run(&["check", "--deny", "warnings", "--json", &profile]);
    assert_eq!(code, Some(1));
    let document: Value = serde_json::from_str(&text).unwrap();
    let errors = schema::errors(&schema::schema("check"), &document);
    assert_eq!(errors, Vec::<String>::new());
    let battery = &document["alone"][0];
    assert_eq!(
        (&battery["input"], &battery["term"]),
        (&"battery".into(), &"empty".into())
    );
    // The warning is correct: with an empty battery, the flight is GOOD.
    let log = folder.file("hover.csv", hover(|_| Some(0.0)));
    let (code, reported, errors) = run(&["assess", "--profile", &profile, &log]);
    assert_eq!((code, errors.as_str()), (Some(0), ""), "{reported}");
    assert!(reported.starts_with("GOOD"), "{reported}");
    let highest = battery["risk_pct"].as_f64().unwrap();
    let said = reported
        .split("highest ")
        .nth(1)
        .unwrap()
        .split(' ')
        .next()
        .unwrap();
    assert!(
        (highest - said.parse::<f64>().unwrap()).abs() < 2.0,
        "{highest} {said}"
    );

    // If all other rules exclude an empty battery, its rule decides: `check` does not warn, and the flight fails.
    let rules = fs::read_to_string(folder.at("rules.yaml")).unwrap();
    let guarded = rules.replace(
        "at_limit IS none THEN",
        "at_limit IS none AND battery IS NOT empty THEN",
    );
    folder.file("rules.yaml", guarded);
    let (code, reported, _) = run(&["check", "--deny", "warnings", &profile]);
    assert_eq!(code, Some(0), "{reported}");
    let (code, reported, _) = run(&["assess", "--profile", &profile, &log]);
    assert_eq!(code, Some(1), "{reported}");
    assert!(reported.starts_with("FAIL"), "{reported}");
}

/// A profile that reads no motor, its rule set, and a table of loads that rise to `last_kg`.
fn forklift(folder: &Folder, last_kg: f64, step_s: f64) -> [String; 2] {
    folder.file(
        "forklift-rules.yaml",
        "fuzzy: 1\nname: forklift\ninputs: {left: {range: [0, 2000], partition: {rated: 1000, over: 1400}}}\n\
         outputs: {risk: {range: [0, 100], terms: {low: {constant: 5}, high: {constant: 95}}, defuzzifier: weighted_average}}\n\
         rules: [IF left IS rated THEN risk IS low, IF left IS over THEN risk IS high]\n",
    );
    let profile =
        "flagred: 1\nname: forklift\nrules: forklift-rules.yaml\ninputs: {left: {mean: left_kg}}\n";
    let mut table = String::from("# vehicle_kind: other vehicle\nt_s,left_kg\n");
    for i in 0..=400 {
        let load_kg = if i < 200 { 900.0 } else { last_kg };
        table += &format!("{},{load_kg}\n", f64::from(i) * step_s);
    }
    [
        folder.file("forklift.yaml", profile),
        folder.file("forklift.csv", table),
    ]
}

#[test]
fn a_profile_that_reads_no_motor_does_not_mention_rotors() {
    let folder = Folder::new();
    let [profile, table] = forklift(&folder, 1500.0, 0.1);
    let (code, reported, _) = run(&["check", "--deny", "notes", &profile]);
    assert_eq!(code, Some(0), "{reported}");
    assert!(
        reported.contains("the profile reads no motors"),
        "{reported}"
    );

    let html = folder.at("forklift.html");
    let arguments = ["assess", "-v", "--profile", &profile, "--html", &html];
    let (code, text, _) = run(&[&arguments[..], &[&table]].concat());
    assert_eq!(code, Some(1), "{text}");
    assert!(
        text.starts_with("FAIL ") && text.contains("in use 40.0 s"),
        "{text}"
    );
    let compared = folder.at("compared.html");
    run(&[
        "assess",
        "--profile",
        &profile,
        "--html",
        &compared,
        &table,
        &table,
    ]);
    let page = |file: &str| -> String {
        let html = fs::read_to_string(file).unwrap();
        let (_, body) = html.split_once("</style>").unwrap();
        body.split("<script>").next().unwrap().to_owned()
    };
    for shown in [&text, &page(&html), &page(&compared)] {
        let shown = shown.to_lowercase();
        for word in [
            "motor",
            "rotor",
            "in the air",
            "take-off",
            "landing",
            "land ",
            "attitude",
            "at a limit",
        ] {
            let found = shown
                .find(word)
                .map(|at| &shown[at.saturating_sub(80)..at + 20]);
            assert_eq!(found, None, "{word}");
        }
    }
    let (_, text, _) = run(&["assess", "--json", "--profile", &profile, &table]);
    let document: Value = serde_json::from_str(&text).unwrap();
    assert_eq!(document["verdict"], "FAIL");
    assert_eq!(document["summary"]["in_air_s"], 40.0);
    assert_eq!(document["vehicle"]["motors"], serde_json::json!([]));
    assert_eq!(
        schema::errors(&schema::schema("assess"), &document),
        Vec::<String>::new()
    );

    let [_, table] = forklift(&folder, 900.0, 0.1);
    let (code, text, _) = run(&["assess", "--profile", &profile, &table]);
    assert!(code == Some(0) && text.starts_with("GOOD "), "{text}");
    // The default profile requires motors; its message names profiles that do not.
    let (code, text, _) = run(&["assess", &table]);
    assert!(
        code == Some(3) && text.contains("not a multirotor"),
        "{text}"
    );
    // If samples are too far apart, for example because times are in milliseconds, each would be a separate flight.
    let [_, table] = forklift(&folder, 1500.0, 100.0);
    let (code, text, _) = run(&["assess", "--profile", &profile, &table]);
    assert_eq!(code, Some(3), "{text}");
    assert!(text.contains("the samples are 100 s apart"), "{text}");
}

#[test]
fn every_output_reports_an_assumed_signal() {
    let folder = Folder::new();
    let battery =
        fs::read_to_string(format!("{ROOT}/rules/profiles/flagred-battery.yaml")).unwrap();
    let plain = "battery: {last: battery_remaining_pct}";
    let with = |value: &str| {
        let input = format!("battery: {{last: battery_remaining_pct, if_missing: {value}}}");
        assert!(battery.contains(plain));
        folder.file("mine.yaml", battery.replace(plain, &input))
    };
    let profile = with("100");
    let (code, reported, _) = run(&["check", "--deny", "notes", &profile]);
    assert_eq!(code, Some(0), "{reported}");

    // A hover: without the level, with it, and with a failed sensor.
    let flight = |column: &str, level: &dyn Fn(u32) -> String| {
        let mut table = format!("t_s,motor1,motor2,motor3,motor4{column}\n");
        for i in 0..1500 {
            let t_s = f64::from(i) * 0.02;
            table += &format!("{t_s},0.5,0.51,0.49,0.5{}\n", level(i));
        }
        folder.file("flight.csv", table)
    };
    let missing = flight("", &|_| String::new());
    let (code, text, _) = run(&["assess", "--profile", "flagred-battery", &missing]);
    assert_eq!(code, Some(3), "{text}");
    let html = folder.at("report.html");
    let (code, text, _) = run(&["assess", "--profile", &profile, "--html", &html, &missing]);
    assert_eq!(code, Some(0), "{text}");
    let note = "is not in the log: input `battery` is assumed to be 100";
    assert!(text.contains(note), "{text}");
    assert!(fs::read_to_string(&html).unwrap().contains(note));
    let (_, text, _) = run(&["assess", "--profile", &profile, &missing, &missing]);
    assert!(text.contains("`battery` assumed to be 100"), "{text}");
    let (_, text, _) = run(&["assess", "--json", "--profile", &profile, &missing]);
    let document: Value = serde_json::from_str(&text).unwrap();
    assert_eq!(
        document["assumed_inputs"],
        serde_json::json!([{"input": "battery", "value": 100.0, "signals": ["battery_remaining_pct"]}])
    );
    assert_eq!(
        schema::errors(&schema::schema("assess"), &document),
        Vec::<String>::new()
    );

    // A failed sensor does not count as a full battery, even if it failed from the beginning.
    for lost in [0, 10] {
        let level = |i: u32| {
            if i < lost {
                ",80".into()
            } else {
                ",".to_owned()
            }
        };
        let log = flight(",battery_remaining_pct", &level);
        let (code, text, _) = run(&["assess", "--profile", &profile, &log]);
        assert_eq!(code, Some(3), "{text}");
        assert!(!text.contains("assumed to be"), "{text}");
    }
    let log = flight(",battery_remaining_pct", &|_| ",2".to_owned());
    let (code, text, _) = run(&["assess", "--profile", &profile, &log]);
    assert!(code == Some(1) && text.starts_with("FAIL"), "{text}");

    let outside = with("120");
    let (code, reported, _) = run(&["check", &outside]);
    assert_eq!(code, Some(1), "{reported}");
    assert!(
        reported.contains(
            "`if_missing` of input `battery` is 120, but the range of the input is 0 to 100"
        ) && reported.contains("help: write a number from 0 to 100"),
        "{reported}"
    );
}
