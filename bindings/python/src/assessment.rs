//! Assessments of flights: verdict, findings, the risk over time, the report.

use std::sync::Arc;

use arrow_array::{ArrayRef, BooleanArray, Float64Array, Int32Array, RecordBatch};
use arrow_schema::{Field, Schema};
use flagred::{
    flight::{Assessment, Step},
    loaded::Loaded,
    monitor::Estimate,
};
use flagred_report::{
    document::{FindingDocument, document},
    finding::Teller,
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

/// What is said of a flight; `flagred.Assessment` is made of it.
#[pyclass(frozen, subclass, module = "flagred._core")]
pub(crate) struct AssessmentData {
    subject: Arc<Subject>,
    loaded: Arc<Loaded>,
}

#[pymethods]
impl AssessmentData {
    #[new]
    fn new(
        py: Python<'_>,
        flight: &FlightData,
        profile: &Profile,
        step_s: Option<f64>,
    ) -> PyResult<Self> {
        if let Some(step_s) = step_s.filter(|step_s| step_s.is_nan() || *step_s <= 0.0) {
            let help = "write a number of seconds above 0, or None for no steps".to_owned();
            return Err(data_error(
                format!("a step of {step_s} s is none"),
                Some(help),
            ));
        }
        let (name, loaded) = (flight.name.clone(), Arc::clone(&profile.loaded));
        let (flight, of) = (Arc::clone(&flight.flight), Arc::clone(&loaded));
        let subject = interruptible(py, move || Subject {
            assessed: flagred::log::assess(&flight, &of.estimator, step_s),
            name,
            flight,
        })?;
        Ok(AssessmentData {
            subject: Arc::new(subject),
            loaded,
        })
    }

    /// Verdict, findings and summary, in JSON.
    fn _json(&self) -> String {
        let Subject {
            flight, assessed, ..
        } = &*self.subject;
        said(
            assessed,
            Teller {
                estimator: &self.loaded.estimator,
                motors: &flight.motors,
            },
        )
    }

    /// All of it in JSON, as `flagred assess --json` prints it.
    fn to_json(&self) -> PyResult<String> {
        let Subject {
            name,
            flight,
            assessed,
        } = &*self.subject;
        let document = document(name, flight, &self.loaded.estimator, assessed);
        serde_json::to_string(&document).map_err(|error| data_error(error, None))
    }

    /// The risk over time.
    fn _steps(&self) -> PyResult<Table> {
        steps(&self.subject.assessed)
    }

    /// The report as one HTML page that needs nothing beside it.
    fn html(&self, py: Python<'_>) -> PyResult<String> {
        let (subject, loaded) = (Arc::clone(&self.subject), Arc::clone(&self.loaded));
        interruptible(py, move || page::report(&subject, &loaded))
    }

    /// The picture of the risk over time as SVG; None where no risk is known.
    fn svg(&self) -> Option<String> {
        page::svg(&self.subject, &self.loaded)
    }
}

/// A page that looks like a report, around a body that is HTML already.
#[pyfunction]
pub(crate) fn _page(title: &str, body: String) -> String {
    page::around(title, body)
}

/// Verdict, findings and summary, in JSON.
pub(crate) fn said(assessed: &Assessment, teller: Teller<'_>) -> String {
    let findings = assessed.findings.iter();
    let findings: Vec<_> = findings.map(|f| FindingDocument::new(f, teller)).collect();
    json!({
        "verdict": assessed.verdict,
        "findings": findings,
        "findings_left_out": assessed.findings_left_out,
        "summary": assessed.summary,
        "assumed_inputs": assessed.assumed_inputs,
        "widened_step_s": assessed.widened_step_s,
    })
    .to_string()
}

/// The risk over time as a table: a row each step.
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
        ("elevated_risk", "%", number(&|step| step.elevated_risk_pct)),
        ("coverage", "1", of(|estimate| estimate.coverage)),
        ("filled", "", Arc::new(filled.collect::<BooleanArray>())),
        ("dominant_rule", "", Arc::new(rules.collect::<Int32Array>())),
        ("margin", "1", number(&|step| step.margin)),
        ("spread", "1", number(&|step| step.spread)),
        ("judged", "", Arc::new(judged)),
    ];
    // A profile may have an input `spread` with another window than the column of that name.
    let inputs: Vec<String> = assessed
        .inputs
        .iter()
        .map(|name| format!("input_{name}"))
        .collect();
    for (i, name) in inputs.iter().enumerate() {
        columns.push((name, "", number(&|step| step.inputs.get(i).copied())));
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
