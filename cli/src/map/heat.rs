//! A slice as a heat map with contour lines, or as a curve where there is one input only.

use std::fmt::Write as _;

use super::{
    contour, short,
    slice::Slice,
    svg::{Anchor, Frame, Sheet, px, ticks},
};
use crate::drawing::palette::{Colour, viridis};

/// What no rule tells anything of.
const UNKNOWN: Colour = Colour(0xd9, 0xd9, 0xd9);

/// Colours are told apart in steps of this share of the range; finer ones only make the file heavier.
const COLOURS: f64 = 100.0;

pub(super) fn draw(slice: &Slice) -> String {
    let mut sheet = Sheet::default();
    sheet.heading(&slice.title());
    let Some(y) = &slice.y else {
        curve(&mut sheet, slice);
        return sheet.finish(&slice.title());
    };
    let colour = |i: usize, j: usize| {
        let value = slice.cell(i, j).value?;
        let step = (slice.share(value) * COLOURS).round() / COLOURS;
        Some(viridis(step))
    };
    cells(&mut sheet, slice, colour);
    hatch(&mut sheet, slice);
    let frame = Frame::USUAL;
    let (columns, rows) = (slice.x.places.len(), y.places.len());
    let (low, high) = slice.range;
    for level in ticks(low, high) {
        if level <= low || level >= high {
            continue;
        }
        let value = |i: usize, j: usize| slice.cell(i, j).value;
        let mut lines = contour::lines(contour::pieces(columns, rows, value, level));
        lines.sort_by_key(|line| std::cmp::Reverse(line.len()));
        for line in &lines {
            let points: Vec<(f64, f64)> = line
                .iter()
                .map(|(i, j)| frame.at(i / (columns - 1) as f64, j / (rows - 1) as f64))
                .collect();
            path(&mut sheet, &points, "halo");
            path(&mut sheet, &points, "contour");
        }
        // The longest line of a level carries its number, inside the frame.
        if let Some(line) = lines.first().filter(|line| line.len() > 4)
            && let Some((i, j)) = line.get(line.len() / 2)
        {
            let (x, y) = frame.at(i / (columns - 1) as f64, j / (rows - 1) as f64);
            let inside = (
                x.clamp(frame.left + 14.0, frame.left + frame.width - 14.0),
                y.clamp(frame.top + 12.0, frame.top + frame.height - 6.0) + 4.0,
            );
            sheet.text_on(inside, &short(level));
        }
    }
    sheet.axes(&frame, slice, (y.low(), y.high()), &y.title());
    sheet.legend(slice);
    sheet.notes(slice);
    sheet.finish(&slice.title())
}

/// Fills the frame cell by cell; cells of one colour that lie side by side are one rectangle.
pub(super) fn cells(
    sheet: &mut Sheet,
    slice: &Slice,
    colour: impl Fn(usize, usize) -> Option<Colour>,
) {
    runs(slice, colour, |(x, y, width, height), colour| {
        sheet.push(format_args!(
            "<rect x=\"{}\" y=\"{}\" width=\"{}\" height=\"{}\" fill=\"{}\"/>",
            px(x),
            px(y),
            px(width + 0.3),
            px(height + 0.3),
            colour.unwrap_or(UNKNOWN)
        ));
    });
}

/// Hatches what was filled.
pub(super) fn hatch(sheet: &mut Sheet, slice: &Slice) {
    let mut outline = String::new();
    let is_filled = |i: usize, j: usize| slice.cell(i, j).filled_from.is_some();
    runs(slice, is_filled, |(x, y, width, height), is_filled| {
        if is_filled {
            let _ = write!(
                outline,
                "M{} {}h{}v{}h-{}z",
                px(x),
                px(y),
                px(width),
                px(height),
                px(width)
            );
        }
    });
    if !outline.is_empty() {
        sheet.push(format_args!(
            "<path d=\"{outline}\" fill=\"url(#hatch)\" fill-opacity=\".75\"/>"
        ));
    }
}

/// Goes through the cells row by row, neighbours that look the same together.
fn runs<L: PartialEq + Copy>(
    slice: &Slice,
    look: impl Fn(usize, usize) -> L,
    mut draw: impl FnMut((f64, f64, f64, f64), L),
) {
    let frame = Frame::USUAL;
    let columns = slice.x.places.len();
    let rows = slice.y.as_ref().map_or(1, |y| y.places.len());
    // A cell reaches half way to its neighbours; those at the ends are cut by the frame.
    let edge = |i: usize, count: usize| {
        let place = (i as f64 - 0.5) / (count - 1).max(1) as f64;
        place.clamp(0.0, 1.0)
    };
    for j in 0..rows {
        let row: Vec<L> = (0..columns).map(|i| look(i, j)).collect();
        let mut first = 0;
        for run in row.chunk_by(|a, b| a == b) {
            let end = first + run.len();
            let (left, bottom) = frame.at(edge(first, columns), edge(j, rows));
            let right_edge = if end == columns {
                1.0
            } else {
                edge(end, columns)
            };
            let top_edge = if j + 1 == rows {
                1.0
            } else {
                edge(j + 1, rows)
            };
            let (right, top) = frame.at(right_edge, top_edge);
            if let Some(this) = run.first() {
                draw((left, top, right - left, bottom - top), *this);
            }
            first = end;
        }
    }
}

fn path(sheet: &mut Sheet, points: &[(f64, f64)], class: &str) {
    if points.len() < 2 {
        return;
    }
    let places: Vec<String> = points
        .iter()
        .map(|(x, y)| format!("{},{}", px(*x), px(*y)))
        .collect();
    sheet.push(format_args!(
        "<polyline points=\"{}\" class=\"{class}\"/>",
        places.join(" ")
    ));
}

/// One input: its value as a curve, filled parts dashed.
fn curve(sheet: &mut Sheet, slice: &Slice) {
    let frame = Frame::USUAL;
    let (low, high) = slice.range;
    for tick in ticks(low, high) {
        let share = (tick - low) / (high - low);
        sheet.line(frame.at(0.0, share), frame.at(1.0, share), "grid");
    }
    let columns = slice.x.places.len();
    let mut piece: Vec<(f64, f64)> = Vec::new();
    let mut class = "curve";
    for i in 0..columns {
        let cell = slice.cell(i, 0);
        let this = if cell.filled_from.is_some() {
            "dashed"
        } else {
            "curve"
        };
        let point = cell
            .value
            .map(|value| frame.at(i as f64 / (columns - 1).max(1) as f64, slice.share(value)));
        if this != class {
            // The parts meet.
            piece.extend(point);
        }
        if this != class || point.is_none() {
            path(sheet, &piece, class);
            piece.clear();
            class = this;
        }
        piece.extend(point);
    }
    path(sheet, &piece, class);
    let title = super::slice::titled(&slice.output, slice.unit.as_deref());
    sheet.axes(&frame, slice, slice.range, &title);
    if slice.any_filled() {
        let note = format!(
            "dashed: no rule covers it; filled ({})",
            slice.filling.unwrap_or("")
        );
        let place = (frame.left, super::svg::HEIGHT - 14.0);
        sheet.text(place, Anchor::Start, "label", &note);
    }
}
