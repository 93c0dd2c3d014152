//! `flagred new`: a commented rule set to start from.

use std::{
    fs::OpenOptions,
    io::{self, Write},
    path::PathBuf,
};

use crate::failure::{Exit, Failure};

#[derive(clap::Args)]
pub(crate) struct Arguments {
    /// The name of the rule set and of the file NAME.yaml
    #[arg(value_name = "NAME", value_parser = name)]
    name: String,
    /// The file to write [default: NAME.yaml]; `-` is standard output
    #[arg(long, short, value_name = "FILE")]
    output: Option<PathBuf>,
}

/// A name that is a file name everywhere and needs no quotes in YAML.
fn name(text: &str) -> Result<String, String> {
    let plain = |c: char| c.is_ascii_alphanumeric() || matches!(c, '-' | '_');
    if text.starts_with(|c: char| c.is_ascii_alphabetic()) && text.chars().all(plain) {
        Ok(text.into())
    } else {
        Err("a name is a letter followed by letters, digits, `-` and `_`".into())
    }
}

const STARTER: &str = include_str!("new.yaml");

pub(crate) fn run(arguments: &Arguments) -> Result<Exit, Failure> {
    let text = STARTER.replace("my-rules", &arguments.name);
    let path = match &arguments.output {
        Some(path) => path.clone(),
        None => PathBuf::from(format!("{}.yaml", arguments.name)),
    };
    if path.as_os_str() == "-" {
        anstream::stdout().lock().write_all(text.as_bytes())?;
        return Ok(Exit::Clean);
    }
    let shown = path.display();
    // An existing file is never overwritten.
    let file = OpenOptions::new().write(true).create_new(true).open(&path);
    let mut file = file.map_err(|error| match error.kind() {
        io::ErrorKind::AlreadyExists => Failure::usage(format!("`{shown}` exists already"))
            .help("choose another name, or another file with `--output`"),
        _ => Failure::unreadable(format!("`{shown}` cannot be written: {error}")),
    })?;
    file.write_all(text.as_bytes())
        .map_err(|error| Failure::unreadable(format!("`{shown}` cannot be written: {error}")))?;
    let mut out = anstream::stdout().lock();
    writeln!(out, "wrote {shown}; edit it, then try:")?;
    writeln!(out, "  flagred check {shown}")?;
    writeln!(out, "  flagred explain {shown} temperature=24 humidity=70")?;
    Ok(Exit::Clean)
}
