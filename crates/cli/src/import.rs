//! `flagred import`: converts a rule set of another program to YAML.

use std::path::{Path, PathBuf};

use flagred_interchange::{Format, Losses};
use fuzzy::Findings;

use crate::{
    diagnostics::{is_meant_as_rules, read_text, refuse, show},
    failure::{Exit, Failure},
    output::{self, Files, Replace},
};

#[derive(clap::Args)]
pub(crate) struct Arguments {
    /// Rule set in FIS, FLL, FCL or FML, recognised by its content; `-` is standard input
    #[arg(value_name = "FILE")]
    file: PathBuf,
    /// The file to write; `-` is standard output [default: -]
    #[arg(short, long, value_name = "OUT.yaml", default_value = "-", hide_default_value = true, value_parser = output::rules_path)]
    output: PathBuf,
    /// Replace the file if it exists
    #[arg(long)]
    force: bool,
    /// The function block to read from an FCL file with several
    #[arg(long, value_name = "NAME")]
    block: Option<String>,
    /// Leave out what a rule set cannot express, including whole rules; results may differ
    #[arg(long)]
    lossy: bool,
}

pub(crate) fn run(arguments: &Arguments) -> Result<Exit, Failure> {
    let replace = Replace::forced(arguments.force);
    let output = Files::reading([&arguments.file])?.output(&arguments.output, replace)?;
    let text = read_text(&arguments.file)?;
    let file = arguments.file.display().to_string();
    let Some(format) = Format::of(&text) else {
        let advice = advice(&arguments.file, &text);
        if let (None, Some(finding)) = (advice, fuzzy::yaml::foreign(&text)) {
            return Err(refuse(
                &Findings::locate(vec![finding], &text),
                &file,
                &text,
            ));
        }
        let failure = Failure::unreadable(format!("`{file}` is not a FIS, FLL, FCL or FML file"));
        return Err(failure.help_if(advice));
    };
    let losses = match arguments.lossy {
        true => Losses::Accept,
        false => Losses::Refuse,
    };
    let read = match &arguments.block {
        None => flagred_interchange::read(&text, format, losses),
        Some(name) if format == Format::Fcl => flagred_interchange::read_block(&text, name, losses),
        Some(_) => {
            let message = format!("`--block` is for FCL, but `{file}` is {}", format.name());
            return Err(Failure::usage(message));
        }
    };
    let document = read.map_err(|findings| refuse(&findings, &file, &text))?;
    show(&document.warnings, &file, &text);
    let validated = document.validate(&text);
    validated.map_err(|findings| refuse(&findings, &file, &text))?;
    output.write(&fuzzy::yaml::to_string(&document.model))?;
    Ok(Exit::Clean)
}

/// Advice for a file that is not in the format of another program.
fn advice(path: &Path, text: &str) -> Option<&'static str> {
    let is = |ending: &str| {
        path.extension()
            .is_some_and(|found| found.eq_ignore_ascii_case(ending))
    };
    if is_meant_as_rules(text) {
        return Some("a rule set in YAML needs no import");
    }
    let is_script = ["mamfis", "sugfis", "newfis"]
        .iter()
        .any(|call| text.contains(call));
    if is("m") || is("mat") || is_script {
        return Some("in MATLAB, `writeFIS(fis, \"name\")` writes `name.fis`; import that file");
    }
    is("py").then_some(
        "docs/from-scikit-fuzzy.md shows how to write a model of scikit-fuzzy as a rule set",
    )
}
