//! Simplification to fewer rules with the same outputs: `flagred.simplify`.

use flagred_tuning::{SimplifyError, SimplifySettings, simplify};
use fuzzy::{Model, yaml};
use numpy::PyReadonlyArray1;
use pyo3::prelude::*;

use crate::{rows::DerivationError, rule_set::RuleSet, threads::interruptible};

#[derive(FromPyObject)]
#[pyo3(from_item_all)]
pub(crate) struct SimplifyOptions {
    tolerance: Option<f64>,
    rows_only: bool,
    seed: u64,
}

/// The result inside `flagred.types.SimplifyResult`.
#[derive(IntoPyObject)]
pub(crate) struct SimplifyResult {
    model: String,
    rules: Vec<Vec<usize>>,
    dropped: Vec<usize>,
    inputs: Vec<String>,
    points: usize,
    /// The largest difference: the output, its value before and after, and the inputs.
    difference: Option<(String, f64, f64, Vec<f64>)>,
}

impl From<SimplifyError> for DerivationError {
    fn from(error: SimplifyError) -> DerivationError {
        match error {
            SimplifyError::Compile(findings) => DerivationError::Findings(findings),
            error => DerivationError::data(error),
        }
    }
}

/// Simplifies a rule set. `columns` contains the rows at which outputs are also compared, as one column for each input;
/// it may be empty.
#[pyfunction]
pub(crate) fn _simplify(
    py: Python<'_>,
    rule_set: &RuleSet,
    columns: Vec<PyReadonlyArray1<'_, f64>>,
    options: SimplifyOptions,
) -> PyResult<SimplifyResult> {
    rule_set.compile(py)?;
    let model = rule_set.model(Model::clone);
    let columns = columns.iter().map(|column| column.as_array().to_vec());
    let columns: Vec<Vec<f64>> = columns.collect();
    let mut settings = SimplifySettings::default();
    settings.tolerance = options.tolerance;
    settings.rows_only = options.rows_only;
    settings.seed = options.seed;
    let found = interruptible(py, move || simplify(&model, &columns, &settings))?;
    let found = found.map_err(|error| DerivationError::from(error).raise(py))?;
    let numbers = |rules: Vec<usize>| rules.into_iter().map(|rule| rule + 1).collect();
    Ok(SimplifyResult {
        model: yaml::to_string(&found.model),
        rules: found.rules.into_iter().map(numbers).collect(),
        dropped: numbers(found.dropped),
        inputs: found.inputs,
        points: found.points,
        difference: found
            .difference
            .map(|one| (one.output, one.before, one.after, one.inputs)),
    })
}
