//! The elevated risk: what the risk of the last seconds adds up to (Eq. 4 to 8 of the paper).
//!
//! The risks of a window are taken as normally distributed with their mean `mu` and standard deviation
//! `sigma`; what lies above `high` raises the elevated risk, what lies below `low` lets it fall:
//!
//! ```text
//! p_high = 1 - Phi((high - mu) / sigma)        p_low = Phi((low - mu) / sigma)
//! dR/dt  = rise p_high - fall p_low            0 <= R <= 100
//! ```
//!
//! The paper gives no time step and no values. Ours are rates in % per second, so the result does not depend
//! on the sample rate.

use crate::window::{Moments, Window};

/// The parameters of an [`Accumulator`].
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct AccumulatorSettings {
    /// Over how many seconds the risks are pooled.
    pub window_s: f64,
    /// The risk in % above which the elevated risk rises (the paper's `x_high`).
    pub high_pct: f64,
    /// The risk in % below which it falls (the paper's `x_low`).
    pub low_pct: f64,
    /// How fast it rises when all risks are above `high_pct`, in % per second (the paper's `k_i`).
    pub rise_pct_per_s: f64,
    /// How fast it falls when all risks are below `low_pct`, in % per second (the paper's `k_d`).
    pub fall_pct_per_s: f64,
}

impl Default for AccumulatorSettings {
    fn default() -> Self {
        AccumulatorSettings {
            window_s: 2.0,
            high_pct: 70.0,
            low_pct: 40.0,
            rise_pct_per_s: 25.0,
            fall_pct_per_s: 10.0,
        }
    }
}

/// The elevated risk, in % from 0 to 100, sample by sample.
///
/// # Example: two seconds of high risk
///
/// ```
/// use flagred::accumulator::{Accumulator, AccumulatorSettings};
///
/// let mut accumulator = Accumulator::new(AccumulatorSettings {
///     window_s: 1.0, high_pct: 70.0, low_pct: 40.0, rise_pct_per_s: 25.0, fall_pct_per_s: 10.0,
/// });
/// for i in 1..=50 {
///     accumulator.push(f64::from(i) * 0.04, 0.04, 90.0);
/// }
/// assert!((accumulator.elevated_risk_pct() - 50.0).abs() < 1e-9);
/// ```
#[derive(Debug, Clone)]
pub struct Accumulator {
    settings: AccumulatorSettings,
    risks: Window,
    elevated_pct: f64,
    /// The rate at the last sample in % per second; unknown before the first.
    last_rate: Option<f64>,
}

impl Accumulator {
    /// An accumulator at 0 %.
    pub fn new(settings: AccumulatorSettings) -> Accumulator {
        Accumulator {
            settings,
            risks: Window::new(settings.window_s),
            elevated_pct: 0.0,
            last_rate: None,
        }
    }

    /// Forgets everything and starts at 0 % again.
    pub fn clear(&mut self) {
        self.risks.clear();
        self.elevated_pct = 0.0;
        self.last_rate = None;
    }

    /// Adds the risk at `t_s`, which stood for the `held_s` seconds before; gives the elevated risk in %.
    pub fn push(&mut self, t_s: f64, held_s: f64, risk_pct: f64) -> f64 {
        self.risks
            .push(t_s, held_s, &Moments::of(risk_pct, held_s));
        let total = self.risks.total();
        if let (Some(mean), Some(std)) = (total.mean(), total.std()) {
            let p_high = 1.0 - share_below(self.settings.high_pct, mean, std);
            let p_low = share_below(self.settings.low_pct, mean, std);
            let rate = self.settings.rise_pct_per_s * p_high - self.settings.fall_pct_per_s * p_low;
            // The trapezoidal rule: the rate changes within a sample's time when samples are few.
            let mean_rate = (rate + self.last_rate.unwrap_or(rate)) / 2.0;
            self.elevated_pct = (self.elevated_pct + mean_rate * held_s).clamp(0.0, 100.0);
            self.last_rate = Some(rate);
        }
        self.elevated_pct
    }

    /// The elevated risk in %.
    pub fn elevated_risk_pct(&self) -> f64 {
        self.elevated_pct
    }
}

/// `Phi((x - mean) / std)` with `Phi(z) = (1 + erf(z / sqrt 2)) / 2`; its limit, a step, at `std = 0`.
fn share_below(x: f64, mean: f64, std: f64) -> f64 {
    let distance = x - mean;
    if distance == 0.0 {
        0.5
    } else if std > 0.0 {
        0.5 * (1.0 + libm::erf(distance / std * core::f64::consts::FRAC_1_SQRT_2))
    } else if distance > 0.0 {
        1.0
    } else {
        0.0
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    const SETTINGS: AccumulatorSettings = AccumulatorSettings {
        window_s: 5.0,
        high_pct: 75.0,
        low_pct: 25.0,
        rise_pct_per_s: 10.0,
        fall_pct_per_s: 5.0,
    };

    #[test]
    fn the_normal_distribution_is_that_of_the_tables() {
        for (z, share) in [
            (-2.0, 0.022_750_132),
            (0.0, 0.5),
            (1.0, 0.841_344_746),
            (1.959_963_985, 0.975),
        ] {
            approx::assert_abs_diff_eq!(share_below(z, 0.0, 1.0), share, epsilon = 1e-9);
        }
    }

    #[test]
    fn without_spread_it_is_a_step() {
        assert_eq!(share_below(75.0, 74.9, 0.0), 1.0);
        assert_eq!(share_below(75.0, 75.1, 0.0), 0.0);
        assert_eq!(share_below(75.0, 75.0, 0.0), 0.5);
        assert_eq!(share_below(75.0, 75.1, f64::MIN_POSITIVE), 0.0);
    }

    #[test]
    fn it_rises_holds_falls_and_stays_within_0_and_100() {
        let mut accumulator = Accumulator::new(SETTINGS);
        let mut t_s = 0.0;
        let mut hold = |accumulator: &mut Accumulator, risk: f64, seconds: usize| {
            let mut elevated = 0.0;
            for _ in 0..seconds * 25 {
                t_s += 0.04;
                elevated = accumulator.push(t_s, 0.04, risk);
            }
            elevated
        };
        approx::assert_abs_diff_eq!(hold(&mut accumulator, 90.0, 4), 40.0, epsilon = 1e-9);
        approx::assert_abs_diff_eq!(hold(&mut accumulator, 90.0, 60), 100.0, epsilon = 1e-9);
        accumulator.clear();
        assert_eq!(accumulator.elevated_risk_pct(), 0.0);
        assert_eq!(hold(&mut accumulator, 50.0, 60), 0.0);
        assert_eq!(hold(&mut accumulator, 0.0, 60), 0.0);
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(16))]

        // Risks that hold for five seconds each, seen at 1, 10, 25 and 400 Hz.
        #[test]
        fn it_does_not_depend_on_the_sample_rate(risks in prop::collection::vec(0.0..100.0f64, 5..40)) {
            let run = |rate: usize| {
                let mut accumulator = Accumulator::new(SETTINGS);
                let dt = 1.0 / rate as f64;
                for i in 0..risks.len() * 5 * rate {
                    accumulator.push((i + 1) as f64 * dt, dt, risks[i / (5 * rate)]);
                }
                accumulator.elevated_risk_pct()
            };
            let fine = run(400);
            // At 1 Hz a jump of the risk is seen half a second late or early: half of `rise`.
            for (rate, points) in [(1, 5.0), (10, 2.0), (25, 1.0)] {
                let difference = run(rate) - fine;
                prop_assert!(difference.abs() < points, "{rate} Hz: off by {difference}");
            }
        }
    }
}
