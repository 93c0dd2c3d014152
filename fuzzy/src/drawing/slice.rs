//! The part of a decision map that is drawn: one output over one or two inputs, with the other inputs fixed.

use super::{
    scale::Scale,
    text::{short, titled, visible},
};
use crate::{
    map::DecisionMap,
    model::{Model, Variable},
};

/// One output over one or two inputs, with the other inputs fixed.
///
/// This is plain data: construct it from any source, or convert a [`DecisionMap`] with [`Slice::new`].
///
/// # Example: a curve over one input
/// ```
/// use fuzzy::{
///     Engine, Model, drawing,
///     map::{DecisionMap, Grid},
///     model::{Output, MembershipFunction, Variable},
///     rule::{Condition, Rule},
/// };
///
/// let low = MembershipFunction::Triangle { left: 0.0, peak: 0.0, right: 1.0 };
/// let small = MembershipFunction::Rectangle { left: 0.0, right: 0.5 };
/// let model = Model::builder("fan")
///     .input(Variable::new("humidity", 0.0, 1.0).term("low", low))
///     .output(Output::new(Variable::new("speed", 0.0, 1.0).term("small", small)))
///     .rule(Rule::new(Condition::is("humidity", "low"), "speed", "small"))
///     .build();
/// let engine = Engine::new(&model)?;
/// let map = DecisionMap::new(&engine, Grid::new(&engine, 51)?, 0)?;
/// let slice = drawing::Slice::new(&model, &map).ok_or("fix inputs until one or two are left")?;
/// let svg = drawing::map_svg(&slice);
/// assert!(svg.contains("humidity"));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug, Clone)]
pub struct Slice {
    /// The name of the rule set.
    pub model: String,
    /// The name of the output.
    pub output: String,
    /// The unit of the output.
    pub unit: Option<String>,
    /// The range of the output.
    pub range: Scale,
    /// The input along the horizontal axis.
    pub x: Axis,
    /// The input along the vertical axis; `None` if there is only one axis.
    pub y: Option<Axis>,
    /// The fixed inputs with their values.
    pub fixed: Vec<(String, f64)>,
    /// The method by which cells without a rule were filled; `None` if they were not.
    pub filling: Option<String>,
    /// The cells: for each point of `x`, one cell per point of `y`.
    pub cells: Vec<Cell>,
}

/// An input along an axis.
#[derive(Debug, Clone)]
pub struct Axis {
    /// The name of the input.
    pub name: String,
    /// The unit of the input.
    pub unit: Option<String>,
    /// The values, evenly spaced in ascending order.
    pub points: Vec<f64>,
}

/// One cell of a slice.
#[derive(Debug, Clone, Copy, Default)]
pub struct Cell {
    /// The value of the output; `None` if it is unknown.
    pub value: Option<f64>,
    /// The largest firing strength of a rule.
    pub coverage: f64,
    /// The index of the rule with the largest firing strength.
    pub rule: Option<usize>,
    /// The distance to the nearest covered cell, if the value was filled by interpolation.
    pub filled_from: Option<f64>,
}

impl Axis {
    /// Creates an axis of `points` evenly spaced values over a part of the range of an input.
    pub fn new(variable: &Variable, part: Scale, points: usize) -> Axis {
        let last = points.saturating_sub(1).max(1) as f64;
        Axis {
            name: variable.name.clone(),
            unit: variable.unit.clone(),
            points: (0..points).map(|i| part.value(i as f64 / last)).collect(),
        }
    }

    /// Returns the part of the input's range that the axis shows.
    pub fn scale(&self) -> Scale {
        Scale {
            low: self.points.first().copied().unwrap_or(0.0),
            high: self.points.last().copied().unwrap_or(1.0),
        }
    }

    /// Returns the name and the unit.
    pub(super) fn title(&self) -> String {
        titled(&self.name, self.unit.as_deref())
    }
}

impl Slice {
    /// Converts a decision map to a slice; `None` unless it has one or two axes.
    pub fn new(model: &Model, map: &DecisionMap) -> Option<Slice> {
        let grid = map.grid();
        let axis = |axis: &crate::map::Axis| {
            let variable = model
                .inputs
                .iter()
                .find(|input| *input.name == *axis.name)?;
            Some(Axis::new(
                variable,
                Scale::new(axis.low, axis.high),
                axis.points,
            ))
        };
        let (x, y) = match grid.axes() {
            [x] => (axis(x)?, None),
            [x, y] => (axis(x)?, Some(axis(y)?)),
            _ => return None,
        };
        let mut outputs = model.outputs.iter().map(|output| &output.variable);
        let output = outputs.find(|output| output.name == map.output())?;
        let cell = |cell| Cell {
            value: map.value(cell),
            coverage: map.coverage(cell),
            rule: map.dominant(cell),
            filled_from: None,
        };
        Some(Slice {
            model: model.name.clone(),
            output: output.name.clone(),
            unit: output.unit.clone(),
            range: Scale::new(output.low, output.high),
            x,
            y,
            fixed: grid
                .fixed()
                .iter()
                .map(|input| (input.name.to_string(), input.value))
                .collect(),
            filling: None,
            cells: (0..grid.cells()).map(cell).collect(),
        })
    }

    /// Returns the cell at a point of each axis; an empty cell if the point is outside.
    pub fn cell(&self, x: usize, y: usize) -> Cell {
        let cell = self.cells.get(x * self.rows() + y);
        cell.copied().unwrap_or_default()
    }

    /// Returns the number of points along the horizontal axis.
    pub fn columns(&self) -> usize {
        self.x.points.len()
    }

    /// Returns the number of points along the vertical axis; 1 if there is none.
    pub fn rows(&self) -> usize {
        self.y.as_ref().map_or(1, |y| y.points.len())
    }

    pub(super) fn any_filled(&self) -> bool {
        self.cells.iter().any(|cell| cell.filled_from.is_some())
    }

    pub(super) fn any_unknown(&self) -> bool {
        self.cells.iter().any(|cell| cell.value.is_none())
    }

    /// Returns the position of a value in the output's range, in [0, 1].
    pub(super) fn share(&self, value: f64) -> f64 {
        self.range.share(value).clamp(0.0, 1.0)
    }

    /// Returns a line with the names of the rule set and the output, and the values of the fixed inputs.
    pub fn heading(&self) -> String {
        let heading = format!("{} {}", self.title(), self.fixed_text());
        visible(heading.trim_end()).into_owned()
    }

    /// Returns the title: `rule set: output [unit]`.
    pub(super) fn title(&self) -> String {
        format!("{}: {}", self.model, self.output_title())
    }

    pub(super) fn output_title(&self) -> String {
        titled(&self.output, self.unit.as_deref())
    }

    /// Returns the values of the fixed inputs: `at load = 0.5, at_limit = 0`; empty if no input is fixed.
    pub(super) fn fixed_text(&self) -> String {
        let fixed = self.fixed.iter();
        let fixed: Vec<String> = fixed
            .map(|(name, value)| format!("{name} = {}", short(*value)))
            .collect();
        match fixed.as_slice() {
            [] => String::new(),
            fixed => format!("at {}", fixed.join(", ")),
        }
    }

    /// Returns a description of the filling method.
    pub(super) fn filling_text(&self) -> &str {
        self.filling.as_deref().unwrap_or("filled")
    }
}
