//! Deriving a rule from the votes for each antecedent.

use alloc::{boxed::Box, collections::BTreeMap, format, string::String, vec, vec::Vec};

use super::{Cell, LearnResult, Learner, Resolution, Votes, antecedent, monotone};
use crate::{
    model::{Model, RejectedConsequent, Rule, Variable},
    rule::Consequent,
};

/// The maximum number of antecedents that are completed, made monotone, or searched for missing rules.
pub(super) const MAX_ANTECEDENTS: u64 = 1_000_000;

/// The consequent of an antecedent.
pub(super) struct Decision {
    /// The value of the output.
    pub(super) value: f64,
    /// The index of the output's term; `None` if it follows from the value.
    pub(super) term: Option<u16>,
    pub(super) confidence: Option<f64>,
    pub(super) note: Option<String>,
}

/// The number of terms of each input.
fn shape(model: &Model) -> impl Iterator<Item = u16> {
    let inputs = model.inputs.iter();
    inputs.map(|input| u16::try_from(input.terms.len()).unwrap_or(u16::MAX))
}

/// The number of antecedents, which are combinations of a term of each input; at most `u64::MAX`.
pub(super) fn antecedents(model: &Model) -> u64 {
    shape(model).fold(1, |count, terms| count.saturating_mul(u64::from(terms)))
}

pub(super) fn resolve(learner: &Learner) -> LearnResult {
    let model = &learner.model;
    let mut learned = LearnResult {
        model: model.clone(),
        samples: learner.samples,
        conflicts: 0,
        missing: 0,
        missing_antecedents: Vec::new(),
        left_out: 0,
        completed: 0,
        moved: 0,
    };
    let Some(output) = model.outputs.first().map(|o| &o.variable) else {
        return learned;
    };
    let shape: Vec<u16> = shape(model).collect();
    let antecedents = antecedents(model);
    let mut decisions: BTreeMap<Box<[u16]>, Decision> = BTreeMap::new();
    for (terms, cell) in &learner.cells {
        learned.conflicts += u64::from(cell.votes.len() > 1);
        let decision = decide(learner, output, cell);
        let sure = decision.confidence.unwrap_or(0.0) >= learner.settings.min_degree;
        if cell.samples >= learner.settings.min_support && sure {
            decisions.insert(terms.clone(), decision);
        } else {
            learned.left_out += 1;
        }
    }
    if learner.settings.complete {
        learned.completed = complete(&shape, &mut decisions);
    }
    if !learner.settings.monotone.is_empty() {
        learned.moved = monotone::enforce(learner, output, &mut decisions);
    }
    learned.missing = antecedents - decisions.len() as u64;
    if learned.missing > 0 && antecedents <= MAX_ANTECEDENTS {
        learned.missing_antecedents = every_antecedent(&shape)
            .filter(|terms| !decisions.contains_key(terms.as_slice()))
            .filter_map(|terms| antecedent(learner, &terms))
            .take(LearnResult::SHOWN)
            .collect();
    }
    for (terms, decision) in decisions {
        let cell = learner.cells.get(&terms);
        learned
            .model
            .rules
            .extend(rule(learner, output, &terms, decision, cell));
    }
    learned
}

fn decide(learner: &Learner, output: &Variable, cell: &Cell) -> Decision {
    let consequents = &learner.consequents;
    // Among consequents with equal weights, the one with the most samples is selected; among those, the first one.
    let winner = |weigh: fn(&Votes) -> f64| {
        let mut votes = cell.votes.iter();
        let first = votes.next();
        votes.fold(first, |best, next| {
            let better = best.is_none_or(|best| {
                (weigh(next.1), next.1.samples) > (weigh(best.1), best.1.samples)
            });
            if better { Some(next) } else { best }
        })
    };
    let best = match learner.settings.resolution {
        Resolution::Strongest => winner(|votes| votes.strongest),
        Resolution::Heaviest => winner(|votes| votes.degrees.value()),
        Resolution::Mean => {
            let share = cell.values.value() / cell.degrees.value();
            let value = output.low + share * (output.high - output.low);
            let term = consequents.nearest(output, value);
            return Decision {
                value,
                term: None,
                confidence: Some(degree(learner, cell, cell.votes.get(&term))),
                note: None,
            };
        }
    };
    let term = best.map_or(0, |(term, _)| *term);
    Decision {
        value: consequents
            .peaks
            .get(usize::from(term))
            .copied()
            .unwrap_or(output.low),
        term: Some(term),
        confidence: best.map(|(_, votes)| degree(learner, cell, Some(votes))),
        note: None,
    }
}

/// Returns the confidence of a consequent, in [0, 1].
pub(super) fn degree(learner: &Learner, cell: &Cell, votes: Option<&Votes>) -> f64 {
    let Some(votes) = votes else {
        return 0.0;
    };
    match learner.settings.resolution {
        Resolution::Strongest => votes.strongest.min(1.0),
        Resolution::Heaviest | Resolution::Mean => {
            let all = cell
                .votes
                .values()
                .fold(0.0, |sum, v| sum + v.degrees.value());
            if all > 0.0 {
                votes.degrees.value() / all
            } else {
                0.0
            }
        }
    }
}

fn rule(
    learner: &Learner,
    output: &Variable,
    terms: &[u16],
    decision: Decision,
    cell: Option<&Cell>,
) -> Option<Rule> {
    let term = decision
        .term
        .unwrap_or_else(|| learner.consequents.nearest(output, decision.value));
    let word = &output.terms.get(usize::from(term))?.name;
    let against = cell.into_iter().flat_map(|cell| &cell.votes);
    Some(Rule {
        rule: crate::rule::Rule {
            condition: antecedent(learner, terms)?,
            consequents: vec![Consequent::is_hedged(&output.name, &[], word)],
            weight: 1.0,
        },
        block: 0,
        confidence: decision.confidence,
        support: Some(cell.map_or(0, |cell| cell.samples)),
        against: against
            .filter(|(other, _)| **other != term)
            .filter_map(|(other, votes)| {
                Some(RejectedConsequent {
                    term: output.terms.get(usize::from(*other))?.name.clone(),
                    degree: cell.map_or(0.0, |cell| degree(learner, cell, Some(votes))),
                    support: votes.samples,
                })
            })
            .collect(),
        note: decision.note,
    })
}

/// Iterates over all antecedents; the term of the last input changes fastest.
fn every_antecedent(shape: &[u16]) -> impl Iterator<Item = Vec<u16>> + '_ {
    let count = shape.iter().map(|n| u64::from(*n)).product();
    (0..count).map(move |i| {
        let mut rest = i;
        let mut terms = vec![0; shape.len()];
        for (term, n) in terms.iter_mut().zip(shape).rev() {
            *term = (rest % u64::from(*n)) as u16;
            rest /= u64::from(*n);
        }
        terms
    })
}

/// Gives each antecedent without a decision the decision of the nearest antecedent, and returns the number of completed
/// antecedents.
///
/// The search goes outwards from the known decisions, a step at a time. The nearest decisions of an antecedent are those of its
/// neighbours that are a step nearer to a decision. Of these, the one with the highest value is used, then the first one.
fn complete(shape: &[u16], decisions: &mut BTreeMap<Box<[u16]>, Decision>) -> u64 {
    // For each input, the number of its terms and the distance between the indices of antecedents with neighbouring terms.
    let mut axes: Vec<(usize, usize)> = shape.iter().map(|n| (usize::from(*n), 1)).collect();
    let mut cells = 1;
    for (terms, stride) in axes.iter_mut().rev() {
        *stride = cells;
        cells *= *terms;
    }
    let known: Vec<(f64, Option<u16>)> = (decisions.values().map(|d| (d.value, d.term))).collect();
    let value_of = |from: usize| known.get(from).map_or(f64::NEG_INFINITY, |one| one.0);
    let is_better = |from: usize, than: usize| {
        let by_value = value_of(from).total_cmp(&value_of(than));
        by_value.then(than.cmp(&from)).is_gt()
    };
    // For each antecedent, the steps to the nearest decision and its index in `known`.
    let mut nearest: Vec<Option<(u32, usize)>> = vec![None; cells];
    let mut layer = Vec::new();
    for (from, terms) in decisions.keys().enumerate() {
        let terms = terms.iter().zip(&axes);
        let cell: usize = terms.map(|(term, axis)| usize::from(*term) * axis.1).sum();
        if let Some(nearest) = nearest.get_mut(cell) {
            *nearest = Some((0, from));
            layer.push(cell);
        }
    }
    for steps in 1.. {
        let mut next = Vec::new();
        for cell in layer {
            let Some(&Some((_, from))) = nearest.get(cell) else {
                continue;
            };
            let neighbours = axes.iter().flat_map(|(terms, stride)| {
                let term = cell / stride % terms;
                let below = (term > 0).then(|| cell - stride);
                let above = (term + 1 < *terms).then(|| cell + stride);
                below.into_iter().chain(above)
            });
            for neighbour in neighbours {
                match nearest.get_mut(neighbour) {
                    Some(unset @ None) => {
                        *unset = Some((steps, from));
                        next.push(neighbour);
                    }
                    Some(Some((at, other))) if *at == steps && is_better(from, *other) => {
                        *other = from;
                    }
                    _ => {}
                }
            }
        }
        if next.is_empty() {
            break;
        }
        layer = next;
    }
    let mut completed = 0;
    for (terms, nearest) in every_antecedent(shape).zip(nearest) {
        if let Some((steps @ 1.., from)) = nearest
            && let Some(&(value, term)) = known.get(from)
        {
            completed += 1;
            let steps = match steps {
                1 => "1 step".into(),
                steps => format!("{steps} steps"),
            };
            let note = format!("no samples; consequent of the nearest rule, {steps} away");
            let decision = Decision {
                value,
                term,
                confidence: None,
                note: Some(note),
            };
            decisions.insert(terms.into_boxed_slice(), decision);
        }
    }
    completed
}
