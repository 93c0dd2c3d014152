//! Motors on outputs above 16, and the outputs of PX4.

use super::*;

const HEXAROTOR: MavType = MavType::MAV_TYPE_HEXAROTOR;

impl Bench<'_> {
    fn beat_as(&mut self, mavtype: MavType, autopilot: MavAutopilot) {
        let times = if self.session.view().is_none() { 3 } else { 1 };
        for _ in 0..times {
            self.take_message(&MavMessage::HEARTBEAT(HEARTBEAT_DATA {
                custom_mode: 0,
                mavtype,
                autopilot,
                base_mode: MavModeFlag::MAV_MODE_FLAG_SAFETY_ARMED,
                system_status: MavState::MAV_STATE_ACTIVE,
                mavlink_version: 3,
            }));
        }
    }

    fn pulses(&mut self, t_s: f64, port: u8, last_four: u16, first_two: u16) {
        self.take_message(&MavMessage::SERVO_OUTPUT_RAW(SERVO_OUTPUT_RAW_DATA {
            time_usec: (t_s * 1e6) as u32,
            port,
            servo1_raw: first_two,
            servo2_raw: first_two,
            servo13_raw: last_four,
            servo14_raw: last_four,
            servo15_raw: last_four,
            servo16_raw: last_four,
            ..SERVO_OUTPUT_RAW_DATA::default()
        }));
    }

    /// Sends the bytes of an integer in place of a float, as PX4 does.
    fn integer(&mut self, name: &str, value: i32) {
        self.take_message(&MavMessage::PARAM_VALUE(PARAM_VALUE_DATA {
            param_value: f32::from_bits(value as u32),
            param_count: 900,
            param_index: u16::MAX,
            param_id: name.into(),
            param_type: MavParamType::MAV_PARAM_TYPE_INT32,
        }));
    }

    fn motors(&self) -> Vec<f64> {
        self.session.view().unwrap().motors.to_vec()
    }

    fn is_asked_for(&self, name: &str) -> bool {
        self.count_sent(|message| {
            matches!(message, MavMessage::PARAM_REQUEST_READ(requested) if requested.param_id.to_str() == Ok(name))
        }) > 0
    }
}

#[test]
fn motors_on_both_ports_require_recent_values_of_both() {
    let estimator = estimator();
    let mut bench = Bench::new(&estimator, Some(191));
    bench.beat_as(HEXAROTOR, MavAutopilot::MAV_AUTOPILOT_ARDUPILOTMEGA);
    bench.wait(0.1);
    assert!(!bench.is_asked_for("SERVO17_FUNCTION"));
    for (name, value) in [
        ("MOT_PWM_MIN", 1000.0),
        ("MOT_PWM_MAX", 2000.0),
        ("MOT_SPIN_MIN", 0.125),
        ("MOT_SPIN_MAX", 0.875),
        ("FRAME_CLASS", 2.0),
        ("FRAME_TYPE", 1.0),
    ] {
        bench.parameter(name, value);
    }
    for output in 1..=16_u8 {
        let function = if output > 12 { 20 + output } else { 0 };
        bench.parameter(&format!("SERVO{output}_FUNCTION"), f32::from(function));
    }
    bench.wait(1.0);
    assert!(bench.is_asked_for("SERVO17_FUNCTION"));
    bench.parameter("SERVO17_FUNCTION", 37.0);
    bench.parameter("SERVO18_FUNCTION", 38.0);
    bench.wait(0.1);
    let setup = bench.setups().last().copied().unwrap();
    assert_eq!(setup.motors.len(), 6);
    let geometry = setup.geometry.as_ref().unwrap();
    assert_eq!(geometry.frame.as_deref(), Some("HEXA/X"));

    // A single timestamp is not trusted yet.
    for t_s in [9.96, 10.0] {
        bench.pulses(t_s, 0, 1500, 0);
        bench.pulses(t_s, 1, 0, 1900);
    }
    assert_eq!(bench.motors(), [0.5, 0.5, 0.5, 0.5, 1.0, 1.0]);
    // The packet of the first port is lost.
    bench.pulses(10.04, 1, 0, 1100);
    let motors = bench.motors();
    assert!(motors[..4].iter().all(|command| command.is_nan()));
    assert_eq!(motors[4..], [0.0, 0.0]);
}

#[test]
fn functions_and_limits_of_outputs_are_requested_from_px4() {
    let estimator = estimator();
    let mut bench = Bench::new(&estimator, Some(191));
    let px4 = MavAutopilot::MAV_AUTOPILOT_PX4;
    bench.beat_as(MavType::MAV_TYPE_QUADROTOR, px4);
    bench.wait(0.1);
    assert!(bench.is_asked_for("PWM_MAIN_FUNC1") && bench.is_asked_for("PWM_AUX_FUNC1"));
    assert!(!bench.is_asked_for("SERVO1_FUNCTION") && !bench.is_asked_for("PWM_MAIN_MIN1"));
    for (output, function) in [(1, 101), (2, 102), (13, 103), (14, 104)] {
        bench.integer(&format!("PWM_MAIN_FUNC{output}"), function);
    }
    bench.wait(1.0);
    assert!(bench.is_asked_for("PWM_MAIN_MIN1") && bench.is_asked_for("PWM_MAIN_MAX1"));
    bench.integer("PWM_MAIN_MIN1", 1100);
    bench.integer("PWM_MAIN_MAX1", 1900);
    bench.integer("CA_ROTOR_COUNT", 4);
    assert!(bench.is_asked_for("CA_ROTOR3_KM"));
    for (rotor, (px, py, km)) in (0..).zip([
        (1.0, 1.0, 0.05),
        (-1.0, -1.0, 0.05),
        (1.0, -1.0, -0.05),
        (-1.0, 1.0, -0.05),
    ]) {
        for (part, value) in [
            ("PX", px),
            ("PY", py),
            ("PZ", 0.0),
            ("AX", 0.0),
            ("AY", 0.0),
            ("AZ", -1.0),
            ("KM", km),
            ("CT", 6.5),
        ] {
            bench.parameter(&format!("CA_ROTOR{rotor}_{part}"), value);
        }
    }
    bench.wait(0.1);
    let setup = bench.setups()[0].clone();
    assert_eq!(setup.assumed, Vec::<String>::new());
    assert_eq!((setup.range.low, setup.range.high), (1100.0, 1900.0));
    let factors = setup.geometry.unwrap().factors;
    assert_eq!(factors[..2], [[-1.0, 1.0, 1.0], [1.0, -1.0, 1.0]]);
    bench.pulses(9.96, 0, 1500, 1100);
    bench.pulses(10.0, 0, 1500, 1100);
    assert_eq!(bench.motors(), [0.0, 0.0, 0.5, 0.5]);
}
