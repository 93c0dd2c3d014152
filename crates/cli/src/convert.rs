//! `flagred convert`: a flight log as flight CSV.

use std::path::PathBuf;

use crate::{
    failure::{Exit, Failure},
    output::{self, Files, Replace},
    range::RangeArgument,
};

#[derive(clap::Args)]
pub(crate) struct Arguments {
    /// The flight log to convert; `-` is standard input
    #[arg(value_name = "LOG")]
    log: PathBuf,

    /// The file to write, replaced if it exists; `-` is standard output
    #[arg(short, long, value_name = "OUT.csv", value_parser = output::csv_path)]
    output: PathBuf,

    #[command(flatten)]
    range: RangeArgument,
}

/// Writes the motor commands and signals of a log, and warns if the log is damaged.
pub(crate) fn run(arguments: &Arguments) -> Result<Exit, Failure> {
    let options = arguments.range.options()?;
    let mut files = Files::reading([&arguments.log])?;
    let output = files.output(&arguments.output, Replace::Yes)?;
    let flight = flagred_flightlog::open(&arguments.log, &options)?;
    output.write_with(|out| flagred_report::table::write_flight(out, &flight))?;
    for warning in flagred_report::words::conversion(&arguments.log.display().to_string(), &flight)
    {
        output::print_note(&format!("warning: {warning}"));
    }
    Ok(Exit::Clean)
}
