//! Rewrites conditions without NOT before brackets, because only YAML supports this use of NOT.

use fuzzy::{
    model::{Conjunction, Disjunction, Operators},
    rule::{Condition, Hedge},
};

/// The disjunction that is related to a conjunction by De Morgan's law.
pub(crate) fn dual(and: Conjunction) -> Disjunction {
    match and {
        Conjunction::Minimum => Disjunction::Maximum,
        Conjunction::Product => Disjunction::ProbabilisticSum,
        Conjunction::BoundedDifference => Disjunction::BoundedSum,
        Conjunction::Drastic => Disjunction::Drastic,
        Conjunction::Einstein => Disjunction::Einstein,
        Conjunction::Hamacher => Disjunction::Hamacher,
        Conjunction::NilpotentMinimum => Disjunction::NilpotentMaximum,
    }
}

/// The condition with every NOT moved to a proposition: `NOT (a AND b)` becomes `NOT a OR NOT b` if the operators are
/// dual; `None` if they are not.
pub(crate) fn without_not(condition: &Condition, operators: Operators) -> Option<Condition> {
    let all = |parts: &[Condition], negated: bool| {
        let negate = |part: &Condition| match negated {
            true => Condition::Not(Box::new(part.clone())),
            false => part.clone(),
        };
        let parts = parts
            .iter()
            .map(|part| without_not(&negate(part), operators));
        parts.collect::<Option<Vec<Condition>>>()
    };
    let is_dual = dual(operators.and) == operators.or;
    Some(match condition {
        Condition::Is(_) => condition.clone(),
        Condition::And(parts) => Condition::And(all(parts, false)?),
        Condition::Or(parts) => Condition::Or(all(parts, false)?),
        Condition::Not(inner) => match &**inner {
            Condition::Not(inner) => without_not(inner, operators)?,
            Condition::Is(proposition) => {
                let mut proposition = proposition.clone();
                proposition.hedges.insert(0, Hedge::Not);
                Condition::Is(proposition)
            }
            Condition::And(parts) if is_dual => Condition::Or(all(parts, true)?),
            Condition::Or(parts) if is_dual => Condition::And(all(parts, true)?),
            Condition::And(_) | Condition::Or(_) => return None,
        },
    })
}
