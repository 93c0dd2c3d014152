//! The elevated risk, accumulated from the risks of the last seconds (Eq. 4 to 8 of the paper).
//!
//! The risks of a window are modelled as a normal distribution with their mean `mu` and standard deviation `sigma`. The
//! part of the distribution above `high` raises the elevated risk, the part below `low` lowers it:
//!
//! ```text
//! p_high = 1 - Phi((high - mu) / sigma)        p_low = Phi((low - mu) / sigma)
//! dR/dt  = rise p_high - fall p_low            0 <= R <= 100
//! ```
//!
//! The paper gives neither a time step nor values for its parameters. Here, `rise` and `fall` are rates in % per
//! second, so the result does not depend on the sample rate. The risk and the rate are interpolated linearly between
//! two samples, and `sigma` includes the change of the risk between samples. The first risk and the first rate also
//! apply to the time before them.

use crate::{moments::Moments, window::Window};

/// The parameters of the elevated risk.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct AccumulatorSettings {
    /// The length of the window of risks, in seconds.
    pub window_s: f64,
    /// The risk in % above which the elevated risk rises (the paper's `x_high`).
    pub high_pct: f64,
    /// The risk in % below which the elevated risk falls (the paper's `x_low`).
    pub low_pct: f64,
    /// The rate at which the elevated risk rises when all risks are above `high_pct`, in % per
    /// second (the paper's `k_i`).
    pub rise_pct_per_s: f64,
    /// The rate at which the elevated risk falls when all risks are below `low_pct`, in % per
    /// second (the paper's `k_d`).
    pub fall_pct_per_s: f64,
}

impl Default for AccumulatorSettings {
    /// The default parameters, which were calibrated on simulated flights.
    fn default() -> Self {
        AccumulatorSettings {
            window_s: 10.0,
            high_pct: 50.0,
            low_pct: 20.0,
            rise_pct_per_s: 1.5,
            fall_pct_per_s: 2.0,
        }
    }
}

/// Computes the elevated risk, in % from 0 to 100, sample by sample. The window of risks is in the caller's memory.
#[derive(Debug, Clone)]
pub(crate) struct Accumulator {
    settings: AccumulatorSettings,
    elevated_pct: f64,
    /// Risk in % and rate in % per second at the last sample. Both are interpolated linearly between two samples, so
    /// that low sample rates are as accurate as high ones.
    last: Option<(f64, f64)>,
}

impl Accumulator {
    pub(crate) const fn new(settings: AccumulatorSettings) -> Accumulator {
        Accumulator {
            settings,
            elevated_pct: 0.0,
            last: None,
        }
    }

    pub(crate) fn clear(&mut self, risks: &mut Window) {
        risks.clear();
        self.elevated_pct = 0.0;
        self.last = None;
    }

    /// Adds the risk at `t_s`, which applies to the preceding `held_s` seconds. Returns the elevated risk in %.
    pub(crate) fn push(
        &mut self,
        risks: &mut Window,
        (t_s, held_s): (f64, f64),
        risk_pct: f64,
    ) -> f64 {
        let last_risk = self.last.map_or(risk_pct, |(risk, _)| risk);
        let between = Moments::between(last_risk, risk_pct, held_s);
        risks.push(t_s, held_s, &between);
        let total = risks.total();
        if let (Some(mean), Some(std)) = (total.mean(), total.std()) {
            let p_high = 1.0 - share_below(self.settings.high_pct, mean, std);
            let p_low = share_below(self.settings.low_pct, mean, std);
            let rate = self.settings.rise_pct_per_s * p_high - self.settings.fall_pct_per_s * p_low;
            let last_rate = self.last.map_or(rate, |(_, rate)| rate);
            let step = (rate + last_rate) / 2.0 * held_s;
            self.elevated_pct = (self.elevated_pct + step).clamp(0.0, 100.0);
            self.last = Some((risk_pct, rate));
        }
        self.elevated_pct
    }
}

/// `Phi((x - mean) / std)` with `Phi(z) = (1 + erf(z / sqrt 2)) / 2`; for `std = 0` the limit of this function, which
/// is a step.
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

state! {
    struct Accumulator { settings, elevated_pct, last }
    struct AccumulatorSettings { window_s, high_pct, low_pct, rise_pct_per_s, fall_pct_per_s }
}

#[cfg(test)]
mod tests {
    use super::*;
    use alloc::vec::Vec;

    const SETTINGS: AccumulatorSettings = AccumulatorSettings {
        window_s: 5.0,
        high_pct: 75.0,
        low_pct: 25.0,
        rise_pct_per_s: 10.0,
        fall_pct_per_s: 5.0,
    };

    #[test]
    fn the_normal_distribution_has_tabulated_values() {
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
    fn without_spread_the_distribution_is_a_step() {
        assert_eq!(share_below(75.0, 74.9, 0.0), 1.0);
        assert_eq!(share_below(75.0, 75.1, 0.0), 0.0);
        assert_eq!(share_below(75.0, 75.0, 0.0), 0.5);
        assert_eq!(share_below(75.0, 75.1, f64::MIN_POSITIVE), 0.0);
    }

    #[test]
    fn the_elevated_risk_rises_holds_falls_and_stays_within_0_and_100() {
        let (mut accumulator, mut risks) = (Accumulator::new(SETTINGS), Window::new(5.0));
        let mut t_s = 0.0;
        let mut hold = |accumulator: &mut Accumulator, risks: &mut Window, risk: f64, seconds| {
            let mut elevated = 0.0;
            for _ in 0..seconds * 25 {
                t_s += 0.04;
                elevated = accumulator.push(risks, (t_s, 0.04), risk);
            }
            elevated
        };
        approx::assert_abs_diff_eq!(
            hold(&mut accumulator, &mut risks, 90.0, 4),
            40.0,
            epsilon = 1e-9
        );
        approx::assert_abs_diff_eq!(
            hold(&mut accumulator, &mut risks, 90.0, 60),
            100.0,
            epsilon = 1e-9
        );
        accumulator.clear(&mut risks);
        assert_eq!(accumulator.elevated_pct, 0.0);
        assert_eq!(hold(&mut accumulator, &mut risks, 50.0, 60), 0.0);
        assert_eq!(hold(&mut accumulator, &mut risks, 0.0, 60), 0.0);
    }

    #[test]
    fn the_elevated_risk_does_not_depend_on_the_sample_rate() {
        // A risk that swings slowly, sampled at 1, 10, 25 and 400 Hz.
        let run = |rate: u32| {
            let (mut accumulator, mut risks) = (Accumulator::new(SETTINGS), Window::new(5.0));
            let dt = 1.0 / f64::from(rate);
            let seconds = |i: u32| f64::from(i) * dt;
            let samples = (1..=120 * rate).map(|i| {
                let risk = 50.0 + 45.0 * (seconds(i) / 8.0).sin();
                (i, accumulator.push(&mut risks, (seconds(i), dt), risk))
            });
            let whole_seconds = samples.filter(|(i, _)| i % rate == 0);
            whole_seconds
                .map(|(_, elevated)| elevated)
                .collect::<Vec<f64>>()
        };
        let fine = run(400);
        assert!(fine.iter().any(|e| *e > 50.0) && fine.iter().any(|e| *e < 10.0));
        for rate in [1, 10, 25] {
            for (coarse, fine) in run(rate).iter().zip(&fine) {
                assert!(
                    (coarse - fine).abs() < 2.0,
                    "{rate} Hz: {coarse} not {fine}"
                );
            }
        }
    }
}
