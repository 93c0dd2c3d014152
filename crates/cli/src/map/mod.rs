//! `flagred map`: the output of a rule set over its inputs, as a picture or a table.

mod check;
mod sample;
mod slice;
mod table;
mod values;

use std::{collections::BTreeSet, path::PathBuf};

use anstyle::{RgbColor, Style};
use clap::ValueEnum;
use flagred::{
    estimator::Estimator,
    gap::{Filling, GapMethod, GapSettings},
};
use flagred_authoring::slice::{Mapped, POINTS};
use fuzzy::{
    Engine,
    drawing::visible,
    drawing::{Colour, map_svg, map_text, rules_svg, rules_text, surface_svg},
};

use crate::{
    built_in,
    diagnostics::read_text,
    failure::{Exit, Failure},
    numbers::{self, whole},
    output::{self, Files, print},
    profile::{self, Loaded},
    rule_set,
    table::{Layout, Suffix},
};

#[derive(clap::Args)]
pub(crate) struct Arguments {
    /// The rule set: a file in YAML, FIS, FLL, FCL or FML, the name of a built-in one, or `-` for standard input; or a profile:
    /// its rule set, with the interpolation of the profile
    #[arg(value_name = "RULES")]
    model: PathBuf,

    /// Points along each axis [default: 51; fewer with `--csv` and more than two inputs, so that there are at most 100,000 in
    /// all; with `--values`, the table has at most 6 columns and rows]
    #[arg(long, value_name = "POINTS", value_parser = whole(2_u16, 1001))]
    points: Option<u16>,

    /// Fix an input at a value: `battery=0.8`; may be repeated. Without this option, inputs that are not axes have the middle
    /// of their range, or the peak of one of their terms if the output varies more there
    #[arg(long, value_name = "INPUT=VALUE", value_parser = hold)]
    hold: Vec<(String, f64)>,

    /// The input along the horizontal axis: `spread`, or with the part of its range to show: `spread:0..0.2`
    /// [default: the first input that is not fixed; in pictures, the part of its range in which its terms change]
    #[arg(long, value_name = "INPUT[:LOW..HIGH]", value_parser = axis)]
    x: Option<AxisChoice>,

    /// The input along the vertical axis, written as for `--x` [default: the next input that is not fixed]
    #[arg(long, value_name = "INPUT[:LOW..HIGH]", value_parser = axis)]
    y: Option<AxisChoice>,

    /// The output to show [default: the last one that is not an input of another output; for a profile, its risk]
    #[arg(long, value_name = "OUTPUT")]
    of: Option<String>,

    /// The file to write, replaced if it exists; `-` is standard output [default: -]
    #[arg(short, long, value_name = "FILE", value_parser = output::text_path)]
    output: Option<PathBuf>,

    /// How to interpolate cells where no rule applies [default: none; for a profile, its own]
    #[arg(long, value_enum, value_name = "METHOD")]
    fill: Option<Fill>,

    /// Interpolate cells whose coverage, the largest firing strength of any rule, is below this value from 0 to 1; needs an
    /// interpolation [default: 0.5 if AND is the minimum; otherwise it depends on AND and the terms]
    #[arg(long, value_name = "STRENGTH", value_parser = numbers::degree_above_0)]
    coverage_below: Option<f64>,

    /// Write an SVG picture to this file instead of text; `-` is standard output
    #[arg(long, value_name = "FILE", value_parser = output::svg_path, conflicts_with = "output")]
    svg: Option<PathBuf>,

    /// Draw a surface in three dimensions instead of a flat map, as SVG
    #[arg(long, requires = "svg", conflicts_with = "csv")]
    surface: bool,

    /// Show the rule with the largest firing strength in each cell instead of the value
    #[arg(long, conflicts_with = "surface")]
    activations: bool,

    /// Print values as numbers: a table below the picture; with more than two inputs, a table for each combination of the peaks
    /// and range ends of the other inputs
    #[arg(long, conflicts_with_all = ["svg", "activations", "csv"])]
    values: bool,

    /// Print a table of all cells instead of a picture
    #[arg(long, conflicts_with_all = ["svg", "activations"])]
    csv: bool,

    /// With `--csv`: the given number of points, spread over all inputs, instead of a grid
    #[arg(
        long,
        value_name = "POINTS",
        requires = "csv",
        conflicts_with_all = ["points", "hold", "x", "y"],
        value_parser = whole(1_u32, 1_000_000)
    )]
    sample: Option<u32>,

    /// Compare the outputs with a table that `map --csv` or `eval` wrote before; exit with 1 if a value differs. `--suffix`,
    /// `--column` and `--delimiter` describe this table
    #[arg(
        long,
        value_name = "TABLE.csv",
        conflicts_with_all = ["points", "hold", "x", "y", "of", "output", "svg", "activations", "values", "csv"]
    )]
    check: Option<PathBuf>,

    #[command(flatten)]
    suffix: Suffix,

    #[command(flatten)]
    layout: Layout,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
enum Fill {
    /// Show no value in such cells
    None,
    /// The value of the nearest covered cell
    Nearest,
    /// The mean of the nearest covered cells, weighted by inverse distance
    #[value(name = "inverse_distance")]
    InverseDistance,
    /// The thin-plate spline through the nearest covered cells
    #[value(name = "thin_plate")]
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

/// The input of an axis, and the shown part of its range.
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
        None => {
            let ends = part.split(['-', ',', ':']).map(str::trim);
            let ends: Vec<&str> = ends.filter(|end| end.parse::<f64>().is_ok()).collect();
            let falling = part
                .split_once("..")
                .map(|(low, high)| (low.trim(), high.trim()));
            let is_number = |end: &str| end.parse::<f64>().is_ok_and(f64::is_finite);
            Err(match ends.as_slice() {
                _ if let Some((high, low)) = falling
                    && is_number(high)
                    && is_number(low) =>
                {
                    match high == low {
                        true => "write two different ends".to_owned(),
                        false => format!("write the low end first: `{name}:{low}..{high}`"),
                    }
                }
                [low, high] => format!("write `{name}:{low}..{high}`"),
                _ => "write `INPUT` or `INPUT:LOW..HIGH`".to_owned(),
            })
        }
    }
}

fn hold(text: &str) -> Result<(String, f64), String> {
    let (name, value) = text.split_once('=').ok_or("write `INPUT=VALUE`")?;
    match value.trim().parse::<f64>() {
        Ok(value) if value.is_finite() => Ok((name.trim().to_owned(), value)),
        _ if value.contains('=') => Err(format!(
            "repeat the option: `--hold {}`",
            text.replace(',', " --hold ")
        )),
        _ => Err(match fuzzy::tree::number_advice(value) {
            Some(advice) => format!("`{value}` is not a number: {advice}"),
            None => format!("`{value}` is not a finite number"),
        }),
    }
}

/// A compiled rule set, with the filling of its gaps and the name of the filling's method.
struct MapSource {
    engine: Engine,
    output: usize,
    filling: Option<(Filling, &'static str)>,
}

/// Default maximum number of cells of a whole map.
const MAP_CELLS: f64 = 100_000.0;

/// Returns the default number of points of a whole map along each of its inputs: at least 3, at most 51, and fewer if the map
/// would otherwise exceed 100,000 cells.
pub(crate) fn points_along(inputs: usize) -> usize {
    let most = MAP_CELLS.powf(1.0 / inputs.max(1) as f64);
    (most as usize).clamp(3, POINTS)
}

pub(crate) fn run(arguments: &Arguments) -> Result<Exit, Failure> {
    let mut held = BTreeSet::new();
    if let Some((name, _)) = arguments.hold.iter().find(|(name, _)| !held.insert(name)) {
        return Err(Failure::usage(format!("`{name}` has two values"))
            .help("use `--hold` once for each input"));
    }
    let given = arguments.suffix.given().or(arguments.layout.given());
    if let (None, Some(option)) = (&arguments.check, given) {
        let failure = Failure::usage(format!("`{option}` needs a table"));
        return Err(failure.help("name a table with `--check`, or leave the option out"));
    }
    let read = [&arguments.model].into_iter().chain(&arguments.check);
    let mut files = Files::reading(read)?;
    let svg = files.optional(arguments.svg.as_ref())?;
    let output = files.optional(arguments.output.as_ref())?;
    let evaluated = evaluate(arguments)?;
    if let Some(table) = &arguments.check {
        let write = || {
            let (model, table) = (arguments.model.display(), table.display());
            format!("`flagred map {model} --csv --output {table}` writes it")
        };
        return check::against(table, arguments, &evaluated).map_err(|failure| {
            match table.exists() {
                true => failure,
                false => failure.help(write()),
            }
        });
    }
    if let Some(name) = arguments.output.as_ref().and_then(|path| path.to_str())
        && evaluated.engine.output_names().any(|output| output == name)
    {
        let failure = Failure::usage(format!(
            "`{name}` is an output of the rule set, and `--output` names a file"
        ));
        return Err(failure.help(format!("`--of {name}` shows this output")));
    }
    let shown = evaluated.engine.model().outputs.get(evaluated.output);
    if let Some(shown) = shown.filter(|shown| shown.keeps_previous()) {
        output::print_note(&format!(
            "note: `{}` keeps its previous value where no rule fires; the cells of a map have no previous value",
            visible(&shown.variable.name)
        ));
    }
    if let Some(points) = arguments.sample {
        print(output.as_ref(), &sample::table(&evaluated, points)?)?;
        return Ok(Exit::Clean);
    }
    let whole = arguments.hold.is_empty() && arguments.x.is_none() && arguments.y.is_none();
    if arguments.csv && whole && evaluated.engine.model().inputs.len() > 2 {
        print(output.as_ref(), &table::whole(arguments, evaluated)?)?;
        return Ok(Exit::Clean);
    }
    if arguments.values {
        print(output.as_ref(), &values::text(arguments, &evaluated)?)?;
        return Ok(Exit::Clean);
    }
    let (slice, notes) = slice::cut(arguments, &evaluated)?;
    for note in notes {
        output::print_note(&format!("note: {note}"));
    }
    let model = evaluated.engine.model();
    match &svg {
        _ if arguments.csv => print(output.as_ref(), &table::of_slice(&slice)?)?,
        None if arguments.activations => {
            print(output.as_ref(), &rules_text(&slice, model, painted))?
        }
        None => print(output.as_ref(), &map_text(&slice, painted))?,
        Some(svg) if arguments.surface => {
            let surface = surface_svg(&slice).ok_or_else(|| {
                Failure::usage("`--surface` needs two inputs, but only one is left")
                    .help("without `--surface`, a map of one input is drawn as a curve")
            })?;
            svg.write(&surface)?;
        }
        Some(svg) if arguments.activations => svg.write(&rules_svg(&slice, model))?,
        Some(svg) => svg.write(&map_svg(&slice))?,
    }
    Ok(Exit::Clean)
}

/// Returns a cell of a picture for a terminal, in its colour.
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

fn evaluate(arguments: &Arguments) -> Result<MapSource, Failure> {
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
    let wanted = arguments.of.as_deref();
    let output = match wanted.or(profile.map(|profile| profile.output.as_str())) {
        None => engine.model().last_outputs().last().copied().unwrap_or(0),
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
    if method.is_none() && arguments.coverage_below.is_some() {
        let message = "`--coverage-below` has no effect without interpolation";
        return Err(Failure::usage(message).help("choose an interpolation with `--fill`"));
    }
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
    Ok(MapSource {
        filling: filling.transpose()?,
        engine,
        output,
    })
}

impl MapSource {
    fn mapped(&self) -> Mapped<'_> {
        let filling = self.filling.as_ref();
        Mapped {
            model: self.engine.model(),
            engine: &self.engine,
            output: self.output,
            filling: filling.map(|(filling, method)| (filling, *method)),
        }
    }
}
