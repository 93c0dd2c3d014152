//! The `flagred` command: assess flights; author, check and explain fuzzy rule sets.
//!
//! One file per command; this one only reads the command line and dispatches.

mod assess;
mod assessment;
mod check;
mod completions;
mod convert;
mod dataset;
mod diagnostics;
mod eval;
mod evaluate;
mod explain;
mod export;
mod failure;
mod help;
mod inspect;
mod learn;
mod man;
mod map;
mod new;
mod output;
mod parallel;
mod profile;
mod report;
mod rule_set;
mod samples;
mod table;
mod watch;

use std::process::ExitCode;

use clap::{Parser, Subcommand};
use failure::{Exit, Failure};

/// Tells from motor commands alone how close a multirotor is to losing it, and serves the authors of fuzzy rule sets.
///
/// Exit codes: 0 nothing found, 1 findings, 2 wrong usage, 3 unreadable or not a multirotor.
#[derive(Parser)]
#[command(name = "flagred", version, max_term_width = 100, after_help = help::FLAGRED)]
struct Arguments {
    #[command(subcommand)]
    command: Command,
}

#[derive(Subcommand)]
enum Command {
    /// Say how risky a flight was: verdict, findings, risk over time
    #[command(after_help = help::ASSESS)]
    Assess(assess::Arguments),
    /// Say what is wrong with a rule set, and what its author should know about it
    #[command(after_help = help::CHECK)]
    Check(check::Arguments),
    /// Write a flight log as flight CSV
    #[command(after_help = help::CONVERT)]
    Convert(convert::Arguments),
    /// Write completions for a shell
    #[command(after_help = help::COMPLETIONS)]
    Completions(completions::Arguments),
    /// Evaluate a rule set at the points of a CSV file
    #[command(after_help = help::EVAL)]
    Eval(eval::Arguments),
    /// Say why the outputs of a rule set are what they are
    #[command(after_help = help::EXPLAIN)]
    Explain(explain::Arguments),
    /// Write a profile and its rule set as constant data, to fly on board
    #[command(after_help = help::EXPORT)]
    Export(export::Arguments),
    /// Turn flights into rows to learn from: inputs, attitude error, risk
    #[command(after_help = help::DATASET)]
    Dataset(dataset::Arguments),
    /// Measure how well profiles tell what comes, beside predictors that need no rules
    #[command(after_help = help::EVALUATE)]
    Evaluate(evaluate::Arguments),
    /// Show what is in a flight log, and where each value came from
    #[command(after_help = help::INSPECT)]
    Inspect(inspect::Arguments),
    /// Learn the rules of a rule set from rows of data
    #[command(after_help = help::LEARN)]
    Learn(learn::Arguments),
    /// Draw what a rule set decides over its inputs
    #[command(after_help = help::MAP)]
    Map(map::Arguments),
    /// Print the manual
    #[command(after_help = help::MAN)]
    Man(man::Arguments),
    /// Say how risky a flight is while it is flown, to you and to the ground station
    #[command(after_help = help::WATCH)]
    Watch(watch::Arguments),
    /// Write a rule set to start from
    #[command(after_help = help::NEW)]
    New(new::Arguments),
}

impl Command {
    fn run(self) -> Result<Exit, Failure> {
        match self {
            Command::Assess(arguments) => assess::run(&arguments),
            Command::Check(arguments) => check::run(&arguments),
            Command::Convert(arguments) => convert::run(&arguments),
            Command::Completions(arguments) => completions::run(&arguments),
            Command::Eval(arguments) => eval::run(&arguments),
            Command::Explain(arguments) => explain::run(&arguments),
            Command::Export(arguments) => export::run(&arguments),
            Command::Dataset(arguments) => dataset::run(&arguments),
            Command::Evaluate(arguments) => evaluate::run(&arguments),
            Command::Inspect(arguments) => inspect::run(&arguments),
            Command::Learn(arguments) => learn::run(&arguments),
            Command::Map(arguments) => map::run(&arguments),
            Command::Man(arguments) => man::run(&arguments),
            Command::Watch(arguments) => watch::run(&arguments),
            Command::New(arguments) => new::run(&arguments),
        }
    }
}

fn main() -> ExitCode {
    let ran = match Arguments::try_parse() {
        Ok(arguments) => arguments.command.run(),
        Err(error) => match failure::command_forgotten(&error) {
            Some(failure) => Err(failure),
            None => error.exit(),
        },
    };
    match ran {
        Ok(exit) => exit.into(),
        Err(failure) => failure.report(),
    }
}
