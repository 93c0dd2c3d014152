//! Matches warnings with episodes: which episodes they announce, how early, and which warnings are false.

use crate::span::Span;

/// A warning is not false if an episode starts within this time after its end, in seconds.
const FOLLOWS_S: f64 = 10.0;

/// A warning is not false if it begins within this time after an episode, in seconds.
const ECHO_S: f64 = 1.0;

/// A tolerance in seconds; timestamps are in microseconds.
const ROUNDING_S: f64 = 1e-6;

/// An episode and its warning.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct EpisodeMatch {
    /// The episode.
    pub episode: Span,
    /// The start, in seconds, of the warning that was on when the episode began, or else of the first warning that
    /// began during the episode. `None` if there is neither.
    pub warned_s: Option<f64>,
}

impl EpisodeMatch {
    /// Whether a warning began before the episode and was still on when the episode started.
    pub fn is_announced(&self) -> bool {
        self.lead_s().is_some_and(|lead_s| lead_s > 0.0)
    }

    /// The lead time: the time from the start of the warning to the start of the episode, in
    /// seconds; negative if the warning began during the episode.
    pub fn lead_s(&self) -> Option<f64> {
        self.warned_s.map(|warned_s| self.episode.from_s - warned_s)
    }
}

/// A period during which a profile warned.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Warning {
    /// The period of the warning, limited to the judged times.
    pub span: Span,
    /// Whether the warning is false; see [`match_warnings`].
    pub is_false: bool,
}

/// The matched episodes and warnings of a flight.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct WarningMatches {
    /// The episodes that start within the judged times.
    pub episodes: Vec<EpisodeMatch>,
    /// The warnings within the judged times.
    pub warnings: Vec<Warning>,
}

/// Matches the warnings of a flight with its episodes, within the judged time of the flight.
///
/// A warning is not false if an episode starts during the warning or within 10 s after its end, or if the warning
/// begins during an episode or within 1 s after one. `lost_s` is the time at which the log ended in the air. The
/// rest of the flight is unknown, so a warning that is on at that time, or ended up to 10 s before, is not false.
///
/// # Example: a false warning, and one four seconds ahead
/// ```
/// use flagred_evaluation::{Span, match_warnings};
///
/// let span = |from_s, to_s| Span { from_s, to_s };
/// let (warnings, episodes) = ([span(5.0, 8.0), span(26.0, 40.0)], [span(30.0, 33.0)]);
/// let judged = match_warnings(&warnings, &episodes, &[span(0.0, 60.0)], None);
/// let is_false: Vec<bool> = judged.warnings.iter().map(|warning| warning.is_false).collect();
/// assert_eq!(is_false, [true, false]);
/// ```
pub fn match_warnings(
    warnings: &[Span],
    episodes: &[Span],
    judged: &[Span],
    lost_s: Option<f64>,
) -> WarningMatches {
    let mut found = WarningMatches::default();
    for time in judged {
        let inside: Vec<Span> = warnings
            .iter()
            .map(|warning| Span {
                from_s: warning.from_s.max(time.from_s),
                to_s: warning.to_s.min(time.to_s),
            })
            .filter(|warning| warning.from_s <= warning.to_s)
            .collect();
        let starting = episodes.iter().filter(|e| time.contains(e.from_s));
        found.episodes.extend(starting.map(|episode| {
            let on = inside.iter().find(|warning| {
                warning.to_s >= episode.from_s - ROUNDING_S && warning.from_s <= episode.to_s
            });
            EpisodeMatch {
                episode: *episode,
                warned_s: on.map(|warning| warning.from_s),
            }
        }));
        found.warnings.extend(inside.into_iter().map(|span| {
            let until_s = span.to_s + FOLLOWS_S;
            let meant = episodes.iter().any(|episode| {
                (span.from_s - ROUNDING_S..=until_s).contains(&episode.from_s)
                    || (episode.from_s..=episode.to_s + ECHO_S).contains(&span.from_s)
            });
            Warning {
                span,
                is_false: !meant && lost_s.is_none_or(|lost_s| lost_s > until_s),
            }
        }));
    }
    found
}

#[cfg(test)]
mod tests {
    use super::*;

    fn spans(ends: &[(f64, f64)]) -> Vec<Span> {
        ends.iter()
            .map(|(from_s, to_s)| Span {
                from_s: *from_s,
                to_s: *to_s,
            })
            .collect()
    }

    fn run(
        warnings: &[(f64, f64)],
        episodes: &[(f64, f64)],
        lost_s: Option<f64>,
    ) -> WarningMatches {
        let judged = spans(&[(10.0, 100.0)]);
        match_warnings(&spans(warnings), &spans(episodes), &judged, lost_s)
    }

    #[test]
    fn an_episode_is_announced_by_a_warning_that_is_on_when_it_starts() {
        let table = [
            ((40.0, 60.0), Some(10.0), true),
            ((50.0, 60.0), Some(0.0), false),
            ((51.0, 60.0), Some(-1.0), false),
            // These warnings end before the episode, or begin after it.
            ((40.0, 49.0), None, false),
            ((56.0, 60.0), None, false),
            // Only the judged time counts.
            ((1.0, 60.0), Some(40.0), true),
        ];
        for (warning, lead_s, announced) in table {
            let found = run(&[warning], &[(50.0, 55.0)], None);
            assert_eq!(found.episodes.len(), 1);
            assert_eq!(found.episodes[0].lead_s(), lead_s, "{warning:?}");
            assert_eq!(found.episodes[0].is_announced(), announced, "{warning:?}");
        }
        assert_eq!(run(&[(40.0, 60.0)], &[(5.0, 55.0)], None).episodes, []);
    }

    #[test]
    fn a_warning_without_a_later_episode_is_false() {
        let table = [
            ((40.0, 45.0), false),
            ((40.0, 39.9), true),
            ((30.0, 39.0), true),
            ((30.0, 40.0), false),
            ((52.0, 58.0), false),
            ((56.0, 58.0), false),
            ((56.5, 58.0), true),
            ((1.0, 9.0), true),
        ];
        for ((from_s, to_s), is_false) in table {
            let found = run(&[(from_s, to_s)], &[(50.0, 55.0)], None);
            if to_s < from_s || to_s < 10.0 {
                assert_eq!(found.warnings, []);
            } else {
                assert_eq!(found.warnings[0].is_false, is_false, "{from_s} to {to_s}");
            }
        }
    }

    #[test]
    fn a_flight_that_ends_in_the_air_does_not_make_a_warning_false() {
        assert!(!run(&[(80.0, 95.0)], &[], Some(101.0)).warnings[0].is_false);
        assert!(run(&[(60.0, 85.0)], &[], Some(101.0)).warnings[0].is_false);
    }
}
