//! The rule language: its syntax tree, parser and printer.
//!
//! An example is `IF heat IS high AND humidity IS very high THEN speed IS fast WITH 0.8`.
//!
//! The precedence, from high to low, is NOT, AND, OR; parentheses group.

use alloc::{boxed::Box, string::String, vec::Vec};
use core::{ops::Range, str::FromStr};

use crate::diagnostic::Diagnostic;

mod mistake;
mod parse;
mod print;
#[cfg(test)]
mod tests;

pub use crate::table::Hedge;
pub(crate) use mistake::{Known, KnownNames, KnownVariable};
pub(crate) use parse::parse_with_weight;
pub use parse::{DEEPEST_NESTING, parse};

/// A name with its byte range in the source text. Names are equal if their texts are equal, regardless of their
/// positions.
#[derive(Debug, Clone, Eq)]
pub struct Name {
    /// The name, without quotes.
    pub text: String,
    /// The byte range in the text it was parsed from; `0..0` for names created in code.
    pub span: Range<usize>,
}

impl PartialEq for Name {
    fn eq(&self, other: &Self) -> bool {
        self.text == other.text
    }
}

impl From<&str> for Name {
    fn from(text: &str) -> Self {
        Name {
            text: text.into(),
            span: 0..0,
        }
    }
}

/// A rule: antecedent, consequents and weight.
///
/// # Example: the parts of a rule
/// ```
/// use fuzzy::rule::{Consequent, Rule};
///
/// let rule: Rule = "IF heat IS high THEN speed IS fast AND lamp IS on WITH 0.5".parse()?;
/// let Consequent { output, term, .. } = &rule.consequents[1];
/// assert_eq!((output.text.as_str(), term.text.as_str()), ("lamp", "on"));
/// assert_eq!(rule.weight, 0.5);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct Rule {
    /// The antecedent.
    pub condition: Condition,
    /// The consequents, at least one; several are joined by AND.
    pub consequents: Vec<Consequent>,
    /// The weight (`WITH w`), by which the firing strength is multiplied; 1 by default.
    pub weight: f64,
}

/// The antecedent of a rule, as a syntax tree.
#[derive(Debug, Clone, PartialEq)]
pub enum Condition {
    /// `variable IS hedge* term`.
    Is(Proposition),
    /// `NOT condition`: one minus the degree of the condition.
    Not(Box<Condition>),
    /// The conjunction of at least two conditions.
    And(Vec<Condition>),
    /// The disjunction of at least two conditions.
    Or(Vec<Condition>),
}

/// `variable IS hedge* term`. `variable IS NOT term` is the hedge [`Hedge::Not`].
#[derive(Debug, Clone, PartialEq)]
pub struct Proposition {
    /// The input, or the output that is read.
    pub variable: Name,
    /// The hedges in the order of the text; the one nearest to the term is applied first.
    pub hedges: Vec<Hedge>,
    /// The term; `None` after the hedge `any`, which needs no term.
    pub term: Option<Name>,
}

/// A consequent after THEN: `output IS hedge* term`.
#[derive(Debug, Clone, PartialEq)]
pub struct Consequent {
    /// The output.
    pub output: Name,
    /// The hedges in the order of the text; the one nearest to the term is applied first. They change the firing
    /// strength: with the degree `d` of the antecedent, the weight `w` and the hedge `h`, the term is activated with
    /// `h(w d)`. `NOT` and `any` are not allowed.
    pub hedges: Vec<Hedge>,
    /// The term of that output.
    pub term: Name,
}

impl Rule {
    /// Returns whether a word, in upper or lower case, is a keyword of the rule language. A name that equals a keyword
    /// must be quoted.
    #[must_use]
    pub fn is_keyword(word: &str) -> bool {
        let keywords = ["IF", "IS", "AND", "OR", "THEN", "WITH"];
        let hedges = Hedge::ALL.iter().map(|hedge| hedge.word());
        keywords
            .into_iter()
            .chain(hedges)
            .any(|keyword| keyword.eq_ignore_ascii_case(word))
    }
}

impl Consequent {
    /// Applies the hedges of the consequent to `strength`, the degree of the antecedent times the weight.
    pub(crate) fn hedged(&self, strength: f64) -> f64 {
        let hedges = self.hedges.iter().rev();
        hedges.fold(strength, |strength, hedge| hedge.of(strength))
    }
}

impl Rule {
    /// Calls `change` for every name in the rule, from left to right.
    pub(crate) fn names_mut(&mut self, change: &mut impl FnMut(&mut Name)) {
        self.condition.names_mut(change);
        for consequent in &mut self.consequents {
            change(&mut consequent.output);
            change(&mut consequent.term);
        }
    }
}

impl Condition {
    fn names_mut(&mut self, change: &mut impl FnMut(&mut Name)) {
        match self {
            Condition::Is(proposition) => {
                change(&mut proposition.variable);
                proposition.term.iter_mut().for_each(change);
            }
            Condition::Not(inner) => inner.names_mut(change),
            Condition::And(parts) | Condition::Or(parts) => {
                parts.iter_mut().for_each(|part| part.names_mut(change));
            }
        }
    }

    /// Calls `visit` for every proposition, from left to right.
    pub fn visit<'a>(&'a self, visit: &mut impl FnMut(&'a Proposition)) {
        match self {
            Condition::Is(proposition) => visit(proposition),
            Condition::Not(inner) => inner.visit(visit),
            Condition::And(parts) | Condition::Or(parts) => {
                for part in parts {
                    part.visit(visit);
                }
            }
        }
    }
}

impl FromStr for Rule {
    type Err = Box<Diagnostic>;

    /// Parses a rule: see [`parse`].
    fn from_str(text: &str) -> Result<Self, Box<Diagnostic>> {
        parse(text)
    }
}

/// Returns whether a name needs no quotes in a rule.
pub(crate) fn is_plain_name(name: &str) -> bool {
    !name.is_empty()
        && name
            .chars()
            .all(|c| c.is_alphanumeric() || matches!(c, '_' | '.' | '-' | '%'))
        && !Rule::is_keyword(name)
}
