//! `flagred watch` with other senders that use the vehicle's identity, or with other watches.

use std::{net::TcpStream, path::Path, time::Duration};

use flagred_flightlog::{
    Flight,
    mavlink::{
        Key, Version,
        dialect::{
            EXTENDED_SYS_STATE_DATA, MavLandedState, MavMessage, MavParamType, PARAM_VALUE_DATA,
        },
    },
};
use flagred_tests::{
    Folder, STEADY, schema,
    vehicle::{StandIn, flight, servo},
    watch::{Watch, WatchOutput, assess, compare, refused},
    wire::{Link, Speed, Wire},
};
use serde_json::json;

fn steady() -> (Flight, f64) {
    let flight = flight(Path::new(STEADY));
    let start_s = flight.in_air.as_ref().unwrap().spans[0].start_s;
    (flight, start_s)
}

/// Asserts that every line matches `flagred schema watch`.
fn valid(output: &WatchOutput) {
    let schema = schema::schema("watch");
    for line in &output.events {
        assert_eq!(schema::errors(&schema, line), Vec::<String>::new());
    }
}

/// Sends motors at their limits, a landing and a parameter, with the identity of the vehicle.
fn lie(liar: &mut StandIn, t_s: f64) {
    liar.beat(false, false);
    liar.send(&servo((t_s * 1e6) as u32, &[2000; 16]));
    liar.send(&MavMessage::EXTENDED_SYS_STATE(EXTENDED_SYS_STATE_DATA {
        landed_state: MavLandedState::MAV_LANDED_STATE_ON_GROUND,
        ..EXTENDED_SYS_STATE_DATA::default()
    }));
    liar.send(&maximum(1100.0));
}

fn maximum(value_us: f32) -> MavMessage {
    MavMessage::PARAM_VALUE(PARAM_VALUE_DATA {
        param_value: value_us,
        param_count: 900,
        param_index: u16::MAX,
        param_id: "MOT_PWM_MAX".into(),
        param_type: MavParamType::MAV_PARAM_TYPE_REAL32,
    })
}

#[test]
fn a_second_sender_is_reported_and_ignored() {
    let (flight, start_s) = steady();
    let folder = Folder::new();
    let file = folder.at("flight.tlog");
    let watch = Watch::udp(&["--record", &file]);
    let mut vehicle = watch.vehicle(&flight, Link::default());
    let mut liar = watch.vehicle(&flight, Link::default());
    vehicle.say_as(154, &maximum(1200.0));
    vehicle.meet();
    vehicle.say_as(154, &maximum(1200.0));
    for i in 0..20 {
        let at_s = start_s + f64::from(i);
        vehicle.fly(&flight, Speed::Fastest, at_s, at_s + 1.0);
        lie(&mut liar, at_s + 0.99);
        liar.linger(Duration::from_millis(2));
    }
    let said = watch.end();
    assert_eq!(said.one("locked")["system"], 1);
    assert_eq!(said.one("ready")["range"]["high"], 2000.0);
    assert_eq!(said.all("level").count() + said.all("landed").count(), 0);
    let reported: Vec<&str> = said
        .all("doubt")
        .map(|doubt| doubt["what"].as_str().unwrap())
        .collect();
    assert_eq!(reported, ["other_component", "second_sender"]);
    let not_believed = &said.one("ended")["not_believed"];
    assert_eq!(not_believed["second_sender"], 80);
    assert_eq!(said.verdict(), "GOOD");
    assert!(!vehicle.received.values("FR_RISK").is_empty());
    assert!(liar.received.messages.is_empty(), "{:?}", liar.received);
    valid(&said);
    // The packets of the liar are not used either when the recording is assessed.
    let assessed = assess(Path::new(&file));
    assert_eq!(assessed["verdict"], "GOOD");
    let (share, difference) = compare(&said, &assessed);
    // One sample of 475 is in only one of the two results.
    assert!(share > 0.99 && difference < 0.5, "{share}, {difference}");
}

#[test]
fn a_vehicle_that_comes_back_from_another_address_is_followed_after_a_silence() {
    let (flight, start_s) = steady();
    let watch = Watch::udp(&[]);
    let mut vehicle = watch.vehicle(&flight, Link::default());
    vehicle.meet();
    vehicle.fly(&flight, Speed::Fastest, start_s, start_s + 10.0);
    vehicle.linger(Duration::from_millis(2300));
    vehicle.move_to(Wire::udp(watch.address()));
    vehicle.fly(&flight, Speed::Fastest, start_s + 12.0, start_s + 30.0);
    let said = watch.end();
    let changed = said.one("sender_changed");
    assert_ne!(changed["from"], changed["to"]);
    assert_eq!(said.one("found")["system"], 1);
    assert_eq!(said.one("left_in_air")["verdict"], "GOOD");
    valid(&said);
}

#[test]
fn only_one_of_two_watches_sends() {
    let (flight, start_s) = steady();
    let first = Watch::udp(&[]);
    // The running times must differ by more than a tenth of a second, the unit in which the watches compare them.
    std::thread::sleep(Duration::from_millis(400));
    let second = Watch::udp(&[]);
    let mut vehicle = first.vehicle(&flight, Link::default());
    vehicle.forward_to(Wire::udp(second.address()));
    vehicle.meet();
    for _ in 0..30 {
        vehicle.beat(false, false);
        vehicle.linger(Duration::from_millis(50));
    }
    vehicle.fly(&flight, Speed::Times(4.0), start_s, start_s + 20.0);
    let (first, second) = (first.end(), second.end());
    let reported = second.one("another_watch");
    assert_eq!(
        (&reported["component"], &reported["speaks"]),
        (&json!(191), &json!(false))
    );
    assert_eq!(
        first
            .all("another_watch")
            .filter(|reported| reported["speaks"] == false)
            .count(),
        0
    );
    assert!(vehicle.received.values("FR_RISK").len() > 2);
    assert_eq!(vehicle.heard_elsewhere.values("FR_RISK").len(), 0);
    // Both watches report the risk.
    for said in [&first, &second] {
        assert_eq!(said.one("left_in_air")["verdict"], "GOOD");
        valid(said);
    }
}

#[test]
fn with_a_key_only_signed_packets_are_accepted_and_sent() {
    let (flight, start_s) = steady();
    let folder = Folder::new();
    let file = folder.file("key", "0b".repeat(32));
    let watch = Watch::udp(&["--key", &file]);
    let key = Key::from_bytes(&[0x0b; 32]).unwrap();
    let mut liar = watch.vehicle(&flight, Link::default());
    let mut vehicle = watch.vehicle(&flight, Link::default());
    vehicle.sign(&key);
    // The liar sends first, unsigned and then with the wrong key; the vehicle is accepted anyway.
    for _ in 0..5 {
        lie(&mut liar, 1.0);
    }
    liar.sign(&Key::from_bytes(&[0x0c; 32]).unwrap());
    for _ in 0..5 {
        lie(&mut liar, 1.0);
    }
    vehicle.meet();
    vehicle.fly_on(&flight, Speed::Fastest, start_s, start_s + 20.0);
    vehicle.linger(Duration::from_millis(300));
    let said = watch.end();
    let ended = said.one("ended");
    assert_eq!(
        (&ended["unsigned"], &ended["bad_signatures"]),
        (&json!(20), &json!(20))
    );
    assert_eq!(ended["not_believed"]["second_sender"], 0);
    assert!(said.has_note("not signed") && said.has_note("signature"));
    assert_eq!(said.verdict(), "GOOD");
    assert!(!vehicle.received.values("FR_RISK").is_empty());
    let skipped = vehicle.skipped();
    assert_eq!(
        (skipped.unsigned, skipped.bad_signatures),
        (0, 0),
        "{skipped:?}"
    );
    valid(&said);

    let wrong = folder.file("wrong", "secret");
    let (code, reported) = refused("udpin:127.0.0.1:0", &["--key", &wrong]);
    assert!(
        code == Some(3) && reported.contains("is not a key") && reported.contains("64 hex"),
        "{reported}"
    );
}

#[test]
fn a_silent_client_does_not_block_a_second_one() {
    let (flight, _) = steady();
    let watch = Watch::start("tcpin:127.0.0.1:0", &[]);
    let silent = TcpStream::connect(watch.address()).unwrap();
    std::thread::sleep(Duration::from_millis(100));
    let stream = TcpStream::connect(watch.address()).unwrap();
    let mut vehicle = watch.vehicle_on(&flight, Wire::tcp(stream), Link::default(), Version::V2);
    vehicle.meet();
    let said = watch.end();
    drop(silent);
    said.one("found");
    said.one("ready");
}
