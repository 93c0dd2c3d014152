//! One level: since when it is reached, the finding that is open, and the motors meanwhile.

use super::{Finding, Level, Measure, MotorFinding, alert::ROUNDING_S};
use crate::margin::{Side, margin};

/// What is known of one level.
#[derive(Debug, Clone)]
pub(super) struct Watch {
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

    /// A motor at an effective command.
    #[cfg(test)]
    pub(super) fn at(command: f64) -> Motor {
        Motor {
            command,
            ..Motor::UNKNOWN
        }
    }

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

const NO_RECORD: MotorRecord = MotorRecord {
    samples: 0,
    mean_margin: 0.0,
    least_margin: f64::INFINITY,
    side: Side::High,
};

impl Watch {
    pub(super) const fn of(level: Level) -> Watch {
        Watch {
            level,
            reached_since_s: None,
            finding: None,
        }
    }

    pub(super) fn level(&self) -> Level {
        self.level
    }

    /// The finding as it stands; `None` while the level is not raised.
    pub(super) fn open(&self, motors: &[Motor]) -> Option<Finding> {
        let motor = self.weakest_motor(motors);
        self.finding.map(|finding| Finding { motor, ..finding })
    }

    /// Which of a motor's records is this level's.
    fn record(&self) -> usize {
        usize::from(self.level == Level::Fail)
    }

    /// Takes in whether the level is reached, by what and over which threshold; gives the level where that raises it.
    pub(super) fn push(
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
    pub(super) fn follow(&mut self, t_s: f64, risk_pct: f64, elevated_pct: f64, reached: bool) {
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

    /// Ends the finding; the level may still be reached.
    pub(super) fn end(&mut self, motors: &[Motor]) -> Option<Finding> {
        let ended = self.open(motors);
        self.finding = None;
        ended
    }

    /// Ends the finding and forgets since when the level is reached.
    pub(super) fn stop(&mut self, motors: &[Motor]) -> Option<Finding> {
        self.reached_since_s = None;
        self.end(motors)
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
