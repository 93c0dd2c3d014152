//! Reads terms of FLL: `NAME Shape PARAMETER...`, with a height after the parameters.

use fuzzy::{
    diagnostic::nearest,
    format::TermSpans,
    model::{MembershipFunction, Term},
};

use crate::{Format, formula, model_draft::ModelDraft, shapes};

/// Shapes with a variable number of parameters.
const OTHERS: [&str; 5] = ["Discrete", "Constant", "Linear", "Function", "Binary"];

/// Reads `NAME Shape PARAMETER...`.
pub(super) fn read(
    draft: &mut ModelDraft<'_>,
    written: &str,
    inputs: &[&str],
    own: Option<&str>,
) -> Option<(Term, TermSpans)> {
    match written.split_once(char::is_whitespace) {
        Some((name, shape)) => of_shape(draft, name, shape.trim(), inputs, own),
        None => {
            let message = format!("`{written}` is not a term");
            let help = "write a name, a shape and its parameters: `term: low Triangle 0 1 2`";
            draft.error("no-term", written, message, help);
            None
        }
    }
}

/// Reads a term from `Shape PARAMETER...`. `own` is the variable that a formula calls `x`, if the term is a fuzzy set.
pub(crate) fn of_shape(
    draft: &mut ModelDraft<'_>,
    name: &str,
    written: &str,
    inputs: &[&str],
    own: Option<&str>,
) -> Option<(Term, TermSpans)> {
    let (shape, rest) = written
        .split_once(char::is_whitespace)
        .unwrap_or((written, ""));
    let mut spans = TermSpans::default();
    spans.name = draft.span(name);
    if shape.eq_ignore_ascii_case("Function") {
        let membership_function = formula::read(draft, &formula::words(rest), own)?;
        let term = Term {
            name: name.to_owned(),
            membership_function,
            height: 1.0,
            lower: None,
        };
        return Some((term, spans));
    }
    let mut numbers = vec![];
    let words: Vec<&str> = rest.split_whitespace().collect();
    for word in &words {
        numbers.push(draft.number(word)?);
        spans.parameters.push(draft.span(word));
    }
    let (function, used) = match shape {
        "Discrete" => points(&numbers),
        "Constant" => (
            MembershipFunction::Constant {
                value: *numbers.first().unwrap_or(&f64::NAN),
            },
            1,
        ),
        "Linear" => (shapes::linear(&numbers, inputs), numbers.len()),
        "Binary" => (binary(draft, &numbers, shape)?, 2),
        _ => {
            let Some((known, count)) = shapes::named(Format::Fll, shape) else {
                let help = match nearest(shape, shapes::names(Format::Fll).chain(OTHERS)) {
                    Some(near) => format!("did you mean `{near}`?"),
                    None => "see fuzzylite's list of terms".into(),
                };
                let message = format!("unknown shape `{shape}`");
                draft.error("unknown-shape", shape, message, &help);
                return None;
            };
            let own = numbers.get(..count).unwrap_or(&numbers);
            if !draft.is_finite(known, own, &words) {
                return None;
            }
            (shapes::read(Format::Fll, known, own)?, count)
        }
    };
    if numbers.len() < used || numbers.len() > used + 1 {
        let message = format!(
            "`{shape}` has {used} parameters and a height, found {} number{}",
            numbers.len(),
            if numbers.len() == 1 { "" } else { "s" }
        );
        let help = match shapes::named(Format::Fll, shape) {
            Some((known, _)) => {
                format!("write `{shape} {}`", shapes::parameters(Format::Fll, known))
            }
            None => "write the numbers of the shape, and no others".into(),
        };
        draft.error("parameter-count", shape, message, &help);
        return None;
    }
    let height = numbers.get(used).copied().unwrap_or(1.0);
    if let Some(span) = spans.parameters.get(used) {
        spans.height = span.clone();
    }
    spans.parameters.truncate(used);
    Some((
        Term {
            name: name.to_owned(),
            membership_function: function,
            height,
            lower: None,
        },
        spans,
    ))
}

/// Reads `x y x y ...`, with a height if the number of values is odd.
fn points(numbers: &[f64]) -> (MembershipFunction, usize) {
    let pairs = numbers.chunks_exact(2).map(|pair| (pair[0], pair[1]));
    let points: Vec<(f64, f64)> = pairs.collect();
    let used = 2 * points.len();
    (MembershipFunction::Piecewise { points }, used)
}

/// A step up at a position, or down if the direction is less than the position, such as `-inf`; `part` is the shape in
/// the text.
fn binary(draft: &mut ModelDraft<'_>, numbers: &[f64], part: &str) -> Option<MembershipFunction> {
    let at = numbers.first().copied().unwrap_or(f64::NAN);
    let direction = numbers.get(1).copied().unwrap_or(f64::NAN);
    if direction > at {
        return Some(MembershipFunction::RightShoulder { foot: at, top: at });
    }
    if direction < at {
        return Some(MembershipFunction::LeftShoulder { top: at, foot: at });
    }
    let message = "`Binary` has no direction".into();
    let help = "write a number and `inf` for a step up, or `-inf` for a step down";
    draft.error("parameter-count", part, message, help);
    None
}
