//! The standard error of a mean of values that follow each other in time, by batch means.
//!
//! Values that follow each other are alike, so their mean is less certain than that of as many independent values. The
//! method of batch means (B. Schmeiser, "Batch Size Effects in the Analysis of Simulation Output", Operations Research
//! 30, 1982) needs no model of that: the values are divided into a few batches of successive values, and the means of
//! the batches count as independent.

use alloc::vec::Vec;

use fuzzy::engine::Interval;

/// The maximum number of batches. Schmeiser recommends 10 to 30 for long series. The windows of profiles are short, and
/// longer batches are less alike: of means over 2 s of a signal with a time constant of 0.2 s, five batches contain
/// the true mean in 90 % of all windows, ten in 78 %. For independent values, five make the interval 19 % wider.
const MOST_BATCHES: usize = 5;

/// The 97.5 % quantiles of Student's t for 1, 2, ... degrees of freedom.
const QUANTILES: [f64; MOST_BATCHES - 1] = [12.706, 4.303, 3.182, 2.776];

/// The 97.5 % quantile of the normal distribution.
const NORMAL_QUANTILE: f64 = 1.960;

/// A mean with its uncertainty.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct BatchMean {
    pub(crate) mean: f64,
    /// The standard error; infinite if there is only one value.
    error: f64,
    /// Half of a two-sided interval of 95 % has this many standard errors.
    quantile: f64,
}

impl BatchMean {
    /// The mean of values in order of time, each as its weight and the product of weight and value; `None` without any.
    pub(crate) fn of(values: impl Iterator<Item = (f64, f64)>) -> Option<BatchMean> {
        let values: Vec<(f64, f64)> = values.filter(|(weight, _)| *weight > 0.0).collect();
        let sum = |values: &[(f64, f64)]| {
            let add = |a: (f64, f64), b: &(f64, f64)| (a.0 + b.0, a.1 + b.1);
            values.iter().fold((0.0, 0.0), add)
        };
        let (total, weighted) = sum(&values);
        let mean = weighted / total;
        let length = values.len().div_ceil(MOST_BATCHES);
        if length == 0 {
            return None;
        }
        let batches = values.chunks(length);
        let count = batches.len();
        let squares = batches.map(|batch| {
            let (weight, weighted) = sum(batch);
            let step = (weighted - weight * mean) / total;
            step * step
        });
        let squares: f64 = squares.sum();
        let (error, quantile) = match count.checked_sub(2).and_then(|i| QUANTILES.get(i)) {
            Some(quantile) => {
                let count = count as f64;
                (libm::sqrt(squares * count / (count - 1.0)), *quantile)
            }
            None => (f64::INFINITY, NORMAL_QUANTILE),
        };
        Some(BatchMean {
            mean,
            error,
            quantile,
        })
    }

    /// Half of the interval of the mean.
    pub(crate) fn half_width(&self) -> f64 {
        self.quantile * self.error
    }

    /// The Wilson interval of a share of time, the mean of zeros and ones, with the standard error of the batches, but at
    /// least that of as many independent samples.
    pub(crate) fn share(&self, share: f64, samples: u32) -> Interval {
        let share = share.clamp(0.0, 1.0);
        let half = self.half_width();
        // The square of the quantile, divided by the number of independent values.
        let of_samples = NORMAL_QUANTILE * NORMAL_QUANTILE / f64::from(samples.max(1));
        let square = match half > 0.0 {
            true => of_samples.max(half * half / (share * (1.0 - share))),
            false => of_samples,
        };
        if !square.is_finite() {
            return Interval::new(0.0, 1.0);
        }
        let middle = (share + square / 2.0) / (1.0 + square);
        let root = libm::sqrt(square * (share * (1.0 - share) + square / 4.0));
        let half = root / (1.0 + square);
        Interval::new((middle - half).max(0.0), (middle + half).min(1.0))
    }
}

/// Half of the interval of 95 % of the slope of the least-squares line through values at times, each with a weight: the
/// textbook's, with the means of batches in place of the values. Infinite if there are fewer than three batches.
pub(crate) fn slope_half_width(values: &[(f64, f64, f64)]) -> f64 {
    let length = values.len().div_ceil(MOST_BATCHES).max(1);
    let mean = |values: &[(f64, f64, f64)]| {
        let add = |a: (f64, f64, f64), (w, t_s, x): &(f64, f64, f64)| {
            (a.0 + w, a.1 + w * t_s, a.2 + w * x)
        };
        let (weight, t_s, x) = values.iter().fold((0.0, 0.0, 0.0), add);
        (weight, t_s / weight, x / weight)
    };
    let batches: Vec<(f64, f64, f64)> = values.chunks(length).map(mean).collect();
    let (weight, middle_s, level) = mean(&batches);
    let sum = |of: &dyn Fn(f64, f64) -> f64| {
        let sum = batches
            .iter()
            .map(|(w, t_s, x)| w * of(t_s - middle_s, x - level));
        sum.sum::<f64>() / weight
    };
    let squares = sum(&|t_s, _| t_s * t_s);
    let slope = sum(&|t_s, x| t_s * x) / squares;
    let rest = sum(&|t_s, x| (x - slope * t_s) * (x - slope * t_s));
    match batches.len().checked_sub(3).and_then(|i| QUANTILES.get(i)) {
        Some(quantile) => quantile * libm::sqrt(rest / squares / (batches.len() - 2) as f64),
        None => f64::INFINITY,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn of(values: &[f64]) -> BatchMean {
        BatchMean::of(values.iter().map(|value| (1.0, *value))).unwrap()
    }

    #[test]
    fn few_values_have_the_textbook_interval() {
        let five = of(&[1.0, 2.0, 3.0, 4.0, 5.0]);
        assert_eq!(five.mean, 3.0);
        // t(4) s / sqrt(n) = 2.776 * 1.5811 / 2.2361.
        approx::assert_abs_diff_eq!(five.half_width(), 1.963, epsilon = 1e-3);
        assert_eq!(of(&[1.0]).half_width(), f64::INFINITY);
        assert_eq!(BatchMean::of(core::iter::empty()), None);
        assert_eq!(of(&[0.5; 40]).half_width(), 0.0);
    }

    #[test]
    fn values_that_stay_for_a_while_are_less_certain() {
        let alternating: Vec<f64> = (0..100).map(|i| f64::from(i % 2)).collect();
        let slow: Vec<f64> = (0..100).map(|i| f64::from(i / 20 % 2)).collect();
        assert!(of(&slow).half_width() > 5.0 * of(&alternating).half_width());
    }

    #[test]
    fn a_share_of_0_has_the_wilson_interval_of_its_samples() {
        let share = of(&[0.0; 100]).share(0.0, 100);
        // z^2 / (n + z^2) = 3.8416 / 103.8416.
        assert_eq!(share.low, 0.0);
        approx::assert_abs_diff_eq!(share.high, 0.036_995, epsilon = 1e-5);
        assert_eq!(of(&[1.0]).share(1.0, 1).high, 1.0);
    }
}
