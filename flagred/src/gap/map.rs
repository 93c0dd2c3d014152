//! A decision map whose gaps are filled.

use fuzzy::map::DecisionMap;

use super::{GapMethod, Lattice, fill, is_gap};

/// A decision map without gaps: what rules cover is as they say, what they do not is filled from there.
///
/// # Example: the corner that the paper marks
/// ```
/// # use flagred::gap::{FilledMap, GapMethod};
/// # use fuzzy::{Engine, map::{DecisionMap, Grid}};
/// # let model = flagred::shipped::rule_set("flagred-paper").ok_or("not shipped")??;
/// # let engine = Engine::new(&model)?;
/// let map = DecisionMap::new(&engine, Grid::new(&engine, 51)?, 0)?;
/// let filled = FilledMap::new(map, 0.5, GapMethod::ThinPlate);
/// // Saturated motors, no spread: the paper has no rule, and the map around it says what to expect.
/// assert_eq!(filled.map().value(0), None);
/// assert!(filled.value(0).is_some_and(|risk| risk > 85.0));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug, Clone)]
pub struct FilledMap {
    map: DecisionMap,
    /// NaN where nothing could be filled; never shown.
    values: Vec<f64>,
    distances: Vec<f32>,
}

/// A value read from a [`FilledMap`].
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Reading {
    /// The value.
    pub value: f64,
    /// How far the nearest covered cell is, in shares of the inputs' ranges; 0 within the covered part.
    pub distance: f64,
}

impl FilledMap {
    /// Fills the cells whose coverage is below `coverage_below`, or that have no value.
    ///
    /// # Example: a gap in the middle of a line
    ///
    /// ```
    /// use flagred::gap::{FilledMap, GapMethod};
    /// use fuzzy::{Engine, map::{DecisionMap, Grid}};
    ///
    /// let model = fuzzy::yaml::parse("
    /// fuzzy: 1
    /// name: two ends
    /// inputs: {x: {range: [0, 1], partition: {low: 0, middle: 0.5, high: 1}}}
    /// outputs: {y: {range: [0, 100], partition: [small, medium, large]}}
    /// rules: [IF x IS low THEN y IS small, IF x IS high THEN y IS large]
    /// ")?.model;
    /// let engine = Engine::new(&model)?;
    /// let map = DecisionMap::new(&engine, Grid::new(&engine, 5)?, 0)?;
    /// assert_eq!(map.value(2), None);
    ///
    /// let method = GapMethod::InverseDistance { power: 2.0, neighbours: 2 };
    /// let filled = FilledMap::new(map, 0.5, method);
    /// let middle = filled.read(&[0.5]).ok_or("nothing is covered")?;
    /// assert_eq!((middle.value, middle.distance), (50.0, 0.25));
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn new(map: DecisionMap, coverage_below: f64, method: GapMethod) -> FilledMap {
        let cells = 0..map.grid().cells();
        let covered: Vec<bool> = cells
            .clone()
            .map(|cell| !is_gap(map.coverage(cell), coverage_below) && map.value(cell).is_some())
            .collect();
        let mut values: Vec<f64> = cells
            .map(|cell| map.value(cell).unwrap_or(f64::NAN))
            .collect();
        let shape: Vec<usize> = map.grid().axes().iter().map(|axis| axis.points).collect();
        let distances = fill(
            &Lattice::new(&shape),
            &covered,
            &mut values,
            map.range(),
            method,
        );
        for (value, distance) in values.iter_mut().zip(&distances) {
            if distance.is_infinite() {
                *value = f64::NAN;
            }
        }
        FilledMap {
            map,
            values,
            distances,
        }
    }

    /// The map before it was filled, with its grid.
    ///
    /// # Example
    /// ```
    /// # use flagred::gap::{FilledMap, GapMethod};
    /// # use fuzzy::{Engine, map::{DecisionMap, Grid}};
    /// # let model = flagred::shipped::rule_set("flagred-paper").ok_or("not shipped")??;
    /// # let engine = Engine::new(&model)?;
    /// let map = DecisionMap::new(&engine, Grid::new(&engine, 51)?, 0)?;
    /// let filled = FilledMap::new(map, 0.5, GapMethod::ThinPlate);
    /// assert_eq!(filled.map().grid().cells(), 51 * 51);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn map(&self) -> &DecisionMap {
        &self.map
    }

    /// The value of a cell; `None` where nothing is covered to fill it from, and off the grid.
    ///
    /// # Example
    /// ```
    /// # use flagred::gap::{FilledMap, GapMethod};
    /// # use fuzzy::{Engine, map::{DecisionMap, Grid}};
    /// # let model = flagred::shipped::rule_set("flagred-paper").ok_or("not shipped")??;
    /// # let engine = Engine::new(&model)?;
    /// let map = DecisionMap::new(&engine, Grid::new(&engine, 51)?, 0)?;
    /// let filled = FilledMap::new(map, 0.5, GapMethod::ThinPlate);
    /// assert!((0..51 * 51).all(|cell| filled.value(cell).is_some()));
    /// assert_eq!(filled.value(51 * 51), None); // off the grid
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn value(&self, cell: usize) -> Option<f64> {
        self.values.get(cell).copied().filter(|v| !v.is_nan())
    }

    /// The distance of a cell to the nearest covered one, in shares of the inputs' ranges: 0 for a covered one,
    /// infinite where there is none.
    ///
    /// # Example
    /// ```
    /// # use flagred::gap::{FilledMap, GapMethod};
    /// # use fuzzy::{Engine, map::{DecisionMap, Grid}};
    /// # let model = flagred::shipped::rule_set("flagred-paper").ok_or("not shipped")??;
    /// # let engine = Engine::new(&model)?;
    /// let map = DecisionMap::new(&engine, Grid::new(&engine, 51)?, 0)?;
    /// let filled = FilledMap::new(map, 0.5, GapMethod::ThinPlate);
    /// assert!(filled.distance(0) > 0.0);
    /// assert_eq!(filled.distance(51 * 51 - 1), 0.0); // covered
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn distance(&self, cell: usize) -> f64 {
        self.distances
            .get(cell)
            .map_or(f64::INFINITY, |d| f64::from(*d))
    }

    /// Whether a cell was filled.
    ///
    /// # Example
    /// ```
    /// # use flagred::gap::{FilledMap, GapMethod};
    /// # use fuzzy::{Engine, map::{DecisionMap, Grid}};
    /// # let model = flagred::shipped::rule_set("flagred-paper").ok_or("not shipped")??;
    /// # let engine = Engine::new(&model)?;
    /// let map = DecisionMap::new(&engine, Grid::new(&engine, 51)?, 0)?;
    /// let filled = FilledMap::new(map, 0.5, GapMethod::ThinPlate);
    /// assert!(filled.is_filled(0) && !filled.is_filled(51 * 51 - 1));
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn is_filled(&self, cell: usize) -> bool {
        self.distance(cell) > 0.0
    }

    /// The share of the cells that were filled.
    ///
    /// # Example
    /// ```
    /// # use flagred::gap::{FilledMap, GapMethod};
    /// # use fuzzy::{Engine, map::{DecisionMap, Grid}};
    /// # let model = flagred::shipped::rule_set("flagred-paper").ok_or("not shipped")??;
    /// # let engine = Engine::new(&model)?;
    /// let map = DecisionMap::new(&engine, Grid::new(&engine, 51)?, 0)?;
    /// let filled = FilledMap::new(map, 0.5, GapMethod::ThinPlate);
    /// assert!((0.02..0.04).contains(&filled.filled_share()));
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn filled_share(&self) -> f64 {
        let filled = self.distances.iter().filter(|d| **d > 0.0).count();
        filled as f64 / self.distances.len().max(1) as f64
    }

    /// The value at a point with a coordinate for each axis of the grid, N-linearly between cells; beyond the grid,
    /// at its end. `None` where nothing is covered, or the point has another number of coordinates.
    ///
    /// # Example
    /// ```
    /// # use flagred::gap::{FilledMap, GapMethod};
    /// # use fuzzy::{Engine, map::{DecisionMap, Grid}};
    /// # let model = flagred::shipped::rule_set("flagred-paper").ok_or("not shipped")??;
    /// # let engine = Engine::new(&model)?;
    /// let map = DecisionMap::new(&engine, Grid::new(&engine, 51)?, 0)?;
    /// let filled = FilledMap::new(map, 0.5, GapMethod::ThinPlate);
    /// let covered = filled.read(&[0.3, 0.2]).ok_or("off the grid")?;
    /// let corner = filled.read(&[0.01, 0.01]).ok_or("off the grid")?;
    /// assert!(covered.distance == 0.0 && corner.distance > 0.0);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn read(&self, point: &[f64]) -> Option<Reading> {
        let grid = self.map.grid();
        Some(Reading {
            value: grid.interpolate(|cell| self.value(cell), point)?,
            distance: grid.interpolate(|cell| Some(self.distance(cell)), point)?,
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use fuzzy::{Engine, Model, map::Grid};

    fn filled(model: &Model, method: GapMethod) -> FilledMap {
        let engine = Engine::new(model).unwrap();
        let grid = Grid::new(&engine, 51).unwrap();
        FilledMap::new(DecisionMap::new(&engine, grid, 0).unwrap(), 0.5, method)
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
            }
        }
    }

    #[test]
    fn a_saturated_drone_reads_high_in_the_papers_corner() {
        let model = crate::shipped::rule_set("flagred-paper").unwrap().unwrap();
        let read = |method, point: [f64; 2]| filled(&model, method).read(&point).unwrap().value;
        for method in [GapMethod::default(), GapMethod::INVERSE_DISTANCE] {
            for point in [[0.0, 0.0], [0.02, 0.01]] {
                let value = read(method, point);
                assert!(value >= 75.0, "{method:?} at {point:?}: {value}");
            }
        }
        // scipy 1.17.1: RBFInterpolator(covered cells, their values, neighbors=16, kernel="thin_plate_spline").
        approx::assert_abs_diff_eq!(
            read(GapMethod::ThinPlate, [0.0, 0.0]),
            91.528,
            epsilon = 0.01
        );
        approx::assert_abs_diff_eq!(
            read(GapMethod::ThinPlate, [0.02, 0.01]),
            77.308,
            epsilon = 0.01
        );
        approx::assert_abs_diff_eq!(
            read(GapMethod::Nearest, [0.0, 0.0]),
            90.278,
            epsilon = 0.001
        );
        // These two only know what is next to the gap, which is milder.
        approx::assert_abs_diff_eq!(read(GapMethod::Nearest, [0.02, 0.01]), 70.5, epsilon = 0.1);
        approx::assert_abs_diff_eq!(read(GapMethod::Harmonic, [0.0, 0.0]), 69.4, epsilon = 0.1);
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
        model.rules.clear();
        let map = filled(&model, GapMethod::Nearest);
        assert_eq!(map.read(&[0.1, 0.1]), None);
        assert_eq!(map.filled_share(), 1.0);
    }
}
