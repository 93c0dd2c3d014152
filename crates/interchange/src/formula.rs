//! Formulas of FLL and FCL.

use fuzzy::model::{Formula, MembershipFunction};

use crate::{model_draft::ModelDraft, words::is_name};

/// Reads a term that is given by a formula; `words` are slices of the text of `draft`. If the formula is a fuzzy set,
/// `own` is the variable that FLL calls `x`.
pub(crate) fn read(
    draft: &mut ModelDraft<'_>,
    words: &[&str],
    own: Option<&str>,
) -> Option<MembershipFunction> {
    let mut text = String::new();
    for (index, word) in words.iter().enumerate() {
        let is_call = words.get(index + 1) == Some(&"(");
        match own {
            Some(own) if *word == "x" => text.push_str(&quoted(own)),
            // jFuzzyLogic writes functions in capitals.
            _ if is_call && is_name(word) => text.push_str(&word.to_ascii_lowercase()),
            _ => text.push_str(word),
        }
        text.push(' ');
    }
    match text.trim().parse::<Formula>() {
        Ok(formula) => Some(MembershipFunction::Function { formula }),
        Err(finding) => {
            let part = words.first().copied().unwrap_or_default();
            let message = format!("the formula cannot be read: {}", finding.message);
            let help = finding.help.unwrap_or_else(|| "write it as points".into());
            draft.loss("formula", part, message, &help);
            None
        }
    }
}

/// Returns a name in the syntax of formulas.
pub(crate) fn quoted(name: &str) -> String {
    match is_name(name) {
        true => name.to_owned(),
        false => format!("'{}'", name.replace('\\', "\\\\").replace('\'', "\\'")),
    }
}

/// Splits a formula into names, numbers and symbols.
pub(crate) fn words(text: &str) -> Vec<&str> {
    let mut words = vec![];
    let mut rest = text.trim_start();
    while let Some(first) = rest.chars().next() {
        let in_word = |c: char| c.is_alphanumeric() || c == '_' || c == '.';
        let length = match in_word(first) {
            true => rest.find(|c| !in_word(c)).unwrap_or(rest.len()),
            false => first.len_utf8(),
        };
        let (word, after) = rest.split_at(length);
        words.push(word);
        rest = after.trim_start();
    }
    words
}

/// Writes a formula that [`read`] and fuzzylite can parse. fuzzylite supports no signs before operands, and supports
/// comparisons only as functions. `own` is written as `x`.
pub(crate) fn write(formula: &Formula, own: Option<&str>) -> String {
    let number = |value: f64| {
        FormulaText::whole(match value < 0.0 {
            true => format!("(0 - {})", -value),
            false => value.to_string(),
        })
    };
    let variable = |name: &str| {
        FormulaText::whole(match own == Some(name) {
            true => "x".to_owned(),
            false => name.to_owned(),
        })
    };
    formula.fold(&number, &variable, &apply).text
}

/// Returns the formula with each name replaced by the result of `name`.
pub(crate) fn renamed(formula: &Formula, name: impl Fn(&str) -> String) -> Formula {
    let number = |value: f64| value.to_string();
    let variable = |before: &str| quoted(&name(before));
    let apply = |word: &str, operands: Vec<String>| match operands.as_slice() {
        [of] if word == "-" || word == "not" => format!("({word} {of})"),
        [a, b] if is_name(word) && word != "and" && word != "or" => format!("{word}({a}, {b})"),
        [a, b] => format!("({a} {word} {b})"),
        _ => format!("{word}({})", operands.join(", ")),
    };
    let text = formula.fold(&number, &variable, &apply);
    text.parse().unwrap_or_else(|_| formula.clone())
}

/// A part of a formula, and the precedence of its operator.
struct FormulaText {
    text: String,
    binds: u8,
}

impl FormulaText {
    /// A part that needs no brackets.
    fn whole(text: String) -> Self {
        FormulaText { text, binds: 4 }
    }

    /// The part as an operand: in brackets if its precedence is lower.
    fn within(self, binds: u8) -> String {
        match self.binds < binds {
            true => format!("({})", self.text),
            false => self.text,
        }
    }
}

fn apply(word: &str, mut operands: Vec<FormulaText>) -> FormulaText {
    let binds = match word {
        "+" | "-" => 1,
        "*" | "/" | "%" => 2,
        "^" => 3,
        _ => 0,
    };
    if binds > 0
        && operands.len() == 2
        && let (Some(right), Some(left)) = (operands.pop(), operands.pop())
    {
        // Powers are put in brackets on both sides, because not all programs nest them to the right.
        let left = left.within(binds + u8::from(word == "^"));
        let text = format!("{left} {word} {}", right.within(binds + 1));
        return FormulaText { text, binds };
    }
    let called = match word {
        "<" => "lt",
        "<=" => "le",
        ">" => "gt",
        ">=" => "ge",
        "==" => "eq",
        "!=" => "neq",
        _ => word,
    };
    let texts: Vec<String> = operands.into_iter().map(|of| of.text).collect();
    FormulaText::whole(match (word, texts.as_slice()) {
        ("-", [of]) => format!("(0 - ({of}))"),
        ("not", [of]) => format!("eq({of}, 0)"),
        // Every number except 0 is true.
        ("and", [a, b]) => format!("min(neq({a}, 0), neq({b}, 0))"),
        ("or", [a, b]) => format!("max(neq({a}, 0), neq({b}, 0))"),
        _ => format!("{called}({})", texts.join(", ")),
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    const FORMULAS: [&str; 8] = [
        "-x^2 + 3 * (y - 2) / (x - (y - 1))",
        "2 - (3 - x) - y",
        "x^y^2 + (x^y)^2 + (-x)^3",
        "not (x > y) or x >= 0.5 and y != x",
        "max(abs(x), sqrt(y)) % 3",
        "atan2(y, x) * pi",
        "-(-x)",
        "x / (y * 2) * 4",
    ];

    /// Asserts that both formulas have the same values at some points.
    fn assert_same(before: &Formula, after: &Formula, names: [&str; 2]) {
        for x in [-1.5, 0.0, 0.25, 2.0] {
            for y in [0.5, 1.0, 3.0] {
                let value = |formula: &Formula, names: [&str; 2]| {
                    formula
                        .evaluate(|name| if name == names[0] { x } else { y })
                        .to_bits()
                };
                assert_eq!(
                    value(before, ["x", "y"]),
                    value(after, names),
                    "{before}: {after}"
                );
            }
        }
    }

    #[test]
    fn written_formulas_read_back_with_the_same_values() {
        for text in FORMULAS {
            let formula: Formula = text.parse().unwrap();
            let written = write(&formula, None);
            assert!(
                !written.contains("(-") && !written.contains("- -"),
                "{written}"
            );
            assert_same(&formula, &written.parse().unwrap(), ["x", "y"]);
            let renamed = renamed(&formula, |name| format!("the {name}"));
            assert_same(&formula, &renamed, ["the x", "the y"]);
        }
        let heat: Formula = "2 * heat - wind".parse().unwrap();
        assert_eq!(write(&heat, Some("heat")), "2 * x - wind");
        let long: Formula = ["x"; 200].join(" + ").parse().unwrap();
        assert_eq!(write(&long, None), ["x"; 200].join(" + "));
    }
}
