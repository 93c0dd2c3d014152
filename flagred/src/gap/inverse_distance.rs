//! Inverse distance weighting (Shepard 1968) over the nearest covered nodes at the edge of the gap.

use super::{fill::Lattice, neighbours::Tree};

/// Fills the nodes that are not covered.
pub(super) fn fill(
    lattice: &Lattice,
    covered: &[bool],
    values: &mut [f64],
    power: f64,
    neighbours: usize,
) {
    let edge: Vec<usize> = (0..covered.len())
        .filter(|node| covered[*node] && lattice.neighbours(*node).any(|n| !covered[n]))
        .collect();
    let dimensions = lattice.shape.len();
    let mut tree = Tree::new(
        dimensions,
        edge.iter().flat_map(|node| lattice.point(*node)).collect(),
    );
    let gap: Vec<usize> = (0..covered.len()).filter(|node| !covered[*node]).collect();
    for node in gap {
        let found = tree.nearest(&lattice.point(node), neighbours);
        let (mut sum, mut weights) = (0.0, 0.0);
        for &(square, index) in found {
            let weight = libm::pow(square, -power / 2.0);
            sum += weight * values[edge[index]];
            weights += weight;
        }
        if weights > 0.0 {
            values[node] = sum / weights;
        }
    }
}
