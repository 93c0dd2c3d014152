//! Line plots with two axes.

use super::{
    colour::{Colour, distinct_line},
    document::{Anchor, Frame, LABEL_WIDTH, SvgDocument},
    scale::Scale,
    text::cut,
};

/// A line plot with two axes.
#[derive(Debug, Clone)]
pub struct Plot {
    /// The title of the plot.
    pub title: String,
    /// The scale and the title of the horizontal axis.
    pub x: (Scale, String),
    /// The scale and the title of the vertical axis.
    pub y: (Scale, String),
    /// The lines; the last one is on top.
    pub series: Vec<PlotLine>,
}

/// One line of a plot.
#[derive(Debug, Clone)]
pub struct PlotLine {
    /// The name in the legend; a line without a name is not listed.
    pub name: String,
    /// The colour.
    pub colour: Colour,
    /// The dashes in the format of SVG: `7 3`; `none` for a solid line.
    pub dash: &'static str,
    /// Whether each point is marked by a dot.
    pub dots: bool,
    /// The points, in the units of the axes.
    pub points: Vec<(f64, f64)>,
}

impl PlotLine {
    /// Creates the i-th line of a plot; lines differ in colour and in dashes.
    pub fn new(i: usize, name: impl Into<String>, points: Vec<(f64, f64)>) -> PlotLine {
        const DASHES: [&str; 4] = ["none", "7 3", "2 3", "9 3 2 3"];
        PlotLine {
            name: name.into(),
            colour: distinct_line(i),
            dash: DASHES[i % DASHES.len()],
            dots: false,
            points,
        }
    }

    fn paint(&self) -> String {
        let PlotLine { colour, dash, .. } = self;
        format!(r#"class="series" stroke="{colour}" stroke-dasharray="{dash}""#)
    }
}

/// The width and the height of a plot.
const SIDE: f64 = 360.0;
/// The margin to the left of each plot.
const LEFT: f64 = 70.0;
/// The margin above the plots.
const TOP: f64 = 44.0;
/// The width of the legend.
const LEGEND: f64 = 260.0;

/// Returns an SVG of plots side by side, with a common legend that lists the lines of the first plot.
pub fn plots_svg(title: &str, plots: &[Plot]) -> String {
    let keys = plots.first().map_or(&[][..], |plot| &plot.series);
    let keys: Vec<&PlotLine> = keys
        .iter()
        .filter(|series| !series.name.is_empty())
        .collect();
    let legend = plots.len() as f64 * (LEFT + SIDE) + 24.0;
    let height = (TOP + SIDE + 56.0).max(TOP + keys.len() as f64 * 18.0 + 20.0);
    let mut document = SvgDocument::new(legend + LEGEND, height);
    for (i, plot) in plots.iter().enumerate() {
        let frame = Frame {
            left: LEFT + i as f64 * (LEFT + SIDE),
            top: TOP,
            width: SIDE,
            height: SIDE,
        };
        let at = (frame.left + SIDE / 2.0, TOP - 16.0);
        document.text(at, Anchor::Middle, "heading", &plot.title);
        draw(&mut document, &frame, plot);
    }
    for (i, series) in keys.into_iter().enumerate() {
        let y = TOP + 8.0 + 18.0 * i as f64;
        let ends = [(legend, y), (legend + 28.0, y)];
        document.through("polyline", &ends, format_args!("{}", series.paint()));
        let name = cut(&series.name, ((LEGEND - 44.0) / LABEL_WIDTH) as usize);
        document.text((legend + 36.0, y + 4.0), Anchor::Start, "label", &name);
    }
    document.finish(title)
}

/// Draws a plot into a frame of a document.
pub(super) fn draw(document: &mut SvgDocument, frame: &Frame, plot: &Plot) {
    let ((x, x_title), (y, y_title)) = (&plot.x, &plot.y);
    document.grid(frame, *y);
    for series in &plot.series {
        let place = |(a, b): &(f64, f64)| frame.at(x.share(*a), y.share(*b));
        let points: Vec<(f64, f64)> = series.points.iter().map(place).collect();
        document.through("polyline", &points, format_args!("{}", series.paint()));
        for (x, y) in points.into_iter().filter(|_| series.dots) {
            document.push(format_args!(
                r#"<circle cx="{x:.1}" cy="{y:.1}" r="3" fill="{}"/>"#,
                series.colour
            ));
        }
    }
    document.axes(frame, (*x, x_title), (*y, y_title));
}
