//! Folds for cross-validation, and intervals from resampled groups.

use std::collections::BTreeSet;

use fastrand::Rng;

use crate::Data;

/// A figure with a 95 % interval from resampled groups, or from resampled rows if there are no groups.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Interval {
    /// The figure for all rows.
    pub value: f64,
    /// The lower end: 2.5 % of the resampled figures are below.
    pub low: f64,
    /// The upper end: 2.5 % of the resampled figures are above.
    pub high: f64,
}

/// The number of resamples.
const RESAMPLES: usize = 400;

/// Rows divided into folds. All rows of a group are in the same fold.
pub(crate) struct Folds {
    /// The number of folds.
    pub(crate) count: usize,
    /// The groups, shuffled; without groups each row is a group.
    groups: Vec<usize>,
    /// The fold of each group.
    fold_of: Vec<usize>,
    random: Rng,
}

impl Folds {
    pub(crate) fn new(data: &Data, count: u32, seed: u64) -> Folds {
        let groups: BTreeSet<usize> = (0..data.len()).map(|row| group(data, row)).collect();
        let mut groups: Vec<usize> = groups.into_iter().collect();
        let mut random = Rng::with_seed(seed);
        random.shuffle(&mut groups);
        let count = (count.max(2) as usize).min(groups.len());
        let mut fold_of = vec![0; groups.iter().max().map_or(0, |last| last + 1)];
        for (i, group) in groups.iter().enumerate() {
            fold_of[*group] = i % count;
        }
        Folds {
            count,
            groups,
            fold_of,
            random,
        }
    }

    /// The fold of a row.
    pub(crate) fn of(&self, data: &Data, row: usize) -> usize {
        self.fold_of[group(data, row)]
    }

    /// The rows of all other folds, and the rows of this fold.
    pub(crate) fn split(&self, data: &Data, fold: usize) -> [Data; 2] {
        let is_left_out = |row: usize| self.of(data, row) == fold;
        [
            data.filtered(|row| !is_left_out(row)),
            data.filtered(is_left_out),
        ]
    }

    /// Returns the figures for all rows, each with its interval. `figures` computes them from the truths and the
    /// weights of rows.
    pub(crate) fn intervals<const N: usize>(
        mut self,
        data: &Data,
        figures: impl Fn(&Data) -> [f64; N],
    ) -> [Interval; N] {
        let mut resampled = [const { Vec::new() }; N];
        for _ in 0..RESAMPLES {
            let mut counts = vec![0.0; self.fold_of.len()];
            for _ in 0..self.groups.len() {
                counts[self.groups[self.random.usize(..self.groups.len())]] += 1.0;
            }
            let weights = (0..data.len()).map(|row| data.weight(row) * counts[group(data, row)]);
            let sample = Data {
                weights: weights.collect(),
                truths: data.truths.clone(),
                ..Data::default()
            };
            for (all, figure) in resampled.iter_mut().zip(figures(&sample)) {
                if figure.is_finite() {
                    all.push(figure);
                }
            }
        }
        let mut values = figures(data).into_iter();
        resampled.map(|all| interval(values.next().unwrap_or(f64::NAN), all))
    }
}

fn group(data: &Data, row: usize) -> usize {
    match data.groups.get(row) {
        Some(group) => *group as usize,
        None => row,
    }
}

fn interval(value: f64, mut resampled: Vec<f64>) -> Interval {
    resampled.sort_by(f64::total_cmp);
    let at = |share: f64| {
        let last = resampled.len().saturating_sub(1) as f64;
        resampled
            .get((share * last).round() as usize)
            .copied()
            .unwrap_or(f64::NAN)
    };
    Interval {
        value,
        low: at(0.025),
        high: at(0.975),
    }
}
