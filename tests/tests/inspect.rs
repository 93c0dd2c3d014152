//! `flagred inspect` from a user's point of view.

use std::io::Write;
use std::process::Stdio;

use flagred_tests::flagred;
use serde_json::Value;

const LOG: &str = "\
# vehicle: test quad
# pwm_low_us: 1000
# pwm_high_us: 2000
# effective_low: 0.15
# effective_high: 0.95
t_s,pwm1,pwm2,in_air,roll_deg
0.00,1000,1000,0,0.0
0.04,1550,1550,1,0.5
0.08,1950,1150,1,0.6
0.12,1550,1550,0,0.7
";

fn inspect(arguments: &[&str], log: &str) -> (Option<i32>, String, String) {
    let mut running = flagred()
        .arg("inspect")
        .args(arguments)
        .arg("-")
        .stdin(Stdio::piped())
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .unwrap();
    let mut stdin = running.stdin.take().unwrap();
    stdin.write_all(log.as_bytes()).unwrap();
    drop(stdin);
    let output = running.wait_with_output().unwrap();
    let text = |bytes: &[u8]| String::from_utf8_lossy(bytes).into_owned();
    (
        output.status.code(),
        text(&output.stdout),
        text(&output.stderr),
    )
}

#[test]
fn the_document_contains_values_and_their_sources() {
    let (code, stdout, _) = inspect(&["--json"], LOG);
    assert_eq!(code, Some(0));
    let document: Value = serde_json::from_str(&stdout).unwrap();
    assert_eq!(document["vehicle"]["frame"], "test quad");
    assert_eq!(document["motors"][1]["source"], "column `pwm2`");
    assert_eq!(
        document["range"]["source"],
        "header pwm_low_us, pwm_high_us"
    );
    assert_eq!(document["in_air"]["spans"][0]["start_s"], 0.04);
    assert_eq!(document["signals"][0]["unit"], "deg");
    assert_eq!(document["read"]["messages"], 4);
    // In the air, the commands on the effective range are 0.5, 0.5, 1 and 0.
    let statistics = &document["statistics"];
    for (name, expected) in [
        ("margin_mean", 0.25),
        ("margin_min", 0.0),
        ("margin_std", 0.25),
        ("margin_mean_of_min", 0.25),
        ("command_mean", 0.5),
        ("command_std", 0.125_f64.sqrt()),
    ] {
        let value = statistics[name].as_f64().unwrap();
        assert!((value - expected).abs() < 1e-12, "{name}: {value}");
    }
}

#[test]
fn missing_values_are_reported_with_the_reason() {
    let (code, stdout, _) = inspect(&[], "t_s,pwm1\n0,1500\n1,1500\n");
    assert_eq!(code, Some(0));
    assert!(
        stdout.contains("NA: the range of the motor commands is not in the log"),
        "{stdout}"
    );
    assert!(
        stdout.contains("at 1.0 Hz, too slow for a spread"),
        "{stdout}"
    );
}

#[test]
fn a_file_that_is_not_a_log_exits_with_3() {
    for (log, said) in [
        ("", "`standard input` is empty"),
        ("hello\n", "is a text file, not a flight log"),
        ("t_s,pwm2\n0,1500\n", "no `pwm1`"),
    ] {
        let (code, stdout, stderr) = inspect(&[], log);
        assert_eq!(code, Some(3), "{log}");
        assert!(stdout.is_empty() && stderr.contains(said), "{stderr}");
    }
}

/// Control sequences in the texts of a log do not reach the terminal.
#[test]
fn control_characters_are_shown_as_such() {
    let (code, stdout, _) = inspect(&[], &format!("# note: \u{1b}[31mred\u{202e}\u{7}\n{LOG}"));
    assert_eq!(code, Some(0));
    assert!(
        stdout.contains("note: \\u{1b}[31mred\\u{202e}\\u{7}"),
        "{stdout}"
    );
}

/// Limits that no vehicle has would hide a motor at its limit.
#[test]
fn impossible_limits_are_refused() {
    for (header, said) in [
        (
            "# effective_low: -3\n# effective_high: 7\n",
            "`effective_low` is -3, outside 0 to 1",
        ),
        (
            "# pwm_low_us: -50000\n# pwm_high_us: 2000\n",
            "line 1: `pwm_low_us` is -50000, outside 500 to 2500",
        ),
        (
            "# pwm_low_us: 1000\n# pwm_high_us: 1e308\n",
            "line 2: `pwm_high_us` is 1000",
        ),
        (
            "# pwm_low_us: 2000\n# pwm_high_us: 1000\n",
            "line 2: `pwm_high_us` is not above `pwm_low_us`",
        ),
        (
            "# pwm_low_us: 1500\n# pwm_high_us: 1500.5\n",
            "line 2: `pwm_high_us` is less than 100 above `pwm_low_us`",
        ),
        (
            "# pwm_high_us: 2000\n",
            "line 1: `pwm_high_us` is given without `pwm_low_us`",
        ),
        (
            "# effective_low: 0.95\n# effective_high: 0.15\n",
            "line 2: `effective_high` is not above `effective_low`",
        ),
        (
            "# effective_low: 0.5\n# effective_high: 0.55\n",
            "line 2: `effective_high` is less than 0.1 above `effective_low`",
        ),
        (
            "# effective_low: 0.15\n",
            "line 1: `effective_low` is given without `effective_high`",
        ),
    ] {
        let (code, _, stderr) = inspect(&[], &format!("{header}t_s,pwm1\n0,2000\n"));
        assert_eq!(code, Some(3));
        assert!(stderr.contains(said), "{stderr}");
    }
}

/// A truncated number still looks like a number, so a last row without a line end is not used. Every command reports
/// that the end is missing.
#[test]
fn an_incomplete_last_row_counts_as_truncation() {
    let whole =
        "# pwm_low_us: 1000\n# pwm_high_us: 2000\nt_s,roll_deg,pwm1\n0,1,1500\n0.1,1,1600\n";
    let read = |log: &str, signals: Option<Vec<String>>| {
        let mut options = flagred_flightlog::Options::default();
        options.signals = signals;
        flagred_flightlog::read(log.as_bytes(), &options).unwrap()
    };
    for signals in [None, Some(Vec::new())] {
        let flight = read(whole, signals.clone());
        assert!(flight.report.is_clean());
        assert_eq!(flight.commands.len(), 2);
        // A comment without a line end, and carriage returns, do not truncate a row.
        for log in [format!("{whole}# end"), whole.replace('\n', "\r\n")] {
            assert!(read(&log, signals.clone()).report.is_clean());
        }
        for (cut, rows) in [(1, 1), (3, 1), (6, 1), (9, 1), (11, 1), (12, 0)] {
            let flight = read(&whole[..whole.len() - cut], signals.clone());
            assert_eq!(flight.commands.len(), rows, "{cut}");
            assert!(flight.report.truncated || cut == 11, "{cut}");
        }
        let flight = read(&format!("{whole}0.2,1\n"), signals);
        assert!(flight.report.truncated && flight.report.bad_messages == 1);
    }
    let torn = &whole[..whole.len() - 2];
    let (_, stdout, _) = inspect(&[], torn);
    assert!(
        stdout.contains("cut off at its end\n")
            && stdout.contains("line 5: the last row has no line end"),
        "{stdout}"
    );
}

#[test]
fn a_plane_is_shown_and_exits_with_3() {
    let (code, stdout, _) = inspect(&[], &format!("# vehicle_kind: plane\n{LOG}"));
    assert_eq!(code, Some(3));
    assert!(
        stdout.contains("the vehicle is a plane, not a multirotor"),
        "{stdout}"
    );
}
