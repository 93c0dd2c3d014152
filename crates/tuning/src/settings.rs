//! Settings of tuning: loss, parameters that may change, constraints, and effort.

use crate::Data;
use fuzzy::{check::Monotone, diagnostic::Findings, engine::EvaluateError};

/// The loss to minimise. Rows are weighted.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Loss {
    /// The mean square of prediction minus truth. The reported measure is its root, in the unit of the output.
    #[default]
    Squared,
    /// The mean of `-ln p` for truth 1 and `-ln(1 - p)` for truth 0, where `p` is the position of the prediction in the
    /// range of the output, from 0 to 1 and at least [`Loss::MIN_PROBABILITY`] away from both ends. Truths are 0 and
    /// 1.
    Log,
    /// The share of wrongly ordered pairs among all pairs of a row with truth 1 and a row with truth 0. A pair is
    /// wrongly ordered if its predictions are; equal predictions count half. The loss is 1 minus the area under the
    /// ROC curve. Truths are 0 and 1. Because this share is a step function, the search minimises the mean of `ln(1 +
    /// exp(-d / s))` over the pairs instead, where `d` is the prediction for the row with truth 1 minus the prediction
    /// for the row with truth 0, and `s` is 2 % of the range.
    Ranking,
}

impl Loss {
    /// The minimum distance of a probability from 0 and 1; see [`Loss::Log`].
    pub const MIN_PROBABILITY: f64 = 1e-3;
}

/// Settings of [`tune`](crate::tune).
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub struct Settings {
    /// The loss to minimise.
    pub loss: Loss,
    /// The variables, or terms as `variable.term`, that may change; if empty, all of them may change.
    pub only: Vec<String>,
    /// The variables, or terms as `variable.term`, that must not change.
    pub fix: Vec<String>,
    /// Whether the weights of rules may change.
    pub weights: bool,
    /// The minimum distance between the peaks of neighbouring terms, as a share of the range. For peaks that are
    /// closer, their current distance is the minimum.
    pub min_distance: f64,
    /// The directions in which the output must change when an input rises. A step is rejected if
    /// [`fuzzy::check::counterexamples`] finds a violation after it.
    pub monotone: Vec<Monotone>,
    /// Whether constants of an output may be outside its range, by at most the width of the range.
    pub beyond_range: bool,
    /// The significant digits of changed numbers; `None` keeps all. A position has the digits that the width of its
    /// range requires: with three digits, a pressure from 950 to 1050 is rounded to 1013. Near 0, three digits are at
    /// most 0.05 % of the width.
    pub digits: Option<u32>,
    /// The number of starts of the search: the first from the model, the others from random points around it.
    pub starts: u32,
    /// The random seed for the starting points.
    pub seed: u64,
    /// The maximum number of steps per start.
    pub iterations: u32,
}

impl Default for Settings {
    /// The defaults: squared error; all terms may change, but stay within the range and at least 1 % of it apart;
    /// fixed weights; three digits; one start of 100 steps.
    fn default() -> Self {
        Settings {
            loss: Loss::Squared,
            only: Vec::new(),
            fix: Vec::new(),
            weights: false,
            min_distance: 0.01,
            monotone: Vec::new(),
            beyond_range: false,
            digits: Some(3),
            starts: 1,
            seed: 0,
            iterations: 100,
        }
    }
}

impl Settings {
    /// Whether the numbers of a term may change.
    pub(crate) fn may_move(&self, variable: &str, term: &str) -> bool {
        let named = |names: &[String]| {
            let is_it =
                |name: &String| *name == variable || name.split_once('.') == Some((variable, term));
            names.iter().any(is_it)
        };
        (self.only.is_empty() || named(&self.only)) && !named(&self.fix)
    }

    /// Whether the consequents of a Takagi-Sugeno output are fitted by least squares rather than searched. This is
    /// possible for squared errors without monotonicity constraints, where they are a linear problem.
    pub(crate) fn fits_consequents(&self) -> bool {
        self.loss == Loss::Squared && self.monotone.is_empty()
    }
}

/// The reason why a model cannot be tuned.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum TuneError {
    /// Tuning needs exactly one output that no other output reads.
    #[error(
        "the rule set has {outputs} outputs that no other output reads; tuning needs exactly one"
    )]
    Outputs {
        /// The number of outputs that no other output reads.
        outputs: usize,
    },
    /// The rule set has interval type-2 terms.
    #[error("the rule set has type-2 terms, which cannot be tuned")]
    Type2,
    /// The model has no variable or term with this name.
    #[error("the rule set has no variable and no term `{name}`")]
    Unknown {
        /// The name.
        name: String,
    },
    /// No parameter may change: all are fixed, or the model has none.
    #[error("nothing can be tuned: every number is fixed")]
    NothingMoves,
    /// No input reduces the cross-validation error.
    #[error("no input predicts the output better than its mean")]
    NoInputHelps,
    /// There are no rows.
    #[error("there are no rows")]
    NoRows,
    /// There are too few or too many columns, or the columns have different lengths.
    #[error("{what}")]
    Columns {
        /// The problem.
        what: &'static str,
    },
    /// There are more candidate columns than a search accepts.
    #[error("{columns} columns exceed the limit of {most}")]
    TooManyColumns {
        /// The number of columns.
        columns: usize,
        /// The maximum number of columns.
        most: usize,
    },
    /// A value or a weight cannot be used.
    #[error("row {row}: {what}")]
    Row {
        /// The index of the row, from 0.
        row: usize,
        /// The problem.
        what: String,
    },
    /// All weights are 0.
    #[error("the weights of all rows are 0")]
    NoWeight,
    /// The error of the model on the rows overflows.
    #[error(
        "the error on these rows is not a finite number: they are too far outside the range of the output"
    )]
    NotFinite,
    /// Targets are so far from the range of the output that changes of the numbers do not affect any digit of the loss.
    #[error(
        "the target {target:e} is farther from the output's range [{low}, {high}] than {} times its width",
        Data::FARTHEST
    )]
    TooFar {
        /// The target that is farthest from the range.
        target: f64,
        /// The lower end of the range.
        low: f64,
        /// The upper end of the range.
        high: f64,
    },
    /// All rows have the same truth, but rows with 0 and with 1 are needed.
    #[error("all rows have the same outcome")]
    OneClass,
    /// The model violates [`Settings::monotone`] before tuning.
    #[error("the output is not {direction} in `{input}` before tuning")]
    NotMonotone {
        /// The input.
        input: String,
        /// The required direction.
        direction: &'static str,
    },
    /// A claim in [`Settings::monotone`] names an input or output that the model does not have.
    #[error("{message}")]
    Claim {
        /// The problem.
        message: String,
    },
    /// The model cannot be used.
    #[error(transparent)]
    Compile(#[from] Findings),
    /// The model cannot be evaluated.
    #[error(transparent)]
    Evaluate(#[from] EvaluateError),
}
