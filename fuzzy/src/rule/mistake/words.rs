//! Suggestions for a wrong or missing word between the parts of a rule.

use alloc::{format, string::String, vec::Vec};

use super::CONNECTIVES;
use crate::{
    diagnostic::is_curly_quote,
    rule::{
        Hedge, Rule, is_plain_name,
        parse::{is_name_letter, keyword, quoted, word},
    },
};

/// Returns a suggestion if a name was expected, but there is a keyword or the end of the rule.
pub(super) fn name_is_missing(what: &str, rest: &str, before: &str) -> Option<String> {
    let found = found_here(rest);
    let is = |word: &str| found.eq_ignore_ascii_case(word);
    let input = what.contains("input");
    if input && found.starts_with('/') {
        return Some("write `AND` or `OR`".into());
    }
    if input && is("IS") {
        return Some("name the input again: `AND input IS term`".into());
    }
    if input && is("IF") {
        return Some("write `IF` once".into());
    }
    if input && (is("THEN") || is("AND") || is("OR")) {
        return Some(
            "add a condition before it, `input IS term`, or remove the word before it".into(),
        );
    }
    if found.is_empty() {
        return Some(match what {
            "the name of an output" => "add a conclusion: `THEN output IS term`".into(),
            _ if input => "add a condition: `input IS term`".into(),
            _ => "add a term".into(),
        });
    }
    if what == "the name of an output" && is("IF") {
        return Some("a rule has one `IF`: join the conditions by `AND` before `THEN`".into());
    }
    if what == "the name of an output" && found == "(" {
        return Some("write the conclusion without brackets, and a weight as `WITH 0.5`".into());
    }
    if !input && is("IS") {
        return Some("remove the second `IS`".into());
    }
    if what.contains("a term or a hedge")
        && let Some(help) = terms_in_brackets(rest, before)
    {
        return Some(help);
    }
    if what.contains("term") && found == "(" {
        return Some("write the term without brackets: `IS very low`".into());
    }
    if what == "the name of an output" && is(":") {
        return Some("remove the colon".into());
    }
    if what == "the name of an output" && is("THEN") {
        return Some("remove the second `THEN`".into());
    }
    if CONNECTIVES.iter().any(|connective| is(connective)) {
        return Some(format!("add a term before `{found}`"));
    }
    Rule::is_keyword(found).then(|| {
        format!(
            "`{found}` is a word of the rule language; put it in quotes as a name: `\"{found}\"`"
        )
    })
}

/// Returns a suggestion for `x IS (low OR high)` and `x IS NOT (low OR high)`.
fn terms_in_brackets(rest: &str, before: &str) -> Option<String> {
    let (inside, _) = rest.strip_prefix('(')?.split_once(')')?;
    let words: Vec<&str> = inside.split_whitespace().collect();
    let input = last_input(before)?;
    let part = |(i, word): (usize, &&str)| match i % 2 {
        0 => (is_plain_name(word) && !Rule::is_keyword(word)).then(|| format!("{input} IS {word}")),
        _ => {
            let connective = word.to_ascii_uppercase();
            ["AND", "OR"]
                .contains(&connective.as_str())
                .then_some(connective)
        }
    };
    let parts: Vec<String> = words.iter().enumerate().map(part).collect::<Option<_>>()?;
    let joined = (parts.len() >= 3 && parts.len() % 2 == 1).then(|| parts.join(" "))?;
    let last = before.split_whitespace().next_back()?;
    match last {
        _ if last.eq_ignore_ascii_case("IS") => Some(format!("write `({joined})`")),
        _ if last.eq_ignore_ascii_case("NOT") => Some(format!("write `NOT ({joined})`")),
        _ => None,
    }
}

/// Returns a suggestion for a rule that does not start with IF.
pub(super) fn at_start(rest: &str) -> String {
    if ["WHEN", "WHENEVER"]
        .iter()
        .any(|word| found_here(rest).eq_ignore_ascii_case(word))
    {
        return format!("write `IF` in place of `{}`", found_here(rest));
    }
    if let Some(help) = sign(rest).filter(|_| rest.starts_with(is_curly_quote)) {
        return help;
    }
    let numbered = rest
        .split_whitespace()
        .take(4)
        .any(|word| word.eq_ignore_ascii_case("IF"));
    if numbered {
        "begin with `IF`; rules have no names or numbers".into()
    } else {
        "a rule reads `IF input IS term THEN output IS term`".into()
    }
}

/// Returns a suggestion for a condition that is not followed by AND, OR or THEN.
pub(super) fn connective(before: &str, rest: &str) -> Option<String> {
    let found = found_here(rest);
    let behind = rest.get(found.len()..).unwrap_or("").trim_start();
    let last = before.split_whitespace().next_back().unwrap_or("");
    // For example `temperature IS cold, mild`.
    let next = found_here(behind);
    if matches!(found, "," | "/")
        && is_plain_name(next)
        && keyword(behind.get(next.len()..).unwrap_or(""), "IS").is_none()
        && let Some(input) = last_input(before)
    {
        return Some(format!("write `OR {input} IS {next}`"));
    }
    if found.eq_ignore_ascii_case("IS") {
        return Some(match last_input(before) {
            Some(input) if input == last => format!("remove one `{input} IS`"),
            _ => format!("write `AND` or `OR` before `{last}`"),
        });
    }
    if last.parse::<f64>().is_ok() {
        let help = "a condition names a term of the input, not a number; give the input a term for these values";
        return Some(help.into());
    }
    match found {
        "," => return Some("write `AND` or `THEN`".into()),
        ";" => return Some("remove it".into()),
        ")" => return Some("there is no `(` before it; remove it, or add one".into()),
        "" => return Some("add a conclusion: `THEN output IS term`".into()),
        _ => {}
    }
    if Hedge::ALL
        .iter()
        .any(|hedge| hedge.word().eq_ignore_ascii_case(found))
    {
        return Some("write a hedge before the term: `input IS very low`".into());
    }
    let (behind, _) = word(rest).ok()?;
    let has_then = rest
        .split_whitespace()
        .any(|word| word.eq_ignore_ascii_case("THEN"));
    if !is_plain_name(found) {
        return None;
    }
    if keyword(behind, "IS").is_some() {
        let connective = if has_then { "AND" } else { "THEN" };
        return Some(format!("write `{connective}` before `{found}`"));
    }
    // For example `IF x IS hot so y IS fast`, and `IF x IS hot ET y IS damp THEN`.
    let (after_next, next) = word(behind).ok()?;
    if is_plain_name(next) && keyword(after_next, "IS").is_some() {
        let connective = if has_then { "AND` or `OR" } else { "THEN" };
        return Some(format!("write `{connective}` in place of `{found}`"));
    }
    // For example `IF x IS hot T`.
    let is_cut = behind.trim().is_empty() && "THEN".starts_with(&found.to_ascii_uppercase());
    is_cut.then(|| "the rule seems to be cut off; it ends with `THEN output IS term`".into())
}

/// Returns a suggestion for an operator of another language.
pub(super) fn sign(rest: &str) -> Option<String> {
    let found = found_here(rest);
    let found = found.trim_end_matches(['(', ')']);
    let text = match found {
        "&" | "&&" => "write `AND`",
        "|" | "||" => "write `OR`",
        "!" | "~" => "write `NOT`",
        "=" | "==" | ":" | ":=" => "write `IS`",
        "!=" | "<>" => "write `IS NOT`",
        "=>" | "->" => "write `THEN`",
        _ if found.starts_with("//") => "a comment begins with `#`",
        _ if found.starts_with(is_curly_quote) => "write straight quotes: `\"`",
        _ if found.starts_with('`') => "write a name without quotes, or in double quotes: `\"`",
        _ => return None,
    };
    Some(text.into())
}

/// Returns the token at this position as an author would quote it: a word, a quoted name, or an operator.
pub(super) fn found_here(rest: &str) -> &str {
    const LONGEST: usize = 40;
    let end = |in_it: fn(char) -> bool| {
        let at = rest
            .char_indices()
            .take(LONGEST)
            .find(|&(_, c)| !in_it(c))
            .map(|(at, _)| at);
        let most = rest
            .char_indices()
            .nth(LONGEST)
            .map_or(rest.len(), |(at, _)| at);
        at.unwrap_or(most)
    };
    let Some(first) = rest.chars().next() else {
        return "";
    };
    let length = match first {
        '"' | '\'' => match quoted(rest, first) {
            Ok((after, _)) => rest.len() - after.len(),
            Err(_) => end(|c| c != '\n'),
        },
        '(' | ')' => 1,
        '-' if rest.starts_with("->") => 2,
        _ if is_name_letter(first) || first == '+' => end(|c| is_name_letter(c) || c == '+'),
        _ => end(|c| !is_name_letter(c) && !c.is_whitespace() && !matches!(c, '"' | '\'')),
    };
    rest.get(..length).unwrap_or(rest)
}

/// Returns the input of the last condition of a text, such as `x` for `IF x IS low OR`.
pub(super) fn last_input(before: &str) -> Option<&str> {
    let words = before.split_whitespace().rev();
    let mut owners = words.clone().zip(words.skip(1));
    let after_then = |(word, _): &(&str, &str)| word.eq_ignore_ascii_case("THEN");
    let (_, owner) = owners
        .by_ref()
        .take_while(|pair| !after_then(pair))
        .find(|(word, _)| word.eq_ignore_ascii_case("IS"))?;
    Some(owner.trim_start_matches('('))
}
