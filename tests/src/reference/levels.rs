//! The times at which levels are raised and lowered, computed from the risk and the elevated risk.

use flagred::verdict::{Level, LevelSettings, Threshold, VerdictSettings};

/// Tolerance for durations, in seconds, because timestamps are sums of steps.
const ROUNDING_S: f64 = 1e-6;

/// The state at one time of a flight.
#[derive(Clone, Copy)]
pub struct Moment {
    /// Time in seconds.
    pub t_s: f64,
    /// The risk in %.
    pub risk: f64,
    /// The elevated risk in %.
    pub elevated: f64,
    /// Whether the take-off was so recent that only FAIL is raised.
    pub takes_off: bool,
    /// Whether the motors slow down together; then FAIL is not raised.
    pub sinks: bool,
}

/// A period with a level above GOOD.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RaisedEpisode {
    /// The worst level of the period.
    pub level: Level,
    /// The start of the period in which the thresholds of any level were reached without interruption.
    pub from_s: f64,
    /// Time at which a level was first raised.
    pub raised_s: f64,
    /// Time at which the level became FAIL.
    pub failed_s: Option<f64>,
    /// The last time at which the thresholds for raising a level were reached.
    pub to_s: f64,
}

fn reached(threshold: &Threshold, now: &Moment) -> bool {
    let over = |value: f64, limit: Option<f64>| limit.is_some_and(|limit| value >= limit);
    over(now.risk, threshold.risk_pct) || over(now.elevated, threshold.elevated_risk_pct)
}

/// The level of one flight, and its periods above GOOD so far.
#[derive(Debug, Clone)]
pub struct Levels {
    /// The current level.
    pub level: Level,
    held_s: f64,
    /// Whether the latest risks reach the thresholds of FAIL, no matter for how long.
    reaches_fail: bool,
    all: Vec<RaisedEpisode>,
}

impl Levels {
    /// The levels of a flight at take-off.
    pub fn new() -> Levels {
        Levels {
            level: Level::Good,
            held_s: f64::NAN,
            reaches_fail: false,
            all: Vec::new(),
        }
    }

    /// Adds the last of the moments since take-off.
    pub fn push(&mut self, settings: &VerdictSettings, moments: &[Moment]) {
        let Some(now) = moments.last() else { return };
        let t_s = now.t_s;
        let levels = [(Level::Warn, &settings.warn), (Level::Fail, &settings.fail)];
        let raises = |level: Level, of: &LevelSettings, now: &Moment| {
            let is_quiet = if level == Level::Warn {
                now.takes_off
            } else {
                now.sinks
            };
            reached(&of.raise, now) && !is_quiet
        };
        self.reaches_fail = raises(Level::Fail, &settings.fail, now);
        let is_held = |(level, of): &&(Level, &LevelSettings)| {
            raises(*level, of, now) || reached(&of.until, now)
        };
        let held = levels
            .iter()
            .rfind(is_held)
            .map_or(Level::Good, |(held, _)| *held);
        if held >= self.level {
            self.held_s = t_s;
        } else if t_s - self.held_s >= settings.clear_after_s - ROUNDING_S {
            self.level = held;
            self.held_s = t_s;
        }
        for (higher, of) in levels {
            let unbroken = moments.iter().rev().take_while(|m| raises(higher, of, m));
            let Some(since_s) = unbroken.last().map(|moment| moment.t_s) else {
                continue;
            };
            if higher > self.level && t_s - since_s >= of.after_s - ROUNDING_S {
                if self.level == Level::Good {
                    let any = |m: &&Moment| levels.iter().any(|(level, of)| raises(*level, of, m));
                    let first = moments.iter().rev().take_while(any).last();
                    self.all.push(RaisedEpisode {
                        level: higher,
                        from_s: first.map_or(since_s, |moment| moment.t_s),
                        raised_s: t_s,
                        failed_s: None,
                        to_s: t_s,
                    });
                }
                self.level = higher;
                self.held_s = t_s;
            }
            if let Some(open) = self.all.last_mut().filter(|_| self.level > Level::Good) {
                open.to_s = t_s;
                if self.level == Level::Fail {
                    open.level = self.level;
                    open.failed_s.get_or_insert(t_s);
                }
            }
        }
    }

    /// Ends the flight, because the vehicle landed or its state became unknown, and returns the periods above GOOD.
    pub fn end(&mut self, settings: &VerdictSettings, landed_s: Option<f64>) -> Vec<RaisedEpisode> {
        let ended = std::mem::take(self);
        let mut all = ended.all;
        // A landing cancels an open WARN that was raised just before it, unless the thresholds of FAIL are reached at
        // the landing.
        let is_late = |open: &RaisedEpisode| {
            landed_s.is_some_and(|t_s| t_s - open.raised_s < settings.quiet_before_landing_s)
        };
        let is_warn = ended.level > Level::Good && !ended.reaches_fail;
        all.pop_if(|open| is_warn && open.level == Level::Warn && is_late(open));
        all
    }
}

impl Default for Levels {
    fn default() -> Self {
        Levels::new()
    }
}
