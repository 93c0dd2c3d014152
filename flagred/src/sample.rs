//! The samples that a monitor takes, and the updates that it returns.

use crate::verdict::{EndedFindings, Level};

/// A sample of a flight.
#[derive(Debug, Clone, Copy)]
pub struct Sample<'a> {
    /// The time in seconds; times must not decrease.
    pub t_s: f64,
    /// The effective command of each motor, from 0 to 1; NaN is unknown. Values from -0.5 to 1.5 are clamped to [0, 1],
    /// others count as unknown. While a motor is unknown, the risk of a profile that reads motors is unknown too.
    pub motors: &'a [f64],
    /// Whether the autopilot reports that the vehicle is in the air; `None` if it does not report it. Motors that idle
    /// mean that the vehicle is on the ground, unless the autopilot reports `true` for 3 s: then the vehicle is
    /// falling.
    pub in_air: Option<bool>,
    /// The values of the signals whose names the monitor was created with, in that order; NaN is unknown.
    pub signals: &'a [f64],
}

impl Sample<'_> {
    /// Whether the autopilot reports that the vehicle is on the ground.
    pub fn is_on_ground(&self) -> bool {
        self.in_air == Some(false)
    }
}

/// The result of a monitor after a sample.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[cfg_attr(feature = "schema", schemars(with = "UpdateFields"))]
pub struct Update {
    /// The time of the sample in seconds.
    pub t_s: f64,
    /// The risk, or the reason why it is unknown.
    pub risk: Result<Estimate, Unknown>,
    /// The elevated risk in %; `None` if the risk is unknown.
    pub elevated_risk_pct: Option<f64>,
    /// The level. If a risk of the profile is unknown, it is the level of an ongoing alarm or `None`, never
    /// [`Level::Good`].
    pub level: Option<Level>,
    /// The new level, if this sample changed the level; `None` if it did not, or if the new level
    /// is unknown.
    pub change: Option<Level>,
    /// Whether the risk counts for levels, findings and the summary of a flight. It does not count in the first seconds
    /// after take-off. A landing also excludes the last seconds before it.
    pub judged: bool,
    /// The findings that ended with this sample.
    pub ended: EndedFindings,
}

/// A known risk.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Estimate {
    /// The risk in %, from 0 to 100.
    pub risk_pct: f64,
    /// The coverage: the largest firing strength of a rule, in [0, 1].
    pub coverage: f64,
    /// If the risk is interpolated, the distance to the nearest inputs that rules cover, in shares of the inputs'
    /// ranges; `None` if rules computed the risk.
    pub filled_from: Option<f64>,
    /// The index in the model of the rule with the largest firing strength, from 0.
    pub dominant_rule: Option<usize>,
    /// Whether an input was outside its range and was moved to the end of the range.
    pub clamped: bool,
}

impl Estimate {
    /// The estimate while motors idle in the air: idle motors cannot keep a vehicle up, whatever the rules compute.
    pub(crate) const FALL: Estimate = Estimate {
        risk_pct: 100.0,
        coverage: 1.0,
        filled_from: None,
        dominant_rule: None,
        clamped: false,
    };
}

/// The reason why a risk is unknown.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Unknown {
    /// The vehicle is on the ground.
    OnGround,
    /// The timestamp is not after the previous one; the sample was ignored.
    OutOfOrder,
    /// The window of an input does not cover enough time yet.
    WarmingUp {
        /// The index of the input in the profile.
        input: usize,
    },
    /// The window of an input contains too few samples.
    TooFewSamples {
        /// The index of the input in the profile.
        input: usize,
        /// The number of samples in the window.
        samples: u32,
    },
    /// The signal of an input has no known value.
    NoValue {
        /// The index of the input in the profile.
        input: usize,
    },
    /// No rule applies, and there is nothing to interpolate from.
    NoRule,
    /// The command of a motor is unknown.
    NoCommand {
        /// The first motor without a command, counted from 0.
        motor: usize,
    },
    /// The command of a motor is so far outside [0, 1] that it must be in another unit.
    CommandOutside {
        /// The first motor with such a command, counted from 0.
        motor: usize,
        /// The command of that motor.
        command: f64,
    },
}

/// The conditions under which an input counts as known.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Sampling {
    /// The minimum number of samples that a window must contain before it counts.
    pub min_samples: u32,
    /// The time in seconds that a window must cover before it counts; for a shorter window, its whole length. 99 % of
    /// this time is enough.
    pub warm_up_s: f64,
    /// A gap between two samples that is longer than this, in seconds, resets the state.
    pub longest_gap_s: f64,
    /// The length of the take-off, in seconds. When `warm_up_s` have passed after the take-off, windows that are longer
    /// than the take-off discard it and the elevated risk restarts, because a take-off is not typical of the flight. If
    /// the length is 0, nothing is discarded.
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
    /// The level. If a risk of the profile is unknown, it is the level of an ongoing alarm or null, never GOOD.
    level: Option<Level>,
    /// Whether the risk counts for levels, findings and the summary of a flight.
    judged: bool,
}

/// A risk and how it was estimated, as serde data; null if it is unknown.
#[cfg(feature = "serde")]
#[derive(Debug, Clone, Copy, serde::Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub(crate) struct RiskFields {
    /// The risk in %.
    #[cfg_attr(feature = "schema", schemars(range(min = 0, max = 100)))]
    risk: Option<f64>,
    /// The elevated risk in %.
    elevated_risk: Option<f64>,
    /// The coverage: the largest firing strength of a rule, in [0, 1].
    coverage: Option<f64>,
    /// Whether the risk is interpolated, because no rule applies.
    filled: Option<bool>,
    /// The number of the rule with the largest firing strength, from 1; null if none fires.
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

state! {
    struct Estimate { risk_pct, coverage, filled_from, dominant_rule, clamped }
    struct Sampling { min_samples, warm_up_s, longest_gap_s, take_off_s }
}

state! {
    enum Unknown {
        0 = OnGround {}, 1 = OutOfOrder {}, 2 = WarmingUp { input }, 3 = TooFewSamples { input, samples },
        4 = NoValue { input }, 5 = NoRule {}, 6 = NoCommand { motor }, 7 = CommandOutside { motor, command }
    }
}
