//! The commands for authors of rule sets, as a user runs them.
#![allow(clippy::unwrap_used, clippy::panic)]

use std::{
    fs,
    io::Write,
    path::Path,
    process::{Command, Output, Stdio},
};

fn flagred(arguments: &[&str], input: &str) -> (Output, String) {
    let mut child = Command::new(env!("CARGO_BIN_EXE_flagred"))
        .current_dir(Path::new(env!("CARGO_MANIFEST_DIR")).join("../../rules"))
        .args(arguments)
        .stdin(Stdio::piped())
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .unwrap();
    let mut stdin = child.stdin.take().unwrap();
    let input = input.to_owned();
    // Writes in another thread, since both processes would otherwise wait for each other. The write may fail, because a
    // command that ignores its input may already have ended.
    let writer = std::thread::spawn(move || drop(stdin.write_all(input.as_bytes())));
    let output = child.wait_with_output().unwrap();
    writer.join().unwrap();
    let text = String::from_utf8(output.stdout.clone()).unwrap();
    (output, text)
}

fn errors(output: &Output) -> String {
    String::from_utf8(output.stderr.clone()).unwrap()
}

#[test]
fn check_shows_the_gaps_of_the_papers_rules() {
    let (output, text) = flagred(&["check", "flagred-paper.yaml"], "");
    assert_eq!(output.status.code(), Some(0));
    insta::assert_snapshot!(text);
    let (output, _) = flagred(&["check", "flagred-paper.yaml", "--deny", "warnings"], "");
    assert_eq!(output.status.code(), Some(1));
}

#[test]
fn check_verifies_claims_about_outputs() {
    let claims = [
        "check",
        "flagred-paper.yaml",
        "--json",
        "--rising",
        "spread",
        "--falling",
        "margin",
    ];
    let (output, text) = flagred(&claims, "");
    assert_eq!(output.status.code(), Some(1));
    let json: serde_json::Value = serde_json::from_str(&text).unwrap();
    assert_eq!(json["schema"], "flagred.check/1");
    let worst = &json["report"]["counterexamples"][0];
    assert_eq!(worst["claim"]["input"], "spread");
    assert_eq!(worst["at"][0]["value"], 0.2);
    assert_eq!(
        (&worst["from_value"], &worst["to"]),
        (&25.0.into(), &0.2.into())
    );
    let box_ = &json["report"]["uncovered"][1];
    assert_eq!(box_["sides"][0]["high"], 0.15);
    assert_eq!(box_["sides"][1]["high"], 0.05);

    let (output, _) = flagred(&["check", "flagred-paper.yaml", "--rising", "wind"], "");
    assert_eq!(output.status.code(), Some(2));
    assert!(errors(&output).contains("choose one of `margin` and `spread`"));

    let (output, _) = flagred(&["check", "tipper.yaml", "--rising", "food"], "");
    assert_eq!(output.status.code(), Some(0));
    let (output, _) = flagred(&["check", "flagred", "--falling", "margin"], "");
    assert_eq!(output.status.code(), Some(2));
    assert!(errors(&output).contains("`--falling` needs a rule set, but `flagred` is a profile"));
}

#[test]
fn check_reads_standard_input_and_reports_unreadable_files() {
    let (output, text) = flagred(&["check", "-"], "fuzzy: 9\n");
    assert_eq!(output.status.code(), Some(1));
    assert!(text.contains("--> -:1:8"), "{text}");
    let (output, _) = flagred(&["check", "no-such-file.yaml"], "");
    assert_eq!(output.status.code(), Some(3));
    let (output, _) = flagred(&["check"], "");
    assert_eq!(output.status.code(), Some(2));
}

#[test]
fn utf_16_is_read_and_latin_1_is_reported() {
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join("encodings");
    fs::create_dir_all(&folder).unwrap();
    let text = fs::read_to_string(
        Path::new(env!("CARGO_MANIFEST_DIR")).join("../../rules/flagred-paper.yaml"),
    )
    .unwrap();
    let file = folder.join("rules.yaml");
    let check = |bytes: &[u8]| {
        fs::write(&file, bytes).unwrap();
        let (output, text) = flagred(&["check", file.to_str().unwrap()], "");
        (output.status.code(), text + &errors(&output))
    };
    let as_utf_8 = check(text.as_bytes());
    let units = || std::iter::once(0xfeff).chain(text.encode_utf16());
    let little: Vec<u8> = units().flat_map(u16::to_le_bytes).collect();
    let big: Vec<u8> = units().flat_map(u16::to_be_bytes).collect();
    assert_eq!(check(&little), as_utf_8);
    assert_eq!(check(&big), as_utf_8);
    assert_eq!(check(format!("\u{feff}{text}").as_bytes()).0, Some(0));
    let (code, said) = check(b"fuzzy: 1\nname: k\xfche\n");
    assert_eq!(code, Some(3));
    assert!(said.contains("line 2 contains the byte FC"), "{said}");
    assert!(
        said.contains("Latin-1, where the byte is `\u{fc}`"),
        "{said}"
    );
    assert!(check(b"\xff\xfea").1.contains("is not valid UTF-16"));
}

#[test]
fn explain_shows_why() {
    let (output, text) = flagred(
        &[
            "explain",
            "flagred-paper.yaml",
            "margin=0.13",
            "spread=0.12",
        ],
        "",
    );
    assert_eq!(output.status.code(), Some(0));
    insta::assert_snapshot!(text);
    let (_, text) = flagred(
        &["explain", "flagred-paper.yaml", "spread=-1", "margin=0"],
        "",
    );
    insta::assert_snapshot!("explain_where_no_rule_fires", text);
    let (_, text) = flagred(
        &[
            "explain",
            "flagred-paper.yaml",
            "margin=0.13",
            "spread=0.12",
            "--json",
        ],
        "",
    );
    let json: serde_json::Value = serde_json::from_str(&text).unwrap();
    assert_eq!(json["schema"], "flagred.explain/1");
    assert_eq!(json["inputs"][0]["terms"][1]["term"], "low");
    assert!(json["outputs"][0]["value"].as_f64().unwrap() > 40.0);
}

#[test]
fn explain_draws_terms_rules_and_the_aggregated_set() {
    let picture = [
        "explain",
        "flagred-paper.yaml",
        "margin=0.13",
        "spread=9",
        "--svg",
    ];
    let (output, text) = flagred(&[&picture[..], &["-"]].concat(), "");
    assert_eq!(output.status.code(), Some(0), "{}", errors(&output));
    for said in [
        "margin = 0.13<",
        "spread = 9, outside the range, used as 0.5<",
        ">low 0.7<",
        ">medium 0.511<",
        "7: IF margin IS low AND spread IS high THEN risk IS very_high",
    ] {
        assert!(text.contains(said), "no `{said}` in {text}");
    }
    let (output, _) = flagred(&[&picture[..], &["fan.png"]].concat(), "");
    assert_eq!(output.status.code(), Some(2));
    assert!(
        errors(&output).contains("write `fan.svg`"),
        "{}",
        errors(&output)
    );
}

#[test]
fn explain_draws_the_number_of_each_rule_of_a_sugeno_output() {
    let point = ["temperature=24", "humidity=55"];
    let model = "../crates/authoring/src/starter.yaml";
    let (_, text) = flagred(&[&["explain", model][..], &point].concat(), "");
    assert!(text.contains("0.40000   25 %         100  4: IF"), "{text}");
    let (_, svg) = flagred(
        &[&["explain", model, "--svg", "-"][..], &point].concat(),
        "",
    );
    for rule in ["rule 2: 50<", "rule 4: 100<", "rule 1: 0<"] {
        assert!(svg.contains(rule), "no `{rule}` in {svg}");
    }
}

#[test]
fn plot_draws_the_terms_and_the_curve_of_one_input() {
    let heater = "fuzzy: 1\nname: heater\n\
        inputs: {room: {range: [0, 30], unit: °C, partition: {cold: 10, mild: 18, warm: 24}}}\n\
        outputs: {power: {range: [0, 100], unit: \"%\", partition: [none, half, full]}}\n\
        rules: [IF room IS cold THEN power IS full, IF room IS mild THEN power IS half, \
        IF room IS warm THEN power IS none]\n";
    let (output, text) = flagred(&["plot", "-"], heater);
    assert_eq!(output.status.code(), Some(0), "{}", errors(&output));
    insta::assert_snapshot!(text);
    let (_, svg) = flagred(&["plot", "-", "--svg", "-"], heater);
    assert!(
        svg.contains("room [°C]<") && svg.contains("power [%] over room [°C]<"),
        "{svg}"
    );
    // There is no curve for several inputs.
    let (_, text) = flagred(&["plot", "tipper.yaml"], "");
    assert!(
        text.contains("service") && !text.contains(" over "),
        "{text}"
    );
    let (output, _) = flagred(&["plot", "tipper.yaml", "--svg", "fan.png"], "");
    assert_eq!(output.status.code(), Some(2));
}

#[test]
fn explain_names_missing_inputs() {
    for (arguments, said) in [
        (&["margin=0.1"][..], "input `spread` has no value"),
        (&["margin=0.1", "sprad=0.1"], "did you mean `spread`?"),
        (
            &["margin=0.1", "margin=0.2", "spread=0"],
            "`margin` is given twice",
        ),
        (
            &["margin=much", "spread=0"],
            "the value of `margin` is not a finite number: `much`",
        ),
        (&["margin"], "write `margin=VALUE spread=VALUE`"),
    ] {
        let all: Vec<&str> = ["explain", "flagred-paper.yaml"]
            .iter()
            .chain(arguments)
            .copied()
            .collect();
        let (output, _) = flagred(&all, "");
        assert_eq!(output.status.code(), Some(2), "{arguments:?}");
        assert!(
            errors(&output).contains(said),
            "{arguments:?}: {}",
            errors(&output)
        );
    }
}

#[test]
fn eval_adds_the_outputs_with_all_digits() {
    let points = "id,spread,margin\na,0.12,0.13\nb,0.12,0.05\n";
    let (output, text) = flagred(&["eval", "flagred-paper.yaml"], points);
    assert_eq!(output.status.code(), Some(0), "{}", errors(&output));
    assert_eq!(errors(&output), "");
    let text_model = fs::read_to_string(
        Path::new(env!("CARGO_MANIFEST_DIR")).join("../../rules/flagred-paper.yaml"),
    );
    let model = fuzzy::yaml::parse(&text_model.unwrap()).unwrap().model;
    let engine = fuzzy::Engine::new(&model).unwrap();
    let rows: Vec<Vec<&str>> = text.lines().map(|line| line.split(',').collect()).collect();
    assert_eq!(rows[0], ["id", "spread", "margin", "risk"]);
    let value = |margin: f64, spread: f64| engine.evaluate(&[margin, spread]).unwrap()[0].value();
    assert_eq!(rows[1][3].parse().ok(), value(0.13, 0.12));
    assert_eq!(rows[2][3].parse().ok(), value(0.05, 0.12));
}

/// Every row has an output row, even if it is invalid.
#[test]
fn eval_explains_the_value_of_each_row() {
    let points = "id,spread,margin\na,0.12,0.13\nb,0,0\nc,NA,0.1\nd,9,-0.05\ne,wide,inf\nf,0.1\ng,,nan\n\
        \"#h\",0.1,\"0,1\"\ni,0,0,0\n";
    let with = [
        "eval",
        "flagred-paper.yaml",
        "--with",
        "coverage,rule,clamped,error",
    ];
    let (output, text) = flagred(&with, points);
    assert_eq!(output.status.code(), Some(1));
    insta::assert_snapshot!(text + "\n" + &errors(&output));

    let (output, text) = flagred(&["eval", "flagred-paper.yaml", "--skip-bad-rows"], points);
    // Bad rows are skipped as requested; some other rows still have no value.
    assert_eq!(output.status.code(), Some(1));
    assert_eq!(text.lines().count(), 6, "{text}");
    assert!(
        errors(&output).contains("left out 4 of 9 rows"),
        "{}",
        errors(&output)
    );
    let (output, text) = flagred(
        &["eval", "flagred-paper.yaml", "--skip-bad-rows"],
        "margin,spread\nx,1\n0.1,0.1\n",
    );
    assert_eq!((output.status.code(), text.lines().count()), (Some(0), 2));
}

#[test]
fn eval_names_columns_by_output_and_continues_where_no_rule_fires() {
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join("eval");
    fs::create_dir_all(&folder).unwrap();
    let model = folder.join("two.yaml");
    fs::write(
        &model,
        "fuzzy: 1\nname: two\ninputs: {heat: {range: [0, 40], terms: {high: {right_shoulder: [20, 30]}}}}\n\
         outputs:\n  fan: {range: [0, 9], partition: [slow, fast], when_no_rule_fires: error}\n  \
         alarm: {range: [0, 1], partition: [no, yes], when_no_rule_fires: {value: 0.5}}\n\
         rules: [IF heat IS high THEN fan IS fast, IF heat IS high THEN alarm IS yes]\n",
    )
    .unwrap();
    let model = model.to_str().unwrap();
    let with = [
        "eval",
        model,
        "--with",
        "rule,error",
        "--delimiter",
        "tab",
        "--column",
        "heat=t",
    ];
    let (output, text) = flagred(&with, "t\tname\n25\ta\n10\tb\n");
    assert_eq!(output.status.code(), Some(1), "{}", errors(&output));
    assert_eq!(
        text,
        "t\tname\tfan\talarm\tfan_dominant_rule\talarm_dominant_rule\terror\n\
         25\ta\t5.5\t0.6111111111111112\t1\t2\t\n\
         10\tb\t\t0.5\t\t\tno rule fires for `fan`\n"
    );
    assert_eq!(
        errors(&output),
        "`fan` has no value in 1 of 2 rows: no rule fires (first in line 3)\n"
    );
    let (output, _) = flagred(&["eval", model, "--with", "error"], "heat,error\n25,x\n");
    assert_eq!(output.status.code(), Some(2));
    assert!(errors(&output).contains("a column `error` already"));
}

#[test]
fn eval_writes_a_complete_file_or_none() {
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join("eval-file");
    let _ = fs::remove_dir_all(&folder);
    fs::create_dir_all(&folder).unwrap();
    let file = folder.join("out.csv");
    let out = file.to_str().unwrap();
    let eval = ["eval", "flagred-paper.yaml", "-", "-o", out];
    let (output, text) = flagred(&eval, "margin,spread\n0.1,0.1\n");
    assert_eq!((output.status.code(), text.as_str()), (Some(0), ""));
    assert_eq!(
        fs::read_to_string(&file).unwrap(),
        "margin,spread,risk\n0.1,0.1,50\n"
    );
    // A folder can be opened but not read.
    let (output, _) = flagred(&["eval", "flagred-paper.yaml", ".", "-o", out], "");
    assert_eq!(output.status.code(), Some(3), "{}", errors(&output));
    assert!(fs::read_to_string(&file).unwrap().starts_with("margin"));
    assert_eq!(fs::read_dir(&folder).unwrap().count(), 1);
}

#[test]
fn eval_keeps_the_order_of_rows_across_blocks_and_threads() {
    let mut points = String::from("margin,spread\n");
    for i in 0..40_000 {
        points += &format!(
            "{},{}\n",
            f64::from(i % 997) / 1994.0,
            f64::from(i % 613) / 1226.0
        );
    }
    let (_, text) = flagred(&["eval", "flagred-paper.yaml"], &points);
    assert_eq!(text.lines().count(), 40_001);
    for (given, got) in points.lines().zip(text.lines()) {
        assert!(got.starts_with(given), "{given}: {got}");
    }
}

#[test]
fn eval_reports_mistakes_in_points() {
    for (points, code, said) in [
        ("", 3, "is empty"),
        ("margin\n0.1\n", 3, "has no column `spread`"),
        ("margin,spraed\n0.1,0.1\n", 3, "did you mean `spraed`?"),
        ("margin;spread\n1;1\n", 3, "`--delimiter ';'`"),
        (
            "margin,spread,spread\n1,1,1\n",
            3,
            "the column `spread` more than once",
        ),
        ("margin,spread,risk\n1,1,1\n", 2, "a column `risk` already"),
    ] {
        let (output, _) = flagred(&["eval", "flagred-paper.yaml"], points);
        assert_eq!(output.status.code(), Some(code), "{points}");
        assert!(
            errors(&output).contains(said),
            "{points}: {}",
            errors(&output)
        );
    }
}

#[test]
fn new_writes_a_rule_set_that_passes_check() {
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join("new");
    let _ = fs::remove_dir_all(&folder);
    fs::create_dir_all(&folder).unwrap();
    let file = folder.join("my.yaml");
    let file = file.to_str().unwrap();
    let (output, text) = flagred(&["new", "fan-control", "--output", file], "");
    assert_eq!(output.status.code(), Some(0), "{}", errors(&output));
    assert!(text.contains("flagred check"));
    assert!(
        fs::read_to_string(file)
            .unwrap()
            .contains("name: fan-control")
    );
    let (output, text) = flagred(&["check", file, "--deny", "notes"], "");
    assert_eq!(output.status.code(), Some(0), "{text}");
    let template = fs::read_to_string(file).unwrap();
    for shown in ["OR (", "NOT", "very", "WITH", "note:"] {
        assert!(template.contains(shown), "no {shown}");
    }
    let (output, _) = flagred(&["explain", file, "temperature=24", "humidity=70"], "");
    assert_eq!(output.status.code(), Some(0));
    // An existing file is not overwritten.
    let (output, _) = flagred(&["new", "fan-control", "--output", file], "");
    assert_eq!(output.status.code(), Some(2));
    let (output, _) = flagred(&["new", "../evil"], "");
    assert_eq!(output.status.code(), Some(2));
}

#[test]
fn a_new_profile_is_the_default_one_under_another_name() {
    let (output, profile) = flagred(
        &["new", "mine", "--profile", "flagred", "--output", "-"],
        "",
    );
    assert_eq!(output.status.code(), Some(0), "{}", errors(&output));
    let (_, shipped) = flagred(&["show", "flagred"], "");
    assert!(profile.contains("name: mine\n") && profile.contains("rules: flagred "));
    let lines = shipped.lines().filter(|line| !line.starts_with("name:"));
    assert!(lines.clone().count() > 20);
    for line in lines {
        assert!(profile.lines().any(|own| own == line), "{line}");
    }
    // The verdicts are the same as with the default profile.
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("mine.yaml");
    fs::write(&path, &profile).unwrap();
    let flight = "../examples/flights/steady.BIN";
    let by = |name: &str| flagred(&["assess", flight, "--json", "--profile", name], "").1;
    let risks = |text: &str| {
        let json: serde_json::Value = serde_json::from_str(text).unwrap();
        (json["verdict"].clone(), json["summary"].clone())
    };
    assert_eq!(risks(&by(path.to_str().unwrap())), risks(&by("flagred")));

    let from = ["new", "mine", "--profile", "flagred-paper", "--output", "-"];
    let (_, paper) = flagred(&from, "");
    assert!(paper.contains("rules: flagred-paper "));
    let (_, rules) = flagred(&["new", "mine", "--from", "flagred", "--output", "-"], "");
    let (_, shown) = flagred(&["show", "flagred", "--rules"], "");
    assert_eq!(rules, shown.replace("\nname: flagred\n", "\nname: mine\n"));
    let (output, _) = flagred(&["new", "mine", "--from", "paper"], "");
    assert_eq!(output.status.code(), Some(2));
    assert!(errors(&output).contains("flagred-paper"));
}

#[test]
fn commands_accept_built_in_names() {
    let folder = tempfile::tempdir().unwrap();
    let points = folder.path().join("points.csv");
    fs::write(&points, "margin,spread\n0.1,0.2\n").unwrap();
    let points = points.to_str().unwrap();
    for name in ["flagred", "flagred-paper"] {
        for arguments in [
            &["show", name][..],
            &["show", name, "--rules"],
            &["check", name],
            &["map", name],
            &["plot", name],
            &["export", "--fll", name],
            &["export", "--fcl", name],
            &["export", "--c", name],
            &["export", "--rust", name],
        ] {
            let (output, text) = flagred(arguments, "");
            assert_eq!(
                output.status.code(),
                Some(0),
                "{arguments:?}: {}",
                errors(&output)
            );
            assert!(!text.is_empty(), "{arguments:?}");
        }
    }
    // The default rule set can be exported to each format that supports it.
    assert_eq!(
        flagred(&["export", "--fll"], "").1,
        flagred(&["export", "--fll", "flagred"], "").1
    );
    let paper = "../rules/flagred-paper.yaml";
    for (built_in, file) in [
        (
            &["eval", "flagred-paper", points][..],
            &["eval", paper, points][..],
        ),
        (
            &["explain", "flagred-paper", "margin=0.1", "spread=0.2"],
            &["explain", paper, "margin=0.1", "spread=0.2"],
        ),
        (&["plot", "flagred-paper"], &["plot", paper]),
    ] {
        let (output, text) = flagred(built_in, "");
        assert_eq!(output.status.code(), Some(0), "{}", errors(&output));
        assert_eq!(text, flagred(file, "").1);
    }
}

#[test]
fn a_built_in_name_takes_precedence_over_a_file_unless_a_path_is_given() {
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join("flagred"), "fuzzy: 1\nname: mine\n").unwrap();
    let run = |name: &str| {
        let mut command = Command::new(env!("CARGO_BIN_EXE_flagred"));
        let command = command.current_dir(folder.path()).args(["plot", name]);
        command.output().unwrap().status.code()
    };
    assert_eq!((run("flagred"), run("./flagred")), (Some(0), Some(3)));
}

#[test]
fn commands_that_change_files_explain_how_to_copy_built_in_ones() {
    for arguments in [
        &["fmt", "flagred"][..],
        &["fmt", "--check", "flagred"],
        &["studio", "flagred"],
    ] {
        let (output, _) = flagred(arguments, "");
        let reported = errors(&output);
        assert_eq!(output.status.code(), Some(3), "{reported}");
        assert!(
            reported.contains(
                "`flagred new NAME --from flagred` writes a copy of the rule set to edit"
            ),
            "{reported}"
        );
    }
}

#[test]
fn fmt_refuses_files_of_other_programs() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("compose.yaml");
    let file = path.to_str().unwrap();
    for (text, said) in [
        (
            "services:\n    web:   {image: nginx}\n",
            "is neither a rule set nor a profile",
        ),
        ("fuzzy: hello\n", "is neither a rule set nor a profile"),
        ("fuzzy: 1\nname: [a\n", "error[yaml-syntax]"),
    ] {
        fs::write(&path, text).unwrap();
        for arguments in [&["fmt", file][..], &["fmt", "--check", file]] {
            let (output, shown) = flagred(arguments, "");
            assert_eq!(
                (output.status.code(), shown.as_str()),
                (Some(3), ""),
                "{text}"
            );
            let reported = errors(&output);
            assert!(
                reported.contains(said) && !reported.contains("\\u{a}"),
                "{reported}"
            );
        }
        assert_eq!(fs::read_to_string(&path).unwrap(), text);
    }
}

#[test]
fn a_target_is_not_an_input() {
    let arguments = [
        "identify", "-", "--target", "x", "--input", "x", "--output", "-",
    ];
    let (output, _) = flagred(&arguments, "x,y\n1,2\n2,3\n");
    assert_eq!(output.status.code(), Some(2));
    let reported = errors(&output);
    assert!(
        reported.contains("`x` is both the target and an input"),
        "{reported}"
    );
    assert!(!reported.contains("\\u{a}"), "{reported}");
}
