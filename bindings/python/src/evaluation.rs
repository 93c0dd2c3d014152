//! Validation of the risks of profiles, over many flights.

use std::{
    path::PathBuf,
    sync::{
        Arc,
        atomic::{AtomicBool, AtomicUsize, Ordering},
    },
};

use arrow_array::{ArrayRef, BooleanArray, Int32Array, RecordBatch};
use arrow_schema::{Field, Schema};
use flagred::shipped;
use flagred_evaluation::{
    Case, Document, ERROR, Estimators, Evaluation, FlightError, FlightTable, LeftOutFile, Record,
    cases, files, page, svg, words,
};
use flagred_flightlog::Flight;
use numpy::{IntoPyArray, PyArray1, PyReadonlyArray1};
use pyo3::prelude::*;
use rayon::{ThreadPool, prelude::*};

use crate::{
    errors::{data_error, log_error, read_error},
    flight::FlightData,
    profile::Profile,
    table::{Table, known},
    threads::{count, interruptible, pool},
};

/// The validation over many flights, inside `flagred.types.Evaluation`.
#[pyclass(frozen, subclass, module = "flagred._core")]
pub(crate) struct EvaluationData {
    evaluation: Arc<Evaluation>,
    /// The names of the estimators, in the same order as the scores of each case.
    names: Vec<String>,
    notes: Vec<String>,
}

/// A flight, or the path of a log or of a folder with logs.
#[derive(FromPyObject)]
pub(crate) enum Log<'py> {
    Flight(PyRef<'py, FlightData>),
    Path(PathBuf),
}

/// A table with a row for each flight; a column contains numbers or texts.
#[derive(FromPyObject)]
#[pyo3(from_item_all)]
pub(crate) struct FlightRows<'py> {
    names: Vec<String>,
    numbers: Vec<Option<PyReadonlyArray1<'py, f64>>>,
    texts: Vec<Vec<String>>,
}

/// A flight to evaluate.
enum Source {
    Flight(String, Arc<Flight>),
    Path(PathBuf),
}

/// The reason why an evaluation failed.
enum EvaluationFailure {
    Flight(FlightError),
    NoSteps,
}

impl EvaluationFailure {
    fn raise(self, py: Python<'_>) -> PyErr {
        match self {
            EvaluationFailure::Flight(FlightError::Read(error)) => read_error(py, &error),
            EvaluationFailure::Flight(why) => log_error(&why, why.help()),
            EvaluationFailure::NoSteps => log_error(
                "there are no steps to evaluate in these logs",
                Some(
                    "a log needs motor commands, attitude, and 20 s in the air; `flagred.read_log(log).gaps` lists what is missing in a log",
                ),
            ),
        }
    }
}

/// Returns the estimators of the shipped profiles that require only motor commands, and of the requested profiles.
fn estimators(py: Python<'_>, requested: &[PyRef<'_, Profile>]) -> PyResult<Estimators> {
    let mut estimators = Estimators::default();
    for name in shipped::motor_profile_names() {
        estimators.add(name, Profile::load(py, name)?.loaded.estimator.clone());
    }
    for profile in requested {
        if !estimators.has(&profile.file) {
            estimators.add(&profile.file, profile.loaded.estimator.clone());
        }
    }
    Ok(estimators)
}

/// Replaces folders by the files in them. Also returns whether each flight or file was named explicitly, because a folder
/// may contain files that are not flights.
fn named(logs: Vec<Source>) -> Result<Vec<(Source, bool)>, EvaluationFailure> {
    let mut found = Vec::new();
    for log in logs {
        match log {
            Source::Path(path) => {
                let files =
                    files(&[path]).map_err(|error| EvaluationFailure::Flight(error.into()))?;
                found.extend(
                    files
                        .into_iter()
                        .map(|f| (Source::Path(f.path), f.is_named)),
                );
            }
            flight => found.push((flight, true)),
        }
    }
    Ok(found)
}

/// Evaluates every flight, until `stop` is set.
fn evaluate(
    logs: Vec<Source>,
    estimators: &Estimators,
    horizon_s: f64,
    skip_bad_logs: bool,
    stop: &AtomicBool,
) -> Result<Evaluation, EvaluationFailure> {
    let logs = named(logs)?;
    // If a log ends the evaluation with an error, the logs after it are not read.
    let last = AtomicUsize::new(usize::MAX);
    let each = logs.par_iter().enumerate().map(|(i, (log, is_named))| {
        if i > last.load(Ordering::Relaxed) || stop.load(Ordering::Relaxed) {
            return None;
        }
        let record = match log {
            Source::Flight(name, flight) => Record::new(name, flight, estimators, horizon_s),
            Source::Path(path) => Record::read(path, estimators, horizon_s),
        };
        if record.is_err() && *is_named && !skip_bad_logs {
            last.fetch_min(i, Ordering::Relaxed);
        }
        Some(record)
    });
    let each: Vec<Option<Result<Record, FlightError>>> = each.collect();
    let (mut records, mut left_out) = (Vec::new(), Vec::new());
    for ((log, is_named), record) in logs.iter().zip(each) {
        match record {
            Some(Ok(record)) => records.push(record),
            Some(Err(why)) if *is_named && !skip_bad_logs => {
                return Err(EvaluationFailure::Flight(why));
            }
            Some(Err(why)) => left_out.push(LeftOutFile::new(name(log), &why)),
            None => {}
        }
    }
    let evaluation = Evaluation::of_flights(estimators, horizon_s, records, left_out, &|| ());
    evaluation.ok_or(EvaluationFailure::NoSteps)
}

fn name(log: &Source) -> String {
    match log {
        Source::Flight(name, _) => name.clone(),
        Source::Path(path) => path.display().to_string(),
    }
}

/// Converts the rows of a table to cases. Also returns notes about the rows.
fn row_cases(rows: &FlightRows<'_>, estimators: &Estimators) -> PyResult<(Vec<Case>, Vec<String>)> {
    let columns: Vec<&str> = rows.names.iter().map(String::as_str).collect();
    if !columns.contains(&ERROR) {
        let help = "critical moments cannot be identified without an attitude error".to_owned();
        return Err(data_error(
            format!("the rows have no column `{ERROR}`"),
            Some(help),
        ));
    }
    let number = |row: usize, column: usize| {
        let numbers = rows.numbers.get(column).and_then(Option::as_ref);
        let number = numbers.and_then(|numbers| numbers.as_array().get(row).copied());
        number.filter(|number| number.is_finite()).ok_or_else(|| {
            let message = format!(
                "row {row}, column `{}`: not a finite number",
                columns[column]
            );
            data_error(message, Some("correct the cell or remove the row".into()))
        })
    };
    let text = |row: usize, column: usize| {
        let texts = rows.texts.get(column);
        texts
            .and_then(|texts| texts.get(row))
            .map_or("", String::as_str)
    };
    let table = FlightTable {
        len: rows.texts.first().map_or(0, Vec::len),
        number: &number,
        text: &text,
        columns: columns.clone(),
    };
    cases(&table, estimators)
}

#[pymethods]
impl EvaluationData {
    #[new]
    #[pyo3(signature = (logs, rows, profiles, horizon_s, skip_bad_logs, threads))]
    fn new(
        py: Python<'_>,
        logs: Vec<Log<'_>>,
        rows: Option<FlightRows<'_>>,
        profiles: Vec<PyRef<'_, Profile>>,
        horizon_s: f64,
        skip_bad_logs: bool,
        #[pyo3(from_py_with = count)] threads: Option<usize>,
    ) -> PyResult<Self> {
        if !(horizon_s > 0.0 && horizon_s.is_finite()) {
            let help = "write a number of seconds above 0".to_owned();
            return Err(data_error(
                format!("`horizon_s` is {horizon_s}"),
                Some(help),
            ));
        }
        let estimators = estimators(py, &profiles)?;
        let names = estimators
            .names()
            .map(|(name, _)| name.to_owned())
            .collect();
        let pool: Arc<ThreadPool> = pool(threads)?;
        let (evaluation, notes) = match rows {
            Some(rows) => {
                let (cases, notes) = row_cases(&rows, &estimators)?;
                let evaluation = interruptible(py, move || {
                    pool.install(|| Evaluation::of_cases(&estimators, cases, &|| ()))
                })?;
                (evaluation, notes)
            }
            None => {
                let logs = logs.into_iter().map(|log| match log {
                    Log::Flight(log) => {
                        let flight = Arc::clone(log.flight(py)?);
                        Ok(Source::Flight(log.name.clone(), flight))
                    }
                    Log::Path(path) => Ok(Source::Path(path)),
                });
                let logs: Vec<Source> = logs.collect::<PyResult<_>>()?;
                let stop = Arc::new(AtomicBool::new(false));
                let is_stopped = Arc::clone(&stop);
                let done = interruptible(py, move || {
                    pool.install(|| {
                        evaluate(logs, &estimators, horizon_s, skip_bad_logs, &is_stopped)
                    })
                });
                stop.store(true, Ordering::Relaxed);
                (done?.map_err(|failed| failed.raise(py))?, Vec::new())
            }
        };
        Ok(EvaluationData {
            evaluation: Arc::new(evaluation),
            names,
            notes,
        })
    }

    /// Notes about the rows.
    fn _notes(&self) -> Vec<String> {
        self.notes.clone()
    }

    /// The whole evaluation in JSON, as `flagred validate --json` prints it.
    fn to_json(&self) -> PyResult<String> {
        let document = Document::new(&self.evaluation);
        serde_json::to_string(&document).map_err(|error| data_error(error, None))
    }

    /// The score of each estimator for each case.
    fn _scores(&self) -> PyResult<Table> {
        let cases = self.evaluation.cases();
        let has_times = cases.iter().any(|case| case.t_s.is_some());
        let flags = |is: fn(&Case) -> bool| -> ArrayRef {
            Arc::new(
                cases
                    .iter()
                    .map(|case| Some(is(case)))
                    .collect::<BooleanArray>(),
            )
        };
        let numbers = |of: &dyn Fn(&Case) -> f64| known(cases.iter().map(of).collect());
        let flights = cases.iter().map(|case| i32::try_from(case.group).ok());
        let flights: Int32Array = flights.collect();
        let mut columns: Vec<(&str, ArrayRef)> = vec![("flight", Arc::new(flights))];
        if has_times {
            columns.push(("t_s", numbers(&|case| case.t_s.unwrap_or(f64::NAN))));
        }
        columns.push(("critical", flags(|case| case.is_critical)));
        if has_times {
            columns.push(("quiet", flags(|case| case.is_quiet)));
            columns.push(("onset", flags(|case| case.is_onset)));
        }
        for (i, name) in self.names.iter().enumerate() {
            let score = |case: &Case| case.scores.get(i).copied().unwrap_or(f64::NAN);
            columns.push((name, numbers(&score)));
        }
        let fields = columns
            .iter()
            .map(|(name, values)| Field::new(*name, values.data_type().clone(), true));
        let schema = Arc::new(Schema::new(fields.collect::<Vec<_>>()));
        let values = columns.into_iter().map(|(_, values)| values).collect();
        let batch = RecordBatch::try_new(Arc::clone(&schema), values);
        let batches = vec![batch.map_err(|error| data_error(error, None))?];
        Ok(Table { batches, schema })
    }

    /// The false and true positive rates along the ROC curve of an estimator.
    fn _roc<'py>(
        &self,
        py: Python<'py>,
        estimator: usize,
    ) -> (Bound<'py, PyArray1<f64>>, Bound<'py, PyArray1<f64>>) {
        let (false_rate, true_rate): (Vec<f64>, Vec<f64>) = self.evaluation.roc(estimator).unzip();
        (false_rate.into_pyarray(py), true_rate.into_pyarray(py))
    }

    /// The evaluation as a single, self-contained HTML page.
    fn html(&self) -> String {
        flagred_report::page::around("Evaluation", page::body(&self.evaluation))
    }

    /// The ROC curves and the reliability as SVG.
    fn svg(&self) -> String {
        svg::draw(&self.evaluation)
    }

    /// The evaluation as text, as `flagred validate` prints it.
    fn __str__(&self) -> String {
        words::text(&self.evaluation)
    }
}
