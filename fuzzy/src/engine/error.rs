//! Why inputs could not be evaluated.

use alloc::sync::Arc;

/// Why inputs could not be evaluated.
///
/// # Example: a value too few
/// ```
/// use fuzzy::engine::EvaluateError;
///
/// # let model = fuzzy::yaml::parse(include_str!(concat!(env!("CARGO_MANIFEST_DIR"), "/../rules/flagred-paper.yaml")))?.model;
/// let engine = fuzzy::Engine::new(&model)?;
/// let refused = engine.evaluate(&[0.1]).unwrap_err();
/// assert_eq!(refused, EvaluateError::WrongNumberOfInputs { expected: 2, got: 1 });
/// // An unknown value is no error to an evaluation, which says so in its outcome, but nothing can be explained.
/// assert!(engine.evaluate(&[0.1, f64::NAN]).is_ok());
/// assert_eq!(engine.explain(&model, &[0.1, f64::NAN]), Err(EvaluateError::InputNotFinite));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum EvaluateError {
    /// Not one value for each input.
    #[error("{got} values were given for {expected} input(s)")]
    WrongNumberOfInputs {
        /// How many inputs the model has.
        expected: usize,
        /// How many values were given.
        got: usize,
    },
    /// Not one place for each output.
    #[error("there is room for {got} outcomes of {expected} output(s)")]
    WrongNumberOfOutputs {
        /// How many outputs the model has.
        expected: usize,
        /// How many places were given.
        got: usize,
    },
    /// Columns of a batch that are not equally long.
    #[error("a column has {other} values where the first has {first}")]
    ColumnsOfDifferentLengths {
        /// The length of the first column.
        first: usize,
        /// Another length.
        other: usize,
    },
    /// An input is NaN or infinite, so there is nothing to explain.
    #[error("an input is not a finite number")]
    InputNotFinite,
    /// The model is not the one that the engine was made from.
    #[error("the engine was made from another model")]
    OtherModel,
    /// No rule of an output fired, and the model says that this is an error.
    #[error("no rule fired for output `{output}`")]
    NoRuleFired {
        /// The output's name.
        output: Arc<str>,
    },
}
