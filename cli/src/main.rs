//! The `flagred` command: assess flights; author, check and explain fuzzy rule sets.
//!
//! One file per command; this one only reads the command line and dispatches.

mod assess;
mod check;
mod convert;
mod dataset;
mod diagnostics;
mod eval;
mod evaluate;
mod explain;
mod failure;
mod inspect;
mod learn;
mod map;
mod new;
mod output;
mod parallel;
mod profile;
mod report;
mod rule_set;
mod samples;
mod table;

use std::process::ExitCode;

use clap::{Parser, Subcommand};
use failure::{Exit, Failure};

/// Tells from motor commands alone how close a multirotor is to losing it, and serves the authors of fuzzy rule sets.
///
/// Exit codes: 0 nothing found, 1 findings, 2 wrong usage, 3 unreadable or not a multirotor.
#[derive(Parser)]
#[command(name = "flagred", version, max_term_width = 100)]
struct Arguments {
    #[command(subcommand)]
    command: Command,
}

#[derive(Subcommand)]
enum Command {
    /// Say how risky a flight was: verdict, findings, risk over time
    Assess(assess::Arguments),
    /// Say what is wrong with a rule set, and what its author should know about it
    Check(check::Arguments),
    /// Write a flight log as flight CSV
    Convert(convert::Arguments),
    /// Evaluate a rule set at the points of a CSV file
    Eval(eval::Arguments),
    /// Say why the outputs of a rule set are what they are
    Explain(explain::Arguments),
    /// Turn flights into rows to learn from: inputs, attitude error, risk
    Dataset(dataset::Arguments),
    /// Measure how well profiles tell what comes, beside predictors that need no rules
    Evaluate(evaluate::Arguments),
    /// Show what is in a flight log, and where each value came from
    Inspect(inspect::Arguments),
    /// Learn the rules of a rule set from rows of data
    Learn(learn::Arguments),
    /// Draw what a rule set decides over its inputs
    Map(map::Arguments),
    /// Write a rule set to start from
    New(new::Arguments),
}

impl Command {
    fn run(self) -> Result<Exit, Failure> {
        match self {
            Command::Assess(arguments) => assess::run(&arguments),
            Command::Check(arguments) => check::run(&arguments),
            Command::Convert(arguments) => convert::run(&arguments),
            Command::Eval(arguments) => eval::run(&arguments),
            Command::Explain(arguments) => explain::run(&arguments),
            Command::Dataset(arguments) => dataset::run(&arguments),
            Command::Evaluate(arguments) => evaluate::run(&arguments),
            Command::Inspect(arguments) => inspect::run(&arguments),
            Command::Learn(arguments) => learn::run(&arguments),
            Command::Map(arguments) => map::run(&arguments),
            Command::New(arguments) => new::run(&arguments),
        }
    }
}

fn main() -> ExitCode {
    match Arguments::parse().command.run() {
        Ok(exit) => exit.into(),
        Err(failure) => failure.report(),
    }
}
