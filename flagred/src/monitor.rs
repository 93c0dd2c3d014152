//! The streaming monitor: a sample in, an assessment out.

use alloc::{format, string::String, vec, vec::Vec};

use crate::{
    channel::{Channel, Input, Seen},
    estimator::{Estimator, Memory},
    follower::{Follower, Room, reading},
    profile::Profile,
    source::{Motors, Signal, Source, Statistic, channels},
    verdict::{Ended, Finding, Motor},
    window::Window,
};

pub use crate::assessment::{Assessment, Sample, Unknown};

impl Unknown {
    /// The reason in words, and what helps.
    ///
    /// # Example: a log of one sample a second
    /// ```
    /// use flagred::{monitor::Unknown, shipped};
    ///
    /// let profile = shipped::profile("flagred-paper").ok_or("not shipped")??;
    /// let why = Unknown::TooFewSamples { input: 1, samples: 2 }.explain(&profile);
    /// assert_eq!(why, "input `spread` has 2 samples in 2 s and needs 5: log the motors at 2.5 Hz or more");
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
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
///
/// # Example: a battery that nobody tells of
/// ```
/// # use flagred::{estimator::Estimator, profile::Profile, shipped, source::Signal};
/// # let mut profile = shipped::profile("flagred-paper").ok_or("not shipped")??;
/// # let rules = shipped::rule_set(&profile.rules).ok_or("not shipped")??;
/// use flagred::monitor::{Monitor, MonitorError};
///
/// profile.inputs[1].source.signal = Signal::named("battery_v");
/// let estimator = Estimator::new(&profile, &rules)?;
/// assert!(Monitor::new(&estimator, 4, &["battery_v"]).is_ok());
/// let refused = Monitor::new(&estimator, 4, &[]).unwrap_err();
/// assert_eq!(refused, MonitorError::NoSignal { signal: "battery_v".into() });
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
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
    channels: Vec<Channel>,
    inputs: Vec<Input>,
    room: OwnRoom,
    follower: Follower,
}

/// What is kept of a flight beside the follower: allocated once.
#[derive(Debug, Clone)]
struct OwnRoom {
    risks: Window,
    seen: Vec<Seen>,
    inputs: Vec<f64>,
    motors: Vec<Motor>,
}

impl<'a> Monitor<'a> {
    /// A monitor for a vehicle with so many motors, whose samples carry the named signals in this order.
    ///
    /// # Errors
    ///
    /// Where the profile needs a signal that is not among them, or there is no motor.
    ///
    /// # Example: samples that carry a signal beside the motors
    /// ```
    /// # use flagred::{estimator::Estimator, profile::Profile, shipped, source::Signal};
    /// # let mut profile = shipped::profile("flagred-paper").ok_or("not shipped")??;
    /// # let rules = shipped::rule_set(&profile.rules).ok_or("not shipped")??;
    /// use flagred::monitor::{Monitor, MonitorError, Sample};
    ///
    /// profile.inputs[0].source.signal = Signal::named("margin_of_thrust"); // in place of the motors' own
    /// let estimator = Estimator::new(&profile, &rules)?;
    /// let mut monitor = Monitor::new(&estimator, 4, &["wind_m_s", "margin_of_thrust"])?;
    /// for i in 0..100 {
    ///     let t_s = f64::from(i) * 0.04;
    ///     monitor.push(&Sample { t_s, motors: &[0.5; 4], in_air: true, signals: &[3.0, 0.3] });
    /// }
    /// assert!((monitor.inputs()[0] - 0.3).abs() < 1e-9);
    /// assert_eq!(Monitor::new(&estimator, 0, &["margin_of_thrust"]).err(), Some(MonitorError::NoMotors));
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
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
        let (channels, inputs) = channels(sources.chain(&always), signals)
            .map_err(|signal| MonitorError::NoSignal { signal })?;
        let seen = channels.iter().map(|channel| Seen::new(channel.window_s));
        Ok(Monitor {
            memory: Memory::of(estimator),
            room: OwnRoom {
                risks: Window::new(profile.elevated_risk.window_s),
                seen: seen.collect(),
                inputs: vec![f64::NAN; profile.inputs.len()],
                motors: vec![Motor::UNKNOWN; motors],
            },
            channels,
            inputs,
            follower: Follower::new(profile.settings()),
            estimator,
        })
    }

    /// Takes a sample in.
    ///
    /// # Example: hovering in still air
    /// ```
    /// # use flagred::{assessment::Sample, estimator::Estimator, monitor::Monitor, shipped};
    /// # let profile = shipped::profile("flagred-paper").ok_or("not shipped")??;
    /// # let rules = shipped::rule_set(&profile.rules).ok_or("not shipped")??;
    /// # let estimator = Estimator::new(&profile, &rules)?;
    /// # let mut monitor = Monitor::new(&estimator, 4, &[])?;
    /// let mut risk_pct = None;
    /// for i in 0..100 {
    ///     let t_s = f64::from(i) * 0.04;
    ///     let said = monitor.push(&Sample { t_s, motors: &[0.5; 4], in_air: true, signals: &[] });
    ///     risk_pct = said.risk.ok().map(|estimate| estimate.risk_pct);
    /// }
    /// assert!(risk_pct.is_some_and(|risk_pct| risk_pct < 10.0));
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn push(&mut self, sample: &Sample<'_>) -> Assessment {
        let Monitor {
            estimator,
            memory,
            channels,
            inputs,
            room,
            follower,
        } = self;
        follower.push((channels, inputs), &mut room.lend(), sample, |inputs| {
            estimator.estimate(inputs, memory)
        })
    }

    /// The values of the inputs after the latest sample, in the order of the profile; NaN is unknown.
    ///
    /// # Example: two motors at 0.4 and two at 0.6
    /// ```
    /// # use flagred::{assessment::Sample, estimator::Estimator, monitor::Monitor, shipped};
    /// # let profile = shipped::profile("flagred-paper").ok_or("not shipped")??;
    /// # let rules = shipped::rule_set(&profile.rules).ok_or("not shipped")??;
    /// # let estimator = Estimator::new(&profile, &rules)?;
    /// # let mut monitor = Monitor::new(&estimator, 4, &[])?;
    /// assert!(monitor.inputs().iter().all(|value| value.is_nan()), "nothing is known yet");
    /// for i in 0..100 {
    ///     let t_s = f64::from(i) * 0.04;
    ///     monitor.push(&Sample { t_s, motors: &[0.4, 0.6, 0.4, 0.6], in_air: true, signals: &[] });
    /// }
    /// let [margin, spread] = monitor.inputs() else { return Err("two inputs".into()) };
    /// assert!((margin - 0.4).abs() < 1e-9 && (spread - 0.1).abs() < 1e-9);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn inputs(&self) -> &[f64] {
        &self.room.inputs
    }

    /// The finding that the level rests on, as it stands so far; `None` while the level is good.
    ///
    /// # Example: while motors are at their limits
    /// ```
    /// # use flagred::{assessment::Sample, estimator::Estimator, monitor::Monitor, shipped};
    /// # let profile = shipped::profile("flagred-paper").ok_or("not shipped")??;
    /// # let rules = shipped::rule_set(&profile.rules).ok_or("not shipped")??;
    /// # let estimator = Estimator::new(&profile, &rules)?;
    /// # let mut monitor = Monitor::new(&estimator, 4, &[])?;
    /// for i in 0..300 {
    ///     let t_s = f64::from(i) * 0.04;
    ///     let motors = if t_s < 10.0 { [0.5; 4] } else { [0.0, 1.0, 0.0, 1.0] };
    ///     monitor.push(&Sample { t_s, motors: &motors, in_air: true, signals: &[] });
    ///     assert!(t_s >= 10.0 || monitor.open_finding().is_none());
    /// }
    /// assert!(monitor.open_finding().is_some_and(|finding| finding.peak_pct >= finding.threshold_pct));
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn open_finding(&self) -> Option<Finding> {
        self.follower.open_finding(&self.room.motors)
    }

    /// Ends the flight: the findings that were still open.
    ///
    /// # Example: a log that ends in trouble
    /// ```
    /// # use flagred::{assessment::Sample, estimator::Estimator, monitor::Monitor, shipped};
    /// # let profile = shipped::profile("flagred-paper").ok_or("not shipped")??;
    /// # let rules = shipped::rule_set(&profile.rules).ok_or("not shipped")??;
    /// # let estimator = Estimator::new(&profile, &rules)?;
    /// # let mut monitor = Monitor::new(&estimator, 4, &[])?;
    /// for i in 0..300 {
    ///     let t_s = f64::from(i) * 0.04;
    ///     let motors = if t_s < 10.0 { [0.5; 4] } else { [0.0, 1.0, 0.0, 1.0] };
    ///     monitor.push(&Sample { t_s, motors: &motors, in_air: true, signals: &[] });
    /// }
    /// let [warn, fail] = monitor.finish();
    /// assert!(warn.is_some() && fail.is_some_and(|fail| fail.to_s > 11.9));
    /// assert_eq!(monitor.finish(), [None, None]); // they are told once
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn finish(&mut self) -> Ended {
        self.follower.finish(&mut self.room.lend())
    }

    /// The mean margin over all motors and the profile's window: the paper's first input, whatever the rules look at.
    ///
    /// # Example: with rules that ask for something else
    /// ```
    /// # use flagred::{assessment::Sample, estimator::Estimator, monitor::Monitor, shipped};
    /// let profile = shipped::profile("flagred").ok_or("not shipped")??; // its inputs have other names
    /// # let rules = shipped::rule_set(&profile.rules).ok_or("not shipped")??;
    /// # let estimator = Estimator::new(&profile, &rules)?;
    /// # let mut monitor = Monitor::new(&estimator, 4, &[])?;
    /// assert_eq!(monitor.margin(), None);
    /// for i in 0..100 {
    ///     let t_s = f64::from(i) * 0.04;
    ///     monitor.push(&Sample { t_s, motors: &[0.25, 0.5, 0.5, 0.75], in_air: true, signals: &[] });
    /// }
    /// assert!(monitor.margin().is_some_and(|margin| (margin - 0.375).abs() < 1e-9));
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn margin(&self) -> Option<f64> {
        self.reading(self.room.inputs.len())
    }

    /// The standard deviation of the effective commands over all motors and the profile's window: the paper's second
    /// input, whatever the rules look at.
    ///
    /// # Example: a saturated motor beside three that rest in the middle
    /// ```
    /// # use flagred::{assessment::Sample, estimator::Estimator, monitor::Monitor, shipped};
    /// # let profile = shipped::profile("flagred-paper").ok_or("not shipped")??;
    /// # let rules = shipped::rule_set(&profile.rules).ok_or("not shipped")??;
    /// # let estimator = Estimator::new(&profile, &rules)?;
    /// # let mut monitor = Monitor::new(&estimator, 4, &[])?;
    /// for i in 0..100 {
    ///     let t_s = f64::from(i) * 0.04;
    ///     monitor.push(&Sample { t_s, motors: &[0.5, 0.5, 0.5, 1.0], in_air: true, signals: &[] });
    /// }
    /// let expected = 0.046875_f64.sqrt(); // the mean square of 0.125, 0.125, 0.125 and 0.375
    /// assert!(monitor.spread().is_some_and(|spread| (spread - expected).abs() < 1e-9));
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn spread(&self) -> Option<f64> {
        self.reading(self.room.inputs.len() + 1)
    }

    fn reading(&self, input: usize) -> Option<f64> {
        let sampling = &self.follower.settings().sampling;
        reading(&self.inputs, &self.room.seen, sampling, input).ok()
    }
}

impl OwnRoom {
    fn lend(&mut self) -> Room<'_> {
        Room {
            risks: &mut self.risks,
            seen: &mut self.seen,
            inputs: &mut self.inputs,
            motors: &mut self.motors,
        }
    }
}

#[cfg(test)]
mod tests;
