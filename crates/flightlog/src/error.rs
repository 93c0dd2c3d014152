//! Errors while reading a log.

use std::io::ErrorKind;

use crate::FileKind;

/// An error that prevents reading a log. A damaged log is not an error: its undamaged part is read, and its
/// [`Report`](crate::Report) counts the damage.
///
/// # Example
/// ```
/// use flagred_flightlog::{Options, ReadError};
///
/// let error = flagred_flightlog::read(&b"\x89PNG\r\n\x1a\n"[..], &Options::default()).unwrap_err();
/// assert!(matches!(error, ReadError::NotALog { .. }));
/// assert_eq!(error.to_string(), "`the log` is a PNG picture, not a flight log");
/// ```
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum ReadError {
    /// The file could not be opened, or reading it failed.
    #[error("`{path}` cannot be read: {source}")]
    Io {
        /// The path of the file, as given by the user; `standard input`, or `the log` if the log was not read from a
        /// file.
        path: String,
        /// The error of the operating system.
        source: std::io::Error,
    },
    /// The file is empty.
    #[error("`{path}` is empty")]
    Empty {
        /// The path of the file, as given by the user.
        path: String,
    },
    /// The file is not a flight log.
    #[error("`{path}` is {what}, not a flight log")]
    NotALog {
        /// The path of the file, as given by the user.
        path: String,
        /// The kind of file, such as `a PNG picture`.
        what: String,
    },
    /// The file is a flight log in a format that is not supported.
    #[error("`{path}` is {what}, a format that is not supported")]
    NotRead {
        /// The path of the file, as given by the user.
        path: String,
        /// The format.
        what: String,
    },
    /// The log contradicts the range of motor outputs that the user gave for it.
    #[error("`{path}` {problem}")]
    Range {
        /// The path of the file, as given by the user.
        path: String,
        /// The contradiction.
        problem: String,
        /// Advice on what to do.
        help: &'static str,
    },
    /// A flight CSV has columns or header values that cannot be used.
    #[error("`{path}`, line {line}: {problem}")]
    Csv {
        /// The path of the file, as given by the user.
        path: String,
        /// The line in the file, from 1.
        line: u64,
        /// The problem in that line.
        problem: String,
        /// Advice on what to do.
        help: String,
    },
}

impl ReadError {
    /// Advice on what to do, in addition to the message.
    pub fn help(&self) -> Option<&str> {
        match self {
            Self::Io { source, path, .. } => match source.kind() {
                ErrorKind::NotFound if path.starts_with("http") => {
                    Some("download the log first, and name the file")
                }
                ErrorKind::NotFound if path.contains('*') => Some("no file matches this pattern"),
                ErrorKind::NotFound => Some("check the path"),
                ErrorKind::IsADirectory => Some("name the logs in it"),
                _ => None,
            },
            Self::Empty { path } if path == STDIN => {
                Some("the command before the pipe printed nothing")
            }
            Self::Empty { .. } => {
                Some("the download or copy may have failed: download the log again")
            }
            Self::NotRead { what, .. } if what != SDLOG2 => FileKind::named(what)?.help,
            Self::NotRead { .. } => Some(
                "it cannot be converted to ULog: write a flight CSV (docs/flight-csv.md) of its OUT0 messages, or fly with PX4 1.4 or newer, which logs as ULog (.ulg)",
            ),
            Self::NotALog { what, .. } => FileKind::named(what).and_then(FileKind::help_for_log).or(Some(
                "flight logs are ArduPilot .bin and .log, PX4 .ulg, MAVLink .tlog and flight CSV, plain or gzipped",
            )),
            Self::Csv { help, .. } => Some(help),
            Self::Range { help, .. } => Some(help),
        }
    }

    /// The same error with the name of the log, for a log that was read from bytes without a path.
    ///
    /// # Example
    /// ```
    /// let error = flagred_flightlog::read(&b""[..], &flagred_flightlog::Options::default()).unwrap_err();
    /// assert_eq!(error.with_path("flight.bin").to_string(), "`flight.bin` is empty");
    /// ```
    #[must_use]
    pub fn with_path(mut self, name: &str) -> Self {
        match &mut self {
            Self::Io { path, .. }
            | Self::Empty { path }
            | Self::NotALog { path, .. }
            | Self::NotRead { path, .. }
            | Self::Range { path, .. }
            | Self::Csv { path, .. } => name.clone_into(path),
        }
        self
    }
}

/// Description of a log in PX4's original format.
pub(crate) const SDLOG2: &str = "an sdlog2 log (.px4log) of PX4 before ULog";

/// The name of standard input in messages.
pub(crate) const STDIN: &str = "standard input";

/// The path in an error until the caller sets it.
pub(crate) const UNNAMED: &str = "the log";

pub(crate) fn io_error(source: std::io::Error) -> ReadError {
    ReadError::Io {
        path: UNNAMED.into(),
        source,
    }
}
