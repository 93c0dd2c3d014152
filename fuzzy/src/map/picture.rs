//! A decision map as text, for snapshots and terminals.

use alloc::{format, string::String, vec::Vec};
use core::fmt::Write as _;

use super::{Axis, DecisionMap};

/// The most columns of the picture.
const WIDEST: usize = 51;
/// The most rows of the picture.
const TALLEST: usize = 26;
/// Rows and columns of the table below the picture.
const TABLE: usize = 6;
/// A cell is covered where its coverage is at least this.
const COVERED: f64 = 0.5;

/// A text picture of a map, and a coarse table of its values.
///
/// A cell is one character: the tenth of the output's range that holds the value, `0` to `9`, or `.` where there is no
/// value. The first axis runs to the right, the second upwards. Further axes are at their middle points, which the first line
/// names. A fine map shows every n-th cell. The last line counts the cells of the whole map with a coverage below 0.5.
///
/// # Example: a snapshot of a rule set
/// ```
/// use fuzzy::model::{Model, Output, MembershipFunction, Variable};
/// use fuzzy::{Engine, map::{DecisionMap, Grid, picture}, rule};
///
/// let model = Model::builder("heater")
///     .input(Variable::new("room", 0.0, 20.0).term("cold", MembershipFunction::LeftShoulder { top: 0.0, foot: 10.0 }))
///     .output(Output::new(Variable::new("power", 0.0, 100.0).term("high", MembershipFunction::Rectangle { left: 50.0, right: 100.0 })))
///     .rule(rule::parse("IF room IS cold THEN power IS high")?)
///     .build();
/// let engine = Engine::new(&model)?;
/// let map = DecisionMap::new(&engine, Grid::new(&engine, 11)?, 0)?;
/// let text = picture(&map); // insta::assert_snapshot!(picture(&map));
/// assert!(text.contains("77777......"));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn picture(map: &DecisionMap) -> String {
    let axes = map.grid().axes();
    let middle: Vec<usize> = axes.iter().map(|axis| axis.points / 2).collect();
    let (low, high) = map.range();
    let mut text = format!("{} in [{low}, {high}]", map.output());
    for fixed in map.grid().fixed() {
        push(
            &mut text,
            format_args!(", {} = {}", fixed.name, fixed.value),
        );
    }
    for (axis, &i) in axes.iter().zip(&middle).skip(2) {
        push(
            &mut text,
            format_args!(", {} = {}", axis.name, axis.coordinate(i)),
        );
    }
    text.push('\n');
    let at = |column: usize, row: usize| {
        let mut indices = middle.clone();
        for (axis, i) in [column, row].into_iter().enumerate() {
            if let Some(index) = indices.get_mut(axis) {
                *index = i;
            }
        }
        map.grid().cell(&indices).unwrap_or(usize::MAX)
    };
    let columns = axes.first().map_or(Vec::new(), |axis| every(axis, WIDEST));
    let rows = axes
        .get(1)
        .map_or(Vec::from([0]), |axis| every(axis, TALLEST));
    let tenth = |value: f64| ((value - low) / (high - low) * 10.0).min(9.0) as u32;
    if let Some(axis) = axes.get(1) {
        push(&mut text, format_args!("{}\n", axis.name));
    }
    for &row in rows.iter().rev() {
        let mark = axes
            .get(1)
            .map_or(String::new(), |axis| mark(axis, row, &rows));
        push(&mut text, format_args!("{mark:>10} |"));
        for &column in &columns {
            let digit = map.value(at(column, row)).map(tenth);
            let digit = digit.and_then(|tenth| char::from_digit(tenth, 10));
            text.push(digit.unwrap_or('.'));
        }
        text.push('\n');
    }
    if let Some(axis) = axes.first() {
        push(
            &mut text,
            format_args!("{:>10} +{}\n", "", "-".repeat(columns.len())),
        );
        push(
            &mut text,
            format_args!("{:>12}{} {} to {}\n\n", "", axis.name, axis.low, axis.high),
        );
        table(&mut text, map, at);
    }
    let cells = map.grid().cells();
    let bare = (0..cells)
        .filter(|&cell| map.coverage(cell) < COVERED)
        .count();
    push(
        &mut text,
        format_args!("coverage below {COVERED}: {bare} of {cells} cells\n"),
    );
    text
}

/// Writing to a `String` cannot fail.
fn push(text: &mut String, arguments: core::fmt::Arguments<'_>) {
    let _ = text.write_fmt(arguments);
}

/// At most `most` points of an axis, the first and last among them.
fn every(axis: &Axis, most: usize) -> Vec<usize> {
    let shown = axis.points.min(most);
    (0..shown)
        .map(|i| (i * (axis.points - 1) + (shown - 1) / 2) / (shown - 1))
        .collect()
}

/// The coordinate at the ends and the middle of the rows.
fn mark(axis: &Axis, row: usize, rows: &[usize]) -> String {
    let marked = [rows.first(), rows.get(rows.len() / 2), rows.last()];
    if marked.contains(&Some(&row)) {
        short(axis.coordinate(row))
    } else {
        String::new()
    }
}

/// At most 4 decimals, without trailing zeros.
fn short(x: f64) -> String {
    let text = format!("{x:.4}");
    text.trim_end_matches('0').trim_end_matches('.').into()
}

/// Values to 2 decimals at a few points of the first two axes.
fn table(text: &mut String, map: &DecisionMap, at: impl Fn(usize, usize) -> usize) {
    let axes = map.grid().axes();
    let columns = axes.first().map_or(Vec::new(), |axis| every(axis, TABLE));
    let rows = axes
        .get(1)
        .map_or(Vec::from([0]), |axis| every(axis, TABLE));
    push(text, format_args!("{:>10} |", ""));
    for &column in &columns {
        let coordinate = axes
            .first()
            .map_or(String::new(), |axis| short(axis.coordinate(column)));
        push(text, format_args!("{coordinate:>8}"));
    }
    text.push('\n');
    for &row in rows.iter().rev() {
        let coordinate = axes
            .get(1)
            .map_or(String::new(), |axis| short(axis.coordinate(row)));
        push(text, format_args!("{coordinate:>10} |"));
        for &column in &columns {
            match map.value(at(column, row)) {
                Some(value) => push(text, format_args!("{value:>8.2}")),
                None => push(text, format_args!("{:>8}", "none")),
            }
        }
        text.push('\n');
    }
}
