//! Reading and writing membership functions in a document, based on the table of shapes.

use alloc::{
    format,
    string::{String, ToString},
    vec::Vec,
};

use super::footprints;
use crate::{
    diagnostic::{Diagnostic, all_of, nearest, suggest},
    foreign,
    model::{Formula, MembershipFunction, ShapeForm, ShapeParts, document::TermSpans},
    rule::Name,
    tree::{Entry, Fields, Node, Value},
};

/// Reads the membership function of a term such as `{triangle: [0, 1, 2], height: 1}`; `term` names it in messages. The
/// positions of its parameters are added to `spans`.
pub(super) fn read(
    term: &str,
    fields: &Fields<'_>,
    spans: &mut TermSpans,
    findings: &mut Vec<Diagnostic>,
) -> Option<MembershipFunction> {
    let mut shapes = fields
        .entries()
        .iter()
        .filter(|entry| entry.key != "height" && !footprints::KEYS.contains(&entry.key));
    let Some(shape) = shapes.next() else {
        let message = format!("{term} has no membership function");
        findings.push(
            Diagnostic::error("missing-key", spans.name.clone(), message)
                .help("write a membership function, such as `triangle: [0, 1, 2]`"),
        );
        return None;
    };
    if let Some(finding) = without_brackets(shape, fields) {
        findings.push(finding);
        return None;
    }
    let known = MembershipFunction::FORMS.iter().map(|form| form.name);
    let known = known.chain(["piecewise", "function", "linear"]);
    if !known.clone().any(|name| name == shape.key) {
        let message = format!("there is no membership function `{}`", shape.key);
        let mut finding = Diagnostic::error(
            "unknown-membership-function",
            shape.key_span.clone(),
            message,
        );
        finding.help = match &shape.value.value {
            // For example `{type: triangle, points: [0, 1, 2]}`.
            Value::Scalar(name) if known.clone().any(|known| known == name.text) => {
                let parameters = shapes.next().map(|other| other.value.to_line());
                Some(format!(
                    "write the name of the membership function as the key: `{{{}: {}}}`",
                    name.text,
                    parameters.unwrap_or_else(|| "...".into())
                ))
            }
            _ => upper_and_lower(fields).or_else(|| suggest(shape.key, known)),
        };
        findings.push(finding);
        return None;
    }
    if let Some(second) = shapes.next() {
        let beside = footprints::KEYS.into_iter().chain(["height"]);
        if let Some(key) = foreign::equivalents(second.key, beside.clone())
            .first()
            .copied()
            .or_else(|| nearest(second.key, beside))
        {
            let message = format!("unknown key `{}` in {term}", second.key);
            let finding = Diagnostic::error("unknown-key", second.key_span.clone(), message);
            findings.push(finding.help(format!("did you mean `{key}`?")));
            return None;
        }
        // In braces, a comma ends the formula: `{function: max(x, 3)}` has a second key `3)`.
        if shape.key == "function"
            && second.value.is_null()
            && let Value::Scalar(start) = &shape.value.value
            && !start.quoted
        {
            let rest = second.key;
            let message = "inside `{...}`, a formula with a comma must be in quotes";
            let help = format!(
                "put the formula in quotes: `function: \"{}, {rest}\"`",
                start.text
            );
            let span = shape.value.span.start..second.key_span.end;
            findings.push(Diagnostic::error("formula-syntax", span, message).help(help));
            return None;
        }
        let message = format!("{term} has a second membership function, `{}`", second.key);
        findings.push(
            Diagnostic::error("duplicate-key", second.key_span.clone(), message)
                .related(shape.key_span.clone(), "first defined here")
                .help("keep one membership function, or write two terms"),
        );
    }
    match shape.key {
        "piecewise" => points(term, shape.value, spans, findings),
        "function" => function(term, shape.value, spans, findings),
        "linear" => linear(shape.value, spans, findings),
        name => {
            let mut forms = MembershipFunction::FORMS.iter();
            let form = forms.find(|form| form.name == name)?;
            by_form(form, shape.value, spans, findings)
        }
    }
}

/// Returns a suggestion if the keys of the two membership functions of a type-2 term are words of another program.
fn upper_and_lower(fields: &Fields<'_>) -> Option<String> {
    let entries = fields.entries().iter();
    let pairs = entries.filter_map(|entry| {
        let here = foreign::equivalents(entry.key, ["upper", "lower"]);
        Some(format!("`{}` in place of `{}`", here.first()?, entry.key))
    });
    let pairs: Vec<String> = pairs.collect();
    (!pairs.is_empty()).then(|| format!("write {}", pairs.join(" and ")))
}

/// Returns a finding for parameters without brackets, which YAML reads as keys: `{triangle: 0, 10, 20}`, or
/// `{triangle(0, 10, 20)}`.
fn without_brackets(shape: &Entry<'_>, fields: &Fields<'_>) -> Option<Diagnostic> {
    let mut others = fields.entries().iter().skip(1);
    let (name, first) = match shape.key.split_once('(') {
        Some((name, first)) if shape.value.is_null() => (name, first),
        _ => (shape.key, shape.value.as_number_text()?),
    };
    let forms = MembershipFunction::FORMS.iter();
    let form = forms
        .clone()
        .find(|form| form.name == name && form.as_list())?;
    let is_rest = |entry: &Entry<'_>| {
        entry.value.is_null() && entry.key.trim_end_matches(')').parse::<f64>().is_ok()
    };
    let rest: Vec<&Entry<'_>> = others.by_ref().take_while(|entry| is_rest(entry)).collect();
    let last = rest.last()?;
    let numbers = rest.iter().map(|entry| entry.key.trim_end_matches(')'));
    let numbers: Vec<&str> = core::iter::once(first).chain(numbers).collect();
    let message = format!("the numbers of `{}` are not in brackets", form.name);
    let span = shape.key_span.start..last.key_span.end;
    let help = format!("write `{}: [{}]`", form.name, numbers.join(", "));
    Some(Diagnostic::error("wrong-type", span, message).help(help))
}

fn by_form(
    form: &ShapeForm,
    node: &Node,
    spans: &mut TermSpans,
    findings: &mut Vec<Diagnostic>,
) -> Option<MembershipFunction> {
    let name = form.name;
    let names = form.names();
    let mut values = Vec::new();
    let mut read = |parameter: &str, node: &Node, findings: &mut Vec<Diagnostic>| {
        spans.parameters.push(node.span.clone());
        spans.numbers.push(node.span.clone());
        values.extend(node.finite(&format!("`{parameter}` of `{name}`"), findings));
    };
    match &node.value {
        Value::Mapping(_) => {
            let what = format!("`{name}`");
            let before = findings.len();
            let fields = node.fields(&what, &names, "", findings)?;
            let help = spelling(form);
            let found: Vec<Option<&Node>> = names
                .iter()
                .map(|parameter| fields.require(parameter, &help, findings))
                .collect();
            if fields.unknown().next().is_some() && findings.len() > before + 1 {
                findings.truncate(before);
                findings.push(other_parameters(form, &fields));
            }
            // The suggestion for a missing parameter contains the numbers of the others.
            for finding in findings.iter_mut().skip(before) {
                if finding.code == "missing-key" {
                    finding.help = Some(completed(form, &found));
                }
            }
            for (parameter, node) in names.iter().zip(found) {
                read(parameter, node?, findings);
            }
        }
        Value::List(items) if form.as_list() && items.len() == names.len() => {
            for (parameter, node) in names.iter().zip(items) {
                read(parameter, node, findings);
            }
        }
        // A single parameter needs no brackets.
        Value::Scalar(_) if names.len() == 1 => {
            read(names.first().copied().unwrap_or(""), node, findings);
        }
        _ => {
            let expected = if form.as_list() {
                format!("{} numbers for `{name}`", names.len())
            } else {
                format!("named parameters for `{name}`")
            };
            let mut finding = node.unexpected(&expected);
            let numbers: Vec<&str> = match &node.value {
                Value::List(items) => items.iter().filter_map(Node::as_number_text).collect(),
                _ => Vec::new(),
            };
            if let Value::List(items) = &node.value
                && form.as_list()
            {
                finding.message = format!(
                    "`{name}` needs {} numbers, but has {}",
                    names.len(),
                    items.len()
                );
                let other = match (name, numbers.len()) {
                    ("triangle", 4) => Some("trapezoid"),
                    ("trapezoid", 3) => Some("triangle"),
                    _ => None,
                };
                let other = other.map(|other| format!("write `{other}: [{}]`", numbers.join(", ")));
                finding.help = Node::list_advice(items, names.len()).or(other);
            }
            let pair = match (numbers.as_slice(), names.as_slice()) {
                ([a, b], [first, second]) if !form.as_list() => {
                    let exchanged = match a == b {
                        true => String::new(),
                        false => format!(" or `{{{first}: {b}, {second}: {a}}}`"),
                    };
                    Some(format!(
                        "name the parameters, because their order differs between programs: `{name}: {{{first}: {a}, {second}: {b}}}`{exchanged}"
                    ))
                }
                _ => None,
            };
            let help = finding.help.take().or(pair);
            finding.help = Some(help.unwrap_or_else(|| spelling(form)));
            findings.push(finding);
            return None;
        }
    }
    if values.len() != names.len() {
        return None;
    }
    (form.build)(&values)
}

/// Returns the notation of a shape with the parameters that were found; a missing one is 1.
fn completed(form: &ShapeForm, found: &[Option<&Node>]) -> String {
    let named = form.names().into_iter().zip(found);
    let named: Vec<String> = named
        .map(|(name, node)| format!("{name}: {}", node.map_or("1".into(), Node::to_line)))
        .collect();
    format!(
        "write all parameters, for example `{}: {{{}}}`",
        form.name,
        named.join(", ")
    )
}

/// Returns a single finding for several parameters with other names, such as `{low: 1, mid: 2, high: 3}`.
fn other_parameters(form: &ShapeForm, fields: &Fields<'_>) -> Diagnostic {
    let names = form.names();
    let unknown: Vec<&Entry<'_>> = fields.unknown().collect();
    let others: Vec<&str> = unknown.iter().map(|entry| entry.key).collect();
    let message = format!(
        "`{}` takes {}, not {}",
        form.name,
        all_of(&names),
        all_of(&others)
    );
    let span = unknown.first().map_or(0..0, |entry| entry.key_span.clone());
    // The keys may be the names of these parameters in other programs. A single unknown key stands for the remaining
    // parameter.
    let parameter = |entry: &Entry<'_>| foreign::parameter(form.name, entry.key, &names);
    let entries = fields.entries().iter();
    let (known, others): (Vec<&Entry<'_>>, Vec<_>) =
        entries.partition(|entry| parameter(entry).is_some());
    let rest = match others.as_slice() {
        [only] => Some(*only),
        _ => None,
    };
    let meant = names.iter().map(|name| {
        let mut entries = known.iter().filter(|entry| parameter(entry) == Some(name));
        let entry = entries.next().copied().or(rest);
        entry
            .filter(|_| entries.next().is_none())?
            .value
            .as_number_text()
    });
    let meant: Option<Vec<&str>> = meant.collect();
    let meant = meant.filter(|_| fields.entries().len() == names.len());
    let numbers = fields
        .entries()
        .iter()
        .map(|entry| entry.value.as_number_text());
    let numbers = numbers.collect::<Option<Vec<&str>>>();
    // If the keys are unknown, their order is certain only for a shape that can be written as a list.
    let numbers = numbers.filter(|numbers| form.as_list() && numbers.len() == names.len());
    let help = match meant.or(numbers) {
        Some(numbers) if form.as_list() => {
            format!("write `{}: [{}]`", form.name, numbers.join(", "))
        }
        Some(numbers) => {
            let named = names.iter().zip(numbers);
            let named: Vec<String> = named
                .map(|(name, number)| format!("{name}: {number}"))
                .collect();
            format!("write `{}: {{{}}}`", form.name, named.join(", "))
        }
        None => spelling(form),
    };
    Diagnostic::error("unknown-key", span, message).help(help)
}

/// Returns the notation of the shape for messages.
fn spelling(form: &ShapeForm) -> String {
    let names = form.names();
    let list = names.join(", ");
    match names.as_slice() {
        [only] => format!("write `{}: {only}` with a number for `{only}`", form.name),
        _ if form.as_list() => format!("write `{}: [{list}]`, in ascending order", form.name),
        _ => {
            let named: Vec<String> = names.iter().map(|p| format!("{p}: ...")).collect();
            format!(
                "name the parameters, because their order differs between programs: `{}: {{{}}}`",
                form.name,
                named.join(", ")
            )
        }
    }
}

const POINTS_HELP: &str =
    "write each point as a pair of x and degree: `piecewise: [[x, degree], [x, degree]]`";

fn points(
    term: &str,
    node: &Node,
    spans: &mut TermSpans,
    findings: &mut Vec<Diagnostic>,
) -> Option<MembershipFunction> {
    let help = match &node.value {
        // For example `{20: 0, 50: 1}`.
        Value::Mapping(pairs) => {
            let pairs = pairs.iter().map(|(x, degree)| {
                Some(format!("[{}, {}]", x.as_text()?, degree.as_number_text()?))
            });
            let points: Option<Vec<String>> = pairs.collect();
            points.map(|points| format!("write `piecewise: [{}]`", points.join(", ")))
        }
        _ => None,
    };
    let help = help.as_deref().unwrap_or(POINTS_HELP);
    let items = node.items(&format!("the points of {term}"), help, findings)?;
    if let Some(first) = items.first()
        && items.iter().all(|item| item.as_text().is_some())
    {
        // For example `[30, 0, 50, 1, 70, 0]`.
        let numbers: Vec<&str> = items.iter().filter_map(Node::as_number_text).collect();
        let (pairs, rest) = numbers.as_chunks::<2>();
        let help = match rest.is_empty() && numbers.len() == items.len() {
            true => {
                let pairs: Vec<String> = pairs.iter().map(|[x, y]| format!("[{x}, {y}]")).collect();
                format!("write each point in brackets: `[{}]`", pairs.join(", "))
            }
            false => POINTS_HELP.into(),
        };
        findings.push(first.unexpected("a point").help(help));
        return None;
    }
    let mut points = Vec::with_capacity(items.len());
    for item in items {
        spans.parameters.push(item.span.clone());
        match &item.value {
            Value::List(pair) if pair.len() == 2 => {
                spans
                    .numbers
                    .extend(pair.iter().map(|number| number.span.clone()));
                let mut numbers = pair.iter().map(|n| n.finite("a point", findings));
                if let (Some(Some(x)), Some(Some(degree))) = (numbers.next(), numbers.next()) {
                    points.push((x, degree));
                }
            }
            _ => findings.push(item.unexpected("a point").help(POINTS_HELP)),
        }
    }
    (points.len() == items.len()).then_some(MembershipFunction::Piecewise { points })
}

/// Reads `function: 2 * speed^2 + 1`.
fn function(
    term: &str,
    node: &Node,
    spans: &mut TermSpans,
    findings: &mut Vec<Diagnostic>,
) -> Option<MembershipFunction> {
    let Value::Scalar(scalar) = &node.value else {
        let finding = node.unexpected(&format!("a formula for {term}"));
        findings.push(finding.help("write a formula, such as `function: 2 * speed^2 + 1`"));
        return None;
    };
    match scalar.text.parse::<Formula>() {
        Ok(formula) => {
            let places = formula.spans().map(|span| scalar.span(span.clone()));
            spans.parameters.extend(places);
            spans
                .names
                .extend(formula.places().map(|(name, span)| Name {
                    text: name.into(),
                    span: scalar.span(span.clone()),
                }));
            Some(MembershipFunction::Function { formula })
        }
        Err(mut finding) => {
            finding.span = scalar.span(finding.span.clone());
            findings.push(*finding);
            None
        }
    }
}

fn linear(
    node: &Node,
    spans: &mut TermSpans,
    findings: &mut Vec<Diagnostic>,
) -> Option<MembershipFunction> {
    let help = match node
        .as_text()
        .filter(|text| text.parse::<Formula>().is_ok())
    {
        Some(formula) => format!("for a formula, write `function: {formula}`"),
        None => {
            "write a constant and a coefficient for each input: `linear: {temperature: 2, constant: 5}`"
                .into()
        }
    };
    let entries = node.entries("the linear term", "key", &help, findings)?;
    let mut coefficients = Vec::new();
    let (mut constant, mut constant_span) = (0.0, 0..0);
    for entry in entries {
        let what = format!("`{}` of the linear term", entry.key);
        let number = entry.value.finite(&what, findings)?;
        if entry.key == "constant" {
            (constant, constant_span) = (number, entry.value.span.clone());
        } else {
            coefficients.push((entry.key.to_string(), number));
            spans.parameters.push(entry.key_span.clone());
            spans.numbers.push(entry.value.span.clone());
            spans.names.push(Name {
                text: entry.key.to_string(),
                span: entry.key_span.clone(),
            });
        }
    }
    spans.numbers.push(constant_span);
    Some(MembershipFunction::Linear {
        coefficients,
        constant,
    })
}

/// Returns the shape as the key and the value in a term's mapping.
pub(super) fn write(shape: &MembershipFunction) -> (&'static str, Node) {
    let numbers = |values: &[f64]| Node::list(values.iter().copied().map(Node::number).collect());
    match shape.parts() {
        ShapeParts::Fixed(form, values) => {
            let value = match values.as_slice() {
                [only] => Node::number(*only),
                places if form.as_list() => numbers(places),
                _ => {
                    let named = form.names().into_iter().zip(values);
                    Node::mapping(named.map(|(name, value)| (name, Node::number(value))))
                }
            };
            (form.name, value)
        }
        ShapeParts::Points(points) => {
            let points = points.iter().map(|&(x, degree)| numbers(&[x, degree]));
            ("piecewise", Node::list(points.collect()))
        }
        ShapeParts::Formula(formula) => ("function", Node::text(formula.to_string())),
        ShapeParts::Linear(coefficients, constant) => {
            let entries = coefficients.iter().map(|(name, c)| (name.as_str(), *c));
            let entries = entries.chain([("constant", constant)]);
            (
                "linear",
                Node::mapping(entries.map(|(key, c)| (key, Node::number(c)))),
            )
        }
    }
}

/// Formats a membership function as in a file, on one line: `triangle: [0, 2, 4]`.
pub fn text(shape: &MembershipFunction) -> String {
    let (name, parameters) = write(shape);
    format!("{name}: {}", parameters.to_line())
}
