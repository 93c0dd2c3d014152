//! Impossible contents of a flight CSV are refused with their position, and never read as a shorter or a different flight.

use std::fmt::Write as _;

use flagred::{log::assess, shipped};
use flagred_flightlog::{Flight, Options, ReadError};

const HEAD: &str = "# pwm_low_us: 1000\n# pwm_high_us: 2000\n";
const NAMES: &str = "t_s,pwm1,pwm2,pwm3,pwm4,in_air\n";

/// A calm flight of 60 s at 25 Hz; `row` may replace a row.
fn flight(header: &str, row: impl Fn(usize, f64) -> Option<String>) -> String {
    let mut csv = format!("{HEAD}{header}{NAMES}");
    for i in 0..1500 {
        let t_s = i as f64 * 0.04;
        let calm = || {
            let pwm = 1500 + i % 7;
            format!("{t_s},{pwm},{pwm},{pwm},{pwm},1")
        };
        let _ = writeln!(csv, "{}", row(i, t_s).unwrap_or_else(calm));
    }
    csv
}

fn read(csv: &str) -> Result<Flight, ReadError> {
    flagred_flightlog::read(csv.as_bytes(), &Options::default())
}

#[track_caller]
fn refused(csv: &str, message: &str, help: &str) {
    let error = read(csv).unwrap_err();
    assert!(error.to_string().contains(message), "{error}");
    assert!(error.help().unwrap().contains(help), "{:?}", error.help());
}

fn verdict(csv: &str) -> String {
    let flight = read(csv).unwrap();
    assess(&flight, &shipped::flagred(), None)
        .verdict
        .to_string()
}

#[test]
fn the_flight_is_good_before_it_is_changed() {
    assert_eq!(verdict(&flight("", |_, _| None)), "GOOD");
}

#[test]
fn a_frame_with_fewer_motors_than_columns_is_refused() {
    for (header, said) in [
        (
            "# frame: TRI\n",
            "line 3: `frame` is `TRI`, which has 3 motors, but there are columns `pwm1` to `pwm4`",
        ),
        (
            "# frame_class: 7\n",
            "line 3: `frame_class` is `7`, which has 3",
        ),
        (
            "# motors: 3\n",
            "line 3: `motors` is `3`, which has 3 motors",
        ),
    ] {
        refused(
            &flight(header, |_, _| None),
            said,
            "rename the columns that are not motors",
        );
    }
    let six = "# frame: QUAD/X\nt_s,motor1,motor2,motor3,motor4,motor5,motor6\n0,0,0,0,0,0,0\n";
    refused(
        six,
        "line 1: `frame` is `QUAD/X`, which has 4 motors",
        "correct the frame",
    );
    // If the factors of all motors are given, they replace the table of the frame.
    let factors: String = (1..=6)
        .map(|motor| format!("# motor{motor}_factors: 1 1 1\n"))
        .collect();
    assert!(read(&format!("{factors}{six}")).is_ok());
}

#[test]
fn a_row_without_a_time_is_refused() {
    for (time, said) in [
        ("", "line 1004: `t_s` is empty"),
        ("inf", "line 1004: `t_s` is `inf`, not a time in seconds"),
        ("nan", "line 1004: `t_s` is `nan`, not a time"),
        ("40.0x", "line 1004: `t_s` is `40.0x`, not a time"),
    ] {
        let csv = flight("", |i, _| {
            (i >= 1000).then(|| format!("{time},1000,2000,1000,2000,1"))
        });
        refused(&csv, said, "give every row a time");
    }
    // Spreadsheets append rows of empty cells.
    let csv = flight("", |_, _| None) + ",,,,,\n,,,,,\n";
    assert_eq!(verdict(&csv), "GOOD");
    assert_eq!(read(&csv).unwrap().report.bad_messages, 2);
}

#[test]
fn a_cell_that_is_not_a_number_is_unknown_and_its_row_counts() {
    for cell in ["inf", "-inf", "x"] {
        let csv = flight("", |i, t_s| {
            (i >= 1000).then(|| format!("{t_s},{cell},2000,1000,2000,1"))
        });
        let flight = read(&csv).unwrap();
        assert_eq!(flight.commands.len(), 1500);
        assert_eq!(flight.report.bad_messages, 500);
        assert!(flight.report.reason.unwrap().starts_with("line 1004: "));
        assert_eq!(verdict(&csv), "NA", "{cell}");
    }
}

#[test]
fn header_lines_and_rows_in_another_notation_are_named() {
    for (csv, said, help) in [
        (
            "vehicle: my quad\nt_s,motor1\n0,0.5\n",
            "line 1: a header line begins with `#`",
            "write `# vehicle: my quad`",
        ),
        (
            "# pwm_low_us 1000\nt_s,pwm1\n0,1500\n",
            "line 1: `pwm_low_us 1000` has no colon",
            "write `# pwm_low_us: 1000`",
        ),
        (
            "t_s,motor1,motor2\n0,00,0,5,0,5\n0,05,0,5,0,5\n",
            "line 2: 6 cells, but the header has 3",
            "a decimal point",
        ),
    ] {
        refused(csv, said, help);
    }
    let utf_16: Vec<u8> = "\u{feff}t_s,motor1\n0,0.5\n"
        .encode_utf16()
        .flat_map(u16::to_le_bytes)
        .collect();
    let error = flagred_flightlog::read(utf_16.as_slice(), &Options::default()).unwrap_err();
    assert_eq!(
        (error.to_string().as_str(), error.help()),
        (
            "`the log` is text in UTF-16, not a flight log",
            Some("save it as UTF-8")
        )
    );
    // A colon in the name of a column does not make its row a header line, and an empty cell at the end of a row does
    // not count as one cell too many.
    for csv in [
        "a: b,t_s,motor1\n1,0,0.5\n",
        "t_s,motor1,motor2,motor3\n0,0.5,0.5,0.5,\n",
    ] {
        assert!(read(csv).is_ok(), "{csv}");
    }
}

#[test]
fn a_row_with_too_few_cells_is_refused() {
    let short = |row: usize| {
        flight("", move |i, t_s| {
            (i == row).then(|| format!("{t_s},1500,1500"))
        })
    };
    refused(
        &short(10),
        "line 14: 3 of 6 columns",
        "give every row a cell",
    );
    // A short last row counts as the end of a truncated file.
    let flight = read(&short(1499)).unwrap();
    assert!(flight.report.truncated);
    assert_eq!(flight.report.bad_messages, 1);
}

/// Without the column `in_air`, idle motors end a flight; with it, they count as a fall. A flight that is written and
/// read back has the same verdict.
#[test]
fn idle_motors_override_an_assumed_time_in_the_air() {
    let idle = |i: usize, t_s: f64, air: &str| {
        let pwm = if i > 1300 { 1030 } else { 1500 + i % 7 };
        format!("{t_s},{pwm},{pwm},{pwm},{pwm}{air}")
    };
    let reported = flight("", |i, t_s| Some(idle(i, t_s, ",1")));
    let assumed = flight("", |i, t_s| Some(idle(i, t_s, ""))).replace(",in_air", "");
    assert_eq!(verdict(&reported), "FAIL");
    assert_eq!(verdict(&assumed), "GOOD");
    let mut written = Vec::new();
    read(&assumed).unwrap().write_csv(&mut written).unwrap();
    let written = String::from_utf8(written).unwrap();
    assert!(written.contains("# in_air: assumed\n"), "{written:.200}");
    assert_eq!(verdict(&written), "GOOD");
    let unclear = written.replace("in_air: assumed", "in_air: perhaps");
    refused(&unclear, "`in_air` is `perhaps`", "write `assumed`");
}

#[test]
fn the_column_for_in_the_air_accepts_only_0_and_1() {
    for state in ["2", "0.5", "-1", "True", "inf"] {
        let csv = flight("", |i, t_s| {
            (i == 10).then(|| format!("{t_s},1500,1500,1500,1500,{state}"))
        });
        let said = format!("line 14: `in_air` is `{state}`, not 0 or 1");
        refused(&csv, &said, "write 1 in the air");
    }
    for state in ["1.0", "", "nan"] {
        let csv = flight("", |i, t_s| {
            (i == 10).then(|| format!("{t_s},1500,1500,1500,1500,{state}"))
        });
        assert_eq!(verdict(&csv), "GOOD");
    }
}

#[test]
fn pulse_widths_in_another_unit_are_refused() {
    for (third, shown) in [
        ("0.52", "0.52"),
        ("52", "52"),
        ("15000", "15000"),
        ("-0.2", "-0.2"),
    ] {
        let csv = flight("", |_, t_s| Some(format!("{t_s},1500,1500,{third},1500,1")));
        let said = format!("line 4: `pwm3` is {shown}, not a pulse width in us");
        refused(
            &csv,
            &said,
            "name columns of fractions from 0 to 1 `motor1`",
        );
        // Without limits no verdict is possible anyway, and `convert` writes such commands, so they are accepted.
        // Fractions are refused even then.
        let without_limits = read(csv.strip_prefix(HEAD).unwrap());
        assert_eq!(without_limits.is_err(), third == "0.52", "{third}");
    }
    let negative = "t_s,motor1,motor2,motor3\n0,0.5,0,-0.2\n0.1,0.5,0,-0.3\n";
    refused(
        negative,
        "line 2: `motor3` is -0.2, not a fraction from 0 to 1",
        "1 the highest",
    );
    // Pulses of 0 from outputs that are off and a single damaged cell are not refused.
    let csv = flight("", |i, t_s| match i {
        0..800 => Some(format!("{t_s},0,0,0,0,0")),
        900 => Some(format!("{t_s},15,1500,1500,1500,1")),
        _ => None,
    });
    assert!(read(&csv).is_ok());
}

#[test]
fn a_reboot_outside_the_flight_is_refused() {
    for time in ["1e9", "-1", "20 61", "inf", "nan"] {
        let header = format!("# rebooted_in_air_s: {time}\n");
        let said = "line 3: `rebooted_in_air_s` is ";
        refused(&flight(&header, |_, _| None), said, "on the clock of `t_s`");
    }
    assert_eq!(
        verdict(&flight("# rebooted_in_air_s: 20\n", |_, _| None)),
        "NA"
    );
    let later = "# rebooted_in_air_s: 61\n# end_s: 62\n";
    assert!(read(&flight(later, |_, _| None)).is_ok());
}

#[test]
fn a_clock_of_whole_numbers_is_named() {
    let at = |time: &dyn Fn(usize) -> String| {
        flight("", |i, _| {
            Some(format!("{},1500,1500,1500,1500,1", time(i)))
        })
    };
    // A clock of about 1 kHz in whole milliseconds, which repeats some values, and a clock of whole seconds.
    for csv in [
        at(&|i| format!("{}", i * 10 / 11)),
        at(&|i| format!("{}", i / 25)),
    ] {
        refused(
            &csv,
            "as in the row before, and a whole number in every row",
            "divide milliseconds by 1000",
        );
    }
    let csv = at(&|i| format!("{}", i / 3 * 5));
    refused(
        &csv,
        "line 7: `t_s` jumps from 0 to 5 in one row",
        "divide milliseconds by 1000",
    );
    // Repeated times are accepted if they are not all whole numbers.
    let csv = at(&|i| format!("{}", i / 3 * 2) + "e-2");
    assert_eq!(verdict(&csv), "GOOD");
}

/// A damaged log may contain values that would be refused in a flight CSV written by a user. `convert` writes them, and
/// its output is read back.
#[test]
fn files_written_by_convert_are_read_with_any_content() {
    let rows = "t_s,pwm1,pwm2,pwm3,pwm4,in_air\n1,32,1500,1500,1500,1\n1,32,1500,1500,1500,1\n1,32,1500,1500,1500,1\n\
                1,32,1500,1500,1500,1\n1,32,1500,1500,1500,1\n1,32,1500,1500,1500,1\n1,32,1500,1500,1500,1\n";
    let head = "# pwm_low_us: 1000\n# pwm_high_us: 2000\n";
    let read = |text: String| {
        flagred_flightlog::read(text.as_bytes(), &flagred_flightlog::Options::default())
    };
    assert!(read(format!("{head}{rows}")).is_err());
    let flight = read(format!(
        "{head}# rebooted_in_air_s: 9000\n# written_by: flagred\n{rows}"
    ));
    let flight = flight.unwrap();
    assert_eq!(flight.rebooted_in_air_s, [9000.0]);
    let mut written = Vec::new();
    flight.write_csv(&mut written).unwrap();
    assert_eq!(
        read(String::from_utf8(written).unwrap()).unwrap().commands,
        flight.commands
    );
}

#[test]
fn any_number_of_quotes_around_names_is_dropped() {
    let text = "t_s, \"\"\"a\"\"\",motor1\n0,1,0.5\n0.1,2,0.5\n";
    let flight =
        flagred_flightlog::read(text.as_bytes(), &flagred_flightlog::Options::default()).unwrap();
    assert_eq!(flight.signals().next().unwrap().label.name, "a");
}

#[test]
fn times_stay_in_order_after_a_clock_restarts_far_below() {
    let row = |t_s: &str| format!("{t_s},0.5,0.5,0.5,0.5\n");
    let rows: String = ["-1e9", "0.0158", "-1e9", "-1e9", "0.5", "1"]
        .map(row)
        .concat();
    let flight = read(&format!("t_s,motor1,motor2,motor3,motor4\n{rows}")).unwrap();
    assert!(
        flight.commands.t_s().is_sorted(),
        "{:?}",
        flight.commands.t_s()
    );
    assert_eq!(flight.commands.len(), 5);
}
