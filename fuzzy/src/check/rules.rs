//! Comparison of rules: contradictory and subsumed rules, and rules that cannot fire.

use alloc::{
    collections::{BTreeMap, BTreeSet},
    string::{String, ToString},
    vec::Vec,
};

use super::logic::{Changes, Extent, Level, Logic};
use crate::{
    model::{self, Activation, Aggregation, Model, Output, concludes},
    rule::{Condition, Consequent, Rule},
};

/// Two rules with the same condition that conclude different terms of one output, or one rule that concludes both.
#[derive(Debug, Clone, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[non_exhaustive]
pub struct Contradiction {
    /// The earlier rule.
    #[cfg_attr(
        feature = "serde",
        serde(serialize_with = "crate::serial::rule_number")
    )]
    #[cfg_attr(feature = "schema", schemars(range(min = 1)))]
    pub first: usize,
    /// The later rule; equal to `first` if a rule contradicts itself.
    #[cfg_attr(
        feature = "serde",
        serde(serialize_with = "crate::serial::rule_number")
    )]
    #[cfg_attr(feature = "schema", schemars(range(min = 1)))]
    pub second: usize,
    /// The output for which the conclusions differ.
    pub output: String,
    /// The term that the earlier rule concludes.
    pub first_term: String,
    /// The term that the later rule concludes.
    pub second_term: String,
}

/// A rule without effect: whenever it fires, another rule with the same conclusion fires at least as strongly.
#[derive(Debug, Clone, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct SubsumedRule {
    /// The rule without effect.
    #[cfg_attr(
        feature = "serde",
        serde(serialize_with = "crate::serial::rule_number")
    )]
    #[cfg_attr(feature = "schema", schemars(range(min = 1)))]
    pub rule: usize,
    /// The more general rule.
    #[cfg_attr(
        feature = "serde",
        serde(serialize_with = "crate::serial::rule_number")
    )]
    #[cfg_attr(feature = "schema", schemars(range(min = 1)))]
    pub by: usize,
}

/// A condition as the sorted set of its parts, so that the order of the parts does not matter.
#[derive(Debug, Clone, PartialEq, Eq, PartialOrd, Ord)]
enum Parts {
    All(Vec<usize>),
    Any(Vec<usize>),
}

/// Assigns a number to each distinct part of a condition, so that conditions can be compared quickly.
#[derive(Default)]
struct PartIds(BTreeMap<String, usize>);

impl PartIds {
    fn of(&mut self, condition: &Condition) -> usize {
        let text = canonical(condition);
        let next = self.0.len();
        *self.0.entry(text).or_insert(next)
    }

    fn parts(&mut self, condition: &Condition) -> Parts {
        let mut sorted = |parts: &[Condition]| {
            let mut numbers: Vec<usize> = parts.iter().map(|part| self.of(part)).collect();
            numbers.sort_unstable();
            numbers.dedup();
            numbers
        };
        match condition {
            Condition::And(parts) => Parts::All(sorted(parts)),
            Condition::Or(parts) => Parts::Any(sorted(parts)),
            // A condition with a single part could be either variant. It is stored as a
            // conjunction, because most conditions are conjunctions.
            one => Parts::All(sorted(core::slice::from_ref(one))),
        }
    }
}

/// Returns the text of the condition in a form that does not depend on the order of the operands of AND and OR.
fn canonical(condition: &Condition) -> String {
    let joined = |parts: &[Condition], word: &str| {
        let mut texts: Vec<String> = parts.iter().map(canonical).collect();
        texts.sort_unstable();
        texts.dedup();
        alloc::format!("({})", texts.join(word))
    };
    match condition {
        Condition::Is(proposition) => proposition.to_string(),
        Condition::Not(inner) => alloc::format!("NOT {}", canonical(inner)),
        Condition::And(parts) => joined(parts, " AND "),
        Condition::Or(parts) => joined(parts, " OR "),
    }
}

/// Returns whether a rule is compared with the other rules of its block. It must be enabled, and the block must not
/// have an activation method: with a method such as `first`, rules are meant to override one another.
fn is_compared(model: &Model, rule: &model::Rule) -> bool {
    model.is_enabled(rule) && model.activation_of(rule) == Activation::General
}

/// Returns the rules that conclude two terms of one output, and the rules with the same block and condition as an
/// earlier rule but a different conclusion. Each is listed with the first rule that it contradicts.
pub(super) fn contradictions(model: &Model) -> Vec<Contradiction> {
    let mut found = Vec::new();
    for (i, rule) in model.rules.iter().enumerate() {
        let consequents = &rule.rule.consequents;
        for (k, one) in consequents.iter().enumerate() {
            let earlier = consequents.iter().take(k);
            let other = earlier
                .rev()
                .find(|c| c.output == one.output && c.term != one.term);
            found.extend(other.map(|other| Contradiction {
                first: i,
                second: i,
                output: one.output.text.clone(),
                first_term: other.term.text.clone(),
                second_term: one.term.text.clone(),
            }));
        }
    }
    let mut ids = PartIds::default();
    let mut by_parts: BTreeMap<(usize, Parts), Vec<usize>> = BTreeMap::new();
    for (i, rule) in model.rules.iter().enumerate() {
        if is_compared(model, rule) {
            let parts = ids.parts(&rule.rule.condition);
            by_parts.entry((rule.block, parts)).or_default().push(i);
        }
    }
    for rules in by_parts.values() {
        // The first of the rules with equal conclusions represents all of them.
        let mut firsts: Vec<usize> = Vec::new();
        let mut seen: BTreeSet<String> = BTreeSet::new();
        for &second in rules {
            let earlier = firsts.iter();
            found.extend(
                earlier
                    .clone()
                    .find_map(|&first| disagreement(model, first, second)),
            );
            let rule = model.rules.get(second).map(|rule| conclusion(&rule.rule));
            if rule.is_some_and(|conclusion| seen.insert(conclusion)) {
                firsts.push(second);
            }
        }
    }
    found.sort_by_key(|c| (c.second, c.first));
    found
}

fn disagreement(model: &Model, first: usize, second: usize) -> Option<Contradiction> {
    let (a, b) = (
        &model.rules.get(first)?.rule,
        &model.rules.get(second)?.rule,
    );
    // If a rule has several conclusions about one output, the first one counts.
    let others = b.consequents.iter().rev();
    let others: BTreeMap<&str, &Consequent> = others.map(|c| (&*c.output.text, c)).collect();
    a.consequents.iter().find_map(|one| {
        let other = others.get(&*one.output.text)?;
        (one.term != other.term).then(|| Contradiction {
            first,
            second,
            output: one.output.text.clone(),
            first_term: one.term.text.clone(),
            second_term: other.term.text.clone(),
        })
    })
}

/// The maximum number of pairs of rules that are compared, which suffices for 10,000 rules with the same conclusion.
/// Beyond that, only the first pairs are compared.
const MAX_COMPARISONS: usize = 100_000_000;

/// Returns the rules that have no effect because a more general rule has the same block and conclusion. Equal rules are
/// reported elsewhere.
pub(super) fn subsumed(model: &Model) -> Vec<SubsumedRule> {
    let mut ids = PartIds::default();
    let mut groups: BTreeMap<(usize, String), Vec<Member>> = BTreeMap::new();
    // If an aggregation is not the maximum, a rule adds to the result even if a more general rule fires.
    let aggregation = |output: &Output| model.operators_of_output(output).aggregation;
    let outputs = model.outputs.iter();
    let adding = outputs.filter(|output| aggregation(output) != Aggregation::Maximum);
    let adding: Vec<&Output> = adding.collect();
    for (index, rule) in model.rules.iter().enumerate() {
        let adds = adding.iter().any(|output| concludes(rule, output));
        if adds || !is_compared(model, rule) {
            continue;
        }
        let parts = ids.parts(&rule.rule.condition);
        let weight = rule.rule.weight;
        let signature = match &parts {
            Parts::All(parts) | Parts::Any(parts) => parts
                .iter()
                .fold(0u64, |bits, part| bits | 1 << (part % 64)),
        };
        groups
            .entry((rule.block, conclusion(&rule.rule)))
            .or_default()
            .push(Member {
                index,
                parts,
                signature,
                weight,
            });
    }
    let mut found = Vec::new();
    let mut left = MAX_COMPARISONS;
    for group in groups.values() {
        for narrow in group {
            left = left.saturating_sub(group.len());
            if left == 0 {
                break;
            }
            let wider = group.iter().find(|wide| {
                wide.index != narrow.index && wide.weight >= narrow.weight && wide.includes(narrow)
            });
            found.extend(wider.map(|wide| SubsumedRule {
                rule: narrow.index,
                by: wide.index,
            }));
        }
    }
    found.sort_by_key(|s| s.rule);
    found
}

struct Member {
    index: usize,
    parts: Parts,
    /// A bit mask in which each part sets a bit, so that a single comparison excludes most pairs of rules.
    signature: u64,
    weight: f64,
}

impl Member {
    /// Returns whether this condition is true whenever the narrower one is, and the two are not equal.
    fn includes(&self, narrow: &Member) -> bool {
        let subset = |a: &[usize], b: &[usize]| {
            a.len() < b.len() && a.iter().all(|part| b.binary_search(part).is_ok())
        };
        match (&self.parts, &narrow.parts) {
            // A conjunction is more general than one with additional parts.
            (Parts::All(wide), Parts::All(all)) => {
                self.signature & !narrow.signature == 0 && subset(wide, all)
            }
            // A disjunction is more general than one with fewer of its parts.
            (Parts::Any(wide), Parts::Any(any)) => {
                narrow.signature & !self.signature == 0 && subset(any, wide)
            }
            (Parts::Any(wide), Parts::All(all)) => {
                all.iter().any(|part| wide.binary_search(part).is_ok())
            }
            (Parts::All(_), Parts::Any(_)) => false,
        }
    }
}

fn conclusion(rule: &Rule) -> String {
    let mut texts: Vec<String> = rule.consequents.iter().map(ToString::to_string).collect();
    texts.sort_unstable();
    texts.join(" AND ")
}

/// Returns the rules that cannot fire because their condition is contradictory or their weight is 0.
pub(super) fn never_firing(model: &Model) -> Vec<usize> {
    let level = Level::fires(model);
    let conditions = model.rules.iter().map(|rule| &rule.rule.condition);
    let logic = Logic::new(
        model,
        conditions,
        level,
        Extent::Points,
        &mut Changes::new(),
    );
    let rules = model.rules.iter().zip(&logic.formulas).enumerate();
    let dead = rules.filter(|(_, (rule, formula))| {
        model.is_enabled(rule) && (rule.rule.weight <= 0.0 || !logic.holds_somewhere(formula))
    });
    dead.map(|(i, _)| i).collect()
}
