//! Levels, which are derived from the risk with hysteresis, a minimum duration and quiet times.
//!
//! Pilots switch off warnings that are too frequent. Therefore a level is raised only after its threshold has been
//! reached for some time, is cleared only after a lower threshold has not been reached for some time, and is not raised
//! just after take-off.

use crate::margin::Side;

mod alert;
mod balance;
mod notices;

pub use crate::{cause::Cause, motor::Motor};
pub(crate) use alert::{Alert, Now, ROUNDING_S};
pub(crate) use notices::Notices;

/// How risky a moment, or a flight, is.
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
    /// No problem was found.
    Good,
    /// Worth knowing but not dangerous: the verdict stays GOOD unless there is a more severe finding.
    Info,
    /// The pilot should pay attention.
    Warn,
    /// Loss of control is imminent, or has happened.
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

/// The quantity that a threshold applies to.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[cfg_attr(feature = "serde", serde(rename_all = "snake_case"))]
pub enum Measure {
    /// The current risk.
    Risk,
    /// The elevated risk.
    ElevatedRisk,
    /// The noise of the motor commands, in % of their range.
    CommandNoise,
    /// The reserve: the distance of the mean command from the upper limit, in % of the range.
    Reserve,
    /// The change of a motor's command since earlier in the flight, relative to the mean command of all motors, in % of
    /// the range.
    Imbalance,
    /// The difference between the command of a motor and that of the opposite motor, in % of the range.
    PairImbalance,
    /// The shift of a motor's command if only the command of this motor is higher than earlier in the flight, in %
    /// of the range: the motor gives less thrust than commanded.
    WeakMotor,
    /// The risk of motors that idle in the air, which is 100 %.
    IdleInAir,
}

impl Measure {
    /// All quantities, in order.
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
            Measure::IdleInAir => "motors idle in the air",
        })
    }
}

/// Thresholds on the risk and the elevated risk; reaching either is enough.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Threshold {
    /// The threshold on the risk, in %.
    pub risk_pct: Option<f64>,
    /// The threshold on the elevated risk, in %.
    pub elevated_risk_pct: Option<f64>,
}

impl Threshold {
    /// The measure that reaches its threshold, and the threshold.
    fn reached(&self, risk_pct: f64, elevated_pct: f64) -> Option<(Measure, f64)> {
        let by = |limit: Option<f64>, value: f64| limit.filter(|limit| value >= *limit);
        by(self.risk_pct, risk_pct)
            .map(|limit| (Measure::Risk, limit))
            .or_else(|| {
                by(self.elevated_risk_pct, elevated_pct).map(|limit| (Measure::ElevatedRisk, limit))
            })
    }
}

/// The conditions under which a level is raised and held.
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
    /// The threshold that raises the level.
    pub raise: Threshold,
    /// How long the threshold must be reached without a break, in seconds.
    pub after_s: f64,
    /// The threshold that holds the level once it is raised; lower than `raise`.
    pub until: Threshold,
}

/// The conditions under which levels are raised and cleared.
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
    /// The conditions for WARN.
    pub warn: LevelSettings,
    /// The conditions for FAIL.
    pub fail: LevelSettings,
    /// A level is cleared when no threshold has held it for this time, in seconds. It is replaced by the level
    /// that is still held.
    pub clear_after_s: f64,
    /// In this time after take-off, in seconds, only FAIL is raised; WARN does not count as reached.
    pub quiet_after_take_off_s: f64,
    /// A WARN that is raised in this time before touch-down, in seconds, is withdrawn, unless FAIL is being reached at
    /// touch-down.
    pub quiet_before_landing_s: f64,
    /// The motors idle while their mean effective command is below this. Before take-off and after landing the vehicle
    /// then counts as on the ground, even if the land detector lags. Motors that begin to idle within 2 s after a risk
    /// that reaches WARN do not count as a landing. Motors that idle for 3 s while the autopilot reports that the
    /// vehicle is in the air count as a fall, with a risk of 100 %.
    pub idle_below: f64,
    /// The limits of the findings that are not about the risk.
    pub notices: NoticeSettings,
}

/// A limit that must be exceeded for some time.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Limit {
    /// The limit, on the effective range.
    pub value: f64,
    /// How long the limit must be exceeded, in seconds.
    pub after_s: f64,
}

/// The limits of the findings that are not about the risk; `None` disables a finding.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct NoticeSettings {
    /// The threshold on the noise of the commands: vibration, or gains that are too high.
    pub noise: Option<Limit>,
    /// The threshold on the reserve, which is the distance of the mean command from the upper limit.
    pub reserve: Option<Limit>,
    /// The threshold on the shift of a motor's command, relative to the mean command of all motors, since earlier in
    /// the flight. It is doubled for the difference of opposite motors, and halved if a single motor is higher than
    /// before.
    pub imbalance: Option<Limit>,
}

impl NoticeSettings {
    /// Whether any finding is enabled. All these findings read the motors.
    pub(crate) fn any(&self) -> bool {
        *self != NoticeSettings::default()
    }
}

impl VerdictSettings {
    /// The default settings, which were calibrated on flights; see docs/validation.md.
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

/// A period at or above a level: from the time at which a level was first reached to the time at which it was last
/// reached, with its worst level.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Finding {
    /// The worst level that was reached.
    pub severity: Level,
    /// The time at which a level was first reached, in seconds.
    pub from_s: f64,
    /// The time at which a level was first raised, in seconds: when it had been reached for the `after_s` of the
    /// level.
    pub raised_s: f64,
    /// The time at which the level was raised to FAIL, in seconds; `None` if it was not.
    pub failed_s: Option<f64>,
    /// The time at which the level was last reached, in seconds. The level is held for some time after that.
    pub to_s: f64,
    /// The measure that reached the level first.
    pub measure: Measure,
    /// The threshold of the level in %.
    pub threshold_pct: f64,
    /// The worst value of the measure in that period, in %.
    pub value_pct: f64,
    /// The motor that is the cause. For a risk caused by motors near a limit, the motor with the least margin while the
    /// level was being raised. For an imbalance, the motor that is out of balance.
    pub motor: Option<MotorFinding>,
    /// The cause of the risk when it reached the level; `None` if no rule raised it, as for a notice or an interpolated
    /// risk.
    #[cfg_attr(feature = "serde", serde(skip))]
    pub cause: Option<Cause>,
}

/// The motor that caused a finding.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct MotorFinding {
    /// The number of the motor, from 1: as numbered by the autopilot, or otherwise its position in
    /// the samples.
    #[cfg_attr(feature = "schema", schemars(range(min = 1)))]
    pub number: usize,
    /// The number of a second motor that may be the cause instead, if the commands do not show which of the two.
    #[cfg_attr(feature = "schema", schemars(range(min = 1)))]
    pub or_number: Option<usize>,
    /// The nearest limit. For an imbalance, `Lower` if the command of the motor is below its share earlier in the
    /// flight or below the opposite motor, `Upper` if it is above.
    pub side: Side,
    /// The mean margin of the motor.
    pub margin_mean: f64,
    /// The smallest margin of the motor.
    pub margin_min: f64,
}

/// Serialises an index as a number that counts from 1.
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

/// The findings that end at the same time: one each about the risk, the noise, the reserve and the balance.
pub type EndedFindings = [Option<Finding>; 4];

state! {
    struct Finding {
        severity, from_s, raised_s, failed_s, to_s, measure, threshold_pct, value_pct, motor, cause
    }
    struct MotorFinding { number, or_number, side, margin_mean, margin_min }
    struct Threshold { risk_pct, elevated_risk_pct }
    struct LevelSettings { raise, after_s, until }
    struct Limit { value, after_s }
    struct NoticeSettings { noise, reserve, imbalance }
    struct VerdictSettings {
        warn, fail, clear_after_s, quiet_after_take_off_s, quiet_before_landing_s, idle_below, notices
    }
}

state! { enum Level { 0 = Good {}, 1 = Info {}, 2 = Warn {}, 3 = Fail {} } }

state! {
    enum Measure {
        0 = Risk {}, 1 = ElevatedRisk {}, 2 = CommandNoise {}, 3 = Reserve {}, 4 = Imbalance {},
        5 = PairImbalance {}, 6 = WeakMotor {}, 7 = IdleInAir {}
    }
}
