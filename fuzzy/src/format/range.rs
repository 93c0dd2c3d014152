//! Reading the range of a variable, also in other notations, which are then reported with the right one.

use alloc::{format, string::String, vec::Vec};
use core::ops::Range;

use crate::{
    diagnostic::Diagnostic,
    tree::{Fields, Node, Value},
};

pub(super) const HELP: &str = "write the minimum and the maximum, such as `range: [0, 1]`";

/// Returns the minimum and the maximum of `[0, 40]`.
pub(super) fn read(what: &str, node: &Node, findings: &mut Vec<Diagnostic>) -> Option<(f64, f64)> {
    let both = |[low, high]: [&str; 2]| format!("write `range: [{low}, {high}]`");
    let Value::List(ends) = &node.value else {
        let finding = node.unexpected(&format!("two numbers for the range of {what}"));
        let help = two_numbers(node).map(both).or_else(|| one_number(node));
        findings.push(finding.help(help.unwrap_or_else(|| HELP.into())));
        return None;
    };
    let [low, high] = ends.as_slice() else {
        let message = format!(
            "the range of {what} must be a list of 2 numbers, but has {}",
            ends.len()
        );
        let help = Node::list_advice(ends, 2).or_else(|| match ends.as_slice() {
            [only] => two_numbers(only).map(both).or_else(|| one_number(only)),
            numbers => smallest_and_largest(numbers).map(both),
        });
        let help = help.unwrap_or_else(|| HELP.into());
        findings.push(Diagnostic::error("wrong-type", node.span.clone(), message).help(help));
        return None;
    };
    let mut read = |node: &Node, end: &str, extreme: &str| {
        let before = findings.len();
        let number = node.finite(&format!("the {end} of the range of {what}"), findings);
        let finding = findings.get_mut(before);
        if let Some(finding) = finding.filter(|finding| finding.code == "not-finite") {
            finding.help = Some(format!("write the {extreme} value that you expect"));
        }
        number
    };
    let (low, high) = (
        read(low, "minimum", "smallest"),
        read(high, "maximum", "largest"),
    );
    Some((low?, high?))
}

/// Returns a suggestion for a range of one number, which is probably its maximum.
fn one_number(node: &Node) -> Option<String> {
    let text = node.as_number_text()?;
    let number = text.parse::<f64>().ok()?;
    let help = "write the minimum and the maximum, such as";
    (number.is_finite() && number > 0.0).then(|| format!("{help} `range: [0, {text}]`"))
}

/// Returns a finding for `min: 0` and `max: 40` in place of a range, and the position of the second key.
pub(super) fn two_keys(what: &str, fields: &Fields<'_>) -> Option<(Diagnostic, Range<usize>)> {
    if fields.entry("range").is_some() {
        return None;
    }
    let pairs = [
        ("min", "max"),
        ("minimum", "maximum"),
        ("low", "high"),
        ("from", "to"),
    ];
    let number_at = |key: &str| {
        let mut unknown = fields.unknown();
        let entry = unknown.find(|entry| entry.key.eq_ignore_ascii_case(key))?;
        Some((entry, entry.value.as_number_text()?))
    };
    pairs.into_iter().find_map(|(low, high)| {
        let ((low, from), (high, to)) = (number_at(low)?, number_at(high)?);
        let message = format!("unknown keys `{}` and `{}` in {what}", low.key, high.key);
        let finding = Diagnostic::error("unknown-key", low.key_span.clone(), message);
        let finding = finding.help(format!("write `range: [{from}, {to}]`"));
        Some((finding, high.key_span.clone()))
    })
}

/// Returns the smallest and the largest of at least two numbers, for example of `[start, stop, step]`.
fn smallest_and_largest(numbers: &[Node]) -> Option<[&str; 2]> {
    let numbers = numbers.iter().map(|node| {
        let text = node.as_number_text()?;
        Some((text.parse().ok()?, text))
    });
    let numbers: Vec<(f64, &str)> = numbers.collect::<Option<_>>()?;
    let order = |a: &&(f64, &str), b: &&(f64, &str)| a.0.total_cmp(&b.0);
    Some([
        numbers.iter().min_by(order)?.1,
        numbers.iter().max_by(order)?.1,
    ])
}

/// Returns a finding for a range without brackets in a mapping with braces, `range: 0, 40` or `range: (0, 40)`.
pub(super) fn split(what: &str, fields: &Fields<'_>) -> Option<Diagnostic> {
    let mut entries = fields.entries().iter();
    let range = entries.find(|entry| entry.key == "range")?;
    let next = entries.next().filter(|entry| entry.value.is_null())?;
    let low = range.value.as_text()?.trim_start_matches(['(', '[']);
    let high = next.key.trim_end_matches([')', ']']);
    let is_number = |text: &str| text.parse::<f64>().is_ok();
    (is_number(low) && is_number(high)).then(|| {
        let message = format!("the range of {what} is not a list of two numbers");
        let span = range.value.span.start..next.key_span.end;
        Diagnostic::error("wrong-type", span, message)
            .help(format!("write `range: [{low}, {high}]`"))
    })
}

/// Returns the numbers of a range in another notation: `0..40`, `0 - 40`, `{min: 0, max: 40}`.
fn two_numbers(node: &Node) -> Option<[&str; 2]> {
    let numbers: Vec<&str> = match &node.value {
        Value::Mapping(pairs) => pairs
            .iter()
            .filter_map(|(_, value)| value.as_number_text())
            .collect(),
        Value::Scalar(scalar) => {
            let separators = ["..", " - ", " to ", ",", ";", "-", " "];
            let mut separators = separators.iter();
            let (low, high) = separators.find_map(|sign| {
                let (low, high) = scalar
                    .text
                    .trim_matches(['(', ')', '[', ']'])
                    .split_once(sign)?;
                let is_number = |text: &str| text.trim().parse::<f64>().is_ok();
                (is_number(low) && is_number(high)).then_some((low.trim(), high.trim()))
            })?;
            Vec::from([low, high])
        }
        Value::List(_) => return None,
    };
    <[&str; 2]>::try_from(numbers).ok()
}
