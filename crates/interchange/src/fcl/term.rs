//! Terms of FCL: `NAME := SHAPE PARAMETER...`, `NAME := (x, y) (x, y)...`, `NAME := VALUE`.

use fuzzy::{
    diagnostic::nearest,
    format::TermSpans,
    model::{MembershipFunction, Term},
};

use crate::{
    Format, formula,
    model_draft::{ModelDraft, number},
    shapes::{self, Shape},
};

/// Whether a term is a number.
pub(super) fn is_number(term: &Term) -> bool {
    matches!(
        term.membership_function,
        MembershipFunction::Singleton { .. }
    )
}

/// Whether the words after `:=` name a shape, rather than points or a number.
pub(super) fn is_named(words: &[&str]) -> bool {
    words
        .first()
        .is_some_and(|first| *first != "(" && number(first).is_none())
}

/// Reads a term from the words after `:=`. In an output with computed values a number is a constant.
pub(super) fn read(
    draft: &mut ModelDraft<'_>,
    variable: &str,
    name: &str,
    words: &[&str],
) -> Option<(Term, TermSpans)> {
    let mut spans = TermSpans::default();
    spans.name = draft.span(name);
    let Some((&first, rest)) = words.split_first() else {
        let message = format!("the term `{name}` has no membership function");
        draft.error("no-term", name, message, "write `TERM low := TRIAN 0 1 2;`");
        return None;
    };
    let (function, parameters) = if first == "(" {
        points(draft, words)?
    } else if number(first).is_some() && rest.is_empty() {
        (
            MembershipFunction::Singleton {
                at: draft.number(first)?,
            },
            vec![first],
        )
    } else if first.eq_ignore_ascii_case("FUNCTION") {
        (formula::read(draft, rest, None)?, vec![])
    } else {
        shape(draft, variable, first, rest)?
    };
    spans.parameters = parameters.iter().map(|word| draft.span(word)).collect();
    let term = Term {
        name: name.to_owned(),
        membership_function: function,
        height: 1.0,
        lower: None,
    };
    Some((term, spans))
}

fn shape<'t>(
    draft: &mut ModelDraft<'_>,
    variable: &str,
    shape: &str,
    words: &[&'t str],
) -> Option<(MembershipFunction, Vec<&'t str>)> {
    let found = [Format::Fcl, Format::Fll]
        .into_iter()
        .find_map(|format| Some((format, shapes::named(format, shape)?)));
    let Some((format, (known, count))) = found else {
        let names = shapes::names(Format::Fcl).chain(shapes::names(Format::Fll));
        let help = match nearest(shape, names) {
            Some(near) => format!("did you mean `{near}`?"),
            None => "known shapes are TRIAN, TRAPE, GAUSS, GAUSS2, GBELL, SIGM, DSIGM, COSINE, points and those of fuzzylite".into(),
        };
        let message = format!("unknown shape `{shape}`");
        draft.error("unknown-shape", shape, message, &help);
        return None;
    };
    let mut numbers = vec![];
    for word in words {
        numbers.push(draft.number(word)?);
    }
    if numbers.len() != count {
        let message = format!("`{shape}` has {count} parameters, found {}", numbers.len());
        let help = format!("write `{shape} {}`", shapes::parameters(format, known));
        draft.error("parameter-count", shape, message, &help);
        return None;
    }
    if !draft.is_finite(known, &numbers, words) {
        return None;
    }
    let function = match (known, &numbers[..]) {
        // jFuzzyLogic uses 0 if the difference is negative, not its absolute value.
        (Shape::SigmoidDifference, [a, b, c, d]) if format == Format::Fcl && (a != c || b > d) => {
            let x = formula::quoted(variable);
            let sigmoid =
                |slope: &f64, place: &f64| format!("1 / (1 + exp(-({slope}) * ({x} - ({place}))))");
            let text = format!("max(0, {} - {})", sigmoid(a, b), sigmoid(c, d));
            MembershipFunction::Function {
                formula: text.parse().ok()?,
            }
        }
        _ => shapes::read(format, known, &numbers)?,
    };
    Some((function, words.to_vec()))
}

/// Reads `(x, y) (x, y) ...`.
fn points<'t>(
    draft: &mut ModelDraft<'_>,
    words: &[&'t str],
) -> Option<(MembershipFunction, Vec<&'t str>)> {
    let mut points = vec![];
    let mut parameters = vec![];
    for point in words.chunks(5) {
        let ["(", x, ",", y, ")"] = *point else {
            let part = point.first().copied().unwrap_or_default();
            let message = format!("expected a point at `{part}`");
            draft.error("fcl-syntax", part, message, "write `(0, 0) (5, 1) (10, 0)`");
            return None;
        };
        points.push((draft.number(x)?, draft.number(y)?));
        parameters.extend([x, y]);
    }
    Some((MembershipFunction::Piecewise { points }, parameters))
}
