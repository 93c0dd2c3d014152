//! Mistakes with tables: `eval` and `explain`.

use super::{assert_advice, files};

/// Each mistake: the command line, its exit code, and a part of its message.
const MISTAKES: &[(&str, i32, &str)] = &[
    (
        "explain fan.yaml 24 70",
        2,
        "write `temperature=24 humidity=70`",
    ),
    (
        "explain fan.yaml temperature=24,5 humidity=3",
        2,
        "write a decimal point: `24.5`",
    ),
    (
        "explain fan.yaml temperature=22% humidity=3",
        2,
        "write `22`, or `0.22` on a scale from 0 to 1",
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
        "the first line contains numbers",
    ),
    (
        "explain fan.yaml temperature=nan humidity=3",
        2,
        "an unknown value cannot be explained",
    ),
    (
        "explain fan.yaml temperature=1,000.5 humidity=3",
        2,
        "write the number without separators: `1000.5`",
    ),
    ("eval fan.yaml .", 3, "`.` is a folder"),
    ("eval fan.yaml excel.csv", 3, "delete the first line"),
    (
        "eval fan.yaml cells.csv --suffix _model",
        1,
        "help: write as many cells",
    ),
    (
        "eval fan.yaml comments.csv",
        1,
        "no value in 1 of 3 rows: an input is unknown (first in line 5)",
    ),
    (
        "eval fan.yaml comments.csv",
        1,
        "line 6: column `temperature`: `#1` is not a number",
    ),
    (
        "eval fan.yaml units.csv --suffix _model",
        0,
        "`fan` is not compared in 2 rows, whose measured value is not a number (first in line 2)",
    ),
    (
        "eval fan.yaml header.csv --suffix _model",
        0,
        "has a header, but no rows",
    ),
    (
        "eval fan.yaml fan.yaml",
        3,
        "is a rule set or profile, not a table",
    ),
    (
        "explain fan.yaml temperature=cold humidity=3",
        2,
        "`cold` is a term; write a number",
    ),
    (
        "explain fan.yaml temperature=20,humidity=3",
        2,
        "separate the values by spaces",
    ),
    ("explain fan.yaml rows.csv", 2, "`--rows rows.csv`"),
    (
        "explain temperature=20 humidity=3 fan.yaml",
        2,
        "name the rule set first",
    ),
    (
        "explain fan.yaml temperature=20 humidity=3 --delimiter ;",
        2,
        "`--delimiter` needs a table",
    ),
    (
        "explain fan.yaml temperature=20 humidity=3 -o x.csv",
        2,
        "`--rows` writes tables",
    ),
    (
        "explain fan.yaml temperature=1 humidity=3 --json x.json",
        2,
        "`flagred explain fan.yaml temperature=1 humidity=3 --json --output x.json` writes this file",
    ),
    (
        "explain fan.yaml temperature 24 humidity 70",
        2,
        "write `temperature=24 humidity=70`",
    ),
    (
        "explain fan.yaml humidity = 70 temperature = 24",
        2,
        "write `temperature=24 humidity=70`",
    ),
    (
        "explain fan.yaml temperature:24 humidity:70",
        2,
        "write `temperature=24 humidity=70`",
    ),
    (
        "explain fan.yaml",
        2,
        "add `temperature=20 humidity=50`, the middles of their ranges",
    ),
    (
        "explain fan.yaml --temperature 24 --humidity 70",
        2,
        "write `temperature=24 humidity=70`",
    ),
    (
        "explain flight.csv",
        3,
        "`flagred assess flight.csv` assesses a flight",
    ),
    (
        "eval fan.yaml temperature=24 humidity=70",
        2,
        "`flagred explain fan.yaml temperature=24 humidity=70` evaluates",
    ),
    (
        "eval fan.yaml temperature=24",
        2,
        "`flagred explain fan.yaml temperature=24` evaluates",
    ),
    (
        "eval fan.yaml rows.csv --sep ;",
        2,
        "write `--delimiter ';'`",
    ),
    (
        "eval fan.yaml rows.csv --with coverage rule",
        2,
        "`--with coverage,rule`",
    ),
    (
        "eval fan.yaml --input rows.csv",
        2,
        "name the file without an option: `rows.csv`",
    ),
    (
        "eval fan.yaml excel.xlsx",
        3,
        "is an Excel file, not a table",
    ),
    ("eval fan.yaml rows.json", 3, "is JSON, not a table"),
    (
        "eval fan.yaml fan_only.csv --column temp=temperature",
        2,
        "`--column temperature=temp`",
    ),
    (
        "eval fan.yaml words.csv --header none",
        2,
        "the first line of a table names its columns",
    ),
    (
        "explain flagred.yaml a=1",
        3,
        "did you mean the built-in `flagred`?",
    ),
    (
        "eval --json fan.yaml rows.csv",
        2,
        "the table is CSV: leave the option out",
    ),
    (
        "eval fan.yaml minus.csv",
        1,
        "this dash is not a minus sign: write `-12`",
    ),
    (
        "eval fan.yaml minus.csv",
        1,
        "write the number without separators: `1234.5`",
    ),
    (
        "eval fan.yaml minus.csv",
        1,
        "line 5: comments are allowed only above the header",
    ),
    (
        "eval fan.yaml shares.csv --suffix _model",
        0,
        "warning: all 4 values of `humidity` are from 0.5 to 1, but its range is 0 to 100",
    ),
    (
        "eval fan.yaml unknown.csv",
        1,
        "line 2: column `humidity`: `null` is not a number: if the value is unknown, leave the cell empty or write `NA`",
    ),
    (
        "eval fan.yaml unknown.csv",
        1,
        "line 4: column `humidity`: `N/A` is not a number: if the value is unknown",
    ),
    (
        "eval fan.yaml open_quote.csv",
        1,
        "line 3: the quote is never closed, so the lines after it are read as one cell
no value in 1 of 2 rows: they cannot be read
",
    ),
    (
        "eval fan.yaml transposed.csv",
        3,
        "write the names in the first line, and the values of each point in a line of their own",
    ),
    (
        "eval fan.yaml no_break.csv",
        1,
        "remove the no-break space: write `5`",
    ),
    (
        "explain fan.yaml temperature=24, humidity=70",
        2,
        "write spaces between the values: `temperature=24 humidity=70`",
    ),
];

#[test]
fn each_mistake_has_its_advice() {
    assert_advice(&files(), MISTAKES);
}

#[test]
fn compressed_and_latin_1_tables_are_named() {
    let folder = files();
    std::fs::write(folder.path().join("rows.csv.gz"), b"\x1f\x8b\x08\0").unwrap();
    let latin = b"temperature,humidity,place\n20,50,M\xfcnchen\n";
    std::fs::write(folder.path().join("latin.csv"), latin).unwrap();
    assert_advice(
        &folder,
        &[
            ("eval fan.yaml rows.csv.gz", 3, "`gunzip rows.csv.gz`"),
            ("eval fan.yaml latin.csv", 1, "save the table as UTF-8"),
            (
                "learn fan.yaml latin.csv -o out.yaml",
                3,
                "save the table as UTF-8",
            ),
        ],
    );
}
