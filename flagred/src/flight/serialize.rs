//! An assessment as serde data, with the names that docs/json.md describes.

use alloc::string::{String, ToString};

use serde::{Serialize, Serializer};

use super::{Assessment, AssumedInput, Finding, Reason, Step, Summary, UnknownRisk, Verdict};
use crate::{sample::RiskFields, verdict::Level};

/// A verdict as one word.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "UPPERCASE")]
pub enum VerdictWord {
    /// No finding is more severe than INFO.
    Good,
    /// The most severe finding is WARN.
    Warn,
    /// The most severe finding is FAIL.
    Fail,
    /// There is no verdict.
    Na,
}

/// Converts a level; `None` is unknown.
impl From<Option<Level>> for VerdictWord {
    fn from(level: Option<Level>) -> VerdictWord {
        match level {
            Some(Level::Good | Level::Info) => VerdictWord::Good,
            Some(Level::Warn) => VerdictWord::Warn,
            Some(Level::Fail) => VerdictWord::Fail,
            None => VerdictWord::Na,
        }
    }
}

impl From<&Verdict> for VerdictWord {
    fn from(verdict: &Verdict) -> VerdictWord {
        match verdict {
            Verdict::Known(level) => Some(*level).into(),
            Verdict::NotAvailable(_) => VerdictWord::Na,
        }
    }
}

/// A [`Verdict`] as serde data.
#[derive(Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub(super) struct VerdictFields {
    /// The level of the most severe finding; `NA` where there is no verdict.
    verdict: VerdictWord,
    /// Only with `NA`: why there is no verdict.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[cfg_attr(feature = "schema", schemars(with = "String"))]
    reason: Option<String>,
    /// Only with `NA`: how to get a verdict for the next flight.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[cfg_attr(feature = "schema", schemars(with = "Option<String>"))]
    help: Option<Option<&'static str>>,
}

impl Serialize for Verdict {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let reason = match self {
            Verdict::Known(_) => None,
            Verdict::NotAvailable(reason) => Some(reason),
        };
        let fields = VerdictFields {
            verdict: self.into(),
            reason: reason.map(ToString::to_string),
            help: reason.map(Reason::help),
        };
        fields.serialize(serializer)
    }
}

impl Serialize for Assessment {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        #[derive(Serialize)]
        struct Fields<'a> {
            #[serde(flatten)]
            verdict: &'a Verdict,
            findings: &'a [Finding],
            findings_left_out: u64,
            summary: &'a Summary,
            assumed_inputs: &'a [AssumedInput],
            unknown_risks: &'a [UnknownRisk],
            steps: Steps<'a>,
            widened_step_s: Option<f64>,
        }
        let fields = Fields {
            verdict: &self.verdict,
            findings: &self.findings,
            findings_left_out: self.findings_left_out,
            summary: &self.summary,
            assumed_inputs: &self.assumed_inputs,
            unknown_risks: &self.unknown_risks,
            steps: self.steps_by_name(),
            widened_step_s: self.widened_step_s,
        };
        fields.serialize(serializer)
    }
}

impl Assessment {
    /// The steps as serde data, with the inputs by their names.
    pub fn steps_by_name(&self) -> Steps<'_> {
        Steps(self)
    }
}

impl Step {
    /// The step of an assessment as serde data, with the inputs and other risks by their names.
    pub fn by_name<'a>(&'a self, of: &'a Assessment) -> NamedStep<'a> {
        NamedStep {
            t_s: self.t_s,
            risk: RiskFields::new(self.estimate, self.elevated_risk_pct),
            risk_low: self.risk_interval.map(|interval| interval.low_pct),
            risk_high: self.risk_interval.map(|interval| interval.high_pct),
            margin: self.margin,
            spread: self.spread,
            judged: self.judged,
            inputs: ByName {
                names: &of.inputs,
                values: &self.inputs,
            },
            other_risks: ByName {
                names: &of.other_risks,
                values: &self.other_risks_pct,
            },
        }
    }
}

/// The steps of a flight as serde data; from [`Assessment::steps_by_name`].
#[derive(Debug, Clone, Copy)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[cfg_attr(
    feature = "schema",
    schemars(with = "alloc::vec::Vec<NamedStep<'_>>", inline)
)]
pub struct Steps<'a>(&'a Assessment);

impl Serialize for Steps<'_> {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.collect_seq(self.0.steps.iter().map(|step| step.by_name(self.0)))
    }
}

/// The state of a flight at one time, for serialisation; created by [`Step::by_name`].
#[derive(Debug, Clone, Copy, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[cfg_attr(feature = "schema", schemars(rename = "Step"))]
pub struct NamedStep<'a> {
    /// The time on the clock of the log, in seconds.
    t_s: f64,
    #[serde(flatten)]
    risk: RiskFields,
    /// The lower end of the interval of the risk in %, from the uncertainty of its inputs; null if it is unknown.
    #[cfg_attr(feature = "schema", schemars(range(min = 0, max = 100)))]
    risk_low: Option<f64>,
    /// The upper end of that interval in %.
    #[cfg_attr(feature = "schema", schemars(range(min = 0, max = 100)))]
    risk_high: Option<f64>,
    /// The mean margin over all motors and the window of the profile.
    margin: Option<f64>,
    /// The standard deviation of the commands over all motors and the window of the profile.
    spread: Option<f64>,
    /// Whether the step counts for findings and summary.
    judged: bool,
    /// The inputs of the rule set by their names.
    inputs: ByName<'a>,
    /// The other risks of the profile in %, by the names of their outputs. Left out if there are no other risks.
    #[serde(skip_serializing_if = "ByName::is_empty")]
    other_risks: ByName<'a>,
}

#[derive(Debug, Clone, Copy)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[cfg_attr(
    feature = "schema",
    schemars(with = "alloc::collections::BTreeMap<String, Option<f64>>", inline)
)]
struct ByName<'a> {
    names: &'a [String],
    values: &'a [f64],
}

impl ByName<'_> {
    fn is_empty(&self) -> bool {
        self.names.is_empty()
    }
}

impl Serialize for ByName<'_> {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.collect_map(self.names.iter().zip(self.values))
    }
}
