//! A flight's assessment for programs: one JSON document, or a table of its steps.

use std::io::{self, Write};

use flagred::{
    estimator::Estimator,
    verdict::{LevelSettings, Measure, Threshold},
};
use flightlog::Flight;
use serde::Serialize;
use serde_json::{Map, Value, json};

use super::{
    follow::{Assessed, Step, Verdict, word},
    words,
};

/// The version of the document's layout; it grows when a name changes its meaning or goes.
const SCHEMA: &str = "flagred.assess/1";

#[derive(Serialize)]
pub(crate) struct Document {
    schema: &'static str,
    log: Value,
    vehicle: Value,
    read: Value,
    profile: Value,
    verdict: &'static str,
    /// Why there is no verdict, and what would help.
    #[serde(skip_serializing_if = "Option::is_none")]
    reason: Option<String>,
    #[serde(skip_serializing_if = "Option::is_none")]
    help: Option<String>,
    findings: Vec<Value>,
    summary: Value,
    steps: Vec<Map<String, Value>>,
}

/// The document of one flight.
pub(crate) fn document(
    name: &str,
    flight: &Flight,
    estimator: &Estimator,
    assessed: &Assessed,
) -> Document {
    let (reason, help) = match &assessed.verdict {
        Verdict::Known(_) => (None, None),
        Verdict::NotAvailable { reason, help } => (Some(reason.clone()), help.clone()),
    };
    let summary = &assessed.summary;
    let peak =
        |peak: Option<(f64, f64)>| peak.map(|(t_s, value)| json!({"t_s": t_s, "value_pct": value}));
    Document {
        schema: SCHEMA,
        log: json!({"path": name, "format": flight.format.to_string()}),
        vehicle: vehicle(flight),
        read: read(&flight.report),
        profile: profile(estimator),
        verdict: assessed.verdict.word(),
        reason,
        help,
        findings: assessed
            .findings
            .iter()
            .map(|finding| {
                let motor = finding.motor.as_ref().and_then(|weakest| {
                    let motor = flight.motors.get(weakest.motor)?;
                    Some(json!({
                        "number": motor.number,
                        "output": motor.output,
                        "side": words::side(weakest.side),
                        "margin_mean": weakest.mean_margin,
                        "margin_min": weakest.least_margin,
                    }))
                });
                json!({
                    "severity": word(finding.level),
                    "from_s": finding.from_s,
                    "to_s": finding.to_s,
                    "raised_s": finding.raised_s,
                    "measure": match finding.measure {
                        Measure::Risk => "risk",
                        Measure::ElevatedRisk => "elevated_risk",
                    },
                    "value_pct": finding.peak_pct,
                    "threshold_pct": finding.threshold_pct,
                    "motor": motor,
                    "text": words::describe(finding, flight),
                })
            })
            .collect(),
        summary: json!({
            "in_air_s": summary.in_air_s,
            "assessed_s": summary.assessed_s,
            "filled_s": summary.filled_s,
            "risk_mean_pct": summary.risk_mean_pct,
            "risk_max": peak(summary.risk_max),
            "elevated_risk_max": peak(summary.elevated_risk_max),
            "saturated_share": summary.saturated_share,
        }),
        steps: assessed
            .steps
            .iter()
            .map(|step| {
                row(estimator, step)
                    .into_iter()
                    .map(|(name, cell)| (name.to_owned(), cell.into_json()))
                    .collect()
            })
            .collect(),
    }
}

fn vehicle(flight: &Flight) -> Value {
    let range = |range: &flightlog::Range| json!({"low": range.low, "high": range.high, "unit": range.unit, "source": range.source});
    json!({
        "kind": flight.vehicle.kind.to_string(),
        "frame": flight.vehicle.frame,
        "firmware": flight.vehicle.firmware,
        "motors": flight.motors.iter().map(|motor| {
            json!({"number": motor.number, "output": motor.output, "source": motor.source})
        }).collect::<Vec<_>>(),
        "range": flight.range.as_ref().map(range),
        "effective_range": range(&flight.effective),
    })
}

/// How the reading went.
pub(crate) fn read(report: &flightlog::Report) -> Value {
    json!({
        "bytes": report.bytes,
        "messages": report.messages,
        "skipped_bytes": report.skipped_bytes,
        "bad_messages": report.bad_messages,
        "truncated": report.truncated,
        "reason": report.reason,
    })
}

/// What the verdict rests on beside the flight.
fn profile(estimator: &Estimator) -> Value {
    let profile = estimator.profile();
    let threshold = |limit: &Threshold| json!({"risk_pct": limit.risk_pct, "elevated_risk_pct": limit.elevated_risk_pct});
    let level = |level: &LevelSettings| {
        json!({
            "raise": threshold(&level.raise),
            "after_s": level.after_s,
            "until": threshold(&level.until),
        })
    };
    let verdict = &profile.verdict;
    json!({
        "name": profile.name,
        "rules": profile.rules,
        "warn": level(&verdict.warn),
        "fail": level(&verdict.fail),
        "clear_after_s": verdict.clear_after_s,
        "quiet_after_take_off_s": verdict.quiet_after_take_off_s,
        "quiet_before_landing_s": verdict.quiet_before_landing_s,
    })
}

/// A value of a step; what is unknown is an empty field, and `null` in JSON.
enum Cell {
    Number(Option<f64>),
    Flag(Option<bool>),
}

impl Cell {
    fn into_json(self) -> Value {
        match self {
            Cell::Number(value) => json!(value.filter(|v| v.is_finite())),
            Cell::Flag(value) => json!(value),
        }
    }

    fn into_field(self) -> String {
        match self {
            Cell::Number(value) => value
                .filter(|v| v.is_finite())
                .map(|v| v.to_string())
                .unwrap_or_default(),
            Cell::Flag(value) => value.map(|v| u8::from(v).to_string()).unwrap_or_default(),
        }
    }
}

/// A step as names and values, the same for CSV and JSON: margin and spread always, then what the rules said, then
/// the rules' other inputs.
fn row<'a>(estimator: &'a Estimator, step: &Step) -> Vec<(&'a str, Cell)> {
    let estimate = step.estimate;
    let mut row = vec![
        ("t_s", Cell::Number(Some(step.t_s))),
        ("margin", Cell::Number(step.margin)),
        ("spread", Cell::Number(step.spread)),
        ("coverage", Cell::Number(estimate.map(|e| e.coverage))),
        (
            "filled",
            Cell::Flag(estimate.map(|e| e.filled_from.is_some())),
        ),
        ("risk", Cell::Number(estimate.map(|e| e.risk_pct))),
        ("elevated_risk", Cell::Number(step.elevated_risk_pct)),
    ];
    for (i, input) in estimator.profile().inputs.iter().enumerate() {
        let name = input.name.as_str();
        let cell = Cell::Number(step.inputs.get(i).copied());
        match row.iter_mut().find(|(known, _)| *known == name) {
            // A profile may take its margin or spread in a way of its own; the rules' is the one to show.
            Some(known) => known.1 = cell,
            None => row.push((name, cell)),
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
    assessed: &Assessed,
) -> io::Result<()> {
    let mut table = csv::Writer::from_writer(out);
    if head {
        let columns = row(estimator, &Step::default());
        let names = columns.iter().map(|(name, _)| *name);
        table.write_record(log.map(|_| "log").into_iter().chain(names))?;
    }
    for step in &assessed.steps {
        let fields = row(estimator, step)
            .into_iter()
            .map(|(_, cell)| cell.into_field());
        table.write_record(log.map(str::to_owned).into_iter().chain(fields))?;
    }
    table.flush()
}
