//! The parser of formulas.
//!
//! ```text
//! any-of     = all-of { or all-of }
//! all-of     = truth { and truth }
//! truth      = not truth | comparison
//! comparison = sum [ ( < | <= | > | >= | == | != ) sum ]
//! sum        = product { ( + | - ) product }
//! product    = signed { ( * | / | % ) signed }
//! signed     = - signed | power
//! power      = operand [ ^ signed ]
//! operand    = number | pi | name | function "(" any-of { "," any-of } ")" | "(" any-of ")"
//! ```
//!
//! A name consists of letters, digits, `_` and `.`, and does not start with a digit. Any other name is written in
//! single or double quotes, in which `\` precedes a quote or a `\`.

use alloc::{boxed::Box, format, string::String, vec::Vec};

use nom::{
    Err, IResult, Parser as _,
    bytes::complete::take_while1,
    character::complete::{digit1, one_of},
    combinator::{opt, recognize},
    error::{ErrorKind, ParseError},
};

use super::{DEEPEST_NESTING, Expression, Formula, LONGEST, Operation, Variable, code};
use crate::diagnostic::{Diagnostic, suggest};

/// Functions of other programs, with the equivalent operations.
const OTHER_NAMES: [(&str, Operation); 11] = [
    ("pow", Operation::POWER),
    ("fmod", Operation::REMAINDER),
    ("fabs", Operation::ABS),
    ("ln", Operation::LOG),
    ("lt", Operation::LESS),
    ("le", Operation::LESS_OR_EQUAL),
    ("gt", Operation::GREATER),
    ("ge", Operation::GREATER_OR_EQUAL),
    ("eq", Operation::EQUAL),
    ("neq", Operation::UNEQUAL),
    ("mod", Operation::REMAINDER),
];

pub(super) fn parse(text: &str) -> Result<Formula, Box<Diagnostic>> {
    let mut parser = Parser {
        text,
        variables: Vec::new(),
        parts: 0,
    };
    let read = parser.level(text, 1, 0).and_then(|(rest, expression)| {
        let rest = after_space(rest);
        match rest {
            "" => Ok(expression),
            _ => wrong(rest, FormulaMistakeKind::Operator),
        }
    });
    let whole = |message: String, help: &str| {
        let finding = Diagnostic::error("formula-syntax", 0..text.len(), message);
        Err(Box::new(finding.help(help)))
    };
    match read {
        Ok(expression) => {
            let formula = Formula::new(expression, parser.variables);
            if code::depth(&formula.code) > code::DEEPEST {
                let message = format!(
                    "the formula needs more than {} intermediate results at a time",
                    code::DEEPEST
                );
                return whole(message, "write deeply nested operands before the others");
            }
            Ok(formula)
        }
        Err(Err::Error(mistake) | Err::Failure(mistake)) => Err(Box::new(mistake.explain(text))),
        // Only nom's streaming parsers report incomplete input, and they are not used here.
        Err(Err::Incomplete(_)) => whole("the formula ends too early".into(), "finish it"),
    }
}

type ParseResult<'a, T> = IResult<&'a str, T, FormulaMistake<'a>>;

/// A syntax error, with the remaining text at the position where it was detected.
struct FormulaMistake<'a> {
    rest: &'a str,
    kind: FormulaMistakeKind<'a>,
}

enum FormulaMistakeKind<'a> {
    /// A number, name or bracket was expected.
    Operand,
    /// An operator or the end was expected.
    Operator,
    /// A second comparison in a row, as in `a < b < c`.
    Chain,
    /// An unknown function, by its name.
    Function(&'a str),
    /// A function with a wrong number of operands: its name, the expected number and the actual one.
    Count(&'a str, usize, usize),
    /// An unclosed bracket.
    OpenBracket,
    /// An unclosed or empty quote.
    Quote,
    /// Digits that are not a valid number, or a number that is too large.
    Number(&'a str),
    TooDeep,
    TooLong,
}

impl<'a> ParseError<&'a str> for FormulaMistake<'a> {
    // nom's own parsers are used only for numbers, where they either match or are optional, so this error is never
    // reported.
    fn from_error_kind(rest: &'a str, _: ErrorKind) -> Self {
        FormulaMistake {
            rest,
            kind: FormulaMistakeKind::Operand,
        }
    }

    fn append(_: &'a str, _: ErrorKind, other: Self) -> Self {
        other
    }
}

fn wrong<'a, T>(rest: &'a str, kind: FormulaMistakeKind<'a>) -> Result<T, Err<FormulaMistake<'a>>> {
    Err(Err::Failure(FormulaMistake { rest, kind }))
}

fn after_space(rest: &str) -> &str {
    rest.trim_start()
}

fn begins_name(c: char) -> bool {
    c.is_alphabetic() || c == '_'
}

fn in_name(c: char) -> bool {
    c.is_alphanumeric() || matches!(c, '_' | '.')
}

/// Returns the word at this position; empty if there is none.
fn word(rest: &str) -> &str {
    if !rest.starts_with(begins_name) {
        return "";
    }
    let end = rest.find(|c| !in_name(c)).unwrap_or(rest.len());
    rest.get(..end).unwrap_or("")
}

fn is_keyword(word: &str) -> bool {
    let words = ["and", "or", "not"];
    words.iter().any(|known| known.eq_ignore_ascii_case(word))
}

/// Returns whether a name needs no quotes in a formula.
pub(super) fn is_plain_name(name: &str) -> bool {
    !name.is_empty() && word(name) == name && !is_keyword(name) && name != "pi"
}

/// Parses an operator; returns the text after it, or `None` if it is not at this position.
fn operator(rest: &str, operation: Operation) -> Option<&str> {
    let symbol = operation.word();
    let rest = after_space(rest);
    if symbol.starts_with(begins_name) {
        let found = word(rest);
        return found
            .eq_ignore_ascii_case(symbol)
            .then(|| rest.get(found.len()..).unwrap_or(""));
    }
    let after = rest.strip_prefix(symbol)?;
    // `<` must not match the start of `<=`, and `*` must not match the start of `**`.
    let longer = after.starts_with('=') && matches!(symbol, "<" | ">")
        || symbol == "*" && after.starts_with('*');
    (!longer).then_some(after)
}

/// The precedence of comparisons, which cannot be chained.
const COMPARISONS: u8 = 4;

/// Parses a binary operator whose precedence is at least `binds`.
fn infix(rest: &str, binds: u8) -> Option<(Operation, &str)> {
    let all = Operation::ALL.iter();
    let mut infix = all.filter(|(operation, _, operands)| {
        *operands == 2 && operation.binds().is_some_and(|own| own >= binds)
    });
    infix.find_map(|(operation, ..)| Some((*operation, operator(rest, *operation)?)))
}

struct Parser<'a> {
    text: &'a str,
    variables: Vec<Variable>,
    /// The count of numbers, names and operations that were parsed.
    parts: usize,
}

impl<'a> Parser<'a> {
    /// Parses an expression whose operators have a precedence of at least `binds`. A single call parses a whole level
    /// of brackets, so that the stack grows only with their nesting.
    fn level(&mut self, rest: &'a str, binds: u8, depth: usize) -> ParseResult<'a, Expression> {
        if depth > DEEPEST_NESTING {
            return wrong(after_space(rest), FormulaMistakeKind::TooDeep);
        }
        let (mut rest, mut left) = self.signed(rest, binds, depth)?;
        let mut last = None;
        while let Some((operation, after)) = infix(rest, binds) {
            let own = operation.binds().unwrap_or(0);
            if own == COMPARISONS && last == Some(own) {
                return wrong(after_space(rest), FormulaMistakeKind::Chain);
            }
            last = Some(own);
            // A power is right-associative, and its exponent may have a sign: `2^-x^2` is `2^(-(x^2))`.
            let (after, right) = match operation {
                Operation::POWER => self.level(after, own - 1, depth + 1)?,
                _ => self.level(after, own + 1, depth)?,
            };
            left = self.part(rest, Expression::Apply(operation, Vec::from([left, right])))?;
            rest = after;
        }
        Ok((rest, left))
    }

    /// Parses an operand, or `not` or `-` with its operand.
    fn signed(&mut self, rest: &'a str, binds: u8, depth: usize) -> ParseResult<'a, Expression> {
        for prefix in [Operation::NOT, Operation::NEGATE] {
            let own = prefix.binds().unwrap_or(0);
            if own >= binds
                && let Some(after) = operator(rest, prefix)
            {
                let (after, inner) = self.level(after, own, depth + 1)?;
                let signed = self.part(rest, Expression::Apply(prefix, Vec::from([inner])))?;
                return Ok((after, signed));
            }
        }
        self.operand(rest, depth)
    }

    /// Counts a number, a name or an operation, so that a formula that is too long is rejected before it becomes a deep
    /// tree.
    fn part(
        &mut self,
        rest: &'a str,
        expression: Expression,
    ) -> Result<Expression, Err<FormulaMistake<'a>>> {
        self.parts += 1;
        match self.parts > LONGEST {
            true => wrong(rest, FormulaMistakeKind::TooLong),
            false => Ok(expression),
        }
    }

    fn operand(&mut self, rest: &'a str, depth: usize) -> ParseResult<'a, Expression> {
        let rest = after_space(rest);
        if let Some(inside) = rest.strip_prefix('(') {
            let (after, inner) = self.level(inside, 1, depth + 1)?;
            return match after_space(after).strip_prefix(')') {
                Some(after) => Ok((after, inner)),
                None if after_space(after).is_empty() => {
                    wrong(rest, FormulaMistakeKind::OpenBracket)
                }
                None => wrong(after_space(after), FormulaMistakeKind::Operator),
            };
        }
        if rest.starts_with(|c: char| c.is_ascii_digit() || c == '.') {
            let (after, number) = number(rest)?;
            return Ok((after, self.part(rest, number)?));
        }
        if let Some(quote @ ('"' | '\'')) = rest.chars().next() {
            let (after, name) = quoted(rest, quote)?;
            let variable = self.variable(rest, after, name);
            return Ok((after, self.part(rest, variable)?));
        }
        let name = word(rest);
        if name.is_empty() || is_keyword(name) {
            return wrong(rest, FormulaMistakeKind::Operand);
        }
        let after = rest.get(name.len()..).unwrap_or("");
        if let Some(operands) = after_space(after).strip_prefix('(') {
            return self.call(rest, name, operands, depth);
        }
        if name == "pi" {
            let pi = Expression::Number(core::f64::consts::PI);
            return Ok((after, self.part(rest, pi)?));
        }
        let variable = self.variable(rest, after, name.into());
        Ok((after, self.part(rest, variable)?))
    }

    fn variable(&mut self, rest: &'a str, after: &'a str, name: String) -> Expression {
        let span = self.text.len() - rest.len()..self.text.len() - after.len();
        let known = self.variables.iter().position(|v| v.name == name);
        let index = known.unwrap_or_else(|| {
            let spans = Vec::new();
            self.variables.push(Variable { name, spans });
            self.variables.len() - 1
        });
        if let Some(variable) = self.variables.get_mut(index) {
            variable.spans.push(span);
        }
        Expression::Variable(index)
    }

    /// Parses a function call; `operands` is the text after its opening bracket.
    fn call(
        &mut self,
        start: &'a str,
        name: &'a str,
        operands: &'a str,
        depth: usize,
    ) -> ParseResult<'a, Expression> {
        let functions = || {
            let all = Operation::ALL.iter();
            all.filter(|(operation, ..)| operation.binds().is_none())
        };
        let other = OTHER_NAMES.iter().find(|(other, _)| *other == name);
        let known = functions().find(|(_, word, _)| *word == name);
        let operation = known
            .map(|(operation, ..)| *operation)
            .or(other.map(|(_, operation)| *operation));
        let Some(operation) = operation else {
            return wrong(start, FormulaMistakeKind::Function(name));
        };
        let mut found = Vec::new();
        let mut rest = operands;
        loop {
            let (after, operand) = self.level(rest, 1, depth + 1)?;
            found.push(operand);
            let after = after_space(after);
            if let Some(next) = after.strip_prefix(',') {
                rest = next;
            } else if let Some(after) = after.strip_prefix(')') {
                let all = Operation::ALL.iter();
                let mut all = all.filter(|(known, ..)| *known == operation);
                let takes = all.next().map_or(0, |(.., count)| *count);
                if found.len() != takes {
                    return wrong(start, FormulaMistakeKind::Count(name, takes, found.len()));
                }
                let called = self.part(start, Expression::Apply(operation, found))?;
                return Ok((after, called));
            } else if after.is_empty() {
                return wrong(start, FormulaMistakeKind::OpenBracket);
            } else {
                return wrong(after, FormulaMistakeKind::Operator);
            }
        }
    }
}

fn number(rest: &str) -> ParseResult<'_, Expression> {
    let digits = take_while1(|c: char| c.is_ascii_digit() || c == '.');
    let power = (one_of("eE"), opt(one_of("+-")), digit1);
    let (after, written) = recognize((digits, opt(power))).parse(rest)?;
    match written.parse::<f64>() {
        Ok(number) if number.is_finite() => Ok((after, Expression::Number(number))),
        _ => wrong(rest, FormulaMistakeKind::Number(written)),
    }
}

/// Parses a name in quotes; a quote or backslash after a backslash is taken literally.
fn quoted(rest: &str, quote: char) -> ParseResult<'_, String> {
    let mut name = String::new();
    let mut letters = rest.char_indices().skip(1);
    while let Some((at, letter)) = letters.next() {
        match letter {
            '\\' => match letters.next() {
                Some((_, escaped @ ('"' | '\'' | '\\'))) => name.push(escaped),
                Some((_, other)) => name.extend(['\\', other]),
                None => break,
            },
            _ if letter == quote && name.is_empty() => break,
            _ if letter == quote => return Ok((rest.get(at + 1..).unwrap_or(""), name)),
            _ => name.push(letter),
        }
    }
    wrong(rest, FormulaMistakeKind::Quote)
}

/// Hedges of rules, which a formula does not have.
const HEDGES: [&str; 4] = ["very", "somewhat", "extremely", "seldom"];

/// The suggestion for conditional expressions such as `c ? a : b`, which formulas do not support.
const CONDITIONAL_HELP: &str = "to choose between `x` and `y`, write `(condition) * x + (1 - (condition)) * y`, because a condition is 1 if true and 0 if false";

/// Returns a suggestion if a number with `%` is before this position, as in `50% * x`.
fn percent(text: &str, start: usize) -> Option<String> {
    let before = text.get(..start)?.trim_end();
    let number = before.strip_suffix('%')?.trim_end();
    let from = number.trim_end_matches(|c: char| c.is_ascii_digit() || c == '.');
    let percent = number.get(from.len()..)?.parse::<f64>().ok()?;
    let fraction = percent / 100.0;
    Some(format!(
        "a number cannot be followed by `%`: write `{fraction}` for {percent} %"
    ))
}

/// Returns the first number with a comma between its digits, with a point in place of the comma.
fn decimal_comma(text: &str) -> Option<String> {
    let digits = |part: &str| part.bytes().take_while(u8::is_ascii_digit).count();
    text.match_indices(',').find_map(|(at, _)| {
        let (before, after) = (text.get(..at)?, text.get(at + 1..)?);
        let start = before.trim_end_matches(|c: char| c.is_ascii_digit()).len();
        let (whole, part) = (before.get(start..)?, after.get(..digits(after))?);
        let is_number = !whole.is_empty() && !part.is_empty();
        is_number.then(|| format!("{whole}.{part}"))
    })
}

impl FormulaMistake<'_> {
    /// Returns the diagnostic of the syntax error.
    fn explain(self, text: &str) -> Diagnostic {
        let rest = after_space(self.rest);
        let start = text.len() - rest.len();
        let signs = |c: char| "=<>!&|*".contains(c);
        let found = match rest.chars().next() {
            Some(c) if begins_name(c) => word(rest),
            Some(c) if c.is_ascii_digit() => {
                let end = rest.find(|c: char| !c.is_ascii_digit() && c != '.');
                rest.get(..end.unwrap_or(rest.len())).unwrap_or("")
            }
            Some(c) if signs(c) => {
                let end = rest.find(|c| !signs(c)).unwrap_or(rest.len());
                rest.get(..end).unwrap_or("")
            }
            Some(c) => rest.get(..c.len_utf8()).unwrap_or(""),
            None => "",
        };
        let shown = match found {
            "" => String::from("the end of the formula"),
            found => format!("`{found}`"),
        };
        let error = |length: usize, message: String| {
            Diagnostic::error("formula-syntax", start..start + length, message)
        };
        match self.kind {
            FormulaMistakeKind::Operand => {
                let message = format!("expected a number, a name or `(`, found {shown}");
                let percent = percent(text, start);
                let within = rest.strip_prefix('|').and_then(|rest| rest.split_once('|'));
                let absolute = match within {
                    Some((inside, _)) => {
                        format!("write `abs({})` for the absolute value", inside.trim())
                    }
                    None => "write `abs(x)` for the absolute value of x".into(),
                };
                let help = match found {
                    "" if text.trim().is_empty() => "write a formula, such as `2 * speed^2 + 1`",
                    "" => "add what is missing, or remove the operator",
                    "!" => "write `not`",
                    "+" => "a sign `+` has no effect; remove it",
                    "|" => &absolute,
                    _ if is_keyword(found) => {
                        "write a value before it, or, if it is a name, put it in quotes"
                    }
                    _ if let Some(help) = &percent => help,
                    _ => "write an operator between two numbers or names",
                };
                error(found.len(), message).help(help)
            }
            FormulaMistakeKind::Operator => {
                let message =
                    format!("expected an operator or the end of the formula, found {shown}");
                let before = text.get(..start).unwrap_or("");
                let whole = before.trim_end_matches(|c: char| c.is_ascii_digit()).len();
                let end = rest.find(' ').unwrap_or(rest.len());
                let comma = text.get(whole..start + end).and_then(decimal_comma);
                let decimal = comma.map(|number| format!("write a decimal point: `{number}`"));
                let before = before.trim_end();
                let before = before.rsplit(|c: char| !c.is_alphanumeric()).next();
                let is_function = |(operation, word, _): &&(Operation, &str, usize)| {
                    operation.binds().is_none() && Some(*word) == before
                };
                if let Some((_, name, _)) = Operation::ALL.iter().find(is_function) {
                    return error(found.len(), message).help(format!("write `{name}({found})`"));
                }
                let help = match found {
                    "=" if is_plain_name(text.get(..start).unwrap_or("").trim()) => {
                        "write only the right-hand side, or use `==` to compare"
                    }
                    "?" | ":" => CONDITIONAL_HELP,
                    _ if before.is_some_and(|word| HEDGES.contains(&word)) => {
                        "formulas cannot contain hedges: write the hedge in a rule, such as `IF input IS very term`"
                    }
                    "=" | "===" => "write `==` to compare",
                    "**" => "write `^` for a power",
                    "²" => "write `^2`",
                    "³" => "write `^3`",
                    "&" | "&&" => "write `and`",
                    "|" | "||" => "write `or`",
                    "<>" | "=/=" => "write `!=`",
                    "=<" => "write `<=`",
                    "=>" => "write `>=`",
                    "," if decimal.is_some() => decimal.as_deref().unwrap_or(""),
                    "," => {
                        "a decimal point is written as `.`; a comma separates the operands of a function"
                    }
                    ")" => "this `)` has no matching `(`: remove the `)`, or add a `(`",
                    "(" => "write `*` to multiply",
                    _ if before.is_some_and(|word| word.parse::<f64>().is_ok()) => {
                        "write `*` to multiply"
                    }
                    _ if found.starts_with(|c: char| in_name(c)) => {
                        "write `*` to multiply; put a name with spaces in quotes"
                    }
                    _ => "operators are `+ - * / % ^`, `< <= > >= == !=`, `and` and `or`",
                };
                error(found.len(), message).help(help)
            }
            FormulaMistakeKind::Chain => {
                error(found.len(), format!("{shown} follows another comparison"))
                    .help("write `low < x and x < high`")
            }
            FormulaMistakeKind::Function(name) => {
                let mut finding = error(name.len(), format!("there is no function `{name}`"));
                let functions = Operation::ALL.iter();
                let functions = functions.filter(|(operation, ..)| operation.binds().is_none());
                finding.help = match name.eq_ignore_ascii_case("if") {
                    true => Some(CONDITIONAL_HELP.into()),
                    false => {
                        // Functions of other languages have a prefix: `Math.exp`, `np.exp`.
                        let bare = name.rsplit('.').next().unwrap_or(name);
                        suggest(bare, functions.map(|(_, word, _)| *word))
                    }
                };
                finding
            }
            FormulaMistakeKind::Count(name, takes, has) => {
                let numbers = if takes == 1 { "number" } else { "numbers" };
                let message = format!("`{name}` takes {takes} {numbers}, not {has}");
                let comma = decimal_comma(rest);
                // A comma is certainly a decimal comma if other commas are followed by a space.
                let comma = comma.filter(|_| has > takes && rest.contains(", "));
                let help = match takes {
                    _ if comma.is_some() => {
                        format!("write a decimal point: `{}`", comma.unwrap_or_default())
                    }
                    1 => format!("write `{name}(x)`"),
                    _ if has > 2 => format!("nest it: `{name}({name}(x, y), z)`"),
                    _ => format!("write `{name}(x, y)`"),
                };
                error(name.len(), message).help(help)
            }
            FormulaMistakeKind::OpenBracket => {
                let length = rest.find('(').map_or(0, |at| at + 1);
                error(length, "the bracket `(` is never closed".into())
                    .help("add the closing bracket `)`")
            }
            FormulaMistakeKind::Quote => error(
                found.len(),
                "the quoted name is empty or never closed".into(),
            )
            .help("write the name of a variable between two quotes"),
            FormulaMistakeKind::Number(written) => {
                let (message, help) = match written.parse::<f64>() {
                    Ok(_) => ("the number `{}` is too large", "write a smaller number"),
                    Err(_) => (
                        "`{}` is not a number",
                        "write digits with one decimal point, as in `0.5`",
                    ),
                };
                error(written.len(), message.replace("{}", written)).help(help)
            }
            FormulaMistakeKind::TooDeep => {
                let message = format!(
                    "brackets, signs and powers are nested more than {DEEPEST_NESTING} levels deep"
                );
                error(found.len(), message)
                    .help("split the formula into the formulas of several terms")
            }
            FormulaMistakeKind::TooLong => {
                let message = format!("the formula has more than {LONGEST} parts");
                Diagnostic::error("formula-syntax", 0..text.len(), message)
                    .help("split the formula into the formulas of several terms")
            }
        }
    }
}
