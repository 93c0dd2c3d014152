//! Rows to learn from and to tune on: from tables, each with its place for messages.

use std::{collections::BTreeMap, path::PathBuf};

use flagred::learning::Row;
use fuzzy::Model;

use crate::{
    failure::Failure,
    table::{Format, Table},
};

/// Where rows come from.
pub(crate) struct Source<'a> {
    pub(crate) tables: &'a [PathBuf],
    pub(crate) format: &'a Format,
    /// The columns with the weights and the groups of the rows.
    pub(crate) weight: Option<&'a str>,
    pub(crate) group: Option<&'a str>,
}

/// Rows, and those that cannot be used, with the reason.
pub(crate) struct Data {
    pub(crate) rows: Vec<(Row, String)>,
    pub(crate) refused: Vec<String>,
}

/// Reads the values of the inputs and of the outputs of a model from all tables.
pub(crate) fn read(source: &Source<'_>, model: &Model) -> Result<Data, Failure> {
    let inputs = model.inputs.iter();
    let outputs = model.outputs.iter().map(|output| &output.variable);
    let names: Vec<&str> = inputs.chain(outputs).map(|v| v.name.as_str()).collect();
    let mut data = Data {
        rows: Vec::new(),
        refused: Vec::new(),
    };
    let mut groups: BTreeMap<String, u32> = BTreeMap::new();
    for path in source.tables {
        let table = Table::read(path, source.format.delimiter)?;
        let columns = source.format.columns(&names, &table.header)?;
        let optional = |name: Option<&str>| {
            name.map(|name| table.header.require(name, "or leave that option out"))
                .transpose()
        };
        let weight = optional(source.weight)?;
        let group = optional(source.group)?;
        for row in 0..table.len() {
            let mut bad = Vec::new();
            let mut number = |column: usize| {
                table.number(row, column).unwrap_or_else(|cell| {
                    bad.push(format!(
                        "`{}`, line {}, column `{}`: {}",
                        table.header.file, cell.line, cell.column, cell.problem
                    ));
                    f64::NAN
                })
            };
            let values: Vec<f64> = columns.iter().map(|column| number(*column)).collect();
            let weight = weight.map_or(1.0, &mut number);
            if !bad.is_empty() {
                data.refused.append(&mut bad);
                continue;
            }
            let group = group.map(|column| {
                let next = u32::try_from(groups.len()).unwrap_or(u32::MAX);
                let name = table.text(row, column).to_owned();
                *groups.entry(name).or_insert(next)
            });
            let place = format!("`{}`, line {}", table.header.file, table.line(row));
            let row = Row {
                values,
                weight,
                group,
            };
            data.rows.push((row, place));
        }
    }
    Ok(data)
}

/// Rows that cannot be used, as a failure.
pub(crate) fn refuse(refused: &[String], purpose: &str) -> Failure {
    const SHOWN: usize = 20;
    let mut shown: Vec<String> = refused.iter().take(SHOWN).cloned().collect();
    let more = refused.len().saturating_sub(SHOWN);
    shown.extend((more > 0).then(|| format!("and {more} more")));
    let count = refused.len();
    Failure::unreadable(format!(
        "{count} row{} cannot be {purpose}, and nothing was written",
        if count == 1 { "" } else { "s" }
    ))
    .details(shown)
    .help("correct or remove these rows, or leave them out with --skip-bad-rows")
}
