//! Outcomes of an evaluation.

use fuzzy::engine::{self, State};
use numpy::{IntoPyArray, PyArrayDyn, PyArrayMethods};
use pyo3::prelude::*;

use crate::errors::data_error;

/// The outcome of one output at one point.
#[pyclass(frozen, get_all, eq, module = "flagred.types")]
#[derive(Clone, PartialEq)]
pub(crate) struct Outcome {
    /// The value; None if it is unknown.
    value: Option<f64>,
    /// The largest firing strength of a rule, in [0, 1].
    coverage: f64,
    /// The rule number with that strength, from 1; None if no rule fires.
    dominant_rule: Option<usize>,
    /// Whether an input was outside its range and was clamped to its end.
    clamped: bool,
    /// The state of the value.
    state: &'static str,
}

#[pymethods]
impl Outcome {
    /// The value; NaN if it is unknown.
    fn __float__(&self) -> f64 {
        self.value.unwrap_or(f64::NAN)
    }

    #[staticmethod]
    fn _of(
        value: Option<f64>,
        coverage: f64,
        dominant_rule: Option<usize>,
        clamped: bool,
        state: &str,
    ) -> PyResult<Self> {
        let state = STATES.iter().find(|known| **known == state);
        Ok(Outcome {
            value,
            coverage,
            dominant_rule,
            clamped,
            state: state.ok_or_else(|| data_error("no state of an outcome", None))?,
        })
    }

    #[expect(clippy::type_complexity, reason = "what pickle takes")]
    fn __reduce__<'py>(
        slf: &Bound<'py, Self>,
    ) -> PyResult<(
        Bound<'py, PyAny>,
        (Option<f64>, f64, Option<usize>, bool, &'static str),
    )> {
        let it = slf.get();
        let fields = (
            it.value,
            it.coverage,
            it.dominant_rule,
            it.clamped,
            it.state,
        );
        Ok((slf.getattr("_of")?, fields))
    }

    fn __repr__(&self, py: Python<'_>) -> PyResult<String> {
        let shown = |value: Py<PyAny>| Ok::<_, PyErr>(value.bind(py).repr()?.to_string());
        let value = shown(self.value.into_pyobject(py)?.unbind())?;
        let coverage = shown(self.coverage.into_pyobject(py)?.into_any().unbind())?;
        let rule = shown(self.dominant_rule.into_pyobject(py)?.unbind())?;
        let clamped = if self.clamped { "True" } else { "False" };
        Ok(format!(
            "Outcome(value={value}, coverage={coverage}, dominant_rule={rule}, clamped={clamped}, state='{}')",
            self.state
        ))
    }
}

/// All states of an outcome.
const STATES: [&str; 5] = [
    "defined",
    "default",
    "previous",
    "no_rule_fired",
    "input_not_finite",
];

impl From<engine::Outcome> for Outcome {
    fn from(outcome: engine::Outcome) -> Self {
        Outcome {
            value: outcome.value(),
            coverage: outcome.coverage,
            dominant_rule: outcome.dominant_rule.map(|rule| rule + 1),
            clamped: outcome.clamped,
            state: match outcome.state {
                State::Defined(_) => STATES[0],
                State::Default(_) => STATES[1],
                State::Previous(_) => STATES[2],
                State::NoRuleFired => STATES[3],
                State::InputNotFinite => STATES[4],
            },
        }
    }
}

/// The outcomes of one output at many points, as arrays.
#[pyclass(frozen, get_all, module = "flagred.types")]
pub(crate) struct Outcomes {
    /// The values; NaN if they are unknown.
    value: Py<PyArrayDyn<f64>>,
    /// The largest firing strength of a rule, in [0, 1].
    coverage: Py<PyArrayDyn<f64>>,
    /// The rule numbers with that strength, from 1; masked if no rule fires.
    dominant_rule: Py<PyAny>,
    /// Whether an input was outside its range and was clamped to its end.
    clamped: Py<PyArrayDyn<bool>>,
}

/// The outcomes of one output, row by row.
pub(crate) struct Columns {
    /// NaN is unknown.
    pub(crate) value: Vec<f64>,
    pub(crate) reasons: Option<Reasons>,
}

/// The reasons of values.
pub(crate) struct Reasons {
    pub(crate) coverage: Vec<f64>,
    /// [`NO_RULE`] if no rule fires.
    pub(crate) dominant_rule: Vec<i32>,
    pub(crate) clamped: Vec<bool>,
}

/// A placeholder for a rule number; it is masked or null before it is returned.
pub(crate) const NO_RULE: i32 = -1;

/// The rule number, from 1.
pub(crate) fn rule_number(rule: Option<usize>) -> i32 {
    rule.map_or(NO_RULE, |rule| rule as i32 + 1)
}

impl Outcomes {
    pub(crate) fn new(
        py: Python<'_>,
        value: Vec<f64>,
        reasons: Reasons,
        shape: &[usize],
    ) -> PyResult<Outcomes> {
        let rules = reasons.dominant_rule.into_pyarray(py).reshape(shape)?;
        let masked = py.import("numpy")?.getattr("ma")?;
        let masked = masked.call_method1("masked_equal", (rules, NO_RULE))?;
        Ok(Outcomes {
            value: value.into_pyarray(py).reshape(shape)?.unbind(),
            coverage: reasons.coverage.into_pyarray(py).reshape(shape)?.unbind(),
            dominant_rule: masked.unbind(),
            clamped: reasons.clamped.into_pyarray(py).reshape(shape)?.unbind(),
        })
    }
}

#[pymethods]
impl Outcomes {
    fn __repr__(&self, py: Python<'_>) -> PyResult<String> {
        let value = self.value.bind(py).as_any();
        Ok(format!("Outcomes(value={})", value.repr()?))
    }
}
