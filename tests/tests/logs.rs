//! Flight logs compared with reference values from pymavlink and pyulog, which are part of the reference data:
//! `FLAGRED_SHARED` is the folder that contains `data/`.

use std::collections::HashMap;
use std::io::Read;
use std::path::Path;

use flagred_flightlog::{Flight, Interval, Options, Range, Statistics};
use flagred_tests::reference_data;
use flate2::read::GzDecoder;
use serde_json::Value;

fn open(path: &Path) -> Flight {
    flagred_flightlog::open(path, &Options::default()).unwrap()
}

fn gunzip(path: &Path) -> String {
    let file = std::fs::File::open(path).unwrap_or_else(|e| panic!("{}: {e}", path.display()));
    let mut text = String::new();
    GzDecoder::new(file).read_to_string(&mut text).unwrap();
    text
}

/// A CSV table as columns; empty cells are `None`.
fn columns(text: &str) -> HashMap<String, Vec<Option<f64>>> {
    let mut lines = text.lines();
    let names: Vec<&str> = lines.next().unwrap().split(',').collect();
    let mut columns = vec![Vec::new(); names.len()];
    for line in lines {
        for (column, cell) in columns.iter_mut().zip(line.split(',')) {
            column.push(cell.parse().ok());
        }
    }
    let names = names.into_iter().map(str::to_owned);
    names.zip(columns).collect()
}

#[track_caller]
fn close(what: &str, ours: f64, theirs: &Value, relative: f64) {
    let theirs = theirs
        .as_f64()
        .unwrap_or_else(|| panic!("{what} is not in the truth"));
    let tolerance = relative * theirs.abs().max(1e-9);
    assert!(
        (ours - theirs).abs() <= tolerance,
        "{what}: {ours} instead of {theirs}"
    );
}

fn compare_statistics(log: &str, ours: &Statistics, truth: &Value) {
    assert_eq!(
        Some(ours.samples as u64),
        truth["n_samples"].as_u64(),
        "{log}: rows in the air"
    );
    for (name, value) in [
        ("mean_margin", ours.margin_mean),
        ("min_margin", ours.margin_min),
        ("std_margin", ours.margin_std),
        ("mean_of_min_over_motors", ours.margin_mean_of_min),
        ("mean_command", ours.command_mean),
        ("std_command", ours.command_std),
    ] {
        close(&format!("{log}: {name}"), value, &truth[name], 1e-6);
    }
}

fn compare_range(log: &str, range: &Range, low: &Value, high: &Value) {
    close(
        &format!("{log}: low end from {}", range.source),
        range.low,
        low,
        1e-9,
    );
    close(
        &format!("{log}: high end from {}", range.source),
        range.high,
        high,
        1e-9,
    );
}

/// For rows without their own time, the reference uses the time of the preceding GPS message, in UTC; our times are
/// interpolated between GPS messages, on the clock since boot.
fn has_times(log: &str) -> bool {
    log != "aptxt_mechanical_fail.log"
}

/// Removes the single row that is in the air here but on the ground in the reference. The reference has no minimum
/// duration of landings.
fn remove_chatter(flight: &mut Flight, truth: &HashMap<String, Vec<Option<f64>>>) {
    let t_s = flight.commands.t_s().to_vec();
    let is_other = |row: &usize| {
        flight.is_in_air(t_s[*row]) == Some(true) && truth["in_air"][*row] == Some(0.0)
    };
    let rows: Vec<usize> = (0..t_s.len()).filter(is_other).collect();
    let &[row] = rows.as_slice() else {
        panic!("rows {rows:?} are not in the air for the reference");
    };
    let spans = &mut flight.in_air.as_mut().unwrap().spans;
    let [span] = spans[..] else {
        panic!("{spans:?}")
    };
    spans[0].end_s = t_s[row];
    spans[0].ends_with_log = false;
    spans.push(Interval {
        start_s: t_s[row + 1],
        ..span
    });
}

/// Compares times and raw values row by row.
fn compare_rows(log: &str, flight: &Flight, truth: &HashMap<String, Vec<Option<f64>>>) {
    assert_eq!(flight.commands.len(), truth["t_s"].len(), "{log}: rows");
    let (zero_s, tolerance_s) = match has_times(log) {
        true => (0.0, 1e-5),
        false => (truth["t_s"][0].unwrap() - flight.commands.t_s()[0], 0.21),
    };
    for (row, (t_s, raw)) in flight.commands.rows().enumerate() {
        let theirs_s = truth["t_s"][row].unwrap() - zero_s;
        assert!(
            (t_s - theirs_s).abs() < tolerance_s,
            "{log}, row {row}: {t_s}"
        );
        for (motor, &ours) in raw.iter().enumerate() {
            // A motor that is commanded to stop is NaN in PX4 logs, and 0 here.
            let theirs = truth[&format!("u{}", motor + 1)][row].filter(|u| u.is_finite());
            let theirs = theirs.unwrap_or(0.0);
            let tolerance = 1e-6 * theirs.abs().max(1e-9);
            assert!(
                (ours - theirs).abs() <= tolerance,
                "{log}, row {row}: {ours} for {theirs}"
            );
        }
    }
}

/// Compares the attitude row by row, in degrees.
fn compare_attitude(log: &str, flight: &Flight, truth: &HashMap<String, Vec<Option<f64>>>) {
    for name in ["roll_deg", "pitch_deg", "roll_des_deg", "pitch_des_deg"] {
        let theirs = &truth[name.trim_end_matches("_deg")];
        let signal = flight
            .signal(name)
            .unwrap_or_else(|| panic!("{log}: no {name}"));
        for (row, theirs) in theirs.iter().enumerate() {
            let t_s = truth["t_s"][row].unwrap();
            let ours = match has_times(log) {
                true => signal.at(t_s + 1e-5),
                false => Some(signal.values[row]),
            };
            match (ours, theirs) {
                (Some(ours), Some(theirs)) => {
                    let off = (ours - theirs).abs();
                    assert!(off < 1e-3, "{log}, {name} at {t_s}: {ours} for {theirs}");
                }
                (ours, theirs) => assert_eq!(ours, *theirs, "{log}, {name} at {t_s}"),
            }
        }
    }
}

/// Logs that pause while disarmed. The reference counts a pause as flight time (628 s and 55 s) if the row before it is
/// in the air; according to the events, the craft was on the ground.
const PAUSES_ON_THE_GROUND: &[&str] = &["ap_beast_sample.bin", "ap_maik17.bin"];

fn seconds_by_rows(flight: &Flight) -> f64 {
    let in_air = |pair: &&[f64]| flight.is_in_air(pair[0]) == Some(true);
    let pairs = flight.commands.t_s().windows(2);
    pairs.filter(in_air).map(|pair| pair[1] - pair[0]).sum()
}

fn compare(folder: &Path, log: &str) {
    let mut flight = open(&folder.join(log));
    let truth_of = |end: &str| folder.join("truth").join(format!("{log}.{end}"));
    let summary = std::fs::read_to_string(truth_of("summary.json")).unwrap();
    let summary: Value = serde_json::from_str(&summary).unwrap();

    // The reference has only a number for builds that are not releases.
    let firmware = summary["firmware"].as_str().unwrap();
    if !firmware.starts_with("PX4 1") {
        assert_eq!(flight.vehicle.firmware.as_deref(), Some(firmware), "{log}");
    }
    assert_eq!(
        Some(flight.motors.len() as u64),
        summary["n_motors"].as_u64(),
        "{log}"
    );
    for motor in &flight.motors {
        let theirs = &summary["channels"][format!("motor{}", motor.number)];
        if let Some(theirs) = theirs.as_str() {
            assert_eq!(
                motor.output.replace("Mot", "C"),
                theirs,
                "{log}: {}",
                motor.source
            );
        }
    }
    let range = flight
        .range
        .as_ref()
        .unwrap_or_else(|| panic!("{log}: no range"));
    match summary.get("pwm_min") {
        Some(low) => compare_range(log, range, low, &summary["pwm_max"]),
        None => compare_range(log, range, &summary["out_min"], &summary["out_max"]),
    }
    if log == "aptxt_mechanical_fail.log" {
        // The reference has no upper limit of the effective range for firmware before 3.4, so that limit is tested
        // here: the smallest margin on the full range is 0.07.
        assert_eq!(flight.effective_range.high, 0.93);
        assert!((flight.full_range_statistics().unwrap().margin_min - 0.07).abs() < 1e-3);
        flight.effective_range.high = 1.0;
        remove_chatter(&mut flight, &columns(&gunzip(&truth_of("motors.csv.gz"))));
    }
    if let Some(low) = summary.get("effective_lo") {
        compare_range(log, &flight.effective_range, low, &summary["effective_hi"]);
    }
    compare_rows(log, &flight, &columns(&gunzip(&truth_of("motors.csv.gz"))));
    compare_attitude(log, &flight, &columns(&gunzip(&truth_of("att.csv.gz"))));

    // The reference adds up the time steps after each row in the air.
    let in_air_s = summary["in_air_s"].as_f64().unwrap();
    let by_rows_s = seconds_by_rows(&flight);
    assert!(
        (by_rows_s - in_air_s).abs() < 0.2,
        "{log}: {by_rows_s} s in the air for {in_air_s}"
    );
    if !PAUSES_ON_THE_GROUND.contains(&log) {
        let spans_s = flight.in_air.as_ref().unwrap().duration_s();
        assert!(
            (spans_s - in_air_s).abs() < 0.2,
            "{log}: {spans_s} s in the air for {in_air_s}"
        );
    }
    let full = flight.full_range_statistics().unwrap();
    compare_statistics(log, &full, &summary["full_range"]);
    if summary["effective_range"].is_object() {
        compare_statistics(
            log,
            &flight.statistics().unwrap(),
            &summary["effective_range"],
        );
    }
}

#[test]
#[ignore = "needs FLAGRED_SHARED"]
fn simulated_flights_are_as_in_their_reference() {
    let data = reference_data();
    for log in [
        "hover_calm.BIN",
        "steady.BIN",
        "intermittent.BIN",
        "payload.BIN",
        "octoquad.BIN",
        "octoquad_crash.BIN",
    ] {
        compare(&data.join("flights"), log);
    }
}

#[test]
#[ignore = "needs FLAGRED_SHARED"]
fn public_logs_are_as_in_their_reference() {
    let data = reference_data();
    for log in [
        "ap_beast_mechfail36.bin",
        "ap_beast_sample.bin",
        "ap_delorean183.bin",
        "ap_maik17.bin",
        "aptxt_mechanical_fail.log",
        "px_3dr1.ulg",
        "px_esc.ulg",
        "px_events.ulg",
        "px_quadlocal.ulg",
        "px_stifael.ulg",
        "x_trunc_px_quadlocal.ulg",
    ] {
        compare(&data.join("logs"), log);
    }
}

/// The rows contain every row that pyulog recovers from the damaged log, and more.
#[test]
#[ignore = "needs FLAGRED_SHARED"]
fn a_damaged_log_gives_at_least_as_much_as_its_reference() {
    let data = reference_data();
    let log = data.join("logs/x_corrupt_px_quadlocal.ulg");
    let flight = open(&log);
    let truth = data.join("logs/truth/x_corrupt_px_quadlocal.ulg.motors.csv.gz");
    let truth = columns(&gunzip(&truth));
    let ours: HashMap<i64, &[f64]> = flight
        .commands
        .rows()
        .map(|(t_s, row)| ((t_s * 1e6).round() as i64, row))
        .collect();
    for (row, t_s) in truth["t_s"].iter().enumerate() {
        let t_us = (t_s.unwrap() * 1e6).round() as i64;
        let ours = ours
            .get(&t_us)
            .unwrap_or_else(|| panic!("no row at {t_us} us"));
        let theirs = truth["u1"][row].unwrap();
        assert!(
            (ours[0] - theirs).abs() <= 1e-6 * theirs.abs(),
            "row at {t_us} us"
        );
    }
    let whole = open(&data.join("logs/px_quadlocal.ulg"));
    assert_eq!((truth["t_s"].len(), whole.commands.len()), (915, 926));
    assert!(
        flight.commands.len() >= 925,
        "{} rows",
        flight.commands.len()
    );
    assert!(flight.report.skipped_bytes > 0 && flight.report.reason.is_some());
}

/// For each log that cannot be assessed, the statistics are an error with the reason.
#[test]
#[ignore = "needs FLAGRED_SHARED"]
fn logs_without_a_verdict_report_the_reason() {
    let data = reference_data();
    for (log, why) in [
        (
            "ap_pymavlink_test.bin",
            "the vehicle is a plane, not a multirotor",
        ),
        ("ap_methodic_80k.bin", "the motors were never armed"),
        (
            "aptxt_octo.log",
            "the commands of the motors are not in the log",
        ),
        (
            "aptxt_underpowered.log",
            "the commands of the motors are not in the log",
        ),
        (
            "px_6ba1.ulg",
            "the commands of the motors are not in the log",
        ),
        ("px_sample.ulg", "the motors were never armed"),
        ("px_appended_multi.ulg", "the motors were never armed"),
        (
            "px_small.ulg",
            "the vehicle is a VTOL plane, not a multirotor",
        ),
    ] {
        let error = open(&data.join("logs").join(log)).statistics().unwrap_err();
        assert!(error.to_string().starts_with(why), "{log}: {error}");
    }
}

/// Numbers that pymavlink 2.4.50 reads from the log, on the vehicle's clock: one packet of each message arrives 1.2 s
/// late, so two rows that are not later than the preceding ones are missing.
#[test]
#[ignore = "needs FLAGRED_SHARED"]
fn telemetry_agrees_with_the_pymavlink_reference() {
    let data = reference_data();
    let flight = open(&data.join("logs/tl_vtol.tlog"));
    assert!(flight.report.is_clean());
    assert_eq!(flight.report.messages, 23_894);
    assert_eq!(flight.commands.len(), 795);
    let outputs: Vec<&str> = flight.motors.iter().map(|m| m.output.as_str()).collect();
    let (servo5, servo8) = (0, 3);
    assert_eq!(
        (outputs[servo5], outputs[servo8]),
        ("servo5_raw", "servo8_raw")
    );
    let sum = |motor: usize| {
        flight
            .commands
            .rows()
            .map(|(_, row)| row[motor])
            .sum::<f64>()
    };
    assert_eq!((sum(servo5), sum(servo8)), (1_044_766.0, 988_000.0));
    assert!((flight.commands.t_s()[400] - 720.382_782).abs() < 1e-9);
    let roll = flight.signal("roll_deg").unwrap();
    assert_eq!(roll.values.len(), 886);
    assert!((roll.t_s[500] - 722.446).abs() < 1e-9);
    assert!((roll.values[500] - 46.123_775_691).abs() < 1e-6);
}

#[test]
#[ignore = "needs FLAGRED_SHARED"]
fn flight_csv_series_are_read_completely() {
    let data = reference_data();
    let flight = open(&data.join("sitl2/timeseries/f000.csv.gz"));
    assert!(flight.report.is_clean(), "{:?}", flight.report);
    assert_eq!(flight.motors.len(), 8);
    assert_eq!(flight.vehicle.frame.as_deref(), Some("x8_def_c60"));
    assert_eq!(flight.effective_range.low, 0.15);
    assert!(flight.signal("climb_m_s").is_some());
    assert!(
        flight
            .header
            .contains(&("judged_from_s".into(), "16.34".into()))
    );
    assert!((flight.command_rate_hz().unwrap() - 25.0).abs() < 1e-6);
    flight.statistics().unwrap();
}

/// Commands computed from torque and thrust set points, compared with those that PX4 recorded. They are computed for a
/// copy of the log in which the topics of motors have other names.
#[test]
#[ignore = "needs FLAGRED_SHARED, the folder with reference data"]
fn computed_motor_commands_are_those_of_px4() {
    let data = reference_data();
    for log in [
        "logs/px_events.ulg",
        "logs/px_quadlocal.ulg",
        "px4sim/m1.ulg.gz",
        "px4sim/p1.ulg.gz",
    ] {
        let mut bytes = std::fs::read(data.join(log)).unwrap();
        if log.ends_with(".gz") {
            let mut unpacked = Vec::new();
            GzDecoder::new(&bytes[..])
                .read_to_end(&mut unpacked)
                .unwrap();
            bytes = unpacked;
        }
        let recorded = flagred_flightlog::read(&bytes[..], &Options::default()).unwrap();
        for topic in [&b"actuator_motors"[..], b"actuator_outputs"] {
            let found = bytes.windows(topic.len()).enumerate();
            let places = found.filter(|(_, bytes)| *bytes == topic);
            for at in places.map(|(at, _)| at).collect::<Vec<_>>() {
                bytes[at] = b'x';
            }
        }
        let computed = flagred_flightlog::read(&bytes[..], &Options::default()).unwrap();
        assert_eq!(computed.motors.len(), recorded.motors.len());
        assert!(computed.assumed[0].contains("set points"), "{log}");
        let mut rows = computed.commands.rows().peekable();
        let mut latest = None;
        let mut errors = Vec::new();
        for (t_s, row) in recorded.commands.rows() {
            while let Some(next) = rows.next_if(|(next_s, _)| *next_s <= t_s) {
                latest = Some(next.1);
            }
            // PX4 stops a failed motor, which no set point shows.
            let is_driven = row.iter().all(|&command| command > 0.0);
            if is_driven
                && recorded.is_in_air(t_s) == Some(true)
                && let Some(latest) = latest
            {
                errors.extend(row.iter().zip(latest).map(|(a, b)| (a - b).abs()));
            }
        }
        errors.sort_by(f64::total_cmp);
        let share = |share: f64| errors[(share * (errors.len() - 1) as f64) as usize];
        let (median, most) = (share(0.5), share(0.99));
        eprintln!(
            "{log}: {} commands, median {median:.4}, 99 % {most:.4}",
            errors.len()
        );
        assert!(median < 0.005 && most < 0.05, "{log}: {median} {most}");
    }
}
