//! Rows from a table that already has one row for each flight: means and standard deviations of the commands.

use std::{fs::File, io::Read, path::Path};

use flagred_evaluation::{recipe::recipe, risk_pct};

use super::{FileRows, Plan, Row};
use crate::{
    failure::Failure,
    table::{BadCell, Table},
};

/// The column of the attitude error.
const ERROR: &str = "att_rmse_deg";

/// Opens a file as a table with a row for each flight, if its first line names an attitude error and no time.
pub(super) fn open(path: &Path) -> Option<Result<Table, Failure>> {
    let mut start = Vec::new();
    File::open(path)
        .ok()?
        .take(16_384)
        .read_to_end(&mut start)
        .ok()?;
    let text = String::from_utf8_lossy(&start);
    let first = text.lines().find(|line| !line.starts_with('#'))?;
    let mut columns = first.split(',').map(str::trim);
    let is_summary = columns.clone().any(|c| c == ERROR) && columns.all(|c| c != "t_s");
    is_summary.then(|| Table::read(path, b','))
}

pub(super) fn rows(table: &Table, plan: &Plan) -> Result<FileRows, Failure> {
    let help = "with this profile, a table of flights must contain this column";
    let error = table.header.require(ERROR, help)?;
    let crashed = table.header.column("crashed");
    let vehicle = table
        .header
        .column("vehicle")
        .or_else(|| table.header.column("frame"));
    let kind = table.header.column("kind");
    let mut recipes = Vec::new();
    for input in &plan.profile.inputs {
        let of_source = recipe(&input.source).filter(|_| input.ratio.is_none());
        let recipe = of_source.ok_or_else(|| {
            Failure::unreadable(format!(
                "input `{}` cannot be computed from a table of flights",
                input.name
            ))
            .help("create the rows from flight logs")
        })?;
        for column in recipe.columns {
            table.header.require(column, help)?;
        }
        recipes.push(recipe);
    }
    let mut made = FileRows {
        rows: Vec::new(),
        notes: Vec::new(),
    };
    for row in 0..table.len() {
        let refused = |bad: BadCell| refuse(table, &bad);
        let att_rmse_deg = table.number(row, error).map_err(refused)?;
        let cell = |name: &str| table.named_number(row, name);
        let inputs = recipes.iter().map(|recipe| recipe.value(cell));
        let inputs = inputs
            .collect::<Result<Vec<f64>, BadCell>>()
            .map_err(refused)?;
        let has_crashed = crashed.is_some_and(|column| table.text(row, column) == "1");
        let text = |column: Option<usize>| column.map_or("", |column| table.text(row, column));
        made.rows.push(Row {
            vehicle: text(vehicle).to_owned(),
            kind: text(kind).to_owned(),
            from_s: None,
            to_s: None,
            inputs,
            errors_before_deg: Vec::new(),
            att_rmse_deg,
            // The attitude error does not reflect a crash, which counts as a risk of 100 %.
            risk_pct: if has_crashed {
                100.0
            } else {
                risk_pct(att_rmse_deg, plan.critical_deg)
            },
        });
    }
    Ok(made)
}

/// Reports a cell that cannot be used, with its position.
pub(crate) fn refuse(table: &Table, bad: &BadCell) -> Failure {
    Failure::unreadable(format!(
        "`{}`, line {}, column `{}`: {}",
        table.header.file, bad.line, bad.column, bad.problem
    ))
    .help("correct the cell or remove the row")
}
