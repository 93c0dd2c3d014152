//! Fits the consequents of a structure by least squares, and computes their cross-validation error.

use nalgebra::{DMatrix, DVector};

use crate::{
    consequents::solve,
    data::{Data, range},
    folds::Folds,
};

use super::{Consequents, structure::Structure};

/// The ridge, as a share of the diagonal elements. It pulls consequents that are supported by few rows towards the
/// mean.
pub(super) const RIDGE: f64 = 1e-3;

/// The sums over a set of rows from which a least-squares fit is computed.
#[derive(Clone)]
struct Sums {
    squares: DMatrix<f64>,
    products: DVector<f64>,
    truths: f64,
    weight: f64,
}

impl Sums {
    fn new(numbers: usize) -> Sums {
        Sums {
            squares: DMatrix::zeros(numbers, numbers),
            products: DVector::zeros(numbers),
            truths: 0.0,
            weight: 0.0,
        }
    }

    /// Adds a row. `factors` contains the indices of the numbers that the prediction of the row depends on, each with
    /// its factor; `truth` is the truth minus the mean.
    fn add(&mut self, factors: &[(usize, f64)], truth: f64, weight: f64) {
        for (p, a) in factors {
            self.products[*p] += weight * a * truth;
            for (q, b) in factors {
                self.squares[(*p, *q)] += weight * a * b;
            }
        }
        self.truths += weight * truth * truth;
        self.weight += weight;
    }

    fn without(&self, other: &Sums) -> Sums {
        Sums {
            squares: &self.squares - &other.squares,
            products: &self.products - &other.products,
            truths: self.truths - other.truths,
            weight: self.weight - other.weight,
        }
    }

    /// The sum of squared errors for given numbers.
    fn error(&self, numbers: &DVector<f64>) -> f64 {
        let error = self.truths - 2.0 * numbers.dot(&self.products)
            + numbers.dot(&(&self.squares * numbers));
        error.max(0.0)
    }
}

/// Scales the range of an input to [-1, 1], so that a ridge has the same effect on all inputs.
struct InputScale {
    input: usize,
    middle: f64,
    half: f64,
}

impl InputScale {
    fn of(&self, x: &dyn Fn(usize) -> f64) -> f64 {
        (x(self.input) - self.middle) / self.half
    }
}

/// The settings of a least-squares fit of consequents.
pub(super) struct Fit<'a> {
    pub(super) structure: &'a Structure,
    pub(super) consequents: Consequents,
    /// For each rule, whether it is used.
    pub(super) kept: &'a [bool],
    /// See [`RIDGE`].
    pub(super) ridge: f64,
}

impl Fit<'_> {
    /// The number of coefficients of a rule: a constant and, for linear consequents, one coefficient for each input.
    fn coefficients_per_rule(&self) -> usize {
        match self.consequents {
            Consequents::Constants => 1,
            Consequents::Lines => self.structure.inputs().len() + 1,
        }
    }

    /// Returns the sums over the rows of each of `parts` parts. `part` returns the part that a row belongs to.
    fn sums(&self, data: &Data, parts: usize, part: impl Fn(usize) -> usize) -> Vec<Sums> {
        let scales = self.scales(data);
        let per_rule = self.coefficients_per_rule();
        let mean = mean(data);
        let mut sums = vec![Sums::new(self.structure.rules() * per_rule); parts];
        let (mut strengths, mut factors) = (Vec::new(), Vec::new());
        for row in 0..data.len() {
            let x = |input: usize| data.inputs[input][row];
            self.structure.strengths(&x, &mut strengths);
            strengths.retain(|(rule, _)| self.kept[*rule]);
            let total: f64 = strengths.iter().map(|(_, strength)| strength).sum();
            if total <= 0.0 {
                continue;
            }
            factors.clear();
            for (rule, strength) in &strengths {
                let share = strength / total;
                let first = rule * per_rule;
                if self.consequents == Consequents::Lines {
                    let of_inputs = scales.iter().enumerate();
                    factors.extend(of_inputs.map(|(i, scale)| (first + i, share * scale.of(&x))));
                }
                factors.push((first + per_rule - 1, share));
            }
            sums[part(row)].add(&factors, data.truths[row] - mean, data.weight(row));
        }
        sums
    }

    /// Fits the numbers of each rule: the coefficients, then the constant.
    pub(super) fn numbers(&self, data: &Data) -> Vec<Vec<f64>> {
        let per_rule = self.coefficients_per_rule();
        let mean = mean(data);
        let sums = self.sums(data, 1, |_| 0).remove(0);
        let found = solve(sums.squares, &sums.products, self.ridge);
        let found = found.unwrap_or_else(|| DVector::zeros(self.structure.rules() * per_rule));
        let scales = self.scales(data);
        let rules = found.as_slice().chunks_exact(per_rule);
        rules
            .map(|numbers| {
                let (scaled, constant) = numbers.split_at(per_rule - 1);
                let slopes = scaled.iter().zip(&scales);
                let mut numbers: Vec<f64> =
                    slopes.map(|(slope, scale)| slope / scale.half).collect();
                let middles = numbers.iter().zip(&scales);
                let moved: f64 = middles.map(|(slope, scale)| slope * scale.middle).sum();
                numbers.push(mean + constant.iter().sum::<f64>() - moved);
                numbers
            })
            .collect()
    }

    /// The scale of each input, for linear consequents.
    fn scales(&self, data: &Data) -> Vec<InputScale> {
        let of = |input: usize| {
            let (low, high) = range(&data.inputs[input]);
            InputScale {
                input,
                middle: (low + high) / 2.0,
                half: (high - low) / 2.0,
            }
        };
        self.structure.inputs().into_iter().map(of).collect()
    }

    /// The cross-validation error: root mean square, with each fold predicted from the others.
    pub(super) fn cross_validation_error(&self, data: &Data, folds: &Folds) -> f64 {
        let sums = self.sums(data, folds.count, |row| folds.of(data, row));
        let mut all = Sums::new(self.structure.rules() * self.coefficients_per_rule());
        for part in &sums {
            all.squares += &part.squares;
            all.products += &part.products;
            all.truths += part.truths;
            all.weight += part.weight;
        }
        let mut error = 0.0;
        for part in &sums {
            let known = all.without(part);
            let numbers = solve(known.squares, &known.products, self.ridge);
            let numbers = numbers.unwrap_or_else(|| DVector::zeros(part.products.len()));
            error += part.error(&numbers);
        }
        (error / all.weight).sqrt()
    }
}

/// The weighted mean of the truths.
pub(super) fn mean(data: &Data) -> f64 {
    let rows = (0..data.len()).map(|row| (data.weight(row), data.truths[row]));
    let (weight, sum) = rows.fold((0.0, 0.0), |(w, s), (weight, truth)| {
        (w + weight, s + weight * truth)
    });
    sum / weight
}
