//! The command `flagred` in this process.

use std::ffi::OsString;

use pyo3::prelude::*;

/// Runs the command of a command line, which begins with the name of the program, and returns its exit code.
#[pyfunction]
pub(crate) fn _command(py: Python<'_>, arguments: Vec<OsString>) -> u8 {
    py.detach(|| flagred_cli::run(arguments.into_iter()))
}
