//! A slice as a heat map with contour lines, or as a curve if it has only one axis.

use std::fmt::Write as _;

use super::{
    colour::{Colour, output_colour},
    contour,
    document::{Anchor, Frame, SvgDocument, px},
    scale::Scale,
    slice::Slice,
    text::short,
};

/// The colour of cells without a value.
const UNKNOWN: Colour = Colour(0xd9, 0xd9, 0xd9);

/// The number of steps in which colours change over the range; more steps only increase the file size.
const COLOURS: f64 = 100.0;

/// Returns an SVG of a slice: a heat map with contour lines, or a curve if there is only one axis.
///
/// Hatched cells (dashed sections of a curve) were filled by interpolation; grey cells have no value.
pub fn map_svg(slice: &Slice) -> String {
    let mut document = SvgDocument::map();
    document.heading(Frame::MAP.left, &slice.title(), &slice.fixed_text());
    match &slice.y {
        Some(y) => {
            cells(&mut document, slice, |i, j| {
                Some(step_colour(slice, slice.share(slice.cell(i, j).value?)))
            });
            contours(&mut document, slice);
            axes(&mut document, slice, y.scale(), &y.title());
            document.legend(slice);
            document.notes(slice);
        }
        None => {
            curve(&mut document, &Frame::MAP, slice);
            if slice.any_filled() {
                let note = format!(
                    "dashed: interpolated where no rule applies ({})",
                    slice.filling_text()
                );
                document.text((Frame::MAP.left, 486.0), Anchor::Start, "label", &note);
            }
        }
    }
    document.finish(&whole_title(slice))
}

/// Returns the colour for a fraction of the range of the output, in steps.
pub(super) fn step_colour(slice: &Slice, share: f64) -> Colour {
    output_colour(&slice.output, (share * COLOURS).round() / COLOURS)
}

/// Returns the title of the slice with the values of the fixed inputs.
pub(super) fn whole_title(slice: &Slice) -> String {
    [slice.title(), slice.fixed_text()]
        .join(" ")
        .trim_end()
        .to_owned()
}

pub(super) fn axes(document: &mut SvgDocument, slice: &Slice, y: Scale, y_title: &str) {
    document.axes(
        &Frame::MAP,
        (slice.x.scale(), &slice.x.title()),
        (y, y_title),
    );
}

/// Paints the frame cell by cell, and hatches the cells whose values were filled by interpolation.
pub(super) fn cells(
    document: &mut SvgDocument,
    slice: &Slice,
    colour: impl Fn(usize, usize) -> Option<Colour>,
) {
    // A cell extends halfway to its neighbours; cells at the ends are cut off by the frame.
    let edge = |i: usize, count: usize| {
        if i == count {
            return 1.0;
        }
        ((i as f64 - 0.5) / (count - 1).max(1) as f64).clamp(0.0, 1.0)
    };
    let (columns, rows) = (slice.columns(), slice.rows());
    let area = |column: usize, row: usize, length: usize| {
        let (left, bottom) = Frame::MAP.at(edge(column, columns), edge(row, rows));
        let (right, top) = Frame::MAP.at(edge(column + length, columns), edge(row + 1, rows));
        Frame {
            left,
            top,
            width: right - left,
            height: bottom - top,
        }
    };
    runs(columns, rows, colour, |column, row, length, colour| {
        let area = area(column, row, length);
        // Cells are drawn slightly larger, so that no gap is visible between neighbours.
        let area = Frame {
            width: area.width + 0.3,
            height: area.height + 0.3,
            ..area
        };
        document.rect(
            area,
            format_args!(r#"fill="{}""#, colour.unwrap_or(UNKNOWN)),
        );
    });
    let mut outline = String::new();
    let is_filled = |i: usize, j: usize| slice.cell(i, j).filled_from.is_some();
    runs(
        columns,
        rows,
        is_filled,
        |column, row, length, is_filled| {
            if is_filled {
                let area = area(column, row, length);
                let [x, y, width, height] = [area.left, area.top, area.width, area.height].map(px);
                // Writing to a String cannot fail.
                let _ = write!(outline, "M{x} {y}h{width}v{height}h-{width}z");
            }
        },
    );
    if !outline.is_empty() {
        document.push(format_args!(
            r#"<path d="{outline}" fill="url(#hatch)" fill-opacity=".75"/>"#
        ));
    }
}

/// Calls `draw` for each run of cells with an equal look in a row. The arguments are the first column, the row, the
/// length and the look of the run.
pub fn runs<L: PartialEq + Copy>(
    columns: usize,
    rows: usize,
    look: impl Fn(usize, usize) -> L,
    mut draw: impl FnMut(usize, usize, usize, L),
) {
    for row in 0..rows {
        let looks: Vec<L> = (0..columns).map(|column| look(column, row)).collect();
        let mut column = 0;
        for run in looks.chunk_by(|a, b| a == b) {
            draw(column, row, run.len(), run[0]);
            column += run.len();
        }
    }
}

fn contours(document: &mut SvgDocument, slice: &Slice) {
    let frame = Frame::MAP;
    let (columns, rows) = (slice.columns(), slice.rows());
    let share = |(i, j): (f64, f64)| (i / (columns - 1) as f64, j / (rows - 1) as f64);
    let (low, high) = (slice.range.low, slice.range.high);
    let levels = slice.range.ticks(5.0).into_iter();
    for level in levels.filter(|level| *level > low && *level < high) {
        let value = |i: usize, j: usize| slice.cell(i, j).value;
        let mut lines = contour::lines(contour::pieces(columns, rows, value, level));
        lines.sort_by_key(|line| std::cmp::Reverse(line.len()));
        for line in &lines {
            let points = line.iter().map(|point| share(*point));
            let points: Vec<(f64, f64)> = points.map(|(x, y)| frame.at(x, y)).collect();
            document.through("polyline", &points, format_args!(r#"class="halo""#));
            document.through("polyline", &points, format_args!(r#"class="contour""#));
        }
        // The longest line of a level is labelled.
        if let Some(line) = lines.first().filter(|line| line.len() > 4)
            && let Some(middle) = line.get(line.len() / 2)
        {
            let (x, y) = share(*middle);
            document.text_on(frame.label_at(x, y), &short(level));
        }
    }
}

/// Draws the output over one input; sections whose values were filled by interpolation are dashed.
pub(super) fn curve(document: &mut SvgDocument, frame: &Frame, slice: &Slice) {
    const DRAWN: &str = r##"fill="none" stroke="#2a788e" stroke-width="2.5""##;
    const DASHED: &str =
        r##"fill="none" stroke="#d55e00" stroke-width="2.5" stroke-dasharray="6 4""##;
    document.grid(frame, slice.range);
    let mut piece: Vec<(f64, f64)> = Vec::new();
    let mut style = DRAWN;
    for (i, x) in slice.x.points.iter().enumerate() {
        let cell = slice.cell(i, 0);
        let this = if cell.filled_from.is_some() {
            DASHED
        } else {
            DRAWN
        };
        let at = |value| frame.at(slice.x.scale().share(*x), slice.share(value));
        let point = cell.value.map(at);
        if this != style {
            // Adjacent sections share one point.
            piece.extend(point);
        }
        if this != style || point.is_none() {
            document.through("polyline", &piece, format_args!("{style}"));
            piece.clear();
            style = this;
        }
        piece.extend(point);
    }
    document.through("polyline", &piece, format_args!("{style}"));
    document.axes(
        frame,
        (slice.x.scale(), &slice.x.title()),
        (slice.range, &slice.output_title()),
    );
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn equal_neighbours_become_one_run() {
        let mut found = Vec::new();
        runs(
            4,
            1,
            |i, _| i / 3,
            |column, row, length, look| {
                found.push((column, row, length, look));
            },
        );
        assert_eq!(found, [(0, 0, 3, 0), (3, 0, 1, 1)]);
    }
}
