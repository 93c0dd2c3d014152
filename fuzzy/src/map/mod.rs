//! Decision maps: an engine on a grid, with how well each cell is covered by rules.

use alloc::{sync::Arc, vec, vec::Vec};

use crate::Engine;
use crate::engine::{EvaluateError, Outcome, Scratch, State};

mod grid;
mod picture;
mod table;
#[cfg(test)]
mod tests;

pub use grid::{Axis, Fixed, Grid, GridError};
pub use picture::picture;
pub use table::{DecisionTable, TableError};

/// One output of an engine on every cell of a grid.
///
/// # Example: the part of a map that rules cover
/// ```
/// # use fuzzy::model::{Model, Output, MembershipFunction, Variable};
/// # use fuzzy::rule::{Condition, Rule};
/// # let model = Model::builder("m")
/// #     .input(Variable::new("x", 0.0, 1.0).term("low", MembershipFunction::Triangle { left: 0.0, peak: 0.0, right: 0.5 }))
/// #     .output(Output::new(Variable::new("y", 0.0, 1.0).term("small", MembershipFunction::Rectangle { left: 0.0, right: 0.5 })))
/// #     .rule(Rule::new(Condition::is("x", "low"), "y", "small")).build();
/// use fuzzy::{Engine, map::{DecisionMap, Grid}};
///
/// let engine = Engine::new(&model)?;
/// let map = DecisionMap::new(&engine, Grid::new(&engine, 11)?, 0)?;
/// let covered = (0..map.grid().cells()).filter(|&cell| map.coverage(cell) >= 0.5);
/// assert_eq!(covered.count(), 3); // x = 0, 0.1 and 0.2
/// assert_eq!(map.value(0), Some(0.25));
/// assert_eq!(map.value(10), None);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct DecisionMap {
    grid: Grid,
    output: Arc<str>,
    range: (f64, f64),
    /// NaN where there is no value; never shown.
    values: Vec<f64>,
    coverage: Vec<f64>,
    /// One more than the rule's index; 0 where no rule fired.
    dominant: Vec<u32>,
}

/// Cells that are evaluated at a time: a batch that stays in the cache.
const CELLS_A_TASK: usize = 512;

/// What fills cells: the engine, and room for a batch.
struct Worker<'a> {
    engine: &'a Engine,
    grid: &'a Grid,
    output: usize,
    scratch: Scratch,
    /// The coordinates along each axis.
    places: Vec<Vec<f64>>,
    /// One column of coordinates for each input.
    columns: Vec<Vec<f64>>,
}

impl<'a> Worker<'a> {
    fn new(engine: &'a Engine, grid: &'a Grid, output: usize) -> Self {
        let mut columns = vec![vec![0.0; CELLS_A_TASK]; engine.input_names().len()];
        for fixed in grid.fixed() {
            if let Some(column) = columns.get_mut(fixed.input) {
                column.fill(fixed.value);
            }
        }
        let places = grid.axes().iter();
        let places = places.map(|axis| (0..axis.points).map(|i| axis.coordinate(i)).collect());
        Worker {
            engine,
            grid,
            output,
            scratch: engine.scratch(),
            places: places.collect(),
            columns,
        }
    }

    /// Evaluates the cells from `first` on.
    fn fill(
        &mut self,
        first: usize,
        values: &mut [f64],
        coverage: &mut [f64],
        dominant: &mut [u32],
    ) {
        let cells = values.len();
        let mut stride = self.grid.cells();
        for (axis, places) in self.grid.axes().iter().zip(&self.places) {
            stride /= axis.points;
            if let Some(column) = self.columns.get_mut(axis.input) {
                spread(
                    places,
                    first,
                    stride,
                    column.get_mut(..cells).unwrap_or_default(),
                );
            }
        }
        let columns: Vec<&[f64]> = self.columns.iter().map(|column| &**column).collect();
        let mut cells = values.iter_mut().zip(coverage).zip(dominant);
        let range = 0..cells.len();
        let put = |outcomes: &[Outcome]| {
            let cell = cells.next().zip(outcomes.get(self.output));
            if let Some((((value, coverage), dominant), outcome)) = cell {
                *value = outcome.value().unwrap_or(f64::NAN);
                *coverage = outcome.coverage;
                *dominant = outcome.dominant.map_or(0, |rule| rule as u32 + 1);
            }
        };
        self.engine
            .evaluate_rows(&mut self.scratch, &columns, range, put);
    }
}

/// Writes the coordinates of cells from `first` on, where neighbours on an axis with these places stand `stride` cells
/// apart.
fn spread(places: &[f64], first: usize, stride: usize, mut cells: &mut [f64]) {
    let mut left = stride - first % stride;
    let around = places.iter().cycle().skip(first / stride % places.len());
    for place in around {
        if cells.is_empty() {
            return;
        }
        let (run, behind) = cells.split_at_mut(left.min(cells.len()));
        run.fill(*place);
        left = stride;
        cells = behind;
    }
}

impl DecisionMap {
    /// Evaluates one output on every cell of a grid.
    ///
    /// Cells where no rule fires have no value, also where the model calls that an error; where the
    /// author chose a value for that, they have it, and no dominant rule.
    ///
    /// # Errors
    /// The grid was laid over another engine, or there is no such output.
    ///
    /// # Example
    /// ```
    /// # use fuzzy::{Engine, map::{DecisionMap, Grid}};
    /// # let model = fuzzy::yaml::parse(include_str!(concat!(env!("CARGO_MANIFEST_DIR"), "/../rules/flagred-paper.yaml")))?.model;
    /// # let engine = Engine::new(&model)?;
    /// let map = DecisionMap::new(&engine, Grid::new(&engine, 51)?, 0)?;
    /// assert_eq!(map.grid().cells(), 51 * 51);
    /// assert!(DecisionMap::new(&engine, Grid::new(&engine, 51)?, 1).is_err(), "there is no second output");
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn new(engine: &Engine, grid: Grid, output: usize) -> Result<Self, EvaluateError> {
        let inputs = engine.input_names().len();
        let named = grid.axes().len() + grid.fixed().len();
        if named != inputs {
            return Err(EvaluateError::WrongNumberOfInputs {
                expected: inputs,
                got: named,
            });
        }
        let Some((name, low, high)) = engine.output_ranges().nth(output) else {
            return Err(EvaluateError::WrongNumberOfOutputs {
                expected: engine.output_names().len(),
                got: output,
            });
        };
        let cells = grid.cells();
        let mut map = DecisionMap {
            output: Arc::clone(name),
            range: (low, high),
            // Zeros come from the system for nothing; every cell is written below.
            values: vec![0.0; cells],
            coverage: vec![0.0; cells],
            dominant: vec![0; cells],
            grid,
        };
        let tasks = map
            .values
            .chunks_mut(CELLS_A_TASK)
            .zip(map.coverage.chunks_mut(CELLS_A_TASK))
            .zip(map.dominant.chunks_mut(CELLS_A_TASK));
        let worker = || Worker::new(engine, &map.grid, output);
        #[cfg(feature = "parallel")]
        {
            use rayon::prelude::*;
            let tasks: Vec<_> = tasks.enumerate().collect();
            tasks.into_par_iter().for_each_init(
                worker,
                |worker, (task, ((values, coverage), dominant))| {
                    worker.fill(task * CELLS_A_TASK, values, coverage, dominant);
                },
            );
        }
        #[cfg(not(feature = "parallel"))]
        {
            let mut worker = worker();
            for (task, ((values, coverage), dominant)) in tasks.enumerate() {
                worker.fill(task * CELLS_A_TASK, values, coverage, dominant);
            }
        }
        Ok(map)
    }

    /// The grid.
    ///
    /// # Example
    /// ```
    /// # use fuzzy::{Engine, map::{DecisionMap, Grid}};
    /// # let model = fuzzy::yaml::parse(include_str!(concat!(env!("CARGO_MANIFEST_DIR"), "/../rules/flagred-paper.yaml")))?.model;
    /// # let engine = Engine::new(&model)?;
    /// # let map = DecisionMap::new(&engine, Grid::new(&engine, 51)?, 0)?;
    /// assert_eq!(map.grid().point(0), [0.0, 0.0]);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn grid(&self) -> &Grid {
        &self.grid
    }

    /// The output's name.
    ///
    /// # Example
    /// ```
    /// # use fuzzy::{Engine, map::{DecisionMap, Grid}};
    /// # let model = fuzzy::yaml::parse(include_str!(concat!(env!("CARGO_MANIFEST_DIR"), "/../rules/flagred-paper.yaml")))?.model;
    /// # let engine = Engine::new(&model)?;
    /// # let map = DecisionMap::new(&engine, Grid::new(&engine, 51)?, 0)?;
    /// assert_eq!((map.output(), map.range()), ("risk", (0.0, 100.0)));
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn output(&self) -> &str {
        &self.output
    }

    /// The output's range.
    ///
    /// # Example
    /// ```
    /// # use fuzzy::{Engine, map::{DecisionMap, Grid}};
    /// # let model = fuzzy::yaml::parse(include_str!(concat!(env!("CARGO_MANIFEST_DIR"), "/../rules/flagred-paper.yaml")))?.model;
    /// # let engine = Engine::new(&model)?;
    /// # let map = DecisionMap::new(&engine, Grid::new(&engine, 51)?, 0)?;
    /// let (low, high) = map.range();
    /// let share = |cell| Some((map.value(cell)? - low) / (high - low));
    /// assert!(share(51 * 51 - 1).is_some_and(|share| share < 0.1));
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn range(&self) -> (f64, f64) {
        self.range
    }

    /// The value of a cell; `None` where there is none, and off the grid.
    ///
    /// # Example
    /// ```
    /// # use fuzzy::{Engine, map::{DecisionMap, Grid}};
    /// # let model = fuzzy::yaml::parse(include_str!(concat!(env!("CARGO_MANIFEST_DIR"), "/../rules/flagred-paper.yaml")))?.model;
    /// # let engine = Engine::new(&model)?;
    /// # let map = DecisionMap::new(&engine, Grid::new(&engine, 51)?, 0)?;
    /// assert_eq!(map.value(0), None); // no margin, no spread: the paper has no rule
    /// assert!(map.value(51 * 51 - 1).is_some_and(|risk| risk < 10.0));
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn value(&self, cell: usize) -> Option<f64> {
        self.values.get(cell).copied().filter(|v| !v.is_nan())
    }

    /// The largest firing strength of a rule of this output in a cell, in [0, 1].
    ///
    /// # Example
    /// ```
    /// # use fuzzy::{Engine, map::{DecisionMap, Grid}};
    /// # let model = fuzzy::yaml::parse(include_str!(concat!(env!("CARGO_MANIFEST_DIR"), "/../rules/flagred-paper.yaml")))?.model;
    /// # let engine = Engine::new(&model)?;
    /// # let map = DecisionMap::new(&engine, Grid::new(&engine, 51)?, 0)?;
    /// // The corner that the paper marks: no rule reaches one half there.
    /// let corner = map.grid().cell(&[14, 4]).ok_or("off the grid")?;
    /// assert!(map.coverage(corner) < 0.5);
    /// assert_eq!(map.coverage(51 * 51 - 1), 1.0);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn coverage(&self, cell: usize) -> f64 {
        self.coverage.get(cell).copied().unwrap_or(0.0)
    }

    /// The rule of the largest firing strength in a cell, as its index in the model.
    ///
    /// # Example
    /// ```
    /// # use fuzzy::{Engine, map::{DecisionMap, Grid}};
    /// # let model = fuzzy::yaml::parse(include_str!(concat!(env!("CARGO_MANIFEST_DIR"), "/../rules/flagred-paper.yaml")))?.model;
    /// # let engine = Engine::new(&model)?;
    /// # let map = DecisionMap::new(&engine, Grid::new(&engine, 51)?, 0)?;
    /// let calm = map.grid().cell(&[50, 0]).and_then(|cell| map.dominant(cell));
    /// assert_eq!(calm, Some(1)); // IF margin IS high AND spread IS low THEN risk IS very_low
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn dominant(&self, cell: usize) -> Option<usize> {
        let rule = self.dominant.get(cell)?.checked_sub(1)?;
        Some(rule as usize)
    }

    /// The map read N-linearly between its cells; `None` where a cell that counts there has no value.
    ///
    /// # Example
    /// ```
    /// # use fuzzy::{Engine, map::{DecisionMap, Grid}};
    /// # let model = fuzzy::yaml::parse(include_str!(concat!(env!("CARGO_MANIFEST_DIR"), "/../rules/flagred-paper.yaml")))?.model;
    /// # let engine = Engine::new(&model)?;
    /// # let map = DecisionMap::new(&engine, Grid::new(&engine, 51)?, 0)?;
    /// let between = map.interpolate(&[0.123, 0.234]).ok_or("not covered")?;
    /// let exact = engine.evaluate(&[0.123, 0.234])?[0].value().ok_or("not covered")?;
    /// assert!((between - exact).abs() < 2.0);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn interpolate(&self, point: &[f64]) -> Option<f64> {
        self.grid.interpolate(|cell| self.value(cell), point)
    }

    /// What a cell says, as an evaluation there would.
    ///
    /// # Example
    /// ```
    /// # use fuzzy::{Engine, map::{DecisionMap, Grid}};
    /// # let model = fuzzy::yaml::parse(include_str!(concat!(env!("CARGO_MANIFEST_DIR"), "/../rules/flagred-paper.yaml")))?.model;
    /// # let engine = Engine::new(&model)?;
    /// # let map = DecisionMap::new(&engine, Grid::new(&engine, 51)?, 0)?;
    /// assert_eq!(map.state(0), engine.evaluate(&[0.0, 0.0])?[0].state);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn state(&self, cell: usize) -> State {
        match (self.value(cell), self.dominant(cell)) {
            (Some(value), Some(_)) => State::Defined(value),
            (Some(value), None) => State::Default(value),
            (None, _) => State::NoRuleFired,
        }
    }
}
