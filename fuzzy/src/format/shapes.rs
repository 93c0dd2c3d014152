//! The spelling of membership functions: one table for reading, writing and checking them.

use alloc::{
    format,
    string::{String, ToString},
    vec::Vec,
};
use core::ops::Range;

use crate::{
    diagnostic::{Diagnostic, suggest},
    model::Shape,
    tree::{Fields, Node, Value},
};

/// How a shape is spelt.
pub(super) struct Form {
    /// Its key.
    pub(super) name: &'static str,
    /// Its parameters by name, in the order of a list.
    pub(super) parameters: &'static [&'static str],
    /// Whether the parameters may stand in a list. Only places from left to right may: programs differ in the order of
    /// all others, `gaussian: [1, 5]` means mean 1 to one and mean 5 to another.
    pub(super) as_list: bool,
    /// What it is, for the schema.
    pub(super) about: &'static str,
}

const fn places(
    name: &'static str,
    parameters: &'static [&'static str],
    about: &'static str,
) -> Form {
    Form {
        name,
        parameters,
        as_list: true,
        about,
    }
}

const fn named(
    name: &'static str,
    parameters: &'static [&'static str],
    about: &'static str,
) -> Form {
    Form {
        name,
        parameters,
        as_list: false,
        about,
    }
}

const SIGMOIDS: [&str; 4] = [
    "left_inflection",
    "left_slope",
    "right_inflection",
    "right_slope",
];

/// All shapes with a fixed number of parameters; `piecewise` and `linear` have their own spelling.
pub(super) const FORMS: [Form; 19] = [
    places(
        "triangle",
        &["left", "peak", "right"],
        "0 at left, 1 at peak, 0 at right",
    ),
    places(
        "trapezoid",
        &["left", "left_top", "right_top", "right"],
        "1 from left_top to right_top, 0 outside left and right",
    ),
    places(
        "left_shoulder",
        &["top", "foot"],
        "1 up to top, 0 from foot on",
    ),
    places(
        "right_shoulder",
        &["foot", "top"],
        "0 up to foot, 1 from top on",
    ),
    places("rectangle", &["left", "right"], "1 from left to right"),
    places("singleton", &["at"], "1 at one value alone"),
    named("gaussian", &["mean", "sd"], "exp(-(x - mean)^2 / (2 sd^2))"),
    named(
        "gaussian2",
        &["left_mean", "left_sd", "right_mean", "right_sd"],
        "Gaussian flanks around 1 from left_mean to right_mean",
    ),
    named(
        "bell",
        &["center", "width", "slope"],
        "1 / (1 + |(x - center) / width|^(2 slope))",
    ),
    named(
        "sigmoid",
        &["inflection", "slope"],
        "1 / (1 + exp(-slope (x - inflection)))",
    ),
    named(
        "sigmoid_difference",
        &SIGMOIDS,
        "The difference of two sigmoids, without its sign",
    ),
    named("sigmoid_product", &SIGMOIDS, "The product of two sigmoids"),
    places(
        "s_shape",
        &["foot", "top"],
        "Two parabolas up from 0 at foot to 1 at top",
    ),
    places(
        "z_shape",
        &["top", "foot"],
        "Two parabolas down from 1 at top to 0 at foot",
    ),
    places(
        "pi_shape",
        &["left", "left_top", "right_top", "right"],
        "An S up to left_top, 1, a Z down from right_top",
    ),
    named(
        "cosine",
        &["center", "width"],
        "A bump of a cosine, width wide",
    ),
    named(
        "spike",
        &["center", "width"],
        "exp(-|10 (x - center) / width|)",
    ),
    named(
        "concave",
        &["inflection", "end"],
        "(end - inflection) / (2 end - inflection - x) up to end, 1 beyond it",
    ),
    places(
        "constant",
        &["value"],
        "The same degree everywhere; in a Takagi-Sugeno output, the value itself",
    ),
];

/// The shape of a name with its parameters.
fn build(name: &str, parameters: &[f64]) -> Option<Shape> {
    Some(match (name, parameters) {
        ("triangle", &[left, peak, right]) => Shape::Triangle { left, peak, right },
        ("trapezoid", &[left, left_top, right_top, right]) => Shape::Trapezoid {
            left,
            left_top,
            right_top,
            right,
        },
        ("left_shoulder", &[top, foot]) => Shape::LeftShoulder { top, foot },
        ("right_shoulder", &[foot, top]) => Shape::RightShoulder { foot, top },
        ("rectangle", &[left, right]) => Shape::Rectangle { left, right },
        ("singleton", &[at]) => Shape::Singleton { at },
        ("gaussian", &[mean, sd]) => Shape::Gaussian { mean, sd },
        ("gaussian2", &[left_mean, left_sd, right_mean, right_sd]) => Shape::Gaussian2 {
            left_mean,
            left_sd,
            right_mean,
            right_sd,
        },
        ("bell", &[center, width, slope]) => Shape::Bell {
            center,
            width,
            slope,
        },
        ("sigmoid", &[inflection, slope]) => Shape::Sigmoid { inflection, slope },
        ("sigmoid_difference", &[left_inflection, left_slope, right_inflection, right_slope]) => {
            Shape::SigmoidDifference {
                left_inflection,
                left_slope,
                right_inflection,
                right_slope,
            }
        }
        ("sigmoid_product", &[left_inflection, left_slope, right_inflection, right_slope]) => {
            Shape::SigmoidProduct {
                left_inflection,
                left_slope,
                right_inflection,
                right_slope,
            }
        }
        ("s_shape", &[foot, top]) => Shape::SShape { foot, top },
        ("z_shape", &[top, foot]) => Shape::ZShape { top, foot },
        ("pi_shape", &[left, left_top, right_top, right]) => Shape::PiShape {
            left,
            left_top,
            right_top,
            right,
        },
        ("cosine", &[center, width]) => Shape::Cosine { center, width },
        ("spike", &[center, width]) => Shape::Spike { center, width },
        ("concave", &[inflection, end]) => Shape::Concave { inflection, end },
        ("constant", &[value]) => Shape::Constant { value },
        _ => return None,
    })
}

/// The name of a shape and its parameters: the inverse of [`build`]. `None` for `piecewise` and `linear`.
fn parts(shape: &Shape) -> Option<(&'static str, Vec<f64>)> {
    let (name, parameters): (_, &[f64]) = match *shape {
        Shape::Triangle { left, peak, right } => ("triangle", &[left, peak, right]),
        Shape::Trapezoid {
            left,
            left_top,
            right_top,
            right,
        } => ("trapezoid", &[left, left_top, right_top, right]),
        Shape::LeftShoulder { top, foot } => ("left_shoulder", &[top, foot]),
        Shape::RightShoulder { foot, top } => ("right_shoulder", &[foot, top]),
        Shape::Rectangle { left, right } => ("rectangle", &[left, right]),
        Shape::Singleton { at } => ("singleton", &[at]),
        Shape::Gaussian { mean, sd } => ("gaussian", &[mean, sd]),
        Shape::Gaussian2 {
            left_mean,
            left_sd,
            right_mean,
            right_sd,
        } => ("gaussian2", &[left_mean, left_sd, right_mean, right_sd]),
        Shape::Bell {
            center,
            width,
            slope,
        } => ("bell", &[center, width, slope]),
        Shape::Sigmoid { inflection, slope } => ("sigmoid", &[inflection, slope]),
        Shape::SigmoidDifference {
            left_inflection,
            left_slope,
            right_inflection,
            right_slope,
        } => (
            "sigmoid_difference",
            &[left_inflection, left_slope, right_inflection, right_slope],
        ),
        Shape::SigmoidProduct {
            left_inflection,
            left_slope,
            right_inflection,
            right_slope,
        } => (
            "sigmoid_product",
            &[left_inflection, left_slope, right_inflection, right_slope],
        ),
        Shape::SShape { foot, top } => ("s_shape", &[foot, top]),
        Shape::ZShape { top, foot } => ("z_shape", &[top, foot]),
        Shape::PiShape {
            left,
            left_top,
            right_top,
            right,
        } => ("pi_shape", &[left, left_top, right_top, right]),
        Shape::Cosine { center, width } => ("cosine", &[center, width]),
        Shape::Spike { center, width } => ("spike", &[center, width]),
        Shape::Concave { inflection, end } => ("concave", &[inflection, end]),
        Shape::Constant { value } => ("constant", &[value]),
        Shape::Piecewise { .. } | Shape::Linear { .. } => return None,
    };
    Some((name, parameters.to_vec()))
}

/// The parameters of a shape, where it has a fixed number of them.
pub(crate) fn parameters(shape: &Shape) -> Vec<f64> {
    parts(shape)
        .map(|(_, parameters)| parameters)
        .unwrap_or_default()
}

/// Reads the shape out of a term `{triangle: [0, 1, 2], height: 1}`; `term` names it in messages.
pub(super) fn read(
    term: &str,
    place: Range<usize>,
    fields: &Fields<'_>,
    findings: &mut Vec<Diagnostic>,
) -> Option<Shape> {
    let mut shapes = fields
        .entries()
        .iter()
        .filter(|entry| entry.key != "height");
    let Some(shape) = shapes.next() else {
        findings.push(
            Diagnostic::error("missing-key", place, format!("{term} has no shape"))
                .help("write one: `{triangle: [0, 1, 2]}`"),
        );
        return None;
    };
    if let Some(second) = shapes.next() {
        let message = format!("{term} has a second shape, `{}`", second.key);
        findings.push(
            Diagnostic::error("duplicate-key", second.key_span.clone(), message)
                .related(shape.key_span.clone(), "the first one")
                .help("a term has one shape; for two write two terms"),
        );
    }
    match shape.key {
        "piecewise" => points(term, shape.value, findings),
        "linear" => linear(shape.value, findings),
        name => match FORMS.iter().find(|form| form.name == name) {
            Some(form) => by_form(form, shape.value, findings),
            None => {
                let known = FORMS.iter().map(|form| form.name);
                let message = format!("there is no shape `{name}`");
                let mut finding =
                    Diagnostic::error("unknown-shape", shape.key_span.clone(), message);
                finding.help = suggest(name, known.chain(["piecewise", "linear"]));
                findings.push(finding);
                None
            }
        },
    }
}

fn by_form(form: &Form, node: &Node, findings: &mut Vec<Diagnostic>) -> Option<Shape> {
    let name = form.name;
    let mut spans: Vec<Range<usize>> = Vec::new();
    let mut values = Vec::new();
    let mut read = |parameter: &str, node: &Node, findings: &mut Vec<Diagnostic>| {
        spans.push(node.span.clone());
        values.extend(node.finite(&format!("`{parameter}` of the {name}"), findings));
    };
    match &node.value {
        Value::Mapping(_) => {
            let what = format!("the {name}");
            let fields = node.fields(&what, form.parameters, findings)?;
            for parameter in form.parameters {
                let help = spelling(form);
                let node = fields.require(parameter, &help, findings)?;
                read(parameter, node, findings);
            }
        }
        Value::List(items) if form.as_list && items.len() == form.parameters.len() => {
            for (parameter, node) in form.parameters.iter().zip(items) {
                read(parameter, node, findings);
            }
        }
        // One parameter needs no brackets.
        Value::Scalar(_) if form.parameters.len() == 1 => {
            read(
                form.parameters.first().copied().unwrap_or(""),
                node,
                findings,
            );
        }
        _ => {
            let expected = if form.as_list {
                format!("{} numbers for the {name}", form.parameters.len())
            } else {
                format!("named parameters for the {name}")
            };
            let mut finding = node.unexpected(&expected);
            if let Value::List(items) = &node.value
                && form.as_list
            {
                finding.message = format!(
                    "the {name} takes {} numbers, not {}",
                    form.parameters.len(),
                    items.len()
                );
            }
            findings.push(finding.help(spelling(form)));
            return None;
        }
    }
    if values.len() != form.parameters.len() {
        return None;
    }
    let shape = build(name, &values)?;
    let place = |blamed: &str| {
        let index = form.parameters.iter().position(|p| *p == blamed);
        index.and_then(|i| spans.get(i)).cloned()
    };
    valid(shape, name, node, place, findings)
}

/// The shape, unless its parameters make none; `place` says where a parameter or point stands.
fn valid(
    shape: Shape,
    name: &str,
    node: &Node,
    place: impl Fn(&str) -> Option<Range<usize>>,
    findings: &mut Vec<Diagnostic>,
) -> Option<Shape> {
    let Err(error) = shape.validate() else {
        return Some(shape);
    };
    let span = place(&error.blamed).unwrap_or(node.span.clone());
    let message = format!("this is no {name}: {error}");
    findings.push(Diagnostic::error("wrong-parameter", span, message).help(
        "the places of a shape stand from left to right, its widths are over 0, degrees lie in [0, 1]",
    ));
    None
}

/// How the shape is written, for messages.
fn spelling(form: &Form) -> String {
    let list = form.parameters.join(", ");
    match form.parameters {
        [only] => format!("write `{}: {only}` with a number for `{only}`", form.name),
        _ if form.as_list => format!("write `{}: [{list}]`, from left to right", form.name),
        _ => {
            let named: Vec<String> = form.parameters.iter().map(|p| format!("{p}: 1")).collect();
            format!(
                "write the parameters by name, since programs differ in their order: `{}: {{{}}}`",
                form.name,
                named.join(", ")
            )
        }
    }
}

fn points(term: &str, node: &Node, findings: &mut Vec<Diagnostic>) -> Option<Shape> {
    let items = node.items(&format!("the points of {term}"), findings)?;
    let mut points = Vec::with_capacity(items.len());
    for item in items {
        match &item.value {
            Value::List(pair) if pair.len() == 2 => {
                let mut numbers = pair.iter().map(|n| n.finite("a point", findings));
                if let (Some(Some(x)), Some(Some(degree))) = (numbers.next(), numbers.next()) {
                    points.push((x, degree));
                }
            }
            _ => findings.push(
                item.unexpected("a point")
                    .help("write `piecewise: [[x, degree], [x, degree]]`"),
            ),
        }
    }
    if points.len() != items.len() {
        return None;
    }
    let place = |blamed: &str| {
        let index = blamed.strip_prefix("point ")?.parse::<usize>().ok()?;
        items.get(index).map(|item| item.span.clone())
    };
    valid(
        Shape::Piecewise { points },
        "piecewise",
        node,
        place,
        findings,
    )
}

fn linear(node: &Node, findings: &mut Vec<Diagnostic>) -> Option<Shape> {
    let entries = node.entries("the linear term", "key", findings)?;
    let mut coefficients = Vec::new();
    let mut constant = 0.0;
    for entry in entries {
        let what = format!("`{}` of the linear term", entry.key);
        let number = entry.value.finite(&what, findings)?;
        if entry.key == "constant" {
            constant = number;
        } else {
            coefficients.push((entry.key.to_string(), number));
        }
    }
    Some(Shape::Linear {
        coefficients,
        constant,
    })
}

/// The shape as the key and the value of a term's mapping.
pub(super) fn write(shape: &Shape) -> (&'static str, Node) {
    let numbers = |values: &[f64]| Node::list(values.iter().copied().map(Node::number).collect());
    match shape {
        Shape::Piecewise { points } => {
            let points = points.iter().map(|&(x, degree)| numbers(&[x, degree]));
            ("piecewise", Node::list(points.collect()))
        }
        Shape::Linear {
            coefficients,
            constant,
        } => {
            let entries = coefficients.iter().map(|(name, c)| (name.as_str(), *c));
            let entries = entries.chain([("constant", *constant)]);
            (
                "linear",
                Node::mapping(entries.map(|(key, c)| (key, Node::number(c)))),
            )
        }
        _ => {
            let (name, values) = parts(shape).unwrap_or(("constant", Vec::new()));
            let form = FORMS.iter().find(|form| form.name == name);
            let value = match (form, values.as_slice()) {
                (_, [only]) => Node::number(*only),
                (Some(form), _) if !form.as_list => Node::mapping(
                    form.parameters
                        .iter()
                        .zip(&values)
                        .map(|(name, value)| (*name, Node::number(*value))),
                ),
                _ => numbers(&values),
            };
            (name, value)
        }
    }
}
