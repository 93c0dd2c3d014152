//! The terms of a variable after a handle was moved, and the verification that edits result in exactly these terms.

use fuzzy::{
    format,
    model::{MembershipFunction, Term, Variable},
};

use super::{Grip, Place, rounded};
use crate::{Document, Edit, edited};

impl Place<'_> {
    /// The terms of the variable after a handle was moved.
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
            Grip::Limit => {
                let mut limits = self.variable.step_limits().unwrap_or_default();
                if let Some(limit) = limits.get_mut(self.index_of_term) {
                    *limit = to;
                }
                let last = terms.last().map_or("", |term| term.name.as_str());
                let names = terms.iter().map(|term| term.name.as_str());
                let empty = Variable::new("", self.variable.low, self.variable.high);
                return Ok(empty.steps(names.zip(limits), last).terms);
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

    /// Returns the edits if the edited text has exactly the intended meaning.
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
        // The models are compared as JSON, because an unreadable range is NaN, which does not equal itself.
        let means = |model: &fuzzy::Model| serde_json::to_value(model).ok();
        match read.is_some_and(|read| means(&read.model) == means(&wanted)) {
            true => Ok(edits),
            false => Err("the number is shared with other places or written in an unusual form; change it in the text".into()),
        }
    }
}
