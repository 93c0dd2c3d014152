//! `flagred assess`: the verdict, findings and risk of flights.

use std::{io::Write, path::PathBuf, sync::Arc};

use clap::ValueEnum;
use flagred::{
    flight::{Assessment, Verdict},
    log::{assess, assess_with_intervals},
    verdict::Level,
};
use flagred_flightlog::{Flight, ReadError};

use flagred_report::{
    document,
    page::{self, Subject},
    steps, words,
};

use crate::{
    failure::{Exit, Failure},
    numbers,
    output::{self, Files, Output, Stdout},
    parallel, profile,
    range::RangeArgument,
};

#[derive(clap::Args)]
pub(crate) struct Arguments {
    /// Flight logs: ArduPilot, PX4, MAVLink or flight CSV, plain or gzipped; `-` is standard input
    #[arg(required = true, value_name = "LOG")]
    logs: Vec<String>,

    /// Profile (inputs, rule set, thresholds): `flagred`, `flagred-paper`, `flagred-battery`, or a file
    #[arg(long, value_name = "NAME|FILE", default_value = profile::DEFAULT)]
    profile: String,

    #[command(flatten)]
    range: RangeArgument,

    /// Print a JSON document instead of text; for several logs, an array
    #[arg(long, conflicts_with = "csv")]
    json: bool,

    /// Print a CSV table of the steps instead of text
    #[arg(long)]
    csv: bool,

    /// List every finding with its measurements; for several logs, print all findings instead of
    /// one line per log
    #[arg(short, long, conflicts_with_all = ["json", "csv"])]
    verbose: bool,

    /// Also write a report to this file, one HTML page that opens offline; for several logs, a comparison; `-` is standard output
    #[arg(long, value_name = "FILE", value_parser = output::html_path)]
    html: Option<PathBuf>,

    /// Also write an SVG picture of the risk over time to this file; `-` is standard output
    #[arg(long, value_name = "FILE", value_parser = output::svg_path)]
    svg: Option<PathBuf>,

    /// Exit with 1 for this verdict and worse ones
    #[arg(long, value_enum, value_name = "VERDICT", default_value = "warn")]
    fail_on: FailOn,

    /// Seconds between the steps shown; every motor sample is assessed
    #[arg(long, value_name = "SECONDS", default_value_t = steps::STEP_S, value_parser = numbers::at_least_0)]
    step: f64,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub(crate) enum FailOn {
    Warn,
    Fail,
    Never,
}

/// Assesses every log. A log that cannot be read does not stop the others.
pub(crate) fn run(arguments: &Arguments) -> Result<Exit, Failure> {
    let loaded = profile::load(&arguments.profile)?;
    let estimator = &loaded.estimator;
    let several = arguments.logs.len() > 1;
    if arguments.logs.iter().filter(|log| *log == "-").count() > 1 {
        return Err(Failure::usage("standard input can be read only once").help("name `-` once"));
    }
    if several && arguments.svg.is_some() {
        return Err(Failure::usage("--svg draws only one flight")
            .help("to compare several flights, use --html FILE"));
    }
    let inputs = arguments.logs.iter().map(PathBuf::from);
    let mut files = Files::reading(inputs.chain(loaded.files.iter().cloned()))?;
    let html = files.optional(arguments.html.as_ref())?;
    let svg = files.optional(arguments.svg.as_ref())?;
    let reports = html.is_some() || svg.is_some();
    let shows_steps = reports || arguments.json || arguments.csv;
    let mut options = flagred_report::options(estimator, reports);
    options.range = arguments.range.given()?;
    let mut subjects = Vec::new();
    let documents: Vec<&Output> = html.iter().chain(&svg).collect();
    let mut out = Stdout::beside(&documents);
    // If reports are requested, the text for standard output is queued until they are written, because the reader of
    // standard output may stop at any time.
    let mut waiting = Vec::new();
    let mut exit = Exit::Clean;
    let mut json = Vec::new();
    let mut head = true;
    let mut show = |log: &String, flight: Flight, assessed: Assessment| {
        let mut out: Box<dyn Write + '_> = match reports {
            true => Box::new(&mut waiting),
            false => Box::new(&mut out),
        };
        if arguments.json {
            let document = document::document(log, &flight, estimator, &assessed);
            json.push(serde_json::to_string_pretty(&document).map_err(std::io::Error::from)?);
        } else if arguments.csv {
            let name = several.then_some(log.as_str());
            steps::write_csv(&mut out, name, head, estimator, &assessed)?;
            head = false;
            if let Verdict::NotAvailable(reason) = &assessed.verdict {
                let failure = Failure::unreadable(format!("`{log}`: no verdict: {reason}"));
                out.flush()?;
                failure.help_if(reason.help()).report();
            }
        } else if several && !arguments.verbose {
            words::write_line(&mut out, log, &flight, estimator, &assessed)?;
            out.flush()?;
        } else {
            words::write(
                &mut out,
                log,
                &flight,
                estimator,
                &assessed,
                arguments.verbose,
            )?;
            out.flush()?;
        }
        drop(out);
        if reports {
            subjects.push(Subject {
                name: log.clone(),
                flight: Arc::new(flight),
                assessed,
            });
        }
        Ok(())
    };
    let mut shown: Result<(), Failure> = Ok(());
    parallel::in_order(
        &arguments.logs,
        "logs",
        |log| {
            let flight = flagred_flightlog::open(log, &options)?;
            let assessed = match shows_steps {
                true => assess_with_intervals(&flight, estimator, arguments.step),
                false => assess(&flight, estimator, Some(arguments.step)),
            };
            Ok((flight, assessed))
        },
        |log, read: Result<(Flight, Assessment), ReadError>| {
            match read {
                Ok((flight, assessed)) => {
                    exit = exit.max(exit_of(&assessed.verdict, arguments.fail_on));
                    shown = show(log, flight, assessed);
                }
                Err(error) => {
                    Failure::from(error).report();
                    exit = exit.max(Exit::Unreadable);
                }
            }
            shown.is_ok()
        },
    );
    shown?;
    // An error here is returned only after the remaining outputs, so that a failed report does not suppress the verdict.
    let reported = match (subjects.as_slice(), several) {
        ([], _) => Ok(()),
        ([subject], false) => write_reports(html.as_ref(), svg.as_ref(), subject, &loaded),
        (subjects, _) => html.as_ref().map_or(Ok(()), |html| {
            let subjects: Vec<&Subject> = subjects.iter().collect();
            html.write(&page::comparison(&subjects, &loaded))
        }),
    };
    out.write_all(&waiting)?;
    if arguments.json {
        document::write(&mut out, &json, several)?;
    }
    out.finish()?;
    reported?;
    Ok(exit)
}

/// Writes the requested report and picture of one flight.
fn write_reports(
    html: Option<&Output>,
    svg: Option<&Output>,
    subject: &Subject,
    loaded: &profile::Loaded,
) -> Result<(), Failure> {
    let mut texts = Vec::new();
    texts.extend(html.map(|html| (html, page::report(subject, loaded))));
    let drawn = svg.and_then(|svg| Some((svg, page::svg(subject, loaded)?)));
    let nothing_drawn = svg.is_some() && drawn.is_none();
    texts.extend(drawn);
    output::write_all(texts)?;
    if nothing_drawn {
        return Err(Failure::unreadable(format!(
            "`{}`: no risk is known at any time, so there is nothing to draw",
            subject.name
        )));
    }
    Ok(())
}

/// Returns the exit code for a verdict. An unknown risk has its own code, so that it is not mistaken for GOOD.
pub(crate) fn exit_of(verdict: &Verdict, fail_on: FailOn) -> Exit {
    match (verdict, fail_on) {
        (Verdict::NotAvailable(_), _) => Exit::Unreadable,
        (Verdict::Known(Level::Fail), FailOn::Warn | FailOn::Fail) => Exit::Findings,
        (Verdict::Known(Level::Warn), FailOn::Warn) => Exit::Findings,
        _ => Exit::Clean,
    }
}
