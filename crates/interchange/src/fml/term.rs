//! Reads terms of FML: `<fuzzyTerm name="low"><triangularShape param1="0" param2="1" param3="2"/></fuzzyTerm>`.

use fuzzy::{
    diagnostic::nearest,
    format::TermSpans,
    model::{MembershipFunction, Term},
};
use roxmltree::Node;

use super::read::{attribute, children, tag};
use crate::model_draft::{ModelDraft, number};

const SHAPES: [(&str, usize); 14] = [
    ("triangularShape", 3),
    ("trapezoidShape", 4),
    ("gaussianShape", 2),
    ("leftGaussianShape", 2),
    ("rightGaussianShape", 2),
    ("leftLinearShape", 2),
    ("rightLinearShape", 2),
    ("rectangularShape", 2),
    ("singletonShape", 1),
    ("piShape", 2),
    ("sShape", 2),
    ("zShape", 2),
    ("pointSetShape", 0),
    ("pointSetMonotonicShape", 0),
];

pub(super) fn read(
    draft: &mut ModelDraft<'_>,
    node: Node<'_, '_>,
    right_is_high: bool,
    range: (f64, f64),
) -> Option<(Term, TermSpans)> {
    let part = tag(draft.text, node);
    let mut spans = TermSpans::default();
    spans.name = draft.span(part);
    let name = attribute(node, "name").unwrap_or_default();
    if attribute(node, "complement").is_some_and(|word| word.eq_ignore_ascii_case("true")) {
        let message = format!("the term `{name}` is a complement");
        draft.loss(
            "complement",
            part,
            message,
            "write `NOT` in the rules that use it",
        );
    }
    let Some(shape) = node.children().find(Node::is_element) else {
        let message = format!("the term `{name}` has no membership function");
        draft.error(
            "no-term",
            part,
            message,
            "add an element such as `<triangularShape .../>`",
        );
        return None;
    };
    let word = shape.tag_name().name();
    let Some(&(known, count)) = SHAPES
        .iter()
        .find(|(known, _)| known.eq_ignore_ascii_case(word))
    else {
        let help = match nearest(word, SHAPES.iter().map(|(known, _)| *known)) {
            Some(near) => format!("did you mean `{near}`?"),
            None => "circular and custom shapes cannot be read".into(),
        };
        let message = format!("unknown shape `{word}`");
        draft.error("unknown-shape", tag(draft.text, shape), message, &help);
        return None;
    };
    let mut p = [0.0; 4];
    for (index, parameter) in p.iter_mut().enumerate().take(count) {
        let key = format!("param{}", index + 1);
        let Some(value) = attribute(shape, &key).and_then(|word| number(word.trim())) else {
            let message = format!("`{word}` needs the number `{key}`");
            draft.error(
                "not-a-number",
                tag(draft.text, shape),
                message,
                &match attribute(shape, &key) {
                    None => format!("add the attribute: `{key}=\"1\"`"),
                    Some(word) => format!("`{word}` is not a number: write it in digits"),
                },
            );
            return None;
        };
        *parameter = value;
    }
    let function = match known {
        "pointSetShape" | "pointSetMonotonicShape" => points(draft, shape)?,
        _ => function(known, p, right_is_high, range)?,
    };
    let term = Term {
        name: name.to_owned(),
        membership_function: function,
        height: 1.0,
        lower: None,
    };
    Some((term, spans))
}

fn function(
    shape: &str,
    [a, b, c, d]: [f64; 4],
    right_is_high: bool,
    (low, high): (f64, f64),
) -> Option<MembershipFunction> {
    use MembershipFunction as To;
    let rising = matches!(shape, "rightLinearShape" | "rightGaussianShape") == right_is_high;
    Some(match shape {
        "triangularShape" => To::Triangle {
            left: a,
            peak: b,
            right: c,
        },
        "trapezoidShape" => To::Trapezoid {
            left: a,
            left_top: b,
            right_top: c,
            right: d,
        },
        "gaussianShape" => To::Gaussian { mean: a, sd: b },
        // The degree is 1 on one side of the mean: a plateau to the end of the range.
        "leftGaussianShape" | "rightGaussianShape" => To::Gaussian2 {
            left_mean: if rising { a } else { low.min(a) },
            left_sd: b,
            right_mean: if rising { high.max(a) } else { a },
            right_sd: b,
        },
        "leftLinearShape" | "rightLinearShape" if rising => To::RightShoulder { foot: a, top: b },
        "leftLinearShape" | "rightLinearShape" => To::LeftShoulder { top: a, foot: b },
        "rectangularShape" => To::Rectangle { left: a, right: b },
        "singletonShape" => To::Singleton { at: a },
        // The degree rises from `a` to 1 at `b`, and falls over the same width.
        "piShape" => To::PiShape {
            left: a,
            left_top: b,
            right_top: b,
            right: b + (b - a).abs(),
        },
        "sShape" => To::SShape { foot: a, top: b },
        "zShape" => To::ZShape { top: a, foot: b },
        _ => return None,
    })
}

fn points(draft: &mut ModelDraft<'_>, shape: Node<'_, '_>) -> Option<MembershipFunction> {
    let method = attribute(shape, "interpolationMethod").unwrap_or("linear");
    if !method.eq_ignore_ascii_case("linear") {
        let message = format!("points are joined by the method `{method}`");
        draft.loss(
            "interpolation",
            tag(draft.text, shape),
            message,
            "only straight lines can be read",
        );
    }
    let mut points = vec![];
    for point in children(shape, &["point"]) {
        let coordinate = |key| attribute(point, key).and_then(|word| number(word.trim()));
        let (Some(x), Some(y)) = (coordinate("x"), coordinate("y")) else {
            let message = "a point needs the numbers `x` and `y`".into();
            draft.error(
                "not-a-number",
                tag(draft.text, point),
                message,
                "write them in digits",
            );
            return None;
        };
        points.push((x, y));
    }
    Some(MembershipFunction::Piecewise { points })
}

/// Reads a Takagi-Sugeno term: the constant, then a coefficient for each input.
pub(super) fn tsk(
    draft: &mut ModelDraft<'_>,
    node: Node<'_, '_>,
    inputs: &[String],
) -> Option<(Term, TermSpans)> {
    let part = tag(draft.text, node);
    let name = attribute(node, "name").unwrap_or_default();
    let mut spans = TermSpans::default();
    spans.name = draft.span(part);
    let mut values = vec![];
    for value in children(node, &["tskValue"]) {
        let word = value.text().unwrap_or_default().trim();
        let Some(number) = number(word) else {
            let message = format!("`{word}` is not a number");
            draft.error(
                "not-a-number",
                tag(draft.text, value),
                message,
                "write it in digits",
            );
            return None;
        };
        values.push(number);
    }
    let Some((&constant, coefficients)) = values.split_first() else {
        let message = format!("the term `{name}` has no value");
        draft.error("no-term", part, message, "add `<tskValue>`");
        return None;
    };
    let membership_function = match coefficients.is_empty() {
        true => MembershipFunction::Constant { value: constant },
        false => MembershipFunction::Linear {
            coefficients: inputs
                .iter()
                .cloned()
                .zip(coefficients.iter().copied())
                .collect(),
            constant,
        },
    };
    let term = Term {
        name: name.to_owned(),
        membership_function,
        height: 1.0,
        lower: None,
    };
    Some((term, spans))
}
