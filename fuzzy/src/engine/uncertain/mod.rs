//! Evaluation of uncertain inputs: intervals of outputs that contain every value for inputs inside given intervals.
//!
//! 1. The degrees of a term for all values in an interval lie between the smallest and the largest one, which are at the
//!    ends of the interval or at an extremum of the membership function.
//! 2. AND, OR and hedges never decrease when a degree increases, and NOT reverses the order. So the bounds of the firing
//!    strengths follow from the bounds of the degrees, as for interval type-2 terms.
//! 3. The bounds of an output follow from those of the firing strengths: by the type reduction for centroids and
//!    weighted outputs, and from the same two sets for other defuzzifiers.
//!
//! These bounds contain every value, but are too wide: they treat the degrees of the terms of an input as independent,
//! whereas `x IS low` and `x IS high` cannot both have a large degree. In smaller intervals the error is smaller. So the
//! intervals of the inputs are divided, always where the bound of an output is farthest out, until the bound is close to
//! a value that occurs, or [`MAX_BOXES`] is reached. Each step keeps the bounds valid.
//!
//! For many rule sets this is not needed, because the extremes are known to be at a few points: see `vertices.rs`.

use alloc::{collections::BinaryHeap, sync::Arc, vec, vec::Vec};
use core::cmp::Ordering;

use super::{Engine, EvaluateError, Outcome, Scratch};
use crate::model::chain;
use stage::{RangedScratch, RangedStage};
use vertices::Vertices;

mod degrees;
mod formula;
mod stage;
mod vertices;

/// The maximum number of boxes that are evaluated for each end of an output. A box is a part of the input intervals.
const MAX_BOXES: usize = 400;

/// The number of steps of integrations after which the inputs are not divided further. It bounds the time for sets of many
/// curved terms; all other rule sets stay far below it.
const MAX_STEPS: u64 = 20_000_000;

/// The search for a bound ends when the distance between the bound and a value that occurs is at most this fraction
/// of the width of the interval of all values that occurred.
const CLOSE: f64 = 0.005;

/// The distance by which both ends are moved outwards because of rounding, relative to the width of the output's range
/// or to the end itself, whichever is larger.
const ROUNDING: f64 = 1e-10;

/// The maximum number of uncertain inputs for which all corners are evaluated.
const MAX_CORNERS: usize = 4;

/// An interval of numbers.
///
/// # Example: a value with its half-width
/// ```
/// use fuzzy::engine::Interval;
///
/// assert_eq!(Interval::around(20.0, 0.5), Interval::new(19.5, 20.5));
/// assert_eq!(Interval::from(3.0), Interval::new(3.0, 3.0));
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Interval {
    /// The lower end.
    pub low: f64,
    /// The upper end.
    pub high: f64,
}

impl Interval {
    /// Creates the interval between two ends.
    #[must_use]
    pub fn new(low: f64, high: f64) -> Self {
        Interval { low, high }
    }

    /// Creates the interval around a value.
    #[must_use]
    pub fn around(value: f64, half_width: f64) -> Self {
        Interval::new(value - half_width, value + half_width)
    }

    /// Returns the distance between the ends.
    #[must_use]
    pub fn width(self) -> f64 {
        self.high - self.low
    }

    /// Returns whether a value is in the interval, ends included.
    #[must_use]
    pub fn contains(self, value: f64) -> bool {
        (self.low..=self.high).contains(&value)
    }

    fn middle(self) -> f64 {
        self.low + 0.5 * (self.high - self.low)
    }

    /// Returns the smallest interval that contains both.
    #[must_use]
    pub fn hull(self, other: Interval) -> Self {
        Interval::new(self.low.min(other.low), self.high.max(other.high))
    }

    /// Returns the interval with both ends clamped to a range.
    #[must_use]
    pub fn within(self, range: Interval) -> Self {
        let clamp = |end: f64| end.max(range.low).min(range.high);
        Interval::new(clamp(self.low), clamp(self.high))
    }
}

impl From<f64> for Interval {
    fn from(value: f64) -> Self {
        Interval::new(value, value)
    }
}

/// The values of an output for inputs that are intervals.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub struct IntervalOutcome {
    /// An interval that contains the values of the output for all inputs in their intervals. With interval type-2 terms,
    /// it also contains the interval of the output for each of these inputs. An end is infinite if a formula has no
    /// bound. `None` if the output has no value for any of these inputs.
    pub values: Option<Interval>,
    /// Whether the output may have no value for some of these inputs, because no rule fires.
    pub may_be_undefined: bool,
    /// Whether an interval of an input was partly outside its range and was clamped to it.
    pub clamped: bool,
}

/// An evaluator of uncertain inputs, created by [`Engine::enclosure`].
#[derive(Debug)]
pub struct Enclosure<'e> {
    engine: &'e Engine,
    stages: Vec<RangedStage>,
    vertices: Option<Vertices>,
}

/// Bounds of the values of an output.
#[derive(Debug, Clone, Copy, PartialEq)]
struct OutputBounds {
    values: Option<Interval>,
    may_be_undefined: bool,
}

impl OutputBounds {
    const UNDEFINED: OutputBounds = OutputBounds {
        values: None,
        may_be_undefined: true,
    };
}

/// The working memory of the search for the ends.
struct EndSearch<'s> {
    enclosure: &'s Enclosure<'s>,
    stages: Vec<RangedScratch>,
    known: Vec<OutputBounds>,
    engine: Scratch,
    outcomes: Vec<Outcome>,
    /// For each output, the smallest and the largest value that occurred so far.
    inner: Vec<Option<Interval>>,
}

/// A part of the input intervals: for each input, an interval inside the given one.
#[derive(Debug, Clone)]
struct InputBox {
    inputs: Vec<Interval>,
    known: OutputBounds,
    /// The result of [`IntervalEnd::of`] for the bounds of the output over this box, at the end that is searched
    /// for. The box with the largest value is divided first.
    urgency: f64,
    scores: Vec<f64>,
}

impl PartialEq for InputBox {
    fn eq(&self, other: &Self) -> bool {
        self.cmp(other) == Ordering::Equal
    }
}

impl Eq for InputBox {}

impl PartialOrd for InputBox {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

impl Ord for InputBox {
    fn cmp(&self, other: &Self) -> Ordering {
        self.urgency.total_cmp(&other.urgency)
    }
}

/// An end of an interval.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum IntervalEnd {
    Low,
    High,
}

impl IntervalEnd {
    /// Returns a number that is larger the farther out this end of an interval is: the upper end, or the negated lower
    /// end.
    fn of(self, values: Option<Interval>) -> f64 {
        match (values, self) {
            (None, _) => f64::NEG_INFINITY,
            (Some(values), IntervalEnd::Low) => -values.low,
            (Some(values), IntervalEnd::High) => values.high,
        }
    }
}

impl Engine {
    /// Prepares the evaluation of uncertain inputs.
    #[must_use]
    pub fn enclosure(&self) -> Enclosure<'_> {
        let (first, later) = chain::stages(&self.model);
        let stages = core::iter::once(&first).chain(&later);
        let stages: Vec<RangedStage> = stages.map(RangedStage::new).collect();
        Enclosure {
            engine: self,
            vertices: stages.first().map(|first| Vertices::new(self, first)),
            stages,
        }
    }

    /// Evaluates inputs of which only intervals are known, in the order of the model, and returns for each output an
    /// interval that contains every value for inputs inside these intervals.
    ///
    /// The interval is never narrower than the interval of the values that occur. It is usually at most a hundredth
    /// wider; with many uncertain inputs, and with activation methods, maxima or `samples`, it may be much wider. This
    /// prepares the evaluation each time: in loops use [`Engine::enclosure`].
    ///
    /// # Errors
    /// Fails like [`Engine::evaluate`], and if an end of an interval is not finite or the ends are in the wrong order.
    ///
    /// # Example: a temperature that is known to within 2 degrees
    /// ```
    /// use fuzzy::{Engine, Model, engine::Interval};
    ///
    /// let model: Model = "
    /// fuzzy: 1
    /// name: fan
    /// inputs: {heat: {range: [0, 40], partition: [low, high]}}
    /// outputs: {speed: {range: [0, 9], defuzzifier: weighted_average, terms: {slow: {constant: 0}, fast: {constant: 8}}}}
    /// rules: [IF heat IS low THEN speed IS slow, IF heat IS high THEN speed IS fast]
    /// ".parse()?;
    /// let engine = Engine::new(&model)?;
    /// let speed = engine.evaluate_interval(&[Interval::around(20.0, 2.0)])?[0];
    /// let values = speed.values.ok_or("no value")?;
    /// // The speed is a fifth of the temperature.
    /// assert!(values.low <= 3.6 && values.high >= 4.4 && values.width() < 0.81);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn evaluate_interval(
        &self,
        inputs: &[Interval],
    ) -> Result<Vec<IntervalOutcome>, EvaluateError> {
        self.enclosure().evaluate(inputs)
    }
}

impl Enclosure<'_> {
    /// Works like [`Engine::evaluate_interval`], but does not prepare the evaluation again.
    ///
    /// # Errors
    /// Fails like [`Engine::evaluate_interval`].
    pub fn evaluate(&self, inputs: &[Interval]) -> Result<Vec<IntervalOutcome>, EvaluateError> {
        let engine = self.engine;
        if inputs.len() != engine.inputs.len() {
            return Err(EvaluateError::WrongNumberOfInputs {
                expected: engine.inputs.len(),
                got: inputs.len(),
            });
        }
        let mut clamped = false;
        let mut whole = Vec::with_capacity(inputs.len());
        for (interval, input) in inputs.iter().zip(&engine.inputs) {
            if !interval.low.is_finite() || !interval.high.is_finite() {
                return Err(EvaluateError::InputNotFinite);
            }
            if interval.low > interval.high {
                return Err(EvaluateError::InvertedInterval {
                    input: Arc::clone(&input.name),
                });
            }
            let range = Interval::new(input.low, input.high);
            clamped |= !range.contains(interval.low) || !range.contains(interval.high);
            whole.push(interval.within(range));
        }
        let count = engine.outputs.len();
        let mut search = EndSearch {
            enclosure: self,
            stages: self.stages.iter().map(RangedStage::scratch).collect(),
            known: vec![OutputBounds::UNDEFINED; count],
            engine: engine.scratch(),
            outcomes: vec![Outcome::default(); count],
            inner: vec![None; count],
        };
        if whole.iter().all(|interval| interval.low == interval.high) {
            search.point(
                &whole
                    .iter()
                    .map(|interval| interval.low)
                    .collect::<Vec<_>>(),
            );
            let known = search.inner.iter().map(|values| OutputBounds {
                values: *values,
                may_be_undefined: values.is_none(),
            });
            search.known = known.collect();
        } else {
            let vertices = self.vertices.as_ref();
            let exact = vertices.and_then(|vertices| search.vertices(vertices, &whole));
            let exact = exact.unwrap_or_else(|| vec![None; count]);
            if exact.iter().any(Option::is_none) {
                search.corners(&whole);
            }
            let known = exact.into_iter().enumerate();
            search.known = known
                .map(|(output, exact)| match exact.map(|exact| exact.values) {
                    Some(Some(values)) => OutputBounds {
                        values: Some(search.rounded(output, values)),
                        may_be_undefined: false,
                    },
                    _ => search.enclose(output, &whole),
                })
                .collect();
        }
        let mut outcomes = Vec::with_capacity(count);
        for (known, output) in search.known.iter().zip(&engine.outputs) {
            if output.must_fire && known.values.is_none() {
                return Err(EvaluateError::NoRuleFired {
                    output: Arc::clone(&output.name),
                });
            }
            outcomes.push(IntervalOutcome {
                values: known.values,
                may_be_undefined: known.may_be_undefined,
                clamped,
            });
        }
        Ok(outcomes)
    }
}

impl EndSearch<'_> {
    /// Evaluates a point, and extends the intervals of the values that occurred.
    fn point(&mut self, inputs: &[f64]) {
        let engine = self.enclosure.engine;
        engine.outcomes(&mut self.engine, inputs, &mut self.outcomes);
        for (outcome, inner) in self.outcomes.iter().zip(&mut self.inner) {
            if let (Some(low), Some(high)) = (outcome.low(), outcome.high()) {
                let values = Interval::new(low, high);
                *inner = Some(inner.map_or(values, |inner| inner.hull(values)));
            }
        }
    }

    /// Evaluates the middle of a box of inputs, and its corners unless there are too many.
    fn corners(&mut self, inputs: &[Interval]) {
        let mut point: Vec<f64> = inputs.iter().map(|input| input.middle()).collect();
        self.point(&point);
        let is_uncertain = |input: &&usize| inputs.get(**input).is_some_and(|it| it.width() > 0.0);
        let all: Vec<usize> = (0..inputs.len()).collect();
        let uncertain: Vec<usize> = all.iter().filter(is_uncertain).copied().collect();
        if uncertain.len() > MAX_CORNERS {
            return;
        }
        for corner in 0..1_u32 << uncertain.len() {
            for (bit, input) in uncertain.iter().enumerate() {
                if let (Some(value), Some(interval)) = (point.get_mut(*input), inputs.get(*input)) {
                    *value = match corner >> bit & 1 {
                        0 => interval.low,
                        _ => interval.high,
                    };
                }
            }
            self.point(&point);
        }
    }

    /// Computes the bounds of an output over a box of inputs.
    fn part(&mut self, output: usize, end: IntervalEnd, inputs: Vec<Interval>) -> InputBox {
        let mut scores = vec![0.0; inputs.len()];
        for (stage, scratch) in self.enclosure.stages.iter().zip(&mut self.stages) {
            stage.enclose(&inputs, scratch, &mut self.known);
            stage.scores(scratch, &mut scores);
        }
        let inputs_of_engine = self.enclosure.engine.inputs.iter();
        for ((score, input), range) in scores.iter_mut().zip(&inputs).zip(inputs_of_engine) {
            *score = match input.width() > 1e-12 * (range.high - range.low) {
                // The width counts too, because linear functions and formulas read the value and not a degree.
                true => *score + 0.1 * input.width() / (range.high - range.low),
                false => 0.0,
            };
        }
        let known = self
            .known
            .get(output)
            .copied()
            .unwrap_or(OutputBounds::UNDEFINED);
        InputBox {
            inputs,
            known,
            urgency: end.of(known.values),
            scores,
        }
    }

    /// Returns the bounds of an output over all inputs.
    fn enclose(&mut self, output: usize, whole: &[Interval]) -> OutputBounds {
        let low = self.search(output, IntervalEnd::Low, whole);
        let high = self.search(output, IntervalEnd::High, whole);
        // Both searches divide the same inputs, so each of them may prove that the output is defined.
        let mut known = OutputBounds {
            values: None,
            may_be_undefined: low.may_be_undefined && high.may_be_undefined,
        };
        if let (Some(low), Some(high)) = (low.values, high.values) {
            let mut values = Interval::new(low.low, high.high);
            if let Some(Some(inner)) = self.inner.get(output) {
                values = values.hull(*inner);
            }
            known.values = Some(self.rounded(output, values));
        }
        known
    }

    /// Divides the inputs where an end of an output is farthest out. Returns the bounds of all parts together.
    fn search(&mut self, output: usize, end: IntervalEnd, whole: &[Interval]) -> OutputBounds {
        let mut parts = BinaryHeap::from([self.part(output, end, whole.to_vec())]);
        let mut count = 1;
        let steps = |stages: &[RangedScratch]| stages.iter().map(RangedScratch::steps).sum::<u64>();
        let before = steps(&self.stages);
        while count < MAX_BOXES && steps(&self.stages) - before < MAX_STEPS {
            let Some(mut worst) = parts.peek_mut() else {
                break;
            };
            let inner = self.inner.get(output).copied().flatten();
            let distance = worst.urgency - end.of(inner);
            let close = inner.map_or(0.0, |inner| CLOSE * inner.width());
            let scores = worst.scores.iter().copied().enumerate();
            let input = scores.max_by(|a, b| a.1.total_cmp(&b.1));
            let Some((input, _)) = input.filter(|(_, score)| *score > 0.0) else {
                break;
            };
            if distance <= close || worst.urgency == f64::NEG_INFINITY {
                break;
            }
            let inputs = core::mem::take(&mut worst.inputs);
            drop(alloc::collections::binary_heap::PeekMut::pop(worst));
            let Some(interval) = inputs.get(input).copied() else {
                break;
            };
            let middle = interval.middle();
            for half in [
                Interval::new(interval.low, middle),
                Interval::new(middle, interval.high),
            ] {
                let mut inputs = inputs.clone();
                if let Some(input) = inputs.get_mut(input) {
                    *input = half;
                }
                self.corners(&inputs);
                let part = self.part(output, end, inputs);
                parts.push(part);
                count += 1;
            }
        }
        let mut all = OutputBounds {
            values: None,
            may_be_undefined: false,
        };
        for part in &parts {
            all.may_be_undefined |= part.known.may_be_undefined;
            all.values = match (all.values, part.known.values) {
                (Some(a), Some(b)) => Some(a.hull(b)),
                (a, b) => a.or(b),
            };
        }
        all
    }

    /// Moves the ends outwards by the largest rounding error, but not out of the range of an output with `clamp`.
    fn rounded(&self, output: usize, values: Interval) -> Interval {
        let output = self.enclosure.engine.model.outputs.get(output);
        let (low, high) = output.map_or((0.0, 0.0), |output| {
            (output.variable.low, output.variable.high)
        });
        let error = |end: f64| ROUNDING * (high - low).max(end.abs());
        let wider = Interval::new(
            values.low - error(values.low),
            values.high + error(values.high),
        );
        match output.is_some_and(|output| output.clamp) {
            // A default value may be outside the range.
            true => wider.within(Interval::new(low, high)).hull(values),
            false => wider,
        }
    }
}

#[cfg(test)]
mod tests;
