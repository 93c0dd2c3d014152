//! What identification is worth on rows that were left out of all of it.

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

/// Root mean squares of errors on rows left out, in the unit of the output.
#[derive(Debug, Clone, PartialEq)]
pub struct Judged {
    /// Into how many parts the rows were divided.
    pub folds: usize,
    /// Of the mean of the other rows.
    pub mean: Interval,
    /// Of a line over all inputs, by least squares.
    pub linear: Interval,
    /// Of the models identified on the other parts.
    pub identified: Interval,
    /// The last divided by that of the line.
    pub ratio: Interval,
    /// What the identified models predicted for rows left out of each class, if the truths are classes.
    pub confusion: Option<Confusion>,
    /// The rows for which no rule fires; the mean of the other rows stands for them.
    pub without_value: usize,
}

/// Identifies a model without a part of the rows and predicts that part, for each part in turn. The structure is searched for anew
/// each time. `watch` is called with each part, counted from 0; with `Break` there is no result.
///
/// # Errors
/// As [`identify`].
pub fn judge(
    names: &[String],
    output: &str,
    data: &Data,
    settings: &Identification,
    folds: u32,
    watch: &mut dyn FnMut(u32) -> ControlFlow<()>,
) -> Result<Option<Judged>, TuneError> {
    data.check_columns(names.len(), crate::Loss::Squared)?;
    let data = &*data.weighted();
    // Other parts than those that steps are chosen by.
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
    Ok(Some(Judged {
        folds: count,
        mean,
        linear,
        identified,
        ratio,
        confusion: confusion(&predictions[2], data),
        without_value,
    }))
}

/// Predictions of rows by the line through others: one rule that always fires.
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
