//! What goes into a monitor with every sample, and what comes out.

use crate::verdict::{Ended, Level};

/// A sample of a flight.
#[derive(Debug, Clone, Copy)]
pub struct Sample<'a> {
    /// Its time in seconds; times must not decrease.
    pub t_s: f64,
    /// The effective command of each motor, from 0 to 1; NaN is unknown. Values from -0.5 to 1.5 are clamped to [0, 1], all
    /// others count as unknown. While a motor is unknown, so is the risk of a profile that reads motors.
    pub motors: &'a [f64],
    /// Whether the autopilot reports that the vehicle is in the air; `None` where it does not report it. Motors that idle mean
    /// that the vehicle is on the ground, unless the autopilot reports `true` for 3 s: then the vehicle falls.
    pub in_air: Option<bool>,
    /// The values of the signals that the monitor was given the names of, in that order; NaN is unknown.
    pub signals: &'a [f64],
}

impl Sample<'_> {
    /// Whether the autopilot reports that the vehicle is on the ground.
    pub fn is_on_ground(&self) -> bool {
        self.in_air == Some(false)
    }
}

/// What a monitor knows after a sample.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[cfg_attr(feature = "schema", schemars(with = "UpdateFields"))]
pub struct Update {
    /// The time of the sample in seconds.
    pub t_s: f64,
    /// The risk, or why it is unknown.
    pub risk: Result<Estimate, Unknown>,
    /// The elevated risk in %; `None` where the risk is unknown.
    pub elevated_risk_pct: Option<f64>,
    /// The level. Where a risk of the profile is unknown it is an alarm that stands, or `None`: never [`Level::Good`].
    pub level: Option<Level>,
    /// The new level where this sample changed it and it is known.
    pub change: Option<Level>,
    /// Whether the risk counts for levels, findings and the summary of a flight: in the first seconds after take-off it
    /// does not. A landing takes back the last seconds before it.
    pub judged: bool,
    /// The findings that ended with this sample.
    pub ended: Ended,
}

/// The risk where all inputs are known.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Estimate {
    /// The risk in %, from 0 to 100.
    pub risk_pct: f64,
    /// The largest firing strength of a rule, in [0, 1].
    pub coverage: f64,
    /// The distance to the nearest inputs that rules cover, in shares of the inputs' ranges, where the risk is
    /// interpolated from there; `None` where rules gave it.
    pub filled_from: Option<f64>,
    /// The rule with the largest firing strength, as its index in the model, from 0.
    pub dominant_rule: Option<usize>,
    /// Whether an input was outside its range and was moved to the end of the range.
    pub clamped: bool,
}

impl Estimate {
    /// Motors that idle in the air keep no vehicle up, whatever the rules say.
    pub(crate) const FALL: Estimate = Estimate {
        risk_pct: 100.0,
        coverage: 1.0,
        filled_from: None,
        dominant_rule: None,
        clamped: false,
    };
}

/// Why a risk is unknown.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Unknown {
    /// The vehicle is on the ground.
    OnGround,
    /// The time stamp is not after the previous one; the sample was ignored.
    OutOfOrder,
    /// The window of an input does not cover enough time yet.
    WarmingUp {
        /// The input, in the order of the profile.
        input: usize,
    },
    /// The window of an input holds too few samples.
    TooFewSamples {
        /// The input, in the order of the profile.
        input: usize,
        /// How many it holds.
        samples: u32,
    },
    /// The signal of an input has no known value.
    NoValue {
        /// The input, in the order of the profile.
        input: usize,
    },
    /// No rule applies, and there is nothing to interpolate from.
    NoRule,
    /// The command of a motor is unknown.
    NoCommand {
        /// The first such motor, counted from 0.
        motor: usize,
    },
    /// The command of a motor is so far outside [0, 1] that it has another unit.
    CommandOutside {
        /// The first such motor, counted from 0.
        motor: usize,
        /// Its command.
        command: f64,
    },
}

/// When an input counts as known.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Sampling {
    /// The fewest samples a window must hold.
    pub min_samples: u32,
    /// How much time a window must cover before it counts, in seconds, or its whole length where that is less; 99 % of it
    /// is enough.
    pub warm_up_s: f64,
    /// After a longer time without a sample, in seconds, the state is reset.
    pub longest_gap_s: f64,
    /// What was before this time in the air, in seconds, is dropped from longer windows `warm_up_s` later, and the elevated
    /// risk begins anew, because the take-off is not typical of the flight. 0 keeps it.
    pub take_off_s: f64,
}

impl Default for Sampling {
    fn default() -> Self {
        Sampling {
            min_samples: 5,
            warm_up_s: 1.0,
            longest_gap_s: 2.0,
            take_off_s: 0.0,
        }
    }
}

#[cfg(feature = "serde")]
impl serde::Serialize for Update {
    fn serialize<S: serde::Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let fields = UpdateFields {
            t_s: self.t_s,
            risk: RiskFields::new(self.risk.ok(), self.elevated_risk_pct),
            level: self.level,
            judged: self.judged,
        };
        fields.serialize(serializer)
    }
}

/// An [`Update`] as serde data.
#[cfg(feature = "serde")]
#[derive(serde::Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
struct UpdateFields {
    /// The time of the sample in seconds.
    t_s: f64,
    #[serde(flatten)]
    risk: RiskFields,
    /// The level. Where a risk of the profile is unknown it is an alarm that stands, or null: never GOOD.
    level: Option<Level>,
    /// Whether the risk counts for levels, findings and the summary of a flight.
    judged: bool,
}

/// A risk and what it rests on, as serde data; null where it is unknown.
#[cfg(feature = "serde")]
#[derive(Debug, Clone, Copy, serde::Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub(crate) struct RiskFields {
    /// The risk in %.
    #[cfg_attr(feature = "schema", schemars(range(min = 0, max = 100)))]
    risk: Option<f64>,
    /// The elevated risk in %.
    elevated_risk: Option<f64>,
    /// The largest firing strength of a rule, in [0, 1].
    coverage: Option<f64>,
    /// Whether the risk is interpolated, since no rule applies.
    filled: Option<bool>,
    /// The number of the rule with the largest firing strength, from 1; null where none fires.
    #[cfg_attr(feature = "schema", schemars(range(min = 1)))]
    dominant_rule: Option<usize>,
}

#[cfg(feature = "serde")]
impl RiskFields {
    pub(crate) fn new(estimate: Option<Estimate>, elevated_risk: Option<f64>) -> RiskFields {
        RiskFields {
            risk: estimate.map(|estimate| estimate.risk_pct),
            elevated_risk,
            coverage: estimate.map(|estimate| estimate.coverage),
            filled: estimate.map(|estimate| estimate.filled_from.is_some()),
            dominant_rule: estimate.and_then(|estimate| Some(estimate.dominant_rule? + 1)),
        }
    }
}
