//! A map in the terminal: one character a cell.

use std::io::Write;

use anstyle::{RgbColor, Style};
use fuzzy::Model;

use super::{
    rule_number, short,
    slice::{Axis, Cell, Slice},
};
use crate::drawing::palette::{Colour, distinct, ink, viridis};

/// The most columns and rows of a picture.
const WIDEST: usize = 61;
const TALLEST: usize = 26;

pub(super) fn write(out: &mut impl Write, slice: &Slice) -> std::io::Result<()> {
    writeln!(out, "{}", slice.title())?;
    picture(out, slice, |cell| {
        let Some(value) = cell.value else {
            return ('.', Style::new());
        };
        let tenth = (slice.share(value) * 10.0).min(9.0) as u8;
        // Letters where the value was filled in.
        let first = if cell.filled_from.is_some() {
            b'a'
        } else {
            b'0'
        };
        (char::from(first + tenth), on(viridis(slice.share(value))))
    })?;
    let (low, high) = slice.range;
    let unit = slice.unit.as_deref().unwrap_or("");
    writeln!(
        out,
        "\n0 to 9: tenths of {} to {} {unit}, as rules say",
        short(low),
        short(high)
    )?;
    if slice.any_filled() {
        writeln!(
            out,
            "a to j: the same, filled where no rule covers ({})",
            slice.filling.unwrap_or("")
        )?;
    }
    if slice.any_unknown() {
        writeln!(out, ".: no value, since no rule fires")?;
    }
    Ok(())
}

/// The rule that dominates each cell, and the rules.
pub(super) fn write_activations(
    out: &mut impl Write,
    slice: &Slice,
    model: &Model,
) -> std::io::Result<()> {
    writeln!(out, "{}: the rule that dominates", slice.title())?;
    let mut seen: Vec<usize> = Vec::new();
    picture(out, slice, |cell| match cell.rule {
        None => ('.', Style::new()),
        Some(rule) => {
            let place = seen.iter().position(|r| *r == rule).unwrap_or_else(|| {
                seen.push(rule);
                seen.len() - 1
            });
            let mark = if cell.filled_from.is_some() {
                ' '
            } else {
                mark(place)
            };
            (mark, on(distinct(place)))
        }
    })?;
    writeln!(out)?;
    for (place, rule) in seen.iter().enumerate() {
        if let Some(said) = model.rules.get(*rule) {
            let number = rule_number(Some(*rule));
            writeln!(out, "{} rule {number}: {}", mark(place), said.rule)?;
        }
    }
    if slice.any_filled() {
        writeln!(out, "blank: no rule covers it; the value is filled in")?;
    }
    Ok(())
}

/// A character for the i-th rule; after 36 all the same.
fn mark(i: usize) -> char {
    u32::try_from(i)
        .ok()
        .and_then(|i| char::from_digit(i, 36))
        .map_or('+', |c| c.to_ascii_uppercase())
}

fn on(colour: Colour) -> Style {
    let rgb = |c: Colour| Some(RgbColor(c.0, c.1, c.2).into());
    Style::new()
        .bg_color(rgb(colour))
        .fg_color(rgb(ink(colour)))
}

fn picture(
    out: &mut impl Write,
    slice: &Slice,
    mut draw: impl FnMut(Cell) -> (char, Style),
) -> std::io::Result<()> {
    let columns = every(&slice.x, WIDEST);
    let rows = slice.y.as_ref().map_or(vec![0], |y| every(y, TALLEST));
    if let Some(y) = &slice.y {
        writeln!(out, "{}", y.title())?;
    }
    let middle = rows.len() / 2;
    for (i, &row) in rows.iter().enumerate().rev() {
        let is_marked = i == 0 || i == middle || i + 1 == rows.len();
        let place = slice.y.as_ref().and_then(|y| y.places.get(row));
        let label = place.filter(|_| is_marked).map(|y| short(*y));
        write!(out, "{:>8} |", label.unwrap_or_default())?;
        for &column in &columns {
            let (character, style) = draw(slice.cell(column, row));
            write!(out, "{style}{character}{style:#}")?;
        }
        writeln!(out)?;
    }
    writeln!(out, "{:>8} +{}", "", "-".repeat(columns.len()))?;
    let (low, high) = (short(slice.x.low()), short(slice.x.high()));
    let gap = columns.len().saturating_sub(low.len() + high.len());
    writeln!(out, "{:>10}{low}{}{high}", "", " ".repeat(gap))?;
    writeln!(out, "{:>10}{}", "", slice.x.title())
}

/// At most `most` places of an axis, the first and last among them.
fn every(axis: &Axis, most: usize) -> Vec<usize> {
    let points = axis.places.len();
    let shown = points.min(most).max(2);
    (0..shown)
        .map(|i| (i * points.saturating_sub(1) + (shown - 1) / 2) / (shown - 1))
        .collect()
}
