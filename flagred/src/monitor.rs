//! The streaming monitor: a sample in, what is known after it out.

use alloc::{format, string::String, vec, vec::Vec};

use crate::{
    channel::{Channel, Input, Seen, motors_needed, restart},
    estimator::{Estimator, Memory},
    follower::{Follower, Room, reading},
    motor::{Motor, set_geometry},
    profile::Profile,
    source::{Motors, Signal, Source, Statistic, channels},
    verdict::{Ended, Finding},
    window::Window,
};

pub use crate::sample::{Estimate, Sample, Unknown, Update};
pub use crate::{craft::Craft, effort::Factors};

impl Unknown {
    /// The reason in words, with the names of the profile's inputs.
    ///
    /// # Example
    /// ```
    /// use flagred::{monitor::Unknown, shipped};
    ///
    /// let why = Unknown::TooFewSamples { input: 1, samples: 2 }.explain(shipped::flagred_paper().profile());
    /// assert_eq!(why, "input `spread` has 2 samples in 2 s and needs 5: log the motors at 2.5 Hz or more");
    /// ```
    pub fn explain(&self, profile: &Profile) -> String {
        let name = |input: &usize| {
            let input = profile.inputs.get(*input);
            input.map_or(("", 0.0), |i| (i.name.as_str(), i.source.window_s))
        };
        match self {
            Unknown::OnGround => "on the ground".into(),
            Unknown::OutOfOrder => "the time stamp is not after the previous one".into(),
            Unknown::WarmingUp { input } => {
                let (name, window_s) = name(input);
                format!("the {window_s} s window of input `{name}` does not cover enough time yet")
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
                format!("the signal of input `{}` has no known value", name(input).0)
            }
            Unknown::NoRule => "no rule applies, and there is nothing to interpolate from".into(),
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
    /// The profile names a motor that the flight does not have.
    #[error("the profile needs motor {motor}, and the flight has {motors} motors")]
    FewMotors {
        /// The motor, counted from 1.
        motor: usize,
        /// How many there are.
        motors: usize,
    },
}

/// Follows one flight, sample by sample.
///
/// It holds its own share of the estimator. After it is made it allocates nothing, its memory does not grow, and a sample
/// costs the same for any length of the windows.
///
/// # Example: motors at their limits
/// ```
/// use flagred::{monitor::{Craft, Monitor, Sample}, shipped, verdict::Level};
///
/// let mut monitor = Monitor::new(&shipped::flagred_paper(), Craft::new(4))?;
/// let mut level = None;
/// for i in 0..500 {
///     let t_s = f64::from(i) * 0.04;
///     let motors = if t_s < 10.0 { [0.4, 0.4, 0.41, 0.41] } else { [0.0, 1.0, 0.05, 1.0] };
///     let update = monitor.push(&Sample { t_s, motors: &motors, in_air: true, signals: &[] });
///     level = update.level.max(level);
/// }
/// assert_eq!(level, Some(Level::Fail));
/// # Ok::<(), flagred::monitor::MonitorError>(())
/// ```
#[derive(Debug, Clone)]
pub struct Monitor {
    estimator: Estimator,
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

impl Monitor {
    /// A monitor of a craft.
    ///
    /// # Errors
    ///
    /// The profile needs a signal that samples do not carry, or a motor that the craft does not have.
    pub fn new(estimator: &Estimator, craft: Craft<'_>) -> Result<Monitor, MonitorError> {
        if craft.motors == 0 {
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
            exponential: false,
        });
        let sources = profile.inputs.iter().map(|input| &input.source);
        let (channels, inputs) = channels(sources.chain(&always), craft.signals)
            .map_err(|signal| MonitorError::NoSignal { signal })?;
        let motor = motors_needed(&channels);
        if motor > craft.motors {
            let motors = craft.motors;
            return Err(MonitorError::FewMotors { motor, motors });
        }
        let mut motors = vec![Motor::UNKNOWN; craft.motors];
        set_geometry(&mut motors, craft.geometry);
        let mut seen = vec![Seen::IDLE; channels.len()];
        restart(&channels, &mut seen);
        Ok(Monitor {
            memory: Memory::of(estimator),
            room: OwnRoom {
                risks: Window::new(profile.elevated_risk.window_s),
                seen,
                inputs: vec![f64::NAN; profile.inputs.len()],
                motors,
            },
            channels,
            inputs,
            follower: Follower::new(profile.settings()),
            estimator: estimator.clone(),
        })
    }

    /// The estimator it uses.
    pub fn estimator(&self) -> &Estimator {
        &self.estimator
    }

    /// Takes a sample in.
    pub fn push(&mut self, sample: &Sample<'_>) -> Update {
        let Monitor {
            estimator,
            memory,
            channels,
            inputs,
            room,
            follower,
        } = self;
        let plan = (&channels[..], &inputs[..]);
        let update = follower.push(plan, &mut room.lend(), sample, |inputs| {
            estimator.estimate(inputs, memory)
        });
        follower.explain(plan, &update, |risk_pct| {
            estimator.cause(&room.inputs, risk_pct, memory)
        });
        update
    }

    /// The values of the inputs after the latest sample, in the order of the profile; NaN is unknown.
    pub fn inputs(&self) -> &[f64] {
        &self.room.inputs
    }

    /// The finding behind the current level, as it stands so far; `None` while the level is good.
    pub fn open_finding(&self) -> Option<Finding> {
        self.follower.open_finding()
    }

    /// The worst open finding beside the risk, as it stands so far: little reserve or an imbalance. The level may rest on a
    /// risk at the same time.
    pub fn open_notice(&self) -> Option<Finding> {
        self.follower.open_notice()
    }

    /// Ends the flight and gives the findings that were still open, once.
    pub fn finish(&mut self) -> Ended {
        self.follower.finish(&mut self.room.lend())
    }

    /// The mean margin over all motors and the profile's window: the paper's first input, for any rule set.
    pub fn margin(&self) -> Option<f64> {
        self.reading(self.room.inputs.len())
    }

    /// The standard deviation of the effective commands over all motors and the profile's window: the paper's second
    /// input, for any rule set.
    pub fn spread(&self) -> Option<f64> {
        self.reading(self.room.inputs.len() + 1)
    }

    fn reading(&self, input: usize) -> Option<f64> {
        let sampling = &self.follower.settings().sampling;
        reading(
            (&self.channels, &self.inputs),
            &self.room.seen,
            sampling,
            input,
        )
        .ok()
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
