//! `flagred identify`: a rule set from rows of data.

mod report;

pub(crate) use report::Document;

use std::{io::Write as _, ops::ControlFlow, path::PathBuf};

use flagred_tuning::{
    Data, Loss, TuneError,
    identify::{
        Antecedents, Consequents, Identification, IdentifyResult, IdentifyValidation, MAX_TERMS,
        check_columns, cross_validate, identify,
    },
};
use fuzzy::diagnostic::suggest;

use crate::{
    failure::{Exit, Failure},
    numbers::{self, whole},
    output::{self, Files, Replace, Stdout},
    rows,
    table::{Cell, Format, Table},
};

#[derive(clap::Args)]
pub(crate) struct Arguments {
    /// Tables with a column for the output and columns that may be inputs
    #[arg(required = true, value_name = "TABLE.csv")]
    data: Vec<PathBuf>,

    /// The column with the output
    #[arg(long, value_name = "COLUMN")]
    target: String,

    /// The file to write; `-` is standard output
    #[arg(short, long, value_name = "OUT.yaml", value_parser = output::rules_path)]
    output: PathBuf,

    /// Replace the file if it exists
    #[arg(long)]
    force: bool,

    /// Use only this column as an input; may be repeated [default: the columns that reduce the error]
    #[arg(long, value_name = "COLUMN", conflicts_with = "max_inputs")]
    input: Vec<String>,

    /// Do not use this column; may be repeated
    #[arg(long, value_name = "COLUMN", conflicts_with = "input")]
    ignore: Vec<String>,

    /// Maximum number of inputs
    #[arg(long, default_value_t = 4, value_name = "COUNT", value_parser = whole(1_u32, 20))]
    max_inputs: u32,

    /// Maximum number of terms of an input
    #[arg(long, default_value_t = 5, value_name = "COUNT", value_parser = whole(2, MAX_TERMS as u32))]
    max_terms: u32,

    /// Maximum number of rules
    #[arg(long, default_value_t = 25, value_name = "COUNT", value_parser = whole(2_u32, 1000))]
    max_rules: u32,

    /// Make one rule per cluster of rows (subtractive clustering) instead of one per combination of terms
    #[arg(long, conflicts_with = "max_terms")]
    clusters: bool,

    /// Use linear consequents instead of constants
    #[arg(long)]
    lines: bool,

    /// Stop when a step lowers the cross-validation error by less than this share
    #[arg(long, default_value_t = 0.02, value_name = "SHARE", value_parser = numbers::share)]
    min_gain: f64,

    /// Minimum number of rows for a rule
    #[arg(long, default_value_t = 1, value_name = "ROWS", value_parser = whole(1, usize::MAX))]
    min_support: usize,

    /// Random seed (folds of cross-validation)
    #[arg(long, default_value_t = 0, value_name = "NUMBER", value_parser = numbers::seed)]
    seed: u64,

    /// The column with the weights of the rows. Rows of weight 0 do not count in `identify` and `tune`; `learn` refuses them
    #[arg(long, value_name = "COLUMN")]
    weight: Option<String>,

    /// Keep all rows with the same value of this column, such as `vehicle`, in the same fold of cross-validation
    #[arg(long, value_name = "COLUMN")]
    group_by: Option<String>,

    /// Number of cross-validation folds
    #[arg(long, default_value_t = 5, value_name = "COUNT", value_parser = whole(2_u32, 100))]
    folds: u32,

    /// Skip cross-validation
    #[arg(long)]
    no_validation: bool,

    #[command(flatten)]
    format: Format,

    /// Print a JSON document instead of text
    #[arg(long)]
    json: bool,
}

/// The results for the report.
struct IdentifyOutcome {
    rows: usize,
    refused: Vec<String>,
    /// The columns that were examined as inputs.
    columns: usize,
    /// Columns without a number.
    without_numbers: Vec<String>,
    identified: IdentifyResult,
    /// The cross-validation; `None` if it was not requested.
    validation: Option<IdentifyValidation>,
}

pub(crate) fn run(arguments: &Arguments) -> Result<Exit, Failure> {
    if arguments.input.contains(&arguments.target) {
        let message = format!("`{}` is both the target and an input", arguments.target);
        return Err(Failure::usage(message).help("name the other columns with `--input`"));
    }
    if let Some(rules) = arguments
        .data
        .iter()
        .find(|path| output::has_ending(path, output::RULES))
    {
        let failure = Failure::usage(format!(
            "`{}` is a rule set, and `identify` reads only tables",
            rules.display()
        ));
        return Err(failure.help(
            "`flagred learn` and `flagred tune` start from a rule set; otherwise leave it out",
        ));
    }
    rows::distinct(&arguments.data)?;
    let mut files = Files::reading(&arguments.data)?;
    let output = files.output(&arguments.output, Replace::forced(arguments.force))?;
    // A table is read only once, since it may be standard input.
    let mut tables = rows::tables(&arguments.data, &arguments.format).peekable();
    let (names, without_numbers) = match tables.peek() {
        Some(Ok(first)) => columns(arguments, first)?,
        _ => (arguments.input.clone(), Vec::new()),
    };
    if let Some(Ok(first)) = tables.peek() {
        has_numbers(arguments, first)?;
    }
    if let ([], [word, ..]) = (names.as_slice(), without_numbers.as_slice()) {
        let message = format!("no column except `{}` contains numbers", arguments.target);
        let help =
            format!("inputs are numbers, and `{word}` contains text: add columns with numbers");
        return Err(Failure::unreadable(message).help(help));
    }
    let failed = |error: TuneError| failure(arguments, &names, &error);
    check_columns(names.len()).map_err(failed)?;
    let (data, refused) = data(arguments, tables, &names)?;
    if let [first, others @ ..] = data.truths.as_slice()
        && others.iter().all(|other| other == first)
    {
        let failure = Failure::unreadable(format!("`{}` is {first} in all rows", arguments.target));
        return Err(failure.help(
            "name another column with `--target`, or add rows with other values of this one",
        ));
    }
    let settings = settings(arguments);
    let identified = identify(&names, &arguments.target, &data, &settings).map_err(failed)?;
    let validation = match arguments.no_validation {
        true => None,
        false => {
            let mut watch = |_| ControlFlow::Continue(());
            let folds = arguments.folds;
            cross_validate(
                &names,
                &arguments.target,
                &data,
                &settings,
                folds,
                &mut watch,
            )
            .map_err(failed)?
        }
    };
    let outcome = IdentifyOutcome {
        rows: data.len(),
        refused,
        columns: names.len(),
        without_numbers,
        identified,
        validation,
    };
    output.write(&report::rule_set(arguments, &outcome)?)?;
    let mut out = Stdout::beside(&[&output]);
    if arguments.json {
        let document = report::Document::new(&outcome);
        serde_json::to_writer_pretty(&mut out, &document).map_err(std::io::Error::from)?;
        writeln!(out)?;
    } else {
        report::words(&mut out, arguments, &outcome)?;
    }
    out.finish()?;
    Ok(Exit::Clean)
}

fn settings(arguments: &Arguments) -> Identification {
    let mut settings = Identification::default();
    settings.antecedents = match arguments.clusters {
        true => Antecedents::Clusters,
        false => Antecedents::Partitions,
    };
    settings.consequents = match arguments.lines {
        true => Consequents::Lines,
        false => Consequents::Constants,
    };
    settings.inputs = arguments.input.clone();
    settings.max_inputs = arguments.max_inputs as usize;
    settings.max_terms = arguments.max_terms as usize;
    settings.max_rules = arguments.max_rules as usize;
    settings.min_gain = arguments.min_gain;
    settings.least_support = arguments.min_support;
    settings.folds = arguments.folds;
    settings.seed = arguments.seed;
    settings
}

/// Returns the columns of a table that may be inputs, and the columns without a number.
fn columns(arguments: &Arguments, table: &Table) -> Result<(Vec<String>, Vec<String>), Failure> {
    let has = |name: &str| table.header.column(name).is_some();
    let mut joined = arguments.input.iter().chain(&arguments.ignore);
    if let Some(joined) =
        joined.find(|name| !has(name) && name.contains(',') && name.split(',').all(has))
    {
        let option = if arguments.input.is_empty() {
            "--ignore"
        } else {
            "--input"
        };
        let failure = Failure::usage(format!("`{joined}` is several columns"));
        return Err(failure.help(rows::repeated(option, joined)));
    }
    if !arguments.input.is_empty() {
        return Ok((arguments.input.clone(), Vec::new()));
    }
    for ignored in &arguments.ignore {
        table
            .header
            .require(ignored, "correct `--ignore`, or leave it out")?;
    }
    let special = [
        Some(&arguments.target),
        arguments.weight.as_ref(),
        arguments.group_by.as_ref(),
    ];
    let is_candidate = |name: &String| {
        !special.contains(&Some(name)) && !arguments.ignore.contains(name) && !name.is_empty()
    };
    let has_number = |column: usize| {
        (0..table.len()).any(|row| {
            matches!(
                Cell::of(table.text(row, column).as_bytes()),
                Cell::Number(_)
            )
        })
    };
    let names = table.header.names.iter().enumerate();
    let (numbers, others): (Vec<_>, Vec<_>) = names
        .filter(|(_, name)| is_candidate(name))
        .partition(|(column, _)| has_number(*column));
    let named =
        |all: Vec<(usize, &String)>| all.into_iter().map(|(_, name)| name.clone()).collect();
    Ok((named(numbers), named(others)))
}

/// Refuses a target that consists of words, such as `good` and `bad`.
fn has_numbers(arguments: &Arguments, table: &Table) -> Result<(), Failure> {
    let layout = &arguments.format.layout;
    if !layout.renames(&arguments.target) {
        let help = "name the column of the output with `--target`";
        table.header.require(&arguments.target, help)?;
    }
    let column = layout.columns(&[&arguments.target], &table.header)?;
    let help = "for two classes write 0 and 1; `FuzzyClassifier` of the Python package supports words and more than two classes";
    let column = column
        .first()
        .map(|column| table.has_numbers(*column, help));
    column.unwrap_or(Ok(()))
}

/// Returns the usable rows as columns, and the reasons why other rows cannot be used.
fn data(
    arguments: &Arguments,
    tables: impl Iterator<Item = Result<Table, Failure>>,
    names: &[String],
) -> Result<(Data, Vec<String>), Failure> {
    let all: Vec<&str> = names
        .iter()
        .chain([&arguments.target])
        .map(String::as_str)
        .collect();
    let read = rows::columns(
        tables,
        &arguments.format,
        &all,
        &[],
        [&arguments.weight, &arguments.group_by].map(Option::as_deref),
    )?;
    let (data, refused) = rows::in_columns(read, names.len(), Loss::Squared);
    if !refused.is_empty() && (!arguments.format.skip_bad_rows || data.is_empty()) {
        return Err(rows::refuse(
            &refused,
            refused.len() + data.truths.len(),
            "used",
        ));
    }
    Ok((data, refused))
}

fn failure(arguments: &Arguments, names: &[String], error: &TuneError) -> Failure {
    let target = &arguments.target;
    let failure = Failure::unusable(format!("`{target}`"), error);
    match error {
        TuneError::NoWeight => {
            failure.help("give some rows a weight above 0, or leave out `--weight`")
        }
        TuneError::NoInputHelps => {
            failure.help("add columns that are related to it, add rows, or lower `--min-gain`")
        }
        TuneError::TooManyColumns { .. } => {
            failure.help("select the inputs with `--input`, or exclude columns with `--ignore`")
        }
        TuneError::Unknown { name } => {
            failure.help_if(suggest(name, names.iter().map(String::as_str)))
        }
        _ => failure,
    }
}
