//! From risk to words: levels with hysteresis, a minimum duration and silence where alarms mean nothing.
//!
//! Pilots switch off warnings that cry too often, so a level is raised only after its threshold has been reached for
//! a while, is lowered only after a lower one has not been reached for a while, and is not raised just after take-off.

use crate::margin::{Side, margin};

/// How risky it is, or was.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum Level {
    /// Nothing to say.
    Good,
    /// The pilot should know.
    Warn,
    /// Control is about to be lost, or was.
    Fail,
}

/// The quantity that a threshold is on.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Measure {
    /// The risk of the moment.
    Risk,
    /// The elevated risk.
    ElevatedRisk,
}

/// A limit on each quantity; reaching either is enough.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
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
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LevelSettings {
    /// The level is raised when this is reached ...
    pub raise: Threshold,
    /// ... for this long without a break, in seconds.
    pub after_s: f64,
    /// Once raised, the level is held while this, which is lower, is reached.
    pub until: Threshold,
}

/// When levels are raised and lowered.
#[derive(Debug, Clone, Copy, PartialEq)]
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
#[derive(Debug, Clone, Copy, PartialEq)]
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
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Finding {
    /// The level.
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
    pub peak_pct: f64,
    /// The motor with the least margin on average over that time; `None` where no motor is known.
    pub motor: Option<MotorFinding>,
}

/// The motor behind a finding.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct MotorFinding {
    /// Which one, counted from 0 in the order of the samples.
    pub motor: usize,
    /// The limit it was nearest to.
    pub side: Side,
    /// Its mean margin.
    pub mean_margin: f64,
    /// Its least margin.
    pub least_margin: f64,
}

/// The findings that end at one time: of WARN, of FAIL.
pub type Ended = [Option<Finding>; 2];

/// Keeps the level over time.
#[derive(Debug, Clone)]
pub(crate) struct Alert {
    settings: VerdictSettings,
    level: Level,
    /// When the level was last held.
    last_held_s: f64,
    /// Of WARN, of FAIL.
    watches: [Watch; 2],
}

/// What is known of one level.
#[derive(Debug, Clone)]
struct Watch {
    level: Level,
    /// Since when the level is reached.
    reached_since_s: Option<f64>,
    finding: Option<Finding>,
}

/// What is kept of one motor.
#[derive(Debug, Clone, Copy)]
pub struct Motor {
    /// Its effective command in the latest sample; NaN is unknown.
    pub(crate) command: f64,
    /// Its margins while a level was reached, since it was first: of WARN, of FAIL.
    records: [MotorRecord; 2],
}

impl Motor {
    /// Memory for a motor, all zeros.
    pub(crate) const IDLE: Motor = Motor {
        command: 0.0,
        records: [MotorRecord {
            samples: 0,
            mean_margin: 0.0,
            least_margin: 0.0,
            side: Side::Low,
        }; 2],
    };

    /// A motor of which nothing is known yet.
    pub const UNKNOWN: Motor = Motor {
        command: f64::NAN,
        records: [NO_RECORD; 2],
    };
}

#[derive(Debug, Clone, Copy)]
struct MotorRecord {
    samples: u32,
    mean_margin: f64,
    least_margin: f64,
    side: Side,
}

/// Sums of time steps are off by less than this.
const ROUNDING_S: f64 = 1e-6;

const NO_RECORD: MotorRecord = MotorRecord {
    samples: 0,
    mean_margin: 0.0,
    least_margin: f64::INFINITY,
    side: Side::High,
};

/// What a sample did to the level.
#[derive(Debug, Clone, Copy, Default)]
pub(crate) struct Step {
    /// The new level, where it changed.
    pub(crate) change: Option<Level>,
    /// The findings that ended.
    pub(crate) ended: Ended,
}

impl Alert {
    pub(crate) const fn new(settings: VerdictSettings) -> Alert {
        Alert {
            settings,
            level: Level::Good,
            last_held_s: 0.0,
            watches: [Watch::of(Level::Warn), Watch::of(Level::Fail)],
        }
    }

    pub(crate) fn level(&self) -> Level {
        self.level
    }

    /// The finding that the level rests on, as it stands; `None` while there is nothing to say.
    pub(crate) fn open(&self, motors: &[Motor]) -> Option<Finding> {
        let watch = self
            .watches
            .iter()
            .find(|watch| watch.level == self.level)?;
        let motor = watch.weakest_motor(motors);
        watch.finding.map(|finding| Finding { motor, ..finding })
    }

    /// Adds a moment of known risk.
    pub(crate) fn push(
        &mut self,
        t_s: f64,
        risk_pct: f64,
        elevated_pct: f64,
        motors: &mut [Motor],
    ) -> Step {
        let settings = self.settings;
        let risk_pct = if idles(motors, &settings.idle) {
            risk_pct.min(settings.idle.risk_at_most_pct)
        } else {
            risk_pct
        };
        let mut step = Step::default();
        let mut held = Level::Good;
        for (watch, settings) in self.watches.iter_mut().zip([settings.warn, settings.fail]) {
            let reached = settings.raise.reached(risk_pct, elevated_pct);
            if let Some(raised) = watch.push(t_s, reached, settings.after_s, self.level, motors) {
                self.level = raised;
                step.change = Some(raised);
            }
            watch.follow(t_s, risk_pct, elevated_pct, reached.is_some());
            if reached.is_some() || settings.until.reached(risk_pct, elevated_pct).is_some() {
                held = watch.level.min(self.level);
            }
        }
        if held >= self.level {
            self.last_held_s = t_s;
        } else if t_s - self.last_held_s >= settings.clear_after_s - ROUNDING_S {
            self.level = held;
            self.last_held_s = t_s;
            step.change = Some(held);
            step.ended = self.watches.each_mut().map(|watch| {
                let is_over = watch.level > held;
                is_over.then(|| watch.end(motors)).flatten()
            });
        }
        step
    }

    /// Ends it all: the flight, or the knowledge of it, is over. What was raised too shortly before a landing
    /// is taken back.
    pub(crate) fn end(&mut self, t_s: f64, landed: bool, motors: &[Motor]) -> Step {
        let change = (self.level > Level::Good).then_some(Level::Good);
        self.level = Level::Good;
        let quiet_s = self.settings.quiet_before_landing_s;
        let ended = self.watches.each_mut().map(|watch| {
            watch.reached_since_s = None;
            let finding = watch.end(motors);
            finding.filter(|finding| !landed || t_s - finding.raised_s >= quiet_s)
        });
        Step { change, ended }
    }
}

impl Watch {
    const fn of(level: Level) -> Watch {
        Watch {
            level,
            reached_since_s: None,
            finding: None,
        }
    }

    /// Which of a motor's records is this level's.
    fn record(&self) -> usize {
        usize::from(self.level == Level::Fail)
    }

    /// Takes in whether the level is reached, by what and over which threshold; gives the level where that raises it.
    fn push(
        &mut self,
        t_s: f64,
        reached: Option<(Measure, f64)>,
        after_s: f64,
        now: Level,
        motors: &mut [Motor],
    ) -> Option<Level> {
        let record = self.record();
        let Some((measure, threshold_pct)) = reached else {
            self.reached_since_s = None;
            return None;
        };
        if self.reached_since_s.is_none() && self.finding.is_none() {
            for motor in motors.iter_mut() {
                motor.records[record] = NO_RECORD;
            }
        }
        let from_s = *self.reached_since_s.get_or_insert(t_s);
        for motor in motors {
            motor.records[record].add(motor.command);
        }
        if self.level <= now || t_s - from_s < after_s - ROUNDING_S {
            return None;
        }
        self.finding = Some(Finding {
            level: self.level,
            from_s,
            raised_s: t_s,
            to_s: t_s,
            measure,
            threshold_pct,
            peak_pct: f64::NEG_INFINITY,
            motor: None,
        });
        Some(self.level)
    }

    /// Keeps the finding that is open up to date.
    fn follow(&mut self, t_s: f64, risk_pct: f64, elevated_pct: f64, reached: bool) {
        if let Some(finding) = &mut self.finding {
            let value = match finding.measure {
                Measure::Risk => risk_pct,
                Measure::ElevatedRisk => elevated_pct,
            };
            finding.peak_pct = finding.peak_pct.max(value);
            if reached {
                finding.to_s = t_s;
            }
        }
    }

    fn end(&mut self, motors: &[Motor]) -> Option<Finding> {
        let motor = self.weakest_motor(motors);
        self.finding
            .take()
            .map(|finding| Finding { motor, ..finding })
    }

    fn weakest_motor(&self, motors: &[Motor]) -> Option<MotorFinding> {
        let records = motors.iter().map(|motor| motor.records[self.record()]);
        let known = records.enumerate().filter(|(_, r)| r.samples > 0);
        let weakest = known.min_by(|(_, a), (_, b)| a.mean_margin.total_cmp(&b.mean_margin));
        weakest.map(|(motor, record)| MotorFinding {
            motor,
            side: record.side,
            mean_margin: record.mean_margin,
            least_margin: record.least_margin,
        })
    }
}

impl MotorRecord {
    fn add(&mut self, e: f64) {
        if !e.is_finite() {
            return;
        }
        let margin = margin(e);
        self.samples += 1;
        self.mean_margin += (margin - self.mean_margin) / f64::from(self.samples);
        if margin < self.least_margin {
            self.least_margin = margin;
            self.side = Side::of(e);
        }
    }
}

fn idles(motors: &[Motor], idle: &Idle) -> bool {
    let commands = motors.iter().map(|motor| motor.command);
    let known = commands.filter(|e| e.is_finite());
    let (sum, count) = known.fold((0.0, 0.0), |(sum, count), e| (sum + e, count + 1.0));
    count > 0.0 && sum < idle.command_below * count
}

#[cfg(test)]
mod tests {
    use super::*;
    use alloc::{vec, vec::Vec};

    const fn threshold(risk_pct: Option<f64>, elevated_risk_pct: Option<f64>) -> Threshold {
        Threshold {
            risk_pct,
            elevated_risk_pct,
        }
    }

    const SETTINGS: VerdictSettings = VerdictSettings {
        warn: LevelSettings {
            raise: threshold(None, Some(50.0)),
            after_s: 0.5,
            until: threshold(None, Some(40.0)),
        },
        fail: LevelSettings {
            raise: threshold(Some(95.0), Some(80.0)),
            after_s: 0.5,
            until: threshold(Some(85.0), Some(70.0)),
        },
        clear_after_s: 2.0,
        quiet_after_take_off_s: 0.0,
        quiet_before_landing_s: 2.0,
        idle: Idle {
            command_below: 0.1,
            risk_at_most_pct: 60.0,
        },
    };

    /// An alert, and the motors it watched.
    #[derive(Clone)]
    struct Flown {
        alert: Alert,
        motors: [Motor; 2],
    }

    impl Flown {
        fn new(commands: [f64; 2]) -> Flown {
            Flown {
                alert: Alert::new(SETTINGS),
                motors: commands.map(|command| Motor {
                    command,
                    ..Motor::UNKNOWN
                }),
            }
        }

        fn end(&mut self, t_s: f64, landed: bool) -> Step {
            self.alert.end(t_s, landed, &self.motors)
        }
    }

    /// Runs (seconds, risk, elevated risk) at 10 Hz; gives what changed when, and the findings.
    fn run(phases: &[(f64, f64, f64)]) -> (Vec<(f64, Level)>, Vec<Finding>, Flown) {
        let mut flown = Flown::new([0.4, 0.95]);
        let (mut changes, mut findings, mut i) = (vec![], vec![], 0);
        for (seconds, risk, elevated) in phases {
            for _ in 0..(seconds * 10.0) as usize {
                let t_s = f64::from(i) / 10.0;
                let step = flown.alert.push(t_s, *risk, *elevated, &mut flown.motors);
                changes.extend(step.change.map(|level| (t_s, level)));
                findings.extend(step.ended.into_iter().flatten());
                i += 1;
            }
        }
        (changes, findings, flown)
    }

    #[test]
    fn a_spike_shorter_than_the_minimum_says_nothing() {
        let (changes, findings, flown) = run(&[
            (1.0, 0.0, 0.0),
            (0.4, 0.0, 60.0),
            (1.0, 0.0, 0.0),
            (0.4, 99.0, 0.0),
            (1.0, 0.0, 0.0),
        ]);
        assert_eq!((changes, findings), (vec![], vec![]));
        assert_eq!(flown.alert.level(), Level::Good);
    }

    #[test]
    fn one_episode_is_one_finding_of_each_level_whatever_its_ups_and_downs() {
        let (changes, findings, _) = run(&[
            (1.0, 0.0, 0.0),
            (2.0, 0.0, 60.0),
            // Held, then not held for less than clear_after_s.
            (5.0, 0.0, 45.0),
            (1.0, 0.0, 0.0),
            (1.0, 0.0, 90.0),
            (5.0, 0.0, 0.0),
        ]);
        assert_eq!(
            changes,
            [(1.5, Level::Warn), (9.5, Level::Fail), (11.9, Level::Good)]
        );
        let [warn, fail] = findings.as_slice() else {
            panic!("{findings:?}")
        };
        assert_eq!((warn.level, fail.level), (Level::Warn, Level::Fail));
        assert_eq!((warn.from_s, warn.raised_s, warn.to_s), (1.0, 1.5, 9.9));
        assert_eq!((fail.from_s, fail.raised_s, fail.to_s), (9.0, 9.5, 9.9));
        assert_eq!(fail.measure, Measure::ElevatedRisk);
        assert_eq!((fail.threshold_pct, fail.peak_pct), (80.0, 90.0));
        let motor = fail.motor.unwrap();
        assert_eq!((motor.motor, motor.side), (1, Side::High));
        approx::assert_abs_diff_eq!(motor.mean_margin, 0.05, epsilon = 1e-12);
    }

    #[test]
    fn either_quantity_is_enough() {
        let (changes, _, mut flown) = run(&[(2.0, 99.0, 0.0)]);
        assert_eq!(changes, [(0.5, Level::Fail)]);
        let [warn, fail] = flown.end(2.0, false).ended;
        assert_eq!(warn, None);
        assert_eq!(fail.map(|f| f.measure), Some(Measure::Risk));
    }

    #[test]
    fn a_risk_at_idle_counts_for_less() {
        for (e, level) in [
            (0.05, Level::Good),
            (0.15, Level::Fail),
            (f64::NAN, Level::Fail),
        ] {
            let Flown {
                mut alert,
                mut motors,
            } = Flown::new([e, e]);
            for i in 0..10 {
                alert.push(f64::from(i) / 10.0, 100.0, 0.0, &mut motors);
            }
            assert_eq!(alert.level(), level, "{e}");
        }
    }

    #[test]
    fn what_is_raised_just_before_landing_is_taken_back() {
        let (_, _, mut flown) = run(&[(2.0, 0.0, 90.0)]);
        let mut later = flown.clone();
        assert_eq!(flown.end(2.0, true).ended, [None; 2]);
        assert!(later.end(3.0, true).ended.iter().all(Option::is_some));
        // A link that is lost is no landing.
        let (_, _, mut flown) = run(&[(2.0, 0.0, 90.0)]);
        assert!(flown.end(2.0, false).ended.iter().all(Option::is_some));
    }

    #[test]
    fn falling_from_fail_to_warn_ends_the_one_finding_and_keeps_the_other_open() {
        let (changes, findings, mut flown) = run(&[(2.0, 0.0, 90.0), (4.0, 0.0, 60.0)]);
        assert_eq!(changes, [(0.5, Level::Fail), (3.9, Level::Warn)]);
        let levels: Vec<Level> = findings.iter().map(|f| f.level).collect();
        assert_eq!(levels, [Level::Fail]);
        let [warn, fail] = flown.end(6.0, false).ended;
        assert_eq!(warn.map(|f| f.to_s), Some(5.9));
        assert_eq!(fail, None);
    }
}
