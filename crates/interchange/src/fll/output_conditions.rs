//! Conditions on outputs. In fuzzylite, the degree of such a condition is the degree to which earlier rules concluded
//! the term; the value of the output is not used. The condition is therefore replaced by the conditions of those
//! rules.

use std::collections::{BTreeMap, BTreeSet};

use fuzzy::{
    model::{Activation, Aggregation, Disjunction, Model, Operators, Rule},
    rule::{Condition, DEEPEST_NESTING, Hedge, Proposition},
};

use crate::model_draft::ModelDraft;

/// The maximum number of propositions that replace conditions on outputs. Without a limit, a chain of rules that read
/// outputs could multiply them.
const MAX_PROPOSITIONS: usize = 100_000;

pub(crate) fn replace(draft: &mut ModelDraft<'_>) {
    let concluding_rules = concluding_rules(&draft.model);
    let outputs = draft.model.outputs.iter();
    let outputs: BTreeSet<String> = outputs.map(|output| output.variable.name.clone()).collect();
    let mut room = MAX_PROPOSITIONS;
    for index in 0..draft.model.rules.len() {
        let Some(rule) = draft.model.rules.get(index) else {
            return;
        };
        if !mentions(&rule.rule.condition, &outputs) {
            continue;
        }
        let mut condition = rule.rule.condition.clone();
        let mut replacement = OutputReplacement {
            model: &draft.model,
            concluding_rules: &concluding_rules,
            outputs: &outputs,
            rule: index,
            room,
            problems: vec![],
        };
        let resolved = replacement.resolve(&mut condition);
        room = replacement.room;
        let problems = replacement.problems;
        let span = draft.spans.rules.get(index).map(|rule| rule.whole.clone());
        let part = draft.text.get(span.unwrap_or_default()).unwrap_or_default();
        if resolved.is_none() || depth(&condition) > 2 * DEEPEST_NESTING {
            let message = "the rule reads outputs whose rules have too many conditions".into();
            let help = format!(
                "conditions about outputs are replaced by those of their rules; this may give at most {MAX_PROPOSITIONS} conditions, nested {DEEPEST_NESTING} deep"
            );
            draft.error("too-large", part, message, &help);
            return;
        }
        let Some(rule) = draft.model.rules.get_mut(index) else {
            return;
        };
        let changes = rule.rule.condition != condition;
        rule.rule.condition = condition;
        if changes && problems.is_empty() {
            let message = "a condition is about an output".into();
            let help = "fuzzylite passes degrees on, so the condition is replaced by those of the rules that conclude the term";
            draft.note("handed-over", part, message, help);
        }
        for problem in problems {
            let help = "name the inputs in this rule instead of the output";
            draft.loss("handed-over", part, problem, help);
        }
    }
}

/// For each term of each output, the indices of the rules that conclude it, ascending.
type ConcludingRules = BTreeMap<(String, String), Vec<usize>>;

fn concluding_rules(model: &Model) -> ConcludingRules {
    let mut concluding_rules = ConcludingRules::new();
    for (index, rule) in model.rules.iter().enumerate() {
        for consequent in &rule.rule.consequents {
            let key = (consequent.output.text.clone(), consequent.term.text.clone());
            let rules = concluding_rules.entry(key).or_default();
            if rules.last() != Some(&index) {
                rules.push(index);
            }
        }
    }
    concluding_rules
}

fn mentions(condition: &Condition, outputs: &BTreeSet<String>) -> bool {
    let mut mentions = false;
    condition.visit(&mut |about| mentions |= outputs.contains(&about.variable.text));
    mentions
}

fn propositions(condition: &Condition) -> usize {
    let mut count = 0;
    condition.visit(&mut |_| count += 1);
    count
}

fn depth(condition: &Condition) -> usize {
    match condition {
        Condition::Is(_) => 0,
        Condition::Not(inner) => 1 + depth(inner),
        Condition::And(parts) | Condition::Or(parts) => {
            1 + parts.iter().map(depth).max().unwrap_or(0)
        }
    }
}

/// Replaces the propositions about outputs in the condition of one rule.
struct OutputReplacement<'m> {
    model: &'m Model,
    concluding_rules: &'m ConcludingRules,
    outputs: &'m BTreeSet<String>,
    rule: usize,
    /// The number of propositions that may still be added.
    room: usize,
    problems: Vec<String>,
}

impl OutputReplacement<'_> {
    /// Replaces the propositions about outputs; `None` if there would be too many.
    fn resolve(&mut self, condition: &mut Condition) -> Option<()> {
        match condition {
            Condition::Not(inner) => self.resolve(inner),
            Condition::And(parts) | Condition::Or(parts) => {
                parts.iter_mut().try_for_each(|part| self.resolve(part))
            }
            Condition::Is(proposition) => {
                if self.outputs.contains(&proposition.variable.text)
                    && let Some(term) = proposition.term.clone()
                {
                    *condition = self.concluded(&proposition.clone(), &term.text)?;
                }
                Some(())
            }
        }
    }

    /// The condition that replaces a proposition about an output; `None` if there would be too many propositions.
    fn concluded(&mut self, proposition: &Proposition, term: &str) -> Option<Condition> {
        let (model, name) = (self.model, &proposition.variable.text);
        let key = (name.clone(), term.to_owned());
        let all = self
            .concluding_rules
            .get(&key)
            .map_or(&[][..], Vec::as_slice);
        let before = all.partition_point(|&index| index < self.rule);
        if before < all.len() {
            self.problems
                .push(format!("`{name}` is concluded after its use"));
        }
        let before = all.get(..before).unwrap_or_default();
        let before = before.iter().filter_map(|&index| model.rules.get(index));
        let before: Vec<&Rule> = before.collect();
        let mut conditions = vec![];
        for rule in &before {
            let count = propositions(&rule.rule.condition);
            self.room = self.room.checked_sub(count)?;
            conditions.push(rule.rule.condition.clone());
        }
        if before.iter().any(|rule| rule.rule.weight != 1.0) {
            self.problems.push(format!(
                "`{name}` is concluded with a weight and used in a condition"
            ));
        }
        let user = model.rules.get(self.rule)?;
        let (operators, activation) = operators(model, user);
        let plain = |condition: &Condition| matches!(condition, Condition::Is(_));
        for other in &before {
            let (others, others_activation) = self::operators(model, other);
            let same = (others.and, others.or) == (operators.and, operators.or)
                || plain(&other.rule.condition);
            if !same
                || (activation, others_activation) != (Activation::General, Activation::General)
            {
                self.problems.push(format!(
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
            self.problems.push(format!(
                "`{name}` is concluded by several rules that are not joined by the maximum"
            ));
        }
        let condition = match conditions.len() {
            0 => match model.inputs.first() {
                Some(input) => Condition::Not(Box::new(Condition::Is(Proposition {
                    variable: input.name.as_str().into(),
                    hedges: vec![Hedge::Any],
                    term: None,
                }))),
                None => return Some(Condition::Is(proposition.clone())),
            },
            1 => conditions.remove(0),
            _ => Condition::Or(conditions),
        };
        Some(hedged(condition, &proposition.hedges, &mut self.problems))
    }
}

/// The operators of a rule, and the activation method of its block.
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
