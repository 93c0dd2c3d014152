//! The same said with fewer rules: `flagred.simplify`.

use flagred_tuning::{SimplifyError, SimplifySettings, simplify};
use fuzzy::{Model, yaml};
use numpy::PyReadonlyArray1;
use pyo3::prelude::*;

use crate::{rows::Failed, rule_set::RuleSet, threads::interruptible};

#[derive(FromPyObject)]
#[pyo3(from_item_all)]
pub(crate) struct SimplifyOptions {
    tolerance: Option<f64>,
    rows_only: bool,
    seed: u64,
}

/// What `flagred.types.Simplified` is made of.
#[derive(IntoPyObject)]
pub(crate) struct Simplified {
    model: String,
    rules: Vec<Vec<usize>>,
    dropped: Vec<usize>,
    inputs: Vec<String>,
    points: usize,
    /// The output, its value before and after, and the inputs.
    difference: Option<(String, f64, f64, Vec<f64>)>,
}

impl From<SimplifyError> for Failed {
    fn from(error: SimplifyError) -> Failed {
        match error {
            SimplifyError::Compile(findings) => Failed::Findings(findings),
            error => Failed::data(error),
        }
    }
}

/// A rule set that says the same; `columns` are rows at which both are compared, too, one for each input or none.
#[pyfunction]
pub(crate) fn _simplify(
    py: Python<'_>,
    rule_set: &RuleSet,
    columns: Vec<PyReadonlyArray1<'_, f64>>,
    options: SimplifyOptions,
) -> PyResult<Simplified> {
    rule_set.compile(py)?;
    let model = rule_set.model(Model::clone);
    let columns = columns.iter().map(|column| column.as_array().to_vec());
    let columns: Vec<Vec<f64>> = columns.collect();
    let mut settings = SimplifySettings::default();
    settings.tolerance = options.tolerance;
    settings.rows_only = options.rows_only;
    settings.seed = options.seed;
    let found = interruptible(py, move || simplify(&model, &columns, &settings))?;
    let found = found.map_err(|error| Failed::from(error).raise(py))?;
    let numbers = |rules: Vec<usize>| rules.into_iter().map(|rule| rule + 1).collect();
    Ok(Simplified {
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
