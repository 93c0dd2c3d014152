//! The harmonic filling: the solution of Laplace's equation in the gap, with the covered knots around it held.
//!
//! Every filled value is the mean of its neighbours, each weighted with the area of the wall between the two and divided
//! by their distance (finite volumes), so there is no extreme inside the gap: it cannot overshoot. The outer ends of
//! the grid are free: nothing flows across them.

use super::field::Field;

/// A sweep that changes no value by more than this share of the span of the known values ends the iteration.
const TOLERANCE: f64 = 1e-9;

/// Gaps are a few terms wide, and settle long before.
const MOST_SWEEPS: usize = 20_000;

/// Over-relaxation: changes are taken by half as much again.
const RELAXATION: f64 = 1.5;

/// Fills the knots that are not covered, starting from the values they have.
pub(super) fn fill(field: &mut Field) {
    let known = || {
        field
            .known_highest_first()
            .into_iter()
            .map(|k| field.values[k])
    };
    let low = known().fold(f64::INFINITY, f64::min);
    let high = known().fold(f64::NEG_INFINITY, f64::max);
    let gap: Vec<(usize, Vec<(usize, f64)>)> = field
        .gap()
        .into_iter()
        .map(|knot| (knot, field.beside(knot)))
        .collect();
    for _ in 0..MOST_SWEEPS {
        let mut largest = 0.0_f64;
        for (knot, beside) in &gap {
            let weights: f64 = beside.iter().map(|(_, weight)| weight).sum();
            let sum: f64 = beside
                .iter()
                .map(|(k, weight)| weight * field.values[*k])
                .sum();
            let step = RELAXATION * (sum / weights - field.values[*knot]);
            field.values[*knot] += step;
            largest = largest.max(step.abs());
        }
        if largest <= TOLERANCE * (high - low) {
            break;
        }
    }
    // The iteration approaches its limit from both sides.
    for (knot, _) in gap {
        field.values[knot] = field.values[knot].clamp(low, high);
    }
}
