//! From risk to words: levels with hysteresis, a minimum duration and silence where alarms mean nothing.
//!
//! Pilots switch off warnings that cry too often, so a level is raised only after its threshold has been reached for
//! a while, is lowered only after a lower one has not been reached for a while, and is not raised just after take-off.

use crate::margin::Side;

mod alert;
mod balance;
mod notices;

pub use crate::{cause::Cause, motor::Motor};
pub(crate) use alert::{Alert, Now, ROUNDING_S};
pub(crate) use notices::Notices;

/// How risky it is, or was.
///
/// # Example
/// ```
/// use flagred::verdict::Level;
///
/// let worst = [Level::Good, Level::Fail, Level::Warn].into_iter().max();
/// assert_eq!(worst, Some(Level::Fail));
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[cfg_attr(feature = "serde", serde(rename_all = "UPPERCASE"))]
pub enum Level {
    /// Nothing to say.
    Good,
    /// Worth knowing, and no danger: the flight is as good as without it.
    Info,
    /// The pilot should know.
    Warn,
    /// Control is about to be lost, or was.
    Fail,
}

impl core::fmt::Display for Level {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        f.pad(match self {
            Level::Good => "GOOD",
            Level::Info => "INFO",
            Level::Warn => "WARN",
            Level::Fail => "FAIL",
        })
    }
}

/// The quantity that a threshold is on.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[cfg_attr(feature = "serde", serde(rename_all = "snake_case"))]
pub enum Measure {
    /// The risk of the moment.
    Risk,
    /// The elevated risk.
    ElevatedRisk,
    /// The noise of the motor commands, in % of their range.
    CommandNoise,
    /// What the mean command leaves below the upper limit, in % of the range.
    Reserve,
    /// How far motors are from their own part of the thrust earlier in the flight, in % of the range.
    Imbalance,
    /// How far a motor is from the one opposite, in % of the range.
    PairImbalance,
    /// How far one motor alone is above its own part of the thrust earlier in the flight, in % of the range: it gives less
    /// thrust than it is commanded.
    WeakMotor,
    /// The risk of motors that idle in the air, which is 100 %.
    IdleInAir,
}

impl Measure {
    /// All of them, in order.
    pub const ALL: [Measure; 8] = [
        Measure::Risk,
        Measure::ElevatedRisk,
        Measure::CommandNoise,
        Measure::Reserve,
        Measure::Imbalance,
        Measure::PairImbalance,
        Measure::WeakMotor,
        Measure::IdleInAir,
    ];
}

impl core::fmt::Display for Measure {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        f.pad(match self {
            Measure::Risk => "risk",
            Measure::ElevatedRisk => "elevated risk",
            Measure::CommandNoise => "command noise",
            Measure::Reserve => "reserve",
            Measure::Imbalance => "imbalance",
            Measure::PairImbalance => "pair imbalance",
            Measure::WeakMotor => "weak motor",
            Measure::IdleInAir => "idle in the air",
        })
    }
}

/// A limit on each quantity; reaching either is enough.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Threshold {
    /// On the risk, in %.
    pub risk_pct: Option<f64>,
    /// On the elevated risk, in %.
    pub elevated_risk_pct: Option<f64>,
}

impl Threshold {
    /// What reaches its limit, and the limit.
    fn reached(&self, risk_pct: f64, elevated_pct: f64) -> Option<(Measure, f64)> {
        let by = |limit: Option<f64>, value: f64| limit.filter(|limit| value >= *limit);
        by(self.risk_pct, risk_pct)
            .map(|limit| (Measure::Risk, limit))
            .or_else(|| {
                by(self.elevated_risk_pct, elevated_pct).map(|limit| (Measure::ElevatedRisk, limit))
            })
    }
}

/// When a level is raised and until when it is held.
///
/// # Example: raised at 67 % for a fifth of a second, held down to 25 %
/// ```
/// use flagred::verdict::{LevelSettings, VerdictSettings};
///
/// let LevelSettings { raise, after_s, until } = VerdictSettings::default().warn;
/// assert_eq!((raise.risk_pct, after_s, until.risk_pct), (Some(67.0), 0.2, Some(25.0)));
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct LevelSettings {
    /// The level is raised when this is reached ...
    pub raise: Threshold,
    /// ... for this long without a break, in seconds.
    pub after_s: f64,
    /// Once raised, the level is held while this, which is lower, is reached.
    pub until: Threshold,
}

/// When levels are raised and lowered.
///
/// # Example: to warn at a risk of 60 % that lasts for a second
/// ```
/// use flagred::verdict::{Threshold, VerdictSettings};
///
/// let mut settings = VerdictSettings::default();
/// settings.warn.raise = Threshold { risk_pct: Some(60.0), elevated_risk_pct: None };
/// settings.warn.after_s = 1.0;
/// assert_eq!(settings.clear_after_s, 10.0);
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct VerdictSettings {
    /// When to warn.
    pub warn: LevelSettings,
    /// When it fails.
    pub fail: LevelSettings,
    /// A level is lowered when nothing has held it for this long, in seconds: to the level that is held then.
    pub clear_after_s: f64,
    /// In the first seconds in the air only FAIL is raised; WARN does not count as reached.
    pub quiet_after_take_off_s: f64,
    /// A WARN that is raised in the last seconds before touch-down is taken back, unless FAIL is being reached at touch-down.
    pub quiet_before_landing_s: f64,
    /// While their mean effective command is below this, the motors idle: before take-off and after landing the vehicle
    /// is on the ground, also where the land detector lags. Motors that begin to idle within 2 s after a risk that reaches
    /// WARN do not rest. Motors that idle for 3 s while the autopilot reports that the vehicle is in the air are a fall, with a
    /// risk of 100 %.
    pub idle_below: f64,
    /// What is told beside the risk.
    pub notices: NoticeSettings,
}

/// A limit that has to be passed for a while.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Limit {
    /// The limit, on the effective range.
    pub value: f64,
    /// For how long, in seconds.
    pub after_s: f64,
}

/// What is told beside the risk; `None` is not.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct NoticeSettings {
    /// Noise of the commands above this: vibration, or gains too high.
    pub noise: Option<Limit>,
    /// A mean command that leaves less than this below the upper limit.
    pub reserve: Option<Limit>,
    /// Motors that moved farther than this from their own part of the thrust earlier in the flight, or are farther than twice
    /// this from the motor opposite; half of it where one motor alone moved up.
    pub imbalance: Option<Limit>,
}

impl NoticeSettings {
    /// Whether anything is told. All of it is about motors.
    pub(crate) fn any(&self) -> bool {
        *self != NoticeSettings::default()
    }
}

impl VerdictSettings {
    /// Calibrated on flights; see docs/validation.md.
    pub const DEFAULT: VerdictSettings = {
        const fn threshold(risk: f64, elevated: f64) -> Threshold {
            Threshold {
                risk_pct: Some(risk),
                elevated_risk_pct: Some(elevated),
            }
        }
        VerdictSettings {
            warn: LevelSettings {
                raise: threshold(67.0, 50.0),
                after_s: 0.2,
                until: threshold(25.0, 30.0),
            },
            fail: LevelSettings {
                raise: threshold(85.0, 90.0),
                after_s: 0.4,
                until: threshold(67.0, 70.0),
            },
            clear_after_s: 10.0,
            quiet_after_take_off_s: 5.0,
            quiet_before_landing_s: 1.0,
            idle_below: 0.1,
            notices: NoticeSettings {
                noise: None,
                reserve: None,
                imbalance: None,
            },
        }
    };
}

impl Default for VerdictSettings {
    fn default() -> Self {
        VerdictSettings::DEFAULT
    }
}

/// A time of trouble: from when a level was first reached until it was last reached, with the worst level of it.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Finding {
    /// The worst level that was reached.
    pub severity: Level,
    /// Since when the level was reached, in seconds.
    pub from_s: f64,
    /// When it was first raised: `after_s` of that level later.
    pub raised_s: f64,
    /// When it became FAIL; `None` where it did not.
    pub failed_s: Option<f64>,
    /// When the level was last reached. It is held for a while longer.
    pub to_s: f64,
    /// What reached the level first.
    pub measure: Measure,
    /// The threshold of the level in %.
    pub threshold_pct: f64,
    /// The worst value of the measure in that time, in %.
    pub value_pct: f64,
    /// The motor that is the cause. Of a risk: where the cause is that motors are near a limit, the one with the least margin
    /// while the level was being raised. Of an imbalance: the one out of balance.
    pub motor: Option<MotorFinding>,
    /// What raised the risk to the level; `None` where no rule did, as for a notice or an interpolated risk.
    #[cfg_attr(feature = "serde", serde(skip))]
    pub cause: Option<Cause>,
}

/// The motor behind a finding.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct MotorFinding {
    /// Its number, from 1: of a log or a vehicle that of the autopilot, else its place in the samples.
    #[cfg_attr(feature = "schema", schemars(range(min = 1)))]
    pub number: usize,
    /// The number of the other motor that it may be as well, where the commands do not show which of the two.
    #[cfg_attr(feature = "schema", schemars(range(min = 1)))]
    pub or_number: Option<usize>,
    /// The limit it was nearest to. Out of balance: below or above its part.
    pub side: Side,
    /// Its mean margin.
    pub margin_mean: f64,
    /// Its least margin.
    pub margin_min: f64,
}

/// An index as a number that counts from 1.
#[cfg(feature = "serde")]
pub(crate) fn from_one<S: serde::Serializer>(
    index: &usize,
    serializer: S,
) -> Result<S::Ok, S::Error> {
    serde::Serialize::serialize(&(index + 1), serializer)
}

impl Finding {
    pub(crate) const NONE: Finding = Finding {
        severity: Level::Good,
        from_s: 0.0,
        raised_s: 0.0,
        failed_s: None,
        to_s: 0.0,
        measure: Measure::Risk,
        threshold_pct: 0.0,
        value_pct: f64::NEG_INFINITY,
        motor: None,
        cause: None,
    };
}

/// The findings that end at one time: of the risk, the noise, the reserve and the balance.
pub type Ended = [Option<Finding>; 4];
