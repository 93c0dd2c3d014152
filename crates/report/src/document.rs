//! A flight's assessment for programs: one JSON document.

use std::io::{self, Write};

use flagred::{
    estimator::Estimator,
    flight::{Assessment, Finding, Steps, Summary, Verdict, Words},
    profile::Reliability,
    verdict::VerdictSettings,
};
use flagred_flightlog::{Flight, Motor, Parameter, Range, Report};
use serde::Serialize;

use crate::finding::{Teller, numbered};

/// The version of the document's layout; it grows when a name changes its meaning or goes.
const SCHEMA: &str = "flagred.assess/1";

/// `docs/json.md` and `crates/cli/schemas/assess.json` describe it.
#[derive(Serialize)]
pub struct Document<'a> {
    schema: &'static str,
    log: Log<'a>,
    vehicle: Vehicle<'a>,
    read: &'a Report,
    profile: Profile<'a>,
    #[serde(flatten)]
    verdict: &'a Verdict,
    findings: Vec<FindingDocument<'a>>,
    findings_left_out: u64,
    summary: &'a Summary,
    #[serde(skip_serializing_if = "Option::is_none")]
    steps: Option<Steps<'a>>,
    widened_step_s: Option<f64>,
}

#[derive(Serialize)]
struct Log<'a> {
    path: &'a str,
    format: String,
}

#[derive(Serialize)]
struct Vehicle<'a> {
    kind: String,
    frame: Option<&'a str>,
    firmware: Option<&'a str>,
    motors: &'a [Motor],
    range: Option<&'a Range>,
    effective_range: &'a Range,
    effective_range_doubt: Option<&'a str>,
    assumed: &'a [String],
    parameters: &'a [Parameter],
}

/// What the verdict rests on beside the flight.
#[derive(Serialize)]
struct Profile<'a> {
    name: &'a str,
    rules: &'a str,
    verdict: VerdictSettings,
    /// How often errors followed a risk; empty where it was not measured.
    reliability: &'a [Reliability],
}

/// A finding with the output of its motor, and in words.
#[derive(Serialize)]
pub struct FindingDocument<'a> {
    #[serde(flatten)]
    finding: Finding,
    output: Option<&'a str>,
    code: String,
    text: String,
    advice: String,
}

impl<'a> FindingDocument<'a> {
    /// A finding of the flight that the teller knows.
    pub fn new(finding: &'a Finding, teller: Teller<'a>) -> Self {
        let Words {
            code, text, advice, ..
        } = teller.words(finding);
        FindingDocument {
            output: teller.motor(finding).map(|motor| motor.output.as_str()),
            finding: numbered(finding, teller.motors),
            code,
            text,
            advice,
        }
    }
}

/// The document of one flight without its steps, which may be many.
pub fn brief<'a>(
    name: &'a str,
    flight: &'a Flight,
    estimator: &'a Estimator,
    assessed: &'a Assessment,
) -> Document<'a> {
    Document {
        steps: None,
        ..document(name, flight, estimator, assessed)
    }
}

/// The document of one flight.
pub fn document<'a>(
    name: &'a str,
    flight: &'a Flight,
    estimator: &'a Estimator,
    assessed: &'a Assessment,
) -> Document<'a> {
    let profile = estimator.profile();
    let findings = assessed.findings.iter();
    let teller = Teller {
        estimator,
        motors: &flight.motors,
    };
    Document {
        schema: SCHEMA,
        log: Log {
            path: name,
            format: flight.format.to_string(),
        },
        vehicle: Vehicle {
            kind: flight.vehicle.kind.to_string(),
            frame: flight.vehicle.frame.as_deref(),
            firmware: flight.vehicle.firmware.as_deref(),
            motors: &flight.motors,
            range: flight.range.as_ref(),
            effective_range: &flight.effective,
            effective_range_doubt: flight.effective_doubt.as_deref(),
            assumed: &flight.assumed,
            parameters: &flight.parameters,
        },
        read: &flight.report,
        profile: Profile {
            name: &profile.name,
            rules: &profile.rules,
            verdict: profile.verdict,
            reliability: &profile.reliability,
        },
        verdict: &assessed.verdict,
        findings: findings
            .map(|finding| FindingDocument::new(finding, teller))
            .collect(),
        findings_left_out: assessed.findings_left_out,
        summary: &assessed.summary,
        steps: Some(assessed.steps_by_name()),
        widened_step_s: assessed.widened_step_s,
    }
}

/// Writes documents in JSON: one, or an array of them where there are `several` flights.
///
/// # Errors
/// When `out` cannot be written.
pub fn write(out: &mut impl Write, documents: &[String], several: bool) -> io::Result<()> {
    if !several || documents.is_empty() {
        for document in documents {
            writeln!(out, "{document}")?;
        }
        return Ok(());
    }
    for (i, document) in documents.iter().enumerate() {
        let before = if i == 0 { "[" } else { "," };
        write!(out, "{before}\n  {}", document.replace('\n', "\n  "))?;
    }
    writeln!(out, "\n]")
}
