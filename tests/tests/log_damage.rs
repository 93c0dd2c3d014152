//! Damaged logs: no panic, no hang, nothing that means nothing, memory bounded by the log.
//!
//! `FLAGRED_MUTATIONS` is the number of damaged copies of each format, 200 by default.

use std::io::Write;
use std::time::{Duration, Instant};

use flagred_tests::log_writer::{
    ATTITUDE, DataFlash, HEARTBEAT, PARAM_VALUE, SERVO_OUTPUT_RAW, Tlog, ULog, Value,
};
use flagred_tests::reference_data;
use flate2::{Compression, write::GzEncoder};
use flightlog::{Flight, Options, ReadError};

/// A generator of numbers that is the same everywhere: xorshift64* (Vigna 2016).
struct Random(u64);

impl Random {
    fn new(seed: u64) -> Self {
        Self(seed.wrapping_mul(0x9e37_79b9_7f4a_7c15) | 1)
    }

    fn below(&mut self, limit: usize) -> usize {
        self.0 ^= self.0 >> 12;
        self.0 ^= self.0 << 25;
        self.0 ^= self.0 >> 27;
        (self.0.wrapping_mul(0x2545_f491_4f6c_dd1d) >> 33) as usize % limit.max(1)
    }

    fn byte(&mut self) -> u8 {
        // Small numbers and borders are where lengths and counts go wrong.
        match self.below(4) {
            0 => [0, 1, 2, 3, 0x7f, 0x80, 0xfe, 0xff][self.below(8)],
            _ => self.below(256) as u8,
        }
    }
}

/// A copy with one to twelve wounds: bytes overwritten, lost, added, repeated, or cut off.
fn damaged(log: &[u8], random: &mut Random) -> Vec<u8> {
    let mut bytes = log.to_vec();
    for _ in 0..=random.below(12) {
        if bytes.is_empty() {
            break;
        }
        let at = random.below(bytes.len());
        let count = 1 + random.below(64).min(bytes.len() - at).saturating_sub(1);
        match random.below(12) {
            0 => drop(bytes.drain(at..at + count)),
            1 => {
                let added: Vec<u8> = (0..count).map(|_| random.byte()).collect();
                bytes.splice(at..at, added);
            }
            2 => {
                let again = bytes[at..at + count].to_vec();
                let to = random.below(bytes.len());
                bytes.splice(to..to, again);
            }
            3 => bytes.truncate(at.max(1)),
            4 => bytes[at..at + count].fill(0),
            5 => bytes[at..at + count]
                .iter_mut()
                .for_each(|b| *b = random.byte()),
            _ => bytes[at] = random.byte(),
        }
    }
    bytes
}

/// What must be true of every flight, however damaged its log.
fn check(flight: &Flight, log: &[u8]) {
    let report = &flight.report;
    assert!(report.skipped_bytes <= report.bytes);
    assert!(report.is_clean() || report.reason.is_some(), "{report:?}");
    assert!(flight.commands.t_s().is_sorted());
    assert!(flight.commands.t_s().iter().all(|t_s| t_s.is_finite()));
    // Every value takes a byte of the log at least: nothing is made up of nothing.
    let values: usize = flight.series.iter().map(|series| series.t_s().len()).sum();
    assert!(flight.commands.len() + values <= 40 * log.len());
    for signal in flight.signals() {
        assert!(signal.t_s.is_sorted(), "{}", signal.label.name);
        assert_eq!(signal.t_s.len(), signal.values.len());
    }
    for range in flight.range.iter().chain([&flight.effective]) {
        assert!(range.high > range.low, "{range:?}");
    }
    for intervals in flight.in_air.iter().chain(&flight.armed) {
        let ends = |span: &flightlog::Interval| span.end_s >= span.start_s;
        assert!(intervals.spans.iter().all(ends), "{intervals:?}");
    }
    // What is written as CSV can be read again.
    let mut csv = Vec::new();
    flight.write_csv(&mut csv).unwrap();
    if !flight.commands.is_empty() {
        let again = flightlog::read(&csv[..], &Options::default()).unwrap();
        assert_eq!(again.commands.len(), flight.commands.len());
    }
    if let Ok(statistics) = flight.statistics() {
        for value in [
            statistics.margin_mean,
            statistics.margin_min,
            statistics.margin_std,
        ] {
            assert!((0.0..=0.5).contains(&value), "{statistics:?}");
        }
        for value in [statistics.command_mean, statistics.command_std] {
            assert!((0.0..=1.0).contains(&value), "{statistics:?}");
        }
    }
}

fn survive(name: &str, log: &[u8]) {
    let count: u64 = match std::env::var("FLAGRED_MUTATIONS") {
        Ok(count) => count.parse().unwrap(),
        Err(_) => 200,
    };
    let intact = flightlog::read(log, &Options::default()).unwrap();
    assert!(intact.report.is_clean(), "{name}: {:?}", intact.report);
    assert!(intact.statistics().is_ok(), "{name}: {:?}", intact.gaps());
    let mut slowest = Duration::ZERO;
    let mut read = 0;
    for seed in 0..count {
        let bytes = damaged(log, &mut Random::new(seed));
        let start = Instant::now();
        match flightlog::read(&bytes[..], &Options::default()) {
            Ok(flight) => {
                read += 1;
                check(&flight, &bytes);
            }
            Err(ReadError::Io { source, .. }) => panic!("{name}, seed {seed}: {source}"),
            Err(_) => {}
        }
        slowest = slowest.max(start.elapsed());
    }
    eprintln!("{name}: {read} of {count} damaged copies read, the slowest in {slowest:?}");
    assert!(slowest < Duration::from_secs(5), "{name}: {slowest:?}");
}

/// A quad that hovers from second 3 to second 8 of 10.
fn data_flash() -> DataFlash {
    let mut log = DataFlash::new();
    log.define(129, "PARM", "QNf", "TimeUS,Name,Value");
    log.define(130, "RCOU", "QHHHH", "TimeUS,C1,C2,C3,C4");
    log.define(
        131,
        "ATT",
        "QccccCC",
        "TimeUS,DesRoll,Roll,DesPitch,Pitch,DesYaw,Yaw",
    );
    log.define(132, "EV", "QB", "TimeUS,Id");
    log.define(133, "MSG", "QZ", "TimeUS,Message");
    log.define(
        134,
        "IMU",
        "Qffffff",
        "TimeUS,GyrX,GyrY,GyrZ,AccX,AccY,AccZ",
    );
    log.write("MSG", [1e6.into(), "ArduCopter V4.5.7 (2a3dc4b7)".into()]);
    for motor in 1..=4 {
        let name = format!("SERVO{motor}_FUNCTION");
        log.parameter(1e6, &name, f64::from(32 + motor));
    }
    log.parameter(1e6, "MOT_PWM_MIN", 1000.0);
    log.parameter(1e6, "MOT_PWM_MAX", 2000.0);
    for row in 0..100 {
        let time = Value::Number(1e6 + 1e5 * f64::from(row));
        match row {
            10 => log.write("EV", [time, 10.0.into()]),
            20 => log.write("EV", [time, 28.0.into()]),
            70 => log.write("EV", [time, 18.0.into()]),
            _ => {}
        }
        let pulse = Value::Number(f64::from(1400 + row));
        log.write("RCOU", [time, pulse, pulse, pulse, pulse]);
        log.write("IMU", std::iter::once(time).chain([Value::Number(0.5); 6]));
    }
    log
}

fn ulog() -> Vec<u8> {
    let mut log = ULog::new(1_000_000);
    log.define("actuator_motors:uint64_t timestamp;float[12] control;");
    log.define("vehicle_attitude:uint64_t timestamp;float[4] q;");
    log.define("vehicle_status:uint64_t timestamp;uint8_t arming_state;uint8_t nav_state;");
    log.define("vehicle_land_detected:uint64_t timestamp;bool landed;uint8_t[7] _padding0;");
    log.parameter("CA_ROTOR_COUNT", 4.0);
    log.parameter("MAV_TYPE", 2.0);
    for (id, name) in [
        (1, "actuator_motors"),
        (2, "vehicle_attitude"),
        (3, "vehicle_status"),
        (4, "vehicle_land_detected"),
    ] {
        log.announce(0, id, name);
    }
    for row in 0..100_u64 {
        let time_us = 1_000_000 + 100_000 * row;
        if row % 10 == 0 {
            log.flags(3, time_us, &[2, 3]);
            log.flags(4, time_us, &[u8::from(!(20..80).contains(&row))]);
        }
        log.floats(1, time_us, &[0.4; 12]);
        log.floats(2, time_us, &[1.0, 0.0, 0.0, 0.0]);
    }
    log.bytes
}

fn tlog() -> Vec<u8> {
    let mut log = Tlog::default();
    for (motor, version) in [(1, 1), (2, 2), (3, 1), (4, 2)] {
        let mut parameter = (32.0 + motor as f32).to_le_bytes().to_vec();
        parameter.extend([0; 4]);
        parameter.extend(format!("SERVO{motor}_FUNCTION").bytes());
        log.packet(
            1_700_000_000_000_000,
            version,
            (1, 1),
            PARAM_VALUE,
            &parameter,
        );
    }
    for (name, value) in [("MOT_PWM_MIN", 1000.0_f32), ("MOT_PWM_MAX", 2000.0)] {
        let mut parameter = value.to_le_bytes().to_vec();
        parameter.extend([0; 4]);
        parameter.extend(name.bytes());
        log.packet(1_700_000_000_000_000, 2, (1, 190), PARAM_VALUE, &parameter);
    }
    for row in 0..100_u64 {
        let stamp_us = 1_700_000_000_000_000 + 100_000 * row;
        let version = 1 + (row % 2) as u8;
        let heartbeat = [0, 0, 0, 0, 2, 3, 128, 4, 3];
        log.packet(stamp_us, version, (1, 1), HEARTBEAT, &heartbeat);
        let mut servos = vec![0; 4];
        servos.extend([1500_u16; 8].iter().flat_map(|pulse| pulse.to_le_bytes()));
        servos.push(0);
        log.packet(stamp_us, version, (1, 1), SERVO_OUTPUT_RAW, &servos);
        log.packet(stamp_us, version, (1, 1), ATTITUDE, &[0; 28]);
    }
    log.bytes
}

fn csv() -> String {
    let mut log = String::from("# vehicle: quad\n# pwm_low_us: 1000\n# pwm_high_us: 2000\n");
    log += "t_s,pwm1,pwm2,pwm3,pwm4,in_air,roll_deg,roll_des_deg,pitch_deg,pitch_des_deg\n";
    for row in 0..100 {
        let t_s = 0.04 * f64::from(row);
        log += &format!(
            "{t_s:.2},1500,1510,1490,1500,{},0.1,0.2,-0.3,0\n",
            u8::from(row > 9)
        );
    }
    log
}

#[test]
fn damaged_dataflash_logs() {
    survive("DataFlash", &data_flash().bytes);
}

#[test]
fn damaged_dataflash_text_logs() {
    survive("DataFlash text", data_flash().text.as_bytes());
}

#[test]
fn damaged_ulog_files() {
    survive("ULog", &ulog());
}

#[test]
fn damaged_telemetry_logs() {
    survive("tlog", &tlog());
}

#[test]
fn damaged_flight_csv() {
    survive("CSV", csv().as_bytes());
}

#[test]
fn damaged_gzipped_logs() {
    let mut packed = GzEncoder::new(Vec::new(), Compression::default());
    packed.write_all(&data_flash().bytes).unwrap();
    survive("gzipped DataFlash", &packed.finish().unwrap());
}

/// Real logs hold messages and definitions that the written ones do not.
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
            let mut random = Random::new(seed);
            let mut bytes = bytes.clone();
            for _ in 0..bytes.len() / 200 {
                let at = random.below(bytes.len());
                bytes[at] = random.byte();
            }
            if let Ok(flight) = flightlog::read(&bytes[..], &Options::default()) {
                check(&flight, &bytes);
            }
        }
    }
}

/// What a tenth of the damage leaves must still be read: a hole costs the records it hits.
#[test]
fn a_hole_costs_what_it_hits() {
    let logs = [
        data_flash().bytes,
        ulog(),
        tlog(),
        data_flash().text.into_bytes(),
    ];
    for mut log in logs {
        let rows = flightlog::read(&log[..], &Options::default())
            .unwrap()
            .commands
            .len();
        let middle = log.len() / 2;
        log[middle..middle + 200].fill(b'?');
        let flight = flightlog::read(&log[..], &Options::default()).unwrap();
        let lost = rows - flight.commands.len();
        assert!(
            (1..=6).contains(&lost),
            "{}: {lost} rows lost",
            flight.format
        );
        let report = &flight.report;
        assert!(report.skipped_bytes + report.bad_messages > 0, "{report:?}");
        // Cut in the middle, all rows before are there.
        let flight = flightlog::read(&log[..middle], &Options::default()).unwrap();
        assert!(flight.commands.len() >= rows / 3, "{}", flight.format);
    }
}
