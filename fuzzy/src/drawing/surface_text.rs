//! A slice as a surface in three dimensions, as text.

use super::{
    colour::{Colour, viridis},
    slice::Slice,
    surface::View,
    text::{short, visible},
};

/// Columns and rows of the picture. A character is about twice as high as wide.
const COLUMNS: usize = 78;
const ROWS: usize = 30;
/// Points of the surface along each axis: enough to leave no hole.
const POINTS: usize = 160;

/// A slice as a surface in text: a digit for the tenth of the range, nearer parts over farther ones; `None` where it has one
/// axis only.
///
/// `paint` gives each character its colour, as for [`map_text`](super::map_text).
pub fn surface_text(
    slice: &Slice,
    paint: impl Fn(char, Option<Colour>) -> String,
) -> Option<String> {
    let y = slice.y.as_ref()?;
    let view = View::new();
    let corners =
        (0..8).map(|i| view.at(f64::from(i & 1), f64::from(i >> 1 & 1), f64::from(i >> 2)));
    let corners: Vec<(f64, f64)> = corners.collect();
    let least = |of: fn(&(f64, f64)) -> f64| corners.iter().map(of).fold(f64::INFINITY, f64::min);
    let most =
        |of: fn(&(f64, f64)) -> f64| corners.iter().map(of).fold(f64::NEG_INFINITY, f64::max);
    let (left, right) = (least(|c| c.0), most(|c| c.0));
    let (top, bottom) = (least(|c| c.1), most(|c| c.1));
    let mut cells: Vec<Vec<Option<(char, Colour)>>> = vec![vec![None; COLUMNS]; ROWS];
    let share = |i: usize| i as f64 / (POINTS - 1) as f64;
    let mut points: Vec<(f64, f64)> = (0..POINTS * POINTS)
        .map(|i| (share(i / POINTS), share(i % POINTS)))
        .collect();
    // The farthest first: nearer ones cover it.
    points.sort_by(|a, b| view.depth(b.0, b.1).total_cmp(&view.depth(a.0, a.1)));
    for (x, y) in points {
        let Some(height) = height(slice, x, y) else {
            continue;
        };
        let (across, down) = view.at(x, y, height);
        let column = (across - left) / (right - left) * (COLUMNS - 1) as f64;
        let row = (down - top) / (bottom - top) * (ROWS - 1) as f64;
        let tenth = (height * 10.0).min(9.0) as u32;
        let mark = char::from_digit(tenth, 10).unwrap_or('9');
        let cell = cells.get_mut(row.round() as usize);
        if let Some(cell) = cell.and_then(|row| row.get_mut(column.round() as usize)) {
            *cell = Some((mark, viridis(height)));
        }
    }
    let title = [slice.title(), slice.held_text()].join(" ");
    let mut text = format!("{}\n\n", visible(title.trim_end()));
    let is_drawn = |row: &Vec<Option<_>>| row.iter().any(Option::is_some);
    let first = cells.iter().position(is_drawn).unwrap_or(0);
    let count = cells
        .iter()
        .rposition(is_drawn)
        .map_or(0, |last| last + 1 - first);
    for row in cells.into_iter().skip(first).take(count) {
        let last = row
            .iter()
            .rposition(Option::is_some)
            .map_or(0, |last| last + 1);
        let drawn = row.into_iter().take(last).map(|cell| match cell {
            Some((mark, colour)) => paint(mark, Some(colour)),
            None => String::from(" "),
        });
        text += &drawn.collect::<String>();
        text.push('\n');
    }
    let (x, unit) = (&slice.x, slice.output_title());
    let axis = |scale: super::Scale| format!("{} to {}", short(scale.low), short(scale.high));
    for line in [
        format!(
            "to the right and to the front: {}, {}",
            x.title(),
            axis(x.scale())
        ),
        format!(
            "to the right and to the back: {}, {}",
            y.title(),
            axis(y.scale())
        ),
        format!("upwards, 0 to 9: tenths of {unit}, {}", axis(slice.range)),
    ] {
        text += &format!("{}\n", visible(&line));
    }
    Some(text)
}

/// The height at a point of the surface between its cells; `None` beside a cell without a value.
fn height(slice: &Slice, x: f64, y: f64) -> Option<f64> {
    let place = |share: f64, count: usize| {
        let at = share * count.saturating_sub(1) as f64;
        let below = (at as usize).min(count.saturating_sub(2));
        (below, at - below as f64)
    };
    let ((i, across), (j, up)) = (place(x, slice.columns()), place(y, slice.rows()));
    let value = |i: usize, j: usize| Some(slice.share(slice.cell(i, j).value?));
    let low = value(i, j)? * (1.0 - across) + value(i + 1, j)? * across;
    let high = value(i, j + 1)? * (1.0 - across) + value(i + 1, j + 1)? * across;
    Some(low * (1.0 - up) + high * up)
}
