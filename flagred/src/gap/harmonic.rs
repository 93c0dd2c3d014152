//! The harmonic filling: the solution of Laplace's equation in the gap, with the surrounding covered knots fixed.
//!
//! Every filled value is the mean of its neighbours, each weighted with the area of the wall between the two cells
//! divided by the distance of the two knots (finite volumes). So there is no extremum inside the gap, and the
//! solution cannot overshoot. No flux crosses the outer ends of the grid.

use super::field::Field;

/// The iteration ends after a sweep that changes no value by more than this share of the span of the known values.
const TOLERANCE: f64 = 1e-9;

/// The maximum number of sweeps. Gaps are a few terms wide, so the iteration converges long before this limit.
const MAX_SWEEPS: usize = 20_000;

/// The over-relaxation factor.
const RELAXATION: f64 = 1.5;

/// Fills the knots that are not covered, starting from their current values.
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
        .map(|knot| (knot, field.neighbours(knot)))
        .collect();
    for _ in 0..MAX_SWEEPS {
        let mut largest = 0.0_f64;
        for (knot, neighbours) in &gap {
            let weights: f64 = neighbours.iter().map(|(_, weight)| weight).sum();
            let sum: f64 = neighbours
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
    // Because of rounding, the iteration can leave the range of the known values.
    for (knot, _) in gap {
        field.values[knot] = field.values[knot].clamp(low, high);
    }
}
