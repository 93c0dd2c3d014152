//! Decision maps: the values, coverage and dominant rules of an engine on a grid.

use alloc::{string::String, vec, vec::Vec};
use core::ops::Range;

use crate::Engine;
use crate::engine::EvaluateError;
use crate::engine::batch::{Memory, ROWS};
use crate::table::Results;

mod grid;
mod table;
#[cfg(test)]
mod tests;

pub use grid::{Axis, Fixed, Grid, GridError};
pub use table::{DecisionTable, TableError};

/// One output of an engine on every cell of a grid.
///
/// # Example: the cells that rules cover
/// ```
/// use fuzzy::model::{Model, Output, MembershipFunction, Variable};
/// use fuzzy::{Engine, map::{DecisionMap, Grid}, rule};
///
/// let model = Model::builder("heater")
///     .input(Variable::new("room", 0.0, 20.0).term("cold", MembershipFunction::LeftShoulder { top: 0.0, foot: 10.0 }))
///     .output(Output::new(Variable::new("power", 0.0, 100.0).term("high", MembershipFunction::Rectangle { left: 50.0, right: 100.0 })))
///     .rule(rule::parse("IF room IS cold THEN power IS high")?)
///     .build();
/// let engine = Engine::new(&model)?;
/// let map = DecisionMap::new(&engine, Grid::new(&engine, 11)?, 0)?; // at 0, 2, 4 ... 20 degrees
/// let covered = (0..map.grid().cells()).filter(|&cell| map.coverage(cell) >= 0.5);
/// assert_eq!(covered.count(), 3);
/// assert_eq!(map.value(0), Some(75.0));
/// assert_eq!(map.value(10), None); // no rule fires
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct DecisionMap {
    grid: Grid,
    output: String,
    /// NaN where there is no value.
    values: Vec<f64>,
    coverage: Vec<f64>,
    /// The rule's index plus one; 0 where no rule fired.
    dominant: Vec<u32>,
}

/// The number of cells in a batch, which fits the cache.
const CELLS_A_TASK: usize = 512;

/// Evaluates batches of cells.
struct Worker<'a> {
    engine: &'a Engine,
    grid: &'a Grid,
    output: usize,
    memory: Memory,
    /// The coordinates along each axis.
    coordinates: Vec<Vec<f64>>,
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
        let coordinates = grid
            .axes()
            .iter()
            .map(|axis| (0..axis.points).map(|i| axis.coordinate(i)).collect());
        Worker {
            engine,
            grid,
            output,
            memory: engine.memory(CELLS_A_TASK),
            coordinates: coordinates.collect(),
            columns,
        }
    }

    /// Evaluates the cells that begin at index `first`.
    fn fill(
        &mut self,
        first: usize,
        values: &mut [f64],
        coverage: &mut [f64],
        dominant: &mut [u32],
    ) {
        let cells = values.len();
        let mut stride = self.grid.cells();
        for (axis, coordinates) in self.grid.axes().iter().zip(&self.coordinates) {
            stride /= axis.points;
            if let Some(column) = self.columns.get_mut(axis.input) {
                spread(
                    coordinates,
                    first,
                    stride,
                    column.get_mut(..cells).unwrap_or_default(),
                );
            }
        }
        let columns: Vec<&[f64]> = self.columns.iter().map(|column| &**column).collect();
        let put = |rows: Range<usize>, output: usize, results: &Results<ROWS>| {
            if output != self.output {
                return;
            }
            let values = values[rows.clone()].iter_mut();
            let cells = values.zip(&mut coverage[rows.clone()]);
            let cells = cells.zip(&mut dominant[rows]).enumerate();
            for (row, ((value, coverage), dominant)) in cells {
                *value = results.value(row);
                *coverage = results.coverage[row];
                *dominant = results.dominant(row).map_or(0, |rule| rule + 1);
            }
        };
        self.engine
            .evaluate_rows(&mut self.memory, &columns, 0..cells, put);
    }
}

/// Writes the coordinates on an axis of the cells that begin at index `first`. Neighbours on the axis are `stride` cells
/// apart.
fn spread(coordinates: &[f64], first: usize, stride: usize, mut cells: &mut [f64]) {
    let mut left = stride - first % stride;
    let around = coordinates.iter().cycle();
    for coordinate in around.skip(first / stride % coordinates.len()) {
        if cells.is_empty() {
            return;
        }
        let (run, behind) = cells.split_at_mut(left.min(cells.len()));
        run.fill(*coordinate);
        left = stride;
        cells = behind;
    }
}

impl DecisionMap {
    /// Evaluates one output on every cell of a grid.
    ///
    /// A cell where no rule fires has no dominant rule. Its value is the default value of the output, if there is one; it has
    /// none where the model makes that an error.
    ///
    /// # Errors
    /// The grid belongs to another engine, or there is no such output.
    pub fn new(engine: &Engine, grid: Grid, output: usize) -> Result<Self, EvaluateError> {
        let inputs = engine.input_names().len();
        let named = grid.axes().len() + grid.fixed().len();
        if named != inputs {
            return Err(EvaluateError::WrongNumberOfInputs {
                expected: inputs,
                got: named,
            });
        }
        let Some(name) = engine.output_names().nth(output) else {
            return Err(EvaluateError::WrongNumberOfOutputs {
                expected: engine.output_names().len(),
                got: output,
            });
        };
        let cells = grid.cells();
        let mut map = DecisionMap {
            output: name.into(),
            // The system provides zeroed memory at no cost; every cell is written below.
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
    pub fn grid(&self) -> &Grid {
        &self.grid
    }

    /// The output's name.
    pub fn output(&self) -> &str {
        &self.output
    }

    /// The value of a cell; `None` where it has none, or where it is not on the grid.
    pub fn value(&self, cell: usize) -> Option<f64> {
        self.values.get(cell).copied().filter(|v| !v.is_nan())
    }

    /// The largest firing strength of a rule of this output in a cell, in [0, 1].
    pub fn coverage(&self, cell: usize) -> f64 {
        self.coverage.get(cell).copied().unwrap_or(0.0)
    }

    /// The rule of the largest firing strength in a cell, as its index in the model.
    pub fn dominant(&self, cell: usize) -> Option<usize> {
        let rule = self.dominant.get(cell)?.checked_sub(1)?;
        Some(rule as usize)
    }

    /// The N-linear interpolation between cells; `None` where one of those cells has no value.
    pub fn interpolate(&self, point: &[f64]) -> Option<f64> {
        self.grid.interpolate(|cell| self.value(cell), point)
    }
}
