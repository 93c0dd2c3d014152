//! Making consequents monotone in the terms of inputs.

use alloc::{boxed::Box, collections::BTreeMap, string::String, vec, vec::Vec};

use super::{
    Direction, Learner,
    resolve::{Decision, degree},
};
use crate::model::Variable;

/// The maximum number of passes over the inputs. The means converge long before.
const MAX_ROUNDS: usize = 1000;
/// The weight of a rule without samples, as a fraction of the largest weight of a sample. It is so small that the rule
/// adapts to its neighbours.
const NO_SAMPLES: f64 = 1e-6;

/// Changes consequents so that they satisfy the required directions, and returns the number of changed ones.
///
/// Along an input, neighbouring antecedents that violate the direction are pooled: each gets the mean value of all,
/// weighted by the degrees of their samples (the pool-adjacent-violators algorithm, applied to the inputs in turn until
/// nothing changes). The values are then rounded to terms. If the order is still violated, because of the rounding or
/// across antecedents without a rule, a term is replaced by the middle between two others: the highest term of the
/// antecedents that must not be above it, and the lowest term of those that must not be below it.
pub(super) fn enforce(
    learner: &Learner,
    output: &Variable,
    decisions: &mut BTreeMap<Box<[u16]>, Decision>,
) -> u64 {
    let axes = axes(learner);
    let cells = axes.iter().map(|axis| axis.ranks.len()).product();
    let place = |terms: &[u16]| -> usize {
        let pairs = axes.iter().zip(terms);
        let ranks = pairs.map(|(axis, term)| {
            axis.stride * axis.ranks.get(usize::from(*term)).copied().unwrap_or(0)
        });
        ranks.sum()
    };
    let mut values = vec![None; cells];
    for (terms, decision) in &*decisions {
        let degrees = learner
            .cells
            .get(terms)
            .map_or(0.0, |cell| cell.degrees.value());
        if let Some(value) = values.get_mut(place(terms)) {
            *value = Some(Value {
                value: decision.value,
                weight: degrees.max(NO_SAMPLES * learner.heaviest),
            });
        }
    }
    let before = values.clone();
    for _ in 0..MAX_ROUNDS {
        let mut changed = 0.0_f64;
        for axis in axes.iter().filter(|axis| axis.sign != 0.0) {
            for first in axis.starts(cells) {
                changed = changed.max(pool(axis, first, &mut values));
            }
        }
        if changed <= 1e-9 * (output.high - output.low) {
            break;
        }
    }

    let term_of_rank = ascending(&learner.consequents.peaks);
    let rank_of_term = inverse(&term_of_rank);
    let mut ranks: Vec<Option<usize>> = vec![None; cells];
    for (terms, decision) in &*decisions {
        let place = place(terms);
        let moved = values.get(place) != before.get(place);
        let value = values
            .get(place)
            .copied()
            .flatten()
            .map_or(decision.value, |v| v.value);
        let term = decision.term.filter(|_| !moved);
        let term = term.unwrap_or_else(|| learner.consequents.nearest(output, value));
        if let Some(rank) = ranks.get_mut(place) {
            *rank = rank_of_term.get(usize::from(term)).copied();
        }
    }
    let least = envelope(&axes, &ranks, false);
    let most = envelope(&axes, &ranks, true);

    let mut moved = 0;
    for (terms, decision) in decisions {
        let place = place(terms);
        let (Some(Some(least)), Some(Some(most))) = (least.get(place), most.get(place)) else {
            continue;
        };
        let Some(&term) = term_of_rank.get((least + most).div_ceil(2)) else {
            continue;
        };
        let term = u16::try_from(term).unwrap_or(u16::MAX);
        let old = decision
            .term
            .unwrap_or_else(|| learner.consequents.nearest(output, decision.value));
        if term == old {
            continue;
        }
        moved += 1;
        decision.term = Some(term);
        let cell = learner.cells.get(terms);
        decision.confidence = cell.map(|cell| degree(learner, cell, cell.votes.get(&term)));
        let old = output
            .terms
            .get(usize::from(old))
            .map_or(String::new(), |term| term.name.clone());
        let note = alloc::format!("moved from {old}, so that the output is monotone");
        decision.note = Some(match decision.note.take() {
            Some(other) => alloc::format!("{other}; {note}"),
            None => note,
        });
    }
    moved
}

#[derive(Debug, Clone, Copy, PartialEq)]
struct Value {
    value: f64,
    weight: f64,
}

/// An input, whose terms are ordered by their peaks.
struct Axis {
    /// The rank of each term.
    ranks: Vec<usize>,
    /// The distance in the table from one rank to the next.
    stride: usize,
    /// 1 if the output must not fall as the input increases, -1 if it must not rise, 0 if it is unconstrained.
    sign: f64,
}

impl Axis {
    /// Iterates over the first cell of each line along the axis.
    fn starts(&self, cells: usize) -> impl Iterator<Item = usize> {
        let (stride, count) = (self.stride, self.ranks.len());
        (0..cells).filter(move |cell| cell / stride % count == 0)
    }

    /// Iterates over the cells of a line in the order in which the output must not fall.
    fn line(&self, first: usize) -> impl DoubleEndedIterator<Item = usize> {
        let (stride, count, is_falling) = (self.stride, self.ranks.len(), self.sign < 0.0);
        (0..count).map(move |i| first + stride * if is_falling { count - 1 - i } else { i })
    }
}

fn axes(learner: &Learner) -> Vec<Axis> {
    let mut stride = 1;
    let axes = learner.model.inputs.iter().rev().map(|input| {
        let peaks: Vec<f64> = input
            .terms
            .iter()
            .map(|term| input.peak(&term.membership_function))
            .collect();
        let mut directions = learner.settings.monotone.iter();
        let found = directions.find(|(name, _)| *name == input.name);
        let axis = Axis {
            ranks: inverse(&ascending(&peaks)),
            stride,
            sign: match found.map(|(_, direction)| direction) {
                Some(Direction::Rising) => 1.0,
                Some(Direction::Falling) => -1.0,
                None => 0.0,
            },
        };
        stride *= input.terms.len();
        axis
    });
    let mut axes: Vec<Axis> = axes.collect();
    axes.reverse();
    axes
}

/// Returns the indices of the terms ordered by their peaks; among equal peaks the first term comes first.
fn ascending(peaks: &[f64]) -> Vec<usize> {
    let mut order: Vec<usize> = (0..peaks.len()).collect();
    order.sort_by(|a, b| peaks[*a].total_cmp(&peaks[*b]));
    order
}

fn inverse(order: &[usize]) -> Vec<usize> {
    let mut ranks = vec![0; order.len()];
    for (rank, term) in order.iter().enumerate() {
        ranks[*term] = rank;
    }
    ranks
}

/// Pools adjacent violators on a line, and returns the largest change.
fn pool(axis: &Axis, first: usize, values: &mut [Option<Value>]) -> f64 {
    /// Neighbours that share one value.
    struct Pool {
        mean: f64,
        weight: f64,
        cells: usize,
    }
    let mut pools: Vec<Pool> = Vec::new();
    for value in axis
        .line(first)
        .filter_map(|cell| values.get(cell).copied().flatten())
    {
        let mut last = Pool {
            mean: value.value,
            weight: value.weight,
            cells: 1,
        };
        while let Some(before) = pools.pop_if(|before| before.mean > last.mean) {
            let weight = before.weight + last.weight;
            last = Pool {
                mean: (before.weight * before.mean + last.weight * last.mean) / weight,
                weight,
                cells: before.cells + last.cells,
            };
        }
        pools.push(last);
    }
    let means = pools
        .iter()
        .flat_map(|pool| core::iter::repeat_n(pool.mean, pool.cells));
    let cells: Vec<usize> = axis
        .line(first)
        .filter(|cell| values.get(*cell).is_some_and(Option::is_some))
        .collect();
    let mut changed = 0.0_f64;
    for (cell, mean) in cells.into_iter().zip(means) {
        if let Some(Some(value)) = values.get_mut(cell) {
            changed = changed.max((value.value - mean).abs());
            value.value = mean;
        }
    }
    changed
}

/// Returns, for each cell, the highest rank of the cells that must not be above it, or the lowest rank of those that
/// must not be below it.
fn envelope(axes: &[Axis], ranks: &[Option<usize>], highest: bool) -> Vec<Option<usize>> {
    let mut reached = ranks.to_vec();
    for axis in axes.iter().filter(|axis| axis.sign != 0.0) {
        for first in axis.starts(ranks.len()) {
            let mut extreme: Option<usize> = None;
            let mut step = |cell: usize| {
                let Some(rank) = reached.get_mut(cell) else {
                    return;
                };
                extreme = match (extreme, *rank) {
                    (Some(a), Some(b)) if highest => Some(a.max(b)),
                    (Some(a), Some(b)) => Some(a.min(b)),
                    (a, b) => a.or(b),
                };
                *rank = extreme;
            };
            if highest {
                axis.line(first).for_each(&mut step);
            } else {
                axis.line(first).rev().for_each(&mut step);
            }
        }
    }
    reached
}
