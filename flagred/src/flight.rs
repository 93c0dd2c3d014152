//! The assessment of a whole flight: its verdict, findings, steps and summary.

use alloc::{collections::VecDeque, vec::Vec};

use crate::{
    estimator::Estimator,
    margin::margin,
    monitor::{Craft, Monitor, MonitorError, Sample, Unknown, Update},
    motor::counted,
    profile::Profile,
    state::{self, Reader, State},
    verdict::{EndedFindings, Level, Measure},
};

mod assessment;
use assessment::UnknownTime;
pub use assessment::{Assessment, AssumedInput, Peak, Step, Summary, UnknownRisk};

mod finding;
pub use finding::{Cause, Finding};

pub use crate::state::StateError;

mod loss;
use loss::Losses;

mod uncertainty;
pub use uncertainty::RiskInterval;
use uncertainty::{RiskBounds, UncertainPeak, UncertainRisk};

mod verdict;
pub use verdict::{Reason, Verdict};

mod words;
pub use words::Words;

#[cfg(feature = "serde")]
mod serialize;
#[cfg(feature = "serde")]
pub use serialize::{NamedStep, Steps, VerdictWord};

/// The share of the time in the air for which the risk must be known for a verdict of GOOD.
const KNOWN_SHARE: f64 = 0.5;
/// A reason that applies for at least this share of the time in the air is reported without its share.
const WHOLE_SHARE: f64 = 0.95;

/// The maximum number of findings that are kept per flight. The most severe ones are kept.
const MAX_FINDINGS: usize = 1000;
/// The maximum number of steps that are kept per flight: seven hours at 10 Hz.
pub const MAX_STEPS: usize = 250_000;
/// Judged risks that a landing could still withdraw are merged if the time between them is less than this, in seconds.
const PENDING_S: f64 = 1e-4;

/// The margin below which a motor counts as saturated.
const SATURATED_MARGIN: f64 = 0.005;

/// Drops every second element.
fn every_other<T>(all: &mut Vec<T>) {
    let mut index = 0;
    all.retain(|_| {
        index += 1;
        index % 2 == 1
    });
}

/// Whether two reasons differ only in their numbers.
fn is_same(a: &Unknown, b: &Unknown) -> bool {
    let input = |reason: &Unknown| match reason {
        Unknown::WarmingUp { input }
        | Unknown::TooFewSamples { input, .. }
        | Unknown::NoValue { input } => Some(*input),
        _ => None,
    };
    core::mem::discriminant(a) == core::mem::discriminant(b) && input(a) == input(b)
}

/// Assesses flights sample by sample.
///
/// # Example: motors at their limits
/// ```
/// use flagred::{flight::Assessor, monitor::{Craft, Sample}, shipped};
///
/// let mut assessor = Assessor::new(&shipped::flagred(), Craft::new(4), Some(0.5))?;
/// for i in 0..1500 {
///     let t_s = f64::from(i) * 0.02;
///     let motors = if t_s < 20.0 { [0.5; 4] } else { [1.0, 0.0, 1.0, 0.0] };
///     assessor.push(&Sample { t_s, motors: &motors, in_air: Some(true), signals: &[] });
/// }
/// let assessment = assessor.finish();
/// assert_eq!(assessment.verdict.to_string(), "FAIL");
/// assert!(assessment.findings[0].from_s > 20.0 && assessment.findings[0].from_s < 25.0);
/// assert_eq!(assessment.steps.len(), 60);
/// # Ok::<(), flagred::monitor::MonitorError>(())
/// ```
#[derive(Debug, Clone)]
pub struct Assessor {
    monitor: Monitor,
    /// The distance between steps in seconds; `None` keeps no steps.
    step_s: Option<f64>,
    /// Whether steps have intervals of their risks.
    has_intervals: bool,
    known_in_air_s: Option<f64>,
    flight: Flight,
    /// The number of findings that had ended before the latest sample.
    ended_before: usize,
}

/// The sums and results of a flight so far.
#[derive(Debug, Clone)]
struct Flight {
    findings: Vec<Finding>,
    findings_left_out: u64,
    steps: Vec<Step>,
    /// The risk of each step with the intervals of its inputs; `None` if it is unknown.
    uncertain: Vec<Option<UncertainRisk>>,
    /// The highest risks of the findings: those of the profile's `output`, then those of each of the other risks.
    peaks: Vec<Vec<UncertainPeak>>,
    next_step_s: f64,
    widened_step_s: Option<f64>,
    last: Option<PreviousSample>,
    summary: Summary,
    judged_s: f64,
    risk_times_s: f64,
    motor_samples: u64,
    saturated: u64,
    /// The reasons why each risk was unknown.
    unknown: Vec<UnknownTime>,
    losses: Losses,
    /// The indices of the inputs whose values were assumed, not measured, while the vehicle was in the air.
    assumed: Vec<usize>,
    /// Judged risks that a landing would still withdraw, in order of time.
    pending: VecDeque<Pending>,
}

/// The previous sample.
#[derive(Debug, Clone, Copy)]
struct PreviousSample {
    t_s: f64,
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

impl Assessor {
    /// Creates an assessor of a craft's flights. It keeps a step every `step_s` seconds; if `step_s` is `None`, it
    /// keeps no steps.
    ///
    /// # Errors
    ///
    /// As [`Monitor::new`].
    pub fn new(
        estimator: &Estimator,
        craft: Craft<'_>,
        step_s: Option<f64>,
    ) -> Result<Assessor, MonitorError> {
        Ok(Assessor {
            monitor: Monitor::new(estimator, craft)?,
            step_s,
            has_intervals: false,
            known_in_air_s: None,
            flight: Flight::new(),
            ended_before: 0,
        })
    }

    /// Makes the assessor compute the interval of the risk of each step from now on. This takes longer than the rest of
    /// the assessment.
    pub fn with_intervals(mut self) -> Assessor {
        self.has_intervals = true;
        self
    }

    /// The monitor that processes the samples.
    pub fn monitor(&self) -> &Monitor {
        &self.monitor
    }

    /// Processes a sample, in the air or on the ground.
    pub fn push(&mut self, sample: &Sample<'_>) -> Update {
        let update = self.monitor.push(sample);
        self.keep_findings(update.ended);
        if update.risk == Err(Unknown::OutOfOrder) {
            let is_repeated = self.flight.last.is_some_and(|last| last.t_s == sample.t_s);
            if !is_repeated && !sample.is_on_ground() {
                self.flight.losses.ignore_sample();
            }
        } else {
            let profile = self.monitor.estimator().profile();
            let elsewhere = self.monitor.unknown_other_risks();
            let elsewhere = elsewhere.map(|(risk, reason)| (risk + 1, reason));
            let first = update.risk.err().map(|reason| (0, reason));
            let unknown = first.into_iter().chain(elsewhere);
            self.flight.add(&update, sample, profile, unknown);
            if !sample.is_on_ground() {
                self.keep_step(&update);
                for input in self.monitor.assumed() {
                    if !self.flight.assumed.contains(&input) {
                        self.flight.assumed.push(input);
                    }
                }
            }
        }
        update
    }

    /// Sets the time in the air of this flight, in seconds, if it is known from another source. By default it is summed
    /// over the samples, which is too short if samples are missing at the start or end.
    pub fn set_in_air_s(&mut self, in_air_s: f64) {
        self.known_in_air_s = Some(in_air_s);
    }

    /// The finding behind the current level, with its values so far; `None` while the level is good.
    pub fn open_finding(&self) -> Option<Finding> {
        if let Some(of_risk) = self.monitor.open_other_risk() {
            return Some(Finding::of_other_risk(&of_risk, self.monitor.estimator()));
        }
        let found = self.monitor.open_finding()?;
        Some(Finding::new(found, self.monitor.estimator()))
    }

    /// The worst open finding that is not about the risk, with its values so far: see [`Monitor::open_notice`].
    pub fn open_notice(&self) -> Option<Finding> {
        let found = self.monitor.open_notice()?;
        Some(Finding::new(found, self.monitor.estimator()))
    }

    /// The findings that ended with the latest sample, or with [`Assessor::end_findings`].
    pub fn ended(&self) -> &[Finding] {
        self.flight.findings.get(self.ended_before..).unwrap_or(&[])
    }

    /// Ends the findings that are still open, and returns them.
    pub fn end_findings(&mut self) -> &[Finding] {
        let ended = self.monitor.finish();
        self.keep_findings(ended);
        self.ended()
    }

    fn keep_findings(&mut self, ended: EndedFindings) {
        self.flight.bound_findings();
        self.ended_before = self.flight.findings.len();
        for found in ended.into_iter().flatten() {
            let finding = Finding::new(found, self.monitor.estimator());
            self.flight.findings.push(finding);
        }
        for of_risk in self.monitor.ended_other_risks() {
            let finding = Finding::of_other_risk(of_risk, self.monitor.estimator());
            self.flight.findings.push(finding);
        }
    }

    /// Ends the flight and returns its assessment. Samples that follow belong to a new flight.
    pub fn finish(&mut self) -> Assessment {
        self.end_findings();
        let mut flight = core::mem::replace(&mut self.flight, Flight::new());
        flight.count_pending(f64::INFINITY);
        let known_in_air_s = self.known_in_air_s.take();
        self.ended_before = 0;
        flight.bound_risks(self.monitor.estimator());
        flight.assessment(known_in_air_s, self.monitor.estimator().profile())
    }

    /// The state after the latest sample as bytes, with the findings and steps so far: see [`Assessor::restore`].
    ///
    /// # Example: the second half of a flight in another process
    /// ```
    /// use flagred::{flight::Assessor, monitor::{Craft, Sample}, shipped};
    ///
    /// let hover = |assessor: &mut Assessor, from: u32| {
    ///     for i in from..from + 500 {
    ///         assessor.push(&Sample { t_s: f64::from(i) * 0.02, motors: &[0.5; 4], in_air: Some(true), signals: &[] });
    ///     }
    /// };
    /// let estimator = shipped::flagred();
    /// let mut one = Assessor::new(&estimator, Craft::new(4), Some(0.5))?;
    /// hover(&mut one, 0);
    /// let state = one.state();
    /// let mut other = Assessor::new(&estimator, Craft::new(4), None)?.restore(&state)?;
    /// hover(&mut one, 500);
    /// hover(&mut other, 500);
    /// assert_eq!(one.finish().summary, other.finish().summary);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn state(&self) -> Vec<u8> {
        let mut bytes = state::begin(&self.monitor.description());
        self.monitor.save(&mut bytes);
        ((self.step_s, self.has_intervals), self.known_in_air_s).save(&mut bytes);
        self.flight.save(&mut bytes);
        self.ended_before.save(&mut bytes);
        state::end(&mut bytes);
        bytes
    }

    /// Sets the state of a new assessor of the same estimator and craft. The results for the rest of the flight
    /// are then bit for bit those of the assessor that [`Assessor::state`] was called on.
    ///
    /// # Errors
    ///
    /// If the bytes are damaged, have the layout of another version, or belong to another profile, rule set or craft.
    pub fn restore(mut self, state: &[u8]) -> Result<Assessor, StateError> {
        let mut from = state::open(state, &self.monitor.description())?;
        self.load(&mut from)
            .filter(|()| from.is_empty())
            .ok_or(StateError::OtherMonitor)?;
        Ok(self)
    }

    fn load(&mut self, from: &mut Reader<'_>) -> Option<()> {
        self.monitor.load(from)?;
        ((self.step_s, self.has_intervals), self.known_in_air_s) = State::load(from)?;
        self.flight = State::load(from)?;
        self.ended_before = State::load(from)?;
        Some(())
    }

    fn keep_step(&mut self, update: &Update) {
        let (Some(step_s), flight) = (self.step_s, &mut self.flight) else {
            return;
        };
        let of_each_risk = self.monitor.of_each_risk();
        flight
            .peaks
            .resize(of_each_risk.clone().count(), Vec::new());
        for (peaks, monitor) in flight.peaks.iter_mut().zip(of_each_risk) {
            UncertainPeak::keep(peaks, &flight.findings, monitor);
        }
        if update.t_s < flight.next_step_s {
            return;
        }
        if flight.steps.len() >= MAX_STEPS {
            flight.widen_steps();
        }
        let step_s = flight.widened_step_s.unwrap_or(step_s);
        // Steps are on a grid of `step_s`. If samples are further apart, every sample is a step.
        flight.next_step_s = match flight.next_step_s + step_s {
            next_s if next_s > update.t_s => next_s,
            _ => update.t_s + step_s,
        };
        let uncertain = self.has_intervals.then(|| UncertainRisk::of(&self.monitor));
        flight.uncertain.push(uncertain.flatten());
        flight.steps.push(Step {
            t_s: update.t_s,
            estimate: update.risk.ok(),
            risk_interval: None,
            elevated_risk_pct: update.elevated_risk_pct,
            margin: self.monitor.margin(),
            spread: self.monitor.spread(),
            judged: update.judged,
            inputs: self.monitor.inputs().to_vec(),
            other_risks_pct: self.monitor.other_risks_pct().collect(),
        });
    }
}

impl Flight {
    fn new() -> Flight {
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
    fn add(
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
    fn bound_findings(&mut self) {
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
    fn widen_steps(&mut self) {
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
    fn count_pending(&mut self, until_s: f64) {
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
    fn bound_risks(&mut self, estimator: &Estimator) {
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

    fn assessment(mut self, known_in_air_s: Option<f64>, profile: &Profile) -> Assessment {
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

state! {
    struct Flight {
        findings, findings_left_out, steps, uncertain, peaks, next_step_s, widened_step_s, last, summary, judged_s,
        risk_times_s, motor_samples, saturated, unknown, losses, assumed, pending
    }
    struct PreviousSample { t_s, in_air }
    struct Pending { t_s, held_s, risk_times_s, risk_pct, elevated_risk_pct }
}

#[cfg(test)]
mod tests;
