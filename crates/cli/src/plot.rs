//! `flagred plot`: the terms of every variable, and the curves of a rule set with one input.

use std::{io::Write as _, path::PathBuf};

use fuzzy::{
    Engine,
    drawing::{Axis, Cell, Scale, Slice, variables_svg, variables_text},
};

use crate::{
    failure::{Exit, Failure},
    map::painted,
    output::{self, Files, Stdout},
    rule_set,
};

#[derive(clap::Args)]
pub(crate) struct Arguments {
    /// The rule set: a file in YAML, FIS, FLL, FCL or FML, the name of a built-in one, or `-` for standard input
    #[arg(value_name = "RULES")]
    model: PathBuf,
    /// Write an SVG picture to this file instead of text; `-` is standard output
    #[arg(long, value_name = "FILE", value_parser = output::svg_path)]
    svg: Option<PathBuf>,
}

/// Number of points of a curve.
const POINTS: usize = 401;

pub(crate) fn run(arguments: &Arguments) -> Result<Exit, Failure> {
    let mut files = Files::reading([&arguments.model])?;
    let svg = files.optional(arguments.svg.as_ref())?;
    let engine = rule_set::load(&arguments.model)?;
    let model = engine.model();
    let curves = curves(&engine)?;
    if let Some(svg) = svg {
        svg.write(&variables_svg(model, &curves))?;
        return Ok(Exit::Clean);
    }
    let mut out = Stdout::text();
    write!(out, "{}", variables_text(model, &curves, painted))?;
    out.finish()?;
    Ok(Exit::Clean)
}

/// The curves of the outputs over the only input; none if there are more inputs. Each point is evaluated once for all
/// outputs, because an output may read other outputs.
fn curves(engine: &Engine) -> Result<Vec<Slice>, Failure> {
    let model = engine.model();
    let [input] = &model.inputs[..] else {
        return Ok(Vec::new());
    };
    let axis = Axis::new(input, Scale::new(input.low, input.high), POINTS);
    let mut curves: Vec<Slice> = Vec::new();
    for output in &model.outputs {
        let variable = &output.variable;
        curves.push(Slice {
            model: model.name.clone(),
            output: variable.name.clone(),
            unit: variable.unit.clone(),
            range: Scale::new(variable.low, variable.high),
            x: axis.clone(),
            y: None,
            fixed: Vec::new(),
            filling: None,
            cells: Vec::with_capacity(POINTS),
        });
    }
    for &x in &axis.points {
        let outcomes = engine.evaluate(&[x]).map_err(|error| {
            Failure::unreadable(format!("the rule set cannot be drawn: {error}"))
        })?;
        for (curve, outcome) in curves.iter_mut().zip(outcomes) {
            curve.cells.push(Cell {
                value: outcome.value(),
                coverage: outcome.coverage,
                rule: outcome.dominant_rule,
                filled_from: None,
            });
        }
    }
    Ok(curves)
}
