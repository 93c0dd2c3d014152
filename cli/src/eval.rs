//! `flagred eval`: a rule set at many points, from CSV to CSV.

use std::{
    fs::File,
    io::{self, BufReader, Read},
    path::{Path, PathBuf},
    thread,
};

use fuzzy::{
    Engine,
    diagnostic::suggest,
    engine::{EvaluateError, Outcome, Scratch, State},
};

use crate::{
    failure::{Exit, Failure},
    output::{self, Files, Stdout, number_or_cell},
    rule_set,
    table::semicolons,
};

#[derive(clap::Args)]
pub(crate) struct Arguments {
    /// The rule set in YAML
    #[arg(value_name = "MODEL")]
    model: PathBuf,
    /// A table with a column for each input; other columns are copied. `-` is standard input
    #[arg(value_name = "POINTS.csv", default_value = "-")]
    points: PathBuf,
}

/// Rows that are evaluated at a time, split over the threads.
const BLOCK: usize = 16_384;

pub(crate) fn run(arguments: &Arguments) -> Result<Exit, Failure> {
    Files::reading([&arguments.model, &arguments.points])?;
    let (_, engine) = rule_set::load(&arguments.model)?;
    let path = &arguments.points;
    let input: Box<dyn Read> = if path == Path::new("-") {
        Box::new(io::stdin().lock())
    } else {
        Box::new(BufReader::new(File::open(path).map_err(|error| {
            Failure::unreadable(format!("`{}` cannot be read: {error}", path.display()))
                .help("check the path")
        })?))
    };
    // Fields are copied with their padding, and trimmed where they are read as numbers.
    let mut reader = csv::ReaderBuilder::new()
        .comment(Some(b'#'))
        .from_reader(input);
    let header = reader
        .headers()
        .map_err(|error| unreadable(&error))?
        .clone();
    let names: Vec<String> = header.iter().map(str::to_owned).collect();
    if let Some(failure) = semicolons(&path.display().to_string(), &names) {
        return Err(failure);
    }
    let columns = columns(&engine, &header)?;
    let mut writer = csv::Writer::from_writer(Stdout::data());
    let names = header.iter().map(number_or_cell);
    let outputs = engine.output_names().map(output::cell);
    writer.write_record(names.chain(outputs).map(|name| name.into_owned()))?;

    let threads = thread::available_parallelism().map_or(1, usize::from);
    let mut scratches: Vec<Scratch> = (0..threads).map(|_| engine.scratch()).collect();
    let mut undefined = vec![Undefined::default(); engine.output_names().len()];
    let mut rows = 0;
    loop {
        let mut block: Vec<csv::StringRecord> = Vec::with_capacity(BLOCK);
        for record in reader.records().take(BLOCK) {
            block.push(record.map_err(|error| unreadable(&error))?);
        }
        if block.is_empty() {
            break;
        }
        for results in evaluate(&engine, &columns, &block, &mut scratches)? {
            for (record, outcomes) in results {
                for (outcome, undefined) in outcomes.iter().zip(&mut undefined) {
                    undefined.count(outcome);
                }
                let values = outcomes
                    .iter()
                    .map(|o| o.value().map(digits).unwrap_or_default());
                let copied = record
                    .iter()
                    .map(|field| number_or_cell(field).into_owned());
                let fields = copied.chain(values);
                writer.write_record(fields)?;
            }
        }
        rows += block.len();
        // A stream may have no end; of a file the rest is evaluated, for what is to be said of it.
        if writer.get_ref().is_closed() && path == Path::new("-") {
            break;
        }
    }
    writer.flush()?;
    for (name, undefined) in engine.output_names().zip(undefined) {
        if let Some(why) = undefined.why(rows) {
            output::say(&format!("`{name}` is undefined {why}"));
        }
    }
    Ok(Exit::Clean)
}

/// Rows in which an output has no value.
#[derive(Clone, Default)]
struct Undefined {
    no_rule: usize,
    no_input: usize,
}

impl Undefined {
    fn count(&mut self, outcome: &Outcome) {
        match outcome.state {
            State::NoRuleFired => self.no_rule += 1,
            State::InputNotFinite => self.no_input += 1,
            State::Defined(_) | State::Default(_) => {}
        }
    }

    /// Where an output has no value, of so many rows; `None` where it always has one.
    fn why(&self, rows: usize) -> Option<String> {
        let Undefined { no_rule, no_input } = self;
        match (no_rule, no_input) {
            (0, 0) => None,
            (no_rule, 0) => Some(format!("where no rule fires ({no_rule} of {rows} rows)")),
            (0, no_input) => Some(format!(
                "where an input is unknown ({no_input} of {rows} rows)"
            )),
            (no_rule, no_input) => Some(format!(
                "where no rule fires ({no_rule} of {rows} rows) and where an input is unknown ({no_input})"
            )),
        }
    }
}

/// The column of each input.
fn columns(engine: &Engine, header: &csv::StringRecord) -> Result<Vec<usize>, Failure> {
    let names = || header.iter().map(str::trim);
    for output in engine.output_names() {
        if names().any(|name| name == output) {
            return Err(
                Failure::usage(format!("the points have a column `{output}` already"))
                    .help("the results go into a column of that name; rename yours"),
            );
        }
    }
    let column = |input: &str| {
        let mut found = names().enumerate().filter(|(_, name)| *name == input);
        match (found.next(), found.next()) {
            (Some((column, _)), None) => Ok(column),
            (Some(_), Some(_)) => Err(Failure::usage(format!(
                "the points have two columns `{input}`"
            ))),
            (None, _) => {
                let failure = Failure::usage(format!("the points have no column `{input}`"));
                Err(failure.help_if(suggest(input, names())))
            }
        }
    };
    engine.input_names().map(column).collect()
}

type Row<'b> = (&'b csv::StringRecord, Vec<Outcome>);

/// Evaluates a block, each part on a thread; the order of the rows is kept.
fn evaluate<'b>(
    engine: &Engine,
    columns: &[usize],
    block: &'b [csv::StringRecord],
    scratches: &mut [Scratch],
) -> Result<Vec<Vec<Row<'b>>>, Failure> {
    let part = block.len().div_ceil(scratches.len().max(1)).max(1);
    let results: Vec<Result<Vec<Row<'b>>, Failure>> = thread::scope(|scope| {
        let parts = block.chunks(part).zip(scratches);
        let running: Vec<_> = parts
            .map(|(rows, scratch)| {
                scope.spawn(move || evaluate_part(engine, columns, rows, scratch))
            })
            .collect();
        let ended = running.into_iter().map(|thread| {
            thread.join().unwrap_or_else(|_| {
                Err(Failure::unreadable(
                    "a thread of the evaluation ended early",
                ))
            })
        });
        ended.collect()
    });
    results.into_iter().collect()
}

fn evaluate_part<'b>(
    engine: &Engine,
    columns: &[usize],
    rows: &'b [csv::StringRecord],
    scratch: &mut Scratch,
) -> Result<Vec<Row<'b>>, Failure> {
    let mut point = vec![0.0; columns.len()];
    let mut outcomes = vec![Outcome::default(); engine.output_names().len()];
    let mut results = Vec::with_capacity(rows.len());
    for record in rows {
        for (place, (column, name)) in point
            .iter_mut()
            .zip(columns.iter().zip(engine.input_names()))
        {
            *place = number(record.get(*column).unwrap_or(""), name, record)?;
        }
        match engine.evaluate_with(scratch, &point, &mut outcomes) {
            Ok(()) => {}
            Err(error @ EvaluateError::NoRuleFired { .. }) => {
                return Err(Failure::unreadable(format!("{}: {error}", line(record)))
                    .help("the rule set says `when_no_rule_fires: error`; add the rules that are missing there"));
            }
            Err(error) => return Err(Failure::unreadable(format!("{}: {error}", line(record)))),
        }
        results.push((record, outcomes.clone()));
    }
    Ok(results)
}

/// The number in a field. An empty field is an unknown input: NaN, for which the engine gives no value.
fn number(field: &str, name: &str, record: &csv::StringRecord) -> Result<f64, Failure> {
    let field = field.trim();
    if field.is_empty() {
        return Ok(f64::NAN);
    }
    field.parse().map_err(|_| {
        Failure::unreadable(format!(
            "{}: `{field}` of `{name}` is not a number",
            line(record)
        ))
        .help("leave the field empty where the value is unknown")
    })
}

fn line(record: &csv::StringRecord) -> String {
    record
        .position()
        .map_or("a row".into(), |place| format!("line {}", place.line()))
}

/// Seventeen digits: reading them again gives the same number.
fn digits(value: f64) -> String {
    let exponent = if value == 0.0 {
        0
    } else {
        value.abs().log10().floor() as i32
    };
    if (-5..16).contains(&exponent) {
        let decimals = (16 - exponent).max(0) as usize;
        format!("{value:.decimals$}")
    } else {
        format!("{value:.16e}")
    }
}

fn unreadable(error: &csv::Error) -> Failure {
    Failure::unreadable(format!("the points cannot be read: {error}"))
        .help("every row needs as many fields as the header")
}
