//! `flagred plot`: the terms of every variable, and the curve of a rule set of one input.

use std::{io::Write as _, path::PathBuf};

use fuzzy::{
    Engine, Model,
    drawing::{Slice, variables_svg, variables_text},
    map::{DecisionMap, Grid},
};

use crate::{
    failure::{Exit, Failure},
    map::painted,
    output::{self, Files, Stdout},
    rule_set,
};

#[derive(clap::Args)]
pub(crate) struct Arguments {
    /// The rule set in YAML; `-` is standard input
    #[arg(value_name = "MODEL")]
    model: PathBuf,
    /// Write an SVG picture to this file instead; `-` is standard output
    #[arg(long, value_name = "FILE", value_parser = output::svg_path)]
    svg: Option<PathBuf>,
}

/// Points of a curve.
const POINTS: usize = 401;

pub(crate) fn run(arguments: &Arguments) -> Result<Exit, Failure> {
    let mut files = Files::reading([&arguments.model])?;
    let svg = files.optional(arguments.svg.as_ref())?;
    let (model, engine) = rule_set::load(&arguments.model)?;
    let curves = curves(&model, &engine)?;
    if let Some(svg) = svg {
        svg.write(&variables_svg(&model, &curves))?;
        return Ok(Exit::Clean);
    }
    let mut out = Stdout::text();
    write!(out, "{}", variables_text(&model, &curves, painted))?;
    out.finish()?;
    Ok(Exit::Clean)
}

/// The outputs over the only input; none where there are more.
fn curves(model: &Model, engine: &Engine) -> Result<Vec<Slice>, Failure> {
    if model.inputs.len() != 1 {
        return Ok(Vec::new());
    }
    let no_curve = |error: &dyn std::fmt::Display| {
        Failure::unreadable(format!("the rule set cannot be drawn: {error}"))
    };
    let mut curves = Vec::new();
    for output in 0..model.outputs.len() {
        let grid = Grid::new(engine, POINTS).map_err(|error| no_curve(&error))?;
        let map = DecisionMap::new(engine, grid, output).map_err(|error| no_curve(&error))?;
        curves.extend(Slice::new(model, &map));
    }
    Ok(curves)
}
