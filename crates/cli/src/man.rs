//! `flagred man`: the manual, generated from the same definitions as the help.

use std::{fs, io::Write as _, path::PathBuf};

use clap::{Command, CommandFactory};

use crate::{
    failure::{Exit, Failure},
    output::{Files, Replace, Stdout},
};

#[derive(clap::Args)]
pub(crate) struct Arguments {
    /// The command whose page is printed [default: flagred itself]
    #[arg(value_name = "COMMAND")]
    command: Option<String>,
    /// Write all pages to this folder instead
    #[arg(long, value_name = "FOLDER", conflicts_with = "command")]
    folder: Option<PathBuf>,
}

pub(crate) fn run(arguments: &Arguments) -> Result<Exit, Failure> {
    let mut flagred = crate::Arguments::command().propagate_version(true);
    // Sets the names of the pages, such as flagred-assess.
    flagred.build();
    let commands = || {
        let commands = flagred.get_subcommands();
        commands.filter(|command| command.get_name() != "help" && !command.is_hide_set())
    };
    if let Some(folder) = &arguments.folder {
        fs::create_dir_all(folder).map_err(|error| {
            let shown = folder.display();
            match folder.is_file() {
                true => Failure::usage(format!("`{shown}` is a file, not a folder")),
                false => Failure::usage(format!("`{shown}` cannot be made: {error}")),
            }
        })?;
        let mut files = Files::reading::<PathBuf>([])?;
        for command in std::iter::once(&flagred).chain(commands()) {
            let page = page(command)?;
            let name = command
                .get_display_name()
                .unwrap_or_else(|| command.get_name());
            let output = files.output(&folder.join(format!("{name}.1")), Replace::Yes)?;
            output.write(&page)?;
        }
        return Ok(Exit::Clean);
    }
    let command = match &arguments.command {
        None => &flagred,
        Some(name) => commands()
            .find(|command| command.get_name() == name)
            .ok_or_else(|| {
                let names: Vec<&str> = commands().map(Command::get_name).collect();
                Failure::usage(format!("there is no command `{name}`"))
                    .help(format!("the commands are {}", names.join(", ")))
            })?,
    };
    let page = page(command)?;
    let mut out = Stdout::data();
    out.write_all(page.as_bytes())?;
    out.finish()?;
    Ok(Exit::Clean)
}

/// Returns a page in the format of `man`.
fn page(command: &Command) -> Result<String, Failure> {
    let mut page = Vec::new();
    clap_mangen::Man::new(command.clone()).render(&mut page)?;
    Ok(String::from_utf8_lossy(&page).into_owned())
}
