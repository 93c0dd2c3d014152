//! The native half of the Python package `flagred`: it converts types and calls the libraries.
//!
//! The other half, `python/flagred`, contains plain Python: data classes, errors, views for editing, and frames of other
//! libraries.

mod arrays;
mod arrow;
mod assessment;
mod c_means;
mod command;
mod compiled;
mod errors;
mod evaluate;
mod evaluation;
mod explained_rows;
mod explanation;
mod flight;
mod identify;
mod learn;
mod map;
mod monitor;
mod outcome;
mod profile;
mod rows;
mod rule_set;
mod simplify;
mod source;
mod table;
mod threads;
mod tune;

#[pyo3::pymodule]
mod _core {
    #[pymodule_export]
    use crate::{
        assessment::{_page, AssessmentData},
        c_means::_c_means,
        command::_command,
        evaluation::EvaluationData,
        explanation::{ExplainedInput, ExplainedOutput, Explanation, FiredRule, Share},
        flight::FlightData,
        identify::_identify,
        learn::_learn,
        map::DecisionMap,
        monitor::{MonitorData, Update},
        outcome::{IntervalOutcome, Outcome, Outcomes},
        profile::{_built_in, Profile},
        rule_set::RuleSet,
        simplify::_simplify,
        table::Table,
        tune::_tune,
    };

    #[pymodule_export]
    const VERSION: &str = env!("CARGO_PKG_VERSION");
}
