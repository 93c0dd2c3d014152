//! Candidates for changes that make a rule set shorter.

use std::collections::{BTreeMap, BTreeSet};

use fuzzy::{
    Model,
    model::{Rule, Variable},
    rule::{self, Consequent},
};

use super::antecedent::{VariableCondition, condition, one_of, parts, size, variable};

/// A rule, and the indices of the original rules that it replaces.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct DerivedRule {
    pub(crate) rule: Rule,
    pub(crate) of: Vec<usize>,
}

/// The rules at their positions; `None` if a rule was removed.
pub(crate) type RuleSlots = Vec<Option<DerivedRule>>;

/// A replacement of rules by other rules.
#[derive(Debug, Clone)]
pub(crate) struct Change {
    /// The positions that are emptied first.
    pub(crate) empty: Vec<usize>,
    pub(crate) fill: Vec<(usize, DerivedRule)>,
    /// The reduction of the number of propositions.
    pub(crate) saved: usize,
    /// Whether an input is no longer named by any rule.
    pub(crate) has_fewer_inputs: bool,
}

/// The size of a group of rules above which only neighbours are merged, not all subsets.
const MAX_FOR_ALL_SUBSETS: usize = 6;

/// The changes that make rules shorter, largest reduction first. If `loose`, outputs may change, so rules with
/// different consequents and weights are merged as well.
pub(crate) fn changes(model: &Model, slots: &RuleSlots, loose: bool) -> Vec<Change> {
    let found = Finder {
        model,
        rules: slots
            .iter()
            .enumerate()
            .filter_map(|(slot, derived)| {
                let derived = derived.as_ref()?;
                let parts = parts(model, &derived.rule.rule.condition);
                Some((slot, derived, parts))
            })
            .collect(),
    };
    let mut changes = Vec::new();
    found.drops(&mut changes);
    let names = model.inputs.iter().map(|input| &input.name);
    let outputs = model.outputs.iter().map(|output| &output.variable.name);
    for name in names.chain(outputs) {
        found.without_variable(name, &mut changes);
        found.merges(name, loose, &mut changes);
    }
    changes.retain(|change| change.saved > 0);
    changes.sort_by_key(|change| std::cmp::Reverse(change.saved));
    changes
}

/// The number of propositions in a rule, including consequents.
pub(crate) fn rule_size(rule: &rule::Rule) -> usize {
    size(&rule.condition) + rule.consequents.len()
}

struct Finder<'a> {
    model: &'a Model,
    /// For each rule: its position, the rule itself, and the parts of its antecedent (`None` if the antecedent is not a
    /// conjunction of parts).
    rules: Vec<(usize, &'a DerivedRule, Option<Vec<VariableCondition>>)>,
}

/// A rule of a group whose members differ in one variable.
struct Member<'a> {
    slot: usize,
    derived: &'a DerivedRule,
    others: Vec<VariableCondition>,
    /// The index of the part for that variable.
    at: usize,
    terms: BTreeSet<usize>,
}

impl Finder<'_> {
    /// Adds changes that remove one rule, or one part of a rule. Such a change keeps the outputs if the removed rule or
    /// part has no effect.
    fn drops(&self, changes: &mut Vec<Change>) {
        // The rules are visited in reverse order, so that the first of two equal rules is kept.
        for (slot, derived, parts) in self.rules.iter().rev() {
            changes.push(Change {
                empty: vec![*slot],
                fill: Vec::new(),
                saved: rule_size(&derived.rule.rule),
                has_fewer_inputs: false,
            });
            for part in parts.iter().flatten() {
                let kept = parts.iter().flatten().filter(|other| *other != part);
                let kept: Vec<VariableCondition> = kept.cloned().collect();
                if kept.is_empty() {
                    continue;
                }
                let mut shorter = (*derived).clone();
                shorter.rule.rule.condition = condition(&kept, &part.variable);
                changes.push(Change {
                    empty: vec![*slot],
                    saved: size(&part.condition),
                    fill: vec![(*slot, shorter)],
                    has_fewer_inputs: false,
                });
            }
        }
    }

    /// Adds the change that removes a variable from all rules. Of rules that are equal afterwards, the one with the
    /// largest support replaces the others.
    fn without_variable(&self, name: &str, changes: &mut Vec<Change>) {
        /// The position and the rule, and its parts without the variable.
        type Group<'a> = Vec<(usize, &'a DerivedRule, Vec<VariableCondition>)>;
        let mut groups: BTreeMap<String, Group<'_>> = BTreeMap::new();
        let mut names_it = false;
        for (slot, derived, parts) in &self.rules {
            let Some(parts) = parts else {
                let mut is_named = false;
                let condition = &derived.rule.rule.condition;
                condition.visit(&mut |proposition| is_named |= proposition.variable.text == name);
                if is_named {
                    return;
                }
                continue;
            };
            names_it |= parts.iter().any(|part| part.variable == name);
            let kept = parts.iter().filter(|part| part.variable != name);
            let kept: Vec<VariableCondition> = kept.cloned().collect();
            let key = format!("{} {}", derived.rule.block, text(&kept));
            groups.entry(key).or_default().push((*slot, derived, kept));
        }
        if !names_it {
            return;
        }
        let mut change = Change {
            empty: Vec::new(),
            fill: Vec::new(),
            saved: 0,
            has_fewer_inputs: true,
        };
        let mut sizes = [0, 0];
        for group in groups.values() {
            let mut support: BTreeMap<String, (u64, usize)> = BTreeMap::new();
            for (_, derived, _) in group {
                let entry = support.entry(consequents(derived)).or_default();
                entry.0 += derived.rule.support.unwrap_or(0);
                entry.1 += 1;
            }
            let most = support.values().max();
            let strongest = group
                .iter()
                .find(|(_, derived, _)| support.get(&consequents(derived)) == most);
            let Some(((_, strongest, kept), (slot, ..))) = strongest.zip(group.first()) else {
                return;
            };
            let members: Vec<&DerivedRule> = group.iter().map(|(_, derived, _)| *derived).collect();
            let merged = merged(
                &members,
                condition(kept, name),
                &strongest.rule.rule.consequents,
                strongest.rule.rule.weight,
            );
            sizes[0] += members
                .iter()
                .map(|s| rule_size(&s.rule.rule))
                .sum::<usize>();
            sizes[1] += rule_size(&merged.rule.rule);
            change.empty.extend(group.iter().map(|(slot, ..)| *slot));
            change.fill.push((*slot, merged));
        }
        change.saved = sizes[0].saturating_sub(sizes[1]);
        changes.push(change);
    }

    /// Adds the changes that merge rules that differ only in their condition on one variable.
    fn merges(&self, name: &str, loose: bool, changes: &mut Vec<Change>) {
        let Some(variable) = variable(self.model, name) else {
            return;
        };
        let all: BTreeSet<usize> = (0..variable.terms.len()).collect();
        // The rules are grouped by their conditions on the other variables.
        let mut groups: BTreeMap<String, Vec<Member<'_>>> = BTreeMap::new();
        for (slot, derived, parts) in &self.rules {
            let Some(parts) = parts else { continue };
            let at = parts.iter().position(|part| part.variable == name);
            let own = at.and_then(|at| parts.get(at));
            let Some(terms) = own.map_or(Some(all.clone()), |part| part.terms.clone()) else {
                continue;
            };
            let others = parts.iter().filter(|part| part.variable != name);
            let others: Vec<VariableCondition> = others.cloned().collect();
            let mut key = format!("{} {}", derived.rule.block, text(&others));
            if !loose {
                key += &consequents(derived);
            }
            groups.entry(key).or_default().push(Member {
                slot: *slot,
                derived,
                at: at.unwrap_or(others.len()),
                others,
                terms,
            });
        }
        for mut members in groups.into_values() {
            members.sort_by(|a, b| a.terms.cmp(&b.terms));
            for subset in subsets(members.len()) {
                let members = subset.iter().filter_map(|i| members.get(*i));
                merge(&members.collect::<Vec<_>>(), variable, changes);
            }
        }
    }
}

fn merge(members: &[&Member<'_>], variable: &Variable, changes: &mut Vec<Change>) {
    let terms = members
        .iter()
        .flat_map(|member| member.terms.iter().copied());
    let terms: BTreeSet<usize> = terms.collect();
    let mut members = members.to_vec();
    members.sort_by_key(|member| member.slot);
    let Some(first) = members.first() else {
        return;
    };
    let derived: Vec<&DerivedRule> = members.iter().map(|member| member.derived).collect();
    let mut consequents: Vec<&Vec<Consequent>> = Vec::new();
    for derived in &derived {
        let own = &derived.rule.rule.consequents;
        if !consequents.contains(&own) {
            consequents.push(own);
        }
    }
    let before: usize = derived.iter().map(|s| rule_size(&s.rule.rule)).sum();
    for way in one_of(variable, &terms) {
        let mut parts = first.others.clone();
        if let Some(condition) = way {
            let part = VariableCondition {
                variable: variable.name.clone(),
                condition,
                terms: Some(terms.clone()),
            };
            parts.insert(first.at, part);
        }
        let condition = condition(&parts, &variable.name);
        for consequents in &consequents {
            for weight in weights(&derived) {
                let merged = merged(&derived, condition.clone(), consequents, weight);
                changes.push(Change {
                    empty: members.iter().map(|member| member.slot).collect(),
                    saved: before.saturating_sub(rule_size(&merged.rule.rule)),
                    fill: vec![(first.slot, merged)],
                    has_fewer_inputs: false,
                });
            }
        }
    }
}

/// The candidate weights of a merged rule.
fn weights(derived: &[&DerivedRule]) -> Vec<f64> {
    let weights = || derived.iter().map(|derived| derived.rule.rule.weight);
    let largest = weights().fold(0.0, f64::max);
    let sum: f64 = weights().sum();
    let mut found = vec![largest];
    let mean = sum / derived.len() as f64;
    found.extend(
        [mean, sum]
            .into_iter()
            .filter(|weight| *weight != largest && *weight <= 1.0),
    );
    found
}

/// Merges several rules into one. Their support is added; their notes are joined.
fn merged(
    derived: &[&DerivedRule],
    condition: rule::Condition,
    consequents: &[Consequent],
    weight: f64,
) -> DerivedRule {
    let mut of: Vec<usize> = derived
        .iter()
        .flat_map(|derived| derived.of.clone())
        .collect();
    of.sort_unstable();
    let rules = || derived.iter().map(|derived| &derived.rule);
    let one = match derived {
        [one] => Some(&one.rule),
        _ => None,
    };
    let mut notes: Vec<&str> = Vec::new();
    for note in rules().filter_map(|rule| rule.note.as_deref()) {
        if !notes.contains(&note) {
            notes.push(note);
        }
    }
    let of_some = rules().any(|rule| rule.note.is_none());
    let note = if of_some { "in part: " } else { "" }.to_owned() + &notes.join("; ");
    DerivedRule {
        rule: Rule {
            rule: rule::Rule {
                condition,
                consequents: consequents.to_vec(),
                weight,
            },
            block: rules().next().map_or(0, |rule| rule.block),
            confidence: one.and_then(|one| one.confidence),
            support: rules()
                .filter_map(|rule| rule.support)
                .reduce(|a, b| a.saturating_add(b)),
            against: one.map_or_else(Vec::new, |one| one.against.clone()),
            note: (!notes.is_empty()).then_some(note),
        },
        of,
    }
}

/// The text of parts, in an order that does not depend on the order in which the author wrote them.
fn text(parts: &[VariableCondition]) -> String {
    let mut texts: Vec<String> = parts
        .iter()
        .map(|part| part.condition.to_string())
        .collect();
    texts.sort_unstable();
    texts.join(" AND ")
}

fn consequents(derived: &DerivedRule) -> String {
    let texts = derived
        .rule
        .rule
        .consequents
        .iter()
        .map(ToString::to_string);
    texts.collect::<Vec<String>>().join(" AND ")
}

/// The subsets of `count` ordered members that have at least two members; only runs of neighbours if `count` exceeds
/// [`MAX_FOR_ALL_SUBSETS`].
fn subsets(count: usize) -> Vec<Vec<usize>> {
    if count <= MAX_FOR_ALL_SUBSETS {
        let bits = 0_u32..1 << count;
        let of = |bits: u32| {
            (0..count)
                .filter(|i| bits >> i & 1 == 1)
                .collect::<Vec<usize>>()
        };
        return bits.filter(|bits| bits.count_ones() > 1).map(of).collect();
    }
    let from = 0..count;
    from.flat_map(|from| (from + 2..=count).map(move |to| (from..to).collect()))
        .collect()
}
