//! Reading the short forms of interval type-2 terms: `{triangle: [0, 2, 4], blur: 0.1}`,
//! `{triangle: [0, 2, 4], lower_scale: 0.8, lower_lag: 0.2}` and `{gaussian: {mean: [2, 3], sd: 1}}`.

use alloc::{
    format,
    string::{String, ToString},
    vec::Vec,
};

use super::{TermSpans, VariableSpans};
use crate::{
    diagnostic::Diagnostic,
    model::{
        LowerFunction, MembershipFunction, Term, Variable,
        footprint::{self, Footprint, NoFootprint},
    },
    tree::{Fields, Node, Value, percentage_advice},
};

/// The keys beside a membership function that define the lower membership function of the term.
pub(super) const KEYS: [&str; 3] = ["blur", "lower_scale", "lower_lag"];

/// The suggestion for membership functions without a short form.
pub(super) const BOTH: &str = "write both membership functions: `{upper: {triangle: [0, 2, 4]}, lower: {triangle: [1, 2, 3]}}`";

/// Adds the lower membership function to a term, if one of [`KEYS`] is in its mapping. `None` if the keys are invalid.
pub(super) fn extended(
    what: &str,
    term: Term,
    fields: &Fields<'_>,
    variable: &Variable,
    spans: &mut TermSpans,
    findings: &mut Vec<Diagnostic>,
) -> Option<Term> {
    let [blur, scale, lag] = KEYS.map(|key| fields.entry(key));
    let Some(first) = blur.or(scale).or(lag) else {
        return Some(term);
    };
    if let (Some(_), Some(second)) = (blur, scale.or(lag)) {
        let message = format!("{what} has both `blur` and `{}`", second.key);
        let help = "keep only one of the two: each defines the lower membership function";
        let finding = Diagnostic::error("duplicate-key", second.key_span.clone(), message);
        findings.push(finding.help(help));
        return None;
    }
    if term.membership_function.validate().is_err() {
        // Invalid parameters are reported by the validation.
        return Some(term);
    }
    if let Some(entry) = blur {
        let share = share(
            &format!("`blur` of {what}"),
            entry.value,
            variable,
            findings,
        )?;
        return blurred(what, &term, share, variable, entry.value, spans, findings);
    }
    let scale = match scale {
        None => 1.0,
        Some(entry) => number_in(
            &format!("`lower_scale` of {what}"),
            entry.value,
            ("greater than 0 and at most 1", |x| x > 0.0 && x <= 1.0),
            findings,
        )?,
    };
    let lag = match lag {
        None => (0.0, 0.0),
        Some(entry) => lags(what, entry.value, findings)?,
    };
    match footprint::lagging(&term.membership_function, scale, lag) {
        Ok(lower) => Some(with(term.clone(), (term.membership_function, lower), spans)),
        Err(error) => {
            findings.push(refused(what, "`lower_lag`", &error, 1.0, first.value));
            None
        }
    }
}

/// Returns a term with its footprint. The height is that of the ordinary term.
fn with(term: Term, (upper, lower): Footprint, spans: &mut TermSpans) -> Term {
    if upper != term.membership_function {
        // The numbers in the text are not those of the upper membership function.
        spans.numbers.clear();
    }
    let lower_spans = TermSpans {
        numbers: Vec::new(),
        names: Vec::new(),
        ..spans.clone()
    };
    spans.lower = Some(lower_spans.into());
    Term {
        membership_function: upper,
        lower: Some(LowerFunction {
            height: term.height * lower.height,
            ..lower
        }),
        ..term
    }
}

fn blurred(
    what: &str,
    term: &Term,
    share: f64,
    variable: &Variable,
    node: &Node,
    spans: &mut TermSpans,
    findings: &mut Vec<Diagnostic>,
) -> Option<Term> {
    let range = (variable.low, variable.high);
    let width = range.1 - range.0;
    if !(width > 0.0 && width.is_finite()) {
        // An invalid range is reported separately.
        return None;
    }
    let function = &term.membership_function;
    match footprint::blurred(function, share * width, range, &variable.name) {
        Ok(footprint) => Some(with(term.clone(), footprint, spans)),
        Err(error) => {
            findings.push(refused(what, "`blur`", &error, width, node));
            None
        }
    }
}

/// Blurs all terms of a partition.
pub(super) fn blur_partition(
    what: &str,
    node: &Node,
    variable: &mut Variable,
    spans: &mut VariableSpans,
    findings: &mut Vec<Diagnostic>,
) {
    let Some(share) = share(&format!("`blur` of {what}"), node, variable, findings) else {
        return;
    };
    for i in 0..variable.terms.len() {
        let Some(term) = variable.terms.get(i) else {
            return;
        };
        let Some(here) = spans.terms.get_mut(i).filter(|spans| !spans.unread) else {
            continue;
        };
        let what = format!("term `{}` of {what}", term.name);
        let numbers = here.numbers.clone();
        let blurred = blurred(&what, term, share, variable, node, here, findings);
        here.numbers = numbers;
        let (Some(blurred), Some(term)) = (blurred, variable.terms.get_mut(i)) else {
            // One error is enough: it states the limit that applies to this term.
            here.unread = true;
            return;
        };
        *term = blurred;
    }
}

/// Reads `{mean: [2, 3], sd: [1, 1.5]}`: a Gaussian whose mean, standard deviation or both are intervals. `None` if
/// `node` is another value, so that it is read as an ordinary Gaussian.
pub(super) fn uncertain_gaussian(
    what: &str,
    node: &Node,
    variable: &Variable,
    spans: &mut TermSpans,
    findings: &mut Vec<Diagnostic>,
) -> Option<Option<Footprint>> {
    const HELP: &str = "write `gaussian: {mean: [2, 3], sd: 1}` for an uncertain mean, `{mean: 2, sd: [1, 2]}` for an uncertain deviation";
    let is_list = |key: &str| {
        let value = node.child(key).map(|node| &node.value);
        matches!(value, Some(Value::List(_)))
    };
    if !is_list("mean") && !is_list("sd") {
        return None;
    }
    let before = findings.len();
    let what = format!("`gaussian` of {what}");
    let fields = node.fields(&what, &["mean", "sd"], HELP, findings)?;
    let mut ends = |key: &str| {
        let node = fields.require(key, HELP, findings)?;
        let what = format!("`{key}` of {what}");
        spans.parameters.push(node.span.clone());
        let nodes = match &node.value {
            Value::List(items) => items.as_slice(),
            _ => core::slice::from_ref(node),
        };
        let numbers: Vec<f64> = nodes
            .iter()
            .filter_map(|node| node.finite(&what, findings))
            .collect();
        let wrong = match numbers[..] {
            _ if numbers.len() < nodes.len() => return None,
            [only] if nodes.len() == 1 && !matches!(node.value, Value::List(_)) => {
                return Some((only, only));
            }
            [low, high] if low <= high => return Some((low, high)),
            [low, high] => format!("{what} begins at {low} and ends at {high}"),
            _ => format!("{what} takes a number or 2 numbers, not {}", nodes.len()),
        };
        findings.push(
            Diagnostic::error("wrong-parameter", node.span.clone(), wrong)
                .help("write the minimum first, then the maximum"),
        );
        None
    };
    let (mean, sd) = (ends("mean"), ends("sd"));
    if let (Some((low, high)), Some(node)) = (sd, fields.get("sd"))
        && low <= 0.0
    {
        let message = format!("`sd` of {what} is {low}, but must be greater than 0");
        let number = if low == high { "1" } else { "[1, 2]" };
        findings.push(
            Diagnostic::error("wrong-parameter", node.span.clone(), message)
                .help(format!("write for example `sd: {number}`")),
        );
    }
    if findings.len() > before {
        return Some(None);
    }
    let found = footprint::uncertain_gaussian(mean?, sd?, &variable.name);
    if let Err(error) = &found {
        findings.push(refused(&what, "an interval", error, 1.0, node));
    }
    Some(found.ok())
}

/// Returns an interval type-2 term for a footprint that is not based on an ordinary membership function.
pub(super) fn of_footprint(
    name: String,
    footprint: Footprint,
    height: f64,
    spans: &mut TermSpans,
) -> Term {
    let term = Term {
        name,
        membership_function: MembershipFunction::Constant { value: 1.0 },
        height,
        lower: None,
    };
    with(term, footprint, spans)
}

/// Reports a key of [`KEYS`] inside of `upper` or `lower`.
pub(super) fn misplaced(what: &str, fields: &Fields<'_>, findings: &mut Vec<Diagnostic>) -> bool {
    let mut entries = fields.entries().iter();
    let Some(entry) = entries.find(|entry| KEYS.contains(&entry.key)) else {
        return false;
    };
    let message = format!("{what} has `{}`", entry.key);
    let help = format!(
        "`{key}` replaces `upper` and `lower`: `{{triangle: [0, 2, 4], {key}: 0.1}}`",
        key = entry.key
    );
    let finding = Diagnostic::error("unknown-key", entry.key_span.clone(), message);
    findings.push(finding.help(help));
    true
}

/// Reads a distance as a fraction of the range.
fn share(
    what: &str,
    node: &Node,
    variable: &Variable,
    findings: &mut Vec<Diagnostic>,
) -> Option<f64> {
    let before = findings.len();
    let found = number_in(what, node, BELOW_1, findings);
    let distance = node
        .as_number_text()
        .and_then(|text| text.parse::<f64>().ok());
    let width = variable.high - variable.low;
    if let (Some(distance), Some(finding)) = (distance, findings.get_mut(before))
        && distance > 0.0
        && distance < width
    {
        finding.help = Some(format!(
            "`blur` is a fraction of the width of the range: for a blur of {distance} in a range of width {width}, write `{}`",
            rounded(distance / width)
        ));
    }
    found
}

/// Reads one lag for both flanks, or one for each.
fn lags(what: &str, node: &Node, findings: &mut Vec<Diagnostic>) -> Option<(f64, f64)> {
    let what = format!("`lower_lag` of {what}");
    let mut lag = |node: &Node| number_in(&what, node, BELOW_1, findings);
    match &node.value {
        Value::List(items) => match items.as_slice() {
            [left, right] => {
                let (left, right) = (lag(left), lag(right));
                Some((left?, right?))
            }
            _ => {
                let message = format!("{what} takes a number or 2 numbers, not {}", items.len());
                findings.push(
                    Diagnostic::error("wrong-type", node.span.clone(), message)
                        .help("write one for both flanks, `lower_lag: 0.2`, or the left and the right one, `[0.2, 0.3]`"),
                );
                None
            }
        },
        _ => lag(node).map(|lag| (lag, lag)),
    }
}

/// A description of a range of numbers, and a function that tests whether a number is in the range.
type NumberRange = (&'static str, fn(f64) -> bool);

const BELOW_1: NumberRange = ("at least 0 and less than 1", |x| (0.0..1.0).contains(&x));

fn number_in(
    what: &str,
    node: &Node,
    (range, valid): NumberRange,
    findings: &mut Vec<Diagnostic>,
) -> Option<f64> {
    let number = node.share(what, findings)?;
    if valid(number) {
        return Some(number);
    }
    let message = format!("{what} is {number}, but must be {range}");
    let mut finding = Diagnostic::error("wrong-parameter", node.span.clone(), message);
    finding.help =
        Some(percentage_advice(number).unwrap_or_else(|| "write for example `0.1`".into()));
    findings.push(finding);
    None
}

fn refused(what: &str, key: &str, error: &NoFootprint, width: f64, node: &Node) -> Diagnostic {
    match error {
        NoFootprint::Unsupported(shape) => {
            let message =
                format!("{key} is not supported for {shape}, the membership function of {what}");
            Diagnostic::error("wrong-parameter", node.span.clone(), message).help(BOTH)
        }
        NoFootprint::TooLarge(distance) => {
            let message = format!(
                "{key} is too large for {what}: its lower membership function would be 0 everywhere"
            );
            let most = distance / width;
            let help = match most > 0.0 {
                true => format!("write a number below {}", rounded(most)),
                false => BOTH.to_string(),
            };
            Diagnostic::error("wrong-parameter", node.span.clone(), message).help(help)
        }
    }
}

/// Rounds down to 3 digits.
fn rounded(x: f64) -> f64 {
    let digits = libm::pow(10.0, 2.0 - libm::floor(libm::log10(x)));
    let rounded = libm::floor(x * digits * (1.0 + 1e-12)) / digits;
    if rounded > 0.0 && rounded.is_finite() {
        rounded
    } else {
        x
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Model;

    fn read(variable: &str) -> Result<Variable, Vec<(String, String)>> {
        let text = format!(
            "{{fuzzy: 1, name: n, inputs: {{x: {{range: [0, 40], {variable}}}}}, outputs: {{y: {{range: [0, 1], partition: [a, b]}}}}, rules: [IF x IS any THEN y IS a]}}"
        );
        match crate::yaml::parse(&text) {
            Ok(document) => {
                let model = document.model;
                let written: Model = crate::yaml::to_string(&model).parse().unwrap();
                assert_eq!(written, model);
                Ok(model.inputs[0].clone())
            }
            Err(findings) => Err(findings
                .0
                .into_iter()
                .map(|finding| (finding.message, finding.help.unwrap_or_default()))
                .collect()),
        }
    }

    #[test]
    fn short_forms_equal_the_upper_and_lower_pair() {
        let equal = |short: &str, pair: &str| {
            assert_eq!(read(short).unwrap(), read(pair).unwrap(), "{short}");
        };
        equal(
            "terms: {warm: {triangle: [4, 8, 16], height: 0.8, blur: 0.0375}}",
            "terms: {warm: {upper: {trapezoid: [2.5, 6.5, 9.5, 17.5], height: 0.8}, lower: {triangle: [5.5, 8.5, 14.5], height: 0.6000000000000001}}}",
        );
        equal(
            "terms: {warm: {triangle: [4, 8, 16], lower_scale: 0.5, lower_lag: [0.25, 0.5]}}",
            "terms: {warm: {upper: {triangle: [4, 8, 16]}, lower: {triangle: [5, 8, 12], height: 0.5}}}",
        );
        equal(
            "terms: {warm: {bell: {center: 20, width: 4, slope: 2}, lower_scale: 0.5}}",
            "terms: {warm: {upper: {bell: {center: 20, width: 4, slope: 2}}, lower: {bell: {center: 20, width: 4, slope: 2}, height: 0.5}}}",
        );
        equal(
            "terms: {warm: {gaussian: {mean: 20, sd: [2, 3]}, height: 0.5}}",
            "terms: {warm: {upper: {gaussian: {mean: 20, sd: 3}, height: 0.5}, lower: {gaussian: {mean: 20, sd: 2}, height: 0.5}}}",
        );
        equal(
            "terms: {warm: {gaussian: {mean: [18, 22], sd: 3}}}",
            "terms: {warm: {gaussian: {mean: 20, sd: 3}, blur: 0.05}}",
        );
        equal(
            "terms: {warm: {gaussian: {mean: [18, 22], sd: 3}}}",
            "terms: {warm: {upper: {gaussian2: {left_mean: 18, left_sd: 3, right_mean: 22, right_sd: 3}}, lower: {function: 'exp(-((abs(x - 20) + 2) / 3)^2 / 2)'}}}",
        );
        equal(
            "partition: {cold: 10, mild: 20, hot: 30}, blur: 0.05",
            "terms: {cold: {left_shoulder: [10, 20], blur: 0.05}, mild: {triangle: [10, 20, 30], blur: 0.05}, hot: {right_shoulder: [20, 30], blur: 0.05}}",
        );
        equal(
            "partition: [cold, mild, hot], blur: 0.25",
            "terms: {cold: {upper: {left_shoulder: [10, 30]}, lower: {left_shoulder: [-10, 10]}}, mild: {upper: {trapezoid: [-10, 10, 30, 50]}, lower: {triangle: [10, 20, 30], height: 0.5}}, hot: {upper: {right_shoulder: [10, 30]}, lower: {right_shoulder: [30, 50]}}}",
        );
    }

    #[test]
    fn mistakes_are_reported_once() {
        let refused = |variable: &str, message: &str, help: &str| {
            let findings = read(variable).unwrap_err();
            assert_eq!(
                findings,
                [(message.to_owned(), help.to_owned())],
                "{variable}"
            );
        };
        refused(
            "terms: {warm: {triangle: [4, 8, 16], blur: 0.15}}",
            "`blur` is too large for term `warm` of input `x`: its lower membership function would be 0 everywhere",
            "write a number below 0.15",
        );
        refused(
            "partition: [cold, mild, hot], blur: 0.6",
            "`blur` is too large for term `mild` of input `x`: its lower membership function would be 0 everywhere",
            "write a number below 0.5",
        );
        refused(
            "terms: {warm: {spike: {center: 4, width: 5}, blur: 0.1}}",
            "`blur` is not supported for a `spike`, the membership function of term `warm` of input `x`",
            BOTH,
        );
        refused(
            "terms: {warm: {triangle: [4, 8, 16], blur: 0.1, lower_lag: 0.1}}",
            "term `warm` of input `x` has both `blur` and `lower_lag`",
            "keep only one of the two: each defines the lower membership function",
        );
        refused(
            "terms: {warm: {triangle: [4, 8, 16], lower_scale: 1.5}}",
            "`lower_scale` of term `warm` of input `x` is 1.5, but must be greater than 0 and at most 1",
            "write for example `0.1`",
        );
        refused(
            "terms: {warm: {gaussian: {mean: [22, 18], sd: 3}}}",
            "`mean` of `gaussian` of term `warm` of input `x` begins at 22 and ends at 18",
            "write the minimum first, then the maximum",
        );
        refused(
            "terms: {warm: {gaussian: {mean: 22, sd: [0, 1]}}}",
            "`sd` of `gaussian` of term `warm` of input `x` is 0, but must be greater than 0",
            "write for example `sd: [1, 2]`",
        );
        refused(
            "terms: {warm: {upper: {triangle: [4, 8, 16], blur: 0.1}, lower: {triangle: [5, 8, 12]}}}",
            "the upper membership function of term `warm` of input `x` has `blur`",
            "`blur` replaces `upper` and `lower`: `{triangle: [0, 2, 4], blur: 0.1}`",
        );
        refused(
            "terms: {warm: {triangle: [4, 8, 16]}}, blur: 0.1",
            "input `x` has `blur` but no `partition`",
            "write `blur` in each term: `{triangle: [0, 2, 4], blur: 0.1}`",
        );
    }
}
