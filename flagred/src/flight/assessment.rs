//! The assessment of a flight, as data.

use alloc::{string::String, vec::Vec};

use super::{Finding, Reason, RiskInterval, Verdict};
use crate::{
    monitor::{Estimate, Unknown},
    profile::Profile,
};

/// The assessment of a flight.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub struct Assessment {
    /// The verdict of the flight.
    pub verdict: Verdict,
    /// The findings, the most severe first, those of equal level in order of time; at most 1,000.
    pub findings: Vec<Finding>,
    /// The number of findings that were left out.
    pub findings_left_out: u64,
    /// Summary figures of the flight.
    pub summary: Summary,
    /// The names of the inputs of the rule set, in the order of [`Step::inputs`].
    pub inputs: Vec<String>,
    /// The names of the other risks of the profile, in the order of [`Step::other_risks_pct`].
    pub other_risks: Vec<String>,
    /// The inputs whose values were assumed, at least until their signals were known.
    pub assumed_inputs: Vec<AssumedInput>,
    /// The risks of the profile that were unknown for some time in the air, in the order of the profile.
    pub unknown_risks: Vec<UnknownRisk>,
    /// The risk over time.
    pub steps: Vec<Step>,
    /// The distance between the steps in seconds, if it is larger than requested because at most 250,000 steps are
    /// kept.
    pub widened_step_s: Option<f64>,
}

/// An input with an assumed value: [`ProfileInput::if_missing`](crate::profile::ProfileInput::if_missing).
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[non_exhaustive]
pub struct AssumedInput {
    /// The name of the input.
    pub input: String,
    /// The assumed value.
    pub value: f64,
    /// The signals that the input is computed from; at least one was missing.
    pub signals: Vec<String>,
}

impl AssumedInput {
    pub(super) fn of(assumed: &[usize], profile: &Profile) -> Vec<AssumedInput> {
        let inputs = profile.inputs.iter().enumerate();
        let assumed = inputs.filter(|(place, _)| assumed.contains(place));
        assumed
            .filter_map(|(_, input)| {
                Some(AssumedInput {
                    input: input.name.clone(),
                    value: input.if_missing?,
                    signals: input.source.signal.carried().map(String::from).collect(),
                })
            })
            .collect()
    }
}

/// A risk that was unknown for some time in the air.
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[non_exhaustive]
pub struct UnknownRisk {
    /// The output of the rule set that is this risk.
    pub output: String,
    /// The time in the air for which the risk was unknown, in seconds.
    pub unknown_s: f64,
    /// Why it was unknown; of several reasons, the one that applied longest.
    pub reason: String,
    /// Advice on how to know it in the next flight, if there is any.
    pub help: Option<&'static str>,
    /// The same reason for use by programs.
    #[cfg_attr(feature = "serde", serde(skip))]
    pub unknown: Unknown,
}

/// The time for which a risk was unknown for one reason.
#[derive(Debug, Clone, Copy)]
pub(super) struct UnknownTime {
    /// The index of the risk: 0 is the first risk of the profile, and its other risks follow from 1.
    pub(super) risk: usize,
    pub(super) reason: Unknown,
    pub(super) total_s: f64,
}

impl UnknownTime {
    /// The reason that applied for the longest time.
    pub(super) fn longest<'a>(
        times: impl Iterator<Item = &'a UnknownTime>,
    ) -> Option<&'a UnknownTime> {
        times.max_by(|a, b| a.total_s.total_cmp(&b.total_s))
    }
}

impl UnknownRisk {
    /// The risks of a profile that were unknown.
    pub(super) fn of(times: &[UnknownTime], profile: &Profile) -> Vec<UnknownRisk> {
        let others = profile.other_risks.iter().map(|risk| &risk.output);
        let outputs = core::iter::once(&profile.output).chain(others).enumerate();
        let unknown = outputs.filter_map(|(risk, output)| {
            let of_risk = times.iter().filter(|time| time.risk == risk);
            let unknown = UnknownTime::longest(of_risk.clone())?.reason;
            Some(UnknownRisk {
                output: output.clone(),
                unknown_s: of_risk.map(|time| time.total_s).sum(),
                reason: match unknown {
                    // The log reports that the vehicle is in the air.
                    Unknown::OnGround => "the motors idled".into(),
                    _ => unknown.explain(profile),
                },
                help: None,
                unknown,
            })
        });
        unknown.filter(|risk| risk.unknown_s > 0.0).collect()
    }
}

/// Summary figures of a flight. The risks are those of judged time
/// ([`Update::judged`](crate::monitor::Update::judged)).
#[derive(Debug, Clone, Copy, PartialEq, Default)]
#[non_exhaustive]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Summary {
    /// The time in the air, summed over all flights of a log, in seconds.
    pub in_air_s: f64,
    /// The time in the air with a known risk, in seconds. If there are several risks, all of them must be known.
    pub assessed_s: f64,
    /// The time in the air with a risk interpolated where no rule applies, in seconds.
    pub filled_s: f64,
    /// The mean risk in %.
    pub risk_mean_pct: Option<f64>,
    /// The highest risk.
    pub risk_max: Option<Peak>,
    /// The highest elevated risk.
    pub elevated_risk_max: Option<Peak>,
    /// The share of motor commands in the air within 0.5 % of a limit, in [0, 1].
    pub saturated_share: Option<f64>,
}

/// The highest value of a quantity, and when it was reached.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Peak {
    /// The time at which the value was first reached, in seconds.
    pub t_s: f64,
    /// The value in %.
    pub value_pct: f64,
}

impl Peak {
    pub(super) fn keep_larger(kept: &mut Option<Peak>, t_s: f64, value_pct: f64) {
        if kept.is_none_or(|kept| value_pct > kept.value_pct) {
            *kept = Some(Peak { t_s, value_pct });
        }
    }
}

/// The state at one time of a flight.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Step {
    /// The time in seconds.
    pub t_s: f64,
    /// The estimate of the risk; `None` if the risk is unknown.
    pub estimate: Option<Estimate>,
    /// The interval of the risk that results from the uncertainty of its inputs; `None` if the risk or the uncertainty is
    /// unknown, or if [`Assessor::with_intervals`](super::Assessor::with_intervals) was not called.
    pub risk_interval: Option<RiskInterval>,
    /// The elevated risk in %.
    pub elevated_risk_pct: Option<f64>,
    /// The mean margin over all motors and the profile's window.
    pub margin: Option<f64>,
    /// The standard deviation of the commands over all motors and the profile's window.
    pub spread: Option<f64>,
    /// Whether the step counts for findings and summary.
    pub judged: bool,
    /// The inputs of the rule set, in the order of the profile; NaN is unknown.
    pub inputs: Vec<f64>,
    /// The other risks in %, in the order of [`Profile::other_risks`]; NaN is unknown.
    pub other_risks_pct: Vec<f64>,
}

impl Assessment {
    /// The assessment of a flight that cannot be assessed, with the reason.
    pub fn not_available(reason: impl Into<Reason>) -> Assessment {
        Assessment {
            verdict: Verdict::NotAvailable(reason.into()),
            findings: Vec::new(),
            findings_left_out: 0,
            summary: Summary::default(),
            inputs: Vec::new(),
            other_risks: Vec::new(),
            assumed_inputs: Vec::new(),
            unknown_risks: Vec::new(),
            steps: Vec::new(),
            widened_step_s: None,
        }
    }
}

state! {
    struct Step { t_s, estimate, risk_interval, elevated_risk_pct, margin, spread, judged, inputs, other_risks_pct }
    struct Summary { in_air_s, assessed_s, filled_s, risk_mean_pct, risk_max, elevated_risk_max, saturated_share }
    struct Peak { t_s, value_pct }
    struct UnknownTime { risk, reason, total_s }
}
