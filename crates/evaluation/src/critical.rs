//! The attitude error of a flight over time, and its critical episodes.

use flagred::{
    monitor::Craft,
    profile::CRITICAL_ERROR_DEG,
    source::{Motors, Observer, Signal, Source, Statistic},
};
use flagred_flightlog::Attitude;

use crate::span::Span;

/// The window of the attitude error, which is a root mean square, in seconds.
const ERROR_WINDOW_S: f64 = 1.0;

/// The name of the signal that is averaged over the window.
const SQUARED_ERROR: &str = "squared_error_deg2";

/// The minimum duration of an episode, in seconds.
const SHORTEST_EPISODE_S: f64 = 1.0;

/// A tolerance for rounding errors, in seconds. Timestamps are in microseconds.
const ROUNDING_S: f64 = 1e-6;

/// The attitude error of a flight over time, and its critical episodes.
///
/// # Example: three seconds with an error of 20 degrees
///
/// ```
/// use flagred_evaluation::ErrorRecord;
/// use flagred_flightlog::Attitude;
///
/// let attitudes = (0..500).map(|i| {
///     let t_s = f64::from(i) * 0.04;
///     let roll_deg = if (10.0..13.0).contains(&t_s) { 20.0 } else { 0.0 };
///     (t_s, Attitude { roll_des_deg: 0.0, roll_deg, pitch_des_deg: 0.0, pitch_deg: 0.0 })
/// });
/// let record = ErrorRecord::new(attitudes);
/// assert_eq!(record.critical_within(4.0, 5.0), Some(false));
/// assert_eq!(record.critical_within(6.0, 5.0), Some(true));
/// assert_eq!(record.critical_within(20.0, 5.0), None);
/// let [episode] = record.episodes() else { return Err("one episode") };
/// assert!(episode.from_s > 10.0 && episode.from_s < 10.2);
/// # Ok::<(), &str>(())
/// ```
#[derive(Debug, Clone, Default)]
pub struct ErrorRecord {
    /// Times in seconds, each with the error over the preceding second in degrees.
    errors: Vec<(f64, f64)>,
    episodes: Vec<Span>,
}

impl ErrorRecord {
    /// Computes the record from the attitudes of a flight with their times in seconds, ascending. An attitude that is
    /// not finite is unknown.
    pub fn new(attitudes: impl IntoIterator<Item = (f64, Attitude)>) -> ErrorRecord {
        let mut record = ErrorRecord::default();
        let squares = Source {
            statistic: Statistic::Mean,
            motors: Motors::Pooled,
            signal: Signal::named(SQUARED_ERROR),
            window_s: ERROR_WINDOW_S,
            exponential: false,
        };
        // The craft has the signal, so creating the observer cannot fail.
        let craft = Craft::new(0).with_signals(&[SQUARED_ERROR]);
        let Ok(mut second) = Observer::new([&squares], craft) else {
            return record;
        };
        let mut excursion: Option<Span> = None;
        let mut last_s = None;
        for (t_s, attitude) in attitudes {
            let squared = attitude.squared_error_deg2();
            if !squared.is_finite() {
                continue;
            }
            let held_s = last_s.map_or(0.0, |last_s: f64| t_s - last_s);
            last_s = Some(t_s);
            if held_s > ERROR_WINDOW_S {
                second.clear();
                excursion = None;
                continue;
            }
            second.push(t_s, held_s, &[], &[squared]);
            // A window counts as full if it lacks at most half the time between two samples.
            let full_s = ERROR_WINDOW_S - held_s / 2.0 - ROUNDING_S;
            let Some(mean) = second.value(0).filter(|mean| mean.covered_s >= full_s) else {
                continue;
            };
            let error_deg = mean.value.sqrt();
            record.errors.push((t_s, error_deg));
            let is_critical = error_deg > CRITICAL_ERROR_DEG;
            let span = excursion.filter(|_| is_critical).unwrap_or(Span {
                from_s: t_s,
                to_s: t_s,
            });
            let span = Span { to_s: t_s, ..span };
            excursion = is_critical.then_some(span);
            // The first sample also applies to the time before it.
            if is_critical && span.length_s() + held_s >= SHORTEST_EPISODE_S - ROUNDING_S {
                match record.episodes.last_mut() {
                    Some(last) if last.from_s == span.from_s => *last = span,
                    _ => record.episodes.push(span),
                }
            }
        }
        record
    }

    /// The largest error within `horizon_s` seconds after `t_s`, in degrees; `None` if it is unknown.
    pub fn largest_within(&self, t_s: f64, horizon_s: f64) -> Option<f64> {
        let after = |t_s: f64| {
            self.errors
                .partition_point(|(time, _)| *time <= t_s + ROUNDING_S)
        };
        let ahead = self.errors.get(after(t_s)..after(t_s + horizon_s));
        ahead?
            .iter()
            .map(|(_, error_deg)| *error_deg)
            .reduce(f64::max)
    }

    /// Whether the error becomes critical within `horizon_s` seconds after `t_s`; `None` if that is unknown.
    pub fn critical_within(&self, t_s: f64, horizon_s: f64) -> Option<bool> {
        let largest_deg = self.largest_within(t_s, horizon_s)?;
        Some(largest_deg > CRITICAL_ERROR_DEG)
    }

    /// Whether no error in the `for_s` seconds before `t_s` is critical; unknown errors do not count.
    pub fn is_quiet(&self, t_s: f64, for_s: f64) -> bool {
        self.critical_within(t_s - for_s, for_s) != Some(true)
    }

    /// The largest error, in degrees; `None` if no error is known.
    pub fn largest_deg(&self) -> Option<f64> {
        let errors = self.errors.iter().map(|(_, error_deg)| *error_deg);
        errors.reduce(f64::max)
    }

    /// The times within a span at which the error exceeds a limit.
    pub fn times_over(&self, limit_deg: f64, span: Span) -> impl Iterator<Item = f64> + '_ {
        let errors = self.errors.iter();
        let over =
            errors.filter(move |(t_s, error_deg)| span.contains(*t_s) && *error_deg > limit_deg);
        over.map(|(t_s, _)| *t_s)
    }

    /// The critical episodes, each at least a second long.
    pub fn episodes(&self) -> &[Span] {
        &self.episodes
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A flight at `rate` Hz with an error of 8 degrees in the given times.
    fn record(rate: u32, spans: &[(f64, f64)]) -> ErrorRecord {
        ErrorRecord::new((0..=60 * rate).map(|i| {
            let t_s = f64::from(i) / f64::from(rate);
            let inside = spans.iter().any(|(from, to)| (*from..*to).contains(&t_s));
            let attitude = Attitude {
                roll_des_deg: if inside { 8.0 } else { 0.0 },
                roll_deg: 0.0,
                pitch_des_deg: 0.0,
                pitch_deg: 0.0,
            };
            (t_s, attitude)
        }))
    }

    #[test]
    fn an_episode_starts_when_the_error_of_a_second_is_over_the_limit_and_lasts_one() {
        // An error of 8 degrees during a share x of the second gives a root mean square of 8 sqrt(x), which is over 5
        // from x = 0.39 on.
        for rate in [10, 25, 100] {
            let record = record(rate, &[(10.0, 11.0), (20.0, 21.5), (40.0, 45.0)]);
            let spans: Vec<(f64, f64)> = record
                .episodes()
                .iter()
                .map(|e| (e.from_s, e.to_s))
                .collect();
            assert_eq!(spans.len(), 3, "{rate} Hz: {spans:?}");
            for ((from_s, to_s), (starts_s, ends_s)) in
                spans
                    .iter()
                    .zip([(10.39, 11.61), (20.39, 22.11), (40.39, 45.61)])
            {
                let step_s = 2.1 / f64::from(rate);
                assert!((from_s - starts_s).abs() < step_s, "{rate} Hz: {spans:?}");
                assert!((to_s - ends_s).abs() < step_s, "{rate} Hz: {spans:?}");
            }
        }
        // The root mean square exceeds the limit, but only for 0.7 s.
        assert_eq!(record(25, &[(10.0, 10.55)]).episodes(), []);
        assert_eq!(
            record(25, &[(10.0, 10.55)]).critical_within(9.0, 5.0),
            Some(true)
        );
    }

    #[test]
    fn a_horizon_reaches_from_just_after_a_time_to_its_end() {
        let record = record(25, &[(10.0, 30.0)]);
        let first_s = record.episodes()[0].from_s;
        for (t_s, critical) in [
            (first_s - 5.04, false),
            (first_s - 5.0, true),
            (first_s - 0.04, true),
            (29.0, true),
            (31.0, false),
        ] {
            assert_eq!(record.critical_within(t_s, 5.0), Some(critical), "{t_s}");
        }
    }

    #[test]
    fn a_flight_is_quiet_until_the_error_is_critical_and_again_some_time_after() {
        let record = record(25, &[(10.0, 30.0)]);
        let episode = record.episodes()[0];
        for (t_s, is_quiet) in [
            (5.0, true),
            (episode.from_s - 0.04, true),
            (episode.from_s, false),
            (20.0, false),
            (episode.to_s + 4.9, false),
            (episode.to_s + 5.0, true),
        ] {
            assert_eq!(record.is_quiet(t_s, 5.0), is_quiet, "{t_s}");
        }
        assert_eq!(record.largest_deg(), Some(8.0));
        let first_over = |limit_deg| record.times_over(limit_deg, episode).next();
        assert_eq!(first_over(5.0), Some(episode.from_s));
        assert_eq!(first_over(8.5), None);
    }

    #[test]
    fn nothing_is_known_across_a_gap() {
        let level = Attitude {
            roll_des_deg: 0.0,
            roll_deg: 0.0,
            pitch_des_deg: 0.0,
            pitch_deg: 0.0,
        };
        let lost = Attitude {
            roll_deg: f64::NAN,
            ..level
        };
        let record = ErrorRecord::new((0..1000).map(|i| {
            let t_s = f64::from(i) * 0.04;
            let known = !(10.0..20.0).contains(&t_s);
            (t_s, if known { level } else { lost })
        }));
        assert_eq!(record.critical_within(11.0, 5.0), None);
        // The mean over a second is known only if the attitude is known throughout that second.
        assert_eq!(record.critical_within(19.5, 1.0), None);
        assert_eq!(record.critical_within(19.5, 2.0), Some(false));
    }
}
