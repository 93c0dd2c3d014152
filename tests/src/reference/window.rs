//! The values in a window and their weights.

const SLOTS: f64 = 128.0;
/// Values that extend into the window by less than this, in seconds, count as outside it.
const RESOLUTION_S: f64 = 1e-6;

/// A time window at one moment.
pub struct Window {
    /// The length in seconds.
    pub length_s: f64,
    /// The end of the window, in seconds.
    pub now_s: f64,
    /// Values that ended before this time do not count.
    pub since_s: f64,
}

impl Window {
    /// Groups values that end in the same slot of 1/128 of the window.
    pub fn slots<'s>(
        &self,
        spans: &'s [(f64, f64)],
    ) -> impl Iterator<Item = &'s [(f64, f64)]> + use<'s> {
        let length_s = self.length_s;
        let slot = move |(_, to_s): &(f64, f64)| (to_s * SLOTS / length_s).floor();
        spans.chunk_by(move |a, b| slot(a) == slot(b))
    }

    /// The weight in seconds of each value, given its time span. Values of a slot count by the share of their time inside the
    /// window.
    pub fn weights(&self, spans: &[(f64, f64)]) -> Vec<f64> {
        let begin_s = self.now_s - self.length_s;
        let together = self.slots(spans);
        let weights = together.flat_map(|spans| {
            let (from_s, to_s) = (spans[0].0, spans[spans.len() - 1].1);
            let share = match to_s - begin_s.max(self.since_s) > RESOLUTION_S {
                true => ((to_s - begin_s) / (to_s - from_s)).min(1.0),
                false => 0.0,
            };
            spans
                .iter()
                .map(move |(from_s, to_s)| share * (to_s - from_s))
        });
        weights.collect()
    }
}

/// The weighted mean of (weight, value) pairs.
pub fn mean(values: impl Iterator<Item = (f64, f64)>) -> f64 {
    let (sum, total) = values.fold((0.0, 0.0), |(sum, total), (weight, value)| {
        (sum + weight * value, total + weight)
    });
    sum / total
}
