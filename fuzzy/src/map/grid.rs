//! Rectangular grids over inputs of an engine.

use alloc::{string::String, sync::Arc, vec::Vec};

use crate::Engine;

/// Equidistant points over some inputs of an engine; the other inputs are fixed.
///
/// Neighbouring cells along the last axis have consecutive indices.
///
/// # Example: a slice of a model with three inputs
/// ```
/// use fuzzy::model::{Model, Output, MembershipFunction, Variable};
/// use fuzzy::{Engine, map::Grid, rule};
///
/// let variable = |name, high| Variable::new(name, 0.0, high).term("high", MembershipFunction::RightShoulder { foot: 0.0, top: high });
/// let model = Model::builder("tip")
///     .input(variable("food", 10.0))
///     .input(variable("service", 10.0))
///     .input(variable("bill", 500.0))
///     .output(Output::new(variable("tip", 25.0)))
///     .rule(rule::parse("IF food IS high AND service IS high AND bill IS high THEN tip IS high")?)
///     .build();
/// let engine = Engine::new(&model)?;
/// let grid = Grid::new(&engine, 51)?.fix("bill", 80.0)?;
/// assert_eq!(grid.axes().len(), 2);
/// assert_eq!(grid.cells(), 51 * 51);
/// assert_eq!(grid.point(52), [0.2, 0.2]);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct Grid {
    axes: Vec<Axis>,
    fixed: Vec<FixedInput>,
    cells: usize,
}

/// One input of a grid.
#[derive(Debug, Clone, PartialEq)]
pub struct Axis {
    /// The name of the input.
    pub name: Arc<str>,
    /// The index of the input.
    pub input: usize,
    /// The first point.
    pub low: f64,
    /// The last point.
    pub high: f64,
    /// The number of points, at least 2.
    pub points: usize,
}

/// A fixed input of a grid.
#[derive(Debug, Clone, PartialEq)]
pub struct FixedInput {
    /// The name of the input.
    pub name: Arc<str>,
    /// The index of the input.
    pub input: usize,
    /// The value of the input.
    pub value: f64,
}

/// The error for an invalid grid.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub enum GridError {
    /// An axis has fewer than 2 points.
    TooFewPoints {
        /// The number of points.
        points: usize,
    },
    /// There is no axis with the given name: it is not an input, or it is fixed.
    NoAxis {
        /// The requested name.
        name: String,
    },
    /// A fixed value is not finite.
    NotFinite {
        /// The name of the input.
        name: String,
        /// The value.
        value: f64,
    },
}

impl core::fmt::Display for GridError {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        match self {
            GridError::TooFewPoints { points } => {
                write!(f, "an axis needs at least 2 points, not {points}")
            }
            GridError::NoAxis { name } => write!(f, "the grid has no axis `{name}`"),
            GridError::NotFinite { name, value } => {
                write!(f, "the value {value} of `{name}` is not finite")
            }
        }
    }
}

impl core::error::Error for GridError {}

/// The maximum number of cells of a decision map; they take 240 MB.
pub(super) const MAX_CELLS: usize = 10_000_000;

impl Axis {
    /// Returns the coordinate of a point: `low + i (high - low) / (points - 1)`, and exactly `high` for the last one.
    pub fn coordinate(&self, i: usize) -> f64 {
        if i + 1 >= self.points {
            self.high
        } else {
            self.low + (self.high - self.low) * (i as f64 / (self.points - 1) as f64)
        }
    }

    /// Returns the index of the point below `x`, and the fraction in [0, 1] of the distance from there to the next
    /// point. `x` is clamped to the axis.
    fn locate(&self, x: f64) -> (usize, f64) {
        let last = self.points.saturating_sub(2);
        let steps = (x - self.low) / (self.high - self.low) * (self.points - 1) as f64;
        if steps > 0.0 {
            let i = (steps as usize).min(last);
            (i, (steps - i as f64).min(1.0))
        } else {
            (0, 0.0)
        }
    }
}

impl Grid {
    /// Creates a grid over the range of every input, with the same number of points on each axis.
    ///
    /// # Errors
    /// `points` is less than 2.
    pub fn new(engine: &Engine, points: usize) -> Result<Self, GridError> {
        let axes = engine
            .ranges()
            .enumerate()
            .map(|(input, (name, low, high))| Axis {
                name: Arc::clone(name),
                input,
                low,
                high,
                points,
            });
        Grid {
            axes: axes.collect(),
            fixed: Vec::new(),
            cells: 0,
        }
        .counted()
    }

    /// Sets the number of points of one axis.
    ///
    /// # Errors
    /// There is no such axis, or `points` is less than 2.
    pub fn points(mut self, name: &str, points: usize) -> Result<Self, GridError> {
        let axis = self.axes.iter_mut().find(|axis| &*axis.name == name);
        let axis = axis.ok_or_else(|| GridError::NoAxis { name: name.into() })?;
        axis.points = points;
        self.counted()
    }

    /// Fixes an input, which removes its axis.
    ///
    /// # Errors
    /// There is no such axis, or the value is not finite.
    pub fn fix(mut self, name: &str, value: f64) -> Result<Self, GridError> {
        if !value.is_finite() {
            return Err(GridError::NotFinite {
                name: name.into(),
                value,
            });
        }
        let index = self.axes.iter().position(|axis| &*axis.name == name);
        let index = index.ok_or_else(|| GridError::NoAxis { name: name.into() })?;
        let axis = self.axes.remove(index);
        self.fixed.push(FixedInput {
            name: axis.name,
            input: axis.input,
            value,
        });
        self.counted()
    }

    fn counted(mut self) -> Result<Self, GridError> {
        self.cells = 1;
        for axis in &self.axes {
            if axis.points < 2 {
                let points = axis.points;
                return Err(GridError::TooFewPoints { points });
            }
            self.cells = self.cells.saturating_mul(axis.points);
        }
        Ok(self)
    }

    /// Returns the axes, in the order of the engine's inputs.
    pub fn axes(&self) -> &[Axis] {
        &self.axes
    }

    /// Returns the fixed inputs.
    pub fn fixed(&self) -> &[FixedInput] {
        &self.fixed
    }

    /// Returns the number of cells; `usize::MAX` if it is too large for `usize`. A decision map has at most 10,000,000
    /// cells.
    pub fn cells(&self) -> usize {
        self.cells
    }

    /// Returns the index of a cell on each axis.
    pub fn indices(&self, cell: usize) -> Vec<usize> {
        let mut rest = cell;
        let mut indices: Vec<usize> = self
            .axes
            .iter()
            .rev()
            .map(|axis| {
                let i = rest % axis.points;
                rest /= axis.points;
                i
            })
            .collect();
        indices.reverse();
        indices
    }

    /// Returns the cell with the given index on each axis; `None` if it is outside the grid.
    pub fn cell(&self, indices: &[usize]) -> Option<usize> {
        if indices.len() != self.axes.len() {
            return None;
        }
        self.axes
            .iter()
            .zip(indices)
            .try_fold(0, |cell, (axis, &i)| {
                (i < axis.points).then_some(cell * axis.points + i)
            })
    }

    /// Returns the coordinate of a cell on each axis.
    pub fn point(&self, cell: usize) -> Vec<f64> {
        let indices = self.indices(cell);
        let axes = self.axes.iter().zip(indices);
        axes.map(|(axis, i)| axis.coordinate(i)).collect()
    }

    /// Interpolates the values of cells N-linearly at a point with one coordinate per axis. Coordinates are clamped to
    /// the grid. `None` if a cell has no value, a coordinate is NaN, or the number of coordinates is wrong.
    pub fn interpolate(&self, value: impl Fn(usize) -> Option<f64>, point: &[f64]) -> Option<f64> {
        if point.len() != self.axes.len() || point.iter().any(|x| x.is_nan()) {
            return None;
        }
        self.corner_sum(&value, point, 0, 0)
    }

    /// Interpolates along one axis between the interpolations along the remaining axes.
    fn corner_sum(
        &self,
        value: &impl Fn(usize) -> Option<f64>,
        point: &[f64],
        depth: usize,
        cell: usize,
    ) -> Option<f64> {
        let (Some(axis), Some(&x)) = (self.axes.get(depth), point.get(depth)) else {
            return value(cell);
        };
        let (i, between) = axis.locate(x);
        let first = cell * axis.points + i;
        if between == 0.0 {
            return self.corner_sum(value, point, depth + 1, first);
        }
        let right = self.corner_sum(value, point, depth + 1, first + 1)?;
        if between == 1.0 {
            return Some(right);
        }
        let left = self.corner_sum(value, point, depth + 1, first)?;
        Some(left + (right - left) * between)
    }
}
