//! `flagred export`: a profile and its rule set as constant data, to fly on board.

use std::path::PathBuf;

use flagred::board::Plan;

use crate::{
    failure::{Exit, Failure},
    output, profile,
};

mod c;
mod rust;

#[derive(clap::Args)]
#[command(group = clap::ArgGroup::new("language").required(true))]
pub(crate) struct Arguments {
    /// Write Rust for the crate `flagred` with `default-features = false`
    #[arg(long, group = "language")]
    rust: bool,
    /// Write C for `flagred.h` and the library of `flagred-c`
    #[arg(long, group = "language")]
    c: bool,
    /// Profile: a built-in name or a file
    #[arg(value_name = "PROFILE", default_value = profile::DEFAULT)]
    profile: String,
    /// The file to write; `-` is standard output
    #[arg(short, long, value_name = "FILE", default_value = "-")]
    output: PathBuf,
}

pub(crate) fn run(arguments: &Arguments) -> Result<Exit, Failure> {
    let loaded = profile::load(&arguments.profile)?;
    let plan = loaded.estimator.plan().map_err(|error| {
        let rules = &loaded.estimator.profile().rules;
        Failure::unreadable(format!("rule set `{rules}`: {error}")).help(error.help())
    })?;
    let rules = &loaded.estimator.profile().rules;
    let signals = loaded.estimator.profile().signals();
    let text = if arguments.rust {
        rust::text(&plan, rules, &signals)
    } else {
        c::text(&plan, rules, &signals)
    };
    output::write(&arguments.output, &text)?;
    Ok(Exit::Clean)
}

/// What stands above the data, in words.
fn heading(plan: &Plan<'_>, rules: &str, signals: &[&str], option: &str) -> Vec<String> {
    let mut lines = vec![
        format!(
            "The profile `{}` with the rule set `{rules}`, written by `flagred export {option}` {}. Not to be edited.",
            plan.name,
            env!("CARGO_PKG_VERSION")
        ),
        format!(
            "{} bytes of constants, of which {} fill gaps of the rules; {} bytes of memory for a monitor of 4 motors.",
            bytes(plan),
            bytes_of_filling(plan),
            plan.bytes(4)
        ),
    ];
    if !signals.is_empty() {
        lines.push(format!(
            "Samples carry beside the motors, in this order: {}.",
            signals.join(", ")
        ));
    }
    lines
}

/// What fills gaps weighs.
fn bytes_of_filling(plan: &Plan<'_>) -> usize {
    plan.filled.map_or(0, |filled| {
        size_of_val(filled.places)
            + size_of_val(filled.starts)
            + size_of_val(filled.values)
            + size_of_val(filled.distances)
    })
}

/// All arrays of a plan weigh.
fn bytes(plan: &Plan<'_>) -> usize {
    let table = &plan.table;
    [
        size_of_val(plan),
        size_of_val(table.inputs),
        size_of_val(table.cuts),
        size_of_val(table.starts),
        size_of_val(table.lines),
        size_of_val(table.curves),
        size_of_val(table.points),
        size_of_val(table.hedges),
        size_of_val(table.axes),
        size_of_val(table.dimensions),
        size_of_val(table.cells),
        size_of_val(table.nodes),
        size_of_val(table.edges),
        size_of_val(table.actions),
        size_of_val(table.programs),
        size_of_val(table.steps),
        size_of_val(table.outputs),
        size_of_val(table.pairs),
        size_of_val(table.moments),
        size_of_val(table.consequences),
        size_of_val(table.coefficients),
        size_of_val(plan.order),
        size_of_val(plan.channels),
        size_of_val(plan.inputs),
        bytes_of_filling(plan),
    ]
    .iter()
    .sum()
}

/// Items in lines of no more than about a hundred characters.
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
