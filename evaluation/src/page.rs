//! The evaluation as one HTML page that needs nothing beside it.

use maud::{Markup, PreEscaped, html};
use report::page::page;

use crate::{
    Evaluation, svg,
    tables::{self, Table},
};

/// The page of an evaluation: its picture and its tables.
pub fn html(evaluation: &Evaluation) -> String {
    let head = tables::head(evaluation);
    let body = html! {
        h1 { "How good the risks are" }
        @for line in &head { p.soft { (line.trim()) } }
        figure.scroll { (PreEscaped(svg::draw(evaluation))) }
        @for one in tables::tables(evaluation) { (table(&one)) }
    };
    page("Evaluation", &body)
}

fn table(table: &Table) -> Markup {
    let class = |is_number: bool| is_number.then_some("n");
    let is_number = |i: usize| table.columns.get(i).is_some_and(|column| column.is_number);
    let has_heads = table.columns.iter().any(|column| !column.head.is_empty());
    html! {
        h2 { @if table.title.is_empty() { "Areas under the curves" } @else { (table.title) } }
        div.scroll { table {
            @if has_heads {
                thead { tr {
                    @for column in &table.columns { th class=[class(column.is_number)] { (column.head) } }
                } }
            }
            tbody {
                @for row in &table.rows { tr {
                    @for (i, cell) in row.iter().enumerate() { td class=[class(is_number(i))] { (cell) } }
                } }
            }
        } }
        @for note in &table.notes { p.soft { (note) } }
    }
}
