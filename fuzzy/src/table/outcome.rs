//! The results of an evaluation.

/// The result of an evaluation for one output.
///
/// # Example: a value, or the reason why there is none
/// ```
/// use fuzzy::engine::{Outcome, State};
///
/// let outcome = Outcome { state: State::NoRuleFired, ..Outcome::default() };
/// assert_eq!(outcome.value(), None);
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Outcome {
    /// The value, or the reason why there is none.
    pub state: State,
    /// The largest firing strength (including the weight) of a rule of this output, in [0, 1]. With interval type-2
    /// terms, the largest upper bound of a firing strength.
    pub coverage: f64,
    /// The index in the model of the rule with that strength; among equally strong rules the first. `None` if no rule
    /// fired.
    pub dominant_rule: Option<usize>,
    /// Whether an input was outside its range and was clamped to it.
    pub clamped: bool,
}

/// The value of an output, or the reason why it has none.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub enum State {
    /// Rules fired and determined this value.
    Defined(f64),
    /// Rules fired and determined this interval, because the model has interval type-2 terms. The value is its middle.
    Interval {
        /// The lower end.
        low: f64,
        /// The upper end.
        high: f64,
    },
    /// No rule fired; this is the default value of the output.
    Default(f64),
    /// No rule fired; this is the value of the previous evaluation in a `Sequence`.
    Previous(f64),
    /// No rule fired, and the output has no default value.
    #[default]
    NoRuleFired,
    /// An input is NaN or infinite.
    InputNotFinite,
}

impl Outcome {
    /// The outcome if no rule fired.
    pub const UNDEFINED: Outcome = Outcome {
        state: State::NoRuleFired,
        coverage: 0.0,
        dominant_rule: None,
        clamped: false,
    };

    /// Returns the value that rules determined, the middle of their interval, the default value, or the previous one. It
    /// is never NaN.
    pub fn value(&self) -> Option<f64> {
        match self.state {
            State::Defined(value) | State::Default(value) | State::Previous(value) => Some(value),
            State::Interval { low, high } => Some(low + 0.5 * (high - low)),
            State::NoRuleFired | State::InputNotFinite => None,
        }
    }

    /// Returns the lower end of the interval of values that interval type-2 terms allow. Without such terms it is the
    /// value.
    #[must_use]
    pub fn low(&self) -> Option<f64> {
        match self.state {
            State::Interval { low, .. } => Some(low),
            _ => self.value(),
        }
    }

    /// Returns the upper end of the interval of values that interval type-2 terms allow. Without such terms it is the
    /// value.
    #[must_use]
    pub fn high(&self) -> Option<f64> {
        match self.state {
            State::Interval { high, .. } => Some(high),
            _ => self.value(),
        }
    }
}
