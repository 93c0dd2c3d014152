//! Explanations of many points: a line for each rule that contributes to an output at a row.

use std::sync::Arc;

use fuzzy::{Engine, engine::EvaluateError};
use numpy::{IntoPyArray, PyReadonlyArray1};
use pyo3::{prelude::*, types::PyDict};
use rayon::prelude::*;

use crate::{
    compiled::CompiledRuleSet,
    errors::data_error,
    threads::{interruptible, pool},
};

/// A rule that contributes to an output at a row.
struct Line {
    row: usize,
    output: usize,
    rule: usize,
    strength: f64,
    share: f64,
    dominant: Option<usize>,
}

/// The rules that contribute to the outputs at each row whose inputs are all known.
fn explained(engine: &Engine, columns: &[Vec<f64>]) -> Result<Vec<Line>, EvaluateError> {
    let rows = columns.first().map_or(0, Vec::len);
    let lines = (0..rows).into_par_iter().map(|row| {
        let values: Vec<f64> = columns.iter().map(|column| column[row]).collect();
        if values.iter().any(|value| !value.is_finite()) {
            return Ok(Vec::new());
        }
        let outcomes = engine.evaluate(&values)?;
        let explanation = engine.explain(&values)?;
        let outputs = explanation.outputs.iter().enumerate();
        let lines = outputs.flat_map(|(output, explained)| {
            let dominant = outcomes
                .get(output)
                .and_then(|outcome| outcome.dominant_rule);
            explained.rules.iter().map(move |rule| Line {
                row,
                output,
                rule: rule.rule,
                strength: rule.strength,
                share: rule.share,
                dominant,
            })
        });
        Ok(lines.collect())
    });
    let lines: Result<Vec<Vec<Line>>, EvaluateError> = lines.collect();
    Ok(lines?.into_iter().flatten().collect())
}

/// The lines of all rows as columns; rules are counted from 1. `columns` are in the order of the inputs.
pub(crate) fn explained_rows<'py>(
    py: Python<'py>,
    compiled: Arc<CompiledRuleSet>,
    columns: &[PyReadonlyArray1<'py, f64>],
) -> PyResult<Bound<'py, PyDict>> {
    let columns = columns.iter().map(|column| column.as_array().to_vec());
    let columns: Vec<Vec<f64>> = columns.collect();
    let pool = pool(None)?;
    let rows = interruptible(py, move || {
        pool.install(|| explained(&compiled.engine, &columns))
    })?;
    let rows = rows.map_err(|error| data_error(error, None))?;
    let found = PyDict::new(py);
    let number = |get: fn(&Line) -> i64| rows.iter().map(get).collect::<Vec<i64>>();
    let float = |get: fn(&Line) -> f64| rows.iter().map(get).collect::<Vec<f64>>();
    found.set_item("row", number(|line| line.row as i64).into_pyarray(py))?;
    found.set_item("output", number(|line| line.output as i64).into_pyarray(py))?;
    found.set_item("rule", number(|line| line.rule as i64 + 1).into_pyarray(py))?;
    found.set_item("strength", float(|line| line.strength).into_pyarray(py))?;
    found.set_item("share", float(|line| line.share).into_pyarray(py))?;
    let dominant = number(|line| line.dominant.map_or(0, |rule| rule as i64 + 1));
    found.set_item("dominant_rule", dominant.into_pyarray(py))?;
    Ok(found)
}
