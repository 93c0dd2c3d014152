//! Time intervals, such as the times in the air.

/// A time interval on the log's clock.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Interval {
    /// The start in seconds.
    pub start_s: f64,
    /// The end in seconds; the last time of the log if the interval was still open.
    pub end_s: f64,
    /// Whether the interval was still open at the end of the log.
    pub ends_with_log: bool,
}

impl Interval {
    /// The length in seconds.
    pub fn duration_s(&self) -> f64 {
        self.end_s - self.start_s
    }

    fn contains(&self, t_s: f64) -> bool {
        t_s >= self.start_s && (t_s < self.end_s || self.ends_with_log)
    }
}

/// Intervals in order of time, and the rule that determined them.
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[cfg_attr(
    feature = "schema",
    schemars(with = "crate::serialize::IntervalsFields<'_>")
)]
pub struct Intervals {
    /// The intervals, in order of time, without overlap.
    pub spans: Vec<Interval>,
    /// The rule that determined the intervals, such as `EV 28 (not landed) to EV 18 (land
    /// complete)`.
    pub rule: String,
    /// Whether the intervals are derived or assumed because the log contains no reports of the
    /// autopilot.
    pub is_assumed: bool,
}

impl Intervals {
    /// Whether `t_s` is in one of the intervals. The start of an interval is included; the end is included only if the
    /// log ends there.
    ///
    /// # Example
    /// ```
    /// use flagred_flightlog::{Interval, Intervals};
    ///
    /// let flown = Interval { start_s: 10.0, end_s: 60.0, ends_with_log: true };
    /// let in_air = Intervals { spans: vec![flown], rule: "an example".into(), is_assumed: false };
    /// assert!(!in_air.contains(9.0) && in_air.contains(10.0));
    /// assert!(in_air.contains(60.0), "the log ended in the air");
    /// ```
    pub fn contains(&self, t_s: f64) -> bool {
        let after = self.spans.partition_point(|span| span.start_s <= t_s);
        after
            .checked_sub(1)
            .and_then(|i| self.spans.get(i))
            .is_some_and(|span| span.contains(t_s))
    }

    /// The times that are inside one of the intervals, ends excluded.
    pub(crate) fn within(&self, times_s: &[f64]) -> Vec<f64> {
        let is_within = |t_s: f64| {
            self.spans
                .iter()
                .any(|span| span.start_s < t_s && t_s < span.end_s)
        };
        times_s
            .iter()
            .copied()
            .filter(|t_s| is_within(*t_s))
            .collect()
    }

    /// The sum of the lengths of all intervals, in seconds.
    pub fn duration_s(&self) -> f64 {
        self.spans.iter().map(Interval::duration_s).sum()
    }

    /// Joins intervals that are less than `gap_s` apart.
    pub(crate) fn joined(mut self, gap_s: f64) -> Self {
        self.spans.dedup_by(|next, kept| {
            let is_near = next.start_s - kept.end_s < gap_s;
            if is_near {
                kept.end_s = next.end_s;
                kept.ends_with_log = next.ends_with_log;
            }
            is_near
        });
        self
    }

    /// Intervals from a state that is reported repeatedly; the first value also applies to the time before it.
    pub(crate) fn from_states(
        states: &[(f64, bool)],
        (first_s, last_s): (f64, f64),
        rule: &str,
    ) -> Self {
        let before = states.first().is_some_and(|(_, state)| *state);
        let within: Vec<(f64, bool)> = states
            .iter()
            .map(|&(t_s, state)| (t_s.max(first_s), state))
            .collect();
        Self::from_changes(&within, before, first_s, last_s, rule)
    }

    /// Intervals from changes of a state. Each change applies until the next one; `before` is the state from `first_s`
    /// to the first change.
    pub(crate) fn from_changes(
        changes: &[(f64, bool)],
        before: bool,
        first_s: f64,
        last_s: f64,
        rule: impl Into<String>,
    ) -> Self {
        let mut spans = Vec::new();
        let mut start = before.then_some(first_s);
        for &(t_s, state) in changes {
            match (start, state) {
                (None, true) => start = Some(t_s),
                (Some(start_s), false) => {
                    if t_s > start_s {
                        spans.push(Interval {
                            start_s,
                            end_s: t_s,
                            ends_with_log: false,
                        });
                    }
                    start = None;
                }
                _ => {}
            }
        }
        if let Some(start_s) = start.filter(|&start_s| last_s >= start_s) {
            spans.push(Interval {
                start_s,
                end_s: last_s,
                ends_with_log: true,
            });
        }
        Self {
            spans,
            rule: rule.into(),
            is_assumed: false,
        }
    }

    /// These intervals, marked as not reported by the autopilot.
    pub(crate) fn assumed(self) -> Self {
        Self {
            is_assumed: true,
            ..self
        }
    }
}

/// Combines the changes of two states into the changes of a state that is true while both states are true. The first
/// value of each state also applies to the time before it.
pub(crate) fn both_hold(a: &[(f64, bool)], b: &[(f64, bool)]) -> Vec<(f64, bool)> {
    let mut times: Vec<f64> = a.iter().chain(b).map(|(t_s, _)| *t_s).collect();
    times.sort_by(f64::total_cmp);
    let at = |states: &[(f64, bool)], t_s: f64| {
        let after = states.partition_point(|(since, _)| *since <= t_s);
        let index = after.saturating_sub(1);
        states.get(index).is_some_and(|(_, state)| *state)
    };
    times
        .into_iter()
        .map(|t_s| (t_s, at(a, t_s) && at(b, t_s)))
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn changes_become_intervals() {
        let changes = [(1.0, true), (2.0, true), (3.0, false), (5.0, true)];
        let found = Intervals::from_changes(&changes, false, 0.0, 8.0, "test");
        let spans: Vec<_> = found
            .spans
            .iter()
            .map(|s| (s.start_s, s.end_s, s.ends_with_log))
            .collect();
        assert_eq!(spans, [(1.0, 3.0, false), (5.0, 8.0, true)]);
        assert_eq!(found.duration_s(), 5.0);
        for (t, inside) in [
            (0.0, false),
            (1.0, true),
            (2.99, true),
            (3.0, false),
            (8.0, true),
        ] {
            assert_eq!(found.contains(t), inside, "{t}");
        }
    }

    #[test]
    fn near_intervals_are_merged() {
        let changes = [
            (1.0, true),
            (3.0, false),
            (3.5, true),
            (5.0, false),
            (6.0, true),
        ];
        let found = Intervals::from_changes(&changes, false, 0.0, 8.0, "test").joined(1.0);
        let spans: Vec<_> = found.spans.iter().map(|s| (s.start_s, s.end_s)).collect();
        assert_eq!(spans, [(1.0, 5.0), (6.0, 8.0)]);
        assert!(found.spans[1].ends_with_log && !found.spans[0].ends_with_log);
    }

    #[test]
    fn a_state_before_the_first_change_counts() {
        let found = Intervals::from_changes(&[(3.0, false)], true, 1.0, 8.0, "test");
        assert_eq!(found.duration_s(), 2.0);
        let all = Intervals::from_changes(&[], true, 1.0, 8.0, "test");
        assert_eq!(all.duration_s(), 7.0);
        let none = Intervals::from_changes(&[], false, 1.0, 8.0, "test");
        assert!(none.spans.is_empty());
    }
}
