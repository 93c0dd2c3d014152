//! `flagred fmt`: one layout for rule sets and profiles. Comments are kept.

use std::{io::Write, path::PathBuf};

use flagred_authoring::layout::{LayoutError, formatted};
use fuzzy::drawing::visible;

use crate::{
    built_in,
    diagnostics::{read_text, refuse},
    failure::{Exit, Failure},
    output::{Files, Replace, Stdout},
};

#[derive(clap::Args)]
pub(crate) struct Arguments {
    /// Rule sets or profiles in YAML; `-` is standard input, written to standard output
    #[arg(required = true, value_name = "FILE")]
    files: Vec<PathBuf>,
    /// Only list files that are not formatted, and exit with 1 if there are any
    #[arg(long)]
    check: bool,
}

pub(crate) fn run(arguments: &Arguments) -> Result<Exit, Failure> {
    let mut exit = Exit::Clean;
    let mut out = Stdout::text();
    for path in &arguments.files {
        let text =
            read_text(path).map_err(|failure| failure.help_if(built_in::help_to_edit(path)))?;
        let file = path.display().to_string();
        if let Some(format) = flagred_interchange::Format::of(&text) {
            let message = format!("`{file}` is {}, and only YAML is formatted", format.name());
            return Err(Failure::unreadable(message)
                .help(format!("`flagred import {file}` converts it to YAML")));
        }
        let formatted = formatted(&text).map_err(|why| match why {
            LayoutError::NotYaml(findings) => refuse(&findings, &file, &text),
            LayoutError::Foreign => {
                let message = format!("`{file}` is neither a rule set nor a profile");
                Failure::unreadable(message)
                    .help("a rule set begins with `fuzzy: 1`, a profile with `flagred: 1`")
            }
            LayoutError::Other(why) => {
                Failure::unreadable(format!("`{file}` cannot be formatted: {why}"))
                    .help("`flagred check` shows its errors")
            }
        })?;
        let is_stdin = file == "-";
        if arguments.check {
            if formatted != text {
                exit = Exit::Findings;
                writeln!(out, "{}: is not formatted", visible(&file))?;
            }
        } else if is_stdin {
            write!(out, "{formatted}")?;
        } else if formatted != text {
            let mut files = Files::reading::<PathBuf>([])?;
            files.output(path, Replace::Yes)?.write(&formatted)?;
        }
    }
    out.finish()?;
    Ok(exit)
}
