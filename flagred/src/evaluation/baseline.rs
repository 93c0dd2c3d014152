//! Baselines: predictors without rules that a risk must beat.

use crate::source::{Motors, Signal, Source, Statistic};

/// A predictor without rules: a statistic of the motors, or a signal as it stands.
///
/// # Example
/// ```
/// use flagred::evaluation::Baseline;
///
/// let lowest = Baseline::all().into_iter().find(|baseline| baseline.name == "lowest_motor").ok_or("gone")?;
/// // The less margin the lowest motor has, the more critical.
/// assert!(lowest.score(0.01) > lowest.score(0.3));
/// # Ok::<(), &str>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct Baseline {
    /// Its name.
    pub name: &'static str,
    /// What it is.
    pub description: &'static str,
    /// Where its value comes from.
    pub source: Source,
    /// Whether a higher value is more critical; otherwise a lower one is.
    pub rises: bool,
}

/// Over how many seconds the statistics of the motors are taken.
const WINDOW_S: f64 = 5.0;

impl Baseline {
    /// All baselines.
    pub fn all() -> [Baseline; 6] {
        let of_motors = |name, description, statistic, motors, signal, rises| Baseline {
            name,
            description,
            source: Source {
                statistic,
                motors,
                signal,
                window_s: WINDOW_S,
            },
            rises,
        };
        let wind = |name, description, signal: &str| Baseline {
            name,
            description,
            source: Source {
                statistic: Statistic::Last,
                motors: Motors::Pooled,
                signal: Signal::named(signal),
                window_s: WINDOW_S,
            },
            rises: true,
        };
        [
            of_motors(
                "margin_mean",
                "mean margin of all motors over 5 s",
                Statistic::Mean,
                Motors::Pooled,
                Signal::MotorMargin,
                false,
            ),
            of_motors(
                "lowest_motor",
                "mean margin of the lowest motor over 5 s",
                Statistic::Mean,
                Motors::Min,
                Signal::MotorMargin,
                false,
            ),
            of_motors(
                "spread",
                "standard deviation of all motor commands over 5 s",
                Statistic::Std,
                Motors::Pooled,
                Signal::MotorCommand,
                true,
            ),
            of_motors(
                "saturated_share",
                "share of motors and of 5 s at a command limit",
                Statistic::ShareBelow(0.006),
                Motors::Pooled,
                Signal::MotorMargin,
                true,
            ),
            wind("ekf_wind", "the autopilot's wind estimate", "ekf_wind_m_s"),
            wind(
                "true_wind",
                "the wind as it was, where it is known",
                "wind_m_s",
            ),
        ]
    }

    /// The score of a value: the higher, the more critical.
    pub fn score(&self, value: f64) -> f64 {
        if self.rises { value } else { -value }
    }
}
