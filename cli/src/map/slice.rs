//! Two inputs of a rule set, the others held: what pictures show.

use std::fmt::Write as _;

use fuzzy::{
    engine::{EvaluateError, Outcome},
    model::Variable,
};

use super::{Arguments, AxisChoice, Evaluated, POINTS, short, view};
use crate::failure::Failure;

/// A picture's worth of a map.
pub(super) struct Slice {
    /// The name of the rule set.
    pub(super) model: String,
    pub(super) output: String,
    pub(super) unit: Option<String>,
    pub(super) range: (f64, f64),
    pub(super) x: Axis,
    /// A rule set of one input has but one axis.
    pub(super) y: Option<Axis>,
    /// The inputs that are held, and at what.
    pub(super) held: Vec<(String, f64)>,
    /// What the user did not ask for and may want otherwise.
    pub(super) notes: Vec<String>,
    /// How gaps are filled; `None` where they are not.
    pub(super) filling: Option<&'static str>,
    /// x by x, each with every y.
    cells: Vec<Cell>,
}

/// An input along an axis.
pub(super) struct Axis {
    pub(super) name: String,
    pub(super) unit: Option<String>,
    /// Where it is evaluated, rising.
    pub(super) places: Vec<f64>,
}

impl Axis {
    fn new(variable: &Variable, (low, high): (f64, f64), points: usize) -> Axis {
        let last = points.saturating_sub(1).max(1) as f64;
        let place = |i: usize| low + (high - low) * i as f64 / last;
        Axis {
            name: variable.name.clone(),
            unit: variable.unit.clone(),
            places: (0..points).map(place).collect(),
        }
    }

    pub(super) fn low(&self) -> f64 {
        self.places.first().copied().unwrap_or(0.0)
    }

    pub(super) fn high(&self) -> f64 {
        self.places.last().copied().unwrap_or(1.0)
    }

    /// The name and the unit.
    pub(super) fn title(&self) -> String {
        titled(&self.name, self.unit.as_deref())
    }
}

pub(super) fn titled(name: &str, unit: Option<&str>) -> String {
    match unit {
        Some(unit) => format!("{name} [{unit}]"),
        None => name.to_owned(),
    }
}

/// What is decided at one place.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Cell {
    pub(super) value: Option<f64>,
    pub(super) coverage: f64,
    pub(super) rule: Option<usize>,
    /// The distance to the nearest covered cell, where the value was filled in from there.
    pub(super) filled_from: Option<f64>,
}

impl Slice {
    pub(super) fn cell(&self, x: usize, y: usize) -> Cell {
        let rows = self.y.as_ref().map_or(1, |y| y.places.len());
        self.cells.get(x * rows + y).copied().unwrap_or_default()
    }

    pub(super) fn any_filled(&self) -> bool {
        self.cells.iter().any(|cell| cell.filled_from.is_some())
    }

    pub(super) fn any_unknown(&self) -> bool {
        self.cells.iter().any(|cell| cell.value.is_none())
    }

    /// Where a value stands in the output's range, from 0 to 1.
    pub(super) fn share(&self, value: f64) -> f64 {
        ((value - self.range.0) / (self.range.1 - self.range.0)).clamp(0.0, 1.0)
    }

    /// `rule set: output [unit]`, and the inputs that are held.
    pub(super) fn title(&self) -> String {
        let output = titled(&self.output, self.unit.as_deref());
        let mut title = format!("{}: {output}", self.model);
        for (i, (name, value)) in self.held.iter().enumerate() {
            let before = if i == 0 { " at " } else { ", " };
            // Writing to a String cannot fail.
            let _ = write!(title, "{before}{name} = {}", short(*value));
        }
        title
    }
}

pub(super) fn cut(arguments: &Arguments, evaluated: &Evaluated) -> Result<Slice, Failure> {
    let model = &evaluated.model;
    let unknown = |name: &str| {
        let inputs = model.inputs.iter().map(|input| input.name.as_str());
        Failure::usage(format!("the rule set has no input `{name}`"))
            .help_if(fuzzy::diagnostic::suggest(name, inputs))
    };
    let place = |name: &str| {
        let found = model.inputs.iter().position(|input| input.name == name);
        found.ok_or_else(|| unknown(name))
    };
    let mut fixed: Vec<Option<f64>> = vec![None; model.inputs.len()];
    for (name, value) in &arguments.fix {
        let input = place(name)?;
        let within = model.inputs.get(input).map(|i| (i.low, i.high));
        if let Some((low, high)) = within.filter(|(low, high)| value < low || value > high) {
            return Err(Failure::usage(format!(
                "`{name}` is fixed at {value}, outside its range from {low} to {high}"
            ))
            .help("fix it within its range"));
        }
        if let Some(slot) = fixed.get_mut(input) {
            *slot = Some(*value);
        }
    }
    let asked = |axis: &Option<AxisChoice>| axis.as_ref().map(|a| place(&a.name)).transpose();
    let (asked_x, asked_y) = (asked(&arguments.x)?, asked(&arguments.y)?);
    for (axis, input) in [("x", asked_x), ("y", asked_y)] {
        if let Some(input) = input
            && fixed.get(input).copied().flatten().is_some()
        {
            return Err(Failure::usage(format!(
                "`--{axis}` names an input that is fixed"
            )));
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
        .ok_or_else(|| Failure::usage("every input is fixed, and nothing is left to draw"))?;
    let y = asked_y.or_else(|| free.next());

    let points = arguments.points.map_or(POINTS, usize::from);
    let variable = |input: usize| model.inputs.get(input);
    let axis = |input: usize, choice: &Option<AxisChoice>| {
        let part = choice.as_ref().and_then(|choice| choice.part);
        variable(input).map(|v| Axis::new(v, part.unwrap_or_else(|| view::shown(v)), points))
    };
    let x_axis =
        axis(x, &arguments.x).ok_or_else(|| Failure::usage("there is no input to draw"))?;
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
        .filter(|(_, input, axis)| (axis.low(), axis.high()) != (input.low, input.high))
        .filter(|(_, input, _)| !chosen.contains(&input.name.as_str()))
        .map(|(flag, input, axis)| {
            let (name, low, high) = (&input.name, short(axis.low()), short(axis.high()));
            let whole = format!("{}..{}", short(input.low), short(input.high));
            format!(
                "`{name}` is shown from {low} to {high}, where its terms change; \
                 all of it: `--{flag} {name}:{whole}`"
            )
        });
    let named = |name: &str| arguments.fix.iter().any(|(fixed, _)| fixed == name);
    let unnamed = held.iter().filter(|(name, _)| !named(name));
    let held_at = unnamed.map(|(name, value)| {
        format!(
            "`{name}` is held at {}; elsewhere: `--fix {name}=VALUE`",
            short(*value)
        )
    });
    let notes = held_at.chain(parts).collect();

    let mut cells = Vec::with_capacity(points * points);
    let mut scratch = evaluated.engine.scratch();
    let mut outcomes = vec![Outcome::default(); evaluated.engine.output_names().len()];
    for x_place in &x_axis.places {
        let rows = y_axis.as_ref().map_or(1, |y| y.places.len());
        for row in 0..rows {
            if let Some(value) = point.get_mut(x) {
                *value = *x_place;
            }
            if let (Some(y), Some(axis)) = (y, &y_axis)
                && let (Some(value), Some(place)) = (point.get_mut(y), axis.places.get(row))
            {
                *value = *place;
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
    Ok(Slice {
        model: model.name.clone(),
        output: output.map(|o| o.name.clone()).unwrap_or_default(),
        unit: output.and_then(|o| o.unit.clone()),
        range: output.map_or((0.0, 1.0), |o| (o.low, o.high)),
        x: x_axis,
        y: y_axis,
        held,
        notes,
        filling: arguments.fill.method().map(|method| method.name()),
        cells,
    })
}

fn cell(evaluated: &Evaluated, outcome: &Outcome, point: &[f64]) -> Cell {
    let filling = evaluated.filling.as_ref();
    let reading = filling
        .filter(|filling| filling.is_gap(outcome.coverage))
        .and_then(|filling| filling.read(point));
    Cell {
        value: reading.map(|r| r.value).or_else(|| outcome.value()),
        coverage: outcome.coverage,
        rule: outcome.dominant,
        filled_from: reading.map(|reading| reading.distance),
    }
}
