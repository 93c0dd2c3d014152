//! `flagred completions`: scripts with which a shell completes command lines.

use std::io::Write as _;

use clap::CommandFactory;
use clap_complete::Shell;

use crate::{
    built_in,
    failure::{Exit, Failure},
    output::Stdout,
};

#[derive(clap::Args)]
pub(crate) struct Arguments {
    /// The shell for which the script is printed
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
    let script = String::from_utf8_lossy(&script);
    out.write_all(with_built_in(arguments.shell, &script).as_bytes())?;
    out.finish()?;
    Ok(Exit::Clean)
}

/// Adds the names of built-in profiles to the script, as completions for `--profile`. This option takes names and
/// files, but clap's generator supports only one of the two.
fn with_built_in(shell: Shell, script: &str) -> String {
    let names: Vec<&str> = built_in::profile_names().collect();
    let names = names.join(" ");
    match shell {
        Shell::Bash => script.replace(
            "--profile)\n                    COMPREPLY=($(compgen -f \"${cur}\"))",
            &format!(
                "--profile)\n                    COMPREPLY=($(compgen -W \"{names}\" -- \"${{cur}}\") $(compgen -f \"${{cur}}\"))"
            ),
        ),
        Shell::Zsh => script.replace(
            ":NAME|FILE:_default",
            &format!(":NAME|FILE:{{ compadd {names}; _files }}"),
        ),
        Shell::Fish => {
            let is_profile = |line: &&str| line.contains(" -l profile ") && line.ends_with(" -r");
            let lines = script.lines().map(|line| match is_profile(&line) {
                true => format!("{line} -a \"{names}\"\n"),
                false => format!("{line}\n"),
            });
            lines.collect()
        }
        _ => script.to_owned(),
    }
}
