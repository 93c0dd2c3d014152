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

const TERM_HELP: &str = "write one: `{triangle: [0, 1, 2]}`";

/// Reads `{low: {triangle: [0, 1, 2], height: 0.8}}`.
pub(super) fn terms(
    what: &str,
    node: &Node,
    variable: &mut Variable,
    spans: &mut VariableSpans,
    findings: &mut Vec<Diagnostic>,
) {
    let help =
        "write `terms: {low: {triangle: [0, 1, 2]}}`, or `partition: [low, high]` for even spacing";
    let Some(entries) = node.entries(what, "term", help, findings) else {
        return;
    };
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
        here.unread = term.is_none();
        variable
            .terms
            .push(term.unwrap_or_else(|| unread(entry.key)));
        spans.terms.push(here);
    }
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
        findings.push(finding.help(match &entry.value.value {
            Value::List(items) if items.iter().any(|item| matches!(item.value, Value::Mapping(_))) => {
                "name both: `{upper: {triangle: [0, 2, 4]}, lower: {triangle: [1, 2, 3]}}`"
            }
            Value::List(items) if items.len() == 4 => "name it: `{trapezoid: [0, 1, 2, 3]}`",
            Value::List(_) => "name it: `{triangle: [0, 1, 2]}`",
            Value::Scalar(scalar) if scalar.as_number().is_some() => {
                "numbers without a membership function are peaks: `partition: {low: 0, high: 10}` in place of `terms`; a term is a membership function: `{triangle: [0, 1, 2]}`"
            }
            _ => TERM_HELP,
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
    const HELP: &str = "write both membership functions: `{upper: {triangle: [0, 2, 4]}, lower: {triangle: [1, 2, 3]}}`";
    let mut others = fields.entries().iter();
    let other = others.find(|entry| !["upper", "lower"].contains(&entry.key));
    if let Some(other) = other {
        let message = format!("{term} has `{}` beside `upper` and `lower`", other.key);
        let help = "`upper` and `lower` each contain a membership function and its height: `{upper: {triangle: [0, 2, 4]}, lower: {triangle: [1, 2, 3], height: 0.8}}`";
        let finding = Diagnostic::error("unknown-key", other.key_span.clone(), message);
        findings.push(finding.help(help));
    }
    let upper = fields.require("upper", HELP, findings);
    let lower = fields.require("lower", HELP, findings);
    let mut lower_spans = TermSpans {
        name: spans.name.clone(),
        ..TermSpans::default()
    };
    let mut read = |which: &str, node: Option<&Node>, spans: &mut TermSpans| {
        let what = format!("the {which} membership function of {term}");
        let node = node?;
        let Value::Mapping(pairs) = &node.value else {
            findings.push(node.unexpected(&what).help(HELP));
            return None;
        };
        let fields = node.fields(&what, &keys_of(pairs), HELP, findings)?;
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
