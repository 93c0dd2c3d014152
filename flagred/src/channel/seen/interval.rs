//! The uncertainty of the statistic of an input, from the samples that its window contains.

use fuzzy::engine::Interval;

use super::{Channel, ChannelState, Input, Statistic, value};
use crate::{moments::Moments, sampling_error::SampledMean};

/// The two-sided 95 % interval of the statistic of an input, for a signal whose mean and variability do not change
/// within the window; docs/profiles.md defines it. `None` if no value is known, and for an exponential window, which
/// does not keep its values.
pub(crate) fn interval(
    (channels, inputs): (&[Channel], &[Input]),
    seen: &[ChannelState],
    input: usize,
) -> Option<Interval> {
    let known = value((channels, inputs), seen, input)?;
    let Input {
        channel, statistic, ..
    } = *inputs.get(input)?;
    let ChannelState { window, bin, .. } = seen.get(channel)?;
    if channels.get(channel)?.exponential {
        return None;
    }
    let latest = statistic.uses_bins().then(|| (0.0, bin.moments()));
    let parts = window.parts().chain(latest);
    // Returns the mean of a quantity over the window. For each part of the window, `sum` returns the quantity times the
    // weight of the part.
    let mean = |sum: &dyn Fn(f64, &Moments) -> f64| {
        let parts = parts.clone();
        SampledMean::of(parts.map(|(t_s, part)| (part.weight(), sum(t_s, &part))))
    };
    let of_mean = || mean(&|_, part| part.sum());
    let root = |square: SampledMean| {
        let end = |square: f64| libm::sqrt(square.max(0.0));
        let half = square.half_width;
        Interval::new(end(square.mean - half), end(square.mean + half))
    };
    let around = |half: f64| Interval::around(known.value, half);
    let found = match statistic {
        Statistic::Min | Statistic::Max | Statistic::Last => around(0.0),
        Statistic::Mean => around(of_mean()?.half_width),
        Statistic::ShareBelow(_) | Statistic::ShareAbove(_) => {
            of_mean()?.share(known.value, window.samples())
        }
        Statistic::Std => {
            let about = of_mean()?.mean;
            root(mean(&|_, part| part.squares_about(about))?)
        }
        Statistic::Rms => root(mean(&|_, part| part.squares_about(0.0))?),
        Statistic::Noise => root(mean(&|_, part| part.steps() / 2.0)?),
        Statistic::StdLessNoise => {
            let about = of_mean()?.mean;
            root(mean(&|_, part| {
                part.squares_about(about) - part.steps() / 2.0
            })?)
        }
        Statistic::Rate => {
            // The half width follows from the influence of each part on the slope.
            let middle_s = mean(&|t_s, part| part.weight() * t_s)?.mean;
            let level = of_mean()?.mean;
            let squares = mean(&|t_s, part| part.weight() * (t_s - middle_s).powi(2))?.mean;
            let influence = mean(&|t_s, part| {
                let later_s = t_s - middle_s;
                let rest = part.sum() - part.weight() * (level + known.value * later_s);
                rest * later_s / squares
            })?;
            around(influence.half_width)
        }
        Statistic::Percentile(percent) => {
            // The method of Woodruff (1952): the ends of an interval for the share of values below the
            // percentile are two percentages. The percentiles at these two percentages are the ends of the
            // result.
            let below = mean(&|_, part| match part.mean() {
                Some(value) if value < known.value => part.weight(),
                _ => 0.0,
            })?;
            let count = parts.clone().count() as u32;
            let share = below.share(percent / 100.0, count);
            let at = |share: f64| window.percentile(100.0 * share);
            Interval::new(at(share.low)?, at(share.high)?)
        }
    };
    Some(found.hull(Interval::from(known.value)))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{
        monitor::Craft,
        source::{Motors, Observer, Signal, Source},
    };

    /// Pseudo-random numbers of a normal distribution with mean 0 and variance 1.
    fn normal(seed: u64) -> impl FnMut() -> f64 {
        let mut state = seed;
        let mut uniform = move || {
            state = state
                .wrapping_mul(6_364_136_223_846_793_005)
                .wrapping_add(1_442_695_040_888_963_407);
            ((state >> 11) as f64 + 0.5) / (1_u64 << 53) as f64
        };
        move || {
            let (radius, angle) = (uniform(), uniform());
            libm::sqrt(-2.0 * libm::log(radius)) * libm::cos(core::f64::consts::TAU * angle)
        }
    }

    /// The interval of a statistic of the last `window_s` seconds of a signal at 50 Hz.
    fn of(statistic: Statistic, window_s: f64, mut signal: impl FnMut() -> f64) -> Interval {
        let source = Source {
            statistic,
            motors: Motors::Pooled,
            signal: Signal::named("wind_m_s"),
            window_s,
            exponential: false,
        };
        let craft = Craft::new(0).with_signals(&["wind_m_s"]);
        let mut observer = Observer::new([&source], craft).unwrap();
        for i in 1..=(window_s * 50.0) as u32 {
            observer.push(f64::from(i) * 0.02, 0.02, &[], &[signal()]);
        }
        observer.interval(0).unwrap()
    }

    /// The share of 1,000 windows whose interval contains the true value, and the mean width.
    fn coverage(
        statistic: Statistic,
        window_s: f64,
        truth: f64,
        signal: impl Fn(&mut dyn FnMut() -> f64, &mut f64) -> f64,
    ) -> (f64, f64) {
        let (mut inside, mut width) = (0, 0.0);
        for seed in 1..=1000 {
            let mut random = normal(seed * 7919);
            let mut state = random();
            let found = of(statistic, window_s, || signal(&mut random, &mut state));
            inside += i32::from(found.contains(truth));
            width += found.width() / 1000.0;
        }
        (f64::from(inside) / 1000.0, width)
    }

    #[test]
    fn intervals_of_independent_samples_contain_the_truth_in_95_percent_of_all_windows() {
        let independent = |random: &mut dyn FnMut() -> f64, _: &mut f64| 3.0 + random();
        let root = 10.0_f64.sqrt();
        let half = 0.158_655;
        let rows = [
            (Statistic::Mean, 3.0, 0.93..0.97),
            (Statistic::Std, 1.0, 0.90..0.97),
            (Statistic::Rms, root, 0.92..0.97),
            (Statistic::ShareBelow(2.0), half, 0.94..0.99),
            (Statistic::ShareAbove(4.0), half, 0.94..0.99),
            (Statistic::Percentile(50.0), 3.0, 0.94..0.99),
            (Statistic::Rate, 0.0, 0.93..0.97),
        ];
        for (statistic, truth, expected) in rows {
            let (share, width) = coverage(statistic, 2.0, truth, independent);
            assert!(expected.contains(&share), "{statistic:?}: {share}");
            // Four times as many samples halve the width. For the rate, they also cover four times the time, which
            // divides the width by four again.
            let (_, longer) = coverage(statistic, 8.0, truth, independent);
            let ratio = match statistic {
                Statistic::Rate => 8.0,
                _ => 2.0,
            };
            assert!(
                (0.8..1.25).contains(&(width / longer / ratio)),
                "{statistic:?}: {width} {longer}"
            );
        }
    }

    /// Samples at 50 Hz of a signal with a time constant of 0.2 s, whose mean is computed over all milliseconds. Such
    /// samples determine this mean more precisely than the same number of independent samples.
    #[test]
    fn the_mean_over_all_times_is_in_the_interval_of_the_samples() {
        let (mut inside, mut width, mut independent) = (0, 0.0, 0.0);
        for seed in 1..=1000 {
            let mut random = normal(seed * 7919);
            let (keep, mut value, mut sum) = (libm::exp(-0.005), random(), 0.0);
            let found = of(Statistic::Mean, 2.0, || {
                for _ in 0..20 {
                    value = keep * value + libm::sqrt(1.0 - keep * keep) * random();
                    sum += value / 2000.0;
                }
                value
            });
            inside += i32::from(found.contains(sum));
            width += found.width();
            independent += of(Statistic::Mean, 2.0, &mut random).width();
        }
        assert!(inside > 950, "{inside}");
        assert!(width < 0.4 * independent, "{width} {independent}");
    }

    #[test]
    fn statistics_that_are_not_means_have_no_uncertainty() {
        let mut random = normal(5);
        for statistic in [Statistic::Min, Statistic::Max, Statistic::Last] {
            assert_eq!(of(statistic, 2.0, &mut random).width(), 0.0);
        }
        assert_eq!(of(Statistic::Mean, 2.0, || 0.25), Interval::from(0.25));
        assert_eq!(of(Statistic::Std, 2.0, || 0.25), Interval::from(0.0));
    }
}
