//! Requested rates, and stations that reduce them.

use super::*;

fn new_way(message: &MavMessage) -> bool {
    matches!(message, MavMessage::COMMAND_LONG(_))
}

#[expect(deprecated, reason = "what old vehicles understand")]
fn old_way(message: &MavMessage) -> bool {
    matches!(message, MavMessage::REQUEST_DATA_STREAM(_))
}

fn count_requests(bench: &Bench<'_>) -> (usize, usize) {
    (bench.count_sent(new_way), bench.count_sent(old_way))
}

fn accepted(by: u8, of: (u8, u8), result: MavResult) -> MavMessage {
    assert_eq!(by, 1);
    MavMessage::COMMAND_ACK(COMMAND_ACK_DATA {
        command: MavCmd::MAV_CMD_SET_MESSAGE_INTERVAL,
        result,
        target_system: of.0,
        target_component: of.1,
        ..COMMAND_ACK_DATA::default()
    })
}

impl Bench<'_> {
    /// Sends motor commands, attitude and landed state at these rates.
    fn stream(&mut self, from_s: f64, seconds: f64, motors_hz: u32, others_hz: u32) {
        use flagred_flightlog::mavlink::dialect::ATTITUDE_DATA;
        for i in 0..(seconds * 50.0) as u32 {
            let t_s = from_s + f64::from(i) / 50.0;
            if i % 50 == 0 {
                self.beat(true);
            }
            if i % (50 / motors_hz) == 0 {
                self.take_message(&servo(t_s, [1500; 4]));
            }
            if i % (50 / others_hz) == 0 {
                self.take_message(&MavMessage::ATTITUDE(ATTITUDE_DATA {
                    time_boot_ms: (t_s * 1e3) as u32,
                    ..ATTITUDE_DATA::default()
                }));
                self.take_message(&MavMessage::EXTENDED_SYS_STATE(EXTENDED_SYS_STATE_DATA {
                    landed_state: MavLandedState::MAV_LANDED_STATE_IN_AIR,
                    ..EXTENDED_SYS_STATE_DATA::default()
                }));
            }
            self.wait(0.02);
        }
    }
}

#[test]
fn rates_are_requested_until_they_arrive_also_by_the_old_message() {
    let estimator = estimator();
    let mut bench = Bench::new(&estimator, Some(191));
    bench.wait_beating(1, false);
    assert_eq!(count_requests(&bench), (0, 0), "it listens first");
    bench.wait_beating(3, false);
    assert_eq!(count_requests(&bench), (6, 0));
    bench.wait_beating(2, false);
    assert_eq!(count_requests(&bench), (6, 3));
    // The values arrive, so nothing more is requested.
    bench.all_parameters();
    bench.stream(10.0, 8.0, 25, 5);
    let (new, old) = count_requests(&bench);
    bench.stream(18.0, 20.0, 25, 5);
    assert_eq!(count_requests(&bench), (new, old));

    // A vehicle that refuses a request immediately receives the older kind of request instead.
    let mut bench = Bench::new(&estimator, Some(191));
    bench.beat(false);
    bench.wait(1.2);
    bench.take_message(&accepted(1, (1, 191), MavResult::MAV_RESULT_UNSUPPORTED));
    bench.wait(0.1);
    assert_eq!(count_requests(&bench), (3, 3));
}

/// A request affects all receivers on a link, and could reduce the rate for another one. Therefore no rate is requested
/// if the current rate is sufficient.
#[test]
fn a_rate_that_is_high_enough_is_not_requested() {
    let estimator = estimator();
    for (motors_hz, others_hz, expected) in [(50, 50, 0), (25, 5, 0), (10, 50, 1), (50, 2, 2)] {
        let mut bench = Bench::new(&estimator, Some(191));
        bench.all_parameters();
        bench.stream(10.0, 2.9, motors_hz, others_hz);
        assert_eq!(
            count_requests(&bench),
            (expected, 0),
            "{motors_hz} Hz, {others_hz} Hz"
        );
    }
    // Two of three packets are lost, but the rate at which the vehicle sends is sufficient.
    let mut bench = Bench::new(&estimator, Some(191));
    bench.beat(true);
    for i in 0..150_u32 {
        let message = MavMessage::SERVO_OUTPUT_RAW(SERVO_OUTPUT_RAW_DATA {
            time_usec: 20_000 * i,
            ..SERVO_OUTPUT_RAW_DATA::default()
        });
        let bytes = bench.vehicle.packet(Version::V2, 1, &message);
        if i % 3 == 0 {
            bench.hear_bytes(None, &bytes);
        }
        bench.wait(0.02);
    }
    let motors = |message: &MavMessage| matches!(message, MavMessage::COMMAND_LONG(command) if command.param1 == 36.0);
    assert_eq!(bench.count_sent(motors), 0);
}

#[test]
fn the_station_that_slows_the_motor_commands_is_named_once() {
    let estimator = estimator();
    let mut bench = Bench::new(&estimator, Some(191));
    bench.beat(true);
    bench.all_parameters();
    bench.stream(10.0, 10.0, 25, 5);
    // An answer to another station changes nothing by itself, and the refusal in it does not concern this watch.
    bench.take_message(&accepted(1, (255, 190), MavResult::MAV_RESULT_UNSUPPORTED));
    bench.take_message(&accepted(1, (255, 190), MavResult::MAV_RESULT_ACCEPTED));
    bench.stream(20.0, 5.0, 25, 5);
    assert_eq!(count_requests(&bench), (0, 0));
    let slowed = |bench: &Bench<'_>| {
        let all = bench.events.iter().filter_map(|event| match event {
            Event::Slowed {
                system,
                component,
                rate_hz,
                ..
            } => Some((*system, *component, *rate_hz)),
            _ => None,
        });
        all.collect::<Vec<_>>()
    };
    assert_eq!(slowed(&bench), []);
    bench.stream(25.0, 12.0, 1, 5);
    let reported = slowed(&bench);
    assert!(
        matches!(reported[..], [(Some(255), Some(190), rate_hz)] if rate_hz < 12.5),
        "{reported:?}"
    );
    assert!(count_requests(&bench).0 > 0, "the rate is asked for again");
    let texts = bench.sent.iter().filter_map(|message| match message {
        MavMessage::STATUSTEXT(status) => Some(status.text.to_str().unwrap().to_owned()),
        _ => None,
    });
    let texts: Vec<String> = texts.filter(|text| text.contains("station")).collect();
    assert!(
        texts.len() == 1 && texts[0].starts_with("FLAGRED: station 255 slows motor data to "),
        "{texts:?}"
    );
}

/// Wherever the rate changes within a measuring interval, the reported rate is the rate after the change.
#[test]
fn the_reported_rate_is_measured_after_the_drop() {
    let estimator = estimator();
    for tenths in 0..20 {
        let mut bench = Bench::new(&estimator, Some(191));
        bench.beat(true);
        bench.all_parameters();
        bench.stream(10.0, 10.0, 25, 5);
        bench.take_message(&accepted(1, (255, 190), MavResult::MAV_RESULT_ACCEPTED));
        bench.stream(20.0, 4.0 + f64::from(tenths) / 10.0, 25, 5);
        bench.stream(26.0, 6.5, 2, 5);
        let reported = bench.events.iter().find_map(|event| match event {
            Event::Slowed { rate_hz, .. } => Some(*rate_hz),
            _ => None,
        });
        let reported = reported.unwrap_or_else(|| panic!("{tenths}: not told within 6.5 s"));
        assert!((1.4..2.6).contains(&reported), "{tenths}: {reported} Hz");
        assert!(
            count_requests(&bench).0 > 0,
            "{tenths}: the rate is asked for again"
        );
    }
}
