//! What the pictures share: a sheet, a frame with axes, ticks, texts and a legend.

use std::fmt::Write as _;

use super::{short, slice::Slice};
use crate::drawing::{
    self,
    palette::viridis,
    text::{Escaped, number},
};

/// Drawn text; writing to a String cannot fail.
#[derive(Default)]
pub(super) struct Sheet {
    body: String,
}

/// The area of a picture that holds the data, in pixels.
#[derive(Clone, Copy)]
pub(super) struct Frame {
    pub(super) left: f64,
    pub(super) top: f64,
    pub(super) width: f64,
    pub(super) height: f64,
}

/// Where a text stands about its place.
#[derive(Clone, Copy)]
pub(super) enum Anchor {
    Start,
    Middle,
    End,
}

pub(super) const WIDTH: f64 = 640.0;
pub(super) const HEIGHT: f64 = 500.0;

impl Frame {
    /// The usual one, with room for a legend on the right.
    pub(super) const USUAL: Frame = Frame {
        left: 70.0,
        top: 44.0,
        width: 440.0,
        height: 380.0,
    };

    /// The place of shares from 0 to 1, the vertical one counted upwards.
    pub(super) fn at(&self, x: f64, y: f64) -> (f64, f64) {
        (
            self.left + x * self.width,
            self.top + (1.0 - y) * self.height,
        )
    }
}

impl Sheet {
    pub(super) fn push(&mut self, element: std::fmt::Arguments<'_>) {
        let _ = self.body.write_fmt(element);
        self.body.push('\n');
    }

    pub(super) fn text(&mut self, (x, y): (f64, f64), anchor: Anchor, class: &str, text: &str) {
        let anchor = match anchor {
            Anchor::Start => "start",
            Anchor::Middle => "middle",
            Anchor::End => "end",
        };
        self.push(format_args!(
            "<text x=\"{}\" y=\"{}\" text-anchor=\"{anchor}\" class=\"{class}\">{}</text>",
            px(x),
            px(y),
            Escaped(text)
        ));
    }

    /// Text over a picture, on a halo of its own: not every viewer draws the edge of letters first.
    pub(super) fn text_on(&mut self, at: (f64, f64), text: &str) {
        self.text(at, Anchor::Middle, "under", text);
        self.text(at, Anchor::Middle, "on", text);
    }

    pub(super) fn line(&mut self, from: (f64, f64), to: (f64, f64), class: &str) {
        self.push(format_args!(
            "<line x1=\"{}\" y1=\"{}\" x2=\"{}\" y2=\"{}\" class=\"{class}\"/>",
            px(from.0),
            px(from.1),
            px(to.0),
            px(to.1)
        ));
    }

    /// A frame with ticks and titles; `y` is the range of the vertical axis and its title.
    pub(super) fn axes(&mut self, frame: &Frame, slice: &Slice, y: (f64, f64), y_title: &str) {
        self.push(format_args!(
            "<rect x=\"{}\" y=\"{}\" width=\"{}\" height=\"{}\" class=\"frame\"/>",
            px(frame.left),
            px(frame.top),
            px(frame.width),
            px(frame.height)
        ));
        let (low, high) = (slice.x.low(), slice.x.high());
        for tick in ticks(low, high) {
            let (x, bottom) = frame.at((tick - low) / (high - low), 0.0);
            self.line((x, bottom), (x, bottom + 5.0), "tick");
            self.text((x, bottom + 18.0), Anchor::Middle, "label", &short(tick));
        }
        for tick in ticks(y.0, y.1) {
            let (left, at) = frame.at(0.0, (tick - y.0) / (y.1 - y.0));
            self.line((left - 5.0, at), (left, at), "tick");
            self.text((left - 8.0, at + 4.0), Anchor::End, "label", &short(tick));
        }
        let (middle, bottom) = frame.at(0.5, 0.0);
        let x_title = slice.x.title();
        self.text((middle, bottom + 38.0), Anchor::Middle, "title", &x_title);
        let (_, centre) = frame.at(0.0, 0.5);
        self.push(format_args!(
            "<text transform=\"translate(18 {}) rotate(-90)\" text-anchor=\"middle\" class=\"title\">{}</text>",
            px(centre),
            Escaped(y_title)
        ));
    }

    pub(super) fn heading(&mut self, text: &str) {
        self.text((Frame::USUAL.left, 24.0), Anchor::Start, "heading", text);
    }

    /// The colours and what they stand for, on the right of the usual frame.
    pub(super) fn legend(&mut self, slice: &Slice) {
        const STEPS: u32 = 50;
        let bar = Frame {
            left: 540.0,
            width: 18.0,
            ..Frame::USUAL
        };
        let step = bar.height / f64::from(STEPS);
        for i in 0..STEPS {
            let share = (f64::from(i) + 0.5) / f64::from(STEPS);
            let (x, y) = bar.at(0.0, (f64::from(i) + 1.0) / f64::from(STEPS));
            self.push(format_args!(
                "<rect x=\"{}\" y=\"{}\" width=\"{}\" height=\"{}\" fill=\"{}\"/>",
                px(x),
                px(y),
                px(bar.width),
                px(step),
                viridis(share)
            ));
        }
        let (low, high) = slice.range;
        for tick in ticks(low, high) {
            let (right, y) = bar.at(1.0, (tick - low) / (high - low));
            self.line((right, y), (right + 4.0, y), "tick");
            self.text((right + 7.0, y + 4.0), Anchor::Start, "label", &short(tick));
        }
        let unit = slice.unit.as_deref();
        let title = super::slice::titled(&slice.output, unit);
        self.text((bar.left, bar.top - 8.0), Anchor::Start, "label", &title);
    }

    /// What hatching and grey mean, below the picture.
    pub(super) fn notes(&mut self, slice: &Slice) {
        let y = HEIGHT - 14.0;
        if slice.any_filled() {
            let x = Frame::USUAL.left;
            self.push(format_args!(
                "<rect x=\"{}\" y=\"{}\" width=\"18\" height=\"12\" class=\"swatch\"/><rect x=\"{}\" y=\"{}\" width=\"18\" height=\"12\" fill=\"url(#hatch)\"/>",
                px(x), px(y - 10.0), px(x), px(y - 10.0)
            ));
            let note = format!(
                "filled: no rule covers it ({})",
                slice.filling.unwrap_or("")
            );
            self.text((x + 24.0, y), Anchor::Start, "label", &note);
        }
        if slice.any_unknown() {
            let x = Frame::USUAL.left + 260.0;
            self.push(format_args!(
                "<rect x=\"{}\" y=\"{}\" width=\"18\" height=\"12\" class=\"unknown\"/>",
                px(x),
                px(y - 10.0)
            ));
            self.text(
                (x + 24.0, y),
                Anchor::Start,
                "label",
                "no value: no rule fires",
            );
        }
    }

    /// The finished picture.
    pub(super) fn finish(self, title: &str) -> String {
        let title = Escaped(title);
        format!(
            "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {WIDTH} {HEIGHT}\" width=\"{WIDTH}\" height=\"{HEIGHT}\" role=\"img\" aria-label=\"{title}\">
<title>{title}</title>
<defs><pattern id=\"hatch\" width=\"7\" height=\"7\" patternUnits=\"userSpaceOnUse\" patternTransform=\"rotate(45)\"><line x1=\"0\" y1=\"0\" x2=\"0\" y2=\"7\" stroke=\"#000\" stroke-width=\"2.4\"/><line x1=\"2\" y1=\"0\" x2=\"2\" y2=\"7\" stroke=\"#fff\" stroke-width=\"1.2\"/></pattern></defs>
<style>rect{{shape-rendering:crispEdges}}text{{font-family:system-ui,sans-serif;fill:#1a1a1a}}.heading{{font-size:15px;font-weight:600}}.title{{font-size:13px}}.label{{font-size:11px}}.frame{{fill:none;stroke:#1a1a1a}}.tick{{stroke:#1a1a1a}}.unknown{{fill:#d9d9d9;stroke:#999}}.swatch{{fill:#fff;stroke:#1a1a1a}}.contour{{fill:none;stroke:#000;stroke-width:1.1}}.halo{{fill:none;stroke:#fff;stroke-width:3;stroke-opacity:.55}}.on,.under{{font-size:11px;font-weight:600}}.under{{stroke:#fff;stroke-width:3px}}.curve{{fill:none;stroke:#2a788e;stroke-width:2.5}}.dashed{{fill:none;stroke:#d55e00;stroke-width:2.5;stroke-dasharray:6 4}}.grid{{stroke:#bbb;stroke-width:.7}}</style>
<rect width=\"{WIDTH}\" height=\"{HEIGHT}\" fill=\"#fff\"/>
{}</svg>
",
            self.body
        )
    }
}

/// A tenth of a pixel is as fine as a screen shows.
pub(super) fn px(x: f64) -> String {
    number(x, 1)
}

/// About five round numbers within a range.
pub(super) fn ticks(low: f64, high: f64) -> Vec<f64> {
    drawing::ticks(low, high, 5.0)
}
