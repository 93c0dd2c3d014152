//! Decision maps: a picture of every rule set in `rules/`, and `flagred map` from a user's point of view.

use std::fs;

use flagred_tests::flagred;
use fuzzy::{
    Engine, drawing,
    map::{DecisionMap, Grid},
};

const PAPER: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/../rules/flagred-paper.yaml");
/// The paper's profile, which interpolates where no rule fires.
const PROFILE: &str = concat!(
    env!("CARGO_MANIFEST_DIR"),
    "/../rules/profiles/flagred-paper.yaml"
);
const FLAGRED: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/../rules/flagred.yaml");

/// A changed decision of a rule set changes its picture, which must then be reviewed.
#[test]
fn a_picture_of_every_rule_set() {
    insta::glob!("../../rules", "*.yaml", |path| {
        let model = fuzzy::yaml::parse(&fs::read_to_string(path).unwrap())
            .unwrap()
            .model;
        let engine = Engine::new(&model).unwrap();
        // A picture has two axes; the other inputs are fixed.
        // The default rules vary most near the lower ends of their inputs.
        let (points, held): (usize, &[(&str, f64)]) = match model.name.as_str() {
            "flagred" | "flagred-battery" => (
                201,
                &[
                    ("at_limit", 0.0),
                    ("throttle_activity", 0.25),
                    ("swing_per_room", 0.3),
                    ("battery", 50.0),
                ],
            ),
            _ => (51, &[]),
        };
        let mut grid = Grid::new(&engine, 2).unwrap();
        let is_input = |name: &str| model.inputs.iter().any(|input| input.name == name);
        for (name, value) in held.iter().filter(|(name, _)| is_input(name)) {
            grid = grid.fix(name, *value).unwrap();
        }
        for input in &model.inputs {
            if !held.iter().any(|(name, _)| *name == input.name) {
                grid = grid.points(&input.name, points).unwrap();
            }
        }
        let map = DecisionMap::new(&engine, grid, 0).unwrap();
        let slice = drawing::Slice::new(&model, &map).unwrap();
        let text = drawing::map_text(&slice, |cell, _| cell.to_string());
        insta::assert_snapshot!(text + &drawing::values_text(&slice, 6));
    });
}

fn map(arguments: &[&str]) -> (Option<i32>, String, String) {
    let output = flagred().arg("map").args(arguments).output().unwrap();
    (
        output.status.code(),
        String::from_utf8(output.stdout).unwrap(),
        String::from_utf8(output.stderr).unwrap(),
    )
}

#[test]
fn a_map_in_the_terminal_marks_filled_cells() {
    let (code, text, _) = map(&[PROFILE]);
    assert_eq!(code, Some(0));
    insta::assert_snapshot!(text);
    let (_, same, _) = map(&[PAPER, "--fill", "thin_plate"]);
    assert_eq!(same, text);
}

/// If the other inputs were fixed in the middle of their ranges, every motor would be at a limit, and the picture would show
/// only danger.
#[test]
fn the_default_picture_is_that_of_the_default_rule_set() {
    let (code, text, notes) = map(&[FLAGRED, "--points", "26"]);
    assert_eq!(code, Some(0));
    insta::assert_snapshot!(format!("{text}\n{notes}"));

    // Explicitly chosen points need no note.
    let requested = [
        "--hold=throttle_activity=0.008",
        "--hold=swing_per_room=0.03",
        "--hold=at_limit=0",
    ];
    let axes = ["--x=unsteady_now:0..0.049", "--y=unsteady_lately:0..0.057"];
    let (_, same, notes) = map(&[&[FLAGRED, "--points", "26"][..], &requested, &axes].concat());
    assert_eq!((same, notes.as_str()), (text, ""));
}

#[test]
fn the_rule_that_dominates_in_the_terminal() {
    let (code, text, _) = map(&[PAPER, "--activations", "--points", "26"]);
    assert_eq!(code, Some(0));
    insta::assert_snapshot!(text);
}

#[test]
fn a_table_of_all_cells() {
    let (code, text, _) = map(&[PROFILE, "--csv"]);
    assert_eq!(code, Some(0));
    let mut lines = text.lines();
    assert_eq!(
        lines.next(),
        Some("margin,spread,risk,coverage,dominant_rule,filled,distance")
    );
    let rows: Vec<Vec<f64>> = lines
        .map(|line| {
            line.split(',')
                .map(|cell| cell.parse().unwrap_or(f64::NAN))
                .collect()
        })
        .collect();
    assert_eq!(rows.len(), 51 * 51);
    // If the margin is below 0.15 and the spread below 0.05, no rule fires.
    assert_eq!(rows.iter().filter(|row| row[5] == 1.0).count(), 15 * 5);
    assert!(rows[0][2] >= 75.0 && rows[0][5] == 1.0 && rows[0][6] > 0.0);
    let at = |margin: f64, spread: f64| {
        let near =
            |row: &&Vec<f64>| (row[0] - margin).abs() < 1e-9 && (row[1] - spread).abs() < 1e-9;
        rows.iter().find(near).unwrap()[2]
    };
    approx::assert_abs_diff_eq!(at(0.1, 0.2), 91.7, epsilon = 0.05);
    assert!(at(0.02, 0.01) >= 75.0);

    let (code, text, _) = map(&[FLAGRED, "--csv", "--points", "5"]);
    assert_eq!((code, text.lines().count()), (Some(0), 1 + 5usize.pow(5)));
}

/// Without a profile, each cell of a map has the value of `flagred eval`, even where the rules
/// hardly fire.
#[test]
fn the_map_of_a_rule_set_agrees_with_eval() {
    let shown = map(&[PAPER, "--csv"]).1;
    let points: String = shown
        .lines()
        .map(|line| line.split(',').take(2).collect::<Vec<_>>().join(",") + "\n")
        .collect();
    let folder = flagred_tests::Folder::new();
    let points = folder.file("points.csv", points);
    let evaluated = flagred().args(["eval", PAPER, &points]).output().unwrap();
    let evaluated = String::from_utf8(evaluated.stdout).unwrap();
    let third = |line: &str| line.split(',').nth(2).unwrap().parse::<f64>().ok();
    let mut empty = 0;
    for (shown, evaluated) in shown.lines().zip(evaluated.lines()).skip(1) {
        let (shown, evaluated) = (third(shown), third(evaluated));
        match (shown, evaluated) {
            (Some(shown), Some(evaluated)) => {
                approx::assert_relative_eq!(shown, evaluated, max_relative = 1e-5);
            }
            _ => assert_eq!(shown, evaluated),
        }
        empty += usize::from(shown.is_none());
    }
    assert!((1..15 * 5).contains(&empty), "{empty} cells have no value");
    let rows = [FLAGRED, "--csv", "--points", "3", "--fill", "none"];
    assert_eq!(map(&rows).1.lines().count(), 1 + 3usize.pow(5));
}

#[test]
fn pictures_are_well_formed_and_complete() {
    let fixed = [
        "--hold=throttle_activity=0",
        "--hold=swing_per_room=0",
        "--hold=at_limit=0",
        "--x",
        "unsteady_now:0..0.08",
    ];
    for (arguments, expected) in [
        (
            vec![PROFILE],
            vec![
                "margin",
                "spread",
                "risk [%]",
                "interpolated where no rule applies (thin plate)",
                "60",
            ],
        ),
        (
            vec![PROFILE, "--surface"],
            vec![
                "margin",
                "spread",
                "risk [%]",
                "interpolated where no rule applies (thin plate)",
            ],
        ),
        (
            vec![PAPER, "--activations"],
            vec!["margin", "10: very_high", "8: medium"],
        ),
        (
            [&[FLAGRED][..], &fixed].concat(),
            vec![
                "unsteady_lately",
                "flagred: risk [%] at throttle_activity = 0, swing_per_room = 0, at_limit = 0",
            ],
        ),
        (
            vec![
                FLAGRED,
                "--hold=throttle_activity=0",
                "--hold=at_limit=0",
                "--hold=swing_per_room=0",
                "--hold=unsteady_now=0",
            ],
            vec!["unsteady_lately"],
        ),
    ] {
        let mut arguments = arguments.clone();
        arguments.extend(["--svg", "-"]);
        let (code, text, said) = map(&arguments);
        assert_eq!(code, Some(0), "{arguments:?}: {said}");
        let document = roxmltree::Document::parse(&text).unwrap();
        let texts: Vec<&str> = document
            .descendants()
            .filter_map(|node| node.text())
            .collect();
        for word in expected {
            assert!(
                texts.contains(&word),
                "{arguments:?}: `{word}` of {texts:?}"
            );
        }
        assert!(
            !text.contains("NaN") && !text.contains("inf"),
            "{arguments:?}"
        );
        assert!(text.len() < 300_000, "{arguments:?}: {}", text.len());
    }
}

#[test]
fn impossible_maps_are_refused() {
    for (arguments, expected) in [
        (vec![PAPER, "--hold", "wind=3"], "has no input `wind`"),
        (
            vec![PAPER, "--hold", "margin=3"],
            "cannot be fixed at 3: its range is 0 to 0.5",
        ),
        (
            vec![PAPER, "--x", "margin", "--y", "margin"],
            "the same input",
        ),
        (
            vec![PAPER, "--hold", "margin=0.1", "--hold", "spread=0.1"],
            "none is left for an axis",
        ),
        (vec![PAPER, "--of", "danger"], "has no output `danger`"),
        (
            vec![PAPER, "--x", "margin:3..1"],
            "write the low end first: `margin:1..3`",
        ),
        (vec![PAPER, "--svg", "map.png"], "write `map.svg`"),
        (
            vec![PAPER, "--hold", "margin=0.1", "--surface", "--svg", "-"],
            "needs two inputs",
        ),
    ] {
        let (code, _, said) = map(&arguments);
        assert_eq!(code, Some(2), "{arguments:?}: {said}");
        assert!(said.contains(expected), "{arguments:?}: {said}");
    }
}

/// A rule set of seven inputs with long names: five of them are fixed.
#[test]
fn long_headings_stay_within_the_picture() {
    let folder = flagred_tests::Folder::new();
    let inputs: String = (0..7)
        .map(|i| format!("  quantity_number_{i}: {{range: [0, 1], partition: [low, high]}}\n"))
        .collect();
    let conditions: Vec<String> = (0..7)
        .map(|i| format!("quantity_number_{i} IS low"))
        .collect();
    let condition = conditions.join(" AND ");
    let model = folder.file(
        "long.yaml",
        format!(
            "fuzzy: 1\nname: a-rule-set-with-a-name-that-is-longer-than-any-picture-of-it-is-wide\ninputs:\n{inputs}\
             outputs:\n  y: {{range: [0, 1], partition: [low, high]}}\n\
             rules:\n  - IF {condition} THEN y IS low\n"
        ),
    );
    let (code, text, _) = map(&[&model, "--svg", "-"]);
    assert_eq!(code, Some(0));
    let document = roxmltree::Document::parse(&text).unwrap();
    let number = |node: roxmltree::Node<'_, '_>, name: &str| -> f64 {
        node.attribute(name).unwrap().parse().unwrap()
    };
    let svg = document.root_element();
    let view: Vec<f64> = svg
        .attribute("viewBox")
        .unwrap()
        .split(' ')
        .map(|x| x.parse().unwrap())
        .collect();
    let mut held = 0;
    for node in document
        .descendants()
        .filter(|node| node.has_tag_name("text"))
    {
        if node.attribute("text-anchor") != Some("start") {
            continue;
        }
        let words = node.text().unwrap();
        held += words.matches("quantity_number_").count();
        let letter = if node.attribute("class") == Some("heading") {
            9.0
        } else {
            6.6
        };
        let right = number(node, "x") + letter * words.chars().count() as f64;
        assert!(right <= view[2], "{words}: {right}");
        assert!(number(node, "y") >= view[1] + 12.0, "{words}");
    }
    assert_eq!(held, 5, "every held input is named");
}

/// A rule set of three inputs and a chain: the intermediate output comes first.
const CHAIN: &str = "fuzzy: 1
name: fan
inputs:
  heat: {range: [0, 40], partition: [cool, warm, hot]}
  damp: {range: [0, 1], partition: [dry, wet]}
  noise: {range: [30, 60], steps: {quiet: 45, loud: }}
  spare: {range: [0, 1], partition: [no, yes]}
outputs:
  strain: {range: [0, 1], terms: {low: {triangle: [-1, 0, 1]}, high: {triangle: [0, 1, 2]}}}
  fan: {range: [0, 100], terms: {slow: {constant: 0}, fast: {constant: 100}}, defuzzifier: weighted_average}
rules:
  - IF heat IS cool OR damp IS dry THEN strain IS low
  - IF heat IS hot AND damp IS wet THEN strain IS high
  - IF strain IS low OR noise IS quiet THEN fan IS slow
  - IF strain IS high AND noise IS loud THEN fan IS fast
";

#[test]
fn map_values_prints_a_table_for_each_slice() {
    let folder = flagred_tests::Folder::new();
    let model = folder.file("chain.yaml", CHAIN);
    let (code, text, notes) = map(&[&model, "--values", "--points", "3"]);
    assert_eq!((code, notes.as_str()), (Some(0), ""));
    insta::assert_snapshot!(text);
    let (_, _, notes) = map(&[&model, "--points", "3"]);
    assert!(
        notes.contains("`noise` is fixed") && !notes.contains("spare"),
        "{notes}"
    );
    let (_, text, _) = map(&[PAPER, "--values", "--points", "26"]);
    let model: fuzzy::Model = fs::read_to_string(PAPER).unwrap().parse().unwrap();
    let engine = Engine::new(&model).unwrap();
    let map = DecisionMap::new(&engine, Grid::new(&engine, 26).unwrap(), 0).unwrap();
    let slice = drawing::Slice::new(&model, &map).unwrap();
    let picture = drawing::map_text(&slice, |cell, _| cell.to_string());
    assert_eq!(
        text,
        picture + &drawing::values_text(&slice, 26),
        "the library's text"
    );
}

#[test]
fn an_earlier_table_is_compared_with_the_current_outputs() {
    let folder = flagred_tests::Folder::new();
    let model = folder.file("chain.yaml", CHAIN);
    let changed = folder.file(
        "changed.yaml",
        CHAIN.replace("{constant: 100}", "{constant: 99.99}"),
    );
    for written in [
        vec!["--csv", "--points", "5"],
        vec!["--csv", "--sample", "200"],
        vec!["--csv", "--hold", "noise=50"],
    ] {
        let table = folder.file("map.csv", "");
        let arguments = [vec![model.as_str()], written.clone(), vec!["-o", &table]].concat();
        let (code, _, errors) = map(&arguments);
        assert_eq!(code, Some(0), "{errors}");
        let (code, reported, _) = map(&[&model, "--check", &table]);
        let (changed_code, change, errors) = map(&[&changed, "--check", &table]);
        if written.contains(&"--hold") {
            // Fixed inputs have no column.
            assert_eq!(changed_code, Some(3), "{change}");
            assert!(errors.contains("has no column `noise`"), "{errors}");
            continue;
        }
        assert_eq!(code, Some(0), "{reported}");
        assert!(reported.contains("`fan` is the same at"), "{reported}");
        assert_eq!(changed_code, Some(1), "{change}");
        assert!(
            change.contains("100 before, 99.99 now") || change.contains("`fan` differs at"),
            "{change}"
        );
    }
    let points = folder.file(
        "points.csv",
        "heat,damp,noise,spare\n40,1,60,0\n0,0,30,1\n40,NA,60,0\n",
    );
    let evaluated = flagred().args(["eval", &model, &points]).output().unwrap();
    let table = folder.file("evaluated.csv", evaluated.stdout);
    let (code, _, errors) = map(&[&model, "--check", &table]);
    assert_eq!(code, Some(3), "an unknown input is not a point: {errors}");
    let known = fs::read_to_string(&table)
        .unwrap()
        .replace("40,NA,60,0,,\n", "");
    let rows: Vec<&str> = known.lines().collect();
    let (kept, _) = rows[1].rsplit_once(',').unwrap();
    let table = folder.file("known.csv", format!("{}\n{kept},\n{}\n", rows[0], rows[2]));
    let (code, reported, _) = map(&[&model, "--check", &table]);
    assert_eq!(code, Some(1), "{reported}");
    insta::assert_snapshot!(reported.replace(folder.path().to_str().unwrap(), "FOLDER"));
}
