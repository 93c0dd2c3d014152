//! Assessments of flights: verdict, findings, the risk over time, and the report.

use std::sync::{Arc, OnceLock};

use arrow_array::{ArrayRef, BooleanArray, Float64Array, Int32Array, RecordBatch};
use arrow_schema::{Field, Schema};
use flagred::{
    flight::{Assessment, RiskInterval, Step},
    loaded::Loaded,
    log::{assess, assess_with_intervals},
    monitor::Estimate,
};
use flagred_flightlog::Flight;
use flagred_report::{
    document::{FindingDocument, document},
    finding::FindingContext,
    moment,
    page::{self, Subject},
};
use pyo3::prelude::*;
use serde_json::json;

use crate::{
    errors::data_error,
    flight::FlightData,
    profile::Profile,
    table::{Table, known},
    threads::interruptible,
};

/// The assessment of a flight, inside `flagred.types.Assessment`.
#[pyclass(frozen, subclass, module = "flagred._core")]
pub(crate) struct AssessmentData {
    flight: Py<FlightData>,
    loaded: Arc<Loaded>,
    step_s: Option<f64>,
    /// Whether the intervals of the risk are computed.
    with_intervals: bool,
    /// The flight and its assessment; after unpickling, created again at the first use.
    subject: OnceLock<Arc<Subject>>,
    /// The verdict, findings and summary as JSON, in the form in which they are pickled.
    json_text: Option<String>,
}

impl AssessmentData {
    fn subject(&self, py: Python<'_>) -> PyResult<&Arc<Subject>> {
        if let Some(subject) = self.subject.get() {
            return Ok(subject);
        }
        let flight = self.flight.get();
        let (name, step_s, with_intervals) =
            (flight.name.clone(), self.step_s, self.with_intervals);
        let (flight, of) = (Arc::clone(flight.flight(py)?), Arc::clone(&self.loaded));
        let subject = interruptible(py, move || Subject {
            assessed: match step_s {
                Some(step_s) if with_intervals => {
                    assess_with_intervals(&flight, &of.estimator, step_s)
                }
                step_s => assess(&flight, &of.estimator, step_s),
            },
            name,
            flight,
        })?;
        Ok(self.subject.get_or_init(|| Arc::new(subject)))
    }

    /// The name of the flight, the flight, and its assessment.
    fn parts(&self, py: Python<'_>) -> PyResult<(&str, &Flight, &Assessment)> {
        let subject = self.subject(py)?;
        Ok((&subject.name, &subject.flight, &subject.assessed))
    }
}

#[pymethods]
impl AssessmentData {
    #[new]
    #[pyo3(signature = (flight, profile, step_s, json_text = None, *, with_intervals = true))]
    fn new(
        flight: &Bound<'_, FlightData>,
        profile: &Profile,
        step_s: Option<f64>,
        json_text: Option<String>,
        with_intervals: bool,
    ) -> PyResult<Self> {
        if let Some(step_s) = step_s.filter(|step_s| step_s.is_nan() || *step_s <= 0.0) {
            let help = "write a number of seconds above 0, or None for no steps".to_owned();
            let message = format!("`step_s` is {step_s}; it must be above 0");
            return Err(data_error(message, Some(help)));
        }
        let new = AssessmentData {
            flight: flight.clone().unbind(),
            loaded: Arc::clone(&profile.loaded),
            step_s,
            with_intervals,
            subject: OnceLock::new(),
            json_text,
        };
        if new.json_text.is_none() {
            new.subject(flight.py())?;
        }
        Ok(new)
    }

    /// Verdict, findings and summary, in JSON.
    fn _json(&self, py: Python<'_>) -> PyResult<String> {
        if let Some(json_text) = &self.json_text {
            return Ok(json_text.clone());
        }
        let (_, flight, assessed) = self.parts(py)?;
        let context = FindingContext {
            estimator: &self.loaded.estimator,
            motors: &flight.motors,
        };
        Ok(json_text(assessed, context))
    }

    /// The time between two steps in seconds, if the caller chose it.
    fn _step_s(&self) -> Option<f64> {
        self.step_s
    }

    /// The whole assessment in JSON, as `flagred assess --json` prints it.
    fn to_json(&self, py: Python<'_>) -> PyResult<String> {
        let (name, flight, assessed) = self.parts(py)?;
        let document = document(name, flight, &self.loaded.estimator, assessed);
        serde_json::to_string(&document).map_err(|error| data_error(error, None))
    }

    /// The state at a time in seconds, and the rules that fired, in JSON.
    fn _moment(&self, py: Python<'_>, t_s: f64) -> PyResult<String> {
        let (_, flight, assessed) = self.parts(py)?;
        let moment = moment::moment(flight, &self.loaded.estimator, assessed, t_s);
        serde_json::to_string(&moment).map_err(|error| data_error(error, None))
    }

    /// The risk over time.
    fn _steps(&self, py: Python<'_>) -> PyResult<Table> {
        steps(&self.subject(py)?.assessed)
    }

    /// The report as a single, self-contained HTML page.
    fn html(&self, py: Python<'_>) -> PyResult<String> {
        let (subject, loaded) = (Arc::clone(self.subject(py)?), Arc::clone(&self.loaded));
        interruptible(py, move || page::report(&subject, &loaded))
    }

    /// The picture of the risk over time as SVG; None if no risk is known.
    fn svg(&self, py: Python<'_>) -> PyResult<Option<String>> {
        Ok(page::svg(self.subject(py)?, &self.loaded))
    }
}

/// Returns a page in the style of a report, with the given HTML as its body.
#[pyfunction]
pub(crate) fn _page(title: &str, body: String) -> String {
    page::around(title, body)
}

/// Verdict, findings and summary, in JSON.
pub(crate) fn json_text(assessed: &Assessment, context: FindingContext<'_>) -> String {
    let findings = assessed.findings.iter();
    let findings: Vec<_> = findings.map(|f| FindingDocument::new(f, context)).collect();
    json!({
        "verdict": assessed.verdict,
        "findings": findings,
        "findings_left_out": assessed.findings_left_out,
        "summary": assessed.summary,
        "assumed_inputs": assessed.assumed_inputs,
        "unknown_risks": assessed.unknown_risks,
        "widened_step_s": assessed.widened_step_s,
    })
    .to_string()
}

/// The risk over time as a table with one row per step.
pub(crate) fn steps(assessed: &Assessment) -> PyResult<Table> {
    let steps = &assessed.steps;
    let number = |get: &dyn Fn(&Step) -> Option<f64>| {
        known(
            steps
                .iter()
                .map(|step| get(step).unwrap_or(f64::NAN))
                .collect(),
        )
    };
    let of = |get: fn(Estimate) -> f64| number(&|step: &Step| step.estimate.map(get));
    let end = |get: fn(RiskInterval) -> f64| number(&|step: &Step| step.risk_interval.map(get));
    let rules = steps.iter().map(|step| {
        let rule = step.estimate.and_then(|estimate| estimate.dominant_rule);
        rule.map(|rule| rule as i32 + 1)
    });
    let filled = steps.iter().map(|step| {
        let estimate = step.estimate;
        estimate.map(|estimate| estimate.filled_from.is_some())
    });
    let times: Float64Array = steps.iter().map(|step| Some(step.t_s)).collect();
    let judged: BooleanArray = steps.iter().map(|step| Some(step.judged)).collect();
    let mut columns: Vec<(&str, &str, ArrayRef)> = vec![
        ("t_s", "s", Arc::new(times)),
        ("risk", "%", of(|estimate| estimate.risk_pct)),
        ("risk_low", "%", end(|interval| interval.low_pct)),
        ("risk_high", "%", end(|interval| interval.high_pct)),
        ("elevated_risk", "%", number(&|step| step.elevated_risk_pct)),
        ("coverage", "1", of(|estimate| estimate.coverage)),
        ("filled", "", Arc::new(filled.collect::<BooleanArray>())),
        ("dominant_rule", "", Arc::new(rules.collect::<Int32Array>())),
        ("margin", "1", number(&|step| step.margin)),
        ("spread", "1", number(&|step| step.spread)),
        ("judged", "", Arc::new(judged)),
    ];
    // A profile may have an input `spread`, but its window may differ from the window of the column `spread`.
    let inputs: Vec<String> = assessed
        .inputs
        .iter()
        .map(|name| format!("input_{name}"))
        .collect();
    for (i, name) in inputs.iter().enumerate() {
        columns.push((name, "", number(&|step| step.inputs.get(i).copied())));
    }
    let others: Vec<String> = assessed
        .other_risks
        .iter()
        .map(|name| format!("other_risk_{name}"))
        .collect();
    for (i, name) in others.iter().enumerate() {
        let values = number(&|step| step.other_risks_pct.get(i).copied());
        columns.push((name, "%", values));
    }
    let fields = columns.iter().map(|(name, unit, values)| {
        let field = Field::new(*name, values.data_type().clone(), *name != "t_s");
        field.with_metadata([("unit".to_owned(), (*unit).to_owned())].into())
    });
    let schema = Arc::new(Schema::new(fields.collect::<Vec<_>>()));
    let values = columns.into_iter().map(|(_, _, values)| values).collect();
    let batch = RecordBatch::try_new(Arc::clone(&schema), values);
    let batches = vec![batch.map_err(|error| data_error(error, None))?];
    Ok(Table { batches, schema })
}
