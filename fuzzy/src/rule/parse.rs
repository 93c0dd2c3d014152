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
//! Keywords are case-insensitive. `#` starts a comment, which ends at the end of the line. A name consists of letters,
//! digits, `_`, `.`, `-` and `%`. Any other name, and a name that equals a keyword, is written in single or double
//! quotes, in which `\` precedes a quote or a `\`.
//!
//! After reading a keyword the parser does not backtrack. The first syntax error is therefore the furthest one, and
//! every error lists what was expected at its position.

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
    mistake::{Known, KnownNames, RuleMistake, RuleMistakeKind},
};
use crate::diagnostic::{Diagnostic, nearest};

/// The maximum nesting depth of brackets and NOTs. Deeper nesting is an error, because syntax trees are processed
/// recursively.
pub const DEEPEST_NESTING: usize = 64;

/// Parses a rule.
///
/// # Errors
/// The first syntax error, with its byte range in `text`, the expected words, and a suggestion.
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
    parse_with_weight(text, &KnownNames::default).map(|(rule, _)| rule)
}

/// Parses a rule, and also returns the position of its weight: the number after WITH, or the empty range after the
/// conclusion. Suggestions contain the names that `known` returns; it is called only for a syntax error.
pub(crate) fn parse_with_weight(
    text: &str,
    known: Known<'_>,
) -> Result<(Rule, Range<usize>), Box<Diagnostic>> {
    let source = Source { text };
    match source.rule(text) {
        Ok((_, found)) => Ok(found),
        Err(Err::Error(mistake) | Err::Failure(mistake)) => {
            Err(Box::new(mistake.explain(text, known())))
        }
        // Only nom's streaming parsers report incomplete input, and they are not used here.
        Err(Err::Incomplete(_)) => Err(Box::new(Diagnostic::error(
            "rule-syntax",
            text.len()..text.len(),
            "the rule ends too early",
        ))),
    }
}

type ParseResult<'a, T> = IResult<&'a str, T, RuleMistake<'a>>;

fn wrong<'a, T>(rest: &'a str, kind: RuleMistakeKind<'a>) -> ParseResult<'a, T> {
    Err(Err::Failure(RuleMistake { rest, kind }))
}

/// Skips white space, line breaks and comments.
fn space(rest: &str) -> ParseResult<'_, ()> {
    let blank = take_while1(char::is_whitespace);
    let comment = preceded(char('#'), take_till(|c| c == '\n'));
    let (rest, _) = many0_count(blank.or(comment)).parse(rest)?;
    Ok((rest, ()))
}

pub(super) fn is_name_letter(c: char) -> bool {
    c.is_alphanumeric() || matches!(c, '_' | '.' | '-' | '%')
}

/// Returns the word at this position; empty if there is none.
pub(super) fn word(rest: &str) -> ParseResult<'_, &str> {
    let (rest, ()) = space(rest)?;
    take_while(is_name_letter).parse(rest)
}

/// Parses a keyword if it is the whole next word.
pub(super) fn keyword<'a>(rest: &'a str, expected: &str) -> Option<&'a str> {
    let (after, word) = word(rest).ok()?;
    word.eq_ignore_ascii_case(expected).then_some(after)
}

/// Parses the next word if it is a hedge.
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

    fn rule(&self, rest: &'a str) -> ParseResult<'a, (Rule, Range<usize>)> {
        let Some(rest) = keyword(rest, "IF") else {
            return wrong(
                rest,
                RuleMistakeKind::Keyword(&["IF"], "at the start of a rule"),
            );
        };
        let (rest, condition) = self.any_of(rest, 0)?;
        let Some(mut rest) = keyword(rest, "THEN") else {
            return wrong(rest, RuleMistakeKind::Connective);
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
            let after = match expected {
                [] => "after the weight",
                _ => "after the conclusion",
            };
            return wrong(rest, RuleMistakeKind::Keyword(expected, after));
        }
        let rule = Rule {
            condition,
            consequents,
            weight,
        };
        Ok((rest, (rule, span)))
    }

    fn any_of(&self, rest: &'a str, depth: usize) -> ParseResult<'a, Condition> {
        let (rest, parts) = joined(rest, "OR", |rest| self.all_of(rest, depth))?;
        Ok((rest, one_or(parts, Condition::Or)))
    }

    fn all_of(&self, rest: &'a str, depth: usize) -> ParseResult<'a, Condition> {
        let (rest, parts) = joined(rest, "AND", |rest| self.condition(rest, depth))?;
        Ok((rest, one_or(parts, Condition::And)))
    }

    fn condition(&self, rest: &'a str, depth: usize) -> ParseResult<'a, Condition> {
        let (rest, ()) = space(rest)?;
        if depth > DEEPEST_NESTING {
            return wrong(rest, RuleMistakeKind::TooDeep);
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
                    wrong(rest, RuleMistakeKind::OpenBracket)
                }
                None => wrong(
                    after,
                    RuleMistakeKind::Keyword(&["AND", "OR", ")"], "after the condition"),
                ),
            };
        }
        if hedge(rest).is_some() {
            return wrong(rest, RuleMistakeKind::HedgeBeforeInput);
        }
        let start = rest;
        let (rest, variable) = self.name(rest, "an input name, `NOT` or `(`")?;
        let Some(mut rest) = keyword(rest, "IS") else {
            return wrong(rest, RuleMistakeKind::NoIs("input", start));
        };
        let mut hedges = Vec::new();
        while let Some((after, hedge)) = hedge(rest) {
            hedges.push(hedge);
            rest = after;
        }
        // `any` needs no term, so the proposition ends if no name follows.
        let (after_space, ()) = space(rest)?;
        let names_follow = starts_name(after_space);
        let (rest, term) = if hedges.last() == Some(&Hedge::Any) && !names_follow {
            (rest, None)
        } else {
            let (after, term) = self.name(rest, "a term or a hedge")?;
            let next = word(after).map_or("", |(_, next)| next);
            let is_bare = !rest.trim_start().starts_with(['"', '\'']);
            if is_bare && is_second_word(after, next) {
                return wrong(rest, RuleMistakeKind::TwoWords(next));
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

    fn consequent(&self, rest: &'a str) -> ParseResult<'a, Consequent> {
        let start = rest;
        let (rest, output) = self.name(rest, "an output name")?;
        let Some(rest) = keyword(rest, "IS") else {
            return wrong(rest, RuleMistakeKind::NoIs("output", start));
        };
        let (mut rest, mut hedges) = (rest, Vec::new());
        while let Some((after, hedge)) = hedge(rest) {
            if !hedge.may_conclude() {
                return wrong(rest, RuleMistakeKind::HedgeInConsequent);
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

    fn name(&self, rest: &'a str, what: &'static str) -> ParseResult<'a, Name> {
        let (rest, ()) = space(rest)?;
        let start = self.at(rest);
        let (after, text) = match rest.chars().next() {
            Some(quote @ ('"' | '\'')) => quoted(rest, quote)?,
            _ => {
                let (after, word) = word(rest)?;
                if !is_plain_name(word) {
                    return wrong(rest, RuleMistakeKind::Name(what));
                }
                (after, word.into())
            }
        };
        let span = start..self.at(after);
        Ok((after, Name { text, span }))
    }
}

/// Parses one or more parts separated by a word: `part { word part }`.
fn joined<'a>(
    mut rest: &'a str,
    word: &str,
    mut part: impl FnMut(&'a str) -> ParseResult<'a, Condition>,
) -> ParseResult<'a, Vec<Condition>> {
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

/// Returns the part if there is only one, and otherwise all parts joined by `join`.
fn one_or(mut parts: Vec<Condition>, join: fn(Vec<Condition>) -> Condition) -> Condition {
    match (parts.pop(), parts.is_empty()) {
        (Some(only), true) => only,
        (last, _) => {
            parts.extend(last);
            join(parts)
        }
    }
}

/// Returns whether the word after a term can only belong to the term's name: it is neither a keyword nor a
/// misspelt keyword, and it does not begin another proposition.
fn is_second_word(after: &str, next: &str) -> bool {
    is_plain_name(next)
        && nearest(next, ["AND", "OR", "THEN"]).is_none()
        && word(after).is_ok_and(|(behind, _)| keyword(behind, "IS").is_none())
}

fn starts_name(rest: &str) -> bool {
    rest.starts_with(['"', '\'']) || word(rest).is_ok_and(|(_, word)| is_plain_name(word))
}

/// Parses a name in quotes; a quote or backslash after a backslash is taken literally.
pub(super) fn quoted(rest: &str, quote: char) -> ParseResult<'_, String> {
    let mut name = String::new();
    let mut letters = rest.char_indices().skip(1);
    while let Some((at, c)) = letters.next() {
        match c {
            '\\' => match letters.next() {
                Some((_, escaped @ ('"' | '\'' | '\\'))) => name.push(escaped),
                Some((_, other)) => name.extend(['\\', other]),
                None => break,
            },
            _ if c == quote && name.is_empty() => return wrong(rest, RuleMistakeKind::EmptyName),
            _ if c == quote => return Ok((rest.get(at + 1..).unwrap_or(""), name)),
            _ => name.push(c),
        }
    }
    wrong(rest, RuleMistakeKind::OpenQuote)
}

fn is_digit(c: char) -> bool {
    c.is_ascii_digit()
}

fn weight(rest: &str) -> ParseResult<'_, f64> {
    let (rest, ()) = space(rest)?;
    let in_number = |c: char| c.is_ascii_alphanumeric() || matches!(c, '.' | '+' | '-' | '%');
    let (after, number) = take_while(in_number).parse(rest)?;
    match number.parse::<f64>() {
        // Rust parses `inf` and `nan` as numbers, but they are not allowed here.
        Ok(weight) if number.contains(is_digit) => {
            if (0.0..=1.0).contains(&weight) {
                Ok((after, weight))
            } else {
                wrong(rest, RuleMistakeKind::Weight(weight))
            }
        }
        _ => wrong(rest, RuleMistakeKind::Number),
    }
}
