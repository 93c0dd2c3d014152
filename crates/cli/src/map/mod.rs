//! `flagred map`: the output of a rule set over its inputs, as a picture or a table.

mod slice;

use std::{io::Write, path::PathBuf};

use anstyle::{RgbColor, Style};
use clap::ValueEnum;
use flagred::{
    estimator::Estimator,
    gap::{Filling, GapMethod, GapSettings},
};
use flagred_authoring::slice::POINTS;
use fuzzy::{
    Engine,
    drawing::visible,
    drawing::{Colour, Slice, map_svg, map_text, rules_svg, rules_text, short, surface_svg},
    map::{DecisionMap, Grid},
};

use crate::{
    built_in,
    diagnostics::read_text,
    failure::{Exit, Failure},
    output::{self, Files, Stdout},
    profile::{self, Loaded},
    rule_set,
};

#[derive(clap::Args)]
pub(crate) struct Arguments {
    /// A rule set, or a profile: its rule set, interpolated as the profile says. A file, a built-in profile's name, or `-` for
    /// standard input
    #[arg(value_name = "MODEL")]
    model: PathBuf,

    /// Points along each axis [default: 51; fewer with `--csv` and more than two inputs]
    #[arg(long, value_name = "POINTS", value_parser = clap::value_parser!(u16).range(2..=1001))]
    points: Option<u16>,

    /// Hold an input at a value: `battery=0.8`. An input that is neither fixed nor an axis is held at the middle of its
    /// range, or at the peak of a term where the output varies more
    #[arg(long, value_name = "INPUT=VALUE", value_parser = fix)]
    fix: Vec<(String, f64)>,

    /// The input along the horizontal axis, and the part of its range to show: `spread` or `spread:0..0.2` [default: the
    /// first that is not fixed, where its terms lie]
    #[arg(long, value_name = "INPUT", value_parser = axis)]
    x: Option<AxisChoice>,

    /// The input along the vertical axis, as `--x` [default: the next that is not fixed]
    #[arg(long, value_name = "INPUT", value_parser = axis)]
    y: Option<AxisChoice>,

    /// The output to show [default: the first]
    #[arg(long, value_name = "OUTPUT")]
    output: Option<String>,

    /// How to interpolate cells where no rule applies [default: none; of a profile, as it says]
    #[arg(long, value_enum, value_name = "METHOD")]
    fill: Option<Fill>,

    /// With an interpolation: interpolate cells in which all firing strengths are below this [default: from AND and the
    /// terms; 0.5 for the minimum]
    #[arg(long, value_name = "DEGREE")]
    coverage_below: Option<f64>,

    /// Write an SVG picture to this file; `-` is standard output
    #[arg(long, value_name = "FILE", value_parser = output::svg_path)]
    svg: Option<PathBuf>,

    /// Draw a surface in three dimensions instead of a flat map, as SVG
    #[arg(long, requires = "svg")]
    surface: bool,

    /// Show in each cell the rule with the largest firing strength instead of the value
    #[arg(long, conflicts_with = "surface")]
    activations: bool,

    /// Print a table of all cells instead of a picture
    #[arg(long, conflicts_with_all = ["svg", "activations"])]
    csv: bool,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
enum Fill {
    /// Show no value there
    None,
    /// The value of the nearest covered cell
    Nearest,
    /// The mean of the nearest covered cells, weighted by inverse distance
    InverseDistance,
    /// The thin-plate spline through the nearest covered cells
    ThinPlate,
    /// Laplace's equation: smooth, without overshoot
    Harmonic,
}

impl Fill {
    fn method(self) -> Option<GapMethod> {
        match self {
            Fill::None => None,
            Fill::Nearest => Some(GapMethod::Nearest),
            Fill::InverseDistance => Some(GapMethod::INVERSE_DISTANCE),
            Fill::ThinPlate => Some(GapMethod::ThinPlate),
            Fill::Harmonic => Some(GapMethod::Harmonic),
        }
    }
}

/// The input of an axis, and the part of its range that is shown.
#[derive(Debug, Clone)]
struct AxisChoice {
    name: String,
    part: Option<(f64, f64)>,
}

fn axis(text: &str) -> Result<AxisChoice, String> {
    let Some((name, part)) = text.rsplit_once(':') else {
        return Ok(AxisChoice {
            name: text.to_owned(),
            part: None,
        });
    };
    let ends = part.split_once("..").and_then(|(low, high)| {
        let ends = (
            low.trim().parse::<f64>().ok()?,
            high.trim().parse::<f64>().ok()?,
        );
        (ends.0.is_finite() && ends.1.is_finite() && ends.0 < ends.1).then_some(ends)
    });
    match ends {
        Some(part) => Ok(AxisChoice {
            name: name.to_owned(),
            part: Some(part),
        }),
        None => Err("write `INPUT` or `INPUT:LOW..HIGH`".to_owned()),
    }
}

fn fix(text: &str) -> Result<(String, f64), String> {
    let (name, value) = text.split_once('=').ok_or("write `INPUT=VALUE`")?;
    match value.trim().parse::<f64>() {
        Ok(value) if value.is_finite() => Ok((name.trim().to_owned(), value)),
        _ => Err(format!("`{value}` is not a finite number")),
    }
}

/// A rule set, compiled, and what fills its gaps, with the name of the method.
struct Evaluated {
    engine: Engine,
    output: usize,
    filling: Option<(Filling, &'static str)>,
}

/// The most cells of a whole map by default.
const MAP_CELLS: f64 = 100_000.0;

/// The default number of points of a whole map along each of so many inputs: 51, fewer where there would be more than
/// 100,000 cells, at least 3.
pub(crate) fn points_along(inputs: usize) -> usize {
    let most = MAP_CELLS.powf(1.0 / inputs.max(1) as f64);
    (most as usize).clamp(3, POINTS)
}

pub(crate) fn run(arguments: &Arguments) -> Result<Exit, Failure> {
    let mut files = Files::reading([&arguments.model])?;
    let svg = files.optional(arguments.svg.as_ref())?;
    let evaluated = evaluate(arguments)?;
    let output = evaluated.engine.model().outputs.get(evaluated.output);
    if let Some(output) = output.filter(|output| output.keeps_previous()) {
        output::say(&format!(
            "note: `{}` keeps its previous value where no rule fires; a map has none before its cells",
            visible(&output.variable.name)
        ));
    }
    let mut out = Stdout::text();
    let whole = arguments.fix.is_empty() && arguments.x.is_none() && arguments.y.is_none();
    if arguments.csv && whole && evaluated.engine.model().inputs.len() > 2 {
        write_whole(&mut out, arguments, evaluated)?;
        out.finish()?;
        return Ok(Exit::Clean);
    }
    let (slice, notes) = slice::cut(arguments, &evaluated)?;
    for note in notes {
        output::say(&format!("note: {note}"));
    }
    let model = &evaluated.engine.model();
    match &svg {
        _ if arguments.csv => write_slice(&mut out, &slice)?,
        None if arguments.activations => {
            write!(out, "{}", rules_text(&slice, model, painted))?;
        }
        None => write!(out, "{}", map_text(&slice, painted))?,
        Some(svg) if arguments.surface => {
            let surface = surface_svg(&slice).ok_or_else(|| {
                Failure::usage("`--surface` needs two inputs, and one is left")
                    .help("without `--surface`, the picture of one input is a curve")
            })?;
            svg.write(&surface)?;
        }
        Some(svg) if arguments.activations => svg.write(&rules_svg(&slice, model))?,
        Some(svg) => svg.write(&map_svg(&slice))?,
    }
    out.finish()?;
    Ok(Exit::Clean)
}

/// A cell of a picture on a terminal, in its colour.
pub(crate) fn painted(cell: char, colour: Option<Colour>) -> String {
    let rgb = |colour: Colour| Some(RgbColor(colour.0, colour.1, colour.2).into());
    match colour {
        None => cell.to_string(),
        Some(colour) => {
            let style = Style::new()
                .bg_color(rgb(colour))
                .fg_color(rgb(colour.ink()));
            format!("{style}{cell}{style:#}")
        }
    }
}

fn evaluate(arguments: &Arguments) -> Result<Evaluated, Failure> {
    let file = arguments.model.display().to_string();
    let built_in = built_in::profile_at(&arguments.model);
    let text = match built_in {
        Some(known) => known.text.to_owned(),
        None => read_text(&arguments.model)?,
    };
    let source = flagred_interchange::source(text);
    let (engine, estimator) = if flagred_authoring::is_profile(&source) {
        let Loaded { estimator, .. } = match built_in {
            Some(known) => profile::load(known.name)?,
            None => profile::from_source(&arguments.model, source)?,
        };
        (estimator.engine().clone(), Some(estimator))
    } else {
        (rule_set::engine(&source, &file)?.clone(), None)
    };
    let profile = estimator.as_ref().map(Estimator::profile);
    let wanted = arguments.output.as_deref();
    let output = match wanted.or(profile.map(|profile| profile.output.as_str())) {
        None => 0,
        Some(wanted) => engine.output(wanted).ok_or_else(|| {
            let outputs = engine.output_names();
            let failure = Failure::usage(format!("`{file}` has no output `{wanted}`"));
            failure.help_if(fuzzy::diagnostic::suggest(wanted, outputs))
        })?,
    };
    let method = match arguments.fill {
        Some(fill) => fill.method(),
        None => profile.map(|profile| profile.gap.method),
    };
    let settings = |method| {
        let mut settings = GapSettings::default();
        settings.method = method;
        settings.coverage_below = arguments
            .coverage_below
            .or(profile.and_then(|profile| profile.gap.coverage_below));
        settings
    };
    let filling = method.map(|method| {
        let filling = Filling::new(&engine, engine.model(), output, &settings(method));
        filling
            .map(|filling| (filling, method.name()))
            .map_err(|error| Failure::unreadable(format!("`{file}` cannot be mapped: {error}")))
    });
    Ok(Evaluated {
        filling: filling.transpose()?,
        engine,
        output,
    })
}

/// Every cell of the map over all inputs.
fn write_whole(
    out: &mut impl Write,
    arguments: &Arguments,
    evaluated: Evaluated,
) -> Result<(), Failure> {
    let points = match arguments.points {
        Some(points) => usize::from(points),
        None => points_along(evaluated.engine.model().inputs.len()),
    };
    let no_map = |error: &dyn std::fmt::Display| {
        Failure::unreadable(format!(
            "`{}` cannot be mapped: {error}",
            arguments.model.display()
        ))
    };
    let grid = Grid::new(&evaluated.engine, points).map_err(|error| no_map(&error))?;
    let map = DecisionMap::new(&evaluated.engine, grid, evaluated.output).map_err(|error| {
        let help = "use fewer `--points`, or `flagred eval` at the points of a table";
        no_map(&error).help(help)
    })?;
    let filling = evaluated.filling.map(|(filling, _)| filling);
    let axes = map.grid().axes().iter().map(|axis| &*axis.name);
    write_head(out, axes, map.output())?;
    for cell in 0..map.grid().cells() {
        let point = map.grid().point(cell);
        for x in &point {
            write!(out, "{},", short(*x))?;
        }
        let is_gap = |filling: &&Filling| filling.is_gap(map.coverage(cell));
        let reading = filling.as_ref().filter(is_gap);
        let reading = reading.and_then(|filling| filling.read(&point));
        let (value, distance) = match reading {
            Some(reading) => (Some(reading.value), Some(reading.distance)),
            None => {
                let value = map.value(cell);
                (value, value.map(|_| 0.0))
            }
        };
        writeln!(
            out,
            "{},{},{},{},{}",
            value.map(short).unwrap_or_default(),
            short(map.coverage(cell)),
            rule_number(map.dominant(cell)),
            u8::from(reading.is_some()),
            distance.map(short).unwrap_or_default()
        )?;
    }
    Ok(())
}

/// The names of the columns.
fn write_head<'a>(
    out: &mut impl Write,
    axes: impl Iterator<Item = &'a str>,
    output: &'a str,
) -> Result<(), Failure> {
    let mut head = csv::Writer::from_writer(out);
    let names = axes
        .chain([output])
        .map(|name| output::cell(name).into_owned());
    let more = ["coverage", "dominant_rule", "filled", "distance"].map(str::to_owned);
    head.write_record(names.chain(more))?;
    Ok(head.flush()?)
}

/// Every cell of a slice.
fn write_slice(out: &mut impl Write, slice: &Slice) -> Result<(), Failure> {
    let axes = std::iter::once(&slice.x).chain(&slice.y);
    write_head(out, axes.map(|axis| axis.name.as_str()), &slice.output)?;
    for (i, x) in slice.x.points.iter().enumerate() {
        for j in 0..slice.rows() {
            write!(out, "{},", short(*x))?;
            if let Some(y) = slice.y.as_ref().and_then(|y| y.points.get(j)) {
                write!(out, "{},", short(*y))?;
            }
            let cell = slice.cell(i, j);
            writeln!(
                out,
                "{},{},{},{},{}",
                cell.value.map(short).unwrap_or_default(),
                short(cell.coverage),
                rule_number(cell.rule),
                u8::from(cell.filled_from.is_some()),
                short(cell.filled_from.unwrap_or(0.0))
            )?;
        }
    }
    Ok(())
}

/// The number of a rule, counted from 1; empty where no rule fired.
fn rule_number(rule: Option<usize>) -> String {
    rule.map(|rule| (rule + 1).to_string()).unwrap_or_default()
}
