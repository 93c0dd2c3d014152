//! The knots of a rule set with their values and their neighbours.

use alloc::vec::Vec;

use super::knots::Knots;

/// Knots with their values, in the form that the filling methods use.
#[derive(Debug, Clone)]
pub(super) struct Field<'a> {
    pub(super) knots: &'a Knots,
    /// The coordinates of the knots along each axis, scaled by the metric.
    pub(super) coordinates: Vec<Vec<f64>>,
    pub(super) covered: Vec<bool>,
    pub(super) values: Vec<f64>,
}

impl Field<'_> {
    /// The knots that are not covered.
    pub(super) fn gap(&self) -> Vec<usize> {
        (0..self.covered.len())
            .filter(|k| !self.covered[*k])
            .collect()
    }

    /// The covered knots, highest values first. Methods prefer the first of equally near knots, and thereby the one
    /// with the highest risk.
    pub(super) fn known_highest_first(&self) -> Vec<usize> {
        let mut known: Vec<usize> = (0..self.covered.len())
            .filter(|k| self.covered[*k])
            .collect();
        known.sort_by(|a, b| self.values[*b].total_cmp(&self.values[*a]).then(a.cmp(b)));
        known
    }

    /// The coordinates of a knot.
    pub(super) fn point(&self, knot: usize) -> Vec<f64> {
        let axes = self.coordinates.iter().enumerate();
        axes.map(|(axis, coordinates)| coordinates[self.knots.index_along(knot, axis)])
            .collect()
    }

    /// The coordinates of several knots, concatenated.
    pub(super) fn points(&self, knots: &[usize]) -> Vec<f64> {
        knots.iter().flat_map(|knot| self.point(*knot)).collect()
    }

    /// The neighbours of a knot, each with the area of the wall between the two cells divided by the distance of
    /// the two knots. The cell around a knot reaches halfway to its neighbours.
    pub(super) fn neighbours(&self, knot: usize) -> Vec<(usize, f64)> {
        let knots = self.knots;
        let width = |axis: usize| {
            let (index, coordinates) = (knots.index_along(knot, axis), &self.coordinates[axis]);
            let before = index
                .checked_sub(1)
                .map_or(0.0, |b| coordinates[index] - coordinates[b]);
            let behind = coordinates
                .get(index + 1)
                .map_or(0.0, |b| b - coordinates[index]);
            // An input with only one knot does not change the size of the cell.
            if coordinates.len() > 1 {
                (before + behind) / 2.0
            } else {
                1.0
            }
        };
        let cell: f64 = (0..self.coordinates.len()).map(width).product();
        let mut neighbours = Vec::new();
        for (axis, coordinates) in self.coordinates.iter().enumerate() {
            for other in [knots.previous(knot, axis), knots.next(knot, axis)] {
                let Some(other) = other else {
                    continue;
                };
                let step = coordinates[knots.index_along(other, axis)]
                    - coordinates[knots.index_along(knot, axis)];
                neighbours.push((other, cell / width(axis) / step.abs()));
            }
        }
        neighbours
    }
}
