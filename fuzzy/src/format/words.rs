//! The names of operators and defuzzifiers in the format.

use alloc::{format, vec::Vec};

use crate::{
    diagnostic::Diagnostic,
    model::{Aggregation, Conjunction, Disjunction, Operators, TypeReduction},
    tree::Node,
};

pub(super) const CONJUNCTIONS: [(&str, Conjunction); Conjunction::ALL.len()] = [
    ("minimum", Conjunction::Minimum),
    ("product", Conjunction::Product),
    ("bounded_difference", Conjunction::BoundedDifference),
    ("drastic", Conjunction::Drastic),
    ("einstein", Conjunction::Einstein),
    ("hamacher", Conjunction::Hamacher),
    ("nilpotent_minimum", Conjunction::NilpotentMinimum),
];

pub(super) const DISJUNCTIONS: [(&str, Disjunction); Disjunction::ALL.len()] = [
    ("maximum", Disjunction::Maximum),
    ("probabilistic_sum", Disjunction::ProbabilisticSum),
    ("bounded_sum", Disjunction::BoundedSum),
    ("drastic", Disjunction::Drastic),
    ("einstein", Disjunction::Einstein),
    ("hamacher", Disjunction::Hamacher),
    ("nilpotent_maximum", Disjunction::NilpotentMaximum),
];

pub(super) const AGGREGATIONS: [(&str, Aggregation); Aggregation::ALL.len()] = [
    ("maximum", Aggregation::Maximum),
    ("probabilistic_sum", Aggregation::ProbabilisticSum),
    ("bounded_sum", Aggregation::BoundedSum),
    ("sum", Aggregation::Sum),
    ("drastic", Aggregation::Drastic),
    ("einstein", Aggregation::Einstein),
    ("hamacher", Aggregation::Hamacher),
    ("nilpotent_maximum", Aggregation::NilpotentMaximum),
];

pub(super) use crate::model::DEFUZZIFIERS;

pub(super) const TYPE_REDUCTIONS: [(&str, TypeReduction); TypeReduction::ALL.len()] = [
    ("exact", TypeReduction::Exact),
    ("nie_tan", TypeReduction::NieTan),
    ("begian_melek_mendel", TypeReduction::BegianMelekMendel),
    ("wu_mendel", TypeReduction::WuMendel),
];

/// Returns the word for a value; every value has one.
pub(super) fn word_of<T: PartialEq>(words: &[(&'static str, T)], value: T) -> &'static str {
    words
        .iter()
        .find(|(_, other)| *other == value)
        .map_or("", |(word, _)| *word)
}

/// Returns the word for a disjunction.
pub fn word_of_or(or: Disjunction) -> &'static str {
    word_of(&DISJUNCTIONS, or)
}

/// Reads a mapping of operators that may contain only `keys`; omitted operators are taken from `otherwise`.
pub(super) fn operators(
    node: &Node,
    what: &str,
    keys: &[&str],
    otherwise: Operators,
    findings: &mut Vec<Diagnostic>,
) -> Option<Operators> {
    let word = node.as_text().unwrap_or("");
    let key = match CONJUNCTIONS.iter().any(|(known, _)| *known == word) {
        true => Some("and"),
        false => DISJUNCTIONS
            .iter()
            .any(|(known, _)| *known == word)
            .then_some("or"),
    };
    let help = match key {
        Some(key) => format!("name the operator: `operators: {{{key}: {word}}}`"),
        None => "write `operators: {and: product, or: maximum}`, with the operators that differ from the defaults".into(),
    };
    let fields = node.fields(what, keys, &help, findings)?;
    let mut operators = otherwise;
    if let Some(node) = fields.get("and") {
        let before = findings.len();
        let word = node.choice("the operator `and`", &CONJUNCTIONS, findings);
        let word_of_or = node.as_text();
        let is_or = DISJUNCTIONS
            .iter()
            .any(|(known, _)| Some(*known) == word_of_or);
        if let Some(finding) = findings.get_mut(before)
            && let Some(word) = word_of_or.filter(|_| is_or)
        {
            finding.help = Some(format!(
                "`{word}` is an operator for `or`: write `or: {word}`"
            ));
        }
        operators.and = word.unwrap_or(operators.and);
    }
    if let Some(node) = fields.get("or") {
        let word = node.choice("the operator `or`", &DISJUNCTIONS, findings);
        operators.or = word.unwrap_or(operators.or);
    }
    if let Some(node) = fields.get("implication") {
        let word = node.choice("the operator `implication`", &CONJUNCTIONS, findings);
        operators.implication = word.unwrap_or(operators.implication);
    }
    if let Some(node) = fields.get("aggregation") {
        let word = node.choice("the operator `aggregation`", &AGGREGATIONS, findings);
        operators.aggregation = word.unwrap_or(operators.aggregation);
    }
    Some(operators)
}

/// Returns the operators in the format of a file, each with its key.
pub(super) fn written(operators: Operators) -> [(&'static str, Node); 4] {
    [
        ("and", Node::text(word_of(&CONJUNCTIONS, operators.and))),
        ("or", Node::text(word_of(&DISJUNCTIONS, operators.or))),
        (
            "implication",
            Node::text(word_of(&CONJUNCTIONS, operators.implication)),
        ),
        (
            "aggregation",
            Node::text(word_of(&AGGREGATIONS, operators.aggregation)),
        ),
    ]
}
