//! What becomes of a text when a handle moves: the terms then, and the edits that make them.

use fuzzy::{
    format,
    model::{MembershipFunction, Term, Variable},
    tree::{Node, Value},
};

use super::{Grip, Place, rounded};
use crate::{Document, Edit, edited};

impl Place<'_> {
    /// The terms of the variable after a handle has moved.
    pub(super) fn moved(&self, grip: Grip, to: f64, degree: f64) -> Result<Vec<Term>, String> {
        let mut terms = self.variable.terms.clone();
        let shape = &self.term.membership_function;
        let changed = match grip {
            Grip::Peak => {
                let peaks = self.variable.partition_peaks().unwrap_or_default();
                let names = terms.iter().map(|term| term.name.as_str());
                let peaks = names.zip(peaks).enumerate();
                let peaks = peaks.map(|(i, (name, peak))| match i == self.index_of_term {
                    true => (name, to),
                    false => (name, peak),
                });
                let empty = Variable::new("", self.variable.low, self.variable.high);
                return Ok(empty.partition_at(peaks).terms);
            }
            Grip::Point(i) => {
                let MembershipFunction::Piecewise { points } = shape else {
                    return Err("there is no such point".into());
                };
                let mut points = points.clone();
                if let Some(point) = points.get_mut(i) {
                    *point = (to, rounded(degree / self.term.height, 2).clamp(0.0, 1.0));
                }
                MembershipFunction::Piecewise { points }
            }
            Grip::Place(parameter) | Grip::Width { parameter, .. } => {
                let values = shape.parameters().into_iter().map(|(_, _, value)| value);
                let mut values: Vec<f64> = values.collect();
                let value = match grip {
                    Grip::Width { place, times, .. } => {
                        let from = values.get(place).copied().unwrap_or(0.0);
                        let width = rounded(((to - from) / times).abs(), self.decimals());
                        width.max(self.step())
                    }
                    _ => to,
                };
                if let Some(number) = values.get_mut(parameter) {
                    *number = value;
                }
                let changed = shape.with_parameters(&values);
                changed.map_err(|error| error.to_string())?
            }
        };
        if let Some(term) = terms.get_mut(self.index_of_term) {
            term.membership_function = changed;
        }
        Ok(terms)
    }

    /// The edits of the numbers that a grip moves.
    pub(super) fn edits(&self, grip: Grip, terms: &[Term]) -> Result<Vec<Edit>, String> {
        let shape = terms
            .get(self.index_of_term)
            .map(|term| &term.membership_function);
        let change = |number: usize, value: f64| {
            let span = self.term_spans.numbers.get(number)?.clone();
            let text = written(value);
            Some(Edit { span, text })
        };
        let edits = match (grip, shape) {
            (Grip::Peak, _) => {
                let changed = Variable {
                    terms: terms.to_vec(),
                    ..self.variable.clone()
                };
                let peaks = changed.partition_peaks();
                let peaks = peaks.ok_or("the peaks of a partition rise from left to right")?;
                let peak = peaks.get(self.index_of_term).copied().unwrap_or_default();
                match self.term_spans.numbers.is_empty() {
                    true => self.spelt_out(&peaks),
                    false => change(0, peak).map(|edit| vec![edit]),
                }
            }
            (Grip::Point(i), Some(MembershipFunction::Piecewise { points })) => {
                let point = points.get(i).copied().unwrap_or_default();
                let edits = [change(2 * i, point.0), change(2 * i + 1, point.1)];
                edits.into_iter().collect()
            }
            (Grip::Place(parameter) | Grip::Width { parameter, .. }, Some(shape)) => {
                let value = shape
                    .parameters()
                    .get(parameter)
                    .map(|(_, _, value)| *value);
                value.and_then(|value| Some(vec![change(parameter, value)?]))
            }
            _ => None,
        };
        edits.ok_or_else(|| "the number is not in the text".into())
    }

    /// An even partition `[low, high]` with its peaks: `{low: 0, high: 1}`.
    fn spelt_out(&self, peaks: &[f64]) -> Option<Vec<Edit>> {
        let list = self.spans.partition.clone();
        let is_flow = self.text.get(list.clone())?.starts_with('[');
        let mut edits = Vec::new();
        let bracket = |at: usize, text: &str| Edit {
            span: at..at + 1,
            text: text.into(),
        };
        if is_flow {
            edits.push(bracket(list.start, "{"));
        }
        for (term, peak) in self.spans.terms.iter().zip(peaks) {
            if !is_flow {
                let dash = self.text.get(..term.name.start)?.trim_end().len();
                let dash = dash.checked_sub(1)?..dash;
                (self.text.get(dash.clone())? == "-").then_some(())?;
                edits.push(Edit {
                    span: dash,
                    text: " ".into(),
                });
            }
            edits.push(Edit {
                span: term.name.end..term.name.end,
                text: format!(": {}", written(*peak)),
            });
        }
        if is_flow {
            edits.push(bracket(list.end.checked_sub(1)?, "}"));
        }
        Some(edits)
    }

    /// The edits, where the text then means what is wanted and nothing else.
    pub(super) fn verified(
        &self,
        document: &Document,
        terms: Vec<Term>,
        edits: Vec<Edit>,
    ) -> Result<Vec<Edit>, String> {
        let mut wanted = self.rules.model.clone();
        let inputs = wanted.inputs.len();
        let variable = match self.index.checked_sub(inputs) {
            None => wanted.inputs.get_mut(self.index),
            Some(output) => wanted
                .outputs
                .get_mut(output)
                .map(|output| &mut output.variable),
        };
        if let Some(variable) = variable {
            variable.terms = terms;
        }
        let text = edited(document.text(), &edits);
        let read = fuzzy::yaml::read(&text).ok();
        let read = read.and_then(|tree| format::read_partly(&tree));
        // As documents: a range that cannot be read is no number, which equals nothing.
        let means = |model: &fuzzy::Model| serde_json::to_value(model).ok();
        match read.is_some_and(|read| means(&read.model) == means(&wanted)) {
            true => Ok(edits),
            false => Err("the number stands for others too, or is written in a way of its own; change it in the text".into()),
        }
    }
}

/// A number as rule sets write it.
fn written(number: f64) -> String {
    match Node::number(number).value {
        Value::Scalar(scalar) => scalar.text,
        _ => String::new(),
    }
}
