//! Changes the range, the unit and the terms of a variable in a text. Comments and layout are preserved. The edited text is
//! parsed again to verify that it has no new error and that nothing else changed.

mod similar;
#[cfg(test)]
mod tests;

use std::ops::Range;

use fuzzy::{
    Model,
    diagnostic::Severity,
    format::{PartialModel, VariableSpans, shape_text},
    model::{MembershipFunction, Term, Variable},
    tree::{Node, Value},
    yaml,
};

use crate::{
    Edit,
    document::{Document, partial},
    edited, numbers,
    structure::{
        UNREADABLE, end, inserted, readable, removed, trimmed, variable_node, variables, written,
    },
};

pub use similar::SHAPES;
use similar::similar;

/// A term as shown in a form.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct TermFields {
    /// The shape, such as `triangle`; `peak` in a partition and `limit` in `steps`.
    pub shape: String,
    /// The parameters without brackets: `0, 2, 4`.
    pub parameters: String,
    /// The names of the parameters; empty for shapes without a fixed number of them.
    pub names: Vec<&'static str>,
    /// Whether [`set_parameters`] can change the term. An interval type-2 term and the last term of `steps` can be
    /// edited only as text.
    pub is_editable: bool,
    /// Whether [`set_shape`] can change the term.
    pub can_change_shape: bool,
}

/// Returns the fields of a term; `None` if there is no such term.
pub fn fields(document: &Document, variable: usize, term: usize) -> Option<TermFields> {
    let (known, spans) = place(document.rules()?, variable)?;
    let of = known.terms.get(term)?;
    let fixed = |shape: &str, number: Option<f64>| TermFields {
        shape: shape.into(),
        parameters: number.map(written).unwrap_or_default(),
        names: Vec::new(),
        is_editable: number.is_some(),
        can_change_shape: false,
    };
    if let Some(lower) = &of.lower {
        let upper = with_height(&of.membership_function, of.height);
        let lower = with_height(&lower.membership_function, lower.height);
        return Some(TermFields {
            parameters: format!("upper {upper}; lower {lower}"),
            ..fixed("interval type-2", None)
        });
    }
    if !spans.partition.is_empty() {
        let peaks = known.partition_peaks();
        return Some(fixed("peak", peaks.and_then(|all| all.get(term).copied())));
    }
    if !spans.steps.is_empty() {
        let limits = known.step_limits();
        return Some(fixed(
            "limit",
            limits.and_then(|all| all.get(term).copied()),
        ));
    }
    let text = shape_text(&of.membership_function);
    let (shape, value) = text.split_once(": ").unwrap_or((&text, ""));
    let parameters = of.membership_function.parameters();
    let numbers: Vec<String> = parameters
        .iter()
        .map(|(.., value)| written(*value))
        .collect();
    let is_number = ["constant", "linear"].contains(&shape);
    Some(TermFields {
        shape: shape.into(),
        parameters: match numbers.is_empty() {
            true => value.into(),
            false => numbers.join(", "),
        },
        names: parameters.iter().map(|(name, ..)| *name).collect(),
        is_editable: true,
        can_change_shape: !is_number,
    })
}

/// Formats a membership function: `triangle: [0, 2, 4], height: 0.9`.
fn with_height(shape: &MembershipFunction, height: f64) -> String {
    match height == 1.0 {
        true => shape_text(shape),
        false => format!("{}, height: {}", shape_text(shape), written(height)),
    }
}

/// Returns the edits that change the range of a variable.
///
/// # Errors
/// The reason why the range cannot be changed.
pub fn set_range(
    document: &Document,
    variable: usize,
    (low, high): (f64, f64),
) -> Result<Vec<Edit>, String> {
    let rules = readable(document)?;
    let node = variable_node(document, rules, variable).ok_or(NO_VARIABLE)?;
    if !(low.is_finite() && high.is_finite() && low < high) {
        return Err("the range needs two numbers, the smaller one first".into());
    }
    let range = node.child("range").ok_or(UNREADABLE)?;
    let text = document.text();
    let ends = [low, high];
    let edits = match &range.value {
        Value::List(items) if items.len() == 2 => items
            .iter()
            .zip(ends)
            .filter(|(item, end)| number_of(item) != Some(*end))
            .map(|(item, end)| replaced(trimmed(text, item), written(end)))
            .collect(),
        _ => {
            let ends = ends.map(written).join(", ");
            vec![replaced(trimmed(text, range), format!("[{ends}]"))]
        }
    };
    verified(document, rules, edits, variable)
}

/// Returns the edits that change the unit of a variable; an empty `unit` removes it.
///
/// # Errors
/// The reason why the unit cannot be changed.
pub fn set_unit(document: &Document, variable: usize, unit: &str) -> Result<Vec<Edit>, String> {
    let rules = readable(document)?;
    let node = variable_node(document, rules, variable).ok_or(NO_VARIABLE)?;
    let Value::Mapping(pairs) = &node.value else {
        return Err(UNREADABLE.into());
    };
    let index = |key: &str| {
        pairs
            .iter()
            .position(|(name, _)| name.as_text() == Some(key))
    };
    let (text, unit) = (document.text(), unit.trim());
    let line = yaml::to_line(&Node::text(unit));
    let edit = match (index("unit"), unit.is_empty()) {
        (None, true) => return Ok(Vec::new()),
        (Some(at), true) => removed(text, node, at),
        (Some(at), false) => pairs
            .get(at)
            .map(|(_, value)| replaced(trimmed(text, value), line)),
        (None, false) => {
            let at = index("range").unwrap_or(pairs.len());
            inserted(text, node, at, &format!("unit: {line}"))
        }
    };
    verified(document, rules, vec![edit.ok_or(UNREADABLE)?], variable)
}

/// Returns the edits that change the parameters of a term, which are given as numbers separated by commas or in the
/// notation of the text. In a partition, the only parameter is the peak; in `steps`, the limit.
///
/// # Errors
/// The reason why the parameters cannot be changed.
pub fn set_parameters(
    document: &Document,
    (variable, term): (usize, usize),
    to: &str,
) -> Result<Vec<Edit>, String> {
    let rules = readable(document)?;
    let (known, spans) = place(rules, variable).ok_or(NO_VARIABLE)?;
    let now = fields(document, variable, term).ok_or(NO_TERM)?;
    if !now.is_editable {
        return Err(only_in_text(&now));
    }
    let to = to.trim();
    if ["peak", "limit"].contains(&now.shape.as_str()) {
        let number = to.parse().ok().filter(|number: &f64| number.is_finite());
        let number = number.ok_or_else(|| format!("`{to}` is not a number"))?;
        let terms = with_place(known, term, number).ok_or_else(|| {
            let (name, shape) = (known.terms.get(term).map_or("", |t| &t.name), &now.shape);
            format!("the {shape} of `{name}` must be between its neighbours and in the range, but is {number}")
        })?;
        let edits = numbers::of_terms(document.text(), known, spans, &terms).ok_or(UNREADABLE)?;
        return verified(document, rules, edits, variable);
    }
    let (shape, names) = (&now.shape, &now.names);
    let value = match names.len() {
        0 | 1 => to.to_owned(),
        _ if to.starts_with('{') => to.to_owned(),
        count => {
            let values = to.trim_matches(['[', ']']).split(',').map(str::trim);
            let values: Vec<&str> = values.collect();
            if values.len() != count {
                let (names, given) = (names.join(", "), values.len());
                return Err(format!(
                    "the {shape} takes {count} numbers, not {given}: {names}"
                ));
            }
            let named = names.iter().zip(&values);
            match is_list(known, term) {
                true => format!("[{}]", values.join(", ")),
                false => format!(
                    "{{{}}}",
                    named
                        .map(|(n, v)| format!("{n}: {v}"))
                        .collect::<Vec<_>>()
                        .join(", ")
                ),
            }
        }
    };
    written_shape(
        document,
        rules,
        (variable, term),
        &format!("{}: {value}", now.shape),
    )
}

/// Returns the edits that give a term one of [`SHAPES`] that covers about the same part of the range.
///
/// # Errors
/// The reason why the shape cannot be changed.
pub fn set_shape(
    document: &Document,
    (variable, term): (usize, usize),
    shape: &str,
) -> Result<Vec<Edit>, String> {
    let rules = readable(document)?;
    let (known, _) = place(rules, variable).ok_or(NO_VARIABLE)?;
    let now = fields(document, variable, term).ok_or(NO_TERM)?;
    if !now.can_change_shape {
        return Err(only_in_text(&now));
    }
    let of = known.terms.get(term).ok_or(NO_TERM)?;
    let similar = similar(of, known, shape)
        .ok_or_else(|| format!("`{shape}` is not one of the shapes {}", SHAPES.join(", ")))?;
    written_shape(document, rules, (variable, term), &shape_text(&similar))
}

const NO_VARIABLE: &str = "there is no such variable";
const NO_TERM: &str = "there is no such term";

fn only_in_text(term: &TermFields) -> String {
    format!("a term of this kind ({}) is edited in the text", term.shape)
}

fn place(rules: &PartialModel, variable: usize) -> Option<(&Variable, &VariableSpans)> {
    let spans = rules.spans.inputs.iter().chain(&rules.spans.outputs);
    variables(rules).zip(spans).nth(variable)
}

/// The terms of a partition or of steps after the peak or the limit of one of them changed.
fn with_place(known: &Variable, term: usize, number: f64) -> Option<Vec<Term>> {
    let names = || known.terms.iter().map(|term| term.name.as_str());
    let empty = || Variable::new("", known.low, known.high);
    if let Some(mut peaks) = known.partition_peaks() {
        *peaks.get_mut(term)? = number;
        let made = empty().partition_at(names().zip(peaks));
        return made.partition_peaks().map(|_| made.terms);
    }
    let mut limits = known.step_limits()?;
    *limits.get_mut(term)? = number;
    let made = empty().steps(names().zip(limits), known.terms.last()?.name.as_str());
    made.step_limits().map(|_| made.terms)
}

/// Whether the parameters of a term are written as a list.
fn is_list(known: &Variable, term: usize) -> bool {
    let shape = known
        .terms
        .get(term)
        .map(|term| shape_text(&term.membership_function));
    shape.is_some_and(|text| text.contains(": ["))
}

/// Returns the edits that replace the membership function of a term. If only numbers differ, only they are replaced.
fn written_shape(
    document: &Document,
    rules: &PartialModel,
    (variable, term): (usize, usize),
    shape: &str,
) -> Result<Vec<Edit>, String> {
    let (known, spans) = place(rules, variable).ok_or(NO_VARIABLE)?;
    let text = document.text();
    let node = variable_node(document, rules, variable).ok_or(UNREADABLE)?;
    let terms = node.child("terms").ok_or(UNREADABLE)?;
    let own = match &terms.value {
        Value::Mapping(pairs) => pairs.get(term).map(|(_, node)| node),
        Value::List(items) => items.get(term),
        Value::Scalar(_) => None,
    };
    let Some(Value::Mapping(pairs)) = own.map(|node| &node.value) else {
        return Err(UNREADABLE.into());
    };
    let before = fields(document, variable, term).ok_or(NO_TERM)?.shape;
    let pair = pairs.iter().find(|(key, _)| key.as_text() == Some(&before));
    let (key, value) = pair.ok_or(UNREADABLE)?;
    let span = key.span.start..end(text, value);
    let whole = verified(
        document,
        rules,
        vec![replaced(span, shape.into())],
        variable,
    )?;
    let after = partial(&fuzzy::Source::new(edited(text, &whole)));
    let after = after.as_ref().and_then(|after| place(after, variable));
    let is_same = shape.starts_with(&format!("{before}: "));
    let small = after
        .filter(|_| is_same)
        .and_then(|(after, _)| numbers::of_terms(text, known, spans, &after.terms))
        .filter(|small| {
            let small = partial(&fuzzy::Source::new(edited(text, small)));
            let small = small.as_ref().and_then(|small| place(small, variable));
            small.map(|(variable, _)| variable) == after.map(|(variable, _)| variable)
        });
    Ok(small.unwrap_or(whole))
}

/// Returns the edits if the edited text has no new error and only this variable changed.
fn verified(
    document: &Document,
    rules: &PartialModel,
    edits: Vec<Edit>,
    variable: usize,
) -> Result<Vec<Edit>, String> {
    let source = fuzzy::Source::new(edited(document.text(), &edits));
    if let Err(findings) = source.engine() {
        let known = document.source().engine().err();
        let is_new = |message: &str| {
            let mut known = known.iter().flat_map(|known| &known.0);
            !known.any(|known| known.message == message)
        };
        let mut errors = findings
            .0
            .iter()
            .filter(|one| one.severity == Severity::Error);
        if let Some(error) = errors.find(|error| is_new(&error.message)) {
            let help = error.help.iter().map(|help| format!("; {help}"));
            return Err(error.message.clone() + &help.collect::<String>());
        }
    }
    // The models are compared as JSON, because an unreadable range is NaN, which does not equal itself.
    let means = |model: &Model| serde_json::to_value(model).ok();
    let mut after = partial(&source).ok_or(UNREADABLE)?.model;
    let before = &rules.model;
    let inputs = before.inputs.len();
    let swapped = match variable.checked_sub(inputs) {
        None => after
            .inputs
            .get_mut(variable)
            .zip(before.inputs.get(variable)),
        Some(output) => {
            let after = after
                .outputs
                .get_mut(output)
                .map(|output| &mut output.variable);
            after.zip(before.outputs.get(output).map(|output| &output.variable))
        }
    };
    let (changed, old) = swapped.ok_or(UNREADABLE)?;
    let names = |of: &Variable| {
        let terms = of.terms.iter().map(|term| term.name.clone());
        terms.chain([of.name.clone()]).collect::<Vec<_>>()
    };
    let keeps_names = names(changed) == names(old);
    changed.clone_from(old);
    match keeps_names && means(&after) == means(before) {
        true => Ok(edits),
        false => Err(UNREADABLE.into()),
    }
}

fn replaced(span: Range<usize>, text: String) -> Edit {
    Edit { span, text }
}

fn number_of(node: &Node) -> Option<f64> {
    match &node.value {
        Value::Scalar(scalar) => scalar.as_number(),
        _ => None,
    }
}
