//! A look-up table that replaces an engine on small processors, with its measured error.

use alloc::vec::Vec;

use super::{DecisionMap, Grid, GridError};
use crate::Engine;
use crate::engine::EvaluateError;

/// Values of one output on a grid, read N-linearly between its points.
///
/// A look-up with N inputs reads `2^N` values, does not allocate and takes the same time everywhere. It has no value where
/// one of these has none.
///
/// # Example: a table within 0.5 % of the engine's power
/// ```
/// use fuzzy::model::{Model, Output, MembershipFunction, Variable};
/// use fuzzy::{Engine, map::DecisionTable, rule};
///
/// let falling = |low, high| MembershipFunction::LeftShoulder { top: low, foot: high };
/// let rising = |low, high| MembershipFunction::RightShoulder { foot: low, top: high };
/// let model = Model::builder("heater")
///     .input(Variable::new("room", 0.0, 20.0).term("cold", falling(0.0, 20.0)).term("warm", rising(0.0, 20.0)))
///     .output(Output::new(Variable::new("power", 0.0, 100.0).term("low", falling(0.0, 100.0)).term("high", rising(0.0, 100.0))))
///     .rule(rule::parse("IF room IS cold THEN power IS high")?)
///     .rule(rule::parse("IF room IS warm THEN power IS low")?)
///     .build();
/// let engine = Engine::new(&model)?;
/// let table = DecisionTable::within(&engine, 0, 0.5)?;
/// assert!(table.error() <= 0.5);
/// let exact = engine.evaluate(&[12.3])?[0].value().ok_or("no rule fires")?;
/// assert!((table.value(&[12.3]).ok_or("no rule fires")? - exact).abs() <= 0.5);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct DecisionTable {
    grid: Grid,
    /// NaN where there is no value.
    values: Vec<f64>,
    error: f64,
}

/// Why a table cannot be made.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub enum TableError {
    /// The grid has an error, or the grid that measures the table has too many cells.
    Grid(GridError),
    /// The grid belongs to another engine, or there is no such output.
    Evaluate(EvaluateError),
    /// The error bound is not positive.
    Bound {
        /// The bound.
        bound: f64,
    },
    /// The largest table exceeds the error bound.
    TooCoarse {
        /// The number of cells of the largest table.
        cells: usize,
        /// Its error.
        error: f64,
        /// The bound.
        bound: f64,
    },
}

impl core::fmt::Display for TableError {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        match self {
            TableError::Grid(error) => error.fmt(f),
            TableError::Evaluate(error) => error.fmt(f),
            TableError::Bound { bound } => write!(f, "the error bound {bound} is not positive"),
            TableError::TooCoarse {
                cells,
                error,
                bound,
            } => write!(
                f,
                "a table of {cells} cells has an error of {error}, over the bound of {bound}"
            ),
        }
    }
}

impl core::error::Error for TableError {}

impl From<GridError> for TableError {
    fn from(error: GridError) -> Self {
        TableError::Grid(error)
    }
}

impl From<EvaluateError> for TableError {
    fn from(error: EvaluateError) -> Self {
        TableError::Evaluate(error)
    }
}

/// The error is measured on a grid this much finer on each axis.
const FINER: usize = 4;
/// The most cells of a table that [`DecisionTable::within`] makes.
const MOST_CELLS: usize = 1 << 18;

impl DecisionTable {
    /// Evaluates an output on a grid, and measures the error of the table between its points.
    ///
    /// # Errors
    /// The grid belongs to another engine, there is no such output, or the grid that measures the error has too many cells.
    pub fn new(engine: &Engine, grid: Grid, output: usize) -> Result<Self, TableError> {
        let mut finer = grid.clone();
        for axis in grid.axes() {
            finer = finer.points(&axis.name, (axis.points - 1) * FINER + 1)?;
        }
        let map = DecisionMap::new(engine, grid, output)?;
        let between = DecisionMap::new(engine, finer, output)?;
        let mut table = DecisionTable {
            values: map.cells.iter().map(|cell| cell.value).collect(),
            grid: map.grid,
            error: 0.0,
        };
        for cell in 0..between.grid().cells() {
            let point = between.grid().point(cell);
            if let (Some(exact), Some(read)) = (between.value(cell), table.value(&point)) {
                table.error = table.error.max(libm::fabs(exact - read));
            }
        }
        Ok(table)
    }

    /// The coarsest table, of those with 5, 9, 17, ... points on each axis, whose measured error is at most
    /// `bound`, in the unit of the output.
    ///
    /// # Errors
    /// As [`DecisionTable::new`]; the bound is not positive; or every table of up to 2^18 cells exceeds it.
    pub fn within(engine: &Engine, output: usize, bound: f64) -> Result<Self, TableError> {
        if bound.is_nan() || bound <= 0.0 {
            return Err(TableError::Bound { bound });
        }
        let mut intervals = 4;
        loop {
            let table = DecisionTable::new(engine, Grid::new(engine, intervals + 1)?, output)?;
            if table.error <= bound {
                return Ok(table);
            }
            let doubled = table.grid.axes().iter().map(|axis| 2 * axis.points - 1);
            let next = doubled.fold(1usize, usize::saturating_mul);
            if next > MOST_CELLS {
                return Err(TableError::TooCoarse {
                    cells: table.grid.cells(),
                    error: table.error,
                    bound,
                });
            }
            intervals *= 2;
        }
    }

    /// The value at a point with a coordinate for each axis of the grid. Coordinates are clamped to the grid. `None` where a
    /// neighbouring grid point has no value, and for NaN.
    pub fn value(&self, point: &[f64]) -> Option<f64> {
        let value = |cell: usize| self.values.get(cell).copied().filter(|v| !v.is_nan());
        self.grid.interpolate(value, point)
    }

    /// The largest measured difference from the engine, in the unit of the output, on a grid four times finer on each axis,
    /// where both have a value. It is no proven bound.
    pub fn error(&self) -> f64 {
        self.error
    }

    /// The grid.
    pub fn grid(&self) -> &Grid {
        &self.grid
    }

    /// The values of the cells of the grid; `None` where there is none.
    pub fn values(&self) -> impl ExactSizeIterator<Item = Option<f64>> {
        self.values.iter().map(|v| (!v.is_nan()).then_some(*v))
    }
}
