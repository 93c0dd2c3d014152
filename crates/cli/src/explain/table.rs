//! Explanations of the rows of a table: the dominant rule and the shares of all rules, for each output.

use std::{io::Write as _, path::Path};

use fuzzy::{
    Engine,
    drawing::short,
    engine::{EvaluateError, ExplainedOutput},
};

use super::Arguments;
use crate::{
    failure::Failure,
    output::{self, Output, Stdout},
    table::{Cell, Header, Table},
};

/// Writes the table with three columns added for each output: `fan`, `fan_rule` and `fan_shares`, such as `3=0.61|2=0.39`.
pub(super) fn explain(
    engine: &Engine,
    path: &Path,
    arguments: &Arguments,
    output: Option<&Output>,
) -> Result<(), Failure> {
    let format = &arguments.format;
    let mut table = Table::read_with(path, format)?;
    let names: Vec<&str> = engine.input_names().collect();
    let inputs = format.layout.columns(&names, &table.header)?;
    let mut writer = csv::WriterBuilder::new()
        .delimiter(format.layout.delimiter)
        .comment(Some(b'#'))
        .from_writer(Vec::new());
    let is_terminal = output::is_terminal(output);
    let copied = |text: &str| output::copied(text.as_bytes(), is_terminal).into_owned();
    let added = added(engine, &table.header, &arguments.suffix.suffix)?;
    let names = table.header.names.iter().chain(&added);
    writer.write_record(names.map(|name| copied(name)))?;
    let mut skipped = std::mem::take(&mut table.skipped);
    let rows = table.len() + skipped.len();
    for row in 0..table.len() {
        let values = inputs.iter().map(|input| value(&table, row, *input));
        let values: Vec<f64> = match values.collect::<Result<_, String>>() {
            Ok(values) => values,
            Err(problem) if format.skip_bad_rows => {
                skipped.push(problem);
                continue;
            }
            Err(problem) => {
                let failure = Failure::unreadable(problem);
                return Err(failure.help("`--skip-bad-rows` leaves such rows out"));
            }
        };
        let outputs = match engine.explain(&values) {
            Ok(explanation) => explanation.outputs,
            Err(EvaluateError::InputNotFinite) => Vec::new(),
            Err(error) => return Err(Failure::unreadable(error)),
        };
        let columns = 0..table.header.names.len();
        let cells = columns.map(|column| copied(table.cell(row, column)));
        let reasons = (0..engine.output_names().len()).flat_map(|i| reasons(outputs.get(i)));
        writer.write_record(cells.chain(reasons.map(String::into_bytes)))?;
    }
    if let Some(first) = skipped.first() {
        let count = skipped.len();
        output::print_note(&format!(
            "left out {count} of {rows} rows: they cannot be read (first: {first})"
        ));
    }
    let text = writer.into_inner();
    let text = text.map_err(|error| Failure::unreadable(error.to_string()))?;
    match output.filter(|output| !output.is_stdout()) {
        Some(output) => output.write_with(|out| out.write_all(&text)),
        None => {
            let mut out = Stdout::data();
            out.write_all(&text)?;
            out.finish()
        }
    }
}

/// The names of the added columns.
fn added(engine: &Engine, header: &Header, suffix: &str) -> Result<Vec<String>, Failure> {
    let of = |output: &str| ["", "_rule", "_shares"].map(|end| format!("{output}{suffix}{end}"));
    let added: Vec<String> = engine.output_names().flat_map(of).collect();
    match added.iter().find(|name| header.column(name).is_some()) {
        None => Ok(added),
        Some(name) => Err(Failure::usage(format!(
            "`{}` has a column `{name}` already",
            header.file
        ))
        .help("`--suffix _model` appends `_model` to the names of the output columns")),
    }
}

/// The value of an input in a row; NaN if unknown.
fn value(table: &Table, row: usize, column: usize) -> Result<f64, String> {
    let text = table.text(row, column).as_bytes();
    match Cell::of(text) {
        Cell::Number(number) => Ok(number),
        Cell::Unknown => Ok(f64::NAN),
        Cell::Bad => {
            let (file, line) = (&table.header.file, table.line(row));
            let (name, problem) = (table.header.name(column), Cell::problem(text));
            Err(format!("`{file}`, line {line}, column `{name}`: {problem}"))
        }
    }
}

/// The value, the dominant rule and the shares of an output; empty cells if an input is unknown.
fn reasons(output: Option<&ExplainedOutput>) -> [String; 3] {
    let Some(output) = output else {
        return Default::default();
    };
    let value = output.value.map(|value| value.to_string());
    let strongest = output.rules.iter().reduce(|a, b| {
        // Among equally strong rules the first one in the file is dominant.
        let is_stronger = b.strength > a.strength || (b.strength == a.strength && b.rule < a.rule);
        if is_stronger { b } else { a }
    });
    let rule = strongest.map(|share| (share.rule + 1).to_string());
    let shares = output.rules.iter().filter(|share| share.share > 0.0);
    let shares = shares.map(|share| {
        let rounded = (share.share * 1e4).round() / 1e4;
        format!("{}={}", share.rule + 1, short(rounded))
    });
    [
        value.unwrap_or_default(),
        rule.unwrap_or_default(),
        shares.collect::<Vec<_>>().join("|"),
    ]
}
