//! Changes numbers of a text in place: the parameters of membership functions, and the weights of rules. Comments
//! and layout are preserved.

use std::ops::Range;

use fuzzy::{
    Model,
    format::{Document, TermSpans, VariableSpans},
    model::{MembershipFunction, Term, Variable},
    tree::{Node, Value},
};

use crate::Edit;

/// The edits that replace the numbers of the rule set in a text by the numbers of `wanted`. `None` if a number that
/// must change does not occur in the text. Nothing else is compared, so the meaning of the edited text must be
/// verified.
pub(crate) fn of_model(text: &str, document: &Document, wanted: &Model) -> Option<Vec<Edit>> {
    let mut edits = Vec::new();
    let spans = document.spans.inputs.iter().chain(&document.spans.outputs);
    let pairs = document
        .model
        .variables()
        .zip(wanted.variables())
        .zip(spans);
    for ((before, after), spans) in pairs {
        edits.extend(of_terms(text, before, spans, &after.terms)?);
    }
    let rules = document.model.rules.iter().zip(&wanted.rules);
    for ((before, after), spans) in rules.zip(&document.spans.rules) {
        let weight = after.rule.weight;
        if before.rule.weight == weight {
            continue;
        }
        edits.push(Edit {
            span: spans.weight.clone(),
            text: match spans.weight.is_empty() {
                true => format!(" WITH {}", written(weight)),
                false => written(weight),
            },
        });
    }
    Some(edits)
}

/// The edits that replace the numbers of a variable in a text by the numbers of `terms`. `None` if a number that must
/// change does not occur in the text.
pub(crate) fn of_terms(
    text: &str,
    variable: &Variable,
    spans: &VariableSpans,
    terms: &[Term],
) -> Option<Vec<Edit>> {
    if variable.terms == terms {
        return Some(Vec::new());
    }
    let mut edits = Vec::new();
    if !spans.steps.is_empty() {
        let moved = Variable {
            terms: terms.to_vec(),
            ..variable.clone()
        };
        let limits = variable
            .step_limits()?
            .into_iter()
            .zip(moved.step_limits()?);
        for ((before, after), spans) in limits.zip(&spans.terms) {
            if before != after {
                edits.push(changed(text, spans, 0, after)?);
            }
        }
        return Some(edits);
    }
    if spans.partition.is_empty() {
        for ((before, after), spans) in variable.terms.iter().zip(terms).zip(&spans.terms) {
            let [before, after] = [before, after].map(|term| numbers(&term.membership_function));
            for (i, (before, after)) in before.into_iter().zip(after).enumerate() {
                if before != after {
                    edits.push(changed(text, spans, i, after)?);
                }
            }
        }
        return Some(edits);
    }
    let moved = Variable {
        terms: terms.to_vec(),
        ..variable.clone()
    };
    let (before, after) = (variable.partition_peaks()?, moved.partition_peaks()?);
    if spans.terms.iter().all(|term| term.numbers.is_empty()) {
        return spelt_out(text, spans, &after);
    }
    for ((before, after), spans) in before.iter().zip(&after).zip(&spans.terms) {
        if before != after {
            edits.push(changed(text, spans, 0, *after)?);
        }
    }
    Some(edits)
}

/// The numbers of a shape, in the order of [`TermSpans::numbers`].
fn numbers(shape: &MembershipFunction) -> Vec<f64> {
    match shape {
        MembershipFunction::Piecewise { points } => points
            .iter()
            .flat_map(|(x, degree)| [*x, *degree])
            .collect(),
        MembershipFunction::Linear {
            coefficients,
            constant,
        } => {
            let numbers = coefficients.iter().map(|(_, number)| *number);
            numbers.chain([*constant]).collect()
        }
        shape => shape
            .parameters()
            .iter()
            .map(|(.., value)| *value)
            .collect(),
    }
}

fn changed(text: &str, spans: &TermSpans, number: usize, value: f64) -> Option<Edit> {
    let span = spans.numbers.get(number)?.clone();
    match span.is_empty() {
        true => constant(text, spans, value),
        false => Some(Edit {
            span,
            text: written(value),
        }),
    }
}

/// The edit that adds a constant, before the first coefficient, to a linear function that has none in the text.
fn constant(text: &str, spans: &TermSpans, value: f64) -> Option<Edit> {
    let start = spans.names.first()?.span.start;
    let line = text.get(..start)?.rsplit('\n').next()?;
    let is_block = line.trim().is_empty();
    let constant = format!("constant: {}", written(value));
    Some(Edit {
        span: start..start,
        text: match is_block {
            true => format!("{constant}\n{line}"),
            false => format!("{constant}, "),
        },
    })
}

/// Converts an even partition such as `[low, high]` to a partition with explicit peaks: `{low: 0, high: 1}`.
fn spelt_out(text: &str, spans: &VariableSpans, peaks: &[f64]) -> Option<Vec<Edit>> {
    let list = spans.partition.clone();
    let is_flow = text.get(list.clone())?.starts_with('[');
    let mut edits = Vec::new();
    let replaced = |span: Range<usize>, text: &str| Edit {
        span,
        text: text.into(),
    };
    if is_flow {
        edits.push(replaced(list.start..list.start + 1, "{"));
    }
    for (term, peak) in spans.terms.iter().zip(peaks) {
        if !is_flow {
            let dash = text.get(..term.name.start)?.trim_end().len();
            let dash = dash.checked_sub(1)?..dash;
            (text.get(dash.clone())? == "-").then_some(())?;
            edits.push(replaced(dash, " "));
        }
        let peak = format!(": {}", written(*peak));
        edits.push(replaced(term.name.end..term.name.end, &peak));
    }
    if is_flow {
        edits.push(replaced(list.end.checked_sub(1)?..list.end, "}"));
    }
    Some(edits)
}

/// A number in the syntax of rule sets.
fn written(number: f64) -> String {
    match Node::number(number).value {
        Value::Scalar(scalar) => scalar.text,
        _ => String::new(),
    }
}
