//! Maps as text, with one character per cell.

use std::fmt::Write as _;

use super::{
    colour::{Colour, distinct, output_colour},
    scale::thinned,
    slice::{Cell, Slice},
    text::{number, short, visible},
};
use crate::model::Model;

/// The coverage from which a cell counts as covered.
const COVERED: f64 = 0.5;

/// The maximum number of columns of a drawing.
const MAX_COLUMNS: usize = 61;
/// The maximum number of rows of a drawing.
const MAX_ROWS: usize = 26;

/// Formats a slice as text: a digit for the tenth of the range that contains the value, or a letter if the value was
/// filled by interpolation.
///
/// `paint` formats each cell, given its character and its colour on a terminal. Without colours:
/// `|cell, _| cell.to_string()`.
pub fn map_text(slice: &Slice, paint: impl Fn(char, Option<Colour>) -> String) -> String {
    let mut text = heading(slice, "");
    picture(&mut text, slice, |cell| {
        let Some(value) = cell.value else {
            return paint('.', None);
        };
        let tenth = (slice.share(value) * 10.0).min(9.0) as u8;
        let first = if cell.filled_from.is_some() {
            b'a'
        } else {
            b'0'
        };
        let colour = output_colour(&slice.output, slice.share(value));
        paint(char::from(first + tenth), Some(colour))
    });
    let (low, high) = (short(slice.range.low), short(slice.range.high));
    let unit = slice.unit.as_ref();
    let unit = unit.map_or_else(String::new, |unit| format!(" {unit}"));
    text.push('\n');
    line(
        &mut text,
        format_args!("0 to 9: tenths of {low} to {high}{unit}"),
    );
    if slice.any_filled() {
        let method = slice.filling_text();
        line(
            &mut text,
            format_args!("a to j: the same, interpolated where no rule applies ({method})"),
        );
    }
    if slice.any_unknown() {
        line(&mut text, format_args!(".: unknown, no rule fires"));
    }
    text
}

/// Formats a slice as text: a character for the dominant rule of each cell, and a list of these rules.
pub fn rules_text(
    slice: &Slice,
    model: &Model,
    paint: impl Fn(char, Option<Colour>) -> String,
) -> String {
    let mut text = heading(slice, ", dominant rule");
    let mut seen: Vec<usize> = Vec::new();
    picture(&mut text, slice, |cell| {
        let Some(rule) = cell.rule else {
            return paint('.', None);
        };
        let i = seen.iter().position(|r| *r == rule).unwrap_or_else(|| {
            seen.push(rule);
            seen.len() - 1
        });
        let mark = if cell.filled_from.is_some() {
            ' '
        } else {
            mark(i)
        };
        paint(mark, Some(distinct(i)))
    });
    text.push('\n');
    for (i, rule) in seen.iter().enumerate() {
        if let Some(written) = model.rules.get(*rule) {
            let (mark, number) = (mark(i), rule + 1);
            line(
                &mut text,
                format_args!("{mark} rule {number}: {}", written.rule),
            );
        }
    }
    if slice.any_filled() {
        line(
            &mut text,
            format_args!("blank: no rule applies, the value is interpolated"),
        );
    }
    text
}

/// Formats the values of a slice at up to `most` points of each axis, with a precision of about a ten-thousandth of the
/// output's range, and the number of cells with a coverage below 0.5.
///
/// Appended to [`map_text`], it gives a snapshot in which small changes are visible too.
///
/// # Example: a snapshot of a rule set
/// ```
/// use fuzzy::{Engine, Model, drawing, map::{DecisionMap, Grid}};
///
/// let model: Model = "
/// fuzzy: 1
/// name: heater
/// inputs:
///   room: {range: [0, 20], partition: [cold, warm]}
/// outputs:
///   power: {range: [0, 100], partition: [none, full]}
/// rules:
///   - IF room IS cold THEN power IS full
///   - IF room IS warm THEN power IS none
/// ".parse()?;
/// let engine = Engine::new(&model)?;
/// let map = DecisionMap::new(&engine, Grid::new(&engine, 11)?, 0)?;
/// let slice = drawing::Slice::new(&model, &map).ok_or("fix inputs until one or two are left")?;
/// let text = drawing::map_text(&slice, |cell, _| cell.to_string()) + &drawing::values_text(&slice, 6);
/// // insta::assert_snapshot!(text);
/// assert!(text.contains("coverage below 0.5: 0 of 11 cells"));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn values_text(slice: &Slice, most: usize) -> String {
    let columns = thinned(slice.columns(), most);
    let rows = match &slice.y {
        Some(y) => thinned(y.points.len(), most),
        None => vec![0],
    };
    let label = |points: &[f64], i: usize| {
        let point = points.get(i).copied();
        point.map_or_else(String::new, |point| number(point, 4))
    };
    let xs = columns.iter().map(|&x| label(&slice.x.points, x));
    let xs: String = xs.map(|x| format!("{x:>8}")).collect();
    let decimals = decimals(slice.range.high - slice.range.low);
    let mut text = String::from("\n");
    line(&mut text, format_args!("{:>8} |{xs}", ""));
    for &row in rows.iter().rev() {
        let y = slice.y.as_ref().map(|y| label(&y.points, row));
        let values = columns.iter().map(|&column| slice.cell(column, row).value);
        let values: String = values
            .map(|value| value.map_or_else(|| "none".into(), |value| format!("{value:.decimals$}")))
            .map(|value| format!("{value:>8}"))
            .collect();
        line(
            &mut text,
            format_args!("{:>8} |{values}", y.unwrap_or_default()),
        );
    }
    let is_bare = |cell: &&Cell| cell.coverage < COVERED;
    let (bare, cells) = (
        slice.cells.iter().filter(is_bare).count(),
        slice.cells.len(),
    );
    line(
        &mut text,
        format_args!("coverage below {COVERED}: {bare} of {cells} cells"),
    );
    text
}

/// Returns the number of decimals: 2 for a range from 0 to 100, 4 for a range from 0 to 1.
fn decimals(width: f64) -> usize {
    /// The maximum number of decimals that fit the columns.
    const MAX_DECIMALS: f64 = 5.0;
    (4.0 - libm::floor(libm::log10(width))).clamp(0.0, MAX_DECIMALS) as usize
}

fn heading(slice: &Slice, more: &str) -> String {
    let fixed = slice.fixed_text();
    let between = if fixed.is_empty() { "" } else { " " };
    let heading = format!("{}{more}{between}{fixed}", slice.title());
    visible(&heading).into_owned() + "\n"
}

/// Writes a line. Hidden characters are escaped, because the line may contain names from the input. Writing to a String
/// cannot fail.
fn line(text: &mut String, arguments: std::fmt::Arguments<'_>) {
    let line = arguments.to_string();
    let _ = writeln!(text, "{}", visible(&line));
}

/// Returns the character for the i-th rule; all rules after the first 36 have the character `+`.
fn mark(i: usize) -> char {
    let digit = u32::try_from(i).ok().and_then(|i| char::from_digit(i, 36));
    digit.map_or('+', |c| c.to_ascii_uppercase())
}

fn picture(text: &mut String, slice: &Slice, mut draw: impl FnMut(Cell) -> String) {
    let columns = thinned(slice.columns(), MAX_COLUMNS);
    let rows = match &slice.y {
        Some(y) => {
            line(text, format_args!("{}", y.title()));
            thinned(y.points.len(), MAX_ROWS)
        }
        None => vec![0],
    };
    let label = |i: usize| {
        let is_marked = [0, rows.len() / 2, rows.len() - 1].contains(&i);
        let y = slice.y.as_ref().filter(|_| is_marked);
        let value = y.and_then(|y| y.points.get(*rows.get(i)?));
        value.map(|y| short(*y)).unwrap_or_default()
    };
    let labels = (0..rows.len()).map(|i| label(i).len());
    let width = labels.max().unwrap_or_default().max(8);
    for (i, &row) in rows.iter().enumerate().rev() {
        let cells = columns.iter().map(|&column| draw(slice.cell(column, row)));
        let cells: String = cells.collect();
        let _ = writeln!(text, "{:>width$} |{cells}", label(i));
    }
    let scale = slice.x.scale();
    let (low, high) = (short(scale.low), short(scale.high));
    let gap = " ".repeat(columns.len().saturating_sub(low.len() + high.len()).max(1));
    line(
        text,
        format_args!("{:>width$} +{}", "", "-".repeat(columns.len())),
    );
    line(text, format_args!("{:>width$}  {low}{gap}{high}", ""));
    line(text, format_args!("{:>width$}  {}", "", slice.x.title()));
}
