//! `flagred show`: prints a built-in profile or rule set as it is written, with its comments.

use std::io::Write;

use crate::{
    built_in,
    failure::{Exit, Failure},
    output::Stdout,
};

#[derive(clap::Args)]
pub(crate) struct Arguments {
    /// The name of a built-in profile
    #[arg(value_name = "NAME", value_parser = built_in::names())]
    name: String,
    /// Print the rule set of the profile instead
    #[arg(long)]
    rules: bool,
}

pub(crate) fn run(arguments: &Arguments) -> Result<Exit, Failure> {
    let shown = match arguments.rules {
        true => built_in::rule_set(&arguments.name)?,
        false => built_in::profile(&arguments.name)?,
    };
    let mut out = Stdout::data();
    write!(out, "{}", shown.text)?;
    out.finish()?;
    Ok(Exit::Clean)
}
