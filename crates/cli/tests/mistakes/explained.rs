//! Explanations of rows, outputs compared with measured values, and rows outside a range.

use super::{
    FAN,
    common::{flagred, folder},
};

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
        let input = "`temperature` is outside its range from 0 to 40 in 1 of 5 rows and clamped to it (first in `rows.csv`, line 3)";
        assert!(errors.contains(input), "{errors}");
        // Only `learn` clamps values of the output to the range and reports them; `tune` and `eval` use such values as
        // they are.
        let output = "`fan` is outside its range from 0 to 100 in 1 of 5 rows and clamped to it (first in `rows.csv`, line 2)";
        assert_eq!(errors.contains(output), command == "learn", "{errors}");
    }
}
