//! Learning of rules from rows: `flagred.learn`.

use flagred::gap::GapSettings;
use flagred_evaluation::learning::{self, Row};
use fuzzy::{
    Engine, Model,
    check::counterexamples,
    learn::{Direction, LastStage, LearnError, Learner, Resolution, Settings},
    model::ProvenanceStep,
};
use pyo3::prelude::*;

use crate::{
    rows::{DerivationError, RowArguments, choice, claims, directed, with_step},
    rule_set::RuleSet,
    threads::interruptible,
};

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

/// The result inside `flagred.types.LearnResult`.
#[derive(IntoPyObject)]
pub(crate) struct LearnResult {
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

impl LearnOptions {
    fn settings(&self) -> PyResult<Settings> {
        let directions = [Direction::Rising, Direction::Falling];
        let resolutions = [
            ("strongest", Resolution::Strongest),
            ("heaviest", Resolution::Heaviest),
            ("mean", Resolution::Mean),
        ];
        let mut settings = Settings::default();
        settings.resolution = choice("resolve", &self.resolve, &resolutions)?;
        settings.min_support = self.min_support;
        settings.min_degree = self.min_degree;
        settings.complete = self.complete;
        settings.monotone = directed(&self.rising, &self.falling, directions);
        Ok(settings)
    }
}

/// Learns rules from rows.
#[pyfunction]
pub(crate) fn _learn(
    py: Python<'_>,
    rule_set: &RuleSet,
    rows: RowArguments<'_>,
    options: LearnOptions,
) -> PyResult<LearnResult> {
    let settings = options.settings()?;
    let (model, text) = (rule_set.model(Model::clone), rule_set.text());
    let (all, skip) = (rows.rows(), rows.skip_bad_rows);
    let learned = interruptible(py, move || {
        learn_rules(model, &text, all, skip, settings, &options)
    })?;
    learned.map_err(|failed| failed.raise(py))
}

fn learn_rules(
    whole: Model,
    text: &str,
    all: Vec<Row>,
    skip_bad_rows: bool,
    settings: Settings,
    options: &LearnOptions,
) -> Result<LearnResult, DerivationError> {
    let wrong =
        |error: LearnError| DerivationError::Data(error.to_string(), Some(error.help().into()));
    let chain = LastStage::new(&whole).map_err(wrong)?;
    let mut model = chain.model().clone();
    if !options.keep_rules {
        model.rules.clear();
    }
    let mut learner = Learner::new(&model, settings.clone()).map_err(wrong)?;
    let (mut rows, mut refused) = (Vec::with_capacity(all.len()), Vec::new());
    for (place, row) in all.into_iter().enumerate() {
        let values = chain.values(&row.values);
        let added = values.and_then(|values| {
            learner.add(&values, row.weight)?;
            Ok(Row { values, ..row })
        });
        match added {
            Ok(row) => rows.push(row),
            Err(refusal) => refused.push(format!("row {place}: {refusal}")),
        }
    }
    if !refused.is_empty() && !skip_bad_rows {
        return Err(DerivationError::Refused(refused));
    }
    if rows.is_empty() {
        return Err(DerivationError::data("there are no rows to learn from"));
    }
    let validation = match options.validation {
        true => {
            let gap = GapSettings::default();
            let errors = learning::cross_validate(&model, &settings, &gap, &rows);
            Some(errors.map_err(DerivationError::data)?)
        }
        false => None,
    };
    let learned = learner.finish();
    let whole = chain.joined(&learned.model);
    let claims = claims(&options.rising, &options.falling);
    let broken = match claims.is_empty() || learned.model.rules.is_empty() {
        true => Vec::new(),
        false => {
            let engine = Engine::new(&whole).map_err(DerivationError::Findings)?;
            counterexamples(&engine, &claims).map_err(DerivationError::data)?
        }
    };
    let rules = learned.model.rules.len() - model.rules.len();
    let step = ProvenanceStep {
        command: "flagred.learn".into(),
        rows: Some(learned.samples),
        note: Some(format!(
            "{} resolution; {rules} rules learned, {} of them without samples",
            options.resolve, learned.completed,
        )),
        ..ProvenanceStep::default()
    };
    Ok(LearnResult {
        rows: learned.samples,
        refused,
        rules,
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
        model: with_step(text, &whole, step)?,
    })
}
