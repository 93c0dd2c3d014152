//! What `flagred watch` recorded gives `flagred assess` what it said.

use std::path::Path;

use flagred_tests::{
    Folder, STEADY, reference_data,
    vehicle::flight,
    watch::{assess, fly_udp, refused},
    wire::{Link, Speed},
};
use serde_json::Value;

/// What was recorded gives `assess` what `watch` said of it. A flight as fast as it goes arrives in a second or so, and a
/// telemetry log knows only when its packets arrived: so they are given the times of a link in real time.
fn a_recording_gives_assess_what_watch_said(log: &Path) {
    let flight = flight(log);
    let name = log.file_stem().unwrap().to_string_lossy().into_owned();
    let folder = Folder::new();
    let path = folder.path().join("flight.tlog");
    let file = path.to_str().unwrap();
    let (said, _) = fly_udp(
        &flight,
        Link::default(),
        &["--record", file],
        Speed::Fastest,
    );
    // A recording is not written over.
    let (code, told) = refused("udpin:127.0.0.1:0", &["--record", file]);
    assert!(code == Some(2) && told.contains("exists already"), "{told}");
    std::fs::write(&path, in_real_time(&std::fs::read(&path).unwrap())).unwrap();
    let assessed = assess(&path);
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
#[ignore = "needs FLAGRED_SHARED"]
fn the_recording_of_a_flight_that_nearly_crashed_gives_assess_what_watch_said() {
    let data = reference_data();
    a_recording_gives_assess_what_watch_said(&data.join("flights/octoquad.BIN"));
}
