//! Formulas of FLL and FCL.

use fuzzy::model::{Formula, MembershipFunction};

use crate::{draft::Draft, words::is_name};

/// A term given by a formula, of words that are parts of the text. `own` is the variable that FLL calls `x`, where the formula is a
/// fuzzy set.
pub(crate) fn read(
    draft: &mut Draft<'_>,
    words: &[&str],
    own: Option<&str>,
) -> Option<MembershipFunction> {
    let mut text = String::new();
    for (index, word) in words.iter().enumerate() {
        let is_call = words.get(index + 1) == Some(&"(");
        match own {
            Some(own) if *word == "x" => text.push_str(&quoted(own)),
            // jFuzzyLogic writes functions in capitals.
            _ if is_call && is_name(word) => text.push_str(&word.to_lowercase()),
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

/// A name as formulas write it.
pub(crate) fn quoted(name: &str) -> String {
    match is_name(name) {
        true => name.to_owned(),
        false => format!("'{}'", name.replace('\\', "\\\\").replace('\'', "\\'")),
    }
}

/// Names, numbers and signs of a formula.
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
