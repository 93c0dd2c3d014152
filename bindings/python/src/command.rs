//! The command `flagred` in this process.

use std::ffi::OsString;

use pyo3::prelude::*;

/// Runs `flagred` with these arguments, the first of which is the name of the program, and returns the exit code.
#[pyfunction]
pub(crate) fn _command(py: Python<'_>, arguments: Vec<OsString>) -> u8 {
    py.detach(|| flagred_cli::run(arguments.into_iter()))
}
