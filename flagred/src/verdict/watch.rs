//! One level: since when it is reached, the finding that is open, and the motors meanwhile.

use alloc::{vec, vec::Vec};

use super::{Finding, Level, Measure, MotorFinding, alert::ROUNDING_S};
use crate::margin::{Side, margin};

/// What is known of one level.
#[derive(Debug, Clone)]
pub(super) struct Watch {
    level: Level,
    /// Since when the level is reached.
    reached_since_s: Option<f64>,
    finding: Option<Finding>,
    /// The motors while the level was reached, since it was first.
    motors: Vec<MotorRecord>,
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
    pub(super) fn new(level: Level, motors: usize) -> Watch {
        Watch {
            level,
            reached_since_s: None,
            finding: None,
            motors: vec![NO_RECORD; motors],
        }
    }

    pub(super) fn level(&self) -> Level {
        self.level
    }

    /// The finding as it stands; `None` while the level is not raised.
    pub(super) fn open(&self) -> Option<Finding> {
        let motor = self.weakest_motor();
        self.finding.map(|finding| Finding { motor, ..finding })
    }

    /// Takes in whether the level is reached, by what and over which threshold; gives the level where that raises it.
    pub(super) fn push(
        &mut self,
        t_s: f64,
        reached: Option<(Measure, f64)>,
        after_s: f64,
        now: Level,
        motors: &[f64],
    ) -> Option<Level> {
        let Some((measure, threshold_pct)) = reached else {
            self.reached_since_s = None;
            return None;
        };
        if self.reached_since_s.is_none() && self.finding.is_none() {
            self.motors.fill(NO_RECORD);
        }
        let from_s = *self.reached_since_s.get_or_insert(t_s);
        for (record, e) in self.motors.iter_mut().zip(motors) {
            record.add(*e);
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
    pub(super) fn end(&mut self) -> Option<Finding> {
        let ended = self.open();
        self.finding = None;
        ended
    }

    /// Ends the finding and forgets since when the level is reached.
    pub(super) fn stop(&mut self) -> Option<Finding> {
        self.reached_since_s = None;
        self.end()
    }

    fn weakest_motor(&self) -> Option<MotorFinding> {
        let known = self
            .motors
            .iter()
            .enumerate()
            .filter(|(_, r)| r.samples > 0);
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
