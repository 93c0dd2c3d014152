//! A value over time as the data of an SVG path, in the units of the data: what is drawn can be read back.

use crate::drawing::text::number;

/// Spans of time a curve is thinned to; each keeps its first, smallest, largest and last value.
const SPANS: usize = 500;

/// The stretch of time of a picture, in seconds on the log's clock.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Stretch {
    pub(crate) start_s: f64,
    pub(crate) end_s: f64,
}

impl Stretch {
    pub(crate) fn length_s(&self) -> f64 {
        (self.end_s - self.start_s).max(1e-3)
    }

    /// The share of the stretch that has passed, in [0, 1].
    pub(crate) fn share(&self, t_s: f64) -> f64 {
        ((t_s - self.start_s) / self.length_s()).clamp(0.0, 1.0)
    }

    pub(crate) fn contains(&self, t_s: f64) -> bool {
        (self.start_s..=self.end_s).contains(&t_s)
    }
}

/// Draws `points` (time in seconds on the log's clock, value or NaN), which must be in order of time.
///
/// The path's x is the seconds since the start of the stretch. It is broken where a value is unknown and where there
/// is none for longer than `gap_s`. Many points are thinned, but the smallest and the largest of each span stay.
pub(crate) fn path(
    points: impl Iterator<Item = (f64, f64)>,
    stretch: Stretch,
    gap_s: f64,
    decimals: usize,
) -> String {
    let mut pen = Pen {
        data: String::new(),
        down: false,
        decimals,
    };
    let span_s = stretch.length_s() / SPANS as f64;
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

#[derive(Default)]
struct Span {
    index: usize,
    points: Vec<(f64, f64)>,
}

impl Span {
    /// Draws what represents the span, in order of time, and empties it.
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
        let mut before = None;
        for i in kept.into_iter().flatten() {
            if before != Some(i)
                && let Some(&(x, y)) = self.points.get(i)
            {
                pen.to(x, y);
            }
            before = Some(i);
        }
        self.points.clear();
    }
}

struct Pen {
    data: String,
    down: bool,
    decimals: usize,
}

impl Pen {
    fn to(&mut self, x: f64, y: f64) {
        self.data.push(if self.down { 'L' } else { 'M' });
        self.data += &number(x, 2);
        self.data.push(' ');
        self.data += &number(y, self.decimals);
        if !self.down {
            // A single point is seen as a dot.
            self.data += "h0";
        }
        self.down = true;
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
    fn what_lies_outside_is_not_drawn() {
        assert_eq!(
            path([(0.0, 1.0), (200.0, 1.0)].into_iter(), STRETCH, 2.0, 1),
            ""
        );
    }
}
