//! Explanations of outputs.

use std::sync::Arc;

use fuzzy::{
    drawing::{explanation_svg, explanation_text},
    engine::{self, Degree},
};
use numpy::{IntoPyArray, PyArray1};
use pyo3::{prelude::*, types::PyDict};

use crate::compiled::CompiledRuleSet;

/// The explanation of the outputs at one point.
#[pyclass(frozen, module = "flagred.types")]
pub(crate) struct Explanation {
    /// The inputs, with the degree of each of their terms.
    #[pyo3(get)]
    inputs: Vec<Py<ExplainedInput>>,
    /// The rules that fired, strongest first.
    #[pyo3(get)]
    rules: Vec<Py<FiredRule>>,
    /// The outputs, with the share of each rule.
    #[pyo3(get)]
    outputs: Vec<Py<ExplainedOutput>>,
    explanation: engine::Explanation,
    compiled: Arc<CompiledRuleSet>,
}

/// An input with the degree of each of its terms.
#[pyclass(frozen, get_all, module = "flagred.types")]
pub(crate) struct ExplainedInput {
    /// The name of the input.
    name: String,
    /// The given value.
    given: f64,
    /// The value that was used: the given one, clamped to the range.
    value: f64,
    /// The degree of each term, in [0, 1].
    terms: Py<PyDict>,
}

/// A rule that fired.
#[pyclass(frozen, get_all, module = "flagred.types")]
pub(crate) struct FiredRule {
    /// The number of the rule in the model, from 1.
    rule: usize,
    /// The text of the rule.
    text: String,
    /// The degree of the rule's condition.
    degree: f64,
    /// The firing strength: the degree times the weight, after the activation method was applied.
    strength: f64,
    /// The lower bound of the strength, if the condition reads an interval type-2 term.
    lower: Option<f64>,
}

/// An output, and the rules that contribute to it.
#[pyclass(frozen, get_all, module = "flagred.types")]
pub(crate) struct ExplainedOutput {
    /// The name of the output.
    name: String,
    /// The value; None if it is unknown.
    value: Option<f64>,
    /// The lower end of the interval whose middle is the value; None without interval type-2 terms.
    low: Option<f64>,
    /// The upper end of the interval whose middle is the value; None without interval type-2 terms.
    high: Option<f64>,
    /// Whether no rule fires and the value is the model's default.
    is_default: bool,
    /// The largest firing strength of a rule of this output.
    coverage: f64,
    /// The rules that contribute to the output, largest share first.
    rules: Vec<Py<Share>>,
    /// The degree of the value in each term.
    terms: Py<PyDict>,
    /// The points over the range of the output at which the degree of the aggregated set is given.
    set_at: Py<PyArray1<f64>>,
    /// The degree of the aggregated set at each point in `set_at`.
    set_degree: Py<PyArray1<f64>>,
}

/// The contribution of a rule to an output.
#[pyclass(frozen, get_all, module = "flagred.types")]
pub(crate) struct Share {
    /// The number of the rule in the model, from 1.
    rule: usize,
    /// The term in the consequent of the rule.
    term: String,
    /// The firing strength of the rule.
    strength: f64,
    /// The lower bound of the strength, if the condition reads an interval type-2 term.
    lower: Option<f64>,
    /// The share of the rule in the result, in [0, 1].
    share: f64,
    /// In a Takagi-Sugeno or Tsukamoto output, the value of the rule.
    value: Option<f64>,
}

fn degrees(py: Python<'_>, degrees: &[Degree]) -> PyResult<Py<PyDict>> {
    let terms = PyDict::new(py);
    for degree in degrees {
        terms.set_item(&degree.term, degree.degree)?;
    }
    Ok(terms.unbind())
}

fn output(py: Python<'_>, output: &engine::ExplainedOutput) -> PyResult<Py<ExplainedOutput>> {
    let share = |share: &engine::Share| {
        let share = Share {
            rule: share.rule + 1,
            term: share.term.clone(),
            strength: share.strength,
            lower: share.lower,
            share: share.share,
            value: share.value,
        };
        Py::new(py, share)
    };
    let (at, degree): (Vec<f64>, Vec<f64>) = output.set.iter().copied().unzip();
    Py::new(
        py,
        ExplainedOutput {
            name: output.name.clone(),
            value: output.value,
            low: output.low,
            high: output.high,
            is_default: output.is_default,
            coverage: output.coverage,
            rules: output.rules.iter().map(share).collect::<PyResult<_>>()?,
            terms: degrees(py, &output.terms)?,
            set_at: at.into_pyarray(py).unbind(),
            set_degree: degree.into_pyarray(py).unbind(),
        },
    )
}

impl Explanation {
    pub(crate) fn new(
        py: Python<'_>,
        explanation: engine::Explanation,
        compiled: Arc<CompiledRuleSet>,
    ) -> PyResult<Explanation> {
        let input = |input: &engine::ExplainedInput| {
            let terms = degrees(py, &input.terms)?;
            let (name, given, value) = (input.name.clone(), input.given, input.value);
            Py::new(
                py,
                ExplainedInput {
                    name,
                    given,
                    value,
                    terms,
                },
            )
        };
        let rule = |rule: &engine::FiredRule| {
            let (degree, strength, lower) = (rule.degree, rule.strength, rule.lower);
            let (rule, text) = (rule.rule + 1, rule.text.clone());
            Py::new(
                py,
                FiredRule {
                    rule,
                    text,
                    degree,
                    strength,
                    lower,
                },
            )
        };
        Ok(Explanation {
            inputs: explanation
                .inputs
                .iter()
                .map(input)
                .collect::<PyResult<_>>()?,
            rules: explanation
                .rules
                .iter()
                .map(rule)
                .collect::<PyResult<_>>()?,
            outputs: explanation
                .outputs
                .iter()
                .map(|o| output(py, o))
                .collect::<PyResult<_>>()?,
            explanation,
            compiled,
        })
    }
}

#[pymethods]
impl Explanation {
    /// The value of each output; None if it is unknown.
    #[getter]
    fn values<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let values = PyDict::new(py);
        for output in &self.explanation.outputs {
            values.set_item(&output.name, output.value)?;
        }
        Ok(values)
    }

    /// The picture as SVG: the terms, the rules that fired, the aggregated set.
    fn svg(&self) -> String {
        explanation_svg(self.compiled.engine.model(), &self.explanation)
    }

    fn _repr_svg_(&self) -> String {
        self.svg()
    }

    fn __str__(&self) -> String {
        explanation_text(self.compiled.engine.model(), &self.explanation)
    }

    fn __repr__(&self) -> String {
        let outputs = self.explanation.outputs.iter();
        let outputs: Vec<&str> = outputs.map(|output| output.name.as_str()).collect();
        let rules = self.explanation.rules.len();
        format!("Explanation({}: {rules} rules fired)", outputs.join(", "))
    }
}
