//! The parser of the rule language.
//!
//! ```text
//! rule        = IF any-of THEN consequent { AND consequent } [ WITH number ]
//! any-of      = all-of { OR all-of }
//! all-of      = condition { AND condition }
//! condition   = NOT condition | "(" any-of ")" | name IS { hedge } name
//! consequent  = name IS name
//! ```
//!
//! Keywords are read in any case. `#` starts a comment that ends with its line. A name is letters, digits, `_`, `.`,
//! `-` and `%`; any other, and one that is a keyword, stands in single or double quotes, `\` before a quote or a `\` in it.
//!
//! Whatever keyword has been read commits the parser, so the first mistake met is the furthest one, and every error
//! knows what could have stood in its place.

use alloc::{boxed::Box, format, string::String, vec::Vec};

use nom::{
    Err, IResult, Parser,
    bytes::complete::{take_till, take_while, take_while1},
    character::complete::char,
    error::{ErrorKind, ParseError},
    multi::many0_count,
    sequence::preceded,
};

use super::{Condition, Consequent, Hedge, Name, Proposition, Rule, is_plain_name};
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
    let source = Source { text };
    match source.rule(text) {
        Ok((_, rule)) => Ok(rule),
        Err(Err::Error(mistake) | Err::Failure(mistake)) => Err(Box::new(source.explain(mistake))),
        // Only nom's streaming parsers ask for more, and none is used.
        Err(Err::Incomplete(_)) => Err(Box::new(Diagnostic::error(
            "rule-syntax",
            text.len()..text.len(),
            "the rule ends too early",
        ))),
    }
}

/// What is wrong, and the text that was left when it was met.
struct Mistake<'a> {
    rest: &'a str,
    kind: Wrong,
}

enum Wrong {
    /// One of these words should have stood here: `after` says after what.
    Keyword(&'static [&'static str], &'static str),
    /// A name of this kind should have stood here.
    Name(&'static str),
    /// A hedge behind THEN.
    HedgeInConsequent,
    /// A quote without its partner.
    OpenQuote,
    /// A bracket without its partner.
    OpenBracket,
    /// Something between quotes that is not there.
    EmptyName,
    /// No number behind WITH.
    Number,
    /// A weight outside [0, 1].
    Weight(f64),
    /// Nested deeper than [`DEEPEST_NESTING`].
    TooDeep,
}

type Step<'a, T> = IResult<&'a str, T, Mistake<'a>>;

impl<'a> ParseError<&'a str> for Mistake<'a> {
    // nom's own parsers are only tried, never required: what they would say is always replaced.
    fn from_error_kind(rest: &'a str, _: ErrorKind) -> Self {
        Mistake {
            rest,
            kind: Wrong::Name("a word"),
        }
    }

    fn append(_: &'a str, _: ErrorKind, other: Self) -> Self {
        other
    }
}

fn wrong<T>(rest: &str, kind: Wrong) -> Step<'_, T> {
    Err(Err::Failure(Mistake { rest, kind }))
}

/// Space, line breaks and comments.
fn space(rest: &str) -> Step<'_, ()> {
    let blank = take_while1(char::is_whitespace);
    let comment = preceded(char('#'), take_till(|c| c == '\n'));
    let (rest, _) = many0_count(blank.or(comment)).parse(rest)?;
    Ok((rest, ()))
}

fn is_name_letter(c: char) -> bool {
    c.is_alphanumeric() || matches!(c, '_' | '.' | '-' | '%')
}

/// The word here, empty where there is none.
fn word(rest: &str) -> Step<'_, &str> {
    let (rest, ()) = space(rest)?;
    take_while(is_name_letter).parse(rest)
}

/// Takes the keyword if it is the next word: keywords end where words end.
fn keyword<'a>(rest: &'a str, expected: &str) -> Option<&'a str> {
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

    fn rule(&self, rest: &'a str) -> Step<'a, Rule> {
        let Some(rest) = keyword(rest, "IF") else {
            return wrong(rest, Wrong::Keyword(&["IF"], "at the start of a rule"));
        };
        let (rest, condition) = self.any_of(rest, 0)?;
        let Some(mut rest) = keyword(rest, "THEN") else {
            return wrong(
                rest,
                Wrong::Keyword(&["AND", "OR", "THEN"], "after the condition"),
            );
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
        let (rest, weight, expected): (_, _, &[&str]) = match keyword(rest, "WITH") {
            Some(rest) => {
                let (rest, weight) = weight(rest)?;
                (rest, weight, &[])
            }
            None => (rest, 1.0, &["AND", "WITH"]),
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
        Ok((rest, rule))
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
        let (rest, variable) = self.name(rest, "the name of an input, `NOT` or `(`")?;
        let Some(mut rest) = keyword(rest, "IS") else {
            return wrong(rest, Wrong::Keyword(&["IS"], "after the input"));
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
            let (rest, term) = self.name(rest, "a term or a hedge")?;
            (rest, Some(term))
        };
        let proposition = Proposition {
            variable,
            hedges,
            term,
        };
        Ok((rest, Condition::Is(proposition)))
    }

    fn consequent(&self, rest: &'a str) -> Step<'a, Consequent> {
        let (rest, output) = self.name(rest, "the name of an output")?;
        let Some(rest) = keyword(rest, "IS") else {
            return wrong(rest, Wrong::Keyword(&["IS"], "after the output"));
        };
        if hedge(rest).is_some() {
            return wrong(rest, Wrong::HedgeInConsequent);
        }
        let (rest, term) = self.name(rest, "a term of the output")?;
        Ok((rest, Consequent { output, term }))
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

    /// The mistake in words.
    fn explain(&self, mistake: Mistake<'a>) -> Diagnostic {
        let rest = mistake.rest.trim_start();
        let start = self.at(rest);
        let found = found_here(rest);
        let span = start..start + found.len();
        let shown = match found {
            "" => String::from("the end of the rule"),
            found => format!("`{found}`"),
        };
        let syntax = |message: String| Diagnostic::error("rule-syntax", span.clone(), message);
        match mistake.kind {
            Wrong::Keyword(expected, after) => {
                let message = match expected {
                    [] => format!("the rule ends {after}, but here stands {shown}"),
                    _ => format!("expected {} {after}, found {shown}", either(expected)),
                };
                let diagnostic = syntax(message);
                let help = match nearest(found, expected.iter().copied()) {
                    Some(word) => Some(format!("did you mean `{word}`?")),
                    None => advice(found, expected),
                };
                with_help(diagnostic, help)
            }
            Wrong::Name(what) => {
                let help = if Rule::is_keyword(found) {
                    Some(format!(
                        "`{found}` is a word of the rule language; as a name it stands in quotes: `\"{found}\"`"
                    ))
                } else {
                    advice(found, &[])
                };
                with_help(syntax(format!("expected {what}, found {shown}")), help)
            }
            Wrong::HedgeInConsequent => syntax(format!("`{found}` cannot stand after `THEN`"))
                .help("hedges and `NOT` belong in the condition; here name one term of the output"),
            Wrong::OpenQuote => syntax(String::from("the quoted name is never closed"))
                .help("add the closing quote"),
            Wrong::OpenBracket => Diagnostic::error(
                "rule-syntax",
                start..start + 1,
                "the bracket `(` is never closed",
            )
            .help("add `)` at the end of what belongs together"),
            Wrong::EmptyName => {
                Diagnostic::error("rule-syntax", start..start + 2, "the name is empty")
                    .help("write the name of a variable or a term between the quotes")
            }
            Wrong::Number => syntax(format!("expected a weight after `WITH`, found {shown}"))
                .help("a weight is a number from 0 to 1: `WITH 0.8`"),
            Wrong::Weight(weight) => Diagnostic::error(
                "weight-outside-range",
                span,
                format!("the weight `{weight}` is outside [0, 1]"),
            )
            .help(
                "a weight multiplies the firing strength of its rule; write a number from 0 to 1",
            ),
            Wrong::TooDeep => Diagnostic::error(
                "rule-too-deep",
                span,
                format!("brackets and NOTs are nested deeper than {DEEPEST_NESTING}"),
            )
            .help("split the rule into several rules of the same conclusion"),
        }
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

fn starts_name(rest: &str) -> bool {
    rest.starts_with(['"', '\'']) || word(rest).is_ok_and(|(_, word)| is_plain_name(word))
}

/// A name in quotes; a backslash takes the next quote or backslash as it is.
fn quoted(rest: &str, quote: char) -> Step<'_, String> {
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

/// What an author would call the thing that stands here: a word, a quoted name, a sign.
fn found_here(rest: &str) -> &str {
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
        _ if is_name_letter(first) || first == '+' => end(|c| is_name_letter(c) || c == '+'),
        _ => end(|c| !is_name_letter(c) && !c.is_whitespace() && !matches!(c, '"' | '\'')),
    };
    rest.get(..length).unwrap_or(rest)
}

/// `` `A`, `B` or `C` ``
fn either(words: &[&str]) -> String {
    let quoted: Vec<String> = words.iter().map(|w| format!("`{w}`")).collect();
    match quoted.split_last() {
        Some((last, first)) if !first.is_empty() => format!("{} or {last}", first.join(", ")),
        _ => quoted.join(""),
    }
}

/// What authors of other languages write, and what it is called here.
fn advice(found: &str, expected: &[&str]) -> Option<String> {
    let say = |text: &str| Some(String::from(text));
    match found {
        "," => say("write `AND` or `THEN`"),
        "&" | "&&" => say("write `AND`"),
        "|" | "||" => say("write `OR`"),
        "!" | "~" => say("write `NOT`"),
        "=" | "==" | ":" => say("write `IS`"),
        "!=" | "<>" => say("write `IS NOT`"),
        "=>" | "->" => say("write `THEN`"),
        "%" => say("write `WITH` and a number from 0 to 1"),
        _ if found.eq_ignore_ascii_case("else") => {
            say("there is no `ELSE`: write a second rule with `NOT`")
        }
        _ if found.eq_ignore_ascii_case("or") && expected.contains(&"WITH") => {
            say("conclusions are joined by `AND`; for `OR` write two rules")
        }
        _ if found.starts_with('\'') || found.starts_with('"') => None,
        _ if found.starts_with(is_name_letter)
            && !expected.is_empty()
            && !expected.contains(&"IF") =>
        {
            say("a name of several words stands in quotes: `\"very low\"`")
        }
        _ if expected.contains(&"IF") => say("a rule reads `IF input IS term THEN output IS term`"),
        _ => None,
    }
}

fn with_help(diagnostic: Diagnostic, help: Option<String>) -> Diagnostic {
    Diagnostic { help, ..diagnostic }
}
