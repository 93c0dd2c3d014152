//! Where a model input comes from: a statistic of a signal over a window.

use alloc::{string::String, vec, vec::Vec};

use crate::channel::{Channel, Input, Observed, Seen, Threshold, push, value};
pub use crate::channel::{Motors, Observation, Statistic};

/// What is observed.
///
/// # Example
/// ```
/// use flagred::source::Signal;
///
/// assert_eq!(Signal::named("motor_margin"), Signal::MotorMargin);
/// assert_eq!(Signal::named("battery_v"), Signal::Named("battery_v".into()));
/// ```
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Signal {
    /// The effective command `e` of each motor: 0 at its lower limit, 1 at its upper one.
    MotorCommand,
    /// The margin `min(e, 1 - e)` of each motor, 0 to 0.5.
    MotorMargin,
    /// How far each motor is from its lower limit: `e`.
    MotorMarginLowSide,
    /// How far each motor is from its upper limit: `1 - e`.
    MotorMarginHighSide,
    /// A signal that the flight carries beside the motors, by name: `battery_v`.
    Named(String),
}

impl Signal {
    /// The signals every flight has, by the names profiles use.
    pub const MOTORS: [(&'static str, Signal); 4] = [
        ("motor_command", Signal::MotorCommand),
        ("motor_margin", Signal::MotorMargin),
        ("motor_margin_low_side", Signal::MotorMarginLowSide),
        ("motor_margin_high_side", Signal::MotorMarginHighSide),
    ];

    /// The signal of a name; a name that is not one of [`Signal::MOTORS`] is one of the flight's own.
    ///
    /// # Example
    /// ```
    /// use flagred::source::Signal;
    ///
    /// for (name, signal) in Signal::MOTORS {
    ///     assert_eq!(Signal::named(name), signal);
    /// }
    /// ```
    pub fn named(name: &str) -> Signal {
        Signal::MOTORS
            .into_iter()
            .find(|(known, _)| *known == name)
            .map_or_else(|| Signal::Named(name.into()), |(_, signal)| signal)
    }

    /// Whether the signal has one value for each motor.
    ///
    /// # Example
    /// ```
    /// use flagred::source::Signal;
    ///
    /// assert!(Signal::MotorCommand.is_of_motors());
    /// assert!(!Signal::named("wind_m_s").is_of_motors());
    /// ```
    pub fn is_of_motors(&self) -> bool {
        !matches!(self, Signal::Named(_))
    }
}

/// Where a model input comes from.
///
/// `{mean: motor_margin}` pools all motors; `{mean: {min: motor_margin}}` is the mean over time of the lowest
/// motor; `{std: {mean: motor_command}}` is the spread over time of what the motors do together.
///
/// # Example: the lowest motor over five seconds, in YAML and in Rust
/// ```
/// use flagred::profile::Profile;
/// use flagred::source::{Motors, Signal, Source, Statistic};
///
/// let text = "flagred: 1\nname: lowest\nrules: my.yaml\ninputs: {x: {mean: {min: motor_margin}, window_s: 5}}";
/// let lowest = Source {
///     statistic: Statistic::Mean,
///     motors: Motors::Min,
///     signal: Signal::MotorMargin,
///     window_s: 5.0,
/// };
/// assert_eq!(text.parse::<Profile>()?.inputs[0].source, lowest);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct Source {
    /// The statistic over time.
    pub statistic: Statistic,
    /// How the motors of one sample become one value, before the statistic.
    pub motors: Motors,
    /// What is observed.
    pub signal: Signal,
    /// Over how many seconds.
    pub window_s: f64,
}

/// The windows that a number of sources need, each window shared by those that look at the same thing.
///
/// # Example: the mean margin of two motors over a second
///
/// ```
/// use flagred::source::{Motors, Observer, Signal, Source, Statistic};
///
/// let margin = Source {
///     statistic: Statistic::Mean,
///     motors: Motors::Pooled,
///     signal: Signal::named("motor_margin"),
///     window_s: 1.0,
/// };
/// let mut observer = Observer::new([&margin], &[])?;
/// for i in 1..=20 {
///     observer.push(f64::from(i) * 0.1, 0.1, &[0.2, 0.7], &[]);
/// }
/// let observed = observer.value(0).ok_or("nothing observed")?;
/// assert!((observed.value - 0.25).abs() < 1e-12);
/// assert_eq!(observed.samples, Some(10));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug, Clone)]
pub struct Observer {
    inputs: Vec<Input>,
    channels: Vec<Channel>,
    seen: Vec<Seen>,
}

impl Observer {
    /// The windows for `sources`; the named signals stand at the places of their names.
    ///
    /// # Errors
    ///
    /// The name of a signal that is not among `names`.
    ///
    /// # Example
    /// ```
    /// # use flagred::source::{Motors, Observer, Signal, Source, Statistic};
    /// # let last = |name| Source { statistic: Statistic::Last, motors: Motors::Pooled, signal: Signal::named(name), window_s: 1.0 };
    /// let wind = last("wind_m_s");
    /// assert!(Observer::new([&wind], &["battery_v", "wind_m_s"]).is_ok());
    /// assert_eq!(Observer::new([&wind], &["battery_v"]).err().as_deref(), Some("wind_m_s"));
    /// ```
    pub fn new<'a>(
        sources: impl IntoIterator<Item = &'a Source>,
        names: &[&str],
    ) -> Result<Observer, String> {
        let (channels, inputs) = channels(sources, names)?;
        let seen = channels.iter().map(|channel| Seen::new(channel.window_s));
        Ok(Observer {
            seen: seen.collect(),
            inputs,
            channels,
        })
    }

    /// Forgets everything.
    ///
    /// # Example
    /// ```
    /// # use flagred::source::{Motors, Observer, Signal, Source, Statistic};
    /// # let last = |name| Source { statistic: Statistic::Last, motors: Motors::Pooled, signal: Signal::named(name), window_s: 1.0 };
    /// let mut observer = Observer::new([&last("wind_m_s")], &["wind_m_s"])?;
    /// observer.push(0.1, 0.1, &[], &[5.0]);
    /// observer.clear();
    /// assert!(observer.value(0).is_none());
    /// # Ok::<(), String>(())
    /// ```
    pub fn clear(&mut self) {
        for seen in &mut self.seen {
            seen.clear();
        }
    }

    /// Adds a sample at `t_s` that stands for the `held_s` seconds before it: the effective command of each motor, and
    /// the named signals in the order of their names; NaN is unknown.
    ///
    /// # Example
    /// ```
    /// # use flagred::source::{Motors, Observer, Signal, Source, Statistic};
    /// # let last = |name| Source { statistic: Statistic::Last, motors: Motors::Pooled, signal: Signal::named(name), window_s: 1.0 };
    /// let mut observer = Observer::new([&last("wind_m_s")], &["wind_m_s"])?;
    /// observer.push(0.1, 0.1, &[0.4, 0.5], &[5.0]);
    /// assert_eq!(observer.value(0).map(|observed| observed.value), Some(5.0));
    /// # Ok::<(), String>(())
    /// ```
    pub fn push(&mut self, t_s: f64, held_s: f64, motors: &[f64], named: &[f64]) {
        let motors = motors.iter().copied();
        push(&self.channels, &mut self.seen, (t_s, held_s), motors, named);
    }

    /// The value of an input, and how much of its window is behind it; `None` where nothing is known.
    ///
    /// # Example
    /// ```
    /// # use flagred::source::{Motors, Observer, Signal, Source, Statistic};
    /// # let last = |name| Source { statistic: Statistic::Last, motors: Motors::Pooled, signal: Signal::named(name), window_s: 1.0 };
    /// let mut observer = Observer::new([&last("wind_m_s")], &["wind_m_s"])?;
    /// assert!(observer.value(0).is_none(), "nothing is known yet");
    /// observer.push(0.1, 0.1, &[], &[f64::NAN]);
    /// assert!(observer.value(0).is_none(), "NaN is unknown");
    /// # Ok::<(), String>(())
    /// ```
    pub fn value(&self, input: usize) -> Option<Observation> {
        value(&self.inputs, &self.seen, input)
    }
}

/// The channels that sources need, each shared by those that look at the same thing, and which of them each source is
/// a statistic of. The named signals stand at the places of their names; a name that is not among them is the error.
pub(crate) fn channels<'a>(
    sources: impl IntoIterator<Item = &'a Source>,
    names: &[&str],
) -> Result<(Vec<Channel>, Vec<Input>), String> {
    let mut channels: Vec<Channel> = vec![];
    let mut inputs = vec![];
    for source in sources {
        let observed = match &source.signal {
            Signal::MotorCommand => Observed::Command,
            Signal::MotorMargin => Observed::Margin,
            Signal::MotorMarginLowSide => Observed::LowSide,
            Signal::MotorMarginHighSide => Observed::HighSide,
            Signal::Named(name) => Observed::Named(
                names
                    .iter()
                    .position(|known| known == name)
                    .ok_or_else(|| name.clone())?,
            ),
        };
        let channel = Channel {
            observed,
            motors: source.motors,
            threshold: match source.statistic {
                Statistic::ShareBelow(value) => Some(Threshold::Below(value)),
                Statistic::ShareAbove(value) => Some(Threshold::Above(value)),
                _ => None,
            },
            window_s: source.window_s,
        };
        let same = channels.iter().position(|known| *known == channel);
        inputs.push(Input {
            channel: same.unwrap_or(channels.len()),
            statistic: source.statistic,
        });
        if same.is_none() {
            channels.push(channel);
        }
    }
    Ok((channels, inputs))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn source(statistic: Statistic, motors: Motors, signal: &str) -> Source {
        Source {
            statistic,
            motors,
            signal: Signal::named(signal),
            window_s: 1.0,
        }
    }

    fn observe(sources: &[Source], samples: &[[f64; 2]]) -> Vec<Option<f64>> {
        let mut observer = Observer::new(sources, &["battery_v"]).unwrap();
        for (i, motors) in samples.iter().enumerate() {
            observer.push(i as f64 * 0.1, 0.1, motors, &[14.8]);
        }
        (0..observer.inputs.len())
            .map(|i| observer.value(i).map(|o| o.value))
            .collect()
    }

    #[test]
    fn statistics_pool_motors_or_reduce_them_first() {
        // Four motor samples: 0.2, 0.6, 0.4, 1.0.
        let samples = [[0.2, 0.6], [0.4, 1.0]];
        let table = [
            (Statistic::Mean, Motors::Pooled, "motor_command", 0.55),
            (Statistic::Mean, Motors::Pooled, "motor_margin", 0.25),
            (
                Statistic::Std,
                Motors::Pooled,
                "motor_command",
                0.0875_f64.sqrt(),
            ),
            (Statistic::Mean, Motors::Min, "motor_margin", 0.1),
            (Statistic::Mean, Motors::Min, "motor_margin_low_side", 0.3),
            (Statistic::Mean, Motors::Min, "motor_margin_high_side", 0.2),
            (Statistic::Min, Motors::Pooled, "motor_margin", 0.0),
            (Statistic::Max, Motors::Mean, "motor_command", 0.7),
            (Statistic::Mean, Motors::Std, "motor_command", 0.25),
            (Statistic::Std, Motors::Mean, "motor_command", 0.15),
            (
                Statistic::Rms,
                Motors::Std,
                "motor_command",
                0.065_f64.sqrt(),
            ),
            (Statistic::Last, Motors::Pooled, "motor_command", 0.7),
            (
                Statistic::ShareBelow(0.01),
                Motors::Pooled,
                "motor_margin",
                0.25,
            ),
            (
                Statistic::ShareBelow(0.01),
                Motors::Min,
                "motor_margin",
                0.5,
            ),
            (
                Statistic::ShareAbove(0.5),
                Motors::Pooled,
                "motor_command",
                0.5,
            ),
            (Statistic::Last, Motors::Pooled, "battery_v", 14.8),
        ];
        let sources: Vec<Source> = table.iter().map(|t| source(t.0, t.1, t.2)).collect();
        for (found, (statistic, motors, signal, expected)) in
            observe(&sources, &samples).into_iter().zip(table)
        {
            let found = found.unwrap();
            assert!(
                (found - expected).abs() < 1e-12,
                "{statistic:?} {motors:?} {signal}: {found}"
            );
        }
    }

    #[test]
    fn unknown_motors_count_for_nothing() {
        let sources = [
            source(Statistic::Mean, Motors::Pooled, "motor_command"),
            source(Statistic::Last, Motors::Min, "motor_command"),
        ];
        let found = observe(&sources, &[[0.2, f64::NAN], [f64::NAN; 2]]);
        assert_eq!(found, [Some(0.2), None]);
    }

    #[test]
    fn inputs_that_look_at_the_same_thing_share_a_window() {
        let sources = [
            source(Statistic::Mean, Motors::Pooled, "motor_command"),
            source(Statistic::Std, Motors::Pooled, "motor_command"),
            source(Statistic::Std, Motors::Min, "motor_command"),
        ];
        assert_eq!(Observer::new(&sources, &[]).unwrap().channels.len(), 2);
    }

    #[test]
    fn a_signal_that_the_flight_lacks_is_named() {
        let sources = [source(Statistic::Last, Motors::Pooled, "rangefinder_m")];
        assert_eq!(
            Observer::new(&sources, &["battery_v"]).unwrap_err(),
            "rangefinder_m"
        );
    }
}
