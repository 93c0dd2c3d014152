//! Shared by `identify`, `learn`, `tune` and `simplify`: arguments, and rows of tables with their positions for messages.

use std::{
    collections::BTreeMap,
    path::{Path, PathBuf},
};

use clap::ValueEnum;
use flagred_evaluation::learning::Row;
use fuzzy::{
    Model,
    check::{Direction, Monotone},
    model::Variable,
};

use crate::{
    failure::Failure,
    output::{self, Files, Output, Replace},
    table::{self, Extent, Format, Table},
};

/// The arguments of a command that derives a rule set from another one.
#[derive(clap::Args)]
pub(crate) struct Rewrite {
    /// The rule set: a file in YAML, FIS, FLL, FCL or FML, the name of a built-in one, or `-` for standard input
    #[arg(value_name = "RULES")]
    pub(crate) model: PathBuf,

    /// The file to write; `-` is standard output
    #[arg(short, long, value_name = "OUT.yaml", value_parser = output::rules_path)]
    pub(crate) output: PathBuf,

    /// Replace the file if it exists
    #[arg(long)]
    pub(crate) force: bool,

    #[command(flatten)]
    pub(crate) format: Format,

    /// Print a JSON document instead of text
    #[arg(long)]
    pub(crate) json: bool,
}

/// The arguments of a command that derives a rule set from another one and from rows.
#[derive(clap::Args)]
pub(crate) struct DerivationArguments {
    #[command(flatten)]
    pub(crate) rewrite: Rewrite,

    /// Tables with a column for each input and the output, as `flagred dataset` writes them
    #[arg(required = true, value_name = "TABLE.csv")]
    pub(crate) data: Vec<PathBuf>,

    #[command(flatten)]
    pub(crate) claims: OutputClaims,

    /// The column with the weights of the rows. Rows of weight 0 do not count in `identify` and `tune`; `learn` refuses them
    #[arg(long, value_name = "COLUMN")]
    weight: Option<String>,

    /// Keep all rows with the same value of this column, such as `vehicle`, in the same fold of cross-validation
    #[arg(long, value_name = "COLUMN")]
    pub(crate) group_by: Option<String>,

    /// Skip cross-validation
    #[arg(long, conflicts_with = "group_by")]
    pub(crate) no_validation: bool,

    /// Replace inputs outside their range by its nearest end, as `eval` does; `learn` also does this for the output
    #[arg(long)]
    clamp: bool,
}

impl DerivationArguments {
    /// Returns the files that the command reads and writes, and its output.
    pub(crate) fn files(&self, command: &str) -> Result<(Files, Output), Failure> {
        let with_output = format!("{command} --output {}", self.rewrite.output.display());
        table::rule_set_first(&with_output, &self.rewrite.model, &self.data)?;
        let Rewrite {
            model,
            output,
            force,
            ..
        } = &self.rewrite;
        distinct(&self.data)?;
        let mut files = Files::reading(self.data.iter().chain([model]))?;
        let output = files.output(output, Replace::forced(*force))?;
        Ok((files, output))
    }
}

/// Claims about an output.
#[derive(clap::Args)]
pub(crate) struct OutputClaims {
    /// The output must not fall when this input rises; `INPUT:OUTPUT` for one of several outputs; may be repeated
    #[arg(long, value_name = "INPUT")]
    rising: Vec<String>,

    /// The output must not rise when this input rises; `INPUT:OUTPUT` for one of several outputs; may be repeated
    #[arg(long, value_name = "INPUT")]
    falling: Vec<String>,
}

impl OutputClaims {
    pub(crate) fn is_empty(&self) -> bool {
        self.rising.is_empty() && self.falling.is_empty()
    }

    /// Advice for several inputs in one option, `--rising temperature,humidity`.
    pub(crate) fn joined(&self) -> Option<String> {
        let mut options = [("--rising", &self.rising), ("--falling", &self.falling)].into_iter();
        options.find_map(|(option, inputs)| {
            let joined = inputs.iter().find(|input| input.contains(','))?;
            Some(repeated(option, joined))
        })
    }

    /// Returns the claims of `--rising`, followed by the claims of `--falling`.
    ///
    /// # Errors
    ///
    /// If the same claim is made in both directions.
    pub(crate) fn monotone(&self) -> Result<Vec<Monotone>, Failure> {
        if let Some(both) = self
            .rising
            .iter()
            .find(|claim| self.falling.contains(claim))
        {
            let message = format!("`{both}` is given with `--rising` and with `--falling`");
            return Err(Failure::usage(message).help("keep the direction that applies"));
        }
        let rising = self.rising.iter();
        let rising = rising.map(|claim| Monotone::new(claim, Direction::Increasing));
        let falling = self.falling.iter();
        Ok(rising
            .chain(falling.map(|claim| Monotone::new(claim, Direction::Decreasing)))
            .collect())
    }

    /// Adds advice to the error for a file that cannot be read: its name may be meant as a further input of a claim.
    pub(crate) fn or_input(&self, path: &Path, failure: Failure) -> Failure {
        let option = match (self.rising.is_empty(), self.falling.is_empty()) {
            _ if path.exists() || path.extension().is_some() => return failure,
            (true, true) => return failure,
            (false, _) => "--rising",
            (true, false) => "--falling",
        };
        failure.help(format!(
            "for a second input repeat the option: `{option} {}`",
            path.display()
        ))
    }

    /// Returns an error if there are claims: the file is a profile, but only rule sets can have claims.
    pub(crate) fn about_rule_sets(&self, profile: &Path) -> Result<(), Failure> {
        let option = match self.rising.is_empty() {
            _ if self.is_empty() => return Ok(()),
            true => "--falling",
            false => "--rising",
        };
        let message = format!(
            "`{option}` needs a rule set, but `{}` is a profile",
            profile.display()
        );
        Err(Failure::usage(message).help("check the rule set that the profile names under `rules`"))
    }

    /// Returns an error for claims about inputs that the rule set does not have.
    pub(crate) fn check_inputs(&self, model: &Model) -> Result<(), Failure> {
        let names = || model.inputs.iter().map(|input| input.name.as_str());
        let claims = self.monotone()?;
        let mut inputs = claims.iter().map(|claim| &claim.input);
        match inputs.find(|input| !names().any(|name| name == *input)) {
            None => Ok(()),
            Some(input) => {
                let failure = Failure::usage(format!("the rule set has no input `{input}`"));
                let near = || fuzzy::diagnostic::suggest(input, names());
                Err(failure.help_if(self.joined().or_else(near)))
            }
        }
    }

    /// Returns the claims for the only output that is learned.
    ///
    /// # Errors
    ///
    /// As for [`monotone`](Self::monotone), or if a claim names another output.
    pub(crate) fn about(&self, output: &str) -> Result<Vec<Monotone>, Failure> {
        let mut claims = self.monotone()?;
        for claim in &mut claims {
            match claim.output.replace(output.to_owned()) {
                Some(other) if other != output => {
                    let message = format!(
                        "`{}:{other}`: `{other}` is not the learned output",
                        claim.input
                    );
                    return Err(Failure::usage(message)
                        .help(format!("write `{0}` or `{0}:{output}`", claim.input)));
                }
                _ => {}
            }
        }
        Ok(claims)
    }
}

/// Advice for several values in one option that may be repeated.
pub(crate) fn repeated(option: &str, joined: &str) -> String {
    let each = joined
        .split(',')
        .map(|one| format!("{option} {}", one.trim()));
    format!(
        "repeat the option: `{}`",
        each.collect::<Vec<_>>().join(" ")
    )
}

/// Returns the command-line word for a value.
pub(crate) fn word(value: &impl ValueEnum) -> String {
    let word = value.to_possible_value();
    word.map_or_else(String::new, |word| word.get_name().to_owned())
}

/// Rows with their positions, and the reasons why other rows cannot be used.
pub(crate) struct Data {
    pub(crate) rows: Vec<(Row, String)>,
    pub(crate) refused: Vec<String>,
}

/// The variables whose values `--clamp` clamps.
#[derive(Clone, Copy)]
pub(crate) enum Clamped {
    Inputs,
    /// The inputs and the output.
    All,
}

/// Reads the values of the inputs and of the measured output of a model from all tables.
pub(crate) fn read(
    arguments: &DerivationArguments,
    model: &Model,
    clamped: Clamped,
) -> Result<Data, Failure> {
    let variables: Vec<&Variable> = model.measured_variables().collect();
    let names: Vec<&str> = variables.iter().map(|v| v.name.as_str()).collect();
    let optional = [&arguments.weight, &arguments.group_by].map(Option::as_deref);
    let format = &arguments.rewrite.format;
    // Names of constants may replace their numbers, such as `failed` for 1.
    let terms = variables.last().map(|output| output.terms.iter());
    let labels: Vec<(String, f64)> = terms
        .into_iter()
        .flatten()
        .filter_map(|term| Some((term.name.clone(), term.membership_function.number()?)))
        .collect();
    let tables = tables(&arguments.data, format);
    let mut data = columns(tables, format, &names, &labels, optional)?;
    for (column, variable) in variables.iter().enumerate() {
        let values = data
            .rows
            .iter()
            .filter_map(|(row, _)| row.values.get(column));
        if let Some(warning) = Extent::of(values.copied()).warning(variable) {
            output::print_note(&warning);
        }
    }
    if arguments.clamp {
        clamp(
            &mut data,
            match clamped {
                Clamped::All => &variables,
                Clamped::Inputs => variables.get(..model.inputs.len()).unwrap_or_default(),
            },
        );
    }
    Ok(data)
}

/// Clamps the values of rows to the ranges of the variables, and reports how many were outside.
fn clamp(data: &mut Data, variables: &[&Variable]) {
    let rows = data.rows.len();
    for (column, variable) in variables.iter().enumerate() {
        let Variable { low, high, .. } = **variable;
        let mut first: Option<String> = None;
        let mut count = 0;
        for (row, place) in &mut data.rows {
            let Some(value) = row.values.get_mut(column) else {
                continue;
            };
            if *value < low || *value > high {
                *value = value.clamp(low, high);
                first.get_or_insert_with(|| place.clone());
                count += 1;
            }
        }
        if let Some(first) = first {
            output::print_note(&format!(
                "`{}` is outside its range from {low} to {high} in {count} of {rows} rows and clamped to it (first in {first})",
                variable.name
            ));
        }
    }
}

/// Refuses a file that is given twice: its rows would be both training and test rows.
pub(crate) fn distinct(files: &[PathBuf]) -> Result<(), Failure> {
    match output::repeated(files) {
        None => Ok(()),
        Some(file) => {
            let message = format!("`{}` is given twice", file.display());
            Err(Failure::usage(message).help("name each file once"))
        }
    }
}

/// Returns the tables; each is read when the iterator reaches it.
pub(crate) fn tables<'a>(
    paths: &'a [PathBuf],
    format: &'a Format,
) -> impl Iterator<Item = Result<Table, Failure>> + 'a {
    paths.iter().map(|path| Table::read_with(path, format))
}

/// Reads the values of variables from all tables, and the columns with the weights and the groups of the rows. `labels` are words
/// that may replace values of the last variable.
pub(crate) fn columns(
    tables: impl Iterator<Item = Result<Table, Failure>>,
    format: &Format,
    names: &[&str],
    labels: &[(String, f64)],
    [weight, group]: [Option<&str>; 2],
) -> Result<Data, Failure> {
    let words = "name another column, or write numbers; for two classes write 0 and 1";
    let mut data = Data {
        rows: Vec::new(),
        refused: Vec::new(),
    };
    let mut groups: BTreeMap<String, u32> = BTreeMap::new();
    for table in tables {
        let mut table = table?;
        data.refused.append(&mut table.skipped);
        let columns = format.layout.columns(names, &table.header)?;
        let optional = |name: Option<&str>| {
            name.map(|name| {
                table.header.require(
                    name,
                    "correct `--weight` or `--group-by`, or leave the option out",
                )
            })
            .transpose()
        };
        let weight = optional(weight)?;
        let group = optional(group)?;
        if let Some((output, inputs)) = columns.split_last()
            && inputs.contains(output)
        {
            let column = table.header.name(*output);
            let message = format!("column `{column}` is both an input and the output");
            return Err(Failure::usage(message).help("correct `--column`"));
        }
        let kept = data.rows.len();
        for row in 0..table.len() {
            let mut bad = Vec::new();
            let mut number = |column: usize| {
                table.number(row, column).unwrap_or_else(|cell| {
                    bad.push(format!("column `{}`: {}", cell.column, cell.problem));
                    f64::NAN
                })
            };
            let label = columns.last().and_then(|output| {
                let text = table.text(row, *output).trim();
                let mut labels = labels.iter();
                labels
                    .find(|(label, _)| label == text)
                    .map(|(_, value)| *value)
            });
            let values: Vec<f64> = match (columns.split_last(), label) {
                (Some((_, inputs)), Some(label)) => inputs
                    .iter()
                    .map(|column| number(*column))
                    .chain([label])
                    .collect(),
                _ => columns.iter().map(|column| number(*column)).collect(),
            };
            let weight = weight.map_or(1.0, &mut number);
            let place = format!("`{}`, line {}", table.header.file, table.line(row));
            if !bad.is_empty() {
                data.refused.push(format!("{place}, {}", bad.join("; ")));
                continue;
            }
            let group = group.map(|column| {
                let next = u32::try_from(groups.len()).unwrap_or(u32::MAX);
                let name = table.text(row, column).to_owned();
                *groups.entry(name).or_insert(next)
            });
            let row = Row {
                values,
                weight,
                group,
            };
            data.rows.push((row, place));
        }
        if data.rows.len() == kept {
            let is_word = columns.last().is_some_and(|output| {
                (0..table.len()).any(|row| {
                    labels
                        .iter()
                        .any(|(label, _)| label == table.text(row, *output))
                })
            });
            let columns = columns.iter().take(columns.len() - usize::from(is_word));
            for column in columns {
                table.has_numbers(*column, words)?;
            }
            if let Some(column) = weight {
                let name = table.header.name(column);
                let help = format!(
                    "a weight is a number; to keep rows with the same `{name}` in one fold, write `--group-by {name}`"
                );
                table.has_numbers(column, &help)?;
            }
        }
    }
    Ok(data)
}

/// Refuses rows in which the value of an input is outside its range.
pub(crate) fn in_range(read: Data, model: &Model) -> Data {
    let Data { rows, mut refused } = read;
    let is_outside =
        |(value, input): &(&f64, &Variable)| !(input.low..=input.high).contains(*value);
    let mut kept = Vec::with_capacity(rows.len());
    for (row, place) in rows {
        // The output, which is the last value, may be outside its range: constants approach it as far as they are
        // allowed to.
        match row.values.iter().zip(&model.inputs).find(is_outside) {
            None => kept.push((row, place)),
            Some((value, input)) => {
                let (name, low, high) = (&input.name, input.low, input.high);
                refused.push(format!(
                    "{place}, column `{name}`: {value} is outside the range from {low} to {high}"
                ));
            }
        }
    }
    Data {
        rows: kept,
        refused,
    }
}

/// Converts rows to columns. Also returns the reasons why other rows cannot be used.
pub(crate) fn in_columns(
    read: Data,
    inputs: usize,
    loss: flagred_tuning::Loss,
) -> (flagred_tuning::Data, Vec<String>) {
    let Data { rows, mut refused } = read;
    let mut data = flagred_tuning::Data {
        inputs: vec![Vec::with_capacity(rows.len()); inputs],
        ..flagred_tuning::Data::default()
    };
    for (row, place) in rows {
        if let Some(problem) = flagred_tuning::Data::problem(&row.values, row.weight, loss) {
            refused.push(format!("{place}: {problem}"));
            continue;
        }
        for (column, value) in data.inputs.iter_mut().zip(&row.values) {
            column.push(*value);
        }
        data.truths.extend(row.values.last());
        data.weights.push(row.weight);
        data.groups.extend(row.group);
    }
    (data, refused)
}

/// Reports the rows that cannot be used, out of `rows` rows in total, as a failure. Rows with the same problem are
/// summarised.
pub(crate) fn refuse(refused: &[String], rows: usize, purpose: &str) -> Failure {
    const SHOWN: usize = 3;
    const KINDS: usize = 5;
    let mut kinds: Vec<(String, Vec<&String>)> = Vec::new();
    for why in refused {
        let kind = kind(why);
        match kinds.iter_mut().find(|(other, _)| *other == kind) {
            Some((_, same)) => same.push(why),
            None => kinds.push((kind, vec![why])),
        }
    }
    let mut details = Vec::new();
    for (_, same) in kinds.iter().take(KINDS) {
        details.extend(same.iter().take(SHOWN).map(|why| (*why).clone()));
        let more = same.len().saturating_sub(SHOWN);
        details.extend((more > 0).then(|| format!("and {more} more like these")));
    }
    let others = kinds.iter().skip(KINDS).map(|(_, same)| same.len());
    let others: usize = others.sum();
    details.extend((others > 0).then(|| format!("and {others} with other problems")));
    let count = refused.len();
    let outside = refused.iter().filter(|why| why.contains("outside")).count();
    let failure = Failure::unreadable(format!(
        "{count} row{} cannot be {purpose}, and nothing was written",
        if count == 1 { "" } else { "s" }
    ))
    .details(details);
    if outside > 1 && 2 * outside > rows {
        return failure.help(format!(
            "{outside} of {rows} rows are outside a range, so their values are probably in another unit: convert them, or correct the `range` in the rule set"
        ));
    }
    failure.help(match (count < rows, outside > 0) {
        (false, false) => "correct or remove these rows",
        (true, false) => "correct or remove these rows, or leave them out with `--skip-bad-rows`",
        (false, true) => {
            "correct or remove these rows, or clamp values outside a range with `--clamp`"
        }
        (true, true) => {
            "correct or remove these rows, leave them out with `--skip-bad-rows`, or clamp values outside a range with `--clamp`"
        }
    })
}

/// Returns the kind of a row's problem: the message without position, numbers and quoted texts, but with the name of the
/// column or variable.
fn kind(why: &str) -> String {
    let (_, problem) = why.split_once(", line ").unwrap_or(("", why));
    let mut kind = String::new();
    for (i, part) in problem.split('`').enumerate() {
        if i % 2 == 0 {
            let is_number = |c: &char| c.is_ascii_digit() || matches!(c, '.' | '-');
            kind.extend(part.chars().filter(|c| !is_number(c)));
        } else if kind.ends_with("column ") || kind == ": " {
            kind.push_str(part);
        }
    }
    kind
}
