//! How well risks and other scores predict critical attitude errors.
//!
//! A *step* is a time of a flight with the scores of the estimators. It is critical where the attitude error, root mean square
//! over a second, exceeds [`CRITICAL_ERROR_DEG`](crate::attitude::CRITICAL_ERROR_DEG) within a horizon after it
//! ([`ErrorRecord`]). An estimator is measured by how well it ranks critical steps above the others ([`Ranking`]), how often
//! a risk of so many percent became critical ([`reliability`]), and which episodes its warnings announce ([`judge`]).

mod announced;
mod baseline;
mod critical;
mod random;
mod ranking;

pub use announced::{Answer, Judged, Warning, judge};
pub use baseline::Baseline;
pub use critical::ErrorRecord;
pub use ranking::{Areas, Band, Interval, Intervals, Prediction, Ranking, RocPoint, reliability};

/// A time of a flight, both ends included, in seconds.
///
/// # Example
/// ```
/// use flagred::evaluation::Span;
///
/// let gust = Span { from_s: 30.0, to_s: 33.5 };
/// assert!(gust.contains(30.0) && gust.contains(33.5) && !gust.contains(34.0));
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
pub struct Span {
    /// Where it begins.
    pub from_s: f64,
    /// Where it ends.
    pub to_s: f64,
}

impl Span {
    /// Its length in seconds.
    pub fn length_s(&self) -> f64 {
        self.to_s - self.from_s
    }

    /// Whether a time lies in it.
    pub fn contains(&self, t_s: f64) -> bool {
        (self.from_s..=self.to_s).contains(&t_s)
    }

    /// Adds a time at which something is the case or not: the last of `spans` grows or ends, or a new one begins.
    ///
    /// `open` keeps whether it was the case the time before.
    pub fn follow(spans: &mut Vec<Span>, open: &mut bool, t_s: f64, is_so: bool) {
        match spans.last_mut().filter(|_| *open && is_so) {
            Some(span) => span.to_s = t_s,
            None if is_so => spans.push(Span {
                from_s: t_s,
                to_s: t_s,
            }),
            None => {}
        }
        *open = is_so;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_the_case_for_a_while_is_a_span() {
        let (mut spans, mut open) = (Vec::new(), false);
        for (t_s, is_so) in [
            (0.0, false),
            (1.0, true),
            (2.0, true),
            (3.0, false),
            (4.0, true),
        ] {
            Span::follow(&mut spans, &mut open, t_s, is_so);
        }
        let span = |from_s, to_s| Span { from_s, to_s };
        assert_eq!(spans, [span(1.0, 2.0), span(4.0, 4.0)]);
        assert!(spans[0].contains(1.0) && spans[0].contains(2.0) && !spans[0].contains(2.1));
    }
}
