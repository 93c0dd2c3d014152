//! The messages of `flagred watch` to the vehicle, and their delays.

use std::{path::Path, time::Duration};

use flagred_tests::{
    STEADY,
    vehicle::flight,
    watch::{Watch, fly_udp},
    wire::{Link, Speed},
};

/// The delays from a motor command to its risk on the wire, in ms and ascending, for the values sent in `seconds`
/// seconds at 50 Hz.
fn late_ms(seconds: f64) -> Vec<f64> {
    let flight = flight(Path::new(STEADY));
    let watch = Watch::udp(&[]);
    let mut vehicle = watch.vehicle(&flight, Link::default());
    vehicle.look_every = Duration::from_micros(200);
    vehicle.meet();
    // The log has a rate of 25 Hz, so it is replayed at twice the speed.
    let air = flight.in_air.as_ref().unwrap().spans[0];
    let end_s = air.start_s + 2.0 * seconds;
    assert!(end_s <= air.end_s, "the flight is too short");
    vehicle.fly(&flight, Speed::Times(2.0), air.start_s, end_s);
    watch.end();
    let values = vehicle.received.values("FR_RISK");
    assert!(values.len() as f64 >= 1.5 * seconds, "{}", values.len());
    let mut late_ms: Vec<f64> = values
        .iter()
        .map(|(at, t_ms, _)| {
            let sent = vehicle.sent.iter().find(|(sent_ms, _)| sent_ms == t_ms);
            at.duration_since(sent.unwrap().1).as_secs_f64() * 1e3
        })
        .collect();
    late_ms.sort_by(f64::total_cmp);
    late_ms
}

/// Other tests share the machine, so only half of the values must meet the limit.
#[test]
fn the_risk_is_on_the_wire_within_5_ms() {
    let late_ms = late_ms(8.0);
    eprintln!("from command to risk: {late_ms:.2?} ms");
    assert!(late_ms[late_ms.len() / 2] < 5.0, "{late_ms:?}");
}

/// Needs an otherwise idle machine; `scripts/measure-live` runs it.
#[test]
#[ignore = "for a machine that does nothing else"]
fn all_but_one_percent_of_risks_are_on_the_wire_within_5_ms() {
    let late_ms = late_ms(55.0);
    let at = |share: f64| late_ms[((late_ms.len() as f64 * share).ceil() as usize).max(1) - 1];
    println!(
        "from command to risk on the wire, {} values at 50 Hz: median {:.2} ms, 99th percentile {:.2} ms, largest {:.2} ms",
        late_ms.len(),
        at(0.5),
        at(0.99),
        at(1.0)
    );
    assert!(at(0.99) < 5.0, "{late_ms:?}");
}

#[test]
fn watch_is_an_onboard_controller_and_sends_values_every_half_second() {
    let flight = flight(Path::new(STEADY));
    let (_, vehicle) = fly_udp(
        &flight,
        Link::default(),
        &["--component", "192"],
        Speed::Fastest,
    );
    let received = &vehicle.received;
    assert!(
        received
            .messages
            .iter()
            .all(|(_, system, component, _)| (*system, *component) == (1, 192))
    );
    let beat = received
        .messages
        .iter()
        .find_map(|(_, _, _, message)| match message {
            flagred_flightlog::mavlink::dialect::MavMessage::HEARTBEAT(beat) => Some(beat),
            _ => None,
        });
    let beat = beat.unwrap();
    assert_eq!((beat.mavtype as u8, beat.autopilot as u8), (18, 8));
    for name in ["FR_RISK", "FR_ELEV"] {
        let values = received.values(name);
        assert!(!values.is_empty(), "{name}");
        assert!(
            values
                .iter()
                .all(|(_, _, value)| (0.0..=100.0).contains(value))
        );
        for pair in values.windows(2) {
            assert!(pair[1].0 - pair[0].0 > Duration::from_millis(400), "{name}");
        }
    }
}
