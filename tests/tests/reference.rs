//! The shipped profile compared with a second implementation of the definitions in the documents:
//! `flagred_tests::reference`.

use std::f64::consts::TAU;

use flagred::{
    estimator::Estimator,
    flight::{Assessment, Assessor},
    monitor::{Craft, Factors},
    sample, shipped,
    verdict::{Level, Measure},
};
use flagred_flightlog::{Basis, Flight};
use flagred_tests::{
    STEADY,
    reference::{
        balance::BalanceFinding,
        flight::{ReferenceResults, Sample, follow, samples},
        levels::RaisedEpisode,
    },
    reference_data,
};

/// Tolerance for rounding: the sums are computed in another order.
const ROUNDING: f64 = 1e-9;

#[test]
fn the_shipped_flight_agrees_with_the_documents() {
    let episodes = compare_log(&open(STEADY));
    assert_eq!(episodes, []);
}

/// Eight motors at eight angles.
fn octa() -> Vec<Factors> {
    let motors = (0..8).map(|i| {
        let angle = TAU * (f64::from(i) + 0.5) / 8.0;
        [
            -angle.sin(),
            angle.cos(),
            if i % 2 == 0 { 1.0 } else { -1.0 },
        ]
    });
    motors.collect()
}

/// A flight of eight motors with every event that resets or interrupts something.
fn eventful(rate_hz: f64, length_s: f64, late_s: f64) -> Vec<Sample> {
    let mut random = fastrand::Rng::with_seed(7);
    let count = (length_s * rate_hz) as u32;
    let mut samples = Vec::new();
    for i in 0..count {
        let t_s = 20.0 + (f64::from(i) + 0.3 * random.f64()) / rate_hz;
        let during = |from_s: f64, to_s: f64| (from_s..to_s).contains(&(t_s - 20.0));
        // Lost samples: a short gap and a long one.
        if during(40.0, 41.0) || during(75.0, 78.0) {
            continue;
        }
        // The vehicle is shaken for some time in flight, just before a landing, and just after a take-off.
        let is_shaken = during(12.0, 18.0) || during(85.0 - late_s, 85.0) || during(89.0, 92.0);
        let shaken = if is_shaken { 0.32 } else { 0.004 };
        let mut commands = Vec::new();
        for motor in 0..8 {
            let phase = f64::from(motor) * 0.4;
            let sway = (TAU * 0.7 * t_s + phase).sin() + 0.5 * (TAU * 1.9 * t_s - phase).cos();
            let turn = if motor % 2 == 0 { 0.05 } else { -0.05 } * (TAU * 0.1 * t_s).sin();
            let noise = 0.01 * (random.f64() - 0.5);
            let full = during(30.0, 31.0) && motor < 4;
            let level = if full {
                1.2
            } else {
                0.5 + shaken * sway + turn + noise
            };
            let unknown = during(22.0, 23.0) && motor == 3 || during(50.0, 50.4);
            commands.push(if unknown {
                f64::NAN
            } else {
                level.clamp(0.0, 1.0)
            });
        }
        // Idling on the ground, in flight, and after a high risk.
        if during(0.0, 3.0) || during(31.2, 33.0) || during(92.0, 95.0) {
            commands = vec![0.05; 8];
        }
        // A land detector that flickers, and two landings.
        let in_air =
            !(during(0.0, 1.0) || during(25.0, 25.6) || during(85.0, 88.0) || during(96.0, 97.3));
        samples.push(Sample {
            t_s,
            commands,
            signals: vec![],
            in_air,
        });
    }
    samples
}

#[test]
fn an_eventful_flight_agrees_with_the_documents() {
    let text = include_str!("../../rules/profiles/multirotor.yaml");
    let with_noise = text.replace("std_less_noise", "std");
    // `late_s` is how long the vehicle is shaken before it lands. It affects the number of findings, because a landing
    // cancels a late WARN.
    for (text, rate_hz, length_s, late_s, factors, findings) in [
        (text, 3.0, 100.0, 1.1, octa(), 3),
        (text, 10.0, 100.0, 0.45, octa(), 2),
        (text, 10.0, 100.0, 1.1, octa(), 3),
        (text, 10.0, 100.0, 2.8, octa(), 3),
        (text, 10.0, 100.0, 1.1, vec![], 3),
        (&with_noise, 10.0, 100.0, 1.1, octa(), 3),
        (text, 60.0, 100.0, 1.1, octa(), 3),
        (text, 400.0, 24.0, 1.1, octa(), 1),
    ] {
        let samples = eventful(rate_hz, length_s, late_s);
        let profile = text.parse().unwrap();
        let estimator = Estimator::new(&profile, shipped::flagred().model()).unwrap();
        let craft = Craft::new(8).with_geometry(&factors);
        let mut assessor = Assessor::new(&estimator, craft, Some(0.0)).unwrap();
        push_all(&mut assessor, &samples);
        let episodes = compare(&estimator, &assessor.finish(), &samples, &factors);
        assert_eq!(episodes.len(), findings, "{rate_hz} Hz: {episodes:?}");
    }
}

/// The motors drop from a calm hover to 3 % in the air.
#[test]
fn a_fall_agrees_with_the_documents() {
    let text = include_str!("../../rules/profiles/multirotor.yaml");
    let samples: Vec<Sample> = (0..1300)
        .map(|i| {
            let t_s = f64::from(i) / 25.0;
            let hover = 0.5 + 0.01 * (t_s * 7.0).sin();
            Sample {
                t_s,
                commands: vec![
                    if (40.0..48.0).contains(&t_s) {
                        0.03
                    } else {
                        hover
                    };
                    8
                ],
                signals: vec![],
                in_air: (2.0..46.0).contains(&t_s),
            }
        })
        .collect();
    let estimator = Estimator::new(&text.parse().unwrap(), shipped::flagred().model()).unwrap();
    let craft = Craft::new(8);
    let mut assessor = Assessor::new(&estimator, craft, Some(0.0)).unwrap();
    push_all(&mut assessor, &samples);
    let assessment = assessor.finish();
    assert_eq!(assessment.verdict.to_string(), "FAIL");
    assert_eq!(compare(&estimator, &assessment, &samples, &[]).len(), 1);
}

fn push_all(assessor: &mut Assessor, samples: &[Sample]) {
    for sample in samples {
        assessor.push(&sample::Sample {
            t_s: sample.t_s,
            motors: &sample.commands,
            in_air: Some(sample.in_air),
            signals: &sample.signals,
        });
    }
}

/// The sources of the inputs: the upper end of each input's range in the rule set, and its
/// statistic of a signal.
const SOURCES: [(f64, &str); 22] = [
    (0.5, "{mean: {motor: 3, of: motor_margin}}"),
    (0.2, "{std: {motor: 8, of: motor_command_less_yaw}}"),
    (1.0, "{mean: {min: motor_command}}"),
    (0.1, "{noise: {std: motor_command}}"),
    (180.0, "{mean: {difference: [yaw_des_deg, yaw_deg]}}"),
    (
        180.0,
        "{rms: {difference: [yaw_des_deg, yaw_deg]}, window_s: 6}",
    ),
    (
        1.0,
        "{share_above: 5, of: {difference: [yaw_des_deg, yaw_deg]}}",
    ),
    (5.0, "{max: {difference: [battery_v, cells_v]}}"),
    (20.0, "{min: battery_v, window_s: 5}"),
    (20.0, "{last: battery_v}"),
    (
        2.0,
        "{mean: {ratio: [battery_v, cells_v], unknown_below: 14.05}, window_s: 4}",
    ),
    (300.0, "{std: {product: [battery_v, cells_v]}}"),
    (2.0, "{rate: battery_v, window_s: 9}"),
    (1.0, "{rate: {mean: motor_command}}"),
    (
        90.0,
        "{rate: {difference: [yaw_des_deg, yaw_deg]}, window_s: 1.5}",
    ),
    (1.0, "{median: {max: motor_command}, window_s: 7}"),
    (
        180.0,
        "{percentile: 90, of: {difference: [yaw_des_deg, yaw_deg]}, window_s: 12}",
    ),
    (1.0, "{percentile: 2.5, of: {motor: 1, of: motor_command}}"),
    (
        0.2,
        "{mean: {std: motor_command_less_yaw}, time_constant_s: 4}",
    ),
    (0.4, "{std: motor_command, time_constant_s: 6}"),
    (
        180.0,
        "{rms: {difference: [yaw_des_deg, yaw_deg]}, time_constant_s: 1.5}",
    ),
    (
        1.0,
        "{share_below: 0.45, of: motor_margin, time_constant_s: 30}",
    ),
];

/// A profile that contains each of these sources, and a rule set that uses all of them.
fn of_sources() -> Estimator {
    let (mut inputs, mut sources, mut rules) = (String::new(), String::new(), String::new());
    for (i, (end, source)) in SOURCES.iter().enumerate() {
        inputs += &format!("  x{i}: {{range: [-{end}, {end}], partition: [low, high]}}\n");
        sources += &format!("  x{i}: {source}\n");
        rules += &format!(
            "  - IF x{i} IS low THEN risk IS low\n  - IF x{i} IS high THEN risk IS high\n"
        );
    }
    let rules = format!(
        "fuzzy: 1\nname: sources\ninputs:\n{inputs}outputs:\n  risk: {{range: [0, 100], terms: \
         {{low: {{triangle: [20, 25, 30]}}, high: {{triangle: [70, 75, 80]}}}}}}\n\
         operators: {{and: product, or: maximum, implication: product, aggregation: sum}}\nrules:\n{rules}"
    );
    let profile = format!(
        "flagred: 1\nname: sources\nrules: sources\ntake_off_s: 3\ninputs:\n{sources}\
         verdict: {{warn: {{risk: 60}}, fail: {{risk: 70}}}}\n"
    );
    let model = fuzzy::yaml::parse(&rules).unwrap().model;
    Estimator::new(&profile.parse().unwrap(), &model).unwrap()
}

#[test]
fn every_statistic_of_every_source_agrees_with_the_documents() {
    let estimator = of_sources();
    let names = estimator.profile().signals();
    assert_eq!(names, ["yaw_des_deg", "yaw_deg", "battery_v", "cells_v"]);
    for (rate_hz, length_s) in [(5.0, 80.0), (12.0, 60.0), (150.0, 14.0)] {
        let mut samples = eventful(rate_hz, length_s, 1.1);
        for sample in &mut samples {
            let t_s = sample.t_s;
            let wanted_deg = 200.0 * (0.4 * t_s).sin();
            let is_at = (wanted_deg - 9.0 * (1.3 * t_s).cos() + 360.0) % 360.0;
            let battery_v = 16.0 - 0.02 * t_s + 0.3 * (0.9 * t_s).sin();
            // The voltage is unknown for some time.
            let is_lost = (46.0..46.9).contains(&t_s);
            let battery_v = if is_lost { f64::NAN } else { battery_v };
            sample.signals = vec![wanted_deg, is_at, battery_v, 15.0 - 0.01 * t_s];
        }
        let factors = octa();
        let craft = Craft::new(8).with_geometry(&factors).with_signals(&names);
        let mut assessor = Assessor::new(&estimator, craft, Some(0.0)).unwrap();
        push_all(&mut assessor, &samples);
        compare(&estimator, &assessor.finish(), &samples, &factors);
    }
}

/// Flights at 4 to 50 Hz with 4, 6 and 8 motors, with their expected level.
const FLIGHTS: [(&str, usize, Option<Level>); 12] = [
    ("real/flights/dronekit_test_01.csv.gz", 4, Some(Level::Fail)),
    ("real/flights/crash_quad_05.csv.gz", 4, Some(Level::Fail)),
    ("real/flights/erle_pxf_b_05.csv.gz", 4, Some(Level::Fail)),
    ("real/flights/px_3dr_hexa_01.csv.gz", 6, None),
    ("real/flights/rrc_quad_09.csv.gz", 4, None),
    ("real/flights/slung_load_02.csv.gz", 4, Some(Level::Fail)),
    ("sitl2/timeseries/f000.csv.gz", 8, None),
    ("sitl2/timeseries/f030.csv.gz", 4, Some(Level::Warn)),
    ("sitl2/timeseries/f280.csv.gz", 8, None),
    ("sitl3/timeseries/n007.csv.gz", 8, None),
    ("sitl3/timeseries/n042.csv.gz", 6, None),
    ("sitl3/timeseries/n309.csv.gz", 4, Some(Level::Fail)),
];

#[test]
#[ignore = "needs FLAGRED_SHARED"]
fn flights_agree_with_the_documents() {
    let mut inferred = 0;
    for (name, motors, worst) in FLIGHTS {
        let flight = open(reference_data().join(name));
        assert_eq!(flight.motors.len(), motors, "{name}");
        let is_inferred = flight.geometry.as_ref().map(|g| g.basis) == Some(Basis::Inferred);
        inferred += u32::from(is_inferred && motors == 8);
        let episodes = compare_log(&flight);
        let found = episodes.iter().map(|episode| episode.level).max();
        assert_eq!(found, worst, "{name}");
    }
    assert!(
        inferred > 0,
        "no vehicle with 8 motors of inferred geometry"
    );
}

fn open(path: impl AsRef<std::path::Path>) -> Flight {
    flagred_flightlog::open(path, &flagred_flightlog::Options::default()).unwrap()
}

/// Compares the assessment of a log with the reference; returns the findings of the reference.
fn compare_log(flight: &Flight) -> Vec<RaisedEpisode> {
    let estimator = shipped::flagred();
    let assessment = flagred::log::assess(flight, &estimator, Some(0.0));
    let factors = flight
        .geometry
        .as_ref()
        .map_or(&[][..], |geometry| &geometry.factors);
    compare(&estimator, &assessment, &samples(flight), factors)
}

fn compare(
    estimator: &Estimator,
    assessment: &Assessment,
    samples: &[Sample],
    factors: &[Factors],
) -> Vec<RaisedEpisode> {
    let ReferenceResults {
        rows,
        episodes,
        unbalanced,
    } = follow(samples, factors, estimator.profile(), estimator.model());
    assert_eq!(assessment.steps.len(), rows.len());
    let mut known = 0;
    for (step, row) in assessment.steps.iter().zip(&rows) {
        let t_s = row.t_s;
        assert_eq!(step.t_s, t_s);
        let agree = |name: &str, value: Option<f64>, expected: Option<f64>| match (value, expected)
        {
            (Some(value), Some(expected)) => {
                let off = (value - expected).abs();
                assert!(
                    off <= ROUNDING * expected.abs().max(1.0),
                    "{name} at {t_s} s: {value}, not {expected}"
                );
            }
            _ => assert_eq!(value, expected, "{name} at {t_s} s"),
        };
        for ((name, value), expected) in assessment.inputs.iter().zip(&step.inputs).zip(&row.inputs)
        {
            agree(
                name,
                Some(*value).filter(|value| value.is_finite()),
                *expected,
            );
        }
        agree(
            "risk",
            step.estimate.map(|estimate| estimate.risk_pct),
            row.risk,
        );
        agree("elevated risk", step.elevated_risk_pct, row.elevated);
        known += usize::from(row.risk.is_some());
    }
    assert!(
        known * 10 > rows.len() * 7,
        "only {known} of {} risks are known",
        rows.len()
    );
    assert_eq!(found(assessment), episodes);
    assert_eq!(of_balance(assessment), unbalanced);
    episodes
}

/// The findings of the balance, in order of time.
fn of_balance(assessment: &Assessment) -> Vec<BalanceFinding> {
    let of_balance = assessment.findings.iter().filter(|found| {
        matches!(
            found.measure,
            Measure::Imbalance | Measure::PairImbalance | Measure::WeakMotor
        )
    });
    let mut all: Vec<BalanceFinding> = of_balance
        .map(|found| BalanceFinding {
            measure: found.measure,
            raised_s: found.raised_s,
            motor: found
                .motor
                .map(|motor| (motor.number - 1, motor.or_number.map(|number| number - 1)))
                .unwrap(),
        })
        .collect();
    all.sort_by(|a, b| a.raised_s.total_cmp(&b.raised_s));
    all
}

/// The findings of the risk, in order of time.
fn found(assessment: &Assessment) -> Vec<RaisedEpisode> {
    let of_risk = assessment.findings.iter().filter(|found| {
        matches!(
            found.measure,
            Measure::Risk | Measure::ElevatedRisk | Measure::IdleInAir
        )
    });
    let mut all: Vec<RaisedEpisode> = of_risk
        .map(|found| RaisedEpisode {
            level: found.severity,
            from_s: found.from_s,
            raised_s: found.raised_s,
            failed_s: found.failed_s,
            to_s: found.to_s,
        })
        .collect();
    all.sort_by(|a, b| a.from_s.total_cmp(&b.from_s));
    all
}
