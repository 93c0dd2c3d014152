//! What may move, towards what, and for how long.

use crate::Data;
use fuzzy::{check::Monotone, diagnostic::Findings, engine::EvaluateError};

/// What is made small. Each row counts by its weight.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Loss {
    /// The mean square of prediction less truth. Its measure is the root of that, in the unit of the output.
    #[default]
    Squared,
    /// The mean of `-ln p` where the truth is 1, `-ln(1 - p)` where it is 0: `p` is the place of the prediction in the range
    /// of the output, from 0 to 1 and kept off the ends by [`Loss::LEAST_PROBABILITY`]. Truths are 0 and 1.
    Log,
    /// The share of pairs of a row of truth 1 and one of truth 0 whose order the predictions have wrong, equal ones half:
    /// 1 less the area under the ROC curve. Truths are 0 and 1. It is a step function; what is made small is the mean of
    /// `ln(1 + exp(-d / s))` over the pairs, for a distance `d` of the predictions and 2 % of the range as `s`.
    Ranking,
}

impl Loss {
    /// See [`Loss::Log`].
    pub const LEAST_PROBABILITY: f64 = 1e-3;
}

/// What may move and how far.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub struct Settings {
    /// What is made small.
    pub loss: Loss,
    /// The variables, or terms as `variable.term`, that may move; empty: all.
    pub only: Vec<String>,
    /// The variables, or terms as `variable.term`, that stay.
    pub fix: Vec<String>,
    /// Whether the weights of rules may move.
    pub weights: bool,
    /// The least distance between the peaks of neighbouring terms, as a share of the range. Peaks that are closer stay as
    /// close as they are.
    pub min_distance: f64,
    /// What the output must do when an input rises. A step after which [`fuzzy::check::counterexamples`] finds that it does
    /// not is not taken.
    pub monotone: Vec<Monotone>,
    /// Whether constants of an output may leave its range, by the width of the range at most.
    pub beyond_range: bool,
    /// The significant digits of numbers that moved; `None`: all. A position has as many as the width of its range needs:
    /// three digits of a pressure from 950 to 1050 are 1013. Near 0, three digits are at most 0.05 % of the width.
    pub digits: Option<u32>,
    /// How often the search starts: first at the model, then at random places around it.
    pub starts: u32,
    /// For the random places.
    pub seed: u64,
    /// The most steps of a start.
    pub iterations: u32,
}

impl Default for Settings {
    /// Squared error; all terms may move, at least 1 % of the range apart and within it; weights stay; three digits; one start
    /// of 100 steps.
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
    /// Whether the numbers of a term may move.
    pub(crate) fn may_move(&self, variable: &str, term: &str) -> bool {
        let named = |names: &[String]| {
            let is_it =
                |name: &String| *name == variable || name.split_once('.') == Some((variable, term));
            names.iter().any(is_it)
        };
        (self.only.is_empty() || named(&self.only)) && !named(&self.fix)
    }

    /// Whether the consequents of a Takagi-Sugeno output are solved for, rather than searched: for squared errors they are a
    /// linear problem, as long as no constraint binds them.
    pub(crate) fn fits_consequents(&self) -> bool {
        self.loss == Loss::Squared && self.monotone.is_empty()
    }
}

/// Why a model cannot be tuned.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum TuneError {
    /// Tuning needs one output that no other output reads.
    #[error(
        "the rule set has {outputs} outputs that no other output reads; tuning needs exactly one"
    )]
    Outputs {
        /// How many of them there are.
        outputs: usize,
    },
    /// A name that the model does not have.
    #[error("the model has no variable and no term `{name}`")]
    Unknown {
        /// The name.
        name: String,
    },
    /// All parameters are fixed, or there are none.
    #[error("nothing may move")]
    NothingMoves,
    /// No input makes the error on rows left out smaller.
    #[error("no input tells more about the output than its mean")]
    NoInputHelps,
    /// There is nothing to learn from.
    #[error("there are no rows")]
    NoRows,
    /// Columns are missing or too many, or not of one length.
    #[error("{what}")]
    Columns {
        /// What is wrong.
        what: &'static str,
    },
    /// More columns may be inputs than a search looks at.
    #[error("{columns} columns are more than {most}")]
    TooManyColumns {
        /// How many there are.
        columns: usize,
        /// How many there may be.
        most: usize,
    },
    /// A value or a weight that cannot be used.
    #[error("row {row}: {what}")]
    Row {
        /// The row, counted from 0.
        row: usize,
        /// What is wrong.
        what: String,
    },
    /// No row counts.
    #[error("the weights of all rows are 0")]
    NoWeight,
    /// The error of the model on the rows overflows.
    #[error(
        "the error on these rows is not a finite number: they are too far outside the range of the output"
    )]
    NotFinite,
    /// Targets are so far from the range of the output that moving numbers changes no digit of the loss.
    #[error(
        "the target {target:e} is farther from the output's range [{low}, {high}] than {} times its width",
        Data::FARTHEST
    )]
    TooFar {
        /// The target that is farthest away.
        target: f64,
        /// The lower end of the range.
        low: f64,
        /// The upper end of the range.
        high: f64,
    },
    /// Truths of 0 and of 1 are both needed.
    #[error("all rows have the same truth")]
    OneClass,
    /// The model does not hold what [`Settings::monotone`] asks for before it is tuned.
    #[error("the output is not {direction} in `{input}` to begin with")]
    NotMonotone {
        /// The input.
        input: String,
        /// What was asked for.
        direction: &'static str,
    },
    /// [`Settings::monotone`] names what the model does not have.
    #[error("{message}")]
    Claim {
        /// What is wrong.
        message: String,
    },
    /// The model cannot be used.
    #[error(transparent)]
    Compile(#[from] Findings),
    /// The model cannot be evaluated.
    #[error(transparent)]
    Evaluate(#[from] EvaluateError),
}
