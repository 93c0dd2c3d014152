//! Findings that are not about the risk: noise of the commands, little reserve of thrust, motors out of balance.
//!
//! Each uses a moving average with a fixed time constant, so it needs no window.

use super::{
    Finding, Level, Limit, Measure, MotorFinding, NoticeSettings,
    alert::ROUNDING_S,
    balance::{self, Balance, UnbalancedMotor},
};
use crate::{average::Average, motor::Motor};

/// The time constant of the noise, in seconds.
const NOISE_S: f64 = 10.0;
/// The time constant of the reserve, in seconds.
const RESERVE_S: f64 = 3.0;

/// The state of the noise, reserve and imbalance of one flight.
#[derive(Debug, Clone)]
pub(crate) struct Notices {
    settings: NoticeSettings,
    noise_squared: Average,
    reserve: Average,
    balance: Balance,
    /// The states for the noise, the reserve, an imbalance and a weak motor.
    watches: [NoticeState; 4],
}

/// The time since which a limit has been exceeded, and the open finding.
#[derive(Debug, Clone, Copy)]
struct NoticeState {
    passed_since_s: Option<f64>,
    finding: Option<Finding>,
}

/// A value that exceeds its limit, and the motor to which the value belongs.
struct Exceedance {
    measure: Measure,
    /// The value, on the effective range.
    value: f64,
    /// The limit of the value, on the effective range.
    limit: f64,
    motor: Option<MotorFinding>,
}

impl Notices {
    pub(crate) const fn new(settings: NoticeSettings) -> Notices {
        Notices {
            settings,
            noise_squared: Average::NONE,
            reserve: Average::NONE,
            balance: Balance::NONE,
            watches: [NoticeState {
                passed_since_s: None,
                finding: None,
            }; 4],
        }
    }

    /// Processes a sample in flight at `t_s` that applies to the `held_s` seconds before. `is_calm` is true while there
    /// is no alarm.
    pub(crate) fn push(
        &mut self,
        (t_s, held_s): (f64, f64),
        noise: f64,
        motors: &mut [Motor],
        is_calm: bool,
    ) {
        let commands = motors.iter().map(|motor| motor.command);
        let known = commands.filter(|e| e.is_finite());
        let (sum, count) = known.fold((0.0, 0.0), |(sum, count), e| (sum + e, count + 1.0));
        let mean = sum / count;
        // The noise is known at most once per 0.1 s.
        self.noise_squared
            .add(noise * noise, held_s.max(0.1), NOISE_S);
        self.reserve.add(1.0 - mean, held_s, RESERVE_S);

        let settings = self.settings;
        let plain = |measure, value, limit: Limit| Exceedance {
            measure,
            value,
            limit: limit.value,
            motor: None,
        };
        let noise = self.noise_squared.known_after(NOISE_S).map(libm::sqrt);
        let noise = noise.zip(settings.noise);
        let noise = noise.filter(|(value, limit)| *value > limit.value);
        let noise = noise.map(|(value, limit)| plain(Measure::CommandNoise, value, limit));
        self.watches[0].push(t_s, Level::Info, settings.noise, noise);
        let reserve = self.reserve.known_after(RESERVE_S).zip(settings.reserve);
        let reserve = reserve.filter(|(value, limit)| *value < limit.value);
        let reserve = reserve.map(|(value, limit)| plain(Measure::Reserve, value, limit));
        self.watches[1].push(t_s, Level::Warn, settings.reserve, reserve);
        let limit = settings.imbalance;
        let seen = limit.map(|limit| self.balance.push(motors, held_s, limit, is_calm));
        let balance::BalanceFindings { weak, imbalance } = seen.unwrap_or_default();
        // A weak motor already explains the imbalance, so it is not reported separately.
        let imbalance = imbalance.filter(|_| self.watches[3].finding.is_none());
        self.watches[2].push(t_s, Level::Warn, limit, imbalance.map(Exceedance::of));
        self.watches[3].push(t_s, Level::Warn, limit, weak.map(Exceedance::of));
    }

    /// Whether the motors work as they did before the alarm; true if that is not monitored.
    pub(crate) fn has_recovered(&self) -> bool {
        self.settings.imbalance.is_none() || self.balance.has_recovered()
    }

    /// Whether the motors differ from each other no more than they did in the last seconds; true if that is not
    /// monitored.
    pub(crate) fn is_together(&self, motors: &[Motor]) -> bool {
        self.settings.imbalance.is_none() || balance::is_together(motors)
    }

    /// Whether all motors slow down together; false if that is not monitored.
    pub(crate) fn slow_down_together(&self) -> bool {
        self.balance.slow_down_together()
    }

    /// Ends the flight and returns the open findings.
    pub(crate) fn end(&mut self) -> [Option<Finding>; 3] {
        let [noise, reserve, imbalance, weak] = self.watches.map(|watch| watch.finding);
        *self = Notices::new(self.settings);
        [noise, reserve, weak.or(imbalance)]
    }

    /// The worst open finding above INFO.
    pub(crate) fn open(&self) -> Option<&Finding> {
        let mut open = self
            .watches
            .iter()
            .filter_map(|watch| watch.finding.as_ref());
        open.rfind(|finding| finding.severity > Level::Info)
    }
}

impl Exceedance {
    fn of(unbalanced: UnbalancedMotor) -> Exceedance {
        let UnbalancedMotor {
            measure,
            value,
            limit,
            motor,
        } = unbalanced;
        Exceedance {
            measure,
            value,
            limit,
            motor: Some(motor),
        }
    }
}

impl NoticeState {
    /// Updates the finding. An open finding stays open until the flight ends, and keeps the motor and the limit with
    /// which it was opened.
    fn push(&mut self, t_s: f64, level: Level, limit: Option<Limit>, passed: Option<Exceedance>) {
        let (Some(Limit { after_s, .. }), Some(passed)) = (limit, passed) else {
            self.passed_since_s = None;
            return;
        };
        let from_s = *self.passed_since_s.get_or_insert(t_s);
        let value_pct = 100.0 * passed.value;
        if let Some(finding) = &mut self.finding {
            finding.to_s = t_s;
            if finding.measure == passed.measure {
                finding.value_pct = match passed.measure {
                    Measure::Reserve => finding.value_pct.min(value_pct),
                    _ => finding.value_pct.max(value_pct),
                };
            }
        } else if t_s - from_s >= after_s - ROUNDING_S {
            self.finding = Some(Finding {
                severity: level,
                from_s,
                raised_s: t_s,
                to_s: t_s,
                measure: passed.measure,
                threshold_pct: 100.0 * passed.limit,
                value_pct,
                motor: passed.motor,
                ..Finding::NONE
            });
        }
    }
}

state! {
    struct Notices {
        settings, noise_squared, reserve, balance, watches
    }
    struct NoticeState { passed_since_s, finding }
}
