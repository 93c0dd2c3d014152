//! Computes 95 % intervals of figures over many flights, by resampling whole flights.

use crate::random::Random;

/// The ends of a 95 % interval.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Interval {
    /// The lower end: 2.5 % of the resamples are below.
    pub low: f64,
    /// The upper end: 2.5 % of the resamples are above.
    pub high: f64,
}

/// Returns the intervals of `N` figures over `groups` groups, such as flights. Each resample draws `groups` groups with
/// replacement; `figures` receives the number of times each group was drawn.
///
/// The same seed gives the same intervals. Resamples for which `figures` returns `None` are ignored; `None` if no
/// resample is left.
///
/// # Example: alarms an hour, over three flights of half an hour
/// ```
/// use flagred_evaluation::bootstrap;
///
/// let alarms = [0, 1, 5];
/// let intervals = bootstrap(alarms.len(), 1000, 1, |drawn| {
///     let sum: u32 = alarms.iter().zip(drawn).map(|(alarms, times)| alarms * times).sum();
///     Some([f64::from(sum) / 1.5])
/// });
/// let [per_hour] = intervals.ok_or("no flight")?;
/// assert!(per_hour.low < 4.0 && per_hour.high > 4.0);
/// # Ok::<(), &str>(())
/// ```
pub fn bootstrap<const N: usize>(
    groups: usize,
    resamples: usize,
    seed: u64,
    mut figures: impl FnMut(&[u32]) -> Option<[f64; N]>,
) -> Option<[Interval; N]> {
    let mut random = Random::new(seed);
    let mut drawn = vec![0_u32; groups];
    let mut found: [Vec<f64>; N] = std::array::from_fn(|_| Vec::with_capacity(resamples));
    for _ in 0..resamples {
        drawn.fill(0);
        for _ in 0..groups {
            drawn[random.below(groups)] += 1;
        }
        for (values, value) in found.iter_mut().zip(figures(&drawn).into_iter().flatten()) {
            values.push(value);
        }
    }
    let none = Interval {
        low: f64::NAN,
        high: f64::NAN,
    };
    let mut intervals = [none; N];
    for (interval, values) in intervals.iter_mut().zip(&mut found) {
        *interval = quantiles(values)?;
    }
    Some(intervals)
}

/// The 2.5 % and 97.5 % quantiles, interpolated linearly between values.
fn quantiles(values: &mut [f64]) -> Option<Interval> {
    values.sort_by(f64::total_cmp);
    let quantile = |share: f64| {
        let rank = share * (values.len().checked_sub(1)?) as f64;
        let (below, part) = (rank as usize, rank - rank.floor());
        let low = *values.get(below)?;
        let high = values.get(below + 1).copied().unwrap_or(low);
        Some(low + part * (high - low))
    };
    Some(Interval {
        low: quantile(0.025)?,
        high: quantile(0.975)?,
    })
}
