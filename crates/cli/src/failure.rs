//! Exit codes of commands, and the messages of commands that fail.

use std::{fmt, io, io::Write, path::Path};

use clap::error::{ContextKind, ContextValue};
use flagred_flightlog::ReadError;
use fuzzy::drawing::{visible, visible_lines};

use crate::path::{self, RULES, has_ending};

/// The result of a command that completed. For several inputs, the result is the last of these variants that applies
/// to an input, so that a finding is never hidden.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) enum Exit {
    /// Nothing to report: 0.
    Clean,
    /// An input could not be read or used, such as a log of a fixed-wing aircraft: 3.
    Unreadable,
    /// Findings at or above the level that the user chose: 1.
    Findings,
}

impl Exit {
    /// The exit code of the program.
    pub(crate) fn code(self) -> u8 {
        match self {
            Exit::Clean => 0,
            Exit::Findings => 1,
            Exit::Unreadable => 3,
        }
    }
}

/// The reason why a command failed, in lower case, with help that describes what to do.
#[derive(Debug)]
pub(crate) struct Failure {
    code: u8,
    message: String,
    /// Details of the message, one line each.
    details: Vec<String>,
    help: Option<String>,
}

impl Failure {
    /// A command line that cannot be executed, or an output that cannot be written: exit code 2.
    pub(crate) fn usage(message: impl fmt::Display) -> Self {
        Failure {
            code: 2,
            message: message.to_string(),
            details: Vec::new(),
            help: None,
        }
    }

    /// A file that cannot be read or has the wrong content: exit code 3.
    pub(crate) fn unreadable(message: impl fmt::Display) -> Self {
        Failure {
            code: 3,
            message: message.to_string(),
            details: Vec::new(),
            help: None,
        }
    }

    /// A failure whose findings have been shown already, so that only the exit code is needed.
    pub(crate) fn shown(code: u8) -> Self {
        Failure {
            code,
            message: String::new(),
            details: Vec::new(),
            help: None,
        }
    }

    /// Adds details, one line each.
    pub(crate) fn details(mut self, details: Vec<String>) -> Self {
        self.details = details;
        self
    }

    /// Like [`Failure::unreadable`], for an error of several lines, such as findings: all lines but the first become
    /// details.
    pub(crate) fn unusable(what: impl fmt::Display, error: &impl fmt::Display) -> Self {
        let error = error.to_string();
        let mut lines = error.lines();
        let first = lines.next().unwrap_or_default();
        let details = lines.map(|line| line.trim_start().to_owned());
        Failure::unreadable(format!("{what}: {first}")).details(details.collect())
    }

    /// Adds help.
    pub(crate) fn help(mut self, help: impl fmt::Display) -> Self {
        self.help = Some(help.to_string());
        self
    }

    /// Adds help, if there is any.
    pub(crate) fn help_if(self, help: Option<impl fmt::Display>) -> Self {
        match help {
            Some(help) => self.help(help),
            None => self,
        }
    }

    /// Replaces the help by a more specific one if the current help is `general`.
    pub(crate) fn instead_of(mut self, general: &str, help: impl FnOnce() -> String) -> Self {
        if self.help.as_deref() == Some(general) {
            self.help = Some(help());
        }
        self
    }

    /// Returns the message without its help.
    pub(crate) fn message(&self) -> &str {
        &self.message
    }

    /// Reports the failure to the user, and returns the exit code.
    pub(crate) fn report(self) -> u8 {
        if !self.message.is_empty() {
            let mut err = anstream::stderr().lock();
            let red = anstyle::AnsiColor::Red.on_default().bold();
            // A write fails if standard error is closed. That cannot be reported elsewhere.
            let _ = writeln!(err, "{red}error{red:#}: {}", visible(&self.message));
            for detail in &self.details {
                let _ = writeln!(err, "  {}", visible(detail));
            }
            if let Some(help) = &self.help {
                let _ = writeln!(err, "  help: {}", visible(help));
            }
        }
        self.code
    }
}

/// Formats the failure without colours, for output that is not a terminal.
impl fmt::Display for Failure {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.message)?;
        let help = self.help.iter().map(|help| format!("help: {help}"));
        let mut lines = self.details.iter().cloned().chain(help);
        lines.try_for_each(|line| write!(f, "\n  {line}"))
    }
}

/// Recognises a file in place of the command, as in `flagred flight.bin`.
pub(crate) fn command_forgotten(error: &clap::Error) -> Option<Failure> {
    let Some(ContextValue::String(word)) = error.get(ContextKind::InvalidSubcommand) else {
        return None;
    };
    if word == "version" {
        return Some(Failure::usage("`version` is not a command").help("`flagred --version`"));
    }
    Path::new(word).exists().then(|| {
        let help = match has_ending(Path::new(word), RULES) {
            true => format!("`flagred check {word}` lists the errors of a rule set or profile"),
            false => format!("`flagred assess {word}` assesses a flight"),
        };
        Failure::usage(format!("`{word}` is a file, not a command")).help(help)
    })
}

/// Reports a file that cannot be read: exit code 3.
pub(crate) fn cannot_read(shown: &str, error: &io::Error) -> Failure {
    match error.kind() {
        io::ErrorKind::IsADirectory => {
            Failure::unreadable(format!("`{shown}` is a folder")).help("name the files in it")
        }
        _ => {
            let failure = Failure::unreadable(format!("`{shown}` cannot be read: {error}"));
            failure.help(path::missing(shown))
        }
    }
}

/// A log that cannot be read: exit code 3.
impl From<ReadError> for Failure {
    fn from(error: ReadError) -> Self {
        let failure = Failure::unreadable(&error);
        match &error {
            ReadError::Io { path, source }
                if source.kind() == io::ErrorKind::NotFound && !path.starts_with("http") =>
            {
                failure.help(path::missing(path))
            }
            ReadError::Io { path, source } if source.kind() == io::ErrorKind::IsADirectory => {
                cannot_read(path, source)
            }
            _ => failure.help_if(error.help()),
        }
    }
}

/// Reports a command line that clap rejects, or prints the help that it requests, and returns the exit code. Control characters that
/// the user typed are made visible.
pub(crate) fn refuse(error: &clap::Error) -> u8 {
    let text = error.render().to_string();
    let mut shown = visible_lines(&text).into_owned();
    if let Some(tip) = shown.find("  tip: to pass '-") {
        // Removes clap's advice for values that begin with `-`, which rarely applies.
        let end = shown.get(tip..).and_then(|tip| tip.find("\n\n"));
        shown.replace_range(tip..end.map_or(shown.len(), |end| tip + end + 2), "");
    }
    // A write fails if the stream is closed. That cannot be reported elsewhere.
    if shown == text {
        let _ = error.print();
    } else {
        let _ = write!(anstream::stderr(), "{shown}");
    }
    match error.use_stderr() {
        true => 2,
        false => 0,
    }
}

/// Standard output could not be written: exit code 2. A reader that closed the pipe is not an error (see `output::Stdout`).
impl From<io::Error> for Failure {
    fn from(error: io::Error) -> Self {
        Failure::usage(format!("the output cannot be written: {error}"))
    }
}

/// Standard output could not be written as a table.
impl From<csv::Error> for Failure {
    fn from(error: csv::Error) -> Self {
        match error.into_kind() {
            csv::ErrorKind::Io(error) => Failure::from(error),
            kind => Failure::usage(format!("the output cannot be written: {kind:?}")),
        }
    }
}
