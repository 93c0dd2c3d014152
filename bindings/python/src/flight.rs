//! Flights: logs read, their commands and signals as arrays and tables.

use std::{io, path::PathBuf, sync::Arc};

use arrow_array::{ArrayRef, Float64Array, RecordBatch};
use arrow_schema::{DataType, Field, Schema};
use flagred_flightlog::{Flight, Options, PulseRange, Series, Signal};
use numpy::{IntoPyArray, PyArray1, PyArray2, PyArrayMethods};
use pyo3::{exceptions::PyValueError, prelude::*, types::PyBytes};
use serde_json::json;

use crate::{
    errors::{data_error, read_error},
    table::{Table, known},
    threads::interruptible,
};

/// A flight; `flagred.Flight` is made of it.
#[pyclass(frozen, subclass, module = "flagred._core")]
pub(crate) struct FlightData {
    pub(crate) flight: Arc<Flight>,
    pub(crate) name: String,
}

/// Where a log is.
enum Source {
    Path(PathBuf),
    Bytes(Vec<u8>),
}

type Column<'py> = Bound<'py, PyArray1<f64>>;

/// Reads a log while Ctrl-C is listened to.
fn read(py: Python<'_>, source: Source, options: Options) -> PyResult<Flight> {
    let flight = interruptible(py, move || match source {
        Source::Path(path) => flagred_flightlog::open(path, &options),
        Source::Bytes(bytes) => flagred_flightlog::read(io::Cursor::new(bytes), &options),
    })?;
    flight.map_err(|error| read_error(py, &error))
}

/// Columns as a table; those after the first may be unknown here and there.
fn table(columns: Vec<(String, &str, Vec<f64>)>) -> PyResult<Table> {
    let mut fields = Vec::new();
    let mut arrays: Vec<ArrayRef> = Vec::new();
    for (name, unit, values) in columns {
        let field = Field::new(name, DataType::Float64, !fields.is_empty());
        fields.push(field.with_metadata([("unit".to_owned(), unit.to_owned())].into()));
        arrays.push(match arrays.is_empty() {
            true => Arc::new(Float64Array::from(values)),
            false => known(values),
        });
    }
    let schema = Arc::new(Schema::new(fields));
    let batch = RecordBatch::try_new(Arc::clone(&schema), arrays);
    let batches = vec![batch.map_err(|error| data_error(error, None))?];
    Ok(Table { batches, schema })
}

impl FlightData {
    fn signal(&self, name: &str) -> Option<Signal<'_>> {
        self.flight.signal(name)
    }

    /// The commands of all motors, row by row.
    fn rows<'py>(
        &self,
        py: Python<'py>,
        value: impl Fn(f64) -> f64,
    ) -> PyResult<Bound<'py, PyArray2<f64>>> {
        let (rows, motors) = (self.flight.commands.len(), self.flight.motors.len());
        let all = self
            .flight
            .commands
            .rows()
            .flat_map(|(_, row)| row.iter().copied());
        let all: Vec<f64> = all.map(value).collect();
        all.into_pyarray(py).reshape([rows, motors])
    }
}

#[pymethods]
impl FlightData {
    #[new]
    #[pyo3(signature = (source, name, signals = None, range = None))]
    fn new(
        py: Python<'_>,
        source: &Bound<'_, PyAny>,
        name: String,
        signals: Option<Vec<String>>,
        range: Option<(u16, u16)>,
    ) -> PyResult<Self> {
        let range = range.map(|(low_us, high_us)| PulseRange::new(low_us, high_us));
        let range = range.transpose().map_err(|error| {
            PyValueError::new_err(format!("`range`: {error}; {}", error.help()))
        })?;
        let source = match source.cast::<PyBytes>() {
            Ok(bytes) => Source::Bytes(bytes.as_bytes().to_vec()),
            Err(_) => Source::Path(source.extract()?),
        };
        let mut options = Options::default();
        options.signals = signals;
        options.range = range;
        let flight = Arc::new(read(py, source, options)?);
        Ok(FlightData { flight, name })
    }

    /// What it was read from.
    #[getter]
    fn name(&self) -> &str {
        &self.name
    }

    /// All but commands and signals, in JSON.
    fn _json(&self) -> String {
        let flight = &self.flight;
        json!({
            "format": flight.format,
            "vehicle": flight.vehicle,
            "motors": flight.motors,
            "geometry": flight.geometry,
            "range": flight.range,
            "effective_range": flight.effective_range,
            "effective_range_doubt": flight.effective_range_doubt,
            "assumed": flight.assumed,
            "parameters": flight.parameters,
            "modes": flight.modes,
            "messages": flight.messages,
            "armed": flight.armed,
            "in_air": flight.in_air,
            "utc_at_zero_s": flight.utc_at_zero_s,
            "boots_s": flight.boots_s,
            "header": flight.header,
            "report": flight.report,
            "gaps": flight.gaps(),
        })
        .to_string()
    }

    /// The times of the motor commands, in seconds on the log's clock.
    fn _command_times<'py>(&self, py: Python<'py>) -> Column<'py> {
        PyArray1::from_slice(py, self.flight.commands.t_s())
    }

    /// The commands as they were logged, a column for each motor.
    fn _raw_commands<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<f64>>> {
        self.rows(py, |raw| raw)
    }

    /// The commands on the effective range, a column for each motor.
    fn _effective_commands<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<f64>>> {
        self.rows(py, |raw| {
            self.flight.effective_command(raw).unwrap_or(f64::NAN)
        })
    }

    /// Time and effective command of each motor as a table.
    fn _commands_table(&self) -> PyResult<Table> {
        let times = self.flight.commands.t_s().to_vec();
        let mut columns = vec![("t_s".to_owned(), "s", times)];
        for (i, motor) in self.flight.motors.iter().enumerate() {
            let rows = self.flight.commands.rows();
            let values = rows.map(|(_, row)| {
                let raw = row.get(i).copied().unwrap_or(f64::NAN);
                self.flight.effective_command(raw).unwrap_or(f64::NAN)
            });
            columns.push((format!("motor{}", motor.number), "1", values.collect()));
        }
        table(columns)
    }

    /// Name, unit, source and rate of each signal, and the index of its time base.
    fn _signals(&self) -> Vec<(String, String, String, Option<f64>, usize)> {
        let series = self.flight.series.iter().enumerate();
        let signals = series.flat_map(|(base, series)| {
            series.signals().map(move |signal| {
                let label = signal.label;
                let (name, unit) = (label.name.clone(), label.unit.clone());
                (name, unit, label.source.clone(), signal.rate_hz(), base)
            })
        });
        signals.collect()
    }

    /// The times and values of a signal; NaN is unknown.
    fn _signal<'py>(&self, py: Python<'py>, name: &str) -> Option<(Column<'py>, Column<'py>)> {
        let signal = self.signal(name)?;
        let arrays = [signal.t_s, signal.values].map(|values| PyArray1::from_slice(py, values));
        Some(arrays.into())
    }

    /// The signals of a time base as a table.
    fn _series_table(&self, base: usize) -> PyResult<Option<Table>> {
        let of = |series: &Series| {
            let mut columns = vec![("t_s".to_owned(), "s", series.t_s().to_vec())];
            columns.extend(series.signals().map(|signal| {
                let label = signal.label;
                (
                    label.name.clone(),
                    label.unit.as_str(),
                    signal.values.to_vec(),
                )
            }));
            table(columns)
        };
        self.flight.series.get(base).map(of).transpose()
    }
}
