//! The rows that a model is tuned on.

use fuzzy::Model;

use crate::{Loss, TuneError};

/// Rows as columns.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Data {
    /// A column for each input of the model, in its order.
    pub inputs: Vec<Vec<f64>>,
    /// The truth of each row: a value of the output; for [`Loss::Log`] and [`Loss::Ranking`] 0 or 1.
    pub truths: Vec<f64>,
    /// How much each row counts; empty: all the same.
    pub weights: Vec<f64>,
    /// The group of each row, such as its vehicle; empty: none.
    pub groups: Vec<u32>,
}

impl Data {
    /// The number of rows.
    pub fn len(&self) -> usize {
        self.truths.len()
    }

    /// Whether there are no rows.
    pub fn is_empty(&self) -> bool {
        self.truths.is_empty()
    }

    /// The weight of a row.
    pub(crate) fn weight(&self, row: usize) -> f64 {
        self.weights.get(row).copied().unwrap_or(1.0)
    }

    /// The inputs of all rows, as the engine takes them.
    pub(crate) fn columns(&self) -> Vec<&[f64]> {
        self.inputs.iter().map(Vec::as_slice).collect()
    }

    /// The rows for which `keep` holds.
    pub(crate) fn filtered(&self, keep: impl Fn(usize) -> bool) -> Data {
        let rows: Vec<usize> = (0..self.len()).filter(|row| keep(*row)).collect();
        let of = |column: &Vec<f64>| {
            rows.iter()
                .filter_map(|row| column.get(*row).copied())
                .collect::<Vec<f64>>()
        };
        Data {
            inputs: self.inputs.iter().map(of).collect(),
            truths: of(&self.truths),
            weights: of(&self.weights),
            groups: rows
                .iter()
                .filter_map(|row| self.groups.get(*row).copied())
                .collect(),
        }
    }

    /// Whether a model can be tuned on the rows.
    pub(crate) fn check(&self, model: &Model, loss: Loss) -> Result<(), TuneError> {
        let outputs = model.outputs.len();
        if outputs != 1 {
            return Err(TuneError::Outputs { outputs });
        }
        self.check_columns(model.inputs.len(), loss)
    }

    /// Whether the rows have so many inputs, and numbers that can be used.
    pub(crate) fn check_columns(&self, inputs: usize, loss: Loss) -> Result<(), TuneError> {
        if self.is_empty() {
            return Err(TuneError::NoRows);
        }
        let wrong = |what| Err(TuneError::Columns { what });
        if self.inputs.len() != inputs {
            return wrong("there must be a column for each input of the model");
        }
        let rows = self.len();
        let is_whole = |len: usize| len == 0 || len == rows;
        if self.inputs.iter().any(|column| column.len() != rows)
            || !is_whole(self.weights.len())
            || !is_whole(self.groups.len())
        {
            return wrong("the columns are not of one length");
        }
        for row in 0..rows {
            let wrong = |what| Err(TuneError::Row { row, what });
            let values = self.inputs.iter().chain([&self.truths]);
            if values
                .filter_map(|column| column.get(row))
                .any(|x| !x.is_finite())
            {
                return wrong("a value is not a finite number");
            }
            if !(self.weight(row) >= 0.0 && self.weight(row).is_finite()) {
                return wrong("the weight is not a number from 0");
            }
            let truth = self.truths.get(row);
            if loss != Loss::Squared && truth.is_none_or(|truth| *truth != 0.0 && *truth != 1.0) {
                return wrong("the truth is neither 0 nor 1");
            }
        }
        let first = self.truths.first();
        if loss == Loss::Ranking && self.truths.iter().all(|truth| Some(truth) == first) {
            return Err(TuneError::OneClass);
        }
        Ok(())
    }
}

/// The least and the largest value.
pub(crate) fn range(column: &[f64]) -> (f64, f64) {
    let of = |(low, high): (f64, f64), x: &f64| (low.min(*x), high.max(*x));
    column.iter().fold((f64::INFINITY, f64::NEG_INFINITY), of)
}
