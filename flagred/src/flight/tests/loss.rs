//! Verdicts of flights with unknown motors and invalid times.

use proptest::prelude::*;

use super::*;
use crate::monitor::Factors;

const QUAD_X: [Factors; 4] = [
    [-1.0, 1.0, 1.0],
    [1.0, -1.0, 1.0],
    [1.0, 1.0, -1.0],
    [-1.0, -1.0, -1.0],
];

/// Simulates a flight of 40 s: hovering, with trouble from 10 to 30 s; `change` may change the motors of a sample.
fn in_trouble(
    estimator: &Estimator,
    factors: &[Factors],
    trouble: [f64; 4],
    change: impl Fn(f64, &mut [f64; 4]),
) -> Assessment {
    let craft = Craft::new(4).with_geometry(factors);
    let mut assessor = Assessor::new(estimator, craft, None).unwrap();
    for i in 0..2000 {
        let t_s = f64::from(i) * 0.02;
        let mut motors = if (10.0..30.0).contains(&t_s) {
            trouble
        } else {
            HOVER
        };
        change(t_s, &mut motors);
        assessor.push(&Sample {
            t_s,
            motors: &motors,
            in_air: Some(true),
            signals: &[],
        });
    }
    assessor.finish()
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))]

    /// Whichever motors are unknown, all the time or repeatedly, a flight that fails is never rated GOOD because of
    /// that.
    #[test]
    fn an_unknown_motor_does_not_make_a_failed_flight_good(
        unknown in prop::array::uniform4(any::<bool>()),
        is_paper: bool,
        has_geometry: bool,
        is_pair: bool,
        from_s in 0.0..12.0f64,
        to_s in 28.0..40.0f64,
        (unknown_s, known_s) in (0.1..20.0f64, 0.0..0.9f64),
    ) {
        let estimator = if is_paper { shipped::flagred_paper() } else { shipped::flagred() };
        let factors = if has_geometry { &QUAD_X[..] } else { &[] };
        let trouble = if is_pair { LIMIT } else { [1.0, 1.0, 0.0, 1.0] };
        let failed = in_trouble(&estimator, factors, trouble, |_, _| {});
        prop_assert_eq!(failed.verdict, Verdict::Known(Level::Fail));
        let hidden = in_trouble(&estimator, factors, trouble, |t_s, motors| {
            let is_off = (from_s..to_s).contains(&t_s) && t_s % (unknown_s + known_s) < unknown_s;
            for (motor, unknown) in motors.iter_mut().zip(unknown) {
                if unknown && is_off {
                    *motor = f64::NAN;
                }
            }
        });
        prop_assert_ne!(hidden.verdict, Verdict::Known(Level::Good));
    }

    /// Trouble occurs only in short periods in which a motor is unknown; together they are more than a sixteenth of the
    /// time (here at least 3 of 40 s). Known time in between does not hide the trouble.
    #[test]
    fn moments_without_a_motor_do_not_hide_a_failure(
        motor in 0..4usize,
        (unknown_s, known_s) in (0.3..1.95f64, 0.9..3.2f64),
        once_s in 0.5..2.0f64,
    ) {
        let estimator = shipped::flagred();
        let (period_s, from_s) = (unknown_s + known_s, 5.0);
        let is_off = |t_s: f64| (from_s..38.0).contains(&t_s) && (t_s - from_s) % period_s < unknown_s;
        let hidden = in_trouble(&estimator, &QUAD_X, HOVER, |t_s, motors| {
            if is_off(t_s) {
                *motors = LIMIT;
                motors[motor] = f64::NAN;
            }
        });
        let is_of_motor = matches!(hidden.verdict, Verdict::NotAvailable(Reason::MotorUnknown { .. }));
        prop_assert!(is_of_motor, "{:?}", hidden.verdict);
        // A single loss of less than a sixteenth of the time does not prevent a verdict.
        let calm = in_trouble(&estimator, &QUAD_X, HOVER, |t_s, motors| {
            if (20.0..20.0 + once_s).contains(&t_s) {
                motors[motor] = f64::NAN;
            }
        });
        prop_assert_eq!(calm.verdict, Verdict::Known(Level::Good));
    }
}

#[test]
fn several_motors_that_are_unknown_in_turns_are_named() {
    let flown = in_trouble(&shipped::flagred(), &[], HOVER, |t_s, motors| {
        if (5.0..30.0).contains(&t_s) {
            motors[(t_s / 1.5) as usize % 4] = f64::NAN;
        }
    });
    let Verdict::NotAvailable(reason) = flown.verdict else {
        panic!("{:?}", flown.verdict)
    };
    assert_eq!(
        reason.to_string(),
        "the command of motor 4, then of others, is unknown in the air from 5.0 to 30.0 s"
    );
}

/// Assesses a calm flight that is interrupted by samples without a valid time, in which motors are at their limits.
fn around(odd_time_s: impl Fn(i32) -> f64) -> String {
    let mut assessor = Assessor::new(&shipped::flagred(), Craft::new(4), None).unwrap();
    let mut push = |t_s: f64, motors: &[f64; 4]| {
        assessor.push(&Sample {
            t_s,
            motors,
            in_air: Some(true),
            signals: &[],
        });
    };
    (0..500).for_each(|i| push(f64::from(i) * 0.04, &HOVER));
    (0..200).for_each(|i| push(odd_time_s(i), &LIMIT));
    (500..1000).for_each(|i| push(f64::from(i) * 0.04, &HOVER));
    match assessor.finish().verdict {
        Verdict::NotAvailable(reason) => reason.to_string(),
        known => known.to_string(),
    }
}

#[test]
fn samples_that_are_ignored_for_their_times_are_a_reason_for_no_verdict() {
    let ignored = "200 samples in the air were ignored: their times are unknown or go back";
    assert_eq!(around(|_| f64::NAN), ignored);
    assert_eq!(around(|i| 19.0 + f64::from(i % 20) * 0.04), ignored);
    // Samples with the same time as the previous one are not ignored.
    assert_eq!(around(|_| 19.96), "GOOD");
    // A time that goes far back begins a new flight.
    let mut assessor = Assessor::new(&shipped::flagred(), Craft::new(4), None).unwrap();
    for i in 0..1000 {
        let t_s = f64::from(if i < 500 { i } else { i - 250 }) * 0.04;
        assessor.push(&Sample {
            t_s,
            motors: &HOVER,
            in_air: Some(true),
            signals: &[],
        });
    }
    let Verdict::NotAvailable(reason) = assessor.finish().verdict else {
        panic!()
    };
    assert_eq!(
        reason.to_string(),
        "the clock goes back in the air at 20.0 s"
    );
}

#[test]
fn a_moment_without_a_motor_does_not_change_the_verdict() {
    let estimator = shipped::flagred();
    let moment = |t_s: f64, motors: &mut [f64; 4]| {
        if t_s % 10.0 < 0.5 {
            motors[2] = f64::NAN;
        }
    };
    let failed = in_trouble(&estimator, &QUAD_X, LIMIT, moment);
    assert_eq!(failed.verdict, Verdict::Known(Level::Fail));
    let calm = in_trouble(&estimator, &QUAD_X, HOVER, moment);
    assert_eq!(calm.verdict, Verdict::Known(Level::Good));
}
