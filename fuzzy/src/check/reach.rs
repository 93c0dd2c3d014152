//! The values that the outputs take.

use alloc::{string::String, vec::Vec};

use super::{
    outer::{UnreachedTerm, unreached},
    probe::{Coordinate, Probe},
};

/// The smallest and the largest value of an output.
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[non_exhaustive]
pub struct Reach {
    /// The name of the output.
    pub output: String,
    /// The smallest value found.
    pub low: f64,
    /// The inputs at which `low` was found.
    pub low_at: Vec<Coordinate>,
    /// The largest value found.
    pub high: f64,
    /// The inputs at which `high` was found.
    pub high_at: Vec<Coordinate>,
    /// The range of the output.
    pub range: [f64; 2],
    /// The outer terms whose peak the output never reaches.
    pub unreached: Vec<UnreachedTerm>,
}

impl Probe<'_> {
    /// Returns the smallest and the largest value found for each output. Outputs that have no value at any point are
    /// omitted.
    pub(super) fn reach(&mut self) -> Vec<Reach> {
        let points = self.points(self.evaluations / 2);
        let none: Option<(f64, Vec<f64>)> = None;
        let mut lows = alloc::vec![none.clone(); self.model.outputs.len()];
        let mut highs = alloc::vec![none; self.model.outputs.len()];
        for point in &points {
            let values: Vec<Option<f64>> = self.outputs(point).collect();
            for ((value, low), high) in values.iter().zip(&mut lows).zip(&mut highs) {
                let Some(value) = *value else { continue };
                if low.as_ref().is_none_or(|(least, _)| value < *least) {
                    *low = Some((value, point.clone()));
                }
                if high.as_ref().is_none_or(|(most, _)| value > *most) {
                    *high = Some((value, point.clone()));
                }
            }
        }
        let mut found = Vec::new();
        let budget = self.evaluations / (4 * self.model.outputs.len().max(1));
        for (output, (low, high)) in lows.into_iter().zip(highs).enumerate() {
            let (Some(low), Some(high)) = (low, high) else {
                continue;
            };
            let (low, low_at) = self.climb(low, output, -1.0, budget);
            let (high, high_at) = self.climb(high, output, 1.0, budget);
            let Some(written) = self.model.outputs.get(output) else {
                continue;
            };
            let variable = &written.variable;
            found.push(Reach {
                output: variable.name.clone(),
                low,
                low_at: self.named(&low_at),
                high,
                high_at: self.named(&high_at),
                range: [variable.low, variable.high],
                unreached: unreached(self.model, written, (low, high)),
            });
        }
        found
    }

    /// Improves the best point by coordinate search, one input at a time.
    fn climb(
        &mut self,
        (mut best, mut point): (f64, Vec<f64>),
        output: usize,
        sign: f64,
        mut budget: usize,
    ) -> (f64, Vec<f64>) {
        let mut better = true;
        while better && budget > 0 {
            better = false;
            for input in 0..point.len() {
                for x in self.values.get(input).cloned().unwrap_or_default() {
                    budget = budget.saturating_sub(1);
                    let mut there = point.clone();
                    if let Some(place) = there.get_mut(input) {
                        *place = x;
                    }
                    if budget > 0
                        && let Some(value) = self.value(&there, output)
                        && sign * value > sign * best
                    {
                        (best, point, better) = (value, there, true);
                    }
                }
            }
        }
        (best, point)
    }
}
