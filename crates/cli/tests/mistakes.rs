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

/// A folder with the files of the mistakes.
fn files() -> tempfile::TempDir {
    folder(&[
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
        (
            "comments.csv",
            "# made by hand\n\ntemperature,humidity\n20,50\n#N/A,50\n#1,50\n",
        ),
        (
            "units.csv",
            "temperature,humidity,fan\n20,50,5 %\n30,50,6 %\n",
        ),
        ("cells.csv", "temperature,humidity,fan\n20,5,50,0\n"),
        (
            "semicolon_cells.csv",
            "temperature;humidity;fan\n20,5;50;0\n",
        ),
        ("capitals.csv", "Temperature,humidity,fan\n20,50,0\n"),
        ("excel.csv", "sep=;\ntemperature;humidity;fan\n"),
        (
            "outside.csv",
            "temperature,humidity,fan\n20,50,0\n99,50,0\n",
        ),
        (
            "plane.csv",
            "# vehicle_kind: fixed wing\nt_s,motor1,motor2,motor3,motor4\n0,0.5,0.5,0.5,0.5\n",
        ),
        (
            "from_0.csv",
            "t_s,motor0,motor1,motor2,motor3\n0,0.5,0.5,0.5,0.5\n",
        ),
        ("fan_only.csv", "temperature,humidity,fans\n20,50,0\n"),
        (
            "german.csv",
            "temperature;humidity;fan\n20;50;0,0\n25;60;9,5\n30;70;30,5\n",
        ),
        (
            "places.csv",
            "temperature,humidity,fan,vehicle\n20,50,0,a\n25,50,50,b\n30,70,70,b\n",
        ),
        (
            "shares.csv",
            "temperature,humidity,fan\n20,0.5,0\n25,0.6,50\n30,0.9,70\n40,1,100\n",
        ),
        (
            "minus.csv",
            "temperature,humidity\n\u{2212}12,5\n20,\"1.234,5\"\n20,50\n# end\n",
        ),
        (
            "many.csv",
            "temperature,humidity,fan\n20,50,0\n20,50,x\n20,50,y\n20,50,z\n20,50,u\n20,50,v\n20,,1\n",
        ),
        ("bare.csv", "pwm_low_us: 1000\nt_s,pwm1\n0,1500\n"),
        (
            "min.csv",
            "# pwm_min_us: 1000\n# pwm_high_us: 2000\nt_s,pwm1\n0,1500\n",
        ),
        (
            "hexa.csv",
            "# frame: HEXA/X\nt_s,pwm1,pwm2,pwm3,pwm4\n0,1500,1500,1500,1500\n",
        ),
        ("copter.param", "MOT_PWM_MIN,1000\nMOT_PWM_MAX,2000\n"),
        ("log.mat", "MATLAB 5.0 MAT-file"),
        ("constant.csv", "temperature,fan\n20,5\n30,5\n35,5\n"),
        (
            "fahrenheit.csv",
            "temperature,humidity,fan\n68,50,0\n99,50,0\n30,50,0\n",
        ),
        (
            "flight.csv",
            "t_s,pwm1,pwm2,pwm3,pwm4\n0,1500,1500,1500,1500\n",
        ),
        ("time.csv", "time,pwm1\n0,1500\n0.1,1500\n"),
        ("t_ms.csv", "t_ms,pwm1\n0,1500\n100,1500\n"),
        ("no_rows.csv", "t_s,pwm1,pwm2,pwm3,pwm4\n"),
        ("tabs.csv", "t_s\tmotor1\n0.5\t0.5\n"),
        ("clock.csv", "t_s,motor1\n12:00:01,0.5\n"),
        (
            "microseconds.csv",
            "t_s,motor1\n0,0.5\n4000,0.5\n8000,0.5\n12000,0.5\n16000,0.5\n20000,0.5\n",
        ),
        ("backwards.csv", "t_s,motor1\n4,0.5\n3,0.5\n2,0.5\n1,0.5\n"),
        ("no_header.csv", "0,1500,1500\n1,1500,1500\n"),
        ("capital_motors.csv", "t_s,Motor_1\n0,0.5\n"),
        ("percent.csv", "t_s,motor1\n0,15%\n0.1,15%\n"),
        ("equals.csv", "# pwm_low_us = 1000\nt_s,pwm1\n0,1500\n"),
        ("rows.json", "[{\"temperature\": 20}]\n"),
        (
            "excel.xlsx",
            "PK\u{3}\u{4}[Content_Types].xml xl/workbook.xml",
        ),
        ("notes.md", "# Notes\n\n**Bold** text\n"),
        ("empty.csv", ""),
        ("script.fis", "fis = mamfis('Name', 'fan');\n"),
        (
            "fan.fll",
            "Engine: fan\nInputVariable: a\n  range: 0 10,5\n",
        ),
        ("fan.m", "fis = mamfis('Name', 'fan');\n"),
        ("fan.py", "import skfuzzy\n"),
    ])
}

/// Asserts the exit code of each command line, and that its output contains the expected text.
fn assert_advice(folder: &tempfile::TempDir, mistakes: &[(&str, i32, &str)]) {
    let mut wrong = Vec::new();
    for &(typed, code, expected) in mistakes {
        let words: Vec<&str> = typed.split(' ').collect();
        let (exit, out, errors) = flagred(folder.path(), &words);
        if exit != Some(code) || !(out + &errors).contains(expected) {
            wrong.push(format!("{typed}: exit {exit:?}, {errors}"));
        }
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}

#[test]
fn the_advice_for_mistakes_works() {
    assert_advice(
        &files(),
        &[
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
                "write `22`, or `0.22` if the value is a share",
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
                "learn fan.yaml header.csv -o out.yaml",
                3,
                "write the rows below the header",
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
            ("new sub/foo", 2, "write `foo -o sub/foo.yaml`"),
            ("new mine --profile", 2, "flagred-battery"),
            ("assess fan.yaml", 3, "`flagred check` examines a rule set"),
            (
                "assess profile.yaml",
                3,
                "`flagred assess --profile PROFILE FLIGHT`",
            ),
            ("assess semicolons.csv", 3, "separates cells by commas"),
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
                "an unknown value cannot be explained",
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
                "choose an interpolation with `--fill`",
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
                "write `5`, or `0.05` if the value is a share",
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
                "map fan.yaml --hold humidity=5 --hold humidity=6",
                2,
                "`humidity` has two values",
            ),
            (
                "map fan.yaml --points 0",
                2,
                "write a whole number from 2 to 1001",
            ),
            (
                "map fan.yaml --fill nearest --coverage-below 50",
                2,
                "write a number above 0 and at most 1",
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
                "assess plane.csv",
                3,
                "`fixed wing` is not a kind of vehicle",
            ),
            ("assess from_0.csv", 3, "number the motors from 1"),
            (
                "assess https://example.org/flight.ulg",
                3,
                "download the log first",
            ),
            (
                "check flagred-batery",
                3,
                "did you mean the built-in `flagred-battery`?",
            ),
            (
                "watch tcp://127.0.0.1:5760",
                2,
                "write `tcp:127.0.0.1:5760`",
            ),
            ("watch udpin:0.0.0.0:99999", 2, "a port from 0 to 65535"),
            ("watch rows.csv", 2, "`flagred assess rows.csv`"),
            ("version", 2, "`flagred --version`"),
            ("man --folder fan.yaml", 2, "is a file, not a folder"),
            ("convert plane.csv -o x.csv.gz", 2, "write `x.csv`"),
            (
                "identify units.csv --target fan -o out.yaml",
                3,
                "write `5`, or `0.05` if the value is a share",
            ),
            (
                "identify words.csv --target kind -o out.yaml",
                3,
                "for two classes write 0 and 1",
            ),
        ],
    );
}

/// Mistakes of people who know other programs: the command line, the exit code, and a part of the message.
const OF_OTHER_PROGRAMS: &[(&str, i32, &str)] = &[
    (
        "explain fan.yaml temperature=1 humidity=3 --json x.json",
        2,
        "`flagred explain fan.yaml temperature=1 humidity=3 --json --output x.json` writes this file",
    ),
    (
        "tune fan.yaml rows.csv -o out.yaml --only fan.slow,fan.fast",
        2,
        "`--only fan.slow --only fan.fast`",
    ),
    (
        "map fan.yaml --x temperature:0-20",
        2,
        "write `temperature:0..20`",
    ),
    (
        "map fan.yaml --x temperature 0 20",
        2,
        "write `--x INPUT:LOW..HIGH`",
    ),
    ("plot fan.yaml --html x.html", 2, "write `--svg x.svg`"),
    ("fmt fan.yaml --write", 2, "leave the option out"),
    (
        "check fan.yaml --coverage 50",
        2,
        "write a number above 0 and at most 1\n",
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
    ("assess excel.xlsx", 3, "save it as CSV (UTF-8)"),
    ("assess time.csv", 3, "rename `time` to `t_s`"),
    (
        "assess t_ms.csv",
        3,
        "rename `t_ms` to `t_s`, and divide its values by 1000",
    ),
    (
        "assess no_rows.csv",
        3,
        "the table has a header, but no rows",
    ),
    ("assess tabs.csv", 3, "a table with tabs between its cells"),
    (
        "assess clock.csv",
        3,
        "write the seconds since the first row",
    ),
    (
        "assess microseconds.csv",
        3,
        "divide microseconds by 1000000",
    ),
    ("assess backwards.csv", 3, "sort the rows by `t_s`"),
    ("assess no_header.csv", 3, "the first line contains numbers"),
    (
        "assess flight.csv --step 100ms",
        2,
        "write a number of at least 0\n",
    ),
    ("--versoin", 2, "'--version'"),
    (
        "assess capital_motors.csv",
        3,
        "there is a column `Motor_1`, but no `motor1`",
    ),
    ("assess percent.csv", 3, "without a unit"),
    ("assess flagred flight.csv", 3, "`--profile flagred`"),
    (
        "explain flagred.yaml a=1",
        3,
        "did you mean the built-in `flagred`?",
    ),
    (
        "map fan.yaml --output fan",
        2,
        "`--of fan` shows this output",
    ),
    ("assess equals.csv", 3, "write `# pwm_low_us: 1000`"),
    ("assess -", 3, "the command before the pipe printed nothing"),
    (
        "assess flight.csv --json --output x.json",
        2,
        "`--json > x.json`",
    ),
    ("assess flight.csv -o x.html", 2, "write `--html x.html`"),
    (
        "assess flight.csv --range 1000-2000",
        2,
        "write `--range 1000 2000`",
    ),
    ("assess -profile flagred flight.csv", 2, "write `--profile`"),
    (
        "assess profile=flagred flight.csv",
        3,
        "`--profile flagred`",
    ),
    (
        "assess flight.csv --threshold 50",
        2,
        "`flagred new NAME --profile flagred`",
    ),
    ("assess flight.csv --fail-on FAIL", 2, "write `fail`"),
    (
        "assess flight.csv --step 1s",
        2,
        "write the number without its unit: `1`",
    ),
    ("assess fligt.csv", 3, "did you mean `flight.csv`?"),
    (
        "inspect flight.csv --csv",
        2,
        "`flagred convert FLIGHT --output flight.csv`",
    ),
    ("convert flight.csv out.csv", 2, "write `--output out.csv`"),
    (
        "convert flight.csv time.csv -o out.csv",
        2,
        "`convert` takes one file at a time",
    ),
    (
        "convert flight.csv --csv out.csv",
        2,
        "write `--output out.csv`",
    ),
    (
        "convert fan.fis -o new.yaml",
        2,
        "flagred import fan.fis --output new.yaml",
    ),
    (
        "convert flight.csv",
        2,
        "`--output <OUT.csv>`: The file to write",
    ),
    ("import fan.fis out.yaml", 2, "write `--output out.yaml`"),
    (
        "import --format fis fan.fis",
        2,
        "the format is recognised by the content",
    ),
    ("import script.fis", 3, "`writeFIS(fis, \"name\")`"),
    ("import fan.fll", 3, "write a decimal point: `10.5`"),
    ("import rows.csv", 3, "a table of values, not a rule set"),
    ("plot fan.yaml --output fan.svg", 2, "write `--svg fan.svg`"),
    ("plot fan.yaml temperature", 2, "`plot` draws all variables"),
    ("plot fan.yaml --csv", 2, "`flagred map RULES --csv`"),
    (
        "map fan.yaml -o map.png",
        2,
        "for a picture write `--svg map.svg`",
    ),
    (
        "map fan.yaml temperature humidity",
        2,
        "write `--x temperature --y humidity`",
    ),
    (
        "map fan.yaml temperature=3",
        2,
        "write `--hold temperature=3`",
    ),
    ("map flight.csv", 3, "`flagred assess flight.csv`"),
    ("export --format fis fan.yaml", 2, "write `--fis`"),
    (
        "export --fis new.fis fan.yaml",
        2,
        "write `--fis fan.yaml --output new.fis`",
    ),
    ("export fan.yaml --matlab", 2, "write `--fis`"),
    (
        "fmt fan.yaml -o out.yaml",
        2,
        "`fmt` formats files in place",
    ),
    ("fmt fan.fll", 3, "`flagred import fan.fll`"),
    ("new my rules", 2, "write `my-rules`"),
    (
        "new my-rules --template flagred",
        2,
        "write `--from flagred`",
    ),
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
    (
        "studio fan.yaml rows.csv",
        2,
        "`studio` takes one file at a time",
    ),
    (
        "studio fan.yaml --browser",
        2,
        "the page opens in the browser by default",
    ),
    ("check fan.yaml --strict", 2, "write `--deny warnings`"),
    (
        "check fan.yaml --rising temperature humidity",
        3,
        "`--rising humidity`",
    ),
    ("check profile", 3, "did you mean `profile.yaml`?"),
    ("check notes.md", 3, "is a document, not a rule set"),
    ("check rows.csv", 1, "a table of values, not a rule set"),
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
        "validate --rows rows.csv",
        3,
        "`flagred dataset --profile NAME`",
    ),
    (
        "validate flight.csv --horizon 5s",
        2,
        "without its unit: `5`",
    ),
    ("watch udp:14550", 2, "write `udpin:0.0.0.0:14550`"),
    ("show fan.yaml", 2, "`show` prints what is built in"),
    (
        "inspect --csv flight.csv",
        2,
        "`flagred convert FLIGHT --output flight.csv` writes a table",
    ),
    ("check --csv fan.yaml", 2, "write `--json`"),
    ("validate --csv flight.csv", 2, "write `--json`"),
    (
        "assess flight.csv --csv out.csv",
        2,
        "`flagred assess flight.csv --csv > out.csv` writes this file",
    ),
    ("map fan.yaml --csv out.csv", 2, "write `--output out.csv`"),
    (
        "check fan.yaml --json out.json",
        2,
        "`flagred check fan.yaml --json > out.json` writes this file",
    ),
    (
        "plot fan.yaml --png terms.png",
        2,
        "write `--svg terms.svg`",
    ),
    (
        "map fan.yaml --hold temperature 5",
        2,
        "write `--hold temperature=5`",
    ),
    (
        "map fan.yaml --hold temperature=5,5",
        2,
        "write a decimal point: `5.5`",
    ),
    (
        "map fan.yaml --hold temperature=5,humidity=3",
        2,
        "`--hold temperature=5 --hold humidity=3`",
    ),
    (
        "map fan.yaml --x temperature,humidity",
        2,
        "write `--x temperature --y humidity`",
    ),
    ("map --json fan.yaml", 2, "write `--csv`"),
    (
        "map fan.yaml --check earlier.csv",
        3,
        "`flagred map fan.yaml --csv --output earlier.csv` writes it",
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
        "learn fan.yaml shares.csv -o shares.yaml",
        0,
        "is the column a share instead of a percentage?",
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
        "check fan.yaml --rising temperature,humidity",
        2,
        "`--rising temperature --rising humidity`",
    ),
    ("watch udpin:0.0.0.0:14559 --json", 2, "write `--jsonl`"),
    (
        "export rust fan.yaml",
        2,
        "an option begins with dashes: write `--rust`",
    ),
    (
        "export --fis -o built-in.fis",
        0,
        "wrote `built-in.fis`: the built-in rule set `flagred`",
    ),
    ("completions", 2, "bash, elvish, fish, powershell"),
    (
        "assess --profile profle.yaml flight.csv",
        3,
        "did you mean `profile.yaml`?",
    ),
    ("assess bare.csv", 3, "write `# pwm_low_us: 1000`"),
    (
        "assess min.csv",
        3,
        "write `pwm_low_us` in place of `pwm_min_us` in line 1",
    ),
    (
        "assess hexa.csv",
        3,
        "add the columns that are missing, or correct `frame`",
    ),
    ("assess copter.param", 3, "is a list of parameters"),
    ("assess log.mat", 3, "name the .bin or .ulg log"),
    ("assess .", 3, "`.` is a folder"),
    (
        "simplify rows.csv fan.yaml -o out.yaml",
        2,
        "flagred simplify --output out.yaml fan.yaml rows.csv",
    ),
    ("convert fan.fis -o fan.csv", 3, "is a rule set"),
];

#[test]
fn words_of_other_programs_are_translated() {
    let folder = files();
    let (_, fis, _) = flagred(folder.path(), &["export", "--fis", "fan.yaml"]);
    std::fs::write(folder.path().join("fan.fis"), fis).unwrap();
    assert_advice(&folder, OF_OTHER_PROGRAMS);
}

#[test]
fn no_tip_writes_to_a_file_that_exists() {
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
        for reported in [
            "`temperature` is outside its range from 0 to 40 in 1 of 5 rows and clamped to it (first in `rows.csv`, line 3)",
            "`fan` is outside its range from 0 to 100 in 1 of 5 rows and clamped to it (first in `rows.csv`, line 2)",
        ] {
            assert!(errors.contains(reported), "{errors}");
        }
    }
}
