//! Rows of measured values: the error of a rule set on them, rules learned from them, and numbers tuned to them.

mod table;

use std::ops::ControlFlow;

use flagred_authoring::provenance;
use flagred_tuning::{Progress, Settings, tune};
use fuzzy::{
    Engine, Model,
    drawing::short,
    learn::{self, LastStage, Learner},
    model::{DataFile, LossChange, ProvenanceStep},
};
use js_sys::Function;
use serde::Serialize;
use wasm_bindgen::{JsError, JsValue, prelude::wasm_bindgen};

use crate::failure::failure;
use table::{Rows, Table};

/// The maximum number of rows with large errors that are listed.
const WORST: usize = 8;
/// Milliseconds between two reports of a search.
const REPORT_MS: f64 = 150.0;

/// A table with a row of measured values in each line.
#[wasm_bindgen(js_name = DataTable)]
pub struct DataTable {
    file: String,
    table: Table,
}

#[derive(Serialize)]
#[serde(rename_all = "camelCase")]
struct Errors<'a> {
    /// The name of the output that is compared.
    output: &'a str,
    unit: Option<&'a str>,
    rows: usize,
    /// The reasons why rows are not used, at most 20.
    refused: Vec<String>,
    refused_count: usize,
    /// The number of rows in which the rule set has no value.
    without_value: usize,
    /// The RMS error; `null` if no row has a value.
    rms: Option<f64>,
    /// The mean of computed minus measured value; `null` if no row has a value.
    mean: Option<f64>,
    largest: Option<f64>,
    /// The rows with the largest errors, the largest first.
    worst: Vec<WorstRow>,
}

#[derive(Serialize)]
struct WorstRow {
    line: u64,
    point: Vec<f64>,
    measured: f64,
    computed: f64,
}

#[derive(Serialize)]
#[serde(rename_all = "camelCase")]
struct FittedRules {
    text: String,
    /// A sentence that describes the result.
    words: String,
    /// The numbers that changed, or other details, one per line.
    details: Vec<String>,
}

#[wasm_bindgen(js_class = DataTable)]
impl DataTable {
    /// Reads a table in CSV: the first line names the columns.
    #[wasm_bindgen(constructor)]
    pub fn new(file: String, text: &str) -> Result<DataTable, JsError> {
        let table = Table::read(text)
            .map_err(|(message, help)| failure(format!("`{file}`: {message}"), Some(&help)))?;
        Ok(DataTable { file, table })
    }

    /// The errors of a rule set on the rows, as JSON.
    pub fn errors(&self, text: &str) -> Result<String, JsError> {
        let model = parsed(text)?;
        let rows = self.rows(&model)?;
        let engine = Engine::new(&model).map_err(|findings| failure(findings, None))?;
        let inputs = model.inputs.len();
        let columns: Vec<Vec<f64>> = (0..inputs)
            .map(|i| rows.values.iter().map(|row| row[i]).collect())
            .collect();
        let columns: Vec<&[f64]> = columns.iter().map(Vec::as_slice).collect();
        let outcomes = engine
            .evaluate_batch(&columns)
            .map_err(|error| failure(error, None))?;
        let target = model.measured_output().unwrap_or(0);
        let values = outcomes
            .iter()
            .skip(target)
            .step_by(model.outputs.len().max(1));
        let mut known: Vec<WorstRow> = Vec::new();
        for ((row, line), outcome) in rows.values.iter().zip(&rows.lines).zip(values) {
            if let (Some(computed), Some((measured, point))) = (outcome.value(), row.split_last()) {
                known.push(WorstRow {
                    line: *line,
                    point: point.to_vec(),
                    measured: *measured,
                    computed,
                });
            }
        }
        let error = |row: &WorstRow| row.computed - row.measured;
        let count = known.len() as f64;
        let mean = |of: &dyn Fn(f64) -> f64| {
            (count > 0.0).then(|| known.iter().map(|row| of(error(row))).sum::<f64>() / count)
        };
        let (rms, mean) = (
            mean(&|error| error * error).map(f64::sqrt),
            mean(&|error| error),
        );
        let without_value = rows.values.len() - known.len();
        known.sort_by(|a, b| {
            error(b)
                .abs()
                .total_cmp(&error(a).abs())
                .then(a.line.cmp(&b.line))
        });
        known.truncate(WORST);
        let output = model.outputs.get(target).map(|output| &output.variable);
        json(&Errors {
            output: output.map_or("", |output| output.name.as_str()),
            unit: output.and_then(|output| output.unit.as_deref()),
            rows: rows.values.len(),
            refused_count: rows.refused.len(),
            refused: rows.refused.into_iter().take(20).collect(),
            without_value,
            rms,
            mean,
            largest: known.first().map(|row| error(row).abs()),
            worst: known,
        })
    }

    /// Changes the numbers of a rule set to reduce its error on the rows, like `flagred tune`. Returns a JSON
    /// object with the new text. `watch` is called with the step, the error so far and the text so far.
    pub fn tune(&self, text: &str, watch: &Function) -> Result<String, JsError> {
        let model = parsed(text)?;
        let rows = self.usable(&model)?;
        let mut data = flagred_tuning::Data {
            inputs: vec![Vec::new(); model.inputs.len()],
            ..flagred_tuning::Data::default()
        };
        for row in &rows.values {
            for (column, value) in data.inputs.iter_mut().zip(row) {
                column.push(*value);
            }
            data.truths.extend(row.last());
        }
        let settings = Settings::default();
        let mut last = js_sys::Date::now();
        let mut first_loss = None;
        let mut step = |progress: &Progress<'_>| {
            let before = *first_loss.get_or_insert(progress.loss);
            let now = js_sys::Date::now();
            if now - last >= REPORT_MS {
                last = now;
                let so_far = self.tuned(
                    text,
                    progress.model,
                    rows.values.len(),
                    (before, progress.loss),
                    Vec::new(),
                );
                if let Ok(so_far) = so_far {
                    let arguments = (
                        progress.iteration.into(),
                        progress.loss.into(),
                        JsValue::from(so_far),
                    );
                    let _ = watch.call3(&JsValue::NULL, &arguments.0, &arguments.1, &arguments.2);
                }
            }
            ControlFlow::Continue(())
        };
        let tuned =
            tune(&model, &data, &settings, &mut step).map_err(|error| failure(error, None))?;
        let moved: Vec<String> = tuned
            .moved
            .iter()
            .map(|one| {
                format!(
                    "{} {} from {} to {}",
                    one.of,
                    one.name,
                    short(one.before),
                    short(one.after)
                )
            })
            .collect();
        let losses = (tuned.before, tuned.after);
        let text = self.tuned(text, &tuned.model, rows.values.len(), losses, moved.clone())?;
        let [before, after] = [tuned.before, tuned.after].map(short);
        json(&FittedRules {
            text,
            words: format!("RMS error {before} before, {after} after tuning"),
            details: moved,
        })
    }

    /// Replaces the rules of a rule set by rules learned from the rows, like `flagred learn`. Returns a JSON object
    /// with the new text. `complete` adds rules for combinations of terms without rows.
    pub fn learn(&self, text: &str, complete: bool) -> Result<String, JsError> {
        let whole = parsed(text)?;
        let refused = |error: learn::LearnError| failure(&error, Some(error.help()));
        let chain = LastStage::new(&whole).map_err(refused)?;
        let mut model = chain.model().clone();
        model.rules.clear();
        let mut settings = learn::Settings::default();
        settings.complete = complete;
        let mut learner = Learner::new(&model, settings).map_err(refused)?;
        let rows = self.usable(&whole)?;
        let mut outside = 0;
        for row in &rows.values {
            let added = chain
                .values(row)
                .and_then(|values| learner.add(&values, 1.0));
            outside += usize::from(added.is_err());
        }
        let learned = learner.finish();
        if learned.model.rules.is_empty() {
            let help = "the values of the rows must be within the ranges of the variables";
            return Err(failure("no rule could be learned", Some(help)));
        }
        let mut made = chain.joined(&learned.model);
        let round = |degree: f64| (degree * 1e6).round() / 1e6;
        for rule in &mut made.rules {
            rule.confidence = rule.confidence.map(round);
            for beaten in &mut rule.against {
                beaten.degree = round(beaten.degree);
            }
        }
        let count = learned.model.rules.len();
        let step = ProvenanceStep {
            command: "flagred learn".into(),
            data: self.source(),
            rows: Some(learned.samples),
            note: Some(format!(
                "strongest resolution; {count} rules learned, {} of them without samples",
                learned.completed
            )),
            ..ProvenanceStep::default()
        };
        let text =
            provenance::rule_set(text, made, step).map_err(|findings| failure(findings, None))?;
        let mut details = Vec::new();
        let mut reported = |count: u64, one: &str, many: &str| {
            if count > 0 {
                details.push(format!("{count} {}", if count == 1 { one } else { many }));
            }
        };
        reported(
            learned.conflicts,
            "combination of terms has rows that disagree",
            "combinations of terms have rows that disagree",
        );
        reported(
            learned.missing,
            "combination of terms has no rule",
            "combinations of terms have no rule",
        );
        reported(
            learned.completed,
            "rule was completed from its neighbours",
            "rules were completed from their neighbours",
        );
        reported(
            outside as u64,
            "row has a value outside the range of its variable",
            "rows have values outside the ranges of their variables",
        );
        json(&FittedRules {
            text,
            words: format!("{count} rules learned from {} rows", learned.samples),
            details,
        })
    }

    fn tuned(
        &self,
        text: &str,
        model: &Model,
        rows: usize,
        (before, after): (f64, f64),
        moved: Vec<String>,
    ) -> Result<String, JsError> {
        let digits = |loss: f64| format!("{loss:.5e}").parse().unwrap_or(loss);
        let step = ProvenanceStep {
            command: "flagred tune".into(),
            data: self.source(),
            rows: Some(rows as u64),
            loss: Some(LossChange {
                name: "RMS error".into(),
                before: digits(before),
                after: digits(after),
            }),
            moved,
            ..ProvenanceStep::default()
        };
        provenance::rule_set(text, model.clone(), step).map_err(|findings| failure(findings, None))
    }

    fn source(&self) -> Vec<DataFile> {
        vec![DataFile {
            file: self.file.clone(),
            sha256: None,
        }]
    }

    fn rows(&self, model: &Model) -> Result<Rows, JsError> {
        if model.measured_output().is_none() {
            let help = "keep one output that no other output reads";
            return Err(failure(
                "rows of data have values of one output, and the rule set has several",
                Some(help),
            ));
        }
        let variables: Vec<_> = model.measured_variables().collect();
        self.table
            .rows(&variables)
            .map_err(|(message, help)| failure(format!("`{}`: {message}", self.file), Some(&help)))
    }

    /// Returns the rows, or an error if none can be used.
    fn usable(&self, model: &Model) -> Result<Rows, JsError> {
        let rows = self.rows(model)?;
        match rows.values.is_empty() {
            true => Err(failure(
                format!("`{}` has no row that can be used", self.file),
                rows.refused.first().map(String::as_str),
            )),
            false => Ok(rows),
        }
    }
}

fn parsed(text: &str) -> Result<Model, JsError> {
    fuzzy::yaml::parse(text)
        .map(|document| document.model)
        .map_err(|findings| failure(findings, None))
}

fn json(value: &impl Serialize) -> Result<String, JsError> {
    serde_json::to_string(value).map_err(|error| failure(error, None))
}
