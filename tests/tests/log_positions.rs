//! Positions in logs of each format. They are read where they are known; they are unknown before the first fix, and
//! missing if there is no fix.

use flagred_flightlog::{Flight, Options};
use flagred_tests::log_writer::{DataFlash, GLOBAL_POSITION_INT, HEARTBEAT, Tlog, ULog};

fn read(bytes: &[u8]) -> Flight {
    flagred_flightlog::read(bytes, &Options::default()).unwrap()
}

/// The known values of a signal with their times, and its source.
fn known(flight: &Flight, name: &str) -> (Vec<(f64, f64)>, String) {
    let signal = flight.signal(name).unwrap();
    let all = signal
        .t_s
        .iter()
        .copied()
        .zip(signal.values.iter().copied());
    let known = all.filter(|(_, value)| value.is_finite());
    (known.collect(), signal.label.source.clone())
}

#[test]
fn ardupilot_logs_have_the_estimated_position_or_else_that_of_the_receiver() {
    let log = |with_estimate: bool| {
        let mut log = DataFlash::new();
        log.define(130, "POS", "QLLf", "TimeUS,Lat,Lng,Alt");
        log.define(131, "GPS", "QBLL", "TimeUS,Status,Lat,Lng");
        for i in 0..4 {
            let time = 1e6 + 2e5 * f64::from(i);
            let degrees = match i {
                0 => [0.0, 0.0],
                i => [47.0 + 1e-5 * f64::from(i), -8.5],
            };
            let [north, east] = degrees.map(Into::into);
            log.write("GPS", [time.into(), 3.0.into(), north, east]);
            if with_estimate {
                let [north, east] = degrees.map(|degrees| (degrees * 2.0).into());
                log.write("POS", [time.into(), north, east, 1.0.into()]);
            }
        }
        log
    };
    for (with_estimate, times, message) in [(false, 1.0, "GPS"), (true, 2.0, "POS")] {
        let log = log(with_estimate);
        for bytes in [&log.bytes[..], log.text.as_bytes()] {
            let flight = read(bytes);
            let (north, source) = known(&flight, "latitude_deg");
            assert_eq!(source, format!("{message}.Lat"));
            assert_eq!(north.len(), 3, "0 is unknown: {north:?}");
            assert!((north[0].1 - times * 47.00001).abs() < 1e-6, "{north:?}");
            assert!((known(&flight, "longitude_deg").0[2].1 + times * 8.5).abs() < 1e-6);
        }
    }
}

#[test]
fn px4_logs_have_global_and_local_positions() {
    let mut log = ULog::new(0);
    log.define("vehicle_global_position:uint64_t timestamp;double lat;double lon;");
    log.define("vehicle_local_position:uint64_t timestamp;float x;float y;bool xy_valid;");
    log.define("vehicle_gps_position:uint64_t timestamp;int32_t lat;int32_t lon;");
    for (id, name) in [
        (1_u16, "vehicle_global_position"),
        (2, "vehicle_local_position"),
        (3, "vehicle_gps_position"),
    ] {
        log.announce(0, id, name);
    }
    let mut data = |id: u16, i: u64, fields: &[&[u8]]| {
        let time_us = (1_000_000 + 200_000 * i).to_le_bytes();
        let body = [&id.to_le_bytes()[..], &time_us, &fields.concat()].concat();
        log.message(b'D', &body);
    };
    for i in 0..3 {
        let degrees = if i == 0 { 0.0_f64 } else { 60.5 };
        data(1, i, &[&degrees.to_le_bytes(), &degrees.to_le_bytes()]);
        let (x, y) = (i as f32, -2.0_f32);
        data(
            2,
            i,
            &[&x.to_le_bytes(), &y.to_le_bytes(), &[u8::from(i < 2)]],
        );
        let raw = 605_000_000_i32;
        data(3, i, &[&raw.to_le_bytes(), &raw.to_le_bytes()]);
    }
    let flight = read(&log.bytes);
    let (latitude, source) = known(&flight, "latitude_deg");
    assert_eq!(source, "vehicle_global_position.lat");
    assert_eq!(
        latitude.iter().map(|(_, v)| *v).collect::<Vec<_>>(),
        [60.5, 60.5]
    );
    // A position in metres may be 0; it is unknown if the estimator reports it as invalid.
    let (north, source) = known(&flight, "north_m");
    assert_eq!(source, "vehicle_local_position.x");
    assert_eq!(
        north.iter().map(|(_, v)| *v).collect::<Vec<_>>(),
        [0.0, 1.0]
    );
    assert_eq!(known(&flight, "east_m").0.len(), 2);
}

#[test]
fn telemetry_has_the_position_once_it_is_known() {
    const START_US: u64 = 1_700_000_000_000_000;
    let mut log = Tlog::default();
    log.packet(
        START_US,
        2,
        (1, 1),
        HEARTBEAT,
        &[0, 0, 0, 0, 2, 3, 128, 4, 3],
    );
    for i in 0..3_u32 {
        let degrees = if i == 0 { 0 } else { -335_000_000_i32 };
        let time_ms = 1000 + 100 * i;
        let fields = [degrees, 1_510_000_000, 500, 2500]
            .map(i32::to_le_bytes)
            .concat();
        let payload = [&time_ms.to_le_bytes()[..], &fields, &[0; 8]].concat();
        let stamp_us = START_US + u64::from(i) * 100_000;
        log.packet(stamp_us, 2, (1, 1), GLOBAL_POSITION_INT, &payload);
    }
    let flight = read(&log.bytes);
    let (latitude, source) = known(&flight, "latitude_deg");
    assert_eq!(source, "GLOBAL_POSITION_INT");
    assert_eq!(latitude.len(), 2, "0 is unknown");
    assert!((latitude[0].1 + 33.5).abs() < 1e-9);
    assert!((known(&flight, "longitude_deg").0[0].1 - 151.0).abs() < 1e-9);
    assert_eq!(known(&flight, "altitude_m").0[0].1, 2.5);
}

#[test]
fn a_log_without_positions_has_no_signal_of_them() {
    let flight = read(b"t_s,motor1\n0,0.5\n1,0.5\n");
    assert!(flight.signal("latitude_deg").is_none() && flight.signal("north_m").is_none());
}
