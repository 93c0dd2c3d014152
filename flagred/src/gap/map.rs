//! A decision map whose gaps are filled.

use fuzzy::map::DecisionMap;

use super::{Filling, Reading};

/// A decision map without gaps. Cells that rules cover have the value that the rules give; all other cells are filled.
#[derive(Debug, Clone)]
pub struct FilledMap {
    map: DecisionMap,
    filling: Filling,
}

impl FilledMap {
    /// A map with the filling of its rule set. Cells that are in a gap or have no value are filled.
    pub fn new(map: DecisionMap, filling: Filling) -> FilledMap {
        FilledMap { map, filling }
    }

    /// The map before it was filled, with its grid.
    pub fn map(&self) -> &DecisionMap {
        &self.map
    }

    /// Whether the value of a cell comes from filling and not from rules: the cell is in a gap, or the rules give it no
    /// value.
    pub fn is_filled(&self, cell: usize) -> bool {
        self.filling.is_gap(self.map.coverage(cell)) || self.map.value(cell).is_none()
    }

    /// The filled value of a cell; `None` if rules cover it, or if nothing can be filled.
    pub fn filled(&self, cell: usize) -> Option<Reading> {
        if !self.is_filled(cell) || cell >= self.map.grid().cells() {
            return None;
        }
        let grid = self.map.grid();
        let mut inputs = vec![0.0; grid.axes().len() + grid.fixed().len()];
        let axes = grid.axes().iter().map(|axis| axis.input);
        let along = axes.zip(grid.point(cell));
        let fixed = grid.fixed().iter().map(|fixed| (fixed.input, fixed.value));
        for (input, value) in along.chain(fixed) {
            *inputs.get_mut(input)? = value;
        }
        self.filling.read(&inputs)
    }

    /// The value of a cell; `None` off the grid, and if the cell is a gap that cannot be filled.
    pub fn value(&self, cell: usize) -> Option<f64> {
        match self.is_filled(cell) {
            true => self.filled(cell).map(|reading| reading.value),
            false => self.map.value(cell),
        }
    }

    /// The share of the cells that were filled.
    pub fn filled_share(&self) -> f64 {
        let cells = self.map.grid().cells();
        let filled = (0..cells).filter(|cell| self.is_filled(*cell)).count();
        filled as f64 / cells.max(1) as f64
    }

    /// The value at a point with one coordinate for each axis of the grid, interpolated linearly along each axis
    /// between cells; beyond the grid it is constant. `None` if nothing is covered, or if the point has another number
    /// of coordinates.
    pub fn read(&self, point: &[f64]) -> Option<f64> {
        let grid = self.map.grid();
        grid.interpolate(|cell| self.value(cell), point)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::gap::{GapMethod, GapSettings};
    use fuzzy::{Engine, Model, map::Grid};

    fn filled(model: &Model, method: GapMethod) -> FilledMap {
        let engine = Engine::new(model).unwrap();
        let grid = Grid::new(&engine, 51).unwrap();
        let map = DecisionMap::new(&engine, grid, 0).unwrap();
        let settings = GapSettings {
            method,
            coverage_below: None,
        };
        FilledMap::new(map, Filling::new(&engine, model, 0, &settings).unwrap())
    }

    #[test]
    fn the_papers_corner_is_the_gap() {
        let model = crate::shipped::flagred_paper_rules();
        for method in GapMethod::ALL {
            let map = filled(&model, method);
            for cell in 0..51 * 51 {
                let point = map.map().grid().point(cell);
                let in_corner = point[0] < 0.15 - 1e-9 && point[1] < 0.05 - 1e-9;
                assert_eq!(map.is_filled(cell), in_corner, "{point:?}");
                assert_eq!(map.filled(cell).is_some(), in_corner);
            }
            // The cell's spread is 0.04 below the covered part. That is 0.08 of the range, which is 0.5 wide.
            let distance = map.filled(2 * 51 + 1).unwrap().distance;
            approx::assert_abs_diff_eq!(distance, 0.08, epsilon = 1e-12);
        }
    }

    #[test]
    fn a_saturated_drone_has_a_high_risk_with_every_filling() {
        let model = crate::shipped::flagred_paper_rules();
        for method in GapMethod::ALL {
            let map = filled(&model, method);
            for point in [[0.0, 0.0], [0.02, 0.01]] {
                let value = map.read(&point).unwrap();
                assert!(value >= 75.0, "{method:?} at {point:?}: {value}");
            }
        }
    }

    #[test]
    fn inverse_distance_over_all_cells_underestimates_and_neighbours_do_not() {
        let model = crate::shipped::flagred_paper_rules();
        let map = filled(&model, GapMethod::Nearest);
        let (mut sum, mut weights) = (0.0, 0.0);
        for cell in (0..51 * 51).filter(|cell| !map.is_filled(*cell)) {
            let point = map.map().grid().point(cell);
            let weight = 1.0 / ((point[0] / 0.5).powi(2) + (point[1] / 0.5).powi(2));
            sum += weight * map.value(cell).unwrap();
            weights += weight;
        }
        // The usual form of inverse distance weighting, over all covered cells, would give a saturated drone only 49 %.
        approx::assert_abs_diff_eq!(sum / weights, 49.0, epsilon = 2.0);
    }

    #[test]
    fn an_empty_map_is_unknown_everywhere() {
        let mut model = crate::shipped::flagred_paper_rules();
        model.rules.truncate(1);
        model.rules[0].rule.weight = 0.0;
        let map = filled(&model, GapMethod::Nearest);
        assert_eq!(map.read(&[0.1, 0.1]), None);
        assert_eq!((map.value(7), map.value(51 * 51)), (None, None));
        assert_eq!(map.filled_share(), 1.0);
    }

    #[test]
    fn a_slice_is_filled_at_its_fixed_inputs() {
        let model = crate::shipped::flagred_paper_rules();
        let engine = Engine::new(&model).unwrap();
        let whole = filled(&model, GapMethod::Harmonic);
        let slice = Grid::new(&engine, 51).unwrap().fix("margin", 0.02).unwrap();
        let map = DecisionMap::new(&engine, slice, 0).unwrap();
        let slice = FilledMap::new(map, whole.filling.clone());
        for cell in 0..51 {
            assert_eq!(slice.value(cell), whole.value(2 * 51 + cell));
        }
    }
}
