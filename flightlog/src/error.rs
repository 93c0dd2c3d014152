//! Why a file could not be read at all.

use std::io::ErrorKind;

/// A log that could not be read. A damaged log is no error: it gives what is there,
/// and says in its [`Report`](crate::Report) what is missing.
///
/// # Example
/// ```
/// use flightlog::{Options, ReadError};
///
/// let error = flightlog::read(&b"\x89PNG\r\n\x1a\n"[..], &Options::default()).unwrap_err();
/// assert!(matches!(error, ReadError::NotALog { .. }));
/// assert_eq!(error.to_string(), "`the log` is a PNG picture, not a flight log");
/// ```
#[derive(Debug, thiserror::Error)]
pub enum ReadError {
    /// The file could not be opened, or reading it failed.
    #[error("`{path}` cannot be read: {source}")]
    Io {
        /// The path as the user gave it; `standard input`, or `the log` for a reader.
        path: String,
        /// What the system said.
        source: std::io::Error,
    },
    /// There is nothing in it.
    #[error("`{path}` is empty")]
    Empty {
        /// The path as the user gave it.
        path: String,
    },
    /// It is something else than a flight log.
    #[error("`{path}` is {what}, not a flight log")]
    NotALog {
        /// The path as the user gave it.
        path: String,
        /// What it looks like, such as `a PNG picture`.
        what: String,
    },
    /// It is a flight CSV, but its columns or values make no flight.
    #[error("`{path}`, line {line}: {problem}")]
    Csv {
        /// The path as the user gave it.
        path: String,
        /// Line in the file, from 1.
        line: u64,
        /// What is wrong there.
        problem: String,
        /// What to do about it.
        help: String,
    },
}

impl ReadError {
    /// What to do about it, apart from the message.
    ///
    /// ```
    /// let picture = b"\x89PNG\r\n\x1a\n and so on";
    /// let error = flightlog::read(&picture[..], &flightlog::Options::default()).unwrap_err();
    /// assert_eq!(error.to_string(), "`the log` is a PNG picture, not a flight log");
    /// assert!(error.help().is_some());
    /// ```
    pub fn help(&self) -> Option<&str> {
        match self {
            Self::Io { source, .. } => match source.kind() {
                ErrorKind::NotFound => Some("check the path"),
                ErrorKind::IsADirectory => Some("name the logs in it"),
                _ => None,
            },
            Self::Empty { .. } => Some("the download or copy may have failed: fetch the log again"),
            Self::NotALog { what, .. } if what.contains("git-lfs") => {
                Some("fetch the log itself with `git lfs pull`")
            }
            Self::NotALog { what, .. } if what == SDLOG2 => Some(
                "PX4 has logged as ULog (.ulg) since 2016: export the flight as flight CSV, or log it again with newer firmware",
            ),
            Self::NotALog { what, .. } if what == TEXT => Some(
                "a flight CSV begins with the names of its columns, commas between them: `t_s`, and `pwm1` or `motor1` and so on; a text log of ArduPilot begins with `FMT` lines",
            ),
            Self::NotALog { .. } => Some(
                "flight logs are ArduPilot .bin and .log, PX4 .ulg, MAVLink .tlog and flight CSV, plain or gzipped",
            ),
            Self::Csv { help, .. } => Some(help),
        }
    }

    pub(crate) fn with_path(mut self, name: &str) -> Self {
        match &mut self {
            Self::Io { path, .. }
            | Self::Empty { path }
            | Self::NotALog { path, .. }
            | Self::Csv { path, .. } => name.clone_into(path),
        }
        self
    }
}

/// What a log of PX4's first format is.
pub(crate) const SDLOG2: &str = "an sdlog2 log of PX4 1.6 or older (.px4log)";

/// What a file is that is text and no log.
pub(crate) const TEXT: &str = "a text file";

/// What a log is called in an error until the caller names it.
pub(crate) const UNNAMED: &str = "the log";

pub(crate) fn io_error(source: std::io::Error) -> ReadError {
    ReadError::Io {
        path: UNNAMED.into(),
        source,
    }
}
