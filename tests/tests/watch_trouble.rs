//! `flagred watch` with faults of the link, the vehicle or the machine.

use std::{
    net::{TcpListener, TcpStream, UdpSocket},
    path::Path,
    time::Duration,
};

use flagred_flightlog::mavlink::Version;
use flagred_tests::{
    STEADY, flagred,
    log_writer::Tlog,
    vehicle::{StandIn, flight, heartbeat_of, servo},
    watch::{Watch, check_texts, refused},
    wire::{Link, Speed, Wire},
};
use serde_json::json;

#[test]
fn a_silent_link_and_a_reboot_are_reported_and_discard_the_old_risk() {
    let flight = flight(Path::new(STEADY));
    let watch = Watch::udp(&[]);
    let mut vehicle = watch.vehicle(&flight, Link::default());
    vehicle.meet();
    let air = flight.in_air.as_ref().unwrap().spans[0];
    vehicle.fly(&flight, Speed::Fastest, air.start_s, air.start_s + 40.0);
    vehicle.linger(Duration::from_millis(2300));
    let values_then = vehicle.received.values("FR_RISK").len();
    // The vehicle returns, half a minute later on its own clock: the windows start empty.
    vehicle.fly(
        &flight,
        Speed::Fastest,
        air.start_s + 70.0,
        air.start_s + 71.0,
    );
    vehicle.fly(
        &flight,
        Speed::Fastest,
        air.start_s + 71.0,
        air.start_s + 80.0,
    );
    assert!(vehicle.received.values("FR_RISK").len() > values_then);
    // The vehicle reboots, which takes time.
    vehicle.linger(Duration::from_millis(2300));
    for t_ms in [100, 200, 300, 400] {
        vehicle.send(&servo(t_ms * 1000, &[1000; 16]));
        vehicle.linger(Duration::from_millis(5));
    }
    let said = watch.end();
    assert!(said.all("lost").all(|lost| lost["what"] == "link"));
    assert_eq!((said.all("lost").count(), said.all("back").count()), (2, 2));
    let back = said.all("back").next().unwrap();
    assert!(back["after_s"].as_f64().unwrap() >= 2.0, "{back}");
    said.one("rebooted");
    let first = said
        .all("risk")
        .find(|event| event["t_s"].as_f64().unwrap() >= air.start_s + 69.9)
        .unwrap();
    assert!(
        first["risk"].is_null() && first["unknown"].is_string(),
        "{first}"
    );
    // The reboot ends the flight, and no landing was received.
    assert_eq!(said.all("landed").count(), 0);
    let lost = said.one("lost_in_air");
    assert_eq!(
        (&lost["why"], &lost["verdict"]),
        (&json!("reboot"), &json!("NA"))
    );
    assert_eq!(lost["level_seen"], "GOOD");
    assert!(lost["t_s"].as_f64().unwrap() > air.start_s + 79.0, "{lost}");
    assert_eq!(
        (said.one("ended")["worst"].as_str(), said.code),
        (Some("NA"), Some(3))
    );
    check_texts(&said, &vehicle.received);
}

#[test]
fn other_vehicles_and_ground_stations_are_not_followed() {
    use flagred_flightlog::mavlink::{
        Sender,
        dialect::{MavAutopilot, MavModeFlag, MavState, MavType},
    };
    let beat = |component, system, mavtype, autopilot| {
        let armed = MavModeFlag::MAV_MODE_FLAG_SAFETY_ARMED;
        let heartbeat = heartbeat_of(mavtype, autopilot, armed, MavState::MAV_STATE_ACTIVE);
        Sender::new(component).packet(Version::V2, system, &heartbeat)
    };
    let flight = flight(Path::new(STEADY));
    let watch = Watch::udp(&[]);
    let mut vehicle = watch.vehicle(&flight, Link::default());
    let none = MavAutopilot::MAV_AUTOPILOT_INVALID;
    let some = MavAutopilot::MAV_AUTOPILOT_ARDUPILOTMEGA;
    vehicle.raw(&beat(190, 255, MavType::MAV_TYPE_GCS, none));
    vehicle.raw(&beat(1, 9, MavType::MAV_TYPE_FIXED_WING, some));
    vehicle.meet();
    for _ in 0..3 {
        vehicle.raw(&beat(1, 7, MavType::MAV_TYPE_HEXAROTOR, some));
        vehicle.raw(&beat(154, 1, MavType::MAV_TYPE_GIMBAL, none));
        vehicle.linger(Duration::from_millis(20));
    }
    let said = watch.end();
    assert_eq!(said.one("not_a_multirotor")["system"], 9);
    assert_eq!(said.one("found")["system"], 1);
    assert_eq!(said.one("another_vehicle")["system"], 7);
}

/// The flight is assessed as if nothing else had been received.
#[test]
fn garbage_and_extreme_values_are_counted_and_raise_no_alarm() {
    let flight = flight(Path::new(STEADY));
    let watch = Watch::udp(&[]);
    let mut vehicle = watch.vehicle(&flight, Link::default());
    vehicle.meet();
    let air = flight.in_air.as_ref().unwrap().spans[0];
    let mut at_s = air.start_s;
    let mut random = 1_u64;
    for round in 0..40_u32 {
        vehicle.fly(&flight, Speed::Fastest, at_s, at_s + 0.5);
        at_s += 0.5;
        let garbage: Vec<u8> = (0..1 + 37 * round as usize)
            .map(|_| {
                random = random
                    .wrapping_mul(6_364_136_223_846_793_005)
                    .wrapping_add(1);
                (random >> 56) as u8
            })
            .collect();
        vehicle.raw(&garbage);
        // More bytes than any packet can have, and the beginning of a truncated packet.
        vehicle.raw(&[0xfd; 5000]);
        vehicle.raw(&[0xfd, 30, 0, 0, 1, 1, 1, 36, 0, 0, 9]);
        // Extreme values: invalid pulses, and impossible times.
        vehicle.send(&servo(((at_s - 0.01) * 1e6) as u32, &[u16::MAX; 16]));
        vehicle.send(&servo(u32::MAX, &[u16::MAX; 16]));
        wild(&mut vehicle, ((at_s - 0.01) * 1e6) as u32);
    }
    let said = watch.end();
    let ended = said.one("ended");
    assert!(
        ended["skipped_bytes"].as_u64().unwrap() > 40 * 5000,
        "{ended}"
    );
    assert_eq!(said.all("level").count(), 0);
    assert_eq!(said.all("rebooted").count(), 0);
    let jumps = said
        .all("doubt")
        .filter(|doubt| doubt["what"] == "clock_jump");
    assert_eq!(jumps.count(), 1);
    assert!(
        ended["not_believed"]["clock_jumps"].as_u64() >= Some(40),
        "{ended}"
    );
    assert_eq!(said.verdict(), "GOOD");
    assert_eq!(vehicle.received.texts(), []);
    assert!(said.has_note("not MAVLink packets"));
    for event in said.all("risk") {
        let risk = event["risk"].as_f64();
        assert!(risk.is_none_or(|risk| risk.is_finite()));
    }
}

/// The messages that are read: number, the extra byte of the checksum, a valid payload, and
/// the width of each field on the wire (<https://mavlink.io/en/messages/common.html>).
fn messages_read(t_us: u32) -> Vec<(u8, u8, Vec<u8>, Vec<usize>)> {
    let mut heartbeat = vec![0; 4];
    // An ArduPilot quadrotor, armed and active.
    heartbeat.extend([2, 3, 128, 4, 3]);
    let mut servo = t_us.to_le_bytes().to_vec();
    servo.extend([1500_u16; 8].iter().flat_map(|pulse| pulse.to_le_bytes()));
    servo.push(0);
    servo.extend([0; 16]);
    let mut parameter = 1000.0_f32.to_le_bytes().to_vec();
    parameter.extend([0; 4]);
    parameter.extend(b"MOT_PWM_MIN\0\0\0\0\0");
    parameter.push(9);
    let mut attitude = (t_us / 1000).to_le_bytes().to_vec();
    attitude.extend([0; 24]);
    vec![
        (0, 50, heartbeat, vec![4, 1, 1, 1, 1, 1]),
        (22, 220, parameter, vec![4, 2, 2, 16, 1]),
        (30, 39, attitude, vec![4; 7]),
        (
            36,
            222,
            servo,
            [vec![4], vec![2; 8], vec![1], vec![2; 8]].concat(),
        ),
        (
            77,
            143,
            vec![0xff, 1, 0, 0, 0, 0, 0, 0, 0, 0],
            vec![2, 1, 1, 4, 1, 1],
        ),
        (245, 130, vec![0, 2], vec![1, 1]),
    ]
}

/// A packet of MAVLink 2 with any payload.
fn packet(message: u8, extra: u8, payload: &[u8]) -> Vec<u8> {
    let mut log = Tlog::default();
    log.packet(0, 2, (1, 1), (u32::from(message), extra, 0), payload);
    // Drop the timestamp that precedes the packet in a log.
    log.bytes.split_off(8)
}

/// Sends every message with extreme values: all bits of one field are set, for each field in turn, and then all bits of all
/// fields (the largest unsigned integer; NaN for a float). Floats are also sent as infinities.
fn wild(vehicle: &mut StandIn, t_us: u32) {
    for (message, extra, payload, widths) in messages_read(t_us) {
        assert_eq!(payload.len(), widths.iter().sum::<usize>(), "{message}");
        let mut at = 0;
        for width in &widths {
            let mut odd = payload.clone();
            odd[at..at + width].fill(0xff);
            vehicle.raw(&packet(message, extra, &odd));
            if *width == 4 {
                for infinity in [f32::INFINITY, f32::NEG_INFINITY] {
                    odd[at..at + 4].copy_from_slice(&infinity.to_le_bytes());
                    vehicle.raw(&packet(message, extra, &odd));
                }
            }
            at += width;
        }
        vehicle.raw(&packet(message, extra, &vec![0xff; payload.len()]));
        vehicle.raw(&packet(message, extra, &[0xff; 255]));
    }
}

/// The checksum of these tests is that of the library, so that extreme values arrive and are not skipped as damaged.
#[test]
fn packets_with_extreme_values_are_valid_packets() {
    use flagred_flightlog::mavlink::{PacketScan, next_packet};
    for (message, extra, payload, _) in messages_read(1) {
        let bytes = packet(message, extra, &payload);
        let PacketScan::Packet(packet) = next_packet(&bytes) else {
            panic!("message {message} is not a packet");
        };
        assert_eq!(packet.id, u32::from(message));
    }
}

#[test]
fn unavailable_ports_are_reported_with_a_remedy() {
    let taken = UdpSocket::bind("127.0.0.1:0").unwrap();
    let (code, reported) = refused(&format!("udpin:{}", taken.local_addr().unwrap()), &[]);
    assert_eq!(code, Some(3));
    assert!(
        reported.contains("cannot be opened") && reported.contains("another program"),
        "{reported}"
    );

    let taken = TcpListener::bind("127.0.0.1:0").unwrap();
    let address = taken.local_addr().unwrap();
    let (code, reported) = refused(&format!("tcpin:{address}"), &[]);
    assert!(
        code == Some(3) && reported.contains("another program"),
        "{reported}"
    );
    drop(taken);
    let (code, reported) = refused(&format!("tcp:{address}"), &["--no-wait"]);
    assert!(
        code == Some(3) && reported.contains("start the vehicle"),
        "{reported}"
    );

    let (code, reported) = refused("/dev/flagred-no-such-port:57600", &["--no-wait"]);
    assert!(
        code == Some(3) && reported.contains("check that the cable is plugged in"),
        "{reported}"
    );
    let (code, reported) = refused("somewhere", &[]);
    assert!(
        code == Some(2) && reported.contains("is not an endpoint"),
        "{reported}"
    );
    let (code, reported) = refused("udpout:127.0.0.1:9", &["--no-send"]);
    assert!(
        code == Some(2) && reported.contains("sends first"),
        "{reported}"
    );
}

/// The watch runs as a user who may not open the port.
#[test]
#[cfg(unix)]
fn a_serial_port_without_permission_is_reported_with_a_remedy() {
    use std::os::unix::{fs::PermissionsExt, process::CommandExt};
    let path = std::env::temp_dir().join(format!("flagred-port-{}", std::process::id()));
    std::fs::write(&path, "").unwrap();
    std::fs::set_permissions(&path, std::fs::Permissions::from_mode(0o000)).unwrap();
    let mut watch = flagred();
    watch.args(["watch", &format!("{}:57600", path.display())]);
    if std::fs::File::open(&path).is_ok() {
        // This user may open anything, so the watch runs as `nobody`.
        watch.uid(65534);
    }
    let output = watch.output();
    std::fs::remove_file(&path).unwrap();
    let output = match output {
        Ok(output) => output,
        Err(error) => {
            eprintln!("skipped: the program cannot be run as another user: {error}");
            return;
        }
    };
    let reported = String::from_utf8(output.stderr).unwrap();
    assert_eq!(output.status.code(), Some(3), "{reported}");
    assert!(
        reported.contains("cannot be opened") && reported.contains("`dialout`"),
        "{reported}"
    );
}

/// A watch is often started before the vehicle, its network and its cable.
#[test]
fn watch_waits_for_an_endpoint_that_does_not_exist_yet() {
    let flight = flight(Path::new(STEADY));
    let free = TcpListener::bind("127.0.0.1:0").unwrap();
    let address = free.local_addr().unwrap();
    drop(free);
    let watch = Watch::start(&format!("tcp:{address}"), &[]);
    std::thread::sleep(Duration::from_millis(300));
    let listener = TcpListener::bind(address).unwrap();
    let wire = Wire::tcp(listener.accept().unwrap().0);
    let mut vehicle = watch.vehicle_on(&flight, wire, Link::default(), Version::V2);
    vehicle.meet();
    let said = watch.end();
    assert!(said.has_note("cannot be opened yet") && said.has_note("--no-wait"));
    assert!(said.has_note("the link is open"));
    said.one("found");

    for endpoint in [
        "/dev/flagred-no-such-port:57600",
        "udpout:no-such-host.invalid:14550",
    ] {
        let watch = Watch::start(endpoint, &[]);
        std::thread::sleep(Duration::from_millis(500));
        let said = watch.end();
        assert!(said.has_note("cannot be opened yet"), "{endpoint}");
        assert_eq!(said.code, Some(3), "{endpoint}");
    }
}

#[test]
fn a_broken_connection_is_reopened() {
    let flight = flight(Path::new(STEADY));
    let watch = Watch::start("tcpin:127.0.0.1:0", &[]);
    for round in 0..2 {
        let stream = TcpStream::connect(watch.address()).unwrap();
        let mut vehicle = StandIn::new(&flight, Wire::tcp(stream), Link::default(), Version::V2);
        if round == 0 {
            vehicle.meet();
        }
        vehicle.beat(false, false);
        vehicle.linger(Duration::from_millis(200));
    }
    let said = watch.end();
    assert!(said.has_note("the link is closed"));
    assert_eq!(
        said.all("note")
            .filter(|event| event["text"] == "the link is open")
            .count(),
        2
    );
    said.one("found");
}

#[test]
fn an_unknown_risk_is_not_good() {
    let watch = Watch::udp(&[]);
    let said = watch.end();
    let ended = said.one("ended");
    assert_eq!(
        (&ended["worst"], &ended["reason"]),
        (&json!("NA"), &json!("no flight was observed"))
    );
    assert_eq!(said.code, Some(3));
}

/// Neither a link that breaks in the air nor a watch that is ended in the air counts as a landing. Only the broken link
/// prevents a verdict, because a watch that is ended has received everything up to its end.
#[test]
fn a_flight_whose_end_was_not_received_is_not_reported_as_landed() {
    let flight = flight(Path::new(STEADY));
    let air = flight.in_air.as_ref().unwrap().spans[0];
    for (silent_ms, event, why, verdict, code) in [
        (2300, "lost_in_air", "link", "NA", 3),
        (0, "left_in_air", "watch_ended", "GOOD", 0),
    ] {
        let watch = Watch::udp(&[]);
        let mut vehicle = watch.vehicle(&flight, Link::default());
        vehicle.meet();
        vehicle.fly(&flight, Speed::Fastest, air.start_s, air.start_s + 30.0);
        vehicle.linger(Duration::from_millis(silent_ms));
        let said = watch.end();
        assert_eq!(said.all("landed").count(), 0);
        let end = said.one(event);
        assert_eq!(
            (&end["why"], &end["verdict"]),
            (&json!(why), &json!(verdict))
        );
        assert!(end["risk_max"].as_f64().is_some(), "{end}");
        assert_eq!(
            (said.one("ended")["worst"].as_str(), said.code),
            (Some(verdict), Some(code))
        );
    }
}
