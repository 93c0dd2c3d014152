//! The words of findings for the pilot.

use alloc::format;

use crate::{
    estimator::Estimator,
    flight::{Cause, Finding, Words},
    margin::Side,
    profile::Profile,
    shipped,
    verdict::{self, Level, Measure, MotorFinding},
};

fn finding(measure: Measure, value_pct: f64) -> Finding {
    Finding {
        found: verdict::Finding {
            severity: Level::Warn,
            measure,
            threshold_pct: 60.0,
            value_pct,
            ..verdict::Finding::NONE
        },
        cause: None,
        risk_interval: None,
        risk_output: None,
    }
}

fn by(input: &str, term: &str, value: f64) -> Finding {
    Finding {
        cause: Some(Cause {
            input: input.into(),
            value,
            term: term.into(),
            rule: 0,
        }),
        ..finding(Measure::Risk, 77.6)
    }
}

fn motor(number: usize, or_number: Option<usize>, side: Side) -> Option<MotorFinding> {
    Some(MotorFinding {
        number,
        or_number,
        side,
        margin_mean: 0.01,
        margin_min: 0.0,
    })
}

#[test]
fn a_risk_has_the_words_of_its_input_and_its_numbers() {
    let words = by("swing_per_room", "large", 0.638).words(&shipped::flagred());
    assert_eq!(words.code, "low_motor_margin");
    assert_eq!(words.brief.concat(), "low motor margin");
    assert!(words.text.contains(" 64 % "), "{}", words.text);
    assert!(
        words.text.ends_with(" The risk reached 78 %."),
        "{}",
        words.text
    );
    let mut elevated = by("unsteady_lately", "stormy", 0.1);
    elevated.found.measure = Measure::ElevatedRisk;
    let text = elevated.words(&shipped::flagred()).text;
    assert!(text.ends_with(" The elevated risk reached 78 %."), "{text}");
}

#[test]
fn motors_near_a_limit_are_named_with_the_limit() {
    let mut finding = by("at_limit", "much", 0.5);
    finding.found.motor = motor(3, None, Side::Upper);
    let words = finding.words(&shipped::flagred());
    assert_eq!(words.code, "motor_at_limit");
    assert_eq!(words.brief, ["upper limit", ", motor 3"]);
    let expected = "Motor 3 was closest to its upper limit. The risk reached 78 %.";
    assert!(words.text.ends_with(expected), "{}", words.text);
}

#[test]
fn another_risk_is_named() {
    let mut finding = by("battery", "low", 12.25);
    finding.risk_output = Some("battery_risk".into());
    let Words { code, text, .. } = finding.words(&shipped::flagred_battery());
    assert_eq!(code, "low_battery");
    let expected = "The battery was down to 12.25 % when this level was raised. The risk `battery_risk` reached 78 %.";
    assert_eq!(text, expected);
}

#[test]
fn words_name_the_motor_and_its_direction() {
    let estimator = shipped::flagred();
    let mut weak = finding(Measure::WeakMotor, 23.7);
    weak.found.motor = motor(3, Some(8), Side::Upper);
    let words = weak.words(&estimator);
    assert_eq!(words.brief.concat(), "motor 3 or 8 weak: +24 %");
    assert!(
        words.advice.contains("check motor 3 or 8:"),
        "{}",
        words.advice
    );
    let mut imbalance = finding(Measure::Imbalance, 16.0);
    imbalance.found.motor = motor(2, None, Side::Lower);
    let words = imbalance.words(&estimator);
    assert_eq!(words.brief, ["imbalance 16 %", ", motor 2"]);
    assert!(
        words.text.contains("motor 2, whose share is now below its"),
        "{}",
        words.text
    );
}

#[test]
fn findings_contain_all_numbers() {
    let estimator = shipped::flagred();
    for measure in Measure::ALL {
        let mut finding = finding(measure, 50.0);
        finding.found.motor = motor(1, None, Side::Upper);
        let Words {
            brief,
            text,
            advice,
            ..
        } = finding.words(&estimator);
        for text in [brief.concat(), text, advice] {
            assert!(!text.contains('{') && !text.is_empty(), "{measure}: {text}");
        }
    }
}

/// Names may contain any characters; in the code of a finding, those that a code cannot contain are replaced.
#[test]
fn an_input_without_words_is_described_by_name_and_description() {
    let battery = shipped::flagred_battery();
    let profile = Profile {
        findings: alloc::vec::Vec::new(),
        ..battery.profile().clone()
    };
    let estimator = Estimator::new(&profile, battery.model()).unwrap();
    let words = by("battery", "low", 12.0).words(&estimator);
    assert_eq!(words.code, "battery");
    assert_eq!(words.brief, ["battery", " low"]);
    let expected = "battery was low: 12 % (what is left in the battery). The risk reached 78 %.";
    assert_eq!(words.text, expected);
    let strange = Words::of_cause(&estimator, "Größe-2", "very high");
    assert_eq!(strange.code, "gr__e_2");
    assert_eq!(
        strange.text,
        format!("Größe-2 was very high: {}.", "{value}")
    );
}
