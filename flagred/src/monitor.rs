//! The streaming monitor, which takes samples and returns the risk and the level after each.

use alloc::{format, string::String, vec, vec::Vec};

use fuzzy::engine::Interval;

use crate::{
    channel::{Channel, ChannelState, Input, assumed, interval, motors_needed, restart},
    estimator::{Estimator, Memory},
    follower::{Feed, FlightMemory, Follower, reading},
    motor::{Motor, set_geometry},
    profile::Profile,
    source::{Motors, Signal, Source, Statistic},
    state::{Reader, State},
    verdict::{EndedFindings, Finding, Level},
    window::Window,
};

pub use crate::sample::{Estimate, Sample, Unknown, Update};
pub use crate::{
    craft::Craft,
    effort::Factors,
    motor::{MAX_OUTSIDE, counted},
};

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
            Unknown::OutOfOrder => "the timestamp is not after the previous one".into(),
            Unknown::WarmingUp { input } => {
                let (name, window_s) = name(input);
                format!("the {window_s} s window of input `{name}` does not cover enough time yet")
            }
            Unknown::TooFewSamples { input, samples } => {
                let (name, window_s) = name(input);
                let rate = f64::from(profile.sampling.min_samples) / window_s;
                let what = match profile.reads_motors() {
                    true => "the motors",
                    false => "its signal",
                };
                format!(
                    "input `{name}` has {samples} sample{} in {window_s} s and needs {}: log {what} at {rate} Hz or more",
                    if *samples == 1 { "" } else { "s" },
                    profile.sampling.min_samples
                )
            }
            Unknown::NoValue { input } => {
                format!("the signal of input `{}` has no known value", name(input).0)
            }
            Unknown::NoRule => "no rule applies, and there is nothing to interpolate from".into(),
            Unknown::NoCommand { motor } => {
                format!("the command of motor {} is unknown", motor + 1)
            }
            Unknown::CommandOutside { motor, command } => format!(
                "the command of motor {} is `{command}`, but a command is a fraction from 0 to 1",
                motor + 1
            ),
        }
    }
}

/// The reason why a monitor cannot be created.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum MonitorError {
    /// The profile needs a signal that the samples do not have.
    #[error("the profile needs the signal `{signal}`, which the flight does not contain")]
    NoSignal {
        /// The signal.
        signal: String,
    },
    /// The profile reads the motors, but the flight has none.
    #[error("the profile reads motors, but the flight has none")]
    NoMotors,
    /// The profile reads a motor that the flight does not have.
    #[error("the profile needs motor {motor}, but the flight has only {motors} motors")]
    FewMotors {
        /// The number of the motor, from 1.
        motor: usize,
        /// The number of motors of the flight.
        motors: usize,
    },
}

/// Assesses one flight, sample by sample.
///
/// It keeps its own reference to the estimator. After its creation it does not allocate, and the cost of a sample does
/// not depend on the lengths of the windows.
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
///     let update = monitor.push(&Sample { t_s, motors: &motors, in_air: Some(true), signals: &[] });
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
    room: OwnedBuffers,
    follower: Follower,
    /// The monitors of the other risks of the profile.
    others: Vec<Monitor>,
    ended_other_risks: Vec<RiskFinding>,
    /// The reason why the risk of this monitor is unknown after the latest sample; the other risks are not considered.
    unknown: Option<Unknown>,
    /// The risk of this monitor after the latest sample; `None` if it is unknown.
    risk: Option<Estimate>,
}

/// A finding about another risk of the profile.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RiskFinding {
    /// The index of the risk in [`Profile::other_risks`].
    pub risk: usize,
    /// The finding.
    pub found: Finding,
}

/// The memory of a flight besides the follower, allocated once.
#[derive(Debug, Clone)]
struct OwnedBuffers {
    risks: Window,
    seen: Vec<ChannelState>,
    inputs: Vec<f64>,
    motors: Vec<Motor>,
}

impl Monitor {
    /// Creates a monitor of a craft. If the profile reads no motors, the craft may have no motors. Samples with empty
    /// `motors` then count as a vehicle in use, unless `in_air` is `Some(false)`.
    ///
    /// # Errors
    ///
    /// If the profile needs a signal that the samples do not have, or a motor that the craft does not have.
    ///
    /// # Example: a load, and no motors
    /// ```
    /// use flagred::{estimator::Estimator, monitor::{Craft, Monitor, Sample}, verdict::Level};
    ///
    /// let rules = "fuzzy: 1\nname: load\ninputs: {load: {range: [0, 2], partition: {light: 0.5, heavy: 1}}}\n\
    ///     outputs: {risk: {range: [0, 100], terms: {none: {constant: 0}, high: {constant: 90}}, defuzzifier: weighted_average}}\n\
    ///     rules: [IF load IS light THEN risk IS none, IF load IS heavy THEN risk IS high]";
    /// let profile = "flagred: 1\nname: load\nrules: load\ninputs: {load: {last: load_t}}";
    /// let estimator = Estimator::new(&profile.parse()?, &fuzzy::yaml::parse(rules)?.model)?;
    /// let mut monitor = Monitor::new(&estimator, Craft::new(0).with_signals(&["load_t"]))?;
    /// let mut level = None;
    /// for i in 0..100 {
    ///     let update = monitor.push(&Sample { t_s: f64::from(i) * 0.1, motors: &[], in_air: None, signals: &[1.2] });
    ///     level = update.level.max(level);
    /// }
    /// assert_eq!(level, Some(Level::Fail));
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn new(estimator: &Estimator, craft: Craft<'_>) -> Result<Monitor, MonitorError> {
        let profile = estimator.profile();
        if craft.motors == 0 && profile.reads_motors() {
            return Err(MonitorError::NoMotors);
        }
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
        let always = if craft.motors > 0 { &always[..] } else { &[] };
        let (channels, inputs) = profile
            .channels(always, craft)
            .map_err(|signal| MonitorError::NoSignal { signal })?;
        let motor = motors_needed(&channels, profile.verdict.notices.any());
        if motor > craft.motors {
            let motors = craft.motors;
            return Err(MonitorError::FewMotors { motor, motors });
        }
        let mut motors = vec![Motor::UNKNOWN; craft.motors];
        set_geometry(&mut motors, craft.geometry);
        let mut seen = vec![ChannelState::IDLE; channels.len()];
        restart(&channels, &mut seen);
        let others = estimator.others().iter();
        let others = others.map(|other| Monitor::new(other, craft));
        let others = others.collect::<Result<Vec<Monitor>, MonitorError>>()?;
        Ok(Monitor {
            ended_other_risks: Vec::with_capacity(others.len()),
            unknown: None,
            risk: None,
            others,
            memory: Memory::of(estimator),
            room: OwnedBuffers {
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

    /// The estimator of the monitor.
    pub fn estimator(&self) -> &Estimator {
        &self.estimator
    }

    /// Processes a sample. The level of the update is the worst of all risks, and never [`Level::Good`] while one of
    /// them is unknown. Risk and elevated risk are those of the profile's `output`; other risks do not change them.
    pub fn push(&mut self, sample: &Sample<'_>) -> Update {
        if self.others.is_empty() {
            return self.push_first(sample);
        }
        let before = self.level();
        let mut update = self.push_first(sample);
        self.ended_other_risks.clear();
        for (risk, other) in self.others.iter_mut().enumerate() {
            let of_other = other.push_first(sample);
            update.level = update.level.max(of_other.level);
            let [found, ..] = of_other.ended;
            self.ended_other_risks
                .extend(found.map(|found| RiskFinding { risk, found }));
        }
        if update.risk.is_err() || self.unknown_other_risks().next().is_some() {
            update.level = update.level.filter(|level| *level > Level::Good);
        }
        update.change = update.level.filter(|level| *level != before);
        update
    }

    /// The worst level of all risks.
    fn level(&self) -> Level {
        let others = self.others.iter().map(|other| other.follower.level());
        others.fold(self.follower.level(), Level::max)
    }

    fn push_first(&mut self, sample: &Sample<'_>) -> Update {
        let Monitor {
            estimator,
            memory,
            channels,
            inputs,
            room,
            follower,
            ..
        } = self;
        let feed = Feed {
            channels,
            inputs,
            order: estimator.order(),
        };
        let update = follower.push(feed, &mut room.borrowed(), sample, |inputs| {
            estimator.estimate(inputs, memory)
        });
        follower.explain(feed, &update, |risk_pct| {
            estimator.cause(&room.inputs, risk_pct, memory)
        });
        self.unknown = update.risk.err();
        self.risk = update.risk.ok();
        update
    }

    /// The values of the inputs after the latest sample, in the order of the profile; NaN is unknown.
    pub fn inputs(&self) -> &[f64] {
        &self.room.inputs
    }

    /// The 95 % intervals of the inputs after the latest sample, in the order of the profile. An interval has zero
    /// width if the value is assumed or the risk does not depend on the input. `None` if the interval of another input
    /// is unknown.
    pub(crate) fn intervals(&self) -> Option<Vec<Interval>> {
        let (plan, seen) = ((&self.channels[..], &self.inputs[..]), &self.room.seen);
        let feed = Feed {
            channels: &self.channels,
            inputs: &self.inputs,
            order: self.estimator.order(),
        };
        let is_measured =
            |input: usize| feed.needs(input) && assumed(&self.inputs, seen, input).is_none();
        let values = self.room.inputs.iter().enumerate();
        let statistics = values.map(|(input, value)| match is_measured(input) {
            true => interval(plan, seen, input),
            false => Some(Interval::from(*value)),
        });
        let statistics = statistics.collect::<Option<Vec<Interval>>>()?;
        let mut all = statistics.clone();
        for (input, of) in self.inputs.iter().enumerate() {
            let Some(ratio) = of.ratio.filter(|_| is_measured(input)) else {
                continue;
            };
            let (Some(found), Some(divided), Some(per)) = (
                all.get_mut(input),
                statistics.get(input),
                statistics.get(ratio.per),
            ) else {
                continue;
            };
            let divisors = [per.low, per.high].map(|per| per.max(ratio.at_least));
            let ends = [divided.low, divided.high].map(|end| divisors.map(|by| end / by));
            let ends = ends.into_iter().flatten().map(Interval::from);
            *found = ends.reduce(Interval::hull).unwrap_or(*found);
        }
        Some(all)
    }

    /// The monitors of all risks: this one, then those of the other risks of the profile.
    pub(crate) fn of_each_risk(&self) -> impl Iterator<Item = &Monitor> + Clone {
        core::iter::once(self).chain(&self.others)
    }

    /// The risk after the latest sample; `None` if it is unknown.
    pub(crate) fn risk(&self) -> Option<Estimate> {
        self.risk
    }

    /// The beginning (in seconds) and the highest value (in %) of the open finding about the risk of this monitor, or of
    /// the finding that will be opened if a threshold stays reached.
    pub(crate) fn peak_of_risk(&self) -> Option<(f64, f64)> {
        self.follower.peak_of_risk()
    }

    /// The indices in the profile of the inputs whose values are assumed after the latest sample: inputs with
    /// `if_missing` whose signals have never been known.
    pub fn assumed(&self) -> impl Iterator<Item = usize> {
        let all = 0..self.room.inputs.len();
        all.filter(|input| assumed(&self.inputs, &self.room.seen, *input).is_some())
    }

    /// The finding behind the current level, with its values so far; `None` while the level is good.
    pub fn open_finding(&self) -> Option<Finding> {
        let other = self.open_other_risk().map(|of_risk| of_risk.found);
        other.or_else(|| self.follower.open_finding())
    }

    /// The finding behind the current level, if the finding is about another risk.
    pub fn open_other_risk(&self) -> Option<RiskFinding> {
        let first = self.follower.open_finding().map(|found| found.severity);
        let others = self.others.iter().enumerate();
        let open = others.filter_map(|(risk, other)| {
            let found = other.follower.open_finding()?;
            Some(RiskFinding { risk, found })
        });
        // Among findings of equal level, the first counts.
        let worst = open.reduce(
            |worst, next| match next.found.severity > worst.found.severity {
                true => next,
                false => worst,
            },
        );
        worst.filter(|worst| first.is_none_or(|first| worst.found.severity > first))
    }

    /// The findings of other risks that ended with the latest sample, or with [`Monitor::finish`].
    pub fn ended_other_risks(&self) -> &[RiskFinding] {
        &self.ended_other_risks
    }

    /// The other risks that are unknown after the latest sample: the index of each in [`Profile::other_risks`], and the
    /// reason.
    pub fn unknown_other_risks(&self) -> impl Iterator<Item = (usize, Unknown)> + Clone {
        let others = self.others.iter().enumerate();
        others.filter_map(|(risk, other)| Some((risk, other.unknown?)))
    }

    /// The other risks after the latest sample in %, in the order of [`Profile::other_risks`]; NaN is unknown.
    pub fn other_risks_pct(&self) -> impl Iterator<Item = f64> {
        let risks = self.others.iter().map(|other| other.risk);
        risks.map(|risk| risk.map_or(f64::NAN, |estimate| estimate.risk_pct))
    }

    /// The worst open finding that is not about the risk, with its values so far: little reserve or an imbalance. A
    /// risk may be the cause of the level at the same time.
    pub fn open_notice(&self) -> Option<Finding> {
        self.follower.open_notice()
    }

    /// Ends the flight and returns the findings that were still open. A second call returns none.
    pub fn finish(&mut self) -> EndedFindings {
        self.ended_other_risks.clear();
        for (risk, other) in self.others.iter_mut().enumerate() {
            let [found, ..] = other.follower.finish(&mut other.room.borrowed());
            self.ended_other_risks
                .extend(found.map(|found| RiskFinding { risk, found }));
        }
        self.follower.finish(&mut self.room.borrowed())
    }

    /// A text that differs between monitors whose states are not interchangeable.
    pub(crate) fn description(&self) -> String {
        let (profile, model) = (self.estimator.profile(), self.estimator.model());
        format!(
            "{profile:?} {model:?} {:?} {:?}",
            self.channels, self.inputs
        )
    }

    pub(crate) fn save(&self, to: &mut Vec<u8>) {
        (self.room).save(to);
        self.follower.save(to);
        self.unknown.save(to);
        self.risk.save(to);
        self.ended_other_risks.save(to);
        self.others.iter().for_each(|other| other.save(to));
    }

    /// Restores the saved state of a monitor that was created in the same way as this one; `None` if the state does not
    /// fit.
    pub(crate) fn load(&mut self, from: &mut Reader<'_>) -> Option<()> {
        let room = OwnedBuffers::load(from)?;
        let lengths = |of: &OwnedBuffers| (of.seen.len(), of.inputs.len(), of.motors.len());
        if lengths(&room) != lengths(&self.room) {
            return None;
        }
        self.room = room;
        self.follower = Follower::load(from)?;
        self.unknown = State::load(from)?;
        self.risk = State::load(from)?;
        self.ended_other_risks.clear();
        self.ended_other_risks
            .extend(Vec::<RiskFinding>::load(from)?);
        self.others
            .iter_mut()
            .try_for_each(|other| other.load(from))
    }

    /// The mean margin over all motors and the profile's window, also if the rule set does not read it: the paper's first
    /// input. `None` if it is unknown, or if the craft has no motors.
    pub fn margin(&self) -> Option<f64> {
        self.reading(self.room.inputs.len())
    }

    /// The standard deviation of the effective commands over all motors and the profile's window, also if the rule set
    /// does not read it: the paper's second input. `None` as for [`Monitor::margin`].
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

impl OwnedBuffers {
    fn borrowed(&mut self) -> FlightMemory<'_> {
        FlightMemory {
            risks: &mut self.risks,
            seen: &mut self.seen,
            inputs: &mut self.inputs,
            motors: &mut self.motors,
        }
    }
}

state! {
    struct RiskFinding { risk, found }
    struct OwnedBuffers { risks, seen, inputs, motors }
}

#[cfg(test)]
mod tests;
