//! `flagred convert`: a flight log as flight CSV.

use std::{
    fs::File,
    io::{BufWriter, Write},
    path::{Path, PathBuf},
};

use flightlog::{Flight, Options};

use crate::failure::{Exit, Failure};

#[derive(clap::Args)]
pub(crate) struct Arguments {
    /// The flight log to convert; `-` is standard input
    #[arg(value_name = "LOG")]
    log: PathBuf,

    /// The CSV file to write; `-` is standard output
    #[arg(short, long, value_name = "FILE")]
    output: PathBuf,
}

/// Writes the motor commands and signals of a log; warns where the log is damaged.
pub(crate) fn run(arguments: &Arguments) -> Result<Exit, Failure> {
    let flight = flightlog::open(&arguments.log, &Options::default())?;
    if arguments.output == Path::new("-") {
        flight.write_csv(&mut BufWriter::new(anstream::stdout().lock()))?;
    } else {
        write(&flight, &arguments.output).map_err(|error| {
            Failure::usage(format!(
                "cannot write `{}`: {error}",
                arguments.output.display()
            ))
        })?;
    }
    if let Some(reason) = &flight.report.reason {
        let mut err = anstream::stderr().lock();
        writeln!(
            err,
            "warning: `{}` is damaged: {reason}; the undamaged part is converted",
            arguments.log.display()
        )?;
    }
    Ok(Exit::Clean)
}

fn write(flight: &Flight, path: &Path) -> std::io::Result<()> {
    let mut out = BufWriter::new(File::create(path)?);
    flight.write_csv(&mut out)?;
    out.flush()
}
