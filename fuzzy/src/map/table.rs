//! A look-up table in place of an engine, with its measured error: for flight controllers.

use alloc::vec::Vec;

use super::{DecisionMap, Grid, GridError};
use crate::Engine;
use crate::engine::EvaluateError;

/// Values of one output on a grid, read N-linearly between its points.
///
/// A look-up touches `2^N` values of N inputs, allocates nothing and takes the same time everywhere. It has no
/// value where a grid point around it has none: a table never makes up what no rule says.
///
/// # Example: a table that is at most 0.5 % of risk away from its engine
/// ```
/// # use fuzzy::model::{Model, Output, MembershipFunction, Variable};
/// # use fuzzy::rule::{Condition, Rule};
/// # let model = Model::builder("m")
/// #     .input(Variable::new("x", 0.0, 1.0)
/// #         .term("low", MembershipFunction::LeftShoulder { top: 0.0, foot: 1.0 }).term("high", MembershipFunction::RightShoulder { foot: 0.0, top: 1.0 }))
/// #     .output(Output::new(Variable::new("risk", 0.0, 100.0)
/// #         .term("low", MembershipFunction::LeftShoulder { top: 0.0, foot: 100.0 }).term("high", MembershipFunction::RightShoulder { foot: 0.0, top: 100.0 })))
/// #     .rule(Rule::new(Condition::is("x", "low"), "risk", "low"))
/// #     .rule(Rule::new(Condition::is("x", "high"), "risk", "high")).build();
/// use fuzzy::{Engine, map::DecisionTable};
///
/// let engine = Engine::new(&model)?;
/// let table = DecisionTable::within(&engine, 0, 0.5)?;
/// assert!(table.error() <= 0.5);
/// let exact = engine.evaluate(&[0.123])?[0].value().unwrap();
/// assert!((table.value(&[0.123]).unwrap() - exact).abs() <= 0.5);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct DecisionTable {
    grid: Grid,
    /// NaN where there is no value; never shown.
    values: Vec<f64>,
    error: f64,
}

/// Why there is no table.
///
/// # Example
/// ```
/// # let model = fuzzy::yaml::parse(include_str!(concat!(env!("CARGO_MANIFEST_DIR"), "/../rules/flagred-paper.yaml")))?.model;
/// # let engine = fuzzy::Engine::new(&model)?;
/// use fuzzy::map::{DecisionTable, TableError};
///
/// // No table of numbers is exact.
/// assert_eq!(DecisionTable::within(&engine, 0, 0.0), Err(TableError::Bound { bound: 0.0 }));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub enum TableError {
    /// The grid cannot be laid, or is too fine to be measured.
    Grid(GridError),
    /// The grid is not one over the engine, or there is no such output.
    Evaluate(EvaluateError),
    /// An error bound that is not over 0.
    Bound {
        /// The bound.
        bound: f64,
    },
    /// The largest table that was tried is not good enough.
    TooCoarse {
        /// The cells of the finest table tried.
        cells: usize,
        /// Its error.
        error: f64,
        /// The bound asked for.
        bound: f64,
    },
}

impl core::fmt::Display for TableError {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        match self {
            TableError::Grid(error) => error.fmt(f),
            TableError::Evaluate(error) => error.fmt(f),
            TableError::Bound { bound } => write!(f, "the error bound {bound} is not over 0"),
            TableError::TooCoarse {
                cells,
                error,
                bound,
            } => write!(
                f,
                "with {cells} cells the error is still {error}, over {bound}"
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

/// Where the error is measured: this many places between two points on each axis.
const PLACES_BETWEEN: usize = 4;
/// The most cells of a table that [`DecisionTable::within`] makes.
const MOST_CELLS: usize = 1 << 18;

impl DecisionTable {
    /// Evaluates an output on a grid, and measures how far the table is from the engine between its points.
    ///
    /// # Errors
    /// The grid is not one over the engine, there is no such output, or measuring takes too many cells.
    ///
    /// # Example
    /// ```
    /// # use fuzzy::{Engine, map::{DecisionTable, Grid}};
    /// # let model = fuzzy::yaml::parse(include_str!(concat!(env!("CARGO_MANIFEST_DIR"), "/../rules/flagred-paper.yaml")))?.model;
    /// # let engine = Engine::new(&model)?;
    /// let table = DecisionTable::new(&engine, Grid::new(&engine, 11)?, 0)?;
    /// assert!(table.error() > 0.0, "it is measured, and no map is flat");
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn new(engine: &Engine, grid: Grid, output: usize) -> Result<Self, TableError> {
        let mut finer = grid.clone();
        for axis in grid.axes() {
            finer = finer.points(&axis.name, (axis.points - 1) * PLACES_BETWEEN + 1)?;
        }
        let map = DecisionMap::new(engine, grid, output)?;
        let between = DecisionMap::new(engine, finer, output)?;
        let mut table = DecisionTable {
            values: map.values,
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
    /// As [`DecisionTable::new`]; a bound that is not over 0; no table of up to 2^18 cells is good enough.
    ///
    /// # Example
    /// ```
    /// # use fuzzy::{Engine, map::{DecisionTable, Grid}};
    /// # let model = fuzzy::yaml::parse(include_str!(concat!(env!("CARGO_MANIFEST_DIR"), "/../rules/flagred-paper.yaml")))?.model;
    /// # let engine = Engine::new(&model)?;
    /// let table = DecisionTable::within(&engine, 0, 10.0)?;
    /// assert!(table.error() <= 10.0);
    /// assert!(DecisionTable::within(&engine, 0, 0.0).is_err());
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
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

    /// The value at a point with a coordinate for each axis of the grid, beyond its ends that of the end;
    /// `None` where a grid point around it has none, and for NaN.
    ///
    /// # Example
    /// ```
    /// # use fuzzy::{Engine, map::{DecisionTable, Grid}};
    /// # let model = fuzzy::yaml::parse(include_str!(concat!(env!("CARGO_MANIFEST_DIR"), "/../rules/flagred-paper.yaml")))?.model;
    /// # let engine = Engine::new(&model)?;
    /// let table = DecisionTable::new(&engine, Grid::new(&engine, 11)?, 0)?;
    /// assert!(table.value(&[0.1, 0.2]).unwrap() > 90.0);
    /// assert_eq!(table.value(&[0.0, 0.0]), None); // no rule speaks there
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn value(&self, point: &[f64]) -> Option<f64> {
        let value = |cell: usize| self.values.get(cell).copied().filter(|v| !v.is_nan());
        self.grid.interpolate(value, point)
    }

    /// The largest distance from the engine that was measured, in the unit of the output: on a grid four times
    /// as fine on each axis, wherever both have a value. It is measured, not proven.
    ///
    /// # Example
    /// ```
    /// # use fuzzy::{Engine, map::{DecisionTable, Grid}};
    /// # let model = fuzzy::yaml::parse(include_str!(concat!(env!("CARGO_MANIFEST_DIR"), "/../rules/flagred-paper.yaml")))?.model;
    /// # let engine = Engine::new(&model)?;
    /// let coarse = DecisionTable::new(&engine, Grid::new(&engine, 11)?, 0)?;
    /// let fine = DecisionTable::new(&engine, Grid::new(&engine, 21)?, 0)?;
    /// assert!(fine.error() < coarse.error());
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn error(&self) -> f64 {
        self.error
    }

    /// The grid.
    ///
    /// # Example
    /// ```
    /// # use fuzzy::{Engine, map::{DecisionTable, Grid}};
    /// # let model = fuzzy::yaml::parse(include_str!(concat!(env!("CARGO_MANIFEST_DIR"), "/../rules/flagred-paper.yaml")))?.model;
    /// # let engine = Engine::new(&model)?;
    /// let table = DecisionTable::new(&engine, Grid::new(&engine, 11)?, 0)?;
    /// assert_eq!(table.grid().cells(), 11 * 11);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn grid(&self) -> &Grid {
        &self.grid
    }

    /// The values on the cells of the grid, to be written into firmware; `None` where there is none.
    ///
    /// # Example
    /// ```
    /// # use fuzzy::{Engine, map::{DecisionTable, Grid}};
    /// # let model = fuzzy::yaml::parse(include_str!(concat!(env!("CARGO_MANIFEST_DIR"), "/../rules/flagred-paper.yaml")))?.model;
    /// # let engine = Engine::new(&model)?;
    /// let table = DecisionTable::new(&engine, Grid::new(&engine, 3)?, 0)?;
    /// let shares: Vec<Option<u8>> = table.values().map(|risk| Some((risk? * 2.55) as u8)).collect();
    /// assert_eq!((shares.len(), shares[0]), (9, None));
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn values(&self) -> impl ExactSizeIterator<Item = Option<f64>> {
        self.values.iter().map(|v| (!v.is_nan()).then_some(*v))
    }
}
