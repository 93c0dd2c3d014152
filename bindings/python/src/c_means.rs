//! Fuzzy c-means: `flagred.c_means`.

use flagred_tuning::c_means::{Clusters, Settings, c_means};
use numpy::{PyArray2, PyReadonlyArray2};
use pyo3::prelude::*;

use crate::{errors::data_error, threads::interruptible};

/// The cluster centers, the degrees of membership, the loss, and the number of iterations.
type ClusterArrays<'py> = (
    Bound<'py, PyArray2<f64>>,
    Bound<'py, PyArray2<f64>>,
    f64,
    u32,
);

/// Finds clusters of the rows of a matrix.
#[pyfunction]
pub(crate) fn _c_means<'py>(
    py: Python<'py>,
    rows: PyReadonlyArray2<'py, f64>,
    clusters: usize,
    fuzzifier: f64,
    iterations: u32,
    starts: u32,
    seed: u64,
) -> PyResult<ClusterArrays<'py>> {
    let settings = Settings {
        clusters,
        fuzzifier,
        iterations,
        starts,
        seed,
    };
    let matrix = rows.as_array();
    let rows = matrix.rows().into_iter();
    let rows: Vec<Vec<f64>> = rows.map(|row| row.to_vec()).collect();
    let found = interruptible(py, move || c_means(&rows, &settings))?;
    let Clusters {
        centers,
        degrees,
        loss,
        iterations,
    } = found.map_err(|error| data_error(error, None))?;
    let matrix = |rows: Vec<Vec<f64>>| PyArray2::from_vec2(py, &rows);
    Ok((matrix(centers)?, matrix(degrees)?, loss, iterations))
}
