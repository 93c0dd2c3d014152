//! The level over time, and its findings: each period of trouble is reported once.

use super::{Cause, Finding, Level, Measure, MotorFinding, VerdictSettings};
use crate::motor::{Motor, MotorRecord};

/// The tolerance for durations, in seconds, because timestamps are sums of steps.
pub(crate) const ROUNDING_S: f64 = 1e-6;

/// Raises and clears the level of a risk over time.
#[derive(Debug, Clone)]
pub(crate) struct Alert {
    settings: VerdictSettings,
    level: Level,
    /// The last time at which the level was held, in seconds.
    last_held_s: f64,
    /// The times since which the thresholds of WARN and FAIL have been reached, in seconds.
    reached_since_s: [Option<f64>; 2],
    /// The time since which any threshold has been reached, in seconds.
    begun_s: Option<f64>,
    /// The highest risk and elevated risk, in %, during the open finding, or else since [`Alert::begun_s`].
    highest_pct: [f64; 2],
    finding: Option<Finding>,
    /// Whether the level of the finding was raised but its cause is not set yet.
    needs_cause: bool,
}

/// The margin above which a motor cannot be the cause.
const NEAR_LIMIT: f64 = 0.1;

/// The changes that a sample causes.
#[derive(Debug, Clone, Copy, Default)]
pub(crate) struct Step {
    pub(crate) change: Option<Level>,
    pub(crate) ended: Option<Finding>,
}

/// The risk at a time.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Now {
    pub(crate) t_s: f64,
    pub(crate) risk_pct: f64,
    pub(crate) elevated_pct: f64,
    /// Whether the take-off was so recent that only FAIL is raised.
    pub(crate) takes_off: bool,
    /// Whether all motors slow down together, as at touch-down; then FAIL is not raised.
    pub(crate) slow_down_together: bool,
    /// Whether the vehicle counts as falling, because its motors idle in the air.
    pub(crate) falls: bool,
}

impl Alert {
    pub(crate) const fn new(settings: VerdictSettings) -> Alert {
        Alert {
            settings,
            level: Level::Good,
            last_held_s: 0.0,
            reached_since_s: [None; 2],
            begun_s: None,
            highest_pct: [f64::NEG_INFINITY; 2],
            finding: None,
            needs_cause: false,
        }
    }

    pub(crate) fn level(&self) -> Level {
        self.level
    }

    /// The open finding, with its values so far.
    pub(crate) fn open(&self) -> Option<Finding> {
        self.finding
    }

    /// The beginning (in seconds) and the highest risk (in %) of the open finding, or of the finding that will be
    /// opened if a threshold stays reached.
    #[cfg(feature = "std")]
    pub(crate) fn peak(&self) -> Option<(f64, f64)> {
        let opened_s = self.finding.map(|finding| finding.from_s);
        Some((opened_s.or(self.begun_s)?, self.highest_pct[0]))
    }

    /// Whether the latest sample raised the level of the finding, so that its cause must be set by [`Alert::explain`].
    pub(crate) fn needs_cause(&self) -> bool {
        self.needs_cause
    }

    /// Sets the cause of the finding; a motor is named only if motors near a limit are the cause.
    pub(crate) fn explain(&mut self, cause: Option<Cause>, is_of_limits: impl Fn(usize) -> bool) {
        self.needs_cause = false;
        if let Some(finding) = &mut self.finding {
            finding.cause = cause;
            finding.motor = finding.motor.filter(|found| is_of_limits(found.number - 1));
        }
    }

    pub(crate) fn push(&mut self, now: Now, motors: &mut [Motor]) -> Step {
        let Now {
            t_s,
            risk_pct,
            elevated_pct,
            takes_off,
            slow_down_together,
            falls,
        } = now;
        let mut step = Step::default();
        let mut held = Level::Good;
        self.needs_cause = false;
        let levels = [
            (Level::Warn, self.settings.warn),
            (Level::Fail, self.settings.fail),
        ];
        let reached = levels.map(|(level, settings)| {
            match if level == Level::Warn {
                takes_off
            } else {
                slow_down_together
            } {
                true => None,
                false => settings.raise.reached(risk_pct, elevated_pct),
            }
        });
        let is_reached = reached.map(|reached| reached.is_some());
        self.record(&is_reached, motors);
        self.keep_highest(t_s, is_reached.contains(&true), [risk_pct, elevated_pct]);
        for (i, (level, settings)) in levels.into_iter().enumerate() {
            if reached[i].is_some() || settings.until.reached(risk_pct, elevated_pct).is_some() {
                held = level.min(self.level);
            }
            let Some((measure, threshold_pct)) = reached[i] else {
                self.reached_since_s[i] = None;
                continue;
            };
            let measure = match falls {
                true => Measure::IdleInAir,
                false => measure,
            };
            if let Some(finding) = &mut self.finding {
                finding.to_s = t_s;
            }
            let since_s = *self.reached_since_s[i].get_or_insert(t_s);
            if level > self.level && t_s - since_s >= settings.after_s - ROUNDING_S {
                self.raise(t_s, level, (measure, threshold_pct), motors);
                step.change = Some(level);
                held = level;
            }
        }
        if let Some(finding) = &mut self.finding {
            let [risk_pct, elevated_pct] = self.highest_pct;
            finding.value_pct = match finding.measure {
                Measure::ElevatedRisk => elevated_pct,
                _ => risk_pct,
            };
        }
        if held >= self.level {
            self.last_held_s = t_s;
        } else if t_s - self.last_held_s >= self.settings.clear_after_s - ROUNDING_S {
            self.level = held;
            self.last_held_s = t_s;
            step.change = Some(held);
            if held == Level::Good {
                step.ended = self.end_finding();
            }
        }
        step
    }

    /// Records the margins of the motors, starting over whenever a level is first reached. The motor of a finding is
    /// thus chosen from the period that raised the level; earlier and later margins are ignored.
    fn record(&self, reached: &[bool; 2], motors: &mut [Motor]) {
        let begins = |i: usize| reached[i] && self.reached_since_s[i].is_none();
        let (begins, any) = (begins(0) || begins(1), reached[0] || reached[1]);
        for motor in motors.iter_mut().filter(|_| any) {
            if begins {
                motor.record = MotorRecord::NONE;
            }
            motor.record.add(motor.command);
        }
    }

    /// Keeps the highest values of the open finding, or of the time in which a threshold has been reached without a
    /// break.
    fn keep_highest(&mut self, t_s: f64, is_reached: bool, values_pct: [f64; 2]) {
        let begins = is_reached && self.begun_s.is_none();
        self.begun_s = self.begun_s.or(Some(t_s)).filter(|_| is_reached);
        for (highest, value) in self.highest_pct.iter_mut().zip(values_pct) {
            *highest = match begins && self.finding.is_none() {
                true => value,
                false => highest.max(value),
            };
        }
    }

    /// Opens the finding, or raises it to FAIL.
    fn raise(&mut self, t_s: f64, level: Level, by: (Measure, f64), motors: &[Motor]) {
        self.level = level;
        let (measure, threshold_pct) = by;
        let failed_s = (level == Level::Fail).then_some(t_s);
        let opened = self.finding.unwrap_or(Finding {
            from_s: self.begun_s.unwrap_or(t_s),
            raised_s: t_s,
            ..Finding::NONE
        });
        // After an earlier FAIL, the finding keeps the time of that FAIL.
        let failed_s = opened.failed_s.or(failed_s);
        let same = opened.severity == level;
        let is_worse = level > opened.severity;
        self.needs_cause = is_worse;
        self.finding = Some(Finding {
            severity: level.max(opened.severity),
            failed_s,
            to_s: t_s,
            measure: if same { opened.measure } else { measure },
            threshold_pct: if same {
                opened.threshold_pct
            } else {
                threshold_pct
            },
            motor: if is_worse {
                weakest(motors)
            } else {
                opened.motor
            },
            ..opened
        });
    }

    /// Ends the flight, or the observed part of it. A landing withdraws a WARN that was raised just before it, unless
    /// FAIL is being reached: the end then does not count as a landing.
    pub(crate) fn end(&mut self, t_s: f64, landed: bool) -> Step {
        let change = (self.level > Level::Good).then_some(Level::Good);
        self.level = Level::Good;
        let [_, reaches_fail] = self.reached_since_s.map(|since_s| since_s.is_some());
        self.reached_since_s = [None; 2];
        self.begun_s = None;
        let quiet_s = self.settings.quiet_before_landing_s;
        let is_landing = |finding: &Finding| {
            landed
                && !reaches_fail
                && finding.severity < Level::Fail
                && t_s - finding.raised_s < quiet_s
        };
        let ended = self.end_finding().filter(|finding| !is_landing(finding));
        Step { change, ended }
    }

    fn end_finding(&mut self) -> Option<Finding> {
        self.needs_cause = false;
        self.finding.take()
    }
}

/// The motor with the least mean margin while the level was being reached, if it is near a limit. When a motor stops,
/// the opposite one soon stops too, so of several motors at zero the one that has been at zero longest is chosen.
fn weakest(motors: &[Motor]) -> Option<MotorFinding> {
    let known = motors
        .iter()
        .enumerate()
        .filter(|(_, m)| m.record.samples > 0);
    let (motor, Motor { record, .. }) = known.min_by(|(_, a), (_, b)| {
        let margins = a.record.margin_mean.total_cmp(&b.record.margin_mean);
        let both_stopped = a.at_zero_s > 0.0 && b.at_zero_s > 0.0;
        match both_stopped {
            true => margins.then(b.at_zero_s.total_cmp(&a.at_zero_s)),
            false => margins,
        }
    })?;
    (record.margin_min < NEAR_LIMIT).then_some(MotorFinding {
        number: motor + 1,
        or_number: None,
        side: record.side,
        margin_mean: record.margin_mean,
        margin_min: record.margin_min,
    })
}

state! {
    struct Alert {
        settings, level, last_held_s, reached_since_s, begun_s, highest_pct, finding, needs_cause
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{
        margin::Side,
        verdict::{LevelSettings, Threshold},
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
        ..VerdictSettings::DEFAULT
    };

    #[derive(Clone)]
    struct SimulatedFlight {
        alert: Alert,
        motors: [Motor; 2],
    }

    impl SimulatedFlight {
        fn new(commands: [f64; 2]) -> SimulatedFlight {
            SimulatedFlight {
                alert: Alert::new(SETTINGS),
                motors: commands.map(Motor::at),
            }
        }

        fn push(&mut self, t_s: f64, risk_pct: f64, elevated_pct: f64) -> Step {
            let now = Now {
                t_s,
                risk_pct,
                elevated_pct,
                takes_off: false,
                slow_down_together: false,
                falls: false,
            };
            self.alert.push(now, &mut self.motors)
        }

        fn end(&mut self, t_s: f64, landed: bool) -> Step {
            self.alert.end(t_s, landed)
        }
    }

    /// Runs phases of (seconds, risk, elevated risk) at 10 Hz, with a motor near its upper limit.
    fn run(phases: &[(f64, f64, f64)]) -> (Vec<(f64, Level)>, Vec<Finding>, SimulatedFlight) {
        let mut flown = SimulatedFlight::new([0.4, 0.95]);
        let (mut changes, mut findings, mut i) = (vec![], vec![], 0);
        for (seconds, risk, elevated) in phases {
            for _ in 0..(seconds * 10.0) as usize {
                let t_s = f64::from(i) / 10.0;
                let step = flown.push(t_s, *risk, *elevated);
                changes.extend(step.change.map(|level| (t_s, level)));
                findings.extend(step.ended);
                i += 1;
            }
        }
        (changes, findings, flown)
    }

    #[test]
    fn of_two_motors_at_zero_the_one_that_stopped_first_is_named() {
        let mut flown = SimulatedFlight::new([0.0, 0.0]);
        // If `at_zero_s` is 0, the motor is at its upper limit instead, with the same margin.
        for (at_zero_s, named) in [
            ([0.1, 0.3], 2),
            ([0.3, 0.1], 1),
            ([0.2, 0.2], 1),
            ([0.0, 0.3], 1),
        ] {
            for (motor, at_zero_s) in flown.motors.iter_mut().zip(at_zero_s) {
                motor.at_zero_s = at_zero_s;
                motor.record.add(0.0);
            }
            assert_eq!(weakest(&flown.motors).unwrap().number, named);
        }
    }

    #[test]
    fn a_spike_shorter_than_the_minimum_raises_no_level() {
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
    fn one_episode_is_one_finding_of_its_worst_level() {
        let (changes, findings, _) = run(&[
            (1.0, 0.0, 0.0),
            (2.0, 0.0, 60.0),
            // The risk holds the level for 5 s, and is then too low for less than `clear_after_s`.
            (5.0, 0.0, 45.0),
            (1.0, 0.0, 0.0),
            (1.0, 0.0, 90.0),
            (5.0, 0.0, 0.0),
        ]);
        assert_eq!(
            changes,
            [(1.5, Level::Warn), (9.5, Level::Fail), (11.9, Level::Good)]
        );
        let [finding] = findings.as_slice() else {
            panic!("{findings:?}")
        };
        assert_eq!(finding.severity, Level::Fail);
        assert_eq!(
            (finding.from_s, finding.raised_s, finding.failed_s),
            (1.0, 1.5, Some(9.5))
        );
        assert_eq!(finding.to_s, 9.9);
        assert_eq!(finding.measure, Measure::ElevatedRisk);
        assert_eq!((finding.threshold_pct, finding.value_pct), (80.0, 90.0));
        let motor = finding.motor.unwrap();
        assert_eq!((motor.number, motor.side), (2, Side::Upper));
        approx::assert_abs_diff_eq!(motor.margin_mean, 0.05, epsilon = 1e-12);
    }

    /// The risk is highest before the level is raised.
    #[test]
    fn a_finding_has_the_highest_value_of_its_whole_time() {
        let (_, _, mut flown) = run(&[(1.0, 0.0, 0.0), (0.3, 99.0, 0.0), (1.0, 96.0, 0.0)]);
        let finding = flown.end(2.3, false).ended.unwrap();
        assert_eq!((finding.from_s, finding.raised_s), (1.0, 1.5));
        assert_eq!(finding.value_pct, 99.0);
        // A level that was reached before the finding, but too briefly to be raised, does not count, and neither do the
        // values at that time.
        let (_, findings, _) = run(&[
            (0.3, 100.0, 0.0),
            (1.0, 0.0, 0.0),
            (1.0, 96.0, 0.0),
            (5.0, 0.0, 0.0),
        ]);
        assert_eq!((findings[0].from_s, findings[0].value_pct), (1.3, 96.0));
        // The finding begins when WARN is reached, although FAIL is raised first.
        let mut settings = SETTINGS;
        settings.warn.after_s = 5.0;
        let mut flown = SimulatedFlight::new([0.4, 0.95]);
        flown.alert = Alert::new(settings);
        for (t_s, risk_pct) in [(0.0, 98.0), (0.2, 0.0), (0.4, 96.0), (0.9, 96.0)] {
            flown.push(t_s, risk_pct, 60.0);
        }
        let finding = flown.end(0.9, false).ended.unwrap();
        assert_eq!((finding.from_s, finding.raised_s), (0.0, 0.9));
        assert_eq!((finding.measure, finding.value_pct), (Measure::Risk, 98.0));
    }

    #[test]
    fn either_quantity_raises_a_level() {
        let (changes, _, mut flown) = run(&[(2.0, 99.0, 0.0)]);
        assert_eq!(changes, [(0.5, Level::Fail)]);
        let finding = flown.end(2.0, false).ended.unwrap();
        assert_eq!(
            (finding.severity, finding.measure),
            (Level::Fail, Measure::Risk)
        );
    }

    #[test]
    fn just_after_take_off_only_fail_is_raised() {
        for (risk_pct, elevated_pct, level) in [(0.0, 60.0, Level::Good), (99.0, 60.0, Level::Fail)]
        {
            let mut flown = SimulatedFlight::new([0.4, 0.95]);
            for i in 0..20 {
                let now = Now {
                    t_s: f64::from(i) / 10.0,
                    risk_pct,
                    elevated_pct,
                    takes_off: true,
                    slow_down_together: false,
                    falls: false,
                };
                flown.alert.push(now, &mut flown.motors);
            }
            assert_eq!(flown.alert.level(), level);
        }
    }

    #[test]
    fn a_landing_cancels_a_warn_raised_just_before_it() {
        // The WARN is raised at 0.5 s and can be withdrawn for 2 s.
        let (_, _, mut flown) = run(&[(1.0, 0.0, 60.0)]);
        let mut later = flown.clone();
        assert_eq!(flown.end(2.4, true).ended, None);
        assert!(later.end(2.6, true).ended.is_some());
        // A landing cancels neither a FAIL nor a WARN during which FAIL is being reached.
        for steps in [
            &[(1.0, 0.0, 90.0)][..],
            &[(1.0, 0.0, 60.0), (0.3, 0.0, 90.0)],
        ] {
            let (_, _, mut flown) = run(steps);
            assert!(flown.end(1.4, true).ended.is_some());
        }
        // A lost link is not a landing.
        let (_, _, mut flown) = run(&[(2.0, 0.0, 90.0)]);
        assert!(flown.end(2.0, false).ended.is_some());
    }

    /// Motor 2 at its upper limit raises the level; afterwards motor 1 is at its lower limit for a long time.
    #[test]
    fn the_motor_is_determined_when_the_level_is_raised() {
        let mut flown = SimulatedFlight::new([0.4, 0.95]);
        for i in 0..300 {
            if i == 60 {
                flown.motors = [0.0, 0.5].map(Motor::at);
            }
            flown.push(f64::from(i) / 10.0, 0.0, if i < 50 { 0.0 } else { 90.0 });
        }
        let motor = flown.end(30.0, false).ended.unwrap().motor.unwrap();
        assert_eq!((motor.number, motor.side), (2, Side::Upper));
        approx::assert_abs_diff_eq!(motor.margin_min, 0.05, epsilon = 1e-12);
    }

    #[test]
    fn a_motor_far_from_its_limits_is_not_named() {
        for (command, is_named) in [(0.85, false), (0.95, true), (0.05, true), (0.17, false)] {
            let mut flown = SimulatedFlight::new([0.5, command]);
            for i in 0..20 {
                flown.push(f64::from(i) / 10.0, 99.0, 0.0);
            }
            let finding = flown.end(2.0, false).ended.unwrap();
            assert_eq!(finding.motor.is_some(), is_named, "{command}");
        }
    }

    #[test]
    fn a_fail_that_becomes_a_warn_stays_one_finding() {
        let (changes, findings, mut flown) = run(&[(2.0, 0.0, 90.0), (4.0, 0.0, 60.0)]);
        assert_eq!(changes, [(0.5, Level::Fail), (3.9, Level::Warn)]);
        assert_eq!(findings, []);
        let finding = flown.end(6.0, false).ended.unwrap();
        assert_eq!((finding.severity, finding.to_s), (Level::Fail, 5.9));
    }
}
