//! `flagred assess` from a user's point of view: on the shipped flight, other files and damaged logs.

use std::{fs, path::Path, process::Output};

use flagred_tests::{
    Folder, STEADY, flagred,
    log_writer::{HEARTBEAT, SERVO_OUTPUT_RAW, Tlog},
    reference_data,
};
use serde_json::Value;

fn assess(arguments: &[&str]) -> Output {
    flagred().arg("assess").args(arguments).output().unwrap()
}

fn json(log: impl AsRef<Path>) -> (Option<i32>, Value) {
    let output = assess(&["--json", log.as_ref().to_str().unwrap()]);
    let document = serde_json::from_slice(&output.stdout).unwrap_or(Value::Null);
    (output.status.code(), document)
}

#[test]
fn the_shipped_flight_in_words() {
    let output = assess(&[STEADY]);
    let text = String::from_utf8(output.stdout).unwrap();
    assert_eq!(output.status.code(), Some(0), "{text}");
    assert!(text.starts_with("GOOD "), "{text}");
    assert!(text.contains("4 motors (C1..C4)"), "{text}");
    assert!(text.contains("risk over time"), "{text}");
}

#[test]
fn the_shipped_flight_as_json() {
    let (code, document) = json(STEADY);
    assert_eq!(code, Some(0));
    for key in [
        "schema", "log", "vehicle", "read", "verdict", "findings", "summary", "steps",
    ] {
        assert!(!document[key].is_null(), "`{key}` is missing");
    }
    assert_eq!(document["verdict"], "GOOD");
    assert_eq!(document["vehicle"]["motors"][2]["output"], "C3");
    let steps = document["steps"].as_array().unwrap();
    // 129 s in the air with a step every 0.1 s; the samples of the log are 0.04 s apart.
    assert!((1250..1300).contains(&steps.len()), "{}", steps.len());
    let step = &steps[600];
    for key in [
        "t_s",
        "margin",
        "spread",
        "coverage",
        "filled",
        "risk",
        "risk_low",
        "risk_high",
        "elevated_risk",
    ] {
        assert!(!step[key].is_null(), "`{key}` of {step}");
    }
}

#[test]
fn csv_has_a_row_for_each_step_of_the_json() {
    let output = assess(&["--csv", STEADY]);
    let text = String::from_utf8(output.stdout).unwrap();
    let (head, rows) = text.split_once('\n').unwrap();
    assert!(
        head.starts_with("t_s,margin,spread,coverage,filled,risk,risk_low,risk_high,elevated_risk"),
        "{head}"
    );
    let (_, document) = json(STEADY);
    let steps = document["steps"].as_array().unwrap();
    assert_eq!(rows.lines().count(), steps.len());
    // The column of an input begins with `input_`, so that it differs from columns such as `spread`; the names are
    // those of the JSON document.
    let names: Vec<&str> = head.split(',').collect();
    let step = &steps[800];
    let of_csv = |name: &str| {
        let column = names.iter().position(|known| *known == name).unwrap();
        let row = rows.lines().nth(800).unwrap();
        row.split(',').nth(column).unwrap().parse::<f64>().unwrap()
    };
    for (name, value) in step["inputs"].as_object().unwrap() {
        let value = value.as_f64().unwrap();
        assert!(
            (of_csv(&format!("input_{name}")) - value).abs() < 1e-12,
            "{name}"
        );
    }
    assert!((of_csv("spread") - step["spread"].as_f64().unwrap()).abs() < 1e-12);
    for (row, step) in rows.lines().zip(steps) {
        let risk = row.split(',').nth(5).unwrap();
        // JSON rounds the last digit.
        match (risk.parse::<f64>().ok(), step["risk"].as_f64()) {
            (Some(a), Some(b)) => assert!((a - b).abs() < 1e-12, "{row}"),
            (a, b) => assert_eq!(a, b, "{row}"),
        }
        let [low, high] = ["risk_low", "risk_high"].map(|end| step[end].as_f64());
        assert!(low <= step["risk"].as_f64() && step["risk"].as_f64() <= high);
        for (end, column) in [(low, 6), (high, 7)] {
            let of_csv = row.split(',').nth(column).unwrap().parse::<f64>().ok();
            assert_eq!(of_csv.is_some(), end.is_some(), "{row}");
        }
    }
}

#[test]
fn several_logs_are_named_and_a_failure_does_not_stop_the_others() {
    let output = assess(&["--csv", STEADY, "/nowhere.BIN", STEADY]);
    let text = String::from_utf8(output.stdout).unwrap();
    assert_eq!(output.status.code(), Some(3));
    assert!(text.starts_with("log,t_s,"));
    assert_eq!(text.matches("log,t_s,").count(), 1, "one head");
    assert!(String::from_utf8_lossy(&output.stderr).contains("`/nowhere.BIN`"));
}

#[test]
fn each_log_is_one_line_and_a_failed_flight_decides_the_exit_code_before_a_missing_verdict() {
    let folder = Folder::new();
    let row = |i: u32, low: f64| format!("{},{low},1,{low},1\n", f64::from(i) * 0.04);
    let head = "t_s,motor1,motor2,motor3,motor4\n";
    let failing = folder.file(
        "failing.csv",
        (0..1000).fold(head.to_owned(), |csv, i| csv + &row(i, 0.0)),
    );
    let short = folder.file(
        "short.csv",
        (0..10).fold(head.to_owned(), |csv, i| csv + &row(i, 0.0)),
    );
    for (logs, code) in [
        (&[&*failing, &short][..], 1),
        (&[&short, &failing], 1),
        (&[&failing, "/nowhere.BIN"], 1),
        (&[&failing, STEADY], 1),
        (&[&short, STEADY], 3),
        (&[STEADY, "/nowhere.BIN"], 3),
        (&[&short, &short], 3),
        (&[STEADY, STEADY], 0),
    ] {
        let output = assess(logs);
        let text = String::from_utf8(output.stdout).unwrap();
        assert_eq!(output.status.code(), Some(code), "{logs:?}: {text}");
        let known = logs.iter().filter(|log| **log != "/nowhere.BIN");
        assert_eq!(text.lines().count(), known.clone().count(), "{text}");
        for (log, line) in known.zip(text.lines()) {
            let verdict = [(&*failing, "FAIL"), (&short, "NA  "), (STEADY, "GOOD")];
            let (_, verdict) = verdict.into_iter().find(|(name, _)| name == log).unwrap();
            assert!(line.starts_with(&format!("{verdict} {log}: ")), "{line}");
        }
    }
    let output = assess(&["-v", STEADY, STEADY]);
    let text = String::from_utf8(output.stdout).unwrap();
    assert_eq!(text.matches("risk over time").count(), 2, "{text}");
}

#[test]
fn standard_input_is_read_like_a_file() {
    let mut child = flagred()
        .args(["assess", "--json", "-"])
        .stdin(std::process::Stdio::piped())
        .stdout(std::process::Stdio::piped())
        .spawn()
        .unwrap();
    let mut stdin = child.stdin.take().unwrap();
    std::io::Write::write_all(&mut stdin, &fs::read(STEADY).unwrap()).unwrap();
    drop(stdin);
    let document: Value =
        serde_json::from_slice(&child.wait_with_output().unwrap().stdout).unwrap();
    assert_eq!(document["steps"], json(STEADY).1["steps"]);
}

#[test]
fn a_file_that_is_not_a_log_is_identified() {
    let folder = Folder::new();
    let picture = b"\x89PNG\r\n\x1a\n\0\0\0\rIHDR and so on";
    for (name, bytes, said) in [
        ("empty.bin", &b""[..], "is empty"),
        (
            "notes.txt",
            b"took off at noon, landed at one\n",
            "is a text file, not a flight log",
        ),
        ("picture.png", picture, "is a PNG picture, not a flight log"),
        (
            "semicolons.csv",
            b"t_s;pwm1;pwm2\n0;1500;1500\n",
            "is a table with semicolons between its cells, not a flight log",
        ),
    ] {
        let output = assess(&[&folder.file(name, bytes)]);
        let reported = String::from_utf8(output.stderr).unwrap();
        assert_eq!(output.status.code(), Some(3), "{name}");
        assert!(
            reported.contains(said) && reported.contains("help:"),
            "{reported}"
        );
        assert!(output.stdout.is_empty(), "{name}");
    }
}

#[test]
fn a_truncated_log_is_assessed_to_its_end() {
    let bytes = fs::read(STEADY).unwrap();
    let folder = Folder::new();
    let cut = folder.file("cut.bin", &bytes[..bytes.len() / 2]);
    let (code, document) = json(cut);
    assert_eq!(code, Some(0));
    assert_eq!(document["read"]["truncated"], true);
    let steps = document["steps"].as_array().unwrap();
    assert!((400..1000).contains(&steps.len()), "{}", steps.len());
}

/// If overwriting hits the definitions of messages, the verdict is NA with a reason. Otherwise the flight is assessed
/// from the remaining messages.
#[test]
fn a_log_with_1_percent_of_its_bytes_overwritten_is_assessed_or_refused_with_a_reason() {
    let intact = fs::read(STEADY).unwrap();
    let folder = Folder::new();
    let mut assessed = 0;
    for seed in 1..=6_u64 {
        let mut bytes = intact.clone();
        let mut random = seed.wrapping_mul(0x9e37_79b9_7f4a_7c15);
        for _ in 0..bytes.len() / 100 {
            random ^= random << 13;
            random ^= random >> 7;
            random ^= random << 17;
            let at = (random >> 16) as usize % bytes.len();
            bytes[at] = random as u8;
        }
        let damaged = folder.file("damaged.bin", &bytes);
        let (code, document) = json(&damaged);
        assert!(
            document["read"]["skipped_bytes"].as_u64().unwrap() > 1000,
            "seed {seed}"
        );
        if document["verdict"] == "NA" {
            assert_eq!(code, Some(3), "seed {seed}");
            assert!(
                !document["reason"].as_str().unwrap().is_empty(),
                "seed {seed}"
            );
            continue;
        }
        assert!(matches!(code, Some(0 | 1)), "seed {seed}: {code:?}");
        let steps = document["steps"].as_array().unwrap();
        let known = steps.iter().filter(|s| s["risk"].is_number()).count();
        assert!(known > 300, "seed {seed}: {known} steps");
        let words = assess(&[&damaged]);
        let text = String::from_utf8(words.stdout).unwrap();
        assert!(text.contains("damaged log, read in part"), "{text}");
        assessed += 1;
    }
    assert!(assessed > 0);
}

#[test]
fn a_rate_too_low_for_a_spread_gives_no_verdict() {
    let mut rows = String::from("t_s,motor1,motor2,motor3,motor4\n");
    for t in 0..120 {
        rows += &format!("{t},0.4,0.41,0.42,0.4\n");
    }
    let folder = Folder::new();
    let output = assess(&[&folder.file("slow.csv", rows)]);
    let text = String::from_utf8(output.stdout).unwrap();
    assert_eq!(output.status.code(), Some(3));
    assert!(text.starts_with("NA ") && text.contains("help:"), "{text}");
}

#[test]
fn a_missing_signal_that_the_profile_needs_gives_no_verdict() {
    let folder = Folder::new();
    let profile = folder.file(
        "wind.yaml",
        b"flagred: 1\nname: wind\nrules: wind-rules.yaml\ninputs: {wind: {mean: anemometer_m_s}}\n",
    );
    folder.file(
        "wind-rules.yaml",
        "fuzzy: 1\nname: wind\ninputs: {wind: {range: [0, 20], partition: [calm, storm]}}\n\
         outputs: {risk: {range: [0, 100], partition: [low, high]}}\n\
         rules: [IF wind IS calm THEN risk IS low, IF wind IS storm THEN risk IS high]\n",
    );
    let output = assess(&["--profile", &profile, STEADY]);
    let text = String::from_utf8(output.stdout).unwrap();
    assert_eq!(
        output.status.code(),
        Some(3),
        "{text}{}",
        String::from_utf8_lossy(&output.stderr)
    );
    assert!(text.contains("`anemometer_m_s`"), "{text}");
}

/// Covers every simulated flight that comes with a record of its events.
#[test]
#[ignore = "needs FLAGRED_SHARED"]
fn the_simulated_flights_are_all_assessed() {
    let data = reference_data();
    let folder = data.join("flights");
    for name in [
        "hover_calm",
        "steady",
        "intermittent",
        "payload",
        "octoquad",
        "octoquad_crash",
    ] {
        let (code, document) = json(folder.join(format!("{name}.BIN")));
        assert!(matches!(code, Some(0 | 1)), "{name}: {code:?}");
        let in_air_s = document["summary"]["in_air_s"].as_f64().unwrap();
        let assessed_s = document["summary"]["assessed_s"].as_f64().unwrap();
        assert!(
            in_air_s > 100.0 && assessed_s > in_air_s - 3.0,
            "{name}: {assessed_s} of {in_air_s} s"
        );
    }
}

/// A tlog of a quadrotor that hovers for 20 s, without parameters; the pulses vary from 1490 us to `to_us`.
fn tlog_without_parameters(to_us: u16) -> Vec<u8> {
    let mut log = Tlog::default();
    for row in 0..500_u32 {
        let stamp_us = 1_700_000_000_000_000 + 40_000 * u64::from(row);
        if row % 25 == 0 {
            log.packet(
                stamp_us,
                2,
                (1, 1),
                HEARTBEAT,
                &[0, 0, 0, 0, 2, 3, 128, 4, 3],
            );
        }
        let mut servos = (1_000_000 + 40_000 * row).to_le_bytes().to_vec();
        for motor in 0..8_u16 {
            let sway = ((row as u16 + 3 * motor) * 7) % 20;
            let pulse_us = match motor {
                0 if row == 250 => to_us,
                0..4 => 1490 + sway,
                _ => 0,
            };
            servos.extend(pulse_us.to_le_bytes());
        }
        servos.push(0);
        log.packet(stamp_us, 2, (1, 1), SERVO_OUTPUT_RAW, &servos);
    }
    log.bytes
}

#[test]
fn a_given_range_replaces_only_an_assumed_one() {
    let folder = Folder::new();
    let log = folder.file("flight.tlog", tlog_without_parameters(1510));
    let range = |arguments: &[&str]| {
        let output = assess(&[arguments, &["--json", log.as_str()]].concat());
        let document: Value = serde_json::from_slice(&output.stdout).unwrap();
        let vehicle = &document["vehicle"];
        (vehicle["range"].clone(), vehicle["assumed"].to_string())
    };
    let (assumed, words) = range(&[]);
    assert_eq!(
        (&assumed["low"], &assumed["high"]),
        (&1000.0.into(), &2000.0.into())
    );
    assert!(words.contains("commands from 1000 to 2000 us"), "{words}");
    let (given, words) = range(&["--range", "1100", "1900"]);
    assert_eq!(
        (&given["low"], &given["high"]),
        (&1100.0.into(), &1900.0.into())
    );
    assert!(
        words.contains("commands from 1100 to 1900 us, given by the user"),
        "{words}"
    );
    assert!(words.contains("effective range 0.15 to 0.95"), "{words}");

    let refused = |log: &str, range: [&str; 2], code: i32, why: &str| {
        let output = assess(&["--range", range[0], range[1], log]);
        let error = String::from_utf8(output.stderr).unwrap();
        assert_eq!(output.status.code(), Some(code), "{error}");
        assert!(error.contains(why), "{error}");
    };
    let log = log.as_str();
    refused(
        log,
        ["1900", "1100"],
        2,
        "expected two pulse widths from 500 to 2500 us",
    );
    refused(
        log,
        ["100", "1900"],
        2,
        "write microseconds from 500 to 2500",
    );
    refused(
        STEADY,
        ["1100", "1900"],
        3,
        "reports its own range, 1000 to 2000 us (MOT_PWM_MIN/MAX)",
    );
    refused(
        log,
        ["1000", "1400"],
        3,
        "has motor commands up to 1510 us, above the given range",
    );
}

#[test]
fn a_converted_log_still_names_the_range_as_given() {
    let folder = Folder::new();
    let log = folder.file("flight.tlog", tlog_without_parameters(1510));
    let csv = folder.at("flight.csv");
    let paths = [log.as_str(), &csv];
    let arguments = [
        "convert", "--range", "1100", "1900", paths[0], "-o", paths[1],
    ];
    let output = flagred().args(arguments).output().unwrap();
    assert_eq!(output.status.code(), Some(0), "{output:?}");
    let output = assess(&[paths[1]]);
    let text = String::from_utf8(output.stdout).unwrap();
    assert!(
        text.contains("1100 to 1900 us, given by the user"),
        "{text}"
    );
}
