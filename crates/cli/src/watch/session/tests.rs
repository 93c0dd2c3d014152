use flagred::{shipped, verdict::Level};
use flagred_flightlog::mavlink::{
    PacketScan, Setup,
    dialect::{
        COMMAND_ACK_DATA, EXTENDED_SYS_STATE_DATA, HEARTBEAT_DATA, MavAutopilot, MavCmd,
        MavLandedState, MavMessage, MavModeFlag, MavParamType, MavResult, MavState, MavType,
        PARAM_VALUE_DATA, SERVO_OUTPUT_RAW_DATA,
    },
    next_packet,
};

use super::*;

mod flood;
mod outputs;
mod px4;
mod rates;
mod signals;
mod trust;

/// A session, a simulated vehicle at the other end of the link, and the clock that both share.
pub(crate) struct Bench<'e> {
    pub(crate) session: Session<'e>,
    vehicle: Sender,
    now_s: f64,
    events: Vec<Event>,
    sent: Vec<MavMessage>,
}

/// The heartbeat of a quadrotor.
pub(crate) fn quadrotor(in_air: bool) -> MavMessage {
    let mut base_mode = MavModeFlag::empty();
    base_mode.set(MavModeFlag::MAV_MODE_FLAG_SAFETY_ARMED, in_air);
    MavMessage::HEARTBEAT(HEARTBEAT_DATA {
        custom_mode: 0,
        mavtype: MavType::MAV_TYPE_QUADROTOR,
        autopilot: MavAutopilot::MAV_AUTOPILOT_ARDUPILOTMEGA,
        base_mode,
        system_status: MavState::MAV_STATE_ACTIVE,
        mavlink_version: 3,
    })
}

/// Four motor commands with a timestamp of the vehicle's clock, which wraps every 71 minutes.
pub(crate) fn servo(t_s: f64, pulses_us: [u16; 4]) -> MavMessage {
    let [servo1_raw, servo2_raw, servo3_raw, servo4_raw] = pulses_us;
    MavMessage::SERVO_OUTPUT_RAW(SERVO_OUTPUT_RAW_DATA {
        time_usec: (t_s * 1e6) as u64 as u32,
        servo1_raw,
        servo2_raw,
        servo3_raw,
        servo4_raw,
        ..SERVO_OUTPUT_RAW_DATA::default()
    })
}

pub(crate) fn estimator() -> Estimator {
    shipped::flagred_paper()
}

impl<'e> Bench<'e> {
    pub(crate) fn new(estimator: &'e Estimator, component: Option<u8>) -> Bench<'e> {
        Bench {
            session: Session::new(estimator, component.map(Sender::new), false),
            vehicle: Sender::new(1),
            now_s: 0.0,
            events: Vec::new(),
            sent: Vec::new(),
        }
    }

    fn take(&mut self, out: SessionOutput) {
        self.events.extend(out.events);
        self.sent
            .extend(out.packets.iter().map(|bytes| match next_packet(bytes) {
                PacketScan::Packet(packet) => packet.message().unwrap(),
                other => panic!("{other:?}"),
            }));
    }

    fn take_message(&mut self, message: &MavMessage) {
        let bytes = self.vehicle.packet(Version::V2, 1, message);
        self.hear_bytes(None, &bytes);
    }

    /// Receives the bytes of a packet from an address.
    fn hear_bytes(&mut self, source: Source, bytes: &[u8]) {
        let PacketScan::Packet(packet) = next_packet(bytes) else {
            panic!("{bytes:?}");
        };
        let mut out = SessionOutput::default();
        self.session.receive(self.now_s, source, &packet, &mut out);
        self.take(out);
    }

    /// Sends a heartbeat, or as many as needed if the vehicle is not followed yet.
    pub(crate) fn beat(&mut self, in_air: bool) {
        let times = if self.session.view().is_none() { 3 } else { 1 };
        for _ in 0..times {
            self.take_message(&quadrotor(in_air));
        }
    }

    /// Advances the time in steps of 20 ms.
    fn wait(&mut self, seconds: f64) {
        let end_s = self.now_s + seconds;
        while self.now_s < end_s {
            self.now_s += 0.02;
            let mut out = SessionOutput::default();
            self.session.tick(self.now_s, &mut out);
            self.take(out);
        }
    }

    /// Advances the time with one heartbeat per second.
    fn wait_beating(&mut self, seconds: u32, in_air: bool) {
        for _ in 0..seconds {
            self.beat(in_air);
            self.wait(1.0);
        }
    }

    fn parameter(&mut self, name: &str, value: f32) {
        self.take_message(&MavMessage::PARAM_VALUE(PARAM_VALUE_DATA {
            param_value: value,
            param_count: 900,
            param_index: u16::MAX,
            param_id: name.into(),
            param_type: MavParamType::MAV_PARAM_TYPE_REAL32,
        }));
    }

    pub(crate) fn all_parameters(&mut self) {
        for (name, value) in [
            ("MOT_PWM_MIN", 1000.0),
            ("MOT_PWM_MAX", 2000.0),
            ("MOT_SPIN_MIN", 0.1),
            ("MOT_SPIN_MAX", 0.9),
            ("FRAME_CLASS", 1.0),
            ("FRAME_TYPE", 1.0),
        ] {
            self.parameter(name, value);
        }
        for output in 1..=16_u8 {
            let function = if output <= 4 { 32 + output } else { 0 };
            self.parameter(&format!("SERVO{output}_FUNCTION"), f32::from(function));
        }
    }

    /// Hovers at 25 Hz, starting at a time of the vehicle's clock.
    pub(crate) fn hover(&mut self, from_s: f64, seconds: f64, pulse: u16) {
        self.fly(from_s, seconds, |i| {
            let wiggle = (i % 5) as u16;
            [pulse + wiggle, pulse, pulse - wiggle, pulse]
        });
    }

    /// Flies at 25 Hz with the pulses of each sample, starting at a time of the vehicle's clock.
    fn fly(&mut self, from_s: f64, seconds: f64, pulses: impl Fn(u32) -> [u16; 4]) {
        for i in 0..(seconds * 25.0) as u32 {
            if i % 25 == 0 {
                self.beat(true);
            }
            self.take_message(&servo(from_s + f64::from(i) / 25.0, pulses(i)));
            self.wait(0.03);
        }
    }

    /// The text of the latest level.
    fn last_text(&self) -> &str {
        let mut events = self.events.iter().rev();
        let text = events.find_map(|event| match event {
            Event::Level { text, .. } => Some(text.as_str()),
            _ => None,
        });
        text.expect("a level was told")
    }

    fn setups(&self) -> Vec<&Setup> {
        let setups = self.events.iter().filter_map(|event| match event {
            Event::Ready { setup, .. } => Some(setup),
            _ => None,
        });
        setups.collect()
    }

    fn count(&self, is: impl Fn(&Event) -> bool) -> usize {
        self.events.iter().filter(|event| is(event)).count()
    }

    fn count_sent(&self, is: impl Fn(&MavMessage) -> bool) -> usize {
        self.sent.iter().filter(|message| is(message)).count()
    }
}

#[test]
fn missing_parameters_are_assumed_and_late_ones_are_used() {
    let estimator = estimator();
    let mut bench = Bench::new(&estimator, Some(191));
    bench.wait_beating(9, false);
    assert!(bench.setups().is_empty(), "too early to assume");
    bench.wait_beating(3, false);
    let assumed = bench.setups()[0].assumed.clone();
    assert_eq!(
        assumed,
        [
            "motors 1 to 4 on outputs 1 to 4",
            "commands from 1000 to 2000 us",
            "effective range 0.15 to 0.95",
        ]
    );
    let requested = |message: &MavMessage| match message {
        MavMessage::PARAM_REQUEST_READ(request) => request.param_id.to_str() == Ok("MOT_PWM_MIN"),
        _ => false,
    };
    assert_eq!(bench.count_sent(requested), 20);

    bench.all_parameters();
    bench.wait(0.1);
    let last = bench.setups()[1];
    assert_eq!(last.assumed, [] as [&str; 0]);
    assert_eq!(
        (last.effective_range.low, last.effective_range.high),
        (f64::from(0.1_f32), f64::from(0.9_f32))
    );
    assert_eq!(last.motors[2].source, "SERVO3_FUNCTION = 35");
    // Repeated parameters are not reported again.
    bench.all_parameters();
    bench.wait(0.1);
    assert_eq!(bench.setups().len(), 2);
}

#[test]
fn a_given_range_is_used_until_the_vehicle_reports_its_own() {
    let estimator = estimator();
    let mut bench = Bench::new(&estimator, Some(191));
    let given = flagred_flightlog::PulseRange::new(1100, 1900).unwrap();
    bench.session = Session::new(&estimator, Some(Sender::new(191)), false).with_range(Some(given));
    bench.wait_beating(12, false);
    let setup = bench.setups()[0];
    assert_eq!((setup.range.low, setup.range.high), (1100.0, 1900.0));
    let assumption = "commands from 1100 to 1900 us, given by the user";
    assert!(
        setup.assumed.contains(&assumption.to_owned()),
        "{:?}",
        setup.assumed
    );
    let is_ignored = |event: &Event| matches!(event, Event::Note { text } if text.contains("`--range` is ignored"));
    assert!(!bench.events.iter().any(is_ignored));
    bench.all_parameters();
    bench.wait(0.1);
    assert_eq!(bench.setups()[1].range.low, 1000.0);
    assert!(bench.events.iter().any(is_ignored));
}

#[test]
fn damaged_parameters_are_ignored() {
    let estimator = estimator();
    let mut bench = Bench::new(&estimator, Some(191));
    bench.beat(false);
    for value in [f32::NAN, f32::INFINITY, 65535.0, -1.0] {
        for name in ["MOT_SPIN_MIN", "MOT_SPIN_MAX", "MOT_PWM_MIN", "MOT_PWM_MAX"] {
            bench.parameter(name, value);
        }
    }
    bench.all_parameters();
    bench.wait(0.1);
    let setup = bench.setups()[0];
    assert_eq!((setup.range.low, setup.range.high), (1000.0, 2000.0));
    assert_eq!(setup.assumed, [] as [&str; 0]);
}

#[test]
fn a_watch_that_only_listens_sends_nothing() {
    let estimator = estimator();
    let mut bench = Bench::new(&estimator, None);
    bench.wait_beating(9, false);
    assert!(bench.setups().is_empty());
    bench.wait_beating(2, false);
    assert_eq!(bench.setups().len(), 1);
    bench.hover(100.0, 12.0, 1950);
    assert!(bench.count(|event| matches!(event, Event::Level { .. })) > 0);
    assert!(bench.sent.is_empty());
}

#[test]
fn a_flight_at_the_limit_is_reported_once_per_level() {
    let estimator = estimator();
    let mut bench = Bench::new(&estimator, Some(191));
    bench.beat(false);
    bench.all_parameters();
    bench.hover(10.0, 10.0, 1500);
    let texts = |message: &MavMessage| matches!(message, MavMessage::STATUSTEXT(_));
    assert_eq!(bench.count_sent(texts), 0, "calm");
    bench.fly(20.0, 20.0, |_| [1100, 1900, 1100, 1900]);
    let levels = bench.count(|event| matches!(event, Event::Level { .. }));
    assert!((1..=2).contains(&levels), "{levels}");
    assert_eq!(bench.count_sent(texts), levels);
    let text = bench.last_text();
    assert!(text.starts_with("FLAGRED: FAIL risk "), "{text}");
    assert!(text.ends_with(" %, lower limit, motor 1"), "{text}");
    // For half a minute of the receiver's clock, values are sent four times a second.
    let values = bench.count_sent(|message| matches!(message, MavMessage::NAMED_VALUE_FLOAT(_)));
    assert!((160..=260).contains(&values), "{values}");
    let mut out = SessionOutput::default();
    assert_eq!(bench.session.finish(&mut out), Verdict::Known(Level::Fail));
}

#[test]
fn a_risk_without_a_motor_at_its_limit_is_reported_with_its_meaning() {
    let estimator = shipped::flagred();
    let mut bench = Bench::new(&estimator, Some(191));
    bench.beat(false);
    bench.all_parameters();
    bench.hover(10.0, 10.0, 1500);
    // The vehicle rolls every other second.
    bench.fly(20.0, 10.0, |i| {
        let roll = if i % 50 < 25 { 0 } else { 200 };
        let [left, right] = [1500 - roll, 1500 + roll];
        [left, right, right, left]
    });
    let text = bench.last_text().to_owned();
    assert!(
        text.starts_with("FLAGRED: WARN risk ") || text.starts_with("FLAGRED: FAIL risk "),
        "{text}"
    );
    assert!(
        text.contains(" %, sudden change") && text.len() <= 50,
        "{text}"
    );
    let mut out = SessionOutput::default();
    bench.session.finish(&mut out);
    let ended = out.events.iter().find_map(|event| match event {
        Event::Ended { finding } => Some(finding),
        _ => None,
    });
    let brief = ended.unwrap().words(&estimator).brief.concat();
    assert!(text.ends_with(&format!(", {brief}")), "{text}");
}

/// Motor 3 gets weaker in flight: the level remains until the landing, and text and finding name
/// the motor.
#[test]
fn a_lasting_imbalance_is_reported_with_its_motor_until_landing() {
    let estimator = shipped::flagred();
    let mut bench = Bench::new(&estimator, Some(191));
    bench.beat(false);
    bench.all_parameters();
    bench.hover(10.0, 40.0, 1500);
    bench.fly(50.0, 60.0, |i| {
        let wiggle = (i % 5) as u16;
        let more = i.min(400) as u16 / 2;
        [
            1500 + wiggle,
            1500 - more / 4,
            1500 + more - wiggle,
            1500 - more / 4,
        ]
    });
    assert_eq!(
        bench.session.view().unwrap().latest.unwrap().level,
        Some(Level::Warn)
    );
    let reported = bench.events.iter().rev().find_map(|event| match event {
        Event::Level { text, motor, .. } => Some((text.clone(), motor.as_ref()?.number)),
        _ => None,
    });
    let (text, motor) = reported.unwrap();
    assert!(text.starts_with("FLAGRED: WARN motor 3 weak: +"), "{text}");
    assert_eq!(motor, 3);
    let mut out = SessionOutput::default();
    assert_eq!(bench.session.finish(&mut out), Verdict::Known(Level::Warn));
}

/// A motor is weak, then the link is lost for 6 s, then the vehicle lands.
#[test]
fn good_is_never_reported_for_an_unknown_risk() {
    let estimator = shipped::flagred();
    let mut bench = Bench::new(&estimator, Some(191));
    bench.beat(false);
    bench.all_parameters();
    bench.hover(10.0, 40.0, 1500);
    let weak = |i: u32| [1700 + (i % 5) as u16, 1500, 1500 - (i % 5) as u16, 1500];
    bench.fly(50.0, 20.0, weak);
    assert!(
        bench.last_text().contains("motor 1 weak: +"),
        "{}",
        bench.last_text()
    );
    bench.wait(6.0);
    bench.fly(76.0, 0.4, weak);
    assert_eq!(bench.last_text(), "FLAGRED: risk unknown, last level WARN");
    bench.fly(76.4, 30.6, weak);
    let before = bench.count(|event| matches!(event, Event::Level { .. }));
    // The vehicle is on the ground.
    bench.fly(107.0, 2.0, |_| [1000; 4]);
    assert_eq!(
        bench.count(|event| matches!(event, Event::Level { .. })),
        before
    );
    let is_good = |event: &Event| match event {
        Event::Level { level, text, .. } => *level == Some(Level::Good) || text.contains("GOOD"),
        Event::Risk { update } => update.risk.is_err() && update.level == Some(Level::Good),
        _ => false,
    };
    assert_eq!(bench.count(is_good), 0);
}

#[test]
fn a_silence_makes_the_risk_unknown_and_is_reported_once() {
    let estimator = estimator();
    let mut bench = Bench::new(&estimator, Some(191));
    bench.beat(false);
    bench.all_parameters();
    bench.hover(10.0, 10.0, 1500);
    assert!(bench.session.view().unwrap().latest.unwrap().risk.is_ok());
    bench.wait(1.5);
    assert_eq!(bench.count(|event| matches!(event, Event::Lost { .. })), 0);
    bench.wait(5.0);
    let lost = |what: SilentSource| move |event: &Event| matches!(event, Event::Lost { what: of } if *of == what);
    assert_eq!(bench.count(lost(SilentSource::Link)), 1);
    assert_eq!(bench.count(lost(SilentSource::MotorCommands)), 0);
    let view = bench.session.view().unwrap();
    assert!(view.latest.is_none() && view.margin.is_none() && view.motors.is_empty());
    let requested = bench.sent.len();
    bench.wait(0.5);
    assert!(
        bench.sent.len() <= requested + 1,
        "it is not asked while it is not there"
    );

    // Only heartbeats arrive: the link is back, but the motor commands are still missing.
    bench.wait_beating(4, true);
    assert_eq!(bench.count(lost(SilentSource::MotorCommands)), 1);
    assert!(bench.session.view().unwrap().latest.is_none());
    bench.hover(40.0, 1.0, 1500);
    assert_eq!(bench.count(|event| matches!(event, Event::Back { .. })), 2);
    let now = bench.session.view().unwrap().latest.unwrap();
    assert!(
        now.risk.is_err(),
        "what was before the silence is forgotten"
    );
}

/// The microseconds since boot wrap after 71 minutes. That is not a reboot, and no state is lost.
#[test]
fn a_restarted_clock_is_continued() {
    let estimator = estimator();
    let mut bench = Bench::new(&estimator, Some(191));
    bench.beat(false);
    bench.all_parameters();
    bench.hover(4290.0, 10.0, 1500);
    assert_eq!(bench.count(|event| matches!(event, Event::Rebooted)), 0);
    let latest = bench.session.view().unwrap().latest.unwrap();
    assert!(latest.risk.is_ok() && latest.t_s > 4299.0, "{latest:?}");
}

/// Two motors of the hexacopter are not assigned to an output.
#[test]
fn a_vehicle_whose_motors_are_not_all_known_ends_with_that_reason() {
    let estimator = estimator();
    let mut bench = Bench::new(&estimator, Some(191));
    bench.all_parameters();
    bench.parameter("FRAME_CLASS", 2.0);
    let MavMessage::HEARTBEAT(quadrotor) = quadrotor(true) else {
        panic!("no heartbeat")
    };
    let hexarotor = MavMessage::HEARTBEAT(HEARTBEAT_DATA {
        mavtype: MavType::MAV_TYPE_HEXAROTOR,
        ..quadrotor
    });
    for i in 0..500 {
        if i % 25 == 0 {
            bench.take_message(&hexarotor);
        }
        if i == 50 {
            bench.all_parameters();
            bench.parameter("FRAME_CLASS", 2.0);
        }
        bench.take_message(&servo(10.0 + f64::from(i) / 25.0, [1500; 4]));
        bench.wait(0.03);
    }
    let verdict = bench.session.finish(&mut SessionOutput::default());
    assert_eq!(verdict.to_string(), "NA");
    let Verdict::NotAvailable(reason) = verdict else {
        panic!("{verdict:?}")
    };
    assert_eq!(
        reason.to_string(),
        "outputs are known for 4 of the 6 motors only"
    );
}
