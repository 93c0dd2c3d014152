//! Which values count in a window, and how much.

const SLOTS: f64 = 128.0;
/// What reaches into the window by less, in seconds, has left it.
const RESOLUTION_S: f64 = 1e-6;

/// A window of time at one moment.
pub struct Window {
    /// Its length in seconds.
    pub length_s: f64,
    /// The moment it ends at.
    pub now_s: f64,
    /// What ended before this time does not count.
    pub since_s: f64,
}

impl Window {
    /// The weight in seconds of each value, which stands for the time from the first to the second moment. Values that end
    /// in one slot of 1/128 of the window count together: by the share of their time that is inside.
    pub fn weights(&self, spans: &[(f64, f64)]) -> Vec<f64> {
        let begin_s = self.now_s - self.length_s;
        let slot = |(_, to_s): &(f64, f64)| (to_s * SLOTS / self.length_s).floor();
        let together = spans.chunk_by(|a, b| slot(a) == slot(b));
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

/// The weighted mean of (weight, value).
pub fn mean(values: impl Iterator<Item = (f64, f64)>) -> f64 {
    let (sum, total) = values.fold((0.0, 0.0), |(sum, total), (weight, value)| {
        (sum + weight * value, total + weight)
    });
    sum / total
}
