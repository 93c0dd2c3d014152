//! The evaluation as text.

use crate::{
    Evaluation,
    tables::{self, Column, Table},
};

/// The evaluation as text in columns, for a terminal.
pub fn text(evaluation: &Evaluation) -> String {
    let mut text = String::new();
    for line in tables::head(evaluation) {
        text += &format!("{line}\n");
    }
    if !evaluation.left_out.is_empty() {
        let files = tables::count(evaluation.left_out.len(), "file");
        text += &format!("{files} left out:\n");
    }
    for (reason, files) in tables::left_out(evaluation) {
        text += &format!("  {files:>4}  {reason}\n");
    }
    text += "\n";
    for table in tables::tables(evaluation) {
        write(&mut text, &table);
    }
    text
}

fn write(text: &mut String, table: &Table) {
    let indent = if table.title.is_empty() { "" } else { "  " };
    if !table.title.is_empty() {
        *text += &format!("\n{}\n", table.title);
    }
    let heads = || table.columns.iter().map(|column| column.head.as_str());
    if heads().any(|head| !head.is_empty()) {
        line(text, indent, &table.columns, heads());
    }
    for row in &table.rows {
        line(text, indent, &table.columns, row.iter().map(String::as_str));
    }
    for note in &table.notes {
        *text += &format!("{indent}{note}\n");
    }
}

/// Appends a line of cells; cells beyond the last column are not padded.
fn line<'a>(
    text: &mut String,
    indent: &str,
    columns: &[Column],
    cells: impl Iterator<Item = &'a str>,
) {
    for (i, cell) in cells.enumerate() {
        *text += if i == 0 { indent } else { "  " };
        *text += &match columns.get(i) {
            Some(column) if column.is_number => format!("{cell:>0$}", column.width),
            Some(column) => format!("{cell:0$}", column.width),
            None => cell.to_owned(),
        };
    }
    text.push('\n');
}
