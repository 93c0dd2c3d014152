//! Mistakes with the names of commands and options.

use super::{
    FAN, assert_advice,
    common::{flagred, folder},
    files,
};

/// Each mistake: the command line, its exit code, and a part of its message.
const MISTAKES: &[(&str, i32, &str)] = &[
    ("fan.yaml", 2, "`flagred check fan.yaml`"),
    ("version", 2, "`flagred --version`"),
    ("man --folder fan.yaml", 2, "is a file, not a folder"),
    ("--versoin", 2, "'--version'"),
    ("analyze flight.csv", 2, "`flagred assess`"),
    ("train fan.yaml rows.csv", 2, "`flagred learn`"),
    ("format fan.yaml", 2, "`flagred fmt`"),
    ("run fan.yaml", 2, "`flagred explain`"),
    ("lint fan.yaml", 2, "`flagred check`"),
    (
        "report flight.csv",
        2,
        "`flagred assess FLIGHT --html report.html`",
    ),
    ("fleet logs", 2, "`python -m flagred.fleet`"),
    ("chek fan.yaml", 2, "did you mean `check`?"),
    (
        "evaluate fan.yaml rows.csv",
        2,
        "flagred eval fan.yaml rows.csv",
    ),
    (
        "-v check fan.yaml",
        2,
        "options are written after the command",
    ),
    ("lsp fan.yaml", 2, "an editor starts `lsp`"),
    ("completions", 2, "bash, elvish, fish, powershell"),
];

#[test]
fn each_mistake_has_its_advice() {
    assert_advice(&files(), MISTAKES);
}

#[test]
fn no_suggested_command_overwrites_a_file() {
    let folder = files();
    let commands = [
        "inspect", "check", "validate", "assess", "convert", "eval", "map", "plot", "explain",
        "export", "dataset", "identify", "fmt", "import", "show", "studio", "watch",
    ];
    let options = [
        "--csv",
        "--json",
        "--html",
        "--png",
        "--out",
        "-o",
        "--output",
        "--save",
        "--format",
        "--report",
        "--svg",
        "--pdf",
        "--write",
        "--outfile",
    ];
    for command in commands {
        for option in options {
            let words = [command, option, "fan.yaml"];
            let (_, _, errors) = flagred(folder.path(), &words);
            let tip = errors.lines().filter(|line| line.contains("tip:"));
            for tip in tip {
                let writes = ["> fan", "--output fan", "--svg fan", "--html fan"];
                assert!(
                    !writes.iter().any(|write| tip.contains(write)),
                    "{words:?}: {tip}"
                );
            }
            let text = std::fs::read_to_string(folder.path().join("fan.yaml")).unwrap();
            assert_eq!(text, FAN, "{words:?}");
        }
    }
}

#[test]
fn options_have_the_same_meaning_in_all_commands() {
    let folder = folder(&[
        ("fan.yaml", FAN),
        ("rows.csv", "temperature,humidity\n20,50\n"),
    ]);
    let run = |typed: &str| {
        let words: Vec<&str> = typed.split(' ').collect();
        flagred(folder.path(), &words)
    };
    // An option with a value does not consume the file after it.
    let (code, _, errors) = run("check --rising temperature fan.yaml");
    assert_eq!(code, Some(0), "{errors}");
    // An existing rule set is kept.
    let (code, fis, _) = run("export --fis fan.yaml");
    assert_eq!(code, Some(0));
    std::fs::write(folder.path().join("fan.fis"), fis).unwrap();
    let (code, _, errors) = run("import fan.fis -o fan.yaml");
    assert_eq!(code, Some(2));
    assert!(errors.contains("`--force`"), "{errors}");
    let (code, _, errors) = run("import fan.fis -o fan.yaml --force");
    assert_eq!(code, Some(0), "{errors}");
    let (code, help, _) = run("help --help");
    assert_eq!(code, Some(0));
    assert!(help.contains("Print this message"), "{help}");
    let (_, _, errors) = run("evaluate --rows rows.csv");
    assert!(
        errors.contains("`evaluate` is called `validate` now"),
        "{errors}"
    );
    let (code, out, _) = run("help");
    assert_eq!(code, Some(0));
    assert!(
        out.contains("  validate ") && !out.contains("  evaluate "),
        "{out}"
    );
}
