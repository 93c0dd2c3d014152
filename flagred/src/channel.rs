//! Channels: one thing observed over one window, and the statistics taken of it. What is to be observed is plain data,
//! which can lie in a table; what was seen is the caller's memory.

use crate::{
    margin::margin,
    moments::Moments,
    motor::{BIN_S, Motor, Together, bin_of},
    window::Window,
};

/// A statistic over time.
///
/// # Example: one second of wind, half of it at 2 m/s and half at 4
/// ```
/// # use flagred::source::{Motors, Observer, Signal, Source};
/// use flagred::channel::Statistic;
///
/// let of = |statistic| -> Result<f64, String> {
///     # let wind = Source { statistic, motors: Motors::Pooled, signal: Signal::named("wind_m_s"), window_s: 1.0 };
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
    /// The latest value; over motors, their mean.
    Last,
    /// The share of time, in [0, 1], spent below a value; over motors, the mean of their shares.
    ShareBelow(f64),
    /// The share of time, in [0, 1], spent above a value; over motors, the mean of their shares.
    ShareAbove(f64),
    /// The standard deviation without noise: `sqrt(max(0, std^2 - noise^2))`, both of the means of bins. What is left is
    /// what successive values share.
    StdLessNoise,
    /// The standard deviation of the noise: `sqrt(mean(step^2) / 2)`, with the steps between the means of successive
    /// bins of 0.1 s (of successive samples where they are rarer). White noise has `noise = std`, slow movement 0.
    /// docs/profiles.md defines the bins. The first one has no step before it, and counts with a step of 0.
    Noise,
}

impl Statistic {
    /// Whether it is one of means over 0.1 s, and not of samples.
    pub(crate) const fn is_of_bins(self) -> bool {
        matches!(self, Statistic::StdLessNoise | Statistic::Noise)
    }
}

/// How the motors of one sample become one value.
///
/// # Example: one motor at 0.25 and one at 0.75
/// ```
/// # use flagred::source::{Observer, Signal, Source};
/// use flagred::channel::{Motors, Statistic};
///
/// let of = |statistic, motors| -> Result<f64, String> {
///     # let source = Source { statistic, motors, signal: Signal::MotorCommand, window_s: 1.0 };
///     # let mut observer = Observer::new([&source], flagred::monitor::Craft::new(2))?;
///     # for i in 1..=8 { observer.push(f64::from(i) * 0.125, 0.125, &[0.25, 0.75], &[]); }
///     let observed = observer.value(0).ok_or("nothing observed")?;
///     Ok(observed.value)
/// };
/// assert_eq!(of(Statistic::Std, Motors::Pooled)?, 0.25); // of all values there are
/// assert_eq!(of(Statistic::Std, Motors::Mean)?, 0.0); // of what they do together, which does not change
/// assert_eq!(of(Statistic::Mean, Motors::Std)?, 0.25); // how far apart they are
/// # Ok::<(), String>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Motors {
    /// They do not: the statistic is over all motors and the whole window at once.
    #[default]
    Pooled,
    /// Their mean.
    Mean,
    /// Their standard deviation: the spread between motors.
    Std,
    /// The smallest of them.
    Min,
    /// The largest of them.
    Max,
}

/// What a sample gives to a channel.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Observed {
    /// The effective command of each motor.
    Command,
    /// The same without the part that turns the nose; the command itself where the geometry is unknown.
    CommandLessYaw,
    /// Its margin.
    Margin,
    /// Its distance from the lower limit.
    LowSide,
    /// Its distance from the upper limit.
    HighSide,
    /// One of the efforts that the commands add up to: roll, pitch, yaw, thrust; unknown without a geometry.
    Effort(usize),
    /// The noise of the commands, all motors together.
    CommandNoise,
    /// The signal of this index among those that samples carry.
    Named(usize),
}

/// The values that count, where a share of time is asked for.
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
    /// Those below.
    Below(f64),
    /// Those above.
    Above(f64),
}

/// One thing to observe over one window.
///
/// # Example: what the paper's second input observes
/// ```
/// # use flagred::{estimator::Estimator, shipped};
/// # let estimator = shipped::flagred_paper();
/// use flagred::channel::{Channel, Input, Motors, Observed, Statistic};
///
/// let plan = estimator.plan()?;
/// assert_eq!(plan.inputs[1], Input { channel: 1, statistic: Statistic::Std });
/// let spread = Channel { observed: Observed::Command, motors: Motors::Pooled, threshold: None, in_bins: false, window_s: 2.0 };
/// assert_eq!(plan.channels[1], spread);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Channel {
    /// What.
    pub observed: Observed,
    /// How the motors of a sample become one value.
    pub motors: Motors,
    /// Which values count, for a share of time.
    pub threshold: Option<Threshold>,
    /// Whether values are averaged over 0.1 s first.
    pub in_bins: bool,
    /// Over how many seconds.
    pub window_s: f64,
}

/// An input: a statistic of a channel.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Input {
    /// The channel's place among all.
    pub channel: usize,
    /// The statistic.
    pub statistic: Statistic,
}

/// What a channel has seen.
#[derive(Debug, Clone)]
pub struct Seen {
    window: Window,
    /// The latest value; over motors, their mean.
    last: Option<f64>,
    bin: Bin,
}

/// The values of the latest bin.
#[derive(Debug, Clone, Copy)]
struct Bin {
    index: f64,
    samples: u32,
    sum: f64,
    held_s: f64,
    end_s: f64,
    /// The mean of the bin before; NaN is unknown.
    before: f64,
}

impl Bin {
    const IDLE: Bin = Bin {
        index: 0.0,
        samples: 0,
        sum: 0.0,
        held_s: 0.0,
        end_s: 0.0,
        before: 0.0,
    };

    const EMPTY: Bin = Bin {
        before: f64::NAN,
        ..Bin::IDLE
    };

    fn moments(&self) -> Moments {
        if self.samples == 0 || self.held_s <= 0.0 {
            return Moments::EMPTY;
        }
        let mean = self.mean();
        match self.before.is_finite() {
            true => Moments::after(self.before, mean, self.held_s),
            false => Moments::of(mean, self.held_s),
        }
    }

    fn mean(&self) -> f64 {
        self.sum / f64::from(self.samples)
    }
}

impl Seen {
    /// Nothing yet, over a window of so many seconds.
    #[cfg(feature = "std")]
    pub(crate) const fn new(window_s: f64) -> Seen {
        Seen {
            window: Window::new(window_s),
            last: None,
            bin: Bin::EMPTY,
        }
    }

    /// Memory for what a channel sees, all zeros; see [`Window::IDLE`].
    pub const IDLE: Seen = Seen {
        window: Window::IDLE,
        last: None,
        bin: Bin::IDLE,
    };

    /// Nothing yet, over a window of so many seconds, where it is.
    pub(crate) fn restart(&mut self, window_s: f64) {
        self.window.restart(window_s);
        self.clear_latest();
    }

    /// Forgets everything.
    pub(crate) fn clear(&mut self) {
        self.window.clear();
        self.clear_latest();
    }

    fn clear_latest(&mut self) {
        self.last = None;
        self.bin = Bin::EMPTY;
    }

    /// Drops what was before a time from a window that is longer than `short_s`.
    pub(crate) fn forget_before(&mut self, t_s: f64, short_s: f64) {
        if self.window.length_s() > short_s {
            self.window.forget_before(t_s);
        }
    }

    fn push_into_bin(&mut self, index: f64, (t_s, held_s): (f64, f64), value: Option<f64>) {
        if self.bin.samples > 0 && self.bin.index != index {
            let before = self.bin.mean();
            self.window
                .push(self.bin.end_s, self.bin.held_s, &self.bin.moments());
            self.bin = Bin {
                before,
                ..Bin::IDLE
            };
        }
        self.window.advance(t_s);
        if let Some(value) = value {
            self.bin.index = index;
            self.bin.samples += 1;
            self.bin.sum += value;
            self.bin.held_s += held_s;
            self.bin.end_s = t_s;
        }
    }
}

/// What is observed at one time.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Now<'a> {
    pub(crate) motors: &'a [Motor],
    pub(crate) together: Together,
    /// The signals that samples carry; NaN is unknown.
    pub(crate) named: &'a [f64],
}

/// Adds a sample, of a time and the seconds before it that it stands for, to all channels.
pub(crate) fn push(
    channels: &[Channel],
    seen: &mut [Seen],
    (t_s, held_s): (f64, f64),
    observed: &Now<'_>,
) {
    let bin = bin_of(t_s);
    let mut before: Option<(&Channel, Moments)> = None;
    for (channel, seen) in channels.iter().zip(seen) {
        // Neighbours often differ in their windows alone.
        let now = match before {
            Some((same, now)) if same.sees_as(channel) => now,
            _ => channel.reduce(observed),
        };
        before = Some((channel, now));
        seen.last = now.mean();
        // A noise is known once in a bin, and stands for all of it.
        let held_s = match channel.observed {
            Observed::CommandNoise => held_s.max(BIN_S),
            _ => held_s,
        };
        if channel.in_bins {
            seen.push_into_bin(bin, (t_s, held_s), now.mean());
        } else if now.weight() > 0.0 {
            // A sample weighs its time, however many motors it knows.
            let moments = now.scaled(held_s / now.weight());
            seen.window.push(t_s, held_s, &moments);
        } else {
            seen.window.advance(t_s);
        }
    }
}

/// The value of an input, and how much of its window is behind it; `None` where nothing is known.
pub(crate) fn value(inputs: &[Input], seen: &[Seen], input: usize) -> Option<Observation> {
    let Input { channel, statistic } = *inputs.get(input)?;
    let Seen { window, last, bin } = seen.get(channel)?;
    let mut total = window.total();
    let mut samples = window.samples();
    if statistic.is_of_bins() {
        let latest = bin.moments();
        samples += u32::from(latest.weight() > 0.0);
        total.merge(&latest);
    }
    let value = match statistic {
        Statistic::Mean | Statistic::ShareBelow(_) | Statistic::ShareAbove(_) => total.mean(),
        Statistic::Std => total.std(),
        Statistic::Rms => total.rms(),
        Statistic::Min => total.min(),
        Statistic::Max => total.max(),
        Statistic::Last => *last,
        Statistic::StdLessNoise => total.std_less_noise(),
        Statistic::Noise => total.noise(),
    };
    Some(Observation {
        value: value?,
        samples: match statistic {
            Statistic::Last => None,
            _ => Some(samples),
        },
        covered_s: total.weight(),
        window_s: window.length_s(),
    })
}

/// The value of an input, and what is behind it.
///
/// # Example: a second of a window of five
/// ```
/// use flagred::{monitor::Craft, source::{Motors, Observation, Observer, Signal, Source, Statistic}};
///
/// let load = Source { statistic: Statistic::Mean, motors: Motors::Pooled, signal: Signal::MotorCommand, window_s: 5.0 };
/// let mut observer = Observer::new([&load], Craft::new(4))?;
/// for i in 1..=4 {
///     observer.push(f64::from(i) * 0.25, 0.25, &[0.5; 4], &[]);
/// }
/// let observed = Observation { value: 0.5, samples: Some(4), covered_s: 1.0, window_s: 5.0 };
/// assert_eq!(observer.value(0), Some(observed));
/// # Ok::<(), String>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Observation {
    /// The value.
    pub value: f64,
    /// The samples in the window; `None` for a statistic that needs but one.
    pub samples: Option<u32>,
    /// How much time of the window they cover, in seconds.
    pub covered_s: f64,
    /// The length of the window in seconds.
    pub window_s: f64,
}

impl Channel {
    /// Whether another channel makes the same of a sample, over whatever window.
    fn sees_as(&self, other: &Channel) -> bool {
        let window_s = self.window_s;
        *self == Channel { window_s, ..*other }
    }

    /// The values of one sample, each motor known with weight 1.
    fn reduce(&self, now: &Now<'_>) -> Moments {
        let commands = now.motors.iter().map(|motor| motor.command);
        match self.observed {
            Observed::Named(index) => {
                self.threshold(now.named.get(index).copied().unwrap_or(f64::NAN))
            }
            Observed::Effort(axis) => {
                let effort = now.together.efforts.get(axis).copied();
                self.threshold(effort.unwrap_or(f64::NAN))
            }
            Observed::CommandNoise => self.threshold(now.together.noise),
            Observed::CommandLessYaw => self.over(now.motors.iter().map(|motor| motor.less_yaw)),
            Observed::Command | Observed::LowSide => self.over(commands),
            Observed::Margin => self.over(commands.map(margin)),
            Observed::HighSide => self.over(commands.map(|e| 1.0 - e)),
        }
    }

    /// The values of the motors, NaN where one is unknown.
    fn over(&self, motors: impl Iterator<Item = f64> + Clone) -> Moments {
        let known = motors.filter(|value| value.is_finite());
        if self.motors == Motors::Pooled {
            return Moments::alike(known.map(|value| self.counted(value)));
        }
        let all = Moments::alike(known);
        let one = match self.motors {
            Motors::Pooled | Motors::Mean => all.mean(),
            Motors::Std => all.std(),
            Motors::Min => all.min(),
            Motors::Max => all.max(),
        };
        self.threshold(one.unwrap_or(f64::NAN))
    }

    /// One value, NaN where it is unknown.
    fn threshold(&self, value: f64) -> Moments {
        if value.is_finite() {
            Moments::of(self.counted(value), 1.0)
        } else {
            Moments::EMPTY
        }
    }

    /// The value itself, or for a share whether it is beyond the threshold.
    fn counted(&self, value: f64) -> f64 {
        match self.threshold {
            None => value,
            Some(Threshold::Below(limit)) => f64::from(u8::from(value < limit)),
            Some(Threshold::Above(limit)) => f64::from(u8::from(value > limit)),
        }
    }
}
