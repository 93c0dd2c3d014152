//! Decision maps: the values, coverage and dominant rules of an engine on a grid.

use alloc::{string::String, vec, vec::Vec};
use core::ops::Range;

use crate::Engine;
use crate::engine::EvaluateError;
use crate::engine::batch::{Memory, ROWS};
use crate::table::Results;

mod grid;
mod peaks;
#[cfg(test)]
mod tests;

use grid::MAX_CELLS;
pub use grid::{Axis, FixedInput, Grid, GridError};
pub use peaks::{changing, peaks};

/// One output of an engine in every cell of a grid.
///
/// # Example: the fraction of cells that rules cover
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
    cells: Vec<Cell>,
}

/// The result for an output in a cell. A map is a single allocation: an allocator may return several large allocations
/// to the system and request them again for the next map, which takes longer than the evaluation.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Cell {
    /// The value; NaN if there is none.
    value: f64,
    coverage: f64,
    /// The index of the rule plus one; 0 if no rule fired.
    dominant: u32,
}

/// The number of cells per batch, chosen to fit the cache.
const CELLS_PER_TASK: usize = 512;

/// A worker that evaluates batches of cells.
struct Worker<'a> {
    engine: &'a Engine,
    grid: &'a Grid,
    output: usize,
    memory: Memory,
    /// The coordinates along each axis.
    coordinates: Vec<Vec<f64>>,
    /// One column of coordinates per input.
    columns: Vec<Vec<f64>>,
}

impl<'a> Worker<'a> {
    fn new(engine: &'a Engine, grid: &'a Grid, output: usize) -> Self {
        let mut columns = vec![vec![0.0; CELLS_PER_TASK]; engine.input_names().len()];
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
            memory: engine.memory(CELLS_PER_TASK),
            coordinates: coordinates.collect(),
            columns,
        }
    }

    /// Evaluates the cells that start at index `first`.
    fn fill(&mut self, first: usize, cells: &mut [Cell]) {
        let count = cells.len();
        let mut stride = self.grid.cells();
        for (axis, coordinates) in self.grid.axes().iter().zip(&self.coordinates) {
            stride /= axis.points;
            if let Some(column) = self.columns.get_mut(axis.input) {
                spread(
                    coordinates,
                    first,
                    stride,
                    column.get_mut(..count).unwrap_or_default(),
                );
            }
        }
        let columns: Vec<&[f64]> = self.columns.iter().map(|column| &**column).collect();
        let put = |rows: Range<usize>, output: usize, results: &Results<ROWS>| {
            if output != self.output {
                return;
            }
            for (row, cell) in cells[rows].iter_mut().enumerate() {
                *cell = Cell {
                    value: results.value(row),
                    coverage: results.coverage[row],
                    dominant: results.dominant(row).map_or(0, |rule| rule + 1),
                };
            }
        };
        self.engine
            .evaluate_rows(&mut self.memory, &columns, 0..count, put);
    }
}

/// Writes the coordinates on one axis for the cells that start at index `first`. Neighbours on that axis are `stride`
/// cells apart.
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
    /// Evaluates one output in every cell of a grid.
    ///
    /// A cell for which no rule fires has no dominant rule. Its value is the default value of the output, if there is
    /// one. It has no value if the model treats this as an error.
    ///
    /// # Errors
    /// The grid belongs to another engine or has too many cells, or there is no such output.
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
            return Err(EvaluateError::UnknownOutput {
                index: output,
                outputs: engine.output_names().len(),
            });
        };
        if grid.cells() > MAX_CELLS {
            return Err(EvaluateError::TooManyCells {
                cells: grid.cells(),
                most: MAX_CELLS,
            });
        }
        let none = Cell {
            value: f64::NAN,
            coverage: 0.0,
            dominant: 0,
        };
        let mut cells = vec![none; grid.cells()];
        let worker = || Worker::new(engine, &grid, output);
        #[cfg(feature = "parallel")]
        {
            use rayon::prelude::*;
            let tasks = cells.par_chunks_mut(CELLS_PER_TASK).enumerate();
            tasks.for_each_init(worker, |worker, (task, cells)| {
                worker.fill(task * CELLS_PER_TASK, cells);
            });
        }
        #[cfg(not(feature = "parallel"))]
        {
            let mut worker = worker();
            for (task, cells) in cells.chunks_mut(CELLS_PER_TASK).enumerate() {
                worker.fill(task * CELLS_PER_TASK, cells);
            }
        }
        Ok(DecisionMap {
            output: name.into(),
            cells,
            grid,
        })
    }

    /// Returns the grid on which the output was evaluated.
    pub fn grid(&self) -> &Grid {
        &self.grid
    }

    /// Returns the name of the output.
    pub fn output(&self) -> &str {
        &self.output
    }

    /// Returns the value of a cell; `None` if it has no value or is outside the grid.
    pub fn value(&self, cell: usize) -> Option<f64> {
        let value = self.cells.get(cell)?.value;
        (!value.is_nan()).then_some(value)
    }

    /// Returns the largest firing strength of a rule of this output in a cell, in [0, 1].
    pub fn coverage(&self, cell: usize) -> f64 {
        self.cells.get(cell).map_or(0.0, |cell| cell.coverage)
    }

    /// Returns the index in the model of the rule with the largest firing strength in a cell.
    pub fn dominant(&self, cell: usize) -> Option<usize> {
        let rule = self.cells.get(cell)?.dominant.checked_sub(1)?;
        Some(rule as usize)
    }

    /// Interpolates N-linearly between cells; `None` if one of these cells has no value.
    pub fn interpolate(&self, point: &[f64]) -> Option<f64> {
        self.grid.interpolate(|cell| self.value(cell), point)
    }
}
