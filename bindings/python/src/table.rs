//! A table for other libraries through Arrow's C interface: pyarrow, polars, pandas, DuckDB.

use std::{collections::HashMap, sync::Arc};

use arrow_array::{
    Array, ArrayRef, BooleanArray, Float64Array, Int32Array, RecordBatch,
    cast::AsArray,
    types::{Float64Type, Int32Type},
};
use arrow_schema::{DataType, Field, Schema, SchemaRef};
use fuzzy::Model;
use numpy::{IntoPyArray, PyReadonlyArray1};
use pyo3::{
    exceptions::PyKeyError,
    prelude::*,
    types::{PyCapsule, PyList},
};

use crate::{
    arrow::{self, numbers},
    errors::data_error,
    outcome::{Columns, NO_RULE},
};

/// A pickled column: name, metadata, values, and a mask of the known values (None if all are known).
type Column<'py> = (
    String,
    HashMap<String, String>,
    Values<'py>,
    Option<PyReadonlyArray1<'py, bool>>,
);

/// The values of a column. Unknown values are arbitrary.
#[derive(FromPyObject)]
enum Values<'py> {
    Floats(PyReadonlyArray1<'py, f64>),
    Integers(PyReadonlyArray1<'py, i32>),
    Booleans(PyReadonlyArray1<'py, bool>),
}

impl Values<'_> {
    fn into_array(self, known: Option<Vec<bool>>) -> ArrayRef {
        fn some<T: Copy>(values: &[T], known: Option<&[bool]>) -> Vec<Option<T>> {
            let is_known = |i: usize| known.is_none_or(|known| known.get(i) == Some(&true));
            let values = values.iter().enumerate();
            values
                .map(|(i, value)| is_known(i).then_some(*value))
                .collect()
        }
        let known = known.as_deref();
        match self {
            Values::Floats(values) => {
                Arc::new(Float64Array::from(some(&values.as_array().to_vec(), known)))
            }
            Values::Integers(values) => {
                Arc::new(Int32Array::from(some(&values.as_array().to_vec(), known)))
            }
            Values::Booleans(values) => {
                Arc::new(BooleanArray::from(some(&values.as_array().to_vec(), known)))
            }
        }
    }
}

/// A table of numbers. Any library that imports Arrow streams can read it: ``pyarrow.table(t)``, ``polars.DataFrame(t)``;
/// ``pandas.DataFrame(dict(t))`` uses its NumPy columns.
#[pyclass(frozen, mapping, module = "flagred.types")]
pub(crate) struct Table {
    pub(crate) batches: Vec<RecordBatch>,
    pub(crate) schema: SchemaRef,
}

#[pymethods]
impl Table {
    /// The table as a stream for other libraries.
    #[pyo3(signature = (requested_schema = None))]
    fn __arrow_c_stream__<'py>(
        &self,
        py: Python<'py>,
        requested_schema: Option<Bound<'py, PyAny>>,
    ) -> PyResult<Bound<'py, PyCapsule>> {
        // The protocol allows ignoring the request.
        let _ = requested_schema;
        arrow::export(py, self.batches.clone(), Arc::clone(&self.schema))
    }

    /// The names of the columns, in their order.
    fn keys(&self) -> Vec<String> {
        let fields = self.schema.fields().iter();
        fields.map(|field| field.name().clone()).collect()
    }

    fn __len__(&self) -> usize {
        self.batches.iter().map(RecordBatch::num_rows).sum()
    }

    fn __iter__<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        Ok(self.keys().into_pyobject(py)?.try_iter()?.into_any())
    }

    /// A column as an array of float64; NaN is unknown.
    fn __getitem__<'py>(&self, py: Python<'py>, name: &str) -> PyResult<Bound<'py, PyAny>> {
        let Ok(index) = self.schema.index_of(name) else {
            return Err(PyKeyError::new_err(name.to_owned()));
        };
        let mut values = Vec::with_capacity(self.__len__());
        for batch in &self.batches {
            values.extend_from_slice(&numbers(name, batch.column(index))?);
        }
        Ok(values.into_pyarray(py).into_any())
    }

    /// Creates a table from its pickled columns.
    #[staticmethod]
    fn _of_columns(columns: Vec<Column<'_>>) -> PyResult<Self> {
        let (mut fields, mut arrays) = (Vec::new(), Vec::new());
        for (name, metadata, values, known) in columns {
            let known = known.map(|known| known.as_array().to_vec());
            let array = values.into_array(known);
            let field = Field::new(&name, array.data_type().clone(), name != "t_s");
            fields.push(field.with_metadata(metadata));
            arrays.push(array);
        }
        let schema = Arc::new(Schema::new(fields));
        let batch = RecordBatch::try_new(Arc::clone(&schema), arrays);
        let batches = vec![batch.map_err(|error| data_error(error, None))?];
        Ok(Table { batches, schema })
    }

    fn __reduce__<'py>(
        slf: &Bound<'py, Self>,
    ) -> PyResult<(Bound<'py, PyAny>, (Bound<'py, PyList>,))> {
        let (py, table) = (slf.py(), slf.get());
        let columns = PyList::empty(py);
        for (index, field) in table.schema.fields().iter().enumerate() {
            let parts = table.batches.iter().map(|batch| batch.column(index));
            let known = parts
                .clone()
                .flat_map(|part| (0..part.len()).map(|i| part.is_valid(i)));
            let known: Vec<bool> = known.collect();
            let known = known.contains(&false).then(|| known.into_pyarray(py));
            let values = match field.data_type() {
                DataType::Int32 => {
                    let values = parts.flat_map(|part| part.as_primitive::<Int32Type>().values());
                    values
                        .copied()
                        .collect::<Vec<i32>>()
                        .into_pyarray(py)
                        .into_any()
                }
                DataType::Boolean => {
                    let values = parts.flat_map(|part| part.as_boolean().values().iter());
                    values.collect::<Vec<bool>>().into_pyarray(py).into_any()
                }
                _ => {
                    let values = parts.flat_map(|part| part.as_primitive::<Float64Type>().values());
                    values
                        .copied()
                        .collect::<Vec<f64>>()
                        .into_pyarray(py)
                        .into_any()
                }
            };
            columns.append((field.name(), field.metadata().clone(), values, known))?;
        }
        Ok((slf.getattr("_of_columns")?, (columns,)))
    }

    fn __repr__(&self) -> String {
        format!("Table({} rows: {})", self.__len__(), self.keys().join(", "))
    }
}

/// The names and types of the columns of results, in the order of [`batch`].
pub(crate) fn schema(model: &Model, with_reasons: bool) -> SchemaRef {
    let mut fields = Vec::new();
    let reasons = [
        ("coverage", DataType::Float64),
        ("dominant_rule", DataType::Int32),
        ("clamped", DataType::Boolean),
    ];
    for output in &model.outputs {
        let has_interval = with_reasons && model.has_interval(output);
        let output = &output.variable.name;
        fields.push(Field::new(output, DataType::Float64, true));
        for end in ["low", "high"].iter().filter(|_| has_interval) {
            let name = format!("{output}_{end}");
            fields.push(Field::new(name, DataType::Float64, true));
        }
        for (reason, kind) in reasons.iter().filter(|_| with_reasons) {
            let name = match model.outputs.len() {
                1 => (*reason).to_owned(),
                _ => format!("{output}_{reason}"),
            };
            fields.push(Field::new(name, kind.clone(), true));
        }
    }
    Arc::new(Schema::new(fields))
}

/// Results as a batch of a table.
pub(crate) fn batch(schema: &SchemaRef, results: Vec<Columns>) -> PyResult<RecordBatch> {
    let mut columns: Vec<ArrayRef> = Vec::new();
    for result in results {
        columns.push(known(result.value));
        let Some(reasons) = result.reasons else {
            continue;
        };
        if let Some(ends) = reasons.ends {
            columns.extend([known(ends.low), known(ends.high)]);
        }
        let rules = reasons.dominant_rule.into_iter();
        let rules = rules.map(|rule| (rule != NO_RULE).then_some(rule));
        columns.push(Arc::new(Float64Array::from(reasons.coverage)));
        columns.push(Arc::new(rules.collect::<Int32Array>()));
        columns.push(Arc::new(BooleanArray::from(reasons.clamped)));
    }
    RecordBatch::try_new(Arc::clone(schema), columns).map_err(|error| data_error(error, None))
}

/// A column in which NaN (unknown) becomes null.
pub(crate) fn known(values: Vec<f64>) -> ArrayRef {
    Arc::new(if values.iter().any(|value| value.is_nan()) {
        let values = values.into_iter();
        values
            .map(|value| (!value.is_nan()).then_some(value))
            .collect()
    } else {
        Float64Array::from(values)
    })
}
