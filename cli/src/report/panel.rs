//! One picture of values over time, with what stands behind and over it: as HTML, or as a part of an SVG file.

use std::fmt::Write as _;

use super::curve::Stretch;
use crate::drawing::{
    text::{Escaped, number},
    ticks,
};

/// What all pictures of one flight have in common.
pub(crate) struct Timeline {
    pub(crate) stretch: Stretch,
    /// Flight modes: their stretch, name, and which one of the different modes it is.
    pub(crate) modes: Vec<(Stretch, String, usize)>,
    /// Findings: their stretch and the class of their level.
    pub(crate) findings: Vec<(Stretch, &'static str)>,
    /// What was said or done, in order of time.
    pub(crate) events: Vec<(f64, String)>,
}

/// One curve.
pub(crate) struct Line {
    /// The class that gives it its colour.
    pub(crate) class: &'static str,
    pub(crate) name: String,
    /// From [`super::curve::path`].
    pub(crate) data: String,
}

/// A value that is marked over all of the time.
pub(crate) struct Mark {
    pub(crate) value: f64,
    pub(crate) class: &'static str,
    /// What it is; empty where that need not be said at every panel.
    pub(crate) name: String,
}

/// Values over time on one scale.
pub(crate) struct Panel {
    pub(crate) title: String,
    pub(crate) unit: &'static str,
    pub(crate) low: f64,
    pub(crate) high: f64,
    pub(crate) size: Size,
    pub(crate) lines: Vec<Line>,
    pub(crate) marks: Vec<Mark>,
    /// What is out of reach, from one value to another.
    pub(crate) zones: Vec<(f64, f64)>,
    /// Which input of the rules it shows, for the picture of the map to follow.
    pub(crate) input: Option<usize>,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Size {
    Large,
    Medium,
    Small,
}

/// Seconds between marks, from which the first is taken that leaves few enough.
const STEPS_S: [f64; 16] = [
    0.1, 0.5, 1.0, 2.0, 5.0, 10.0, 20.0, 30.0, 60.0, 120.0, 300.0, 600.0, 1200.0, 1800.0, 3600.0,
    7200.0,
];
/// At most so many marks fit along the time, on a phone too.
const MOST_TICKS: f64 = 7.0;

/// The times to mark: whole steps of the log's clock.
fn time_ticks(stretch: Stretch) -> Vec<f64> {
    let fits = |step: &&f64| stretch.length_s() / **step <= MOST_TICKS;
    let step_s = STEPS_S
        .iter()
        .find(fits)
        .copied()
        .unwrap_or(stretch.length_s() / MOST_TICKS);
    let first = (stretch.start_s / step_s).ceil();
    (0..=MOST_TICKS as usize)
        .map(|i| (first + i as f64) * step_s)
        .filter(|t_s| stretch.contains(*t_s))
        .collect()
}

/// A round step that divides a range into two to five parts.
fn value_ticks(low: f64, high: f64, small: bool) -> Vec<f64> {
    if small {
        return vec![low, high];
    }
    ticks(low, high, 4.0)
}

impl Panel {
    /// What is written beside the values: the highest has the unit.
    fn scale(&self, small: bool, decimals: usize) -> Vec<(f64, String)> {
        let ticks = value_ticks(self.low, self.high, small);
        let mut labels: Vec<(f64, String)> = ticks
            .into_iter()
            .map(|value| (value, number(value, decimals)))
            .collect();
        if let Some((_, highest)) = labels.last_mut().filter(|_| !self.unit.is_empty()) {
            let _ = write!(highest, " {}", self.unit);
        }
        labels
    }

    /// What is drawn, in a nested SVG whose x is seconds since the start and whose y is the value upwards.
    fn drawing(&self, timeline: &Timeline, place: &str) -> String {
        let (low, high) = (self.low, self.high);
        let (length, height) = (timeline.stretch.length_s(), high - low);
        let (length, height) = (number(length, 3), number(height, 6));
        let mut svg = format!(
            r#"<svg class="plot" {place} viewBox="0 {} {length} {height}" preserveAspectRatio="none"><g transform="scale(1 -1)">"#,
            number(-high, 6),
        );
        let since_start = |t_s: f64| (t_s - timeline.stretch.start_s).max(0.0);
        let mut rectangle = |class: &str, from: f64, to: f64, bottom: f64, top: f64| {
            let _ = write!(
                svg,
                r#"<rect class="{class}" x="{}" y="{}" width="{}" height="{}"/>"#,
                number(from, 2),
                number(bottom, 4),
                number(to - from, 2),
                number(top - bottom, 4),
            );
        };
        for (stretch, _, kind) in &timeline.modes {
            let (from, to) = (since_start(stretch.start_s), since_start(stretch.end_s));
            rectangle(&format!("mode{}", kind % 4), from, to, low, high);
        }
        for (bottom, top) in &self.zones {
            rectangle("zone", 0.0, timeline.stretch.length_s(), *bottom, *top);
        }
        if self.size != Size::Small {
            let strip = (high - low) * 0.04;
            for (stretch, class) in &timeline.findings {
                let (from, to) = (since_start(stretch.start_s), since_start(stretch.end_s));
                rectangle(class, from, to, high - strip, high);
            }
        }
        let ticks = value_ticks(low, high, self.size == Size::Small);
        let levels = ticks.into_iter().map(|value| (value, "grid"));
        let marks = self.marks.iter().map(|mark| (mark.value, mark.class));
        for (value, class) in levels.chain(marks) {
            let _ = write!(
                svg,
                r#"<path class="{class}" d="M0 {}H{length}"/>"#,
                number(value, 4)
            );
        }
        let (bottom, top) = (number(low, 4), number(high, 4));
        for (t_s, text) in &timeline.events {
            let _ = write!(
                svg,
                r#"<path class="event" d="M{} {bottom}V{top}"><title>{}</title></path>"#,
                number(since_start(*t_s), 2),
                Escaped(text),
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

    /// The picture for the report: it takes the width there is, and its text keeps its size.
    pub(crate) fn html(&self, timeline: &Timeline) -> String {
        let class = match self.size {
            Size::Large => "large",
            Size::Medium => "medium",
            Size::Small => "small",
        };
        let input = self
            .input
            .map(|input| format!(r#" data-input="{input}""#))
            .unwrap_or_default();
        let mut html = format!(
            r#"<figure class="panel {class}"{input} data-unit="{}" data-start="{}" data-length="{}"><figcaption>"#,
            self.unit,
            number(timeline.stretch.start_s, 3),
            number(timeline.stretch.length_s(), 3),
        );
        let _ = write!(html, "<b>{}</b>", Escaped(&self.title));
        for line in self.lines.iter().filter(|line| !line.data.is_empty()) {
            let bare = if line.name.is_empty() { " bare" } else { "" };
            let _ = write!(
                html,
                r#" <span class="key {}{bare}">{} <output></output></span>"#,
                line.class,
                Escaped(&line.name)
            );
        }
        for mark in self.marks.iter().filter(|mark| !mark.name.is_empty()) {
            let _ = write!(
                html,
                r#" <span class="key dashed {}">{}</span>"#,
                mark.class,
                Escaped(&mark.name)
            );
        }
        html += "</figcaption><div class=\"frame\">";
        let small = self.size == Size::Small;
        for (value, label) in self.scale(small, 3) {
            let share = (value - self.low) / (self.high - self.low);
            let _ = write!(
                html,
                r#"<span class="y" style="bottom:{}%">{label}</span>"#,
                number(share * 100.0, 2),
            );
        }
        html += "<div class=\"area\">";
        if self.size == Size::Large {
            for (stretch, name, _) in &timeline.modes {
                let from = timeline.stretch.share(stretch.start_s) * 100.0;
                let to = timeline.stretch.share(stretch.end_s) * 100.0;
                let _ = write!(
                    html,
                    r#"<span class="mode" style="left:{}%;width:{}%">{}</span>"#,
                    number(from, 2),
                    number(to - from, 2),
                    Escaped(name)
                );
            }
        }
        html += &self.drawing(timeline, "");
        html += "</div></div>";
        if !small {
            html += &time_axis(timeline.stretch);
        }
        html += "</figure>";
        html
    }

    /// The picture at a place of an SVG file, with its labels: left, top, width and height of the drawing.
    pub(crate) fn svg(&self, timeline: &Timeline, [left, top, width, height]: [f64; 4]) -> String {
        let place = format!(
            r#"x="{}" y="{}" width="{}" height="{}""#,
            number(left, 1),
            number(top, 1),
            number(width, 1),
            number(height, 1)
        );
        let mut svg = self.drawing(timeline, &place);
        let mut text = |class: &str, x: f64, y: f64, words: &str| {
            let _ = write!(
                svg,
                r#"<text class="{class}" x="{}" y="{}">{}</text>"#,
                number(x, 1),
                number(y, 1),
                Escaped(words)
            );
        };
        for (value, label) in self.scale(false, 4) {
            let share = (value - self.low) / (self.high - self.low);
            let y = top + height * (1.0 - share) + 4.0;
            text("y", left - 6.0, y, &label);
        }
        let last = time_ticks(timeline.stretch).len().saturating_sub(1);
        for (i, t_s) in time_ticks(timeline.stretch).into_iter().enumerate() {
            let x = left + width * timeline.stretch.share(t_s);
            let unit = if i == last { " s" } else { "" };
            text(
                "x",
                x,
                top + height + 16.0,
                &format!("{}{unit}", number(t_s, 1)),
            );
        }
        for (stretch, name, _) in &timeline.modes {
            let from = timeline.stretch.share(stretch.start_s);
            let room = (timeline.stretch.share(stretch.end_s) - from) * width;
            // About 7 units a character; a name that does not fit would lie over the next one.
            if name.chars().count() as f64 * 7.0 < room {
                text("mode", left + width * from + 4.0, top + 24.0, name);
            }
        }
        let mut x = left;
        for line in &self.lines {
            text(&format!("key {}", line.class), x, top - 8.0, &line.name);
            x += line.name.chars().count() as f64 * 7.0 + 24.0;
        }
        svg
    }
}

fn time_axis(stretch: Stretch) -> String {
    let mut html = String::from("<div class=\"times\">");
    let ticks = time_ticks(stretch);
    let last = ticks.len().saturating_sub(1);
    for (i, t_s) in ticks.into_iter().enumerate() {
        let share = stretch.share(t_s);
        // Beyond the right edge there is nothing on a phone.
        let class = if share > 0.94 { r#" class="end""# } else { "" };
        let _ = write!(
            html,
            r#"<span{class} style="left:{}%">{}{}</span>"#,
            number(share * 100.0, 2),
            number(t_s, 1),
            if i == last { " s" } else { "" }
        );
    }
    html + "</div>"
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ticks_are_round_and_few() {
        let stretch = |start_s, end_s| Stretch { start_s, end_s };
        assert_eq!(
            time_ticks(stretch(48.8, 178.0)),
            [60.0, 80.0, 100.0, 120.0, 140.0, 160.0]
        );
        for end_s in [0.2, 3.0, 61.0, 600.0, 5000.0, 1e6] {
            let ticks = time_ticks(stretch(0.0, end_s));
            assert!((2..=8).contains(&ticks.len()), "{end_s}: {ticks:?}");
        }
    }
}
