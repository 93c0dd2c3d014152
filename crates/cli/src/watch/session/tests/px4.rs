//! A PX4 vehicle: its answers, the values that it repeats as its own, and parameters that arrive in flight.

use flagred_flightlog::mavlink::{Packet, dialect::NAMED_VALUE_FLOAT_DATA};

use super::*;

const PARAM_ERROR: u32 = 345;
/// CRC_EXTRA of PARAM_ERROR, a message that the dialect of this program lacks.
const PARAM_ERROR_EXTRA: u8 = 209;

impl Bench<'_> {
    fn px4_beat(&mut self) {
        let times = if self.session.view().is_none() { 3 } else { 1 };
        for _ in 0..times {
            self.take_message(&MavMessage::HEARTBEAT(HEARTBEAT_DATA {
                custom_mode: 0,
                mavtype: MavType::MAV_TYPE_QUADROTOR,
                autopilot: MavAutopilot::MAV_AUTOPILOT_PX4,
                base_mode: MavModeFlag::MAV_MODE_FLAG_SAFETY_ARMED,
                system_status: MavState::MAV_STATE_ACTIVE,
                mavlink_version: 3,
            }));
        }
    }

    fn px4_state(&mut self, landed_state: MavLandedState) {
        self.take_message(&MavMessage::EXTENDED_SYS_STATE(EXTENDED_SYS_STATE_DATA {
            landed_state,
            ..EXTENDED_SYS_STATE_DATA::default()
        }));
    }

    /// Flies at 25 Hz, with pulses near the given ones.
    fn px4_fly(&mut self, from_s: f64, seconds: f64, pulses: [u16; 4]) {
        self.px4_fly_and(from_s, seconds, pulses, |_, _| {});
    }

    /// Like `px4_fly`; after each sample, `each` receives the number of packets that were sent before it.
    fn px4_fly_and(
        &mut self,
        from_s: f64,
        seconds: f64,
        pulses: [u16; 4],
        mut each: impl FnMut(&mut Self, usize),
    ) {
        for i in 0..(seconds * 25.0) as u32 {
            if i % 25 == 0 {
                self.px4_beat();
                self.px4_state(MavLandedState::MAV_LANDED_STATE_IN_AIR);
            }
            let t_s = from_s + f64::from(i) / 25.0;
            let wiggle = (i % 5) as u16;
            let [one, two, three, four] = pulses;
            let before = self.sent.len();
            self.take_message(&servo(t_s, [one + wiggle, two, three - wiggle, four]));
            each(self, before);
            self.wait(0.03);
        }
    }

    fn px4_parameter(&mut self, name: &str, value: f32) {
        self.parameter(name, value);
    }

    fn px4_integer(&mut self, name: &str, value: i32) {
        self.take_message(&MavMessage::PARAM_VALUE(PARAM_VALUE_DATA {
            param_value: f32::from_bits(value as u32),
            param_count: 900,
            param_index: u16::MAX,
            param_id: name.into(),
            param_type: MavParamType::MAV_PARAM_TYPE_INT32,
        }));
    }

    /// Sends motors and geometry of a square quadrotor, without limits and thrust coefficients.
    fn px4_motors(&mut self) {
        for motor in 1..=4 {
            self.px4_integer(&format!("PWM_MAIN_FUNC{motor}"), 100 + motor);
        }
        self.px4_integer("CA_ROTOR_COUNT", 4);
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
            ] {
                self.px4_parameter(&format!("CA_ROTOR{rotor}_{part}"), value);
            }
        }
    }

    /// Reports that PX4 does not have these parameters.
    fn px4_lacks(&mut self, names: &[String]) {
        for name in names {
            let mut payload = vec![0, 0, 1, 191];
            payload.extend(name.bytes());
            payload.resize(20, 0);
            payload.push(1);
            let bytes = packet(PARAM_ERROR, PARAM_ERROR_EXTRA, &payload);
            self.hear_bytes(None, &bytes);
        }
    }

    fn ready(&self) -> usize {
        self.count(|event| matches!(event, Event::Ready { .. }))
    }

    /// The numbers of flights that have begun and ended.
    fn flights(&self) -> (usize, usize) {
        let took_off = self.count(|event| matches!(event, Event::TookOff { .. }));
        (
            took_off,
            self.count(|event| matches!(event, Event::Over { .. })),
        )
    }
}

/// A MAVLink 2 packet of the vehicle.
fn packet(id: u32, extra: u8, payload: &[u8]) -> Vec<u8> {
    let [a, b, c, _] = id.to_le_bytes();
    let mut bytes = vec![0xfd, payload.len() as u8, 0, 0, 0, 1, 1, a, b, c];
    bytes.extend(payload);
    let sum = bytes[1..]
        .iter()
        .chain([&extra])
        .fold(0xffff_u16, |sum, byte| {
            (0..8).fold(sum ^ u16::from(*byte), |sum, _| match sum & 1 {
                1 => (sum >> 1) ^ 0x8408,
                _ => sum >> 1,
            })
        });
    bytes.extend(sum.to_le_bytes());
    bytes
}

fn limits() -> Vec<String> {
    ["PWM_MAIN_MIN1", "PWM_MAIN_MAX1"].map(str::to_owned).into()
}

fn coefficients() -> Vec<String> {
    (0..4).map(|rotor| format!("CA_ROTOR{rotor}_CT")).collect()
}

fn value(name: &str, value: f32, time_boot_ms: u32) -> MavMessage {
    MavMessage::NAMED_VALUE_FLOAT(NAMED_VALUE_FLOAT_DATA {
        time_boot_ms,
        value,
        name: name.into(),
    })
}

#[test]
fn a_parameter_that_the_vehicle_does_not_have_is_not_waited_for() {
    let estimator = estimator();
    let mut bench = Bench::new(&estimator, Some(191));
    bench.px4_beat();
    bench.px4_motors();
    bench.wait(0.6);
    assert_eq!(bench.ready(), 0);
    bench.px4_lacks(&limits());
    bench.px4_lacks(&coefficients());
    bench.wait(0.1);
    assert_eq!(bench.setups()[0].assumed, ["commands from 1000 to 2000 us"]);
    let requested = |bench: &Bench<'_>| {
        bench.count_sent(|message| matches!(message, MavMessage::PARAM_REQUEST_READ(_)))
    };
    let before = requested(&bench);
    bench.wait_beating(2, true);
    assert_eq!(requested(&bench), before, "nothing is asked for again");
}

#[test]
fn a_vehicle_found_in_the_air_has_a_risk_before_its_parameters_arrive() {
    let estimator = estimator();
    let mut bench = Bench::new(&estimator, Some(191));
    bench.px4_fly(100.0, 0.8, [1500; 4]);
    for motor in 1..=2 {
        bench.px4_integer(&format!("PWM_MAIN_FUNC{motor}"), 100 + motor);
    }
    bench.px4_fly(100.8, 3.0, [1500; 4]);
    assert_eq!(bench.ready(), 0, "two of four motors are no basis");
    bench.px4_motors();
    bench.px4_fly(103.8, 2.0, [1500; 4]);
    assert!(bench.session.view().unwrap().latest.unwrap().risk.is_ok());
    // The flight begins at its first packet, and is counted only once.
    let took_off = bench.events.iter().filter_map(|event| match event {
        Event::TookOff { t_s } => Some(*t_s),
        _ => None,
    });
    let took_off: Vec<f64> = took_off.collect();
    assert!(took_off.len() == 1 && took_off[0] < 100.2, "{took_off:?}");
}

/// Limits that arrive in flight change the commands of the whole flight: the verdict is the same as if these limits had
/// been known from the start.
#[test]
fn limits_that_arrive_in_the_air_apply_to_the_whole_flight() {
    let estimator = estimator();
    let mut bench = Bench::new(&estimator, Some(191));
    bench.px4_beat();
    bench.px4_motors();
    bench.px4_lacks(&coefficients());
    bench.wait_beating_px4(12);
    assert_eq!(bench.setups()[0].assumed, ["commands from 1000 to 2000 us"]);
    bench.px4_fly(100.0, 30.0, [1400; 4]);
    assert_eq!(bench.count(|event| matches!(event, Event::Level { .. })), 0);
    // With the right limits, 1400 us is nearly the maximum.
    bench.px4_integer("PWM_MAIN_MIN1", 900);
    bench.px4_integer("PWM_MAIN_MAX1", 1402);
    bench.px4_fly(130.0, 5.0, [1400; 4]);
    assert_eq!(bench.ready(), 2);
    assert_eq!(bench.flights(), (1, 0), "it is one flight");
    assert!(bench.count(|event| matches!(event, Event::Level { .. })) > 0);
    let mut out = SessionOutput::default();
    assert_ne!(bench.session.finish(&mut out), Verdict::Known(Level::Good));
}

/// The range of the motors changes between two flights. A change in flight applies after the landing.
#[test]
fn changed_limits_apply_from_the_next_flight() {
    let estimator = estimator();
    let mut bench = Bench::new(&estimator, Some(191));
    bench.px4_beat();
    bench.px4_motors();
    bench.px4_lacks(&coefficients());
    for (name, value) in [("PWM_MAIN_MIN1", 1000), ("PWM_MAIN_MAX1", 2000)] {
        bench.px4_integer(name, value);
    }
    let range = |bench: &Bench<'_>| {
        let range = &bench.session.view().unwrap().setup.unwrap().range;
        (range.low, range.high)
    };
    bench.wait_beating_px4(3);
    bench.px4_fly(100.0, 15.0, [1400; 4]);
    bench.px4_integer("PWM_MAIN_MAX1", 1402);
    bench.px4_fly(115.0, 5.0, [1400; 4]);
    assert_eq!(range(&bench), (1000.0, 2000.0));
    assert_eq!(bench.count(|event| matches!(event, Event::Level { .. })), 0);
    bench.wait_beating_px4(1);
    assert_eq!(range(&bench), (1000.0, 2000.0), "the flight is not over");
    bench.take_message(&servo(120.0, [1000; 4]));
    bench.wait_beating_px4(1);
    assert_eq!(range(&bench), (1000.0, 1402.0));
    bench.px4_integer("PWM_MAIN_MIN1", 900);
    bench.wait_beating_px4(1);
    assert_eq!(range(&bench), (900.0, 1402.0));
    bench.px4_fly(130.0, 15.0, [1400; 4]);
    assert!(bench.count(|event| matches!(event, Event::Level { .. })) > 0);
    assert_eq!(bench.flights(), (2, 1));
}

/// PX4 refused these parameters; later a ground station loads all of them.
#[test]
fn a_refused_parameter_that_arrives_in_the_air_clears_no_alarm() {
    const FAULT: [u16; 4] = [1000, 2000, 1000, 2000];
    let estimator = estimator();
    let mut bench = Bench::new(&estimator, Some(191));
    bench.px4_beat();
    bench.px4_motors();
    bench.px4_lacks(&limits());
    bench.px4_lacks(&coefficients());
    bench.wait(0.6);
    bench.px4_fly(100.0, 15.0, [1500; 4]);
    bench.px4_fly(115.0, 10.0, FAULT);
    for rotor in 0..4 {
        let coefficient = if rotor == 1 { 10.83 } else { 6.5 };
        bench.px4_parameter(&format!("CA_ROTOR{rotor}_CT"), coefficient);
    }
    bench.px4_fly(125.0, 3.0, FAULT);
    assert_eq!(bench.ready(), 2);
    assert_eq!(bench.flights(), (1, 0), "it is one flight");
    assert_eq!(
        bench.session.view().unwrap().latest.unwrap().level,
        Some(Level::Fail)
    );
    let mut out = SessionOutput::default();
    assert_eq!(bench.session.finish(&mut out), Verdict::Known(Level::Fail));
}

impl Bench<'_> {
    fn wait_beating_px4(&mut self, seconds: u32) {
        for _ in 0..seconds {
            self.px4_beat();
            self.px4_state(MavLandedState::MAV_LANDED_STATE_ON_GROUND);
            self.wait(1.0);
        }
    }
}

/// A ground station that connects in flight loads all parameters, including the thrust coefficients.
#[test]
fn parameters_without_effect_do_not_interrupt_the_flight() {
    let estimator = estimator();
    let mut bench = Bench::new(&estimator, Some(191));
    bench.px4_beat();
    bench.px4_motors();
    bench.px4_lacks(&limits());
    bench.wait_beating_px4(12);
    bench.px4_fly(100.0, 20.0, [1500; 4]);
    let before = bench.session.view().unwrap().latest.unwrap();
    let factors = bench.setups()[0].geometry.as_ref().unwrap().factors.clone();
    for rotor in 0..4 {
        bench.px4_parameter(&format!("CA_ROTOR{rotor}_CT"), 6.5);
        bench.px4_parameter(&format!("MPC_OTHER_{rotor}"), 1.0);
        bench.px4_fly(120.0 + f64::from(rotor), 1.0, [1500; 4]);
        let now = bench.session.view().unwrap();
        assert_eq!(
            now.setup.unwrap().geometry.as_ref().unwrap().factors,
            factors
        );
        let latest = now.latest.unwrap();
        assert!(
            latest.risk.is_ok() && latest.level == before.level,
            "{latest:?}"
        );
    }
    assert_eq!(bench.flights(), (1, 0), "it is one flight");
}

/// PX4 repeats the last NAMED_VALUE_FLOAT that it received as its own, with its own time.
#[test]
fn a_value_forwarded_by_px4_is_not_taken_for_another_watch() {
    let estimator = estimator();
    let mut bench = Bench::new(&estimator, Some(191));
    bench.px4_beat();
    bench.px4_motors();
    bench.px4_lacks(&limits());
    bench.px4_lacks(&coefficients());
    bench.wait(0.6);
    let mut echoes = 0;
    let mut risk = None;
    bench.px4_fly_and(100.0, 30.0, [1500, 1400, 1600, 1500], |bench, before| {
        // FR_ELEV is lost, so FR_RISK is repeated.
        let new = bench.sent[before..]
            .iter()
            .find_map(|message| match message {
                MavMessage::NAMED_VALUE_FLOAT(value)
                    if value.name.to_str() == Ok(messages::RISK) =>
                {
                    Some(value.value)
                }
                _ => None,
            });
        let before = risk;
        risk = new.or(risk);
        if let Some(was) = before.filter(|_| new.is_some()) {
            echoes += 1;
            bench.take_message(&value(messages::RISK, was, 90_000 + echoes));
        }
    });
    assert!(echoes > 30, "{echoes}");
    let other = |event: &Event| matches!(event, Event::AnotherWatch { .. });
    assert_eq!(bench.count(other), 0);
    // A module on the vehicle that sends a risk of its own counts as another watch.
    bench.px4_fly_and(130.0, 3.0, [1500; 4], |bench, _| {
        bench.take_message(&value(messages::RISK, 0.123, 1));
    });
    assert_eq!(bench.count(other), 1);
}

#[test]
fn a_warning_is_sent_if_another_watch_does_not_warn() {
    let estimator = estimator();
    for warns in [false, true] {
        let mut bench = Bench::new(&estimator, Some(191));
        bench.px4_beat();
        bench.px4_motors();
        bench.px4_lacks(&limits());
        bench.px4_lacks(&coefficients());
        bench.wait(0.6);
        let texts = |bench: &Bench<'_>| {
            bench.count_sent(|message| matches!(message, MavMessage::STATUSTEXT(_)))
        };
        let mut reported = 0;
        bench.px4_fly_and(100.0, 20.0, [1000, 2000, 1000, 2000], |bench, _| {
            bench.take_message(&value(messages::RISK, 0.123, 1));
            let levels = bench.events.iter().filter_map(|event| match event {
                Event::Level { level, .. } => *level,
                _ => None,
            });
            let levels: Vec<Level> = levels.collect();
            if warns && levels.len() > reported {
                let text = format!("FLAGRED: {} risk 99 %", levels[reported]);
                bench.take_message(&messages::status(levels[reported], &text));
                reported = levels.len();
            }
        });
        let levels = bench.count(|event| matches!(event, Event::Level { .. }));
        assert!(levels > 0);
        assert_eq!(texts(&bench), if warns { 0 } else { levels }, "{warns}");
    }
}

/// EVENT is a message that PX4 sends, and that the message dialect of this program lacks.
#[test]
fn an_unknown_message_of_the_vehicle_is_ignored() {
    let estimator = estimator();
    let mut bench = Bench::new(&estimator, Some(191));
    bench.px4_beat();
    let bytes = packet(410, 160, &[7; 30]);
    let PacketScan::Unverified(unknown) = next_packet(&bytes) else {
        panic!("{:?}", next_packet(&bytes));
    };
    let mut out = SessionOutput::default();
    let mut receive = |packet: &Packet<'_>| bench.session.receive(1.0, None, packet, &mut out);
    assert!(receive(&unknown), "it is recorded");
    let other = Packet {
        system: 9,
        ..unknown
    };
    assert!(!receive(&other));
    assert!(out.events.is_empty());
    // The link is lost, because messages that cannot be verified do not count as traffic.
    bench.wait(2.5);
    assert!(bench.session.view().unwrap().link_lost);
}

/// The motors drop from a hover to 3 %. Returns the level texts, the latest first, and the verdict after the landing.
fn cut(in_the_air: impl Fn(&mut Bench<'_>)) -> (Vec<String>, Verdict) {
    let estimator = shipped::flagred();
    let mut bench = Bench::new(&estimator, Some(191));
    bench.px4_beat();
    bench.px4_motors();
    bench.px4_fly(100.0, 30.0, [1500; 4]);
    for i in 0..150 {
        if i % 25 == 0 {
            in_the_air(&mut bench);
        }
        bench.take_message(&servo(130.0 + f64::from(i) / 25.0, [1030; 4]));
        bench.wait(0.03);
    }
    bench.px4_state(MavLandedState::MAV_LANDED_STATE_ON_GROUND);
    bench.take_message(&servo(136.0, [1030; 4]));
    let texts = bench.events.iter().rev().filter_map(|event| match event {
        Event::Level { text, .. } => Some(text.clone()),
        _ => None,
    });
    let texts = texts.collect();
    (texts, bench.session.finish(&mut SessionOutput::default()))
}

#[test]
fn the_landed_state_overrides_idle_motors() {
    let (texts, verdict) = cut(|bench| {
        bench.px4_beat();
        bench.px4_state(MavLandedState::MAV_LANDED_STATE_IN_AIR);
    });
    assert_eq!(texts[0], "FLAGRED: FAIL motors idle in the air");
    assert_eq!(verdict, Verdict::Known(Level::Fail));
}

/// The landed state may be outdated. After a landing, a pilot may also stop the motors before the land detector reports it.
#[test]
fn an_old_landed_state_and_stopped_motors_are_not_a_fall() {
    let silent = cut(|bench| bench.px4_beat());
    let killed = cut(|bench| {
        bench.take_message(&MavMessage::HEARTBEAT(HEARTBEAT_DATA {
            custom_mode: 0,
            mavtype: MavType::MAV_TYPE_QUADROTOR,
            autopilot: MavAutopilot::MAV_AUTOPILOT_PX4,
            base_mode: MavModeFlag::MAV_MODE_FLAG_SAFETY_ARMED,
            system_status: MavState::MAV_STATE_FLIGHT_TERMINATION,
            mavlink_version: 3,
        }));
        bench.px4_state(MavLandedState::MAV_LANDED_STATE_IN_AIR);
    });
    for (texts, verdict) in [silent, killed] {
        assert_eq!(texts, [] as [&str; 0]);
        assert_eq!(verdict, Verdict::Known(Level::Good));
    }
}
