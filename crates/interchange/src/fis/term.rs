//! Terms of FIS: `'name':'shape',[parameters]`.

use fuzzy::{
    diagnostic::nearest,
    format::TermSpans,
    model::{MembershipFunction, Term},
};

use super::read::{bracketed, number, unquoted};
use crate::{Format, draft::Draft, shapes};

const OTHERS: [&str; 3] = ["discretemf", "constant", "linear"];

pub(super) fn read(
    draft: &mut Draft<'_>,
    written: &str,
    inputs: &[&str],
) -> Option<(Term, TermSpans)> {
    let parts = written
        .split_once(':')
        .and_then(|(name, rest)| Some((name, rest.split_once(',')?)));
    let Some((name, (shape, parameters))) = parts else {
        let message = format!("`{written}` is not a term");
        let help = "write `MF1='low':'trimf',[0 1 2]`";
        draft.error("no-term", written, message, help);
        return None;
    };
    let (name, shape) = (unquoted(name), unquoted(shape));
    let mut spans = TermSpans::default();
    spans.name = draft.span(name);
    let mut numbers = vec![];
    let words = bracketed(parameters);
    for word in &words {
        numbers.push(number(draft, word)?);
        spans.parameters.push(draft.span(word));
    }
    let (function, count) = match shape.to_ascii_lowercase().as_str() {
        "constant" => {
            let value = numbers.first().copied().unwrap_or(f64::NAN);
            (MembershipFunction::Constant { value }, 1)
        }
        "linear" => (shapes::linear(&numbers, inputs), inputs.len() + 1),
        "discretemf" => {
            let pairs = numbers.chunks_exact(2).map(|pair| (pair[0], pair[1]));
            let points = pairs.collect();
            (
                MembershipFunction::Piecewise { points },
                numbers.len() / 2 * 2,
            )
        }
        _ => {
            let Some((known, count)) = shapes::named(Format::Fis, shape) else {
                let names = shapes::names(Format::Fis).chain(OTHERS);
                let help = match nearest(shape, names) {
                    Some(near) => format!("did you mean `{near}`?"),
                    None => "functions of your own cannot be read".into(),
                };
                let message = format!("unknown shape `{shape}`");
                draft.error("unknown-shape", shape, message, &help);
                return None;
            };
            let own = numbers.get(..count).unwrap_or(&numbers);
            if !draft.is_finite(known, own, &words) {
                return None;
            }
            (shapes::read(Format::Fis, known, own)?, count)
        }
    };
    if numbers.len() < count {
        let message = format!("`{shape}` has {count} parameters, found {}", numbers.len());
        draft.error("parameter-count", shape, message, "count the numbers");
        return None;
    }
    // Old files pad the parameters of every shape to four numbers.
    if numbers.len() > count
        && numbers
            .get(count..)
            .is_some_and(|rest| rest.iter().any(|&x| x != 0.0))
    {
        let message = format!("`{shape}` has {count} parameters, found {}", numbers.len());
        draft.warning(
            "parameter-count",
            shape,
            message,
            "the numbers behind them are left out",
        );
    }
    spans.parameters.truncate(count);
    let term = Term {
        name: name.to_owned(),
        membership_function: function,
        height: 1.0,
        lower: None,
    };
    Some((term, spans))
}
