//! The search: damped Gauss-Newton steps (Levenberg, Marquardt), with derivatives by finite differences.

use std::ops::ControlFlow;

use nalgebra::{DMatrix, DVector};

use crate::{
    TuneError,
    consequents::solve,
    objective::{Objective, Point},
    parameters::Parameters,
};

/// The step of a finite difference. All free numbers are of the order of 1.
const DIFFERENCE: f64 = 1e-4;

/// The longest step of a free number. All free numbers are of the order of 1.
const LONGEST: f64 = 2.0;

/// A step with a smaller relative gain counts as poor.
const MIN_GAIN: f64 = 1e-7;

/// The number of poor steps that end a search.
const MAX_POOR_STEPS: u32 = 3;

/// Receives the step and the best point that satisfies all claims, if there is one yet, and returns whether to
/// continue.
pub(crate) type SearchCallback<'a> = dyn FnMut(u32, Option<&Point>) -> ControlFlow<()> + 'a;

/// Searches from given free numbers, for at most `iterations` steps. `watch` is called before each step and can end
/// the search. A random start may violate a claim; the search then has no point to report until a step satisfies all
/// claims.
pub(crate) fn search(
    objective: &Objective<'_>,
    parameters: &Parameters,
    from: &[f64],
    iterations: u32,
    watch: &mut SearchCallback<'_>,
) -> Result<(Option<Point>, ControlFlow<()>), TuneError> {
    let limits = parameters.limits();
    let mut z = within(&limits, from.iter().copied());
    let mut at = objective.fitted(parameters.model(&z))?;
    let mut holds = objective.broken_claim(&at.model)?.is_none();
    let mut damping = 1e-2;
    let mut poor = 0;
    for iteration in 1..=iterations {
        if watch(iteration, holds.then_some(&at)).is_break() {
            return Ok((holds.then_some(at), ControlFlow::Break(())));
        }
        if z.is_empty() {
            break;
        }
        let (squares, products) = normal_equations(objective, parameters, &limits, &z, &at)?;
        let before = at.slopes.loss;
        let bounded = (parameters, limits.as_slice());
        let Some((step, next, used)) =
            step(objective, bounded, &z, &at, &squares, &products, damping)?
        else {
            break;
        };
        z = step;
        at = next;
        holds = true;
        damping = (used / 4.0).max(1e-9);
        let gain = before - at.slopes.loss;
        poor = if gain < MIN_GAIN * before {
            poor + 1
        } else {
            0
        };
        if poor == MAX_POOR_STEPS {
            break;
        }
    }
    Ok((holds.then_some(at), ControlFlow::Continue(())))
}

/// Clamps free numbers to their limits.
fn within(limits: &[(f64, f64)], free: impl Iterator<Item = f64>) -> Vec<f64> {
    let pairs = free.zip(limits);
    pairs.map(|(z, (low, high))| z.clamp(*low, *high)).collect()
}

/// The curvature of the loss with respect to the free numbers, and the negative gradient.
fn normal_equations(
    objective: &Objective<'_>,
    parameters: &Parameters,
    limits: &[(f64, f64)],
    z: &[f64],
    at: &Point,
) -> Result<(DMatrix<f64>, DVector<f64>), TuneError> {
    let mut columns: Vec<Vec<f64>> = Vec::with_capacity(z.len());
    for (i, (_, high)) in limits.iter().enumerate() {
        // At the upper limit, and only there, the difference is taken downwards.
        let difference = match z[i] + DIFFERENCE > *high {
            true => -DIFFERENCE,
            false => DIFFERENCE,
        };
        let mut moved = z.to_vec();
        moved[i] += difference;
        let moved = objective.fitted(parameters.model(&moved))?;
        let pairs = moved.predictions.iter().zip(&at.predictions);
        let slope = |(moved, at): (&f64, &f64)| {
            let slope = (moved - at) / difference;
            if slope.is_finite() { slope } else { 0.0 }
        };
        columns.push(pairs.map(slope).collect());
    }
    let sum = |terms: &mut dyn Iterator<Item = f64>| terms.sum::<f64>();
    let products = columns.iter().map(|column| {
        let terms = column.iter().zip(&at.slopes.first);
        -sum(&mut terms.map(|(slope, first)| slope * first))
    });
    let products = DVector::from_iterator(z.len(), products);
    let squares = DMatrix::from_fn(z.len(), z.len(), |i, j| {
        if j > i {
            return 0.0;
        }
        let slopes = columns[i].iter().zip(&columns[j]).zip(&at.slopes.second);
        sum(&mut slopes.map(|((a, b), second)| a * b * second))
    });
    let (mut squares, mut products) = (squares, products);
    squares.fill_upper_triangle_with_lower_triangle();
    hold(limits, z, &mut squares, &mut products);
    Ok((squares, products))
}

/// Removes from the equations the numbers that are at a limit and would exceed it, so that the steps of the other
/// numbers do not depend on them.
fn hold(limits: &[(f64, f64)], z: &[f64], squares: &mut DMatrix<f64>, products: &mut DVector<f64>) {
    let largest = squares.diagonal().max();
    for (i, ((low, high), z)) in limits.iter().zip(z).enumerate() {
        if (z >= high && products[i] > 0.0) || (z <= low && products[i] < 0.0) {
            squares.row_mut(i).fill(0.0);
            squares.column_mut(i).fill(0.0);
            squares[(i, i)] = largest;
            products[i] = 0.0;
        }
    }
}

/// The next point: the damping increases until the loss decreases and no constraint is violated. `None` if no step
/// succeeds.
fn step(
    objective: &Objective<'_>,
    (parameters, limits): (&Parameters, &[(f64, f64)]),
    z: &[f64],
    at: &Point,
    squares: &DMatrix<f64>,
    products: &DVector<f64>,
    mut damping: f64,
) -> Result<Option<(Vec<f64>, Point, f64)>, TuneError> {
    const MAX_TRIES: u32 = 12;
    for _ in 0..MAX_TRIES {
        let Some(step) = solve(squares.clone(), products, damping) else {
            return Ok(None);
        };
        let moved = z.iter().zip(step.iter());
        let moved = moved.map(|(z, step)| z + step.clamp(-LONGEST, LONGEST));
        let moved = within(limits, moved);
        let next = objective.fitted(parameters.model(&moved))?;
        if next.slopes.loss < at.slopes.loss && objective.broken_claim(&next.model)?.is_none() {
            return Ok(Some((moved, next, damping)));
        }
        damping *= 5.0;
    }
    Ok(None)
}
