//! `flagred explain`: how the outputs of a rule set come about at one point.

use std::{io::Write as _, path::PathBuf};

use flagred_authoring::answers::Explained;
use fuzzy::{
    Model,
    diagnostic::suggest,
    drawing::{explanation_svg, explanation_text},
};

use crate::{
    failure::{Exit, Failure},
    output::{self, Files, Stdout},
    rule_set,
};

#[derive(clap::Args)]
pub(crate) struct Arguments {
    /// The rule set: a file in YAML, FIS, FLL, FCL or FML, a built-in one's name, or `-` for standard input
    #[arg(value_name = "MODEL")]
    model: PathBuf,
    /// A value for each input: `margin=0.07`
    #[arg(required = true, value_name = "INPUT=VALUE", value_parser = assignment)]
    inputs: Vec<(String, f64)>,
    /// Print a JSON document instead of text
    #[arg(long)]
    json: bool,
    /// Write an SVG picture of terms, rules and results to this file instead; `-` is standard output
    #[arg(long, value_name = "FILE", conflicts_with = "json", value_parser = output::svg_path)]
    svg: Option<PathBuf>,
}

fn assignment(text: &str) -> Result<(String, f64), String> {
    let (name, value) = text.split_once('=').ok_or("write NAME=VALUE")?;
    match value.trim().parse::<f64>() {
        Ok(number) if number.is_finite() => Ok((name.trim().into(), number)),
        _ => Err(format!("`{value}` is not a finite number")),
    }
}

pub(crate) fn run(arguments: &Arguments) -> Result<Exit, Failure> {
    let mut files = Files::reading([&arguments.model])?;
    let svg = files.optional(arguments.svg.as_ref())?;
    let engine = rule_set::load(&arguments.model)?;
    let model = engine.model();
    let values = values(model, &arguments.inputs)?;
    let explanation = engine.explain(&values).map_err(Failure::usage)?;
    if let Some(svg) = svg {
        svg.write(&explanation_svg(model, &explanation))?;
        return Ok(Exit::Clean);
    }
    let mut out = Stdout::text();
    if arguments.json {
        let json = Explained::new(&model.name, &explanation);
        serde_json::to_writer_pretty(&mut out, &json).map_err(std::io::Error::from)?;
        writeln!(out)?;
    } else {
        write!(out, "{}", explanation_text(model, &explanation))?;
    }
    out.finish()?;
    Ok(Exit::Clean)
}

/// One value for each input, in the order of the model.
fn values(model: &Model, given: &[(String, f64)]) -> Result<Vec<f64>, Failure> {
    let names = || model.inputs.iter().map(|input| input.name.as_str());
    for (i, (name, _)) in given.iter().enumerate() {
        if !names().any(|known| known == name) {
            let failure = Failure::usage(format!("the rule set has no input `{name}`"));
            return Err(failure.help_if(suggest(name, names())));
        }
        if given.iter().take(i).any(|(other, _)| other == name) {
            return Err(Failure::usage(format!("`{name}` is given twice")));
        }
    }
    let value = |name: &str| {
        let found = given.iter().find(|(known, _)| known == name);
        found.map(|(_, value)| *value).ok_or_else(|| {
            Failure::usage(format!("input `{name}` has no value")).help(format!("add `{name}=0.5`"))
        })
    };
    names().map(value).collect()
}
