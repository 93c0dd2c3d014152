//! Points spread over all inputs, for rule sets with too many inputs for a grid.

use flagred_authoring::slice::at;
use fuzzy::model::Variable;

use super::{MapSource, table};
use crate::failure::Failure;

/// Returns a table of the output at the given number of points, which are spread over the inputs.
pub(super) fn table(evaluated: &MapSource, points: u32) -> Result<String, Failure> {
    let mapped = evaluated.mapped();
    let inputs = &evaluated.engine.model().inputs;
    let names = inputs.iter().map(|input| input.name.as_str());
    let output = evaluated.engine.output_names().nth(evaluated.output);
    let mut out = table::head(names, output.unwrap_or_default())?;
    for index in 0..points {
        let point = point(inputs, index);
        let cell = at(&mapped, &point).map_err(|error| Failure::unreadable(error.to_string()))?;
        table::row(&mut out, &point, &cell);
    }
    Ok(out)
}

/// Returns a point of a sequence that fills the ranges evenly (R-sequence): its coordinates are the fractional parts of
/// multiples of 1/g, 1/g^2, ..., plus 0.5, where g is the positive root of g^(n+1) = g + 1 for n inputs.
fn point(inputs: &[Variable], index: u32) -> Vec<f64> {
    let dimensions = inputs.len() as f64;
    let mut root = 2.0_f64;
    for _ in 0..64 {
        root = (1.0 + root).powf(1.0 / (dimensions + 1.0));
    }
    let mut step = 1.0;
    let coordinate = |input: &Variable| {
        step /= root;
        let share = (0.5 + step * (f64::from(index) + 1.0)).fract();
        rounded(input, input.low + (input.high - input.low) * share)
    };
    inputs.iter().map(coordinate).collect()
}

/// Rounds a value to about four digits of the range, which keeps the table short.
fn rounded(input: &Variable, value: f64) -> f64 {
    let width = input.high - input.low;
    let decimals = (3.0 - width.log10().floor()).clamp(0.0, 17.0) as usize;
    let rounded = format!("{value:.decimals$}").parse().unwrap_or(value);
    rounded.clamp(input.low, input.high) + 0.0
}
