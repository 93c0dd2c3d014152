//! The assessment of a flight as a JSON document for programs.

use std::io::{self, Write};

use flagred::{
    estimator::Estimator,
    flight::{Assessment, AssumedInput, Finding, Steps, Summary, UnknownRisk, Verdict, Words},
    profile::Reliability,
    verdict::VerdictSettings,
};
use flagred_flightlog::{Flight, Format, Motor, Parameter, Range, Report, VehicleKind};
use serde::Serialize;

use crate::finding::{FindingContext, numbered};

/// The version of the document's layout; it increases when a name changes its meaning or is removed.
const SCHEMA: &str = "flagred.assess/1";

/// The assessment of a flight: `flagred assess --json`. `docs/json.md` describes it.
#[derive(Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[cfg_attr(feature = "schema", schemars(rename = "FlightDocument"))]
pub struct Document<'a> {
    #[cfg_attr(feature = "schema", schemars(extend("const" = SCHEMA)))]
    schema: &'static str,
    /// The log that was read.
    log: Log<'a>,
    vehicle: Vehicle<'a>,
    /// The amount of data that was read, and the damage that was found.
    read: &'a Report,
    profile: Profile<'a>,
    #[serde(flatten)]
    verdict: &'a Verdict,
    /// The findings, the most severe first, those of equal severity in order of time; at most
    /// 1,000.
    findings: Vec<FindingDocument<'a>>,
    /// The number of findings that were left out.
    findings_left_out: u64,
    summary: &'a Summary,
    /// The inputs whose values were assumed because their signals are missing from the log.
    assumed_inputs: &'a [AssumedInput],
    /// The risks of the profile that were unknown for some time in the air.
    unknown_risks: &'a [UnknownRisk],
    /// The risk over time. The npm package can leave it out; `flagred assess` never does.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[cfg_attr(feature = "schema", schemars(with = "Steps<'_>"))]
    steps: Option<Steps<'a>>,
    /// The distance between the steps in seconds, if it is larger than requested because at most 250,000 steps are
    /// kept.
    widened_step_s: Option<f64>,
}

#[derive(Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
struct Log<'a> {
    /// The path of the log, as given.
    path: &'a str,
    /// The format of the log, such as `ArduPilot DataFlash`.
    format: Format,
}

#[derive(Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
struct Vehicle<'a> {
    /// The kind of vehicle, such as `multirotor`.
    kind: VehicleKind,
    /// The name of the frame or type, such as `QUAD/X`.
    frame: Option<&'a str>,
    /// The firmware with its version.
    firmware: Option<&'a str>,
    /// The motors in order of their number.
    motors: &'a [Motor],
    /// The range of the raw commands.
    range: Option<&'a Range>,
    /// The part of the range that is used in flight, as fractions of the whole range.
    effective_range: &'a Range,
    /// The reason why the whole range is used although the log contains limits.
    effective_range_doubt: Option<&'a str>,
    /// The assumptions about motors, commands and ranges that replace information missing from the log, as texts.
    assumed: &'a [String],
    /// The parameters of the autopilot that determine motors and ranges, and the gains, if the log contains them.
    parameters: &'a [Parameter],
}

/// The profile that the assessment used.
#[derive(Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
struct Profile<'a> {
    /// The name of the profile.
    name: &'a str,
    /// The name or the file of the rule set.
    rules: &'a str,
    /// The conditions under which levels are raised and cleared.
    verdict: VerdictSettings,
    /// How often large attitude errors followed a risk; empty if it was not measured.
    reliability: &'a [Reliability],
}

/// A finding with its texts, and the output of the motor that it names.
#[derive(Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[cfg_attr(feature = "schema", schemars(rename = "FlightFinding"))]
pub struct FindingDocument<'a> {
    #[serde(flatten)]
    finding: Finding,
    /// The name of the motor's output in the log.
    output: Option<&'a str>,
    /// The kind of finding: a stable identifier for use by programs, such as `fighting_gusts`.
    code: String,
    /// What happened, and what it means, for pilots.
    text: String,
    /// What to do.
    advice: String,
}

impl<'a> FindingDocument<'a> {
    /// Creates the document of a finding, described with `context`.
    pub fn new(finding: &'a Finding, context: FindingContext<'a>) -> Self {
        let Words {
            code, text, advice, ..
        } = context.words(finding);
        FindingDocument {
            output: context.motor(finding).map(|motor| motor.output.as_str()),
            finding: numbered(finding, context.motors),
            code,
            text,
            advice,
        }
    }
}

/// The document of one flight without its steps, of which there may be many.
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
    let context = FindingContext {
        estimator,
        motors: &flight.motors,
    };
    Document {
        schema: SCHEMA,
        log: Log {
            path: name,
            format: flight.format,
        },
        vehicle: Vehicle {
            kind: flight.vehicle.kind,
            frame: flight.vehicle.frame.as_deref(),
            firmware: flight.vehicle.firmware.as_deref(),
            motors: &flight.motors,
            range: flight.range.as_ref(),
            effective_range: &flight.effective_range,
            effective_range_doubt: flight.effective_range_doubt.as_deref(),
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
            .map(|finding| FindingDocument::new(finding, context))
            .collect(),
        findings_left_out: assessed.findings_left_out,
        summary: &assessed.summary,
        assumed_inputs: &assessed.assumed_inputs,
        unknown_risks: &assessed.unknown_risks,
        steps: Some(assessed.steps_by_name()),
        widened_step_s: assessed.widened_step_s,
    }
}

/// Writes documents as JSON: a single one, or an array if there are `several` flights.
///
/// # Errors
/// If writing to `out` fails.
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
