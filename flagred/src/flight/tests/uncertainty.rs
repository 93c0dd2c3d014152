//! The intervals of risks.

use super::*;
use crate::{
    estimator::Estimator,
    flight::uncertainty::{RiskBounds, UncertainRisk},
};

/// Pseudo-random numbers, uniform from -1 to 1.
fn noise() -> impl FnMut() -> f64 {
    let mut state = 3_u64;
    move || {
        state = state
            .wrapping_mul(6_364_136_223_846_793_005)
            .wrapping_add(1_442_695_040_888_963_407);
        (state >> 11) as f64 / (1_u64 << 52) as f64 - 1.0
    }
}

/// A flight of a minute in which the motors differ more and more, up to their limits.
fn rising(rate_hz: f64, mut push: impl FnMut(&Sample<'_>)) {
    let mut random = noise();
    for i in 0..(60.0 * rate_hz) as u32 {
        let t_s = f64::from(i) / rate_hz;
        let apart = 0.00015 * t_s * t_s * (1.7 * t_s).sin() + 0.01 * random();
        let thrust = 0.5 + 0.01 * (0.9 * t_s).sin();
        let motors = [thrust - apart, thrust + apart, thrust + 0.5 * apart, thrust];
        push(&Sample {
            t_s,
            motors: &motors,
            in_air: Some(true),
            signals: &[40.0 - 0.5 * t_s],
        });
    }
}

fn assessor(estimator: &Estimator) -> Assessor {
    let craft = Craft::new(4).with_signals(&["battery_remaining_pct"]);
    let assessor = Assessor::new(estimator, craft, Some(0.1)).unwrap();
    assessor.with_intervals()
}

fn assessed(estimator: &Estimator, rate_hz: f64) -> Assessment {
    let mut assessor = assessor(estimator);
    rising(rate_hz, |sample| {
        assessor.push(sample);
    });
    assessor.finish()
}

fn widths(steps: &[Step]) -> Vec<f64> {
    let intervals = steps.iter().filter_map(|step| step.risk_interval);
    let mut widths: Vec<f64> = intervals.map(|it| it.high_pct - it.low_pct).collect();
    widths.sort_by(f64::total_cmp);
    widths
}

fn profiles() -> [Estimator; 3] {
    [
        shipped::flagred(),
        shipped::flagred_paper(),
        shipped::flagred_battery(),
    ]
}

#[test]
fn every_known_risk_is_in_its_interval() {
    for estimator in profiles() {
        let flown = assessed(&estimator, 50.0);
        let mut count = 0;
        for step in &flown.steps {
            let Some(estimate) = step.estimate else {
                assert_eq!(step.risk_interval, None);
                continue;
            };
            let interval = step.risk_interval.unwrap();
            assert!(0.0 <= interval.low_pct && interval.high_pct <= 100.0);
            assert!(
                (interval.low_pct..=interval.high_pct).contains(&estimate.risk_pct),
                "{interval:?} {estimate:?}"
            );
            count += 1;
        }
        assert!(count > 550, "{count}");
    }
}

/// The bounds are guaranteed: the risk is within them for all values of the inputs within their intervals.
#[test]
fn no_inputs_within_their_intervals_have_a_risk_outside() {
    for estimator in profiles() {
        let mut random = noise();
        let mut assessor = assessor(&estimator);
        let mut risks = Vec::new();
        rising(50.0, |sample| {
            assessor.push(sample);
            risks.extend(UncertainRisk::of(assessor.monitor()));
        });
        let mut bounds = RiskBounds::new(&estimator);
        let variables = estimator.profile().inputs.iter().map(|input| {
            let mut inputs = estimator.model().inputs.iter();
            inputs.find(|variable| variable.name == input.name)
        });
        let variables: Vec<_> = variables.collect();
        for risk in risks.iter().step_by(97) {
            let interval = bounds.of(risk).unwrap();
            for _ in 0..200 {
                let within = risk.inputs().iter().zip(&variables);
                let point: Vec<f64> = within
                    .map(|(within, variable)| {
                        let (least, most) = variable.map_or((0.0, 1.0), |it| (it.low, it.high));
                        let (low, high) = (within.low.max(least), within.high.min(most));
                        // Because `share` is clamped, the ends of the interval are chosen often.
                        let share = (0.5 + 0.7 * random()).clamp(0.0, 1.0);
                        low + (high - low).max(0.0) * share
                    })
                    .collect();
                let risk_pct = estimator.at(&point).unwrap().risk_pct;
                assert!(
                    (interval.low_pct..=interval.high_pct).contains(&risk_pct),
                    "{point:?}: {risk_pct} {interval:?}"
                );
            }
        }
    }
}

#[test]
fn few_samples_have_wide_intervals() {
    let estimator = shipped::flagred_paper();
    let median = |rate_hz: f64| {
        let (mut random, mut assessor) = (noise(), assessor(&estimator));
        for i in 0..(60.0 * rate_hz) as u32 {
            assessor.push(&Sample {
                t_s: f64::from(i) / rate_hz,
                motors: &[0.0; 4].map(|_: f64| 0.5 + 0.2 * random()),
                in_air: Some(true),
                signals: &[40.0],
            });
        }
        let widths = widths(&assessor.finish().steps);
        widths[widths.len() / 2]
    };
    let (few, many) = (median(3.0), median(50.0));
    assert!(few > 2.0 * many, "{few} {many}");
}

#[test]
fn a_risk_with_an_unknown_motor_has_no_interval_until_it_is_known_again() {
    let estimator = shipped::flagred();
    let mut assessor = assessor(&estimator);
    rising(50.0, |sample| {
        let mut motors = [0.0; 4];
        motors.copy_from_slice(sample.motors);
        if (30.0..31.0).contains(&sample.t_s) {
            motors[2] = f64::NAN;
        }
        assessor.push(&Sample {
            motors: &motors,
            ..*sample
        });
    });
    let flown = assessor.finish();
    let during = |step: &&Step| (30.0..31.0).contains(&step.t_s);
    let lost: Vec<&Step> = flown.steps.iter().filter(during).collect();
    assert!(lost.len() >= 9);
    assert!(
        lost.iter()
            .all(|step| step.estimate.is_none() && step.risk_interval.is_none())
    );
    let after = flown
        .steps
        .iter()
        .find(|step| step.t_s > 31.0 && step.estimate.is_some());
    let after = after.unwrap();
    let interval = after.risk_interval.unwrap();
    let risk_pct = after.estimate.unwrap().risk_pct;
    assert!(interval.low_pct <= risk_pct && risk_pct < interval.high_pct);
}

#[test]
fn a_finding_reports_that_its_interval_contains_the_threshold() {
    let estimator = shipped::flagred();
    let flown = assessed(&estimator, 50.0);
    let finding = flown
        .findings
        .iter()
        .find(|it| it.measure == Measure::Risk)
        .unwrap();
    let interval = finding.risk_interval.unwrap();
    assert!(interval.low_pct <= finding.value_pct && finding.value_pct <= interval.high_pct);
    let of = |low_pct: f64| {
        let risk_interval = Some(RiskInterval {
            low_pct,
            high_pct: 90.0,
        });
        let finding = Finding {
            risk_interval,
            ..finding.clone()
        };
        finding.uncertainty()
    };
    let threshold_pct = finding.threshold_pct;
    let text = of(threshold_pct - 6.0).unwrap();
    let within = format!(
        "is within the interval of the risk, {} to 90 %",
        threshold_pct - 6.0
    );
    assert!(text.ends_with(&within), "{text}");
    assert_eq!(of(threshold_pct), None);
    // Without steps, no intervals are computed.
    let mut assessor = Assessor::new(&estimator, Craft::new(4), None).unwrap();
    rising(50.0, |sample| {
        assessor.push(sample);
    });
    let plain = assessor.finish();
    assert!(
        plain
            .findings
            .iter()
            .all(|finding| finding.risk_interval.is_none())
    );
    assert_eq!(plain.verdict, flown.verdict);
    assert_eq!(plain.summary, flown.summary);
}

#[test]
fn a_finding_of_another_risk_has_the_interval_of_that_risk() {
    let rules = "
fuzzy: 1
name: two
inputs:
  load: {range: [0, 1], partition: {light: 0, heavy: 1}}
  heat: {range: [0, 100], partition: {cool: 0, hot: 100}}
outputs:
  risk: {range: [0, 100], terms: {none: {constant: 0}, high: {constant: 50}}, defuzzifier: weighted_average}
  heat_risk: {range: [0, 100], terms: {none: {constant: 0}, high: {constant: 100}}, defuzzifier: weighted_average}
rules:
  - IF load IS light THEN risk IS none
  - IF load IS heavy THEN risk IS high
  - IF heat IS cool THEN heat_risk IS none
  - IF heat IS hot THEN heat_risk IS high
";
    let profile = "
flagred: 1
name: two
rules: two
inputs: {load: {mean: motor_command}, heat: {mean: heat_c}}
output: risk
verdict: {warn: {risk: 60, after_s: 0.5}, fail: {risk: 99}}
other_risks: {heat_risk: {}}
";
    let rules = fuzzy::yaml::parse(rules).unwrap().model;
    let estimator = Estimator::new(&profile.parse().unwrap(), &rules).unwrap();
    let craft = Craft::new(4).with_signals(&["heat_c"]);
    let mut assessor = Assessor::new(&estimator, craft, Some(0.1))
        .unwrap()
        .with_intervals();
    let mut random = noise();
    for i in 0..1000 {
        let t_s = f64::from(i) * 0.02;
        assessor.push(&Sample {
            t_s,
            motors: &[0.5; 4],
            in_air: Some(true),
            signals: &[10.0 * random() + if t_s < 10.0 { 20.0 } else { 70.0 }],
        });
    }
    let flown = assessor.finish();
    let [finding] = flown.findings.as_slice() else {
        panic!("{:?}", flown.findings);
    };
    assert_eq!(finding.risk_output.as_deref(), Some("heat_risk"));
    let interval = finding.risk_interval.unwrap();
    assert!(interval.low_pct < finding.value_pct && finding.value_pct < interval.high_pct);
    assert!(interval.high_pct < interval.low_pct + 20.0, "{interval:?}");
}

#[test]
fn an_exponential_window_has_no_interval() {
    let rules = "
fuzzy: 1
name: mean
inputs: {load: {range: [0, 1], partition: {light: 0, heavy: 1}}}
outputs: {risk: {range: [0, 100], terms: {none: {constant: 0}, high: {constant: 90}}, defuzzifier: weighted_average}}
rules: [IF load IS light THEN risk IS none, IF load IS heavy THEN risk IS high]
";
    for (window, is_known) in [("time_constant_s", false), ("window_s", true)] {
        let profile = format!(
            "flagred: 1\nname: mean\nrules: mean\ninputs: {{load: {{mean: motor_command, {window}: 2}}}}"
        );
        let rules = fuzzy::yaml::parse(rules).unwrap().model;
        let estimator = Estimator::new(&profile.parse().unwrap(), &rules).unwrap();
        let flown = assessed(&estimator, 50.0);
        let last = flown.steps.last().unwrap();
        assert!(last.estimate.is_some());
        assert_eq!(last.risk_interval.is_some(), is_known, "{window}");
    }
}
