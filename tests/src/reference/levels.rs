//! When levels are raised and lowered, from the risk and the elevated risk over time.

use flagred::verdict::{Level, LevelSettings, Threshold, VerdictSettings};

/// Time stamps are sums of steps: a duration this much shorter, in seconds, is long enough.
const ROUNDING_S: f64 = 1e-6;

/// What is known at one time of a flight.
#[derive(Clone, Copy)]
pub struct Moment {
    /// When, in seconds.
    pub t_s: f64,
    /// The risk in %.
    pub risk: f64,
    /// The elevated risk in %.
    pub elevated: f64,
    /// Just after take-off, when only FAIL is raised.
    pub takes_off: bool,
}

/// A time of trouble.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Trouble {
    /// Its worst level.
    pub level: Level,
    /// Since when the level that was raised first was reached.
    pub from_s: f64,
    /// When a level was first raised.
    pub raised_s: f64,
    /// When it became FAIL.
    pub failed_s: Option<f64>,
    /// When a level was last reached.
    pub to_s: f64,
}

fn reached(threshold: &Threshold, now: &Moment) -> bool {
    let over = |value: f64, limit: Option<f64>| limit.is_some_and(|limit| value >= limit);
    over(now.risk, threshold.risk_pct) || over(now.elevated, threshold.elevated_risk_pct)
}

/// The times of trouble of one flight from take-off on, until the vehicle landed or nothing is known any more.
pub fn troubles(
    settings: &VerdictSettings,
    moments: &[Moment],
    landed_s: Option<f64>,
) -> Vec<Trouble> {
    let levels = [(Level::Warn, &settings.warn), (Level::Fail, &settings.fail)];
    let raises = |level: Level, of: &LevelSettings, now: &Moment| {
        reached(&of.raise, now) && !(now.takes_off && level == Level::Warn)
    };
    let mut all: Vec<Trouble> = Vec::new();
    let mut level = Level::Good;
    let mut held_s = f64::NAN;
    for (i, now) in moments.iter().enumerate() {
        let t_s = now.t_s;
        let is_held = |(level, of): &&(Level, &LevelSettings)| {
            raises(*level, of, now) || reached(&of.until, now)
        };
        let held = levels
            .iter()
            .rfind(is_held)
            .map_or(Level::Good, |(held, _)| *held);
        if held >= level {
            held_s = t_s;
        } else if t_s - held_s >= settings.clear_after_s - ROUNDING_S {
            level = held;
            held_s = t_s;
        }
        for (higher, of) in levels {
            let unbroken = moments[..=i]
                .iter()
                .rev()
                .take_while(|m| raises(higher, of, m));
            let Some(since_s) = unbroken.last().map(|moment| moment.t_s) else {
                continue;
            };
            if higher > level && t_s - since_s >= of.after_s - ROUNDING_S {
                if level == Level::Good {
                    all.push(Trouble {
                        level: higher,
                        from_s: since_s,
                        raised_s: t_s,
                        failed_s: None,
                        to_s: t_s,
                    });
                }
                level = higher;
                held_s = t_s;
            }
            if let Some(open) = all.last_mut().filter(|_| level > Level::Good) {
                open.to_s = t_s;
                if level == Level::Fail {
                    open.level = level;
                    open.failed_s.get_or_insert(t_s);
                }
            }
        }
    }
    // A landing takes back what is open and was raised just before it.
    let quiet_s = |trouble: &Trouble| match trouble.level {
        Level::Fail => settings.quiet_before_landing_s / 2.0,
        _ => settings.quiet_before_landing_s,
    };
    let raised_before_s = |open: &Trouble| landed_s.map(|landed_s| landed_s - open.raised_s);
    let is_open = level > Level::Good;
    all.pop_if(|open| is_open && raised_before_s(open).is_some_and(|s| s < quiet_s(open)));
    all
}
