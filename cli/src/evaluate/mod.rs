//! `flagred evaluate`: how good are the risks of profiles, beside predictors that need no rules?

mod alarms;
mod document;
mod estimators;
mod flight;
mod rows;
mod scores;
mod svg;
mod warnings;
mod words;

use std::{
    fs,
    io::Write,
    path::{Path, PathBuf},
};

use serde::Serialize;

use crate::{
    failure::{Exit, Failure},
    output::{self, Files, Stdout},
    parallel,
};
use alarms::Alarms;
use document::Document;
use estimators::Estimators;
use flight::Record;
use scores::{APART, Case, Evaluated};
use warnings::Warnings;

#[derive(clap::Args)]
pub(crate) struct Arguments {
    /// Flight logs with attitude (ArduPilot, PX4, tlog, flight CSV; plain or gzipped), and folders of them
    #[arg(required_unless_present = "rows", value_name = "FLIGHT")]
    flights: Vec<PathBuf>,

    /// Evaluate a table with a row for each flight instead of logs, as `flagred dataset` writes it
    #[arg(long, value_name = "DATA.csv", conflicts_with = "flights")]
    rows: Option<PathBuf>,

    /// A profile to compare with the built-in ones, a file; may be repeated
    #[arg(long = "profile", value_name = "FILE")]
    profiles: Vec<String>,

    /// How many seconds ahead the risk should predict
    #[arg(long, value_name = "SECONDS", default_value_t = 5.0, value_parser = horizon)]
    horizon: f64,

    /// Print a JSON document instead of text
    #[arg(long)]
    json: bool,

    /// Write an SVG picture of the ROC curves and the reliability to this file; `-` is standard output
    #[arg(long, value_name = "FILE", value_parser = output::svg_path)]
    svg: Option<PathBuf>,
}

fn horizon(text: &str) -> Result<f64, String> {
    match text.parse::<f64>() {
        Ok(horizon_s) if horizon_s > 0.0 && horizon_s.is_finite() => Ok(horizon_s),
        _ => Err("a horizon is a number of seconds above 0".to_owned()),
    }
}

/// A file that is not among the flights, and why.
#[derive(Serialize)]
struct LeftOut {
    file: String,
    reason: String,
}

/// What came of it all.
struct Evaluation {
    /// What the cases are: `steps` or `flights`.
    cases: &'static str,
    horizon_s: Option<f64>,
    flights: usize,
    critical: usize,
    left_out: Vec<LeftOut>,
    estimators: Vec<Evaluated>,
    /// Of each profile: over all flights, and by kind.
    warnings: Vec<(Warnings, Vec<(String, Warnings)>)>,
    alarms: Vec<Alarms>,
    records: Vec<Record>,
}

pub(crate) fn run(arguments: &Arguments) -> Result<Exit, Failure> {
    let inputs = arguments.flights.iter().chain(&arguments.rows).cloned();
    let inputs = inputs.chain(arguments.profiles.iter().map(PathBuf::from));
    let mut files = Files::reading(inputs)?;
    files.optional(arguments.svg.as_ref())?;
    let estimators = Estimators::new(&arguments.profiles)?;
    let (mut evaluation, exit) = match &arguments.rows {
        Some(table) => (rows(table, &estimators)?, Exit::Clean),
        None => flights(arguments, &estimators)?,
    };
    // Flights in folders are known only now.
    let mut files = Files::reading(evaluation.records.iter().map(|record| &record.file))?;
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
        evaluation.make_names_visible();
        words::write(&mut out, &evaluation)?;
    }
    out.finish()?;
    drawn?;
    Ok(exit)
}

/// Evaluates every flight; one that cannot be read stops no other.
fn flights(arguments: &Arguments, estimators: &Estimators) -> Result<(Evaluation, Exit), Failure> {
    let files = files(&arguments.flights)?;
    let mut records = Vec::new();
    let (mut left_out, mut exit) = (Vec::new(), Exit::Clean);
    parallel::in_order(
        &files,
        "flights",
        |file| flight::evaluate(&file.path, estimators, arguments.horizon),
        |file, evaluated| {
            match evaluated {
                Ok(record) => records.push(record),
                Err(failure) => {
                    let path = file.path.display().to_string();
                    let reason = failure.message().replace(&format!("`{path}`"), "");
                    left_out.push(LeftOut {
                        file: path,
                        reason: reason.trim_start_matches([' ', ',']).to_owned(),
                    });
                    // A folder may hold other things than flights.
                    if file.is_named {
                        failure.report();
                        exit = Exit::Unreadable;
                    }
                }
            }
            true
        },
    );
    let cases: Vec<Case> = records
        .iter_mut()
        .zip(0..)
        .flat_map(|(record, group)| {
            let vehicle = record.vehicle_name().to_owned();
            let kind = record.kind.clone();
            record.steps.iter_mut().map(move |step| Case {
                group,
                vehicle: vehicle.clone(),
                kind: kind.clone(),
                is_critical: step.is_critical,
                is_quiet: step.is_quiet,
                is_onset: step.is_onset,
                scores: std::mem::take(&mut step.scores),
            })
        })
        .collect();
    if cases.is_empty() {
        return Err(Failure::unreadable("there is no step to evaluate in these files").help(
            "`flagred inspect` shows what is in a log: it takes motors, attitude, and 20 s in the air",
        ));
    }
    let main = records.iter().filter(|record| record.kind != APART);
    let evaluation = Evaluation {
        cases: "steps",
        horizon_s: Some(arguments.horizon),
        flights: main.count(),
        left_out,
        warnings: (0..estimators.profiles.len())
            .map(|profile| Warnings::by_kind(profile, &records))
            .collect(),
        alarms: (0..estimators.profiles.len())
            .map(|profile| Alarms::of(profile, &records))
            .collect(),
        records,
        ..Evaluation::of(estimators, &cases)
    };
    Ok((evaluation, exit))
}

/// Evaluates a table with a row for each flight.
fn rows(table: &Path, estimators: &Estimators) -> Result<Evaluation, Failure> {
    let (cases, notes) = rows::cases(table, estimators)?;
    for note in notes {
        output::say(&note);
    }
    Ok(Evaluation::of(estimators, &cases))
}

impl Evaluation {
    /// For words on a terminal. In JSON and in pictures names stand as they are.
    fn make_names_visible(&mut self) {
        let evaluated = self.estimators.iter_mut().flat_map(|of| {
            let groups = of.by_vehicle.iter_mut().chain(&mut of.by_kind);
            groups.map(|(name, _)| name).chain([&mut of.name])
        });
        let warned = self.warnings.iter_mut().flat_map(|(_, by_kind)| by_kind);
        let alarmed = self.alarms.iter_mut().flat_map(|of| &mut of.by_kind);
        let recorded = self.records.iter_mut();
        let names = evaluated
            .chain(warned.map(|(kind, _)| kind))
            .chain(alarmed.map(|(kind, _, _)| kind))
            .chain(recorded.flat_map(|of| of.vehicle.iter_mut().chain([&mut of.kind])))
            .chain(self.left_out.iter_mut().map(|of| &mut of.reason));
        for name in names {
            *name = fuzzy::drawing::visible(name).into_owned();
        }
    }

    /// Of cases that are flights.
    fn of(estimators: &Estimators, cases: &[Case]) -> Evaluation {
        let main = || cases.iter().filter(|case| case.kind != APART);
        Evaluation {
            cases: "flights",
            horizon_s: None,
            flights: main().count(),
            critical: main().filter(|case| case.is_critical).count(),
            left_out: Vec::new(),
            estimators: scores::score(estimators.names(), estimators.profiles.len(), cases),
            warnings: Vec::new(),
            alarms: Vec::new(),
            records: Vec::new(),
        }
    }
}

/// A file to evaluate.
struct Candidate {
    path: PathBuf,
    /// Whether the user named it, and not only a folder that it is in.
    is_named: bool,
}

/// The files, and those in the folders and their folders, in the order of their names.
fn files(paths: &[PathBuf]) -> Result<Vec<Candidate>, Failure> {
    let mut found = Vec::new();
    for path in paths {
        if path.is_dir() {
            let mut inside = Vec::new();
            walk(path, &mut inside)?;
            inside.sort();
            found.extend(inside.into_iter().map(|path| Candidate {
                path,
                is_named: false,
            }));
        } else {
            found.push(Candidate {
                path: path.clone(),
                is_named: true,
            });
        }
    }
    Ok(found)
}

fn walk(folder: &Path, found: &mut Vec<PathBuf>) -> Result<(), Failure> {
    let unreadable =
        |error| Failure::unreadable(format!("`{}` cannot be read: {error}", folder.display()));
    for entry in fs::read_dir(folder).map_err(unreadable)? {
        let entry = entry.map_err(unreadable)?;
        // A link could lead back to where it came from.
        let kind = entry.file_type().map_err(unreadable)?;
        if kind.is_dir() {
            walk(&entry.path(), found)?;
        } else {
            found.push(entry.path());
        }
    }
    Ok(())
}
