//! Verification of claims that outputs are monotone.

use alloc::{string::String, vec::Vec};
use core::fmt;

use super::{
    findings::coordinates,
    probe::{Coordinate, Line, NOTABLE, Probe},
    shown,
};

/// A claim that an output never decreases, or never increases, as an input increases.
#[derive(Debug, Clone, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Monotone {
    /// The name of the input.
    pub input: String,
    /// The claimed direction of the output as the input increases.
    pub direction: Direction,
    /// The name of the output; `None` if the claim is about every output.
    pub output: Option<String>,
}

/// The direction of an output as an input increases.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[cfg_attr(feature = "serde", serde(rename_all = "lowercase"))]
pub enum Direction {
    /// The output never decreases.
    Increasing,
    /// The output never increases.
    Decreasing,
}

impl Direction {
    /// Returns the verb that describes a violation of the claim: `falls` or `rises`.
    pub(super) fn contradicted(self) -> &'static str {
        match self {
            Direction::Increasing => "falls",
            Direction::Decreasing => "rises",
        }
    }
}

impl Monotone {
    /// Creates a claim from its text: the name of an input (`heat`) for a claim about every output, or the names of an
    /// input and an output (`heat:speed`).
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
    /// The claim, with the output that violates it.
    pub claim: Monotone,
    /// The value of each input. The claim's input has the smaller of its two values; the larger one is `to`.
    pub at: Vec<Coordinate>,
    /// The larger value of the claim's input.
    pub to: f64,
    /// The value of the output at the smaller input.
    pub from_value: f64,
    /// The value of the output at the larger input.
    pub to_value: f64,
}

/// Formats a counterexample as `` `speed` falls from 6 to 3 as `heat` rises from 20 to 40 at humidity = 50 ``
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
    /// Returns, for each output that violates a claim, the worst counterexample.
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
            // For each output: the most extreme value so far on the line, preceded by the input at which it
            // occurs. The most extreme value is the largest one for an increasing claim and the smallest one for
            // a decreasing claim.
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
            let requested = claim.output.as_ref().is_none_or(|name| name == output);
            let range = self
                .model
                .outputs
                .iter()
                .find(|o| o.variable.name == *output)?;
            let range = range.variable.high - range.variable.low;
            (requested && fall > NOTABLE * range).then_some(example)
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
