//! Flights: reading logs, commands and signals as arrays and tables.

use std::{
    fs, io,
    path::{Path, PathBuf},
    sync::{Arc, OnceLock},
    time::SystemTime,
};

use arrow_array::{ArrayRef, Float64Array, RecordBatch};
use arrow_schema::{DataType, Field, Schema};
use flagred_flightlog::{Flight, Options, PulseRange, Series};
use numpy::{IntoPyArray, PyArray1, PyArray2, PyArrayMethods};
use pyo3::{exceptions::PyValueError, prelude::*, types::PyBytes};
use serde_json::json;

use crate::{
    errors::{data_error, os_error, read_error},
    table::{Table, known},
    threads::interruptible,
};

/// The data of a flight, inside `flagred.types.Flight`.
#[pyclass(frozen, subclass, module = "flagred._core")]
pub(crate) struct FlightData {
    /// The flight; after unpickling, read at the first use.
    flight: OnceLock<Arc<Flight>>,
    pub(crate) name: String,
    source: Source,
    signals: Option<Vec<String>>,
    range: Option<(u16, u16)>,
}

/// The source of a log.
enum Source {
    Path(PathBuf, Option<Stamp>),
    Bytes(Py<PyBytes>),
}

/// The size and modification time of a file when it was read.
type Stamp = (u64, SystemTime);

fn stamp(path: &Path) -> Option<Stamp> {
    let file = fs::metadata(path).ok()?;
    Some((file.len(), file.modified().ok()?))
}

/// Name, unit, source and rate of a signal, and the index of its time base.
type SignalParts = (String, String, String, Option<f64>, usize);

type Column<'py> = Bound<'py, PyArray1<f64>>;

/// The arguments of [`FlightData::new`], in the form in which they are pickled.
type Parts<'py> = (
    Bound<'py, PyBytes>,
    String,
    Option<Vec<String>>,
    Option<(u16, u16)>,
);

/// Converts columns to a table. All columns except the first may contain unknown values.
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
    /// Returns the flight. Its log is read if necessary; Ctrl-C interrupts the reading.
    pub(crate) fn flight(&self, py: Python<'_>) -> PyResult<&Arc<Flight>> {
        if let Some(flight) = self.flight.get() {
            return Ok(flight);
        }
        let range = self
            .range
            .map(|(low_us, high_us)| PulseRange::new(low_us, high_us));
        let range = range.transpose().map_err(|error| {
            PyValueError::new_err(format!("`range`: {error}; {}", error.help()))
        })?;
        let mut options = Options::default();
        options.signals = self.signals.clone();
        options.range = range;
        let flight = match &self.source {
            Source::Path(path, _) => {
                let path = path.clone();
                interruptible(py, move || flagred_flightlog::open(path, &options))?
            }
            Source::Bytes(bytes) => {
                let bytes = bytes.as_bytes(py).to_vec();
                interruptible(py, move || {
                    flagred_flightlog::read(io::Cursor::new(bytes), &options)
                })?
            }
        };
        let flight = flight.map_err(|error| read_error(py, &error))?;
        Ok(self.flight.get_or_init(|| Arc::new(flight)))
    }

    /// Returns the bytes of the log, or an error if its file changed after it was read.
    fn bytes<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyBytes>> {
        let (path, read) = match &self.source {
            Source::Bytes(bytes) => return Ok(bytes.bind(py).clone()),
            Source::Path(path, read) => (path, read),
        };
        let shown = path.display().to_string();
        if stamp(path) != *read && path.exists() {
            let help = "read it again, or pickle the flight before the file changes".to_owned();
            let message =
                format!("`{shown}` changed after it was read, so the flight cannot be pickled");
            return Err(data_error(message, Some(help)));
        }
        let help = "a flight is pickled with the bytes of its log";
        match fs::read(path) {
            Ok(bytes) => Ok(PyBytes::new(py, &bytes)),
            Err(error) => Err(os_error(py, &error, &shown, Some(help))?),
        }
    }

    /// The commands of all motors, row by row.
    fn rows<'py>(
        &self,
        py: Python<'py>,
        value: impl Fn(&Flight, f64) -> f64,
    ) -> PyResult<Bound<'py, PyArray2<f64>>> {
        let flight = self.flight(py)?;
        let (rows, motors) = (flight.commands.len(), flight.motors.len());
        let all = flight
            .commands
            .rows()
            .flat_map(|(_, row)| row.iter().copied());
        let all: Vec<f64> = all.map(|raw| value(flight, raw)).collect();
        all.into_pyarray(py).reshape([rows, motors])
    }
}

#[pymethods]
impl FlightData {
    #[new]
    #[pyo3(signature = (source, name, signals = None, range = None, lazy = false))]
    fn new(
        py: Python<'_>,
        source: &Bound<'_, PyAny>,
        name: String,
        signals: Option<Vec<String>>,
        range: Option<(u16, u16)>,
        lazy: bool,
    ) -> PyResult<Self> {
        let source = match source.cast::<PyBytes>() {
            Ok(bytes) => Source::Bytes(bytes.clone().unbind()),
            Err(_) => {
                let path: PathBuf = source.extract()?;
                let read = stamp(&path);
                Source::Path(path, read)
            }
        };
        let new = FlightData {
            flight: OnceLock::new(),
            name,
            source,
            signals,
            range,
        };
        if !lazy {
            new.flight(py)?;
        }
        Ok(new)
    }

    /// The parts that reproduce the flight: the bytes of the log, its name, the signals and the given range.
    fn _parts<'py>(&self, py: Python<'py>) -> PyResult<Parts<'py>> {
        let (name, signals) = (self.name.clone(), self.signals.clone());
        Ok((self.bytes(py)?, name, signals, self.range))
    }

    /// The name of the source of the flight.
    #[getter]
    fn name(&self) -> &str {
        &self.name
    }

    /// All data except commands and signals, in JSON.
    fn _json(&self, py: Python<'_>) -> PyResult<String> {
        let flight = self.flight(py)?;
        let json = json!({
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
        });
        Ok(json.to_string())
    }

    /// The times of the motor commands, in seconds on the log's clock.
    fn _command_times<'py>(&self, py: Python<'py>) -> PyResult<Column<'py>> {
        let flight = self.flight(py)?;
        Ok(PyArray1::from_slice(py, flight.commands.t_s()))
    }

    /// The commands as logged, with a column for each motor.
    fn _raw_commands<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<f64>>> {
        self.rows(py, |_, raw| raw)
    }

    /// The commands on the effective range, with a column for each motor.
    fn _effective_commands<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<f64>>> {
        self.rows(py, |flight, raw| {
            flight.effective_command(raw).unwrap_or(f64::NAN)
        })
    }

    /// Time and effective command of each motor as a table.
    fn _commands_table(&self, py: Python<'_>) -> PyResult<Table> {
        let flight = self.flight(py)?;
        let times = flight.commands.t_s().to_vec();
        let mut columns = vec![("t_s".to_owned(), "s", times)];
        for (i, motor) in flight.motors.iter().enumerate() {
            let rows = flight.commands.rows();
            let values = rows.map(|(_, row)| {
                let raw = row.get(i).copied().unwrap_or(f64::NAN);
                flight.effective_command(raw).unwrap_or(f64::NAN)
            });
            columns.push((format!("motor{}", motor.number), "1", values.collect()));
        }
        table(columns)
    }

    /// Name, unit, source and rate of each signal, and the index of its time base.
    fn _signals(&self, py: Python<'_>) -> PyResult<Vec<SignalParts>> {
        let series = self.flight(py)?.series.iter().enumerate();
        let signals = series.flat_map(|(base, series)| {
            series.signals().map(move |signal| {
                let label = signal.label;
                let (name, unit) = (label.name.clone(), label.unit.clone());
                (name, unit, label.source.clone(), signal.rate_hz(), base)
            })
        });
        Ok(signals.collect())
    }

    /// The times and values of a signal, where NaN means unknown.
    fn _signal<'py>(
        &self,
        py: Python<'py>,
        name: &str,
    ) -> PyResult<Option<(Column<'py>, Column<'py>)>> {
        let arrays = self.flight(py)?.signal(name).map(|signal| {
            [signal.t_s, signal.values].map(|values| PyArray1::from_slice(py, values))
        });
        Ok(arrays.map(Into::into))
    }

    /// The signals of a time base as a table.
    fn _series_table(&self, py: Python<'_>, base: usize) -> PyResult<Option<Table>> {
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
        self.flight(py)?.series.get(base).map(of).transpose()
    }
}
