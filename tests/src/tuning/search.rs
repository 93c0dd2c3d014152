//! Coordinate descent over round peaks, consequents and weights.

use rayon::prelude::*;

use super::{
    objective::Problem,
    rows::Row,
    votes::{Input, Vote, Votes, WeightedSum},
};

/// The possible weights of a rule; a rule with weight 0 is dropped.
const WEIGHTS: [f64; 8] = [0.0, 0.05, 0.1, 0.2, 0.35, 0.5, 0.7, 1.0];

/// The first digits of round numbers.
const DIGITS: [&str; 12] = [
    "1", "1.2", "1.6", "2", "2.5", "3", "4", "5", "6", "7", "8", "9",
];

/// The number of round numbers to try on either side of a peak.
const REACH: usize = 2;

/// The minimum gain of a change.
const MIN_GAIN: f64 = 1e-5;

const ROUNDS: usize = 6;

/// The random seeds of the orders in which changes are tried; the best result is kept.
const SEEDS: [u64; 4] = [0, 1, 2, 3];

/// Tunes the votes on rows.
pub fn tune(template: &Votes, rows: &[&Row]) -> Votes {
    let problem = Problem::new(rows, template);
    let tried: Vec<(Votes, f64)> = SEEDS
        .par_iter()
        .map(|seed| descend(template.clone(), &problem, *seed))
        .collect();
    let best = tried
        .into_iter()
        .reduce(|best, next| if next.1 > best.1 { next } else { best });
    best.map_or_else(|| template.clone(), |(votes, _)| votes)
}

/// A part of the votes of an input that the search changes in one step.
#[derive(Clone, Copy)]
enum VotePart {
    Peak,
    Consequent,
    Weight,
    /// The weights of all terms of the input.
    Weights,
}

fn descend(mut votes: Votes, problem: &Problem, seed: u64) -> (Votes, f64) {
    let mut random = fastrand::Rng::with_seed(seed);
    let consequents = votes.consequents.clone();
    let of_input = |input: &Input, column: &[f64]| -> Vec<WeightedSum> {
        column.iter().map(|x| input.sum(*x, &consequents)).collect()
    };
    let mut sums: Vec<Vec<WeightedSum>> = votes
        .inputs
        .iter()
        .zip(&problem.columns)
        .map(|(input, column)| of_input(input, column))
        .collect();
    let mut best = problem.score(total(&sums, usize::MAX).into_iter());
    let mut coordinates: Vec<(usize, VotePart, usize)> = Vec::new();
    for (i, input) in votes.inputs.iter().enumerate() {
        if !input.is_tuned() {
            continue;
        }
        coordinates.push((i, VotePart::Weights, 0));
        for term in 0..input.peaks.len() {
            coordinates.push((i, VotePart::Peak, term));
            if input.votes[term].is_some() {
                coordinates.push((i, VotePart::Consequent, term));
                coordinates.push((i, VotePart::Weight, term));
            }
        }
    }
    for _ in 0..ROUNDS {
        let before = best;
        random.shuffle(&mut coordinates);
        for &(i, part, term) in &coordinates {
            let others = total(&sums, i);
            let range = votes.range(&votes.inputs[i]);
            for changed in changes(&votes.inputs[i], part, term, range, &consequents) {
                let own = of_input(&changed, &problem.columns[i]);
                let all = others.iter().zip(&own).map(|(a, b)| WeightedSum {
                    values: a.values + b.values,
                    weights: a.weights + b.weights,
                });
                let score = problem.score(all);
                if score > best + MIN_GAIN {
                    best = score;
                    votes.inputs[i] = changed;
                    sums[i] = own;
                }
            }
        }
        if best == before {
            break;
        }
    }
    (votes, best)
}

/// The sums over all inputs but one, at each row.
fn total(sums: &[Vec<WeightedSum>], without: usize) -> Vec<WeightedSum> {
    let mut total = vec![WeightedSum::default(); sums.first().map_or(0, Vec::len)];
    for (_, sums) in sums.iter().enumerate().filter(|(i, _)| *i != without) {
        for (total, sum) in total.iter_mut().zip(sums) {
            total.values += sum.values;
            total.weights += sum.weights;
        }
    }
    total
}

/// The variants of an input with one changed part.
fn changes(
    input: &Input,
    part: VotePart,
    term: usize,
    range: (f64, f64),
    consequents: &[f64],
) -> Vec<Input> {
    let with = |change: &dyn Fn(&mut Input)| {
        let mut changed = input.clone();
        change(&mut changed);
        changed
    };
    let all: Vec<Input> = match (part, input.votes[term]) {
        (VotePart::Peak, _) => {
            let peaks = near(input.peaks[term], range).into_iter();
            peaks
                .map(|peak| with(&|changed| changed.peaks[term] = peak))
                .collect()
        }
        (VotePart::Consequent, Some(vote)) => {
            let others = (0..consequents.len()).filter(|consequent| *consequent != vote.consequent);
            let others = others.map(|consequent| Vote { consequent, ..vote });
            others
                .map(|vote| with(&|changed| changed.votes[term] = Some(vote)))
                .collect()
        }
        (VotePart::Weight, Some(vote)) => {
            let others = WEIGHTS.into_iter().filter(|weight| *weight != vote.weight);
            let others = others.map(|weight| Vote { weight, ..vote });
            others
                .map(|vote| with(&|changed| changed.votes[term] = Some(vote)))
                .collect()
        }
        (VotePart::Weights, _) => [-1, 1]
            .into_iter()
            .map(|step| {
                with(&|changed| {
                    for vote in changed.votes.iter_mut().flatten() {
                        vote.weight = next(vote.weight, step);
                    }
                })
            })
            .collect(),
        (_, None) => Vec::new(),
    };
    let is_sound = |input: &Input| input.is_sound(consequents);
    all.into_iter().filter(is_sound).collect()
}

/// The next larger or smaller weight; 0 stays 0.
fn next(weight: f64, step: isize) -> f64 {
    let place = WEIGHTS.iter().position(|known| *known == weight);
    let next = place
        .filter(|place| *place > 0)
        .and_then(|place| WEIGHTS.get(place.saturating_add_signed(step)));
    next.copied().unwrap_or(weight)
}

/// The round numbers around a peak within the range.
fn near(peak: f64, (low, high): (f64, f64)) -> Vec<f64> {
    let round = (-3..3).flat_map(|power| DIGITS.map(|digits| format!("{digits}e{power}")));
    let round = round.filter_map(|text| text.parse::<f64>().ok());
    let round: Vec<f64> = round.filter(|x| (low..high).contains(x)).collect();
    let left = round.partition_point(|x| *x < peak);
    let right = round.partition_point(|x| *x <= peak);
    let below = round[left.saturating_sub(REACH)..left].iter();
    let above = round[right..].iter().take(REACH);
    below.chain(above).copied().collect()
}
