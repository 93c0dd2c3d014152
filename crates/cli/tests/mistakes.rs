//! Mistakes of newcomers, each with the advice for it.
#![allow(clippy::unwrap_used, reason = "tests")]

mod common;

use common::{flagred, folder};

const FAN: &str = "fuzzy: 1
name: fan
inputs:
  temperature: {range: [0, 40], partition: {cold: 10, mild: 20, hot: 30}}
  humidity: {range: [0, 100], partition: [dry, wet]}
outputs:
  fan: {range: [0, 100], terms: {slow: {constant: 0}, fast: {constant: 100}}, defuzzifier: weighted_average}
rules:
  - IF temperature IS NOT hot THEN fan IS slow
  - IF temperature IS hot AND humidity IS wet THEN fan IS fast
";

#[test]
fn the_advice_for_mistakes_works() {
    let folder = folder(&[
        ("fan.yaml", FAN),
        ("profile.yaml", "flagred: 1\nname: mine\n"),
        (
            "rows.csv",
            "temperature,humidity,fan\n20,50,0\n40,100,100\n35,90,100\n",
        ),
        ("header.csv", "temperature,humidity,fan\n"),
        ("numbers.csv", "24,70\n1,2\n"),
        ("semicolons.csv", "t_s;motor1\n0,5;0,5\n"),
        ("words.csv", "heat,kind\n1,good\n2,bad\n"),
        ("fan.m", "fis = mamfis('Name', 'fan');\n"),
        ("fan.py", "import skfuzzy\n"),
    ]);
    for (typed, code, expected) in [
        (
            "explain fan.yaml 24 70",
            2,
            "write `temperature=24 humidity=70`",
        ),
        (
            "explain fan.yaml temperature=24,5 humidity=3",
            2,
            "the decimal mark is a point: `24.5`",
        ),
        (
            "explain fan.yaml temperature=22% humidity=3",
            2,
            "write the number without its unit: `22`",
        ),
        (
            "explain fan.yaml temperature=22",
            2,
            "add `humidity=50`, the middle of its range",
        ),
        (
            "eval rows.csv fan.yaml",
            2,
            "flagred eval fan.yaml rows.csv",
        ),
        (
            "eval fan.yaml numbers.csv",
            3,
            "the first line holds numbers",
        ),
        (
            "learn fan.yaml header.csv -o out.yaml",
            3,
            "the lines below the header hold the rows",
        ),
        (
            "tune fan.yaml rows.csv --only temperature.hat -o out.yaml",
            2,
            "did you mean `temperature.hot`?",
        ),
        ("import fan.m", 3, "`writeFIS(fis, \"name\")`"),
        ("import fan.py", 3, "docs/from-scikit-fuzzy.md"),
        ("import fan.yaml", 3, "needs no import"),
        ("new foo.yaml", 2, "write `foo`"),
        ("new sub/foo", 2, "write `foo -o sub/foo`"),
        ("new mine --profile", 2, "flagred-battery"),
        ("assess fan.yaml", 3, "`flagred check` examines a rule set"),
        (
            "assess profile.yaml",
            3,
            "`flagred assess --profile PROFILE FLIGHT`",
        ),
        ("assess semicolons.csv", 3, "commas between its cells"),
        (
            "map fan.yaml -o map.svg",
            2,
            "for a picture write `--svg map.svg`",
        ),
        ("map fan.yaml --check fan.yaml", 3, "`fan.yaml`"),
        ("fan.yaml", 2, "`flagred check fan.yaml`"),
        (
            "explain fan.yaml temperature=nan humidity=3",
            2,
            "an unknown value leaves nothing to explain",
        ),
        (
            "explain fan.yaml temperature=1,000.5 humidity=3",
            2,
            "write the number without separators: `1000.5`",
        ),
        ("check .", 3, "`.` is a folder"),
        ("eval fan.yaml .", 3, "`.` is a folder"),
        (
            "learn fan.yaml rows.csv -o out.csv",
            2,
            "the file is YAML; write `out.yaml`",
        ),
        ("export --fis fan.yaml -o fan.fll", 2, "write `fan.fis`"),
        ("map fan.yaml --csv -o fan.yaml", 2, "write `fan.txt`"),
        (
            "map fan.yaml --coverage-below 0.2",
            2,
            "choose one with `--fill`",
        ),
        (
            "learn fan.yaml rows.csv -o out.yaml --min-support 9",
            2,
            "lower `--min-support`",
        ),
        (
            "learn fan.yaml rows.csv -o out.yaml --rising temperature --falling temperature",
            2,
            "with `--rising` and with `--falling`",
        ),
        (
            "learn fan.yaml rows.csv -o out.yaml --rising temperature:humidity",
            2,
            "name `fan`, or the input alone",
        ),
        (
            "tune fan.yaml rows.csv -o out.yaml --loss log",
            3,
            "`--loss squared`",
        ),
        (
            "identify words.csv --target kind -o out.yaml",
            3,
            "for two classes write 0 and 1",
        ),
    ] {
        let words: Vec<&str> = typed.split(' ').collect();
        let (exit, _, errors) = flagred(folder.path(), &words);
        assert_eq!(exit, Some(code), "{typed}: {errors}");
        assert!(errors.contains(expected), "{typed}: {errors}");
    }
}

#[test]
fn options_mean_the_same_everywhere() {
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

#[test]
fn a_table_is_explained_row_by_row() {
    let folder = folder(&[
        ("fan.yaml", FAN),
        (
            "rows.csv",
            "id,temperature,humidity\na,26,80\nb,NA,3\nc,40,100\n",
        ),
    ]);
    let (code, table, errors) =
        flagred(folder.path(), &["explain", "fan.yaml", "--csv", "rows.csv"]);
    assert_eq!(code, Some(0), "{errors}");
    assert_eq!(
        table,
        "id,temperature,humidity,fan,fan_rule,fan_shares\n\
         a,26,80,60,2,2=0.6|1=0.4\n\
         b,NA,3,,,\n\
         c,40,100,100,2,2=1\n"
    );
}

#[test]
fn rules_that_do_not_fire_and_the_next_changes_are_explained() {
    let folder = folder(&[("fan.yaml", FAN)]);
    let typed = ["explain", "fan.yaml", "temperature=20", "humidity=50"];
    let (code, text, _) = flagred(folder.path(), &typed);
    assert_eq!(code, Some(0));
    let reasons = text.split_once("rules that do not fire").unwrap().1;
    insta::assert_snapshot!(reasons);
}

#[test]
fn outputs_are_compared_with_measured_values() {
    let rows = "temperature,humidity,fan\n20,50,0\n40,100,90\n26,80,63\n";
    let folder = folder(&[("fan.yaml", FAN), ("rows.csv", rows)]);
    let run = |typed: &str| {
        let words: Vec<&str> = typed.split(' ').collect();
        flagred(folder.path(), &words)
    };
    let (code, _, errors) = run("eval fan.yaml rows.csv");
    assert_eq!(code, Some(2));
    assert!(errors.contains("`--suffix _model`"), "{errors}");
    let (code, table, errors) = run("eval fan.yaml rows.csv --suffix _model");
    assert_eq!(code, Some(0), "{errors}");
    assert!(
        table.starts_with(
            "temperature,humidity,fan,fan_model\n20,50,0,0\n40,100,90,100\n26,80,63,60\n"
        ),
        "{table}"
    );
    assert_eq!(
        errors,
        "`fan` against its measured values in 3 rows: RMS error 6.027714, mean error 2.333333 (computed less measured)\n  \
         line 3: 100 computed, 90 measured\n  line 4: 60 computed, 63 measured\n"
    );
}

#[test]
fn rows_outside_a_range_are_clamped_on_request() {
    let rows = "temperature,humidity,fan\n20,50,-0.9\n41,100,100\n35,90,100\n10,10,0\n15,20,0\n";
    let folder = folder(&[("fan.yaml", FAN), ("rows.csv", rows)]);
    let run = |typed: &str| {
        let words: Vec<&str> = typed.split(' ').collect();
        flagred(folder.path(), &words)
    };
    let (code, _, errors) = run("learn fan.yaml rows.csv -o learned.yaml --no-validation");
    assert_eq!(code, Some(3));
    assert!(errors.contains("`--clamp`"), "{errors}");
    for command in ["learn", "tune"] {
        let typed =
            format!("{command} fan.yaml rows.csv -o {command}.yaml --no-validation --clamp");
        let (code, _, errors) = run(&typed);
        assert_eq!(code, Some(0), "{errors}");
        for told in [
            "`temperature` is outside its range from 0 to 40 in 1 of 5 rows and clamped to it (first in `rows.csv`, line 3)",
            "`fan` is outside its range from 0 to 100 in 1 of 5 rows and clamped to it (first in `rows.csv`, line 2)",
        ] {
            assert!(errors.contains(told), "{errors}");
        }
    }
}
