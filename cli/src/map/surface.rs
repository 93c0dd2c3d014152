//! A slice as a surface in three dimensions, seen from above at a slant.

use super::{
    short,
    slice::{Axis, Slice},
    svg::{Anchor, Sheet, px, ticks},
};
use crate::drawing::{
    palette::{Colour, mix, viridis},
    text::Escaped,
};
use crate::failure::Failure;

/// The most quadrilaterals along an axis; more only make the file heavier.
const ALONG: usize = 40;

/// From where the surface is seen: turned about the vertical, then tipped, in degrees.
const TURN_DEG: f64 = 35.0;
const TIP_DEG: f64 = 28.0;

/// The middle of the picture and its size, in pixels.
const MIDDLE: (f64, f64) = (280.0, 258.0);
const SIZE: f64 = 285.0;

/// The places of a unit cube on the sheet, without perspective, so that equal heights stay equal.
struct View {
    sin_turn: f64,
    cos_turn: f64,
    sin_tip: f64,
    cos_tip: f64,
}

impl View {
    fn new() -> View {
        let (turn, tip) = (TURN_DEG.to_radians(), TIP_DEG.to_radians());
        View {
            sin_turn: turn.sin(),
            cos_turn: turn.cos(),
            sin_tip: tip.sin(),
            cos_tip: tip.cos(),
        }
    }

    fn at(&self, x: f64, y: f64, z: f64) -> (f64, f64) {
        let (x, y, z) = (x - 0.5, y - 0.5, z - 0.5);
        let across = x * self.cos_turn + y * self.sin_turn;
        let up = z * 0.75 * self.cos_tip + self.depth(x, y) * self.sin_tip;
        (MIDDLE.0 + SIZE * across, MIDDLE.1 - SIZE * up)
    }

    /// How far a place is away from the one who looks.
    fn depth(&self, x: f64, y: f64) -> f64 {
        y * self.cos_turn - x * self.sin_turn
    }
}

pub(super) fn draw(slice: &Slice) -> Result<String, Failure> {
    let Some(y) = &slice.y else {
        return Err(
            Failure::usage("a surface needs two inputs, and there is one")
                .help("leave out `--surface`: one input makes a curve"),
        );
    };
    let view = View::new();
    let mut sheet = Sheet::default();
    sheet.heading(&slice.title());
    floor(&mut sheet, &view, slice, y);

    let columns = every(slice.x.places.len());
    let rows = every(y.places.len());
    let share = |i: usize, count: usize| i as f64 / (count - 1).max(1) as f64;
    let mut quads = Vec::new();
    for i in columns.windows(2) {
        for j in rows.windows(2) {
            let corners = [(i[0], j[0]), (i[1], j[0]), (i[1], j[1]), (i[0], j[1])];
            let mut points = Vec::with_capacity(4);
            let (mut sum, mut filled) = (0.0, 0);
            for (column, row) in corners {
                let cell = slice.cell(column, row);
                let Some(value) = cell.value else {
                    continue;
                };
                let height = slice.share(value);
                sum += height;
                filled += usize::from(cell.filled_from.is_some());
                points.push(view.at(
                    share(column, slice.x.places.len()),
                    share(row, y.places.len()),
                    height,
                ));
            }
            if points.len() == 4 {
                let (x, y) = (
                    share(i[0], slice.x.places.len()),
                    share(j[0], y.places.len()),
                );
                quads.push((view.depth(x, y), points, sum / 4.0, filled >= 2));
            }
        }
    }
    // What is further away is drawn first and covered by what is nearer.
    quads.sort_by(|a, b| b.0.total_cmp(&a.0));
    for (_, points, height, filled) in quads {
        let places: Vec<String> = points
            .iter()
            .map(|(x, y)| format!("{},{}", px(*x), px(*y)))
            .collect();
        let places = places.join(" ");
        let colour = viridis((height * 100.0).round() / 100.0);
        let edge = mix(colour, Colour(0, 0, 0), 0.25);
        sheet.push(format_args!(
            "<polygon points=\"{places}\" fill=\"{colour}\" stroke=\"{edge}\" stroke-width=\".5\"/>"
        ));
        if filled {
            sheet.push(format_args!(
                "<polygon points=\"{places}\" fill=\"url(#hatch)\" fill-opacity=\".6\"/>"
            ));
        }
    }
    sheet.legend(slice);
    sheet.notes(slice);
    Ok(sheet.finish(&slice.title()))
}

/// The floor with its grid, the upright axis, ticks and titles.
fn floor(sheet: &mut Sheet, view: &View, slice: &Slice, y: &Axis) {
    let place = |tick: f64, axis: &Axis| (tick - axis.low()) / (axis.high() - axis.low());
    for tick in ticks(slice.x.low(), slice.x.high()) {
        let x = place(tick, &slice.x);
        sheet.line(view.at(x, 0.0, 0.0), view.at(x, 1.0, 0.0), "grid");
        let (left, top) = view.at(x, -0.06, 0.0);
        sheet.text((left, top + 8.0), Anchor::Middle, "label", &short(tick));
    }
    for tick in ticks(y.low(), y.high()) {
        let at = place(tick, y);
        sheet.line(view.at(0.0, at, 0.0), view.at(1.0, at, 0.0), "grid");
        let (left, top) = view.at(1.04, at, 0.0);
        sheet.text((left, top + 8.0), Anchor::Start, "label", &short(tick));
    }
    let (low, high) = slice.range;
    for tick in ticks(low, high) {
        let z = (tick - low) / (high - low);
        // On the two walls behind the surface.
        sheet.line(view.at(0.0, 0.0, z), view.at(0.0, 1.0, z), "grid");
        sheet.line(view.at(0.0, 1.0, z), view.at(1.0, 1.0, z), "grid");
        let (left, top) = view.at(0.0, 0.0, z);
        sheet.text((left - 6.0, top + 4.0), Anchor::End, "label", &short(tick));
    }
    for (from, to) in [
        ((0.0, 0.0, 0.0), (1.0, 0.0, 0.0)),
        ((1.0, 0.0, 0.0), (1.0, 1.0, 0.0)),
        ((0.0, 0.0, 0.0), (0.0, 0.0, 1.0)),
        ((0.0, 1.0, 0.0), (0.0, 1.0, 1.0)),
    ] {
        let at = |(x, y, z): (f64, f64, f64)| view.at(x, y, z);
        sheet.line(at(from), at(to), "tick");
    }
    let along =
        |from: (f64, f64), to: (f64, f64)| (to.1 - from.1).atan2(to.0 - from.0).to_degrees();
    let (x_from, x_to) = (view.at(0.0, -0.17, 0.0), view.at(1.0, -0.17, 0.0));
    let (y_from, y_to) = (view.at(1.2, 0.0, 0.0), view.at(1.2, 1.0, 0.0));
    for (from, to, title) in [(x_from, x_to, slice.x.title()), (y_from, y_to, y.title())] {
        sheet.push(format_args!(
            "<text transform=\"translate({} {}) rotate({})\" text-anchor=\"middle\" class=\"title\">{}</text>",
            px((from.0 + to.0) / 2.0),
            px((from.1 + to.1) / 2.0 + 8.0),
            px(along(from, to)),
            Escaped(&title)
        ));
    }
}

/// At most [`ALONG`] steps, the first and last place among them.
fn every(points: usize) -> Vec<usize> {
    let steps = points.saturating_sub(1).clamp(1, ALONG);
    (0..=steps)
        .map(|i| i * points.saturating_sub(1) / steps)
        .collect()
}
