//! A flight through the monitor: from a log's samples to steps, findings and a verdict.

use flagred::{
    estimator::{Estimate, Estimator},
    monitor::{Assessment, Monitor, MonitorError, Unknown},
    profile::Profile,
    verdict::{Finding, Level, VerdictSettings},
};
use flightlog::{Flight, Gap};

use crate::samples;

/// What became of one flight.
pub(crate) struct Assessed {
    pub(crate) verdict: Verdict,
    /// The gravest first, equal ones in order of time.
    pub(crate) findings: Vec<Finding>,
    pub(crate) steps: Vec<Step>,
    pub(crate) summary: Summary,
}

/// The answer to "was that flight risky?".
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) enum Verdict {
    Known(Level),
    /// There is no answer: why, and what would help.
    NotAvailable {
        reason: String,
        help: Option<String>,
    },
}

impl Verdict {
    pub(crate) fn word(&self) -> &'static str {
        match self {
            Verdict::Known(level) => word(*level),
            Verdict::NotAvailable { .. } => "NA",
        }
    }
}

/// The words pilots know from other log analysers.
pub(crate) fn word(level: Level) -> &'static str {
    match level {
        Level::Good => "GOOD",
        Level::Warn => "WARN",
        Level::Fail => "FAIL",
    }
}

/// One moment that is shown.
#[derive(Default)]
pub(crate) struct Step {
    pub(crate) t_s: f64,
    pub(crate) margin: Option<f64>,
    pub(crate) spread: Option<f64>,
    /// In the order of the profile's inputs; NaN is unknown, and so is what is missing.
    pub(crate) inputs: Vec<f64>,
    pub(crate) estimate: Option<Estimate>,
    pub(crate) elevated_risk_pct: Option<f64>,
    /// Whether it is one of flight, and not of taking off or touching down.
    pub(crate) judged: bool,
}

/// The flight in a few numbers. Times are sums over the motor samples in the air.
#[derive(Debug, Default)]
pub(crate) struct Summary {
    pub(crate) in_air_s: f64,
    /// In the air with a known risk. The risks below leave the seconds around take-off and landing out.
    pub(crate) assessed_s: f64,
    /// In the air with a risk filled in from beside the rules.
    pub(crate) filled_s: f64,
    pub(crate) risk_mean_pct: Option<f64>,
    pub(crate) risk_max: Option<(f64, f64)>,
    pub(crate) elevated_risk_max: Option<(f64, f64)>,
    pub(crate) saturated_share: Option<f64>,
}

/// The least share of the time in the air that must be assessed for a GOOD.
const KNOWN_ENOUGH: f64 = 0.5;

/// A motor this near to a limit counts as saturated.
const SATURATED_MARGIN: f64 = 0.005;

/// Follows a flight from its first motor sample to its last.
///
/// Every sample goes through the monitor; a step is kept every `step_s`.
pub(crate) fn follow(flight: &Flight, estimator: &Estimator, step_s: f64) -> Assessed {
    if let Some(gap) = flight
        .gaps()
        .into_iter()
        .find(|gap| !matches!(gap, Gap::NoAttitude | Gap::TooSlow { .. }))
    {
        return not_available(gap.to_string(), gap.help().map(str::to_owned));
    }
    let names = estimator.profile().signals();
    let carried = samples::carried(flight, &names);
    let mut monitor = match Monitor::new(estimator, flight.motors.len(), &carried) {
        Ok(monitor) => monitor,
        Err(error) => {
            let help = matches!(error, MonitorError::NoSignal { .. })
                .then(|| "`flagred inspect` lists the signals a log carries".to_owned());
            return not_available(error.to_string(), help);
        }
    };

    let mut tally = Tally::default();
    let mut findings = Vec::new();
    let mut steps = Vec::new();
    let mut next_step_s = f64::NEG_INFINITY;
    samples::each(flight, &carried, |sample| {
        let (t_s, in_air) = (sample.t_s, sample.in_air);
        let assessment = monitor.push(sample);
        findings.extend(assessment.ended.into_iter().flatten());
        let judged = is_judged(flight, &estimator.profile().verdict, t_s);
        if in_air {
            tally.add(&assessment, judged, sample.motors);
        }
        if in_air && t_s >= next_step_s {
            // On a grid of `step_s`; every sample where they are rarer.
            next_step_s = (next_step_s + step_s).max(t_s);
            steps.push(Step {
                t_s,
                margin: monitor.margin(),
                spread: monitor.spread(),
                inputs: monitor.inputs().to_vec(),
                estimate: assessment.risk.ok(),
                elevated_risk_pct: assessment.elevated_risk_pct,
                judged,
            });
        }
    });
    findings.extend(monitor.finish().into_iter().flatten());
    findings.sort_by(|a, b| b.level.cmp(&a.level).then(a.from_s.total_cmp(&b.from_s)));

    let worst = findings
        .iter()
        .map(|finding| finding.level)
        .max()
        .unwrap_or(Level::Good);
    let slow = flight
        .gaps()
        .into_iter()
        .find(|gap| matches!(gap, Gap::TooSlow { .. }));
    let help = slow.and_then(|gap| gap.help());
    let verdict = tally.verdict(worst, estimator.profile(), help);
    Assessed {
        verdict,
        findings,
        steps,
        summary: tally.summary(),
    }
}

fn not_available(reason: String, help: Option<String>) -> Assessed {
    Assessed {
        verdict: Verdict::NotAvailable { reason, help },
        findings: Vec::new(),
        steps: Vec::new(),
        summary: Summary::default(),
    }
}

/// What adds up over a flight.
#[derive(Default)]
pub(crate) struct Tally {
    last_s: Option<f64>,
    in_air_s: f64,
    assessed_s: f64,
    filled_s: f64,
    judged_s: f64,
    risk_times_s: f64,
    risk_max: Option<(f64, f64)>,
    elevated_max: Option<(f64, f64)>,
    motor_samples: u64,
    saturated: u64,
    unknown: Vec<(Unknown, f64)>,
}

impl Tally {
    /// Adds a sample in the air; risks count where they are judged.
    pub(crate) fn add(&mut self, assessment: &Assessment, is_judged: bool, motors: &[f64]) {
        let t_s = assessment.t_s;
        let held_s = self
            .last_s
            .replace(t_s)
            .map_or(0.0, |last_s| (t_s - last_s).max(0.0));
        self.in_air_s += held_s;
        for e in motors.iter().filter(|e| e.is_finite()) {
            self.motor_samples += 1;
            self.saturated += u64::from(flagred::margin::margin(*e) < SATURATED_MARGIN);
        }
        match assessment.risk {
            Ok(estimate) => {
                self.assessed_s += held_s;
                if is_judged {
                    self.judged_s += held_s;
                    self.risk_times_s += estimate.risk_pct * held_s;
                    keep_larger(&mut self.risk_max, t_s, estimate.risk_pct);
                }
                if estimate.filled_from.is_some() {
                    self.filled_s += held_s;
                }
            }
            Err(reason) => {
                match self.unknown.iter_mut().find(|(known, _)| {
                    std::mem::discriminant(known) == std::mem::discriminant(&reason)
                }) {
                    Some((_, total_s)) => *total_s += held_s,
                    None => self.unknown.push((reason, held_s)),
                }
            }
        }
        if let Some(elevated) = assessment.elevated_risk_pct.filter(|_| is_judged) {
            keep_larger(&mut self.elevated_max, t_s, elevated);
        }
    }

    /// Whether enough of the flight was assessed to call it good.
    fn knows_enough(&self) -> bool {
        self.assessed_s > 0.0 && self.assessed_s >= KNOWN_ENOUGH * self.in_air_s
    }

    /// What kept the risk unknown for longest.
    fn main_reason(&self) -> Option<Unknown> {
        let longest = self.unknown.iter().max_by(|a, b| a.1.total_cmp(&b.1));
        longest.map(|(reason, _)| *reason)
    }

    /// What the worst level means: nothing found is no clean bill where hardly anything was known.
    pub(crate) fn verdict(&self, worst: Level, profile: &Profile, help: Option<&str>) -> Verdict {
        if worst > Level::Good || self.knows_enough() {
            return Verdict::Known(worst);
        }
        Verdict::NotAvailable {
            reason: self.main_reason().map_or_else(
                || "hardly any motor command was known in the air".to_owned(),
                |unknown| unknown.explain(profile),
            ),
            help: help.map(str::to_owned),
        }
    }

    fn summary(&self) -> Summary {
        let share = |part: f64, whole: f64| (whole > 0.0).then(|| part / whole);
        Summary {
            in_air_s: self.in_air_s,
            assessed_s: self.assessed_s,
            filled_s: self.filled_s,
            risk_mean_pct: share(self.risk_times_s, self.judged_s),
            risk_max: self.risk_max,
            elevated_risk_max: self.elevated_max,
            saturated_share: share(self.saturated as f64, self.motor_samples as f64),
        }
    }
}

/// Whether the risk at a time in the air is one of flight, and not of taking off or touching down.
fn is_judged(flight: &Flight, settings: &VerdictSettings, t_s: f64) -> bool {
    let Some(span) = flight
        .in_air
        .iter()
        .flat_map(|air| &air.spans)
        .rfind(|span| span.start_s <= t_s)
    else {
        return false;
    };
    let lands_s = if span.ends_with_log {
        f64::INFINITY
    } else {
        span.end_s - settings.quiet_before_landing_s
    };
    t_s >= span.start_s + settings.quiet_after_take_off_s && t_s < lands_s
}

/// Keeps the time and value of the largest value.
fn keep_larger(kept: &mut Option<(f64, f64)>, t_s: f64, value: f64) {
    if kept.is_none_or(|(_, largest)| value > largest) {
        *kept = Some((t_s, value));
    }
}
