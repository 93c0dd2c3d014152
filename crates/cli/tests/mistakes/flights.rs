//! Mistakes with flights: `assess`, `inspect`, `convert`, `watch`, `validate`.

use super::{assert_advice, common::flagred, files};

/// Each mistake: the command line, its exit code, and a part of its message.
const MISTAKES: &[(&str, i32, &str)] = &[
    ("assess fan.yaml", 3, "`flagred check` examines a rule set"),
    (
        "assess profile.yaml",
        3,
        "`flagred assess --profile PROFILE FLIGHT`",
    ),
    ("assess semicolons.csv", 3, "separates cells by commas"),
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
        "watch tcp://127.0.0.1:5760",
        2,
        "write `tcp:127.0.0.1:5760`",
    ),
    ("watch udpin:0.0.0.0:99999", 2, "a port from 0 to 65535"),
    ("watch rows.csv", 2, "`flagred assess rows.csv`"),
    ("convert plane.csv -o x.csv.gz", 2, "write `x.csv`"),
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
        "`0.1` if the unit is s, `100` if it is ms",
    ),
    (
        "assess capital_motors.csv",
        3,
        "there is a column `Motor_1`, but no `motor1`",
    ),
    ("assess percent.csv", 3, "without a unit"),
    ("assess flagred flight.csv", 3, "`--profile flagred`"),
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
    (
        "inspect --csv flight.csv",
        2,
        "`flagred convert FLIGHT --output flight.csv` writes a table",
    ),
    ("validate --csv flight.csv", 2, "write `--json`"),
    (
        "assess flight.csv --csv out.csv",
        2,
        "`flagred assess flight.csv --csv > out.csv` writes this file",
    ),
    ("watch udpin:0.0.0.0:14559 --json", 2, "write `--jsonl`"),
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
    ("convert fan.fis -o fan.csv", 3, "is a rule set"),
    (
        "assess report.pdf",
        3,
        "help: flight logs are ArduPilot .bin and .log",
    ),
    (
        "assess flight.bbl",
        3,
        "`flight.bbl` is a Betaflight log, a format that is not supported
  help: convert it with `blackbox_decode`",
    ),
    ("assess vehicle.csv", 3, "write `# vehicle: x`"),
    (
        "assess one_row.csv",
        3,
        "the log has only one sample of the motor commands",
    ),
    (
        "assess commas.csv",
        3,
        "line 2: 8 cells, but the header has 4
  help: write numbers with a decimal point",
    ),
    (
        "assess flight.csv --range 1100,1900",
        2,
        "write `--range 1100 1900`",
    ),
    (
        "assess flight.csv --range 1000us 2000us",
        2,
        "write the number without its unit: `1000`",
    ),
    (
        "assess --range 1100,1900 flight.csv",
        2,
        "write two numbers: `--range 1100 1900`",
    ),
    (
        "assess --range 1100 flight.csv",
        2,
        "write two numbers of microseconds, such as `--range 1100 1900`",
    ),
    (
        "assess flight.csv --profile flagred,flagred-paper",
        3,
        "help: name one profile",
    ),
    (
        "assess flight.csv --profile my.yaml",
        3,
        "help: check the path; the folder has",
    ),
    (
        "watch udpin:14550",
        2,
        "to listen on a port, write `udpin:0.0.0.0:14550`",
    ),
    (
        "watch /dev/ttyUSB0 --baud 57600",
        2,
        "the baud rate follows the serial port: `/dev/ttyUSB0:57600`",
    ),
    (
        "watch udpin:127.0.0.1:14598 --key secret",
        3,
        "`--key` names a file with the key: 32 bytes, or 64 hexadecimal digits",
    ),
];

#[test]
fn each_mistake_has_its_advice() {
    assert_advice(&files(), MISTAKES);
}

#[test]
fn watch_refuses_a_log() {
    let folder = files();
    let log = folder.path().join("flight.csv").display().to_string();
    let (code, _, errors) = flagred(folder.path(), &["watch", &log]);
    assert_eq!(code, Some(2));
    assert!(
        errors.contains(&format!("`{log}` is a file: `flagred assess {log}`")),
        "{errors}"
    );
}
