//! Exponential windows: all past values count, with weights that decay with their age. A window stores only a few numbers.

use crate::moments::Moments;

/// A window in which each value has the weight `exp(-age / constant)`.
#[derive(Debug, Clone)]
pub(crate) struct Exponential {
    constant_s: f64,
    now_s: f64,
    /// The sum of the weights of the samples, where the latest sample has weight 1.
    samples: f64,
    /// The moments, weighted by the integral of `exp(-age / constant)` over the time of each sample.
    moments: Moments,
}

impl Exponential {
    /// Memory for a window, all zeros.
    pub(crate) const IDLE: Exponential = Exponential {
        constant_s: 0.0,
        now_s: 0.0,
        samples: 0.0,
        moments: Moments::IDLE,
    };

    /// An empty window with a time constant above 0.
    pub(crate) const fn new(constant_s: f64) -> Exponential {
        Exponential {
            constant_s,
            now_s: f64::NEG_INFINITY,
            samples: 0.0,
            moments: Moments::EMPTY,
        }
    }

    pub(crate) fn clear(&mut self) {
        *self = Exponential::new(self.constant_s);
    }

    /// Adds a sample at `t_s` that applies to the `held_s` seconds before.
    pub(crate) fn push(&mut self, t_s: f64, held_s: f64, moments: &Moments) {
        self.advance(t_s);
        if held_s <= 0.0 || moments.weight() <= 0.0 {
            return;
        }
        let weight = -self.constant_s * libm::expm1(-held_s / self.constant_s);
        self.moments
            .merge(&moments.scaled(weight / moments.weight()));
        self.samples += 1.0;
    }

    /// Ages all values until `t_s`.
    pub(crate) fn advance(&mut self, t_s: f64) {
        if t_s > self.now_s {
            let left = libm::exp((self.now_s - t_s) / self.constant_s);
            self.moments = self.moments.scaled(left);
            self.samples *= left;
            self.now_s = t_s;
        }
    }

    pub(crate) fn total(&self) -> Moments {
        self.moments
    }

    /// The effective number of samples: at an even rate about the number of samples in one time constant.
    pub(crate) fn samples(&self) -> u32 {
        libm::round(self.samples) as u32
    }

    /// The covered time in seconds: samples without a gap over this time, up to now, would have the same total weight.
    /// This is the inverse of `constant (1 - exp(-seconds / constant))`.
    pub(crate) fn covered_s(&self) -> f64 {
        let share = (self.moments.weight() / self.constant_s).min(1.0);
        -self.constant_s * libm::log1p(-share)
    }
}

state! { struct Exponential { constant_s, now_s, samples, moments } }

#[cfg(test)]
mod tests {
    use super::*;
    use alloc::vec::Vec;

    /// Samples of (seconds, seconds held, value) at uneven times, with a gap.
    fn samples() -> Vec<(f64, f64, f64)> {
        let mut t_s = 50.0;
        let steps = (0..400).map(|i| {
            let held_s = 0.02 + 0.03 * f64::from(i % 7);
            t_s += held_s + if i == 200 { 1.5 } else { 0.0 };
            (t_s, held_s, (f64::from(i) * 0.13).sin() + 2.0)
        });
        steps.collect()
    }

    /// The definition, computed over all samples: the sum of weight times value over the sum of weights.
    fn plain(samples: &[(f64, f64, f64)], constant_s: f64) -> (f64, f64, f64) {
        let now_s = samples[samples.len() - 1].0;
        let weigh = |(t_s, held_s, _): &(f64, f64, f64)| {
            let at = |age_s: f64| constant_s * (-age_s / constant_s).exp();
            at(now_s - t_s) - at(now_s - t_s + held_s)
        };
        let weight: f64 = samples.iter().map(weigh).sum();
        let mean = samples.iter().map(|s| weigh(s) * s.2).sum::<f64>() / weight;
        let squares = samples.iter().map(|s| weigh(s) * (s.2 - mean).powi(2));
        (weight, mean, (squares.sum::<f64>() / weight).sqrt())
    }

    #[test]
    fn exponential_statistics_are_weighted_mean_and_deviation() {
        for constant_s in [0.3, 2.0, 60.0] {
            let samples = samples();
            let mut window = Exponential::new(constant_s);
            for (i, (t_s, held_s, value)) in samples.iter().enumerate() {
                window.push(*t_s, *held_s, &Moments::of(*value, 4.0));
                let (weight, mean, std) = plain(&samples[..=i], constant_s);
                let total = window.total();
                approx::assert_relative_eq!(total.weight(), weight, max_relative = 1e-9);
                approx::assert_relative_eq!(total.mean().unwrap(), mean, max_relative = 1e-9);
                approx::assert_abs_diff_eq!(total.std().unwrap(), std, epsilon = 1e-9);
            }
        }
    }

    #[test]
    fn the_exponential_mean_follows_a_step_like_a_low_pass() {
        let mut window = Exponential::new(5.0);
        for i in 1..=20_000 {
            let value = if i <= 10_000 { 0.0 } else { 1.0 };
            window.push(f64::from(i) * 0.01, 0.01, &Moments::of(value, 0.01));
            if i == 10_500 {
                let expected = 1.0 - (-1.0_f64).exp();
                approx::assert_abs_diff_eq!(
                    window.total().mean().unwrap(),
                    expected,
                    epsilon = 1e-6
                );
            }
        }
    }

    #[test]
    fn exponential_coverage_grows_with_time_and_shrinks_after_a_silence() {
        let mut window = Exponential::new(5.0);
        assert_eq!((window.covered_s(), window.total().mean()), (0.0, None));
        for i in 1..=100 {
            window.push(f64::from(i) * 0.02, 0.02, &Moments::of(1.0, 0.02));
        }
        approx::assert_abs_diff_eq!(window.covered_s(), 2.0, epsilon = 1e-9);
        assert_eq!(window.samples(), 83);
        window.advance(4.0);
        approx::assert_abs_diff_eq!(window.covered_s(), 1.25, epsilon = 0.01);
        window.clear();
        assert_eq!((window.samples(), window.covered_s()), (0, 0.0));
    }
}
