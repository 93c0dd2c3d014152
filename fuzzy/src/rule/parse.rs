//! The parser of the rule language.
//!
//! ```text
//! rule        = IF any-of THEN consequent { AND consequent } [ WITH number ]
//! any-of      = all-of { OR all-of }
//! all-of      = condition { AND condition }
//! condition   = NOT condition | "(" any-of ")" | name IS { hedge } name
//! consequent  = name IS { hedge } name
//! ```
//!
//! Keywords are read in any case. `#` starts a comment that ends with its line. A name is letters, digits, `_`, `.`,
//! `-` and `%`; any other, and one that is a keyword, stands in single or double quotes, `\` before a quote or a `\` in it.
//!
//! Whatever keyword has been read commits the parser, so the first mistake met is the furthest one, and every error
//! knows what could have stood in its place.

use alloc::{boxed::Box, string::String, vec::Vec};
use core::ops::Range;

use nom::{
    Err, IResult, Parser,
    bytes::complete::{take_till, take_while, take_while1},
    character::complete::char,
    multi::many0_count,
    sequence::preceded,
};

use super::{
    Condition, Consequent, Hedge, Name, Proposition, Rule, is_plain_name,
    mistake::{Mistake, Wrong},
};
use crate::diagnostic::{Diagnostic, nearest};

/// Brackets and NOTs deeper than this are an error: a tree is walked by recursion.
pub const DEEPEST_NESTING: usize = 64;

/// Reads one rule.
///
/// # Errors
/// The first mistake, with its byte span in `text`, what could have stood there, and what to do.
///
/// # Example
/// ```
/// let rule = fuzzy::rule::parse("if heat is very high or not humidity is low then speed is fast with 0.8")?;
/// assert_eq!(rule.to_string(), "IF heat IS very high OR NOT humidity IS low THEN speed IS fast WITH 0.8");
///
/// let mistake = fuzzy::rule::parse("IF heat IS high THNE speed IS fast").unwrap_err();
/// assert_eq!(mistake.message, "expected `AND`, `OR` or `THEN` after the condition, found `THNE`");
/// assert_eq!(mistake.span, 16..20);
/// assert_eq!(mistake.help.as_deref(), Some("did you mean `THEN`?"));
/// # Ok::<(), Box<fuzzy::diagnostic::Diagnostic>>(())
/// ```
pub fn parse(text: &str) -> Result<Rule, Box<Diagnostic>> {
    parse_with_weight(text).map(|(rule, _)| rule)
}

/// Reads one rule, with the span of its weight: the number behind WITH, or the empty place behind the conclusion.
pub(crate) fn parse_with_weight(text: &str) -> Result<(Rule, Range<usize>), Box<Diagnostic>> {
    let source = Source { text };
    match source.rule(text) {
        Ok((_, found)) => Ok(found),
        Err(Err::Error(mistake) | Err::Failure(mistake)) => Err(Box::new(mistake.explain(text))),
        // Only nom's streaming parsers ask for more, and none is used.
        Err(Err::Incomplete(_)) => Err(Box::new(Diagnostic::error(
            "rule-syntax",
            text.len()..text.len(),
            "the rule ends too early",
        ))),
    }
}

type Step<'a, T> = IResult<&'a str, T, Mistake<'a>>;

fn wrong<'a, T>(rest: &'a str, kind: Wrong<'a>) -> Step<'a, T> {
    Err(Err::Failure(Mistake { rest, kind }))
}

/// Space, line breaks and comments.
fn space(rest: &str) -> Step<'_, ()> {
    let blank = take_while1(char::is_whitespace);
    let comment = preceded(char('#'), take_till(|c| c == '\n'));
    let (rest, _) = many0_count(blank.or(comment)).parse(rest)?;
    Ok((rest, ()))
}

pub(super) fn is_name_letter(c: char) -> bool {
    c.is_alphanumeric() || matches!(c, '_' | '.' | '-' | '%')
}

/// The word here, empty where there is none.
pub(super) fn word(rest: &str) -> Step<'_, &str> {
    let (rest, ()) = space(rest)?;
    take_while(is_name_letter).parse(rest)
}

/// Takes the keyword if it is the next word: keywords end where words end.
pub(super) fn keyword<'a>(rest: &'a str, expected: &str) -> Option<&'a str> {
    let (after, word) = word(rest).ok()?;
    word.eq_ignore_ascii_case(expected).then_some(after)
}

/// Takes the hedge if the next word is one.
fn hedge(rest: &str) -> Option<(&str, Hedge)> {
    Hedge::ALL
        .into_iter()
        .find_map(|hedge| Some((keyword(rest, hedge.word())?, hedge)))
}

struct Source<'a> {
    text: &'a str,
}

impl<'a> Source<'a> {
    fn at(&self, rest: &str) -> usize {
        self.text.len() - rest.len()
    }

    fn rule(&self, rest: &'a str) -> Step<'a, (Rule, Range<usize>)> {
        let Some(rest) = keyword(rest, "IF") else {
            return wrong(rest, Wrong::Keyword(&["IF"], "at the start of a rule"));
        };
        let (rest, condition) = self.any_of(rest, 0)?;
        let Some(mut rest) = keyword(rest, "THEN") else {
            return wrong(rest, Wrong::Joint);
        };
        let mut consequents = Vec::new();
        loop {
            let (after, consequent) = self.consequent(rest)?;
            consequents.push(consequent);
            match keyword(after, "AND") {
                Some(next) => rest = next,
                None => {
                    rest = after;
                    break;
                }
            }
        }
        let (rest, weight, span, expected): (_, _, _, &[&str]) = match keyword(rest, "WITH") {
            Some(rest) => {
                let (number, ()) = space(rest)?;
                let (rest, weight) = weight(number)?;
                (rest, weight, self.at(number)..self.at(rest), &[])
            }
            None => (rest, 1.0, self.at(rest)..self.at(rest), &["AND", "WITH"]),
        };
        let (rest, ()) = space(rest)?;
        if !rest.is_empty() {
            return wrong(rest, Wrong::Keyword(expected, "after the conclusion"));
        }
        let rule = Rule {
            condition,
            consequents,
            weight,
        };
        Ok((rest, (rule, span)))
    }

    fn any_of(&self, rest: &'a str, depth: usize) -> Step<'a, Condition> {
        let (rest, parts) = joined(rest, "OR", |rest| self.all_of(rest, depth))?;
        Ok((rest, one_or(parts, Condition::Or)))
    }

    fn all_of(&self, rest: &'a str, depth: usize) -> Step<'a, Condition> {
        let (rest, parts) = joined(rest, "AND", |rest| self.condition(rest, depth))?;
        Ok((rest, one_or(parts, Condition::And)))
    }

    fn condition(&self, rest: &'a str, depth: usize) -> Step<'a, Condition> {
        let (rest, ()) = space(rest)?;
        if depth > DEEPEST_NESTING {
            return wrong(rest, Wrong::TooDeep);
        }
        if let Some(rest) = keyword(rest, "NOT") {
            let (rest, inner) = self.condition(rest, depth + 1)?;
            return Ok((rest, Condition::Not(Box::new(inner))));
        }
        if let Some(inside) = rest.strip_prefix('(') {
            let (after, inner) = self.any_of(inside, depth + 1)?;
            let (after, ()) = space(after)?;
            return match after.strip_prefix(')') {
                Some(after) => Ok((after, inner)),
                None if after.is_empty() || keyword(after, "THEN").is_some() => {
                    wrong(rest, Wrong::OpenBracket)
                }
                None => wrong(
                    after,
                    Wrong::Keyword(&["AND", "OR", ")"], "after the condition"),
                ),
            };
        }
        if hedge(rest).is_some() {
            return wrong(rest, Wrong::HedgeBeforeInput);
        }
        let start = rest;
        let (rest, variable) = self.name(rest, "the name of an input, `NOT` or `(`")?;
        let Some(mut rest) = keyword(rest, "IS") else {
            return wrong(rest, Wrong::NoIs("input", start));
        };
        let mut hedges = Vec::new();
        while let Some((after, hedge)) = hedge(rest) {
            hedges.push(hedge);
            rest = after;
        }
        // `any` needs no term: whatever follows it that is no name ends the proposition.
        let (after_space, ()) = space(rest)?;
        let names_follow = starts_name(after_space);
        let (rest, term) = if hedges.last() == Some(&Hedge::Any) && !names_follow {
            (rest, None)
        } else {
            let (after, term) = self.name(rest, "a term or a hedge")?;
            let next = word(after).map_or("", |(_, next)| next);
            let is_bare = !rest.trim_start().starts_with(['"', '\'']);
            if is_bare && is_second_word(after, next) {
                return wrong(rest, Wrong::TwoWords(next));
            }
            (after, Some(term))
        };
        let proposition = Proposition {
            variable,
            hedges,
            term,
        };
        Ok((rest, Condition::Is(proposition)))
    }

    fn consequent(&self, rest: &'a str) -> Step<'a, Consequent> {
        let start = rest;
        let (rest, output) = self.name(rest, "the name of an output")?;
        let Some(rest) = keyword(rest, "IS") else {
            return wrong(rest, Wrong::NoIs("output", start));
        };
        let (mut rest, mut hedges) = (rest, Vec::new());
        while let Some((after, hedge)) = hedge(rest) {
            if !hedge.may_conclude() {
                return wrong(rest, Wrong::HedgeInConsequent);
            }
            hedges.push(hedge);
            rest = after;
        }
        let (rest, term) = self.name(rest, "a term of the output")?;
        let consequent = Consequent {
            output,
            hedges,
            term,
        };
        Ok((rest, consequent))
    }

    fn name(&self, rest: &'a str, what: &'static str) -> Step<'a, Name> {
        let (rest, ()) = space(rest)?;
        let start = self.at(rest);
        let (after, text) = match rest.chars().next() {
            Some(quote @ ('"' | '\'')) => quoted(rest, quote)?,
            _ => {
                let (after, word) = word(rest)?;
                if !is_plain_name(word) {
                    return wrong(rest, Wrong::Name(what));
                }
                (after, word.into())
            }
        };
        let span = start..self.at(after);
        Ok((after, Name { text, span }))
    }
}

/// `part { word part }`
fn joined<'a>(
    mut rest: &'a str,
    word: &str,
    mut part: impl FnMut(&'a str) -> Step<'a, Condition>,
) -> Step<'a, Vec<Condition>> {
    let mut parts = Vec::new();
    loop {
        let (after, condition) = part(rest)?;
        parts.push(condition);
        match keyword(after, word) {
            Some(next) => rest = next,
            None => return Ok((after, parts)),
        }
    }
}

/// The only part, or all parts joined.
fn one_or(mut parts: Vec<Condition>, join: fn(Vec<Condition>) -> Condition) -> Condition {
    match (parts.pop(), parts.is_empty()) {
        (Some(only), true) => only,
        (last, _) => {
            parts.extend(last);
            join(parts)
        }
    }
}

/// Whether the word behind a term could only be a part of it: no keyword, none misspelt, and not the input of a further
/// proposition.
fn is_second_word(after: &str, next: &str) -> bool {
    is_plain_name(next)
        && nearest(next, ["AND", "OR", "THEN"]).is_none()
        && word(after).is_ok_and(|(behind, _)| keyword(behind, "IS").is_none())
}

fn starts_name(rest: &str) -> bool {
    rest.starts_with(['"', '\'']) || word(rest).is_ok_and(|(_, word)| is_plain_name(word))
}

/// A name in quotes; a backslash takes the next quote or backslash as it is.
pub(super) fn quoted(rest: &str, quote: char) -> Step<'_, String> {
    let mut name = String::new();
    let mut letters = rest.char_indices().skip(1);
    while let Some((at, c)) = letters.next() {
        match c {
            '\\' => match letters.next() {
                Some((_, escaped @ ('"' | '\'' | '\\'))) => name.push(escaped),
                Some((_, other)) => name.extend(['\\', other]),
                None => break,
            },
            _ if c == quote && name.is_empty() => return wrong(rest, Wrong::EmptyName),
            _ if c == quote => return Ok((rest.get(at + 1..).unwrap_or(""), name)),
            _ => name.push(c),
        }
    }
    wrong(rest, Wrong::OpenQuote)
}

fn is_digit(c: char) -> bool {
    c.is_ascii_digit()
}

fn weight(rest: &str) -> Step<'_, f64> {
    let (rest, ()) = space(rest)?;
    let in_number = |c: char| c.is_ascii_alphanumeric() || matches!(c, '.' | '+' | '-' | '%');
    let (after, number) = take_while(in_number).parse(rest)?;
    match number.parse::<f64>() {
        // Words that Rust takes for numbers (`inf`, `nan`) are none here.
        Ok(weight) if number.contains(is_digit) => {
            if (0.0..=1.0).contains(&weight) {
                Ok((after, weight))
            } else {
                wrong(rest, Wrong::Weight(weight))
            }
        }
        _ => wrong(rest, Wrong::Number),
    }
}
