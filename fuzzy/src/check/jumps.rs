//! Jumps of the outputs.

use alloc::{string::String, vec::Vec};

use super::{
    axis,
    probe::{Coordinate, Line, MAX_ON_A_LINE, NOTABLE, Probe},
};

/// A discontinuity of an output: between two neighbouring values of an input, the output changes by more than 0.5 % of
/// its range.
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[non_exhaustive]
pub struct Jump {
    /// The name of the output.
    pub output: String,
    /// The value of each input; the value of `input` is just below the jump.
    pub at: Vec<Coordinate>,
    /// The input along which the output jumps.
    pub input: String,
    /// The value of the output below the jump.
    pub below: f64,
    /// The value of the output above the jump.
    pub above: f64,
}

impl Probe<'_> {
    /// Returns the largest jump of each output along each input.
    pub(super) fn jumps(&mut self) -> Vec<Jump> {
        let mut found = Vec::new();
        let inputs = self.model.inputs.len();
        // The inputs share the budget of evaluations. If there are very many inputs, only the first ones are examined.
        let most_inputs = (self.evaluations / (4 * MAX_ON_A_LINE)).max(1);
        for input in 0..inputs.min(most_inputs) {
            let lines = self.lines(input);
            for output in 0..self.model.outputs.len() {
                found.extend(self.largest_jump(&lines, input, output));
            }
        }
        found
    }

    fn largest_jump(&mut self, lines: &[Line], input: usize, output: usize) -> Option<Jump> {
        /// The maximum number of steep steps that are bisected.
        const CANDIDATES: usize = 6;
        let variable = &self.model.outputs.get(output)?.variable;
        let notable = NOTABLE * (variable.high - variable.low);
        let mut steep: Vec<(f64, usize, f64, f64)> = Vec::new();
        for (index, line) in lines.iter().enumerate() {
            for pair in line.values.windows(2) {
                let [(low, below), (high, above)] = pair else {
                    continue;
                };
                let (below, above) = (below.get(output), above.get(output));
                if let (Some(Some(below)), Some(Some(above))) = (below, above) {
                    let change = (above - below).abs();
                    if change > notable {
                        steep.push((change, index, *low, *high));
                    }
                }
            }
        }
        steep.sort_by(|a, b| b.0.total_cmp(&a.0));
        steep.truncate(CANDIDATES);
        let mut largest: Option<(f64, Jump)> = None;
        for (_, index, low, high) in steep {
            let line = lines.get(index)?;
            let Some((x, below, above)) = self.close_in(line, output, low, high) else {
                continue;
            };
            let size = (above - below).abs();
            if size > notable && largest.as_ref().is_none_or(|(most, _)| size > *most) {
                let mut point = line.base.clone();
                *point.get_mut(input)? = axis::rounded(x);
                let jump = Jump {
                    output: self.model.outputs.get(output)?.variable.name.clone(),
                    at: self.named(&point),
                    input: self.model.inputs.get(input)?.name.clone(),
                    below,
                    above,
                };
                largest = Some((size, jump));
            }
        }
        largest.map(|(_, jump)| jump)
    }

    /// Bisects from `low` to `high`, keeping the steeper half, until there is no number between them.
    fn close_in(
        &mut self,
        line: &Line,
        output: usize,
        mut low: f64,
        mut high: f64,
    ) -> Option<(f64, f64, f64)> {
        let mut point = line.base.clone();
        let mut at = |probe: &mut Self, x: f64| {
            *point.get_mut(line.input)? = x;
            probe.value(&point, output)
        };
        let (mut below, mut above) = (at(self, low)?, at(self, high)?);
        loop {
            let middle = 0.5 * (low + high);
            if middle <= low || middle >= high {
                return Some((low, below, above));
            }
            // A point without a value between two points with a value is a gap, not a jump.
            let value = at(self, middle)?;
            if (value - below).abs() >= (above - value).abs() {
                (high, above) = (middle, value);
            } else {
                (low, below) = (middle, value);
            }
        }
    }
}
