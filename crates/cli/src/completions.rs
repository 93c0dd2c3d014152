//! `flagred completions`: what a shell needs to complete command lines.

use std::io::Write as _;

use clap::CommandFactory;
use clap_complete::Shell;

use crate::{
    failure::{Exit, Failure},
    output::Stdout,
};

#[derive(clap::Args)]
pub(crate) struct Arguments {
    /// The shell
    #[arg(value_enum)]
    shell: Shell,
}

pub(crate) fn run(arguments: &Arguments) -> Result<Exit, Failure> {
    let mut script = Vec::new();
    clap_complete::generate(
        arguments.shell,
        &mut crate::Arguments::command(),
        "flagred",
        &mut script,
    );
    let mut out = Stdout::data();
    out.write_all(&script)?;
    out.finish()?;
    Ok(Exit::Clean)
}
