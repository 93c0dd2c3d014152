//! Explanations of the rows of a table: the dominant rule and the shares of all rules, for each output.

use std::path::Path;

use fuzzy::{
    Engine,
    drawing::short,
    engine::{EvaluateError, ExplainedOutput},
};

use crate::{
    failure::Failure,
    output::{cell, number_or_cell},
    table::{Cell, Format, Header, Table},
};

/// Returns the table with three columns added for each output: `fan`, `fan_rule` and `fan_shares`, such as `3=0.61|2=0.39`.
pub(super) fn explained(engine: &Engine, path: &Path, format: &Format) -> Result<String, Failure> {
    let table = Table::read(path, format.delimiter)?;
    let names: Vec<&str> = engine.input_names().collect();
    let inputs = format.columns(&names, &table.header)?;
    let mut writer = csv::WriterBuilder::new()
        .delimiter(format.delimiter)
        .comment(Some(b'#'))
        .from_writer(Vec::new());
    let added = added(engine, &table.header)?;
    let copied = table.header.names.iter().map(|name| number_or_cell(name));
    let added = added.iter().map(|name| cell(name));
    writer.write_record(copied.chain(added).map(|name| name.into_owned()))?;
    for row in 0..table.len() {
        let values = inputs.iter().map(|input| value(&table, row, *input));
        let values: Vec<f64> = match values.collect::<Result<_, Failure>>() {
            Ok(values) => values,
            Err(_) if format.skip_bad_rows => continue,
            Err(failure) => return Err(failure),
        };
        let outputs = match engine.explain(&values) {
            Ok(explanation) => explanation.outputs,
            Err(EvaluateError::InputNotFinite) => Vec::new(),
            Err(error) => return Err(Failure::unreadable(error)),
        };
        let columns = 0..table.header.names.len();
        let copied = columns.map(|column| number_or_cell(table.text(row, column)).into_owned());
        let reasons = (0..engine.output_names().len()).flat_map(|i| reasons(outputs.get(i)));
        writer.write_record(copied.chain(reasons))?;
    }
    let text = writer.into_inner();
    let text = text.map_err(|error| Failure::unreadable(error.to_string()))?;
    Ok(String::from_utf8_lossy(&text).into_owned())
}

/// The names of the added columns.
fn added(engine: &Engine, header: &Header) -> Result<Vec<String>, Failure> {
    let of = |output: &str| ["", "_rule", "_shares"].map(|end| format!("{output}{end}"));
    let added: Vec<String> = engine.output_names().flat_map(of).collect();
    match added.iter().find(|name| header.column(name).is_some()) {
        None => Ok(added),
        Some(name) => Err(Failure::usage(format!(
            "`{}` has a column `{name}` already",
            header.file
        ))
        .help("the reasons go into a column of that name; rename yours")),
    }
}

/// The value of an input in a row; NaN if unknown.
fn value(table: &Table, row: usize, column: usize) -> Result<f64, Failure> {
    let text = table.text(row, column).as_bytes();
    match Cell::of(text) {
        Cell::Number(number) => Ok(number),
        Cell::Unknown => Ok(f64::NAN),
        Cell::Bad => {
            let (file, line) = (&table.header.file, table.line(row));
            let (name, problem) = (table.header.name(column), Cell::problem(text));
            let message = format!("`{file}`, line {line}, column `{name}`: {problem}");
            Err(Failure::unreadable(message).help("`--skip-bad-rows` leaves such rows out"))
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
