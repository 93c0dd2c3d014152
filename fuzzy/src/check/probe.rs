//! Evaluations of the engine at many points, for the analyses of reach, monotonicity and jumps.
//!
//! The points include the parameters of the terms. Every reported case is real: it occurs at the reported inputs. A
//! case between the points can be missed.

use alloc::{string::String, vec::Vec};

use super::axis;
use crate::{
    Engine,
    engine::{Outcome, Scratch, State},
    model::{Model, Variable},
};

/// An input with its value.
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Coordinate {
    /// The name of the input.
    pub input: String,
    /// The value of this input.
    pub value: f64,
}

/// The maximum work of one analysis, as the number of evaluated rules and terms. This work takes some tens of
/// milliseconds.
const MAX_STEPS: usize = 3_000_000;
/// The maximum work of all analyses together, as the number of evaluated rules, terms and memberships. This work
/// takes about one second. A single evaluation of an output with many curved terms takes millions of these steps.
const MAX_STEPS_IN_ALL: u64 = 200_000_000;
/// The maximum number of points on a line along one input.
pub(super) const MAX_ON_A_LINE: usize = 200;
/// The minimum change, as a fraction of the output's range, that counts as a jump or a counterexample.
pub(super) const NOTABLE: f64 = 0.005;

/// The engine, with the points at which it is evaluated.
pub(super) struct Probe<'m> {
    pub(super) model: &'m Model,
    engine: &'m Engine,
    scratch: Scratch,
    outcomes: Vec<Outcome>,
    /// The values at which each input is evaluated.
    pub(super) values: Vec<Vec<f64>>,
    /// The maximum number of evaluations per analysis.
    pub(super) evaluations: usize,
    /// The number of rules and terms that each evaluation processes.
    work: u64,
    /// The work that the analyses may still do, in the unit of `MAX_STEPS_IN_ALL`.
    steps_left: u64,
    /// Whether all points that an analysis requested were evaluated.
    pub(super) is_complete: bool,
}

impl<'m> Probe<'m> {
    pub(super) fn new(model: &'m Model, engine: &'m Engine) -> Self {
        let values = model
            .inputs
            .iter()
            .map(|input| chosen(input, MAX_ON_A_LINE));
        let work = model.rules.len() + model.inputs.iter().map(|v| v.terms.len()).sum::<usize>();
        let terms = model.outputs.iter().map(|o| o.variable.terms.len());
        Probe {
            model,
            engine,
            scratch: engine.scratch(),
            outcomes: alloc::vec![Outcome::default(); model.outputs.len()],
            values: values.collect(),
            evaluations: (MAX_STEPS / work.max(1)).clamp(100, 60_000),
            work: (work + terms.sum::<usize>()) as u64,
            steps_left: MAX_STEPS_IN_ALL,
            is_complete: true,
        }
    }

    /// Runs an analysis that may use at most the fraction `part` of the remaining work.
    pub(super) fn with_part<T>(&mut self, part: f64, run: impl FnOnce(&mut Self) -> T) -> T {
        let all = self.steps_left;
        let own = (all as f64 * part) as u64;
        self.steps_left = own;
        let done = run(self);
        self.steps_left += all - own;
        done
    }

    /// Returns the value of each output at a point. A value is `None` if no rule fires, or if the remaining work does
    /// not suffice for an evaluation.
    pub(super) fn outputs(&mut self, point: &[f64]) -> impl Iterator<Item = Option<f64>> {
        let failed = !self.is_evaluated(point);
        self.outcomes
            .iter()
            .map(move |outcome| match outcome.state {
                // After an error, the outcomes belong to an earlier point.
                State::Defined(_) | State::Interval { .. } if !failed => outcome.value(),
                _ => None,
            })
    }

    /// Evaluates a point, and returns whether this succeeded.
    fn is_evaluated(&mut self, point: &[f64]) -> bool {
        let left = self.steps_left.checked_sub(self.work);
        let Some(left) = left.filter(|left| *left > 0) else {
            self.steps_left = 0;
            self.is_complete = false;
            return false;
        };
        self.scratch.bound_steps(left);
        let done = self
            .engine
            .evaluate_with(&mut self.scratch, point, &mut self.outcomes);
        let (steps, enough) = self.scratch.steps();
        self.steps_left = left.saturating_sub(steps);
        self.is_complete &= enough;
        done.is_ok() && enough
    }

    pub(super) fn value(&mut self, point: &[f64], output: usize) -> Option<f64> {
        self.outputs(point).nth(output).flatten()
    }

    /// Returns at most `most` points of the input space: all combinations of a few values of each input or, if there
    /// are too many inputs for that, pseudo-random points, which are the same in every run.
    pub(super) fn points(&self, most: usize) -> Vec<Vec<f64>> {
        let count = self.values.len();
        let side = libm::pow(most as f64, 1.0 / count.max(1) as f64) as usize;
        if side >= 5 {
            let mut points: Vec<Vec<f64>> = Vec::from([Vec::new()]);
            for input in &self.model.inputs {
                let values = chosen(input, side);
                let longer = points.iter().flat_map(|point| {
                    values.iter().map(|&x| {
                        let mut point = point.clone();
                        point.push(x);
                        point
                    })
                });
                points = longer.collect();
            }
            return points;
        }
        // A linear congruential generator with the constants of Knuth's MMIX.
        let mut state: u64 = 1;
        let mut draw = |below: usize| {
            state = state
                .wrapping_mul(6_364_136_223_846_793_005)
                .wrapping_add(1_442_695_040_888_963_407);
            ((state >> 33) as usize) % below.max(1)
        };
        let mut point = || {
            let one = |values: &Vec<f64>| values.get(draw(values.len())).copied().unwrap_or(0.0);
            self.values.iter().map(one).collect()
        };
        (0..most).map(|_| point()).collect()
    }

    /// Returns lines parallel to the axis of an input, with the values of the outputs along them. Each line has a
    /// different combination of values of the other inputs.
    pub(super) fn lines(&mut self, input: usize) -> Vec<Line> {
        let along = self.values.get(input).cloned().unwrap_or_default();
        let count = (self.evaluations / (2 * along.len().max(1))).clamp(2, 400);
        let mut bases = self.points(count);
        for base in &mut bases {
            if let Some(value) = base.get_mut(input) {
                *value = 0.0;
            }
        }
        bases.sort_by(|a, b| a.partial_cmp(b).unwrap_or(core::cmp::Ordering::Equal));
        bases.dedup();
        let lines = bases.into_iter().map(|base| {
            let mut point = base.clone();
            let values = along.iter().map(|&x| {
                if let Some(value) = point.get_mut(input) {
                    *value = x;
                }
                (x, self.outputs(&point).collect())
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

/// The outputs along one input, with the other inputs fixed.
pub(super) struct Line {
    /// The values of the fixed inputs. The element of `input` has no meaning and is 0.
    pub(super) base: Vec<f64>,
    pub(super) input: usize,
    /// The values of the input, in ascending order, each with the values of all outputs at that point.
    pub(super) values: Vec<(f64, Vec<Option<f64>>)>,
}

/// Returns at most `most` values of an input: the parameters of its terms and the ends of its range, supplemented by
/// evenly spaced values.
fn chosen(input: &Variable, most: usize) -> Vec<f64> {
    let range = input.low..=input.high;
    let mut named: Vec<f64> = input
        .terms
        .iter()
        .flat_map(|term| axis::marks(&term.membership_function))
        .collect();
    named.retain(|x| range.contains(x));
    named.extend([input.low, input.high]);
    named.sort_by(f64::total_cmp);
    named.dedup();
    if named.len() >= most {
        return thin(&named, most);
    }
    let mut even = axis::values(input);
    even.retain(|x| !named.contains(x));
    let mut values = thin(&even, most - named.len());
    values.extend(named);
    values.sort_by(f64::total_cmp);
    values
}

/// Selects `most` of the values, with evenly spaced indices.
fn thin(values: &[f64], most: usize) -> Vec<f64> {
    let count = values.len();
    if count <= most {
        return values.to_vec();
    }
    let last = most.saturating_sub(1).max(1);
    let kept = (0..most).filter_map(|i| values.get(i * (count - 1) / last).copied());
    kept.collect()
}
