//! Candidates for changes that make a rule set shorter.

use std::collections::{BTreeMap, BTreeSet};

use fuzzy::{
    Model,
    model::{Rule, Variable},
    rule::{self, Consequent},
};

use super::antecedent::{Part, condition, one_of, parts, size, variable};

/// A rule, and the indices of the original rules that it replaces.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Standing {
    pub(crate) rule: Rule,
    pub(crate) of: Vec<usize>,
}

/// The rules at their positions; `None` if a rule was removed.
pub(crate) type Places = Vec<Option<Standing>>;

/// A replacement of rules by other rules.
#[derive(Debug, Clone)]
pub(crate) struct Change {
    /// The positions that are emptied first.
    pub(crate) empty: Vec<usize>,
    pub(crate) fill: Vec<(usize, Standing)>,
    /// The reduction of the number of propositions.
    pub(crate) saved: usize,
    /// Whether an input is no longer named by any rule.
    pub(crate) has_fewer_inputs: bool,
}

/// The size of a group of rules above which only neighbours are merged, not all subsets.
const MOST_FOR_ALL_SUBSETS: usize = 6;

/// The changes that make rules shorter, largest reduction first. With `loose`, if outputs may change, also merges of
/// rules with different consequents and weights.
pub(crate) fn changes(model: &Model, places: &Places, loose: bool) -> Vec<Change> {
    let found = Finder {
        model,
        rules: places
            .iter()
            .enumerate()
            .filter_map(|(place, standing)| {
                let standing = standing.as_ref()?;
                let parts = parts(model, &standing.rule.rule.condition);
                Some((place, standing, parts))
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
    /// The position, the rule, and the parts of its antecedent if that is a conjunction of parts.
    rules: Vec<(usize, &'a Standing, Option<Vec<Part>>)>,
}

/// A rule of a group whose members differ in one variable.
struct Member<'a> {
    place: usize,
    standing: &'a Standing,
    others: Vec<Part>,
    /// The index of the part for that variable.
    at: usize,
    terms: BTreeSet<usize>,
}

impl Finder<'_> {
    /// Adds the removal of rules and of parts of rules, which may have no effect.
    fn drops(&self, changes: &mut Vec<Change>) {
        // Of two equal rules, the first is kept.
        for (place, standing, parts) in self.rules.iter().rev() {
            changes.push(Change {
                empty: vec![*place],
                fill: Vec::new(),
                saved: rule_size(&standing.rule.rule),
                has_fewer_inputs: false,
            });
            for part in parts.iter().flatten() {
                let kept = parts.iter().flatten().filter(|other| *other != part);
                let kept: Vec<Part> = kept.cloned().collect();
                if kept.is_empty() {
                    continue;
                }
                let mut shorter = (*standing).clone();
                shorter.rule.rule.condition = condition(&kept, &part.variable);
                changes.push(Change {
                    empty: vec![*place],
                    saved: size(&part.condition),
                    fill: vec![(*place, shorter)],
                    has_fewer_inputs: false,
                });
            }
        }
    }

    /// Adds the removal of a variable from all rules. Of rules that are equal afterwards, the one with the largest
    /// support replaces the others.
    fn without_variable(&self, name: &str, changes: &mut Vec<Change>) {
        /// The position and the rule, and its parts without the variable.
        type Group<'a> = Vec<(usize, &'a Standing, Vec<Part>)>;
        let mut groups: BTreeMap<String, Group<'_>> = BTreeMap::new();
        let mut names_it = false;
        for (place, standing, parts) in &self.rules {
            let Some(parts) = parts else {
                let mut is_named = false;
                let condition = &standing.rule.rule.condition;
                condition.visit(&mut |proposition| is_named |= proposition.variable.text == name);
                if is_named {
                    return;
                }
                continue;
            };
            names_it |= parts.iter().any(|part| part.variable == name);
            let kept = parts.iter().filter(|part| part.variable != name);
            let kept: Vec<Part> = kept.cloned().collect();
            let key = format!("{} {}", standing.rule.block, text(&kept));
            groups
                .entry(key)
                .or_default()
                .push((*place, standing, kept));
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
            for (_, standing, _) in group {
                let entry = support.entry(consequents(standing)).or_default();
                entry.0 += standing.rule.support.unwrap_or(0);
                entry.1 += 1;
            }
            let most = support.values().max();
            let strongest = group
                .iter()
                .find(|(_, standing, _)| support.get(&consequents(standing)) == most);
            let Some(((_, strongest, kept), (place, ..))) = strongest.zip(group.first()) else {
                return;
            };
            let members: Vec<&Standing> = group.iter().map(|(_, standing, _)| *standing).collect();
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
            change.empty.extend(group.iter().map(|(place, ..)| *place));
            change.fill.push((*place, merged));
        }
        change.saved = sizes[0].saturating_sub(sizes[1]);
        changes.push(change);
    }

    /// Adds the merging of rules that differ only in their condition on one variable.
    fn merges(&self, name: &str, loose: bool, changes: &mut Vec<Change>) {
        let Some(variable) = variable(self.model, name) else {
            return;
        };
        let all: BTreeSet<usize> = (0..variable.terms.len()).collect();
        // Grouped by their conditions on the other variables.
        let mut groups: BTreeMap<String, Vec<Member<'_>>> = BTreeMap::new();
        for (place, standing, parts) in &self.rules {
            let Some(parts) = parts else { continue };
            let at = parts.iter().position(|part| part.variable == name);
            let own = at.and_then(|at| parts.get(at));
            let Some(terms) = own.map_or(Some(all.clone()), |part| part.terms.clone()) else {
                continue;
            };
            let others = parts.iter().filter(|part| part.variable != name);
            let others: Vec<Part> = others.cloned().collect();
            let mut key = format!("{} {}", standing.rule.block, text(&others));
            if !loose {
                key += &consequents(standing);
            }
            groups.entry(key).or_default().push(Member {
                place: *place,
                standing,
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
    members.sort_by_key(|member| member.place);
    let Some(first) = members.first() else {
        return;
    };
    let standing: Vec<&Standing> = members.iter().map(|member| member.standing).collect();
    let mut consequents: Vec<&Vec<Consequent>> = Vec::new();
    for standing in &standing {
        let own = &standing.rule.rule.consequents;
        if !consequents.contains(&own) {
            consequents.push(own);
        }
    }
    let before: usize = standing.iter().map(|s| rule_size(&s.rule.rule)).sum();
    for way in one_of(variable, &terms) {
        let mut parts = first.others.clone();
        if let Some(condition) = way {
            let part = Part {
                variable: variable.name.clone(),
                condition,
                terms: Some(terms.clone()),
            };
            parts.insert(first.at, part);
        }
        let condition = condition(&parts, &variable.name);
        for consequents in &consequents {
            for weight in weights(&standing) {
                let merged = merged(&standing, condition.clone(), consequents, weight);
                changes.push(Change {
                    empty: members.iter().map(|member| member.place).collect(),
                    saved: before.saturating_sub(rule_size(&merged.rule.rule)),
                    fill: vec![(first.place, merged)],
                    has_fewer_inputs: false,
                });
            }
        }
    }
}

/// The candidate weights of a merged rule.
fn weights(standing: &[&Standing]) -> Vec<f64> {
    let weights = || standing.iter().map(|standing| standing.rule.rule.weight);
    let largest = weights().fold(0.0, f64::max);
    let sum: f64 = weights().sum();
    let mut found = vec![largest];
    let mean = sum / standing.len() as f64;
    found.extend(
        [mean, sum]
            .into_iter()
            .filter(|weight| *weight != largest && *weight <= 1.0),
    );
    found
}

/// Merges several rules into one. Their support is added; their notes are joined.
fn merged(
    standing: &[&Standing],
    condition: rule::Condition,
    consequents: &[Consequent],
    weight: f64,
) -> Standing {
    let mut of: Vec<usize> = standing
        .iter()
        .flat_map(|standing| standing.of.clone())
        .collect();
    of.sort_unstable();
    let rules = || standing.iter().map(|standing| &standing.rule);
    let one = match standing {
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
    Standing {
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

/// The text of parts, in an order that is independent of the author's.
fn text(parts: &[Part]) -> String {
    let mut texts: Vec<String> = parts
        .iter()
        .map(|part| part.condition.to_string())
        .collect();
    texts.sort_unstable();
    texts.join(" AND ")
}

fn consequents(standing: &Standing) -> String {
    let texts = standing
        .rule
        .rule
        .consequents
        .iter()
        .map(ToString::to_string);
    texts.collect::<Vec<String>>().join(" AND ")
}

/// The subsets of at least two of `count` ordered members.
fn subsets(count: usize) -> Vec<Vec<usize>> {
    if count <= MOST_FOR_ALL_SUBSETS {
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
