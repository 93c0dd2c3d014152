//! `flagred watch` of vehicles that send motor commands too rarely, that another station slows down, or whose motors
//! are on other outputs.

use std::{path::Path, time::Duration};

use flagred_tests::watch::Watch;
use flagred_tests::{
    STEADY,
    vehicle::flight,
    watch::{assess, check_texts, compare},
    wire::{Link, Speed},
};
use serde_json::{Value, json};

/// Whether the risk of an event is known.
fn is_known(event: &Value) -> bool {
    event["risk"].is_number()
}

/// Two samples in a window are too few for a deviation.
#[test]
fn a_vehicle_at_1_hz_has_no_risk_and_no_verdict() {
    let flight = flight(Path::new(STEADY));
    let watch = Watch::udp(&[]);
    let mut vehicle = watch.vehicle(&flight, Link::default());
    vehicle.every = Duration::from_secs(1);
    vehicle.meet();
    vehicle.fly(&flight, Speed::Fastest, 0.0, f64::INFINITY);
    let said = watch.end();
    assert!(said.all("risk").count() > 60);
    assert!(!said.all("risk").any(is_known));
    let reasons = said.all("risk").filter_map(|risk| risk["unknown"].as_str());
    let mut reasons: Vec<&str> = reasons.collect();
    reasons.dedup();
    assert!(
        reasons
            .iter()
            .any(|reason| reason.contains("log the motors at 2.5 Hz or more")),
        "{reasons:?}"
    );
    let landed = said.one("landed");
    assert_eq!(
        (&landed["verdict"], &landed["level_seen"]),
        (&json!("NA"), &Value::Null)
    );
    assert_eq!(
        (said.one("ended")["worst"].as_str(), said.code),
        (Some("NA"), Some(3))
    );
    assert_eq!(vehicle.received.values("FR_RISK").len(), 0);
    assert_eq!(vehicle.received.texts(), []);
}

/// Another station slows down the motor commands in flight; the watch repeats its request, and the risk is known again.
#[test]
fn a_stream_that_another_station_slowed_down_is_requested_again() {
    let flight = flight(Path::new(STEADY));
    let watch = Watch::udp(&[]);
    let mut vehicle = watch.vehicle(&flight, Link::default());
    vehicle.meet();
    let air = flight.in_air.as_ref().unwrap().spans[0];
    let [stolen_s, end_s] = [air.start_s + 20.0, air.start_s + 60.0];
    vehicle.fly(&flight, Speed::Times(4.0), air.start_s, stolen_s);
    vehicle.every = Duration::from_secs(1);
    vehicle.obeys = true;
    vehicle.fly(&flight, Speed::Times(4.0), stolen_s, end_s);
    assert_eq!(
        vehicle.every,
        Duration::from_millis(40),
        "it was asked for 25 Hz again"
    );
    let said = watch.end();
    let risks_from = |from_s: f64| {
        let risks = said.all("risk");
        risks.filter(move |risk| risk["t_s"].as_f64().unwrap() >= from_s)
    };
    assert!(
        risks_from(stolen_s).any(|risk| !is_known(risk)),
        "it was slow"
    );
    assert!(risks_from(end_s - 5.0).all(is_known));
    assert!(risks_from(end_s - 5.0).count() > 100);
    assert_eq!(said.one("left_in_air")["level_seen"], "GOOD");
}

#[test]
fn motors_on_outputs_9_to_12_and_17_to_20_get_the_risk_of_assess() {
    let log = Path::new(STEADY);
    let (flight, assessed) = (flight(log), assess(log));
    for first in [9, 17] {
        let watch = Watch::udp(&[]);
        let mut vehicle = watch.vehicle(&flight, Link::default());
        vehicle.remap(first);
        vehicle.meet();
        vehicle.fly(&flight, Speed::Fastest, 0.0, f64::INFINITY);
        let said = watch.end();
        let ready = said.one("ready");
        assert_eq!(ready["assumed"], json!([]));
        let sources = ready["motors"].as_array().unwrap().iter();
        let sources: Vec<&str> = sources
            .map(|motor| motor["source"].as_str().unwrap())
            .collect();
        let expected: Vec<String> = (0..4)
            .map(|i| format!("SERVO{}_FUNCTION = {}", first + i, 33 + i))
            .collect();
        assert_eq!(sources, expected);
        assert_eq!(said.one("landed")["verdict"], assessed["verdict"]);
        let (share, difference) = compare(&said, &assessed);
        assert!(
            share > 0.999 && difference <= 2.0,
            "{first}: {share}, {difference}"
        );
        check_texts(&said, &vehicle.received);
    }
}

/// The parameters behind the verdict are reported when ready, and are in the recording.
#[test]
fn the_parameters_behind_the_verdict_are_reported_and_recorded() {
    let flight = flight(Path::new(STEADY));
    let folder = flagred_tests::Folder::new();
    let path = folder.path().join("flight.tlog");
    let watch = Watch::udp(&["--record", path.to_str().unwrap()]);
    let mut vehicle = watch.vehicle(&flight, Link::default());
    vehicle.meet();
    vehicle.fly(&flight, Speed::Fastest, 0.0, 80.0);
    let said = watch.end();
    let ready = said.one("ready");
    let reported = ready["parameters"].as_array().unwrap();
    let has = |name: &str| {
        reported
            .iter()
            .any(|reported| reported["name"] == name && reported["source"] == "PARAM_VALUE")
    };
    assert!(
        has("MOT_PWM_MIN") && has("MOT_SPIN_MAX") && has("FRAME_CLASS"),
        "{ready}"
    );
    let recorded = &assess(&path)["vehicle"];
    assert_eq!(recorded["parameters"], ready["parameters"]);
    for key in ["low", "high", "source"] {
        assert_eq!(recorded["range"][key], ready["range"][key]);
        assert_eq!(
            recorded["effective_range"][key],
            ready["effective_range"][key]
        );
    }
}
