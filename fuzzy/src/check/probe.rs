//! The engine asked at many points: what reach, monotonicity and jumps are found by.
//!
//! The places that the terms name are among the points. What is reported happens, at the inputs that are given with it;
//! what is not reported may still happen between the points.

use alloc::{string::String, vec::Vec};

use super::axis;
use crate::{
    Engine,
    engine::{Outcome, Scratch, State},
    model::{Model, Variable},
};

/// The value of an input.
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
pub struct Coordinate {
    /// The input.
    pub input: String,
    /// Its value.
    pub value: f64,
}

/// Steps that may be spent on a question, a step being one rule or term at one point: some tens of milliseconds.
const MOST_STEPS: usize = 3_000_000;
/// Points of a line along one input.
pub(super) const MOST_ON_A_LINE: usize = 200;
/// A smaller part of the output's range is no jump, and no counterexample.
pub(super) const NOTABLE: f64 = 0.005;

/// The engine with places to look at.
pub(super) struct Probe<'m> {
    pub(super) model: &'m Model,
    engine: &'m Engine,
    scratch: Scratch,
    outcomes: Vec<Outcome>,
    /// The values of each input at which to look.
    pub(super) places: Vec<Vec<f64>>,
    /// Evaluations that are left for one question.
    pub(super) evaluations: usize,
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
    pub(super) fn values(&mut self, point: &[f64]) -> impl Iterator<Item = Option<f64>> {
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

    pub(super) fn value(&mut self, point: &[f64], output: usize) -> Option<f64> {
        self.values(point).nth(output).flatten()
    }

    /// Points of the input space: all combinations of a few places of each input where that is possible, else places
    /// drawn without order but the same every time.
    pub(super) fn points(&self, most: usize) -> Vec<Vec<f64>> {
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

    /// Lines along an input through points of the other inputs, with the outputs' values on them.
    pub(super) fn lines(&mut self, input: usize) -> Vec<Line> {
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

    pub(super) fn named(&self, point: &[f64]) -> Vec<Coordinate> {
        let inputs = self.model.inputs.iter().zip(point);
        let named = inputs.map(|(variable, &value)| Coordinate {
            input: variable.name.clone(),
            value,
        });
        named.collect()
    }
}

/// Values along one input, the others held.
pub(super) struct Line {
    pub(super) base: Vec<f64>,
    pub(super) input: usize,
    pub(super) values: Vec<(f64, Vec<Option<f64>>)>,
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
