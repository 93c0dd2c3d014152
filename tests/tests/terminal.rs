//! Text from outside is visible on a terminal, and cannot control it.

use std::fs;

use flagred_tests::{
    Folder, flagred,
    writing::{RULES, wild_flight},
};

/// Sets the window title, clears the screen, changes colour and writing direction.
const HOSTILE: &str = "x\u{1b}]0;owned\u{7}\u{1b}[2J\u{9b}31m\u{202e}y";

/// Whether an output contains no control characters except line ends and tabs.
fn is_harmless(text: &str) -> bool {
    let acts =
        |c: char| c.is_control() && c != '\n' && c != '\t' || matches!(c, '\u{202a}'..='\u{202e}');
    !text.contains(acts)
}

/// The output of a command on both streams.
fn said(arguments: &[&str]) -> String {
    let output = flagred().args(arguments).output().unwrap();
    let both = [output.stdout, output.stderr].concat();
    String::from_utf8(both).unwrap()
}

#[test]
fn nothing_from_outside_acts_on_a_terminal() {
    let folder = Folder::new();
    let head = format!(
        "# vehicle: {HOSTILE}\n# vehicle_id: {HOSTILE}\n# firmware: {HOSTILE}\n# kind: {HOSTILE}\n# note: {HOSTILE}\n"
    );
    let log = &folder.file(&format!("{HOSTILE}\nGOOD.csv"), head + &wild_flight(40));
    let missing = &folder.at(&format!("{HOSTILE}.BIN"));
    let rules = fs::read_to_string(RULES).unwrap();
    let hostile = r#""x\e[2J\u202e\ny""#;
    let rules = rules.replace("name: flagred-paper", &format!("name: {hostile}"));
    let rules = rules.replace("unit: '%'", &format!("unit: {hostile}"));
    assert!(rules.contains(hostile));
    let rules = &folder.file("rules.yaml", rules);
    let faulty = &folder.file(
        "faulty.yaml",
        format!("fuzzy: 1\nname: {hostile}\n{hostile}: 1\ninputs: {{{hostile}: 3}}\n# \u{202e}\n"),
    );
    let rows = &folder.file(
        "rows.csv",
        format!("margin,spread,risk,vehicle\n{HOSTILE},0.1,50,{HOSTILE}\n"),
    );
    let table = &folder.file("table.csv", format!("att_rmse_deg,margin,spread,vehicle,kind\n1,0.3,0.05,{HOSTILE},{HOSTILE}\n9,0.02,0.2,b,c\n"));
    let out = &folder.at("out.yaml");
    let values = ["margin=0.1", "spread=0.1"];
    for (arguments, names_it) in [
        (vec!["assess", log], true),
        (vec!["assess", "-v", log, log], true),
        (vec!["assess", "--csv", log, log], true),
        (vec!["assess", missing], true),
        (vec!["assess", log, "--profile", missing], true),
        (vec!["inspect", log], true),
        (vec!["convert", log, "-o", "-"], true),
        (vec!["dataset", log], true),
        (vec!["validate", log], true),
        (vec!["validate", "--rows", table], true),
        (vec!["check", rules], false),
        (vec!["check", faulty], true),
        (vec!["check", faulty, "--format", "github"], true),
        (vec!["check", missing], true),
        (vec!["explain", rules, values[0], values[1]], true),
        (vec!["explain", rules, HOSTILE], true),
        (vec!["map", rules], true),
        (vec!["map", rules, "--activations"], true),
        (vec!["map", rules, "--x", HOSTILE], true),
        (vec!["learn", rules, rows, "-o", out], true),
        (vec!["new", HOSTILE], true),
        (vec![HOSTILE], true),
        (vec!["watch", HOSTILE], true),
        (vec!["studio", missing], true),
        (vec!["assess", log, "--html", "-"], true),
        (vec!["assess", log, "--svg", "-"], true),
        (vec!["map", rules, "--svg", "-"], true),
    ] {
        let said = said(&arguments);
        assert!(is_harmless(&said), "{arguments:?}: {said:?}");
        assert_eq!(
            said.contains("\\u{202e}"),
            names_it,
            "{arguments:?}: {said}"
        );
        // A document may have line breaks within its markup.
        let is_words = !arguments.contains(&"-") || arguments[0] == "convert";
        let forged = is_words && said.lines().any(|line| line.starts_with("GOOD"));
        assert!(!forged, "{arguments:?}: {said}");
    }
}

/// Spreadsheets evaluate cells that begin with `=`, `+`, `-` or `@` as formulas.
#[test]
fn no_cell_of_a_table_is_a_formula() {
    let folder = Folder::new();
    let formula = "=HYPERLINK(0)";
    let log = format!(
        "# vehicle: {formula}\n# kind: @SUM(A1)\n# note: a,{formula};-1,-2.5\n{}",
        wild_flight(40)
    );
    let log = &folder.file(
        "log.csv",
        log.replace("in_air", "in_air,+signal")
            .replace(",1\n", ",1,-3\n")
            .replace(",0\n", ",0,-3\n"),
    );
    let table = &folder.file(
        "table.csv",
        format!("att_rmse_deg,margin_mean,c_mean,c_std,vehicle,kind\n1,0.3,0.5,0.05,{formula},@SUM(A1)\n"),
    );
    for (arguments, expected) in [
        (
            vec!["convert", log, "-o", "-"],
            "# note: a,'=HYPERLINK(0);-1,-2.5\n",
        ),
        (vec!["convert", log, "-o", "-"], ",'+signal\n"),
        (vec!["dataset", table], ",'=HYPERLINK(0),'@SUM(A1),"),
    ] {
        let said = said(&arguments);
        assert!(
            said.contains(expected),
            "{arguments:?}: {}",
            &said[..said.len().min(600)]
        );
        let cells = said.split(['\n', ',']);
        let formulas = cells.filter(|cell| cell.starts_with(['=', '+', '-', '@']));
        let texts: Vec<&str> = formulas
            .filter(|cell| cell.parse::<f64>().is_err())
            .collect();
        assert_eq!(texts, [""; 0], "{arguments:?}");
    }
}
