//! `flagred assess`: how risky was this flight?

#[allow(dead_code, reason = "the text of an assessment comes next")]
mod picture;

use std::path::PathBuf;

use crate::failure::{Exit, Failure};

#[derive(clap::Args)]
pub(crate) struct Arguments {
    /// Flight logs; `-` is standard input
    #[arg(required = true, value_name = "LOG")]
    logs: Vec<PathBuf>,
}

/// Assesses every log in turn.
pub(crate) fn run(arguments: &Arguments) -> Result<Exit, Failure> {
    let log = arguments
        .logs
        .first()
        .map(|p| p.display().to_string())
        .unwrap_or_default();
    Err(Failure::unreadable(format!("`{log}` cannot be read yet")))
}
