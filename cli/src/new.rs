//! `flagred new`: a commented rule set or profile to start from.

use std::{io::Write, path::PathBuf};

use authoring::starter;
use fuzzy::drawing::visible;

use crate::{
    failure::{Exit, Failure},
    output::{Files, Replace, Stdout},
};

#[derive(clap::Args)]
pub(crate) struct Arguments {
    /// The name of the rule set or profile, and of the file NAME.yaml
    #[arg(value_name = "NAME", value_parser = name)]
    name: String,
    /// The file to write [default: NAME.yaml]; `-` is standard output
    #[arg(long, short, value_name = "FILE")]
    output: Option<PathBuf>,
    /// Write a profile instead of a rule set
    #[arg(long)]
    profile: bool,
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
    let text = match arguments.profile {
        true => starter::profile(&arguments.name),
        false => starter::rules(&arguments.name),
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
            false => writeln!(out, "  flagred explain {shown} temperature=24 humidity=70")?,
        }
        out.finish()?;
    }
    Ok(Exit::Clean)
}
