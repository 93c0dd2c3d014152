//! Antecedents as conditions on single variables, and sets of terms as conditions.

use std::collections::BTreeSet;

use fuzzy::{
    Model,
    model::Variable,
    rule::{Condition, Hedge, Name, Proposition},
};

/// The condition of an antecedent on one variable.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct VariableCondition {
    pub(crate) variable: String,
    pub(crate) condition: Condition,
    /// The indices of the terms that satisfy the condition; `None` if it contains hedges other than
    /// NOT.
    pub(crate) terms: Option<BTreeSet<usize>>,
}

/// Returns the parts of an antecedent, one for each variable, that are joined by AND; `None` if the
/// antecedent is not such a conjunction.
pub(crate) fn parts(model: &Model, condition: &Condition) -> Option<Vec<VariableCondition>> {
    let mut found: Vec<(String, Vec<Condition>)> = Vec::new();
    for condition in conjuncts(condition) {
        let mut names = BTreeSet::new();
        condition.visit(&mut |proposition| {
            names.insert(proposition.variable.text.clone());
        });
        let name = names.pop_first().filter(|_| names.is_empty())?;
        match found.iter_mut().find(|(known, _)| *known == name) {
            Some((_, conditions)) => conditions.push(condition.clone()),
            None => found.push((name, vec![condition.clone()])),
        }
    }
    let part = |(name, mut conditions): (String, Vec<Condition>)| {
        let condition = match conditions.len() {
            1 => conditions.remove(0),
            _ => Condition::And(conditions),
        };
        Some(VariableCondition {
            terms: terms(variable(model, &name)?, &condition),
            variable: name,
            condition,
        })
    };
    found.into_iter().map(part).collect()
}

/// Returns the input or output with the given name.
pub(crate) fn variable<'m>(model: &'m Model, name: &str) -> Option<&'m Variable> {
    model.variables().find(|variable| variable.name == name)
}

/// Joins parts into an antecedent. If there are no parts, the antecedent is always true: `variable IS any`.
pub(crate) fn condition(parts: &[VariableCondition], variable: &str) -> Condition {
    let mut conditions: Vec<Condition> = parts
        .iter()
        .flat_map(|part| conjuncts(&part.condition))
        .cloned()
        .collect();
    match conditions.len() {
        0 => is(variable, &[Hedge::Any], None),
        1 => conditions.remove(0),
        _ => Condition::And(conditions),
    }
}

/// Returns alternative conditions that are true if a variable belongs to one of the given terms,
/// the shortest first; `None` in the list means that no condition is needed.
pub(crate) fn one_of(variable: &Variable, terms: &BTreeSet<usize>) -> Vec<Option<Condition>> {
    let is = |index: usize, hedges: &[Hedge]| {
        let term = variable.terms.get(index)?;
        Some(is(&variable.name, hedges, Some(&term.name)))
    };
    let all = 0..variable.terms.len();
    let others: Option<Vec<Condition>> = all
        .filter(|index| !terms.contains(index))
        .map(|index| is(index, &[Hedge::Not]))
        .collect();
    let named: Option<Vec<Condition>> = terms.iter().map(|index| is(*index, &[])).collect();
    let (Some(mut others), Some(mut named)) = (others, named) else {
        return Vec::new();
    };
    let mut ways = Vec::new();
    match others.len() {
        0 => ways.push(None),
        1 if named.len() > 1 => ways.push(Some(others.remove(0))),
        2 if named.len() > 2 => ways.push(Some(Condition::And(others))),
        _ => {}
    }
    ways.push(Some(match named.len() {
        1 => named.remove(0),
        _ => Condition::Or(named),
    }));
    ways
}

/// The number of propositions in a condition.
pub(crate) fn size(condition: &Condition) -> usize {
    let mut count = 0;
    condition.visit(&mut |_| count += 1);
    count
}

fn is(variable: &str, hedges: &[Hedge], term: Option<&str>) -> Condition {
    Condition::Is(Proposition {
        variable: Name::from(variable),
        hedges: hedges.to_vec(),
        term: term.map(Name::from),
    })
}

/// The conditions that are joined by AND, at any depth of nesting.
fn conjuncts(condition: &Condition) -> Vec<&Condition> {
    match condition {
        Condition::And(parts) => parts.iter().flat_map(conjuncts).collect(),
        one => vec![one],
    }
}

fn terms(variable: &Variable, condition: &Condition) -> Option<BTreeSet<usize>> {
    let all = || (0..variable.terms.len()).collect::<BTreeSet<usize>>();
    let sets = |parts: &[Condition]| {
        let sets = parts.iter().map(|part| terms(variable, part));
        sets.collect::<Option<Vec<_>>>()
    };
    match condition {
        Condition::Is(proposition) => {
            let Some(name) = &proposition.term else {
                return Some(all());
            };
            let index = variable.terms.iter().position(|t| t.name == name.text)?;
            let named = BTreeSet::from([index]);
            match proposition.hedges.as_slice() {
                [] => Some(named),
                [Hedge::Not] => Some(&all() - &named),
                _ => None,
            }
        }
        Condition::Not(inner) => Some(&all() - &terms(variable, inner)?),
        Condition::And(parts) => sets(parts)?.into_iter().reduce(|a, b| &a & &b),
        Condition::Or(parts) => sets(parts)?.into_iter().reduce(|a, b| &a | &b),
    }
}
