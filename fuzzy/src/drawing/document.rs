//! An SVG document under construction: shapes, texts, and frames with axes.

use std::fmt::{self, Write as _};

use super::{
    colour::{Colour, output_colour},
    scale::Scale,
    slice::Slice,
    text::{EscapedText, cut, number, short, wrapped},
};

/// An SVG document under construction. Lengths are in pixels, relative to the upper left corner.
pub struct SvgDocument {
    width: f64,
    height: f64,
    /// Additional height above the upper edge, for headings with more than one line.
    above: f64,
    style: String,
    body: String,
}

/// The area of a drawing that contains the data, in pixels.
#[derive(Debug, Clone, Copy)]
pub struct Frame {
    /// The left edge.
    pub left: f64,
    /// The upper edge.
    pub top: f64,
    /// The width.
    pub width: f64,
    /// The height.
    pub height: f64,
}

/// The part of a text that is aligned with its position.
#[derive(Debug, Clone, Copy)]
pub enum Anchor {
    /// The start of the text.
    Start,
    /// The middle of the text.
    Middle,
    /// The end of the text.
    End,
}

impl fmt::Display for Anchor {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Anchor::Start => "start",
            Anchor::Middle => "middle",
            Anchor::End => "end",
        })
    }
}

/// The size of the drawing of a map.
const WIDTH: f64 = 640.0;
const HEIGHT: f64 = 500.0;

/// The approximate width of a character in a label and in a heading.
pub(super) const LABEL_WIDTH: f64 = 6.6;
const HEADING_WIDTH: f64 = 9.0;

const STYLE: &str = "rect{shape-rendering:crispEdges}text{font-family:system-ui,sans-serif;fill:#1a1a1a}\
.heading{font-size:15px;font-weight:600}.title{font-size:13px}.label{font-size:11px}\
.frame{fill:none;stroke:#1a1a1a}.tick{stroke:#1a1a1a}.grid{stroke:#bbb;stroke-width:.7}\
.unknown{fill:#d9d9d9;stroke:#999}.swatch{fill:#fff;stroke:#1a1a1a}\
.contour{fill:none;stroke:#000;stroke-width:1.1}.halo{fill:none;stroke:#fff;stroke-width:3;stroke-opacity:.55}\
.on,.under{font-size:11px;font-weight:600}.under{stroke:#fff;stroke-width:3px}\
.series{fill:none;stroke-width:2}.marker{stroke:#1a1a1a;stroke-width:1.5;stroke-dasharray:4 3}";

impl Frame {
    /// The frame of a map, which leaves room for a legend on the right.
    pub(super) const MAP: Frame = Frame {
        left: 70.0,
        top: 44.0,
        width: 440.0,
        height: 380.0,
    };

    /// Returns the point at a fraction `x` of the width, from the left edge, and a fraction `y` of the height, from the
    /// lower edge.
    pub fn at(&self, x: f64, y: f64) -> (f64, f64) {
        (
            self.left + x * self.width,
            self.top + (1.0 - y) * self.height,
        )
    }

    /// Returns the right edge.
    pub fn right(&self) -> f64 {
        self.left + self.width
    }

    /// Returns the lower edge.
    pub fn bottom(&self) -> f64 {
        self.top + self.height
    }

    /// Returns the ticks of the vertical axis: about one per 45 pixels, and at most 5.
    fn ticks(&self, y: Scale) -> Vec<f64> {
        y.ticks((self.height / 45.0).clamp(2.0, 5.0))
    }

    /// Returns the position of a label for a point, moved inside the frame.
    pub(super) fn label_at(&self, x: f64, y: f64) -> (f64, f64) {
        let (x, y) = self.at(x, y);
        (
            x.clamp(self.left + 14.0, self.right() - 14.0),
            y.clamp(self.top + 14.0, self.bottom() - 8.0) + 4.0,
        )
    }
}

impl SvgDocument {
    /// Creates an empty white document with the default styles.
    pub fn new(width: f64, height: f64) -> SvgDocument {
        SvgDocument::styled(width, height, STYLE)
    }

    /// Creates an empty document with custom styles. The style `rect.paper` applies to the background.
    pub fn styled(width: f64, height: f64, style: impl Into<String>) -> SvgDocument {
        SvgDocument {
            width,
            height,
            above: 0.0,
            style: style.into(),
            body: String::new(),
        }
    }

    pub(super) fn map() -> SvgDocument {
        SvgDocument::new(WIDTH, HEIGHT)
    }

    /// Adds markup verbatim. Text from the input must be escaped with [`EscapedText`].
    pub fn push(&mut self, markup: fmt::Arguments<'_>) {
        // Writing to a String cannot fail.
        let _ = self.body.write_fmt(markup);
        self.body.push('\n');
    }

    /// Adds a text with a class; an empty text is ignored.
    pub fn text(&mut self, (x, y): (f64, f64), anchor: Anchor, class: &str, text: &str) {
        if text.is_empty() {
            return;
        }
        let (x, y, text) = (px(x), px(y), EscapedText(text));
        self.push(format_args!(
            r#"<text x="{x}" y="{y}" text-anchor="{anchor}" class="{class}">{text}</text>"#
        ));
    }

    /// Adds a title along an axis, rotated clockwise about its middle.
    pub fn rotated_text(&mut self, (x, y): (f64, f64), degrees: f64, text: &str) {
        if text.is_empty() {
            return;
        }
        let (x, y, degrees, text) = (px(x), px(y), px(degrees), EscapedText(text));
        self.push(format_args!(
            r#"<text transform="translate({x} {y}) rotate({degrees})" text-anchor="middle" class="title">{text}</text>"#
        ));
    }

    /// Adds a number on top of the data. Its white outline is a separate text, because not all viewers support
    /// `paint-order`.
    pub(super) fn text_on(&mut self, at: (f64, f64), text: &str) {
        self.text(at, Anchor::Middle, "under", text);
        self.text(at, Anchor::Middle, "on", text);
    }

    /// Adds a rectangle; `paint` contains its remaining attributes.
    pub fn rect(&mut self, frame: Frame, paint: fmt::Arguments<'_>) {
        let (x, y) = (px(frame.left), px(frame.top));
        let (width, height) = (px(frame.width), px(frame.height));
        self.push(format_args!(
            r#"<rect x="{x}" y="{y}" width="{width}" height="{height}" {paint}/>"#
        ));
    }

    /// Adds a straight line with a class.
    pub fn line(&mut self, from: (f64, f64), to: (f64, f64), class: &str) {
        let [x1, y1, x2, y2] = [from.0, from.1, to.0, to.1].map(px);
        self.push(format_args!(
            r#"<line x1="{x1}" y1="{y1}" x2="{x2}" y2="{y2}" class="{class}"/>"#
        ));
    }

    /// Adds a line through points or, if `shape` is `polygon`, an area; `paint` contains its remaining attributes.
    pub fn through(&mut self, shape: &str, points: &[(f64, f64)], paint: fmt::Arguments<'_>) {
        if points.len() < 2 {
            return;
        }
        let points = points.iter().map(|(x, y)| format!("{},{}", px(*x), px(*y)));
        let points = points.collect::<Vec<_>>().join(" ");
        self.push(format_args!(r#"<{shape} points="{points}" {paint}/>"#));
    }

    /// Adds a heading at `left`, and further lines below it. If they are long, the document grows upwards.
    pub fn heading(&mut self, left: f64, text: &str, more: &str) {
        let room = self.width - left - 8.0;
        let mut lines = vec![("heading", cut(text, (room / HEADING_WIDTH) as usize))];
        if !more.is_empty() {
            let below = wrapped(more, (room / LABEL_WIDTH) as usize);
            lines.extend(below.into_iter().map(|line| ("label", line)));
        }
        let mut y = 24.0;
        for (class, line) in lines.iter().rev() {
            self.text((left, y), Anchor::Start, class, line);
            y -= if *class == "label" { 16.0 } else { 0.0 };
        }
        self.above = 24.0 - y;
    }

    /// Adds a frame with ticks and titles. `x` and `y` are the scales and titles of the horizontal and the vertical
    /// axis.
    pub fn axes(&mut self, frame: &Frame, x: (Scale, &str), y: (Scale, &str)) {
        self.rect(*frame, format_args!(r#"class="frame""#));
        let (middle, bottom) = frame.at(0.5, 0.0);
        let (left, centre) = frame.at(0.0, 0.5);
        // About one tick per 70 pixels, and at most 5.
        for tick in x.0.ticks((frame.width / 70.0).clamp(2.0, 5.0)) {
            let (x, _) = frame.at(x.0.share(tick), 0.0);
            self.line((x, bottom), (x, bottom + 5.0), "tick");
            self.text((x, bottom + 18.0), Anchor::Middle, "label", &short(tick));
        }
        for tick in frame.ticks(y.0) {
            let (_, y) = frame.at(0.0, y.0.share(tick));
            self.line((left - 5.0, y), (left, y), "tick");
            self.text((left - 8.0, y + 4.0), Anchor::End, "label", &short(tick));
        }
        self.text((middle, bottom + 36.0), Anchor::Middle, "title", x.1);
        self.rotated_text((left - 52.0, centre), -90.0, y.1);
    }

    /// Adds grid lines at the ticks of the vertical axis.
    pub(super) fn grid(&mut self, frame: &Frame, y: Scale) {
        for tick in frame.ticks(y) {
            let share = y.share(tick);
            self.line(frame.at(0.0, share), frame.at(1.0, share), "grid");
        }
    }

    /// Adds coloured squares, each with a text, one below the other.
    pub(super) fn legend_entries(&mut self, left: f64, top: f64, keys: &[(Colour, String)]) {
        let most = ((self.width - left - 20.0) / LABEL_WIDTH) as usize;
        for (i, (colour, text)) in keys.iter().enumerate() {
            let y = top + 18.0 * i as f64;
            let square = Frame {
                left,
                top: y,
                width: 11.0,
                height: 11.0,
            };
            self.rect(
                square,
                format_args!(r##"fill="{colour}" stroke="#1a1a1a" stroke-width=".5""##),
            );
            self.text(
                (left + 16.0, y + 10.0),
                Anchor::Start,
                "label",
                &cut(text, most),
            );
        }
    }

    /// Adds the legend to the right of a map's frame: the colours and their values.
    pub(super) fn legend(&mut self, slice: &Slice) {
        const STEPS: u32 = 50;
        let bar = Frame {
            left: 540.0,
            width: 18.0,
            ..Frame::MAP
        };
        for i in 0..STEPS {
            let (left, top) = bar.at(0.0, f64::from(i + 1) / f64::from(STEPS));
            let height = bar.height / f64::from(STEPS);
            let share = (f64::from(i) + 0.5) / f64::from(STEPS);
            let colour = output_colour(&slice.output, share);
            self.rect(
                Frame {
                    left,
                    top,
                    height,
                    ..bar
                },
                format_args!(r#"fill="{colour}""#),
            );
        }
        for tick in slice.range.ticks(5.0) {
            let (right, y) = bar.at(1.0, slice.range.share(tick));
            self.line((right, y), (right + 4.0, y), "tick");
            self.text((right + 7.0, y + 4.0), Anchor::Start, "label", &short(tick));
        }
        let title = cut(&slice.output_title(), 18);
        // A long title is aligned with the right edge of the document instead of the bar.
        let (x, anchor) = match title.chars().count() {
            0..15 => (bar.left, Anchor::Start),
            _ => (WIDTH - 8.0, Anchor::End),
        };
        self.text((x, bar.top - 8.0), anchor, "label", &title);
    }

    /// Adds an explanation of hatched and grey cells below a map.
    pub(super) fn notes(&mut self, slice: &Slice) {
        let swatch = Frame {
            left: Frame::MAP.left,
            top: HEIGHT - 24.0,
            width: 18.0,
            height: 12.0,
        };
        let beside = |swatch: Frame| (swatch.left + 24.0, swatch.top + 10.0);
        if slice.any_filled() {
            self.rect(swatch, format_args!(r#"class="swatch""#));
            self.rect(swatch, format_args!(r#"fill="url(#hatch)""#));
            let note = format!(
                "interpolated where no rule applies ({})",
                slice.filling_text()
            );
            self.text(beside(swatch), Anchor::Start, "label", &note);
        }
        if slice.any_unknown() {
            let swatch = Frame {
                left: Frame::MAP.left + if slice.any_filled() { 340.0 } else { 0.0 },
                ..swatch
            };
            self.rect(swatch, format_args!(r#"class="unknown""#));
            self.text(
                beside(swatch),
                Anchor::Start,
                "label",
                "unknown: no rule fires",
            );
        }
    }

    /// Returns the finished document. The title is read by screen readers and shown by browsers.
    pub fn finish(self, title: &str) -> String {
        let SvgDocument {
            width,
            style,
            body,
            above,
            ..
        } = self;
        let (height, title) = (self.height + above, EscapedText(title));
        format!(
            r##"<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 {top} {width} {height}" width="{width}" height="{height}" role="img" aria-label="{title}">
<title>{title}</title>
<defs><pattern id="hatch" width="7" height="7" patternUnits="userSpaceOnUse" patternTransform="rotate(45)"><line x1="0" y1="0" x2="0" y2="7" stroke="#000" stroke-width="2.4"/><line x1="2" y1="0" x2="2" y2="7" stroke="#fff" stroke-width="1.2"/></pattern></defs>
<style>{style}</style>
<rect class="paper" y="{top}" width="{width}" height="{height}" fill="#fff"/>
{body}</svg>
"##,
            top = 0.0 - above,
        )
    }
}

/// Formats a length with a resolution of a tenth of a pixel; screens show no finer detail.
pub(super) fn px(x: f64) -> String {
    number(x, 1)
}
