//! The native half of the Python package `flagred`: it converts types and calls the libraries.
//!
//! The other half, `python/flagred`, holds what is plain Python: data classes, errors, views for editing, other libraries'
//! frames.

mod arrays;
mod arrow;
mod errors;
mod evaluate;
mod explanation;
mod map;
mod outcome;
mod rule_set;
mod table;
mod threads;

#[pyo3::pymodule]
mod _core {
    #[pymodule_export]
    use crate::{
        explanation::{ExplainedInput, ExplainedOutput, Explanation, FiredRule, Share},
        map::DecisionMap,
        outcome::{Outcome, Outcomes},
        rule_set::RuleSet,
        table::Table,
    };

    #[pymodule_export]
    const VERSION: &str = env!("CARGO_PKG_VERSION");
}
