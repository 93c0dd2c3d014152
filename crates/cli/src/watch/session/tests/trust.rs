//! Tests of which senders the watch trusts, and of its behaviour when another watch is present.

use flagred_flightlog::mavlink::dialect::NAMED_VALUE_FLOAT_DATA;

use super::*;

fn address(port: u16) -> Source {
    Some(([192, 0, 2, 1], port).into())
}

/// A sender at an address, as a component of a system.
struct Peer {
    source: Source,
    system: u8,
    sender: Sender,
}

impl Peer {
    fn new(port: u16, system: u8, component: u8) -> Peer {
        Peer {
            source: address(port),
            system,
            sender: Sender::new(component),
        }
    }

    fn send(&mut self, bench: &mut Bench<'_>, message: &MavMessage) {
        let bytes = self.sender.packet(Version::V2, self.system, message);
        bench.hear_bytes(self.source, &bytes);
    }
}

impl Bench<'_> {
    fn followed(&self) -> Option<u8> {
        self.session.view().map(|view| view.system)
    }

    fn reported_doubts(&self) -> Vec<UntrustedPacket> {
        let doubts = self.events.iter().filter_map(|event| match event {
            Event::Doubt { what, .. } => Some(*what),
            _ => None,
        });
        doubts.collect()
    }
}

#[test]
fn one_stray_heartbeat_does_not_select_a_vehicle() {
    let estimator = estimator();
    let mut bench = Bench::new(&estimator, Some(191));
    let mut stray = Peer::new(1, 9, 1);
    stray.send(&mut bench, &quadrotor(true));
    assert_eq!(bench.followed(), None);
    bench.wait_beating(1, false);
    assert_eq!(bench.followed(), Some(1));

    // A sender of heartbeats without motor commands is replaced by the one that sends commands.
    let mut bench = Bench::new(&estimator, Some(191));
    let mut vehicle = Peer::new(2, 1, 1);
    for i in 0..20_u32 {
        stray.send(&mut bench, &quadrotor(true));
        bench.wait(0.5);
        if i == 3 {
            assert_eq!(bench.followed(), Some(9));
        }
        if i >= 4 {
            vehicle.send(&mut bench, &quadrotor(false));
            vehicle.send(&mut bench, &servo(f64::from(i) * 0.5, [1500; 4]));
        }
    }
    assert_eq!(bench.followed(), Some(1));
    let locked = bench.count(
        |event| matches!(event, Event::Locked { system: 1, address: sender } if *sender == address(2)),
    );
    assert_eq!(locked, 1);
    assert_eq!(
        bench.count(|event| matches!(event, Event::GivenUp { system: 9 })),
        1
    );
}

#[test]
fn another_vehicle_is_selected_if_the_first_only_sends_heartbeats() {
    let estimator = estimator();
    let mut bench = Bench::new(&estimator, Some(191));
    let (mut stray, mut vehicle) = (Peer::new(1, 9, 1), Peer::new(2, 1, 1));
    for i in 0..9 {
        stray.send(&mut bench, &quadrotor(true));
        if i > 3 {
            vehicle.send(&mut bench, &quadrotor(false));
        }
        bench.wait(1.0);
    }
    assert_eq!(bench.followed(), Some(1));
}

#[test]
fn a_second_sender_is_reported_once_and_ignored_until_the_first_is_silent() {
    let estimator = estimator();
    let mut bench = Bench::new(&estimator, Some(191));
    bench.beat(false);
    bench.all_parameters();
    bench.hover(10.0, 10.0, 1500);
    let mut liar = Peer::new(7, 1, 1);
    let on_ground = MavMessage::EXTENDED_SYS_STATE(EXTENDED_SYS_STATE_DATA {
        landed_state: MavLandedState::MAV_LANDED_STATE_ON_GROUND,
        ..EXTENDED_SYS_STATE_DATA::default()
    });
    for i in 0..100 {
        liar.send(&mut bench, &quadrotor(false));
        liar.send(&mut bench, &on_ground);
        liar.send(&mut bench, &servo(20.0 + f64::from(i) * 0.04, [1999; 4]));
    }
    bench.hover(20.0, 10.0, 1500);
    assert_eq!(bench.reported_doubts(), [UntrustedPacket::SecondSender]);
    assert_eq!(bench.session.doubts().second_sender, 300);
    assert_eq!(bench.count(|event| matches!(event, Event::Over { .. })), 0);
    assert_eq!(bench.count(|event| matches!(event, Event::Level { .. })), 0);

    // The first sender is silent: the flight continues with the second one, and that is reported.
    bench.wait(2.5);
    for i in 0..50 {
        liar.send(&mut bench, &quadrotor(true));
        liar.send(&mut bench, &servo(33.0 + f64::from(i) * 0.04, [1500; 4]));
        bench.wait(0.04);
    }
    let changed = bench.count(
        |event| matches!(event, Event::SenderChanged { from: None, to, .. } if *to == address(7)),
    );
    assert_eq!(changed, 1);
    assert!(!bench.session.view().unwrap().link_lost);
    // The original sender now counts as the second one.
    bench.beat(true);
    assert_eq!(bench.session.doubts().second_sender, 301);
    let mut out = SessionOutput::default();
    bench.session.finish(&mut out);
    let is_left = |event: &Event| {
        matches!(
            event,
            Event::Over {
                end: End::LeftInAir(StopReason::WatchEnded),
                ..
            }
        )
    };
    assert!(out.events.iter().any(is_left));
}

#[test]
fn another_system_is_followed_only_long_after_the_vehicle_fell_silent() {
    let estimator = estimator();
    let mut bench = Bench::new(&estimator, Some(191));
    bench.beat(false);
    bench.all_parameters();
    bench.hover(10.0, 10.0, 1500);
    let mut other = Peer::new(2, 7, 1);
    for _ in 0..28 {
        other.send(&mut bench, &quadrotor(false));
        bench.wait(1.0);
    }
    assert_eq!(bench.followed(), Some(1));
    for _ in 0..5 {
        other.send(&mut bench, &quadrotor(false));
        bench.wait(1.0);
    }
    assert_eq!(bench.followed(), Some(7));
    let is_lost = |event: &Event| {
        matches!(
            event,
            Event::Over {
                end: End::Lost(ContactLoss::Link),
                ..
            }
        )
    };
    assert_eq!(bench.count(is_lost), 1);
    assert_eq!(
        bench.count(|event| matches!(event, Event::AnotherVehicle { .. })),
        1
    );
}

#[test]
fn parameters_of_other_components_are_ignored() {
    let estimator = estimator();
    let mut bench = Bench::new(&estimator, Some(191));
    bench.beat(false);
    let mut gimbal = Peer::new(1, 1, 154);
    for _ in 0..3 {
        gimbal.send(
            &mut bench,
            &MavMessage::PARAM_VALUE(PARAM_VALUE_DATA {
                param_value: 1900.0,
                param_count: 900,
                param_index: u16::MAX,
                param_id: "MOT_PWM_MAX".into(),
                param_type: MavParamType::MAV_PARAM_TYPE_REAL32,
            }),
        );
    }
    bench.all_parameters();
    bench.wait(0.1);
    assert_eq!(bench.setups()[0].range.high, 2000.0);
    assert_eq!(bench.reported_doubts(), [UntrustedPacket::OtherComponent]);
    assert_eq!(bench.session.doubts().other_component, 3);
}

/// A sender at the vehicle's own address sends two packets for each packet of the vehicle. A clock that jumps back is
/// not a reboot while the original clock continues.
#[test]
fn a_clock_that_jumps_once_is_not_a_reboot() {
    let estimator = estimator();
    let mut bench = Bench::new(&estimator, Some(191));
    bench.beat(false);
    bench.all_parameters();
    bench.hover(100.0, 10.0, 1500);
    for i in 0..100 {
        let t_s = 110.0 + f64::from(i) * 0.04;
        bench.take_message(&servo(t_s, [1500; 4]));
        for late_s in [0.0, 0.02] {
            bench.take_message(&servo(t_s - 100.0 + late_s, [1999; 4]));
        }
        bench.wait(0.04);
    }
    assert_eq!(bench.count(|event| matches!(event, Event::Rebooted)), 0);
    assert_eq!(bench.count(|event| matches!(event, Event::Level { .. })), 0);
    assert_eq!(bench.reported_doubts(), [UntrustedPacket::ClockJump]);
    assert_eq!(bench.session.doubts().clock_jumps, 200);
    let latest = bench.session.view().unwrap().latest.unwrap();
    assert!(latest.risk.is_ok() && latest.t_s > 113.0, "{latest:?}");

    // A vehicle that reboots is silent before it sends again.
    bench.wait_beating(3, true);
    for i in 0..5 {
        bench.take_message(&servo(1.0 + f64::from(i) * 0.04, [1000; 4]));
        bench.wait(0.04);
    }
    assert_eq!(bench.count(|event| matches!(event, Event::Rebooted)), 1);
}

fn watch_beat(age_s: f64) -> MavMessage {
    messages::heartbeat(age_s)
}

fn risk() -> MavMessage {
    MavMessage::NAMED_VALUE_FLOAT(NAMED_VALUE_FLOAT_DATA {
        time_boot_ms: 1,
        value: 20.0,
        name: messages::RISK.into(),
    })
}

fn warned(bench: &Bench<'_>) -> usize {
    bench.count_sent(|message| matches!(message, MavMessage::STATUSTEXT(_)))
}

fn count_sent(bench: &Bench<'_>) -> usize {
    bench.count_sent(|message| {
        matches!(
            message,
            MavMessage::NAMED_VALUE_FLOAT(_) | MavMessage::HEARTBEAT(_)
        )
    })
}

#[test]
fn the_older_of_two_watches_sends_and_the_younger_takes_over() {
    let estimator = estimator();
    let mut bench = Bench::new(&estimator, Some(191));
    bench.wait(10.0);
    bench.beat(false);
    bench.all_parameters();
    let mut elder = Peer::new(4, 1, 191);
    elder.send(&mut bench, &watch_beat(60.0));
    let before = count_sent(&bench);
    for i in 0..10_u32 {
        elder.send(&mut bench, &watch_beat(61.0 + f64::from(i)));
        elder.send(&mut bench, &risk());
        bench.hover(10.0 + f64::from(i), 1.0, 1950);
    }
    assert!(bench.count(|event| matches!(event, Event::Level { .. })) > 0);
    assert_eq!(count_sent(&bench), before, "it sends no values");
    assert!(warned(&bench) > 0, "the older one did not warn");
    let reported = |component: Option<u8>, is_sending: bool| move |event: &Event| matches!(event, Event::AnotherWatch { component: c, is_sending: s, .. } if (*c, *s) == (component, is_sending));
    assert_eq!(bench.count(reported(Some(191), false)), 1);
    bench.hover(20.0, 10.0, 1950);
    assert_eq!(bench.count(reported(None, true)), 1);
    assert!(count_sent(&bench) > before + 10);

    // Another watch with a shorter running time does not silence this one.
    elder.send(&mut bench, &watch_beat(1.0));
    let before = count_sent(&bench);
    bench.hover(30.0, 4.0, 1950);
    assert!(count_sent(&bench) > before + 3);
}

#[test]
fn a_risk_sent_by_the_autopilot_is_repeated_only_on_request() {
    let estimator = estimator();
    for insists in [false, true] {
        let mut bench = Bench::new(&estimator, None);
        bench.session = Session::new(&estimator, Some(Sender::new(191)), insists);
        bench.beat(false);
        bench.all_parameters();
        for i in 0..10_u32 {
            bench.take_message(&risk());
            bench.hover(10.0 + f64::from(i), 1.0, 1950);
        }
        assert_eq!(count_sent(&bench) > 0, insists);
        assert!(warned(&bench) > 0, "a warning is sent in any case");
        assert_eq!(bench.count(|event| matches!(event, Event::AnotherWatch { component: Some(1), is_sending, .. } if *is_sending == insists)), 1);
    }
}

/// A link that returns every packet is not another watch.
#[test]
fn an_echo_of_the_watch_is_not_taken_for_another_watch() {
    let estimator = estimator();
    let mut bench = Bench::new(&estimator, Some(191));
    bench.beat(false);
    bench.all_parameters();
    let mut out = SessionOutput::default();
    bench.session.tick(1.1, &mut out);
    bench.session.tick(2.2, &mut out);
    assert!(!out.packets.is_empty());
    for packet in out.packets {
        bench.hear_bytes(None, &packet);
    }
    assert_eq!(
        bench.count(|event| matches!(event, Event::AnotherWatch { .. })),
        0
    );
}
