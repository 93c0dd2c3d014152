//! Whether outputs are monotone as claimed.

use alloc::{string::String, vec::Vec};
use core::fmt;

use super::{
    findings::coordinates,
    probe::{Coordinate, Line, NOTABLE, Probe},
    shown,
};

/// A claim about an output: it never falls, or never rises, when an input rises.
#[derive(Debug, Clone, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Monotone {
    /// The input.
    pub input: String,
    /// What the output does when the input rises.
    pub direction: Direction,
    /// The output; every output where none is named.
    pub output: Option<String>,
}

/// What an output does when an input rises.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[cfg_attr(feature = "serde", serde(rename_all = "lowercase"))]
pub enum Direction {
    /// It never falls.
    Increasing,
    /// It never rises.
    Decreasing,
}

impl Direction {
    /// What an output does that contradicts it.
    pub(super) fn contradicted(self) -> &'static str {
        match self {
            Direction::Increasing => "falls",
            Direction::Decreasing => "rises",
        }
    }
}

impl Monotone {
    /// A claim about every output, from the name of an input (`heat`), or about one output (`heat:speed`).
    #[must_use]
    pub fn new(claim: &str, direction: Direction) -> Monotone {
        let (input, output) = match claim.split_once(':') {
            Some((input, output)) => (input, Some(output)),
            None => (claim, None),
        };
        Monotone {
            input: input.trim().into(),
            direction,
            output: output.map(|output| output.trim().into()),
        }
    }
}

/// A counterexample to a claim.
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[non_exhaustive]
pub struct Counterexample {
    /// The claim, with the output that contradicts it.
    pub claim: Monotone,
    /// All inputs by name, at the smaller value.
    pub at: Vec<Coordinate>,
    /// The larger value of the input.
    pub to: f64,
    /// The output at the smaller value.
    pub from_value: f64,
    /// The output at the larger value.
    pub to_value: f64,
}

/// `` `speed` falls from 6 to 3 as `heat` rises from 20 to 40 at humidity = 50 ``
impl fmt::Display for Counterexample {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let claim = &self.claim;
        let (along, others): (Vec<Coordinate>, Vec<Coordinate>) = self
            .at
            .iter()
            .cloned()
            .partition(|c| c.input == claim.input);
        write!(
            f,
            "`{}` {} from {} to {} as `{}` rises from {} to {}",
            claim.output.as_deref().unwrap_or(""),
            claim.direction.contradicted(),
            shown(self.from_value),
            shown(self.to_value),
            claim.input,
            shown(along.first().map_or(0.0, |c| c.value)),
            shown(self.to)
        )?;
        match others.as_slice() {
            [] => Ok(()),
            others => write!(f, " at {}", coordinates(others)),
        }
    }
}

impl Probe<'_> {
    /// The worst counterexample to each claim, for each output.
    pub(super) fn counterexamples(&mut self, claim: &Monotone) -> Vec<Counterexample> {
        let Some(input) = self.model.inputs.iter().position(|v| v.name == claim.input) else {
            return Vec::new();
        };
        let sign = match claim.direction {
            Direction::Increasing => 1.0,
            Direction::Decreasing => -1.0,
        };
        let outputs = self.model.outputs.len();
        let mut worst: Vec<Option<(f64, Counterexample)>> = alloc::vec![None; outputs];
        for line in self.lines(input) {
            // The best value so far on the line, by output, and where it is.
            let mut best: Vec<Option<(f64, f64)>> = alloc::vec![None; outputs];
            for (x, values) in &line.values {
                for (output, value) in values.iter().enumerate() {
                    let (Some(value), Some(best)) = (*value, best.get_mut(output)) else {
                        continue;
                    };
                    match best {
                        Some((_, most)) if sign * value < sign * *most => {
                            let fall = sign * (*most - value);
                            let example = self.example(claim, output, &line, *best, *x, value);
                            let place = worst.get_mut(output);
                            if let (Some(place), Some(example)) = (place, example)
                                && place.as_ref().is_none_or(|(deepest, _)| fall > *deepest)
                            {
                                *place = Some((fall, example));
                            }
                        }
                        _ => *best = Some((*x, value)),
                    }
                }
            }
        }
        let notable = |(fall, example): (f64, Counterexample)| {
            let output = example.claim.output.as_ref()?;
            let asked = claim.output.as_ref().is_none_or(|name| name == output);
            let range = self
                .model
                .outputs
                .iter()
                .find(|o| o.variable.name == *output)?;
            let range = range.variable.high - range.variable.low;
            (asked && fall > NOTABLE * range).then_some(example)
        };
        worst.into_iter().flatten().filter_map(notable).collect()
    }

    fn example(
        &self,
        claim: &Monotone,
        output: usize,
        line: &Line,
        best: Option<(f64, f64)>,
        to: f64,
        to_value: f64,
    ) -> Option<Counterexample> {
        let (from, from_value) = best?;
        let mut point = line.base.clone();
        *point.get_mut(line.input)? = from;
        let output = self.model.outputs.get(output)?.variable.name.clone();
        Some(Counterexample {
            claim: Monotone {
                output: Some(output),
                ..claim.clone()
            },
            at: self.named(&point),
            to,
            from_value,
            to_value,
        })
    }
}
