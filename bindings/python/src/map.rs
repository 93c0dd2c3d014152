//! Decision maps: an output over a grid of inputs.

use std::sync::Arc;

use fuzzy::{
    drawing::{Slice, map_svg, rules_svg, surface_svg},
    map::{self, Axis, Grid},
};
use numpy::{IntoPyArray, PyArrayDyn, PyArrayMethods};
use pyo3::{prelude::*, sync::PyOnceLock, types::PyDict};

use crate::{
    compiled::CompiledRuleSet,
    errors::data_error,
    outcome::{NO_RULE, rule_number},
};

/// One output of a rule set over a grid of its inputs.
#[pyclass(frozen, module = "flagred.types")]
pub(crate) struct DecisionMap {
    map: map::DecisionMap,
    compiled: Arc<CompiledRuleSet>,
}

impl DecisionMap {
    /// Evaluates the grid on the threads of the current pool.
    pub(crate) fn new(compiled: Arc<CompiledRuleSet>, grid: Grid, output: usize) -> PyResult<Self> {
        let map = map::DecisionMap::new(&compiled.engine, grid, output);
        let map = map.map_err(|error| data_error(error, None))?;
        Ok(DecisionMap { map, compiled })
    }

    fn shape(&self) -> Vec<usize> {
        self.map
            .grid()
            .axes()
            .iter()
            .map(|axis| axis.points)
            .collect()
    }

    fn cells(&self) -> std::ops::Range<usize> {
        0..self.map.grid().cells()
    }

    fn slice(&self) -> PyResult<Slice> {
        Slice::new(self.compiled.engine.model(), &self.map).ok_or_else(|| {
            let axes = self.map.grid().axes().len();
            data_error(
                format!("a picture has one or two axes, but the map has {axes}"),
                Some("fix the other inputs at a value: `model.map(bill=80)`".into()),
            )
        })
    }
}

#[pymethods]
impl DecisionMap {
    /// The output.
    #[getter]
    fn output(&self) -> &str {
        self.map.output()
    }

    /// The points along each axis, by the name of the input, in the order of the axes of `values`.
    #[getter]
    fn axes<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let axes = PyDict::new(py);
        for axis in self.map.grid().axes() {
            let points: Vec<f64> = (0..axis.points)
                .map(|i| Axis::coordinate(axis, i))
                .collect();
            axes.set_item(&*axis.name, points.into_pyarray(py))?;
        }
        Ok(axes)
    }

    /// The fixed inputs and their values.
    #[getter]
    fn fixed<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let held = PyDict::new(py);
        for fixed in self.map.grid().fixed() {
            held.set_item(&*fixed.name, fixed.value)?;
        }
        Ok(held)
    }

    /// The value of each cell; NaN if it is unknown.
    #[getter]
    fn values<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArrayDyn<f64>>> {
        let values = self
            .cells()
            .map(|cell| self.map.value(cell).unwrap_or(f64::NAN));
        values
            .collect::<Vec<f64>>()
            .into_pyarray(py)
            .reshape(self.shape())
    }

    /// The largest firing strength of a rule in each cell, in [0, 1].
    #[getter]
    fn coverage<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArrayDyn<f64>>> {
        let coverage = self.cells().map(|cell| self.map.coverage(cell));
        coverage
            .collect::<Vec<f64>>()
            .into_pyarray(py)
            .reshape(self.shape())
    }

    /// The number of the rule with the largest firing strength in each cell, from 1; masked if no rule fires.
    #[getter]
    fn dominant_rule<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        let rules = self
            .cells()
            .map(|cell| rule_number(self.map.dominant(cell)));
        let rules = rules
            .collect::<Vec<i32>>()
            .into_pyarray(py)
            .reshape(self.shape())?;
        py.import("numpy")?
            .getattr("ma")?
            .call_method1("masked_equal", (rules, NO_RULE))
    }

    /// The picture as SVG.
    #[pyo3(signature = (kind = "map"))]
    fn svg(&self, kind: &str) -> PyResult<String> {
        let slice = self.slice()?;
        match kind {
            "map" => Ok(map_svg(&slice)),
            "rules" => Ok(rules_svg(&slice, self.compiled.engine.model())),
            "surface" => surface_svg(&slice).ok_or_else(|| {
                let help = "fix one input less".to_owned();
                data_error("a surface has two axes, but the map has one", Some(help))
            }),
            other => Err(data_error(
                format!("`{other}` is not a kind of picture"),
                Some("write `map`, `rules` or `surface`".into()),
            )),
        }
    }

    /// Draws the map, which must have one or two axes.
    ///
    /// Parameters
    /// ----------
    /// ax : matplotlib.axes.Axes, optional
    ///     Axes of matplotlib to draw on.
    ///
    /// Returns
    /// -------
    /// Picture or matplotlib.axes.Axes
    ///     The axes; without ``ax`` a picture in SVG, which does not require matplotlib.
    #[pyo3(signature = (ax = None))]
    fn plot<'py>(
        slf: &Bound<'py, Self>,
        ax: Option<Bound<'py, PyAny>>,
    ) -> PyResult<Bound<'py, PyAny>> {
        static PLOT: PyOnceLock<Py<PyAny>> = PyOnceLock::new();
        let plot = PLOT.import(slf.py(), "flagred._picture", "plot_map")?;
        plot.call1((slf, ax))
    }

    fn _repr_svg_(&self) -> Option<String> {
        self.slice().ok().map(|slice| map_svg(&slice))
    }

    fn __repr__(&self) -> String {
        let axes = self.map.grid().axes().iter();
        let axes: Vec<String> = axes.map(|a| format!("{}: {}", a.name, a.points)).collect();
        format!(
            "DecisionMap({} over {})",
            self.map.output(),
            axes.join(", ")
        )
    }
}
