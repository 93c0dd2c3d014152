//! Logs of old firmware: data that they lack, and limits that only old firmware has.

use flagred_flightlog::{Basis, Flight, Options, ReadError};
use flagred_tests::log_writer::{DataFlash, ULog, Value};

fn read(bytes: &[u8]) -> Flight {
    flagred_flightlog::read(bytes, &Options::default()).unwrap()
}

/// ArduCopter 3.2 with six outputs, `moving` of which follow the throttle from 1200 to `to_us`;
/// the others are constant or move independently.
fn copter(moving: usize, to_us: f64, parameters: &[(&str, f64)]) -> DataFlash {
    let mut log = DataFlash::new();
    log.define(129, "PARM", "QNf", "TimeUS,Name,Value");
    let labels = "TimeUS,Ch1,Ch2,Ch3,Ch4,Ch5,Ch6";
    log.define(130, "RCOU", "QHHHHHH", labels);
    log.define(131, "MSG", "QZ", "TimeUS,Message");
    log.define(132, "EV", "QB", "TimeUS,Id");
    log.write("MSG", [1e6.into(), "ArduCopter V3.2 (c8e0f3e1)".into()]);
    for (name, value) in [("RC3_MIN", 1000.0), ("RC3_MAX", 2000.0)] {
        log.parameter(1e6, name, value);
    }
    for (name, value) in parameters {
        log.parameter(1e6, name, *value);
    }
    for row in 0..100 {
        let time = Value::Number(2e6 + 1e5 * f64::from(row));
        let event = match row {
            5 => Some(10.0),
            // The land detector reports 0.2 s of landing in the middle of the flight.
            10 | 52 => Some(28.0),
            50 | 90 => Some(18.0),
            95 => Some(11.0),
            _ => None,
        };
        if let Some(id) = event {
            log.write("EV", [time, Value::Number(id)]);
        }
        let flying = (10..90).contains(&row);
        let share = (f64::from(row) - 10.0) / 80.0;
        let throttle = if flying {
            1200.0 + share * (to_us - 1200.0)
        } else {
            1000.0
        };
        let gimbal = if row % 2 == 0 { 1400.0 } else { 1600.0 };
        let pulses = (0..6).map(|output| match output < moving {
            true => Value::Number((throttle + 3.0 * f64::from(row % (output as i32 + 2))).round()),
            false => Value::Number(gimbal),
        });
        log.write("RCOU", std::iter::once(time).chain(pulses));
    }
    log
}

#[test]
fn without_a_frame_the_outputs_that_move_together_are_the_motors() {
    for (moving, motors, frame) in [(4, 4, "QUAD/PLUS"), (6, 6, "HEXA/PLUS")] {
        let flight = read(&copter(moving, 1800.0, &[("FRAME", 0.0)]).bytes);
        assert_eq!(flight.motors.len(), motors);
        let source = &flight.motors[0].source;
        assert!(source.contains("move together"), "{source}");
        let geometry = flight.geometry.unwrap();
        assert_eq!(geometry.basis, Basis::Declared);
        assert_eq!(geometry.frame.as_deref(), Some(frame));
    }
    // Two outputs that move together are not a multirotor.
    assert!(read(&copter(2, 1800.0, &[]).bytes).motors.is_empty());
}

#[test]
fn landings_of_less_than_a_second_are_ignored() {
    let flight = read(&copter(4, 1800.0, &[]).bytes);
    let in_air = flight.in_air.unwrap();
    let spans: Vec<_> = in_air.spans.iter().map(|s| (s.start_s, s.end_s)).collect();
    assert_eq!(spans, [(3.0, 11.0)]);
    assert_eq!(in_air.duration_s(), 8.0);
}

#[test]
fn the_upper_limit_is_that_of_the_generation_unless_the_commands_go_beyond() {
    let low = ("THR_MIN", 130.0);
    for (limit, to_us, high) in [
        (("MOT_TCRV_MAXPCT", 93.0), 1900.0, 0.93),
        (("MOT_TCRV_MAXPCT", 93.0), 1990.0, 1.0),
        (("MOT_THST_MAX", 0.95), 1900.0, 0.13 + 0.95 * 0.87),
        (("OTHER", 0.0), 1900.0, 1.0),
    ] {
        let flight = read(&copter(4, to_us, &[low, limit]).bytes);
        let effective = flight.effective_range;
        assert_eq!(effective.low, 0.13, "{}", effective.source);
        // Parameters have single precision.
        assert!((effective.high - high).abs() < 1e-7, "{}", effective.source);
    }
}

/// PX4 1.13 with SYS_CTRL_ALLOC = 0 has the parameters of single outputs, and does not use them.
#[test]
fn static_mixers_have_the_range_of_their_bank() {
    let mut log = ULog::new(1_000_000);
    log.define("actuator_outputs:uint64_t timestamp;float[4] output;");
    for (name, value) in [
        ("MAV_TYPE", 2.0),
        ("SYS_CTRL_ALLOC", 0.0),
        ("SYS_AUTOSTART", 4001.0),
        ("PWM_MAIN_MIN", 1075.0),
        ("PWM_MAIN_MAX", 1950.0),
        ("PWM_MAIN_MIN1", 1000.0),
        ("PWM_MAIN_MAX1", 2000.0),
        ("PWM_MAIN_FUNC1", 0.0),
        ("PWM_MAIN_FUNC2", 101.0),
    ] {
        log.parameter(name, value);
    }
    log.announce(0, 1, "actuator_outputs");
    for row in 0..20_u64 {
        log.floats(1, 1_000_000 + 100_000 * row, &[1500.0; 4]);
    }
    let flight = read(&log.bytes);
    let range = flight.range.unwrap();
    assert_eq!(
        (range.low, range.high),
        (1075.0, 1950.0),
        "{}",
        range.source
    );
    assert_eq!(flight.motors.len(), 4);
    assert_eq!(flight.geometry.unwrap().source, "SYS_AUTOSTART = 4001");
}

#[test]
fn a_px4_log_older_than_ulog_is_identified() {
    let mut log = DataFlash::new();
    log.define(129, "TIME", "Q", "StartTime");
    log.define(2, "ATT", "ffff", "qw,qx,qy,qz");
    log.write("TIME", [1e6.into()]);
    let error = flagred_flightlog::read(&log.bytes[..], &Options::default()).unwrap_err();
    assert!(matches!(error, ReadError::NotRead { .. }));
    assert!(error.to_string().contains("sdlog2"), "{error}");
    assert!(error.help().unwrap().contains("ULog"));
}

/// The number of bad messages does not depend on the selected signals.
#[test]
fn the_report_does_not_depend_on_the_kept_signals() {
    let mut log = copter(4, 1800.0, &[]);
    log.define(133, "ATT", "Qcccc", "TimeUS,DesRoll,Roll,DesPitch,Pitch");
    for time_us in [12.0e6, 12.1e6, 12.2e6, 12.05e6, 12.07e6, 12.3e6] {
        log.write(
            "ATT",
            std::iter::once(Value::Number(time_us)).chain([Value::Number(0.0); 4]),
        );
    }
    let csv = "t_s,motor1,roll_deg,note\n0,0.5,1,2\n1,0.5,x,2\n2,0.5,z,2\n3,0.5,1,y\n";
    for bytes in [&log.bytes[..], log.text.as_bytes(), csv.as_bytes()] {
        let all = read(bytes);
        let mut none = Options::default();
        none.signals = Some(Vec::new());
        let few = flagred_flightlog::read(bytes, &none).unwrap();
        assert!(all.report.bad_messages > 1 && all.signals().count() > 0);
        assert_eq!(few.report, all.report);
        assert_eq!(few.commands, all.commands);
        assert_eq!(few.signals().count(), 0);
    }
}

/// ArduCopter 3.1 describes MOT messages in every log, but writes them only if bit 10 of LOG_BITMASK is set.
#[test]
fn the_bitmask_reports_motors_that_were_not_logged() {
    let gap = |mask: f64| {
        let mut log = DataFlash::new();
        log.define(129, "PARM", "Nf", "Name,Value");
        log.define(131, "MSG", "Z", "Message");
        log.define(11, "MOT", "hhhh", "Mot1,Mot2,Mot3,Mot4");
        log.define(130, "ATT", "Ic", "TimeMS,Roll");
        log.write("MSG", ["ArduCopter V3.1 (5c6503e2)".into()]);
        log.write("PARM", ["LOG_BITMASK".into(), mask.into()]);
        log.write("ATT", [1000.0.into(), 0.0.into()]);
        let gap = read(&log.bytes).gaps().remove(0);
        (gap.to_string(), gap.help().unwrap())
    };
    let (reason, help) = gap(830.0);
    assert!(
        reason.ends_with("not in the log: LOG_BITMASK is 830, without bit 10"),
        "{reason}"
    );
    assert!(help.starts_with("add 1024 to LOG_BITMASK"), "{help}");
    let (reason, help) = gap(1854.0);
    assert!(reason.ends_with("not in the log"), "{reason}");
    assert!(help.contains("is set"), "{help}");
}

/// A quadrotor of PX4 1.14 or later, with logged set points but neither motors nor outputs.
#[test]
fn motor_commands_of_px4_are_computed_from_set_points() {
    let mut log = ULog::new(1_000_000);
    for topic in ["vehicle_torque_setpoint", "vehicle_thrust_setpoint"] {
        log.define(&format!("{topic}:uint64_t timestamp;float[3] xyz;"));
    }
    let rotors = [
        (0.15, 0.15, 0.05),
        (-0.15, -0.15, 0.05),
        (0.15, -0.15, -0.05),
        (-0.15, 0.15, -0.05),
    ];
    for (name, value) in [("MAV_TYPE", 2.0), ("CA_ROTOR_COUNT", 4.0)] {
        log.parameter(name, value);
    }
    for (rotor, (x, y, km)) in rotors.into_iter().enumerate() {
        for (name, value) in [("PX", x), ("PY", y), ("KM", km)] {
            log.parameter(&format!("CA_ROTOR{rotor}_{name}"), value);
        }
    }
    log.announce(0, 1, "vehicle_torque_setpoint");
    log.announce(0, 2, "vehicle_thrust_setpoint");
    for row in 0..50_u64 {
        let time_us = 1_000_000 + 20_000 * row;
        // No thrust is logged from row 40 on, so for the last torques the latest thrust is too old.
        if row < 40 {
            log.floats(2, time_us, &[0.0, 0.0, -0.5]);
        }
        log.floats(1, time_us + 1, &[0.1, 0.0, 0.0]);
    }
    let flight = read(&log.bytes);
    assert_eq!(flight.range.as_ref().unwrap().unit, "1");
    assert_eq!(flight.assumed.len(), 1);
    assert_eq!(flight.geometry.unwrap().factors.len(), 4);
    let rows: Vec<(f64, &[f64])> = flight.commands.rows().collect();
    assert_eq!(rows.len(), 50);
    let expected = [0.4293, 0.5707, 0.5707, 0.4293];
    for (command, expected) in rows[10].1.iter().zip(expected) {
        assert!((command - expected).abs() < 1e-4, "{command} {expected}");
    }
    assert!(rows[49].1.iter().all(|command| command.is_nan()));
}
