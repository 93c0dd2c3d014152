//! Statistics of weighted values that can be merged without subtracting sums.

/// Mean, standard deviation and extremes of weighted values.
///
/// Two sets are merged without subtracting sums (Chan, Golub and LeVeque 1983), so there is no cancellation and no
/// drift.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Moments {
    weight: f64,
    mean: f64,
    /// `sum(weight (value - mean)^2)`.
    squares: f64,
    /// `sum(weight (value - previous value)^2)`, where the previous value is known.
    steps: f64,
    min: f64,
    max: f64,
}

impl Moments {
    /// The moments of no values.
    pub(crate) const EMPTY: Moments = Moments {
        weight: 0.0,
        mean: 0.0,
        squares: 0.0,
        steps: 0.0,
        min: f64::INFINITY,
        max: f64::NEG_INFINITY,
    };

    /// All-zero memory for moments.
    pub(crate) const IDLE: Moments = Moments {
        min: 0.0,
        max: 0.0,
        ..Moments::EMPTY
    };

    /// The moments of one finite value with a weight above 0.
    pub(crate) fn of(value: f64, weight: f64) -> Moments {
        Moments {
            weight,
            mean: value,
            squares: 0.0,
            steps: 0.0,
            min: value,
            max: value,
        }
    }

    /// The moments of one finite value that follows another.
    pub(crate) fn after(previous: f64, value: f64, weight: f64) -> Moments {
        Moments {
            steps: weight * (value - previous) * (value - previous),
            ..Moments::of(value, weight)
        }
    }

    /// The moments of a finite value that moves linearly from `from` to `to`, with a weight above 0.
    pub(crate) fn between(from: f64, to: f64, weight: f64) -> Moments {
        Moments {
            weight,
            mean: (from + to) / 2.0,
            squares: weight * (to - from) * (to - from) / 12.0,
            steps: 0.0,
            min: from.min(to),
            max: from.max(to),
        }
    }

    /// The moments of the values that `counted` returns, each with weight 1; [`EMPTY`](Self::EMPTY)
    /// if one of them is not finite.
    pub(crate) fn alike(
        values: impl Iterator<Item = f64> + Clone,
        counted: impl Fn(f64) -> f64,
    ) -> Moments {
        let mut all = Moments::EMPTY;
        // The values are taken relative to the first one, so that the mean of equal values is exact and their standard
        // deviation is 0.
        let Some(first) = values.clone().next().map(&counted) else {
            return all;
        };
        let mut count = 0_u32;
        for value in values.clone() {
            if !value.is_finite() {
                return Moments::EMPTY;
            }
            let value = counted(value);
            count += 1;
            all.mean += value - first;
            // The numbers are finite; `f64::min` would also test for NaN.
            all.min = if value < all.min { value } else { all.min };
            all.max = if value > all.max { value } else { all.max };
        }
        all.weight = f64::from(count);
        all.mean = first + all.mean / all.weight;
        for value in values.map(counted) {
            all.squares += (value - all.mean) * (value - all.mean);
        }
        all
    }

    /// Adds the values of `other`.
    pub(crate) fn merge(&mut self, other: &Moments) {
        if other.weight <= 0.0 {
            return;
        }
        if self.weight <= 0.0 {
            *self = *other;
            return;
        }
        let weight = self.weight + other.weight;
        let share = other.weight / weight;
        let step = other.mean - self.mean;
        self.mean += step * share;
        self.squares += other.squares + step * step * self.weight * share;
        self.steps += other.steps;
        self.weight = weight;
        self.min = self.min.min(other.min);
        self.max = self.max.max(other.max);
    }

    /// The same values with their weights multiplied by `factor`.
    #[must_use]
    pub(crate) fn scaled(&self, factor: f64) -> Moments {
        Moments {
            weight: self.weight * factor,
            squares: self.squares * factor,
            steps: self.steps * factor,
            ..*self
        }
    }

    /// The sum of the weights; in a [`Window`], seconds.
    pub(crate) fn weight(&self) -> f64 {
        self.weight
    }

    /// `sum(weight value)`.
    #[cfg(feature = "std")]
    pub(crate) fn sum(&self) -> f64 {
        self.weight * self.mean
    }

    /// `sum(weight (value - origin)^2)`.
    #[cfg(feature = "std")]
    pub(crate) fn squares_about(&self, origin: f64) -> f64 {
        let step = self.mean - origin;
        self.squares + self.weight * step * step
    }

    /// `sum(weight (value - previous value)^2)`, where the previous value is known.
    #[cfg(feature = "std")]
    pub(crate) fn steps(&self) -> f64 {
        self.steps
    }

    /// The weighted mean; `None` without a value.
    pub(crate) fn mean(&self) -> Option<f64> {
        self.known(self.mean)
    }

    /// The weighted standard deviation of the population; `None` without a value.
    pub(crate) fn std(&self) -> Option<f64> {
        self.known(libm::sqrt(self.squares / self.weight))
    }

    /// The standard deviation of white noise that has the same steps between values, `sqrt(mean((value - previous
    /// value)^2) / 2)`; `None` without a value.
    pub(crate) fn noise(&self) -> Option<f64> {
        self.known(libm::sqrt(self.steps / self.weight / 2.0))
    }

    /// The standard deviation without the [`noise`](Self::noise), `sqrt(max(0, std^2 - noise^2))`, which measures the
    /// part of the variance that successive values share. `None` without a value.
    pub(crate) fn std_less_noise(&self) -> Option<f64> {
        let variance = (self.squares - self.steps / 2.0) / self.weight;
        self.known(libm::sqrt(variance.max(0.0)))
    }

    /// The weighted root mean square; `None` without a value.
    pub(crate) fn rms(&self) -> Option<f64> {
        self.known(libm::sqrt(
            self.squares / self.weight + self.mean * self.mean,
        ))
    }

    /// The smallest value; `None` without a value.
    pub(crate) fn min(&self) -> Option<f64> {
        self.known(self.min)
    }

    /// The largest value; `None` without a value.
    pub(crate) fn max(&self) -> Option<f64> {
        self.known(self.max)
    }

    fn known(&self, statistic: f64) -> Option<f64> {
        (self.weight > 0.0).then_some(statistic)
    }
}

state! { struct Moments { weight, mean, squares, steps, min, max } }

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn a_quarter_of_the_time_at_full_power_is_a_quarter_of_the_weight() {
        let mut command = Moments::of(0.5, 3.0);
        command.merge(&Moments::of(1.0, 1.0));
        assert_eq!(command.mean(), Some(0.625));
        assert_eq!(command.std(), Some(0.046875_f64.sqrt()));
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(64))]

        #[test]
        fn equal_values_merge_like_single_ones(values in prop::collection::vec(-1.0..1.0f64, 0..20)) {
            let mut merged = Moments::EMPTY;
            for value in &values {
                merged.merge(&Moments::of(*value, 1.0));
            }
            let alike = Moments::alike(values.iter().copied(), |value| value);
            prop_assert_eq!((alike.weight(), alike.min(), alike.max()), (merged.weight(), merged.min(), merged.max()));
            prop_assert!((alike.mean().unwrap_or(9.0) - merged.mean().unwrap_or(9.0)).abs() < 1e-14);
            prop_assert!((alike.std().unwrap_or(9.0) - merged.std().unwrap_or(9.0)).abs() < 1e-14);
        }

        #[test]
        fn equal_values_have_no_spread(value in -1.0..1.0f64, count in 1usize..20) {
            let alike = Moments::alike(core::iter::repeat_n(value, count), |value| value);
            prop_assert_eq!((alike.mean(), alike.std()), (Some(value), Some(0.0)));
        }

        #[test]
        fn merged_moments_are_those_of_all_values(a in prop::collection::vec((-5.0..5.0f64, 0.1..2.0f64), 1..20), cut in 0usize..20) {
            let pooled = a.iter().fold(Moments::EMPTY, |mut m, (x, w)| { m.merge(&Moments::of(*x, *w)); m });
            let cut = cut.min(a.len());
            let (mut left, mut right) = (Moments::EMPTY, Moments::EMPTY);
            for (x, w) in &a[..cut] { left.merge(&Moments::of(*x, *w)); }
            for (x, w) in &a[cut..] { right.merge(&Moments::of(*x, *w)); }
            left.merge(&right);
            prop_assert!((left.mean().unwrap() - pooled.mean().unwrap()).abs() < 1e-12);
            prop_assert!((left.std().unwrap() - pooled.std().unwrap()).abs() < 1e-9);
            prop_assert!((left.rms().unwrap().powi(2) - left.mean().unwrap().powi(2) - left.std().unwrap().powi(2)).abs() < 1e-9);
        }
    }
}
