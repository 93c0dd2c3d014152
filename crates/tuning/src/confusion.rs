//! The confusion matrix of predictions for classes.

use crate::Data;

/// The number of rows for each class and predicted class. The predicted class is the one nearest to the prediction.
#[derive(Debug, Clone, PartialEq)]
pub struct Confusion {
    /// The classes, ascending: the values of the output that occur in the rows.
    pub classes: Vec<f64>,
    /// For each class, the number of its rows for each predicted class.
    pub rows: Vec<Vec<usize>>,
}

impl Confusion {
    /// The share of rows whose class was predicted.
    #[must_use]
    pub fn accuracy(&self) -> f64 {
        let rows: usize = self.rows.iter().flatten().sum();
        let right: usize = self.rows.iter().enumerate().map(|(i, row)| row[i]).sum();
        right as f64 / rows as f64
    }
}

/// The maximum number of classes; an output with more values counts as a quantity.
const MAX_CLASSES: usize = 10;
/// The minimum mean number of rows per class; with fewer, the output counts as a quantity.
const MIN_ROWS: usize = 5;

/// Returns the confusion matrix if the truths are classes: 2 to 10 whole numbers with at least 5
/// rows each on average. Rows without a prediction are left out.
pub(crate) fn confusion(predictions: &[f64], data: &Data) -> Option<Confusion> {
    let mut classes: Vec<f64> = Vec::new();
    for &truth in &data.truths {
        if let Err(place) = classes.binary_search_by(|class| class.total_cmp(&truth)) {
            if classes.len() == MAX_CLASSES || truth.fract() != 0.0 {
                return None;
            }
            classes.insert(place, truth);
        }
    }
    if classes.len() < 2 || data.len() < MIN_ROWS * classes.len() {
        return None;
    }
    let nearest = |value: f64| {
        let distances = classes.iter().map(|class| (class - value).abs());
        let nearest = distances.enumerate().min_by(|a, b| a.1.total_cmp(&b.1));
        nearest.map_or(0, |(class, _)| class)
    };
    let mut rows = vec![vec![0; classes.len()]; classes.len()];
    for (prediction, truth) in predictions.iter().zip(&data.truths) {
        if prediction.is_finite() {
            rows[nearest(*truth)][nearest(*prediction)] += 1;
        }
    }
    Some(Confusion { classes, rows })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn data(truths: &[f64]) -> Data {
        Data {
            truths: truths.to_vec(),
            ..Data::default()
        }
    }

    #[test]
    fn rows_are_counted_by_class_and_nearest_prediction() {
        let data = data(&[0.0, 0.0, 0.0, 0.0, 0.0, 3.0, 3.0, 3.0, 3.0, 3.0]);
        let predictions = [0.1, -2.0, 1.4, 1.6, 9.0, 3.0, 3.0, 0.0, f64::NAN, 2.0];
        let found = confusion(&predictions, &data).unwrap();
        assert_eq!(found.classes, [0.0, 3.0]);
        assert_eq!(found.rows, [[3, 2], [1, 3]]);
        assert!((found.accuracy() - 6.0 / 9.0).abs() < 1e-12);
    }

    #[test]
    fn continuous_targets_have_no_confusion_matrix() {
        let tenths: Vec<f64> = (0..30).map(|i| f64::from(i % 3) / 10.0).collect();
        let many: Vec<f64> = (0..100).map(|i| f64::from(i % 11)).collect();
        for truths in [tenths, many, vec![0.0, 1.0, 2.0], vec![1.0; 30]] {
            assert_eq!(confusion(&vec![0.0; truths.len()], &data(&truths)), None);
        }
    }
}
