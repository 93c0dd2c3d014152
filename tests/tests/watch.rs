//! `flagred watch` against a stand-in vehicle: the same verdicts as `flagred assess`, whatever the link does.

use std::{
    net::TcpListener,
    path::{Path, PathBuf},
};

use flagred_tests::{
    STEADY, shared_data,
    vehicle::{Link, Speed, StandIn, Wire, flight},
    watch::{Said, Watch, assess, check_texts, compare, fly_udp},
};
use flightlog::{Flight, mavlink::Version};

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

    let (said, vehicle) = fly_tcp(&flight, Speed::Fastest);
    assert_eq!(said.verdict(), verdict, "{name} over TCP");
    let (share, difference) = compare(&said, &assessed);
    assert!(
        share > 0.999 && difference <= 2.0,
        "{name} over TCP: {share} {difference}"
    );
    check_texts(&said, &vehicle.heard);
}

/// Flies a log over TCP, in MAVLink 1.
fn fly_tcp(flight: &Flight, speed: Speed) -> (Said, StandIn) {
    let listener = TcpListener::bind("127.0.0.1:0").unwrap();
    let watch = Watch::start(&format!("tcp:{}", listener.local_addr().unwrap()), &[]);
    let wire = Wire::tcp(listener.accept().unwrap().0);
    let mut vehicle = watch.vehicle_on(flight, wire, Link::default(), Version::V1);
    vehicle.meet();
    vehicle.fly(flight, speed, 0.0, f64::INFINITY);
    (watch.end(), vehicle)
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
        for (log, over_tcp) in logs.iter().flat_map(|log| [(log, false), (log, true)]) {
            scope.spawn(move || {
                let flight = flight(log);
                let assessed = assess(log);
                let (said, vehicle) = if over_tcp {
                    fly_tcp(&flight, Speed::Times(1.0))
                } else {
                    fly_udp(&flight, Link::default(), &[], Speed::Times(1.0))
                };
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
