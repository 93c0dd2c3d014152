//! What the outputs do: how far they reach, whether they rise and fall as the author says, where they jump.
//!
//! These are found by evaluating the engine at many points, the places that the terms name among them. What is reported
//! happens, at the inputs that are given with it; what is not reported may still happen between the points.

use alloc::{string::String, vec::Vec};
use core::str::FromStr;

use serde::Serialize;

use super::axis;
use crate::{
    Engine,
    engine::{Outcome, Scratch, State},
    model::{Model, Variable},
};

/// What an author says of an output: it never falls, or never rises, when an input rises.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct Monotone {
    /// The input.
    pub input: String,
    /// What the output does when the input rises.
    pub direction: Direction,
    /// The output; every output where none is named.
    pub output: Option<String>,
}

/// What an output does when an input rises.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum Direction {
    /// It never falls.
    Increasing,
    /// It never rises.
    Decreasing,
}

impl FromStr for Monotone {
    type Err = String;

    /// Reads `margin:decreasing`, or `margin:decreasing:risk` for one output of several.
    fn from_str(text: &str) -> Result<Self, String> {
        let mut parts = text.split(':');
        let (input, direction) = (parts.next().unwrap_or(""), parts.next().unwrap_or(""));
        let output = parts.next().map(String::from);
        let direction = match direction {
            "increasing" => Direction::Increasing,
            "decreasing" => Direction::Decreasing,
            _ => return Err("write `input:increasing`, or `input:decreasing:output`".into()),
        };
        if input.is_empty() || parts.next().is_some() {
            return Err("write `input:increasing`, or `input:decreasing:output`".into());
        }
        Ok(Monotone {
            input: input.into(),
            direction,
            output,
        })
    }
}

/// A place at which an output does not do what its author says.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Counterexample {
    /// What was said, with the output it was found in.
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

/// The value of an input.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Coordinate {
    /// The input.
    pub input: String,
    /// Its value.
    pub value: f64,
}

/// The values an output takes.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Reach {
    /// The output.
    pub output: String,
    /// The smallest value found.
    pub low: f64,
    /// Where it is found.
    pub low_at: Vec<Coordinate>,
    /// The largest value found.
    pub high: f64,
    /// Where it is found.
    pub high_at: Vec<Coordinate>,
    /// The range that the author gave it.
    pub range: [f64; 2],
}

/// A place at which an output jumps.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Jump {
    /// The output.
    pub output: String,
    /// All inputs by name; the named input is just below the jump.
    pub at: Vec<Coordinate>,
    /// The input along which it jumps.
    pub input: String,
    /// The output below it.
    pub below: f64,
    /// The output above it.
    pub above: f64,
}

/// Steps that may be spent on a question, a step being one rule or term at one point: some tens of milliseconds.
const MOST_STEPS: usize = 3_000_000;
/// Points of a line along one input.
const MOST_ON_A_LINE: usize = 200;
/// A smaller part of the output's range is no jump, and no counterexample.
const NOTABLE: f64 = 0.005;

/// The engine with places to look at.
pub(super) struct Probe<'m> {
    model: &'m Model,
    engine: &'m Engine,
    scratch: Scratch,
    outcomes: Vec<Outcome>,
    /// The values of each input at which to look.
    places: Vec<Vec<f64>>,
    /// Evaluations that are left for one question.
    evaluations: usize,
}

impl<'m> Probe<'m> {
    pub(super) fn new(model: &'m Model, engine: &'m Engine) -> Self {
        let places = model
            .inputs
            .iter()
            .map(|input| chosen(input, MOST_ON_A_LINE));
        let work = model.rules.len() + model.inputs.iter().map(|v| v.terms.len()).sum::<usize>();
        Probe {
            model,
            engine,
            scratch: engine.scratch(),
            outcomes: alloc::vec![Outcome::default(); model.outputs.len()],
            places: places.collect(),
            evaluations: (MOST_STEPS / work.max(1)).clamp(100, 60_000),
        }
    }

    /// The values of the outputs that rules give at a point.
    fn values(&mut self, point: &[f64]) -> impl Iterator<Item = Option<f64>> {
        let done = self
            .engine
            .evaluate_with(&mut self.scratch, point, &mut self.outcomes);
        let failed = done.is_err();
        self.outcomes
            .iter()
            .map(move |outcome| match outcome.state {
                // An error about one output leaves those behind it as they were.
                State::Defined(value) if !failed => Some(value),
                _ => None,
            })
    }

    fn value(&mut self, point: &[f64], output: usize) -> Option<f64> {
        self.values(point).nth(output).flatten()
    }

    /// Points of the input space: all combinations of a few places of each input where that is possible, else places
    /// drawn without order but the same every time.
    fn points(&self, most: usize) -> Vec<Vec<f64>> {
        let count = self.places.len();
        let side = libm::pow(most as f64, 1.0 / count.max(1) as f64) as usize;
        if side >= 5 {
            let mut points: Vec<Vec<f64>> = Vec::from([Vec::new()]);
            for input in &self.model.inputs {
                let places = chosen(input, side);
                let longer = points.iter().flat_map(|point| {
                    places.iter().map(|&x| {
                        let mut point = point.clone();
                        point.push(x);
                        point
                    })
                });
                points = longer.collect();
            }
            return points;
        }
        // A linear congruential generator (Knuth's MMIX constants) is order enough, and the same everywhere.
        let mut state: u64 = 1;
        let mut draw = |below: usize| {
            state = state
                .wrapping_mul(6_364_136_223_846_793_005)
                .wrapping_add(1_442_695_040_888_963_407);
            ((state >> 33) as usize) % below.max(1)
        };
        let mut point = || {
            let place = |places: &Vec<f64>| places.get(draw(places.len())).copied().unwrap_or(0.0);
            self.places.iter().map(place).collect()
        };
        (0..most).map(|_| point()).collect()
    }

    /// The smallest and the largest value of each output, as far as they are found. None for outputs that no point defines.
    pub(super) fn reach(&mut self) -> Vec<Reach> {
        let points = self.points(self.evaluations / 2);
        let none: Option<(f64, Vec<f64>)> = None;
        let mut lows = alloc::vec![none.clone(); self.model.outputs.len()];
        let mut highs = alloc::vec![none; self.model.outputs.len()];
        for point in &points {
            let values: Vec<Option<f64>> = self.values(point).collect();
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
            let Some(variable) = self.model.outputs.get(output).map(|o| &o.variable) else {
                continue;
            };
            found.push(Reach {
                output: variable.name.clone(),
                low,
                low_at: self.named(&low_at),
                high,
                high_at: self.named(&high_at),
                range: [variable.low, variable.high],
            });
        }
        found
    }

    /// Walks from the best point to better ones, one input at a time.
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
                for x in self.places.get(input).cloned().unwrap_or_default() {
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

    /// The worst counterexample of each output to what its author says.
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

    /// Where outputs jump along an input: the largest jump of each output along each input.
    pub(super) fn jumps(&mut self) -> Vec<Jump> {
        let mut found = Vec::new();
        let inputs = self.model.inputs.len();
        // Each input gets its part of the time; of very many the first ones.
        let most_inputs = (self.evaluations / (4 * MOST_ON_A_LINE)).max(1);
        for input in 0..inputs.min(most_inputs) {
            let lines = self.lines(input);
            for output in 0..self.model.outputs.len() {
                found.extend(self.largest_jump(&lines, input, output));
            }
        }
        found
    }

    fn largest_jump(&mut self, lines: &[Line], input: usize, output: usize) -> Option<Jump> {
        /// How many steep places are looked at closely.
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

    /// Halves the stretch from `low` to `high`, always keeping the steeper half, until nothing lies between.
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
            // A place without a value between two with one is a gap, not a jump.
            let value = at(self, middle)?;
            if (value - below).abs() >= (above - value).abs() {
                (high, above) = (middle, value);
            } else {
                (low, below) = (middle, value);
            }
        }
    }

    /// Lines along an input through points of the other inputs, with the outputs' values on them.
    fn lines(&mut self, input: usize) -> Vec<Line> {
        let places = self.places.get(input).cloned().unwrap_or_default();
        let count = (self.evaluations / (2 * places.len().max(1))).clamp(2, 400);
        let mut bases = self.points(count);
        for base in &mut bases {
            if let Some(place) = base.get_mut(input) {
                *place = 0.0;
            }
        }
        bases.sort_by(|a, b| a.partial_cmp(b).unwrap_or(core::cmp::Ordering::Equal));
        bases.dedup();
        let lines = bases.into_iter().map(|base| {
            let mut point = base.clone();
            let values = places.iter().map(|&x| {
                if let Some(place) = point.get_mut(input) {
                    *place = x;
                }
                (x, self.values(&point).collect())
            });
            let values = values.collect();
            Line {
                base,
                input,
                values,
            }
        });
        lines.collect()
    }

    fn named(&self, point: &[f64]) -> Vec<Coordinate> {
        let inputs = self.model.inputs.iter().zip(point);
        let named = inputs.map(|(variable, &value)| Coordinate {
            input: variable.name.clone(),
            value,
        });
        named.collect()
    }
}

/// Values along one input, the others held.
struct Line {
    base: Vec<f64>,
    input: usize,
    values: Vec<(f64, Vec<Option<f64>>)>,
}

/// Places of an input at which to look, at most `most`: those its terms name come first, even steps fill up.
fn chosen(input: &Variable, most: usize) -> Vec<f64> {
    let range = input.low..=input.high;
    let mut named: Vec<f64> = input
        .terms
        .iter()
        .flat_map(|term| axis::marks(&term.shape))
        .collect();
    named.retain(|x| range.contains(x));
    named.extend([input.low, input.high]);
    named.sort_by(f64::total_cmp);
    named.dedup();
    if named.len() >= most {
        return thin(&named, most);
    }
    let mut even = axis::places(input);
    even.retain(|x| !named.contains(x));
    let mut places = thin(&even, most - named.len());
    places.extend(named);
    places.sort_by(f64::total_cmp);
    places
}

/// `most` places, evenly taken from all.
fn thin(places: &[f64], most: usize) -> Vec<f64> {
    let count = places.len();
    if count <= most {
        return places.to_vec();
    }
    let last = most.saturating_sub(1).max(1);
    let kept = (0..most).filter_map(|i| places.get(i * (count - 1) / last).copied());
    kept.collect()
}
