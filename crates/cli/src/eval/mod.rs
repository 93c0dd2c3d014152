//! `flagred eval`: evaluates a rule set at many points, from CSV to CSV.

mod errors;
mod pipeline;
mod rows;
mod tally;
mod uncertain;

use std::{
    io::{self, Write as _},
    path::{Path, PathBuf},
};

use fuzzy::{Engine, model::MembershipFunction};

use self::tally::Tally;

use crate::{
    failure::{Exit, Failure},
    output::{self, Files, Replace, Stdout},
    rule_set,
    table::{self, Format, Header},
};

#[derive(clap::Args)]
pub(crate) struct Arguments {
    /// The rule set: a file in YAML, FIS, FLL, FCL or FML, the name of a built-in one, or `-` for standard input
    #[arg(value_name = "RULES")]
    model: PathBuf,

    /// A table with a column for each input; other columns are copied [default: standard input]
    #[arg(
        value_name = "TABLE.csv",
        default_value = "-",
        hide_default_value = true
    )]
    points: PathBuf,

    /// The file to write, replaced if it exists; `-` is standard output [default: -]
    #[arg(short, long, value_name = "OUT.csv", default_value = "-", hide_default_value = true, value_parser = output::table_path)]
    output: PathBuf,

    #[command(flatten)]
    suffix: table::Suffix,

    /// Add columns that explain the outputs; separate several by commas, or repeat the option
    #[arg(long, value_name = "COLUMN", value_delimiter = ',')]
    with: Vec<ExplanationColumn>,

    /// The half-width of an uncertain input, as a number or a column: `heat=0.5`; may be repeated.
    /// Adds an interval of each output, which contains its values for all inputs within the half-widths
    #[arg(long, value_name = "INPUT=HALF_WIDTH", value_parser = table::pair)]
    uncertain: Vec<(String, String)>,

    #[command(flatten)]
    format: Format,
}

/// A column that explains the outputs of a row.
#[derive(Debug, Clone, Copy, PartialEq, Eq, clap::ValueEnum)]
enum ExplanationColumn {
    /// The coverage: the largest firing strength of any rule, from 0 to 1
    Coverage,
    /// The number of the rule with the largest firing strength, counted from 1
    Rule,
    /// The inputs that are outside their range and were clamped
    Clamped,
    /// Why the row has no value
    Error,
}

impl ExplanationColumn {
    fn name(self) -> &'static str {
        match self {
            ExplanationColumn::Coverage => "coverage",
            ExplanationColumn::Rule => "dominant_rule",
            ExplanationColumn::Clamped => "clamped",
            ExplanationColumn::Error => "error",
        }
    }
}

/// The settings for processing a row.
struct Plan {
    engine: Engine,
    header: Header,
    /// The column of each input.
    inputs: Vec<usize>,
    with: Vec<ExplanationColumn>,
    suffix: String,
    /// For each output, whether it has an interval. The ends of the interval are written to separate columns.
    intervals: Vec<bool>,
    /// For each input, its half-width; empty if all inputs are numbers.
    half_widths: Vec<Option<uncertain::HalfWidth>>,
    /// For each output, the column with its measured values.
    measured: Vec<Option<usize>>,
    delimiter: u8,
    skip_bad_rows: bool,
    /// Whether the table is written to a terminal.
    is_terminal: bool,
}

pub(crate) fn run(arguments: &Arguments) -> Result<Exit, Failure> {
    let mut files = Files::reading([&arguments.model, &arguments.points])?;
    let output = files.output(&arguments.output, Replace::Yes)?;
    table::rule_set_first(
        "eval",
        &arguments.model,
        std::slice::from_ref(&arguments.points),
    )?;
    let points = arguments.points.display().to_string();
    if points.contains('=') && !arguments.points.exists() {
        let failure = Failure::usage(format!("`{points}` is not a table"));
        let model = arguments.model.display();
        return Err(failure.help(format!(
            "`flagred explain {model} {points}` evaluates one point"
        )));
    }
    let engine = rule_set::load(&arguments.model)?;
    let format = &arguments.format;
    let (header, reader) = table::open(&arguments.points, format.layout.delimiter)?;
    let names: Vec<&str> = engine.input_names().collect();
    let inputs = format.layout.columns(&names, &header)?;
    let mut with = Vec::new();
    for column in &arguments.with {
        if !with.contains(column) {
            with.push(*column);
        }
    }
    let half_widths = uncertain::half_widths(&arguments.uncertain, &engine, &header)?;
    let plan = Plan {
        inputs,
        measured: match arguments.suffix.suffix.is_empty() {
            true => vec![None; engine.output_names().len()],
            false => engine
                .output_names()
                .map(|name| header.column(name))
                .collect(),
        },
        suffix: arguments.suffix.suffix.clone(),
        intervals: {
            let model = engine.model();
            let outputs = model.outputs.iter();
            let is_uncertain = !half_widths.is_empty();
            outputs
                .map(|output| is_uncertain || model.has_interval(output))
                .collect()
        },
        half_widths,
        engine,
        header,
        with,
        delimiter: format.layout.delimiter,
        skip_bad_rows: format.skip_bad_rows,
        is_terminal: output::is_terminal(Some(&output)),
    };
    let head = plan.head()?;
    let tally = if output.is_stdout() {
        let mut out = Stdout::data();
        out.write_all(&head)?;
        // A stream may be endless, so its evaluation stops when nobody reads the output any more. A file is evaluated
        // to its end in any case, because the report covers all rows.
        let is_stream = arguments.points == Path::new("-");
        let is_read = |out: &Stdout| !(is_stream && out.is_closed());
        let evaluated = pipeline::run(&plan, reader, &mut out, is_read)?;
        out.finish()?;
        evaluated?
    } else {
        let (mut tally, mut failed) = (Tally::new(&plan), None);
        let written = output.write_with(|out| {
            out.write_all(&head)?;
            match pipeline::run(&plan, reader, out, |_| true)? {
                Ok(of_rows) => tally = of_rows,
                Err(failure) => failed = Some(failure),
            }
            // An error here discards the partial table.
            failed
                .as_ref()
                .map_or(Ok(()), |_| Err(io::ErrorKind::InvalidData.into()))
        });
        failed.map_or(written, Err)?;
        tally
    };
    tally.print_notes(&plan);
    Ok(if tally.is_complete(&plan) {
        Exit::Clean
    } else {
        Exit::Findings
    })
}

impl Plan {
    fn writer<'b>(&self, buffer: &'b mut Vec<u8>) -> csv::Writer<&'b mut Vec<u8>> {
        csv::WriterBuilder::new()
            .delimiter(self.delimiter)
            // A row that begins like a comment is quoted.
            .comment(Some(b'#'))
            .from_writer(buffer)
    }

    /// Returns whether a term of an output is a formula.
    fn has_formula(&self, output: &str) -> bool {
        let mut outputs = self.engine.model().outputs.iter();
        let output = outputs.find(|known| known.variable.name == output);
        output.is_some_and(|output| {
            let mut terms = output.variable.terms.iter();
            terms.any(|term| {
                matches!(
                    term.membership_function,
                    MembershipFunction::Function { .. }
                )
            })
        })
    }

    /// The header of the output.
    fn head(&self) -> Result<Vec<u8>, Failure> {
        let outputs = self.engine.output_names();
        let outputs: Vec<String> = outputs
            .map(|output| format!("{output}{}", self.suffix))
            .collect();
        let of_outputs = |word: &str| match outputs.as_slice() {
            [_] => vec![word.to_owned()],
            several => several
                .iter()
                .map(|output| format!("{output}_{word}"))
                .collect(),
        };
        let mut added = Vec::new();
        for (output, is_interval) in outputs.iter().zip(&self.intervals) {
            added.push(output.clone());
            if *is_interval {
                added.extend(["low", "high"].map(|end| format!("{output}_{end}")));
            }
        }
        for with in &self.with {
            added.extend(match with {
                ExplanationColumn::Coverage | ExplanationColumn::Rule => of_outputs(with.name()),
                ExplanationColumn::Clamped | ExplanationColumn::Error => {
                    vec![with.name().to_owned()]
                }
            });
        }
        if let Some(name) = added.iter().find(|name| self.header.column(name).is_some()) {
            return Err(
                Failure::usage(format!("the points have a column `{name}` already"))
                    .help("`--suffix _model` appends `_model` to the names of the output columns, and compares the outputs with measured values"),
            );
        }
        let names = self.header.names.iter().chain(&added);
        let names = names.map(|name| output::copied(name.as_bytes(), self.is_terminal));
        let mut head = Vec::new();
        let mut writer = self.writer(&mut head);
        writer.write_record(names)?;
        writer.flush()?;
        drop(writer);
        Ok(head)
    }
}
