//! The assessment of a whole flight: its verdict, findings, steps and summary.

use alloc::vec::Vec;

use crate::{
    estimator::Estimator,
    monitor::{Craft, Monitor, MonitorError, Sample, Unknown, Update},
    state::{self, Reader, State},
    verdict::EndedFindings,
};

mod assessment;
pub use assessment::{Assessment, AssumedInput, Peak, Step, Summary, UnknownRisk};

mod finding;
pub use finding::{Cause, Finding};

pub use crate::state::StateError;

mod loss;

mod results;
use results::Flight;

mod uncertainty;
pub use uncertainty::RiskInterval;
use uncertainty::{UncertainPeak, UncertainRisk};

mod verdict;
pub use verdict::{Reason, Verdict};

mod words;
pub use words::Words;

#[cfg(feature = "serde")]
mod serialize;
#[cfg(feature = "serde")]
pub use serialize::{NamedStep, Steps, VerdictWord};

/// The maximum number of steps that are kept per flight: seven hours at 10 Hz.
pub const MAX_STEPS: usize = 250_000;
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

#[cfg(test)]
mod tests;
