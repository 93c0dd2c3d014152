//! What `identify` and `tune` say of rows that were used, and of errors on rows left out.

use std::io::Write;

use flagred_tuning::Interval;
use fuzzy::drawing::{short, visible};
use schemars::JsonSchema;
use serde::Serialize;

/// The reasons for rows without use that are shown.
const SHOWN: usize = 12;

/// How many rows were used, and why others were not.
pub(crate) fn rows(out: &mut dyn Write, used: usize, refused: &[String]) -> std::io::Result<()> {
    writeln!(out, "rows        {used} used, {} refused", refused.len())?;
    for refused in refused.iter().take(SHOWN) {
        writeln!(out, "            {}", visible(refused))?;
    }
    Ok(())
}

/// `2.9 [2.6, 3.2]`
pub(crate) fn figure(Interval { value, low, high }: &Interval) -> String {
    format!("{} [{}, {}]", short(*value), short(*low), short(*high))
}

/// What cross-validation divides into parts.
pub(crate) fn divided(group_by: Option<&String>) -> String {
    match group_by {
        Some(column) => format!("groups of `{}`", visible(column)),
        None => "rows".to_owned(),
    }
}

/// A figure of rows left out, with its 95 % interval.
#[derive(Serialize, JsonSchema)]
#[schemars(rename = "Interval")]
pub(crate) struct OfInterval {
    /// The figure.
    value: f64,
    /// The lower end of the interval.
    low: f64,
    /// The upper end of the interval.
    high: f64,
}

impl From<&Interval> for OfInterval {
    fn from(Interval { value, low, high }: &Interval) -> OfInterval {
        OfInterval {
            value: *value,
            low: *low,
            high: *high,
        }
    }
}
