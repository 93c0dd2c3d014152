//! Baselines: predictors without rules, with which risks are compared.

use flagred::{
    monitor::Craft,
    source::{Motors, Observer, Signal, Source, Statistic},
};

/// A predictor without rules: a statistic of the motors, or an unchanged signal.
///
/// # Example
/// ```
/// use flagred_evaluation::Baseline;
///
/// let lowest = Baseline::all().into_iter().find(|baseline| baseline.name == "lowest_motor").ok_or("gone")?;
/// // The less margin the lowest motor has, the higher the score.
/// assert!(lowest.score(0.01) > lowest.score(0.3));
/// # Ok::<(), &str>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct Baseline {
    /// The name in tables and documents, such as `margin_mean`.
    pub name: &'static str,
    /// A description in one sentence.
    pub description: &'static str,
    /// The source of the value.
    pub source: Source,
    /// How the statistics of single motors are combined, if the statistic is computed for each motor separately.
    pub per_motor: Option<PerMotor>,
    /// Whether a higher value is more critical; otherwise a lower one is.
    pub rises: bool,
}

/// How the statistics of single motors are combined into one value.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum PerMotor {
    /// The mean over the motors.
    Mean,
    /// The smallest value.
    Min,
}

/// The window of the statistics of all motors, in seconds.
const WINDOW_S: f64 = 5.0;

/// The window of statistics of single motors, and of the share near the upper limit, in seconds.
const SHORT_WINDOW_S: f64 = 2.0;

impl Baseline {
    /// All baselines.
    pub fn all() -> [Baseline; 9] {
        let of = |name, description, source, rises| Baseline {
            name,
            description,
            source,
            per_motor: None,
            rises,
        };
        let over = |window_s, statistic, motors, signal| Source {
            statistic,
            motors,
            signal,
            window_s,
            exponential: false,
        };
        let of_motors = |statistic, motors, signal| over(WINDOW_S, statistic, motors, signal);
        let of_each = |statistic, signal| over(SHORT_WINDOW_S, statistic, Motors::Pooled, signal);
        let last = |signal| of_motors(Statistic::Last, Motors::Pooled, Signal::named(signal));
        [
            of(
                "margin_mean",
                "mean margin of all motors over 5 s",
                of_motors(Statistic::Mean, Motors::Pooled, Signal::MotorMargin),
                false,
            ),
            of(
                "lowest_motor",
                "mean margin of the lowest motor over 5 s",
                of_motors(Statistic::Mean, Motors::Min, Signal::MotorMargin),
                false,
            ),
            of(
                "spread",
                "standard deviation of all motor commands over 5 s",
                of_motors(Statistic::Std, Motors::Pooled, Signal::MotorCommand),
                true,
            ),
            of(
                "saturated_share",
                "share of all motor commands over 5 s that are at a limit",
                of_motors(
                    Statistic::ShareBelow(0.006),
                    Motors::Pooled,
                    Signal::MotorMargin,
                ),
                true,
            ),
            Baseline {
                per_motor: Some(PerMotor::Mean),
                ..of(
                    "motor_activity",
                    "standard deviation of each motor's command over 2 s, mean over the motors",
                    of_each(Statistic::Std, Signal::MotorCommand),
                    true,
                )
            },
            Baseline {
                per_motor: Some(PerMotor::Min),
                ..of(
                    "least_margin",
                    "lowest mean margin of a motor over 2 s",
                    of_each(Statistic::Mean, Signal::MotorMargin),
                    false,
                )
            },
            of(
                "full_share",
                "share of all motor commands over 2 s that are above 0.98",
                of_each(Statistic::ShareAbove(0.98), Signal::MotorCommand),
                true,
            ),
            of(
                "ekf_wind",
                "the autopilot's wind estimate",
                last("ekf_wind_m_s"),
                true,
            ),
            of(
                "true_wind",
                "the true wind, where it is known",
                last("wind_m_s"),
                true,
            ),
        ]
    }

    /// The score of a value: the higher, the more critical.
    pub fn score(&self, value: f64) -> f64 {
        if self.rises { value } else { -value }
    }
}

/// Computes the scores of baselines during a flight.
///
/// # Example: one of two motors at its lower limit
/// ```
/// use flagred_evaluation::{Baseline, BaselineObserver};
/// use flagred::monitor::Craft;
///
/// let baselines = Baseline::all();
/// let mut observer = BaselineObserver::new(&baselines, Craft::new(2))?;
/// for i in 1..=50 {
///     observer.push(f64::from(i) * 0.1, 0.1, &[0.0, 0.5], &[]);
/// }
/// let scores: Vec<Option<f64>> = observer.scores().collect();
/// let score = |name: &str| baselines.iter().zip(&scores).find(|(b, _)| b.name == name).and_then(|(_, score)| *score);
/// assert_eq!((score("spread"), score("motor_activity")), (Some(0.25), Some(0.0)));
/// assert_eq!((score("least_margin"), score("true_wind")), (Some(0.0), None));
/// # Ok::<(), String>(())
/// ```
#[derive(Debug, Clone)]
pub struct BaselineObserver<'a> {
    baselines: &'a [Baseline],
    /// Computes the baselines without [`PerMotor`] whose signals are available, in the order of `baselines`.
    pooled: Observer,
    /// For each motor: computes the statistics of the baselines with [`PerMotor`], in the order of `baselines`.
    motors: Vec<Observer>,
    /// The index of each baseline in `pooled`, or in each observer of `motors`; `None` if its signal is not available.
    indices: Vec<Option<usize>>,
}

impl<'a> BaselineObserver<'a> {
    /// Creates an observer for a craft. If the craft lacks the signal of a baseline, that baseline has no score.
    ///
    /// # Errors
    ///
    /// As [`Observer::new`].
    pub fn new(
        baselines: &'a [Baseline],
        craft: Craft<'_>,
    ) -> Result<BaselineObserver<'a>, String> {
        let names = craft.signals;
        let (mut pooled, mut per_motor) = (vec![], vec![]);
        let indices = baselines
            .iter()
            .map(|baseline| {
                let mut carried = baseline.source.signal.carried();
                let is_there = carried.all(|name| names.contains(&name));
                let sources = match baseline.per_motor {
                    Some(_) => &mut per_motor,
                    None => &mut pooled,
                };
                is_there.then(|| {
                    sources.push(&baseline.source);
                    sources.len() - 1
                })
            })
            .collect();
        let of_a_motor = Observer::new(per_motor, Craft::new(1).with_signals(names))?;
        Ok(BaselineObserver {
            baselines,
            pooled: Observer::new(pooled, craft)?,
            motors: vec![of_a_motor; craft.motors],
            indices,
        })
    }

    /// Discards all observations.
    pub fn clear(&mut self) {
        self.pooled.clear();
        self.motors.iter_mut().for_each(Observer::clear);
    }

    /// Adds a sample, as [`Observer::push`].
    pub fn push(&mut self, t_s: f64, held_s: f64, motors: &[f64], named: &[f64]) {
        self.pooled.push(t_s, held_s, motors, named);
        for (observer, motor) in self.motors.iter_mut().zip(motors.chunks(1)) {
            observer.push(t_s, held_s, motor, named);
        }
    }

    /// The score of each baseline; `None` if unknown.
    pub fn scores(&self) -> impl Iterator<Item = Option<f64>> + '_ {
        self.baselines
            .iter()
            .zip(&self.indices)
            .map(|(baseline, index)| {
                let value = self.value(baseline.per_motor, (*index)?)?;
                Some(baseline.score(value))
            })
    }

    fn value(&self, per_motor: Option<PerMotor>, index: usize) -> Option<f64> {
        let of = |observer: &Observer| observer.value(index).map(|observed| observed.value);
        let mut values = self.motors.iter().filter_map(of);
        match per_motor {
            None => of(&self.pooled),
            Some(PerMotor::Min) => values.reduce(f64::min),
            Some(PerMotor::Mean) => {
                let first = values.next()?;
                let (sum, motors) = values.fold((first, 1.0), |(sum, motors), value| {
                    (sum + value, motors + 1.0)
                });
                Some(sum / motors)
            }
        }
    }
}
