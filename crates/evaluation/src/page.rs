//! The evaluation as an HTML page with its picture and tables.

use maud::{Markup, PreEscaped, html};

use crate::{
    Evaluation, svg,
    tables::{self, Table},
};

/// The body of the page, for `flagred_report::page::around`.
pub fn body(evaluation: &Evaluation) -> String {
    let body = html! {
        h1 { "How good the risks are" }
        @for line in tables::head(evaluation) { p.soft { (line) } }
        @for (reason, files) in tables::left_out(evaluation) {
            p.soft { (tables::count(files, "file")) " left out: " (reason) }
        }
        figure.picture { (PreEscaped(svg::draw(evaluation))) }
        @for one in tables::tables(evaluation) { (table(&one)) }
    };
    body.into_string()
}

fn table(table: &Table) -> Markup {
    let class = |i: usize| match table.columns.get(i) {
        Some(column) if !column.is_number => (i == 0).then_some("name"),
        _ => Some("n"),
    };
    let has_heads = table.columns.iter().any(|column| !column.head.is_empty());
    html! {
        h2 { @if table.title.is_empty() { "Areas under the curves" } @else { (table.title) } }
        div.scroll { table {
            @if has_heads {
                thead { tr {
                    @for (i, column) in table.columns.iter().enumerate() {
                        th class=[class(i)] { (column.head) }
                    }
                } }
            }
            tbody {
                @for row in &table.rows { tr {
                    @for (i, cell) in row.iter().enumerate() { td class=[class(i)] { (cell) } }
                } }
            }
        } }
        @for note in &table.notes { p.soft { (note) } }
    }
}
