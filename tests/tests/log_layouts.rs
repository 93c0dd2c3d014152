//! Layouts of real flight logs that cannot be redistributed, generated here.

use flagred_flightlog::{Flight, Format, Options, VehicleKind};
use flagred_tests::log_writer::{
    ATTITUDE, DataFlash, HEARTBEAT, NAV_CONTROLLER_OUTPUT, PARAM_VALUE, SERVO_OUTPUT_RAW,
    STATUSTEXT, Tlog, ULog, Value,
};

fn read(bytes: &[u8]) -> Flight {
    flagred_flightlog::read(bytes, &Options::default()).unwrap()
}

/// Both forms of a DataFlash log must contain the same flight.
fn read_both(log: &DataFlash) -> Flight {
    let binary = read(&log.bytes);
    let text = read(log.text.as_bytes());
    assert_eq!(text.format, Format::DataFlashText);
    assert!(
        binary.report.is_clean() && text.report.is_clean(),
        "{:?}",
        text.report
    );
    assert_eq!(binary.motors, text.motors);
    assert_eq!(binary.range, text.range);
    let rows = |flight: &Flight| -> Vec<(i64, Vec<f64>)> {
        let row = |(t_s, row): (f64, &[f64])| ((t_s * 1e6).round() as i64, row.to_vec());
        flight.commands.rows().map(row).collect()
    };
    assert_eq!(rows(&binary), rows(&text));
    binary
}

fn outputs(flight: &Flight) -> Vec<(u16, &str)> {
    let named = |motor: &flagred_flightlog::Motor| motor.number;
    flight
        .motors
        .iter()
        .map(|motor| (named(motor), motor.output.as_str()))
        .collect()
}

/// The log of a quad whose outputs are labelled `stem` with a number from 1, with times in `clock` and rows 100 ms
/// apart.
fn quad(stem: &str, clock: &str, parameters: &[(&str, f64)]) -> DataFlash {
    let mut log = DataFlash::new();
    let (kind, per_s) = match clock {
        "TimeUS" => ("Q", 1e6),
        _ => ("I", 1e3),
    };
    let labels: Vec<String> = (1..=6).map(|output| format!("{stem}{output}")).collect();
    let labels = format!("{clock},{}", labels.join(","));
    log.define(129, "PARM", "QNf", "TimeUS,Name,Value");
    log.define(130, "RCOU", &format!("{kind}HHHHHH"), &labels);
    log.define(131, "MSG", &format!("{kind}Z"), &format!("{clock},Message"));
    log.define(132, "EV", &format!("{kind}B"), &format!("{clock},Id"));
    for (name, value) in parameters {
        log.parameter(1e6, name, *value);
    }
    for text in ["ArduCopter V3.4.6 (e707341b)", "Frame: HEXA"] {
        log.write("MSG", [(1.0 * per_s).into(), text.into()]);
    }
    fly(&mut log, per_s, 2.0);
    log
}

/// Writes a flight: the vehicle is armed at `from_s`, takes off a second later, and lands after two seconds in the air.
/// `per_s` is the number of units of the clock per second.
fn fly(log: &mut DataFlash, per_s: f64, from_s: f64) {
    let event = |log: &mut DataFlash, t_s: f64, id: f64| {
        log.write("EV", [Value::Number((t_s * per_s).round()), id.into()]);
    };
    event(log, from_s, 10.0);
    for row in 0..40 {
        let t_s = from_s + 0.1 * f64::from(row);
        if row == 10 {
            event(log, t_s, 28.0);
        }
        if row == 30 {
            event(log, t_s, 18.0);
        }
        let time = Value::Number((t_s * per_s).round());
        let pulses = (1..=6).map(|output| Value::Number(f64::from(1100 + 10 * output + row)));
        log.write("RCOU", std::iter::once(time).chain(pulses));
    }
    event(log, from_s + 4.0, 11.0);
}

const RADIO: [(&str, f64); 2] = [("RC3_MIN", 1000.0), ("RC3_MAX", 2000.0)];

#[test]
fn labels_and_clocks_of_each_generation() {
    for (stem, clock) in [("C", "TimeUS"), ("Ch", "TimeUS"), ("Chan", "TimeMS")] {
        let flight = read_both(&quad(stem, clock, &RADIO));
        assert_eq!(flight.commands.len(), 40, "{stem}");
        assert_eq!(flight.commands.rows().nth(5).unwrap().1[2], 1135.0);
        assert!((flight.commands.t_s()[5] - 2.5).abs() < 1e-9, "{clock}");
        assert_eq!(flight.motors[2].output, format!("{stem}3"));
        let in_air = flight.in_air.unwrap();
        assert!((in_air.duration_s() - 2.0).abs() < 1e-9, "{in_air:?}");
        assert!((flight.armed.unwrap().duration_s() - 4.0).abs() < 1e-9);
    }
}

#[test]
fn without_functions_the_frame_determines_the_number_of_motors() {
    let flight = read_both(&quad("Chan", "TimeMS", &RADIO));
    let expected = ["Chan1", "Chan2", "Chan3", "Chan4", "Chan5", "Chan6"];
    assert_eq!(outputs(&flight), (1..=6).zip(expected).collect::<Vec<_>>());
    assert!(flight.motors[0].source.contains("frame HEXA"));
}

#[test]
fn the_range_is_that_of_the_throttle_stick_where_the_motors_have_none() {
    let parameters = [
        ("MOT_PWM_MIN", 0.0),
        ("MOT_PWM_MAX", 0.0),
        ("RCMAP_THROTTLE", 1.0),
        ("RC1_MIN", 1094.0),
        ("RC1_MAX", 1934.0),
        ("RC3_MIN", 1000.0),
        ("RC3_MAX", 2000.0),
    ];
    let flight = read_both(&quad("C", "TimeUS", &parameters));
    let range = flight.range.unwrap();
    assert_eq!((range.low, range.high), (1094.0, 1934.0));
    assert!(range.source.contains("RCMAP_THROTTLE"), "{}", range.source);
}

#[test]
fn a_function_that_changes_in_flight_does_not_move_the_motor() {
    let functions = [
        ("SERVO1_FUNCTION", 34.0),
        ("SERVO2_FUNCTION", 33.0),
        ("SERVO3_FUNCTION", 35.0),
        ("SERVO5_FUNCTION", 36.0),
    ];
    let mut log = quad("C", "TimeUS", &functions);
    log.parameter(9e6, "SERVO2_FUNCTION", 1.0);
    let flight = read_both(&log);
    assert_eq!(
        outputs(&flight),
        [(1, "C2"), (2, "C1"), (3, "C3"), (4, "C5")]
    );
    assert_eq!(
        flight.commands.rows().next().unwrap().1,
        [1120.0, 1110.0, 1130.0, 1150.0]
    );
}

#[test]
fn a_second_boot_continues_the_clock() {
    let mut log = quad("C", "TimeUS", &RADIO);
    let second = quad("C", "TimeUS", &RADIO);
    log.bytes.extend(second.bytes);
    log.text += &second.text;
    let flight = read_both(&log);
    assert_eq!(flight.boots_s.len(), 1);
    // The first boot ended with its last message, at 6 s.
    assert!(
        (flight.boots_s[0] - 6.0).abs() < 1e-6,
        "{:?}",
        flight.boots_s
    );
    assert_eq!(flight.commands.len(), 80);
    assert!(flight.commands.t_s().is_sorted());
    let in_air: Vec<f64> = flight
        .in_air
        .unwrap()
        .spans
        .iter()
        .map(|s| s.start_s)
        .collect();
    assert!(
        (in_air[0] - 3.0).abs() < 1e-6 && (in_air[1] - 9.0).abs() < 1e-6,
        "{in_air:?}"
    );
}

#[test]
fn motors_beyond_output_14_and_motor_8() {
    let mut log = DataFlash::new();
    log.define(129, "PARM", "QNf", "TimeUS,Name,Value");
    log.define(130, "RCOU", "QHH", "TimeUS,C1,C2");
    log.define(131, "RCO2", "QHH", "TimeUS,C15,C16");
    for (name, value) in [("SERVO1_FUNCTION", 33.0), ("SERVO15_FUNCTION", 82.0)] {
        log.parameter(1e6, name, value);
    }
    for row in 0..3 {
        let time = Value::Number(2e6 + 1e5 * f64::from(row));
        log.write("RCOU", [time, 1500.0.into(), 0.0.into()]);
        log.write("RCO2", [time, (1600.0 + f64::from(row)).into(), 0.0.into()]);
    }
    let flight = read_both(&log);
    assert_eq!(outputs(&flight), [(1, "C1"), (9, "C15")]);
    assert_eq!(flight.commands.rows().nth(2).unwrap().1, [1500.0, 1602.0]);
}

#[test]
fn impossible_definitions_do_not_cause_a_panic() {
    let good = quad("C", "TimeUS", &RADIO);
    for length in [0, 1, 2, 3, 255] {
        let mut bytes = good.bytes.clone();
        let mut bad = DataFlash::default();
        bad.define(200, "BAD", "QQ", "TimeUS,A");
        bad.bytes[4] = length;
        bytes.extend(bad.bytes);
        bytes.extend(&good.bytes);
        let flight = read(&bytes);
        assert_eq!(
            flight.commands.len(),
            80,
            "length {length}: {:?}",
            flight.report
        );
    }
}

/// Instance 0 of the outputs exists but is idle; the motors are UAVCAN ESCs in instance 1.
#[test]
fn uavcan_escs_in_the_second_instance() {
    let mut log = ULog::new(1_000_000);
    log.define("actuator_outputs:uint64_t timestamp;float[4] output;");
    log.define("vehicle_status:uint64_t timestamp;uint8_t arming_state;uint8_t nav_state;");
    log.define("vehicle_land_detected:uint64_t timestamp;bool landed;");
    log.parameter("MAV_TYPE", 2.0);
    for (instance, id, name) in [
        (0, 1, "actuator_outputs"),
        (1, 2, "actuator_outputs"),
        (0, 3, "vehicle_status"),
        (0, 4, "vehicle_land_detected"),
    ] {
        log.announce(instance, id, name);
    }
    log.flags(3, 1_000_000, &[2, 2]);
    log.flags(4, 1_000_000, &[0]);
    for row in 0..20_u64 {
        let time_us = 1_000_000 + 100_000 * row;
        log.floats(1, time_us, &[0.0; 4]);
        log.floats(2, time_us + 7, &[4095.5, 4095.5, 4095.5, 8191.0]);
    }
    let flight = read(&log.bytes);
    assert!(flight.report.is_clean());
    assert_eq!(flight.commands.len(), 20);
    assert_eq!(flight.motors[3].output, "actuator_outputs[1].output[3]");
    assert_eq!(flight.range.as_ref().unwrap().high, 8191.0);
    let statistics = flight.statistics().unwrap();
    assert!((statistics.margin_mean - 0.375).abs() < 1e-9);
    assert_eq!(statistics.margin_min, 0.0);
    assert_eq!(flight.modes[0].what, "POSCTL");
}

#[test]
fn a_stopped_px4_motor_is_a_command_of_0() {
    let mut log = ULog::new(0);
    log.define("actuator_motors:uint64_t timestamp;float[12] control;");
    log.announce(0, 9, "actuator_motors");
    log.parameter("CA_ROTOR_COUNT", 4.0);
    let mut control = [f32::NAN; 12];
    control[..3].copy_from_slice(&[0.25, 0.5, 0.75]);
    log.floats(9, 50, &control);
    let flight = read(&log.bytes);
    assert_eq!(flight.motors.len(), 4);
    assert_eq!(
        flight.commands.rows().next().unwrap().1,
        [0.25, 0.5, 0.75, 0.0]
    );
}

fn parameter(name: &str, value: f32) -> Vec<u8> {
    let mut payload = value.to_le_bytes().to_vec();
    payload.extend([0; 4]);
    payload.extend(name.bytes());
    payload.resize(24, 0);
    payload.push(9);
    payload
}

/// The log mixes MAVLink 1 and 2. It contains parameters stored under component 190, a ground station whose heartbeat has
/// the armed bit, and a gimbal on the vehicle's system.
#[test]
fn telemetry_of_other_vehicles_is_ignored() {
    const QUAD: (u8, u8) = (7, 1);
    const START_US: u64 = 1_700_000_000_000_000;
    let heartbeat = |mav_type: u8, armed: bool, status: u8| {
        [
            5,
            0,
            0,
            0,
            mav_type,
            3,
            if armed { 128 } else { 0 },
            status,
            3,
        ]
    };
    let mut log = Tlog::default();
    log.packet(START_US, 2, (255, 190), HEARTBEAT, &heartbeat(6, true, 4));
    for (name, value) in [
        ("SERVO1_FUNCTION", 33.0),
        ("SERVO2_FUNCTION", 34.0),
        ("MOT_PWM_MIN", 1000.0),
        ("MOT_PWM_MAX", 2000.0),
    ] {
        log.packet(START_US, 2, (7, 190), PARAM_VALUE, &parameter(name, value));
    }
    let mut text = vec![6];
    text.extend(b"ArduCopter V4.5.7 (2a3dc4b7)");
    log.packet(START_US, 1, QUAD, STATUSTEXT, &text);
    for row in 0..100_u64 {
        let stamp_us = START_US + 1_000_000 + 100_000 * row;
        let version = 1 + (row % 2) as u8;
        if row % 10 == 0 {
            let flying = (20..80).contains(&row);
            let status = if flying { 4 } else { 3 };
            log.packet(
                stamp_us,
                version,
                QUAD,
                HEARTBEAT,
                &heartbeat(2, row >= 10, status),
            );
            log.packet(
                stamp_us,
                version,
                (7, 154),
                HEARTBEAT,
                &heartbeat(26, false, 3),
            );
            log.packet(stamp_us, 2, (255, 190), HEARTBEAT, &heartbeat(6, true, 4));
        }
        let mut servos = vec![0; 4];
        for pulse_us in [1500_u16, 1900, 0, 0, 0, 0, 0, 0] {
            servos.extend(pulse_us.to_le_bytes());
        }
        servos.push(0);
        log.packet(stamp_us, version, QUAD, SERVO_OUTPUT_RAW, &servos);
        let floats = |values: &[f32]| {
            values
                .iter()
                .flat_map(|v| v.to_le_bytes())
                .collect::<Vec<u8>>()
        };
        let attitude = floats(&[0.0, 0.1, -0.2, 0.0, 0.0, 0.0, 0.0]);
        log.packet(stamp_us, version, QUAD, ATTITUDE, &attitude);
        log.packet(
            stamp_us,
            version,
            QUAD,
            NAV_CONTROLLER_OUTPUT,
            &floats(&[6.0, -12.0]),
        );
    }
    let flight = read(&log.bytes);
    assert!(flight.report.is_clean(), "{:?}", flight.report);
    assert_eq!(flight.vehicle.kind, VehicleKind::Multirotor);
    assert_eq!(outputs(&flight), [(1, "servo1_raw"), (2, "servo2_raw")]);
    assert_eq!(flight.range.as_ref().unwrap().source, "MOT_PWM_MIN/MAX");
    assert_eq!(flight.commands.len(), 100);
    assert!((flight.commands.t_s()[0] - 1.0).abs() < 1e-6);
    assert_eq!(flight.utc_at_zero_s, Some(1.7e9));
    assert!((flight.armed.as_ref().unwrap().duration_s() - 8.9).abs() < 1e-6);
    assert!((flight.in_air.as_ref().unwrap().duration_s() - 6.0).abs() < 1e-6);
    let roll = flight.signal("roll_deg").unwrap().at(5.0).unwrap();
    assert!((roll - 0.1_f64.to_degrees()).abs() < 1e-5);
    assert_eq!(flight.signal("pitch_des_deg").unwrap().at(5.0), Some(-12.0));
    // MOT_SPIN_MIN and MOT_SPIN_MAX are not in the log, so 0.15 and 0.95 are assumed, as by `watch`.
    assert_eq!(flight.assumed, ["effective range 0.15 to 0.95"]);
    assert!((flight.statistics().unwrap().margin_mean - 0.25).abs() < 1e-9);
}

/// A PX4 quadrotor of 1.13 or later with two motors on MAIN and two on AUX, which are in port 1 of SERVO_OUTPUT_RAW.
#[test]
fn tlog_with_motors_on_both_ports() {
    const START_US: u64 = 1_700_000_000_000_000;
    let parameter = |name: &str, value: i32| {
        let mut payload = value.to_le_bytes().to_vec();
        payload.extend([0; 4]);
        payload.extend(name.as_bytes());
        payload.resize(24, 0);
        payload.push(6);
        payload
    };
    let mut log = Tlog::default();
    let heartbeat = [0, 0, 0, 0, 2, 12, 128, 4, 3];
    log.packet(START_US, 2, (1, 1), HEARTBEAT, &heartbeat);
    for (name, value) in [
        ("PWM_MAIN_FUNC1", 101),
        ("PWM_MAIN_FUNC2", 102),
        ("PWM_AUX_FUNC1", 103),
        ("PWM_AUX_FUNC9", 0),
        ("PWM_AUX_FUNC10", 104),
        ("PWM_MAIN_MIN1", 1100),
        ("PWM_MAIN_MAX1", 1900),
    ] {
        log.packet(START_US, 2, (1, 1), PARAM_VALUE, &parameter(name, value));
    }
    for row in 0..50_u64 {
        for port in [0, 1_u8] {
            let mut servos = vec![0; 4];
            let first = [1500_u16, 1600, 0, 0, 0, 0, 0, 0].map(|us| us + u16::from(port) * 100);
            servos.extend(first.iter().flat_map(|us| us.to_le_bytes()));
            servos.push(port);
            servos.extend([0; 2]);
            servos.extend(1900_u16.to_le_bytes());
            let stamp_us = START_US + 100_000 * row + u64::from(port);
            log.packet(stamp_us, 2, (1, 1), SERVO_OUTPUT_RAW, &servos);
        }
    }
    let flight = read(&log.bytes);
    assert_eq!(
        outputs(&flight),
        [
            (1, "servo1_raw"),
            (2, "servo2_raw"),
            (3, "servo1_raw of port 1"),
            (4, "servo10_raw of port 1")
        ]
    );
    let range = flight.range.as_ref().unwrap();
    assert_eq!((range.low, range.high), (1100.0, 1900.0));
    assert_eq!(flight.commands.len(), 50);
    let (_, row) = flight.commands.rows().nth(20).unwrap();
    assert_eq!(row, [1500.0, 1600.0, 1600.0, 1900.0]);
}

/// The example of the documentation has the documented values.
#[test]
fn the_documented_flight_csv() {
    let page = include_str!("../../docs/flight-csv.md");
    let example = page
        .split("```csv\n")
        .nth(1)
        .unwrap()
        .split("```")
        .next()
        .unwrap();
    let flight = read(example.as_bytes());
    assert!(flight.report.is_clean());
    assert_eq!(flight.motors.len(), 4);
    assert_eq!(flight.is_in_air(0.02), Some(false));
    assert_eq!(flight.signal("battery_v").unwrap().at(0.04), Some(16.2));
    let expected = (0.48 - 0.15) / 0.8;
    assert!((flight.effective_command(1480.0).unwrap() - expected).abs() < 1e-12);
}
