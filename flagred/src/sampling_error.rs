//! The sampling error of a mean over time: how far the mean of samples may be from the mean over the whole time
//! that they cover.
//!
//! Samples of a signal over time are a systematic sample, and samples that follow each other are alike. So the
//! error follows from the differences between successive samples and not from their standard deviation: a slowly
//! moving signal is well known between its samples, but noise is not. The estimator that uses successive
//! differences is v2 in K. Wolter, "Introduction to Variance Estimation", chapter 8; such differences go back to
//! J. von Neumann (1941). For independent values, the expected result is that of `s^2 / n`.

use fuzzy::engine::Interval;

/// The 97.5 % quantile of the normal distribution.
const NORMAL_QUANTILE: f64 = 1.959_964;

/// A mean with its sampling error.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct SampledMean {
    pub(crate) mean: f64,
    /// Half the width of the two-sided 95 % interval; infinite if there is only one value.
    pub(crate) half_width: f64,
}

impl SampledMean {
    /// Computes the mean of values in order of time. Each item consists of the weight of a value, and the product of
    /// weight and value. `None` if there are no values.
    pub(crate) fn of(values: impl Iterator<Item = (f64, f64)>) -> Option<SampledMean> {
        let (mut count, mut total, mut sum, mut squares) = (0_u32, 0.0, 0.0, 0.0);
        let mut before = None;
        for (weight, product) in values.filter(|(weight, _)| *weight > 0.0) {
            let value = product / weight;
            // Each difference is weighted like the later of its two values.
            let step = weight * (value - before.replace(value).unwrap_or(value));
            squares += step * step / 2.0;
            total += weight;
            sum += product;
            count += 1;
        }
        let steps = f64::from(count.checked_sub(1)?);
        let half_width = match count {
            1 => f64::INFINITY,
            _ => {
                // Successive differences overlap, so they have about two thirds of the degrees of freedom.
                let quantile = quantile(steps * 2.0 / 3.0);
                quantile * libm::sqrt(squares * (steps + 1.0) / steps) / total
            }
        };
        Some(SampledMean {
            mean: sum / total,
            half_width,
        })
    }

    /// Returns the Wilson interval of a share of time, which is a mean of zeros and ones. It uses the number of
    /// independent values that would give this sampling error, or `samples` if all values are equal.
    pub(crate) fn share(&self, share: f64, samples: u32) -> Interval {
        let share = share.clamp(0.0, 1.0);
        // The square of the quantile, divided by the number of independent values.
        let square = match self.half_width > 0.0 {
            true => self.half_width * self.half_width / (share * (1.0 - share)),
            false => NORMAL_QUANTILE * NORMAL_QUANTILE / f64::from(samples.max(1)),
        };
        if !square.is_finite() {
            return Interval::new(0.0, 1.0);
        }
        let middle = (share + square / 2.0) / (1.0 + square);
        let root = libm::sqrt(square * (share * (1.0 - share) + square / 4.0));
        let half = root / (1.0 + square);
        Interval::around(middle, half).within(Interval::new(0.0, 1.0))
    }
}

/// The 97.5 % quantile of Student's t: the expansion 26.7.5 of Abramowitz and Stegun.
fn quantile(degrees_of_freedom: f64) -> f64 {
    let inverse = 1.0 / degrees_of_freedom;
    NORMAL_QUANTILE + inverse * (2.372 + inverse * (2.823 + inverse * 2.556))
}

#[cfg(test)]
mod tests {
    use super::*;
    use alloc::vec::Vec;

    fn of(values: &[f64]) -> SampledMean {
        SampledMean::of(values.iter().map(|value| (1.0, *value))).unwrap()
    }

    #[test]
    fn the_quantiles_are_those_of_the_tables() {
        for (degrees_of_freedom, expected) in [(3.0, 3.182), (5.0, 2.571), (20.0, 2.086)] {
            let found = quantile(degrees_of_freedom);
            approx::assert_relative_eq!(found, expected, max_relative = 0.01);
        }
    }

    #[test]
    fn the_error_follows_from_the_differences_of_successive_values() {
        let alternating: Vec<f64> = (0..100).map(|i| f64::from(i % 2)).collect();
        // With 99 differences of 1, the standard error is sqrt(1 / 2 / 100).
        let expected = quantile(66.0) * 0.005_f64.sqrt();
        approx::assert_abs_diff_eq!(of(&alternating).half_width, expected, epsilon = 1e-12);
        let once: Vec<f64> = (0..100).map(|i| f64::from(i / 50)).collect();
        assert!(of(&once).half_width < 0.2 * expected);
        assert_eq!(of(&[1.0]).half_width, f64::INFINITY);
        assert_eq!(SampledMean::of(core::iter::empty()), None);
        assert_eq!(of(&[0.5; 40]).half_width, 0.0);
    }

    #[test]
    fn a_share_of_0_has_the_wilson_interval_of_its_samples() {
        let share = of(&[0.0; 100]).share(0.0, 100);
        // z^2 / (n + z^2) = 3.8415 / 103.8415.
        assert_eq!(share.low, 0.0);
        approx::assert_abs_diff_eq!(share.high, 0.036_995, epsilon = 1e-5);
        assert_eq!(of(&[1.0]).share(1.0, 1).high, 1.0);
    }
}
