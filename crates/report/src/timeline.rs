//! Curves over time on one scale, with phases behind the curves and with events.

use std::fmt::Write as _;

use fuzzy::drawing::{EscapedText, Frame, Scale, number};

use crate::curve::Stretch;

/// The styles of curves over time. The page that includes these styles sets the colours of the classes of lines,
/// marks and alerts, in the CSS variable `--c`.
pub(crate) const CSS: &str = include_str!("timeline.css");

/// The data that all panels over the same time share.
#[derive(Debug, Clone)]
pub(crate) struct Timeline {
    /// The stretch of time that is shown.
    pub(crate) stretch: Stretch,
    /// The time at which the labels show 0:00, in seconds.
    pub(crate) zero_s: f64,
    /// The phases behind the curves.
    pub(crate) phases: Vec<Phase>,
    /// Stretches that are marked along the upper edge, each with a class of the style sheet; the last is on top.
    pub(crate) alerts: Vec<(Stretch, &'static str)>,
    /// Single events, in order of time.
    pub(crate) events: Vec<(f64, String)>,
}

/// A phase, such as a flight mode, shaded behind the curves.
#[derive(Debug, Clone)]
pub(crate) struct Phase {
    /// The time from the start to the end of the phase.
    pub(crate) stretch: Stretch,
    /// The name of the phase.
    pub(crate) name: String,
    /// The kind of the phase: phases of one kind have the same shade.
    pub(crate) kind: usize,
}

/// One curve.
#[derive(Debug, Clone)]
pub(crate) struct Line {
    /// The class in the style sheet, which sets its colour.
    pub(crate) class: &'static str,
    /// The name of the curve.
    pub(crate) name: String,
    /// The data of the path, from [`path`](crate::curve::path).
    pub(crate) data: String,
}

/// A value that is marked by a horizontal line.
#[derive(Debug, Clone)]
pub(crate) struct Mark {
    /// The value.
    pub(crate) value: f64,
    /// The class in the style sheet.
    pub(crate) class: &'static str,
    /// The name; empty if the panel does not need to show it.
    pub(crate) name: String,
}

/// Curves over time on one scale.
#[derive(Debug, Clone)]
pub(crate) struct Panel {
    /// The title.
    pub(crate) title: String,
    /// The unit of the values.
    pub(crate) unit: String,
    /// The range of values that is shown.
    pub(crate) scale: Scale,
    /// The height.
    pub(crate) size: Size,
    /// The curves.
    pub(crate) lines: Vec<Line>,
    /// A shaded area behind the curves, such as the interval of a risk.
    pub(crate) band: Option<Line>,
    /// Values that are marked by horizontal lines.
    pub(crate) marks: Vec<Mark>,
    /// Ranges of values that are shaded over the whole time.
    pub(crate) zones: Vec<Scale>,
}

/// The height of a panel.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Size {
    /// A main panel, the tallest size.
    Large,
    /// A panel of medium height.
    Medium,
    /// A small panel, one of many in a column: only the ends of its scale are labelled.
    Small,
}

/// The number of decimals that are needed to show a thousandth of a range of values.
pub(crate) fn decimals(scale: Scale) -> usize {
    let range = scale.high - scale.low;
    match range.is_finite() && range > 0.0 {
        true => (3.0 - range.log10().floor()).clamp(0.0, 8.0) as usize,
        false => 0,
    }
}

impl Line {
    /// A curve with a class, from the data of its path.
    pub(crate) fn new(class: &'static str, name: impl Into<String>, data: String) -> Line {
        let name = name.into();
        Line { class, name, data }
    }
}

impl Panel {
    /// A panel of curves with a scale and a unit, without a band, marks or zones.
    pub(crate) fn new(
        title: impl Into<String>,
        (scale, unit): (Scale, &str),
        size: Size,
        lines: Vec<Line>,
    ) -> Panel {
        Panel {
            title: title.into(),
            unit: unit.to_owned(),
            scale,
            size,
            lines,
            band: None,
            marks: Vec::new(),
            zones: Vec::new(),
        }
    }

    /// Whether the panel contains a curve with data.
    pub(crate) fn has_data(&self) -> bool {
        self.lines.iter().any(|line| !line.data.is_empty())
    }

    /// The values with ticks: round numbers, or the ends of a small panel's scale.
    fn ticks(&self) -> Vec<f64> {
        match self.size {
            Size::Small => vec![self.scale.low, self.scale.high],
            Size::Large | Size::Medium => self.scale.ticks(4.0),
        }
    }

    /// The values with ticks and their labels; the highest label includes the unit.
    pub(crate) fn labels(&self) -> Vec<(f64, String)> {
        let labels = self.ticks().into_iter();
        let decimals = decimals(self.scale).max(3);
        let mut labels: Vec<(f64, String)> = labels
            .map(|value| (value, number(value, decimals)))
            .collect();
        if let Some((_, highest)) = labels.last_mut().filter(|_| !self.unit.is_empty()) {
            // Writing to a String cannot fail.
            let _ = write!(highest, " {}", self.unit);
        }
        labels
    }

    /// The curves as an SVG element without labels. The x axis is the time in seconds since the start; the y axis
    /// is the value and points upwards.
    ///
    /// `attributes` are the attributes of the element: its position and size within another SVG document, or none.
    pub(crate) fn plot(&self, timeline: &Timeline, attributes: &str) -> String {
        let Scale { low, high } = self.scale;
        let (length, height) = (timeline.stretch.length_s(), high - low);
        let (length, height) = (number(length, 3), number(height, 8));
        let places = decimals(self.scale).max(4);
        let mut svg = format!(
            r#"<svg class="plot" {attributes} viewBox="0 {} {length} {height}" preserveAspectRatio="none"><g transform="scale(1 -1)">"#,
            number(-high, 8),
        );
        let since_start = |t_s: f64| (t_s - timeline.stretch.start_s).max(0.0);
        let mut rectangle = |class: &str, from: f64, to: f64, bottom: f64, top: f64| {
            let _ = write!(
                svg,
                r#"<rect class="{class}" x="{}" y="{}" width="{}" height="{}"/>"#,
                number(from, 2),
                number(bottom, places),
                number(to - from, 2),
                number(top - bottom, places),
            );
        };
        let ends = |stretch: &Stretch| (since_start(stretch.start_s), since_start(stretch.end_s));
        for phase in &timeline.phases {
            let (from, to) = ends(&phase.stretch);
            rectangle(&format!("phase{}", phase.kind % 4), from, to, low, high);
        }
        for zone in &self.zones {
            rectangle(
                "zone",
                0.0,
                timeline.stretch.length_s(),
                zone.low,
                zone.high,
            );
        }
        if self.size != Size::Small {
            let strip = (high - low) * 0.04;
            for (stretch, class) in &timeline.alerts {
                let (from, to) = ends(stretch);
                rectangle(class, from, to, high - strip, high);
            }
        }
        if let Some(band) = &self.band {
            let _ = write!(
                svg,
                r#"<path class="band {}" d="{}"/>"#,
                band.class, band.data
            );
        }
        let levels = self.ticks().into_iter().map(|value| (value, "grid"));
        let marks = self.marks.iter().map(|mark| (mark.value, mark.class));
        for (value, class) in levels.chain(marks) {
            let _ = write!(
                svg,
                r#"<path class="{class}" d="M0 {}H{length}"/>"#,
                number(value, places)
            );
        }
        // Browsers use single precision, and damaged logs contain larger values.
        let drawn = |value: f64| number(value.clamp(-1e30, 1e30), places);
        let (bottom, top) = (drawn(low), drawn(high));
        for (t_s, text) in &timeline.events {
            let _ = write!(
                svg,
                r#"<path class="event" d="M{} {bottom}V{top}"><title>{}</title></path>"#,
                number(since_start(*t_s), 2),
                EscapedText(text),
            );
        }
        for line in self.lines.iter().filter(|line| !line.data.is_empty()) {
            let _ = write!(
                svg,
                r#"<path class="line {}" d="{}"/>"#,
                line.class, line.data
            );
        }
        let _ = write!(
            svg,
            r#"<path class="cursor" d="M-1 {bottom}V{top}"/></g></svg>"#
        );
        svg
    }

    /// The panel with its labels as part of an SVG document, with the curves inside `frame`.
    ///
    /// It needs 48 pixels to the left of the frame, and 24 above and below.
    pub(crate) fn svg(&self, timeline: &Timeline, frame: Frame) -> String {
        let Frame {
            left,
            top,
            width,
            height,
        } = frame;
        let [x, y, across, down] = [left, top, width, height].map(|length| number(length, 1));
        let place = format!(r#"x="{x}" y="{y}" width="{across}" height="{down}""#);
        let mut svg = self.plot(timeline, &place);
        let mut text = |class: &str, x: f64, y: f64, words: &str| {
            let (x, y) = (number(x, 1), number(y, 1));
            let _ = write!(
                svg,
                r#"<text class="{class}" x="{x}" y="{y}">{}</text>"#,
                EscapedText(words)
            );
        };
        for (value, label) in self.labels() {
            let (_, y) = frame.at(0.0, self.scale.share(value));
            text("y", left - 6.0, y + 4.0, &label);
        }
        for (t_s, label) in timeline.stretch.ticks(timeline.zero_s) {
            let (x, y) = frame.at(timeline.stretch.share(t_s), 0.0);
            text("x", x, y + 16.0, &label);
        }
        // About 7 pixels per character.
        let length = |words: &str| words.chars().count() as f64 * 7.0;
        for Phase { stretch, name, .. } in &timeline.phases {
            let from = timeline.stretch.share(stretch.start_s);
            let room = (timeline.stretch.share(stretch.end_s) - from) * width;
            // A name that does not fit is omitted, because it would overlap the next one.
            if length(name) < room {
                text("phase", left + width * from + 4.0, top + 24.0, name);
            }
        }
        let mut x = left;
        for line in self.lines.iter().chain(&self.band) {
            text(&format!("key {}", line.class), x, top - 8.0, &line.name);
            x += length(&line.name) + 24.0;
        }
        svg
    }
}
