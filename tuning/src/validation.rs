//! What tuning is worth on rows that were left out.

use std::{collections::BTreeSet, ops::ControlFlow};

use fuzzy::Model;

use crate::{
    Data, Progress, Settings, TuneError, loss, objective::Objective, parameters::Parameters, tune,
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

/// A figure, and the interval that holds 95 % of the figures of resampled groups (of rows where there are no groups).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Interval {
    /// The figure of all rows.
    pub value: f64,
    /// 2.5 % of the resampled figures are below.
    pub low: f64,
    /// 2.5 % of the resampled figures are above.
    pub high: f64,
}

/// How often the groups are resampled.
const RESAMPLES: usize = 400;

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
    let group_of = |row: usize| match data.groups.get(row) {
        Some(group) => *group as usize,
        None => row,
    };
    let groups: BTreeSet<usize> = (0..data.len()).map(group_of).collect();
    let mut groups: Vec<usize> = groups.into_iter().collect();
    let mut random = fastrand::Rng::with_seed(settings.seed);
    random.shuffle(&mut groups);
    let folds = (folds.max(2) as usize).min(groups.len());
    let mut fold_of = vec![0; groups.iter().max().map_or(0, |last| last + 1)];
    for (i, group) in groups.iter().enumerate() {
        fold_of[*group] = i % folds;
    }
    let mut after = vec![f64::NAN; data.len()];
    for fold in 0..folds {
        let is_left_out = |row: usize| fold_of[group_of(row)] == fold;
        let known = data.filtered(|row| !is_left_out(row));
        let left_out = data.filtered(is_left_out);
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
        let rows = (0..data.len()).filter(|row| is_left_out(*row));
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
    let mut resampled = [const { Vec::new() }; 3];
    for _ in 0..RESAMPLES {
        let mut counts = vec![0.0; fold_of.len()];
        for _ in 0..groups.len() {
            counts[groups[random.usize(..groups.len())]] += 1.0;
        }
        let weights = (0..data.len()).map(|row| data.weight(row) * counts[group_of(row)]);
        let sample = Data {
            weights: weights.collect(),
            truths: data.truths.clone(),
            ..Data::default()
        };
        for (all, figure) in resampled.iter_mut().zip(figures(&sample)) {
            if figure.is_finite() {
                all.push(figure);
            }
        }
    }
    let mut values = figures(data).into_iter();
    let [before, after, gain] =
        resampled.map(|all| interval(values.next().unwrap_or(f64::NAN), all));
    Ok(Some(Validation {
        folds,
        before,
        after,
        gain,
    }))
}

fn interval(value: f64, mut resampled: Vec<f64>) -> Interval {
    resampled.sort_by(f64::total_cmp);
    let at = |share: f64| {
        let last = resampled.len().saturating_sub(1) as f64;
        resampled
            .get((share * last).round() as usize)
            .copied()
            .unwrap_or(f64::NAN)
    };
    Interval {
        value,
        low: at(0.025),
        high: at(0.975),
    }
}
