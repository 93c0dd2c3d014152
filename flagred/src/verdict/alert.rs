//! The level over time: raised, held, lowered.

use super::{
    Ended, Finding, Idle, Level, VerdictSettings,
    watch::{Motor, Watch},
};

/// Sums of time steps are off by less than this.
pub(super) const ROUNDING_S: f64 = 1e-6;

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
            .find(|watch| watch.level() == self.level)?;
        watch.open(motors)
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
                held = watch.level().min(self.level);
            }
        }
        if held >= self.level {
            self.last_held_s = t_s;
        } else if t_s - self.last_held_s >= settings.clear_after_s - ROUNDING_S {
            self.level = held;
            self.last_held_s = t_s;
            step.change = Some(held);
            step.ended = self.watches.each_mut().map(|watch| {
                let is_over = watch.level() > held;
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
            let finding = watch.stop(motors);
            finding.filter(|finding| !landed || t_s - finding.raised_s >= quiet_s)
        });
        Step { change, ended }
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
    use crate::{
        margin::Side,
        verdict::{LevelSettings, Measure, Threshold},
    };
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
                motors: commands.map(Motor::at),
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
