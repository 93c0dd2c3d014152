//! The harmonic filling: the solution of Laplace's equation in the gap, with the covered cells at its edge held.
//!
//! Every filled value is the mean of its neighbours (weighted with `1 / step^2` along each axis), so there is no
//! extreme inside the gap: it cannot overshoot. The outer ends of the grid are free: nothing flows across them.

use super::fill::Lattice;

/// A sweep that changes no value by more than this share of the span of the known values ends the iteration.
const TOLERANCE: f64 = 1e-7;

/// Fills the nodes that are not covered, starting from the values they have; `deepest` is how far, in shares of the
/// ranges, the gap reaches away from the covered part.
pub(super) fn fill(lattice: &Lattice, covered: &[bool], values: &mut [f64], deepest: f64) {
    let axes: Vec<(usize, f64)> = lattice
        .strides
        .iter()
        .enumerate()
        .map(|(axis, stride)| (*stride, lattice.step(axis).powi(-2)))
        .collect();
    let known = || values.iter().zip(covered).filter(|(_, c)| **c);
    let low = known().map(|(v, _)| *v).fold(f64::INFINITY, f64::min);
    let high = known().map(|(v, _)| *v).fold(f64::NEG_INFINITY, f64::max);
    let gap = open_sides(lattice, covered);

    // Successive over-relaxation, with the factor that is best on a strip with one held and one free end.
    let finest = (0..axes.len())
        .map(|axis| lattice.step(axis))
        .fold(1.0, f64::min);
    let depth = deepest / finest + 1.0;
    let relaxation = 2.0 / (1.0 + libm::sin(core::f64::consts::PI / (2.0 * depth + 1.0)));
    let most_sweeps = 100 + 20 * depth as usize;
    for _ in 0..most_sweeps {
        let mut largest = 0.0_f64;
        for &(node, sides) in &gap {
            let node = node as usize;
            let (mut sum, mut weights) = (0.0, 0.0);
            for (axis, &(stride, weight)) in axes.iter().enumerate() {
                if sides >> (2 * axis) & 1 == 1 {
                    sum += weight * values[node - stride];
                    weights += weight;
                }
                if sides >> (2 * axis + 1) & 1 == 1 {
                    sum += weight * values[node + stride];
                    weights += weight;
                }
            }
            let step = relaxation * (sum / weights - values[node]);
            values[node] += step;
            largest = largest.max(step.abs());
        }
        if largest <= TOLERANCE * (high - low) {
            break;
        }
    }
    // The iteration approaches its limit from both sides.
    for (node, _) in gap {
        let value = &mut values[node as usize];
        *value = value.clamp(low, high);
    }
}

/// The nodes of the gap, each with a bit for every neighbour it has: before and behind along each axis.
fn open_sides(lattice: &Lattice, covered: &[bool]) -> Vec<(u32, u32)> {
    (0..covered.len())
        .filter(|node| !covered[*node])
        .map(|node| {
            let sides = (0..lattice.shape.len()).fold(0, |sides, axis| {
                let place = lattice.place(node, axis);
                let before = u32::from(place > 0);
                let behind = u32::from(place + 1 < lattice.shape[axis]);
                sides | before << (2 * axis) | behind << (2 * axis + 1)
            });
            (node as u32, sides)
        })
        .collect()
}
