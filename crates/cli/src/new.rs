//! `flagred new`: writes a commented rule set or profile as a starting point.

use std::{io::Write, path::PathBuf};

use flagred_authoring::starter;
use fuzzy::drawing::visible;

use crate::{
    built_in,
    failure::{Exit, Failure},
    output::{self, Files, Replace, Stdout},
};

#[derive(clap::Args)]
pub(crate) struct Arguments {
    /// The name of the rule set or profile, and of the file NAME.yaml
    #[arg(value_name = "NAME", value_parser = name)]
    name: String,
    /// The file to write; `-` is standard output [default: NAME.yaml]
    #[arg(long, short, value_name = "OUT.yaml", value_parser = output::rules_path)]
    output: Option<PathBuf>,
    /// Write a profile: a copy of this built-in one with its comments
    #[arg(long, value_name = "BUILT-IN", value_parser = built_in::names(), conflicts_with = "from")]
    profile: Option<String>,
    /// Write a copy of this built-in rule set
    #[arg(long, value_name = "BUILT-IN", value_parser = built_in::names())]
    from: Option<String>,
    /// Replace the file if it exists
    #[arg(long)]
    force: bool,
}

fn name(text: &str) -> Result<String, String> {
    if starter::is_name(text) {
        return Ok(text.into());
    }
    let path = std::path::Path::new(text);
    let stem = path.file_stem().unwrap_or_default().to_string_lossy();
    let name = stem.to_lowercase().replace(' ', "-");
    let help = match starter::is_name(&name) {
        true if path.components().count() > 1 => {
            let file = path.with_extension("yaml");
            format!("; write `{name} -o {}`", file.display())
        }
        true => format!("; write `{name}`"),
        false => String::new(),
    };
    Err(format!(
        "a name is a letter followed by letters, digits, `-` and `_`{help}"
    ))
}

pub(crate) fn run(arguments: &Arguments) -> Result<Exit, Failure> {
    let text = match (&arguments.profile, &arguments.from) {
        (Some(profile), _) => starter::profile(&arguments.name, built_in::profile(profile)?),
        (None, Some(from)) => starter::renamed(&arguments.name, built_in::rule_set(from)?),
        (None, None) => starter::rules(&arguments.name),
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
        match (&arguments.profile, &arguments.from) {
            (Some(_), _) => writeln!(out, "  flagred assess --profile {shown} flight.bin")?,
            (None, Some(_)) => writeln!(out, "  flagred map {shown}")?,
            (None, None) => writeln!(out, "  flagred explain {shown} temperature=24 humidity=70")?,
        }
        out.finish()?;
    }
    Ok(Exit::Clean)
}
