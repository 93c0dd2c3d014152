//! The observations of channels during a flight, in memory that the caller provides.

use super::{Channel, Input, Motors, Observed, Statistic, Threshold, short_way_deg};
use crate::{
    exponential::Exponential,
    margin::margin,
    moments::Moments,
    motor::{BIN_S, Motor, MotorTotals},
    window::Window,
};

#[cfg(feature = "std")]
mod interval;
#[cfg(feature = "std")]
pub(crate) use interval::interval;

/// The observations of one channel.
#[derive(Debug, Clone)]
pub struct ChannelState {
    window: Window,
    /// Used instead of the window if the channel is exponential.
    exponential: Exponential,
    /// The latest value; for a signal of motors, the mean over the motors.
    last: Option<f64>,
    bin: Bin,
    /// Whether all signals were known at the same time at least once, on the ground or in the air, in this flight or
    /// before.
    has_arrived: bool,
}

/// The values of the latest bin.
#[derive(Debug, Clone, Copy)]
struct Bin {
    index: f64,
    samples: u32,
    sum: f64,
    held_s: f64,
    end_s: f64,
    /// The mean of the previous bin; NaN is unknown.
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

impl ChannelState {
    /// Memory for the observations of a channel, all zeros; see [`Window::IDLE`].
    pub const IDLE: ChannelState = ChannelState {
        window: Window::IDLE,
        exponential: Exponential::IDLE,
        last: None,
        bin: Bin::IDLE,
        has_arrived: false,
    };

    /// Discards all observations and sets the length of the window to `window_s` seconds, in place.
    fn restart(&mut self, window_s: f64) {
        self.window.restart(window_s);
        self.exponential = Exponential::new(window_s);
        self.has_arrived = false;
        self.clear_latest();
    }

    /// Discards all observations.
    pub(crate) fn clear(&mut self) {
        self.window.clear();
        self.exponential.clear();
        self.clear_latest();
    }

    fn clear_latest(&mut self) {
        self.last = None;
        self.bin = Bin::EMPTY;
    }

    /// Discards observations before `t_s` if the window is longer than `short_s`.
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

/// Resets all channels, whatever the memory contained.
pub(crate) fn restart(channels: &[Channel], seen: &mut [ChannelState]) {
    for (channel, seen) in channels.iter().zip(seen) {
        seen.restart(channel.window_s);
    }
}

/// The values of one sample that channels observe.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Now<'a> {
    pub(crate) motors: &'a [Motor],
    pub(crate) together: MotorTotals,
    /// The signals of the sample; NaN is unknown.
    pub(crate) named: &'a [f64],
}

impl Now<'_> {
    /// The value of a signal of the sample; NaN is unknown.
    fn signal(&self, index: usize) -> f64 {
        self.named.get(index).copied().unwrap_or(f64::NAN)
    }
}

/// Records whether the signals of each input with `if_missing` are known in a sample, in the air or on the
/// ground.
pub(crate) fn note(
    (channels, inputs): (&[Channel], &[Input]),
    seen: &mut [ChannelState],
    named: &[f64],
) {
    for input in inputs.iter().filter(|input| input.if_missing.is_some()) {
        let place = input.channel;
        if let (Some(channel), Some(seen)) = (channels.get(place), seen.get_mut(place)) {
            let is_known = |signal: usize| named.get(signal).is_some_and(|value| value.is_finite());
            seen.has_arrived |= channel.observed.signals().all(is_known);
        }
    }
}

/// The value to assume for an input, if the profile gives one and the signals of the input have not
/// been known yet.
pub(crate) fn assumed(inputs: &[Input], seen: &[ChannelState], input: usize) -> Option<f64> {
    let Input {
        channel,
        if_missing,
        ..
    } = *inputs.get(input)?;
    if_missing.filter(|_| seen.get(channel).is_some_and(|seen| !seen.has_arrived))
}

/// Adds a sample to all channels. It was taken at `t_s` and applies to the preceding `held_s` seconds.
pub(crate) fn push(
    channels: &[Channel],
    seen: &mut [ChannelState],
    (t_s, held_s): (f64, f64),
    observed: &Now<'_>,
) {
    let bin = observed.together.bin;
    let mut before: Option<(&Channel, Moments)> = None;
    for (channel, seen) in channels.iter().zip(seen) {
        // Successive channels often differ only in their windows.
        let now = match before {
            Some((same, now)) if same.sees_as(channel) => now,
            _ => channel.reduce(observed),
        };
        before = Some((channel, now));
        seen.last = now.mean();
        // The noise is computed once per bin and applies to the whole bin.
        let held_s = match channel.observed {
            Observed::CommandNoise => held_s.max(BIN_S),
            _ => held_s,
        };
        if channel.exponential {
            seen.exponential.push(t_s, held_s, &now);
        } else if channel.in_bins {
            seen.push_into_bin(bin, (t_s, held_s), now.mean());
        } else if now.weight() > 0.0 {
            // A sample is weighted by its duration, whatever the number of known motors.
            let moments = now.scaled(held_s / now.weight());
            seen.window.push(t_s, held_s, &moments);
        } else {
            seen.window.advance(t_s);
        }
    }
}

/// The statistic of an input, and how much of its window is covered; `None` if no value is known.
pub(crate) fn value(
    (channels, inputs): (&[Channel], &[Input]),
    seen: &[ChannelState],
    input: usize,
) -> Option<Observation> {
    let Input {
        channel, statistic, ..
    } = *inputs.get(input)?;
    let ChannelState {
        window,
        exponential,
        last,
        bin,
        ..
    } = seen.get(channel)?;
    let is_exponential = channels.get(channel)?.exponential;
    let (mut total, mut samples) = match is_exponential {
        true => (exponential.total(), exponential.samples()),
        false => (window.total(), window.samples()),
    };
    if statistic.uses_bins() {
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
        Statistic::Rate => window.rate(),
        Statistic::Percentile(percent) => window.percentile(percent),
    };
    Some(Observation {
        value: value?,
        samples: match statistic {
            Statistic::Last => None,
            _ => Some(samples),
        },
        covered_s: match is_exponential {
            true => exponential.covered_s(),
            false => total.weight(),
        },
        window_s: window.length_s(),
    })
}

/// The value of an input, and the number and duration of the samples that it was computed from.
///
/// # Example: one second of samples in a window of five seconds
/// ```
/// use flagred::{monitor::Craft, source::{Motors, Observation, Observer, Signal, Source, Statistic}};
///
/// let load = Source { statistic: Statistic::Mean, motors: Motors::Pooled, signal: Signal::MotorCommand, window_s: 5.0, exponential: false };
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
    /// The number of samples in the window; `None` for a statistic that needs only one.
    pub samples: Option<u32>,
    /// The time of the window that the samples cover, in seconds.
    pub covered_s: f64,
    /// The length of the window in seconds.
    pub window_s: f64,
}

impl Channel {
    /// Whether another channel computes the same value from a sample; the windows may differ.
    fn sees_as(&self, other: &Channel) -> bool {
        let window_s = self.window_s;
        *self == Channel { window_s, ..*other }
    }

    /// The moments of the values of one sample, in which each known motor has weight 1.
    fn reduce(&self, now: &Now<'_>) -> Moments {
        let commands = now.motors.iter().map(|motor| motor.command);
        match self.observed {
            Observed::Named(index) => self.threshold(now.signal(index)),
            Observed::Difference { a, b, circular } => {
                let difference = now.signal(a) - now.signal(b);
                self.threshold(match circular {
                    true => short_way_deg(difference),
                    false => difference,
                })
            }
            Observed::Ratio {
                a,
                b,
                unknown_below,
            } => {
                let (of, by) = (now.signal(a), now.signal(b));
                // A division by 0 is not finite, so the value is unknown.
                self.threshold(match by.abs() < unknown_below {
                    true => f64::NAN,
                    false => of / by,
                })
            }
            Observed::Product { a, b } => self.threshold(now.signal(a) * now.signal(b)),
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

    /// The moments of the values of the motors, or of the value into which they are combined; empty if a motor that counts
    /// is unknown.
    fn over(&self, mut motors: impl Iterator<Item = f64> + Clone) -> Moments {
        if let Motors::One(motor) = self.motors {
            let one = motors.nth(motor as usize);
            return self.threshold(one.unwrap_or(f64::NAN));
        }
        if self.motors == Motors::Pooled {
            return Moments::alike(motors, |value| self.counted(value));
        }
        let all = Moments::alike(motors, |value| value);
        let one = match self.motors {
            Motors::Pooled | Motors::Mean | Motors::One(_) => all.mean(),
            Motors::Std => all.std(),
            Motors::Min => all.min(),
            Motors::Max => all.max(),
        };
        self.threshold(one.unwrap_or(f64::NAN))
    }

    /// The moments of a single value; empty if the value is not finite.
    fn threshold(&self, value: f64) -> Moments {
        if value.is_finite() {
            Moments::of(self.counted(value), 1.0)
        } else {
            Moments::EMPTY
        }
    }

    /// The value itself; for a share of time, 1 if it is beyond the threshold and 0 otherwise.
    fn counted(&self, value: f64) -> f64 {
        match self.threshold {
            None => value,
            Some(Threshold::Below(limit)) => f64::from(u8::from(value < limit)),
            Some(Threshold::Above(limit)) => f64::from(u8::from(value > limit)),
        }
    }
}

state! {
    struct ChannelState { window, exponential, last, bin, has_arrived }
    struct Bin { index, samples, sum, held_s, end_s, before }
}
