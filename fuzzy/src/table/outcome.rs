//! The results of an evaluation.

/// The result for one output.
///
/// # Example: the value, or why there is none
/// ```
/// use fuzzy::engine::{Outcome, State};
///
/// let outcome = Outcome { state: State::NoRuleFired, ..Outcome::default() };
/// assert_eq!(outcome.value(), None);
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Outcome {
    /// The value, or why there is none.
    pub state: State,
    /// The largest firing strength (weight included) of a rule of this output, in [0, 1].
    pub coverage: f64,
    /// The index in the model of the rule with that strength, the first of equal ones. `None` where no rule fired.
    pub dominant_rule: Option<usize>,
    /// Whether an input was outside its range and was clamped to it.
    pub clamped: bool,
}

/// Whether an output has a value.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub enum State {
    /// Rules fired and gave this value.
    Defined(f64),
    /// No rule fired; this is the default value of the output.
    Default(f64),
    /// No rule fired; this is the value of the evaluation before, in a `Sequence`.
    Previous(f64),
    /// No rule fired, and the output has no default value.
    #[default]
    NoRuleFired,
    /// An input is NaN or infinite.
    InputNotFinite,
}

impl Outcome {
    /// No rule fired.
    pub const UNDEFINED: Outcome = Outcome {
        state: State::NoRuleFired,
        coverage: 0.0,
        dominant_rule: None,
        clamped: false,
    };

    /// The value that rules gave, the default value or the previous one. Never NaN.
    pub fn value(&self) -> Option<f64> {
        match self.state {
            State::Defined(value) | State::Default(value) | State::Previous(value) => Some(value),
            State::NoRuleFired | State::InputNotFinite => None,
        }
    }
}
