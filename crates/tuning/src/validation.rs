//! What tuning is worth on rows that were left out.

use std::ops::ControlFlow;

use fuzzy::Model;

use crate::{
    Confusion, Data, Interval, Loss, Progress, Settings, TuneError,
    confusion::confusion,
    folds::Folds,
    objective::Objective,
    parameters::Parameters,
    reliability::{Bin, reliability},
    tune,
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
    /// With truths of 0 and 1: what was predicted of rows left out, beside what came, by tenths of the range.
    pub reliability: Vec<Bin>,
    /// What was predicted for rows left out of each class, if the truths are classes and not a ranking.
    pub confusion: Option<Confusion>,
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
    let data = &*data.weighted();
    let parameters = Parameters::new(model, settings)?;
    let whole = Objective::new(model, &parameters, data, settings);
    let before = whole.point(model.clone())?.predictions;
    let folds = Folds::new(data, folds, settings.seed);
    let Some(after) = left_out(model, data, settings, &folds, EIGHTHS, watch)? else {
        return Ok(None);
    };
    let figures = |data: &Data| {
        let [before, after] =
            [&before, &after].map(|predictions| whole.measure_of(predictions, data));
        [before, after, before - after]
    };
    let count = folds.count;
    let [before, after_interval, gain] = folds.intervals(data, figures);
    Ok(Some(Validation {
        folds: count,
        before,
        after: after_interval,
        gain,
        confusion: match settings.loss {
            Loss::Ranking => None,
            Loss::Squared => confusion(&whole.values(&after), data),
            Loss::Log => confusion(&after, data),
        },
        reliability: match settings.loss {
            Loss::Squared => Vec::new(),
            _ => reliability(&after, data),
        },
    }))
}

/// The loss on rows left out of models that are tuned on few and on many of the others.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct CurvePoint {
    /// The share of the other rows, or of their groups, that a model is tuned on.
    pub share: f64,
    /// The loss on rows left out; see [`crate::Loss`].
    pub left_out: f64,
}

/// Into how many parts the known rows are divided for a learning curve.
const EIGHTHS: usize = 8;

/// [`cross_validate`] with an eighth, a quarter and half of the known rows; the point of all of them is what `worth`, the
/// cross-validation with the same arguments, says. Where the curve still falls, more rows would help.
///
/// # Errors
/// As [`tune`].
pub fn learning_curve(
    model: &Model,
    data: &Data,
    settings: &Settings,
    folds: u32,
    worth: &Validation,
    watch: &mut dyn FnMut(u32, &Progress<'_>) -> ControlFlow<()>,
) -> Result<Option<Vec<CurvePoint>>, TuneError> {
    data.check(model, settings.loss)?;
    let data = &*data.weighted();
    let parameters = Parameters::new(model, settings)?;
    let whole = Objective::new(model, &parameters, data, settings);
    let folds = Folds::new(data, folds, settings.seed);
    let mut curve = Vec::new();
    for eighths in [1, 2, 4] {
        let Some(predictions) = left_out(model, data, settings, &folds, eighths, watch)? else {
            return Ok(None);
        };
        curve.push(CurvePoint {
            share: eighths as f64 / EIGHTHS as f64,
            left_out: whole.measure_of(&predictions, data),
        });
    }
    curve.push(CurvePoint {
        share: 1.0,
        left_out: worth.after.value,
    });
    Ok(Some(curve))
}

/// Predictions of the rows of each part by a model that is tuned on so many eighths of the others; `None` where the watcher ended
/// it.
fn left_out(
    model: &Model,
    data: &Data,
    settings: &Settings,
    folds: &Folds,
    eighths: usize,
    watch: &mut dyn FnMut(u32, &Progress<'_>) -> ControlFlow<()>,
) -> Result<Option<Vec<f64>>, TuneError> {
    let parameters = Parameters::new(model, settings)?;
    let mut predictions = vec![f64::NAN; data.len()];
    for fold in 0..folds.count {
        let [mut known, left_out] = folds.split(data, fold);
        if eighths < EIGHTHS && !known.is_empty() {
            let parts = Folds::new(&known, EIGHTHS as u32, settings.seed);
            let most = (eighths * parts.count).div_ceil(EIGHTHS);
            known = known.filtered(|row| parts.of(&known, row) < most);
        }
        if known.is_empty() || left_out.is_empty() {
            continue;
        }
        let mut told = |progress: &Progress<'_>| watch(fold as u32, progress);
        let tuned = match tune(model, &known, settings, &mut told) {
            // A few rows may all have one truth: nothing is learned from them.
            Err(TuneError::OneClass) if eighths < EIGHTHS => model.clone(),
            tuned => {
                let tuned = tuned?;
                if tuned.is_stopped {
                    return Ok(None);
                }
                tuned.model
            }
        };
        let judged = Objective::new(model, &parameters, &left_out, settings);
        let values = judged.point(tuned)?.predictions;
        let rows = (0..data.len()).filter(|row| folds.of(data, *row) == fold);
        for (row, value) in rows.zip(values) {
            predictions[row] = value;
        }
    }
    Ok(Some(predictions))
}
