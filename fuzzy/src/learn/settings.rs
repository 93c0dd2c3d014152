//! What is learned and how, and why something is not.

use alloc::{string::String, vec::Vec};

use crate::rule::Condition;

/// What decides between the consequents that samples of one antecedent vote for.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Resolution {
    /// The consequent of the one vote with the highest degree wins: Wang and Mendel's, and the FLAGRED paper's.
    /// One odd sample can decide. The confidence of a rule is that degree.
    #[default]
    Strongest,
    /// The consequent with the highest sum of degrees wins. The confidence is its share of the sum of all degrees.
    Heaviest,
    /// The mean of the output over the samples of the antecedent, each weighted with the product of its input
    /// memberships, decides: the term it belongs to most. Where no term holds it, the term whose peak is nearest. The
    /// confidence is the share of that weight whose own values say the same term.
    Mean,
}

/// Which way the output must go when an input rises.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Direction {
    /// It never falls.
    Rising,
    /// It never rises.
    Falling,
}

/// What is learned, and how.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Settings {
    /// What decides where samples disagree.
    pub resolution: Resolution,
    /// An antecedent with fewer samples makes no rule; 0 and 1 take every one.
    pub min_support: u64,
    /// A rule with a lower confidence is left out.
    pub min_degree: f64,
    /// Complete the rules: an antecedent without one takes what the nearest one says (steps between terms counted,
    /// the highest of equally near ones), and says so in its note.
    pub complete: bool,
    /// Inputs on which the output must be monotone. Neighbouring antecedents that contradict it are averaged until
    /// none does.
    pub monotone: Vec<(String, Direction)>,
    /// A condition that every learned rule is joined to by AND; its inputs are not learned over, and a sample counts
    /// as much as it fulfils it.
    pub given: Option<Condition>,
}

/// Why nothing can be learned with a model and settings.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum LearnError {
    /// The model has not exactly one output.
    #[error("rules are learned for one output, but the model has {outputs}")]
    Outputs {
        /// How many it has.
        outputs: usize,
    },
    /// A variable without terms.
    #[error("`{variable}` has no terms")]
    NoTerms {
        /// The variable.
        variable: String,
    },
    /// A setting names what is no input of the model, or not one that is learned over.
    #[error("`{name}` is no input that rules are learned over")]
    NoInput {
        /// The name.
        name: String,
    },
    /// The given condition names a term that its input does not have.
    #[error("`{variable}` has no term `{term}`")]
    NoTerm {
        /// The input.
        variable: String,
        /// The term.
        term: String,
    },
    /// The given condition is more than propositions joined by AND.
    #[error("the given condition is not made of `input IS term` joined by AND")]
    Given,
}

/// Why a sample was not learned from.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum Refusal {
    /// Not one value for each variable.
    #[error("there are {got} values for {expected} variables")]
    WrongNumber {
        /// Inputs and output.
        expected: usize,
        /// The values given.
        got: usize,
    },
    /// A value that is NaN or infinite.
    #[error("`{variable}` is not a finite number")]
    NotFinite {
        /// The variable.
        variable: String,
    },
    /// A value outside the range of its variable.
    #[error("`{variable}` is {value}, outside its range from {low} to {high}")]
    OutOfRange {
        /// The variable.
        variable: String,
        /// The value.
        value: f64,
        /// The lower end of the range.
        low: f64,
        /// The upper end of the range.
        high: f64,
    },
    /// A value that belongs to no term.
    #[error("`{variable}` is {value}, which belongs to none of its terms")]
    NoTerm {
        /// The variable.
        variable: String,
        /// The value.
        value: f64,
    },
    /// A weight that is not a finite number above 0.
    #[error("the weight {weight} is not a finite number above 0")]
    Weight {
        /// The weight.
        weight: f64,
    },
}
