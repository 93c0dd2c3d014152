//! Why inputs could not be evaluated.

use alloc::{format, string::String, sync::Arc};
use core::fmt;

/// Why inputs could not be evaluated.
#[derive(Debug, Clone, PartialEq, Eq)]
#[non_exhaustive]
pub enum EvaluateError {
    /// Not one value for each input.
    WrongNumberOfInputs {
        /// How many inputs the model has.
        expected: usize,
        /// How many values were given.
        got: usize,
    },
    /// Not one outcome for each output.
    WrongNumberOfOutputs {
        /// How many outputs the model has.
        expected: usize,
        /// How many outcomes were lent.
        got: usize,
    },
    /// Columns of a batch that are not equally long.
    ColumnsOfDifferentLengths {
        /// The length of the first column.
        first: usize,
        /// Another length.
        other: usize,
    },
    /// A name that is no input.
    UnknownInput {
        /// The name.
        name: String,
    },
    /// An input without a value.
    MissingInput {
        /// The input.
        name: Arc<str>,
    },
    /// An input with two values.
    RepeatedInput {
        /// The input.
        name: Arc<str>,
    },
    /// A value that is no struct or map of numbers.
    NoFields {
        /// What was expected.
        message: String,
    },
    /// An input is NaN or infinite, so there is nothing to explain.
    InputNotFinite,
    /// No rule of an output fired, and the model says that this is an error.
    NoRuleFired {
        /// The output's name.
        output: Arc<str>,
    },
    /// A grid has more cells than a decision map takes.
    TooManyCells {
        /// How many; `usize::MAX` where there are more than fit.
        cells: usize,
        /// The most cells of a decision map.
        most: usize,
    },
}

/// `1 input`, `2 inputs`.
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
                let (outputs, room) = (counted(*expected, "output"), counted(*got, "outcome"));
                write!(f, "the model has {outputs}, but there is room for {room}")
            }
            EvaluateError::ColumnsOfDifferentLengths { first, other } => {
                write!(f, "a column has {other} values where the first has {first}")
            }
            EvaluateError::UnknownInput { name } => write!(f, "there is no input `{name}`"),
            EvaluateError::MissingInput { name } => write!(f, "input `{name}` has no value"),
            EvaluateError::RepeatedInput { name } => write!(f, "input `{name}` has two values"),
            EvaluateError::NoFields { message } => f.write_str(message),
            EvaluateError::InputNotFinite => f.write_str("an input is not a finite number"),
            EvaluateError::TooManyCells { cells, most } => match *cells {
                usize::MAX => write!(f, "the grid has more than {most} cells, the most of a map"),
                cells => write!(f, "the grid has {cells} cells; a map has at most {most}"),
            },
            EvaluateError::NoRuleFired { output } => {
                write!(f, "no rule fired for output `{output}`")
            }
        }
    }
}

impl core::error::Error for EvaluateError {}
