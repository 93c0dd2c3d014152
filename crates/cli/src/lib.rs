//! The `flagred` command: assess flights; author, check and explain fuzzy rule sets.
//!
//! Each command has its own file; this one parses the command line and dispatches.

mod advice;
mod assess;
mod built_in;
mod check;
mod completions;
mod convert;
mod dataset;
mod diagnostics;
mod eval;
mod explain;
mod export;
mod failure;
mod flights;
mod fmt;
#[doc(hidden)] // For fuzz targets and tests of other packages.
pub mod fuzzing;
mod held_out;
mod help;
mod identify;
mod import;
mod inspect;
mod learn;
mod lsp;
mod man;
mod map;
mod new;
mod numbers;
mod output;
mod parallel;
mod path;
mod plot;
mod profile;
mod provenance;
mod range;
mod rows;
mod rule_set;
mod schema;
mod show;
mod simplify;
mod studio;
mod table;
mod tune;
mod validate;
mod watch;

#[doc(hidden)] // For the Python package.
pub use export::{Language, export_profile, export_rules};
#[doc(hidden)] // For the types of the npm package.
pub use schema::npm_types;

use std::{
    ffi::OsString,
    io::{self, Write as _},
};

use clap::{CommandFactory, FromArgMatches, Parser, Subcommand};
use failure::{Exit, Failure};

/// Estimates the risk that a multirotor loses control, from its motor commands; checks, explains
/// and learns fuzzy rule sets.
///
/// Exit codes: 0 done; 1 done, with findings (the help of a command names them); 2 wrong usage, or an output cannot be written;
/// 3 no answer: the input cannot be read or used.
#[derive(Parser)]
#[command(name = "flagred", version, max_term_width = 100, after_help = help::FLAGRED)]
struct Arguments {
    #[command(subcommand)]
    command: Command,
}

#[derive(Subcommand)]
enum Command {
    /// Assess the risk of a flight: verdict, findings, risk over time
    #[command(after_help = help::ASSESS)]
    Assess(assess::Arguments),
    /// Assess a flight live over MAVLink and send warnings to the ground station
    #[command(after_help = help::WATCH)]
    Watch(watch::Arguments),
    /// Show the contents of a flight log and the source of each value
    #[command(after_help = help::INSPECT)]
    Inspect(inspect::Arguments),
    /// Convert a flight log to flight CSV
    #[command(after_help = help::CONVERT)]
    Convert(convert::Arguments),
    /// Write a commented rule set or profile to start from
    #[command(after_help = help::NEW)]
    New(new::Arguments),
    /// Print a built-in profile or rule set with its comments
    #[command(after_help = help::SHOW)]
    Show(show::Arguments),
    /// Find errors, gaps and conflicts in rule sets and profiles
    #[command(after_help = help::CHECK)]
    Check(check::Arguments),
    /// Explain the outputs of a rule set at a point: degrees, rules, result, what would change it
    #[command(after_help = help::EXPLAIN)]
    Explain(explain::Arguments),
    /// Evaluate a rule set at the points of a CSV file
    #[command(after_help = help::EVAL)]
    Eval(eval::Arguments),
    /// Format rule sets and profiles in place; comments stay
    #[command(after_help = help::FMT)]
    Fmt(fmt::Arguments),
    /// Serve an editor: findings, completion, renaming and more for rule sets and profiles (language server protocol)
    #[command(after_help = help::LSP)]
    Lsp(lsp::Arguments),
    /// Open the studio, a page in the browser: look into flights, edit a rule set and see its map change
    #[command(after_help = help::STUDIO)]
    Studio(studio::Arguments),
    /// Draw or tabulate the output of a rule set over its inputs, or compare it with a table
    #[command(after_help = help::MAP)]
    Map(map::Arguments),
    /// Draw the terms of every variable of a rule set
    #[command(after_help = help::PLOT)]
    Plot(plot::Arguments),
    /// Make a table of flights for `learn`: their inputs, attitude errors and risks
    #[command(after_help = help::DATASET)]
    Dataset(dataset::Arguments),
    /// Find inputs, partitions and rules for a column of a table
    #[command(after_help = help::IDENTIFY)]
    Identify(identify::Arguments),
    /// Learn rules from a table of inputs and outputs
    #[command(after_help = help::LEARN)]
    Learn(learn::Arguments),
    /// Move membership functions, consequents and weights of a rule set to fit a table of inputs and outputs
    #[command(after_help = help::TUNE)]
    Tune(tune::Arguments),
    /// Simplify a rule set: fewer rules and inputs, nearly the same outputs
    #[command(after_help = help::SIMPLIFY)]
    Simplify(simplify::Arguments),
    /// Measure how well profiles predict attitude errors, compared with simple baselines
    #[command(after_help = help::VALIDATE)]
    Validate(validate::Arguments),
    /// The earlier name of `validate`
    #[command(after_help = help::VALIDATE, hide = true)]
    Evaluate(validate::Arguments),
    /// Convert a rule set of another program (FIS, FLL, FCL, FML) to YAML
    #[command(after_help = help::IMPORT)]
    Import(import::Arguments),
    /// Export a profile or rule set as code (Rust, C, Lua), or a rule set for another program (FIS, FLL, FCL, FML)
    #[command(after_help = help::EXPORT)]
    Export(export::Arguments),
    /// Print the JSON Schema of a format: rule set, profile, or what a command prints
    #[command(after_help = help::SCHEMA)]
    Schema(schema::Arguments),
    /// Print completions for a shell
    #[command(after_help = help::COMPLETIONS)]
    Completions(completions::Arguments),
    /// Print a manual page
    #[command(after_help = help::MAN)]
    Man(man::Arguments),
}

impl Command {
    fn run(self) -> Result<Exit, Failure> {
        match self {
            Command::Assess(arguments) => assess::run(&arguments),
            Command::Watch(arguments) => watch::run(&arguments),
            Command::Inspect(arguments) => inspect::run(&arguments),
            Command::Convert(arguments) => convert::run(&arguments),
            Command::New(arguments) => new::run(&arguments),
            Command::Show(arguments) => show::run(&arguments),
            Command::Check(arguments) => check::run(&arguments),
            Command::Explain(arguments) => explain::run(&arguments),
            Command::Eval(arguments) => eval::run(&arguments),
            Command::Fmt(arguments) => fmt::run(&arguments),
            Command::Lsp(arguments) => lsp::run(&arguments),
            Command::Studio(arguments) => studio::run(&arguments),
            Command::Map(arguments) => map::run(&arguments),
            Command::Plot(arguments) => plot::run(&arguments),
            Command::Dataset(arguments) => dataset::run(&arguments),
            Command::Identify(arguments) => identify::run(&arguments),
            Command::Learn(arguments) => learn::run(&arguments),
            Command::Tune(arguments) => tune::run(&arguments),
            Command::Simplify(arguments) => simplify::run(&arguments),
            Command::Validate(arguments) => validate::run(&arguments),
            Command::Evaluate(arguments) => {
                arguments.are_flights()?;
                output::print_note(
                    "note: `evaluate` is called `validate` now; the old name is removed in the next release",
                );
                validate::run(&arguments)
            }
            Command::Import(arguments) => import::run(&arguments),
            Command::Export(arguments) => export::run(&arguments),
            Command::Schema(arguments) => schema::run(&arguments),
            Command::Completions(arguments) => completions::run(&arguments),
            Command::Man(arguments) => man::run(&arguments),
        }
    }
}

/// Rewrites `flagred help --help` to `flagred help help`.
fn help_of_help(arguments: impl Iterator<Item = OsString>) -> Vec<OsString> {
    let mut arguments: Vec<OsString> = arguments.collect();
    if let [_, command, option, ..] = arguments.as_mut_slice()
        && command == "help"
        && (option == "--help" || option == "-h")
    {
        *option = "help".into();
    }
    arguments
}

/// Returns the definition of the command line. Options accept `-1` as a value, because their parsers report a better
/// error than clap.
fn program() -> clap::Command {
    Arguments::command().mut_subcommands(|subcommand| {
        subcommand.mut_args(|argument| {
            let takes_value = argument.get_action().takes_values() && !argument.is_positional();
            argument.allow_negative_numbers(takes_value)
        })
    })
}

fn parse(arguments: &[OsString]) -> Result<Arguments, clap::Error> {
    let mut command = program();
    let parsed = command.try_get_matches_from_mut(arguments);
    let parsed = parsed.and_then(|matches| {
        Arguments::from_arg_matches(&matches).map_err(|error| error.format(&mut command))
    });
    parsed.map_err(|mut error| {
        advice::improve(&mut error, &command, arguments);
        error
    })
}

/// Runs a command line, which begins with the name of the program, and returns its exit code.
pub fn run(arguments: impl Iterator<Item = OsString>) -> u8 {
    let arguments = help_of_help(arguments);
    let code = match parse(&arguments) {
        Ok(parsed) => {
            let done = match advice::file_behind_switch(&program(), &arguments) {
                Some(failure) => Err(failure),
                None => parsed.command.run(),
            };
            done.map_or_else(Failure::report, Exit::code)
        }
        Err(error) => {
            let other = || advice::other_command(&error, &arguments);
            match failure::command_forgotten(&error).or_else(other) {
                Some(failure) => failure.report(),
                None => failure::refuse(&error),
            }
        }
    };
    // A process that is not a Rust program, such as Python, does not flush Rust's buffer when it ends. An error of this
    // flush cannot be reported any more.
    let _ = io::stdout().flush();
    code
}
