//! Rows from a table that has one row for each flight already: means and standard deviations of the commands.
//!
//! Such tables hold statistics of the normalised command c on the full range. Of a command all moments convert exactly
//! to the effective range, `e = (c - low) / (high - low)`; and by the law of total variance the variance of all motors
//! and times is that of the motors' mean over time, plus the mean of the variance between motors.

use std::{fs::File, io::Read, path::Path};

use flagred::{
    attitude::risk_pct,
    source::{Motors, Signal, Source, Statistic},
};

use super::{Plan, Row, Rows};
use crate::{
    failure::Failure,
    table::{BadCell, Table},
};

/// The attitude error by which such a table is known.
const ERROR: &str = "att_rmse_deg";

/// The table, if the file is one: its first line names an attitude error, and no time.
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

pub(super) fn rows(table: &Table, plan: &Plan) -> Result<Rows, Failure> {
    let help = "a table of flights needs it for this profile";
    let error = table.header.require(ERROR, help)?;
    let crashed = table.header.column("crashed");
    let vehicle = table
        .header
        .column("vehicle")
        .or_else(|| table.header.column("frame"));
    let kind = table.header.column("kind");
    let mut recipes = Vec::new();
    for input in &plan.profile.inputs {
        let recipe = recipe(&input.source).ok_or_else(|| {
            Failure::unreadable(format!(
                "input `{}` cannot be told from a table of flights",
                input.name
            ))
            .help("make its rows from flight logs")
        })?;
        for column in recipe.columns {
            table.header.require(column, help)?;
        }
        recipes.push(recipe);
    }
    let mut made = Rows {
        rows: Vec::new(),
        notes: Vec::new(),
    };
    for row in 0..table.len() {
        let refused = |bad: BadCell| refuse(table, &bad);
        let att_rmse_deg = table.number(row, error).map_err(refused)?;
        let inputs = recipes.iter().map(|recipe| recipe.value(table, row));
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
            // No attitude error stands for hitting the ground.
            risk_pct: if has_crashed {
                100.0
            } else {
                risk_pct(att_rmse_deg, plan.critical_deg)
            },
        });
    }
    Ok(made)
}

/// A cell that cannot be used, told with its place.
pub(crate) fn refuse(table: &Table, bad: &BadCell) -> Failure {
    Failure::unreadable(format!(
        "`{}`, line {}, column `{}`: {}",
        table.header.file, bad.line, bad.column, bad.problem
    ))
    .help("correct the cell or remove the row")
}

/// How an input is made of columns, and of the limits of the effective range.
pub(crate) struct Recipe {
    pub(crate) columns: &'static [&'static str],
    make: Make,
}

type Make = fn(&[f64], f64, f64) -> f64;

impl Recipe {
    /// The value in a row of a table that has the columns; without limits the effective range is the full one.
    pub(crate) fn value(&self, table: &Table, row: usize) -> Result<f64, BadCell> {
        let cell = |name: &str| match table.header.column(name) {
            Some(column) => table.number(row, column).map(Some),
            None => Ok(None),
        };
        let low = cell("c_limit_low")?.unwrap_or(0.0);
        let high = cell("c_limit_high")?.unwrap_or(1.0);
        let values = self.columns.iter().map(|name| cell(name));
        let values = values.collect::<Result<Option<Vec<f64>>, BadCell>>()?;
        Ok(values.map_or(f64::NAN, |values| (self.make)(&values, low, high)))
    }
}

/// The recipe of a source, where such tables tell it.
pub(crate) fn recipe(source: &Source) -> Option<Recipe> {
    let spread: Make = |values, low, high| values[0] / (high - low);
    let (columns, make): (&'static [&'static str], Make) =
        match (source.statistic, source.motors, &source.signal) {
            (Statistic::Mean, Motors::Pooled | Motors::Mean, Signal::MotorCommand) => {
                (&["c_mean"], |values, low, high| {
                    ((values[0] - low) / (high - low)).clamp(0.0, 1.0)
                })
            }
            (Statistic::Std, Motors::Pooled, Signal::MotorCommand) => (&["c_std"], spread),
            (Statistic::Std, Motors::Mean, Signal::MotorCommand) => (&["c_std_time"], spread),
            (Statistic::Mean, Motors::Std, Signal::MotorCommand) => (&["c_std_motors"], spread),
            (Statistic::Std, Motors::Std, Signal::MotorCommand) => (
                &["c_std", "c_std_time", "c_std_motors"],
                |values, low, high| {
                    let square = values[0].powi(2) - values[1].powi(2) - values[2].powi(2);
                    square.max(0.0).sqrt() / (high - low)
                },
            ),
            (Statistic::Mean, Motors::Pooled, Signal::MotorMargin) => {
                (&["margin_mean", "c_mean"], effective_margin)
            }
            (Statistic::Mean, Motors::Min, Signal::MotorMargin) => {
                (&["margin_min_mean", "c_mean"], effective_margin)
            }
            (Statistic::ShareBelow(limit), Motors::Pooled, Signal::MotorMargin)
                if (0.004..0.01).contains(&limit) =>
            {
                (&["sat_lim_frac"], |values, _, _| values[0])
            }
            _ => return None,
        };
    Some(Recipe { columns, make })
}

/// A mean margin on the effective range; exact where all commands lie on one side of the middle of both ranges.
fn effective_margin(values: &[f64], low: f64, high: f64) -> f64 {
    let nearer = if values[1] < 0.5 {
        values[0] - low
    } else {
        high - (1.0 - values[0])
    };
    (nearer / (high - low)).clamp(0.0, 0.5)
}
