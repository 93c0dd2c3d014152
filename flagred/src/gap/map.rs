//! A decision map whose gaps are filled.

use fuzzy::map::DecisionMap;

use super::{Filling, Reading};

/// A decision map without gaps: what rules cover is as they say, what they do not is filled from there.
///
/// # Example: the corner that rules leave open
/// ```
/// # use flagred::gap::{FilledMap, Filling, GapSettings};
/// # use fuzzy::{Engine, map::{DecisionMap, Grid}};
/// # let model = flagred::shipped::rule_set("flagred-paper").ok_or("not shipped")??;
/// # let engine = Engine::new(&model)?;
/// # let filling = Filling::new(&engine, &model, 0, &GapSettings::default())?;
/// # let map = DecisionMap::new(&engine, Grid::new(&engine, 11)?, 0)?;
/// let bare = map.coverage(0);
/// let filled = FilledMap::new(map, filling);
/// assert!(bare < 0.5 && filled.value(0) > Some(75.0));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug, Clone)]
pub struct FilledMap {
    map: DecisionMap,
    filling: Filling,
}

impl FilledMap {
    /// A map with the filling of its rule set. Cells that are a gap or have no value are filled.
    ///
    /// # Example: the corner that the paper's rules do not cover
    ///
    /// ```
    /// use flagred::gap::{FilledMap, Filling, GapSettings};
    /// use fuzzy::{Engine, map::{DecisionMap, Grid}};
    ///
    /// let model = flagred::shipped::rule_set("flagred-paper").ok_or("not shipped")??;
    /// let engine = Engine::new(&model)?;
    /// let map = DecisionMap::new(&engine, Grid::new(&engine, 51)?, 0)?;
    /// let filling = Filling::new(&engine, &model, 0, &GapSettings::default())?;
    /// let filled = FilledMap::new(map, filling);
    ///
    /// assert!(filled.is_filled(0) && filled.value(0).is_some_and(|risk| risk > 75.0));
    /// assert!(!filled.is_filled(51 * 51 - 1));
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn new(map: DecisionMap, filling: Filling) -> FilledMap {
        FilledMap { map, filling }
    }

    /// The map before it was filled, with its grid.
    ///
    /// # Example: the grid that cells are counted on
    /// ```
    /// # use flagred::gap::{FilledMap, Filling, GapSettings};
    /// # use fuzzy::{Engine, map::{DecisionMap, Grid}};
    /// # let model = flagred::shipped::rule_set("flagred-paper").ok_or("not shipped")??;
    /// # let engine = Engine::new(&model)?;
    /// # let filling = Filling::new(&engine, &model, 0, &GapSettings::default())?;
    /// # let map = DecisionMap::new(&engine, Grid::new(&engine, 11)?, 0)?;
    /// let filled = FilledMap::new(map, filling);
    /// assert_eq!(filled.map().grid().point(0), [0.0, 0.0]);
    /// assert_eq!(filled.map().value(0), None); // before it was filled
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn map(&self) -> &DecisionMap {
        &self.map
    }

    /// Whether a cell is not as rules say.
    ///
    /// # Example: margins below 0.15 at a spread of 0
    /// ```
    /// # use flagred::gap::{FilledMap, Filling, GapSettings};
    /// # use fuzzy::{Engine, map::{DecisionMap, Grid}};
    /// # let model = flagred::shipped::rule_set("flagred-paper").ok_or("not shipped")??;
    /// # let engine = Engine::new(&model)?;
    /// # let filling = Filling::new(&engine, &model, 0, &GapSettings::default())?;
    /// # let map = DecisionMap::new(&engine, Grid::new(&engine, 11)?, 0)?;
    /// let filled = FilledMap::new(map, filling);
    /// let row = (0..11).map(|margin| 11 * margin); // a step of 0.05 in the margin is 11 cells on
    /// let open: Vec<usize> = row.filter(|&cell| filled.is_filled(cell)).collect();
    /// assert_eq!(open, [0, 11, 22]);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn is_filled(&self, cell: usize) -> bool {
        self.filling.is_gap(self.map.coverage(cell)) || self.map.value(cell).is_none()
    }

    /// The filling at a cell; `None` where rules say what it is, or there is nothing to fill from.
    ///
    /// # Example: how far it was filled from
    /// ```
    /// # use flagred::gap::{FilledMap, Filling, GapSettings};
    /// # use fuzzy::{Engine, map::{DecisionMap, Grid}};
    /// # let model = flagred::shipped::rule_set("flagred-paper").ok_or("not shipped")??;
    /// # let engine = Engine::new(&model)?;
    /// # let filling = Filling::new(&engine, &model, 0, &GapSettings::default())?;
    /// # let map = DecisionMap::new(&engine, Grid::new(&engine, 11)?, 0)?;
    /// let filled = FilledMap::new(map, filling);
    /// let corner = filled.filled(0).ok_or("not filled")?;
    /// assert!((corner.distance - 0.1).abs() < 1e-9);
    /// assert_eq!(filled.filled(11 * 11 - 1), None); // rules speak there
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
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

    /// The value of a cell; `None` where nothing is covered to fill it from, and off the grid.
    ///
    /// # Example: where rules speak they are left alone
    /// ```
    /// # use flagred::gap::{FilledMap, Filling, GapSettings};
    /// # use fuzzy::{Engine, map::{DecisionMap, Grid}};
    /// # let model = flagred::shipped::rule_set("flagred-paper").ok_or("not shipped")??;
    /// # let engine = Engine::new(&model)?;
    /// # let filling = Filling::new(&engine, &model, 0, &GapSettings::default())?;
    /// # let map = DecisionMap::new(&engine, Grid::new(&engine, 11)?, 0)?;
    /// let (said, cells) = (map.value(11 * 11 - 1), map.grid().cells());
    /// let filled = FilledMap::new(map, filling);
    /// assert_eq!(filled.value(11 * 11 - 1), said);
    /// assert!((0..cells).all(|cell| filled.value(cell).is_some()));
    /// assert_eq!(filled.value(cells), None); // off the grid
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn value(&self, cell: usize) -> Option<f64> {
        match self.is_filled(cell) {
            true => self.filled(cell).map(|reading| reading.value),
            false => self.map.value(cell),
        }
    }

    /// The share of the cells that were filled.
    ///
    /// # Example: 3 of 121 cells
    /// ```
    /// # use flagred::gap::{FilledMap, Filling, GapSettings};
    /// # use fuzzy::{Engine, map::{DecisionMap, Grid}};
    /// # let model = flagred::shipped::rule_set("flagred-paper").ok_or("not shipped")??;
    /// # let engine = Engine::new(&model)?;
    /// # let filling = Filling::new(&engine, &model, 0, &GapSettings::default())?;
    /// # let map = DecisionMap::new(&engine, Grid::new(&engine, 11)?, 0)?;
    /// assert_eq!(FilledMap::new(map, filling).filled_share(), 3.0 / 121.0);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn filled_share(&self) -> f64 {
        let cells = self.map.grid().cells();
        let filled = (0..cells).filter(|cell| self.is_filled(*cell)).count();
        filled as f64 / cells.max(1) as f64
    }

    /// The value at a point with a coordinate for each axis of the grid, N-linearly between cells; beyond the grid,
    /// at its end. `None` where nothing is covered, or the point has another number of coordinates.
    ///
    /// # Example: half way between two cells
    /// ```
    /// # use flagred::gap::{FilledMap, Filling, GapSettings};
    /// # use fuzzy::{Engine, map::{DecisionMap, Grid}};
    /// # let model = flagred::shipped::rule_set("flagred-paper").ok_or("not shipped")??;
    /// # let engine = Engine::new(&model)?;
    /// # let filling = Filling::new(&engine, &model, 0, &GapSettings::default())?;
    /// # let map = DecisionMap::new(&engine, Grid::new(&engine, 11)?, 0)?;
    /// let filled = FilledMap::new(map, filling);
    /// let (here, next) = (filled.value(0).ok_or("unknown")?, filled.value(1).ok_or("unknown")?);
    /// let between = filled.read(&[0.0, 0.025]).ok_or("unknown")?;
    /// assert!((between - (here + next) / 2.0).abs() < 1e-9);
    /// assert_eq!(filled.read(&[-1.0, 0.0]), Some(here)); // beyond the grid, as at its end
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
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
        let model = crate::shipped::rule_set("flagred-paper").unwrap().unwrap();
        for method in GapMethod::ALL {
            let map = filled(&model, method);
            for cell in 0..51 * 51 {
                let point = map.map().grid().point(cell);
                let in_corner = point[0] < 0.15 - 1e-9 && point[1] < 0.05 - 1e-9;
                assert_eq!(map.is_filled(cell), in_corner, "{point:?}");
                assert_eq!(map.filled(cell).is_some(), in_corner);
            }
            // 0.04 below the covered part, in shares of a range of 0.5.
            let distance = map.filled(2 * 51 + 1).unwrap().distance;
            approx::assert_abs_diff_eq!(distance, 0.08, epsilon = 1e-12);
        }
    }

    #[test]
    fn a_saturated_drone_reads_high_whatever_fills_the_papers_corner() {
        let model = crate::shipped::rule_set("flagred-paper").unwrap().unwrap();
        for method in GapMethod::ALL {
            let map = filled(&model, method);
            for point in [[0.0, 0.0], [0.02, 0.01]] {
                let value = map.read(&point).unwrap();
                assert!(value >= 75.0, "{method:?} at {point:?}: {value}");
            }
        }
    }

    #[test]
    fn inverse_distance_over_all_cells_is_the_trap_that_neighbours_avoid() {
        let model = crate::shipped::rule_set("flagred-paper").unwrap().unwrap();
        let map = filled(&model, GapMethod::Nearest);
        let (mut sum, mut weights) = (0.0, 0.0);
        for cell in (0..51 * 51).filter(|cell| !map.is_filled(*cell)) {
            let point = map.map().grid().point(cell);
            let weight = 1.0 / ((point[0] / 0.5).powi(2) + (point[1] / 0.5).powi(2));
            sum += weight * map.value(cell).unwrap();
            weights += weight;
        }
        // The classic form calls a saturated drone harmless.
        approx::assert_abs_diff_eq!(sum / weights, 49.0, epsilon = 2.0);
    }

    #[test]
    fn a_map_of_nothing_reads_as_unknown() {
        let mut model = crate::shipped::rule_set("flagred-paper").unwrap().unwrap();
        model.rules.truncate(1);
        model.rules[0].rule.weight = 0.0;
        let map = filled(&model, GapMethod::Nearest);
        assert_eq!(map.read(&[0.1, 0.1]), None);
        assert_eq!((map.value(7), map.value(51 * 51)), (None, None));
        assert_eq!(map.filled_share(), 1.0);
    }

    #[test]
    fn a_slice_is_filled_with_its_fixed_inputs_in_their_places() {
        let model = crate::shipped::rule_set("flagred-paper").unwrap().unwrap();
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
