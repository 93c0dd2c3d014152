//! `flagred inspect`: the contents of a flight log, and the source of each value.

pub(crate) mod json;
pub(crate) mod text;

pub(crate) use json::Document;

use std::{io::Write, path::PathBuf};

use flagred_flightlog::Gap;

use crate::{
    failure::{Exit, Failure},
    output::{Files, Stdout},
    range::RangeArgument,
};

#[derive(clap::Args)]
pub(crate) struct Arguments {
    /// Flight logs; `-` is standard input
    #[arg(required = true, value_name = "LOG")]
    logs: Vec<PathBuf>,

    #[command(flatten)]
    range: RangeArgument,

    /// Print JSON documents instead of text, one for each log
    #[arg(long)]
    json: bool,
}

/// Shows every log in turn. A log that cannot be read does not stop the others.
pub(crate) fn run(arguments: &Arguments) -> Result<Exit, Failure> {
    let options = arguments.range.options()?;
    Files::reading(&arguments.logs)?;
    let mut exit = Exit::Clean;
    for log in &arguments.logs {
        let name = log.display().to_string();
        let flight = match flagred_flightlog::open(log, &options) {
            Ok(flight) => flight,
            Err(error) => {
                Failure::from(error).report();
                exit = Exit::Unreadable;
                continue;
            }
        };
        let other = |gap: &Gap| matches!(gap, Gap::NotAMultirotor { .. });
        if flight.gaps().iter().any(other) {
            exit = Exit::Unreadable;
        }
        let mut out = Stdout::text();
        match arguments.json {
            true => {
                serde_json::to_writer_pretty(&mut out, &json::Document::new(&name, &flight))
                    .map_err(std::io::Error::from)?;
                writeln!(out)?;
            }
            false => text::write(&mut out, &name, &flight)?,
        }
        out.finish()?;
    }
    Ok(exit)
}
