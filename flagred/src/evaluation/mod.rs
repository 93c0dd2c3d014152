//! How good is a risk? Scores held against what became of the flight.
//!
//! A *step* is a moment of a flight with the scores of the estimators; it is critical where the attitude error goes over
//! [`CRITICAL_ERROR_DEG`](crate::attitude::CRITICAL_ERROR_DEG), root mean square over a second, within a horizon after it
//! ([`ErrorRecord`]). An estimator is worth what it ranks critical steps above the others ([`Ranking`]), what its
//! percentages come to ([`reliability`]), and what its warnings announce ([`judge`]).

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
#[derive(Debug, Clone, Copy, PartialEq)]
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

    /// Whether it holds a time.
    pub fn contains(&self, t_s: f64) -> bool {
        (self.from_s..=self.to_s).contains(&t_s)
    }

    /// Takes in whether something is the case at `t_s`: the last of `spans` grows, ends, or is followed by a new one.
    ///
    /// `open` remembers whether it is still the case.
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
