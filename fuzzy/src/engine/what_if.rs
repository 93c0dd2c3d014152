//! The nearest changes in the result if one input changes.

use alloc::{string::String, vec::Vec};

use super::{Engine, EvaluateError};
use crate::{model::Variable, table::Outcome};

/// The number of evenly spaced steps over the range of an input. The corners of its terms are examined in addition.
const STEPS: usize = 200;

/// The nearest change of the result if one input changes and the others do not.
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[non_exhaustive]
pub struct Change {
    /// The input that changes.
    pub input: String,
    /// The value of the input at which the change takes effect.
    pub at: f64,
    /// The value `at` minus the current value of the input.
    pub by: f64,
    /// Whether the input decreases. Not serialised.
    #[cfg_attr(feature = "serde", serde(skip))]
    pub is_below: bool,
    /// The effect of the change.
    #[cfg_attr(feature = "serde", serde(flatten))]
    pub effect: Effect,
}

/// The effect of changing an input.
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[cfg_attr(feature = "serde", serde(tag = "effect", rename_all = "snake_case"))]
#[non_exhaustive]
pub enum Effect {
    /// A different term of the input has the largest degree; `None` if all degrees are 0.
    Term {
        /// The term.
        term: Option<String>,
    },
    /// A different rule is the dominant rule of an output.
    Rule {
        /// The name of the output.
        output: String,
        /// The index of the rule in the model, `None` if no rule fires; serialised as the rule number, which counts
        /// from 1.
        #[cfg_attr(feature = "serde", serde(serialize_with = "rule_number"))]
        #[cfg_attr(feature = "schema", schemars(with = "Option<usize>", range(min = 1)))]
        rule: Option<usize>,
        /// The value of the output at the changed input.
        value: Option<f64>,
    },
}

#[cfg(feature = "serde")]
fn rule_number<S: serde::Serializer>(rule: &Option<usize>, to: S) -> Result<S::Ok, S::Error> {
    serde::Serialize::serialize(&rule.map(|index| index + 1), to)
}

impl Engine {
    /// Returns, for each input, the nearest values below and above its current one at which a different term of the
    /// input has the largest degree, or a different rule is the dominant rule of an output. The other inputs keep their
    /// values.
    ///
    /// The search examines 200 evenly spaced steps over the range. A change that is reversed before the next step may
    /// be missed.
    ///
    /// # Errors
    /// `inputs` does not have one finite value per input.
    ///
    /// # Example: the temperature increase at which the fan becomes fast
    /// ```
    /// use fuzzy::{Engine, Model, engine::Effect};
    ///
    /// let model: Model = "
    /// fuzzy: 1
    /// name: fan
    /// inputs: {heat: {range: [0, 40], partition: [low, high]}}
    /// outputs: {speed: {range: [0, 9], partition: [slow, fast]}}
    /// rules: [IF heat IS low THEN speed IS slow, IF heat IS high THEN speed IS fast]
    /// ".parse()?;
    /// let changes = Engine::new(&model)?.what_if(&[15.0])?;
    /// let rule = changes.iter().find(|change| matches!(change.effect, Effect::Rule { rule: Some(1), .. })).unwrap();
    /// assert!((rule.at - 20.0).abs() < 1e-9 && (rule.by - 5.0).abs() < 1e-9);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn what_if(&self, inputs: &[f64]) -> Result<Vec<Change>, EvaluateError> {
        let now = self.outcomes_at(inputs)?;
        let mut found = Vec::new();
        let model = self.model();
        let outputs = model.outputs.iter().map(|output| &output.variable.name);
        let read: Vec<&str> = outputs.flat_map(|output| model.inputs_of(output)).collect();
        let variables = model.inputs.iter().enumerate();
        let variables = variables.filter(|(_, variable)| read.contains(&variable.name.as_str()));
        for (index, variable) in variables {
            let Some(value) = inputs.get(index) else {
                continue;
            };
            let value = value.clamp(variable.low, variable.high);
            let (below, above): (Vec<f64>, Vec<f64>) = places(variable)
                .into_iter()
                .partition(|place| *place < value);
            let below: Vec<f64> = below.into_iter().rev().collect();
            for (places, is_below) in [(below, true), (above, false)] {
                let search = ChangeSearch {
                    engine: self,
                    inputs,
                    index,
                    variable,
                    value,
                    is_below,
                    now: &now,
                };
                found.extend(search.term(&places));
                for output in 0..now.len() {
                    found.extend(search.rule(&places, output));
                }
            }
        }
        Ok(found)
    }
}

/// Returns the values of an input to examine, in ascending order: evenly spaced ones, and the corners of its terms with
/// their neighbouring numbers.
fn places(variable: &Variable) -> Vec<f64> {
    let (low, high) = (variable.low, variable.high);
    let even = (0..=STEPS).map(|i| {
        let part = i as f64 / STEPS as f64;
        low * (1.0 - part) + high * part
    });
    let terms = variable.terms.iter();
    let cuts = terms.flat_map(|term| term.membership_function.cuts());
    let cuts = cuts.flat_map(|x| [x.next_down(), x, x.next_up()]);
    let mut places: Vec<f64> = even
        .chain(cuts.filter(|x| (low..=high).contains(x)))
        .collect();
    places.sort_by(f64::total_cmp);
    places.dedup();
    places
}

/// A search from the value of an input towards one end of its range.
struct ChangeSearch<'a> {
    engine: &'a Engine,
    inputs: &'a [f64],
    index: usize,
    variable: &'a Variable,
    value: f64,
    is_below: bool,
    now: &'a [Outcome],
}

impl ChangeSearch<'_> {
    fn term(&self, places: &[f64]) -> Option<Change> {
        let strongest = |x: f64| {
            let terms = self.variable.terms.iter();
            let degrees = terms.map(|term| (term, term.membership(x)));
            let degrees = degrees.filter(|(_, degree)| *degree > 0.0);
            // The first of the terms with the largest degree.
            let strongest = degrees.reduce(|a, b| if b.1 > a.1 { b } else { a });
            strongest.map(|(term, _)| term.name.as_str())
        };
        let before = strongest(self.value);
        let at = self.first(places, |x| strongest(x) == before)?;
        let term = strongest(at).map(String::from);
        Some(self.change(at, Effect::Term { term }))
    }

    fn rule(&self, places: &[f64], output: usize) -> Option<Change> {
        let outcome = |x: f64| {
            let mut inputs = self.inputs.to_vec();
            *inputs.get_mut(self.index)? = x;
            self.engine.outcomes_at(&inputs).ok()?.get(output).copied()
        };
        let dominant = |x: f64| outcome(x).and_then(|outcome| outcome.dominant_rule);
        let before = self.now.get(output)?.dominant_rule;
        let at = self.first(places, |x| dominant(x) == before)?;
        let there = outcome(at)?;
        let output = self.engine.model().outputs.get(output)?;
        let effect = Effect::Rule {
            output: output.variable.name.clone(),
            rule: there.dominant_rule,
            value: there.value(),
        };
        Some(self.change(at, effect))
    }

    /// Returns the nearest value at which `same` is false, by bisection between two examined values.
    fn first(&self, places: &[f64], same: impl Fn(f64) -> bool) -> Option<f64> {
        let changed = places.iter().position(|x| !same(*x))?;
        let mut to = *places.get(changed)?;
        let last = changed.checked_sub(1).and_then(|last| places.get(last));
        let mut from = last.copied().unwrap_or(self.value);
        loop {
            let middle = 0.5 * (from + to);
            if middle == from || middle == to {
                return Some(to);
            }
            if same(middle) {
                from = middle;
            } else {
                to = middle;
            }
        }
    }

    fn change(&self, at: f64, effect: Effect) -> Change {
        Change {
            input: self.variable.name.clone(),
            at,
            by: at - self.value,
            is_below: self.is_below,
            effect,
        }
    }
}
