//! Identification of a rule set from rows alone: `flagred.identify`.

use std::ops::ControlFlow;

use flagred_tuning::{
    Data,
    identify::{Antecedents, Consequents, Identification, cross_validate, identify},
};
use fuzzy::yaml;
use numpy::PyReadonlyArray1;
use pyo3::prelude::*;

use crate::{
    rows::{DerivationError, choice},
    threads::interruptible,
};

#[derive(FromPyObject)]
#[pyo3(from_item_all)]
pub(crate) struct IdentifyOptions {
    antecedents: String,
    consequents: String,
    inputs: Vec<String>,
    max_inputs: usize,
    max_terms: usize,
    max_rules: usize,
    min_gain: f64,
    min_support: usize,
    folds: u32,
    seed: u64,
    validation: bool,
}

impl IdentifyOptions {
    fn settings(&self) -> PyResult<Identification> {
        let antecedents = [
            ("partitions", Antecedents::Partitions),
            ("clusters", Antecedents::Clusters),
        ];
        let consequents = [
            ("constants", Consequents::Constants),
            ("lines", Consequents::Lines),
        ];
        let mut settings = Identification::default();
        settings.antecedents = choice("antecedents", &self.antecedents, &antecedents)?;
        settings.consequents = choice("consequents", &self.consequents, &consequents)?;
        settings.inputs = self.inputs.clone();
        settings.max_inputs = self.max_inputs;
        settings.max_terms = self.max_terms;
        settings.max_rules = self.max_rules;
        settings.min_gain = self.min_gain;
        settings.least_support = self.min_support;
        settings.folds = self.folds;
        settings.seed = self.seed;
        Ok(settings)
    }
}

/// A figure and the ends of its confidence interval.
type Figure = (f64, f64, f64);

/// The result inside `flagred.types.IdentifyResult`.
#[derive(IntoPyObject)]
pub(crate) struct IdentifyResult {
    model: String,
    /// For each step of the search: the input, its number of terms, and the cross-validation error.
    steps: Vec<(String, usize, f64)>,
    without_rows: usize,
    validation: Option<IdentifyValidation>,
}

#[derive(IntoPyObject)]
pub(crate) struct IdentifyValidation {
    folds: usize,
    without_value: usize,
    identified: Figure,
    linear: Figure,
    mean: Figure,
    ratio: Figure,
}

/// Finds a rule set that predicts the truths, from columns with the given names.
#[pyfunction]
pub(crate) fn _identify(
    py: Python<'_>,
    names: Vec<String>,
    output: String,
    columns: Vec<PyReadonlyArray1<'_, f64>>,
    truths: PyReadonlyArray1<'_, f64>,
    groups: Option<PyReadonlyArray1<'_, u32>>,
    options: IdentifyOptions,
) -> PyResult<IdentifyResult> {
    let settings = options.settings()?;
    let data = Data {
        inputs: columns
            .iter()
            .map(|column| column.as_array().to_vec())
            .collect(),
        truths: truths.as_array().to_vec(),
        groups: groups.map_or_else(Vec::new, |groups| groups.as_array().to_vec()),
        ..Data::default()
    };
    let (folds, validation) = (options.folds, options.validation);
    let found = interruptible(py, move || {
        let found = identify(&names, &output, &data, &settings)?;
        let validation = match validation {
            true => cross_validate(&names, &output, &data, &settings, folds, &mut |_| {
                ControlFlow::Continue(())
            })?,
            false => None,
        };
        Ok((found, validation))
    })?;
    let (found, validation) =
        found.map_err(|error: flagred_tuning::TuneError| DerivationError::from(error).raise(py))?;
    let figure = |interval: flagred_tuning::Interval| (interval.value, interval.low, interval.high);
    let steps = found.steps.into_iter();
    Ok(IdentifyResult {
        model: yaml::to_string(&found.model),
        steps: steps
            .map(|step| (step.input, step.terms, step.cv_error))
            .collect(),
        without_rows: found.without_rows,
        validation: validation.map(|validation| IdentifyValidation {
            folds: validation.folds,
            without_value: validation.without_value,
            identified: figure(validation.identified),
            linear: figure(validation.linear),
            mean: figure(validation.mean),
            ratio: figure(validation.ratio),
        }),
    })
}
