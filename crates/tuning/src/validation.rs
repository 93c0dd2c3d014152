//! Cross-validation of tuning.

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

/// The cross-validation of tuning: losses on rows that the tuned model has not seen.
#[derive(Debug, Clone, PartialEq)]
pub struct Validation {
    /// The number of folds.
    pub folds: usize,
    /// The loss of the original model; see [`crate::Loss`].
    pub before: Interval,
    /// The loss when each fold is predicted by a model tuned on the other folds.
    pub after: Interval,
    /// The reduction of the loss.
    pub gain: Interval,
    /// If the truths are 0 and 1: the mean prediction and the observed share of ones in each tenth of the range.
    pub reliability: Vec<Bin>,
    /// The confusion matrix of the cross-validation, if the truths are classes and the loss is not
    /// a ranking.
    pub confusion: Option<Confusion>,
}

/// For each fold in turn, tunes on the other rows and predicts the fold. Rows of a group stay together.
///
/// `watch` is called as in [`tune`], but also receives the index of the fold; on `Break` there is no result.
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
    let Some(after) = predict_folds(model, data, settings, &folds, EIGHTHS, watch)? else {
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

/// A point of a learning curve: the loss on unseen rows, for models tuned on only a share of the other rows.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct CurvePoint {
    /// The share of the other rows, or of their groups, that is used for tuning.
    pub share: f64,
    /// The loss on unseen rows; see [`crate::Loss`].
    pub unseen_loss: f64,
}

/// The number of parts into which the known rows are divided for a learning curve.
const EIGHTHS: usize = 8;

/// Computes the loss of [`cross_validate`] with models tuned on an eighth, a quarter and half of the rows outside the
/// fold. The last point, for all of these rows, is taken from `validation`, the result of [`cross_validate`] with the same
/// arguments. If the curve still falls at its end, more rows would help.
///
/// # Errors
/// As [`tune`].
pub fn learning_curve(
    model: &Model,
    data: &Data,
    settings: &Settings,
    folds: u32,
    validation: &Validation,
    watch: &mut dyn FnMut(u32, &Progress<'_>) -> ControlFlow<()>,
) -> Result<Option<Vec<CurvePoint>>, TuneError> {
    data.check(model, settings.loss)?;
    let data = &*data.weighted();
    let parameters = Parameters::new(model, settings)?;
    let whole = Objective::new(model, &parameters, data, settings);
    let folds = Folds::new(data, folds, settings.seed);
    let mut curve = Vec::new();
    for eighths in [1, 2, 4] {
        let Some(predictions) = predict_folds(model, data, settings, &folds, eighths, watch)?
        else {
            return Ok(None);
        };
        curve.push(CurvePoint {
            share: eighths as f64 / EIGHTHS as f64,
            unseen_loss: whole.measure_of(&predictions, data),
        });
    }
    curve.push(CurvePoint {
        share: 1.0,
        unseen_loss: validation.after.value,
    });
    Ok(Some(curve))
}

/// Predicts the rows of each fold by a model tuned on `eighths` eighths of the other rows; `None` if `watch` ended the
/// search.
fn predict_folds(
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
        let mut reported = |progress: &Progress<'_>| watch(fold as u32, progress);
        let tuned = match tune(model, &known, settings, &mut reported) {
            // If only a part of the rows is used, they may all have the same truth; the model is then not tuned.
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
