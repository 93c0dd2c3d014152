//! Telemetry streams that `flagred watch` recorded from the autopilots' own simulators, replayed to a watch and to
//! `assess`: both agree.

use std::{fs, io::Read, path::Path};

use flagred::{estimator::Estimator, flight::Verdict, shipped};
use flagred_cli::fuzzing::Watch;
use flagred_flightlog::mavlink::{
    PacketScan,
    dialect::{MavCmd, MavMessage},
    next_packet,
};
use flagred_tests::reference_data;
use serde_json::Value;

/// The interval at which a watch reads the time.
const TICK_S: f64 = 0.02;
/// Bytes of the timestamp before each packet of a telemetry log.
const STAMP: usize = 8;

/// The output of a watch for a stream, and the packets that it sent.
struct Replay {
    events: Vec<Value>,
    sent: Vec<MavMessage>,
}

impl Replay {
    fn of(stream: &[u8], estimator: &Estimator) -> Replay {
        let mut watch = Watch::new(estimator);
        let mut replay = Replay {
            events: Vec::new(),
            sent: Vec::new(),
        };
        let (mut rest, mut first_us, mut now_s) = (stream, None, 0.0);
        while let Some((stamp, tail)) = rest.split_first_chunk::<STAMP>() {
            let stamp_us = u64::from_be_bytes(*stamp);
            let at_s = (stamp_us - *first_us.get_or_insert(stamp_us)) as f64 * 1e-6;
            let PacketScan::Packet(packet) = next_packet(tail) else {
                panic!("not a packet after {at_s} s")
            };
            while now_s + TICK_S < at_s {
                now_s += TICK_S;
                watch.tick(now_s);
            }
            watch.receive(at_s, None, packet.bytes);
            rest = &tail[packet.bytes.len()..];
            replay.take(&mut watch);
        }
        watch.finish(now_s);
        replay.take(&mut watch);
        replay
    }

    fn take(&mut self, watch: &mut Watch<'_>) {
        let reported = watch.reported();
        let events = reported
            .json
            .iter()
            .map(|line| serde_json::from_str(line).unwrap());
        self.events.extend(events);
        for bytes in &reported.packets {
            let PacketScan::Packet(packet) = next_packet(bytes) else {
                panic!("{bytes:?}")
            };
            self.sent.extend(packet.message());
        }
    }

    fn all<'a>(&'a self, name: &'a str) -> impl Iterator<Item = &'a Value> {
        self.events
            .iter()
            .filter(move |event| event["event"] == name)
    }

    /// The worst verdict of the flights; NA counts only if all verdicts are NA.
    fn verdict(&self) -> String {
        let ends = ["landed", "left_in_air", "lost_in_air"];
        let over = ends.iter().flat_map(|name| self.all(name));
        let verdicts: Vec<&str> = over
            .map(|event| event["verdict"].as_str().unwrap())
            .collect();
        let worst = ["FAIL", "WARN", "GOOD", "NA"];
        let worst = worst.iter().find(|verdict| verdicts.contains(verdict));
        (*worst.unwrap_or_else(|| panic!("no flight"))).to_owned()
    }
}

fn stream(path: &Path) -> Vec<u8> {
    let mut bytes = Vec::new();
    let file = fs::File::open(path).unwrap();
    flate2::read::GzDecoder::new(file)
        .read_to_end(&mut bytes)
        .unwrap();
    bytes
}

/// The verdict of `assess`, and its assumptions.
fn assess(stream: &[u8], estimator: &Estimator) -> (Verdict, Vec<String>) {
    let flight = flagred_flightlog::read(stream, &flagred_flightlog::Options::default()).unwrap();
    let assessment = flagred::log::assess(&flight, estimator, None);
    (assessment.verdict, flight.assumed)
}

fn px4(name: &str) -> Vec<u8> {
    stream(&reference_data().join(format!("px4sim/{name}.watch.tlog.gz")))
}

/// PX4's simulator does not report the limits of its outputs.
#[test]
#[ignore = "needs FLAGRED_SHARED"]
fn px4_streams_get_the_verdict_of_assess_with_the_same_assumptions() {
    for (name, verdict) in [
        ("c1", "GOOD"),
        ("w1", "GOOD"),
        ("plist", "GOOD"),
        ("p1", "WARN"),
        ("m1", "FAIL"),
        ("m2", "FAIL"),
    ] {
        let bytes = px4(name);
        let replay = Replay::of(&bytes, &shipped::flagred());
        let (assessed, assumed) = assess(&bytes, &shipped::flagred());
        assert_eq!(replay.verdict(), verdict, "{name}");
        assert_eq!(assessed.to_string(), verdict, "{name}: {assessed:?}");
        let ready = replay.all("ready").last().unwrap();
        assert_eq!(ready["assumed"], serde_json::json!(assumed), "{name}");
        assert_eq!(assumed, ["commands from 1000 to 2000 us"], "{name}");
        // Parameters that arrive in the air, 887 of them in one stream, change nothing.
        assert_eq!(replay.all("took_off").count(), 1, "{name}");
        let parts = replay
            .all("left_in_air")
            .filter(|part| part["why"] == "set_up_anew");
        assert_eq!(parts.count(), 0, "{name}");
        // The risk is known soon after take-off, although the thrust coefficients were never
        // received, because that watch did not request them.
        let first_s = |name: &str, is: &dyn Fn(&&Value) -> bool| {
            let first = replay.all(name).find(is).unwrap();
            first["t_s"].as_f64().unwrap()
        };
        let blind_s =
            first_s("risk", &|risk| risk["risk"].is_number()) - first_s("took_off", &|_| true);
        assert!(blind_s < 2.0, "{name}: {blind_s}");
        // PX4 sends ATTITUDE and motor commands at 50 Hz: no rate is lowered.
        let lowered = replay.sent.iter().filter(|message| {
            matches!(message, MavMessage::COMMAND_LONG(command)
                if command.command == MavCmd::MAV_CMD_SET_MESSAGE_INTERVAL && command.param1 != 245.0)
        });
        assert_eq!(lowered.count(), 0, "{name}");
        eprintln!("{name}: {verdict}, first risk {blind_s:.2} s after take-off");
    }
}

/// PX4 sends SYS_STATUS without a request.
#[test]
#[ignore = "needs FLAGRED_SHARED"]
fn px4_streams_have_the_battery_risk_of_assess() {
    let estimator = shipped::flagred_battery();
    for name in ["c1", "w1", "m1"] {
        let bytes = px4(name);
        let replay = Replay::of(&bytes, &estimator);
        let (assessed, _) = assess(&bytes, &estimator);
        assert_eq!(replay.verdict(), assessed.to_string(), "{name}");
        assert_ne!(replay.verdict(), "NA", "{name}");
    }
}

#[test]
#[ignore = "needs FLAGRED_SHARED"]
fn ardupilot_streams_get_the_verdict_of_assess() {
    let mut streams: Vec<_> = fs::read_dir(reference_data().join("sitl5/streams"))
        .unwrap()
        .map(|entry| entry.unwrap().path())
        .collect();
    streams.sort();
    assert!(streams.len() > 20);
    let mut wrong = Vec::new();
    for path in streams {
        let name = path.file_name().unwrap().to_string_lossy().into_owned();
        // Two flights, of which the first was lost in the air: `assess` has one verdict for both.
        if name.starts_with("w_kill") || name.starts_with("w_reboot") {
            continue;
        }
        let bytes = stream(&path);
        let (replay, (assessed, assumed)) = (
            Replay::of(&bytes, &shipped::flagred()),
            assess(&bytes, &shipped::flagred()),
        );
        let watched = replay.verdict();
        eprintln!("{name}: {watched}, {assessed}, assumed {assumed:?}");
        if watched != assessed.to_string() {
            wrong.push(format!("{name}: {watched}, {assessed:?}"));
        }
    }
    assert!(wrong.is_empty(), "{wrong:#?}");
}

/// The other station of this flight requests 1 Hz every three seconds.
#[test]
#[ignore = "needs FLAGRED_SHARED"]
fn the_station_that_slows_a_recorded_stream_is_named() {
    let bytes = stream(&reference_data().join("sitl5/streams/w_1hz_contend.tlog.gz"));
    let replay = Replay::of(&bytes, &shipped::flagred());
    let slowed: Vec<&Value> = replay.all("slowed").collect();
    assert!(!slowed.is_empty());
    for event in slowed {
        assert_eq!(
            (&event["system"], &event["component"]),
            (&serde_json::json!(255), &serde_json::json!(190))
        );
    }
}
