//! A compiled rule set, and its evaluation for Python: at a point, on arrays, on a table.

use std::{
    cell::RefCell,
    sync::atomic::{AtomicU64, Ordering},
};

use arrow_array::Array;
use fuzzy::{
    Engine,
    diagnostic::suggest,
    engine::{EvaluateError, Interval, Outcome as Raw, Scratch},
};
use numpy::{IntoPyArray, PyArrayMethods};
use pyo3::{
    IntoPyObjectExt,
    prelude::*,
    sync::PyOnceLock,
    types::{PyDict, PyFloat, PyInt, PyString, PyTuple},
};

use crate::{
    arrays::Arrays,
    arrow,
    errors::data_error,
    evaluate::Evaluator,
    outcome::{IntervalOutcome, Outcome, Outcomes},
    table::{self, Table},
};

/// A compiled rule set, with the information that Python needs to evaluate it.
pub(crate) struct CompiledRuleSet {
    /// An id that is unique within the process.
    id: u64,
    pub(crate) engine: Engine,
    inputs: Vec<Py<PyString>>,
}

/// The scratch memory of a rule set for single evaluations. Each thread caches it for a few rule sets.
struct CachedScratch {
    id: u64,
    scratch: Scratch,
    outcomes: Vec<Raw>,
}

thread_local! {
    static KEPT: RefCell<Vec<CachedScratch>> = const { RefCell::new(Vec::new()) };
}

const MAX_KEPT: usize = 8;

/// The values to evaluate: numbers, or a value for each row.
pub(crate) enum Inputs<'py> {
    /// One number for each input, in the order of the inputs.
    Numbers(Vec<f64>),
    /// One array for each input, in the order of the inputs.
    Arrays(Vec<Bound<'py, PyAny>>),
    /// A table, or a dict by the names of the inputs.
    Frame(Bound<'py, PyAny>),
}

impl CompiledRuleSet {
    pub(crate) fn new(py: Python<'_>, engine: Engine) -> CompiledRuleSet {
        static NEXT: AtomicU64 = AtomicU64::new(0);
        let inputs = engine.input_names();
        let inputs = inputs.map(|name| PyString::intern(py, name).unbind());
        CompiledRuleSet {
            id: NEXT.fetch_add(1, Ordering::Relaxed),
            inputs: inputs.collect(),
            engine,
        }
    }

    /// Returns the arguments in the order of the inputs.
    pub(crate) fn requested<'py>(
        &self,
        py: Python<'py>,
        args: &Bound<'py, PyTuple>,
        named: Option<&Bound<'py, PyDict>>,
    ) -> PyResult<Inputs<'py>> {
        let values = self.values(py, args, named)?;
        let numbers: Option<Vec<f64>> = values.iter().map(number).collect();
        match numbers {
            Some(numbers) => Ok(Inputs::Numbers(numbers)),
            None => match values.as_slice() {
                [one] if named.is_none() && is_frame(py, one)? => Ok(Inputs::Frame(one.clone())),
                _ => Ok(Inputs::Arrays(values)),
            },
        }
    }

    /// Returns the values in the order of the inputs. A single argument is returned as it is.
    fn values<'py>(
        &self,
        py: Python<'py>,
        args: &Bound<'py, PyTuple>,
        named: Option<&Bound<'py, PyDict>>,
    ) -> PyResult<Vec<Bound<'py, PyAny>>> {
        // A call with a dict, such as `model({"service": 8, "food": 9})`, also allows names that are not Python
        // identifiers.
        let mapping = match named {
            None if args.len() == 1 => args.get_item(0)?.cast_into::<PyDict>().ok(),
            _ => None,
        };
        match mapping.as_ref().or(named) {
            Some(named) if args.is_empty() || mapping.is_some() => self.by_name(py, named),
            Some(_) => {
                let help = "write `model(8, 9)` or `model(service=8, food=9)`".to_owned();
                Err(data_error(
                    "values are given both by position and by name",
                    Some(help),
                ))
            }
            _ => Ok(args.iter().collect()),
        }
    }

    fn by_name<'py>(
        &self,
        py: Python<'py>,
        named: &Bound<'py, PyDict>,
    ) -> PyResult<Vec<Bound<'py, PyAny>>> {
        let mut values = Vec::with_capacity(self.inputs.len());
        for name in &self.inputs {
            match named.get_item(name.bind(py))? {
                Some(value) => values.push(value),
                None => break,
            }
        }
        if values.len() == self.inputs.len() && values.len() == named.len() {
            return Ok(values);
        }
        let names = || self.engine.input_names();
        for key in named.keys() {
            let key: String = key.extract()?;
            if self.engine.input(&key).is_none() {
                let message = format!("there is no input `{key}`");
                return Err(data_error(message, suggest(&key, names())));
            }
        }
        let missing = names().find(|name| !named.contains(*name).unwrap_or(false));
        let message = format!("input `{}` has no value", missing.unwrap_or_default());
        Err(data_error(
            message,
            Some("use None or NaN for an unknown value".into()),
        ))
    }

    /// Evaluates one point. Returns values, or outcomes if `with_reasons`.
    pub(crate) fn point<'py>(
        &self,
        py: Python<'py>,
        numbers: &[f64],
        with_reasons: bool,
    ) -> PyResult<Bound<'py, PyAny>> {
        self.outcomes(numbers, |outcomes| match with_reasons {
            true => self.by_output(py, outcomes.iter().map(|raw| Outcome::from(*raw))),
            false => {
                let values = outcomes.iter().map(|o| o.value().unwrap_or(f64::NAN));
                self.by_output(py, values)
            }
        })?
    }

    /// Evaluates inputs that are numbers or intervals. An interval is a pair `(low, high)`.
    pub(crate) fn intervals<'py>(
        &self,
        py: Python<'py>,
        args: &Bound<'py, PyTuple>,
        named: Option<&Bound<'py, PyDict>>,
    ) -> PyResult<Bound<'py, PyAny>> {
        let values = self.values(py, args, named)?;
        let intervals = values.iter().map(|value| match number(value) {
            Some(number) => Ok(Interval::from(number)),
            None => match value.extract::<(f64, f64)>() {
                Ok((low, high)) => Ok(Interval::new(low, high)),
                Err(_) => Err(data_error(
                    format!("{} is not an interval", value.repr()?),
                    Some("give a number, or the two ends: `(7.5, 8.5)`".into()),
                )),
            },
        });
        let intervals: Vec<Interval> = intervals.collect::<PyResult<_>>()?;
        let engine = &self.engine;
        let outcomes = py.detach(|| engine.evaluate_interval(&intervals));
        let outcomes = outcomes.map_err(|error| data_error(error, None))?;
        self.by_output(py, outcomes.into_iter().map(IntervalOutcome::from))
    }

    fn outcomes<T>(&self, numbers: &[f64], take: impl FnOnce(&[Raw]) -> T) -> PyResult<T> {
        KEPT.with_borrow_mut(|kept| {
            let at = match kept.iter().position(|kept| kept.id == self.id) {
                Some(at) => at,
                None => {
                    kept.truncate(MAX_KEPT - 1);
                    let outputs = self.engine.output_names().len();
                    let new = CachedScratch {
                        id: self.id,
                        scratch: self.engine.scratch(),
                        outcomes: vec![Raw::default(); outputs],
                    };
                    kept.insert(0, new);
                    0
                }
            };
            let CachedScratch {
                scratch, outcomes, ..
            } = &mut kept[at];
            let done = self.engine.evaluate_with(scratch, numbers, outcomes);
            done.map_err(|error| data_error(error, None))?;
            Ok(take(outcomes))
        })
    }

    /// Returns the item of the only output, or a dict of items by the names of the outputs.
    fn by_output<'py, T: IntoPyObject<'py>>(
        &self,
        py: Python<'py>,
        things: impl IntoIterator<Item = T>,
    ) -> PyResult<Bound<'py, PyAny>> {
        let mut things = things.into_iter();
        if self.engine.output_names().len() == 1
            && let Some(only) = things.next()
        {
            return only.into_bound_py_any(py);
        }
        let dict = PyDict::new(py);
        for (name, thing) in self.engine.output_names().zip(things) {
            dict.set_item(name, thing)?;
        }
        Ok(dict.into_any())
    }

    /// Evaluates arrays that broadcast against each other.
    pub(crate) fn arrays<'py>(
        &self,
        py: Python<'py>,
        values: &[Bound<'py, PyAny>],
        threads: Option<usize>,
        with_reasons: bool,
    ) -> PyResult<Bound<'py, PyAny>> {
        let expected = self.inputs.len();
        let columns = match values {
            [matrix] if expected > 1 => matrix_columns(py, matrix, expected)?,
            _ => None,
        };
        let values = columns.as_deref().unwrap_or(values);
        if values.len() != expected {
            let got = values.len();
            let help = "give a value for each input, or a matrix or a frame with a column for each";
            let error = EvaluateError::WrongNumberOfInputs { expected, got };
            return Err(data_error(error, Some(help.into())));
        }
        let arrays = Arrays::new(py, values)?;
        let rows = arrays.shape.iter().product();
        let mut evaluator = Evaluator::new(&self.engine, threads, with_reasons)?;
        let results = evaluator.run(py, rows, &arrays.columns()?)?;
        let shaped = results.into_iter().map(|result| match result.reasons {
            Some(reasons) => {
                let outcomes = Outcomes::new(py, result.value, reasons, &arrays.shape)?;
                outcomes.into_bound_py_any(py)
            }
            // Arrays without axes give a number, as in NumPy.
            None if arrays.shape.is_empty() => result.value[0].into_bound_py_any(py),
            None => Ok(result
                .value
                .into_pyarray(py)
                .reshape(arrays.shape.clone())?
                .into_any()),
        });
        let shaped: Vec<Bound<'py, PyAny>> = shaped.collect::<PyResult<_>>()?;
        self.by_output(py, shaped)
    }

    /// Evaluates a table from Arrow's C interface, one batch at a time.
    pub(crate) fn table(
        &self,
        frame: &Bound<'_, PyAny>,
        threads: Option<usize>,
        with_reasons: bool,
    ) -> PyResult<Table> {
        let py = frame.py();
        let mut imported = arrow::import(frame)?;
        let columns = imported.names();
        let names: Vec<&str> = self.engine.input_names().collect();
        let places = names.iter().map(|name| {
            let columns = || columns.iter().map(String::as_str);
            let mut found = columns().enumerate().filter(|(_, column)| column == name);
            match (found.next(), found.next()) {
                (Some((place, _)), None) => Ok(place),
                (None, _) => {
                    let message = format!("the table has no column `{name}`");
                    Err(data_error(message, suggest(name, columns())))
                }
                (Some(_), Some(_)) => {
                    let message = format!("the table has the column `{name}` more than once");
                    let help = "rename all of them except one".to_owned();
                    Err(data_error(message, Some(help)))
                }
            }
        });
        let places: Vec<usize> = places.collect::<PyResult<_>>()?;
        let schema = table::schema(self.engine.model(), with_reasons);
        let mut evaluator = Evaluator::new(&self.engine, threads, with_reasons)?;
        let mut batches = Vec::new();
        // The interpreter is released, because a stream that is implemented in Python acquires it
        // itself.
        while let Some(batch) = py.detach(|| imported.next()) {
            let batch = batch.map_err(|error| data_error(error, None))?;
            let columns = names.iter().zip(&places);
            let columns = columns.map(|(name, at)| arrow::column(name, &batch, *at));
            let columns: Vec<_> = columns.collect::<PyResult<_>>()?;
            let columns: Vec<&[f64]> = columns.iter().map(|column| &**column).collect();
            let results = evaluator.run(py, batch.len(), &columns)?;
            batches.push(table::batch(&schema, results)?);
        }
        Ok(Table { batches, schema })
    }
}

/// Converts a Python number; Python's `None` becomes NaN, which is unknown. Returns `None` for anything else.
fn number(value: &Bound<'_, PyAny>) -> Option<f64> {
    if let Ok(float) = value.cast::<PyFloat>() {
        return Some(float.value());
    }
    if value.is_instance_of::<PyInt>() {
        return value.extract().ok();
    }
    value.is_none().then_some(f64::NAN)
}

/// The columns of a matrix that has a column for each input; `None` if it is not a matrix.
fn matrix_columns<'py>(
    py: Python<'py>,
    matrix: &Bound<'py, PyAny>,
    inputs: usize,
) -> PyResult<Option<Vec<Bound<'py, PyAny>>>> {
    static COLUMNS: PyOnceLock<Py<PyAny>> = PyOnceLock::new();
    let columns = COLUMNS.import(py, "flagred._arrays", "columns")?;
    columns.call1((matrix, inputs))?.extract()
}

fn is_frame(py: Python<'_>, value: &Bound<'_, PyAny>) -> PyResult<bool> {
    static IS_FRAME: PyOnceLock<Py<PyAny>> = PyOnceLock::new();
    let is_frame = IS_FRAME.import(py, "flagred._frames", "is_frame")?;
    is_frame.call1((value,))?.extract()
}
