//! Rows to learn from, and options shared by `flagred.learn` and `flagred.tune`.

use flagred_authoring::provenance;
use flagred_evaluation::learning::Row;
use fuzzy::{
    Findings, Model,
    check::{Direction, Monotone},
    model::ProvenanceStep,
};
use numpy::PyReadonlyArray1;
use pyo3::prelude::*;

use crate::errors::{data_error, rule_set_error};

/// The maximum number of refused rows that a message shows.
const SHOWN: usize = 20;

/// Rows as arguments from Python.
#[derive(FromPyObject)]
#[pyo3(from_item_all)]
pub(crate) struct RowArguments<'py> {
    /// A column for each input, then the output.
    columns: Vec<PyReadonlyArray1<'py, f64>>,
    weights: Option<PyReadonlyArray1<'py, f64>>,
    groups: Option<PyReadonlyArray1<'py, u32>>,
    pub(crate) skip_bad_rows: bool,
}

impl RowArguments<'_> {
    pub(crate) fn rows(&self) -> Vec<Row> {
        let columns: Vec<_> = self.columns.iter().map(|c| c.as_array()).collect();
        let weights = self.weights.as_ref().map(|weights| weights.as_array());
        let groups = self.groups.as_ref().map(|groups| groups.as_array());
        let row = |row: usize| Row {
            values: columns.iter().map(|column| column[row]).collect(),
            weight: weights.map_or(1.0, |weights| weights[row]),
            group: groups.map(|groups| groups[row]),
        };
        (0..columns.first().map_or(0, |column| column.len()))
            .map(row)
            .collect()
    }
}

/// The reason why no rule set could be learned, tuned or identified.
pub(crate) enum DerivationError {
    Refused(Vec<String>),
    /// A message, and help.
    Data(String, Option<String>),
    Findings(Findings),
}

impl DerivationError {
    pub(crate) fn data(error: impl std::fmt::Display) -> DerivationError {
        DerivationError::Data(error.to_string(), None)
    }

    pub(crate) fn raise(self, py: Python<'_>) -> PyErr {
        match self {
            DerivationError::Data(message, help) => data_error(message, help),
            DerivationError::Findings(findings) => rule_set_error(py, &findings, "<model>", ""),
            DerivationError::Refused(refused) => {
                let plural = if refused.len() == 1 { "" } else { "s" };
                let mut message = format!("{} row{plural} cannot be used", refused.len());
                for row in refused.iter().take(SHOWN) {
                    message += &format!("\n  {row}");
                }
                if refused.len() > SHOWN {
                    message += &format!("\n  and {} more", refused.len() - SHOWN);
                }
                let help = "correct these rows, or leave them out with `skip_bad_rows=True`";
                data_error(message, Some(help.into()))
            }
        }
    }
}

/// Returns the text of a rule set that was derived from another one, including the provenance step that created it.
pub(crate) fn with_step(
    original_text: &str,
    model: &Model,
    step: ProvenanceStep,
) -> Result<String, DerivationError> {
    provenance::rule_set(original_text, model.clone(), step).map_err(DerivationError::Findings)
}

/// Returns the choice with the given name.
pub(crate) fn choice<T: Copy>(key: &str, word: &str, choices: &[(&str, T)]) -> PyResult<T> {
    if let Some((_, choice)) = choices.iter().find(|(name, _)| *name == word) {
        return Ok(*choice);
    }
    let mut names: Vec<String> = choices
        .iter()
        .map(|(name, _)| format!("`{name}`"))
        .collect();
    let last = names.pop().unwrap_or_default();
    let help = format!("write {} or {last}", names.join(", "));
    Err(data_error(format!("`{key}` is `{word}`"), Some(help)))
}

/// The inputs in `rising`, followed by the inputs in `falling`, each with its direction.
pub(crate) fn directed<D: Copy>(
    rising: &[String],
    falling: &[String],
    [up, down]: [D; 2],
) -> Vec<(String, D)> {
    let rising = rising.iter().map(|input| (input.clone(), up));
    let falling = falling.iter().map(|input| (input.clone(), down));
    rising.chain(falling).collect()
}

/// The monotonicity claims for the inputs in `rising` and `falling`.
pub(crate) fn claims(rising: &[String], falling: &[String]) -> Vec<Monotone> {
    let directions = [Direction::Increasing, Direction::Decreasing];
    let claims = directed(rising, falling, directions).into_iter();
    let claims = claims.map(|(input, direction)| Monotone {
        input,
        direction,
        output: None,
    });
    claims.collect()
}
