//! `flagred tune`: fits the numbers of a rule set to rows of data.

mod report;

pub(crate) use report::Document;

use std::{
    io::{IsTerminal, Write as _},
    ops::ControlFlow,
    path::PathBuf,
    sync::{
        Arc,
        atomic::{AtomicBool, Ordering},
    },
    time::{Duration, Instant},
};

use clap::ValueEnum;
use flagred_authoring::provenance::fingerprint;
use flagred_tuning::{
    ChangedNumber, CurvePoint, Data, Loss, Progress, Settings, TuneError, TuneResult, Validation,
    cross_validate, learning_curve, tune,
};
use fuzzy::{
    Model,
    drawing::{moved_svg, visible},
};
use indicatif::{ProgressBar, ProgressStyle};

use crate::{
    failure::{Exit, Failure},
    numbers::{self, whole},
    output::{self, Output, Stdout},
    rows::{self, Clamped},
    rule_set,
    table::Extent,
};

#[derive(clap::Args)]
pub(crate) struct Arguments {
    #[command(flatten)]
    rows: rows::DerivationArguments,

    /// Loss to minimise
    #[arg(long, value_enum, default_value = "squared", value_name = "LOSS")]
    loss: LossName,

    /// Move only this variable or term: `heat`, `heat.warm`; may be repeated
    #[arg(long, value_name = "NAME")]
    only: Vec<String>,

    /// Do not move this variable or term; may be repeated
    #[arg(long, value_name = "NAME")]
    fix: Vec<String>,

    /// Move the weights of the rules, too
    #[arg(long = "rule-weights")]
    weights: bool,

    /// Minimum distance between neighbouring peaks, as a share of the range
    #[arg(long, default_value_t = 0.01, value_name = "SHARE", value_parser = numbers::share)]
    min_distance: f64,

    /// Let constants leave the range of the output by at most its width
    #[arg(long)]
    beyond_range: bool,

    /// Significant digits of the numbers that moved, or `all`
    #[arg(long, default_value = "3", value_name = "DIGITS", value_parser = digits)]
    round: Digits,

    /// Number of starts: the first from the rule set, the others from random points around it
    #[arg(long, default_value_t = 1, value_name = "COUNT", value_parser = whole(1_u32, 1000))]
    starts: u32,

    /// Maximum number of steps per start
    #[arg(long, default_value_t = 100, value_name = "COUNT", value_parser = whole(1_u32, 100_000))]
    iterations: u32,

    /// Random seed (starting points, folds of cross-validation)
    #[arg(long, default_value_t = 0, value_name = "NUMBER", value_parser = numbers::seed)]
    seed: u64,

    /// Save the best rule set so far to this file; if the file exists, start from it
    #[arg(long, value_name = "FILE.yaml", value_parser = output::rules_path)]
    checkpoint: Option<PathBuf>,

    /// Number of cross-validation folds
    #[arg(long, default_value_t = 5, value_name = "COUNT", value_parser = whole(2_u32, 100))]
    folds: u32,

    /// Also report the cross-validation error after tuning on 1/8, 1/4 and 1/2 of the training rows
    #[arg(long, conflicts_with = "no_validation")]
    learning_curve: bool,

    /// Also write an SVG picture of the variables that moved, before and after, to this file; `-` is standard output
    #[arg(long, value_name = "FILE", value_parser = output::svg_path)]
    svg: Option<PathBuf>,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
enum LossName {
    /// The mean square of the error
    Squared,
    /// The mean of -ln p for outcomes of 0 and 1, with the predicted probability p of the outcome
    Log,
    /// The share of pairs of a 1 and a 0 in the wrong order: 1 minus the area under the ROC curve
    Ranking,
}

/// Number of significant digits; `None` for all.
#[derive(Debug, Clone, Copy)]
struct Digits(Option<u32>);

fn digits(text: &str) -> Result<Digits, String> {
    let digits = text.parse().ok().filter(|digits| (1..=17).contains(digits));
    match (text, digits) {
        ("all", _) => Ok(Digits(None)),
        (_, Some(digits)) => Ok(Digits(Some(digits))),
        (_, None) => Err("write a number of digits from 1 to 17, or `all`".into()),
    }
}

impl Arguments {
    fn loss(&self) -> Loss {
        match self.loss {
            LossName::Squared => Loss::Squared,
            LossName::Log => Loss::Log,
            LossName::Ranking => Loss::Ranking,
        }
    }
}

/// The results for the report.
struct TuneOutcome {
    rows: usize,
    refused: Vec<String>,
    tuned: TuneResult,
    /// The cross-validation; `None` if it was not requested or was interrupted.
    validation: Option<Validation>,
    /// The learning curve; `None` if it was not requested or was interrupted.
    curve: Option<Vec<CurvePoint>>,
    /// Whether the search started from a checkpoint.
    is_resumed: bool,
}

pub(crate) fn run(arguments: &Arguments) -> Result<Exit, Failure> {
    let (mut files, output) = arguments.rows.files("tune")?;
    let svg = files.optional(arguments.svg.as_ref())?;
    let checkpoint = files.optional(arguments.checkpoint.as_ref())?;
    let name = arguments.rows.rewrite.model.display().to_string();
    let source = rule_set::read(&arguments.rows.rewrite.model)?;
    let original = rule_set::engine(&source, &name)?.model();
    arguments.rows.claims.check_inputs(original)?;
    let settings = settings(arguments)?;
    let resumed = resumed(arguments, original, &settings)?;
    let start = resumed.as_ref().unwrap_or(original);
    let (data, refused) = data(arguments, start)?;
    let failed = |error: TuneError| match &error {
        TuneError::Unknown { name: unknown } if unknown.contains(',') => {
            let option = if arguments.only.contains(unknown) {
                "--only"
            } else {
                "--fix"
            };
            failure(&name, original, &error).help(rows::repeated(option, unknown))
        }
        _ => failure(&name, original, &error),
    };

    let stop = Arc::new(AtomicBool::new(false));
    let flag = Arc::clone(&stop);
    ctrlc::set_handler(move || flag.store(true, Ordering::Relaxed)).map_err(|error| {
        Failure::unreadable(format!("cannot set the handler for Ctrl-C: {error}"))
    })?;
    let mut watch = SearchObserver::new(arguments, stop, checkpoint.as_ref());
    let tuned = tune(start, &data, &settings, &mut |progress| {
        watch.step(progress, None)
    });
    let tuned = tuned.map_err(failed)?;
    // A checkpoint that cannot be written is reported as an error at the end; cross-validation runs first.
    let kept = watch.keep(&tuned.model);
    let validation = match arguments.rows.no_validation || tuned.is_stopped {
        true => None,
        false => {
            let mut reported =
                |fold: u32, progress: &Progress<'_>| watch.step(progress, Some(fold));
            cross_validate(original, &data, &settings, arguments.folds, &mut reported)
                .map_err(failed)?
        }
    };
    let curve = match &validation {
        Some(validation) if arguments.learning_curve => {
            let mut reported = |_: u32, _: &Progress<'_>| watch.more("learning curve");
            let folds = arguments.folds;
            learning_curve(original, &data, &settings, folds, validation, &mut reported)
                .map_err(failed)?
        }
        _ => None,
    };
    watch.bar.finish_and_clear();
    let outcome = TuneOutcome {
        rows: data.len(),
        refused,
        tuned,
        validation,
        curve,
        is_resumed: resumed.is_some(),
    };
    if let Some(warning) = warning(&outcome) {
        output::print_note(&warning);
    }
    let mut texts = vec![(
        &output,
        report::rule_set(arguments, &outcome, source.text())?,
    )];
    if let Some(svg) = &svg {
        texts.push((svg, moved_svg(original, &outcome.tuned.model)));
    }
    let written: Vec<&Output> = texts.iter().map(|(output, _)| *output).collect();
    let all_written = output::write_all(texts);
    let mut out = Stdout::beside(&written);
    if arguments.rows.rewrite.json {
        let document = report::Document::new(arguments, &outcome);
        serde_json::to_writer_pretty(&mut out, &document).map_err(std::io::Error::from)?;
        writeln!(out)?;
    } else {
        report::words(&mut out, arguments, &outcome)?;
    }
    out.finish()?;
    match (kept, all_written) {
        (Err(checkpoint), Err(output)) => {
            checkpoint.report();
            Err(output)
        }
        (kept, all_written) => kept.and(all_written).map(|()| Exit::Clean),
    }
}

fn settings(arguments: &Arguments) -> Result<Settings, Failure> {
    let mut settings = Settings::default();
    settings.loss = arguments.loss();
    settings.only = arguments.only.clone();
    settings.fix = arguments.fix.clone();
    settings.weights = arguments.weights;
    settings.min_distance = arguments.min_distance;
    settings.monotone = arguments.rows.claims.monotone()?;
    settings.beyond_range = arguments.beyond_range;
    settings.digits = arguments.round.0;
    settings.starts = arguments.starts;
    settings.seed = arguments.seed;
    settings.iterations = arguments.iterations;
    Ok(settings)
}

/// Returns the usable rows as columns, and the reasons why other rows cannot be used.
fn data(arguments: &Arguments, model: &Model) -> Result<(Data, Vec<String>), Failure> {
    // The output is not clamped: constants approach values beyond the range as far as they are allowed to, and `eval`
    // computes its errors from the same values.
    let read = rows::read(&arguments.rows, model, Clamped::Inputs)?;
    let read = rows::in_range(read, model);
    outcomes(arguments, model, &read)?;
    let (data, refused) = rows::in_columns(read, model.inputs.len(), arguments.loss());
    if !refused.is_empty() && (!arguments.rows.rewrite.format.skip_bad_rows || data.is_empty()) {
        let rows = refused.len() + data.truths.len();
        return Err(rows::refuse(&refused, rows, "used"));
    }
    Ok((data, refused))
}

/// Refuses rows whose outputs are not 0 or 1, if the loss requires outcomes of 0 and 1.
fn outcomes(arguments: &Arguments, model: &Model, read: &rows::Data) -> Result<(), Failure> {
    let truths = read
        .rows
        .iter()
        .filter_map(|(row, _)| row.values.last().copied());
    let others = truths
        .clone()
        .filter(|truth| ![0.0, 1.0].contains(truth))
        .count();
    let skips = arguments.rows.rewrite.format.skip_bad_rows && others < read.rows.len();
    if arguments.loss() == Loss::Squared || others == 0 || skips {
        return Ok(());
    }
    let output = model.measured_output();
    let output = output.and_then(|output| model.outputs.get(output));
    let name = output.map_or("", |output| output.variable.name.as_str());
    let Extent { low, high, .. } = Extent::of(truths);
    let message = format!(
        "the values of `{name}` are from {low} to {high}, but `--loss {}` is for outcomes of 0 and 1",
        rows::word(&arguments.loss)
    );
    let failure = Failure::unreadable(message);
    Err(match others < read.rows.len() {
        true => failure.help(
            "for other values use `--loss squared`, or leave their rows out with `--skip-bad-rows`",
        ),
        false => failure.help("for other values use `--loss squared`"),
    })
}

/// Returns a warning if the cross-validation error rises, or if there are fewer rows than numbers that moved.
fn warning(outcome: &TuneOutcome) -> Option<String> {
    let (rows, moved) = (outcome.rows, outcome.tuned.moved.len());
    let plural = if rows == 1 { "" } else { "s" };
    let few = format!("{rows} row{plural} for {moved} numbers that moved");
    let worse = outcome
        .validation
        .as_ref()
        .filter(|it| it.after.value > it.before.value);
    let why = match worse {
        Some(it) => format!(
            "the cross-validation error rises from {:.3} to {:.3}",
            it.before.value, it.after.value
        ),
        None if rows < moved => few,
        None => return None,
    };
    Some(format!(
        "warning: {why}: add rows, or move fewer numbers with `--only`"
    ))
}

/// Returns the rule set with the numbers of the checkpoint, if the checkpoint exists. It may differ from the rule set only
/// in numbers that may change.
fn resumed(
    arguments: &Arguments,
    model: &Model,
    settings: &Settings,
) -> Result<Option<Model>, Failure> {
    let Some(path) = arguments.checkpoint.as_ref().filter(|path| path.exists()) else {
        return Ok(None);
    };
    let source = rule_set::read(path)?;
    let saved = &rule_set::document(&source, &path.display().to_string())?.model;
    let resumed = flagred_tuning::with_numbers_of(model, saved);
    let resumed = resumed.filter(|resumed| fingerprint(resumed) == fingerprint(saved));
    if resumed.is_none() {
        let message = format!("`{}` is a checkpoint of another rule set", path.display());
        return Err(Failure::usage(message).help("name a new file, or remove this one"));
    }
    let fixed = resumed
        .as_ref()
        .and_then(|resumed| flagred_tuning::moved_although_fixed(model, resumed, settings));
    if let Some(ChangedNumber {
        of,
        name,
        before,
        after,
    }) = fixed
    {
        let message = format!(
            "the checkpoint `{}` changes `{name}` of `{}` from {before} to {after}, which must not change",
            path.display(),
            visible(&of)
        );
        return Err(Failure::usage(message).help(
            "run with the `--only`, `--fix` and `--rule-weights` that the checkpoint was written with, or name a new file",
        ));
    }
    Ok(resumed)
}

fn failure(name: &str, model: &Model, error: &TuneError) -> Failure {
    let help = match error {
        TuneError::Outputs { .. } => "keep one of these outputs, and the outputs that it reads",
        TuneError::Type2 => {
            "remove the keys that make terms type-2, such as `blur` or `lower`, for tuning"
        }
        TuneError::Unknown { .. } => "name a variable, or a term as `variable.term`",
        TuneError::NothingMoves => {
            "`--only` and `--fix` leave nothing to tune; `--rule-weights` tunes the weights of rules"
        }
        TuneError::NoRows => "the tables contain no rows",
        TuneError::NoWeight => "give some rows a weight above 0, or leave out `--weight`",
        TuneError::NotFinite | TuneError::TooFar { .. } => {
            "check the units of the output's column and of its range"
        }
        TuneError::OneClass => "ranking needs both rows of 1 and rows of 0",
        TuneError::NotMonotone { .. } => {
            "`flagred check` with the same options shows where; start from a rule set without counterexamples: `flagred learn --rising`"
        }
        _ => "`flagred check` shows what is wrong with the rule set",
    };
    match error {
        TuneError::Unknown { name: unknown } => {
            let names = model.variables().flat_map(|variable| {
                let terms = variable.terms.iter();
                let terms = terms.map(|term| format!("{}.{}", variable.name, term.name));
                std::iter::once(variable.name.clone()).chain(terms)
            });
            let names: Vec<String> = names.collect();
            let near = fuzzy::diagnostic::nearest(unknown, names.iter().map(String::as_str));
            let help = near.map_or(help.to_owned(), |near| format!("did you mean `{near}`?"));
            Failure::usage(format!("`{name}`: {error}")).help(help)
        }
        TuneError::NothingMoves | TuneError::Claim { .. } => {
            Failure::usage(format!("`{name}`: {error}")).help(help)
        }
        _ => Failure::unusable(format!("`{name}`"), error).help(help),
    }
}

/// Observes a search: shows its progress, writes checkpoints, and stops it if the user interrupts.
struct SearchObserver<'a> {
    stop: Arc<AtomicBool>,
    bar: ProgressBar,
    starts: u32,
    iterations: u32,
    checkpoint: Option<&'a Output>,
    kept: Instant,
    /// Whether a failure to write a checkpoint has been reported.
    is_refused: bool,
}

impl<'a> SearchObserver<'a> {
    fn new(
        arguments: &Arguments,
        stop: Arc<AtomicBool>,
        checkpoint: Option<&'a Output>,
    ) -> SearchObserver<'a> {
        let parts = if arguments.rows.no_validation {
            1
        } else {
            arguments.folds + 1
        };
        let steps = arguments.starts * arguments.iterations;
        let style = ProgressStyle::with_template("{msg} {wide_bar} at most {eta} left");
        let bar = match (std::io::stderr().is_terminal(), style) {
            (true, Ok(style)) => ProgressBar::new(u64::from(steps * parts)).with_style(style),
            _ => ProgressBar::hidden(),
        };
        SearchObserver {
            stop,
            bar,
            starts: arguments.starts,
            iterations: arguments.iterations,
            checkpoint,
            kept: Instant::now(),
            is_refused: false,
        }
    }

    /// Called after each step of the search and of cross-validation: shows the progress and writes checkpoints.
    fn step(&mut self, progress: &Progress<'_>, fold: Option<u32>) -> ControlFlow<()> {
        const BETWEEN: Duration = Duration::from_secs(5);
        let part = fold.map_or(0, |fold| fold + 1);
        let before = part * self.starts + progress.start - 1;
        self.bar
            .set_position(u64::from(before * self.iterations + progress.iteration));
        self.bar.set_message(match fold {
            None => format!("loss {:.6}", progress.loss),
            Some(fold) => format!("validation, part {}", fold + 1),
        });
        if fold.is_none() && self.kept.elapsed() > BETWEEN {
            // A later attempt may succeed. A failure of the last attempt is an error.
            if let Err(failure) = self.keep(progress.model)
                && !std::mem::replace(&mut self.is_refused, true)
            {
                let note = format!("{}; the search continues", failure.message());
                self.bar.suspend(|| output::print_note(&note));
            }
        }
        self.flow()
    }

    /// Called after each step of work that the progress bar does not count, such as the learning curve.
    fn more(&self, what: &'static str) -> ControlFlow<()> {
        self.bar.set_message(what);
        self.flow()
    }

    fn flow(&self) -> ControlFlow<()> {
        match self.stop.load(Ordering::Relaxed) {
            true => ControlFlow::Break(()),
            false => ControlFlow::Continue(()),
        }
    }

    fn keep(&mut self, model: &Model) -> Result<(), Failure> {
        self.kept = Instant::now();
        match self.checkpoint {
            Some(checkpoint) => checkpoint.write(&fuzzy::yaml::to_string(model)),
            None => Ok(()),
        }
    }
}
