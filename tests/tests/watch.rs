//! `flagred watch` with a stand-in vehicle: the same verdicts as `flagred assess`, over any link.

use std::{
    net::TcpListener,
    path::{Path, PathBuf},
};

use flagred_flightlog::{Flight, mavlink::Version};
use flagred_tests::{
    STEADY, reference_data, shared_data,
    vehicle::{StandIn, flight},
    watch::{Watch, WatchOutput, assess, check_texts, compare, fly_udp},
    wire::{Link, Speed, Wire},
};
use serde_json::{Value, json};

/// A good link and two bad ones.
fn links() -> [Link; 3] {
    let bad = |loss| Link {
        loss,
        reordered: 0.05,
        repeated: 0.02,
    };
    [Link::default(), bad(0.05), bad(0.3)]
}

/// Replays a log over UDP, over TCP and over bad links: the verdict is that of `assess`.
fn every_link_gives_the_verdict_of_assess(log: &Path) {
    let flight = flight(log);
    let assessed = assess(log);
    for link in links() {
        let reported = fly_udp(&flight, link, &[], Speed::Fastest);
        assert_agrees_with_assess(
            &reported,
            &assessed,
            &format!("{}, {link:?}", log.display()),
            link,
        );
    }
    let reported = fly_tcp(&flight, Speed::Fastest);
    assert_agrees_with_assess(
        &reported,
        &assessed,
        &format!("{} over TCP", log.display()),
        Link::default(),
    );
}

/// Asserts the same verdict, the same risk if no packet is lost, and one text for each change of state.
fn assert_agrees_with_assess(
    (output, vehicle): &(WatchOutput, StandIn),
    assessed: &Value,
    case: &str,
    link: Link,
) {
    let verdict = assessed["verdict"].as_str().unwrap();
    assert_eq!(output.verdict(), verdict, "{case}");
    assert_eq!(output.one("ready")["assumed"], json!([]), "{case}");
    let (share, difference) = compare(output, assessed);
    eprintln!(
        "{case}: {:.1} % of samples, difference {difference:.3}",
        100.0 * share
    );
    if link.loss == 0.0 {
        assert!(share > 0.999, "{case}: {share}");
        assert!(difference <= 2.0, "{case}: {difference} points");
    }
    check_texts(output, &vehicle.received);
    if verdict == "GOOD" {
        assert_eq!(vehicle.received.texts(), [], "{case}");
    }
    let code = match verdict {
        "WARN" | "FAIL" => 1,
        "GOOD" => 0,
        _ => 3,
    };
    assert_eq!(output.code, Some(code), "{case}");
}

/// A watch with a TCP connection from a vehicle, in MAVLink 1.
fn watch_tcp(flight: &Flight, keep: fn(&Value) -> bool) -> (Watch, StandIn) {
    let listener = TcpListener::bind("127.0.0.1:0").unwrap();
    let endpoint = format!("tcp:{}", listener.local_addr().unwrap());
    let watch = Watch::start_keeping(&endpoint, &[], keep);
    let wire = Wire::tcp(listener.accept().unwrap().0);
    let vehicle = watch.vehicle_on(flight, wire, Link::default(), Version::V1);
    (watch, vehicle)
}

/// Replays a log over TCP.
fn fly_tcp(flight: &Flight, speed: Speed) -> (WatchOutput, StandIn) {
    let (watch, mut vehicle) = watch_tcp(flight, |_| true);
    vehicle.meet();
    vehicle.fly(flight, speed, 0.0, f64::INFINITY);
    (watch.end(), vehicle)
}

#[test]
fn the_shipped_flight_gets_the_verdict_of_assess_over_every_link() {
    every_link_gives_the_verdict_of_assess(Path::new(STEADY));
}

#[test]
#[ignore = "needs FLAGRED_SHARED"]
fn reference_flights_get_the_verdict_of_assess_over_every_link() {
    let data = reference_data();
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

/// Replays the flights at the original speed. This takes two minutes per flight, so the test runs only on request
/// (`--ignored`).
#[test]
#[ignore = "needs FLAGRED_SHARED"]
fn reference_flights_get_the_verdict_of_assess_in_real_time() {
    let data = reference_data();
    let mut logs: Vec<PathBuf> = std::fs::read_dir(data.join("flights"))
        .unwrap()
        .map(|entry| entry.unwrap().path())
        .filter(|path| path.extension().is_some_and(|extension| extension == "BIN"))
        .collect();
    logs.sort();
    assert_eq!(logs.len(), 6);
    std::thread::scope(|scope| {
        // `None` stands for TCP.
        let wires = links().map(Some).into_iter().chain([None]);
        for (log, link) in logs
            .iter()
            .flat_map(|log| wires.clone().map(move |link| (log, link)))
        {
            scope.spawn(move || {
                let flight = flight(log);
                let assessed = assess(log);
                let reported = match link {
                    Some(link) => fly_udp(&flight, link, &[], Speed::Times(1.0)),
                    None => fly_tcp(&flight, Speed::Times(1.0)),
                };
                let case = format!("{}, {link:?}", log.display());
                let link = link.unwrap_or_default();
                assert_agrees_with_assess(&reported, &assessed, &case, link);
                let values = reported.1.received.values("FR_RISK");
                let rate_hz =
                    values.len() as f64 / assessed["summary"]["assessed_s"].as_f64().unwrap();
                assert!((1.0..=2.1).contains(&rate_hz), "{case}: {rate_hz} Hz");
            });
        }
    });
}

/// Replays flights one after the other, a whole day of them, as fast as possible; run by
/// `scripts/measure-live`.
#[test]
#[ignore = "a day of flights"]
fn a_day_of_flights_takes_no_more_memory_than_an_hour() {
    const DAY_S: f64 = 24.0 * 3600.0;
    let eventful = shared_data().map(|data| data.join("flights").join("intermittent.BIN"));
    let flight = flight(eventful.as_deref().unwrap_or(Path::new(STEADY)));
    let [first_s, .., last_s] = flight.commands.t_s() else {
        panic!("no flight");
    };
    let length_s = last_s - first_s + 1.0;
    let (watch, mut vehicle) = watch_tcp(&flight, |event| event["event"] != "risk");
    vehicle.meet();
    let (mut flights, mut hour_kb) = (0, None);
    while vehicle.clock_s < DAY_S {
        vehicle.fly_on(&flight, Speed::Fastest, 0.0, f64::INFINITY);
        vehicle.received.messages.clear();
        vehicle.sent.clear();
        vehicle.clock_s += length_s;
        flights += 1;
        if vehicle.clock_s > 3600.0 {
            hour_kb.get_or_insert_with(|| watch.resident_kb());
        }
    }
    vehicle.wait_until_processed();
    let (hour_kb, day_kb) = (hour_kb.unwrap(), watch.resident_kb());
    println!("{hour_kb} kB after an hour, {day_kb} kB after a day of {flights} flights");
    assert!(day_kb < hour_kb + 512, "{hour_kb} kB, {day_kb} kB");
    let said = watch.end();
    assert_eq!(said.all("landed").count(), flights);
    assert_eq!(said.all("rebooted").count(), 0);
}
