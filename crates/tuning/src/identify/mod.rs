//! Structure identification: finds inputs, partitions and rules from rows of data (Takagi and Sugeno 1985; Sugeno and
//! Yasukawa 1993).

mod clusters;
mod fit;
mod model;
mod structure;
mod validation;

use fuzzy::Model;

use crate::{
    Loss, TuneError,
    data::{Data, range},
    folds::Folds,
};

use clusters::Clusters;
use fit::{Fit, RIDGE};
use structure::{Axis, Structure};

pub use model::MAX_TERMS;
pub use validation::{IdentifyValidation, cross_validate};

/// The kind of consequents.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Consequents {
    /// Constants.
    #[default]
    Constants,
    /// Linear functions of the inputs.
    Lines,
}

/// The kind of antecedents.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Antecedents {
    /// Combinations of the terms of partitions, one rule for each.
    #[default]
    Partitions,
    /// Clusters, found by subtractive clustering (Chiu 1994), one rule for each.
    Clusters,
}

/// Settings of [`identify`].
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub struct Identification {
    /// The kind of antecedents.
    pub antecedents: Antecedents,
    /// The kind of consequents.
    pub consequents: Consequents,
    /// The names of the inputs to use; if empty, inputs are selected.
    pub inputs: Vec<String>,
    /// The maximum number of inputs, if they are selected.
    pub max_inputs: usize,
    /// The maximum number of terms of an input, from 2 to [`MAX_TERMS`].
    pub max_terms: usize,
    /// The maximum number of rules.
    pub max_rules: usize,
    /// The minimum relative reduction of the cross-validation error by a step.
    pub min_gain: f64,
    /// The minimum number of rows at which a rule fires more strongly than any other; rules with fewer such rows are
    /// omitted.
    pub least_support: usize,
    /// The number of folds for choosing a step.
    pub folds: u32,
    /// The random seed for the folds.
    pub seed: u64,
}

impl Default for Identification {
    /// The defaults: partitions and constants; at most 4 inputs, 5 terms each and 25 rules; a gain
    /// of at least 2 % per step; 5 folds.
    fn default() -> Self {
        Identification {
            antecedents: Antecedents::Partitions,
            consequents: Consequents::Constants,
            inputs: Vec::new(),
            max_inputs: 4,
            max_terms: 5,
            max_rules: 25,
            min_gain: 0.02,
            least_support: 1,
            folds: 5,
            seed: 0,
        }
    }
}

/// A model identified from data.
#[derive(Debug, Clone, PartialEq)]
pub struct IdentifyResult {
    /// The model: a Takagi-Sugeno output, with the product as conjunction.
    pub model: Model,
    /// For each input of the model, the index of its column.
    pub columns: Vec<usize>,
    /// The steps of the search.
    pub steps: Vec<IdentifyStep>,
    /// The number of term combinations without enough rows, which have no rule.
    pub without_rows: usize,
}

/// One step of the search.
#[derive(Debug, Clone, PartialEq)]
pub struct IdentifyStep {
    /// The input that was added or received another term.
    pub input: String,
    /// The number of terms of that input; for clusters, the number of clusters.
    pub terms: usize,
    /// The cross-validation error (root mean square), in the unit of the output.
    pub cv_error: f64,
}

/// A step must also reduce the error by this share of the error that a prediction of the mean has: smaller reductions
/// are irrelevant.
const MIN_GAIN_OF_ALL: f64 = 1e-3;

/// The radii of clusters that are tried, as shares of the ranges.
const RADII: [f64; 4] = [0.3, 0.5, 0.7, 1.0];

/// The maximum number of candidate columns. It is limited because each step of the search tries all of them.
const MAX_COLUMNS: usize = 500;

/// Rejects tables with more columns than [`identify`] accepts, so that a program can check this before it reads the
/// rows.
///
/// # Errors
/// [`TuneError::TooManyColumns`] if there are more columns.
pub fn check_columns(columns: usize) -> Result<(), TuneError> {
    match columns > MAX_COLUMNS {
        true => Err(TuneError::TooManyColumns {
            columns,
            most: MAX_COLUMNS,
        }),
        false => Ok(()),
    }
}

/// Finds inputs, partitions or clusters, and rules for columns of data and their true outputs. It is a forward search:
/// each step adds the input or the term with the smallest cross-validation error, as long as the error decreases
/// enough. Peaks are at rounded quantiles; consequents are computed by least squares with a ridge. [`crate::tune`] can
/// improve both afterwards.
///
/// The error of a step is computed on rows that were not used for its consequents. But because steps are chosen to make
/// this error small, it is optimistic. [`cross_validate`] cross-validates the whole search.
///
/// # Errors
/// If the rows cannot be used, if a name is unknown, or if no input reduces the error.
///
/// # Example: which of three columns matter
/// ```
/// use flagred_tuning::{Data, identify::{Identification, identify}};
///
/// // The output is the product of the first two columns; the third has nothing to do with it.
/// let mut data = Data { inputs: vec![Vec::new(); 3], ..Data::default() };
/// for i in 0..1000 {
///     let row = [f64::from(i % 10), f64::from(i / 10 % 10), f64::from(i * 7919 % 13)];
///     data.inputs.iter_mut().zip(row).for_each(|(column, x)| column.push(x));
///     data.truths.push(row[0] * row[1]);
/// }
/// let names = ["width", "length", "noise"].map(str::to_owned);
/// let found = identify(&names, "area", &data, &Identification::default())?;
/// assert_eq!(found.columns.len(), 2);
/// let area = fuzzy::Engine::new(&found.model)?.evaluate(&[5.0, 5.0])?[0].value();
/// assert!((area.unwrap() - 25.0).abs() < 2.0);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn identify(
    names: &[String],
    output: &str,
    data: &Data,
    settings: &Identification,
) -> Result<IdentifyResult, TuneError> {
    data.check_columns(names.len(), Loss::Squared)?;
    check_columns(names.len())?;
    let data = &*data.weighted();
    let named = |name: &String| {
        let found = names.iter().position(|known| known == name);
        found.ok_or_else(|| TuneError::Unknown { name: name.clone() })
    };
    let wanted: Vec<usize> = settings
        .inputs
        .iter()
        .map(named)
        .collect::<Result<_, _>>()?;
    let (low, high) = range(&data.truths);
    if low == high {
        return Err(TuneError::NoInputHelps);
    }
    let folds = Folds::new(data, settings.folds, settings.seed);
    let sorted = data.inputs.iter().map(|column| {
        let mut values = column.clone();
        values.sort_by(f64::total_cmp);
        values
    });
    let search = Search {
        data,
        sorted: sorted.collect(),
        settings,
        folds,
        wanted: &wanted,
    };
    let (structure, steps) = search.run();
    let steps = steps
        .into_iter()
        .map(|(input, terms, left_out)| IdentifyStep {
            input: names[input].clone(),
            terms,
            cv_error: left_out,
        });
    if structure.inputs().is_empty() {
        return Err(TuneError::NoInputHelps);
    }
    let mut identified = model::model(names, output, data, settings, &structure);
    identified.steps = steps.collect();
    Ok(identified)
}

struct Search<'a> {
    data: &'a Data,
    /// The values of each input, ascending.
    sorted: Vec<Vec<f64>>,
    settings: &'a Identification,
    folds: Folds,
    /// The indices of the inputs to use; if empty, inputs are selected.
    wanted: &'a [usize],
}

/// A step: the changed input, its number of terms, and the error after it.
type SearchStep = (usize, usize, f64);

impl Search<'_> {
    fn run(&self) -> (Structure, Vec<SearchStep>) {
        let mut best = Structure::Grid(Vec::new());
        let mut error = self.error(&best);
        let least_of_all = MIN_GAIN_OF_ALL * error;
        let mut steps = Vec::new();
        loop {
            let next = self
                .grown(&best)
                .into_iter()
                .map(|(input, terms, structure)| {
                    let error = self.error(&structure);
                    (input, terms, error, structure)
                })
                .min_by(|a, b| a.2.total_cmp(&b.2));
            let Some((input, terms, left_out, structure)) = next else {
                break;
            };
            // Inputs that the user requested are added regardless of their gain.
            let is_asked_for =
                structure.inputs().len() > best.inputs().len() && !self.wanted.is_empty();
            let least = least_of_all.max(self.settings.min_gain * error);
            if !is_asked_for && left_out >= error - least {
                break;
            }
            steps.push((input, terms, left_out));
            (best, error) = (structure, left_out);
        }
        (best, steps)
    }

    fn error(&self, structure: &Structure) -> f64 {
        let fit = Fit {
            structure,
            consequents: self.settings.consequents,
            kept: &vec![true; structure.rules()],
            ridge: RIDGE,
        };
        fit.cross_validation_error(self.data, &self.folds)
    }

    /// The candidates for a step: the changed input, its number of terms, and the structure.
    fn grown(&self, from: &Structure) -> Vec<(usize, usize, Structure)> {
        let used = from.inputs();
        let is_open = |input: &usize| {
            let (low, high) = range(&self.data.inputs[*input]);
            low < high && !used.contains(input)
        };
        let fresh: Vec<usize> = match self.wanted {
            [] if used.len() >= self.settings.max_inputs => Vec::new(),
            [] => (0..self.data.inputs.len()).filter(is_open).collect(),
            wanted => wanted.iter().copied().filter(is_open).collect(),
        };
        match self.settings.antecedents {
            Antecedents::Clusters => self.clusters(&used, &fresh),
            Antecedents::Partitions => self.grids(from, &fresh),
        }
    }

    fn clusters(&self, used: &[usize], fresh: &[usize]) -> Vec<(usize, usize, Structure)> {
        let all = fresh
            .iter()
            .flat_map(|input| RADII.map(|radius| (*input, radius)));
        let found = all.map(|(input, radius)| {
            let inputs: Vec<usize> = used.iter().copied().chain([input]).collect();
            let clusters = Clusters::find(self.data, &inputs, radius, self.settings.max_rules);
            (input, clusters.centers.len(), Structure::Clusters(clusters))
        });
        found.collect()
    }

    /// Returns the structures that result if an input with two or three terms is added, or if an input in use gets
    /// another term.
    fn grids(&self, from: &Structure, fresh: &[usize]) -> Vec<(usize, usize, Structure)> {
        let Structure::Grid(axes) = from else {
            return Vec::new();
        };
        let mut grown = Vec::new();
        let mut take = |input: usize, terms: usize, axes: Vec<Axis>| {
            let structure = Structure::Grid(axes);
            if structure.rules() <= self.settings.max_rules {
                grown.push((input, terms, structure));
            }
        };
        let max_terms = self.settings.max_terms.min(MAX_TERMS);
        for input in fresh {
            for terms in 2..=max_terms.min(3) {
                if let Some(axis) = self.axis(*input, terms) {
                    take(*input, terms, axes.iter().cloned().chain([axis]).collect());
                }
            }
        }
        for (i, axis) in axes.iter().enumerate() {
            let terms = axis.peaks.len() + 1;
            if terms <= max_terms
                && let Some(axis) = self.axis(axis.input, terms)
            {
                let mut axes = axes.clone();
                axes[i] = axis;
                take(axes[i].input, terms, axes);
            }
        }
        grown
    }

    /// Returns an axis with its peaks at quantiles from 5 to 95 %; `None` if the peaks are not far enough apart.
    fn axis(&self, input: usize, terms: usize) -> Option<Axis> {
        let values = &self.sorted[input];
        let (low, high) = (values.first()?, values.last()?);
        let last = values.len() - 1;
        let quantile = |i: usize| {
            let share = 0.05 + 0.9 * i as f64 / (terms - 1) as f64;
            model::round(
                values[(share * last as f64).round() as usize],
                high - low,
                f64::round,
            )
        };
        let peaks: Vec<f64> = (0..terms).map(quantile).collect();
        let is_apart = peaks.is_sorted_by(|a, b| b - a >= 0.02 * (high - low));
        is_apart.then_some(Axis { input, peaks })
    }
}

#[cfg(test)]
mod tests;
