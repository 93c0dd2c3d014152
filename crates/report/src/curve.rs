//! Draws a value over time: as the data of an SVG path in the units of the values, or as text.

use std::fmt::Write as _;

use fuzzy::drawing::{block, number};

use crate::clock::minutes;

/// The number of spans of time in a thinned curve; each keeps its first, smallest, largest and last value.
const SPANS: usize = 500;
/// The number of spans of time in a thinned curve if many curves are drawn.
pub(crate) const FEW_SPANS: usize = 120;

/// A stretch shorter than this, in seconds, is drawn with a finer resolution of time.
const FEW_S: f64 = 2.0;

/// A stretch of time that a picture shows.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Stretch {
    /// The start, in seconds.
    pub start_s: f64,
    /// The end, in seconds.
    pub end_s: f64,
}

/// The candidates for the seconds between ticks; the smallest step with few enough ticks is used.
const STEPS_S: [f64; 17] = [
    0.1, 0.5, 1.0, 2.0, 5.0, 10.0, 15.0, 30.0, 60.0, 120.0, 300.0, 600.0, 900.0, 1200.0, 1800.0,
    3600.0, 7200.0,
];
/// The maximum number of ticks along the time axis, which must fit on a phone.
const MAX_TICKS: f64 = 6.0;

impl Stretch {
    /// The length in seconds; at least a millisecond.
    pub fn length_s(&self) -> f64 {
        (self.end_s - self.start_s).max(1e-3)
    }

    /// The position of a time, clamped to the stretch: 0 at the start, 1 at the end.
    pub fn share(&self, t_s: f64) -> f64 {
        ((t_s - self.start_s) / self.length_s()).clamp(0.0, 1.0)
    }

    /// Whether a time is within the stretch, ends included.
    pub fn contains(&self, t_s: f64) -> bool {
        (self.start_s..=self.end_s).contains(&t_s)
    }

    /// The times of ticks with their labels: round minutes and seconds since `zero_s`; the last label includes the unit.
    pub(crate) fn ticks(&self, zero_s: f64) -> Vec<(f64, String)> {
        let fits = |step: &&f64| self.length_s() / **step <= MAX_TICKS;
        let step_s = STEPS_S.iter().find(fits).copied();
        let step_s = step_s.unwrap_or(self.length_s() / MAX_TICKS);
        let decimals = usize::from(step_s < 1.0);
        let first = ((self.start_s - zero_s) / step_s).ceil();
        let times = (0..=MAX_TICKS as usize).map(|i| (first + i as f64) * step_s);
        let within = times.filter(|since_s| self.contains(zero_s + since_s));
        let label = |since_s: f64| (zero_s + since_s, minutes(since_s, decimals));
        let mut ticks: Vec<(f64, String)> = within.map(label).collect();
        if let Some((_, last)) = ticks.last_mut() {
            last.push_str(" min");
        }
        ticks
    }
}

/// The data of an SVG path through `points` (time in seconds, value or NaN), which must be in order of time.
///
/// Its x is the seconds since the start of the stretch, its y the value, so that a script can read the values back. The
/// line is interrupted at unknown values and where there is no point for longer than `gap_s`. Many points are thinned;
/// the smallest and the largest of each span are kept.
pub(crate) fn path(
    points: impl Iterator<Item = (f64, f64)>,
    stretch: Stretch,
    gap_s: f64,
    decimals: usize,
) -> String {
    thinned(points, stretch, gap_s, decimals, SPANS)
}

/// Like [`path`], but thinned to the given number of spans.
pub(crate) fn thinned(
    points: impl Iterator<Item = (f64, f64)>,
    stretch: Stretch,
    gap_s: f64,
    decimals: usize,
    spans: usize,
) -> String {
    let mut pen = Pen {
        data: String::new(),
        down: false,
        // Short stretches are drawn to a tenth of a millisecond: with hundredths of a second, steps would be visible.
        decimals: [if stretch.length_s() < FEW_S { 4 } else { 2 }, decimals],
    };
    let span_s = stretch.length_s() / spans as f64;
    let mut span = Span::default();
    let mut last_s = f64::NEG_INFINITY;
    for (t_s, value) in points.filter(|(t_s, _)| stretch.contains(*t_s)) {
        let x = t_s - stretch.start_s;
        let known = value.is_finite();
        if !known || t_s - last_s > gap_s {
            span.draw(&mut pen);
            pen.down = false;
        }
        if known {
            let index = (x / span_s) as usize;
            if span.index != index {
                span.draw(&mut pen);
                span.index = index;
            }
            span.points.push((x, value));
            last_s = t_s;
        }
    }
    span.draw(&mut pen);
    pen.data
}

/// The data of an SVG path around the area between the lower and the upper values of `points` (time in seconds, both
/// values or `None`), in the units of [`path`]. Many points are thinned: each span has its smallest and largest value.
pub(crate) fn area(
    points: impl Iterator<Item = (f64, Option<(f64, f64)>)>,
    stretch: Stretch,
    gap_s: f64,
    decimals: usize,
) -> String {
    let span_s = stretch.length_s() / SPANS as f64;
    let mut parts: Vec<Vec<AreaSpan>> = Vec::new();
    let mut last_s = f64::NEG_INFINITY;
    for (t_s, values) in points.filter(|(t_s, _)| stretch.contains(*t_s)) {
        let Some((low, high)) = values else {
            last_s = f64::NEG_INFINITY;
            continue;
        };
        let x = t_s - stretch.start_s;
        if t_s - last_s > gap_s {
            parts.push(Vec::new());
        }
        last_s = t_s;
        let index = (x / span_s) as usize;
        let Some(part) = parts.last_mut() else {
            continue;
        };
        match part.last_mut().filter(|span| span.index == index) {
            Some(span) => {
                span.times[1] = x;
                span.ends = [span.ends[0].min(low), span.ends[1].max(high)];
            }
            None => part.push(AreaSpan {
                index,
                times: [x, x],
                ends: [low, high],
            }),
        }
    }
    let across = if stretch.length_s() < FEW_S { 4 } else { 2 };
    let mut data = String::new();
    for part in parts {
        let upper = part
            .iter()
            .flat_map(|span| span.times.map(|x| (x, span.ends[1])));
        let lower = part
            .iter()
            .flat_map(|span| span.times.map(|x| (x, span.ends[0])));
        let lower: Vec<(f64, f64)> = lower.collect();
        let around = upper.chain(lower.into_iter().rev());
        for (i, (x, y)) in around.enumerate() {
            data.push(if i == 0 { 'M' } else { 'L' });
            data += &number(x, across);
            data.push(' ');
            data += &number(y, decimals);
        }
        data.push('Z');
    }
    data
}

/// A span of an area: its first and last time, its lowest and highest value.
struct AreaSpan {
    index: usize,
    times: [f64; 2],
    ends: [f64; 2],
}

#[derive(Default)]
struct Span {
    index: usize,
    points: Vec<(f64, f64)>,
}

impl Span {
    /// Draws the kept points in order of time, and clears the span.
    fn draw(&mut self, pen: &mut Pen) {
        let indices = 0..self.points.len();
        let value = |i: &usize| self.points.get(*i).map_or(f64::NAN, |point| point.1);
        let by_value = |a: &usize, b: &usize| value(a).total_cmp(&value(b));
        let mut kept = [
            Some(0),
            indices.clone().min_by(by_value),
            indices.clone().max_by(by_value),
            indices.last(),
        ];
        kept.sort_unstable();
        let mut kept: Vec<usize> = kept.into_iter().flatten().collect();
        kept.dedup();
        for &(x, y) in kept.into_iter().filter_map(|i| self.points.get(i)) {
            pen.to(x, y);
        }
        self.points.clear();
    }
}

struct Pen {
    data: String,
    down: bool,
    /// The number of decimals of the seconds and of the value.
    decimals: [usize; 2],
}

impl Pen {
    fn to(&mut self, x: f64, y: f64) {
        self.data.push(if self.down { 'L' } else { 'M' });
        let [across, up] = self.decimals;
        self.data += &number(x, across);
        self.data.push(' ');
        self.data += &number(y, up);
        if !self.down {
            // A line of length 0 draws a single point as a dot.
            self.data += "h0";
        }
        self.down = true;
    }
}

/// The height of a text chart, in rows.
const ROWS: usize = 5;

/// Values in percent over time as text, `width` columns wide.
///
/// A column shows the highest value of its span of time, so that no peak is lost; `·` marks spans in which all values
/// are unknown, an empty column a span without points.
pub(crate) fn over_time_text(points: &[(f64, Option<f64>)], width: usize) -> String {
    let (Some(first), Some(last)) = (points.first(), points.last()) else {
        return String::new();
    };
    let (start_s, span_s) = (first.0, (last.0 - first.0).max(f64::MIN_POSITIVE));
    let mut columns: Vec<Option<Option<f64>>> = vec![None; width];
    for &(t_s, value) in points {
        let column = ((t_s - start_s) / span_s * width as f64) as usize;
        if let Some(cell) = columns.get_mut(column.min(width.saturating_sub(1))) {
            let known = cell.flatten();
            *cell = Some(match (known, value) {
                (Some(a), Some(b)) => Some(a.max(b)),
                (a, b) => a.or(b),
            });
        }
    }

    let mut text = String::new();
    for row in (0..ROWS).rev() {
        let label = match row {
            r if r + 1 == ROWS => "100 % ┤",
            0 => "  0 % ┤",
            _ => "      │",
        };
        let line: String = columns.iter().map(|&column| cell(column, row)).collect();
        let _ = writeln!(text, "{label}{}", line.trim_end());
    }
    let (from, to) = (
        format!("{start_s:.0} s"),
        format!("{:.0} s", start_s + span_s),
    );
    let _ = writeln!(text, "      └{}", "─".repeat(width));
    let _ = writeln!(
        text,
        "       {from}{to:>rest$}",
        rest = width.saturating_sub(from.chars().count())
    );
    text
}

/// The character of one column in one row, counted from the bottom.
fn cell(column: Option<Option<f64>>, row: usize) -> char {
    match column {
        None => ' ',
        Some(None) if row == 0 => '·',
        Some(None) => ' ',
        Some(Some(percent)) => {
            // The bar is at least one eighth high, so that 0 is visibly a known value.
            let eighths = ((percent / 100.0 * (ROWS * 8) as f64).round() as usize).max(1);
            block(eighths, row)
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const STRETCH: Stretch = Stretch {
        start_s: 10.0,
        end_s: 110.0,
    };

    #[test]
    fn ticks_are_round_and_few() {
        let flight = Stretch {
            start_s: 48.0,
            end_s: 178.0,
        };
        let labels = |ticks: Vec<(f64, String)>| -> Vec<String> {
            ticks.into_iter().map(|(_, label)| label).collect()
        };
        assert_eq!(
            labels(flight.ticks(48.0)),
            ["0:00", "0:30", "1:00", "1:30", "2:00 min"]
        );
        assert_eq!(flight.ticks(48.0)[1].0, 78.0);
        for end_s in [0.2, 3.0, 61.0, 600.0, 5000.0, 1e6] {
            let ticks = Stretch {
                start_s: 0.0,
                end_s,
            }
            .ticks(0.0);
            assert!((2..=8).contains(&ticks.len()), "{end_s}: {ticks:?}");
        }
    }

    #[test]
    fn unknown_values_and_gaps_break_the_line() {
        let points = [
            (10.0, 1.0),
            (11.0, 2.0),
            (12.0, f64::NAN),
            (13.0, 3.0),
            (20.0, 4.0),
        ];
        let data = path(points.into_iter(), STRETCH, 2.0, 2);
        assert_eq!(data, "M0 1h0L1 2M3 3h0M10 4h0");
    }

    #[test]
    fn thinning_keeps_a_peak_of_one_sample() {
        let points = (0..100_000).map(|i| {
            let value = if i == 41_234 { 99.0 } else { f64::from(i % 7) };
            (10.0 + f64::from(i) * 1e-3, value)
        });
        let data = path(points, STRETCH, 2.0, 1);
        assert!(data.contains("L41.23 99"), "the peak is gone");
        assert!(data.len() < 30_000, "{} bytes", data.len());
    }

    #[test]
    fn short_stretches_have_finer_times() {
        let points = || [(10.0, 1.0), (10.0025, 2.0)].into_iter();
        assert_eq!(path(points(), STRETCH, 2.0, 1), "M0 1h0L0 2");
        let end_s = 11.5;
        let short = Stretch { end_s, ..STRETCH };
        assert_eq!(path(points(), short, 2.0, 1), "M0 1h0L0.0025 2");
    }

    #[test]
    fn an_area_encloses_its_values_and_breaks_where_they_are_unknown() {
        let points = [
            (10.0, Some((1.0, 4.0))),
            (10.1, Some((2.0, 5.0))),
            (11.0, Some((2.0, 3.0))),
            (12.0, None),
            (13.0, Some((3.0, 3.5))),
        ];
        let data = area(points.into_iter(), STRETCH, 2.0, 1);
        assert_eq!(
            data,
            "M0 5L0.1 5L1 3L1 3L1 2L1 2L0.1 1L0 1ZM3 3.5L3 3.5L3 3L3 3Z"
        );
    }

    #[test]
    fn points_outside_are_not_drawn() {
        assert_eq!(
            path([(0.0, 1.0), (200.0, 1.0)].into_iter(), STRETCH, 2.0, 1),
            ""
        );
    }

    #[test]
    fn a_peak_of_one_step_is_drawn_and_unknown_values_are_marked() {
        let mut points: Vec<(f64, Option<f64>)> =
            (0..400).map(|i| (i as f64 * 0.1, Some(10.0))).collect();
        points[200].1 = Some(100.0);
        for point in &mut points[..40] {
            point.1 = None;
        }
        insta::assert_snapshot!(over_time_text(&points, 40), @r"
        100 % ┤                    █
              │                    █
              │                    █
              │                    █
          0 % ┤····▄▄▄▄▄▄▄▄▄▄▄▄▄▄▄▄█▄▄▄▄▄▄▄▄▄▄▄▄▄▄▄▄▄▄▄
              └────────────────────────────────────────
               0 s                                 40 s
        ");
    }

    #[test]
    fn an_empty_curve_draws_nothing() {
        assert_eq!(over_time_text(&[], 40), "");
        assert!(over_time_text(&[(3.0, Some(50.0))], 10).contains("3 s"));
    }
}
