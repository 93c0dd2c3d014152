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
    /// The lower end of the interval if the output depends on type-2 terms; otherwise the value itself.
    low: Option<f64>,
    /// The upper end of the interval if the output depends on type-2 terms; otherwise the value itself.
    high: Option<f64>,
    /// The largest firing strength of a rule, in [0, 1].
    coverage: f64,
    /// The number of the rule with the largest firing strength, from 1; None if no rule fires.
    dominant_rule: Option<usize>,
    /// Whether an input was outside its range and was therefore clamped to the nearer end of the range.
    clamped: bool,
    /// The state of the value, such as ``defined``.
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
        ends: (Option<f64>, Option<f64>),
        coverage: f64,
        dominant_rule: Option<usize>,
        clamped: bool,
        state: &str,
    ) -> PyResult<Self> {
        let state = STATES.iter().find(|known| **known == state);
        Ok(Outcome {
            value,
            low: ends.0,
            high: ends.1,
            coverage,
            dominant_rule,
            clamped,
            state: state.ok_or_else(|| data_error("not a state of an outcome", None))?,
        })
    }

    #[expect(clippy::type_complexity, reason = "what pickle takes")]
    fn __reduce__<'py>(
        slf: &Bound<'py, Self>,
    ) -> PyResult<(
        Bound<'py, PyAny>,
        (
            Option<f64>,
            (Option<f64>, Option<f64>),
            f64,
            Option<usize>,
            bool,
            &'static str,
        ),
    )> {
        let it = slf.get();
        let fields = (
            it.value,
            (it.low, it.high),
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
        let ends = match self.low == self.high {
            true => String::new(),
            false => {
                let low = shown(self.low.into_pyobject(py)?.unbind())?;
                let high = shown(self.high.into_pyobject(py)?.unbind())?;
                format!("low={low}, high={high}, ")
            }
        };
        Ok(format!(
            "Outcome(value={value}, {ends}coverage={coverage}, dominant_rule={rule}, clamped={clamped}, state='{}')",
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
            low: outcome.low(),
            high: outcome.high(),
            coverage: outcome.coverage,
            dominant_rule: outcome.dominant_rule.map(|rule| rule + 1),
            clamped: outcome.clamped,
            state: match outcome.state {
                State::Defined(_) | State::Interval { .. } => STATES[0],
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
    /// The values; NaN if unknown.
    value: Py<PyArrayDyn<f64>>,
    /// The lower ends of the intervals if the output depends on type-2 terms; otherwise the values themselves.
    low: Py<PyArrayDyn<f64>>,
    /// The upper ends of the intervals if the output depends on type-2 terms; otherwise the values themselves.
    high: Py<PyArrayDyn<f64>>,
    /// The largest firing strength of a rule, in [0, 1].
    coverage: Py<PyArrayDyn<f64>>,
    /// The number of the rule with the largest firing strength, from 1; masked if no rule fires.
    dominant_rule: Py<PyAny>,
    /// Whether an input was outside its range and was therefore clamped to the nearer end of the range.
    clamped: Py<PyArrayDyn<bool>>,
}

/// The outcomes of one output, row by row.
pub(crate) struct Columns {
    /// The values, where NaN means unknown.
    pub(crate) value: Vec<f64>,
    pub(crate) reasons: Option<Reasons>,
}

/// The lower and the upper ends of intervals, where NaN means unknown.
pub(crate) struct Ends {
    pub(crate) low: Vec<f64>,
    pub(crate) high: Vec<f64>,
}

/// The columns of outcomes other than the values.
pub(crate) struct Reasons {
    /// The ends of the intervals; `None` if no type-2 term affects the output.
    pub(crate) ends: Option<Ends>,
    pub(crate) coverage: Vec<f64>,
    /// The number of the rule with the largest firing strength; [`NO_RULE`] if no rule fires.
    pub(crate) dominant_rule: Vec<i32>,
    pub(crate) clamped: Vec<bool>,
}

/// A placeholder if no rule fires; it is masked or becomes null before it is returned.
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
        let value = value.into_pyarray(py).reshape(shape)?;
        let (low, high) = match reasons.ends {
            None => (value.clone(), value.clone()),
            Some(Ends { low, high }) => (
                low.into_pyarray(py).reshape(shape)?,
                high.into_pyarray(py).reshape(shape)?,
            ),
        };
        Ok(Outcomes {
            value: value.unbind(),
            low: low.unbind(),
            high: high.unbind(),
            coverage: reasons.coverage.into_pyarray(py).reshape(shape)?.unbind(),
            dominant_rule: masked.unbind(),
            clamped: reasons.clamped.into_pyarray(py).reshape(shape)?.unbind(),
        })
    }
}

/// The values of an output for inputs that are intervals.
#[pyclass(frozen, get_all, eq, module = "flagred.types")]
#[derive(Clone, PartialEq)]
pub(crate) struct IntervalOutcome {
    /// The lower end of an interval that contains every value; None if the output has no value.
    low: Option<f64>,
    /// The upper end of an interval that contains every value; None if the output has no value.
    high: Option<f64>,
    /// Whether the output may have no value for some of the inputs, because no rule fires.
    may_be_undefined: bool,
    /// Whether the interval of an input was partly outside the range of the input and was clamped to the range.
    clamped: bool,
}

impl From<engine::IntervalOutcome> for IntervalOutcome {
    fn from(outcome: engine::IntervalOutcome) -> Self {
        IntervalOutcome {
            low: outcome.values.map(|values| values.low),
            high: outcome.values.map(|values| values.high),
            may_be_undefined: outcome.may_be_undefined,
            clamped: outcome.clamped,
        }
    }
}

#[pymethods]
impl IntervalOutcome {
    #[staticmethod]
    fn _of(low: Option<f64>, high: Option<f64>, may_be_undefined: bool, clamped: bool) -> Self {
        IntervalOutcome {
            low,
            high,
            may_be_undefined,
            clamped,
        }
    }

    #[expect(clippy::type_complexity, reason = "what pickle takes")]
    fn __reduce__<'py>(
        slf: &Bound<'py, Self>,
    ) -> PyResult<(Bound<'py, PyAny>, (Option<f64>, Option<f64>, bool, bool))> {
        let it = slf.get();
        let fields = (it.low, it.high, it.may_be_undefined, it.clamped);
        Ok((slf.getattr("_of")?, fields))
    }

    fn __repr__(&self, py: Python<'_>) -> PyResult<String> {
        let shown = |value: Option<f64>| {
            let value = value.into_pyobject(py)?;
            Ok::<_, PyErr>(value.repr()?.to_string())
        };
        let truth = |value: bool| if value { "True" } else { "False" };
        Ok(format!(
            "IntervalOutcome(low={}, high={}, may_be_undefined={}, clamped={})",
            shown(self.low)?,
            shown(self.high)?,
            truth(self.may_be_undefined),
            truth(self.clamped)
        ))
    }
}

#[pymethods]
impl Outcomes {
    fn __repr__(&self, py: Python<'_>) -> PyResult<String> {
        let value = self.value.bind(py).as_any();
        Ok(format!("Outcomes(value={})", value.repr()?))
    }
}
