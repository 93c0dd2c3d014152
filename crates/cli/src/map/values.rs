//! A map as numbers: a table for each slice.

use flagred_authoring::slice::Mapped;
use fuzzy::drawing::{map_text, values_text, visible};

use super::{Arguments, MapSource, painted, slice};
use crate::{failure::Failure, output};

/// Maximum number of columns and rows of a table without `--points`.
const SHOWN: usize = 6;
/// Maximum number of slices; more would be too long to read.
const MAX_SLICES: usize = 100;

/// Returns the picture and the values of a map of one or two inputs. With more inputs, it returns the values of a slice at every
/// combination of the peaks of the inputs that are not axes.
pub(super) fn text(arguments: &Arguments, evaluated: &MapSource) -> Result<String, Failure> {
    let shown = arguments.points.map_or(SHOWN, usize::from);
    let axes = slice::axes(arguments, evaluated)?;
    let mapped = evaluated.mapped();
    let others = others(&mapped, &axes);
    if others.iter().all(|(_, peaks)| peaks.len() == 1) {
        let (slice, notes) = slice::cut(arguments, evaluated)?;
        for note in notes {
            output::print_note(&format!("note: {note}"));
        }
        return Ok(map_text(&slice, painted) + &values_text(&slice, shown));
    }
    let slices: usize = others.iter().map(|(_, peaks)| peaks.len()).product();
    if slices > MAX_SLICES {
        let message = format!("the map has {slices} slices, but the limit is {MAX_SLICES}");
        return Err(Failure::usage(message).help(
            "fix inputs with `--hold INPUT=VALUE`, or sample the map with `--csv --sample 1000`",
        ));
    }
    let lists: Vec<Vec<f64>> = others.iter().map(|(_, peaks)| peaks.clone()).collect();
    let mut text = String::new();
    for values in flagred_authoring::slice::combinations(&lists) {
        let mut point = axes.middle.clone();
        for ((input, _), value) in others.iter().zip(values) {
            if let Some(slot) = point.get_mut(*input) {
                *slot = value;
            }
        }
        let slice = flagred_authoring::slice::cut(&mapped, axes.x.clone(), axes.y.clone(), point)
            .map_err(|error| Failure::unreadable(error.to_string()))?;
        let break_line = if text.is_empty() { "" } else { "\n" };
        let across = &slice.x.name;
        let axes = match &slice.y {
            Some(up) => format!("{across} to the right, {} upwards", up.name),
            None => format!("{across} to the right"),
        };
        let heading = format!("{break_line}{}\n{}", slice.heading(), visible(&axes));
        text += &format!("{heading}{}", values_text(&slice, shown));
    }
    Ok(text)
}

/// Returns the inputs that are not axes, each with its peaks. A fixed input, or one that the output does not read, has one value.
fn others(mapped: &Mapped<'_>, axes: &slice::Axes) -> Vec<(usize, Vec<f64>)> {
    let output = mapped.model.outputs.get(mapped.output);
    let read = output.map_or(Vec::new(), |output| {
        mapped.model.inputs_of(&output.variable.name)
    });
    let is_axis =
        |index: usize| axes.x.0 == index || axes.y.as_ref().is_some_and(|(y, _)| *y == index);
    let inputs = mapped.model.inputs.iter().enumerate();
    let others = inputs.filter(|(index, _)| !is_axis(*index));
    let peaks = others.map(|(index, input)| {
        let fixed = axes.fixed.get(index).copied().flatten();
        let middle = axes.middle.get(index).copied();
        let peaks = match fixed {
            Some(value) => vec![value],
            None if read.contains(&input.name.as_str()) => fuzzy::map::peaks(input),
            None => middle.into_iter().collect(),
        };
        (index, peaks)
    });
    peaks.collect()
}
