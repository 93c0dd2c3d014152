//! Lasting motor faults are reported until landing, with the right motor; healthy motors are not reported as weak.
//!
//! `FLAGRED_SHARED=... cargo test -p flagred-tests --test motor_faults -- --ignored --nocapture` prints a line for each flight.

use std::path::Path;

use flagred::{
    board::OwnedMemory,
    flight::{Assessment, Assessor},
    monitor::{Craft, Factors, Sample, Unknown, Update},
    shipped,
    verdict::{Finding, Level, Measure},
};
use flagred_tests::{reference::flight::samples, reference_data, simulated::on_all_cores};

/// The results of a monitor for a flight.
struct MonitorResults {
    id: String,
    findings: Vec<Finding>,
    /// The level after each sample in the air, with its time.
    levels: Vec<(f64, Option<Level>)>,
    /// Times, in seconds, at which the risk was unknown and the level was GOOD.
    good_and_unknown_s: Vec<f64>,
}

fn follow(path: &Path) -> MonitorResults {
    let flight = flagred_flightlog::open(path, &flagred_flightlog::Options::default()).unwrap();
    let factors = flight.geometry.as_ref().map_or(&[][..], |g| &g.factors);
    let craft = Craft::new(flight.motors.len()).with_geometry(factors);
    let mut assessor = Assessor::new(&shipped::flagred(), craft, None).unwrap();
    let (mut levels, mut good_and_unknown_s) = (vec![], vec![]);
    for sample in samples(&flight) {
        let update = assessor.push(&Sample {
            t_s: sample.t_s,
            motors: &sample.commands,
            in_air: Some(sample.in_air),
            signals: &[],
        });
        if update.risk.is_err() && update.level == Some(Level::Good) {
            good_and_unknown_s.push(sample.t_s);
        }
        if sample.in_air && update.risk != Err(Unknown::OnGround) {
            levels.push((sample.t_s, update.level));
        }
    }
    let findings = assessor.finish().findings;
    let name = path.file_name().unwrap().to_string_lossy();
    MonitorResults {
        id: name.split('.').next().unwrap().to_owned(),
        findings: findings.iter().map(|finding| finding.found).collect(),
        levels,
        good_and_unknown_s,
    }
}

fn is_of_balance(finding: &Finding) -> bool {
    matches!(
        finding.measure,
        Measure::Imbalance | Measure::PairImbalance | Measure::WeakMotor
    )
}

fn line(flight: &MonitorResults) -> String {
    let mut text = format!("{:24}", flight.id);
    for found in &flight.findings {
        let motor = found.motor.map_or(String::new(), |m| {
            let or = m.or_number.map_or(String::new(), |or| format!(" or {or}"));
            format!(" motor {}{or}", m.number)
        });
        text += &format!(
            "  {} {} {:.0} %{motor} {:.1}-{:.1}",
            found.severity, found.measure, found.value_pct, found.raised_s, found.to_s
        );
    }
    text
}

/// Faults of sitl5: the flight, the motor (from 1), and the times in the air at which the fault begins and ends.
const FAULTS: [(&str, usize, f64, f64); 9] = [
    ("motor_quad_m1_75", 1, 94.6, 154.0),
    ("motor_quad_m3_50", 3, 94.7, 120.0),
    ("motor_hexa_m3_60", 3, 94.7, 182.5),
    ("motor_hexa_m1_0", 1, 94.7, 110.0),
    ("motor_octa_m3_0", 3, 94.7, 182.5),
    ("motor_octa_m1_50", 1, 94.7, 167.5),
    ("motor_y6_m2_0", 2, 94.7, 162.5),
    ("motor_octaquad_m3_0", 3, 94.8, 182.5),
    ("motor_octaquad_m6_50", 6, 94.8, 182.5),
];

#[test]
#[ignore = "needs FLAGRED_SHARED"]
fn a_lasting_fault_stays_reported_and_its_motor_is_named() {
    for (id, motor, from_s, to_s) in FAULTS {
        let flight = follow(&reference_data().join(format!("sitl5/{id}.BIN.gz")));
        println!("{}", line(&flight));
        let raised = flight
            .levels
            .iter()
            .find(|(t_s, level)| *t_s >= from_s && level.is_some_and(|level| level > Level::Good));
        let (raised_s, _) = raised.unwrap_or_else(|| panic!("{id}: no alarm"));
        assert!(raised_s - from_s < 2.0, "{id}: raised at {raised_s} s");
        let mut lasting = flight.levels.iter();
        let silent = lasting.find(|(t_s, level)| {
            (*raised_s..to_s).contains(t_s) && level.is_none_or(|level| level < Level::Warn)
        });
        assert_eq!(silent, None, "{id}");
        let named = flight.findings.iter().filter(|found| is_of_balance(found));
        let named: Vec<_> = named.filter_map(|found| found.motor).collect();
        assert!(!named.is_empty(), "{id}");
        for found in named {
            assert_eq!((found.number, found.or_number), (motor, None), "{id}");
        }
        assert_eq!(flight.good_and_unknown_s, [0.0; 0]);
    }
}

#[test]
#[ignore = "needs FLAGRED_SHARED"]
fn wind_and_manoeuvres_are_not_reported_as_a_weak_motor() {
    for id in [
        "batt_quad",
        "calm_quad",
        "hsteps_c69",
        "hwind_c69",
        "landings_octaquad",
        "ord_hexa",
        "ord_quad_a",
        "steps_quad",
        "stockwind_quad",
        "wind_hexa",
        "wind_octa",
        "wind_octaquad",
    ] {
        let flight = follow(&reference_data().join(format!("sitl5/{id}.BIN.gz")));
        println!("{}", line(&flight));
        let mut of_balance = flight.findings.iter().filter(|found| is_of_balance(found));
        let weak = of_balance.find(|found| found.measure == Measure::WeakMotor);
        assert_eq!(weak, None, "{id}");
        assert_eq!(flight.good_and_unknown_s, [0.0; 0]);
    }
}

/// Flights without a motor fault that have a finding about a weak motor: a flight with an upset of another kind; a
/// landing after which the motors run for seconds on the ground; a craft that leans into rising wind and no longer
/// leans after a FAIL (a shift of 8 %, reported for 8 s); and a real flight in which the pilot turns the craft over
/// in ACRO, with a FAIL 6 s before the end of the flight.
const NOT_FAULTS: [&str; 4] = ["f240", "n240", "f068", "dronekit_test_01"];

#[test]
#[ignore = "needs FLAGRED_SHARED"]
fn no_weak_motor_in_flights_without_a_motor_fault() {
    let data = reference_data();
    for set in ["real", "real2", "sitl2", "sitl3"] {
        let folder = match set {
            "real" | "real2" => data.join(set).join("flights"),
            _ => data.join(set).join("timeseries"),
        };
        let mut table = csv::Reader::from_path(data.join(set).join("index.csv")).unwrap();
        let rows = table.deserialize::<std::collections::BTreeMap<String, String>>();
        let rows: Vec<_> = rows.map(Result::unwrap).collect();
        let flights = on_all_cores(&rows, |row| {
            follow(&folder.join(format!("{}.csv.gz", row["id"])))
        });
        let mut false_alarms = vec![];
        for (row, flight) in rows.iter().zip(&flights) {
            let what = [row.get("kind"), row.get("subkind"), row.get("class")];
            let what: Vec<&str> = what.into_iter().flatten().map(String::as_str).collect();
            println!("{set} {:32} {}", what.join(" "), line(flight));
            let is_fault = what
                .iter()
                .any(|what| what.contains("motor") || what.contains("order"));
            let mut found = flight.findings.iter();
            let weak = found.any(|found| found.measure == Measure::WeakMotor);
            if weak && !is_fault && !NOT_FAULTS.contains(&flight.id.as_str()) {
                false_alarms.push(flight.id.clone());
            }
            assert_eq!(flight.good_and_unknown_s, [0.0; 0], "{}", flight.id);
        }
        assert_eq!(false_alarms, Vec::<String>::new(), "{set}");
    }
}

// Generated flights, with the commands of ArduPilot's simulator.

const QUAD: [Factors; 4] = [
    [-1.0, 1.0, 1.0],
    [1.0, -1.0, 1.0],
    [1.0, 1.0, -1.0],
    [-1.0, -1.0, -1.0],
];
/// Plus layout: front, rear, left rear, right front, left front, right rear.
const HEXA: [Factors; 6] = [
    [0.0, 1.0, -1.0],
    [0.0, -1.0, 1.0],
    [1.0, -0.5, -1.0],
    [-1.0, 0.5, 1.0],
    [1.0, 0.5, 1.0],
    [-1.0, -0.5, -1.0],
];
/// Plus layout: motors 1 and 6 in front, 2 and 5 left, 3 and 8 behind, 4 and 7 right.
const OCTAQUAD: [Factors; 8] = [
    [0.0, 1.0, 1.0],
    [1.0, 0.0, -1.0],
    [0.0, -1.0, 1.0],
    [-1.0, 0.0, -1.0],
    [1.0, 0.0, 1.0],
    [0.0, 1.0, -1.0],
    [-1.0, 0.0, 1.0],
    [0.0, -1.0, -1.0],
];

/// A start time in seconds, and from then on the commands relative to 0.55.
type Phase<'a> = (f64, &'a [f64]);

/// Flies phases at 50 Hz until a time, with a little noise, and lands; samples in `gap` are omitted. The on-board
/// monitor must give the same results.
fn fly(
    factors: &[Factors],
    phases: &[Phase<'_>],
    gap: core::ops::Range<f64>,
    to_s: f64,
) -> (Assessment, Vec<Update>) {
    let estimator = shipped::flagred();
    let craft = Craft::new(factors.len()).with_geometry(factors);
    let mut assessor = Assessor::new(&estimator, craft, None).unwrap();
    let plan = estimator.plan().unwrap();
    let mut memory = OwnedMemory::new(&plan, factors.len());
    let mut on_board = memory.monitor(&plan).unwrap();
    on_board.set_geometry(factors).unwrap();
    let mut updates = vec![];
    for i in 0..((to_s + 3.0) * 50.0) as u32 {
        let t_s = f64::from(i) * 0.02;
        if gap.contains(&t_s) {
            continue;
        }
        let phase = phases.iter().rfind(|(from_s, _)| t_s >= *from_s);
        let of_motor = |motor: usize| phase.map_or(0.0, |(_, shifts)| shifts[motor]);
        let noise = |motor: usize| 0.003 * (t_s * (motor as f64 + 1.0)).sin();
        let motors = (0..factors.len()).map(|motor| 0.55 + of_motor(motor) + noise(motor));
        let motors: Vec<f64> = motors.collect();
        let sample = Sample {
            t_s,
            motors: &motors,
            in_air: Some(t_s < to_s),
            signals: &[],
        };
        let update = assessor.push(&sample);
        assert_eq!(on_board.push(&sample), update);
        updates.push(update);
    }
    (assessor.finish(), updates)
}

/// The levels in a span of time.
fn levels(updates: &[Update], span_s: core::ops::Range<f64>) -> Vec<Option<Level>> {
    let within = updates.iter().filter(|u| span_s.contains(&u.t_s));
    within.map(|update| update.level).collect()
}

#[test]
fn a_weak_motor_is_the_one_above_its_trim_and_remains_reported() {
    let faults: [(&[Factors], &[f64], usize); 4] = [
        // A motor with 75 % of its thrust.
        (&QUAD, &[0.24, 0.0, 0.0, 0.0], 0),
        // A motor with 60 % of its thrust. The command of the healthy opposite motor is lowered.
        (&HEXA, &[0.07, 0.07, 0.24, -0.15, 0.07, 0.07], 2),
        // A motor that has stopped. The other motor of its arm is motor 8; the opposite motor is motor 6.
        (
            &OCTAQUAD,
            &[-0.02, 0.01, 0.32, 0.01, 0.15, -0.16, 0.15, 0.18],
            2,
        ),
        // A motor with 50 % of its thrust. The other motor of its arm is motor 1.
        (
            &OCTAQUAD,
            &[0.11, 0.1, -0.11, 0.1, 0.0, 0.21, 0.0, -0.01],
            5,
        ),
    ];
    for (factors, shifts, motor) in faults {
        // A fault upsets the vehicle for a moment.
        let upset: Vec<f64> = shifts.iter().map(|shift| 1.7 * shift).collect();
        let other: Vec<f64> = shifts.iter().map(|shift| -shift).collect();
        let phases: [Phase<'_>; 4] = [
            (40.0, &upset),
            (40.2, &other),
            (40.4, &upset),
            (40.6, shifts),
        ];
        let (flown, updates) = fly(factors, &phases, 0.0..0.0, 120.0);
        let mut found = flown.findings.iter();
        let found = found.find(|found| found.measure == Measure::WeakMotor);
        let found = found.unwrap_or_else(|| panic!("{shifts:?}: {:?}", flown.findings));
        let named = found.motor.unwrap();
        assert_eq!((named.number, named.or_number), (motor + 1, None));
        assert!(found.raised_s < 52.0 && found.to_s > 119.0, "{found:?}");
        let after = levels(&updates, found.raised_s..120.0);
        assert!(after.iter().all(|level| *level >= Some(Level::Warn)));
    }
}

#[test]
fn turning_and_leaning_are_not_reported_as_a_weak_motor() {
    let others: [(&[Factors], &[f64]); 4] = [
        // The vehicle turns.
        (&QUAD, &[0.2, 0.2, -0.2, -0.2]),
        // The vehicle leans towards a motor, and between two motors.
        (&QUAD, &[0.14, -0.14, 0.0, 0.0]),
        (&QUAD, &[0.13, -0.13, 0.13, -0.13]),
        (&HEXA, &[-0.07, 0.07, 0.14, -0.14, 0.07, -0.07]),
    ];
    for (factors, shifts) in others {
        // The commands change slowly, because a sudden change would be unsteady.
        let mut phases: Vec<(f64, Vec<f64>)> = vec![];
        for step in 1..=100 {
            let share = f64::from(step) / 100.0;
            let now = shifts.iter().map(|shift| share * shift).collect();
            phases.push((40.0 + 0.1 * f64::from(step), now));
        }
        let phases: Vec<Phase<'_>> = phases.iter().map(|(s, of)| (*s, &of[..])).collect();
        let (flown, _) = fly(factors, &phases, 0.0..0.0, 120.0);
        let mut found = flown.findings.iter();
        let found = found.find(|found| is_of_balance(found));
        assert_eq!(found, None, "{shifts:?}");
    }
}

/// The commands oscillate for two seconds; then they stay at new values until 80 s.
const SHAKEN: [&[f64]; 3] = [
    &[0.4, -0.4, 0.4, -0.4],
    &[-0.4, 0.4, -0.4, 0.4],
    &[0.1, -0.1, 0.0, 0.0],
];

#[test]
fn an_alarm_ends_when_the_motors_work_as_before() {
    let mut phases: Vec<Phase<'_>> = vec![];
    for half in 0..10 {
        let from_s = 40.0 + 0.2 * f64::from(half);
        phases.push((from_s, SHAKEN[(half % 2) as usize]));
    }
    phases.push((42.0, SHAKEN[2]));
    phases.push((80.0, &[0.0; 4]));
    let (flown, updates) = fly(&QUAD, &phases, 0.0..0.0, 120.0);
    assert!(!flown.findings.iter().any(|found| is_of_balance(found)));
    let stands = levels(&updates, 43.0..85.0);
    assert!(
        stands.iter().all(|level| *level >= Some(Level::Warn)),
        "{stands:?}"
    );
    assert_eq!(levels(&updates, 100.0..120.0), [Some(Level::Good); 1000]);
}

#[test]
fn a_gap_does_not_end_an_alarm() {
    let shifts = [0.24, 0.0, 0.0, 0.0];
    let (_, updates) = fly(&QUAD, &[(40.0, &shifts)], 55.0..61.0, 120.0);
    let after = levels(&updates, 60.0..120.0);
    assert_eq!(after[0], None);
    assert!(!after.contains(&Some(Level::Good)));
    assert!(after.iter().flatten().all(|level| *level >= Level::Warn));
    // The next flight starts without the state of the first.
    let (_, updates) = fly(&QUAD, &[], 0.0..0.0, 20.0);
    assert_eq!(
        updates.iter().filter_map(|update| update.level).max(),
        Some(Level::Good)
    );
}

/// A motor that PX4 stops: the allocator also sets the opposite one to 0, a moment later.
#[test]
fn a_motor_that_stopped_is_named_and_not_the_one_opposite() {
    let alone = [0.0, 0.0, -0.55, 0.0, 0.0, 0.0];
    let both = [0.2, 0.2, -0.55, -0.55, 0.2, 0.2];
    let phases: [Phase<'_>; 2] = [(40.0, &alone), (40.4, &both)];
    let (flown, _) = fly_clipped(&HEXA, &phases);
    let mut found = flown.findings.iter();
    let found = found
        .find(|found| found.measure == Measure::Imbalance)
        .unwrap();
    let motor = found.motor.unwrap();
    assert_eq!((motor.number, motor.or_number), (3, None));
    // If both stop at the same time, they cannot be distinguished.
    let (flown, _) = fly_clipped(&HEXA, &[(40.0, &both)]);
    let mut found = flown.findings.iter();
    let found = found
        .find(|found| found.measure == Measure::Imbalance)
        .unwrap();
    let motor = found.motor.unwrap();
    assert_eq!((motor.number, motor.or_number), (3, Some(4)));
}

/// Flies phases at 50 Hz for 80 s, like [`fly`], but without a landing, and without noise, so that the command of a
/// stopped motor is exactly 0.
fn fly_clipped(factors: &[Factors], phases: &[Phase<'_>]) -> (Assessment, Vec<Update>) {
    let estimator = shipped::flagred();
    let craft = Craft::new(factors.len()).with_geometry(factors);
    let mut assessor = Assessor::new(&estimator, craft, None).unwrap();
    let mut updates = vec![];
    for i in 0..4000 {
        let t_s = f64::from(i) * 0.02;
        let phase = phases.iter().rfind(|(from_s, _)| t_s >= *from_s);
        let of_motor = |motor: usize| phase.map_or(0.0, |(_, shifts)| shifts[motor]);
        let motors = (0..factors.len()).map(|motor| 0.55 + of_motor(motor));
        let motors: Vec<f64> = motors.collect();
        updates.push(assessor.push(&Sample {
            t_s,
            motors: &motors,
            in_air: Some(true),
            signals: &[],
        }));
    }
    (assessor.finish(), updates)
}

/// Pulses of a quadrotor in PX4's simulator in us, 25 per second, from the stop of its motor 2 on.
const FALL: [[u16; 4]; 48] = [
    [1436, 900, 1498, 1486],
    [1323, 900, 1489, 1506],
    [1224, 900, 1475, 1547],
    [1145, 900, 1517, 1536],
    [1000, 900, 1359, 1481],
    [1000, 900, 1286, 1469],
    [1000, 900, 1248, 1411],
    [1000, 900, 1216, 1336],
    [1000, 900, 1170, 1277],
    [1000, 900, 1123, 1277],
    [1000, 900, 1160, 1240],
    [1000, 900, 1168, 1232],
    [1000, 900, 1199, 1201],
    [1000, 900, 1183, 1217],
    [1000, 900, 1215, 1185],
    [1000, 900, 1184, 1216],
    [1000, 900, 1220, 1180],
    [1000, 900, 1203, 1197],
    [1000, 900, 1242, 1158],
    [1000, 900, 1215, 1185],
    [1000, 900, 1251, 1149],
    [1000, 900, 1271, 1129],
    [1000, 900, 1261, 1139],
    [1000, 900, 1288, 1112],
    [1000, 900, 1298, 1102],
    [1000, 900, 1330, 1070],
    [1000, 900, 1347, 1053],
    [1000, 900, 1380, 1020],
    [1000, 900, 1297, 1103],
    [1170, 900, 1370, 1200],
    [1000, 900, 1319, 1081],
    [1018, 900, 1269, 1149],
    [1127, 900, 1272, 1255],
    [1027, 900, 1230, 1197],
    [1098, 900, 1224, 1274],
    [1000, 900, 1192, 1208],
    [1000, 900, 1189, 1211],
    [1000, 900, 1132, 1268],
    [1133, 900, 1212, 1321],
    [1053, 900, 1165, 1288],
    [1059, 900, 1191, 1268],
    [1055, 900, 1154, 1300],
    [1167, 900, 1159, 1408],
    [1000, 900, 1139, 1261],
    [1010, 900, 1134, 1277],
    [1000, 900, 1112, 1288],
    [1000, 900, 1148, 1252],
    [1000, 900, 1115, 1285],
];

#[test]
fn a_fall_is_not_taken_for_a_landing() {
    let estimator = shipped::flagred();
    let craft = Craft::new(4).with_geometry(&QUAD);
    let mut assessor = Assessor::new(&estimator, craft, None).unwrap();
    let mut failed_s = None;
    for i in 0..1000 + FALL.len() {
        let t_s = i as f64 * 0.04;
        let noise = |motor: usize| (3.0 * (t_s * (motor as f64 + 1.0)).sin()) as i32;
        let motors: Vec<f64> = (0..4)
            .map(|motor| match i.checked_sub(1000) {
                Some(row) => i32::from(FALL[row][motor]),
                None => 1490 + noise(motor),
            })
            .map(|pulse| (f64::from(pulse - 1000) / 1000.0).clamp(0.0, 1.0))
            .collect();
        let update = assessor.push(&Sample {
            t_s,
            motors: &motors,
            in_air: Some(true),
            signals: &[],
        });
        if t_s > 40.0 {
            assert_ne!(update.risk, Err(Unknown::OnGround), "{t_s}");
            if update.level == Some(Level::Fail) {
                failed_s.get_or_insert(t_s - 40.0);
            }
        }
    }
    assert!(failed_s.is_some_and(|s| s < 1.8), "{failed_s:?}");
}

/// Landings with a weak motor, each with the time at which FAIL ends, in seconds of the vehicle's clock. The throttle
/// is closed later.
const LANDINGS: [(&str, f64); 4] = [
    ("motor_y6_m2_0.BIN.gz", 162.5),
    ("motor_hexa_m3_60.BIN.gz", 182.5),
    ("streams/motor_y6_m2_0.tlog.gz", 162.5),
    ("streams/w_motor_blackout.tlog.gz", 140.0),
];

#[test]
#[ignore = "needs FLAGRED_SHARED"]
fn a_touchdown_raises_no_fail() {
    for (name, from_s) in LANDINGS {
        let flight = follow(&reference_data().join("sitl5").join(name));
        let late = flight.levels.iter().filter(|(t_s, _)| *t_s >= from_s);
        let late: Vec<_> = late.map(|(_, level)| *level).collect();
        assert!(!late.is_empty(), "{name}");
        assert!(!late.contains(&Some(Level::Fail)), "{name}");
    }
}
