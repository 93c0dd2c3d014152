//! Channels: a channel is one quantity that is observed over one window, with its statistics. A channel is plain data
//! that can be in a constant table; the observed values are in memory that the caller provides.

mod code;
mod seen;

#[cfg(feature = "std")]
pub(crate) use seen::interval;
pub use seen::{ChannelState, Observation};
pub(crate) use seen::{Now, assumed, note, push, restart, value};

/// A statistic over time.
///
/// # Example: one second of wind, half of it at 2 m/s and half at 4
/// ```
/// # use flagred::source::{Motors, Observer, Signal, Source};
/// use flagred::channel::Statistic;
///
/// let of = |statistic| -> Result<f64, String> {
///     # let wind = Source { statistic, motors: Motors::Pooled, signal: Signal::named("wind_m_s"), window_s: 1.0, exponential: false };
///     # let craft = flagred::monitor::Craft::new(1).with_signals(&["wind_m_s"]);
///     # let mut observer = Observer::new([&wind], craft)?;
///     # for i in 1..=8 { observer.push(f64::from(i) * 0.125, 0.125, &[], &[if i <= 4 { 2.0 } else { 4.0 }]); }
///     let observed = observer.value(0).ok_or("nothing observed")?;
///     Ok(observed.value)
/// };
/// assert_eq!((of(Statistic::Mean)?, of(Statistic::Std)?), (3.0, 1.0));
/// assert_eq!((of(Statistic::Min)?, of(Statistic::Last)?), (2.0, 4.0));
/// assert_eq!(of(Statistic::ShareAbove(3.0))?, 0.5);
/// # Ok::<(), String>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Statistic {
    /// The mean.
    Mean,
    /// The standard deviation.
    Std,
    /// The root mean square.
    Rms,
    /// The smallest value.
    Min,
    /// The largest value.
    Max,
    /// The latest value; for a signal of motors, the mean over the motors.
    Last,
    /// The share of time spent below a value, in [0, 1]; for a signal of motors, the mean over the motors.
    ShareBelow(f64),
    /// The share of time spent above a value, in [0, 1]; for a signal of motors, the mean over the motors.
    ShareAbove(f64),
    /// The standard deviation without noise: `sqrt(max(0, std^2 - noise^2))`, both computed from the means of bins. It
    /// measures changes that are slower than a bin.
    StdLessNoise,
    /// The standard deviation of the noise: `sqrt(mean(step^2) / 2)`, with the steps between the means of successive
    /// bins of 0.1 s (between successive samples if they are further apart). For white noise `noise = std`, for slow
    /// movement it is 0. docs/profiles.md defines the bins. The first bin has no bin before it, and counts as a step of
    /// 0.
    Noise,
    /// The rate of change per second: the slope of the least-squares line through the means of the window's slots. Each
    /// slot is weighted by the time that its samples cover.
    Rate,
    /// A percentile of the means of the window's slots, each weighted by the time that its samples cover; 50 is the
    /// median. docs/profiles.md defines it.
    Percentile(f64),
}

impl Statistic {
    /// Whether the statistic is computed from means over 0.1 s instead of samples.
    pub(crate) const fn uses_bins(self) -> bool {
        matches!(self, Statistic::StdLessNoise | Statistic::Noise)
    }

    /// Whether the statistic can be computed over an exponential window.
    pub(crate) const fn supports_exponential(self) -> bool {
        matches!(
            self,
            Statistic::Mean
                | Statistic::Std
                | Statistic::Rms
                | Statistic::ShareBelow(_)
                | Statistic::ShareAbove(_)
        )
    }

    /// Whether the statistic is computed from the means of slots instead of samples.
    #[cfg(feature = "std")]
    pub(crate) const fn uses_slots(self) -> bool {
        matches!(self, Statistic::Rate | Statistic::Percentile(_))
    }
}

/// How the motors of one sample are combined into one value.
///
/// # Example: one motor at 0.25 and one at 0.75
/// ```
/// # use flagred::source::{Observer, Signal, Source};
/// use flagred::channel::{Motors, Statistic};
///
/// let of = |statistic, motors| -> Result<f64, String> {
///     # let source = Source { statistic, motors, signal: Signal::MotorCommand, window_s: 1.0, exponential: false };
///     # let mut observer = Observer::new([&source], flagred::monitor::Craft::new(2))?;
///     # for i in 1..=8 { observer.push(f64::from(i) * 0.125, 0.125, &[0.25, 0.75], &[]); }
///     let observed = observer.value(0).ok_or("nothing observed")?;
///     Ok(observed.value)
/// };
/// assert_eq!(of(Statistic::Std, Motors::Pooled)?, 0.25); // over all values
/// assert_eq!(of(Statistic::Std, Motors::Mean)?, 0.0); // of their mean, which does not change
/// assert_eq!(of(Statistic::Mean, Motors::Std)?, 0.25); // the mean spread between the motors
/// # Ok::<(), String>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Motors {
    /// No combination: the statistic is computed over all motors and the whole window at once.
    #[default]
    Pooled,
    /// The mean of the motors.
    Mean,
    /// The standard deviation of the motors: the spread between them.
    Std,
    /// The smallest value.
    Min,
    /// The largest value.
    Max,
    /// The value of one motor, counted from 0 in the order of the samples; unknown if there are fewer motors.
    One(u32),
}

/// The quantity that a channel observes in each sample.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Observed {
    /// The effective command of each motor.
    Command,
    /// The effective command without the part that commands yaw; the command itself if the geometry is unknown.
    CommandLessYaw,
    /// The margin of each motor.
    Margin,
    /// The distance of each command from the lower limit.
    LowSide,
    /// The distance of each command from the upper limit.
    HighSide,
    /// One of the efforts into which the commands are decomposed (0 roll, 1 pitch, 2 yaw, 3
    /// thrust); unknown without a geometry.
    Effort(usize),
    /// The noise of the commands of all motors together.
    CommandNoise,
    /// The signal with this index among the signals of a sample.
    Named(usize),
    /// The signal `a` minus the signal `b`, by their indices. If both are angles in degrees, the difference is taken
    /// the shorter way around, in [-180, 180).
    Difference {
        /// The minuend.
        a: usize,
        /// The subtrahend.
        b: usize,
        /// Whether both signals are angles in degrees.
        circular: bool,
    },
    /// The signal `a` divided by the signal `b`, by their indices.
    Ratio {
        /// The dividend.
        a: usize,
        /// The divisor.
        b: usize,
        /// The ratio is unknown while `|b|` is below this, and always when `b` is 0.
        unknown_below: f64,
    },
    /// The signal `a` times the signal `b`, by their indices.
    Product {
        /// The first factor.
        a: usize,
        /// The second factor.
        b: usize,
    },
}

impl Observed {
    /// The indices of the signals that the channel reads.
    pub fn signals(&self) -> impl Iterator<Item = usize> {
        let [first, second] = match *self {
            Observed::Named(signal) => [Some(signal), None],
            Observed::Difference { a, b, .. }
            | Observed::Ratio { a, b, .. }
            | Observed::Product { a, b } => [Some(a), Some(b)],
            Observed::Command
            | Observed::CommandLessYaw
            | Observed::Margin
            | Observed::LowSide
            | Observed::HighSide
            | Observed::Effort(_)
            | Observed::CommandNoise => [None, None],
        };
        first.into_iter().chain(second)
    }
}

/// The difference of two angles, the shorter way around, in [-180, 180).
pub(crate) fn short_way_deg(difference_deg: f64) -> f64 {
    let short_deg = libm::remainder(difference_deg, 360.0);
    if short_deg == 180.0 {
        -180.0
    } else {
        short_deg
    }
}

/// The values that count towards a share of time.
///
/// # Example: the share of time that motors of the shipped profile are at a limit
/// ```
/// # use flagred::{estimator::Estimator, shipped};
/// # let estimator = shipped::flagred();
/// use flagred::channel::{Statistic, Threshold};
///
/// let plan = estimator.plan()?;
/// let at_limit = plan.inputs[5];
/// assert_eq!(at_limit.statistic, Statistic::ShareBelow(0.006));
/// assert_eq!(plan.channels[at_limit.channel].threshold, Some(Threshold::Below(0.006)));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Threshold {
    /// Values below this limit.
    Below(f64),
    /// Values above this limit.
    Above(f64),
}

/// One quantity to observe over one window.
///
/// # Example: the channel of the paper's second input
/// ```
/// # use flagred::{estimator::Estimator, shipped};
/// # let estimator = shipped::flagred_paper();
/// use flagred::channel::{Channel, Input, Motors, Observed, Statistic};
///
/// let plan = estimator.plan()?;
/// assert_eq!(plan.inputs[1], Input { channel: 1, statistic: Statistic::Std, ratio: None, if_missing: None });
/// let spread = Channel { observed: Observed::Command, motors: Motors::Pooled, threshold: None, in_bins: false, window_s: 2.0, exponential: false };
/// assert_eq!(plan.channels[1], spread);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Channel {
    /// The quantity.
    pub observed: Observed,
    /// How the motors of a sample are combined into one value.
    pub motors: Motors,
    /// The values that count towards a share of time; `None` for other statistics.
    pub threshold: Option<Threshold>,
    /// Whether values are averaged over 0.1 s first.
    pub in_bins: bool,
    /// The length of the window in seconds.
    pub window_s: f64,
    /// Whether the window is exponential, with `window_s` as its time constant.
    pub exponential: bool,
}

impl Channel {
    /// The number of motors that a craft must have for this channel.
    fn motors_needed(&self) -> usize {
        match self.motors {
            _ if self.observed.signals().next().is_some() => 0,
            Motors::One(motor) => (motor as usize).saturating_add(1),
            Motors::Pooled | Motors::Mean | Motors::Std | Motors::Min | Motors::Max => 1,
        }
    }
}

/// The number of motors that a craft must have for the channels and, with `has_notices`, for the findings that are not
/// about the risk.
pub(crate) fn motors_needed(channels: &[Channel], has_notices: bool) -> usize {
    let needed = channels.iter().map(Channel::motors_needed);
    needed.fold(usize::from(has_notices), usize::max)
}

/// Whether an input reads the commands of the motors.
pub(crate) fn reads_motors(channels: &[Channel], input: &Input) -> bool {
    let channel = channels.get(input.channel);
    channel.is_some_and(|channel| channel.motors_needed() > 0)
}

/// An input: a statistic of a channel.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Input {
    /// The index of the channel.
    pub channel: usize,
    /// The statistic.
    pub statistic: Statistic,
    /// The division by another input, if the input is a ratio.
    pub ratio: Option<Ratio>,
    /// The value to assume until the signals are known for the first time, because a vehicle might never send them.
    pub if_missing: Option<f64>,
}

impl Input {
    /// The indices of the other inputs that the value of this input depends on.
    pub(crate) fn others(&self) -> impl Iterator<Item = usize> {
        self.ratio.into_iter().map(|ratio| ratio.per)
    }
}

/// The division of an input by another input. The value of the input is `x / max(per, at_least)`, where `x` is its
/// statistic. The other input must not be a ratio itself.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Ratio {
    /// The index of the input to divide by.
    pub per: usize,
    /// The minimum of the divisor, above 0.
    pub at_least: f64,
}

impl Ratio {
    /// The value of an input, computed from the statistics of all inputs; NaN if one is unknown. `None` if the index is
    /// out of bounds.
    pub(crate) fn of(&self, statistics: &[f64], input: usize) -> Option<f64> {
        let per = *statistics.get(self.per)?;
        // `max` of a number and NaN would return the number.
        let per = if per < self.at_least {
            self.at_least
        } else {
            per
        };
        Some(statistics.get(input)? / per)
    }
}
