//! `flagred dataset` and `flagred learn` from a user's point of view, and the learned rule set.

use std::{
    collections::BTreeMap,
    fs,
    path::Path,
    process::{Command, Output},
};

use flagred_tests::{Folder, STEADY, flagred, reference_data};
use serde_json::Value;

const VARIABLES: &str = "\
# Kept at the head.
fuzzy: 1
name: test
inputs:
  margin: {range: [0, 0.5], partition: {very_low: 0, low: 0.1, medium: 0.2, high: 0.3}}
  spread: {range: [0, 0.5], partition: {low: 0, medium: 0.1, high: 0.2}}
outputs:
  risk: {range: [0, 100], partition: [very_low, low, medium, high, very_high]}
rules: []
";

fn learn(arguments: &[&str]) -> Output {
    flagred().arg("learn").args(arguments).output().unwrap()
}

/// Each reason why rules cannot be learned has its own help.
#[test]
fn an_unsuitable_template_is_refused_with_help() {
    let folder = Folder::new();
    let data = folder.file("data.csv", "margin,spread,risk\n0.1,0.2,50\n");
    let output = "  risk: {range: [0, 100], partition: [very_low, low, medium, high, very_high]}";
    let cases = [
        (
            VARIABLES.replace(output, "  risk: {range: [0, 100], defuzzifier: weighted_average, terms: {low: {linear: {margin: 2, constant: 1}}, high: {constant: 90}}}"),
            "help: replace it by a number, such as `{constant: 5}`; `tune` fits functions",
        ),
        (
            VARIABLES.replace(output, "  risk: {range: [0, 100], defuzzifier: weighted_average, terms: {low: {function: 2 * margin}, high: {constant: 90}}}"),
            "help: replace it by a number, such as `{constant: 5}`; `tune` fits functions",
        ),
        (
            VARIABLES.replace("rules: []", "  more: {range: [0, 1], partition: [a, b]}\nrules: []"),
            "help: keep one of these outputs, and the outputs that it reads",
        ),
        (
            VARIABLES.replace("rules: []", "blocks: {one: {rules: [IF margin IS low THEN risk IS low]}}"),
            "help: remove `blocks`",
        ),
    ];
    for (text, expected) in cases {
        let model = folder.file("model.yaml", &text);
        let output = learn(&[&model, &data, "-o", &folder.at("out.yaml")]);
        let reported = String::from_utf8_lossy(&output.stderr);
        assert_eq!(output.status.code(), Some(3), "{reported}");
        assert!(reported.contains(expected), "{reported}");
    }
}

/// No option and no message can name a column without a name.
#[test]
fn columns_without_a_name_are_ignored() {
    let folder = Folder::new();
    let model = folder.file("model.yaml", VARIABLES);
    let data = folder.file("data.csv", "margin,,spread\n0.1,5,0.2\n");
    let reported = |arguments: &[&str]| {
        let out = folder.at("out.yaml");
        let mut command = flagred();
        let output = command.args(arguments).args(["-o", &out]).output().unwrap();
        assert!(!output.status.success());
        String::from_utf8_lossy(&output.stderr).into_owned()
    };
    let missing = reported(&["learn", &model, &data]);
    assert!(
        missing.contains("choose one of `margin` and `spread`"),
        "{missing}"
    );
    for arguments in [
        &["identify", &data, "--target="][..],
        &["learn", &model, &data, "--column", "risk="],
        &[
            "learn",
            &model,
            &data,
            "--column",
            "risk=margin",
            "--weight=",
        ],
    ] {
        let nameless = reported(arguments);
        assert!(nameless.contains("a column must have a name"), "{nameless}");
    }
}

/// Earlier versions accepted such weights, and their sums overflowed: every rule had the same consequent, and the error
/// was NaN.
#[test]
fn weights_whose_sums_overflow_are_refused_as_by_tune() {
    let folder = Folder::new();
    let model = folder.file("model.yaml", VARIABLES);
    for weight in ["1e308", "1e-320"] {
        let data = folder.file(
            "data.csv",
            format!("margin,spread,risk,w\n0.1,0.2,50,1\n0.2,0.2,40,{weight}\n"),
        );
        let out = folder.at("out.yaml");
        let output = learn(&[&model, &data, "-o", &out, "--weight", "w"]);
        let reported = String::from_utf8_lossy(&output.stderr);
        assert_eq!(output.status.code(), Some(3), "{reported}");
        let expected =
            format!("line 3: the weight is {weight}, but must be a number from 1e-50 to 1e50");
        assert!(reported.contains(&expected), "{reported}");
        assert!(!std::path::Path::new(&out).exists());
    }
}

/// A profile may have an input `spread` that is not the spread of the motor commands in the summary.
#[test]
fn a_profile_does_not_change_the_meaning_of_dataset_columns() {
    let folder = Folder::new();
    let rules = "fuzzy: 1\nname: uneven\ninputs: {spread: {range: [0, 0.5], partition: {even: 0, uneven: 0.1}}}
outputs: {risk: {range: [0, 100], partition: [low, high]}}
rules: [IF spread IS even THEN risk IS low, IF spread IS uneven THEN risk IS high]\n";
    folder.file("uneven.yaml", rules);
    let profile = "flagred: 1\nname: uneven\nrules: uneven.yaml\ninputs: {spread: {mean: {std: motor_command_less_yaw}}}\n";
    let profile = folder.file("profile.yaml", profile);
    let rows = |more: &[&str]| {
        let output = flagred()
            .args(["dataset", "--window", "2", STEADY])
            .args(more)
            .output()
            .unwrap();
        assert!(output.status.success(), "{output:?}");
        String::from_utf8(output.stdout).unwrap()
    };
    // Rows are matched by their time, because the first assessed time depends on the profile.
    let column = |rows: &str, name: &str| -> BTreeMap<String, String> {
        let mut lines = rows.lines().map(|line| line.split(',').collect::<Vec<_>>());
        let head = lines.next().unwrap();
        let index = |name: &str| head.iter().position(|column| *column == name).unwrap();
        let (t_s, value) = (index("t_s"), index(name));
        lines
            .map(|cells| (cells[t_s].to_owned(), cells[value].to_owned()))
            .collect()
    };
    let (plain, with_profile) = (rows(&[]), rows(&["--profile", &profile]));
    let of_profile = column(&with_profile, "input_spread");
    for name in ["margin", "spread"] {
        let (plain, with_profile) = (column(&plain, name), column(&with_profile, name));
        assert!(plain.len() > 50);
        assert!(
            plain
                .iter()
                .all(|(t_s, value)| with_profile.get(t_s) == Some(value))
        );
        assert_ne!(with_profile, of_profile);
    }
    let ahead = flagred()
        .args(["dataset", "--horizon", "5", "--profile", "flagred", STEADY])
        .output()
        .unwrap();
    let head = String::from_utf8_lossy(&ahead.stdout);
    assert!(!head.lines().next().unwrap().contains("input_"), "{head}");
}

#[test]
fn rows_become_a_rule_set_with_its_provenance() {
    let folder = Folder::new();
    let model = folder.file("model.yaml", VARIABLES);
    // Table I of the paper, under other names.
    let data = folder.file(
        "data.csv",
        "m,s,r\n0.007969,0.226310,65.679063\n0.070469,0.308401,100.0\n0.064687,0.153689,46.015181\n0.351094,0.092301,4.798570\n",
    );
    let out = folder.at("out.yaml");
    let columns = [
        "--column", "margin=m", "--column", "spread=s", "--column", "risk=r",
    ];
    let mut arguments = vec![model.as_str(), &data, "-o", &out, "--json"];
    arguments.extend(columns);
    let output = learn(&arguments);
    assert_eq!(
        output.status.code(),
        Some(0),
        "{}",
        String::from_utf8_lossy(&output.stderr)
    );
    let report: Value = serde_json::from_slice(&output.stdout).unwrap();
    assert_eq!(report["rows"]["used"], 4);
    assert_eq!(report["rules"]["learned"], 3);
    assert_eq!(report["conflicts"], 1);
    assert_eq!(report["missing"]["count"], 9);
    let written = fs::read_to_string(&out).unwrap();
    insta::assert_snapshot!(written);
    // The written file is a valid rule set.
    let check = flagred().args(["check", &out]).output().unwrap();
    assert_ne!(check.status.code(), Some(3));
}

#[test]
fn bad_data_is_reported_with_its_position_and_nothing_is_written() {
    let folder = Folder::new();
    let model = folder.file("model.yaml", VARIABLES);
    let out = folder.at("out.yaml");
    for (name, text, expected) in [
        (
            "missing",
            "margin,spred,risk\n0.1,0.1,5\n",
            "has no column `spread`",
        ),
        (
            "nan",
            "margin,spread,risk\n0.1,0.1,5\n0.1,NaN,5\n",
            "line 3, column `spread`: `NaN` is not a finite number",
        ),
        (
            "text",
            "margin,spread,risk\nhigh,0.1,5\n",
            "line 2, column `margin`: `high` is not a number",
        ),
        (
            "infinite",
            "margin,spread,risk\n0.1,0.1,inf\n",
            "line 2, column `risk`: `inf` is not a finite number",
        ),
        (
            "range",
            "margin,spread,risk\n0.1,0.1,5\n0.1,0.7,5\n",
            "line 3: `spread` is 0.7, outside its range from 0 to 0.5",
        ),
        (
            "cell",
            "margin,spread,risk\n0.1,,5\n",
            "line 2, column `spread`: the cell is empty",
        ),
        ("empty", "", "is empty"),
        (
            "header",
            "margin,spread,risk\n",
            "has a header, but no rows",
        ),
        (
            "ragged",
            "margin,spread,risk\n0.1,0.1\n",
            "line 2: 2 cells, but the header has 3",
        ),
        (
            "twice",
            "margin,spread,risk,risk\n0.1,0.1,5,6\n",
            "has the column `risk` more than once",
        ),
    ] {
        let data = folder.file(&format!("{name}.csv"), text);
        let output = learn(&[&model, &data, "-o", &out]);
        let said = String::from_utf8_lossy(&output.stderr);
        assert_eq!(output.status.code(), Some(3), "{name}: {said}");
        assert!(
            said.contains(expected) && said.contains(name),
            "{name}: {said}"
        );
        assert!(said.contains("help: "), "{name}: {said}");
        assert!(!Path::new(&out).exists(), "{name}");
    }
    // The file with the rows must not be overwritten.
    let data = folder.file("rows.csv", "margin,spread,risk\n0.1,0.1,5\n");
    let output = learn(&[&model, &data, "-o", &data]);
    assert_eq!(output.status.code(), Some(2));
    assert!(fs::read_to_string(&data).unwrap().starts_with("margin"));
    // A single row is enough for a rule, and invalid rows can be skipped.
    let data = folder.file("one.csv", "margin,spread,risk\n0.1,0.1,5\n0.1,NaN,5\n");
    let output = learn(&[&model, &data, "-o", &out, "--skip-bad-rows"]);
    let said = String::from_utf8_lossy(&output.stdout);
    assert_eq!(output.status.code(), Some(0));
    assert!(
        said.contains("1 used, 1 refused") && said.contains("`NaN` is not a finite number"),
        "{said}"
    );
    assert!(Path::new(&out).exists());
}

#[test]
fn a_flight_becomes_rows() {
    let rows = |arguments: &[&str]| {
        let output = flagred()
            .arg("dataset")
            .args(arguments)
            .arg(STEADY)
            .output()
            .unwrap();
        assert_eq!(
            output.status.code(),
            Some(0),
            "{}",
            String::from_utf8_lossy(&output.stderr)
        );
        let text = String::from_utf8(output.stdout).unwrap();
        let mut lines = text
            .lines()
            .map(|l| l.split(',').map(str::to_owned).collect::<Vec<_>>());
        let header = lines.next().unwrap();
        (header, lines.collect::<Vec<_>>())
    };
    let (header, whole) = rows(&[]);
    let names = [
        "file",
        "vehicle",
        "kind",
        "from_s",
        "t_s",
        "margin",
        "spread",
        "att_rmse_deg",
        "risk",
    ];
    assert_eq!(header, names);
    assert_eq!(whole.len(), 1);
    let number = |text: &str| text.parse::<f64>().unwrap();
    let margin = number(&whole[0][5]);
    assert!((0.3..0.45).contains(&margin), "{margin}");
    approx::assert_abs_diff_eq!(
        number(&whole[0][8]),
        20.0 * number(&whole[0][7]),
        epsilon = 1e-3
    );

    let (_, windows) = rows(&["--window", "10"]);
    assert!((8..14).contains(&windows.len()), "{}", windows.len());
    let mean = windows.iter().map(|row| number(&row[5])).sum::<f64>() / windows.len() as f64;
    approx::assert_abs_diff_eq!(mean, margin, epsilon = 0.01);

    let (header, ahead) = rows(&["--horizon", "5", "--profile", "flagred-paper"]);
    let last = [
        "error_last_5_s_deg",
        "error_last_10_s_deg",
        "att_rmse_deg",
        "risk",
    ];
    assert_eq!(header[7..], last);
    assert!(ahead.len() > 180, "{}", ahead.len());
    let (_, often) = rows(&[
        "--horizon",
        "5",
        "--every",
        "0.25",
        "--profile",
        "flagred-paper",
    ]);
    assert!((2 * ahead.len() - 1..=2 * ahead.len()).contains(&often.len()));
    for row in &ahead {
        let [air_s, t_s, last_5, last_10] = [3, 4, 7, 8].map(|column| number(&row[column]));
        assert!(t_s >= air_s + 2.0 && last_5 <= last_10, "{row:?}");
        // The next 5 s of this row are the last 5 s of the row five seconds later.
        let later = ahead
            .iter()
            .find(|later| (number(&later[4]) - t_s - 5.0).abs() < 1e-6);
        assert!(later.is_none_or(|later| later[7] == row[9]), "{row:?}");
    }
}

#[test]
#[ignore = "needs FLAGRED_SHARED"]
fn the_documented_command_learns_the_shipped_rules() {
    let data = reference_data();
    let workspace = Path::new(env!("CARGO_MANIFEST_DIR")).join("..");
    let folder = Folder::new();
    let out = folder.at("flagred.yaml");
    fs::create_dir(folder.at("profiles")).unwrap();
    let profiles = ["profiles/multirotor.yaml", "profiles/flagred-battery.yaml"];
    let shipped = |name: &str| fs::read_to_string(workspace.join("rules").join(name)).unwrap();
    for name in profiles {
        let is_measured = |line: &&str| line.starts_with("  - {risk:");
        let text = shipped(name);
        let lines = text.split_inclusive('\n').filter(|line| !is_measured(line));
        fs::write(folder.at(name), lines.collect::<String>()).unwrap();
    }
    let status = Command::new(workspace.join("scripts/learn-flagred"))
        .arg(data)
        .arg(&out)
        .env("FLAGRED", flagred().get_program())
        .env(
            "TUNE",
            concat!(
                env!("CARGO"),
                " run -q -p flagred-tests --example tune_rules --"
            ),
        )
        .output()
        .unwrap();
    assert!(
        status.status.success(),
        "{}",
        String::from_utf8_lossy(&status.stderr)
    );
    for name in ["flagred.yaml"].into_iter().chain(profiles) {
        assert!(
            fs::read_to_string(folder.at(name)).unwrap() == shipped(name),
            "run scripts/learn-flagred on the data and commit rules/{name}"
        );
    }
}

#[cfg(unix)]
#[test]
fn the_battery_rules_extend_the_shipped_rules_unchanged() {
    let workspace = Path::new(env!("CARGO_MANIFEST_DIR")).join("..");
    let output = Command::new(workspace.join("scripts/add-battery"))
        .arg(workspace.join("rules/flagred.yaml"))
        .output()
        .unwrap();
    let shipped = fs::read(workspace.join("rules/flagred-battery.yaml")).unwrap();
    assert!(
        output.status.success() && output.stdout == shipped,
        "run scripts/add-battery rules/flagred.yaml and commit rules/flagred-battery.yaml: {}",
        String::from_utf8_lossy(&output.stderr)
    );
}

/// The directions that `learn` reports agree with `check --rising`.
#[test]
fn directions_are_confirmed_or_refuted_at_a_position() {
    let folder = Folder::new();
    let rows = "margin,spread,risk\n0,0.2,90\n0,0,20\n0.1,0.1,75\n0.1,0.2,25\n0.2,0,60\n0.3,0,0\n0.3,0.2,30\n";
    let data = folder.file("data.csv", rows);
    let operators = "operators: {and: product, implication: product, aggregation: sum}\nrules";
    for (variables, name, code) in [
        (VARIABLES.to_owned(), "bent", 1),
        (VARIABLES.replace("rules", operators), "straight", 0),
    ] {
        let model = folder.file(&format!("{name}.yaml"), variables);
        let out = folder.at(&format!("{name}-learned.yaml"));
        let arguments = [
            &model,
            &data,
            "-o",
            &out,
            "--complete",
            "--falling",
            "margin",
            "--rising",
            "spread",
            "--no-validation",
        ];
        let output = learn(&arguments);
        let said = String::from_utf8_lossy(&output.stdout);
        assert_eq!(output.status.code(), Some(code), "{name}: {said}");
        let check = flagred()
            .args(["check", &out, "--falling", "margin", "--rising", "spread"])
            .output()
            .unwrap();
        let found = String::from_utf8_lossy(&check.stdout);
        assert_eq!(found.contains("not-monotone"), code == 1, "{name}: {found}");
        if code == 1 {
            assert!(said.contains("monotone   no"), "{said}");
            assert!(
                said.contains("help: the output of these rules is monotone with `operators:"),
                "{said}"
            );
            let place = said
                .lines()
                .find(|line| line.contains("rises from"))
                .unwrap()
                .trim();
            assert!(found.contains(place), "{place}: {found}");
        } else {
            assert!(said.contains("monotone   yes"), "{said}");
            let text = fs::read_to_string(&out).unwrap();
            assert!(text.contains("so that the output is monotone"), "{text}");
        }
        let output = learn(&[&arguments[..], &["--json", "--force"]].concat());
        let report: Value = serde_json::from_slice(&output.stdout).unwrap();
        assert_eq!(report["monotone"]["holds"], code == 0);
    }
}

/// A map of 20 inputs has too many cells for any memory.
#[test]
fn rules_of_many_inputs_are_learned_without_a_map() {
    let folder = Folder::new();
    let names = |format: &dyn Fn(usize) -> String| (0..20).map(format).collect::<String>();
    let inputs = names(&|i| format!("  x{i}: {{range: [0, 1], partition: [low, high]}}\n"));
    let output = "outputs: {y: {range: [0, 1], partition: [low, high]}}\nrules: []\n";
    let model = format!("fuzzy: 1\nname: many\ninputs:\n{inputs}{output}");
    let mut rows = names(&|i| format!("x{i},")) + "y\n";
    for row in 0..50 {
        rows += &names(&|i| format!("{},", (row * 7 + i * 13) % 11 % 2));
        rows += &format!("{}\n", row % 2);
    }
    let (model, rows) = (
        folder.file("many.yaml", model),
        folder.file("rows.csv", rows),
    );
    let (text, json) = (folder.at("text.yaml"), folder.at("json.yaml"));
    let said = learn(&[&model, &rows, "--output", &text]);
    let said = String::from_utf8(said.stdout).unwrap();
    assert!(
        said.contains("coverage   not computed: too many inputs"),
        "{said}"
    );
    let said = learn(&[&model, &rows, "--json", "--output", &json]);
    let said: Value = serde_json::from_slice(&said.stdout).unwrap();
    assert!(
        said["coverage"].is_null() && said["rules"]["learned"].as_u64() > Some(0),
        "{said}"
    );
}

#[test]
fn an_error_over_no_rows_is_unknown() {
    let folder = Folder::new();
    let model = folder.file("model.yaml", VARIABLES);
    // One row gives one rule; without that rule, there is no other rule from which the gap could be filled.
    let data = folder.file("data.csv", "margin,spread,risk\n0.1,0.1,50\n");
    let out = folder.at("out.yaml");
    let output = learn(&[&model, &data, "-o", &out, "--compare-gaps", "--json"]);
    let report: Value = serde_json::from_slice(&output.stdout).unwrap();
    let gaps = &report["gap_methods"];
    assert_eq!(gaps["with_the_rule"]["rows"], 1);
    assert_eq!(gaps["methods"][0]["by_row"]["without_prediction"], 1);
    assert_eq!(gaps["methods"][0]["by_row"]["rmse"], Value::Null);
    assert_eq!(gaps["methods"][0]["by_rule_mean_absolute"], Value::Null);
    let output = learn(&[&model, &data, "-o", &out, "--compare-gaps", "--force"]);
    let text = String::from_utf8(output.stdout).unwrap();
    let nearest = text.lines().find(|line| line.contains("nearest")).unwrap();
    let figures: Vec<&str> = nearest.split_whitespace().skip(1).collect();
    assert_eq!(figures, ["NA"; 4], "{text}");
}

/// Rows of the fan that `flagred new` writes: its speed rises with heat and humidity.
fn fan_rows() -> String {
    let mut rows = String::from("temperature,humidity,fan\n");
    for i in 0..400 {
        let (temperature, humidity) = (
            f64::from(i % 20) * 40.0 / 19.0,
            f64::from(i / 20) * 100.0 / 19.0,
        );
        let fan = (temperature * 2.5 * (0.5 + humidity / 200.0)).min(100.0);
        rows += &format!("{temperature},{humidity},{fan}\n");
    }
    rows
}

/// The template's output has constants as terms. With each way to resolve conflicts, the learned rules are the same as
/// with triangles or singletons in place of the constants.
#[test]
fn rules_are_learned_for_the_constants_of_the_template() {
    let folder = Folder::new();
    let fan = folder.at("fan.yaml");
    let new = flagred().args(["new", "fan", "-o", &fan]).output().unwrap();
    assert!(new.status.success());
    let text = fs::read_to_string(&fan).unwrap();
    let constants = "slow: {constant: 0}\n      medium: {constant: 50}\n      fast: {constant: 100}\n    defuzzifier: weighted_average";
    assert!(text.contains(constants));
    let sets = "slow: {triangle: [-50, 0, 50]}\n      medium: {triangle: [0, 50, 100]}\n      fast: {triangle: [50, 100, 150]}\n    defuzzifier: centroid";
    let of_sets = folder.file("sets.yaml", text.replace(constants, sets));
    let singletons = "slow: {singleton: 0}\n      medium: {singleton: 50}\n      fast: {singleton: 100}\n    defuzzifier: centroid";
    let of_singletons = folder.file("singletons.yaml", text.replace(constants, singletons));
    let rows = folder.file("rows.csv", fan_rows());
    for resolve in ["strongest", "heaviest", "mean"] {
        for direction in [&[][..], &["--complete"]] {
            let learned = |model: &str| {
                let out = folder.at("learned.yaml");
                let mut arguments = vec![model, &rows, "-o", &out, "--force", "--resolve", resolve];
                arguments.extend(direction);
                let output = learn(&arguments);
                let reported = String::from_utf8_lossy(&output.stderr);
                assert_eq!(output.status.code(), Some(0), "{resolve}: {reported}");
                let text = fs::read_to_string(&out).unwrap();
                let model = fuzzy::yaml::parse(&text).unwrap().model;
                let rules = model.rules.iter().map(|rule| rule.rule.to_string());
                rules.collect::<Vec<String>>()
            };
            let rules = learned(&fan);
            assert_eq!(rules, learned(&of_sets), "{resolve} {direction:?}");
            assert_eq!(rules, learned(&of_singletons), "{resolve} {direction:?}");
            assert_eq!(rules.len(), 6);
            for (antecedent, fan) in [
                ("temperature IS cold AND humidity IS dry", "slow"),
                ("temperature IS mild AND humidity IS damp", "medium"),
                (
                    "temperature IS hot AND humidity IS damp",
                    // Of the two rows with the highest degree, `strongest` uses the one with the larger value. The mean is 70.
                    if resolve == "strongest" {
                        "fast"
                    } else {
                        "medium"
                    },
                ),
            ] {
                let rule = format!("IF {antecedent} THEN fan IS {fan}");
                assert!(rules.contains(&rule), "{resolve} {direction:?}: {rules:?}");
            }
        }
    }
}
