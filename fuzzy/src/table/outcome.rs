//! What an evaluation says.

/// What one output is for one set of inputs.
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
    /// That rule, as its index in the model; of several, the first. `None` where no rule fired.
    pub dominant: Option<usize>,
    /// Whether an input lay outside its range and was taken as the range's end.
    pub clamped: bool,
}

/// Whether an output has a value.
///
/// # Example
/// ```
/// use fuzzy::engine::State;
///
/// let told = |state: State| match state {
///     State::Defined(value) => format!("{value} by the rules"),
///     State::Default(value) => format!("{value}, for no rule fires"),
///     State::NoRuleFired => "no rule fires".to_string(),
///     State::InputNotFinite => "an input is unknown".to_string(),
/// };
/// assert_eq!(told(State::Default(0.5)), "0.5, for no rule fires");
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub enum State {
    /// Rules fired, and this is the value.
    Defined(f64),
    /// No rule fired; this is the value that the author chose for that.
    Default(f64),
    /// No rule fired: the output is undefined here.
    #[default]
    NoRuleFired,
    /// An input is NaN or infinite: nothing can be said.
    InputNotFinite,
}

impl Outcome {
    /// Nothing is known: no rule fired.
    pub const UNDEFINED: Outcome = Outcome {
        state: State::NoRuleFired,
        coverage: 0.0,
        dominant: None,
        clamped: false,
    };

    /// The value: of the rules, or the one chosen by the author for where no rule fires. Never NaN.
    ///
    /// # Example
    /// ```
    /// use fuzzy::engine::{Outcome, State};
    ///
    /// let of = |state| Outcome { state, ..Outcome::default() }.value();
    /// assert_eq!(of(State::Defined(0.3)), Some(0.3));
    /// assert_eq!(of(State::InputNotFinite), None);
    /// ```
    pub fn value(&self) -> Option<f64> {
        match self.state {
            State::Defined(value) | State::Default(value) => Some(value),
            State::NoRuleFired | State::InputNotFinite => None,
        }
    }
}
