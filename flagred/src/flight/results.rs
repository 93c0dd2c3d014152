//! The sums and results of a flight, sample by sample, and its verdict.

use alloc::{collections::VecDeque, vec::Vec};

use super::{
    MAX_STEPS,
    assessment::{Assessment, AssumedInput, Peak, Step, Summary, UnknownRisk, UnknownTime},
    finding::Finding,
    loss::Losses,
    uncertainty::{RiskBounds, UncertainPeak, UncertainRisk},
    verdict::{Reason, Verdict},
};
use crate::{
    estimator::Estimator,
    margin::margin,
    monitor::{Sample, Unknown, Update},
    motor::counted,
    profile::Profile,
    verdict::{Level, Measure},
};

/// The share of the time in the air for which the risk must be known for a verdict of GOOD.
const KNOWN_SHARE: f64 = 0.5;
/// A reason that applies for at least this share of the time in the air is reported without its share.
const WHOLE_SHARE: f64 = 0.95;

/// The maximum number of findings that are kept per flight. The most severe ones are kept.
const MAX_FINDINGS: usize = 1000;
/// Judged risks that a landing could still withdraw are merged if the time between them is less than this, in seconds.
const PENDING_S: f64 = 1e-4;

/// The margin below which a motor counts as saturated.
const SATURATED_MARGIN: f64 = 0.005;

/// The sums and results of a flight so far.
#[derive(Debug, Clone)]
pub(super) struct Flight {
    pub(super) findings: Vec<Finding>,
    findings_left_out: u64,
    pub(super) steps: Vec<Step>,
    /// The risk of each step with the intervals of its inputs; `None` if it is unknown.
    pub(super) uncertain: Vec<Option<UncertainRisk>>,
    /// The highest risks of the findings: those of the profile's `output`, then those of each of the other risks.
    pub(super) peaks: Vec<Vec<UncertainPeak>>,
    pub(super) next_step_s: f64,
    pub(super) widened_step_s: Option<f64>,
    pub(super) last: Option<PreviousSample>,
    summary: Summary,
    judged_s: f64,
    risk_times_s: f64,
    motor_samples: u64,
    saturated: u64,
    /// The reasons why each risk was unknown.
    unknown: Vec<UnknownTime>,
    pub(super) losses: Losses,
    /// The indices of the inputs whose values were assumed, not measured, while the vehicle was in the air.
    pub(super) assumed: Vec<usize>,
    /// Judged risks that a landing would still withdraw, in order of time.
    pending: VecDeque<Pending>,
}

/// The previous sample.
#[derive(Debug, Clone, Copy)]
pub(super) struct PreviousSample {
    pub(super) t_s: f64,
    in_air: bool,
}

/// A judged risk, or several at nearly the same time.
#[derive(Debug, Clone, Copy)]
struct Pending {
    t_s: f64,
    held_s: f64,
    risk_times_s: f64,
    /// The highest risk in %.
    risk_pct: f64,
    elevated_risk_pct: Option<f64>,
}

impl Flight {
    pub(super) fn new() -> Flight {
        Flight {
            findings: Vec::new(),
            findings_left_out: 0,
            steps: Vec::new(),
            uncertain: Vec::new(),
            peaks: Vec::new(),
            next_step_s: f64::NEG_INFINITY,
            widened_step_s: None,
            last: None,
            summary: Summary::default(),
            judged_s: 0.0,
            risk_times_s: 0.0,
            motor_samples: 0,
            saturated: 0,
            unknown: Vec::new(),
            losses: Losses::default(),
            assumed: Vec::new(),
            pending: VecDeque::new(),
        }
    }

    /// Adds a sample; `unknown` are the unknown risks, each with its index ([`UnknownTime::risk`]) and the reason.
    pub(super) fn add(
        &mut self,
        update: &Update,
        sample: &Sample<'_>,
        profile: &Profile,
        unknown: impl Iterator<Item = (usize, Unknown)> + Clone,
    ) {
        let t_s = sample.t_s;
        let last = self.last.replace(PreviousSample {
            t_s,
            in_air: !sample.is_on_ground(),
        });
        let last = last.filter(|last| last.in_air);
        if let Some(last) = last.filter(|last| last.t_s > t_s) {
            self.losses.set_clock_back(last.t_s);
        }
        let flown_s = last.map_or(0.0, |last| {
            let held_s = (t_s - last.t_s).max(0.0);
            // If the vehicle landed within a gap, the time of the landing is unknown, so the gap does not count as time
            // in the air.
            match !sample.is_on_ground() || held_s <= profile.sampling.longest_gap_s {
                true => held_s,
                false => 0.0,
            }
        });
        self.summary.in_air_s += flown_s;
        let quiet_s = profile.verdict.quiet_before_landing_s;
        if sample.is_on_ground() {
            if last.is_some() {
                self.retract(t_s - quiet_s);
            }
            return;
        }
        let commands = sample.motors.iter().map(|command| counted(*command));
        for e in commands.filter(|e| e.is_finite()) {
            self.motor_samples += 1;
            self.saturated += u64::from(margin(e) < SATURATED_MARGIN);
        }
        let reasons = unknown.clone().map(|(_, reason)| reason);
        self.losses.take_sample(reasons, t_s, flown_s);
        if unknown.clone().next().is_none() {
            self.summary.assessed_s += flown_s;
        }
        for (risk, reason) in unknown {
            self.add_unknown(risk, reason, flown_s);
        }
        if let Ok(estimate) = update.risk {
            if estimate.filled_from.is_some() {
                self.summary.filled_s += flown_s;
            }
            if update.judged {
                self.wait(Pending {
                    t_s,
                    held_s: flown_s,
                    risk_times_s: estimate.risk_pct * flown_s,
                    risk_pct: estimate.risk_pct,
                    elevated_risk_pct: update.elevated_risk_pct,
                });
            }
        }
        self.count_pending(t_s - quiet_s);
    }

    fn add_unknown(&mut self, risk: usize, reason: Unknown, flown_s: f64) {
        let mut known = self.unknown.iter_mut();
        match known.find(|known| known.risk == risk && is_same(&known.reason, &reason)) {
            Some(known) => known.total_s += flown_s,
            None => self.unknown.push(UnknownTime {
                risk,
                reason,
                total_s: flown_s,
            }),
        }
    }

    /// Keeps a judged risk pending until a landing can no longer withdraw it.
    fn wait(&mut self, risk: Pending) {
        match self.pending.back_mut() {
            Some(last) if risk.t_s - last.t_s < PENDING_S => {
                last.held_s += risk.held_s;
                last.risk_times_s += risk.risk_times_s;
                last.risk_pct = last.risk_pct.max(risk.risk_pct);
                // `None` (unknown) compares as smaller than any number.
                if risk.elevated_risk_pct > last.elevated_risk_pct {
                    last.elevated_risk_pct = risk.elevated_risk_pct;
                }
            }
            _ => self.pending.push_back(risk),
        }
    }

    /// Drops the least severe findings if there are too many.
    pub(super) fn bound_findings(&mut self) {
        if self.findings.len() >= 2 * MAX_FINDINGS {
            self.keep_worst();
        }
    }

    fn keep_worst(&mut self) {
        let by_severity = |a: &Finding, b: &Finding| {
            b.severity
                .cmp(&a.severity)
                .then(a.from_s.total_cmp(&b.from_s))
        };
        self.findings.sort_by(by_severity);
        let left_out = self.findings.len().saturating_sub(MAX_FINDINGS);
        self.findings.truncate(MAX_FINDINGS);
        self.findings_left_out += left_out as u64;
    }

    /// Drops every other step, and doubles the distance between steps from now on.
    pub(super) fn widen_steps(&mut self) {
        every_other(&mut self.steps);
        every_other(&mut self.uncertain);
        let span_s = match (self.steps.first(), self.steps.last()) {
            (Some(first), Some(last)) => last.t_s - first.t_s,
            _ => 0.0,
        };
        let mean_s = span_s / (MAX_STEPS / 2) as f64;
        self.widened_step_s = Some(self.widened_step_s.map_or(mean_s, |s| mean_s.max(2.0 * s)));
    }

    /// Counts the pending risks up to the given time, which a landing can no longer withdraw.
    pub(super) fn count_pending(&mut self, until_s: f64) {
        while let Some(risk) = self.pending.front().filter(|risk| risk.t_s <= until_s) {
            self.judged_s += risk.held_s;
            self.risk_times_s += risk.risk_times_s;
            Peak::keep_larger(&mut self.summary.risk_max, risk.t_s, risk.risk_pct);
            if let Some(elevated_pct) = risk.elevated_risk_pct {
                Peak::keep_larger(&mut self.summary.elevated_risk_max, risk.t_s, elevated_pct);
            }
            self.pending.pop_front();
        }
    }

    /// Handles a landing: the time after `from_s` is not judged.
    fn retract(&mut self, from_s: f64) {
        self.count_pending(from_s);
        self.pending.clear();
        for step in self.steps.iter_mut().rev() {
            if step.t_s <= from_s {
                break;
            }
            step.judged = false;
        }
    }

    /// Computes the intervals of the steps' risks and of the findings' highest risks.
    pub(super) fn bound_risks(&mut self, estimator: &Estimator) {
        let of_each_risk = core::iter::once(estimator).chain(estimator.others());
        for (risk, (estimator, peaks)) in of_each_risk.zip(&self.peaks).enumerate() {
            let has_steps = risk == 0 && self.uncertain.iter().any(Option::is_some);
            if peaks.is_empty() && !has_steps {
                continue;
            }
            let mut bounds = RiskBounds::new(estimator);
            if has_steps {
                for (step, risk) in self.steps.iter_mut().zip(&self.uncertain) {
                    step.risk_interval = risk.as_ref().and_then(|risk| bounds.of(risk));
                }
            }
            let output = (risk > 0).then(|| estimator.profile().output.as_str());
            let is_of_risk = |finding: &&mut Finding| {
                finding.measure == Measure::Risk && finding.risk_output.as_deref() == output
            };
            for finding in self.findings.iter_mut().filter(is_of_risk) {
                let risk = UncertainPeak::find(peaks, finding.from_s);
                finding.risk_interval = risk.and_then(|risk| bounds.of(risk));
            }
        }
    }

    pub(super) fn assessment(
        mut self,
        known_in_air_s: Option<f64>,
        profile: &Profile,
    ) -> Assessment {
        self.keep_worst();
        let share = |part: f64, whole: f64| (whole > 0.0).then(|| part / whole);
        let summary = Summary {
            in_air_s: known_in_air_s.unwrap_or(self.summary.in_air_s),
            risk_mean_pct: share(self.risk_times_s, self.judged_s),
            saturated_share: share(self.saturated as f64, self.motor_samples as f64),
            ..self.summary
        };
        Assessment {
            verdict: self.verdict(&summary, profile),
            findings: self.findings,
            findings_left_out: self.findings_left_out,
            summary,
            inputs: profile.inputs.iter().map(|i| i.name.clone()).collect(),
            other_risks: profile
                .other_risks
                .iter()
                .map(|risk| risk.output.clone())
                .collect(),
            assumed_inputs: AssumedInput::of(&self.assumed, profile),
            unknown_risks: UnknownRisk::of(&self.unknown, profile),
            steps: self.steps,
            widened_step_s: self.widened_step_s,
        }
    }

    /// The verdict. Without findings the flight is GOOD only if the risk was known for most of the time in the air, the
    /// commands of all motors were known except for short periods, and the clock never went back.
    fn verdict(&self, summary: &Summary, profile: &Profile) -> Verdict {
        let knows_enough =
            summary.assessed_s > 0.0 && summary.assessed_s >= KNOWN_SHARE * summary.in_air_s;
        let worst = self.findings.first().map(|finding| finding.severity);
        let lost = self
            .losses
            .reason(summary.in_air_s, profile.sampling.longest_gap_s);
        match (worst.filter(|level| *level > Level::Info), lost) {
            (Some(worst), _) => Verdict::Known(worst),
            (None, Some(lost)) => Verdict::NotAvailable(lost),
            (None, None) if knows_enough && summary.risk_max.is_none() => {
                Verdict::NotAvailable(Reason::TooShort {
                    in_air_s: summary.in_air_s,
                    quiet_s: profile.verdict.quiet_after_take_off_s,
                })
            }
            (None, None) if knows_enough => Verdict::Known(Level::Good),
            (None, None) => {
                Verdict::NotAvailable(match UnknownTime::longest(self.unknown.iter()) {
                    Some(UnknownTime {
                        reason: Unknown::WarmingUp { .. },
                        ..
                    }) if summary.in_air_s <= profile.verdict.quiet_after_take_off_s => {
                        Reason::TooShort {
                            in_air_s: summary.in_air_s,
                            quiet_s: profile.verdict.quiet_after_take_off_s,
                        }
                    }
                    Some(UnknownTime {
                        reason: unknown,
                        total_s,
                        ..
                    }) => Reason::RiskUnknown {
                        unknown: *unknown,
                        explanation: match unknown {
                            Unknown::OnGround => {
                                "the motors idle for most of the time in the air".into()
                            }
                            _ if *total_s < WHOLE_SHARE * summary.in_air_s => format!(
                                "{} for {:.0} % of the time in the air",
                                unknown.explain(profile),
                                100.0 * total_s / summary.in_air_s
                            ),
                            _ => unknown.explain(profile),
                        },
                        help: None,
                    },
                    None => Reason::NoSamples,
                })
            }
        }
    }
}

/// Drops every second element.
fn every_other<T>(all: &mut Vec<T>) {
    let mut index = 0;
    all.retain(|_| {
        index += 1;
        index % 2 == 1
    });
}

/// Whether two reasons are of the same kind and, if they name an input, name the same input.
fn is_same(a: &Unknown, b: &Unknown) -> bool {
    let input = |reason: &Unknown| match reason {
        Unknown::WarmingUp { input }
        | Unknown::TooFewSamples { input, .. }
        | Unknown::NoValue { input } => Some(*input),
        _ => None,
    };
    core::mem::discriminant(a) == core::mem::discriminant(b) && input(a) == input(b)
}

state! {
    struct Flight {
        findings, findings_left_out, steps, uncertain, peaks, next_step_s, widened_step_s, last, summary, judged_s,
        risk_times_s, motor_samples, saturated, unknown, losses, assumed, pending
    }
    struct PreviousSample { t_s, in_air }
    struct Pending { t_s, held_s, risk_times_s, risk_pct, elevated_risk_pct }
}
