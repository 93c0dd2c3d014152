//! Cross-validation of the whole identification.

use std::ops::ControlFlow;

use fuzzy::Engine;

use crate::{
    Confusion, Interval, TuneError,
    confusion::confusion,
    data::{Data, range},
    folds::Folds,
};

use super::{
    Consequents, Identification,
    fit::{Fit, mean},
    identify,
    structure::{Axis, Structure},
};

/// Cross-validation errors (root mean squares), in the unit of the output.
#[derive(Debug, Clone, PartialEq)]
pub struct IdentifyValidation {
    /// The number of folds.
    pub folds: usize,
    /// The error of a baseline that predicts each row as the mean of the rows in other folds.
    pub mean: Interval,
    /// The error of a linear regression on all inputs.
    pub linear: Interval,
    /// The error of the models identified on the other folds.
    pub identified: Interval,
    /// The error of the identified models divided by the error of the linear regression.
    pub ratio: Interval,
    /// The predictions of the identified models for left-out rows of each class, if the truths are classes.
    pub confusion: Option<Confusion>,
    /// The number of rows for which no rule fires; they are predicted as the mean of the rows in other folds.
    pub without_value: usize,
}

/// For each fold in turn, identifies a model on the other rows, including its structure, and predicts the fold.
/// `watch` is called with the index of each fold; on `Break` there is no result.
///
/// # Errors
/// As [`identify`].
pub fn cross_validate(
    names: &[String],
    output: &str,
    data: &Data,
    settings: &Identification,
    folds: u32,
    watch: &mut dyn FnMut(u32) -> ControlFlow<()>,
) -> Result<Option<IdentifyValidation>, TuneError> {
    data.check_columns(names.len(), crate::Loss::Squared)?;
    let data = &*data.weighted();
    // These folds differ from the folds for choosing steps.
    let folds = Folds::new(data, folds, settings.seed.wrapping_add(1));
    let mut predictions = [const { Vec::new() }; 3].map(|_: Vec<f64>| vec![f64::NAN; data.len()]);
    let mut without_value = 0;
    for fold in 0..folds.count {
        if watch(fold as u32).is_break() {
            return Ok(None);
        }
        let [known, left_out] = folds.split(data, fold);
        if known.is_empty() || left_out.is_empty() {
            continue;
        }
        let mean = mean(&known);
        let linear = line(&known, &left_out);
        let values = match identify(names, output, &known, settings) {
            Ok(identified) => {
                let engine = Engine::new(&identified.model)?;
                let columns: Vec<&[f64]> = identified
                    .columns
                    .iter()
                    .map(|column| left_out.inputs[*column].as_slice())
                    .collect();
                let outcomes = engine.evaluate_batch(&columns)?;
                outcomes.iter().map(|outcome| outcome.value()).collect()
            }
            Err(TuneError::NoInputHelps) => vec![Some(mean); left_out.len()],
            Err(error) => return Err(error),
        };
        without_value += values.iter().filter(|value| value.is_none()).count();
        let rows = (0..data.len()).filter(|row| folds.of(data, *row) == fold);
        for ((row, linear), value) in rows.zip(linear).zip(values) {
            predictions[0][row] = mean;
            predictions[1][row] = linear;
            predictions[2][row] = value.unwrap_or(mean);
        }
    }
    let count = folds.count;
    let error = |predictions: &[f64], data: &Data| {
        let rows = (0..data.len()).filter(|row| predictions[*row].is_finite());
        let (squares, weights) = rows.fold((0.0, 0.0), |(squares, weights), row| {
            let error = predictions[row] - data.truths[row];
            let weight = data.weight(row);
            (squares + weight * error * error, weights + weight)
        });
        (squares / weights).sqrt()
    };
    let figures = |data: &Data| {
        let [mean, linear, identified] = predictions.each_ref().map(|all| error(all, data));
        [mean, linear, identified, identified / linear]
    };
    let [mean, linear, identified, ratio] = folds.intervals(data, figures);
    Ok(Some(IdentifyValidation {
        folds: count,
        mean,
        linear,
        identified,
        ratio,
        confusion: confusion(&predictions[2], data),
        without_value,
    }))
}

/// Predicts rows by a linear regression on other rows. The regression is computed by fitting one rule that always
/// fires.
fn line(known: &Data, rows: &Data) -> Vec<f64> {
    let varies = |input: &usize| {
        let (low, high) = range(&known.inputs[*input]);
        low < high
    };
    let inputs = (0..known.inputs.len()).filter(varies);
    let everywhere = |input: usize| Axis {
        input,
        peaks: vec![0.0],
    };
    let structure = Structure::Grid(inputs.map(everywhere).collect());
    let fit = Fit {
        structure: &structure,
        consequents: Consequents::Lines,
        kept: &[true],
        ridge: 1e-9,
    };
    let numbers = fit.numbers(known).remove(0);
    let inputs = structure.inputs();
    let predict = |row: usize| {
        let terms = inputs.iter().zip(&numbers);
        let sum: f64 = terms
            .map(|(input, slope)| slope * rows.inputs[*input][row])
            .sum();
        sum + numbers[inputs.len()]
    };
    (0..rows.len()).map(predict).collect()
}
