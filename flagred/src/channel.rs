//! Channels: one thing observed over one window, and the statistics taken of it. What is to be observed is plain data,
//! which can lie in a table; what was seen is the caller's memory.

use crate::{margin::margin, moments::Moments, window::Window};

/// A statistic over time.
///
/// # Example: one second of wind, half of it at 2 m/s and half at 4
/// ```
/// # use flagred::source::{Motors, Observer, Signal, Source};
/// use flagred::channel::Statistic;
///
/// let of = |statistic| -> Result<f64, String> {
///     # let wind = Source { statistic, motors: Motors::Pooled, signal: Signal::named("wind_m_s"), window_s: 1.0 };
///     # let mut observer = Observer::new([&wind], &["wind_m_s"])?;
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
///     # let mut observer = Observer::new([&source], &[])?;
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
    /// Its margin.
    Margin,
    /// Its distance from the lower limit.
    LowSide,
    /// Its distance from the upper limit.
    HighSide,
    /// The signal at this place among those that samples carry.
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
/// let at_limit = plan.inputs[3];
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
/// let spread = Channel { observed: Observed::Command, motors: Motors::Pooled, threshold: None, window_s: 2.0 };
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
}

impl Seen {
    /// Nothing yet, over a window of so many seconds.
    #[cfg(feature = "std")]
    pub(crate) const fn new(window_s: f64) -> Seen {
        Seen {
            window: Window::new(window_s),
            last: None,
        }
    }

    /// Memory for what a channel sees, all zeros; see [`Window::IDLE`].
    pub const IDLE: Seen = Seen {
        window: Window::IDLE,
        last: None,
    };

    /// Nothing yet, over a window of so many seconds, where it is.
    pub(crate) fn restart(&mut self, window_s: f64) {
        self.window.restart(window_s);
        self.last = None;
    }

    /// Forgets everything.
    pub(crate) fn clear(&mut self) {
        self.window.clear();
        self.last = None;
    }
}

/// Adds a sample, of a time and the seconds before it that it stands for, to all channels; NaN is unknown.
pub(crate) fn push(
    channels: &[Channel],
    seen: &mut [Seen],
    (t_s, held_s): (f64, f64),
    motors: impl Iterator<Item = f64> + Clone,
    named: &[f64],
) {
    let mut before: Option<(&Channel, Moments)> = None;
    for (channel, seen) in channels.iter().zip(seen) {
        // Neighbours often differ in their windows alone.
        let now = match before {
            Some((same, now)) if same.sees_as(channel) => now,
            _ => channel.reduce(motors.clone(), named),
        };
        before = Some((channel, now));
        seen.last = now.mean();
        if now.weight() > 0.0 {
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
    let Seen { window, last } = seen.get(channel)?;
    let total = window.total();
    let value = match statistic {
        Statistic::Mean | Statistic::ShareBelow(_) | Statistic::ShareAbove(_) => total.mean(),
        Statistic::Std => total.std(),
        Statistic::Rms => total.rms(),
        Statistic::Min => total.min(),
        Statistic::Max => total.max(),
        Statistic::Last => *last,
    };
    Some(Observation {
        value: value?,
        samples: match statistic {
            Statistic::Last => None,
            _ => Some(window.samples()),
        },
        covered_s: total.weight(),
        window_s: window.length_s(),
    })
}

/// The value of an input, and what is behind it.
///
/// # Example: a second of a window of five
/// ```
/// use flagred::source::{Motors, Observation, Observer, Signal, Source, Statistic};
///
/// let load = Source { statistic: Statistic::Mean, motors: Motors::Pooled, signal: Signal::MotorCommand, window_s: 5.0 };
/// let mut observer = Observer::new([&load], &[])?;
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
    fn reduce(&self, motors: impl Iterator<Item = f64> + Clone, named: &[f64]) -> Moments {
        match self.observed {
            Observed::Named(index) => self.threshold(named.get(index).copied().unwrap_or(f64::NAN)),
            Observed::Command | Observed::LowSide => self.over(motors),
            Observed::Margin => self.over(motors.map(margin)),
            Observed::HighSide => self.over(motors.map(|e| 1.0 - e)),
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
