//! From risk to words: levels with hysteresis, a minimum duration and silence where alarms mean nothing.
//!
//! Pilots switch off warnings that cry too often, so a level is raised only after its threshold has been reached for
//! a while, is lowered only after a lower one has not been reached for a while, and is not raised just after take-off.

use crate::margin::Side;

mod alert;
mod watch;

pub(crate) use alert::{Alert, Step};
pub use watch::Motor;

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
#[cfg_attr(feature = "serde", serde(rename_all = "UPPERCASE"))]
pub enum Level {
    /// Nothing to say.
    Good,
    /// The pilot should know.
    Warn,
    /// Control is about to be lost, or was.
    Fail,
}

impl core::fmt::Display for Level {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        f.pad(match self {
            Level::Good => "GOOD",
            Level::Warn => "WARN",
            Level::Fail => "FAIL",
        })
    }
}

/// The quantity that a threshold is on.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
#[cfg_attr(feature = "serde", serde(rename_all = "snake_case"))]
pub enum Measure {
    /// The risk of the moment.
    Risk,
    /// The elevated risk.
    ElevatedRisk,
}

/// A limit on each quantity; reaching either is enough.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
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
pub struct VerdictSettings {
    /// When to warn.
    pub warn: LevelSettings,
    /// When it fails.
    pub fail: LevelSettings,
    /// A level is lowered when nothing has held it for this long, in seconds.
    pub clear_after_s: f64,
    /// In the first seconds in the air no level is raised.
    pub quiet_after_take_off_s: f64,
    /// What is raised in the last seconds before touching down is taken back.
    pub quiet_before_landing_s: f64,
    /// Where the motors idle, as when touching down, the risk says little.
    pub idle: Idle,
}

/// How a risk counts while the motors idle: near their lower limit all at once, they hold nothing in the air.
///
/// # Example: a key of a profile
/// ```
/// use flagred::{profile::Profile, verdict::Idle};
///
/// let text = "flagred: 1\nname: p\nrules: my.yaml\ninputs: {margin: {mean: motor_margin}}
/// verdict: {idle: {command_below: 0.2, risk_at_most: 50}}";
/// let idle = Idle { command_below: 0.2, risk_at_most_pct: 50.0 };
/// assert_eq!(text.parse::<Profile>()?.verdict.idle, idle);
/// # Ok::<(), fuzzy::diagnostic::Findings>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
pub struct Idle {
    /// The motors idle while their mean effective command is below this.
    pub command_below: f64,
    /// The risk then counts as this at most, in %.
    pub risk_at_most_pct: f64,
}

impl Default for VerdictSettings {
    /// Calibrated on simulated flights.
    fn default() -> Self {
        let threshold = |risk, elevated| Threshold {
            risk_pct: Some(risk),
            elevated_risk_pct: Some(elevated),
        };
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
            idle: Idle {
                command_below: 0.1,
                risk_at_most_pct: 60.0,
            },
        }
    }
}

/// A time at or above a level: what is FAIL for a while is one finding of that while, within one of WARN.
///
/// # Example: ten seconds of motors at their limits
/// ```
/// # use flagred::{sample::Sample, estimator::Estimator, monitor::{Craft, Monitor}, shipped};
/// # let estimator = shipped::flagred_paper();
/// # let mut monitor = Monitor::new(&estimator, Craft::new(4))?;
/// use flagred::{margin::Side, verdict::{Finding, Level, Measure, MotorFinding}};
///
/// for i in 0..500 {
///     let t_s = f64::from(i) * 0.04;
///     let motors = if t_s < 10.0 { [0.5; 4] } else { [0.0, 0.9, 1.0, 0.1] };
///     monitor.push(&Sample { t_s, motors: &motors, in_air: true, signals: &[] });
/// }
/// let Finding { level, from_s, raised_s, measure, motor, .. } = monitor.finish()[1].ok_or("nothing found")?;
/// assert!(level == Level::Fail && from_s > 10.0 && raised_s >= from_s + 0.4 && measure == Measure::Risk);
/// let MotorFinding { motor, side, least_margin, .. } = motor.ok_or("no motor")?;
/// assert_eq!((motor, side, least_margin), (0, Side::Low, 0.0)); // the first of two without any margin
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
pub struct Finding {
    /// The level.
    #[cfg_attr(feature = "serde", serde(rename = "severity"))]
    pub level: Level,
    /// Since when the level was reached, in seconds.
    pub from_s: f64,
    /// When it was raised: its `after_s` later.
    pub raised_s: f64,
    /// When the level was last reached. It is held for a while longer.
    pub to_s: f64,
    /// What reached the level first.
    pub measure: Measure,
    /// The threshold of the level in %.
    pub threshold_pct: f64,
    /// The largest value of the measure in that time, in %.
    #[cfg_attr(feature = "serde", serde(rename = "value_pct"))]
    pub peak_pct: f64,
    /// The motor with the least margin on average over that time; `None` where no motor is known.
    pub motor: Option<MotorFinding>,
}

/// The motor behind a finding.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
pub struct MotorFinding {
    /// Which one, counted from 0 in the order of the samples.
    #[cfg_attr(
        feature = "serde",
        serde(rename = "number", serialize_with = "from_one")
    )]
    pub motor: usize,
    /// The limit it was nearest to.
    pub side: Side,
    /// Its mean margin.
    #[cfg_attr(feature = "serde", serde(rename = "margin_mean"))]
    pub mean_margin: f64,
    /// Its least margin.
    #[cfg_attr(feature = "serde", serde(rename = "margin_min"))]
    pub least_margin: f64,
}

/// An index as a number that counts from 1.
#[cfg(feature = "serde")]
fn from_one<S: serde::Serializer>(index: &usize, serializer: S) -> Result<S::Ok, S::Error> {
    serde::Serialize::serialize(&(index + 1), serializer)
}

/// The findings that end at one time: of WARN, of FAIL.
pub type Ended = [Option<Finding>; 2];
