//! `flagred convert`: a flight log as flight CSV.

use std::path::PathBuf;

use flightlog::Options;

use crate::{
    failure::{Exit, Failure},
    output::{self, Files, Replace},
};

#[derive(clap::Args)]
pub(crate) struct Arguments {
    /// The flight log to convert; `-` is standard input
    #[arg(value_name = "LOG")]
    log: PathBuf,

    /// The CSV file to write; `-` is standard output
    #[arg(short, long, value_name = "FILE", value_parser = output::csv_path)]
    output: PathBuf,
}

/// Writes the motor commands and signals of a log; warns where the log is damaged.
pub(crate) fn run(arguments: &Arguments) -> Result<Exit, Failure> {
    let mut files = Files::reading([&arguments.log])?;
    let output = files.output(&arguments.output, Replace::Yes)?;
    let flight = flightlog::open(&arguments.log, &Options::default())?;
    output.write_with(|out| report::table::write_flight(out, &flight))?;
    for warning in report::words::conversion(&arguments.log.display().to_string(), &flight) {
        output::say(&format!("warning: {warning}"));
    }
    Ok(Exit::Clean)
}
