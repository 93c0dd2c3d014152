//! `flagred validate`: measures how well the risks of profiles predict attitude errors, compared with predictors
//! without rules.

use std::{
    io::Write,
    path::{Path, PathBuf},
};

use flagred::shipped;
use flagred_evaluation::{
    Document, Estimators, Evaluation, FlightError, FlightTable, LeftOutFile, Record, files, svg,
    words,
};

use crate::{
    dataset::summary::refuse,
    failure::{Exit, Failure},
    numbers,
    output::{self, Files, Stdout},
    parallel, profile,
    table::Table,
};

#[derive(clap::Args)]
pub(crate) struct Arguments {
    /// Flight logs with attitude (ArduPilot, PX4, tlog, flight CSV; plain or gzipped), and folders of them
    #[arg(required_unless_present = "rows", value_name = "LOG")]
    flights: Vec<PathBuf>,

    /// Validate on this table instead of logs: a row for each flight, as `flagred dataset --profile NAME` writes it
    #[arg(long, value_name = "TABLE.csv", conflicts_with = "flights")]
    rows: Option<PathBuf>,

    /// A further profile to compare with `flagred` and `flagred-paper`: the name of a built-in one, or a file; may be repeated
    #[arg(long = "profile", value_name = "NAME|FILE")]
    profiles: Vec<String>,

    /// How many seconds ahead the risk predicts
    #[arg(long, value_name = "SECONDS", default_value_t = 5.0, value_parser = numbers::positive, conflicts_with = "rows")]
    horizon: f64,

    /// Print a JSON document instead of text
    #[arg(long)]
    json: bool,

    /// Also write an SVG picture of the ROC curves and the reliability to this file; `-` is standard output
    #[arg(long, value_name = "FILE", value_parser = output::svg_path)]
    svg: Option<PathBuf>,
}

impl Arguments {
    /// Refuses a rule set in place of a flight, with the advice to use `eval`.
    pub(crate) fn are_flights(&self) -> Result<(), Failure> {
        let mut flights = self.flights.iter();
        let Some(rules) = flights.find(|path| output::has_ending(path, output::RULES)) else {
            return Ok(());
        };
        let others = self.flights.iter().filter(|path| *path != rules);
        let names = [rules].into_iter().chain(others);
        let names: Vec<String> = names.map(|path| path.display().to_string()).collect();
        let message = format!("`{}` is a rule set, not a flight", rules.display());
        Err(Failure::usage(message).help(format!("flagred eval {}", names.join(" "))))
    }
}

pub(crate) fn run(arguments: &Arguments) -> Result<Exit, Failure> {
    let inputs = arguments.flights.iter().chain(&arguments.rows).cloned();
    let inputs = inputs.chain(arguments.profiles.iter().map(PathBuf::from));
    let mut files = Files::reading(inputs)?;
    files.optional(arguments.svg.as_ref())?;
    let estimators = estimators(&arguments.profiles)?;
    let (evaluation, exit) = match &arguments.rows {
        Some(table) => (rows(table, &estimators)?, Exit::Clean),
        None => flights(arguments, &estimators)?,
    };
    // The files in folders are known only after the folders have been listed, so the output is checked again.
    let mut files = Files::reading(evaluation.records().iter().map(Record::file))?;
    let svg = files.optional(arguments.svg.as_ref())?;
    let drawn = match &svg {
        Some(svg) => svg.write(&svg::draw(&evaluation)),
        None => Ok(()),
    };
    let documents: Vec<&output::Output> = svg.iter().collect();
    let mut out = Stdout::beside(&documents);
    if arguments.json {
        let document = Document::new(&evaluation);
        serde_json::to_writer_pretty(&mut out, &document).map_err(std::io::Error::from)?;
        writeln!(out)?;
    } else {
        out.write_all(words::text(&evaluation).as_bytes())?;
    }
    out.finish()?;
    drawn?;
    Ok(exit)
}

/// Returns the estimators of the built-in profiles that require only motor commands, and of the requested profiles.
fn estimators(requested: &[String]) -> Result<Estimators, Failure> {
    let mut estimators = Estimators::default();
    let shipped = shipped::motor_profile_names().map(str::to_owned);
    for wanted in shipped.chain(requested.iter().cloned()) {
        if !estimators.has(&wanted) {
            estimators.add(&wanted, profile::load(&wanted)?.estimator);
        }
    }
    Ok(estimators)
}

/// Evaluates every flight. A flight that cannot be read does not stop the others.
fn flights(arguments: &Arguments, estimators: &Estimators) -> Result<(Evaluation, Exit), Failure> {
    let files = files(&arguments.flights)?;
    let mut records = Vec::new();
    let (mut left_out, mut exit) = (Vec::new(), Exit::Clean);
    parallel::in_order(
        &files,
        "flights",
        |file| Record::read(&file.path, estimators, arguments.horizon),
        |file, evaluated| {
            match evaluated {
                Ok(record) => records.push(record),
                Err(why) => {
                    left_out.push(LeftOutFile::new(file.path.display().to_string(), &why));
                    // A folder may contain files other than flights.
                    if file.is_named {
                        Failure::from(why).report();
                        exit = Exit::Unreadable;
                    }
                }
            }
            true
        },
    );
    let evaluation = scored(estimators, |done| {
        Evaluation::of_flights(estimators, arguments.horizon, records, left_out, done)
    });
    let evaluation = evaluation.ok_or_else(|| match files.len() {
        0 => Failure::unreadable("there are no files in these folders").help("name flight logs, or folders that contain some"),
        // The reason has already been reported.
        1 if exit == Exit::Unreadable => Failure::shown(3),
        _ => Failure::unreadable("there are no steps to evaluate in these files").help(
            "a log needs motor commands, attitude, and 20 s in the air; `flagred inspect` shows what it contains",
        ),
    })?;
    Ok((evaluation, exit))
}

/// Evaluates a table that has a row for each flight.
fn rows(path: &Path, estimators: &Estimators) -> Result<Evaluation, Failure> {
    let table = Table::read(path, b',')?;
    table.header.require(
        flagred_evaluation::ERROR,
        "`flagred dataset --profile NAME` writes a table with this column: critical moments are identified by the attitude error",
    )?;
    let rows = FlightTable {
        columns: table.header.names.iter().map(String::as_str).collect(),
        len: table.len(),
        number: &|row, column| table.number(row, column),
        text: &|row, column| table.text(row, column),
    };
    let cases = flagred_evaluation::cases(&rows, estimators);
    let (cases, notes) = cases.map_err(|bad| refuse(&table, &bad))?;
    for note in notes {
        output::print_note(&note);
    }
    Ok(scored(estimators, |done| {
        Evaluation::of_cases(estimators, cases, done)
    }))
}

/// Scores the estimators, with a progress bar.
fn scored<T>(estimators: &Estimators, score: impl FnOnce(&(dyn Fn() + Sync)) -> T) -> T {
    let bar = parallel::progress(estimators.names().count(), "estimators");
    let scored = score(&|| bar.inc(1));
    bar.finish_and_clear();
    scored
}

impl From<FlightError> for Failure {
    fn from(why: FlightError) -> Failure {
        Failure::unreadable(&why).help_if(why.help())
    }
}
