//! Suggestions for a wrong or missing word between the parts of a rule.

use alloc::{format, string::String, vec::Vec};

use super::{CONNECTIVES, KnownNames, comparison::not_a_number, condition::in_list};
use crate::{
    diagnostic::{is_curly_quote, listed},
    rule::{
        Hedge, Rule, is_plain_name,
        parse::{is_name_letter, keyword, quoted, word},
    },
};

/// Returns a name as it is written in a rule.
pub(super) fn quoted_name(name: &str) -> String {
    match is_plain_name(name) {
        true => name.into(),
        false => format!("\"{name}\""),
    }
}

/// Returns the first names of a list, for a choice of one: `` `dry` or `humid` ``.
pub(super) fn one_of(names: &[&str]) -> String {
    const MOST: usize = 6;
    match names.get(..MOST) {
        Some(first) => format!("{} ...", listed(first)),
        None => crate::diagnostic::either(names),
    }
}

/// Returns the connective for a word of natural language between two conditions.
pub(super) fn joining(word: &str) -> Option<&'static str> {
    let is = |known: &[&str]| known.iter().any(|one| word.eq_ignore_ascii_case(one));
    if is(&["UNLESS", "EXCEPT"]) {
        Some("AND NOT")
    } else if is(&["BUT", "PLUS", "WHILE"]) {
        Some("AND")
    } else {
        None
    }
}

/// Returns a suggestion for a hedge before an input, such as `very water IS hot`.
pub(super) fn before_input(rest: &str) -> String {
    let words: Vec<&str> = rest.split_whitespace().collect();
    match words.as_slice() {
        [hedge, input, is, term, ..] if is.eq_ignore_ascii_case("IS") => {
            let term = term.trim_end_matches(')');
            format!("write `{input} IS {hedge} {term}`")
        }
        _ => "write `input IS very term`".into(),
    }
}

/// Returns a suggestion if a name was expected, but there is a keyword or the end of the rule.
pub(super) fn name_is_missing(
    what: &str,
    rest: &str,
    before: &str,
    known: KnownNames<'_>,
) -> Option<String> {
    let found = found_here(rest);
    let is = |word: &str| found.eq_ignore_ascii_case(word);
    let input = what.contains("input");
    let last = before.split_whitespace().next_back().unwrap_or("");
    if input && found.starts_with('/') {
        return Some("write either `AND` or `OR`".into());
    }
    if input && is("IS") {
        let term = rest.split_whitespace().nth(1).unwrap_or("term");
        let name = last_input(before).unwrap_or("input");
        return Some(format!("name the input again: `{last} {name} IS {term}`"));
    }
    if input && is("IF") {
        return Some("remove the second `IF`".into());
    }
    if input && (is("THEN") || is("AND") || is("OR")) {
        return Some(match last.eq_ignore_ascii_case("IF") {
            true => format!("add a condition after `{last}`: `input IS term`"),
            false => format!("add a condition after `{last}`, or remove `{last}`"),
        });
    }
    // For example `humidity IS not THEN`, with a term `not`.
    let terms = last_input(before).map_or(&[][..], |name| known.terms(name));
    let is_term = |word: &str| {
        Rule::is_keyword(word) && terms.iter().any(|term| term.eq_ignore_ascii_case(word))
    };
    if let Some(word) = [last, found].into_iter().find(|word| is_term(word)) {
        return Some(format!(
            "`{word}` is a keyword: to use it as a term, put it in quotes: `IS \"{word}\"`"
        ));
    }
    if found.is_empty() {
        return Some(match what {
            "an output name" => "add a conclusion: `THEN output IS term`".into(),
            _ if input => "add a condition: `input IS term`".into(),
            _ => "add a term".into(),
        });
    }
    if what == "an output name" && is("IF") {
        return Some(
            "a rule can have only one `IF`: join the conditions with `AND` before `THEN`".into(),
        );
    }
    if what == "an output name" && found == "(" {
        let (inside, behind) = rest.split_once(')').unwrap_or((rest, ""));
        let inside = inside.trim_start_matches(['(', ' ']);
        let weight = behind.trim().trim_matches(['(', ')', '[', ']']);
        return Some(match weight.parse::<f64>() {
            Ok(weight) => format!(
                "write the conclusion without brackets, and the weight after `WITH`: `THEN {inside} WITH {weight}`"
            ),
            Err(_) => format!("write the conclusion without brackets: `THEN {inside}`"),
        });
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
        let inside = rest.trim_start_matches('(').split(')').next().unwrap_or("");
        return Some(format!(
            "write the term without brackets: `IS {}`",
            inside.trim()
        ));
    }
    if what == "an output name" && is(":") {
        return Some("remove the colon".into());
    }
    if what == "an output name" && is("THEN") {
        return Some("remove the second `THEN`".into());
    }
    if CONNECTIVES.iter().any(|connective| is(connective)) {
        return Some(format!("add a term before `{found}`"));
    }
    Rule::is_keyword(found).then(|| {
        format!(
            "`{found}` is a keyword: write a name in its place, or put it in quotes if it is a name: `\"{found}\"`"
        )
    })
}

/// Returns a suggestion for `x IS (low OR high)`, `x IS NOT (low OR high)` and `x IS very (low OR high)`.
fn terms_in_brackets(rest: &str, before: &str) -> Option<String> {
    let (inside, _) = rest.strip_prefix('(')?.split_once(')')?;
    let words: Vec<&str> = inside.split_whitespace().collect();
    let input = last_input(before)?;
    let last = before.split_whitespace().rev();
    let hedges = last.take_while(|word| !word.eq_ignore_ascii_case("IS"));
    let mut hedges: Vec<&str> = hedges.collect();
    let is_negated = hedges
        .last()
        .is_some_and(|word| word.eq_ignore_ascii_case("NOT"));
    if is_negated {
        hedges.pop();
    }
    hedges.reverse();
    let hedged = hedges
        .iter()
        .fold(String::new(), |all, hedge| all + hedge + " ");
    let part = |(i, word): (usize, &&str)| match i % 2 {
        0 => (is_plain_name(word) && !Rule::is_keyword(word))
            .then(|| format!("{input} IS {hedged}{word}")),
        _ => {
            let connective = word.to_ascii_uppercase();
            ["AND", "OR"]
                .contains(&connective.as_str())
                .then_some(connective)
        }
    };
    let parts: Vec<String> = words.iter().enumerate().map(part).collect::<Option<_>>()?;
    let joined = (parts.len() >= 3 && parts.len() % 2 == 1).then(|| parts.join(" "))?;
    let not = if is_negated { "NOT " } else { "" };
    Some(format!("write `{not}({joined})`"))
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
    let mut words = rest.split_whitespace();
    if numbered {
        "begin the rule with `IF`, without a name or number".into()
    } else if words
        .nth(1)
        .is_some_and(|word| word.eq_ignore_ascii_case("IS"))
    {
        match found_here(rest) {
            found if found.starts_with("IF") => "write a space after `IF`".into(),
            found => format!("write `IF` before `{found}`"),
        }
    } else {
        "write the rule as `IF input IS term THEN output IS term`".into()
    }
}

/// Returns a suggestion for a condition that is not followed by AND, OR or THEN.
pub(super) fn connective(before: &str, rest: &str, known: KnownNames<'_>) -> Option<String> {
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
    let input = last_input(before).unwrap_or("input");
    if last.parse::<f64>().is_ok() {
        return Some(not_a_number(input));
    }
    // For example `temperature IS NOT IN (cold, mild)`.
    if last.eq_ignore_ascii_case("IN") {
        let mut words = before.split_whitespace().rev();
        let is_negated = words
            .nth(1)
            .is_some_and(|word| word.eq_ignore_ascii_case("NOT"));
        return in_list(input, rest, is_negated);
    }
    match found {
        "," if known.is_output(next) => return Some("write `THEN` in place of the comma".into()),
        "," if known.variable(next).is_some() => {
            return Some("write `AND` or `OR` in place of the comma".into());
        }
        "," if next.eq_ignore_ascii_case("THEN") => return Some("remove the comma".into()),
        "," => return Some("write `AND` or `THEN` in place of the comma".into()),
        ";" => return Some("remove the semicolon".into()),
        ")" => return Some("this `)` has no matching `(`: remove the `)`, or add a `(`".into()),
        "" => return Some("add a conclusion: `THEN output IS term`".into()),
        _ => {}
    }
    if Hedge::ALL
        .iter()
        .any(|hedge| hedge.word().eq_ignore_ascii_case(found))
    {
        return Some(format!(
            "write the hedge before the term: `{input} IS {found} {last}`"
        ));
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
    is_cut.then(|| "the rule seems to be cut off: complete it with `THEN output IS term`".into())
}

/// Returns a suggestion for an operator of another language.
pub(super) fn sign(rest: &str) -> Option<String> {
    let found = found_here(rest);
    let found = found.trim_end_matches(['(', ')']);
    let word = match found {
        "&" | "&&" => "AND",
        "|" | "||" => "OR",
        "!" | "~" => "NOT",
        "=" | "==" | ":" | ":=" => "IS",
        "!=" | "<>" => "IS NOT",
        "=>" | "->" => "THEN",
        _ if found.starts_with("//") => {
            return Some("a comment begins with `#`, not with `//`".into());
        }
        _ if found.starts_with(is_curly_quote) => {
            return Some("write straight quotes: `\"`".into());
        }
        _ if found.starts_with('`') => return Some("write the name without backticks".into()),
        _ => return None,
    };
    Some(format!("write `{word}` in place of `{found}`"))
}

/// Returns the token at this position, as messages quote it: a word, a name with its quotes, or an operator.
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

/// Returns the variable of the last condition or conclusion of a text, such as `x` for `IF x IS low OR`.
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
