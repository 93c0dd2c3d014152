//! Conditions about outputs. In fuzzylite such a condition is as true as the rules before it that conclude the term are: the
//! degrees are handed over, not the value. So the condition becomes the conditions of those rules.

use fuzzy::{
    model::{Activation, Aggregation, Disjunction, Model, Operators, Rule},
    rule::{Condition, Hedge, Proposition},
};

use crate::draft::Draft;

pub(crate) fn replace(draft: &mut Draft<'_>) {
    for index in 0..draft.model.rules.len() {
        let Some(rule) = draft.model.rules.get(index) else {
            return;
        };
        let mut condition = rule.rule.condition.clone();
        let mut problems = vec![];
        resolve(&mut condition, &draft.model, index, &mut problems);
        let Some(rule) = draft.model.rules.get_mut(index) else {
            return;
        };
        let changes = rule.rule.condition != condition;
        rule.rule.condition = condition;
        let span = draft.spans.rules.get(index).map(|rule| rule.whole.clone());
        let part = draft.text.get(span.unwrap_or_default()).unwrap_or_default();
        if changes && problems.is_empty() {
            let message = "a condition is about an output".into();
            let help = "fuzzylite hands degrees over, so it becomes the conditions of the rules that conclude the term";
            draft.note("handed-over", part, message, help);
        }
        for problem in problems {
            let help = "name the inputs in this rule instead of the output";
            draft.loss("handed-over", part, problem, help);
        }
    }
}

/// Replaces the propositions about outputs in the condition of a rule.
fn resolve(condition: &mut Condition, model: &Model, rule: usize, problems: &mut Vec<String>) {
    match condition {
        Condition::Not(inner) => resolve(inner, model, rule, problems),
        Condition::And(parts) | Condition::Or(parts) => {
            for part in parts {
                resolve(part, model, rule, problems);
            }
        }
        Condition::Is(proposition) => {
            if let Some(replaced) = concluded(proposition, model, rule, problems) {
                *condition = replaced;
            }
        }
    }
}

/// What concludes the term of a proposition about an output; `None` of an input.
fn concluded(
    proposition: &Proposition,
    model: &Model,
    rule: usize,
    problems: &mut Vec<String>,
) -> Option<Condition> {
    let name = &proposition.variable.text;
    let is_output = model
        .outputs
        .iter()
        .any(|output| output.variable.name == *name);
    let term = proposition.term.as_ref().filter(|_| is_output)?;
    let concludes = |rule: &&Rule| {
        let mut consequents = rule.rule.consequents.iter();
        consequents
            .any(|consequent| consequent.output == proposition.variable && consequent.term == *term)
    };
    let before: Vec<_> = model.rules.get(..rule)?.iter().filter(concludes).collect();
    if model.rules.get(rule..)?.iter().any(|rule| concludes(&rule)) {
        problems.push(format!("`{name}` is concluded after its use"));
    }
    if before.iter().any(|rule| rule.rule.weight != 1.0) {
        problems.push(format!(
            "`{name}` is concluded with a weight and used in a condition"
        ));
    }
    let mut conditions: Vec<Condition> = before
        .iter()
        .map(|rule| rule.rule.condition.clone())
        .collect();
    let user = model.rules.get(rule)?;
    let (operators, activation) = operators(model, user);
    let plain = |condition: &Condition| matches!(condition, Condition::Is(_));
    for other in &before {
        let (others, others_activation) = self::operators(model, other);
        let same = (others.and, others.or) == (operators.and, operators.or)
            || plain(&other.rule.condition);
        if !same || (activation, others_activation) != (Activation::General, Activation::General) {
            problems.push(format!(
                "`{name}` is concluded in a block with other operators or another activation"
            ));
        }
    }
    let output = model
        .outputs
        .iter()
        .find(|output| output.variable.name == *name);
    let aggregation = output
        .and_then(|output| output.aggregation)
        .unwrap_or(operators.aggregation);
    let largest = aggregation == Aggregation::Maximum && operators.or == Disjunction::Maximum;
    if conditions.len() > 1 && !largest {
        problems.push(format!(
            "`{name}` is concluded by several rules that are not joined by the maximum"
        ));
    }
    let condition = match conditions.len() {
        0 => Condition::Not(Box::new(Condition::Is(Proposition {
            variable: model.inputs.first()?.name.as_str().into(),
            hedges: vec![Hedge::Any],
            term: None,
        }))),
        1 => conditions.remove(0),
        _ => Condition::Or(conditions),
    };
    Some(hedged(condition, &proposition.hedges, problems))
}

/// The operators of a rule, and which rules of its block fire.
fn operators(model: &Model, rule: &Rule) -> (Operators, Activation) {
    let block = model.blocks.get(rule.block);
    (
        model.operators_of(rule),
        block.map_or(model.activation, |block| block.activation),
    )
}

fn hedged(mut condition: Condition, hedges: &[Hedge], problems: &mut Vec<String>) -> Condition {
    for &hedge in hedges.iter().rev() {
        condition = match (condition, hedge) {
            (Condition::Is(mut proposition), hedge) => {
                proposition.hedges.insert(0, hedge);
                Condition::Is(proposition)
            }
            (other, Hedge::Not) => Condition::Not(Box::new(other)),
            (other, hedge) => {
                let word = hedge.word();
                problems.push(format!("an output is hedged with `{word}` in a condition"));
                other
            }
        };
    }
    condition
}
