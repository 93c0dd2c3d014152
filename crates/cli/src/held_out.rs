//! Output that `identify`, `learn` and `tune` share: used and refused rows, and cross-validation errors.

use std::io::Write;

use flagred_tuning::{Confusion, Interval};
use fuzzy::drawing::{short, visible};
use schemars::JsonSchema;
use serde::Serialize;

/// Maximum number of items of a list that are shown.
const SHOWN: usize = 12;

/// Formats a number of folds: `5 folds`.
pub(crate) fn folds(count: usize) -> String {
    match count {
        1 => "1 fold".to_owned(),
        count => format!("{count} folds"),
    }
}

/// Writes how many rows were used, and why others were refused.
pub(crate) fn rows(out: &mut dyn Write, used: usize, refused: &[String]) -> std::io::Result<()> {
    writeln!(out, "rows        {used} used, {} refused", refused.len())?;
    listed(out, 12, refused, refused.len())
}

/// Writes the first few of `count` items, each on its own indented line, and the number of remaining items.
pub(crate) fn listed(
    out: &mut dyn Write,
    indent: usize,
    items: &[impl ToString],
    count: usize,
) -> std::io::Result<()> {
    let shown = items.iter().take(SHOWN);
    let more = count.saturating_sub(shown.len());
    for item in shown {
        writeln!(out, "{:indent$}{}", "", visible(&item.to_string()))?;
    }
    match more {
        0 => Ok(()),
        more => writeln!(out, "{:indent$}and {more} more", ""),
    }
}

/// Formats a value with its interval: `2.9 [2.6, 3.2]`.
pub(crate) fn figure(Interval { value, low, high }: &Interval) -> String {
    format!("{} [{}, {}]", short(*value), short(*low), short(*high))
}

/// Writes the confusion table of cross-validation. `name` returns the name of a class; names are shown if all classes have one.
pub(crate) fn confusion(
    out: &mut dyn Write,
    confusion: &Confusion,
    name: impl Fn(f64) -> Option<String>,
) -> std::io::Result<()> {
    let classes = &confusion.classes;
    let names: Option<Vec<String>> = classes.iter().map(|class| name(*class)).collect();
    let names = names.unwrap_or_else(|| classes.iter().map(|class| short(*class)).collect());
    let counts = confusion.rows.iter().flatten().map(usize::to_string);
    let lengths = names.iter().cloned().chain(counts);
    let width = lengths.map(|text| text.chars().count()).max().unwrap_or(0);
    writeln!(
        out,
        "classes     {:.1} % of the cross-validated rows are predicted as their class; lines: class of the rows, columns: predicted class",
        100.0 * confusion.accuracy()
    )?;
    let line = |cells: &mut dyn Iterator<Item = String>| {
        let cells: Vec<String> = cells.map(|cell| format!("{cell:>width$}")).collect();
        cells.join("  ")
    };
    writeln!(
        out,
        "            {:width$}  {}",
        "",
        line(&mut names.iter().cloned())
    )?;
    for (name, row) in names.iter().zip(&confusion.rows) {
        let counts = line(&mut row.iter().map(usize::to_string));
        writeln!(out, "            {name:<width$}  {counts}")?;
    }
    Ok(())
}

/// Returns the unit that cross-validation divides into folds: rows or groups.
pub(crate) fn divided(group_by: Option<&String>) -> String {
    match group_by {
        Some(column) => format!("groups of `{}`", visible(column)),
        None => "rows".to_owned(),
    }
}

/// The confusion matrix of the cross-validation.
#[derive(Serialize, JsonSchema)]
#[schemars(rename = "Confusion")]
pub(crate) struct ConfusionDocument {
    /// The classes: values of the output, ascending.
    classes: Vec<f64>,
    /// For each class, the number of its rows that were predicted as each class.
    rows: Vec<Vec<usize>>,
    /// The share of rows whose class was predicted correctly.
    accuracy: f64,
}

impl From<&Confusion> for ConfusionDocument {
    fn from(confusion: &Confusion) -> ConfusionDocument {
        ConfusionDocument {
            classes: confusion.classes.clone(),
            rows: confusion.rows.clone(),
            accuracy: confusion.accuracy(),
        }
    }
}

/// A cross-validated figure with its 95 % confidence interval.
#[derive(Serialize, JsonSchema)]
#[schemars(rename = "Interval")]
pub(crate) struct IntervalDocument {
    /// The figure.
    value: f64,
    /// The lower end of the interval.
    low: f64,
    /// The upper end of the interval.
    high: f64,
}

impl From<&Interval> for IntervalDocument {
    fn from(Interval { value, low, high }: &Interval) -> IntervalDocument {
        IntervalDocument {
            value: *value,
            low: *low,
            high: *high,
        }
    }
}
