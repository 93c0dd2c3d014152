//! Deriving a rule from the votes for each antecedent.

use alloc::{boxed::Box, collections::BTreeMap, format, string::String, vec, vec::Vec};

use super::{Cell, LearnResult, Learner, Resolution, Votes, antecedent, monotone};
use crate::{
    model::{RejectedConsequent, Rule, Variable},
    rule::Consequent,
};

/// The maximum number of antecedents that are completed or made monotone.
const MAX_COMPLETED: u64 = 1_000_000;

/// The consequent of an antecedent.
pub(super) struct Decision {
    /// The value of the output.
    pub(super) value: f64,
    /// The index of the output's term; `None` if it follows from the value.
    pub(super) term: Option<u16>,
    pub(super) confidence: Option<f64>,
    pub(super) note: Option<String>,
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
    let shape: Vec<u16> = learner
        .model
        .inputs
        .iter()
        .map(|input| u16::try_from(input.terms.len()).unwrap_or(u16::MAX))
        .collect();
    let antecedents = shape
        .iter()
        .fold(1u64, |n, terms| n.saturating_mul(u64::from(*terms)));
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
    if antecedents <= MAX_COMPLETED {
        if learner.settings.complete && !decisions.is_empty() {
            learned.completed = complete(&shape, &mut decisions);
        }
        if !learner.settings.monotone.is_empty() {
            learned.moved = monotone::enforce(learner, output, &mut decisions);
        }
    }
    learned.missing = antecedents - decisions.len() as u64;
    if learned.missing > 0 && antecedents <= MAX_COMPLETED {
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
fn complete(shape: &[u16], decisions: &mut BTreeMap<Box<[u16]>, Decision>) -> u64 {
    let known: Vec<(Box<[u16]>, f64, Option<u16>)> = decisions
        .iter()
        .map(|(terms, decision)| (terms.clone(), decision.value, decision.term))
        .collect();
    let mut completed = 0;
    for terms in every_antecedent(shape) {
        if decisions.contains_key(terms.as_slice()) {
            continue;
        }
        let steps = |other: &[u16]| -> u32 {
            let pairs = other.iter().zip(&terms);
            pairs.map(|(a, b)| u32::from(a.abs_diff(*b))).sum()
        };
        let nearest = known.iter().min_by(|a, b| {
            let near = steps(&a.0).cmp(&steps(&b.0));
            near.then(b.1.total_cmp(&a.1))
        });
        if let Some((from, value, term)) = nearest {
            completed += 1;
            decisions.insert(
                terms.clone().into_boxed_slice(),
                Decision {
                    value: *value,
                    term: *term,
                    confidence: None,
                    note: Some(format!(
                        "no samples; consequent of the nearest rule, {} away",
                        match steps(from) {
                            1 => "1 step".into(),
                            steps => format!("{steps} steps"),
                        }
                    )),
                },
            );
        }
    }
    completed
}
