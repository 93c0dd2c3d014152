//! Rules and numbers from rows: `flagred.learn` and `flagred.tune`.

use std::{
    ops::ControlFlow,
    sync::{
        Arc,
        atomic::{AtomicBool, Ordering},
    },
};

use flagred::{
    gap::GapSettings,
    learning::{self, Row},
};
use fuzzy::{
    Engine, Findings, Model,
    check::{self, Monotone, counterexamples},
    learn::{self, Learner, Resolution},
    yaml,
};
use numpy::PyReadonlyArray1;
use pyo3::prelude::*;
use tuning::{Data, Loss, TuneError, cross_validate};

use crate::{
    errors::{data_error, rule_set_error},
    rule_set::RuleSet,
    threads::{interruptible, pool},
};

/// The most refused rows that a message shows.
const SHOWN: usize = 20;

/// Rows as Python gives them.
#[derive(FromPyObject)]
#[pyo3(from_item_all)]
pub(crate) struct Rows<'py> {
    /// A column for each input, then the output.
    columns: Vec<PyReadonlyArray1<'py, f64>>,
    weights: Option<PyReadonlyArray1<'py, f64>>,
    groups: Option<PyReadonlyArray1<'py, u32>>,
    skip_bad_rows: bool,
}

#[derive(FromPyObject)]
#[pyo3(from_item_all)]
pub(crate) struct LearnOptions {
    resolve: String,
    min_support: u64,
    min_degree: f64,
    complete: bool,
    rising: Vec<String>,
    falling: Vec<String>,
    keep_rules: bool,
    validation: bool,
}

/// What `flagred.Learned` is made of.
#[derive(IntoPyObject)]
pub(crate) struct Learned {
    model: String,
    rows: u64,
    refused: Vec<String>,
    rules: usize,
    conflicts: u64,
    missing: u64,
    left_out: u64,
    completed: u64,
    moved: u64,
    counterexamples: Vec<String>,
    validation: Option<Errors>,
}

#[derive(IntoPyObject)]
struct Errors {
    rows: usize,
    without_prediction: usize,
    rmse: f64,
    mean_absolute: f64,
    bias: f64,
}

#[derive(FromPyObject)]
#[pyo3(from_item_all)]
pub(crate) struct TuneOptions {
    loss: String,
    only: Vec<String>,
    fix: Vec<String>,
    weights: bool,
    least_distance: f64,
    rising: Vec<String>,
    falling: Vec<String>,
    digits: Option<u32>,
    starts: u32,
    iterations: u32,
    seed: u64,
    folds: Option<u32>,
    threads: Option<usize>,
}

/// What `flagred.Tuned` is made of.
#[derive(IntoPyObject)]
pub(crate) struct Tuned {
    model: String,
    rows: usize,
    refused: Vec<String>,
    before: f64,
    after: f64,
    without_value: usize,
    moved: Vec<(String, String, f64, f64)>,
    validation: Option<Validation>,
}

/// Each figure with its interval.
#[derive(IntoPyObject)]
struct Validation {
    folds: usize,
    before: (f64, f64, f64),
    after: (f64, f64, f64),
    gain: (f64, f64, f64),
}

/// Why there is no result.
enum Failed {
    Refused(Vec<String>),
    Data(String),
    Findings(Findings),
}

impl Failed {
    fn data(error: impl std::fmt::Display) -> Failed {
        Failed::Data(error.to_string())
    }

    fn raise(self, py: Python<'_>) -> PyErr {
        match self {
            Failed::Data(message) => data_error(message, None),
            Failed::Findings(findings) => rule_set_error(py, &findings, "<model>", ""),
            Failed::Refused(refused) => {
                let plural = if refused.len() == 1 { "" } else { "s" };
                let mut message = format!("{} row{plural} cannot be used", refused.len());
                for row in refused.iter().take(SHOWN) {
                    message += &format!("\n  {row}");
                }
                if refused.len() > SHOWN {
                    message += &format!("\n  and {} more", refused.len() - SHOWN);
                }
                let help = "correct these rows, or leave them out with `skip_bad_rows=True`";
                data_error(message, Some(help.into()))
            }
        }
    }
}

impl From<TuneError> for Failed {
    fn from(error: TuneError) -> Failed {
        match error {
            TuneError::Compile(findings) => Failed::Findings(findings),
            error => Failed::data(error),
        }
    }
}

impl Rows<'_> {
    fn rows(&self) -> Vec<Row> {
        let columns: Vec<_> = self.columns.iter().map(|c| c.as_array()).collect();
        let weights = self.weights.as_ref().map(|weights| weights.as_array());
        let groups = self.groups.as_ref().map(|groups| groups.as_array());
        let row = |row: usize| Row {
            values: columns.iter().map(|column| column[row]).collect(),
            weight: weights.map_or(1.0, |weights| weights[row]),
            group: groups.map(|groups| groups[row]),
        };
        (0..columns.first().map_or(0, |column| column.len()))
            .map(row)
            .collect()
    }
}

/// The claims that `rising` and `falling` make.
fn claims(rising: &[String], falling: &[String]) -> Vec<Monotone> {
    let claim = |input: &String, direction| Monotone {
        input: input.clone(),
        direction,
        output: None,
    };
    let rising = rising.iter();
    let rising = rising.map(|input| claim(input, check::Direction::Increasing));
    let falling = falling.iter();
    rising
        .chain(falling.map(|input| claim(input, check::Direction::Decreasing)))
        .collect()
}

impl LearnOptions {
    fn settings(&self) -> PyResult<learn::Settings> {
        let directed = |names: &[String], direction| {
            let names = names.iter().cloned();
            names.map(move |name| (name, direction)).collect::<Vec<_>>()
        };
        let mut monotone = directed(&self.rising, learn::Direction::Rising);
        monotone.extend(directed(&self.falling, learn::Direction::Falling));
        Ok(learn::Settings {
            resolution: match self.resolve.as_str() {
                "strongest" => Resolution::Strongest,
                "heaviest" => Resolution::Heaviest,
                "mean" => Resolution::Mean,
                other => {
                    return Err(data_error(
                        format!("`resolve` is `{other}`"),
                        Some("write `strongest`, `heaviest` or `mean`".into()),
                    ));
                }
            },
            min_support: self.min_support,
            min_degree: self.min_degree,
            complete: self.complete,
            monotone,
        })
    }
}

impl TuneOptions {
    fn settings(&self) -> PyResult<tuning::Settings> {
        Ok(tuning::Settings {
            loss: match self.loss.as_str() {
                "squared" => Loss::Squared,
                "log" => Loss::Log,
                "ranking" => Loss::Ranking,
                other => {
                    return Err(data_error(
                        format!("`loss` is `{other}`"),
                        Some("write `squared`, `log` or `ranking`".into()),
                    ));
                }
            },
            only: self.only.clone(),
            fix: self.fix.clone(),
            weights: self.weights,
            least_distance: self.least_distance,
            monotone: claims(&self.rising, &self.falling),
            digits: self.digits,
            starts: self.starts,
            seed: self.seed,
            iterations: self.iterations,
        })
    }
}

/// Rules from rows.
#[pyfunction]
pub(crate) fn _learn(
    py: Python<'_>,
    rule_set: &RuleSet,
    rows: Rows<'_>,
    options: LearnOptions,
) -> PyResult<Learned> {
    let settings = options.settings()?;
    let model = rule_set.model(Model::clone);
    let (all, skip) = (rows.rows(), rows.skip_bad_rows);
    let learned = interruptible(py, move || {
        learn_rules(model, all, skip, settings, &options)
    })?;
    learned.map_err(|failed| failed.raise(py))
}

fn learn_rules(
    mut model: Model,
    all: Vec<Row>,
    skip_bad_rows: bool,
    settings: learn::Settings,
    options: &LearnOptions,
) -> Result<Learned, Failed> {
    if !options.keep_rules {
        model.rules.clear();
    }
    let mut learner = Learner::new(&model, settings.clone()).map_err(Failed::data)?;
    let (mut rows, mut refused) = (Vec::with_capacity(all.len()), Vec::new());
    for (place, row) in all.into_iter().enumerate() {
        match learner.add(&row.values, row.weight) {
            Ok(()) => rows.push(row),
            Err(refusal) => refused.push(format!("row {place}: {refusal}")),
        }
    }
    if !refused.is_empty() && !skip_bad_rows {
        return Err(Failed::Refused(refused));
    }
    if rows.is_empty() {
        return Err(Failed::Data("there are no rows to learn from".into()));
    }
    let validation = match options.validation {
        true => {
            let gap = GapSettings::default();
            let errors = learning::cross_validate(&model, &settings, &gap, &rows);
            Some(errors.map_err(Failed::data)?)
        }
        false => None,
    };
    let learned = learner.finish();
    let claims = claims(&options.rising, &options.falling);
    let broken = match claims.is_empty() || learned.model.rules.is_empty() {
        true => Vec::new(),
        false => {
            let engine = Engine::new(&learned.model).map_err(Failed::Findings)?;
            counterexamples(&engine, &claims).map_err(Failed::data)?
        }
    };
    Ok(Learned {
        rows: learned.samples,
        refused,
        rules: learned.model.rules.len() - model.rules.len(),
        conflicts: learned.conflicts,
        missing: learned.missing,
        left_out: learned.left_out,
        completed: learned.completed,
        moved: learned.moved,
        counterexamples: broken.iter().map(ToString::to_string).collect(),
        validation: validation.map(|errors| Errors {
            rows: errors.rows,
            without_prediction: errors.without_prediction,
            rmse: errors.rmse,
            mean_absolute: errors.mean_absolute,
            bias: errors.bias,
        }),
        model: yaml::to_string(&learned.model),
    })
}

/// Numbers from rows. Ctrl-C ends the search before its next step.
#[pyfunction]
pub(crate) fn _tune(
    py: Python<'_>,
    rule_set: &RuleSet,
    rows: Rows<'_>,
    options: TuneOptions,
) -> PyResult<Tuned> {
    rule_set.compile(py)?;
    let settings = options.settings()?;
    let model = rule_set.model(Model::clone);
    let (all, skip) = (rows.rows(), rows.skip_bad_rows);
    let pool = pool(options.threads)?;
    let stop = Arc::new(AtomicBool::new(false));
    let is_stopped = Arc::clone(&stop);
    let tuned = interruptible(py, move || {
        pool.install(|| tune_numbers(&model, all, skip, &settings, options.folds, &is_stopped))
    });
    stop.store(true, Ordering::Relaxed);
    tuned?.map_err(|failed| failed.raise(py))
}

fn tune_numbers(
    model: &Model,
    all: Vec<Row>,
    skip_bad_rows: bool,
    settings: &tuning::Settings,
    folds: Option<u32>,
    stop: &AtomicBool,
) -> Result<Tuned, Failed> {
    let (data, refused) = data(model, all, settings.loss);
    if !refused.is_empty() && !skip_bad_rows {
        return Err(Failed::Refused(refused));
    }
    let flow = || match stop.load(Ordering::Relaxed) {
        true => ControlFlow::Break(()),
        false => ControlFlow::Continue(()),
    };
    let tuned = tuning::tune(model, &data, settings, &mut |_| flow())?;
    let validation = match folds {
        Some(folds) => cross_validate(model, &data, settings, folds, &mut |_, _| flow())?,
        None => None,
    };
    let interval = |figure: tuning::Interval| (figure.value, figure.low, figure.high);
    let moved = tuned.moved.into_iter();
    Ok(Tuned {
        model: yaml::to_string(&tuned.model),
        rows: data.len(),
        refused,
        before: tuned.before,
        after: tuned.after,
        without_value: tuned.without_value,
        moved: moved
            .map(|one| (one.of, one.name, one.before, one.after))
            .collect(),
        validation: validation.map(|validation| Validation {
            folds: validation.folds,
            before: interval(validation.before),
            after: interval(validation.after),
            gain: interval(validation.gain),
        }),
    })
}

/// The rows that can be used, as columns, and why others cannot.
fn data(model: &Model, rows: Vec<Row>, loss: Loss) -> (Data, Vec<String>) {
    let mut data = Data {
        inputs: vec![Vec::with_capacity(rows.len()); model.inputs.len()],
        ..Data::default()
    };
    let mut refused = Vec::new();
    for (place, row) in rows.into_iter().enumerate() {
        let truth = row.values.last().copied().unwrap_or(f64::NAN);
        let wrong = if row.values.iter().any(|value| !value.is_finite()) {
            "a value is not a finite number"
        } else if loss != Loss::Squared && truth != 0.0 && truth != 1.0 {
            "the output's value must be 0 or 1 for this loss"
        } else if !(row.weight >= 0.0 && row.weight.is_finite()) {
            "the weight is not a number from 0"
        } else {
            for (column, value) in data.inputs.iter_mut().zip(&row.values) {
                column.push(*value);
            }
            data.truths.push(truth);
            data.weights.push(row.weight);
            data.groups.extend(row.group);
            continue;
        };
        refused.push(format!("row {place}: {wrong}"));
    }
    (data, refused)
}
