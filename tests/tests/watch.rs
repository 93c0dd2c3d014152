//! `flagred watch` against a stand-in vehicle: the same verdicts as `flagred assess`, whatever the link does.

use std::{
    io::{BufRead, BufReader},
    net::{SocketAddr, TcpListener, TcpStream, UdpSocket},
    path::{Path, PathBuf},
    process::{Child, Command, Output, Stdio},
    sync::{
        Arc,
        atomic::{AtomicU64, Ordering},
    },
    thread::JoinHandle,
    time::Duration,
};

use flagred_tests::{
    Folder, STEADY, flagred, shared_data,
    vehicle::{Heard, Link, Speed, StandIn, Wire, flight, servo},
};
use flightlog::{Flight, mavlink::Version};
use serde_json::Value;

/// A running watch, and where it listens.
struct Watch {
    child: Child,
    address: Option<SocketAddr>,
    /// Reads along: a watch whose output nobody takes would have to wait.
    reader: JoinHandle<Vec<Value>>,
    /// The vehicle's time, in ms, of the latest risk that was told.
    followed_ms: Arc<AtomicU64>,
}

impl Watch {
    fn start(endpoint: &str, options: &[&str]) -> Watch {
        let mut child = flagred()
            .args(["watch", endpoint, "--jsonl"])
            .args(options)
            .stdout(Stdio::piped())
            .spawn()
            .unwrap();
        let mut lines = BufReader::new(child.stdout.take().unwrap());
        let mut first = String::new();
        lines.read_line(&mut first).unwrap();
        let started: Value = serde_json::from_str(&first).unwrap();
        assert_eq!(started["schema"], "flagred.watch/1");
        let endpoint = started["endpoint"].as_str().unwrap();
        let address = endpoint.strip_prefix("listening at ");
        let followed_ms = Arc::new(AtomicU64::new(0));
        let told_ms = Arc::clone(&followed_ms);
        Watch {
            child,
            address: address.map(|address| address.parse().unwrap()),
            reader: std::thread::spawn(move || {
                let events = lines.lines().map(|line| {
                    let event: Value = serde_json::from_str(&line.unwrap()).unwrap();
                    if let Some(t_s) = event["t_s"].as_f64() {
                        told_ms.store((t_s * 1e3) as u64, Ordering::Relaxed);
                    }
                    event
                });
                events.collect()
            }),
            followed_ms,
        }
    }

    fn udp(options: &[&str]) -> Watch {
        Watch::start("udpin:127.0.0.1:0", options)
    }

    fn address(&self) -> SocketAddr {
        self.address.unwrap()
    }

    /// A vehicle that sends it datagrams.
    fn vehicle(&self, flight: &Flight, link: Link) -> StandIn {
        let mut vehicle = StandIn::new(flight, Wire::udp(self.address()), link, Version::V2);
        vehicle.followed_ms = Some(Arc::clone(&self.followed_ms));
        vehicle
    }

    /// Interrupts it; gives all it said.
    fn end(mut self) -> Said {
        let interrupted = Command::new("kill")
            .args(["-INT", &self.child.id().to_string()])
            .status();
        assert!(interrupted.unwrap().success());
        let events = self.reader.join().unwrap();
        let code = self.child.wait().unwrap().code();
        Said { events, code }
    }
}

struct Said {
    events: Vec<Value>,
    code: Option<i32>,
}

impl Said {
    fn all<'a>(&'a self, kind: &'a str) -> impl Iterator<Item = &'a Value> {
        self.events
            .iter()
            .filter(move |event| event["event"] == kind)
    }

    fn one(&self, kind: &str) -> &Value {
        let is_of = |event: &&Value| event["event"] == kind;
        let all: Vec<&Value> = self.events.iter().filter(is_of).collect();
        assert_eq!(all.len(), 1, "`{kind}` in {:?}", self.events);
        all[0]
    }

    /// The worst verdict of its flights; that one is all there is to say where it is `NA`.
    fn verdict(&self) -> String {
        let order = ["NA", "GOOD", "WARN", "FAIL"];
        let verdicts = self
            .all("landed")
            .map(|event| event["verdict"].as_str().unwrap());
        let worst = verdicts.max_by_key(|verdict| order.iter().position(|known| known == verdict));
        worst.unwrap_or("none").to_owned()
    }

    fn has_note(&self, part: &str) -> bool {
        self.all("note")
            .any(|event| event["text"].as_str().unwrap().contains(part))
    }
}

fn assess(log: &Path) -> Value {
    let output = flagred()
        .args(["assess", "--json", "--step", "0"])
        .arg(log)
        .output()
        .unwrap();
    serde_json::from_slice(&output.stdout).unwrap()
}

/// Flies a log over UDP; gives what the watch and the vehicle heard.
fn fly_udp(flight: &Flight, link: Link, options: &[&str], speed: Speed) -> (Said, StandIn) {
    let watch = Watch::udp(options);
    let mut vehicle = watch.vehicle(flight, link);
    vehicle.meet();
    vehicle.fly(flight, speed, 0.0, f64::INFINITY);
    (watch.end(), vehicle)
}

/// The share of samples whose risk was told, and the largest difference to what `assess` says of them.
fn compare(said: &Said, assessed: &Value) -> (f64, f64) {
    let steps = assessed["steps"].as_array().unwrap();
    let mut watched = said
        .all("risk")
        .filter_map(|event| Some((event["t_s"].as_f64()?, event["risk_pct"].as_f64()?)));
    let (mut matched, mut known, mut largest) = (0, 0, 0.0_f64);
    let mut next = watched.next();
    for step in steps {
        let (Some(t_s), Some(risk)) = (step["t_s"].as_f64(), step["risk"].as_f64()) else {
            continue;
        };
        known += 1;
        while next.is_some_and(|(at_s, _)| at_s < t_s - 1e-4) {
            next = watched.next();
        }
        if let Some((at_s, watched_risk)) = next
            && (at_s - t_s).abs() < 1e-4
        {
            matched += 1;
            largest = largest.max((watched_risk - risk).abs());
        }
    }
    (f64::from(matched) / f64::from(known), largest)
}

/// One text for each change of state, none of them on the ground, all as ground stations want them.
fn check_texts(said: &Said, heard: &Heard) {
    let texts = heard.texts();
    let levels: Vec<(String, u8)> = said
        .all("level")
        .map(|event| {
            let severity = match event["level"].as_str().unwrap() {
                "GOOD" => 6,
                "WARN" => 4,
                _ => 2,
            };
            (event["text"].as_str().unwrap().to_owned(), severity)
        })
        .collect();
    assert_eq!(texts.len(), levels.len(), "{texts:?} {levels:?}");
    for ((severity, text), (level, expected)) in texts.iter().zip(&levels) {
        assert_eq!((text, severity), (level, expected));
        assert!(text.starts_with("FLAGRED: ") && text.len() <= 50, "{text}");
    }
}

/// A log over UDP and TCP and over bad links: the verdict is that of `assess`.
fn every_link_gives_the_verdict_of_assess(log: &Path) {
    let flight = flight(log);
    let assessed = assess(log);
    let verdict = assessed["verdict"].as_str().unwrap();
    let name = log.file_name().unwrap().to_string_lossy().into_owned();
    let bad = |loss| Link {
        loss,
        reordered: 0.05,
        repeated: 0.02,
    };
    for link in [Link::default(), bad(0.05), bad(0.3)] {
        let (said, vehicle) = fly_udp(&flight, link, &[], Speed::Fastest);
        let case = format!("{name}, {link:?}");
        assert_eq!(said.verdict(), verdict, "{case}");
        assert_eq!(
            said.one("ready")["assumed"],
            serde_json::json!([]),
            "{case}"
        );
        let (share, difference) = compare(&said, &assessed);
        eprintln!(
            "{case}: {:.1} % of samples, difference {difference:.3}",
            100.0 * share
        );
        if link.loss == 0.0 {
            assert!(share > 0.999, "{case}: {share}");
            assert!(difference <= 2.0, "{case}: {difference} points");
        }
        check_texts(&said, &vehicle.heard);
        if verdict == "GOOD" {
            assert_eq!(vehicle.heard.texts(), [], "{case}");
        }
        assert_eq!(
            said.code,
            Some(i32::from(matches!(verdict, "WARN" | "FAIL"))),
            "{case}"
        );
    }

    let listener = TcpListener::bind("127.0.0.1:0").unwrap();
    let watch = Watch::start(&format!("tcp:{}", listener.local_addr().unwrap()), &[]);
    let wire = Wire::tcp(listener.accept().unwrap().0);
    let mut vehicle = StandIn::new(&flight, wire, Link::default(), Version::V1);
    vehicle.followed_ms = Some(Arc::clone(&watch.followed_ms));
    vehicle.meet();
    vehicle.fly(&flight, Speed::Fastest, 0.0, f64::INFINITY);
    let said = watch.end();
    assert_eq!(said.verdict(), verdict, "{name} over TCP");
    let (share, difference) = compare(&said, &assessed);
    assert!(
        share > 0.999 && difference <= 2.0,
        "{name} over TCP: {share} {difference}"
    );
    check_texts(&said, &vehicle.heard);
}

#[test]
fn the_shipped_flight_gets_the_verdict_of_assess_over_every_link() {
    every_link_gives_the_verdict_of_assess(Path::new(STEADY));
}

#[test]
fn reference_flights_get_the_verdict_of_assess_over_every_link() {
    let Some(data) = shared_data() else { return };
    let names = [
        "hover_calm",
        "intermittent",
        "octoquad",
        "octoquad_crash",
        "payload",
    ];
    std::thread::scope(|scope| {
        for name in names {
            let log = data.join("flights").join(format!("{name}.BIN"));
            scope.spawn(move || every_link_gives_the_verdict_of_assess(&log));
        }
    });
}

/// As slow as it was flown: two minutes a flight, so only where it is asked for (`--ignored`).
#[test]
#[ignore = "takes as long as the flights"]
fn reference_flights_get_the_verdict_of_assess_in_real_time() {
    let Some(data) = shared_data() else { return };
    let mut logs: Vec<PathBuf> = std::fs::read_dir(data.join("flights"))
        .unwrap()
        .map(|entry| entry.unwrap().path())
        .filter(|path| path.extension().is_some_and(|extension| extension == "BIN"))
        .collect();
    logs.sort();
    assert_eq!(logs.len(), 6);
    std::thread::scope(|scope| {
        for log in &logs {
            scope.spawn(|| {
                let flight = flight(log);
                let assessed = assess(log);
                let link = Link::default();
                let (said, vehicle) = fly_udp(&flight, link, &[], Speed::Times(1.0));
                assert_eq!(said.verdict(), assessed["verdict"], "{}", log.display());
                let (share, difference) = compare(&said, &assessed);
                assert!(share > 0.999 && difference <= 2.0, "{share} {difference}");
                check_texts(&said, &vehicle.heard);
                let values = vehicle.heard.values("FR_RISK");
                let rate_hz =
                    values.len() as f64 / assessed["summary"]["assessed_s"].as_f64().unwrap();
                assert!((1.0..=2.1).contains(&rate_hz), "{rate_hz} Hz");
            });
        }
    });
}

/// From motor commands at 50 Hz to the risk on the wire, in real time.
#[test]
fn the_risk_is_on_the_wire_within_5_ms() {
    let flight = flight(Path::new(STEADY));
    let watch = Watch::udp(&[]);
    let mut vehicle = watch.vehicle(&flight, Link::default());
    vehicle.meet();
    // The log has 25 Hz, so twice as fast.
    let air = flight.in_air.as_ref().unwrap().spans[0];
    vehicle.fly(&flight, Speed::Times(2.0), air.start_s, air.start_s + 16.0);
    watch.end();
    let values = vehicle.heard.values("FR_RISK");
    assert!(values.len() >= 12, "{}", values.len());
    let mut late_ms: Vec<f64> = values
        .iter()
        .map(|(at, t_ms, _)| {
            let (_, sent) = vehicle
                .sent
                .iter()
                .find(|(sent_ms, _)| sent_ms == t_ms)
                .unwrap();
            at.duration_since(*sent).as_secs_f64() * 1e3
        })
        .collect();
    late_ms.sort_by(f64::total_cmp);
    eprintln!("from command to risk: {late_ms:.2?} ms");
    // Other tests share the machine: half of all must make it here. The 99th percentile is for the test alone.
    assert!(late_ms[late_ms.len() / 2] < 5.0, "{late_ms:?}");
}

#[test]
fn it_is_an_onboard_controller_of_the_vehicle_and_tells_values_once_in_half_a_second() {
    let flight = flight(Path::new(STEADY));
    let (_, vehicle) = fly_udp(
        &flight,
        Link::default(),
        &["--component", "192"],
        Speed::Fastest,
    );
    let heard = &vehicle.heard;
    assert!(
        heard
            .messages
            .iter()
            .all(|(_, system, component, _)| (*system, *component) == (1, 192))
    );
    let beat = heard
        .messages
        .iter()
        .find_map(|(_, _, _, message)| match message {
            flightlog::mavlink::dialect::MavMessage::HEARTBEAT(beat) => Some(beat),
            _ => None,
        });
    let beat = beat.unwrap();
    assert_eq!((beat.mavtype as u8, beat.autopilot as u8), (18, 8));
    for name in ["FR_RISK", "FR_ELEV"] {
        let values = heard.values(name);
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

#[test]
fn a_silent_link_and_a_reboot_are_told_and_the_old_risk_is_not_carried_on() {
    let flight = flight(Path::new(STEADY));
    let watch = Watch::udp(&[]);
    let mut vehicle = watch.vehicle(&flight, Link::default());
    vehicle.meet();
    let air = flight.in_air.as_ref().unwrap().spans[0];
    vehicle.fly(&flight, Speed::Fastest, air.start_s, air.start_s + 40.0);
    vehicle.linger(Duration::from_millis(2300));
    let values_then = vehicle.heard.values("FR_RISK").len();
    // It comes back, half a minute later on its own clock: the windows start anew.
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
    assert!(vehicle.heard.values("FR_RISK").len() > values_then);
    // It starts anew.
    for t_ms in [100, 200, 300, 400] {
        vehicle.send(&servo(t_ms * 1000, &[1000; 16]));
        vehicle.linger(Duration::from_millis(5));
    }
    let said = watch.end();
    assert_eq!(said.one("lost")["what"], "link");
    let back = said.one("back");
    assert!(back["after_s"].as_f64().unwrap() >= 2.0, "{back}");
    said.one("rebooted");
    let first = said
        .all("risk")
        .find(|event| event["t_s"].as_f64().unwrap() >= air.start_s + 69.9)
        .unwrap();
    assert!(
        first["risk_pct"].is_null() && first["unknown"].is_string(),
        "{first}"
    );
    // The flight is over with the reboot.
    assert_eq!(said.all("landed").count(), 1);
    check_texts(&said, &vehicle.heard);
}

#[test]
fn other_vehicles_and_ground_stations_are_not_followed() {
    use flightlog::mavlink::{
        Sender,
        dialect::{HEARTBEAT_DATA, MavAutopilot, MavMessage, MavModeFlag, MavState, MavType},
    };
    let beat = |component, system, mavtype, autopilot| {
        let heartbeat = MavMessage::HEARTBEAT(HEARTBEAT_DATA {
            custom_mode: 0,
            mavtype,
            autopilot,
            base_mode: MavModeFlag::MAV_MODE_FLAG_SAFETY_ARMED,
            system_status: MavState::MAV_STATE_ACTIVE,
            mavlink_version: 3,
        });
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

/// Whatever comes in between, the flight is assessed as if it had not.
#[test]
fn garbage_and_wild_values_are_counted_and_raise_no_alarm() {
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
        // Longer than any packet, and the beginning of one that is cut off.
        vehicle.raw(&[0xfd; 5000]);
        vehicle.raw(&[0xfd, 30, 0, 0, 1, 1, 1, 36, 0, 0, 9]);
        // Wild values: no pulse at all, and times from nowhere.
        vehicle.send(&servo(((at_s - 0.01) * 1e6) as u32, &[u16::MAX; 16]));
        vehicle.send(&servo(u32::MAX, &[u16::MAX; 16]));
        wild(&mut vehicle);
    }
    let said = watch.end();
    let ended = said.one("ended");
    assert!(
        ended["skipped_bytes"].as_u64().unwrap() > 40 * 5000,
        "{ended}"
    );
    assert_eq!(said.all("level").count(), 0);
    assert_eq!(said.all("rebooted").count(), 0);
    assert_eq!(said.verdict(), "GOOD");
    assert_eq!(vehicle.heard.texts(), []);
    assert!(said.has_note("no MAVLink packets"));
    for event in said.all("risk") {
        let risk = event["risk_pct"].as_f64();
        assert!(risk.is_none_or(|risk| risk.is_finite()));
    }
}

/// NaN and the largest value in every field that is read.
fn wild(vehicle: &mut StandIn) {
    use flightlog::mavlink::dialect::{ATTITUDE_DATA, MavMessage, MavParamType, PARAM_VALUE_DATA};
    vehicle.send(&MavMessage::ATTITUDE(ATTITUDE_DATA {
        time_boot_ms: u32::MAX,
        roll: f32::NAN,
        pitch: f32::NAN,
        yaw: f32::INFINITY,
        ..ATTITUDE_DATA::default()
    }));
    for value in [f32::NAN, 65535.0, -1.0] {
        for name in [
            "MOT_SPIN_MAX",
            "MOT_PWM_MIN",
            "SERVO1_FUNCTION",
            "SERVO16_FUNCTION",
        ] {
            vehicle.send(&MavMessage::PARAM_VALUE(PARAM_VALUE_DATA {
                param_value: value,
                param_count: u16::MAX,
                param_index: u16::MAX,
                param_id: name.into(),
                param_type: MavParamType::MAV_PARAM_TYPE_REAL32,
            }));
        }
    }
}

fn refused(endpoint: &str, options: &[&str]) -> (Option<i32>, String) {
    let Output { status, stderr, .. } = flagred()
        .args(["watch", endpoint])
        .args(options)
        .output()
        .unwrap();
    (status.code(), String::from_utf8(stderr).unwrap())
}

#[test]
fn ports_that_cannot_be_had_are_told_with_what_to_do() {
    let taken = UdpSocket::bind("127.0.0.1:0").unwrap();
    let (code, told) = refused(&format!("udpin:{}", taken.local_addr().unwrap()), &[]);
    assert_eq!(code, Some(3));
    assert!(
        told.contains("cannot be opened") && told.contains("another program"),
        "{told}"
    );

    let taken = TcpListener::bind("127.0.0.1:0").unwrap();
    let address = taken.local_addr().unwrap();
    let (code, told) = refused(&format!("tcpin:{address}"), &[]);
    assert!(
        code == Some(3) && told.contains("another program"),
        "{told}"
    );
    drop(taken);
    let (code, told) = refused(&format!("tcp:{address}"), &[]);
    assert!(
        code == Some(3) && told.contains("start the vehicle"),
        "{told}"
    );

    let (code, told) = refused("/dev/flagred-no-such-port:57600", &[]);
    assert!(
        code == Some(3) && told.contains("is the cable plugged in?"),
        "{told}"
    );
    let (code, told) = refused("somewhere", &[]);
    assert!(code == Some(2) && told.contains("is no endpoint"), "{told}");
    let (code, told) = refused("udpout:127.0.0.1:9", &["--no-send"]);
    assert!(code == Some(2) && told.contains("sends first"), "{told}");
}

#[test]
fn a_connection_that_breaks_is_opened_again() {
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

/// What was recorded gives `assess` what `watch` said of it. A flight as fast as it goes arrives in a second or so, and a
/// telemetry log knows only when its packets arrived: so they are given the times of a link in real time.
fn a_recording_gives_assess_what_watch_said(log: &Path) {
    let flight = flight(log);
    let name = log.file_stem().unwrap().to_string_lossy().into_owned();
    let folder = Folder::new();
    let file = folder.at("recorded.tlog");
    let (said, _) = fly_udp(
        &flight,
        Link::default(),
        &["--record", &file],
        Speed::Fastest,
    );
    // A recording is not written over.
    let (code, told) = refused("udpin:127.0.0.1:0", &["--record", &file]);
    assert!(
        code == Some(3) && told.contains("cannot be recorded to"),
        "{told}"
    );
    let recorded = std::fs::read(&file).unwrap();
    let assessed = assess(Path::new(
        &folder.file("real-time.tlog", in_real_time(&recorded)),
    ));
    assert_eq!(assessed["log"]["format"], "MAVLink tlog");
    assert_eq!(assessed["read"]["skipped_bytes"], 0);
    assert_eq!(
        assessed["verdict"].as_str(),
        Some(said.verdict().as_str()),
        "{name}"
    );
    let findings = |value: &Value| {
        let severity = value["severity"].as_str().unwrap().to_owned();
        (
            severity,
            value["value_pct"].as_f64().unwrap().round() as i64,
        )
    };
    let mut of_log: Vec<_> = assessed["findings"]
        .as_array()
        .unwrap()
        .iter()
        .map(findings)
        .collect();
    let mut of_watch: Vec<_> = said.all("finding").map(findings).collect();
    of_log.sort();
    of_watch.sort();
    assert_eq!(of_log, of_watch, "{name}");
}

/// A telemetry log whose packets arrived when the vehicle's clock said they were sent.
fn in_real_time(log: &[u8]) -> Vec<u8> {
    use flightlog::mavlink::{Next, dialect::MavMessage, next_packet};
    const YEAR_2025_US: u64 = 1_735_689_600_000_000;
    let (mut at, mut clock_us, mut again) = (0, 0, Vec::new());
    while at + 8 < log.len() {
        let Next::Packet(packet) = next_packet(&log[at + 8..]) else {
            panic!("no packet at {at}");
        };
        if let Some(MavMessage::SERVO_OUTPUT_RAW(servo)) = packet.message() {
            clock_us = u64::from(servo.time_usec);
        }
        again.extend((YEAR_2025_US + clock_us).to_be_bytes());
        again.extend(packet.bytes);
        at += 8 + packet.bytes.len();
    }
    again
}

#[test]
fn the_recording_of_the_shipped_flight_gives_assess_what_watch_said() {
    a_recording_gives_assess_what_watch_said(Path::new(STEADY));
}

#[test]
fn the_recording_of_a_flight_that_nearly_crashed_gives_assess_what_watch_said() {
    let Some(data) = shared_data() else { return };
    a_recording_gives_assess_what_watch_said(&data.join("flights/octoquad.BIN"));
}
