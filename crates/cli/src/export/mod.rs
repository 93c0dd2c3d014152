//! `flagred export`: a profile and its rule set, or only a rule set, as constant data for firmware; or a rule set for
//! another program.

use std::{
    fmt::Debug,
    path::{Path, PathBuf},
};

use flagred::{
    board::{
        Plan, Rules,
        table::{self, Table},
    },
    estimator::Estimator,
    flight::Words,
    gap::FilledKnots,
    verdict::Measure,
};
use flagred_interchange::{Format, Losses};
use fuzzy::drawing::visible;

use crate::{
    diagnostics::is_meant_as_rules,
    failure::{Exit, Failure},
    output::{self, Files, Replace, print_note},
    profile, rule_set,
};

mod c;
mod lua;
mod rules;
mod rust;

#[derive(clap::Args)]
#[command(group = clap::ArgGroup::new("language").required(true))]
pub(crate) struct Arguments {
    /// Write Rust: a profile for the crate `flagred`, a rule set for `flagred-fuzzy`, both without their default features
    #[arg(long, group = "language")]
    rust: bool,
    /// Write C for `flagred.h` and the library of `flagred-c`
    #[arg(long, group = "language")]
    c: bool,
    /// Write a Lua script that ArduPilot runs from its memory card (docs/firmware.md)
    #[arg(long, group = "language")]
    lua: bool,
    /// Write a rule set as FIS, for MATLAB and Octave
    #[arg(long, group = "language")]
    fis: bool,
    /// Write a rule set as FLL, for fuzzylite
    #[arg(long, group = "language")]
    fll: bool,
    /// Write a rule set as FCL, for jFuzzyLogic and other IEC 61131-7 programs
    #[arg(long, group = "language")]
    fcl: bool,
    /// Write a rule set as FML, for JFML and other IEEE 1855 programs
    #[arg(long, group = "language")]
    fml: bool,
    /// Leave out what the format cannot express, including whole rules (for Rust and C, also `samples`); results may
    /// differ
    #[arg(long, conflicts_with = "lua")]
    lossy: bool,
    /// The profile or rule set to export: `flagred`, `flagred-paper`, `flagred-battery`, or a file. `--lua` needs a profile,
    /// `--fis`, `--fll`, `--fcl` and `--fml` need a rule set
    #[arg(value_name = "FILE", default_value = profile::DEFAULT)]
    file: String,
    /// The file to write; `-` is standard output [default: -]
    #[arg(
        short,
        long,
        value_name = "FILE",
        default_value = "-",
        hide_default_value = true
    )]
    output: PathBuf,
    /// Replace the file if it exists; code (Rust, C, Lua) is replaced without this option
    #[arg(long)]
    force: bool,
}

pub(crate) fn run(arguments: &Arguments) -> Result<Exit, Failure> {
    arguments.check_ending()?;
    if let Some(format) = arguments.format() {
        return to_program(arguments, format);
    }
    let path = Path::new(&arguments.file);
    let loaded = if arguments.lua || profile::is_shipped(&arguments.file) {
        profile::load(&arguments.file)?
    } else {
        let source = flagred_interchange::source(profile::file_text(path)?);
        if is_meant_as_rules(source.text()) && !flagred_authoring::is_profile(&source) {
            return rules::export(arguments, &source);
        }
        profile::from_source(path, source)?
    };
    if arguments.lossy {
        return Err(Failure::usage(
            "`--lossy` is for rule sets, but this is a profile",
        ));
    }
    let output = Files::reading(&loaded.files)?.output(&arguments.output, Replace::Yes)?;
    output.write(&profile_code(&loaded.estimator, arguments.language())?)?;
    arguments.note_built_in("profile");
    Ok(Exit::Clean)
}

/// The language of exported code.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Language {
    /// Constants for the crate `flagred` or `flagred-fuzzy`.
    Rust,
    /// Constants for `flagred.h`.
    C,
    /// A script for ArduPilot.
    Lua,
}

/// Returns a profile and its rule set as code.
pub(crate) fn profile_code(estimator: &Estimator, language: Language) -> Result<String, Failure> {
    let profile = estimator.profile();
    let plan = estimator.plan().map_err(|error| {
        Failure::unreadable(format!("rule set `{}`: {error}", profile.rules)).help(error.help())
    })?;
    let signals = profile.signals();
    let words = FindingWords::of(estimator);
    match language {
        Language::Rust => Ok(rust::text(&plan, &profile.rules, &signals, &words)),
        Language::C => Ok(c::text(&plan, &profile.rules, &signals, &words)),
        Language::Lua => lua::text(estimator, &plan)
            .map_err(|refused| Failure::unreadable(refused.message).help(refused.help)),
    }
}

/// Exports a profile, like `flagred export`. An error has its help on a second line.
pub fn export_profile(estimator: &Estimator, language: Language) -> Result<String, String> {
    profile_code(estimator, language).map_err(|failure| failure.to_string())
}

/// Exports a rule set, like `flagred export`, and returns the code and the warnings. An error has its help on a second
/// line.
pub fn export_rules(
    model: &fuzzy::Model,
    language: Language,
    lossy: bool,
) -> Result<(String, Vec<String>), String> {
    rules::code((model, &model.name), language, lossy).map_err(|failure| failure.to_string())
}

impl Arguments {
    /// Refuses an output file with the extension of another format, so that a rule set named by mistake is not replaced.
    fn check_ending(&self) -> Result<(), Failure> {
        let (what, endings): (&str, &[&str]) = match self.format() {
            Some(Format::Fis) => ("FIS", &["fis", "t2fis"]),
            Some(Format::Fll) => ("FLL", &["fll"]),
            Some(Format::Fcl) => ("FCL", &["fcl"]),
            Some(Format::Fml) => ("FML", &["xml", "fml"]),
            None => match self.language() {
                Language::Rust => ("Rust", &["rs"]),
                Language::C => ("C", &["h", "c"]),
                Language::Lua => ("Lua", &["lua"]),
            },
        };
        let text = self.output.to_string_lossy();
        let checked = output::path_of(&text, &format!("the output is {what}"), endings);
        checked.map(drop).map_err(|wrong| {
            Failure::usage(format!("`{text}` has the extension of another format")).help(wrong)
        })
    }

    /// Prints a note if the default profile or rule set was written to a file.
    fn note_built_in(&self, what: &str) {
        if self.file == profile::DEFAULT && self.output != Path::new("-") {
            let written = self.output.display();
            print_note(&format!(
                "wrote `{written}`: the built-in {what} `{}`",
                self.file
            ));
        }
    }

    /// Returns the language, if no other program's format was chosen.
    fn language(&self) -> Language {
        match (self.rust, self.c) {
            (true, _) => Language::Rust,
            (_, true) => Language::C,
            _ => Language::Lua,
        }
    }

    /// Returns the other program's format, if one was chosen.
    fn format(&self) -> Option<Format> {
        let chosen = [self.fis, self.fll, self.fcl, self.fml];
        let mut formats = Format::ALL.into_iter().zip(chosen);
        formats
            .find(|(_, chosen)| *chosen)
            .map(|(format, _)| format)
    }
}

/// Writes a rule set for another program.
fn to_program(arguments: &Arguments, format: Format) -> Result<Exit, Failure> {
    let path = Path::new(&arguments.file);
    // The name of a built-in profile is also the name of its rule set.
    let source = rule_set::read(path)?;
    let model = rule_set::engine(&source, &arguments.file)?.model();
    let replace = Replace::forced(arguments.force);
    let output = Files::reading([path])?.output(&arguments.output, replace)?;
    let losses = match arguments.lossy {
        true => Losses::Accept,
        false => Losses::Refuse,
    };
    let print_findings =
        |findings: &fuzzy::Findings| findings.to_string().lines().for_each(print_note);
    match flagred_interchange::write(model, format, losses) {
        Ok(written) => {
            print_findings(&written.findings);
            output.write(&written.text)?;
            arguments.note_built_in("rule set");
            Ok(Exit::Clean)
        }
        Err(findings) => {
            print_findings(&findings);
            let message = format!(
                "`{}` cannot be written as {}",
                arguments.file,
                format.name()
            );
            let failure = Failure::unreadable(message);
            let is_lossy = flagred_interchange::write(model, format, Losses::Accept).is_ok();
            Err(match is_lossy {
                true => failure.help("`--lossy` leaves out what the format cannot express"),
                false => failure,
            })
        }
    }
}

/// The texts of findings for pilots.
struct FindingWords {
    /// Texts for findings that an input caused: a row for each proposition of the plan.
    causes: Vec<Words>,
    /// Texts for the other findings: a row for each measure.
    notices: Vec<Words>,
}

impl FindingWords {
    fn of(estimator: &Estimator) -> FindingWords {
        let causes = estimator.propositions();
        let notices = Measure::ALL.into_iter();
        let notices = notices.map(|measure| Words::of_measure(estimator.profile(), measure));
        FindingWords {
            causes: causes
                .map(|(input, term)| Words::of_cause(estimator, input, term))
                .collect(),
            notices: notices.collect(),
        }
    }
}

/// Returns texts as string literals of Rust and C: code, brief, text and advice.
fn literals(words: &Words) -> [String; 4] {
    let Words {
        code,
        brief,
        text,
        advice,
    } = words;
    [code, &brief.concat(), text, advice].map(|text| format!("{:?}", visible(text)))
}

/// The comment above the data.
fn heading(plan: &Plan<'_>, rules: &str, signals: &[&str], option: &str) -> Vec<String> {
    let mut lines = vec![
        origin(plan, rules, option),
        format!(
            "{} bytes of constants, {} of them to fill gaps of the rules. A monitor of 4 motors takes {} bytes of memory.",
            bytes(plan),
            bytes_of_filling(plan),
            plan.bytes(4)
        ),
    ];
    if !signals.is_empty() {
        lines.push(format!(
            "Signals of a sample, in this order: {}.",
            signals.join(", ")
        ));
    }
    lines.into_iter().map(harmless).collect()
}

/// Makes a line safe inside a comment: a name in the line must not end the comment.
fn harmless(line: String) -> String {
    visible(&line).replace("*/", "* /")
}

/// Describes the source of an exported file.
fn origin(plan: &Plan<'_>, rules: &str, option: &str) -> String {
    format!(
        "The profile `{}` with the rule set `{rules}`, written by `flagred export {option}` {}. Do not edit.",
        plan.name,
        env!("CARGO_PKG_VERSION")
    )
}

/// An array of a plan, ready to print.
struct Array {
    field: &'static str,
    /// The type of its items.
    item: &'static str,
    bytes: usize,
    /// The debug form of each item.
    items: Vec<String>,
}

impl Array {
    fn new<T: Debug>(field: &'static str, item: &'static str, items: &[T]) -> Self {
        Array {
            field,
            item,
            bytes: size_of_val(items),
            items: items.iter().map(|item| format!("{item:?}")).collect(),
        }
    }
}

/// Returns the arrays of a table.
fn arrays(table: &Table<'_>) -> Vec<Array> {
    macro_rules! list {
        ($($(#[$doc:meta])* $array:ident: $item:ident,)*) => {
            vec![$(Array::new(stringify!($array), stringify!($item), table.$array)),*]
        };
    }
    table::arrays!(list!)
}

/// Returns the arrays of a filling.
fn filling(knots: &FilledKnots<'_>) -> [Array; 4] {
    [
        Array::new("coordinates", "f64", knots.coordinates),
        Array::new("starts", "u32", knots.starts),
        Array::new("values", "f64", knots.values),
        Array::new("distances", "f64", knots.distances),
    ]
}

/// The size of the constants that fill gaps, in bytes.
fn bytes_of_filling(plan: &Plan<'_>) -> usize {
    let arrays = plan.filled.as_ref().map(filling);
    arrays.iter().flatten().map(|array| array.bytes).sum()
}

/// The size of all constants, in bytes.
fn bytes(plan: &Plan<'_>) -> usize {
    let profile = size_of_val(plan.order)
        + size_of_val(plan.channels)
        + size_of_val(plan.inputs)
        + size_of_val(plan.propositions);
    size_of_val(plan) + bytes_of_rules(&plan.rules) + profile + bytes_of_filling(plan)
}

/// The size of the arrays of a rule set, in bytes.
fn bytes_of_rules(rules: &Rules<'_>) -> usize {
    let arrays = arrays(&rules.table);
    let table: usize = arrays.iter().map(|array| array.bytes).sum();
    table + size_of_val(rules.stages) + size_of_val(rules.indices)
}

/// Joins items into lines of about a hundred characters.
fn rows(items: &[String]) -> Vec<String> {
    let (mut row, mut rows) = (String::new(), Vec::new());
    for item in items {
        if !row.is_empty() && row.len() + item.len() > 100 {
            rows.push(std::mem::take(&mut row));
        }
        if !row.is_empty() {
            row.push(' ');
        }
        row.push_str(item);
        row.push(',');
    }
    rows.push(row);
    rows
}
