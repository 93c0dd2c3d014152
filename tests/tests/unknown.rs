//! If a log lacks motors or the end of a flight, the verdict is never GOOD, whatever the format of the log.

use std::fmt::Write as _;

use flagred::{
    flight::{Reason, Verdict},
    log::assess,
    shipped,
};
use flagred_flightlog::{Options, ReadError};
use flagred_tests::{
    Folder, flagred,
    log_writer::{DataFlash, ULog, Value},
};

/// Runs `flagred assess` on a flight CSV; returns the exit code and the output.
fn assess_csv(csv: &str, more: &[&str]) -> (Option<i32>, String) {
    let folder = Folder::new();
    let log = folder.file("flight.csv", csv.as_bytes());
    let output = flagred()
        .arg("assess")
        .arg(log)
        .args(more)
        .output()
        .unwrap();
    let text = [output.stdout, output.stderr].concat();
    (output.status.code(), String::from_utf8(text).unwrap())
}

/// A flight of a hexarotor, 60 s at 25 Hz. From 20 s on, its motors alternate between their limits. Motors not in
/// `known` have empty cells.
fn hexa(frame: &str, known: &[usize]) -> String {
    let mut csv = format!(
        "# vehicle_kind: multirotor\n{frame}t_s,motor1,motor2,motor3,motor4,motor5,motor6,in_air\n"
    );
    for i in 0..1500 {
        let t_s = f64::from(i) * 0.04;
        let up = (t_s as u32).is_multiple_of(2);
        let _ = write!(csv, "{t_s}");
        for motor in 0..6 {
            let command = match (t_s > 20.0, up == (motor % 2 == 0)) {
                (false, _) => 0.5,
                (true, true) => 1.0,
                (true, false) => 0.0,
            };
            match known.contains(&motor) {
                true => write!(csv, ",{command}"),
                false => write!(csv, ","),
            }
            .unwrap();
        }
        csv += ",1\n";
    }
    csv
}

#[test]
fn a_motor_without_commands_prevents_a_verdict() {
    for frame in ["", "# frame: HEXA/X\n", "# frame: HEXA/PLUS\n"] {
        for profile in ["flagred", "flagred-paper"] {
            let more = ["--profile", profile];
            let (code, text) = assess_csv(&hexa(frame, &[0, 1, 2, 3, 4, 5]), &more);
            assert_eq!(code, Some(1), "{frame} {profile}: {text}");
            for known in [&[5][..], &[0, 1, 2, 4, 5], &[0, 2, 4]] {
                let (code, text) = assess_csv(&hexa(frame, known), &more);
                let missing = (0..6).find(|motor| !known.contains(motor)).unwrap() + 1;
                assert_eq!(code, Some(3), "{frame} {profile} {known:?}: {text}");
                let reason = format!(
                    "the command of motor {missing} is unknown in the air from 0.0 to 60.0 s"
                );
                assert!(text.contains(&reason), "{known:?}: {text}");
            }
            let (code, text) = assess_csv(&hexa(frame, &[]), &more);
            assert_eq!(code, Some(3), "{text}");
            assert!(
                text.contains("the commands of the motors are not in the log"),
                "{text}"
            );
        }
    }
}

#[test]
fn a_motor_without_commands_for_a_while_prevents_a_verdict_unless_the_flight_fails() {
    let whole = hexa("", &[0, 1, 2, 3, 4, 5]);
    let without = |from_s: f64, to_s: f64| -> String {
        let rows = whole.lines().map(|row| {
            let mut cells: Vec<&str> = row.split(',').collect();
            if cells[0]
                .parse()
                .is_ok_and(|t_s: f64| from_s <= t_s && t_s < to_s)
            {
                cells[3] = "";
            }
            cells.join(",") + "\n"
        });
        rows.collect()
    };
    // One motor is unknown for as long as the motors oscillate.
    let (code, text) = assess_csv(&without(20.0, 60.0), &[]);
    assert_eq!(code, Some(3), "{text}");
    assert!(
        text.contains("motor 3 is unknown in the air from 20.0 to 60.0 s"),
        "{text}"
    );
    // If the motor is known during a part of the oscillation, the flight fails; a moment without the motor changes nothing.
    for (from_s, to_s) in [(50.0, 60.0), (22.0, 22.5), (10.0, 10.5)] {
        let (code, text) = assess_csv(&without(from_s, to_s), &[]);
        assert_eq!((code, text.starts_with("FAIL")), (Some(1), true), "{text}");
    }
}

/// A DataFlash log of a hexacopter: parameters, then rows of outputs from `outputs(t_s)` at 25 Hz. It takes off at 1 s.
/// `clock_back` is a time, and the amount in seconds by which the clock goes back at that time.
fn dataflash(outputs: impl Fn(f64) -> [u16; 6], clock_back: Option<(f64, f64)>) -> Vec<u8> {
    let mut log = DataFlash::new();
    log.define(129, "PARM", "QNf", "TimeUS,Name,Value");
    log.define(130, "RCOU", "QHHHHHH", "TimeUS,C1,C2,C3,C4,C5,C6");
    log.define(131, "MSG", "QZ", "TimeUS,Message");
    log.define(132, "EV", "QB", "TimeUS,Id");
    for (name, value) in [
        ("MOT_PWM_MIN", 1000.0),
        ("MOT_PWM_MAX", 2000.0),
        ("FRAME_CLASS", 2.0),
    ] {
        log.parameter(1e5, name, value);
    }
    for output in 0..6 {
        log.parameter(
            1e5,
            &format!("SERVO{}_FUNCTION", output + 1),
            f64::from(33 + output),
        );
    }
    log.write("MSG", [1e5.into(), "ArduCopter V4.5.1 (abcdef12)".into()]);
    for (t_s, id) in [(0.5, 10.0), (1.0, 28.0)] {
        log.write("EV", [Value::Number(t_s * 1e6), id.into()]);
    }
    for i in 0..3000 {
        let t_s = 1.0 + f64::from(i) * 0.04;
        let row = outputs(t_s).map(|pulse| Value::Number(pulse.into()));
        let set_back = clock_back.filter(|(at_s, _)| t_s > *at_s);
        let back_s = set_back.map_or(0.0, |(_, by_s)| by_s);
        log.write(
            "RCOU",
            std::iter::once(Value::Number((t_s - back_s) * 1e6)).chain(row),
        );
    }
    log.bytes
}

#[test]
fn outputs_that_are_not_pulses_prevent_a_verdict() {
    let outputs = |t_s: f64| {
        let high = if t_s > 30.0 { 2000 } else { 1500 };
        [1500, u16::MAX, high, 1500, u16::MAX, high]
    };
    let flight =
        flagred_flightlog::read(&dataflash(outputs, None)[..], &Options::default()).unwrap();
    for estimator in [shipped::flagred(), shipped::flagred_paper()] {
        let verdict = assess(&flight, &estimator, None).verdict;
        assert!(
            matches!(
                verdict,
                Verdict::NotAvailable(Reason::MotorUnknown { motor: 2, .. })
            ),
            "{verdict:?}"
        );
    }
}

/// On a live link, the same event is reported as `lost_in_air` (docs/live.md).
#[test]
fn a_clock_that_goes_back_in_the_air_prevents_a_verdict() {
    let calm = |_| [1500; 6];
    let estimator = shipped::flagred();
    let read = |bytes: &[u8]| flagred_flightlog::read(bytes, &Options::default()).unwrap();
    let whole = read(&dataflash(calm, None));
    assert_eq!(assess(&whole, &estimator, None).verdict.to_string(), "GOOD");
    assert!(whole.rebooted_in_air_s.is_empty());

    let lost = read(&dataflash(calm, Some((61.0, 40.0))));
    let mut csv = Vec::new();
    lost.write_csv(&mut csv).unwrap();
    for flight in [&lost, &read(&csv)] {
        assert_eq!(flight.rebooted_in_air_s.len(), 1);
        let verdict = assess(flight, &estimator, None).verdict;
        let Verdict::NotAvailable(reason @ Reason::SetBackInAir { .. }) = &verdict else {
            panic!("{verdict:?}");
        };
        assert_eq!(
            reason.to_string(),
            "the clock goes back in the air at 61.0 s"
        );
    }
    // If the clock goes back by one second only, the rows of that second are dropped.
    let short = read(&dataflash(calm, Some((61.0, 1.0))));
    assert_eq!(short.rebooted_in_air_s, [61.0]);
    assert_eq!(assess(&short, &estimator, None).verdict.to_string(), "NA");
    // If a motor is unknown around a reboot, the reason is the reboot.
    let mut csv = String::from("t_s,motor1,motor2,motor3,motor4,in_air\n");
    for i in 0..1500 {
        let first = if (1000..1200).contains(&i) { "" } else { "0.5" };
        let _ = writeln!(csv, "{},{first},0.5,0.5,0.5,1", f64::from(i) * 0.04);
    }
    let verdict = |csv: &str| assess(&read(csv.as_bytes()), &estimator, None).verdict;
    let Verdict::NotAvailable(Reason::MotorUnknown { .. }) = verdict(&csv) else {
        panic!("{:?}", verdict(&csv));
    };
    let Verdict::NotAvailable(Reason::SetBackInAir { at_s: 40.0 }) =
        verdict(&format!("# rebooted_in_air_s: 40\n{csv}"))
    else {
        panic!("{:?}", verdict(&format!("# rebooted_in_air_s: 40\n{csv}")));
    };
    // Trouble before the reboot gives FAIL.
    let trouble = |t_s: f64| match t_s > 30.0 {
        true => [2000, 1000, 2000, 1000, 2000, 1000],
        false => [1500; 6],
    };
    let failed = assess(
        &read(&dataflash(trouble, Some((61.0, 40.0)))),
        &estimator,
        None,
    );
    assert_eq!(failed.verdict.to_string(), "FAIL");
}

#[test]
fn a_clock_of_px4_that_goes_back_in_the_air_prevents_a_verdict() {
    let fly = |back_at: u64, back_by: u64| {
        let mut log = ULog::new(1_000_000);
        log.define("actuator_motors:uint64_t timestamp;float[12] control;");
        log.define("vehicle_land_detected:uint64_t timestamp;bool landed;");
        log.parameter("CA_ROTOR_COUNT", 4.0);
        log.announce(0, 1, "actuator_motors");
        log.announce(0, 2, "vehicle_land_detected");
        for row in 0..3000 {
            let us = 1_000_000 + 40_000 * (if row < back_at { row } else { row - back_by });
            if row % 25 == 0 {
                log.flags(2, us, &[0]);
            }
            log.floats(1, us + 1000, &[0.4; 12]);
        }
        let flight = flagred_flightlog::read(&log.bytes[..], &Options::default()).unwrap();
        assess(&flight, &shipped::flagred(), None)
            .verdict
            .to_string()
    };
    assert_eq!(fly(3000, 0), "GOOD");
    assert_eq!(fly(1500, 1000), "NA");
    assert_eq!(fly(1500, 25), "NA");
}

#[test]
fn a_flight_csv_whose_clock_starts_again_in_the_air_has_no_verdict() {
    let rows = |air: u8| -> String {
        let row = |i: u32| format!("{},0.5,0.5,0.5,0.5,{air}\n", f64::from(i) * 0.04);
        (0..1000).map(row).collect()
    };
    let head = "t_s,motor1,motor2,motor3,motor4,in_air\n";
    let (code, text) = assess_csv(&format!("{head}{}{}", rows(1), rows(1)), &[]);
    assert_eq!(code, Some(3), "{text}");
    assert!(
        text.contains("the clock goes back in the air at 40.0 s"),
        "{text}"
    );
    // The verdict is the same if the clock goes back by only one second; here the rows of that second are assessed.
    let second: String = rows(1).lines().fold(String::new(), |mut text, row| {
        let (t_s, rest) = row.split_once(',').unwrap();
        let t_s: f64 = t_s.parse().unwrap();
        let _ = writeln!(text, "{},{rest}", t_s + 39.0);
        text
    });
    let (code, text) = assess_csv(&format!("{head}{}{second}", rows(1)), &[]);
    assert_eq!(code, Some(3), "{text}");
    assert!(
        text.contains("the clock goes back in the air at 40.0 s"),
        "{text}"
    );
    // If the clock goes back on the ground, the next flight begins.
    let ground = "40,0,0,0,0,0\n41.5,0,0,0,0,0\n";
    let (code, text) = assess_csv(&format!("{head}{}{ground}{}", rows(1), rows(1)), &[]);
    assert_eq!(code, Some(0), "{text}");
    assert!(text.contains("0.0 to 40.0 s, 41.5 to"), "{text}");
}

#[test]
fn a_rate_too_low_for_the_windows_prevents_a_verdict() {
    for step_s in [1.0, 1.5, 2.5, 4.0] {
        let row = |i: u32| format!("{},0.4,0.41,0.42,0.4\n", 0.5 + f64::from(i) * step_s);
        let rows: String = (0..200).map(row).collect();
        let (code, text) = assess_csv(&format!("t_s,motor1,motor2,motor3,motor4\n{rows}"), &[]);
        assert_eq!(code, Some(3), "{text}");
        assert!(
            !text.contains("no known value") && !text.contains("does not cover"),
            "{text}"
        );
        assert!(
            text.contains("too slow for a spread") || text.contains("log the motors at"),
            "{text}"
        );
    }
}

#[test]
fn cells_with_another_unit_are_refused_with_their_position() {
    for (motor, t_step, said) in [
        (
            "1500",
            0.04,
            "line 2: `motor1` is 1500, not a fraction from 0 to 1",
        ),
        (
            "50",
            0.04,
            "line 2: `motor1` is 50, not a fraction from 0 to 1",
        ),
        (
            "-1",
            0.04,
            "line 2: `motor1` is -1, not a fraction from 0 to 1",
        ),
        (
            "0.5",
            40.0,
            "line 3: `t_s` jumps from 0 to 40 in one row, but is in seconds",
        ),
    ] {
        let row = |i: u32| format!("{},{motor},0.5,0.5,0.5\n", f64::from(i) * t_step);
        let rows: String = (0..1000).map(row).collect();
        let csv = format!("t_s,motor1,motor2,motor3,motor4\n{rows}");
        let refused = flagred_flightlog::read(csv.as_bytes(), &Options::default()).unwrap_err();
        assert!(matches!(refused, ReadError::Csv { .. }), "{refused}");
        let (code, text) = assess_csv(&csv, &[]);
        assert_eq!(code, Some(3), "{text}");
        assert!(text.contains(said) && text.contains("help: "), "{text}");
    }
    // Small excesses from rounding are clamped.
    let of = |motors: &str| {
        let row = |i: u32| format!("{},{motors}\n", f64::from(i) * 0.04);
        let rows: String = (0..1000).map(row).collect();
        assess_csv(
            &format!("t_s,motor1,motor2,motor3,motor4\n{rows}"),
            &["--json"],
        )
    };
    let verdict = |(_, text): (Option<i32>, String)| -> Vec<serde_json::Value> {
        let document: serde_json::Value = serde_json::from_str(&text).unwrap();
        ["verdict", "findings", "summary"]
            .map(|key| document[key].clone())
            .to_vec()
    };
    assert_eq!(of("1,0,1,0").0, Some(1));
    let rounded = verdict(of("1.0000001,-0.01,1.2,0"));
    assert_eq!(rounded, verdict(of("1,0,1,0")));
}

#[test]
fn a_frame_with_more_motors_than_columns_is_not_good() {
    let rows: String = (0..1500)
        .map(|i| format!("{},0.5,0.5,0.5,0.5,1\n", f64::from(i) * 0.04))
        .collect();
    let of = |header: &str| {
        assess_csv(
            &format!(
                "# vehicle_kind: multirotor\n{header}\nt_s,motor1,motor2,motor3,motor4,in_air\n{rows}"
            ),
            &[],
        )
    };
    assert_eq!(of("# frame: QUAD/X").0, Some(0));
    for header in [
        "# frame: HEXA/X",
        "# frame: Y6/Y6B",
        "# frame_class: 2",
        "# motors: 6",
    ] {
        let (code, text) = of(header);
        assert!(
            code == Some(3) && text.contains("outputs are known for 4 of the 6 motors only"),
            "{header}: {text}"
        );
    }
    for motors in ["6.5", "0", "six"] {
        let (code, text) = of(&format!("# motors: {motors}"));
        assert!(
            code == Some(3) && text.contains(&format!("`motors` is `{motors}`")),
            "{text}"
        );
    }
}
