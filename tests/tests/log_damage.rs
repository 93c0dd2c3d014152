//! Damaged logs are read as far as possible. `mutations.rs` tests many more damaged logs.

use flagred::{flight::Verdict, log::assess, shipped};
use flagred_flightlog::Options;
use flagred_tests::{
    fuzzing::{check, mutation, seeds},
    log_writer::Value,
    reference_data,
};

/// The logs are intact before the tests damage them.
#[test]
fn the_logs_are_intact_before_they_are_damaged() {
    for log in seeds::logs() {
        let flight = flagred_flightlog::read(&log[..], &Options::default()).unwrap();
        assert!(flight.report.is_clean(), "{:?}", flight.report);
        assert!(flight.statistics().is_ok(), "{:?}", flight.gaps());
        check(&flight, &log);
    }
}

/// Real logs contain messages and definitions that the generated ones do not.
#[test]
#[ignore = "needs FLAGRED_SHARED"]
fn damaged_real_logs() {
    let data = reference_data();
    for log in [
        "ap_methodic_80k.bin",
        "ap_beast_sample.bin",
        "aptxt_mechanical_fail.log",
        "px_roboto.ulg",
        "tl_vtol.tlog",
    ] {
        let bytes = std::fs::read(data.join("logs").join(log)).unwrap();
        for seed in 0..6 {
            let mut random = fastrand::Rng::with_seed(seed);
            let mut bytes = bytes.clone();
            for _ in 0..bytes.len() / 200 {
                let at = random.usize(..bytes.len());
                bytes[at] = mutation::byte(&mut random);
            }
            if let Ok(flight) = flagred_flightlog::read(&bytes[..], &Options::default()) {
                check(&flight, &bytes);
            }
        }
    }
}

/// If a tenth of the file is damaged, all rows that are still intact must be read.
#[test]
fn a_hole_loses_only_the_rows_in_it() {
    let logs = [
        seeds::data_flash().bytes,
        seeds::ulog(),
        seeds::tlog(),
        seeds::data_flash().text.into_bytes(),
    ];
    for mut log in logs {
        let rows = flagred_flightlog::read(&log[..], &Options::default())
            .unwrap()
            .commands
            .len();
        let middle = log.len() / 2;
        log[middle..middle + 200].fill(b'?');
        let flight = flagred_flightlog::read(&log[..], &Options::default()).unwrap();
        let lost = rows - flight.commands.len();
        assert!(
            (1..=6).contains(&lost),
            "{}: {lost} rows lost",
            flight.format
        );
        let report = &flight.report;
        assert!(report.skipped_bytes + report.bad_messages > 0, "{report:?}");
        // If the log is cut in the middle, all rows before the cut are read.
        let flight = flagred_flightlog::read(&log[..middle], &Options::default()).unwrap();
        assert!(flight.commands.len() >= rows / 3, "{}", flight.format);
    }
}

/// With the invalid timestamps, the flight would last 292,000 years, and seconds would be below the precision of the
/// clock.
#[test]
fn seconds_of_invalid_timestamps_are_skipped() {
    let log = |wild_us: Option<f64>| {
        let mut log = seeds::hovering();
        for row in 0..1000 {
            let time_us = 12e6 + 4e4 * f64::from(row);
            let wild_us = wild_us.filter(|_| (300..400).contains(&row));
            let time_us = wild_us.map_or(time_us, |wild_us| wild_us + time_us);
            let pulse = Value::Number(f64::from(1450 + row % 100));
            log.write("RCOU", [time_us.into(), pulse, pulse, pulse, pulse]);
        }
        flagred_flightlog::read(&log.bytes[..], &Options::default()).unwrap()
    };
    let whole = log(None);
    let verdict = assess(&whole, &shipped::flagred(), None).verdict;
    assert!(matches!(verdict, Verdict::Known(_)), "{verdict:?}");
    for wild_us in [9_223_372_036_854_775_808.0, 1e12, 3e16] {
        let flight = log(Some(wild_us));
        assert!(flight.report.bad_messages >= 100, "{:?}", flight.report);
        assert_eq!(flight.commands.len(), whole.commands.len() - 100);
        assert!(flight.time_span_s() == whole.time_span_s() && flight.boots_s.is_empty());
        let assessed = assess(&flight, &shipped::flagred(), None);
        assert_eq!(assessed.verdict, verdict);
    }
}
