//! Losses of predictions, and their derivatives with respect to each prediction.
//!
//! Here, predictions and truths are positions in the range of the output, from 0 to 1.

use crate::{Loss, data::Data};

/// The loss of all rows, with the first derivative and a curvature for each row's prediction.
#[derive(Debug, Clone)]
pub(crate) struct Slopes {
    pub(crate) loss: f64,
    pub(crate) first: Vec<f64>,
    /// The expected second derivative, which is never below 0.
    pub(crate) second: Vec<f64>,
}

/// Sums the loss of predictions; NaN counts as the middle of the range.
pub(crate) fn slopes(loss: Loss, predictions: &[f64], truths: &[f64], data: &Data) -> Slopes {
    if loss == Loss::Ranking {
        return ranking(predictions, truths, data);
    }
    let total: f64 = (0..data.len()).map(|row| data.weight(row)).sum();
    let mut slopes = Slopes {
        loss: 0.0,
        first: Vec::with_capacity(predictions.len()),
        second: Vec::with_capacity(predictions.len()),
    };
    for (row, (prediction, truth)) in predictions.iter().zip(truths).enumerate() {
        let weight = data.weight(row) / total;
        let is_known = prediction.is_finite();
        let known = if is_known { *prediction } else { 0.5 };
        let (value, first, second) = match loss {
            Loss::Log => {
                let least = Loss::MIN_PROBABILITY;
                let p = known.clamp(least, 1.0 - least);
                let value = -(truth * p.ln() + (1.0 - truth) * (1.0 - p).ln());
                (value, (p - truth) / (p * (1.0 - p)), 1.0 / (p * (1.0 - p)))
            }
            _ => {
                let error = known - truth;
                (error * error, 2.0 * error, 2.0)
            }
        };
        slopes.loss += weight * value;
        // An unknown prediction counts as the middle of the range and does not respond to small changes, so its slope
        // is 0.
        slopes
            .first
            .push(if is_known { weight * first } else { 0.0 });
        slopes
            .second
            .push(if is_known { weight * second } else { 0.0 });
    }
    slopes
}

/// The distance `s` in [`Loss::Ranking`], as a share of the range.
const SCALE: f64 = 0.02;

/// The number of positions for which pairs are summed; the sums are interpolated linearly between them.
const PLACES: usize = 512;

/// The loss of [`Loss::Ranking`]: the mean of a smooth loss over all pairs of a row with truth 1 and a row with truth
/// 0.
fn ranking(predictions: &[f64], truths: &[f64], data: &Data) -> Slopes {
    let between = |prediction: f64| {
        let known = if prediction.is_finite() {
            prediction.clamp(0.0, 1.0)
        } else {
            0.5
        };
        let at = known * (PLACES - 1) as f64;
        let left = (at.floor() as usize).min(PLACES - 2);
        (left, at - left as f64)
    };
    // The total weight of the rows with each truth, at each position.
    let mut masses = [vec![0.0; PLACES], vec![0.0; PLACES]];
    for (row, (prediction, truth)) in predictions.iter().zip(truths).enumerate() {
        let (left, part) = between(*prediction);
        let mass = &mut masses[usize::from(*truth == 1.0)];
        mass[left] += (1.0 - part) * data.weight(row);
        mass[left + 1] += part * data.weight(row);
    }
    let pairs: f64 = masses.iter().map(|mass| mass.iter().sum::<f64>()).product();
    let pairs = pairs.max(f64::MIN_POSITIVE);
    // Loss, slope and curvature of a pair, for each distance between two positions.
    let by_distance: Vec<[f64; 3]> = (0..2 * PLACES - 1)
        .map(|i| {
            let distance = (i as f64 - (PLACES - 1) as f64) / (PLACES - 1) as f64 / SCALE;
            let wrong = 1.0 / (1.0 + distance.exp());
            let loss = (-distance).max(0.0) + (-distance.abs()).exp().ln_1p();
            [
                loss,
                -wrong / SCALE,
                wrong * (1.0 - wrong) / (SCALE * SCALE),
            ]
        })
        .collect();
    // For each position, the sums over the pairs of a row at this position with every row of the other truth: first for
    // a row with truth 0, then for one with truth 1.
    let sums = [true, false].map(|is_zero| {
        let partners = &masses[usize::from(is_zero)];
        let sum_at = |place: usize| {
            let mut sum = [0.0; 3];
            for (partner, mass) in partners.iter().enumerate().filter(|(_, mass)| **mass > 0.0) {
                let distance = match is_zero {
                    true => partner + PLACES - 1 - place,
                    false => place + PLACES - 1 - partner,
                };
                for (sum, term) in sum.iter_mut().zip(by_distance[distance]) {
                    *sum += mass * term;
                }
            }
            sum
        };
        (0..PLACES).map(sum_at).collect::<Vec<[f64; 3]>>()
    });
    let mut slopes = Slopes {
        loss: 0.0,
        first: Vec::with_capacity(predictions.len()),
        second: Vec::with_capacity(predictions.len()),
    };
    for (row, (prediction, truth)) in predictions.iter().zip(truths).enumerate() {
        let (left, part) = between(*prediction);
        let sums = &sums[usize::from(*truth == 1.0)];
        let at = |k: usize| (1.0 - part) * sums[left][k] + part * sums[left + 1][k];
        let weight = data.weight(row) / pairs;
        let sign = if *truth == 1.0 { 1.0 } else { -1.0 };
        let known = if prediction.is_finite() { weight } else { 0.0 };
        slopes.loss += weight * at(0) / 2.0;
        slopes.first.push(known * sign * at(1));
        slopes.second.push(known * at(2));
    }
    slopes
}

/// The loss that is reported: see [`Loss`]. For [`Loss::Ranking`] it is the exact share, not the smooth function that
/// is minimised.
pub(crate) fn measure(
    loss: Loss,
    predictions: &[f64],
    truths: &[f64],
    data: &Data,
    width: f64,
) -> f64 {
    match loss {
        Loss::Squared => slopes(loss, predictions, truths, data).loss.sqrt() * width,
        Loss::Log => slopes(loss, predictions, truths, data).loss,
        Loss::Ranking => 1.0 - area(predictions, truths, data),
    }
}

/// The area under the ROC curve: the share of pairs in the right order; equal predictions count half. NaN unless both
/// truths occur.
fn area(predictions: &[f64], truths: &[f64], data: &Data) -> f64 {
    let rows = predictions.iter().zip(truths).enumerate();
    let mut rows: Vec<(f64, bool, f64)> = rows
        .map(|(row, (prediction, truth))| {
            let known = if prediction.is_finite() {
                *prediction
            } else {
                0.5
            };
            (known, *truth == 1.0, data.weight(row))
        })
        .collect();
    rows.sort_by(|a, b| a.0.total_cmp(&b.0));
    let (mut right, mut below, mut ones) = (0.0, 0.0, 0.0);
    for equal in rows.chunk_by(|a, b| a.0 == b.0) {
        let sum = |of: bool| -> f64 {
            equal
                .iter()
                .filter(|(_, truth, _)| *truth == of)
                .map(|(.., weight)| weight)
                .sum()
        };
        right += sum(true) * (below + sum(false) / 2.0);
        below += sum(false);
        ones += sum(true);
    }
    right / (ones * below)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn data(truths: &[f64]) -> Data {
        Data {
            truths: truths.to_vec(),
            weights: (0..truths.len())
                .map(|row| 1.0 + row as f64 / 10.0)
                .collect(),
            ..Data::default()
        }
    }

    #[test]
    fn first_derivatives_are_those_of_the_loss() {
        let truths = [1.0, 0.0, 1.0, 0.0, 0.0];
        let predictions = [0.72, 0.6, 0.41, 0.4203, 0.1];
        let data = data(&truths);
        for loss in [Loss::Squared, Loss::Log, Loss::Ranking] {
            let at = slopes(loss, &predictions, &truths, &data);
            for row in 0..predictions.len() {
                let moved = |by: f64| {
                    let mut predictions = predictions;
                    predictions[row] += by;
                    slopes(loss, &predictions, &truths, &data).loss
                };
                let step = if loss == Loss::Ranking { 2e-3 } else { 1e-6 };
                let slope = (moved(step) - moved(-step)) / (2.0 * step);
                let error = (slope - at.first[row]).abs();
                assert!(
                    error < 0.02 * slope.abs().max(0.1),
                    "{loss:?} {row}: {slope} {}",
                    at.first[row]
                );
                assert!(at.second[row] >= 0.0);
            }
        }
    }

    #[test]
    fn the_measure_of_ranking_is_the_share_of_wrong_pairs() {
        let truths = [1.0, 0.0, 1.0, 0.0];
        let data = Data {
            truths: truths.to_vec(),
            ..Data::default()
        };
        let wrong = measure(Loss::Ranking, &[0.9, 0.2, 0.2, 0.3], &truths, &data, 1.0);
        // Of the four pairs, one is in the wrong order, and one has equal predictions, which counts half.
        assert_eq!(wrong, 1.5 / 4.0);
    }

    #[test]
    fn an_unknown_prediction_counts_as_the_middle_and_has_no_gradient() {
        let data = Data {
            truths: vec![1.0],
            ..Data::default()
        };
        let unknown = slopes(Loss::Squared, &[f64::NAN], &[1.0], &data);
        assert_eq!(
            (unknown.loss, unknown.first[0], unknown.second[0]),
            (0.25, 0.0, 0.0)
        );
    }
}
