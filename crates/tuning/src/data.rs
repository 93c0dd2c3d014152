//! The rows for tuning a model.

use std::borrow::Cow;

use fuzzy::{
    Model,
    learn::{WEIGHTS, bad_weight},
};

use crate::{Loss, TuneError};

/// Rows, stored as columns.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Data {
    /// One column for each input of the model, in the order of the model.
    pub inputs: Vec<Vec<f64>>,
    /// The true output of each row: a value of the output; for [`Loss::Log`] and [`Loss::Ranking`] 0 or 1.
    pub truths: Vec<f64>,
    /// The weight of each row; if empty, all rows count the same.
    pub weights: Vec<f64>,
    /// The group of each row, such as its vehicle; empty without groups.
    pub groups: Vec<u32>,
}

impl Data {
    /// The largest absolute value of a number in a row, and the largest weight. Squares of larger numbers, and their
    /// products, would overflow.
    pub const LARGEST: f64 = *WEIGHTS.end();

    /// The largest distance of a target of [`Loss::Squared`] from the output's range, in widths of the range. For
    /// targets farther away, changes of the numbers affect the loss by less than its rounding errors.
    pub const FARTHEST: f64 = 1e6;

    /// Returns the reason why a row cannot be used, if there is one. `values` are its inputs followed by its output.
    pub fn problem(values: &[f64], weight: f64, loss: Loss) -> Option<String> {
        let largest = Data::LARGEST;
        if values.iter().any(|x| !x.is_finite()) {
            return Some("a value is not a finite number".into());
        }
        if let Some(x) = values.iter().find(|x| x.abs() > largest) {
            let range =
                format!("outside the range from -{largest:e} to {largest:e} that tuning supports");
            return Some(format!("the value {x:e} is {range}"));
        }
        if !(weight == 0.0 || WEIGHTS.contains(&weight)) {
            return Some(bad_weight(weight, "0, or a number"));
        }
        let truth = values.last().filter(|truth| ![0.0, 1.0].contains(*truth));
        truth
            .filter(|_| loss != Loss::Squared)
            .map(|truth| format!("the output's value is {truth}, but must be 0 or 1 for this loss"))
    }

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

    /// The rows with a weight above 0. Without this selection, folds of cross-validation could consist of rows without
    /// weight.
    pub(crate) fn weighted(&self) -> Cow<'_, Data> {
        match self.weights.contains(&0.0) {
            true => Cow::Owned(self.filtered(|row| self.weight(row) > 0.0)),
            false => Cow::Borrowed(self),
        }
    }

    /// The inputs of all rows, in the form for the engine.
    pub(crate) fn columns(&self) -> Vec<&[f64]> {
        self.inputs.iter().map(Vec::as_slice).collect()
    }

    /// The rows for which `keep` returns true.
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

    /// Checks that a model can be tuned on the rows.
    pub(crate) fn check(&self, model: &Model, loss: Loss) -> Result<(), TuneError> {
        if model.has_type2_terms() {
            return Err(TuneError::Type2);
        }
        let output = &model.outputs[target(model)?];
        self.check_columns(model.inputs.len(), loss)?;
        let (low, high) = (output.variable.low, output.variable.high);
        let distance = |target: f64| (low - target).max(target - high);
        let counting = self.truths.iter().enumerate();
        let counting = counting.filter(|(row, _)| self.weight(*row) > 0.0);
        let farthest = counting
            .map(|(_, target)| *target)
            .max_by(|a, b| distance(*a).total_cmp(&distance(*b)));
        match farthest {
            Some(target)
                if loss == Loss::Squared && distance(target) > Data::FARTHEST * (high - low) =>
            {
                Err(TuneError::TooFar { target, low, high })
            }
            _ => Ok(()),
        }
    }

    /// Checks that the rows have this number of inputs, and that all numbers can be used.
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
            return wrong("the columns differ in length");
        }
        let mut values = Vec::with_capacity(inputs + 1);
        for row in 0..rows {
            values.clear();
            let columns = self.inputs.iter().chain([&self.truths]);
            values.extend(columns.filter_map(|column| column.get(row)));
            if let Some(what) = Data::problem(&values, self.weight(row), loss) {
                return Err(TuneError::Row { row, what });
            }
        }
        let truths = self.truths.iter().enumerate();
        let mut truths = truths.filter(|(row, _)| self.weight(*row) > 0.0);
        let Some((_, first)) = truths.next() else {
            return Err(TuneError::NoWeight);
        };
        if loss == Loss::Ranking && truths.all(|(_, truth)| truth == first) {
            return Err(TuneError::OneClass);
        }
        Ok(())
    }
}

/// The index of the output that is tuned: the only one that no other output reads.
pub(crate) fn target(model: &Model) -> Result<usize, TuneError> {
    match model.last_outputs()[..] {
        [target] => Ok(target),
        ref last => Err(TuneError::Outputs {
            outputs: last.len(),
        }),
    }
}

/// The minimum and maximum of a column.
pub(crate) fn range(column: &[f64]) -> (f64, f64) {
    let of = |(low, high): (f64, f64), x: &f64| (low.min(*x), high.max(*x));
    column.iter().fold((f64::INFINITY, f64::NEG_INFINITY), of)
}
