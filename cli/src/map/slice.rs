//! The part of a map that a picture shows: two inputs are the axes, the others are held.

use fuzzy::{
    drawing::{Axis, Cell, Scale, Slice, short},
    engine::{EvaluateError, Outcome},
};

use super::{Arguments, AxisChoice, Evaluated, POINTS, view};
use crate::failure::Failure;

/// The slice that the arguments ask for, and notes about what they leave open.
pub(super) fn cut(
    arguments: &Arguments,
    evaluated: &Evaluated,
) -> Result<(Slice, Vec<String>), Failure> {
    let model = &evaluated.model;
    let unknown = |name: &str| {
        let inputs = model.inputs.iter().map(|input| input.name.as_str());
        Failure::usage(format!("the rule set has no input `{name}`"))
            .help_if(fuzzy::diagnostic::suggest(name, inputs))
    };
    let index = |name: &str| {
        let found = model.inputs.iter().position(|input| input.name == name);
        found.ok_or_else(|| unknown(name))
    };
    let mut fixed: Vec<Option<f64>> = vec![None; model.inputs.len()];
    for (name, value) in &arguments.fix {
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
    let asked = |axis: &Option<AxisChoice>| axis.as_ref().map(|a| index(&a.name)).transpose();
    let (asked_x, asked_y) = (asked(&arguments.x)?, asked(&arguments.y)?);
    for (axis, input) in [("x", asked_x), ("y", asked_y)] {
        if let Some(input) = input
            && fixed.get(input).copied().flatten().is_some()
        {
            return Err(
                Failure::usage(format!("`--{axis}` names an input that `--fix` holds"))
                    .help("leave one of the two out"),
            );
        }
    }
    if asked_x.is_some() && asked_x == asked_y {
        return Err(Failure::usage("`--x` and `--y` name the same input"));
    }
    let mut free = (0..model.inputs.len())
        .filter(|input| fixed.get(*input).copied().flatten().is_none())
        .filter(|input| Some(*input) != asked_x && Some(*input) != asked_y);
    let x = asked_x
        .or_else(|| free.next())
        .ok_or_else(|| Failure::usage("every input is fixed, none is left for an axis"))?;
    let y = asked_y.or_else(|| free.next());

    let points = arguments.points.map_or(POINTS, usize::from);
    let variable = |input: usize| model.inputs.get(input);
    let axis = |input: usize, choice: &Option<AxisChoice>| {
        let part = choice.as_ref().and_then(|choice| choice.part);
        let part = |v| part.map_or_else(|| view::shown(v), |(low, high)| Scale::new(low, high));
        variable(input).map(|v| Axis::new(v, part(v), points))
    };
    let x_axis =
        axis(x, &arguments.x).ok_or_else(|| Failure::usage("the rule set has no inputs"))?;
    let y_axis = y.and_then(|y| axis(y, &arguments.y));
    let mut point = view::held(evaluated, &fixed, (x, y));
    let held = model.inputs.iter().zip(&point).enumerate();
    let held: Vec<(String, f64)> = held
        .filter(|(input, _)| *input != x && Some(*input) != y)
        .map(|(_, (input, value))| (input.name.clone(), *value))
        .collect();
    let axes = [("x", Some(x), Some(&x_axis)), ("y", y, y_axis.as_ref())];
    let shown = axes
        .into_iter()
        .filter_map(|(flag, input, axis)| Some((flag, variable(input?)?, axis?)));
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
                "`{name}` is shown from {low} to {high}, where its terms change; \
                 the whole range: `--{flag} {name}:{whole}`"
            )
        });
    let named = |name: &str| arguments.fix.iter().any(|(fixed, _)| fixed == name);
    let unnamed = held.iter().filter(|(name, _)| !named(name));
    let held_at = unnamed.map(|(name, value)| {
        format!(
            "`{name}` is held at {}; another value: `--fix {name}=VALUE`",
            short(*value)
        )
    });
    let notes: Vec<String> = held_at.chain(parts).collect();

    let mut cells = Vec::with_capacity(points * points);
    let mut scratch = evaluated.engine.scratch();
    let mut outcomes = vec![Outcome::default(); evaluated.engine.output_names().len()];
    for x_value in &x_axis.points {
        let rows = y_axis.as_ref().map_or(1, |y| y.points.len());
        for row in 0..rows {
            if let Some(value) = point.get_mut(x) {
                *value = *x_value;
            }
            if let (Some(y), Some(axis)) = (y, &y_axis)
                && let (Some(value), Some(y_value)) = (point.get_mut(y), axis.points.get(row))
            {
                *value = *y_value;
            }
            let engine = &evaluated.engine;
            match engine.evaluate_with(&mut scratch, &point, &mut outcomes) {
                Ok(()) | Err(EvaluateError::NoRuleFired { .. }) => {}
                Err(error) => return Err(Failure::unreadable(error.to_string())),
            }
            let outcome = outcomes.get(evaluated.output).copied().unwrap_or_default();
            cells.push(cell(evaluated, &outcome, &point));
        }
    }
    let output = model.outputs.get(evaluated.output).map(|o| &o.variable);
    let slice = Slice {
        model: model.name.clone(),
        output: output.map(|o| o.name.clone()).unwrap_or_default(),
        unit: output.and_then(|o| o.unit.clone()),
        range: output.map_or(Scale::new(0.0, 1.0), |o| Scale::new(o.low, o.high)),
        x: x_axis,
        y: y_axis,
        held,
        filling: evaluated
            .filling
            .as_ref()
            .map(|(_, method)| method.replace('_', " ")),
        cells,
    };
    Ok((slice, notes))
}

fn cell(evaluated: &Evaluated, outcome: &Outcome, point: &[f64]) -> Cell {
    let filling = evaluated.filling.as_ref();
    let reading = filling
        .filter(|(filling, _)| filling.is_gap(outcome.coverage))
        .and_then(|(filling, _)| filling.read(point));
    Cell {
        value: reading.map(|r| r.value).or_else(|| outcome.value()),
        coverage: outcome.coverage,
        rule: outcome.dominant,
        filled_from: reading.map(|reading| reading.distance),
    }
}
