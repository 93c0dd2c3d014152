//! Terms in a file: membership functions with heights, and interval type-2 terms.

use alloc::{
    format,
    string::{String, ToString},
    vec::Vec,
};

use super::{TermSpans, VariableSpans, footprints, shapes};
use crate::{
    diagnostic::Diagnostic,
    model::{LowerFunction, MembershipFunction, Term, Variable, footprint::Footprint},
    tree::{Entry, Fields, Node, Value},
};

const TERM_HELP: &str = "write a membership function, such as `{triangle: [0, 1, 2]}`";

/// Reads `{low: {triangle: [0, 1, 2], height: 0.8}}`.
pub(super) fn terms(
    what: &str,
    node: &Node,
    variable: &mut Variable,
    spans: &mut VariableSpans,
    findings: &mut Vec<Diagnostic>,
) {
    let Value::Mapping(_) = &node.value else {
        let names = match &node.value {
            Value::List(items) => items.iter().filter_map(Node::as_text).collect(),
            _ => Vec::new(),
        };
        let first = names.first().copied().unwrap_or("low");
        let all = match names.len() {
            0 | 1 => "low, high".into(),
            _ => names.join(", "),
        };
        let finding = node.unexpected(&format!("a mapping for the terms of {what}"));
        findings.push(finding.help(format!(
            "for even spacing write `partition: [{all}]`, otherwise give each term a membership function: `terms: {{{first}: {{triangle: [0, 1, 2]}}, ...}}`"
        )));
        return;
    };
    let entries = node.entries(what, "term", "", findings).unwrap_or_default();
    // An entry with a repeated name is rejected. Its author probably meant another name, which rules may use, so
    // unknown terms are not reported.
    spans.terms_unread = entries.len() < node.children();
    for entry in &entries {
        let mut here = TermSpans {
            name: entry.key_span.clone(),
            ..TermSpans::default()
        };
        let before = findings.len();
        let term = term(what, entry, variable, &mut here, findings);
        // For example `none: 0` beside `some: {constant: 5}`.
        let computed = ["constant", "linear", "function"];
        let is_computed =
            |other: &Entry<'_>| computed.iter().any(|key| other.value.child(key).is_some());
        if let Some(number) = entry.value.as_number_text()
            && entries.iter().any(is_computed)
            && let Some(finding) = findings.get_mut(before)
        {
            finding.help = Some(format!("write `{}: {{constant: {number}}}`", entry.key));
        }
        if let Some(number) = entry.value.as_number_text()
            && let (low, high) = (variable.low, variable.high)
            && number
                .parse()
                .is_ok_and(|number| low <= number && number <= high)
            && entries
                .iter()
                .any(|other| matches!(other.value.value, Value::Mapping(_)))
            && !entries.iter().any(is_computed)
            && let Some(finding) = findings.get_mut(before)
        {
            finding.help = Some(format!(
                "write a membership function, such as `{}: {{triangle: [{low}, {number}, {high}]}}`",
                entry.key
            ));
        }
        here.unread = term.is_none();
        variable
            .terms
            .push(term.unwrap_or_else(|| unread(entry.key)));
        spans.terms.push(here);
    }
    if !node.span.is_empty() {
        findings.extend(reversed(what, variable, spans));
    }
}

/// Returns a note if terms are written from right to left, because their shoulders or the signs of their slopes may be
/// exchanged. The caller omits trees without positions, because their formats may sort keys.
fn reversed(what: &str, variable: &Variable, spans: &VariableSpans) -> Option<Diagnostic> {
    const FEWEST: usize = 3;
    let shapes = || variable.terms.iter().map(|term| &term.membership_function);
    let (first, last) = (shapes().next()?, shapes().next_back()?);
    let is_read = spans.terms.iter().all(|term| !term.unread) && variable.low < variable.high;
    let are_ends =
        first.is_monotone() && last.is_monotone() && shapes().all(|it| it.number().is_none());
    if !is_read || !are_ends || variable.terms.len() < FEWEST {
        return None;
    }
    if !shapes()
        .map(|shape| variable.peak(shape))
        .is_sorted_by(|left, right| left > right)
    {
        return None;
    }
    let (name, other) = (&variable.terms.first()?.name, &variable.terms.last()?.name);
    let message = format!(
        "the terms of {what} are written from right to left: `{name}` is highest on the right, `{other}` on the left"
    );
    let finding = Diagnostic::note(
        "inverted-parameters",
        spans.terms.first()?.name.clone(),
        message,
    );
    let hint = match first {
        MembershipFunction::Sigmoid { .. } => {
            "a `sigmoid` with a negative slope is highest on the left"
        }
        _ => "a `left_shoulder` is 1 on the left, a `right_shoulder` on the right",
    };
    Some(finding.help(format!(
        "write the terms from left to right; if the shapes are wrong, correct them: {hint}"
    )))
}

fn term(
    what: &str,
    entry: &Entry<'_>,
    variable: &Variable,
    spans: &mut TermSpans,
    findings: &mut Vec<Diagnostic>,
) -> Option<Term> {
    let term = format!("term `{}` of {what}", entry.key);
    let Value::Mapping(pairs) = &entry.value.value else {
        let expected = format!("a membership function for {term}");
        let finding = entry.value.unexpected(&expected);
        let numbers = entry.value.to_line();
        let items = match &entry.value.value {
            Value::List(items) => items.as_slice(),
            _ => &[],
        };
        let has_functions = items.iter().any(|item| item.children() > 0);
        findings.push(finding.help(match items {
            [upper, lower] if has_functions => format!(
                "label the two membership functions `upper` and `lower`: `{{upper: {}, lower: {}}}`",
                upper.to_line(),
                lower.to_line()
            ),
            _ if has_functions => footprints::BOTH.into(),
            [_, _] => format!(
                "name the membership function: `left_shoulder: {numbers}`, `right_shoulder: {numbers}` or `rectangle: {numbers}`"
            ),
            [_, _, _] => {
                format!("name the membership function: `{}: {{triangle: {numbers}}}`", entry.key)
            }
            [_, _, _, _] => {
                format!("name the membership function: `{}: {{trapezoid: {numbers}}}`", entry.key)
            }
            _ => TERM_HELP.into(),
        }));
        return None;
    };
    // The valid keys depend on the membership function, so all keys are accepted here and checked when that function is
    // read.
    let keys = keys_of(pairs);
    let fields = entry.fields(&term, &keys, TERM_HELP, findings)?;
    let name = entry.key.to_string();
    if ["upper", "lower"].iter().any(|key| keys.contains(key)) {
        return interval(&term, name, &fields, spans, findings);
    }
    if let Some(gaussian) = fields.get("gaussian")
        && let Some(footprint) =
            footprints::uncertain_gaussian(&term, gaussian, variable, spans, findings)
    {
        return uncertain(&term, name, &fields, footprint, spans, findings);
    }
    let (membership_function, height) = function(&term, &fields, spans, findings)?;
    let ordinary = Term {
        name,
        membership_function,
        height,
        lower: None,
    };
    footprints::extended(&term, ordinary, &fields, variable, spans, findings)
}

/// Returns the term of a Gaussian with intervals. The only other key that its mapping may contain is `height`.
fn uncertain(
    term: &str,
    name: String,
    fields: &Fields<'_>,
    footprint: Option<Footprint>,
    spans: &mut TermSpans,
    findings: &mut Vec<Diagnostic>,
) -> Option<Term> {
    let mut others = fields.entries().iter();
    if let Some(other) = others.find(|entry| !["gaussian", "height"].contains(&entry.key)) {
        let message = format!(
            "{term} has both `{}` and a gaussian with intervals",
            other.key
        );
        let help =
            "remove one: the intervals already define the upper and the lower membership function";
        let finding = Diagnostic::error("duplicate-key", other.key_span.clone(), message);
        findings.push(finding.help(help));
        return None;
    }
    let height = height(term, fields, spans, findings);
    Some(footprints::of_footprint(name, footprint?, height?, spans))
}

fn keys_of(pairs: &[(Node, Node)]) -> Vec<&str> {
    pairs.iter().filter_map(|(key, _)| key.as_text()).collect()
}

/// Reads `{triangle: [0, 1, 2], height: 0.8}`: a membership function and its height.
fn function(
    what: &str,
    fields: &Fields<'_>,
    spans: &mut TermSpans,
    findings: &mut Vec<Diagnostic>,
) -> Option<(MembershipFunction, f64)> {
    let height = height(what, fields, spans, findings);
    let membership_function = shapes::read(what, fields, spans, findings);
    Some((membership_function?, height?))
}

fn height(
    what: &str,
    fields: &Fields<'_>,
    spans: &mut TermSpans,
    findings: &mut Vec<Diagnostic>,
) -> Option<f64> {
    fields.get("height").map_or(Some(1.0), |node| {
        spans.height = node.span.clone();
        node.share(&format!("the height of {what}"), findings)
    })
}

/// Reads `{upper: {triangle: [0, 2, 4]}, lower: {triangle: [1, 2, 3], height: 0.8}}`: an interval type-2 term.
fn interval(
    term: &str,
    name: String,
    fields: &Fields<'_>,
    spans: &mut TermSpans,
    findings: &mut Vec<Diagnostic>,
) -> Option<Term> {
    let mut others = fields.entries().iter();
    let other = others.find(|entry| !["upper", "lower"].contains(&entry.key));
    if let Some(other) = other {
        let message = format!(
            "{term} cannot have `{}` outside of `upper` and `lower`",
            other.key
        );
        let help = match other.key {
            "height" => format!(
                "move `height: {}` into `upper`, into `lower`, or into both",
                other.value.to_line()
            ),
            _ => footprints::BOTH.into(),
        };
        let finding = Diagnostic::error("unknown-key", other.key_span.clone(), message);
        findings.push(finding.help(help));
    }
    let missing = |key: &str| {
        format!("add the {key} membership function, such as `{key}: {{triangle: [0, 2, 4]}}`")
    };
    let upper = fields.require("upper", &missing("upper"), findings);
    let lower = fields.require("lower", &missing("lower"), findings);
    let mut lower_spans = TermSpans {
        name: spans.name.clone(),
        ..TermSpans::default()
    };
    let beside: Vec<&Node> = upper.into_iter().chain(lower).collect();
    let mut read = |which: &str, node: Option<&Node>, spans: &mut TermSpans| {
        let what = format!("the {which} membership function of {term}");
        let node = node?;
        let Value::Mapping(pairs) = &node.value else {
            // The other membership function probably has the same shape.
            let shape = beside.iter().find_map(|other| match &other.value {
                Value::Mapping(pairs) => keys_of(pairs).first().copied(),
                _ => None,
            });
            let shape = shape.unwrap_or("triangle");
            let help = format!(
                "name the membership function: `{which}: {{{shape}: {}}}`",
                node.to_line()
            );
            findings.push(node.unexpected(&what).help(help));
            return None;
        };
        let fields = node.fields(&what, &keys_of(pairs), footprints::BOTH, findings)?;
        if footprints::misplaced(&what, &fields, findings) {
            return None;
        }
        function(&what, &fields, spans, findings)
    };
    let upper = read("upper", upper, spans);
    let lower = read("lower", lower, &mut lower_spans);
    spans.names.extend(lower_spans.names.iter().cloned());
    spans.lower = Some(lower_spans.into());
    let ((membership_function, height), lower) = (upper?, lower?);
    other.is_none().then_some(Term {
        name,
        membership_function,
        height,
        lower: Some(LowerFunction {
            membership_function: lower.0,
            height: lower.1,
        }),
    })
}

/// Returns a term whose membership function cannot be read. Its name is known, so that rules that use it are not
/// reported.
pub(super) fn unread(name: &str) -> Term {
    Term {
        name: String::from(name),
        membership_function: MembershipFunction::Constant { value: 1.0 },
        height: 1.0,
        lower: None,
    }
}
