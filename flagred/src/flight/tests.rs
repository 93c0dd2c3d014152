use super::*;
use crate::{
    shipped,
    verdict::{Level, Measure},
};

mod loss;
mod state;
mod uncertainty;
mod words;

/// Simulates a flight at 50 Hz. Each phase consists of its duration in seconds, whether the vehicle is in the air, and
/// the motor commands.
fn fly(phases: &[(f64, bool, [f64; 4])]) -> Assessment {
    let estimator = shipped::flagred_paper();
    let mut assessor = Assessor::new(&estimator, Craft::new(4), Some(0.1)).unwrap();
    let mut i = 0;
    for (seconds, in_air, motors) in phases {
        for _ in 0..(seconds * 50.0) as usize {
            assessor.push(&Sample {
                t_s: f64::from(i) * 0.02,
                motors,
                in_air: Some(*in_air),
                signals: &[],
            });
            i += 1;
        }
    }
    assessor.finish()
}

const HOVER: [f64; 4] = [0.5; 4];
const LIMIT: [f64; 4] = [0.0, 1.0, 0.0, 1.0];

#[test]
fn time_on_the_ground_is_not_in_the_air() {
    let flown = fly(&[
        (10.0, true, HOVER),
        (400.0, false, [0.0; 4]),
        (10.0, true, HOVER),
        (1.0, false, [0.0; 4]),
    ]);
    assert!((flown.summary.in_air_s - 20.0).abs() < 0.1);
    assert_eq!(flown.verdict, Verdict::Known(Level::Good));
}

#[test]
fn risk_just_after_take_off_and_just_before_landing_is_not_assessed() {
    let flown = fly(&[
        (2.0, true, LIMIT),
        (20.0, true, HOVER),
        (0.9, true, LIMIT),
        (1.0, false, [0.0; 4]),
    ]);
    let peak = flown.summary.risk_max.unwrap();
    assert!(peak.value_pct < 30.0, "{peak:?}");
    let last = flown.steps.last().unwrap();
    assert!(!last.judged && last.estimate.unwrap().risk_pct > peak.value_pct);
    assert!(!flown.steps[0].judged && flown.steps[100].judged);
    // Without a landing, the same last seconds are judged.
    let cut = fly(&[(20.0, true, HOVER), (3.0, true, LIMIT)]);
    assert!(cut.summary.risk_max.unwrap().value_pct > 60.0);
    assert_eq!(cut.verdict, Verdict::Known(Level::Fail));
    assert!(
        cut.findings
            .is_sorted_by(|a, b| (b.severity, a.from_s) <= (a.severity, b.from_s))
    );
}

#[test]
fn a_flight_of_unknown_motors_has_no_verdict() {
    let flown = fly(&[(20.0, true, [f64::NAN; 4])]);
    let Verdict::NotAvailable(reason) = flown.verdict else {
        panic!("{:?}", flown.verdict)
    };
    assert_eq!(
        reason.to_string(),
        "the command of motor 1 is unknown in the air from 0.0 to 20.0 s"
    );
    let never = fly(&[(20.0, false, HOVER)]);
    assert_eq!(never.verdict, Verdict::NotAvailable(Reason::NoSamples));
}

#[test]
fn a_flight_with_too_little_known_risk_has_no_verdict() {
    let mut assessor = Assessor::new(&shipped::flagred(), Craft::new(4), None).unwrap();
    for i in 0..1000 {
        let t_s = f64::from(i) * 0.02;
        assessor.push(&Sample {
            t_s,
            motors: &HOVER,
            in_air: Some(true),
            signals: &[],
        });
    }
    assessor.set_in_air_s(100.0);
    let flown = assessor.finish();
    assert!(matches!(
        flown.verdict,
        Verdict::NotAvailable(Reason::RiskUnknown { .. })
    ));
    assert_eq!(flown.summary.in_air_s, 100.0);
    assert!(flown.steps.is_empty());
}

#[test]
fn a_second_flight_starts_without_the_state_of_the_first() {
    let mut assessor = Assessor::new(&shipped::flagred(), Craft::new(4), None).unwrap();
    let mut fly = |from_s: f64, motors: [f64; 4]| {
        for i in 0..1000 {
            let t_s = from_s + f64::from(i) * 0.02;
            assessor.push(&Sample {
                t_s,
                motors: &motors,
                in_air: Some(true),
                signals: &[],
            });
        }
        assessor.finish()
    };
    assert_eq!(fly(0.0, LIMIT).verdict, Verdict::Known(Level::Fail));
    assert_eq!(fly(30.0, HOVER).verdict, Verdict::Known(Level::Good));
}

/// Tests the paper's rules with two sources of their first input: the margin of the motors, and another signal, whose low
/// values do not mean that a motor is at its limit.
#[test]
fn a_motor_is_named_only_where_motors_near_a_limit_are_the_cause() {
    let paper = shipped::flagred_paper();
    let mut profile = paper.profile().clone();
    for (signal, names_motor) in [("motor_margin", true), ("slack", false)] {
        profile.inputs[0].source.signal = crate::source::Signal::named(signal);
        let estimator = Estimator::new(&profile, paper.model()).unwrap();
        let craft = Craft::new(4).with_signals(&["slack"]);
        let mut assessor = Assessor::new(&estimator, craft, None).unwrap();
        for i in 0..1150 {
            let (motors, slack) = if i < 1000 { (HOVER, 0.5) } else { (LIMIT, 0.0) };
            assessor.push(&Sample {
                t_s: f64::from(i) * 0.02,
                motors: &motors,
                in_air: Some(true),
                signals: &[slack],
            });
        }
        let open = assessor.open_finding().unwrap();
        assert_eq!(open.motor.is_some(), names_motor);
        let cause = open.cause.clone().unwrap();
        assert_eq!(
            (cause.input.as_str(), cause.term.as_str()),
            ("margin", "very_low")
        );
        assert_eq!(assessor.ended(), []);
        assert_eq!(assessor.end_findings().len(), 1);
        let findings = assessor.finish().findings;
        assert_eq!(findings.len(), 1);
        assert_eq!(findings[0].cause, open.cause);
    }
}

/// An octaquad in an X: motors 2 and 4 are opposite and turn the same way.
const OCTAQUAD: [crate::monitor::Factors; 8] = [
    [-1.0, 1.0, 1.0],
    [1.0, 1.0, -1.0],
    [1.0, -1.0, 1.0],
    [-1.0, -1.0, -1.0],
    [1.0, 1.0, 1.0],
    [-1.0, 1.0, -1.0],
    [-1.0, -1.0, 1.0],
    [1.0, -1.0, -1.0],
];

/// Flies an octaquad for two minutes with one motor dead after `from_s`: motor 2 is at 0.86, the opposite one at 0.39.
/// The on-board monitor must give the same updates. Returns the assessment, and the levels from 30 s after the fault
/// on.
fn with_a_dead_motor(from_s: f64) -> (super::Assessment, Vec<Level>) {
    let estimator = shipped::flagred();
    let craft = Craft::new(8).with_geometry(&OCTAQUAD);
    let mut assessor = Assessor::new(&estimator, craft, None).unwrap();
    let plan = estimator.plan().unwrap();
    let mut memory = crate::board::OwnedMemory::new(&plan, 8);
    let mut on_board = memory.monitor(&plan).unwrap();
    on_board.set_geometry(&OCTAQUAD).unwrap();
    let (mut levels, mut ended) = (Vec::new(), Vec::new());
    for i in 0..6100 {
        let t_s = f64::from(i) * 0.02;
        let mut motors = [0.6; 8];
        if t_s >= from_s {
            (motors[1], motors[3]) = (0.86, 0.39);
        }
        for (motor, n) in motors.iter_mut().zip(1..) {
            *motor += 0.003 * (t_s * f64::from(n)).sin();
        }
        let sample = Sample {
            t_s,
            motors: &motors,
            in_air: Some(i < 6000),
            signals: &[],
        };
        let update = assessor.push(&sample);
        assert_eq!(on_board.push(&sample), update);
        ended.extend(update.ended.into_iter().flatten());
        if !sample.is_on_ground() && t_s >= from_s + 30.0 {
            levels.extend(update.level);
        }
    }
    let flown = assessor.finish();
    let of = |measure| flown.findings.iter().find(|f| f.measure == measure);
    for measure in [Measure::WeakMotor, Measure::PairImbalance] {
        let found = ended.iter().find(|f| f.measure == measure);
        assert_eq!(found, of(measure).map(|finding| &finding.found));
    }
    (flown, levels)
}

#[test]
fn a_lasting_fault_stays_a_finding_until_landing() {
    for (from_s, measure) in [(60.0, Measure::WeakMotor), (8.0, Measure::PairImbalance)] {
        let (flown, levels) = with_a_dead_motor(from_s);
        assert!(levels.len() > 1000 && levels.iter().all(|level| *level >= Level::Warn));
        let mut found = flown.findings.iter();
        let found = found.find(|finding| finding.measure == measure).unwrap();
        let motor = found.motor.unwrap();
        assert_eq!((motor.number, motor.side), (2, crate::margin::Side::Upper));
        assert!(found.raised_s < from_s + 15.0, "{found:?}");
        assert!(found.to_s > 119.0, "{found:?}");
        assert_eq!(found.severity, Level::Warn);
    }
    // Without the fault, nothing is reported.
    let (flown, levels) = with_a_dead_motor(1e9);
    assert_eq!((flown.findings, levels), (vec![], vec![]));
}

#[test]
fn a_flight_with_only_information_is_good() {
    let mut profile = shipped::flagred_paper().profile().clone();
    profile.verdict.notices.noise = Some(crate::verdict::Limit {
        value: 0.04,
        after_s: 3.0,
    });
    let paper = shipped::flagred_paper();
    let estimator = Estimator::new(&profile, paper.model()).unwrap();
    let mut assessor = Assessor::new(&estimator, Craft::new(4), None).unwrap();
    for i in 0..300 {
        let e = if i % 2 == 0 { 0.45 } else { 0.55 };
        assessor.push(&Sample {
            t_s: f64::from(i) * 0.1,
            motors: &[e; 4],
            in_air: Some(true),
            signals: &[],
        });
    }
    let flown = assessor.finish();
    assert_eq!(flown.verdict, Verdict::Known(Level::Good));
    let levels: Vec<Level> = flown.findings.iter().map(|f| f.severity).collect();
    assert_eq!(levels, [Level::Info]);
    assert_eq!(flown.findings[0].cause, None);
}

#[cfg(feature = "serde")]
#[test]
fn an_assessment_is_serde_data() {
    let flown = fly(&[(20.0, true, HOVER), (3.0, true, LIMIT)]);
    let json = serde_json::to_value(&flown).unwrap();
    assert_eq!(json["verdict"], "FAIL");
    assert!(json.get("reason").is_none());
    let finding = &json["findings"][0];
    assert_eq!(finding["severity"], "FAIL");
    assert_eq!(finding["motor"]["number"], 1);
    assert_eq!(finding["motor"]["side"], "lower");
    assert!(finding["failed_s"].is_number());
    let cause = &finding["cause"];
    assert_eq!(
        (&cause["input"], &cause["term"]),
        (&"margin".into(), &"very_low".into())
    );
    assert_eq!(cause["rule"], 9);
    assert!(cause["value"].as_f64() < Some(0.1));
    let first = &json["steps"][0];
    assert!(first["risk"].is_null() && first["inputs"]["margin"].is_null());
    let hovering = &json["steps"][100];
    assert_eq!(hovering["inputs"]["margin"], 0.5);
    assert!(hovering["risk"].is_number() && hovering["elevated_risk"].is_number());
    assert!(hovering["dominant_rule"].as_u64() >= Some(1));

    let unknown = serde_json::to_value(fly(&[(20.0, true, [f64::NAN; 4])])).unwrap();
    assert_eq!(unknown["verdict"], "NA");
    assert!(unknown["reason"].is_string() && unknown["help"].is_string());
}

/// One risk depends on the margin, the other on the spread.
const TWO_RISKS: &str = "
fuzzy: 1
name: two
inputs:
  margin: {range: [0, 0.5], partition: [low, high]}
  spread: {range: [0, 0.5], partition: [low, high]}
outputs:
  weak: {range: [0, 100], terms: {no: {triangle: [0, 5, 10]}, yes: {triangle: [90, 95, 100]}}}
  torn: {range: [0, 100], terms: {no: {triangle: [0, 5, 10]}, yes: {triangle: [90, 95, 100]}}}
rules:
  - IF margin IS low THEN weak IS yes
  - IF margin IS high THEN weak IS no
  - IF spread IS low THEN torn IS no
  - IF spread IS high THEN torn IS yes
";

fn two_risks(risks: &str) -> Estimator {
    let inputs = "inputs: {margin: {mean: motor_margin}, spread: {std: motor_command}}";
    let profile = format!("flagred: 1\nname: two\nrules: two\n{inputs}\n{risks}\n");
    let model = fuzzy::yaml::parse(TWO_RISKS).unwrap().model;
    Estimator::new(&profile.parse().unwrap(), &model).unwrap()
}

/// First both motors approach their limit together, then they diverge.
fn fly_twice(estimator: &Estimator) -> (Assessment, Vec<(f64, Level)>, Vec<Option<String>>) {
    let mut assessor = Assessor::new(estimator, Craft::new(2), None).unwrap();
    let (mut changes, mut open) = (vec![], vec![]);
    for i in 0..4500 {
        let t_s = f64::from(i) * 0.02;
        let motors = match t_s {
            20.0..25.0 => [0.999, 0.999],
            50.0..55.0 => [0.5 - 0.46, 0.5 + 0.46],
            _ => [0.5, 0.5],
        };
        let update = assessor.push(&Sample {
            t_s,
            motors: &motors,
            in_air: Some(true),
            signals: &[],
        });
        changes.extend(update.change.map(|level| (t_s, level)));
        if update.change.is_some() {
            open.push(assessor.open_finding().and_then(|found| found.risk_output));
        }
    }
    (assessor.finish(), changes, open)
}

#[test]
fn several_risks_have_the_findings_of_profiles_of_each() {
    let weak = "warn: {risk: 60}\n  fail: {risk: 99}";
    let torn = "warn: {risk: 50}\n    fail: {risk: 80}\n    elevated_risk: {window_s: 3}";
    let both = two_risks(&format!(
        "output: weak\nverdict:\n  {weak}\nother_risks:\n  torn:\n    {torn}"
    ));
    let (assessment, changes, open) = fly_twice(&both);
    let of = |risk: Option<&str>| {
        let found = assessment.findings.iter();
        let of_risk = found.filter(|found| found.risk_output.as_deref() == risk);
        of_risk
            .map(|found| (found.found, found.cause.clone()))
            .collect::<Vec<_>>()
    };
    let alone = |risks: &str| {
        let findings = fly_twice(&two_risks(risks)).0.findings.into_iter();
        findings
            .map(|found| (found.found, found.cause))
            .collect::<Vec<_>>()
    };
    let first = alone(&format!("output: weak\nverdict:\n  {weak}"));
    let second = alone(&format!(
        "output: torn\nverdict:\n  {}",
        "warn: {risk: 50}\n  fail: {risk: 80}\nelevated_risk: {window_s: 3}"
    ));
    assert!(
        !first.is_empty() && second.len() == 1,
        "{first:?} {second:?}"
    );
    assert_eq!((of(None), of(Some("torn"))), (first, second));
    assert_eq!(assessment.verdict, Verdict::Known(Level::Fail));
    let torn = assessment
        .findings
        .iter()
        .find(|found| found.risk_output.is_some());
    assert_eq!(torn.unwrap().cause.as_ref().unwrap().input, "spread");

    // The level is the worst of both risks.
    let levels: Vec<Level> = changes.iter().map(|(_, level)| *level).collect();
    assert_eq!(levels[..2], [Level::Warn, Level::Good]);
    assert!(levels.contains(&Level::Fail), "{changes:?}");
    assert_eq!(open[0], None);
    assert!(open.contains(&Some("torn".into())), "{open:?}");

    let refused = both.plan().unwrap_err();
    assert_eq!(
        refused.to_string(),
        "the profile has the risks `weak` and `torn`, but exported code supports only one"
    );
}

/// If a risk is unknown because no rule covers it, a flight without findings is not GOOD, even if the other risk is known.
#[test]
fn a_flight_is_good_where_every_risk_is_known() {
    let rules = TWO_RISKS.replace("  - IF spread IS low THEN torn IS no\n", "");
    let model = fuzzy::yaml::parse(&rules).unwrap().model;
    let known = two_risks("output: weak\nother_risks: {torn: {}}");
    let mut profile = known.profile().clone();
    profile.gap.coverage_below = Some(0.0);
    let estimator = Estimator::new(&profile, &model).unwrap();
    let fly = |estimator: &Estimator| {
        let mut assessor = Assessor::new(estimator, Craft::new(2), None).unwrap();
        for i in 0..1000 {
            assessor.push(&Sample {
                t_s: f64::from(i) * 0.02,
                motors: &HOVER[..2],
                in_air: Some(true),
                signals: &[],
            });
        }
        assessor.finish()
    };
    assert_eq!(fly(&known).verdict, Verdict::Known(Level::Good));
    let unknown = Verdict::NotAvailable(Reason::RiskUnknown {
        unknown: Unknown::NoRule,
        explanation: "no rule applies, and there is nothing to interpolate from".into(),
        help: None,
    });
    let assessment = fly(&estimator);
    assert_eq!(assessment.verdict, unknown);
    let of_torn = assessment
        .unknown_risks
        .iter()
        .find(|risk| risk.output == "torn");
    let UnknownRisk {
        unknown_s, unknown, ..
    } = of_torn.unwrap();
    assert!(
        *unknown_s > 0.95 * assessment.summary.in_air_s,
        "{unknown_s}"
    );
    assert_eq!(*unknown, Unknown::NoRule);
}
