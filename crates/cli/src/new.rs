//! `flagred new`: a commented rule set or profile to start from.

use std::{io::Write, path::PathBuf};

use flagred_authoring::starter;
use fuzzy::drawing::visible;

use crate::{
    built_in,
    failure::{Exit, Failure},
    output::{Files, Replace, Stdout},
    profile,
};

#[derive(clap::Args)]
pub(crate) struct Arguments {
    /// The name of the rule set or profile, and of the file NAME.yaml
    #[arg(value_name = "NAME", value_parser = name)]
    name: String,
    /// The file to write [default: NAME.yaml]; `-` is standard output
    #[arg(long, short, value_name = "FILE")]
    output: Option<PathBuf>,
    /// Write a profile instead of a rule set: a copy of the default profile with its comments
    #[arg(long)]
    profile: bool,
    /// Copy this built-in rule set or profile: `flagred`, `flagred-battery` or `flagred-paper`
    #[arg(long, value_name = "BUILT-IN", value_parser = built_in::name)]
    from: Option<String>,
    /// Replace the file if it exists
    #[arg(long)]
    force: bool,
}

fn name(text: &str) -> Result<String, String> {
    match starter::is_name(text) {
        true => Ok(text.into()),
        false => Err("a name is a letter followed by letters, digits, `-` and `_`".into()),
    }
}

pub(crate) fn run(arguments: &Arguments) -> Result<Exit, Failure> {
    let from = arguments.from.as_deref();
    let text = match arguments.profile {
        true => {
            let from = built_in::profile(from.unwrap_or(profile::DEFAULT))?;
            starter::profile(&arguments.name, from)
        }
        false => match from {
            Some(from) => starter::renamed(&arguments.name, built_in::rule_set(from)?),
            None => starter::rules(&arguments.name),
        },
    };
    let path = match &arguments.output {
        Some(path) => path.clone(),
        None => PathBuf::from(format!("{}.yaml", arguments.name)),
    };
    let mut files = Files::reading::<PathBuf>([])?;
    let output = files.output(&path, Replace::forced(arguments.force))?;
    output.write(&text)?;
    if !output.is_stdout() {
        let shown = path.display().to_string();
        let shown = visible(&shown);
        let mut out = Stdout::text();
        writeln!(out, "wrote {shown}; edit it, then try:")?;
        writeln!(out, "  flagred check {shown}")?;
        match arguments.profile {
            true => writeln!(out, "  flagred assess --profile {shown} flight.bin")?,
            false if from.is_some() => writeln!(out, "  flagred map {shown}")?,
            false => writeln!(out, "  flagred explain {shown} temperature=24 humidity=70")?,
        }
        out.finish()?;
    }
    Ok(Exit::Clean)
}
