//! Periods of a flight.

/// A period of a flight, both ends included, in seconds.
///
/// # Example
/// ```
/// use flagred_evaluation::Span;
///
/// let gust = Span { from_s: 30.0, to_s: 33.5 };
/// assert!(gust.contains(30.0) && gust.contains(33.5) && !gust.contains(34.0));
/// ```
#[derive(Debug, Clone, Copy, PartialEq, serde::Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Span {
    /// The start in seconds.
    pub from_s: f64,
    /// The end in seconds.
    pub to_s: f64,
}

impl Span {
    /// The length in seconds.
    pub fn length_s(&self) -> f64 {
        self.to_s - self.from_s
    }

    /// Whether a time is within the span.
    pub fn contains(&self, t_s: f64) -> bool {
        (self.from_s..=self.to_s).contains(&t_s)
    }

    /// Sorts spans by time and joins those that touch.
    pub fn joined(spans: impl IntoIterator<Item = Span>) -> Vec<Span> {
        let mut spans: Vec<Span> = spans.into_iter().collect();
        spans.sort_by(|a, b| a.from_s.total_cmp(&b.from_s));
        spans.dedup_by(|next, kept| {
            let touches = next.from_s <= kept.to_s;
            if touches {
                kept.to_s = kept.to_s.max(next.to_s);
            }
            touches
        });
        spans
    }

    /// The length of the overlap of two spans, in seconds; 0 without overlap.
    pub fn shared_s(&self, other: &Span) -> f64 {
        let to_s = self.to_s.min(other.to_s);
        (to_s - self.from_s.max(other.from_s)).max(0.0)
    }

    /// Updates `spans` with the next time. If `is_so` is true, the last span is extended or a new one begins;
    /// otherwise the last span ends.
    ///
    /// `open` stores the value of `is_so` between calls.
    pub fn follow(spans: &mut Vec<Span>, open: &mut bool, t_s: f64, is_so: bool) {
        match spans.last_mut().filter(|_| *open && is_so) {
            Some(span) => span.to_s = t_s,
            None if is_so => spans.push(Span {
                from_s: t_s,
                to_s: t_s,
            }),
            None => {}
        }
        *open = is_so;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_condition_over_a_time_is_a_span() {
        let (mut spans, mut open) = (Vec::new(), false);
        for (t_s, is_so) in [
            (0.0, false),
            (1.0, true),
            (2.0, true),
            (3.0, false),
            (4.0, true),
        ] {
            Span::follow(&mut spans, &mut open, t_s, is_so);
        }
        let span = |from_s, to_s| Span { from_s, to_s };
        assert_eq!(spans, [span(1.0, 2.0), span(4.0, 4.0)]);
        let drawn = [
            span(4.0, 5.0),
            span(1.0, 3.0),
            span(2.0, 2.5),
            span(3.0, 3.5),
        ];
        assert_eq!(Span::joined(drawn), [span(1.0, 3.5), span(4.0, 5.0)]);
        assert_eq!(spans[0].shared_s(&span(1.5, 9.0)), 0.5);
        assert_eq!(spans[0].shared_s(&spans[1]), 0.0);
        assert!(spans[0].contains(1.0) && spans[0].contains(2.0) && !spans[0].contains(2.1));
    }
}
