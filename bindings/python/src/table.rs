//! A table that Arrow's C interface hands on: to pyarrow, polars, pandas, DuckDB.

use std::sync::Arc;

use arrow_array::{ArrayRef, BooleanArray, Float64Array, Int32Array, RecordBatch};
use arrow_schema::{DataType, Field, Schema, SchemaRef};
use numpy::IntoPyArray;
use pyo3::{exceptions::PyKeyError, prelude::*, types::PyCapsule};

use crate::{
    arrow::{self, numbers},
    errors::data_error,
    outcome::{Columns, NO_RULE},
};

/// Columns of numbers. Whatever takes Arrow streams takes it: ``pyarrow.table(t)``, ``polars.DataFrame(t)``; and
/// ``pandas.DataFrame(dict(t))`` takes its NumPy columns.
#[pyclass(frozen, mapping, module = "flagred")]
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
        // The protocol allows to ignore the wish.
        let _ = requested_schema;
        arrow::export(py, self.batches.clone(), Arc::clone(&self.schema))
    }

    /// The names of the columns.
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

    fn __repr__(&self) -> String {
        format!("Table({} rows: {})", self.__len__(), self.keys().join(", "))
    }
}

/// The names and types of the columns of results, as [`batch`] makes them.
pub(crate) fn schema(outputs: &[String], with_reasons: bool) -> SchemaRef {
    let mut fields = Vec::new();
    let reasons = [
        ("coverage", DataType::Float64),
        ("dominant_rule", DataType::Int32),
        ("clamped", DataType::Boolean),
    ];
    for output in outputs {
        fields.push(Field::new(output, DataType::Float64, true));
        for (reason, kind) in reasons.iter().filter(|_| with_reasons) {
            let name = match outputs {
                [_] => (*reason).to_owned(),
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
        let rules = reasons.dominant_rule.into_iter();
        let rules = rules.map(|rule| (rule != NO_RULE).then_some(rule));
        columns.push(Arc::new(Float64Array::from(reasons.coverage)));
        columns.push(Arc::new(rules.collect::<Int32Array>()));
        columns.push(Arc::new(BooleanArray::from(reasons.clamped)));
    }
    RecordBatch::try_new(Arc::clone(schema), columns).map_err(|error| data_error(error, None))
}

/// A column in which NaN, which is unknown, is null.
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
