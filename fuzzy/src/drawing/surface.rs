//! A slice as a three-dimensional surface, viewed diagonally from above.

use super::{
    colour::Colour,
    document::{Anchor, Frame, SvgDocument},
    heat::{step_colour, whole_title},
    scale::thinned,
    slice::{Axis, Slice},
    text::short,
};

/// The maximum number of points along an axis; more points only increase the file size.
const MAX_POINTS: usize = 41;

/// The rotation of the view about the vertical axis, in degrees; it is applied before the tilt.
const TURN_DEG: f64 = 35.0;
/// The tilt of the view, in degrees.
const TILT_DEG: f64 = 28.0;

/// The middle of the drawing, in pixels.
const MIDDLE: (f64, f64) = (280.0, 258.0);
/// The size of the unit cube in the drawing, in pixels.
const SIZE: f64 = 285.0;

/// A projection of the unit cube onto the document. It has no perspective, so that equal heights stay equal.
struct View {
    sin_turn: f64,
    cos_turn: f64,
    sin_tilt: f64,
    cos_tilt: f64,
}

impl View {
    fn new() -> View {
        let (turn, tilt) = (TURN_DEG.to_radians(), TILT_DEG.to_radians());
        View {
            sin_turn: turn.sin(),
            cos_turn: turn.cos(),
            sin_tilt: tilt.sin(),
            cos_tilt: tilt.cos(),
        }
    }

    /// Returns the position on the document of a point of the unit cube.
    fn at(&self, x: f64, y: f64, z: f64) -> (f64, f64) {
        let (x, y, z) = (x - 0.5, y - 0.5, z - 0.5);
        let across = x * self.cos_turn + y * self.sin_turn;
        let up = z * 0.75 * self.cos_tilt + self.depth(x, y) * self.sin_tilt;
        (MIDDLE.0 + SIZE * across, MIDDLE.1 - SIZE * up)
    }

    /// Returns the distance from the viewer.
    fn depth(&self, x: f64, y: f64) -> f64 {
        y * self.cos_turn - x * self.sin_turn
    }
}

/// Returns an SVG of a slice as a surface; `None` if it has only one axis.
pub fn surface_svg(slice: &Slice) -> Option<String> {
    let y = slice.y.as_ref()?;
    let view = View::new();
    let mut document = SvgDocument::map();
    document.heading(Frame::MAP.left, &slice.title(), &slice.fixed_text());
    floor(&mut document, &view, slice, y);

    let columns = thinned(slice.columns(), MAX_POINTS);
    let rows = thinned(slice.rows(), MAX_POINTS);
    let share = |i: usize, count: usize| i as f64 / (count - 1).max(1) as f64;
    let at = |i: usize, j: usize| (share(i, slice.columns()), share(j, slice.rows()));
    let mut quads = Vec::new();
    for i in columns.windows(2) {
        for j in rows.windows(2) {
            let mut points = Vec::with_capacity(4);
            let (mut sum, mut filled) = (0.0, 0);
            for (column, row) in [(i[0], j[0]), (i[1], j[0]), (i[1], j[1]), (i[0], j[1])] {
                let cell = slice.cell(column, row);
                let Some(value) = cell.value else {
                    continue;
                };
                let (x, y) = at(column, row);
                points.push(view.at(x, y, slice.share(value)));
                sum += slice.share(value);
                filled += usize::from(cell.filled_from.is_some());
            }
            if points.len() == 4 {
                let (x, y) = at(i[0], j[0]);
                quads.push((view.depth(x, y), points, sum / 4.0, filled >= 2));
            }
        }
    }
    // The farthest quads are drawn first, so that nearer ones cover them.
    quads.sort_by(|a, b| b.0.total_cmp(&a.0));
    for (_, points, height, is_filled) in quads {
        let colour = step_colour(slice, height);
        let edge = colour.mix(Colour::BLACK, 0.25);
        let paint = format_args!(r#"fill="{colour}" stroke="{edge}" stroke-width=".5""#);
        document.through("polygon", &points, paint);
        if is_filled {
            let paint = format_args!(r#"fill="url(#hatch)" fill-opacity=".6""#);
            document.through("polygon", &points, paint);
        }
    }
    document.legend(slice);
    document.notes(slice);
    Some(document.finish(&whole_title(slice)))
}

/// Draws the floor with its grid, the vertical axis, ticks and titles.
fn floor(document: &mut SvgDocument, view: &View, slice: &Slice, y: &Axis) {
    for tick in slice.x.scale().ticks(5.0) {
        let x = slice.x.scale().share(tick);
        document.line(view.at(x, 0.0, 0.0), view.at(x, 1.0, 0.0), "grid");
        let (left, top) = view.at(x, -0.06, 0.0);
        document.text((left, top + 8.0), Anchor::Middle, "label", &short(tick));
    }
    for tick in y.scale().ticks(5.0) {
        let at = y.scale().share(tick);
        document.line(view.at(0.0, at, 0.0), view.at(1.0, at, 0.0), "grid");
        let (left, top) = view.at(1.04, at, 0.0);
        document.text((left, top + 8.0), Anchor::Start, "label", &short(tick));
    }
    for tick in slice.range.ticks(5.0) {
        let z = slice.range.share(tick);
        // Grid lines on the two walls behind the surface.
        document.line(view.at(0.0, 0.0, z), view.at(0.0, 1.0, z), "grid");
        document.line(view.at(0.0, 1.0, z), view.at(1.0, 1.0, z), "grid");
        let (left, top) = view.at(0.0, 0.0, z);
        document.text((left - 6.0, top + 4.0), Anchor::End, "label", &short(tick));
    }
    for (from, to) in [
        ((0.0, 0.0, 0.0), (1.0, 0.0, 0.0)),
        ((1.0, 0.0, 0.0), (1.0, 1.0, 0.0)),
        ((0.0, 0.0, 0.0), (0.0, 0.0, 1.0)),
        ((0.0, 1.0, 0.0), (0.0, 1.0, 1.0)),
    ] {
        let at = |(x, y, z): (f64, f64, f64)| view.at(x, y, z);
        document.line(at(from), at(to), "tick");
    }
    let x_ends = (view.at(0.0, -0.17, 0.0), view.at(1.0, -0.17, 0.0));
    let y_ends = (view.at(1.2, 0.0, 0.0), view.at(1.2, 1.0, 0.0));
    for ((from, to), title) in [(x_ends, slice.x.title()), (y_ends, y.title())] {
        let middle = ((from.0 + to.0) / 2.0, (from.1 + to.1) / 2.0 + 8.0);
        let along = (to.1 - from.1).atan2(to.0 - from.0).to_degrees();
        document.rotated_text(middle, along, &title);
    }
}
