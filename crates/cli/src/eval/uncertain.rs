//! Inputs that are known up to a half-width, and the intervals of the outputs.

use csv::ByteRecord;
use fuzzy::{
    Engine,
    engine::{Enclosure, Interval, IntervalOutcome},
};

use crate::{
    failure::Failure,
    table::{Cell, Header},
};

/// The half-width of an input: the largest error of its values.
#[derive(Debug, Clone, Copy)]
pub(super) enum HalfWidth {
    /// The same number in all rows.
    Number(f64),
    /// The number in this column of each row.
    Column(usize),
}

/// Returns the half-width of each input that `--uncertain` names.
///
/// # Errors
/// If there is no such input or column, or the number is negative.
pub(super) fn half_widths(
    options: &[(String, String)],
    engine: &Engine,
    header: &Header,
) -> Result<Vec<Option<HalfWidth>>, Failure> {
    let mut found = vec![None; engine.input_names().len()];
    if options.is_empty() {
        return Ok(Vec::new());
    }
    if engine.model().keeps_previous() {
        let message = "`--uncertain` does not support outputs with `when_no_rule_fires: previous`";
        return Err(Failure::usage(message));
    }
    for (input, text) in options {
        let Some(place) = engine.input(input).and_then(|input| found.get_mut(input)) else {
            let names: Vec<&str> = engine.input_names().collect();
            return Err(Failure::usage(format!("there is no input `{input}`"))
                .help(format!("the inputs are: {}", names.join(", "))));
        };
        let half_width = match (text.parse::<f64>(), header.column(text)) {
            (Ok(number), _) if number >= 0.0 && number.is_finite() => HalfWidth::Number(number),
            (Ok(_), _) => {
                let message =
                    format!("the half-width {text} of `{input}` is not a number of at least 0");
                return Err(Failure::usage(message));
            }
            (Err(_), Some(column)) => HalfWidth::Column(column),
            (Err(_), None) => {
                let message =
                    format!("there is no column `{text}` with the half-widths of `{input}`");
                return Err(Failure::usage(message)
                    .help("write a number, or the name of a column: `--uncertain heat=0.5`"));
            }
        };
        *place = Some(half_width);
    }
    Ok(found)
}

/// Returns the half-width of an input in a row; NaN if it is unknown.
///
/// # Errors
/// If the cell does not contain a number of at least 0.
pub(super) fn in_row(
    half_width: Option<HalfWidth>,
    record: &ByteRecord,
    header: &Header,
) -> Result<f64, String> {
    let column = match half_width {
        None => return Ok(0.0),
        Some(HalfWidth::Number(number)) => return Ok(number),
        Some(HalfWidth::Column(column)) => column,
    };
    let text = record.get(column).unwrap_or_default();
    let problem = |what: String| format!("column `{}`: {what}", header.name(column));
    match Cell::of(text) {
        Cell::Number(number) if number >= 0.0 => Ok(number),
        Cell::Number(number) => Err(problem(format!("the half-width {number} is negative"))),
        Cell::Unknown => Ok(f64::NAN),
        Cell::Bad => Err(problem(Cell::problem(text))),
    }
}

/// Evaluates a row of values with half-widths; `None` if a value or a half-width is unknown.
pub(super) fn enclose(
    enclosure: &Enclosure<'_>,
    inputs: impl Iterator<Item = (f64, f64)>,
) -> Option<Vec<IntervalOutcome>> {
    let inputs: Vec<Interval> = inputs
        .map(|(value, half_width)| Interval::around(value, half_width))
        .collect();
    enclosure.evaluate(&inputs).ok()
}
