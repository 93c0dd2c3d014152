//! Conversion of errors and findings to Python; the classes are in `python/flagred/errors.py`.

use std::io;

use flagred_flightlog::ReadError;
use flagred_report::diagnostics::{Style, draw};
use fuzzy::{
    Findings,
    diagnostic::{Diagnostic, Severity},
};
use pyo3::{exceptions::PyOSError, prelude::*, sync::PyOnceLock, types::PyType};

pyo3::import_exception!(flagred.errors, DataError);
pyo3::import_exception!(flagred.errors, LogError);
pyo3::import_exception!(flagred.errors, RuleSetError);

const STYLE: Style = Style {
    colored: false,
    advice: |_| None,
    all: "`findings` of the error lists them",
    is_quoted: |text| {
        flagred_interchange::Format::of(text).is_some() || flagred::loaded::is_meant_as_rules(text)
    },
};

/// A [`DataError`] with help.
pub(crate) fn data_error(message: impl std::fmt::Display, help: Option<String>) -> PyErr {
    match help {
        Some(help) => DataError::new_err(format!("{message}\n  help: {help}")),
        None => DataError::new_err(message.to_string()),
    }
}

/// A [`LogError`] with help.
pub(crate) fn log_error(message: impl std::fmt::Display, help: Option<&str>) -> PyErr {
    match help {
        Some(help) => LogError::new_err(format!("{message}\n  help: {help}")),
        None => LogError::new_err(message.to_string()),
    }
}

/// The error of a file that cannot be read, as raised by `open`.
pub(crate) fn os_error(
    py: Python<'_>,
    error: &io::Error,
    path: &str,
    help: Option<&str>,
) -> PyResult<PyErr> {
    let help = help.map_or(String::new(), |help| format!(" ({help})"));
    Ok(match error.raw_os_error() {
        Some(number) => {
            let reported = py.import("os")?.call_method1("strerror", (number,))?;
            PyOSError::new_err((number, format!("{reported}{help}"), path.to_owned()))
        }
        None => PyOSError::new_err(format!("`{path}` cannot be read: {error}{help}")),
    })
}

/// The error of a log that cannot be read.
pub(crate) fn read_error(py: Python<'_>, error: &ReadError) -> PyErr {
    match error {
        ReadError::Io { path, source } => {
            os_error(py, source, path, error.help()).unwrap_or_else(|error| error)
        }
        error => log_error(error, error.help()),
    }
}

/// A [`RuleSetError`] whose message shows the findings with the source lines that they refer to.
pub(crate) fn rule_set_error(py: Python<'_>, findings: &Findings, file: &str, text: &str) -> PyErr {
    match diagnostics(py, findings, file, text) {
        Ok(list) => {
            let list: Vec<Py<PyAny>> = list.into_iter().map(Bound::unbind).collect();
            RuleSetError::new_err((draw(&findings.0, file, text, STYLE), list))
        }
        Err(error) => error,
    }
}

/// Findings as objects of `flagred.types.Diagnostic`.
pub(crate) fn diagnostics<'py>(
    py: Python<'py>,
    findings: &Findings,
    file: &str,
    text: &str,
) -> PyResult<Vec<Bound<'py, PyAny>>> {
    static CLASS: PyOnceLock<Py<PyType>> = PyOnceLock::new();
    let class = CLASS.import(py, "flagred.errors", "Diagnostic")?;
    let object = |finding: &Diagnostic| {
        let severity = match finding.severity {
            Severity::Error => "error",
            Severity::Warning => "warning",
            Severity::Note => "note",
        };
        class.call1((
            severity,
            finding.code,
            &finding.message,
            finding.help.as_deref(),
            file,
            finding.position.map(|position| position.line),
            finding.position.map(|position| position.column),
            draw(std::slice::from_ref(finding), file, text, STYLE),
        ))
    };
    findings.0.iter().map(object).collect()
}
