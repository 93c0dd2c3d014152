//! Points on a rectangular grid over some of an engine's inputs.

use alloc::{string::String, sync::Arc, vec::Vec};

use crate::Engine;

/// Equidistant points over some inputs of an engine, the other inputs fixed.
///
/// Cells are counted with the last axis fastest.
///
/// # Example: a slice of a model of three inputs
/// ```
/// # use fuzzy::model::{Model, Output, MembershipFunction, Variable};
/// # use fuzzy::rule::{Condition, Rule};
/// # let term = |name, low, high| Variable::new(name, low, high).term("any", MembershipFunction::Rectangle { left: low, right: high });
/// # let model = Model::builder("m").input(term("margin", 0.0, 0.5)).input(term("spread", 0.0, 0.5)).input(term("battery", 0.0, 1.0))
/// #     .output(Output::new(term("risk", 0.0, 100.0))).rule(Rule::new(Condition::is("margin", "any"), "risk", "any")).build();
/// use fuzzy::{Engine, map::Grid};
///
/// let engine = Engine::new(&model)?;
/// let grid = Grid::new(&engine, 51)?.fix("battery", 0.8)?;
/// assert_eq!(grid.axes().len(), 2);
/// assert_eq!(grid.cells(), 51 * 51);
/// assert_eq!(grid.point(51), [0.01, 0.0]);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct Grid {
    axes: Vec<Axis>,
    fixed: Vec<Fixed>,
    cells: usize,
}

/// One input of a grid.
///
/// # Example
/// ```
/// # let model = fuzzy::yaml::parse(include_str!(concat!(env!("CARGO_MANIFEST_DIR"), "/../rules/flagred-paper.yaml")))?.model;
/// # let engine = fuzzy::Engine::new(&model)?;
/// use fuzzy::map::{Axis, Grid};
///
/// let grid = Grid::new(&engine, 11)?;
/// let spread = Axis { name: "spread".into(), input: 1, low: 0.0, high: 0.5, points: 11 };
/// assert_eq!(grid.axes()[1], spread);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct Axis {
    /// The input's name.
    pub name: Arc<str>,
    /// The input's place among the engine's inputs.
    pub input: usize,
    /// The first point.
    pub low: f64,
    /// The last point.
    pub high: f64,
    /// The number of points, at least 2.
    pub points: usize,
}

/// An input that has one value all over a grid.
///
/// # Example: along the margin at one spread
/// ```
/// # let model = fuzzy::yaml::parse(include_str!(concat!(env!("CARGO_MANIFEST_DIR"), "/../rules/flagred-paper.yaml")))?.model;
/// # let engine = fuzzy::Engine::new(&model)?;
/// use fuzzy::map::{Fixed, Grid};
///
/// let grid = Grid::new(&engine, 11)?.fix("spread", 0.2)?;
/// assert_eq!(grid.fixed(), [Fixed { name: "spread".into(), input: 1, value: 0.2 }]);
/// assert_eq!(grid.axes().len(), 1);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct Fixed {
    /// The input's name.
    pub name: Arc<str>,
    /// The input's place among the engine's inputs.
    pub input: usize,
    /// Its value.
    pub value: f64,
}

/// Why a grid cannot be laid.
///
/// # Example
/// ```
/// # let model = fuzzy::yaml::parse(include_str!(concat!(env!("CARGO_MANIFEST_DIR"), "/../rules/flagred-paper.yaml")))?.model;
/// # let engine = fuzzy::Engine::new(&model)?;
/// use fuzzy::map::{Grid, GridError};
///
/// assert_eq!(Grid::new(&engine, 1), Err(GridError::TooFewPoints { points: 1 }));
/// let fixed_twice = Grid::new(&engine, 11)?.fix("spread", 0.2)?.fix("spread", 0.3);
/// assert_eq!(fixed_twice, Err(GridError::NoAxis { name: "spread".into() }));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub enum GridError {
    /// An axis needs both ends of its input's range.
    TooFewPoints {
        /// The number asked for.
        points: usize,
    },
    /// More cells than can be counted in 32 bits.
    TooManyCells {
        /// The most that fit.
        most: usize,
    },
    /// A name that is no input, or no longer an axis.
    NoAxis {
        /// The name.
        name: String,
    },
    /// A fixed value that is not a finite number.
    NotFinite {
        /// The input.
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
            GridError::TooManyCells { most } => {
                write!(f, "the grid has too many cells: at most {most} fit")
            }
            GridError::NoAxis { name } => write!(f, "`{name}` is no axis of the grid"),
            GridError::NotFinite { name, value } => {
                write!(f, "`{name}` cannot be fixed at {value}")
            }
        }
    }
}

impl core::error::Error for GridError {}

/// Cells are counted in 32 bits wherever one is kept.
const MOST_CELLS: usize = u32::MAX as usize;

impl Axis {
    /// The coordinate of a point: `low + i (high - low) / (points - 1)`; the last is `high` itself.
    ///
    /// # Example
    /// ```
    /// # use fuzzy::{Engine, map::Grid};
    /// # let model = fuzzy::yaml::parse(include_str!(concat!(env!("CARGO_MANIFEST_DIR"), "/../rules/flagred-paper.yaml")))?.model;
    /// # let engine = Engine::new(&model)?;
    /// let grid = Grid::new(&engine, 11)?;
    /// let margin = &grid.axes()[0];
    /// assert_eq!((margin.coordinate(0), margin.coordinate(3), margin.coordinate(10)), (0.0, 0.15, 0.5));
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn coordinate(&self, i: usize) -> f64 {
        if i + 1 >= self.points {
            self.high
        } else {
            self.low + (self.high - self.low) * (i as f64 / (self.points - 1) as f64)
        }
    }

    /// The points around `x` and how far it lies between them, in [0, 1]; beyond the ends, the end.
    ///
    /// # Example
    /// ```
    /// # use fuzzy::{Engine, map::Grid};
    /// # let model = fuzzy::yaml::parse(include_str!(concat!(env!("CARGO_MANIFEST_DIR"), "/../rules/flagred-paper.yaml")))?.model;
    /// # let engine = Engine::new(&model)?;
    /// let grid = Grid::new(&engine, 3)?; // points at 0, 0.25 and 0.5
    /// let margin = &grid.axes()[0];
    /// assert_eq!(margin.locate(0.3125), (1, 0.25));
    /// assert_eq!(margin.locate(9.0), (1, 1.0));
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn locate(&self, x: f64) -> (usize, f64) {
        let last = self.points.saturating_sub(2);
        let place = (x - self.low) / (self.high - self.low) * (self.points - 1) as f64;
        if place > 0.0 {
            let i = (place as usize).min(last);
            (i, (place - i as f64).min(1.0))
        } else {
            (0, 0.0)
        }
    }
}

impl Grid {
    /// A grid over every input's range, with the same number of points on each axis.
    ///
    /// # Errors
    /// Fewer than 2 points; more cells than can be counted.
    ///
    /// # Example
    /// ```
    /// # use fuzzy::{Engine, map::Grid};
    /// # let model = fuzzy::yaml::parse(include_str!(concat!(env!("CARGO_MANIFEST_DIR"), "/../rules/flagred-paper.yaml")))?.model;
    /// # let engine = Engine::new(&model)?;
    /// let grid = Grid::new(&engine, 11)?;
    /// assert_eq!(grid.cells(), 11 * 11);
    /// assert!(Grid::new(&engine, 1).is_err());
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
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
    /// No such axis; fewer than 2 points; more cells than can be counted.
    ///
    /// # Example
    /// ```
    /// # use fuzzy::{Engine, map::Grid};
    /// # let model = fuzzy::yaml::parse(include_str!(concat!(env!("CARGO_MANIFEST_DIR"), "/../rules/flagred-paper.yaml")))?.model;
    /// # let engine = Engine::new(&model)?;
    /// let grid = Grid::new(&engine, 11)?.points("spread", 3)?;
    /// assert_eq!(grid.cells(), 11 * 3);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn points(mut self, name: &str, points: usize) -> Result<Self, GridError> {
        let axis = self.axes.iter_mut().find(|axis| &*axis.name == name);
        let axis = axis.ok_or_else(|| GridError::NoAxis { name: name.into() })?;
        axis.points = points;
        self.counted()
    }

    /// Fixes one input, which is then no axis: a slice of the whole.
    ///
    /// # Errors
    /// No such axis, or the value is not a finite number.
    ///
    /// # Example
    /// ```
    /// # use fuzzy::{Engine, map::Grid};
    /// # let model = fuzzy::yaml::parse(include_str!(concat!(env!("CARGO_MANIFEST_DIR"), "/../rules/flagred-paper.yaml")))?.model;
    /// # let engine = Engine::new(&model)?;
    /// let line = Grid::new(&engine, 11)?.fix("spread", 0.1)?;
    /// assert_eq!((line.cells(), line.axes().len()), (11, 1));
    /// assert_eq!(line.clone().fix("battery", 1.0).unwrap_err().to_string(), "`battery` is no axis of the grid");
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn fix(mut self, name: &str, value: f64) -> Result<Self, GridError> {
        if !value.is_finite() {
            return Err(GridError::NotFinite {
                name: name.into(),
                value,
            });
        }
        let place = self.axes.iter().position(|axis| &*axis.name == name);
        let place = place.ok_or_else(|| GridError::NoAxis { name: name.into() })?;
        let axis = self.axes.remove(place);
        self.fixed.push(Fixed {
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
            let cells = self.cells.checked_mul(axis.points);
            self.cells = cells
                .filter(|cells| *cells <= MOST_CELLS)
                .ok_or(GridError::TooManyCells { most: MOST_CELLS })?;
        }
        Ok(self)
    }

    /// The axes, in the order of the engine's inputs.
    ///
    /// # Example
    /// ```
    /// # use fuzzy::{Engine, map::Grid};
    /// # let model = fuzzy::yaml::parse(include_str!(concat!(env!("CARGO_MANIFEST_DIR"), "/../rules/flagred-paper.yaml")))?.model;
    /// # let engine = Engine::new(&model)?;
    /// let grid = Grid::new(&engine, 11)?;
    /// assert_eq!(&*grid.axes()[1].name, "spread");
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn axes(&self) -> &[Axis] {
        &self.axes
    }

    /// The inputs that have one value all over the grid.
    ///
    /// # Example
    /// ```
    /// # use fuzzy::{Engine, map::Grid};
    /// # let model = fuzzy::yaml::parse(include_str!(concat!(env!("CARGO_MANIFEST_DIR"), "/../rules/flagred-paper.yaml")))?.model;
    /// # let engine = Engine::new(&model)?;
    /// let line = Grid::new(&engine, 11)?.fix("spread", 0.1)?;
    /// assert_eq!((&*line.fixed()[0].name, line.fixed()[0].value), ("spread", 0.1));
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn fixed(&self) -> &[Fixed] {
        &self.fixed
    }

    /// The number of cells.
    ///
    /// # Example
    /// ```
    /// # use fuzzy::{Engine, map::Grid};
    /// # let model = fuzzy::yaml::parse(include_str!(concat!(env!("CARGO_MANIFEST_DIR"), "/../rules/flagred-paper.yaml")))?.model;
    /// # let engine = Engine::new(&model)?;
    /// let grid = Grid::new(&engine, 11)?;
    /// let corners = (0..grid.cells()).filter(|&cell| grid.indices(cell).iter().all(|i| i % 10 == 0));
    /// assert_eq!(corners.count(), 4);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn cells(&self) -> usize {
        self.cells
    }

    /// The point's place on each axis.
    ///
    /// # Example
    /// ```
    /// # use fuzzy::{Engine, map::Grid};
    /// # let model = fuzzy::yaml::parse(include_str!(concat!(env!("CARGO_MANIFEST_DIR"), "/../rules/flagred-paper.yaml")))?.model;
    /// # let engine = Engine::new(&model)?;
    /// let grid = Grid::new(&engine, 11)?;
    /// assert_eq!(grid.indices(25), [2, 3]); // the last axis runs fastest
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
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

    /// The cell at a place on each axis; `None` off the grid.
    ///
    /// # Example
    /// ```
    /// # use fuzzy::{Engine, map::Grid};
    /// # let model = fuzzy::yaml::parse(include_str!(concat!(env!("CARGO_MANIFEST_DIR"), "/../rules/flagred-paper.yaml")))?.model;
    /// # let engine = Engine::new(&model)?;
    /// let grid = Grid::new(&engine, 11)?;
    /// assert_eq!(grid.cell(&[2, 3]), Some(25));
    /// assert_eq!(grid.cell(&[2, 11]), None);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
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

    /// A cell's coordinate on each axis.
    ///
    /// # Example
    /// ```
    /// # use fuzzy::{Engine, map::Grid};
    /// # let model = fuzzy::yaml::parse(include_str!(concat!(env!("CARGO_MANIFEST_DIR"), "/../rules/flagred-paper.yaml")))?.model;
    /// # let engine = Engine::new(&model)?;
    /// let grid = Grid::new(&engine, 11)?;
    /// assert_eq!(grid.point(25), [0.1, 0.15]);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn point(&self, cell: usize) -> Vec<f64> {
        let indices = self.indices(cell);
        let axes = self.axes.iter().zip(indices);
        axes.map(|(axis, i)| axis.coordinate(i)).collect()
    }

    /// Reads values on the grid's cells N-linearly at a point with a coordinate for each axis; beyond
    /// the grid's ends, at the end.
    ///
    /// `None` where a cell that counts there has no value, or where the number of coordinates is wrong.
    ///
    /// # Example
    /// ```
    /// # use fuzzy::{Engine, map::Grid};
    /// # let model = fuzzy::yaml::parse(include_str!(concat!(env!("CARGO_MANIFEST_DIR"), "/../rules/flagred-paper.yaml")))?.model;
    /// # let engine = Engine::new(&model)?;
    /// let grid = Grid::new(&engine, 3)?;
    /// let sum = |cell| Some(grid.point(cell).iter().sum());
    /// assert_eq!(grid.interpolate(sum, &[0.125, 0.375]), Some(0.5));
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn interpolate(&self, value: impl Fn(usize) -> Option<f64>, point: &[f64]) -> Option<f64> {
        if point.len() != self.axes.len() || point.iter().any(|x| x.is_nan()) {
            return None;
        }
        self.corner_sum(&value, point, 0, 0)
    }

    /// Interpolates along one axis between what the further axes give on both sides.
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
