//! Defaults of a picture: the part of each axis that is shown, and the values at which the other inputs are held.

use fuzzy::{drawing::Scale, engine::Outcome, model::Variable};

use super::Evaluated;

/// Combinations of held values that are tried.
const MOST_TRIED: usize = 1000;

/// An input is held off its middle only where the output then varies more by this share of its range.
const NOTICEABLE: f64 = 0.01;

/// The part of an input's range that is shown: the whole range, or twice the part where the terms change if that is less
/// than a quarter of the range.
pub(super) fn shown(variable: &Variable) -> Scale {
    let (low, high) = (variable.low, variable.high);
    let (first, last) = flagred::gap::changing(variable);
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

/// A value for each input: the fixed one, the middle of its range, or the peak of a term where the output varies more
/// over the two axes.
pub(super) fn held(
    evaluated: &Evaluated,
    fixed: &[Option<f64>],
    (x, y): (usize, Option<usize>),
) -> Vec<f64> {
    let inputs = &evaluated.model.inputs;
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
                    let mut peaks = flagred::gap::peaks(input);
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
    while candidates.iter().map(Vec::len).product::<usize>() > MOST_TRIED {
        let longest = candidates.iter_mut().max_by_key(|c| c.len());
        longest.into_iter().for_each(|c| c.truncate(c.len() / 2));
    }
    let axes = [Some(x), y].into_iter().flatten();
    let axes: Vec<(usize, Vec<f64>)> = axes
        .filter_map(|input| Some((input, flagred::gap::peaks(inputs.get(input)?))))
        .collect();
    let (mut best, mut most) = (first.clone(), variation(evaluated, &first, &axes));
    for point in combinations(&candidates) {
        let variation = variation(evaluated, &point, &axes);
        if variation > most + NOTICEABLE {
            (best, most) = (point, variation);
        }
    }
    best
}

/// Every choice of one value from each list; the last list varies fastest.
fn combinations(lists: &[Vec<f64>]) -> Vec<Vec<f64>> {
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

/// From the lowest to the highest value of the output over the peaks of the axes, as a share of its range.
fn variation(evaluated: &Evaluated, point: &[f64], axes: &[(usize, Vec<f64>)]) -> f64 {
    let lists: Vec<Vec<f64>> = axes.iter().map(|(_, peaks)| peaks.clone()).collect();
    let mut scratch = evaluated.engine.scratch();
    let mut outcomes = vec![Outcome::default(); evaluated.engine.output_names().len()];
    let mut point = point.to_vec();
    let (mut least, mut most) = (f64::INFINITY, f64::NEG_INFINITY);
    for values in combinations(&lists) {
        for ((input, _), axis_value) in axes.iter().zip(values) {
            if let Some(value) = point.get_mut(*input) {
                *value = axis_value;
            }
        }
        let engine = &evaluated.engine;
        let told = engine.evaluate_with(&mut scratch, &point, &mut outcomes);
        let value = outcomes.get(evaluated.output).and_then(Outcome::value);
        if let (Ok(()), Some(value)) = (told, value) {
            (least, most) = (least.min(value), most.max(value));
        }
    }
    let output = evaluated.model.outputs.get(evaluated.output);
    let range = output.map_or(1.0, |o| o.variable.high - o.variable.low);
    ((most - least) / range).max(0.0)
}
