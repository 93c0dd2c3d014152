//! The part of a decision map that a picture shows: one or two inputs are the axes, the others have fixed values.

use flagred::gap::Filling;
use fuzzy::{
    Engine, Model,
    drawing::{Axis, Cell, Scale, Slice},
    engine::{EvaluateError, Outcome, Scratch},
    model::Variable,
};

/// The default number of points along an axis.
pub const POINTS: usize = 51;

/// A compiled rule set, with the output to show and the filling of its gaps.
#[derive(Debug)]
pub struct Mapped<'a> {
    /// The rule set.
    pub model: &'a Model,
    /// The compiled rule set.
    pub engine: &'a Engine,
    /// The index of the output.
    pub output: usize,
    /// The filling of gaps, and the name of its method.
    pub filling: Option<(&'a Filling, &'static str)>,
}

/// The maximum number of combinations of fixed values that are tried.
const MAX_TRIED: usize = 1000;

/// An input is fixed at a value other than the middle of its range only if this increases the variation of the output
/// by at least this share of the output's range.
const NOTICEABLE: f64 = 0.01;

/// Evaluates the output at a point.
///
/// # Errors
/// If the point does not match the inputs of the rule set.
pub fn at(mapped: &Mapped<'_>, point: &[f64]) -> Result<Cell, EvaluateError> {
    let mut outcomes = vec![Outcome::default(); mapped.engine.output_names().len()];
    let mut scratch = mapped.engine.scratch();
    evaluate(mapped, &mut scratch, point, &mut outcomes)
}

/// Evaluates one output over the axes; `point` contains the values of the other inputs.
///
/// # Errors
/// If the point does not match the inputs of the rule set.
pub fn cut(
    mapped: &Mapped<'_>,
    (x, x_axis): (usize, Axis),
    y: Option<(usize, Axis)>,
    mut point: Vec<f64>,
) -> Result<Slice, EvaluateError> {
    let model = mapped.model;
    let is_axis = |input: usize| input == x || y.as_ref().is_some_and(|(y, _)| *y == input);
    let values = model.inputs.iter().zip(&point).enumerate();
    let output = model.outputs.get(mapped.output).map(|o| &o.variable);
    let read = output.map_or(Vec::new(), |output| model.inputs_of(&output.name));
    let fixed: Vec<(String, f64)> = values
        .filter(|(input, (variable, _))| !is_axis(*input) && read.contains(&variable.name.as_str()))
        .map(|(_, (input, value))| (input.name.clone(), *value))
        .collect();
    let rows = y.as_ref().map_or(1, |(_, axis)| axis.points.len());
    let mut cells = Vec::with_capacity(x_axis.points.len() * rows);
    let mut scratch = mapped.engine.scratch();
    let mut outcomes = vec![Outcome::default(); mapped.engine.output_names().len()];
    for x_value in &x_axis.points {
        for row in 0..rows {
            if let Some(value) = point.get_mut(x) {
                *value = *x_value;
            }
            if let Some((y, axis)) = &y
                && let (Some(value), Some(y_value)) = (point.get_mut(*y), axis.points.get(row))
            {
                *value = *y_value;
            }
            cells.push(evaluate(mapped, &mut scratch, &point, &mut outcomes)?);
        }
    }
    Ok(Slice {
        model: model.name.clone(),
        output: output.map(|o| o.name.clone()).unwrap_or_default(),
        unit: output.and_then(|o| o.unit.clone()),
        range: output.map_or(Scale::new(0.0, 1.0), |o| Scale::new(o.low, o.high)),
        x: x_axis,
        y: y.map(|(_, axis)| axis),
        fixed,
        filling: mapped.filling.map(|(_, method)| method.replace('_', " ")),
        cells,
    })
}

fn evaluate(
    mapped: &Mapped<'_>,
    scratch: &mut Scratch,
    point: &[f64],
    outcomes: &mut [Outcome],
) -> Result<Cell, EvaluateError> {
    match mapped.engine.evaluate_with(scratch, point, outcomes) {
        Ok(()) | Err(EvaluateError::NoRuleFired { .. }) => {}
        Err(error) => return Err(error),
    }
    let outcome = outcomes.get(mapped.output).copied().unwrap_or_default();
    Ok(cell(mapped, &outcome, point))
}

fn cell(mapped: &Mapped<'_>, outcome: &Outcome, point: &[f64]) -> Cell {
    let reading = mapped
        .filling
        .filter(|(filling, _)| filling.is_gap(outcome.coverage))
        .and_then(|(filling, _)| filling.read(point));
    Cell {
        value: reading.map(|r| r.value).or_else(|| outcome.value()),
        coverage: outcome.coverage,
        rule: outcome.dominant_rule,
        filled_from: reading.map(|reading| reading.distance),
    }
}

/// Returns the part of a variable's range to show. Usually this is the whole range. If the terms change only within
/// less than a quarter of the range, only that part is shown, with margins that double its width.
pub fn shown(variable: &Variable) -> Scale {
    let (low, high) = (variable.low, variable.high);
    let (first, last) = fuzzy::map::changing(variable);
    let width = last - first;
    if width <= 0.0 || width >= (high - low) / 4.0 {
        return Scale::new(low, high);
    }
    let (low, high) = match (first > low, last < high) {
        (true, false) => (first - width, high),
        (false, true) => (low, last + width),
        _ => (
            (first - width / 2.0).max(low),
            (last + width / 2.0).min(high),
        ),
    };
    Scale::new(low, high)
}

/// Chooses a value for each input: the fixed one, the middle of its range, or the peak of a term if the output then
/// varies more over the two axes.
pub fn fixed_values(
    mapped: &Mapped<'_>,
    fixed: &[Option<f64>],
    (x, y): (usize, Option<usize>),
) -> Vec<f64> {
    let inputs = &mapped.model.inputs;
    let middle = |input: &Variable| (input.low + input.high) / 2.0;
    let mut candidates: Vec<Vec<f64>> = inputs
        .iter()
        .zip(fixed)
        .enumerate()
        .map(|(index, (input, fixed))| {
            let middle = middle(input);
            match fixed {
                Some(value) => vec![*value],
                None if index == x || Some(index) == y => vec![middle],
                None => {
                    let mut peaks = fuzzy::map::peaks(input);
                    peaks.sort_by(|a, b| (a - middle).abs().total_cmp(&(b - middle).abs()));
                    [vec![middle], peaks].concat()
                }
            }
        })
        .collect();
    let first: Vec<f64> = candidates
        .iter()
        .filter_map(|c| c.first().copied())
        .collect();
    while candidates.iter().map(Vec::len).product::<usize>() > MAX_TRIED {
        let longest = candidates.iter_mut().max_by_key(|c| c.len());
        longest.into_iter().for_each(|c| c.truncate(c.len() / 2));
    }
    let axes = [Some(x), y].into_iter().flatten();
    let axes: Vec<(usize, Vec<f64>)> = axes
        .filter_map(|input| Some((input, fuzzy::map::peaks(inputs.get(input)?))))
        .collect();
    let (mut best, mut most) = (first.clone(), variation(mapped, &first, &axes));
    for point in combinations(&candidates) {
        let variation = variation(mapped, &point, &axes);
        if variation > most + NOTICEABLE {
            (best, most) = (point, variation);
        }
    }
    best
}

/// Every choice of one value from each list; the last list varies fastest.
pub fn combinations(lists: &[Vec<f64>]) -> Vec<Vec<f64>> {
    lists.iter().fold(vec![Vec::new()], |all, list| {
        let with = |so_far: Vec<f64>| {
            let longer = list
                .iter()
                .map(move |value| [so_far.as_slice(), &[*value]].concat());
            longer.collect::<Vec<_>>()
        };
        all.into_iter().flat_map(with).collect()
    })
}

/// Returns the difference between the lowest and the highest value of the output, as a share of the output's range. The
/// inputs that are axes take every combination of the peaks of their terms.
fn variation(mapped: &Mapped<'_>, point: &[f64], axes: &[(usize, Vec<f64>)]) -> f64 {
    let lists: Vec<Vec<f64>> = axes.iter().map(|(_, peaks)| peaks.clone()).collect();
    let mut scratch = mapped.engine.scratch();
    let mut outcomes = vec![Outcome::default(); mapped.engine.output_names().len()];
    let mut point = point.to_vec();
    let (mut least, mut most) = (f64::INFINITY, f64::NEG_INFINITY);
    for values in combinations(&lists) {
        for ((input, _), axis_value) in axes.iter().zip(values) {
            if let Some(value) = point.get_mut(*input) {
                *value = axis_value;
            }
        }
        let engine = &mapped.engine;
        let reported = engine.evaluate_with(&mut scratch, &point, &mut outcomes);
        let value = outcomes.get(mapped.output).and_then(Outcome::value);
        if let (Ok(()), Some(value)) = (reported, value) {
            (least, most) = (least.min(value), most.max(value));
        }
    }
    let output = mapped.model.outputs.get(mapped.output);
    let range = output.map_or(1.0, |o| o.variable.high - o.variable.low);
    ((most - least) / range).max(0.0)
}
