//! What tuning is worth on rows that were left out.

use std::ops::ControlFlow;

use fuzzy::Model;

use crate::{
    Data, Interval, Progress, Settings, TuneError, folds::Folds, loss, objective::Objective,
    parameters::Parameters, tune,
};

/// What tuning is worth on rows that the tuned model does not know.
#[derive(Debug, Clone, PartialEq)]
pub struct Validation {
    /// Into how many parts the rows were divided.
    pub folds: usize,
    /// The loss of the model as it is; see [`crate::Loss`].
    pub before: Interval,
    /// The loss where each part is predicted by the model tuned on the others.
    pub after: Interval,
    /// How much lower the second is than the first.
    pub gain: Interval,
}

/// Tunes without a part of the rows and predicts that part, for each part in turn. Rows of a group stay together.
///
/// `watch` is called as by [`tune`], with the part, counted from 0; with `Break` there is no result.
///
/// # Errors
/// As [`tune`].
pub fn cross_validate(
    model: &Model,
    data: &Data,
    settings: &Settings,
    folds: u32,
    watch: &mut dyn FnMut(u32, &Progress<'_>) -> ControlFlow<()>,
) -> Result<Option<Validation>, TuneError> {
    data.check(model, settings.loss)?;
    let parameters = Parameters::new(model, settings)?;
    let whole = Objective::new(model, &parameters, data, settings);
    let before = whole.point(model.clone())?.predictions;
    let folds = Folds::new(data, folds, settings.seed);
    let count = folds.count;
    let mut after = vec![f64::NAN; data.len()];
    for fold in 0..count {
        let [known, left_out] = folds.split(data, fold);
        if known.is_empty() || left_out.is_empty() {
            continue;
        }
        let mut told = |progress: &Progress<'_>| watch(fold as u32, progress);
        let tuned = tune(model, &known, settings, &mut told)?;
        if tuned.is_stopped {
            return Ok(None);
        }
        let judged = Objective::new(model, &parameters, &left_out, settings);
        let mut predictions = judged.point(tuned.model)?.predictions.into_iter();
        let rows = (0..data.len()).filter(|row| folds.of(data, *row) == fold);
        for (row, prediction) in rows.zip(&mut predictions) {
            after[row] = prediction;
        }
    }
    let measure = |predictions: &[f64], data: &Data| {
        loss::measure(
            settings.loss,
            predictions,
            whole.truths(),
            data,
            whole.width(),
        )
    };
    let figures = |data: &Data| {
        let [before, after] = [&before, &after].map(|predictions| measure(predictions, data));
        [before, after, before - after]
    };
    let [before, after, gain] = folds.intervals(data, figures);
    Ok(Some(Validation {
        folds: count,
        before,
        after,
        gain,
    }))
}
