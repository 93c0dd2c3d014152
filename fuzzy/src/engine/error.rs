//! Errors of evaluation.

use alloc::{format, string::String, sync::Arc};
use core::fmt;

/// An error of evaluation.
#[derive(Debug, Clone, PartialEq, Eq)]
#[non_exhaustive]
pub enum EvaluateError {
    /// The number of values differs from the number of inputs.
    WrongNumberOfInputs {
        /// The number of inputs of the model.
        expected: usize,
        /// The number of values.
        got: usize,
    },
    /// The number of outcomes that the caller passed differs from the number of outputs; for a batch, from the number of
    /// outputs of all rows.
    WrongNumberOfOutputs {
        /// The number of outputs.
        expected: usize,
        /// The number of outcomes that the caller passed.
        got: usize,
    },
    /// The model has no output with the given index.
    UnknownOutput {
        /// The unknown index, from 0.
        index: usize,
        /// The number of outputs of the model.
        outputs: usize,
    },
    /// The columns of a batch have different lengths.
    ColumnsOfDifferentLengths {
        /// The length of the first column.
        first: usize,
        /// The length of the first column that differs.
        other: usize,
    },
    /// The model has no input with the given name.
    UnknownInput {
        /// The unknown name.
        name: String,
    },
    /// An input has no value.
    MissingInput {
        /// The name of the input.
        name: Arc<str>,
    },
    /// An input has two values.
    RepeatedInput {
        /// The name of the input.
        name: Arc<str>,
    },
    /// The interval of an input ends below its start.
    InvertedInterval {
        /// The name of the input.
        input: Arc<str>,
    },
    /// The value is not a struct or map of numbers.
    NoFields {
        /// The error message, which states the expected type.
        message: String,
    },
    /// An input, or an end of its interval, is NaN or infinite. [`Engine::evaluate`](super::Engine::evaluate) returns
    /// [`State::InputNotFinite`](super::State::InputNotFinite) instead of this error.
    InputNotFinite,
    /// No rule of an output fired, and the model treats that as an error.
    NoRuleFired {
        /// The name of the output.
        output: Arc<str>,
    },
    /// A grid has more cells than a decision map supports.
    TooManyCells {
        /// The number of cells; `usize::MAX` if it does not fit into `usize`.
        cells: usize,
        /// The maximum number of cells of a decision map.
        most: usize,
    },
}

/// Formats a count with its noun: `1 input`, `2 inputs`.
fn counted(count: usize, word: &str) -> String {
    let plural = if count == 1 { "" } else { "s" };
    format!("{count} {word}{plural}")
}

impl fmt::Display for EvaluateError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            EvaluateError::WrongNumberOfInputs { expected, got } => {
                let (inputs, values) = (counted(*expected, "input"), counted(*got, "value"));
                write!(
                    f,
                    "the model has {inputs}, but {values} given",
                    values = match got {
                        1 => format!("{values} was"),
                        _ => format!("{values} were"),
                    }
                )
            }
            EvaluateError::WrongNumberOfOutputs { expected, got } => {
                let outcomes = counted(*expected, "outcome");
                write!(f, "there must be room for {outcomes}, not for {got}")
            }
            EvaluateError::UnknownOutput { index, outputs } => {
                let outputs = counted(*outputs, "output");
                write!(
                    f,
                    "there is no output with index {index}: the model has {outputs}"
                )
            }
            EvaluateError::ColumnsOfDifferentLengths { first, other } => {
                write!(f, "a column has {other} values where the first has {first}")
            }
            EvaluateError::UnknownInput { name } => write!(f, "there is no input `{name}`"),
            EvaluateError::MissingInput { name } => write!(f, "input `{name}` has no value"),
            EvaluateError::RepeatedInput { name } => write!(f, "input `{name}` has two values"),
            EvaluateError::InvertedInterval { input } => {
                write!(f, "the interval of input `{input}` ends below its start")
            }
            EvaluateError::NoFields { message } => f.write_str(message),
            EvaluateError::InputNotFinite => f.write_str("an input is not a finite number"),
            EvaluateError::TooManyCells { cells, most } => match *cells {
                usize::MAX => write!(
                    f,
                    "the grid has more than {most} cells, the maximum for a map"
                ),
                cells => write!(f, "the grid has {cells} cells; a map has at most {most}"),
            },
            EvaluateError::NoRuleFired { output } => {
                write!(f, "no rule fired for output `{output}`")
            }
        }
    }
}

impl core::error::Error for EvaluateError {}
