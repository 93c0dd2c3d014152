//! What is said of a flight, as data.

use alloc::{string::String, vec::Vec};

use super::{Finding, Reason, Verdict};
use crate::{monitor::Estimate, profile::Profile};

/// What is said about a flight.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub struct Assessment {
    /// How risky the flight was.
    pub verdict: Verdict,
    /// The gravest first, those of equal level in order of time; of many the gravest 1,000.
    pub findings: Vec<Finding>,
    /// How many findings were left out.
    pub findings_left_out: u64,
    /// The flight in a few numbers.
    pub summary: Summary,
    /// The names of the inputs of the rule set, in the order of [`Step::inputs`].
    pub inputs: Vec<String>,
    /// The inputs whose values were assumed, at least until their signals came.
    pub assumed_inputs: Vec<AssumedInput>,
    /// The risk over time.
    pub steps: Vec<Step>,
    /// Seconds between the steps, where they are further apart than was asked for: 250,000 are kept at most.
    pub widened_step_s: Option<f64>,
}

/// An input with a value that nobody measured: [`ProfileInput::if_missing`](crate::profile::ProfileInput::if_missing).
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[non_exhaustive]
pub struct AssumedInput {
    /// Its name.
    pub input: String,
    /// Its value.
    pub value: f64,
    /// The signals that it is made of; at least one was missing.
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

/// A flight in a few numbers. The risks are those of judged time ([`Update::judged`](crate::monitor::Update::judged)).
#[derive(Debug, Clone, Copy, PartialEq, Default)]
#[non_exhaustive]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Summary {
    /// The time in the air: the sum of all flights of a log, in seconds.
    pub in_air_s: f64,
    /// The time in the air with a known risk, of several with all of them known, in seconds.
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

/// The largest value of a quantity.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Peak {
    /// When it was first reached, in seconds.
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

/// What was known at one time of a flight.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Step {
    /// The time in seconds.
    pub t_s: f64,
    /// The risk and what it rests on; `None` where it is unknown.
    pub estimate: Option<Estimate>,
    /// The elevated risk in %.
    pub elevated_risk_pct: Option<f64>,
    /// The mean margin over all motors and the profile's window.
    pub margin: Option<f64>,
    /// The standard deviation of the commands over all motors and the profile's window.
    pub spread: Option<f64>,
    /// Whether it counts for findings and summary.
    pub judged: bool,
    /// The inputs of the rule set, in the order of the profile; NaN is unknown.
    pub inputs: Vec<f64>,
}

impl Assessment {
    /// The assessment of a flight that cannot be assessed.
    pub fn not_available(reason: impl Into<Reason>) -> Assessment {
        Assessment {
            verdict: Verdict::NotAvailable(reason.into()),
            findings: Vec::new(),
            findings_left_out: 0,
            summary: Summary::default(),
            inputs: Vec::new(),
            assumed_inputs: Vec::new(),
            steps: Vec::new(),
            widened_step_s: None,
        }
    }
}
