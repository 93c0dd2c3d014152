//! The part of a map that a picture shows: two inputs are the axes, the others have fixed values.

use flagred_authoring::slice::{self, POINTS};
use fuzzy::{
    drawing::{Axis, Scale, Slice, short},
    model::Variable,
};

use super::{Arguments, AxisChoice, MapSource};
use crate::failure::Failure;

/// The chosen axes, each with the index of its input.
pub(super) struct Axes {
    pub(super) x: (usize, Axis),
    pub(super) y: Option<(usize, Axis)>,
    /// The value of each input that the user fixed.
    pub(super) fixed: Vec<Option<f64>>,
    /// A value for each input, used for inputs that are not axes.
    pub(super) middle: Vec<f64>,
}

/// Determines the axes from the arguments.
pub(super) fn axes(arguments: &Arguments, evaluated: &MapSource) -> Result<Axes, Failure> {
    let model = evaluated.engine.model();
    let unknown = |name: &str| {
        let inputs = model.inputs.iter().map(|input| input.name.as_str());
        Failure::usage(format!("the rule set has no input `{name}`")).help_if(
            match name.split_once(',') {
                Some((x, y)) => Some(format!("write `--x {} --y {}`", x.trim(), y.trim())),
                None => fuzzy::diagnostic::suggest(name, inputs),
            },
        )
    };
    let index = |name: &str| {
        let found = model.inputs.iter().position(|input| input.name == name);
        found.ok_or_else(|| unknown(name))
    };
    let mut fixed: Vec<Option<f64>> = vec![None; model.inputs.len()];
    for (name, value) in &arguments.hold {
        let input = index(name)?;
        let within = model.inputs.get(input).map(|i| (i.low, i.high));
        if let Some((low, high)) = within.filter(|(low, high)| value < low || value > high) {
            return Err(Failure::usage(format!(
                "`{name}` cannot be fixed at {value}: its range is {low} to {high}"
            ))
            .help("choose a value within the range"));
        }
        if let Some(slot) = fixed.get_mut(input) {
            *slot = Some(*value);
        }
    }
    let requested = |axis: &Option<AxisChoice>| axis.as_ref().map(|a| index(&a.name)).transpose();
    let (asked_x, asked_y) = (requested(&arguments.x)?, requested(&arguments.y)?);
    for (axis, input) in [("x", asked_x), ("y", asked_y)] {
        if let Some(input) = input
            && fixed.get(input).copied().flatten().is_some()
        {
            return Err(
                Failure::usage(format!("`--{axis}` names an input that `--hold` fixes"))
                    .help("leave one of the two out"),
            );
        }
    }
    if asked_x.is_some() && asked_x == asked_y {
        return Err(Failure::usage("`--x` and `--y` name the same input"));
    }
    // Inputs that the output reads come first.
    let output = model.outputs.get(evaluated.output);
    let read = output.map_or(Vec::new(), |output| model.inputs_of(&output.variable.name));
    let is_read = |input: &usize| {
        let input = model.inputs.get(*input);
        input.is_some_and(|input| read.contains(&input.name.as_str()))
    };
    let all = || 0..model.inputs.len();
    let mut free = (all().filter(is_read))
        .chain(all().filter(|input| !is_read(input) && read.is_empty()))
        .filter(|input| fixed.get(*input).copied().flatten().is_none())
        .filter(|input| Some(*input) != asked_x && Some(*input) != asked_y);
    let x = asked_x
        .or_else(|| free.next())
        .ok_or_else(|| {
            let values = arguments.hold.iter().map(|(name, value)| format!(" {name}={value}"));
            let values: String = values.collect();
            let failure = Failure::usage("every input is fixed, so none is left for an axis");
            failure.help(format!(
                "leave out one `--hold`; `flagred explain RULES{values}` evaluates the output at this point"
            ))
        })?;
    let y = asked_y.or_else(|| free.next());

    let points = arguments.points.map_or(POINTS, usize::from);
    let variable = |input: usize| model.inputs.get(input);
    let axis = |input: usize, choice: &Option<AxisChoice>| {
        let part = choice.as_ref().and_then(|choice| choice.part);
        // Tables of numbers cover the whole range of each input, so that they can be compared with later tables.
        let shown = |v: &Variable| match arguments.csv || arguments.values {
            true => Scale::new(v.low, v.high),
            false => slice::shown(v),
        };
        let part = |v| part.map_or_else(|| shown(v), |(low, high)| Scale::new(low, high));
        variable(input).map(|v| Axis::new(v, part(v), points))
    };
    let x_axis =
        axis(x, &arguments.x).ok_or_else(|| Failure::usage("the rule set has no inputs"))?;
    let y_axis = y.and_then(|y| axis(y, &arguments.y));
    let middle = slice::fixed_values(&evaluated.mapped(), &fixed, (x, y));
    Ok(Axes {
        x: (x, x_axis),
        y: y.zip(y_axis),
        fixed,
        middle,
    })
}

/// Returns the requested slice, and notes about the choices that the arguments left open.
pub(super) fn cut(
    arguments: &Arguments,
    evaluated: &MapSource,
) -> Result<(Slice, Vec<String>), Failure> {
    let model = evaluated.engine.model();
    let axes = axes(arguments, evaluated)?;
    let mapped = evaluated.mapped();
    let slice = slice::cut(&mapped, axes.x.clone(), axes.y.clone(), axes.middle)
        .map_err(|error| Failure::unreadable(error.to_string()))?;
    let axes = [("x", Some(&axes.x)), ("y", axes.y.as_ref())];
    let shown = axes.into_iter().filter_map(|(flag, axis)| {
        let (input, axis) = axis?;
        Some((flag, model.inputs.get(*input)?, axis))
    });
    let chosen = arguments.x.iter().chain(&arguments.y);
    let chosen: Vec<&str> = chosen
        .filter(|choice| choice.part.is_some())
        .map(|choice| choice.name.as_str())
        .collect();
    let parts = shown
        .filter(|(_, input, axis)| axis.scale() != Scale::new(input.low, input.high))
        .filter(|(_, input, _)| !chosen.contains(&input.name.as_str()))
        .map(|(flag, input, axis)| {
            let Scale { low, high } = axis.scale();
            let (name, low, high) = (&input.name, short(low), short(high));
            let whole = format!("{}..{}", short(input.low), short(input.high));
            format!(
                "`{name}` is shown from {low} to {high}, where its terms change; to show the whole range: `--{flag} {name}:{whole}`"
            )
        });
    let named = |name: &str| arguments.hold.iter().any(|(fixed, _)| fixed == name);
    let unnamed = slice.fixed.iter().filter(|(name, _)| !named(name));
    let fixed_at = unnamed.map(|(name, value)| {
        format!(
            "`{name}` is fixed at {}; to fix another value: `--hold {name}=VALUE`",
            short(*value)
        )
    });
    let beyond = axes.into_iter().filter_map(|(_, axis)| {
        let (input, axis) = axis?;
        let input = model.inputs.get(*input)?;
        let Scale { low, high } = axis.scale();
        (low < input.low || high > input.high).then(|| {
            format!(
                "the range of `{}` is {} to {}; values beyond it are clamped",
                input.name,
                short(input.low),
                short(input.high)
            )
        })
    });
    let notes: Vec<String> = fixed_at.chain(parts).chain(beyond).collect();
    Ok((slice, notes))
}
