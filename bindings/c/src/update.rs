//! Updates and findings as C data.

use flagred::{
    margin::Side,
    sample::{self, Estimate, Unknown},
    verdict::{self, Cause, EndedFindings, Level},
};

/// The maximum number of findings that can end at one time: `FLAGRED_ENDED` in C.
pub(crate) const ENDED: usize = 4;

/// A finding: `struct flagred_finding` in C.
#[derive(Debug, Clone, Copy)]
#[repr(C)]
pub struct Finding {
    from_s: f64,
    raised_s: f64,
    failed_s: f64,
    to_s: f64,
    threshold_pct: f64,
    peak_pct: f64,
    mean_margin: f64,
    least_margin: f64,
    cause_value: f64,
    level: i32,
    measure: i32,
    motor: i32,
    or_motor: i32,
    at_high_limit: i32,
    cause: i32,
    cause_rule: i32,
    cause_input: i32,
}

/// The state of a monitor after a sample: `struct flagred_update` in C.
#[derive(Debug, Clone, Copy)]
#[repr(C)]
pub struct Update {
    t_s: f64,
    risk_pct: f64,
    elevated_risk_pct: f64,
    coverage: f64,
    filled_from: f64,
    ended: [Finding; ENDED],
    dominant_rule: i32,
    clamped: i32,
    level: i32,
    change: i32,
    unknown: i32,
    unknown_input: i32,
    unknown_motor: i32,
}

impl Finding {
    const NONE: Finding = Finding {
        from_s: f64::NAN,
        raised_s: f64::NAN,
        failed_s: f64::NAN,
        to_s: f64::NAN,
        threshold_pct: f64::NAN,
        peak_pct: f64::NAN,
        mean_margin: f64::NAN,
        least_margin: f64::NAN,
        level: -1,
        measure: 0,
        motor: -1,
        or_motor: -1,
        at_high_limit: 0,
        cause_value: f64::NAN,
        cause: -1,
        cause_rule: -1,
        cause_input: -1,
    };

    pub(crate) fn of(finding: Option<verdict::Finding>) -> Finding {
        let Some(finding) = finding else {
            return Finding::NONE;
        };
        let verdict::Finding { motor, cause, .. } = finding;
        let of_cause = |value: fn(&Cause) -> usize| cause.as_ref().map_or(-1, |c| index(value(c)));
        Finding {
            from_s: finding.from_s,
            raised_s: finding.raised_s,
            failed_s: finding.failed_s.unwrap_or(f64::NAN),
            to_s: finding.to_s,
            threshold_pct: finding.threshold_pct,
            peak_pct: finding.value_pct,
            mean_margin: motor.map_or(f64::NAN, |motor| motor.margin_mean),
            least_margin: motor.map_or(f64::NAN, |motor| motor.margin_min),
            level: level(Some(finding.severity)),
            measure: finding.measure as i32,
            motor: motor.map_or(-1, |motor| index(motor.number - 1)),
            or_motor: motor
                .and_then(|motor| motor.or_number)
                .map_or(-1, |number| index(number - 1)),
            at_high_limit: i32::from(motor.is_some_and(|motor| motor.side == Side::Upper)),
            cause_value: cause.map_or(f64::NAN, |cause| cause.value),
            cause: of_cause(|cause| cause.proposition),
            cause_rule: of_cause(|cause| cause.rule),
            cause_input: of_cause(|cause| cause.input),
        }
    }
}

pub(crate) fn findings(ended: EndedFindings) -> [Finding; ENDED] {
    ended.map(Finding::of)
}

impl Update {
    pub(crate) fn of(update: &sample::Update) -> Update {
        let (unknown, unknown_input, unknown_motor) = match update.risk {
            Ok(_) => (0, -1, -1),
            Err(Unknown::OnGround) => (1, -1, -1),
            Err(Unknown::OutOfOrder) => (2, -1, -1),
            Err(Unknown::WarmingUp { input }) => (3, index(input), -1),
            Err(Unknown::TooFewSamples { input, .. }) => (4, index(input), -1),
            Err(Unknown::NoValue { input }) => (5, index(input), -1),
            Err(Unknown::NoRule) => (6, -1, -1),
            Err(Unknown::NoCommand { motor }) => (7, -1, index(motor)),
            Err(Unknown::CommandOutside { motor, .. }) => (8, -1, index(motor)),
        };
        Update {
            t_s: update.t_s,
            elevated_risk_pct: update.elevated_risk_pct.unwrap_or(f64::NAN),
            ended: findings(update.ended),
            level: level(update.level),
            change: level(update.change),
            unknown,
            unknown_input,
            unknown_motor,
            ..Update::of_estimate(update.risk.ok())
        }
    }

    /// The fields of an estimate, independent of the flight.
    pub(crate) fn of_estimate(estimate: Option<Estimate>) -> Update {
        let known = |value: fn(&Estimate) -> f64| estimate.as_ref().map_or(f64::NAN, value);
        Update {
            t_s: f64::NAN,
            risk_pct: known(|estimate| estimate.risk_pct),
            elevated_risk_pct: f64::NAN,
            coverage: known(|estimate| estimate.coverage),
            filled_from: known(|estimate| estimate.filled_from.unwrap_or(f64::NAN)),
            ended: [Finding::NONE; ENDED],
            dominant_rule: estimate
                .and_then(|estimate| estimate.dominant_rule)
                .map_or(-1, index),
            clamped: i32::from(estimate.is_some_and(|estimate| estimate.clamped)),
            level: -1,
            change: -1,
            unknown: if estimate.is_some() { 0 } else { 6 },
            unknown_input: -1,
            unknown_motor: -1,
        }
    }
}

fn level(level: Option<Level>) -> i32 {
    level.map_or(-1, |level| level as i32)
}

fn index(index: usize) -> i32 {
    i32::try_from(index).unwrap_or(i32::MAX)
}
