//! A flight's assessment for programs: one JSON document, or a table of its steps.

use std::io::Write;

use flagred::{
    estimator::Estimator,
    flight::{Assessment, Finding, Step, Steps, Summary, Verdict},
    verdict::VerdictSettings,
};
use flightlog::{Flight, Motor, Parameter, Range, Report};
use serde::Serialize;

use super::finding::Teller;
use crate::{failure::Failure, output::cell};

/// The version of the document's layout; it grows when a name changes its meaning or goes.
const SCHEMA: &str = "flagred.assess/1";

/// `docs/json.md` and `docs/schemas/assess.json` describe it.
#[derive(Serialize)]
pub(crate) struct Document<'a> {
    schema: &'static str,
    log: Log<'a>,
    vehicle: Vehicle<'a>,
    read: &'a Report,
    profile: Profile<'a>,
    #[serde(flatten)]
    verdict: &'a Verdict,
    findings: Vec<FindingDocument<'a>>,
    summary: &'a Summary,
    steps: Steps<'a>,
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
    parameters: &'a [Parameter],
}

/// What the verdict rests on beside the flight.
#[derive(Serialize)]
struct Profile<'a> {
    name: &'a str,
    rules: &'a str,
    verdict: VerdictSettings,
}

/// A finding with the output of its motor, and in words.
#[derive(Serialize)]
pub(crate) struct FindingDocument<'a> {
    #[serde(flatten)]
    finding: Finding,
    output: Option<&'a str>,
    text: String,
}

impl<'a> FindingDocument<'a> {
    pub(crate) fn new(finding: &'a Finding, teller: Teller<'a>) -> Self {
        FindingDocument {
            output: teller.motor(finding).map(|motor| motor.output.as_str()),
            text: teller.finding(finding),
            finding: numbered(finding, teller.motors),
        }
    }
}

/// The finding with the autopilot's number of its motor, where it is not its place in the samples.
pub(crate) fn numbered(finding: &Finding, motors: &[Motor]) -> Finding {
    let mut finding = finding.clone();
    if let Some(named) = &mut finding.found.motor
        && let Some(motor) = motors.get(named.motor)
    {
        named.motor = usize::from(motor.number).saturating_sub(1);
    }
    finding
}

/// The document of one flight.
pub(crate) fn document<'a>(
    name: &'a str,
    flight: &'a Flight,
    estimator: &'a Estimator,
    assessed: &'a Assessment,
) -> Document<'a> {
    let profile = estimator.profile();
    let findings = assessed.findings.iter();
    let teller = Teller {
        model: estimator.model(),
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
            parameters: &flight.parameters,
        },
        read: &flight.report,
        profile: Profile {
            name: &profile.name,
            rules: &profile.rules,
            verdict: profile.verdict,
        },
        verdict: &assessed.verdict,
        findings: findings
            .map(|finding| FindingDocument::new(finding, teller))
            .collect(),
        summary: &assessed.summary,
        steps: assessed.steps_by_name(),
    }
}

/// A step as columns and fields: margin and spread always, then what the rules said, then the rules' other inputs. What is
/// unknown is an empty field.
fn row<'a>(estimator: &'a Estimator, step: &Step) -> Vec<(&'a str, String)> {
    let number = |value: Option<f64>| {
        let known = value.filter(|value| value.is_finite());
        known.map(|value| value.to_string()).unwrap_or_default()
    };
    let estimate = step.estimate;
    let filled = estimate.map(|e| u8::from(e.filled_from.is_some()).to_string());
    let mut row = vec![
        ("t_s", number(Some(step.t_s))),
        ("margin", number(step.margin)),
        ("spread", number(step.spread)),
        ("coverage", number(estimate.map(|e| e.coverage))),
        ("filled", filled.unwrap_or_default()),
        ("risk", number(estimate.map(|e| e.risk_pct))),
        ("elevated_risk", number(step.elevated_risk_pct)),
    ];
    for (i, input) in estimator.profile().inputs.iter().enumerate() {
        let field = number(step.inputs.get(i).copied());
        match row.iter_mut().find(|(known, _)| *known == input.name) {
            // A profile may define its margin or spread differently; the rules' is the one to show.
            Some(known) => known.1 = field,
            None => row.push((&input.name, field)),
        }
    }
    row
}

/// Writes the steps of one flight as CSV; `log` becomes the first column where there are several flights.
pub(crate) fn write_csv(
    out: &mut impl Write,
    log: Option<&str>,
    head: bool,
    estimator: &Estimator,
    assessed: &Assessment,
) -> Result<(), Failure> {
    let mut table = csv::Writer::from_writer(out);
    if head {
        let columns = row(estimator, &Step::default());
        let names = columns.iter().map(|(name, _)| cell(name));
        let names = log.map(|_| "log".into()).into_iter().chain(names);
        table.write_record(names.map(|name| name.into_owned()))?;
    }
    for step in &assessed.steps {
        let fields = row(estimator, step).into_iter().map(|(_, field)| field);
        table.write_record(
            log.map(|log| cell(log).into_owned())
                .into_iter()
                .chain(fields),
        )?;
    }
    Ok(table.flush()?)
}
