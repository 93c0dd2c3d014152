//! Inverse distance weighting (Shepard 1968) over the nearest covered knots at the edge of the gap.

use super::{field::Field, neighbours::Tree};

/// Fills the knots that are not covered.
pub(super) fn fill(field: &mut Field, power: f64, neighbours: usize) {
    let at_edge = |knot: &usize| {
        let neighbours = field.neighbours(*knot);
        neighbours.iter().any(|(other, _)| !field.covered[*other])
    };
    let edge: Vec<usize> = field
        .known_highest_first()
        .into_iter()
        .filter(at_edge)
        .collect();
    let mut tree = Tree::new(field.coordinates.len(), field.points(&edge));
    for knot in field.gap() {
        let found = tree.nearest(&field.point(knot), neighbours);
        let (mut sum, mut weights) = (0.0, 0.0);
        for &(square, index) in found {
            let weight = libm::pow(square, -power / 2.0);
            sum += weight * field.values[edge[index]];
            weights += weight;
        }
        if weights > 0.0 {
            field.values[knot] = sum / weights;
        }
    }
}
