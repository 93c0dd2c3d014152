//! Terms of FIS: `'name':'shape',[parameters]`.

use fuzzy::{
    diagnostic::nearest,
    format::TermSpans,
    model::{MembershipFunction, Term},
};

use super::read::{bracketed, number, unquoted};
use crate::{Format, model_draft::ModelDraft, shapes};

const OTHERS: [&str; 3] = ["discretemf", "constant", "linear"];

/// Whether a character is a curly quote, as word processors insert it.
fn is_curly(c: char) -> bool {
    matches!(c, '\u{2018}'..='\u{201f}')
}

/// The first number that contains a comma, if the numbers of the list are separated by blanks: `1,5` in `[1,5 0]`.
fn decimal_comma(parameters: &str) -> Option<&str> {
    let inner = parameters
        .trim()
        .trim_start_matches('[')
        .trim_end_matches(']');
    let mut words = inner.split_whitespace();
    let has_blanks = words.clone().count() > 1;
    words.find(|word| {
        let parts = word.split_once(',');
        let is_digits = |part: &str| !part.is_empty() && part.bytes().all(|c| c.is_ascii_digit());
        has_blanks
            && parts.is_some_and(|(whole, part)| {
                is_digits(whole.trim_start_matches('-')) && is_digits(part)
            })
    })
}

/// The parameters that a term has besides those of its shape.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum ParameterForm {
    /// No other parameters.
    Plain,
    /// The height, as the last parameter.
    WithHeight,
    /// All parameters once more, for the upper end of an interval of numbers.
    Repeated,
}

pub(super) fn read(
    draft: &mut ModelDraft<'_>,
    written: &str,
    inputs: &[&str],
    parameter_form: ParameterForm,
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
    if name.starts_with(is_curly) || name.ends_with(is_curly) {
        let message = format!("the typographic quotes become part of the name `{name}`");
        let bare = name.trim_matches(is_curly);
        let help = format!("write straight quotes: `'{bare}'`");
        draft.warning("typographic-quotes", name, message, &help);
    }
    let mut numbers = vec![];
    let words = bracketed(parameters);
    for word in &words {
        numbers.push(number(draft, word)?);
        spans.parameters.push(draft.span(word));
    }
    let height = match parameter_form {
        ParameterForm::WithHeight => {
            spans.parameters.pop();
            numbers.pop().unwrap_or(f64::NAN)
        }
        ParameterForm::Plain | ParameterForm::Repeated => 1.0,
    };
    let mut form = String::new();
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
            form = shapes::parameters(Format::Fis, known);
            let own = numbers.get(..count).unwrap_or(&numbers);
            if !draft.is_finite(known, own, &words) {
                return None;
            }
            (shapes::read(Format::Fis, known, own)?, count)
        }
    };
    let has_height = parameter_form == ParameterForm::WithHeight;
    if numbers.len() < count || (has_height && numbers.len() > count) {
        let (and, last) = match has_height {
            true => (" and a height", " height"),
            false => ("", ""),
        };
        let message = format!(
            "`{shape}` has {count} parameters{and}, found {}",
            words.len()
        );
        let help = match form.is_empty() {
            true => "write a number for each input, and the constant".into(),
            false => format!("write `[{form}{last}]`"),
        };
        draft.error("parameter-count", shape, message, &help);
        return None;
    }
    if numbers.len() > count
        && let Some(number) = decimal_comma(parameters)
    {
        let message = format!("`{shape}` has {count} parameters, found {}", numbers.len());
        let point = number.replacen(',', ".", 1);
        let help = format!("is `{number}` a decimal comma? write `{point}`");
        draft.error("parameter-count", number, message, &help);
        return None;
    }
    if parameter_form == ParameterForm::Repeated
        && let Some((first, second)) = numbers.split_at_checked(count)
        && second.len() == count
    {
        if first != second {
            let message = format!("the numbers of the term `{name}` are intervals");
            let help = "a rule set has single numbers: repeat the same ones, or write a rule set for each end";
            draft.loss("interval-of-numbers", parameters, message, help);
        }
        numbers.truncate(count);
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
            "the numbers after them are left out",
        );
    }
    spans.parameters.truncate(count);
    let term = Term {
        name: name.to_owned(),
        membership_function: function,
        height,
        lower: None,
    };
    Some((term, spans))
}
