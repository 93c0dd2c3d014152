//! Comparison of outputs with a table that was written earlier.

use std::{io::Write as _, path::Path};

use flagred_authoring::slice::{Mapped, at};
use fuzzy::drawing::{short, visible};

use super::{Arguments, MapSource};
use crate::{
    failure::{Exit, Failure},
    output::{self, Stdout},
    table::{Cell, Table},
};

/// Differences below this value, relative to the range of the output, are ignored, because another program may write
/// fewer digits.
const NEGLIGIBLE: f64 = 1e-9;

/// The row with the largest difference.
struct LargestDifference {
    line: u64,
    point: Vec<f64>,
    before: Option<f64>,
    now: Option<f64>,
}

/// Compares the outputs with the columns of the same names.
pub(super) fn against(
    path: &Path,
    arguments: &Arguments,
    evaluated: &MapSource,
) -> Result<Exit, Failure> {
    let table = Table::read(path, arguments.layout.delimiter)?;
    let names: Vec<&str> = evaluated.engine.input_names().collect();
    let header = &table.header;
    let columns = arguments.layout.columns(&names, header);
    let columns = columns.map_err(|failure| match header.names.len() {
        // A table to compare with has a column for at least one input and one output.
        1 if header.other_delimiter().is_none() => failure.help(
            "`map --csv` writes such a table; the tables of `map --values` cannot be compared",
        ),
        _ => failure,
    })?;
    let suffix = &arguments.suffix.suffix;
    let outputs = evaluated.engine.output_names().enumerate();
    let outputs = outputs.filter_map(|(output, name)| {
        let name = format!("{name}{suffix}");
        let column = table.header.column(&name)?;
        Some((output, name, column))
    });
    let outputs: Vec<(usize, String, usize)> = outputs.collect();
    if outputs.is_empty() {
        let outputs = evaluated.engine.output_names();
        let outputs: Vec<String> = outputs.map(|name| format!("{name}{suffix}")).collect();
        let message = format!("`{}` has no column for an output", table.header.file);
        let known = fuzzy::diagnostic::suggest("", outputs.iter().map(String::as_str));
        let known = known.unwrap_or_default();
        return Err(Failure::unreadable(message)
            .help(format!("{known}; `flagred map --csv` writes such a table")));
    }
    let mut suffixes = Vec::new();
    let mut out = Stdout::text();
    let mut exit = Exit::Clean;
    let file = visible(&table.header.file);
    for (output, name, column) in outputs {
        let mapped = Mapped {
            output,
            // The filling applies only to the output of the profile.
            filling: evaluated
                .mapped()
                .filling
                .filter(|_| output == evaluated.output),
            ..evaluated.mapped()
        };
        let (differ, worst) = differences(&table, &mapped, &columns, column)?;
        suffixes.extend(other_suffix(evaluated, &table, output).filter(|_| worst.is_some()));
        let (rows, name) = (table.len(), visible(&name));
        let Some(worst) = worst else {
            writeln!(out, "{file}: `{name}` is the same at {rows} points")?;
            continue;
        };
        exit = Exit::Findings;
        let at = names.iter().zip(&worst.point);
        let at: Vec<String> = at
            .map(|(name, x)| format!("{} = {}", visible(name), short(*x)))
            .collect();
        let value = |value: Option<f64>| value.map_or_else(|| "no value".to_owned(), short);
        writeln!(
            out,
            "{file}: `{name}` differs at {differ} of {rows} points, most in line {}, at {}: {} before, {} now",
            worst.line,
            at.join(", "),
            value(worst.before),
            value(worst.now)
        )?;
    }
    out.finish()?;
    if let Some(other) = suffixes.first().filter(|_| suffix.is_empty()) {
        output::print_note(&format!(
            "help: if `eval --suffix {other}` wrote the table, add `--suffix {other}`: the columns without it contain measured values"
        ));
    }
    Ok(exit)
}

/// Returns the suffix by which the name of another column extends the name of an output, such as `_rules`.
fn other_suffix<'t>(evaluated: &MapSource, table: &'t Table, output: usize) -> Option<&'t str> {
    let output = evaluated.engine.output_names().nth(output)?;
    let mut columns = table.header.names.iter();
    columns.find_map(|name| {
        name.strip_prefix(output)
            .filter(|suffix| suffix.starts_with('_'))
    })
}

/// Returns how many rows differ, and the largest difference. A value that is missing on one side
/// counts as the largest difference.
fn differences(
    table: &Table,
    mapped: &Mapped<'_>,
    inputs: &[usize],
    column: usize,
) -> Result<(usize, Option<LargestDifference>), Failure> {
    let bad = |row: usize, column: usize| {
        let problem = Cell::problem(table.text(row, column).as_bytes());
        let (file, line) = (&table.header.file, table.line(row));
        let name = table.header.name(column);
        Failure::unreadable(format!("`{file}`, line {line}, column `{name}`: {problem}"))
    };
    let range = mapped.model.outputs.get(mapped.output);
    let range = range.map_or(1.0, |output| output.variable.high - output.variable.low);
    let (mut differ, mut worst, mut most) = (0, None, 0.0);
    for row in 0..table.len() {
        let point = inputs.iter().map(|input| {
            let number = table.number(row, *input);
            number.map_err(|_| bad(row, *input))
        });
        let point: Vec<f64> = point.collect::<Result<_, _>>()?;
        let before = match Cell::of(table.text(row, column).as_bytes()) {
            Cell::Number(value) => Some(value),
            Cell::Unknown => None,
            Cell::Bad => return Err(bad(row, column)),
        };
        let now = at(mapped, &point).map_err(|error| Failure::unreadable(error.to_string()))?;
        let difference = match (before, now.value) {
            (Some(before), Some(now)) => (before - now).abs(),
            (None, None) => 0.0,
            _ => f64::INFINITY,
        };
        if difference <= NEGLIGIBLE * range {
            continue;
        }
        differ += 1;
        if difference > most {
            most = difference;
            worst = Some(LargestDifference {
                line: table.line(row),
                point,
                before,
                now: now.value,
            });
        }
    }
    Ok((differ, worst))
}
