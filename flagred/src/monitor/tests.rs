use fuzzy::{
    Model,
    model::{MembershipFunction, NoRuleFires, Output, Variable},
    rule::{Condition, Rule},
};

use super::*;
use crate::{
    accumulator::AccumulatorSettings,
    board::{OwnedMemory, SetupError},
    gap::GapSettings,
    profile::{ProfileInput, Sampling},
    source::{Motors, Signal, Source, Statistic},
    verdict::{Finding, Level, Limit, VerdictSettings},
};

/// The risk falls from 100 % at a mean margin of 0 to 0 % at 0.5, by two rules; `without_low` omits the first.
fn rules(without_low: bool) -> Model {
    let margin = Variable::new("margin", 0.0, 0.5)
        .term(
            "low",
            MembershipFunction::LeftShoulder {
                top: 0.1,
                foot: 0.4,
            },
        )
        .term(
            "high",
            MembershipFunction::RightShoulder {
                foot: 0.1,
                top: 0.4,
            },
        );
    let risk = Variable::new("risk", 0.0, 100.0)
        .term(
            "small",
            MembershipFunction::Triangle {
                left: 0.0,
                peak: 10.0,
                right: 20.0,
            },
        )
        .term(
            "large",
            MembershipFunction::Triangle {
                left: 80.0,
                peak: 90.0,
                right: 100.0,
            },
        );
    let mut model = Model::builder("one input")
        .input(margin)
        .output(Output::new(risk))
        .rule(Rule::new(Condition::is("margin", "low"), "risk", "large"))
        .rule(Rule::new(Condition::is("margin", "high"), "risk", "small"))
        .build();
    if without_low {
        model.rules.remove(0);
    }
    model
}

fn profile() -> Profile {
    let source = |signal: &str| Source {
        statistic: Statistic::Mean,
        motors: Motors::Pooled,
        signal: Signal::named(signal),
        window_s: 2.0,
        exponential: false,
    };
    Profile {
        name: "test".into(),
        description: None,
        rules: "test".into(),
        window_s: 1.0,
        inputs: vec![ProfileInput {
            name: "margin".into(),
            source: source("motor_margin"),
            ratio: None,
            if_missing: None,
        }],
        output: "risk".into(),
        other_risks: Vec::new(),
        sampling: Sampling::default(),
        gap: GapSettings::default(),
        elevated_risk: AccumulatorSettings::default(),
        verdict: VerdictSettings::default(),
        findings: Vec::new(),
        reliability: Vec::new(),
        allow: Vec::new(),
    }
}

/// Simulates a flight at `rate_hz`; each phase is given as (seconds, command of both motors, in the air).
fn fly(monitor: &mut Monitor, rate_hz: f64, phases: &[(f64, f64, bool)]) -> Vec<Update> {
    let mut assessments = Vec::new();
    let mut i = 0.0;
    for (seconds, e, in_air) in phases {
        for _ in 0..(seconds * rate_hz) as usize {
            assessments.push(monitor.push(&Sample {
                t_s: i / rate_hz,
                motors: &[*e, *e],
                in_air: Some(*in_air),
                signals: &[],
            }));
            i += 1.0;
        }
    }
    assessments
}

fn risk_at(assessments: &[Update], t_s: f64) -> Result<f64, Unknown> {
    let at = assessments.iter().rfind(|a| a.t_s <= t_s + 1e-9).unwrap();
    at.risk.map(|estimate| estimate.risk_pct)
}

/// A ratio `x / max(per, at_least)` may divide by an input that the rules do not have. If that input is unknown, so is the ratio.
#[test]
fn a_ratio_divides_two_other_inputs() {
    let text = "flagred: 1
name: ratio
rules: test
window_s: 2
inputs:
  per: {last: battery_v}
  margin: {mean: motor_margin, per: per, at_least: 0.5}
";
    let profile: Profile = text.parse().unwrap();
    let estimator = Estimator::new(&profile, &rules(false)).unwrap();
    let craft = Craft::new(2).with_signals(&["battery_v"]);
    let plan = estimator.plan().unwrap();
    let mut memory = OwnedMemory::new(&plan, 2);
    for (per, expected) in [
        (2.0, Some(0.2 / 2.0)),
        (0.1, Some(0.2 / 0.5)),
        (0.0, Some(0.2 / 0.5)),
        (f64::NAN, None),
    ] {
        let mut monitor = Monitor::new(&estimator, craft).unwrap();
        let mut board = memory.monitor(&plan).unwrap();
        for i in 0..100 {
            let sample = Sample {
                t_s: f64::from(i) * 0.04,
                motors: &[0.2, 0.2],
                in_air: Some(true),
                signals: &[per],
            };
            let (update, on_board) = (monitor.push(&sample), board.push(&sample));
            assert_eq!(update, on_board);
        }
        let margin = Some(monitor.inputs()[1]).filter(|value| value.is_finite());
        assert_eq!(margin.is_some(), expected.is_some(), "{per}");
        let off = margin.zip(expected).map_or(0.0, |(a, b)| a - b);
        assert!(off.abs() < 1e-12, "{per}: {margin:?}");
    }
}

/// If a motor is unknown, so is a ratio that divides by its statistic, even if the window still has earlier values.
#[test]
fn a_ratio_by_motors_requires_motors() {
    let text = "flagred: 1
name: ratio
rules: test
inputs:
  margin: {last: battery_v, per: load, at_least: 0.5}
  load: {mean: motor_command}
";
    let profile: Profile = text.parse().unwrap();
    let estimator = Estimator::new(&profile, &rules(false)).unwrap();
    assert!(estimator.plan().unwrap().needs_motors());
    let craft = Craft::new(2).with_signals(&["battery_v"]);
    let mut monitor = Monitor::new(&estimator, craft).unwrap();
    for i in 0..100 {
        let lost = i == 99;
        let update = monitor.push(&Sample {
            t_s: f64::from(i) * 0.04,
            motors: &[0.5, if lost { f64::NAN } else { 0.5 }],
            in_air: Some(true),
            signals: &[0.1],
        });
        match lost {
            true => assert_eq!(update.risk, Err(Unknown::NoCommand { motor: 1 })),
            false => assert!(update.risk.is_ok() || i < 50, "{i}: {update:?}"),
        }
    }
}

#[test]
fn risk_follows_the_motors_within_the_window_and_is_unknown_on_the_ground() {
    let estimator = Estimator::new(&profile(), &rules(false)).unwrap();
    let mut monitor = Monitor::new(&estimator, Craft::new(2)).unwrap();
    let flight = fly(
        &mut monitor,
        25.0,
        &[
            (5.0, 0.0, false),
            (20.0, 0.5, true),
            (20.0, 1.0, true),
            (3.0, 0.0, false),
        ],
    );
    assert_eq!(risk_at(&flight, 4.0), Err(Unknown::OnGround));
    assert_eq!(risk_at(&flight, 5.2), Err(Unknown::WarmingUp { input: 0 }));
    approx::assert_abs_diff_eq!(risk_at(&flight, 10.0).unwrap(), 10.0, epsilon = 1e-9);
    approx::assert_abs_diff_eq!(risk_at(&flight, 26.0).unwrap(), 50.0, epsilon = 5.0);
    approx::assert_abs_diff_eq!(risk_at(&flight, 28.0).unwrap(), 90.0, epsilon = 1e-9);
    assert_eq!(risk_at(&flight, 46.0), Err(Unknown::OnGround));

    let changes: Vec<_> = flight
        .iter()
        .filter_map(|a| a.change.map(|level| (a.t_s, level)))
        .collect();
    // A landing is not reported as a change: on the ground the level is unknown.
    let [(warn_s, Level::Warn), (fail_s, Level::Fail)] = changes[..] else {
        panic!("{changes:?}");
    };
    assert!(25.0 < warn_s && warn_s < fail_s && fail_s < 33.0);
    let findings: Vec<Finding> = flight.iter().flat_map(|a| a.ended).flatten().collect();
    let levels: Vec<Level> = findings.iter().map(|f| f.severity).collect();
    assert_eq!(levels, [Level::Fail]);
    assert_eq!(findings[0].motor.map(|m| m.margin_mean), Some(0.0));
    assert_eq!(monitor.finish(), [None; 4]);
}

#[test]
fn inputs_are_unknown_on_the_ground_at_once() {
    let estimator = Estimator::new(&profile(), &rules(false)).unwrap();
    let mut monitor = Monitor::new(&estimator, Craft::new(2)).unwrap();
    fly(&mut monitor, 25.0, &[(5.0, 0.5, true)]);
    assert_eq!(monitor.inputs(), [0.5]);
    let mut touch = |t_s, in_air| {
        monitor.push(&Sample {
            t_s,
            motors: &[0.5; 2],
            in_air,
            signals: &[],
        });
        monitor.inputs()[0]
    };
    assert!(touch(5.0, Some(false)).is_nan());
    assert_eq!(touch(5.04, Some(true)), 0.5);
}

#[test]
fn the_first_seconds_in_the_air_raise_only_fail() {
    let estimator = Estimator::new(&profile(), &rules(false)).unwrap();
    for (e, level) in [(0.85, Level::Good), (1.0, Level::Fail)] {
        let mut monitor = Monitor::new(&estimator, Craft::new(2)).unwrap();
        let flight = fly(&mut monitor, 25.0, &[(1.0, 0.0, false), (4.0, e, true)]);
        let last = flight.last().unwrap();
        assert!(last.risk.unwrap().risk_pct > 67.0, "{e}");
        assert_eq!(last.level, Some(level));
    }
}

#[test]
fn a_filled_gap_is_reported_as_filled() {
    let estimator = Estimator::new(&profile(), &rules(true)).unwrap();
    let mut monitor = Monitor::new(&estimator, Craft::new(2)).unwrap();
    let flight = fly(&mut monitor, 25.0, &[(5.0, 0.5, true), (5.0, 1.0, true)]);
    let covered = flight[100].risk.unwrap();
    assert_eq!((covered.filled_from, covered.coverage), (None, 1.0));
    let filled = flight.last().unwrap().risk.unwrap();
    assert_eq!(filled.coverage, 0.0);
    // Half of the range is covered: the degree of the term `high` is 0.5 in the middle.
    approx::assert_abs_diff_eq!(filled.filled_from.unwrap(), 0.5, epsilon = 0.02);
    approx::assert_abs_diff_eq!(filled.risk_pct, 10.0, epsilon = 1e-9);
}

#[test]
fn no_rule_and_nothing_to_fill_from_is_unknown() {
    let mut model = rules(true);
    model.rules.truncate(1);
    model.rules[0].rule.weight = 0.0;
    let estimator = Estimator::new(&profile(), &model).unwrap();
    let mut monitor = Monitor::new(&estimator, Craft::new(2)).unwrap();
    let flight = fly(&mut monitor, 25.0, &[(3.0, 0.5, true)]);
    assert_eq!(risk_at(&flight, 3.0), Err(Unknown::NoRule));
}

#[test]
fn gaps_are_filled_even_if_the_model_treats_them_as_errors() {
    let mut model = rules(true);
    model.outputs[0].when_no_rule_fires = NoRuleFires::Error;
    let estimator = Estimator::new(&profile(), &model).unwrap();
    let mut monitor = Monitor::new(&estimator, Craft::new(2)).unwrap();
    let flight = fly(&mut monitor, 25.0, &[(3.0, 1.0, true)]);
    assert!(flight.last().unwrap().risk.unwrap().filled_from.is_some());
}

#[test]
fn too_few_samples_give_an_unknown_risk_with_help() {
    let estimator = Estimator::new(&profile(), &rules(false)).unwrap();
    let mut monitor = Monitor::new(&estimator, Craft::new(2)).unwrap();
    let flight = fly(&mut monitor, 1.0, &[(30.0, 0.5, true)]);
    let unknown = flight.last().unwrap().risk.unwrap_err();
    assert_eq!(
        unknown,
        Unknown::TooFewSamples {
            input: 0,
            samples: 2
        }
    );
    assert_eq!(
        unknown.explain(estimator.profile()),
        "input `margin` has 2 samples in 2 s and needs 5: log the motors at 2.5 Hz or more"
    );
}

#[test]
fn a_lost_link_or_a_restart_discards_old_samples() {
    let estimator = Estimator::new(&profile(), &rules(false)).unwrap();
    for jump_s in [60.0, -15.0] {
        let mut monitor = Monitor::new(&estimator, Craft::new(2)).unwrap();
        fly(&mut monitor, 25.0, &[(20.0, 1.0, true)]);
        let open = monitor.clone().finish();
        assert_eq!(open[0].map(|finding| finding.severity), Some(Level::Fail));
        let after = monitor.push(&Sample {
            t_s: 20.0 + jump_s,
            motors: &[0.5, 0.5],
            in_air: Some(true),
            signals: &[],
        });
        assert_eq!(after.ended, open);
        assert_eq!((after.change, after.level), (None, None));
        assert!(after.risk.is_err());
        assert_eq!(after.elevated_risk_pct, None);
    }
}

#[test]
fn repeated_late_and_damaged_samples_change_nothing() {
    let estimator = Estimator::new(&profile(), &rules(false)).unwrap();
    let mut clean = Monitor::new(&estimator, Craft::new(2)).unwrap();
    let mut dirty = clean.clone();
    for i in 0..500 {
        let t_s = f64::from(i) * 0.04;
        let push = |monitor: &mut Monitor, t_s: f64, e: f64| {
            monitor.push(&Sample {
                t_s,
                motors: &[e, 0.5],
                in_air: Some(true),
                signals: &[],
            })
        };
        let expected = push(&mut clean, t_s, 0.5);
        assert_eq!(push(&mut dirty, t_s, 0.5), expected);
        for bad_s in [t_s, t_s - 0.04, f64::NAN, f64::INFINITY] {
            let bad = push(&mut dirty, bad_s, 0.0);
            assert_eq!(bad.risk, Err(Unknown::OutOfOrder));
        }
    }
}

#[test]
fn an_unknown_motor_makes_the_risk_unknown_and_rounding_does_not() {
    let estimator = Estimator::new(&profile(), &rules(false)).unwrap();
    let follow = |command: f64| {
        let mut monitor = Monitor::new(&estimator, Craft::new(2)).unwrap();
        let mut push = |i: u32, motors: &[f64]| {
            monitor.push(&Sample {
                t_s: f64::from(i) * 0.04,
                motors,
                in_air: Some(true),
                signals: &[],
            })
        };
        for i in 0..100 {
            assert_eq!(push(i, &[0.5, 0.5]).risk.is_ok(), i >= 25, "{i}");
        }
        let updates: Vec<Update> = (100..200).map(|i| push(i, &[0.5, command])).collect();
        for i in 200..299 {
            push(i, &[0.5, 0.5]);
        }
        let again = push(299, &[0.5, 0.5]);
        assert!(again.risk.is_ok() && again.level.is_some(), "{again:?}");
        updates
    };
    for garbage in [
        f64::INFINITY,
        f64::NEG_INFINITY,
        65535.0,
        1500.0,
        50.0,
        -1.0,
    ] {
        let outside = Unknown::CommandOutside {
            motor: 1,
            command: garbage,
        };
        let updates = follow(garbage);
        assert!(updates.iter().all(|update| update.risk == Err(outside)));
        assert!(updates.iter().all(|update| update.level.is_none()));
    }
    let unknown = follow(f64::NAN);
    assert!(
        unknown
            .iter()
            .all(|update| update.risk == Err(Unknown::NoCommand { motor: 1 }))
    );
    assert_eq!(unknown[99].level, None);
    for (rounded, limit) in [(1.000_000_1, 1.0), (1.5, 1.0), (-0.1, 0.0)] {
        let of = |command| {
            follow(command)
                .iter()
                .map(|update| update.risk)
                .collect::<Vec<_>>()
        };
        assert_eq!(of(rounded), of(limit), "{rounded}");
        assert!(of(rounded).iter().all(Result::is_ok));
    }
    // A sample with fewer commands than motors.
    let mut monitor = Monitor::new(&estimator, Craft::new(2)).unwrap();
    let update = monitor.push(&Sample {
        t_s: 0.0,
        motors: &[0.5],
        in_air: Some(true),
        signals: &[],
    });
    assert_eq!(update.risk, Err(Unknown::NoCommand { motor: 1 }));
    let why = Unknown::CommandOutside {
        motor: 1,
        command: 1500.0,
    };
    assert_eq!(
        why.explain(&profile()),
        "the command of motor 2 is `1500`, but a command is a fraction from 0 to 1"
    );
}

#[test]
fn a_profile_that_reads_no_motor_requires_no_motor() {
    let mut profile = profile();
    profile.inputs[0].source.signal = Signal::named("battery_v");
    let estimator = Estimator::new(&profile, &rules(false)).unwrap();
    let plan = estimator.plan().unwrap();
    for (motors, in_air) in [(0, None), (0, Some(true)), (2, Some(true))] {
        let craft = Craft::new(motors).with_signals(&["battery_v"]);
        let mut monitor = Monitor::new(&estimator, craft).unwrap();
        let mut memory = OwnedMemory::new(&plan, motors);
        let mut on_board = memory.monitor(&plan).unwrap();
        let unknown = vec![f64::NAN; motors];
        let mut last = None;
        for i in 0..100 {
            let sample = Sample {
                t_s: f64::from(i) * 0.04,
                motors: &unknown,
                in_air,
                signals: &[0.05],
            };
            let update = monitor.push(&sample);
            assert_eq!(on_board.push(&sample), update);
            last = Some(update);
        }
        let last = last.unwrap();
        assert!(last.risk.is_ok() && last.level.is_some(), "{last:?}");
        assert!(monitor.margin().is_none() && monitor.spread().is_none());
    }
    // A vehicle on the ground has no risk.
    let craft = Craft::new(0).with_signals(&["battery_v"]);
    let mut monitor = Monitor::new(&estimator, craft).unwrap();
    let update = monitor.push(&Sample {
        t_s: 0.0,
        motors: &[],
        in_air: Some(false),
        signals: &[0.05],
    });
    assert_eq!(update.risk, Err(Unknown::OnGround));
    // Findings that are not about the risk also read the motors.
    profile.verdict.notices.reserve = Some(Limit {
        value: 0.1,
        after_s: 1.0,
    });
    let estimator = Estimator::new(&profile, &rules(false)).unwrap();
    assert_eq!(
        Monitor::new(&estimator, craft).unwrap_err(),
        MonitorError::NoMotors
    );
    let plan = estimator.plan().unwrap();
    let refused = OwnedMemory::new(&plan, 0).monitor(&plan).map(|_| ());
    assert_eq!(refused, Err(SetupError::NoMotors));
}

#[test]
fn missing_signals_are_reported_when_the_monitor_is_created() {
    let mut profile = profile();
    profile.inputs[0].source.signal = Signal::named("battery_v");
    let estimator = Estimator::new(&profile, &rules(false)).unwrap();
    assert_eq!(
        Monitor::new(&estimator, Craft::new(4).with_signals(&["wind_m_s"])).unwrap_err(),
        MonitorError::NoSignal {
            signal: "battery_v".into()
        }
    );
    let of_motors = Estimator::new(&self::profile(), &rules(false)).unwrap();
    assert_eq!(
        Monitor::new(&of_motors, Craft::new(0)).unwrap_err(),
        MonitorError::NoMotors
    );
    assert!(
        Monitor::new(
            &estimator,
            Craft::new(4).with_signals(&["wind_m_s", "battery_v"])
        )
        .is_ok()
    );
}

#[test]
fn a_motor_that_the_vehicle_lacks_is_reported_when_the_monitor_is_created() {
    let mut profile = profile();
    profile.inputs[0].source.motors = Motors::One(4);
    let estimator = Estimator::new(&profile, &rules(false)).unwrap();
    let refused = Monitor::new(&estimator, Craft::new(4)).unwrap_err();
    assert_eq!(
        refused.to_string(),
        "the profile needs motor 5, but the flight has only 4 motors"
    );
    assert!(Monitor::new(&estimator, Craft::new(5)).is_ok());

    let plan = estimator.plan().unwrap();
    let on_board = |motors| {
        let mut memory = OwnedMemory::new(&plan, motors);
        memory.monitor(&plan).map(|_| ())
    };
    assert_eq!(on_board(4), Err(SetupError::NoMotors));
    assert_eq!(on_board(5), Ok(()));
}

#[test]
fn a_missing_signal_has_its_default_until_it_first_arrives() {
    let mut profile = profile();
    profile.inputs[0].source.signal = Signal::named("battery_v");
    profile.inputs[0].source.statistic = Statistic::Last;
    profile.inputs[0].if_missing = Some(0.4);
    let estimator = Estimator::new(&profile, &rules(false)).unwrap();
    let plan = estimator.plan().unwrap();
    let names = ["battery_v"];
    let known = Craft::new(2).with_signals(&names);
    // A case contains a craft, the signal in 2 samples on the ground and 4 in the air, whether the input is assumed
    // after each sample, and the value of the input after each sample.
    let nan = f64::NAN;
    type Case<'a> = (Craft<'a>, [f64; 6], [bool; 6], [f64; 6]);
    let cases: [Case<'_>; 4] = [
        (
            Craft::new(2),
            [nan; 6],
            [true; 6],
            [nan, nan, 0.4, 0.4, 0.4, 0.4],
        ),
        (known, [nan; 6], [false; 6], [nan; 6]),
        (
            known.with_optional(&names),
            [nan, nan, nan, 0.1, nan, 0.2],
            [true, true, true, false, false, false],
            [nan, nan, 0.4, 0.1, nan, 0.2],
        ),
        // A sensor that was present on the ground is lost.
        (
            known.with_optional(&names),
            [nan, 0.1, nan, nan, nan, nan],
            [true, false, false, false, false, false],
            [nan; 6],
        ),
    ];
    for (craft, values, assumed, inputs) in cases {
        let mut monitor = Monitor::new(&estimator, craft).unwrap();
        let mut memory = OwnedMemory::new(&plan, 2);
        let mut on_board = memory.monitor(&plan).unwrap();
        for (i, value) in values.into_iter().enumerate() {
            let sample = Sample {
                t_s: i as f64 * 0.1,
                motors: &[0.5; 2],
                in_air: Some(i > 1),
                signals: &[value],
            };
            let update = monitor.push(&sample);
            assert_eq!(monitor.assumed().count() == 1, assumed[i], "{i}");
            let input = monitor.inputs()[0];
            assert_eq!(input.to_bits(), inputs[i].to_bits(), "{i}: {input}");
            assert_eq!(update.risk.is_ok(), input.is_finite(), "{i}");
            let reported = on_board.push(&sample);
            if craft != known {
                assert_eq!(reported, update);
            }
        }
    }
}
