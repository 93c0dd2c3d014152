//! The streaming monitor: a sample in, an assessment out.

use alloc::{format, string::String, vec, vec::Vec};

use crate::{
    accumulator::Accumulator,
    estimator::{Estimate, Estimator, Memory},
    profile::Profile,
    source::{Motors, Observer, Signal, Source, Statistic},
    verdict::{Alert, Ended, Finding, Level, Step},
};

/// A moment of a flight.
#[derive(Debug, Clone, Copy)]
pub struct Sample<'a> {
    /// When, in seconds; must not fall.
    pub t_s: f64,
    /// The effective command of each motor in [0, 1]; anything else, such as NaN, is unknown.
    pub motors: &'a [f64],
    /// Whether the vehicle is in the air.
    pub in_air: bool,
    /// The values of the signals that the monitor was told the names of; NaN is unknown.
    pub signals: &'a [f64],
}

/// What is known after a sample.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Assessment {
    /// When, in seconds.
    pub t_s: f64,
    /// The risk of the moment, or why it is unknown.
    pub risk: Result<Estimate, Unknown>,
    /// The elevated risk in %; `None` where the risk is unknown.
    pub elevated_risk_pct: Option<f64>,
    /// The level; `None` on the ground and where the risk has been unknown for long.
    pub level: Option<Level>,
    /// The new level where this sample changed it.
    pub change: Option<Level>,
    /// The findings that ended with this sample.
    pub ended: Ended,
}

/// Why a risk is unknown.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Unknown {
    /// The vehicle is on the ground.
    OnGround,
    /// The time stamp is not after the one before: the sample is repeated, late or damaged, and was left out.
    OutOfOrder,
    /// The window of an input does not reach back far enough yet.
    WarmingUp {
        /// The input, in the order of the profile.
        input: usize,
    },
    /// The window of an input holds too few samples.
    TooFewSamples {
        /// The input, in the order of the profile.
        input: usize,
        /// How many it holds.
        samples: u32,
    },
    /// Nothing is known of the signal of an input.
    NoValue {
        /// The input, in the order of the profile.
        input: usize,
    },
    /// No rule says anything about such inputs, and no part of the map is covered to fill it from.
    NoRule,
}

impl Unknown {
    /// The reason in words, and what helps.
    pub fn explain(&self, profile: &Profile) -> String {
        let name = |input: &usize| {
            let input = profile.inputs.get(*input);
            input.map_or(("", 0.0), |i| (i.name.as_str(), i.source.window_s))
        };
        match self {
            Unknown::OnGround => "on the ground".into(),
            Unknown::OutOfOrder => "the time stamp is not after the one before".into(),
            Unknown::WarmingUp { input } => {
                let (name, window_s) = name(input);
                format!("input `{name}` needs more of its window of {window_s} s")
            }
            Unknown::TooFewSamples { input, samples } => {
                let (name, window_s) = name(input);
                let rate = f64::from(profile.sampling.min_samples) / window_s;
                format!(
                    "input `{name}` has {samples} samples in {window_s} s and needs {}: log the motors at {rate} Hz or more",
                    profile.sampling.min_samples
                )
            }
            Unknown::NoValue { input } => {
                format!(
                    "nothing is known of the signal of input `{}`",
                    name(input).0
                )
            }
            Unknown::NoRule => "no rule says anything about such inputs".into(),
        }
    }
}

/// Why a monitor cannot be made.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum MonitorError {
    /// The profile needs a signal that the flight does not carry.
    #[error("the profile needs the signal `{signal}`, which the flight does not carry")]
    NoSignal {
        /// The signal.
        signal: String,
    },
    /// There is no motor to watch.
    #[error("the flight has no motors")]
    NoMotors,
}

/// Follows one flight, sample by sample.
///
/// After it is made it allocates nothing, its memory does not grow, and a sample costs the same whatever the lengths
/// of the windows.
///
/// # Example: a motor saturates for two seconds
///
/// ```
/// use flagred::{estimator::Estimator, monitor::{Monitor, Sample}, shipped, verdict::Level};
///
/// let profile = shipped::profile("flagred-paper").ok_or("not shipped")??;
/// let rules = shipped::rule_set(&profile.rules).ok_or("not shipped")??;
/// let estimator = Estimator::new(&profile, &rules)?;
/// let mut monitor = Monitor::new(&estimator, 4, &[])?;
///
/// let mut level = None;
/// for i in 0..500 {
///     let t_s = f64::from(i) * 0.04;
///     let hovering = [0.4, 0.4, 0.41, 0.41];
///     let saturated = [0.0, 1.0, 0.05, 1.0];
///     let motors = if t_s < 10.0 { hovering } else { saturated };
///     let assessment = monitor.push(&Sample { t_s, motors: &motors, in_air: true, signals: &[] });
///     level = assessment.level.max(level);
/// }
/// assert_eq!(level, Some(Level::Fail));
/// let [warn, fail] = monitor.finish();
/// let finding = warn.or(fail).ok_or("no finding")?;
/// assert!(finding.from_s > 10.0 && finding.from_s < 15.0);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug, Clone)]
pub struct Monitor<'a> {
    estimator: &'a Estimator,
    memory: Memory,
    observer: Observer,
    /// The values of the inputs after the latest sample; NaN is unknown.
    inputs: Vec<f64>,
    /// The motors of the latest sample; NaN is unknown.
    motors: Vec<f64>,
    accumulator: Accumulator,
    alert: Alert,
    last_s: Option<f64>,
    in_air_since_s: Option<f64>,
    last_known_s: Option<f64>,
}

impl<'a> Monitor<'a> {
    /// A monitor for a vehicle with so many motors, whose samples carry the named signals in this order.
    ///
    /// # Errors
    ///
    /// Where the profile needs a signal that is not among them, or there is no motor.
    pub fn new(
        estimator: &'a Estimator,
        motors: usize,
        signals: &[&str],
    ) -> Result<Monitor<'a>, MonitorError> {
        if motors == 0 {
            return Err(MonitorError::NoMotors);
        }
        let profile = estimator.profile();
        let always = [
            (Statistic::Mean, Signal::MotorMargin),
            (Statistic::Std, Signal::MotorCommand),
        ]
        .map(|(statistic, signal)| Source {
            statistic,
            motors: Motors::Pooled,
            signal,
            window_s: profile.window_s,
        });
        let sources = profile.inputs.iter().map(|input| &input.source);
        let observer = Observer::new(sources.chain(&always), signals)
            .map_err(|signal| MonitorError::NoSignal { signal })?;
        Ok(Monitor {
            memory: Memory::of(estimator),
            inputs: vec![f64::NAN; profile.inputs.len()],
            motors: vec![f64::NAN; motors],
            observer,
            accumulator: Accumulator::new(profile.elevated_risk),
            alert: Alert::new(profile.verdict, motors),
            estimator,
            last_s: None,
            in_air_since_s: None,
            last_known_s: None,
        })
    }

    /// Takes a sample in.
    pub fn push(&mut self, sample: &Sample<'_>) -> Assessment {
        let t_s = sample.t_s;
        let mut step = Step::default();
        let longest_gap_s = self.estimator.profile().sampling.longest_gap_s;
        let held_s = match self.last_s {
            _ if !t_s.is_finite() => return self.unknown(t_s, Unknown::OutOfOrder, step),
            None => 0.0,
            Some(last_s) if t_s <= last_s && last_s - t_s <= longest_gap_s => {
                return self.unknown(t_s, Unknown::OutOfOrder, step);
            }
            // A jump, forward (a lost link) or back (a vehicle that restarted): what was before is no guide.
            Some(last_s) if !(0.0..=longest_gap_s).contains(&(t_s - last_s)) => {
                step = self.forget(last_s, false);
                0.0
            }
            Some(last_s) => t_s - last_s,
        };
        self.last_s = Some(t_s);
        if !sample.in_air {
            if self.in_air_since_s.is_some() {
                step = self.forget(t_s, true);
            }
            return self.unknown(t_s, Unknown::OnGround, step);
        }
        let in_air_since_s = *self.in_air_since_s.get_or_insert(t_s);

        self.motors.fill(f64::NAN);
        for (kept, e) in self.motors.iter_mut().zip(sample.motors) {
            if (0.0..=1.0).contains(e) {
                *kept = *e;
            }
        }
        self.observer
            .push(t_s, held_s, &self.motors, sample.signals);
        let risk = self.estimate();
        let Ok(estimate) = risk else {
            let known_s = self.last_known_s.unwrap_or(t_s);
            if t_s - known_s > longest_gap_s {
                step = self.stop_judging(known_s, false);
            }
            let reason = risk.err().unwrap_or(Unknown::NoRule);
            return self.unknown(t_s, reason, step);
        };
        self.last_known_s = Some(t_s);
        let elevated = self.accumulator.push(t_s, held_s, estimate.risk_pct);
        if t_s - in_air_since_s >= self.estimator.profile().verdict.quiet_after_take_off_s {
            let judged = self
                .alert
                .push(t_s, estimate.risk_pct, elevated, &self.motors);
            step = Step {
                change: judged.change.or(step.change),
                // Both at once cannot be: what was just forgotten takes a while to be raised again.
                ended: if step.ended == [None; 2] {
                    judged.ended
                } else {
                    step.ended
                },
            };
        }
        Assessment {
            t_s,
            risk,
            elevated_risk_pct: Some(self.accumulator.elevated_risk_pct()),
            level: Some(self.alert.level()),
            change: step.change,
            ended: step.ended,
        }
    }

    /// The values of the inputs after the latest sample, in the order of the profile; NaN is unknown.
    pub fn inputs(&self) -> &[f64] {
        &self.inputs
    }

    /// The finding that the level rests on, as it stands so far; `None` while the level is good.
    pub fn open_finding(&self) -> Option<Finding> {
        self.alert.open()
    }

    /// Ends the flight: the findings that were still open.
    pub fn finish(&mut self) -> Ended {
        self.last_s
            .map_or([None; 2], |last_s| self.forget(last_s, false).ended)
    }

    /// The mean margin over all motors and the profile's window: the paper's first input, whatever the rules look at.
    pub fn margin(&self) -> Option<f64> {
        self.reading(self.inputs.len()).ok()
    }

    /// The standard deviation of the effective commands over all motors and the profile's window: the paper's second
    /// input, whatever the rules look at.
    pub fn spread(&self) -> Option<f64> {
        self.reading(self.inputs.len() + 1).ok()
    }

    fn estimate(&mut self) -> Result<Estimate, Unknown> {
        let mut reason = None;
        for input in 0..self.inputs.len() {
            let value = self.reading(input).unwrap_or_else(|unknown| {
                reason.get_or_insert(unknown);
                f64::NAN
            });
            if let Some(kept) = self.inputs.get_mut(input) {
                *kept = value;
            }
        }
        match reason {
            Some(reason) => Err(reason),
            None => self
                .estimator
                .estimate(&self.inputs, &mut self.memory)
                .ok_or(Unknown::NoRule),
        }
    }

    /// The value of an input, where enough is known of its window.
    fn reading(&self, input: usize) -> Result<f64, Unknown> {
        let sampling = self.estimator.profile().sampling;
        let observation = self
            .observer
            .value(input)
            .ok_or(Unknown::NoValue { input })?;
        // A window that is full to a sample's time or so is full.
        let needed_s = sampling.warm_up_s.min(observation.window_s) * 0.99;
        match observation.samples {
            Some(_) if observation.covered_s < needed_s => Err(Unknown::WarmingUp { input }),
            Some(samples) if samples < sampling.min_samples => {
                Err(Unknown::TooFewSamples { input, samples })
            }
            _ => Ok(observation.value),
        }
    }

    /// An assessment without a risk.
    fn unknown(&mut self, t_s: f64, reason: Unknown, step: Step) -> Assessment {
        let judging = self.in_air_since_s.is_some() && self.last_known_s.is_some();
        Assessment {
            t_s,
            risk: Err(reason),
            elevated_risk_pct: None,
            level: judging.then(|| self.alert.level()),
            change: step.change,
            ended: step.ended,
        }
    }

    /// Starts anew: what is behind says nothing about what comes.
    fn forget(&mut self, t_s: f64, landed: bool) -> Step {
        self.observer.clear();
        self.inputs.fill(f64::NAN);
        self.in_air_since_s = None;
        self.stop_judging(t_s, landed)
    }

    fn stop_judging(&mut self, t_s: f64, landed: bool) -> Step {
        self.accumulator.clear();
        self.last_known_s = None;
        self.alert.end(t_s, landed)
    }
}

#[cfg(test)]
mod tests;
