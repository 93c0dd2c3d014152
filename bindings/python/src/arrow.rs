//! Arrow's C interface in Python capsules: tables of other libraries in, tables out.
//!
//! The only place of this package that is unsafe: a capsule is a pointer to a C struct.
#![allow(unsafe_code)]

use std::borrow::Cow;

use arrow_array::{
    Array, ArrayRef, RecordBatch, RecordBatchIterator, RecordBatchReader, StructArray,
    cast::AsArray,
    ffi::{FFI_ArrowArray, FFI_ArrowSchema, from_ffi},
    ffi_stream::{ArrowArrayStreamReader, FFI_ArrowArrayStream},
    types::{
        ArrowPrimitiveType, Decimal128Type, Float16Type, Float32Type, Float64Type, Int8Type,
        Int16Type, Int32Type, Int64Type, UInt8Type, UInt16Type, UInt32Type, UInt64Type,
    },
};
use arrow_schema::{DataType, SchemaRef};
use pyo3::{prelude::*, types::PyCapsule};

use crate::errors::data_error;

/// A stream that is handed to another library.
#[repr(transparent)]
struct Exported(FFI_ArrowArrayStream);

// SAFETY: the stream owns its batches, which are `Send`, and nothing else refers to it.
unsafe impl Send for Exported {}

/// Batches as a capsule.
pub(crate) fn export(
    py: Python<'_>,
    batches: Vec<RecordBatch>,
    schema: SchemaRef,
) -> PyResult<Bound<'_, PyCapsule>> {
    let reader = RecordBatchIterator::new(batches.into_iter().map(Ok), schema);
    let stream = FFI_ArrowArrayStream::new(Box::new(reader));
    // Who takes the stream leaves an empty one in the capsule, and the capsule releases what is left.
    PyCapsule::new_with_value(py, Exported(stream), c"arrow_array_stream")
}

/// The batches of a table of another library, one after another.
pub(crate) fn import(table: &Bound<'_, PyAny>) -> PyResult<Box<dyn RecordBatchReader + Send>> {
    if !table.hasattr("__arrow_c_stream__")? {
        return import_batch(table);
    }
    let capsule = table.call_method0("__arrow_c_stream__")?;
    let capsule = capsule.cast::<PyCapsule>()?;
    let pointer = capsule.pointer_checked(Some(c"arrow_array_stream"))?;
    // SAFETY: a capsule of this name points to an ArrowArrayStream, which is moved out and marked as released.
    let reader = unsafe { ArrowArrayStreamReader::from_raw(pointer.as_ptr().cast()) };
    Ok(Box::new(reader.map_err(|error| data_error(error, None))?))
}

/// One batch: an Arrow array of structs.
fn import_batch(table: &Bound<'_, PyAny>) -> PyResult<Box<dyn RecordBatchReader + Send>> {
    let capsules = table.call_method0("__arrow_c_array__")?;
    let (schema, array): (Bound<'_, PyCapsule>, Bound<'_, PyCapsule>) = capsules.extract()?;
    let schema = schema.pointer_checked(Some(c"arrow_schema"))?;
    let array = array.pointer_checked(Some(c"arrow_array"))?;
    // SAFETY: a capsule of this name points to an ArrowSchema, which lives as long as the capsule.
    let schema = unsafe { &*schema.as_ptr().cast::<FFI_ArrowSchema>() };
    // SAFETY: a capsule of this name points to an ArrowArray, which is moved out and marked as released.
    let array = unsafe { FFI_ArrowArray::from_raw(array.as_ptr().cast()) };
    // SAFETY: by the protocol the array is what the schema says.
    let data = unsafe { from_ffi(array, schema) }.map_err(|error| data_error(error, None))?;
    if !matches!(data.data_type(), DataType::Struct(_)) {
        let message = format!("a column of {} is no table", data.data_type());
        return Err(data_error(
            message,
            Some("give a table with a column for each input, or arrays".into()),
        ));
    }
    let batch = RecordBatch::from(StructArray::from(data));
    let schema = batch.schema();
    Ok(Box::new(RecordBatchIterator::new([Ok(batch)], schema)))
}

/// A column as numbers; NaN is unknown.
pub(crate) fn numbers<'a>(name: &str, column: &'a ArrayRef) -> PyResult<Cow<'a, [f64]>> {
    fn of<T: ArrowPrimitiveType>(
        column: &ArrayRef,
        number: impl Fn(T::Native) -> f64,
    ) -> Cow<'_, [f64]> {
        let values = column.as_primitive::<T>().iter();
        let numbers = values.map(|value| value.map_or(f64::NAN, &number));
        Cow::Owned(numbers.collect())
    }
    Ok(match column.data_type() {
        DataType::Float64 if column.null_count() == 0 => {
            Cow::Borrowed(&column.as_primitive::<Float64Type>().values()[..])
        }
        DataType::Float64 => of::<Float64Type>(column, |value| value),
        DataType::Float32 => of::<Float32Type>(column, f64::from),
        DataType::Float16 => of::<Float16Type>(column, f64::from),
        DataType::Int8 => of::<Int8Type>(column, f64::from),
        DataType::Int16 => of::<Int16Type>(column, f64::from),
        DataType::Int32 => of::<Int32Type>(column, f64::from),
        DataType::Int64 => of::<Int64Type>(column, |value| value as f64),
        DataType::UInt8 => of::<UInt8Type>(column, f64::from),
        DataType::UInt16 => of::<UInt16Type>(column, f64::from),
        DataType::UInt32 => of::<UInt32Type>(column, f64::from),
        DataType::UInt64 => of::<UInt64Type>(column, |value| value as f64),
        DataType::Decimal128(_, scale) => {
            let unit = 10f64.powi((*scale).into());
            of::<Decimal128Type>(column, |value| value as f64 / unit)
        }
        DataType::Boolean => {
            let values = column.as_boolean().iter();
            let numbers =
                values.map(|value| value.map_or(f64::NAN, |value| f64::from(u8::from(value))));
            Cow::Owned(numbers.collect())
        }
        DataType::Null => Cow::Owned(vec![f64::NAN; column.len()]),
        other => {
            let message = format!("column `{name}` holds {other}, not numbers");
            let help = "convert it to numbers first".to_owned();
            return Err(data_error(message, Some(help)));
        }
    })
}
