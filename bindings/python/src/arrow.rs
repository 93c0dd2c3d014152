//! Arrow's C interface in Python capsules: imports tables from other libraries and exports our own tables.
//!
//! This is the only file of this package with unsafe code: a capsule contains a pointer to a C struct.
#![allow(unsafe_code)]

use std::{
    borrow::Cow,
    cell::Cell,
    ffi::{CStr, c_void},
    panic::{AssertUnwindSafe, catch_unwind, set_hook, take_hook},
    ptr::NonNull,
    sync::Once,
};

use arrow_array::{
    Array, ArrayRef, RecordBatch, RecordBatchIterator, StructArray,
    cast::AsArray,
    ffi::{FFI_ArrowArray, FFI_ArrowSchema, from_ffi_and_data_type},
    ffi_stream::FFI_ArrowArrayStream,
    types::{
        ArrowPrimitiveType, Decimal128Type, Float16Type, Float32Type, Float64Type, Int8Type,
        Int16Type, Int32Type, Int64Type, UInt8Type, UInt16Type, UInt32Type, UInt64Type,
    },
};
use arrow_schema::{DataType, Fields, SchemaRef};
use pyo3::{prelude::*, types::PyCapsule};

use crate::errors::data_error;

/// A stream that is passed to another library.
#[repr(transparent)]
struct ExportedStream(FFI_ArrowArrayStream);

// SAFETY: the stream owns its batches, which are `Send`, and nothing else refers to it.
unsafe impl Send for ExportedStream {}

/// Exports batches as an Arrow stream in a Python capsule.
pub(crate) fn export(
    py: Python<'_>,
    batches: Vec<RecordBatch>,
    schema: SchemaRef,
) -> PyResult<Bound<'_, PyCapsule>> {
    let reader = RecordBatchIterator::new(batches.into_iter().map(Ok), schema);
    let stream = FFI_ArrowArrayStream::new(Box::new(reader));
    // A consumer moves the stream out and leaves an empty one in the capsule; the capsule releases whatever remains.
    PyCapsule::new_with_value(py, ExportedStream(stream), c"arrow_array_stream")
}

/// A table from another library.
pub(crate) struct ForeignTable {
    fields: Fields,
    source: Source,
}

enum Source {
    Stream(FFI_ArrowArrayStream),
    /// A single batch; `None` after it has been read.
    Batch(Option<StructArray>),
}

/// Imports a table from another library.
///
/// # Errors
/// The value is not a table, or its capsules violate Arrow's protocol.
pub(crate) fn import(table: &Bound<'_, PyAny>) -> PyResult<ForeignTable> {
    match table.hasattr("__arrow_c_stream__")? {
        true => import_stream(&table.call_method0("__arrow_c_stream__")?),
        false => import_batch(&table.call_method0("__arrow_c_array__")?),
    }
}

fn import_stream(capsule: &Bound<'_, PyAny>) -> PyResult<ForeignTable> {
    let pointer = capsule_pointer(capsule, c"arrow_array_stream")?;
    // SAFETY: a capsule of this name points to an ArrowArrayStream, which is moved out and marked as released.
    let mut stream = unsafe { FFI_ArrowArrayStream::from_raw(pointer.cast().as_ptr()) };
    let Some(get_schema) = stream.get_schema.filter(|_| stream.release.is_some()) else {
        return Err(taken("stream"));
    };
    let mut schema = FFI_ArrowSchema::empty();
    // SAFETY: the stream is not released; it fills the schema, which is ours.
    let code = unsafe { get_schema(&mut stream, &mut schema) };
    if code != 0 {
        return Err(data_error(last_error(&mut stream, code), None));
    }
    Ok(ForeignTable {
        fields: fields(&schema)?,
        source: Source::Stream(stream),
    })
}

/// Imports a table that is a single batch: an Arrow array of structs.
fn import_batch(capsules: &Bound<'_, PyAny>) -> PyResult<ForeignTable> {
    let pair: Result<(Bound<'_, PyAny>, Bound<'_, PyAny>), PyErr> = capsules.extract();
    let (schema, array) = pair.map_err(|_| mismatched("a pair of capsules"))?;
    let schema = capsule_pointer(&schema, c"arrow_schema")?;
    let array = capsule_pointer(&array, c"arrow_array")?;
    // SAFETY: a capsule of this name points to an ArrowSchema, which lives as long as the capsule.
    let is_taken = unsafe { schema.cast::<SchemaLayout>().as_ref() }
        .release
        .is_none();
    // SAFETY: a capsule of this name points to an ArrowArray, which is moved out and marked as released.
    let array = unsafe { FFI_ArrowArray::from_raw(array.cast().as_ptr()) };
    if is_taken || array.is_released() {
        return Err(taken("array"));
    }
    // SAFETY: the schema lives as long as the capsule, and it is not released, so its texts are valid.
    let fields = fields(unsafe { schema.cast::<FFI_ArrowSchema>().as_ref() })?;
    let batch = batch(array, &fields).map_err(|error| data_error(error, None))?;
    Ok(ForeignTable {
        fields,
        source: Source::Batch(Some(batch)),
    })
}

/// The layout of `ArrowSchema` in Arrow's C data interface, which never changes. The crate `arrow` does not expose
/// whether a schema is released.
#[repr(C)]
struct SchemaLayout {
    texts: [*const c_void; 3],
    flags: i64,
    children: i64,
    parts: [*const c_void; 2],
    release: Option<unsafe extern "C" fn(*mut c_void)>,
}

impl ForeignTable {
    /// The names of the columns, in their order.
    pub(crate) fn names(&self) -> Vec<String> {
        self.fields
            .iter()
            .map(|field| field.name().clone())
            .collect()
    }

    /// The next batch of rows; whole rows may be null.
    pub(crate) fn next(&mut self) -> Option<Result<StructArray, String>> {
        let stream = match &mut self.source {
            Source::Batch(batch) => return batch.take().map(Ok),
            Source::Stream(stream) => stream,
        };
        let get_next = stream.get_next?;
        let mut array = FFI_ArrowArray::empty();
        // SAFETY: the stream is not released; it fills the array, which is ours.
        match unsafe { get_next(stream, &mut array) } {
            0 if array.is_released() => None,
            0 => Some(batch(array, &self.fields)),
            code => Some(Err(last_error(stream, code))),
        }
    }
}

/// Returns the pointer in a capsule with the given name.
fn capsule_pointer(capsule: &Bound<'_, PyAny>, name: &CStr) -> PyResult<NonNull<c_void>> {
    let wanted = || mismatched(&format!("a capsule `{}`", name.to_string_lossy()));
    let capsule = capsule.cast::<PyCapsule>().map_err(|_| wanted())?;
    capsule.pointer_checked(Some(name)).map_err(|_| wanted())
}

fn mismatched(wanted: &str) -> PyErr {
    data_error(
        format!("the table does not provide {wanted}, which Arrow requires"),
        None,
    )
}

fn taken(what: &str) -> PyErr {
    let help = "ask the table for new capsules".to_owned();
    data_error(format!("the Arrow {what} was already consumed"), Some(help))
}

fn last_error(stream: &mut FFI_ArrowArrayStream, code: i32) -> String {
    // SAFETY: the stream is not released.
    let text = stream.get_last_error.map(|get| unsafe { get(stream) });
    match text.filter(|text| !text.is_null()) {
        // SAFETY: according to the protocol, the text is valid until the stream is used again.
        Some(text) => unsafe { CStr::from_ptr(text) }
            .to_string_lossy()
            .into_owned(),
        None => format!("the Arrow stream failed with error {code}"),
    }
}

struct PanicError;

/// Runs a function that may panic, and returns a panic as an error. The panic message is not printed to standard error,
/// because the caller reports its own error.
fn catch_panic<T>(run: impl FnOnce() -> T) -> Result<T, PanicError> {
    thread_local! {
        static IS_SILENT: Cell<bool> = const { Cell::new(false) };
    }
    static HOOK: Once = Once::new();
    HOOK.call_once(|| {
        let report = take_hook();
        set_hook(Box::new(move |info| {
            if !IS_SILENT.get() {
                report(info);
            }
        }));
    });
    IS_SILENT.set(true);
    let done = catch_unwind(AssertUnwindSafe(run));
    IS_SILENT.set(false);
    done.map_err(|_| PanicError)
}

/// Converts an Arrow schema to the columns of a table.
fn fields(schema: &FFI_ArrowSchema) -> PyResult<Fields> {
    let read = catch_panic(|| DataType::try_from(schema));
    match read {
        Ok(Ok(DataType::Struct(fields))) => Ok(fields),
        Ok(Ok(other)) => {
            let help = "give a table with a column for each input, or arrays".to_owned();
            Err(data_error(
                format!("a column of {other} is not a table"),
                Some(help),
            ))
        }
        Ok(Err(error)) => Err(data_error(error, None)),
        Err(PanicError) => Err(mismatched("a schema")),
    }
}

/// Converts an Arrow array to a batch with these columns. The crate `arrow` panics if a table violates the protocol;
/// such a panic becomes an error.
fn batch(array: FFI_ArrowArray, fields: &Fields) -> Result<StructArray, String> {
    let broken = || "the Arrow array does not have the columns of its schema".to_owned();
    if array.num_children() != fields.len() {
        return Err(broken());
    }
    let kind = DataType::Struct(fields.clone());
    let read = catch_panic(|| {
        // SAFETY: according to the protocol, the array matches the schema.
        unsafe { from_ffi_and_data_type(array, kind) }.map(StructArray::from)
    });
    read.map_err(|PanicError| broken())?
        .map_err(|error| error.to_string())
}

/// Returns a column of a batch as numbers, where NaN means unknown. If a whole row is null, its value is unknown,
/// whatever the column contains.
pub(crate) fn column<'a>(
    name: &str,
    batch: &'a StructArray,
    column: usize,
) -> PyResult<Cow<'a, [f64]>> {
    let mut found = numbers(name, batch.column(column))?;
    if let Some(nulls) = batch.nulls().filter(|nulls| nulls.null_count() > 0) {
        for (number, is_known) in found.to_mut().iter_mut().zip(nulls) {
            if !is_known {
                *number = f64::NAN;
            }
        }
    }
    Ok(found)
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
            let message = format!("column `{name}` contains {other}, not numbers");
            let help = "convert it to numbers first".to_owned();
            return Err(data_error(message, Some(help)));
        }
    })
}
