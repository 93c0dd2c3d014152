//! Tuning of the numbers of a rule set on rows: `flagred.tune`.

use std::{
    ops::ControlFlow,
    sync::{
        Arc,
        atomic::{AtomicBool, Ordering},
    },
};

use flagred_evaluation::learning::Row;
use flagred_tuning::{Data, Loss, Settings, TuneError, cross_validate};
use fuzzy::{
    Model,
    drawing::short,
    model::{LossChange, ProvenanceStep},
};
use pyo3::prelude::*;

use crate::{
    rows::{DerivationError, RowArguments, choice, claims, with_step},
    rule_set::RuleSet,
    threads::{count, pool, stoppable},
};

#[derive(FromPyObject)]
#[pyo3(from_item_all)]
pub(crate) struct TuneOptions {
    loss: String,
    only: Vec<String>,
    fix: Vec<String>,
    weights: bool,
    min_distance: f64,
    rising: Vec<String>,
    falling: Vec<String>,
    beyond_range: bool,
    digits: Option<u32>,
    starts: u32,
    iterations: u32,
    seed: u64,
    folds: Option<u32>,
}

/// The result inside `flagred.types.TuneResult`.
#[derive(IntoPyObject)]
pub(crate) struct TuneResult {
    model: String,
    rows: usize,
    refused: Vec<String>,
    before: f64,
    after: f64,
    without_value: usize,
    moved: Vec<(String, String, f64, f64)>,
    at_bounds: Vec<String>,
    validation: Option<Validation>,
}

/// The figures of the cross-validation, each with its interval.
#[derive(IntoPyObject)]
struct Validation {
    folds: usize,
    before: (f64, f64, f64),
    after: (f64, f64, f64),
    gain: (f64, f64, f64),
}

impl From<TuneError> for DerivationError {
    fn from(error: TuneError) -> DerivationError {
        match error {
            TuneError::Compile(findings) => DerivationError::Findings(findings),
            error => DerivationError::data(error),
        }
    }
}

impl TuneOptions {
    fn settings(&self) -> PyResult<Settings> {
        let losses = [
            ("squared", Loss::Squared),
            ("log", Loss::Log),
            ("ranking", Loss::Ranking),
        ];
        let mut settings = Settings::default();
        settings.loss = choice("loss", &self.loss, &losses)?;
        settings.only = self.only.clone();
        settings.fix = self.fix.clone();
        settings.weights = self.weights;
        settings.min_distance = self.min_distance;
        settings.monotone = claims(&self.rising, &self.falling);
        settings.beyond_range = self.beyond_range;
        settings.digits = self.digits;
        settings.starts = self.starts;
        settings.seed = self.seed;
        settings.iterations = self.iterations;
        Ok(settings)
    }
}

/// Tunes the numbers of a rule set on rows. Also returns whether Ctrl-C ended the search early.
#[pyfunction]
#[pyo3(signature = (rule_set, rows, options, threads))]
pub(crate) fn _tune(
    py: Python<'_>,
    rule_set: &RuleSet,
    rows: RowArguments<'_>,
    options: TuneOptions,
    #[pyo3(from_py_with = count)] threads: Option<usize>,
) -> PyResult<(TuneResult, bool)> {
    rule_set.compile(py)?;
    let settings = options.settings()?;
    let (model, text) = (rule_set.model(Model::clone), rule_set.text());
    let (all, skip) = (rows.rows(), rows.skip_bad_rows);
    let pool = pool(threads)?;
    let stop = Arc::new(AtomicBool::new(false));
    let is_stopped = Arc::clone(&stop);
    let (tuned, was_interrupted) = stoppable(py, &stop, move || {
        pool.install(|| {
            tune_numbers(
                (&text, &model),
                all,
                skip,
                &settings,
                options.folds,
                &is_stopped,
            )
        })
    })?;
    let tuned = tuned.map_err(|failed| failed.raise(py))?;
    Ok((tuned, was_interrupted))
}

fn tune_numbers(
    (text, model): (&str, &Model),
    all: Vec<Row>,
    skip_bad_rows: bool,
    settings: &Settings,
    folds: Option<u32>,
    stop: &AtomicBool,
) -> Result<TuneResult, DerivationError> {
    let (data, refused) = data(model, all, settings.loss);
    if !refused.is_empty() && !skip_bad_rows {
        return Err(DerivationError::Refused(refused));
    }
    let flow = || match stop.load(Ordering::Relaxed) {
        true => ControlFlow::Break(()),
        false => ControlFlow::Continue(()),
    };
    let tuned = flagred_tuning::tune(model, &data, settings, &mut |_| flow())?;
    let validation = match folds {
        Some(folds) => cross_validate(model, &data, settings, folds, &mut |_, _| flow())?,
        None => None,
    };
    let loss = match settings.loss {
        Loss::Squared => "RMS error",
        Loss::Log => "log loss",
        Loss::Ranking => "wrong pairs",
    };
    let left_out = validation.as_ref().map(|validation| {
        let [before, after] = [&validation.before, &validation.after].map(|f| short(f.value));
        let folds = validation.folds;
        format!("cross-validation in {folds} folds: {before} before, {after} after")
    });
    let moved = |one: &flagred_tuning::ChangedNumber| {
        let [before, after] = [one.before, one.after].map(short);
        format!("{} {} from {before} to {after}", one.of, one.name)
    };
    let step = ProvenanceStep {
        command: "flagred.tune".into(),
        rows: Some(data.len() as u64),
        seed: Some(settings.seed),
        loss: Some(LossChange {
            name: loss.into(),
            before: rounded(tuned.before),
            after: rounded(tuned.after),
        }),
        moved: tuned.moved.iter().map(moved).collect(),
        note: left_out,
        ..ProvenanceStep::default()
    };
    let interval = |figure: flagred_tuning::Interval| (figure.value, figure.low, figure.high);
    let moved = tuned.moved.into_iter();
    Ok(TuneResult {
        model: with_step(text, &tuned.model, step)?,
        rows: data.len(),
        refused,
        before: tuned.before,
        after: tuned.after,
        without_value: tuned.without_value,
        moved: moved
            .map(|one| (one.of, one.name, one.before, one.after))
            .collect(),
        at_bounds: tuned.at_bounds,
        validation: validation.map(|validation| Validation {
            folds: validation.folds,
            before: interval(validation.before),
            after: interval(validation.after),
            gain: interval(validation.gain),
        }),
    })
}

/// Rounds a loss to six significant digits for display.
fn rounded(loss: f64) -> f64 {
    format!("{loss:.5e}").parse().unwrap_or(loss)
}

/// Returns the usable rows as columns, and for each of the other rows the reason why it is not usable.
fn data(model: &Model, rows: Vec<Row>, loss: Loss) -> (Data, Vec<String>) {
    let mut data = Data {
        inputs: vec![Vec::with_capacity(rows.len()); model.inputs.len()],
        ..Data::default()
    };
    let mut refused = Vec::new();
    for (place, row) in rows.into_iter().enumerate() {
        if let Some(problem) = Data::problem(&row.values, row.weight, loss) {
            refused.push(format!("row {place}: {problem}"));
            continue;
        }
        for (column, value) in data.inputs.iter_mut().zip(&row.values) {
            column.push(*value);
        }
        data.truths.extend(row.values.last());
        data.weights.push(row.weight);
        data.groups.extend(row.group);
    }
    (data, refused)
}
