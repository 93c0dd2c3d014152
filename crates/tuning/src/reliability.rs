//! Reliability of predictions as probabilities.

use crate::Data;

/// Rows with similar predictions.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Bin {
    /// The number of rows.
    pub rows: usize,
    /// The mean prediction of these rows, as a position in the range of the output from 0 to 1.
    pub predicted: f64,
    /// The share of these rows with truth 1.
    pub observed: f64,
}

/// The number of bins, which have equal width.
const BINS: usize = 10;

/// Groups the rows by their predictions, in tenths of the range, ascending. Empty tenths and rows without a prediction
/// are omitted. If predictions are calibrated, `predicted` and `observed` differ only by chance.
pub(crate) fn reliability(predictions: &[f64], data: &Data) -> Vec<Bin> {
    let mut sums = [(0_usize, 0.0, 0.0, 0.0); BINS];
    for (row, (prediction, truth)) in predictions.iter().zip(&data.truths).enumerate() {
        if !prediction.is_finite() {
            continue;
        }
        let weight = data.weight(row);
        let bin = ((prediction * BINS as f64) as usize).min(BINS - 1);
        let (rows, weights, predicted, observed) = &mut sums[bin];
        *rows += 1;
        *weights += weight;
        *predicted += weight * prediction;
        *observed += weight * truth;
    }
    let bins = sums.into_iter().filter(|(_, weights, ..)| *weights > 0.0);
    bins.map(|(rows, weights, predicted, observed)| Bin {
        rows,
        predicted: predicted / weights,
        observed: observed / weights,
    })
    .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rows_are_counted_by_tenths_and_by_weight() {
        let data = Data {
            truths: vec![0.0, 1.0, 1.0, 0.0, 1.0],
            weights: vec![1.0, 3.0, 1.0, 1.0, 0.0],
            ..Data::default()
        };
        let bins = reliability(&[0.05, 0.01, 1.0, f64::NAN, 0.5], &data);
        let near = |a: f64, b: f64| assert!((a - b).abs() < 1e-12, "{bins:?}");
        assert_eq!((bins.len(), bins[0].rows, bins[1].rows), (2, 2, 1));
        near(bins[0].predicted, 0.02);
        near(bins[0].observed, 0.75);
        near(bins[1].predicted, 1.0);
        near(bins[1].observed, 1.0);
    }
}
