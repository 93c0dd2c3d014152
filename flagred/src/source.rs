//! The source of an input: a statistic of a signal over a window.

use alloc::{string::String, vec, vec::Vec};

pub use crate::channel::{Motors, Observation, Statistic};
use crate::{
    channel::{Channel, ChannelState, Input, Now, Observed, Threshold, push, restart, value},
    craft::Craft,
    motor::{Bin, Motor, clear, set_geometry, take},
};

/// The signal that is observed.
#[derive(Debug, Clone, PartialEq)]
pub enum Signal {
    /// The effective command `e` of each motor: 0 at its lower limit, 1 at its upper limit.
    MotorCommand,
    /// The command of each motor without the part that commands yaw: `e_i - y_i yaw`, with the yaw factor `y_i` of the
    /// motor and the yaw effort of all motors. If the geometry is unknown, this is the command itself. If the geometry
    /// is known, the value is unknown while any motor is unknown.
    MotorCommandLessYaw,
    /// The margin `min(e, 1 - e)` of each motor, 0 to 0.5.
    MotorMargin,
    /// The distance of each motor from its lower limit: `e`.
    MotorMarginLowSide,
    /// The distance of each motor from its upper limit: `1 - e`.
    MotorMarginHighSide,
    /// The roll effort of all motors; this and the other efforts are unknown without a geometry.
    RollEffort,
    /// The pitch effort.
    PitchEffort,
    /// The yaw effort.
    YawEffort,
    /// The thrust effort.
    ThrustEffort,
    /// The noise of the commands, every 0.1 s: `sqrt(mean over motors of (step^2) / 2)`, with the steps between the
    /// means of successive bins of 0.1 s.
    CommandNoise,
    /// Another signal of the flight by its name, such as `battery_v`.
    Named(String),
    /// The difference `a - b` of two named signals. If both names end in `_deg`, the signals are angles, and the
    /// difference is taken the shorter way around, in [-180, 180).
    Difference {
        /// The minuend.
        a: String,
        /// The subtrahend.
        b: String,
    },
    /// The ratio `a / b` of two named signals.
    Ratio {
        /// The dividend.
        a: String,
        /// The divisor.
        b: String,
        /// The ratio is unknown while `|b|` is below this, and always when `b` is 0.
        unknown_below: f64,
    },
    /// The product `a b` of two named signals.
    Product {
        /// The first factor.
        a: String,
        /// The second factor.
        b: String,
    },
}

/// The signals with a value for each motor, with their names in profiles.
const OF_MOTORS: [(&str, Signal); 5] = [
    ("motor_command", Signal::MotorCommand),
    ("motor_command_less_yaw", Signal::MotorCommandLessYaw),
    ("motor_margin", Signal::MotorMargin),
    ("motor_margin_low_side", Signal::MotorMarginLowSide),
    ("motor_margin_high_side", Signal::MotorMarginHighSide),
];

/// The signals with one value for all motors.
const OF_ALL_MOTORS: [(&str, Signal); 5] = [
    ("roll_effort", Signal::RollEffort),
    ("pitch_effort", Signal::PitchEffort),
    ("yaw_effort", Signal::YawEffort),
    ("thrust_effort", Signal::ThrustEffort),
    ("command_noise", Signal::CommandNoise),
];

impl Signal {
    /// The names of the signals that have a value for each motor.
    pub fn names_of_motors() -> impl Iterator<Item = &'static str> {
        OF_MOTORS.iter().map(|(name, _)| *name)
    }

    /// The names of the signals that are computed from the commands of the motors.
    pub fn names() -> impl Iterator<Item = &'static str> + Clone {
        let all = OF_MOTORS.iter().chain(&OF_ALL_MOTORS);
        all.map(|(name, _)| *name)
    }

    /// The signal with the given name; any other name denotes a signal of the flight.
    pub fn named(name: &str) -> Signal {
        OF_MOTORS
            .into_iter()
            .chain(OF_ALL_MOTORS)
            .find(|(known, _)| *known == name)
            .map_or_else(|| Signal::Named(name.into()), |(_, signal)| signal)
    }

    /// The name of a signal that is computed from the commands of the motors; `None` for other signals.
    pub(crate) fn name_of(signal: &Signal) -> Option<&'static str> {
        let mut all = OF_MOTORS.iter().chain(&OF_ALL_MOTORS);
        all.find(|(_, known)| known == signal)
            .map(|(name, _)| *name)
    }

    /// The names of the signals that samples must contain to compute this signal.
    pub fn carried(&self) -> impl Iterator<Item = &str> + Clone {
        let (first, second) = match self {
            Signal::Named(name) => (Some(name), None),
            Signal::Difference { a, b } | Signal::Product { a, b } => (Some(a), Some(b)),
            Signal::Ratio { a, b, .. } => (Some(a), Some(b)),
            _ => (None, None),
        };
        first.into_iter().chain(second).map(String::as_str)
    }

    /// Whether the signal is computed from the commands of the motors.
    pub fn is_computed_from_commands(&self) -> bool {
        self.carried().next().is_none()
    }

    /// Whether the signal has one value for each motor.
    pub fn is_of_motors(&self) -> bool {
        OF_MOTORS.iter().any(|(_, signal)| signal == self)
    }
}

/// The source of an input.
///
/// `{mean: motor_margin}` pools all motors; `{mean: {min: motor_margin}}` is the mean over time of the lowest motor;
/// `{std: {mean: motor_command}}` is the standard deviation over time of the mean of the motors.
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
///     exponential: false,
/// };
/// assert_eq!(text.parse::<Profile>()?.inputs[0].source, lowest);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct Source {
    /// The statistic over time.
    pub statistic: Statistic,
    /// How the motors of one sample are combined into one value, before the statistic.
    pub motors: Motors,
    /// The observed signal.
    pub signal: Signal,
    /// The length of the window in seconds; for an exponential window its time constant.
    pub window_s: f64,
    /// Whether the window is exponential: all past values count with the weight `exp(-age / window_s)`.
    pub exponential: bool,
}

/// Computes the values of several sources. Sources that observe the same signal share a window.
///
/// # Example: the mean margin of two motors over a second
///
/// ```
/// use flagred::{monitor::Craft, source::{Motors, Observer, Signal, Source, Statistic}};
///
/// let margin = Source {
///     statistic: Statistic::Mean,
///     motors: Motors::Pooled,
///     signal: Signal::named("motor_margin"),
///     window_s: 1.0,
///     exponential: false,
/// };
/// let mut observer = Observer::new([&margin], Craft::new(2))?;
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
    seen: Vec<ChannelState>,
    motors: Vec<Motor>,
    bin: Bin,
}

impl Observer {
    /// Creates an observer that computes the values of `sources` from the samples of a craft.
    ///
    /// # Errors
    ///
    /// If the craft does not have a signal of a source; the error is the name of the signal.
    pub fn new<'a>(
        sources: impl IntoIterator<Item = &'a Source>,
        craft: Craft<'_>,
    ) -> Result<Observer, String> {
        let (channels, inputs) = channels(sources, craft.signals)?;
        let mut seen = vec![ChannelState::IDLE; channels.len()];
        restart(&channels, &mut seen);
        let mut motors = vec![Motor::UNKNOWN; craft.motors];
        set_geometry(&mut motors, craft.geometry);
        Ok(Observer {
            seen,
            inputs,
            channels,
            motors,
            bin: Bin::NONE,
        })
    }

    /// Discards all observations.
    pub fn clear(&mut self) {
        for seen in &mut self.seen {
            seen.clear();
        }
        clear(&mut self.motors, false);
        self.bin = Bin::NONE;
    }

    /// Adds a sample at `t_s` that applies to the `held_s` seconds before: the effective commands of the motors and the
    /// values of the craft's signals; NaN is unknown.
    pub fn push(&mut self, t_s: f64, held_s: f64, motors: &[f64], named: &[f64]) {
        let together = take(&mut self.motors, &mut self.bin, t_s, motors);
        let motors = &self.motors;
        let now = Now {
            motors,
            together,
            named,
        };
        push(&self.channels, &mut self.seen, (t_s, held_s), &now);
    }

    /// The value of the source with this index; `None` if nothing is known.
    pub fn value(&self, input: usize) -> Option<Observation> {
        value((&self.channels, &self.inputs), &self.seen, input)
    }

    /// The interval of the value of the source with this index.
    #[cfg(test)]
    pub(crate) fn interval(&self, input: usize) -> Option<fuzzy::engine::Interval> {
        crate::channel::interval((&self.channels, &self.inputs), &self.seen, input)
    }
}

/// Whether a signal is an angle in degrees, by its name.
pub(crate) fn is_angle(name: &str) -> bool {
    name.ends_with("_deg")
}

/// Returns the channels that sources need, and the channel and statistic of each source. Sources that observe the
/// same signal share a channel. Named signals are identified by their index in `names`; the error is a name that
/// `names` does not contain.
pub(crate) fn channels<'a>(
    sources: impl IntoIterator<Item = &'a Source>,
    names: &[&str],
) -> Result<(Vec<Channel>, Vec<Input>), String> {
    let mut channels: Vec<Channel> = vec![];
    let mut inputs = vec![];
    let place = |name: &String| {
        let place = names.iter().position(|known| known == name);
        place.ok_or_else(|| name.clone())
    };
    for source in sources {
        let observed = match &source.signal {
            Signal::MotorCommand => Observed::Command,
            Signal::MotorMargin => Observed::Margin,
            Signal::MotorMarginLowSide => Observed::LowSide,
            Signal::MotorMarginHighSide => Observed::HighSide,
            Signal::MotorCommandLessYaw => Observed::CommandLessYaw,
            Signal::RollEffort => Observed::Effort(0),
            Signal::PitchEffort => Observed::Effort(1),
            Signal::YawEffort => Observed::Effort(2),
            Signal::ThrustEffort => Observed::Effort(3),
            Signal::CommandNoise => Observed::CommandNoise,
            Signal::Named(name) => Observed::Named(place(name)?),
            Signal::Difference { a, b } => Observed::Difference {
                circular: is_angle(a) && is_angle(b),
                a: place(a)?,
                b: place(b)?,
            },
            Signal::Ratio {
                a,
                b,
                unknown_below,
            } => Observed::Ratio {
                a: place(a)?,
                b: place(b)?,
                unknown_below: *unknown_below,
            },
            Signal::Product { a, b } => Observed::Product {
                a: place(a)?,
                b: place(b)?,
            },
        };
        let channel = Channel {
            observed,
            motors: source.motors,
            threshold: match source.statistic {
                Statistic::ShareBelow(value) => Some(Threshold::Below(value)),
                Statistic::ShareAbove(value) => Some(Threshold::Above(value)),
                _ => None,
            },
            in_bins: source.statistic.uses_bins(),
            window_s: source.window_s,
            exponential: source.exponential,
        };
        let same = channels.iter().position(|known| *known == channel);
        inputs.push(Input {
            channel: same.unwrap_or(channels.len()),
            statistic: source.statistic,
            ratio: None,
            if_missing: None,
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

    fn craft<'a>(signals: &'a [&'a str]) -> Craft<'a> {
        Craft::new(2).with_signals(signals)
    }

    fn source(statistic: Statistic, motors: Motors, signal: &str) -> Source {
        Source {
            statistic,
            motors,
            signal: Signal::named(signal),
            window_s: 1.0,
            exponential: false,
        }
    }

    fn observe(sources: &[Source], samples: &[[f64; 2]]) -> Vec<Option<f64>> {
        let mut observer = Observer::new(sources, craft(&["battery_v"])).unwrap();
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
            (Statistic::Mean, Motors::One(0), "motor_command", 0.3),
            (Statistic::Max, Motors::One(1), "motor_margin", 0.4),
            (
                Statistic::ShareAbove(0.3),
                Motors::One(0),
                "motor_command",
                0.5,
            ),
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
    fn a_sample_with_an_unknown_motor_is_ignored() {
        let sources = [
            source(Statistic::Mean, Motors::Pooled, "motor_command"),
            source(Statistic::Last, Motors::Min, "motor_command"),
            // The geometry is unknown.
            source(Statistic::Mean, Motors::Pooled, "motor_command_less_yaw"),
            source(Statistic::Mean, Motors::One(1), "motor_command"),
            // There are only two motors.
            source(Statistic::Mean, Motors::One(2), "motor_command"),
        ];
        let found = observe(&sources, &[[0.2, f64::NAN], [f64::NAN; 2]]);
        assert_eq!(found, [None; 5]);
    }

    #[test]
    fn a_difference_of_angles_goes_the_short_way_around() {
        let names = ["yaw_des_deg", "yaw_deg", "ekf_wind_m_s", "wind_m_s"];
        let difference = |a: usize, b: usize| Source {
            signal: Signal::Difference {
                a: names[a].into(),
                b: names[b].into(),
            },
            ..source(Statistic::Last, Motors::Pooled, "")
        };
        let sources = [difference(0, 1), difference(2, 3)];
        for (a, b, angle, plain) in [
            (10.0, 4.0, 6.0, 6.0),
            (179.0, -179.0, -2.0, 358.0),
            (-179.0, 179.0, 2.0, -358.0),
            (350.0, 5.0, -15.0, 345.0),
            (90.0, -90.0, -180.0, 180.0),
            (-90.0, 90.0, -180.0, -180.0),
            (725.0, 0.0, 5.0, 725.0),
        ] {
            let mut observer = Observer::new(&sources, craft(&names)).unwrap();
            observer.push(1.0, 0.1, &[], &[a, b, a, b]);
            let found = [0, 1].map(|i| observer.value(i).map(|o| o.value));
            assert_eq!(found, [Some(angle), Some(plain)], "{a} - {b}");
            observer.push(1.1, 0.1, &[], &[f64::NAN, b, a, f64::NAN]);
            assert_eq!(observer.value(0), None);
        }
        assert_eq!(
            Observer::new(&sources, craft(&names[..3])).unwrap_err(),
            "wind_m_s"
        );
    }

    #[test]
    fn a_ratio_of_signals_is_unknown_near_a_divisor_of_0_and_never_infinite() {
        let (a, b) = (String::from("battery_a"), String::from("battery_v"));
        let of = |signal| Source {
            signal,
            ..source(Statistic::Last, Motors::Pooled, "")
        };
        let ratio = |unknown_below| {
            let (a, b) = (a.clone(), b.clone());
            of(Signal::Ratio {
                a,
                b,
                unknown_below,
            })
        };
        let (first, second) = (a.clone(), b.clone());
        let product = of(Signal::Product {
            a: first,
            b: second,
        });
        let sources = [ratio(0.0), ratio(0.5), product];
        let nan = f64::NAN;
        for (a, b, found) in [
            (3.0, 2.0, [Some(1.5), Some(1.5), Some(6.0)]),
            (3.0, -0.5, [Some(-6.0), Some(-6.0), Some(-1.5)]),
            (3.0, -0.25, [Some(-12.0), None, Some(-0.75)]),
            (3.0, 0.0, [None, None, Some(0.0)]),
            (0.0, -0.0, [None, None, Some(0.0)]),
            (1e300, 1e-300, [None, None, Some(1.0)]),
            (1e300, 1e300, [Some(1.0), Some(1.0), None]),
            (nan, 2.0, [None; 3]),
            (3.0, nan, [None; 3]),
        ] {
            let mut observer = Observer::new(&sources, craft(&["battery_a", "battery_v"])).unwrap();
            observer.push(1.0, 0.1, &[], &[a, b]);
            let values = [0, 1, 2].map(|i| observer.value(i).map(|o| o.value));
            assert_eq!(values, found, "{a} {b}");
        }
    }

    #[test]
    fn inputs_with_the_same_source_share_a_window() {
        let sources = [
            source(Statistic::Mean, Motors::Pooled, "motor_command"),
            source(Statistic::Std, Motors::Pooled, "motor_command"),
            source(Statistic::Std, Motors::Min, "motor_command"),
        ];
        assert_eq!(
            Observer::new(&sources, craft(&[])).unwrap().channels.len(),
            2
        );
    }

    /// Pseudo-random numbers, uniform from -1 to 1; their standard deviation is `1 / sqrt(3)`.
    fn noise() -> impl FnMut() -> f64 {
        let mut state = 1_u64;
        move || {
            state = state
                .wrapping_mul(6_364_136_223_846_793_005)
                .wrapping_add(1_442_695_040_888_963_407);
            (state >> 11) as f64 / (1_u64 << 52) as f64 - 1.0
        }
    }

    /// Returns the values of the sources after 60 s in which the commands of two motors deviate from 0.5 by `apart(t)`,
    /// in opposite directions, sampled at `rate_hz`.
    fn at_rate(sources: &[Source], rate_hz: f64, mut apart: impl FnMut(f64) -> f64) -> Vec<f64> {
        let mut observer = Observer::new(sources, craft(&["battery_v"])).unwrap();
        for i in 0..(60.0 * rate_hz) as u32 {
            let t_s = f64::from(i) / rate_hz;
            let apart = apart(t_s);
            let motors = [0.5 - apart, 0.5 + apart];
            observer.push(t_s, 1.0 / rate_hz, &motors, &[apart]);
        }
        (0..sources.len())
            .map(|i| observer.value(i).unwrap().value)
            .collect()
    }

    fn unsteadiness(window_s: f64) -> [Source; 3] {
        [Statistic::StdLessNoise, Statistic::Noise, Statistic::Std].map(|statistic| Source {
            window_s,
            ..source(statistic, Motors::Pooled, "battery_v")
        })
    }

    #[test]
    fn noise_and_movement_agree_with_a_plain_computation() {
        let mut random = noise();
        let values: Vec<f64> = (0..600)
            .map(|i| (f64::from(i) * 0.05).sin() + 0.3 * random())
            .collect();
        let mut next = values.iter().copied();
        let found = at_rate(&unsteadiness(100.0), 10.0, |_| next.next().unwrap());

        let count = values.len() as f64;
        let mean = values.iter().sum::<f64>() / count;
        let variance = values.iter().map(|x| (x - mean).powi(2)).sum::<f64>() / count;
        let steps: f64 = values
            .windows(2)
            .map(|pair| (pair[1] - pair[0]).powi(2))
            .sum();
        // The first value has no step, and has the same weight as the others.
        let noise = (steps / count / 2.0).sqrt();
        let expected = [(variance - noise * noise).sqrt(), noise, variance.sqrt()];
        for (found, expected) in found.into_iter().zip(expected) {
            approx::assert_abs_diff_eq!(found, expected, epsilon = 1e-9);
        }
    }

    #[test]
    fn white_noise_is_noise_and_a_slow_sine_is_movement() {
        let mut random = noise();
        let sigma = 0.03 / 3.0_f64.sqrt();
        let [less_noise, noise, _] = at_rate(&unsteadiness(60.0), 10.0, |_| 0.03 * random())[..]
        else {
            panic!()
        };
        approx::assert_relative_eq!(noise, sigma, max_relative = 0.05);
        assert!(less_noise < 0.3 * sigma, "{less_noise}");

        let sine = |t_s: f64| 0.03 * (t_s * 0.2 * core::f64::consts::TAU).sin();
        let [less_noise, noise, std] = at_rate(&unsteadiness(60.0), 10.0, sine)[..] else {
            panic!()
        };
        approx::assert_relative_eq!(less_noise, std, max_relative = 0.01);
        assert!(noise < 0.1 * std, "{noise}");
    }

    /// The statistics without noise agree within 5 % for all rates of the log, with noise of 0.009 on movement of
    /// 0.014.
    #[test]
    fn one_flight_at_different_rates_has_the_same_unsteadiness() {
        let sources = [
            source(Statistic::StdLessNoise, Motors::Std, "motor_command"),
            source(Statistic::StdLessNoise, Motors::Pooled, "battery_v"),
            source(Statistic::Mean, Motors::Pooled, "motor_command"),
        ]
        .map(|source| Source {
            window_s: 60.0,
            ..source
        });
        let apart = |t_s: f64| 0.1 + 0.02 * (t_s * 0.2 * core::f64::consts::TAU).sin();
        let quiet = at_rate(&sources, 400.0, apart);
        approx::assert_relative_eq!(quiet[0], 0.02 / 2.0_f64.sqrt(), max_relative = 0.02);
        for rate_hz in [400.0, 50.0, 25.0, 10.0, 5.0] {
            let mut random = noise();
            let found = at_rate(&sources, rate_hz, |t_s| apart(t_s) + 0.015 * random());
            for (i, (found, quiet)) in found.iter().zip(&quiet).enumerate() {
                approx::assert_relative_eq!(found, quiet, max_relative = 0.05);
                assert!(*found > 0.0, "source {i} at {rate_hz} Hz");
            }
        }
    }

    /// The factors of a quadrotor in an X, [roll, pitch, yaw].
    const QUAD_X: [crate::monitor::Factors; 4] = [
        [-1.0, 1.0, 1.0],
        [1.0, -1.0, 1.0],
        [1.0, 1.0, -1.0],
        [-1.0, -1.0, -1.0],
    ];

    #[test]
    fn yaw_of_a_quad_does_not_change_the_spread_without_yaw() {
        let sources = ["motor_command_less_yaw", "motor_command"]
            .map(|signal| source(Statistic::Mean, Motors::Std, signal));
        let spread = |geometry, yaw: f64| {
            let craft = Craft::new(4).with_geometry(geometry);
            let mut observer = Observer::new(&sources, craft).unwrap();
            for i in 0..20 {
                let roll = 0.05;
                let motors = QUAD_X.map(|[r, _, y]| 0.5 + roll * r + yaw * y);
                observer.push(f64::from(i) * 0.05, 0.05, &motors, &[]);
            }
            [0, 1].map(|i| observer.value(i).unwrap().value)
        };
        let [straight, all] = spread(&QUAD_X[..], 0.0);
        assert_eq!(straight, all);
        for yaw in [-0.2, 0.1, 0.3] {
            let [less_yaw, all] = spread(&QUAD_X[..], yaw);
            approx::assert_abs_diff_eq!(less_yaw, straight, epsilon = 1e-12);
            assert!(all > 1.5 * straight, "{all}");
            // Without a geometry, yaw is not removed.
            let [less_yaw, all] = spread(&[], yaw);
            assert_eq!(less_yaw, all);
        }
    }

    #[test]
    fn a_signal_that_the_flight_lacks_is_named() {
        let sources = [source(Statistic::Last, Motors::Pooled, "rangefinder_m")];
        assert_eq!(
            Observer::new(&sources, craft(&["battery_v"])).unwrap_err(),
            "rangefinder_m"
        );
    }
}
