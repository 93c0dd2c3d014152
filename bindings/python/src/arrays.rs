//! NumPy arrays as arguments: any broadcastable shapes, any strides, any numeric type.

use numpy::{PyArrayDyn, PyArrayMethods, PyReadonlyArrayDyn, PyUntypedArrayMethods};
use pyo3::{prelude::*, sync::PyOnceLock, types::PyList};

/// Contiguous arrays of the same shape.
pub(crate) struct Arrays<'py> {
    arrays: Vec<PyReadonlyArrayDyn<'py, f64>>,
    pub(crate) shape: Vec<usize>,
}

impl<'py> Arrays<'py> {
    /// Returns the values as contiguous arrays of the same shape. Values that are not such arrays
    /// yet are converted by `flagred._arrays.alike`.
    pub(crate) fn new(py: Python<'py>, values: &[Bound<'py, PyAny>]) -> PyResult<Self> {
        if let Some(arrays) = Self::of(values) {
            return Ok(arrays);
        }
        static ALIKE: PyOnceLock<Py<PyAny>> = PyOnceLock::new();
        let alike = ALIKE.import(py, "flagred._arrays", "alike")?;
        let made: Vec<Bound<'py, PyAny>> = alike.call1((PyList::new(py, values)?,))?.extract()?;
        Self::of(&made).ok_or_else(|| {
            crate::errors::data_error(
                "the inputs must be arrays of numbers of the same shape",
                None,
            )
        })
    }

    /// The values without a copy; `None` unless all are contiguous arrays of the same shape.
    fn of(values: &[Bound<'py, PyAny>]) -> Option<Self> {
        let arrays = values.iter().map(|value| {
            let array = value.cast::<PyArrayDyn<f64>>().ok()?;
            let array = array
                .is_c_contiguous()
                .then(|| array.try_readonly().ok())??;
            // `as_slice` fails if the array is not aligned.
            array.as_slice().is_ok().then_some(array)
        });
        let arrays: Vec<_> = arrays.collect::<Option<_>>()?;
        let shape = arrays.first()?.shape().to_vec();
        let is_alike = arrays.iter().all(|array| array.shape() == shape);
        is_alike.then_some(Arrays { arrays, shape })
    }

    pub(crate) fn columns(&self) -> PyResult<Vec<&[f64]>> {
        let slices = self.arrays.iter().map(|array| Ok(array.as_slice()?));
        slices.collect()
    }
}
