//! Rows from tables, each with its place for messages.

use std::collections::BTreeMap;

use flagred::learning::Row;
use fuzzy::Model;

use super::Arguments;
use crate::{failure::Failure, table::Table};

/// Rows, and those that cannot be used, with the reason.
pub(super) struct Data {
    pub(super) rows: Vec<(Row, String)>,
    pub(super) refused: Vec<String>,
}

pub(super) fn read(arguments: &Arguments, model: &Model) -> Result<Data, Failure> {
    let inputs = model.inputs.iter();
    let outputs = model.outputs.iter().map(|output| &output.variable);
    let names: Vec<&str> = inputs.chain(outputs).map(|v| v.name.as_str()).collect();
    let mut data = Data {
        rows: Vec::new(),
        refused: Vec::new(),
    };
    let mut groups: BTreeMap<String, u32> = BTreeMap::new();
    for path in &arguments.data {
        let table = Table::read(path, arguments.format.delimiter)?;
        let columns = arguments.format.columns(&names, &table.header)?;
        let optional = |name: &Option<String>| {
            name.as_ref()
                .map(|name| table.header.require(name, "or leave that option out"))
                .transpose()
        };
        let weight = optional(&arguments.weight)?;
        let group = optional(&arguments.group_by)?;
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
