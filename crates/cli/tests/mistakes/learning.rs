//! Mistakes when rules are made from tables: `learn`, `tune`, `identify`, `simplify`, and terms of type 2.

use super::{FAN, assert_advice, common::flagred, files};

/// Each mistake: the command line, its exit code, and a part of its message.
const MISTAKES: &[(&str, i32, &str)] = &[
    (
        "learn fan.yaml header.csv -o out.yaml",
        3,
        "write the rows below the header",
    ),
    (
        "tune fan.yaml rows.csv --only temperature.hat -o out.yaml",
        2,
        "did you mean `temperature.hot`?",
    ),
    (
        "learn fan.yaml rows.csv -o out.csv",
        2,
        "the file is YAML; write `out.yaml`",
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
        "write `temperature` or `temperature:fan`",
    ),
    (
        "tune fan.yaml rows.csv -o out.yaml --loss log",
        3,
        "`--loss squared`",
    ),
    (
        "learn fan.yaml rows.csv -o out.yaml --rising temprature",
        2,
        "did you mean `temperature`?",
    ),
    (
        "tune fan.yaml rows.csv -o out.yaml --rising temprature",
        2,
        "did you mean `temperature`?",
    ),
    (
        "learn fan.yaml rows.csv rows.csv -o out.yaml",
        2,
        "`rows.csv` is given twice",
    ),
    (
        "learn fan.yaml rows.csv ./rows.csv -o out.yaml",
        2,
        "`./rows.csv` is given twice",
    ),
    (
        "learn fan.yaml rows.csv -o out.yaml --column fan=humidity",
        2,
        "column `humidity` is both an input and the output",
    ),
    (
        "tune fan.yaml outside.csv -o out.yaml",
        3,
        "line 3, column `temperature`: 99 is outside the range from 0 to 40",
    ),
    (
        "tune fan.yaml rows.csv -o out.yaml --checkpoint out.yaml",
        2,
        "`out.yaml` cannot be written: it is also another output",
    ),
    (
        "tune fan.yaml units.csv -o out.yaml",
        3,
        "column `fan` of `units.csv` contains no number (line 2: `5 %`)",
    ),
    (
        "tune fan.yaml units.csv -o out.yaml",
        3,
        "write `5`, or `0.05` on a scale from 0 to 1",
    ),
    ("learn fan.yaml cells.csv -o out.yaml", 3, "write a point"),
    (
        "learn fan.yaml semicolon_cells.csv -o out.yaml",
        3,
        "`--delimiter ';'`",
    ),
    (
        "learn fan.yaml capitals.csv -o out.yaml",
        3,
        "`--column temperature=Temperature`",
    ),
    (
        "simplify fan.yaml -o out.yaml --tolerance 1000",
        2,
        "allows any output",
    ),
    (
        "simplify fan.yaml -o out.yaml --tolerance -1",
        2,
        "write a number of at least 0",
    ),
    (
        "tune fan.yaml rows.csv -o out.yaml --seed -1",
        2,
        "write a whole number of at least 0",
    ),
    (
        "identify units.csv --target fan -o out.yaml",
        3,
        "write `5`, or `0.05` on a scale from 0 to 1",
    ),
    (
        "identify words.csv --target kind -o out.yaml",
        3,
        "for two classes write 0 and 1",
    ),
    (
        "tune fan.yaml rows.csv -o out.yaml --only fan.slow,fan.fast",
        2,
        "`--only fan.slow --only fan.fast`",
    ),
    (
        "learn flagred flight.csv -o out.yaml",
        3,
        "`flagred dataset flight.csv --profile flagred -o rows.csv`",
    ),
    (
        "learn fan.yaml rows.csv --target fan -o out.yaml",
        2,
        "`--column OUTPUT=fan`",
    ),
    (
        "learn rows.csv fan.yaml -o out.yaml",
        2,
        "flagred learn --output out.yaml fan.yaml rows.csv",
    ),
    (
        "learn fan.yaml fan_only.csv -o out.yaml",
        3,
        "did you mean `fans`? If not: name the column",
    ),
    (
        "learn fan.yaml fahrenheit.csv -o out.yaml",
        3,
        "2 of 3 rows are outside a range",
    ),
    (
        "learn fan.yaml rows.csv -o out.yaml --min-support 0.5",
        2,
        "write a whole number of at least 1",
    ),
    (
        "tune fan.yaml rows.csv -o out.yaml --loss mse",
        2,
        "write `squared`",
    ),
    (
        "tune fan.yaml rows.csv -o out.yaml --learning-rate 0.1",
        2,
        "the search has no such setting",
    ),
    ("simplify fan.yaml out.yaml", 2, "write `--output out.yaml`"),
    (
        "identify fan.yaml rows.csv --target fan -o out.yaml",
        2,
        "`identify` reads only tables",
    ),
    (
        "identify rows.csv --target fan --input temperature,humidity -o out.yaml",
        2,
        "`--input temperature --input humidity`",
    ),
    (
        "identify constant.csv --target fan -o out.yaml",
        3,
        "`fan` is 5 in all rows",
    ),
    (
        "identify rows.csv -o out.yaml",
        2,
        "`--target <COLUMN>`: The column with the output",
    ),
    (
        "learn fan.yaml shares.csv -o shares.yaml",
        0,
        "is the column a fraction instead of a percentage?",
    ),
    (
        "learn fan.yaml german.csv --delimiter ; -o out.yaml",
        3,
        "column `fan` of `german.csv` contains no number (line 2: `0,0`)\n  help: write a decimal point: `0.0`",
    ),
    (
        "learn fan.yaml many.csv -o out.yaml",
        3,
        "and 2 more like these",
    ),
    (
        "tune fan.yaml places.csv --weight vehicle -o out.yaml",
        3,
        "write `--group-by vehicle`",
    ),
    (
        "tune fan.yaml places.csv --loss log -o out.yaml",
        3,
        "the values of `fan` are from 0 to 70, but `--loss log` is for outcomes of 0 and 1",
    ),
    (
        "simplify rows.csv fan.yaml -o out.yaml",
        2,
        "flagred simplify --output out.yaml fan.yaml rows.csv",
    ),
    (
        "learn fan.yaml open_quote.csv -o out.yaml",
        3,
        "line 3: the quote is never closed",
    ),
    (
        "identify cities.csv --target fan -o out.yaml",
        3,
        "no column except `fan` contains numbers
  help: inputs are numbers, and `city` contains text",
    ),
    (
        "simplify fan.yaml -o out.yaml --tolerance 1%",
        2,
        "write a number of at least 0; write `1`, or `0.01` on a scale from 0 to 1",
    ),
];

#[test]
fn each_mistake_has_its_advice() {
    assert_advice(&files(), MISTAKES);
}

#[test]
fn terms_of_type_2_are_named_by_their_keys() {
    let folder = files();
    let fan = FAN.replace("hot: 30}}", "hot: 30}, blur: 0.05}");
    std::fs::write(folder.path().join("blur.yaml"), fan).unwrap();
    for command in [
        "export --fll blur.yaml",
        "tune blur.yaml rows.csv -o out.yaml",
        "learn blur.yaml rows.csv -o out.yaml",
        "simplify blur.yaml -o out.yaml",
    ] {
        let words: Vec<&str> = command.split(' ').collect();
        let (code, _, errors) = flagred(folder.path(), &words);
        assert!(code == Some(2) || code == Some(3), "{command}: {code:?}");
        assert!(
            errors.contains("remove the keys that make terms type-2, such as `blur` or `lower`"),
            "{command}: {errors}"
        );
    }
}
