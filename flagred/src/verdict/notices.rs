//! What is worth telling beside the risk: noise in the commands, little reserve of thrust, a motor that changed its part.
//!
//! Each is a moving average with a fixed time constant, so it needs no window.

use super::{Finding, Level, Limit, Measure, MotorFinding, NoticeSettings, alert::ROUNDING_S};
use crate::{
    average::Average,
    margin::{Side, margin},
    motor::Motor,
};

/// Time constants of the averages, in seconds.
const NOISE_S: f64 = 10.0;
const RESERVE_S: f64 = 3.0;
const IMBALANCE_S: f64 = 5.0;
const TRIM_S: f64 = 30.0;

/// For so long the trim is learned before anything is held against it, in seconds.
const TRIM_KNOWN_AFTER_S: f64 = 10.0;

/// Noise, reserve and imbalance of one flight.
#[derive(Debug, Clone)]
pub(crate) struct Notices {
    settings: NoticeSettings,
    since_s: Option<f64>,
    noise_squared: Average,
    reserve: Average,
    watches: [Watch; 3],
}

/// Since when a limit is passed, and the finding that is open.
#[derive(Debug, Clone, Copy)]
struct Watch {
    passed_since_s: Option<f64>,
    finding: Option<Finding>,
}

/// What is passed, and the motor it is about.
struct Passed {
    measure: Measure,
    /// The value and its limit, on the effective range.
    value: f64,
    limit: f64,
    motor: Option<MotorFinding>,
}

impl Notices {
    pub(crate) const fn new(settings: NoticeSettings) -> Notices {
        Notices {
            settings,
            since_s: None,
            noise_squared: Average::NONE,
            reserve: Average::NONE,
            watches: [Watch {
                passed_since_s: None,
                finding: None,
            }; 3],
        }
    }

    /// Takes in a sample of flight, of a time and the seconds before it that it stands for.
    pub(crate) fn push(&mut self, (t_s, held_s): (f64, f64), noise: f64, motors: &mut [Motor]) {
        let since_s = *self.since_s.get_or_insert(t_s);
        let commands = motors.iter().map(|motor| motor.command);
        let known = commands.filter(|e| e.is_finite());
        let (sum, count) = known.fold((0.0, 0.0), |(sum, count), e| (sum + e, count + 1.0));
        let mean = sum / count;
        // A noise is known once in 0.1 s or more.
        self.noise_squared
            .add(noise * noise, held_s.max(0.1), NOISE_S);
        self.reserve.add(1.0 - mean, held_s, RESERVE_S);

        let settings = self.settings;
        let plain = |measure, value, limit: Limit| Passed {
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
        let imbalance = settings.imbalance.and_then(|Limit { value, .. }| {
            let from_trim = from_trim(motors, mean, held_s, value);
            let is_known = t_s - since_s >= TRIM_KNOWN_AFTER_S;
            from_trim
                .filter(|_| is_known)
                .or_else(|| at_odds(motors, 2.0 * value))
        });
        self.watches[2].push(t_s, Level::Warn, settings.imbalance, imbalance);
    }

    /// Ends the flight: the open findings.
    pub(crate) fn end(&mut self) -> [Option<Finding>; 3] {
        let ended = self.watches.map(|watch| watch.finding);
        *self = Notices::new(self.settings);
        ended
    }

    /// The worst open finding but information.
    pub(crate) fn open(&self) -> Option<Finding> {
        let mut open = self.watches.iter().filter_map(|watch| watch.finding);
        open.rfind(|finding| finding.level > Level::Info)
    }
}

/// The motor that is farthest from its own trim, where it is beyond the limit. The trim is the motor's mean difference from
/// the mean of all; it stands still while a motor is half way to the limit.
fn from_trim(motors: &mut [Motor], mean: f64, held_s: f64, limit: f64) -> Option<Passed> {
    let mut farthest: Option<(usize, f64)> = None;
    for (i, motor) in motors.iter_mut().enumerate() {
        let difference = motor.less_yaw - mean;
        motor.difference.add(difference, held_s, IMBALANCE_S);
        let from_trim = motor.difference.value - motor.trim.value;
        if motor.trim.known_s < TRIM_KNOWN_AFTER_S || from_trim.abs() < limit / 2.0 {
            motor.trim.add(difference, held_s, TRIM_S);
        }
        if farthest.is_none_or(|(_, most)| from_trim.abs() > most.abs()) {
            farthest = Some((i, from_trim));
        }
    }
    let (motor, from_trim) = farthest?;
    Passed::by(motors, Measure::Imbalance, motor, from_trim, limit)
}

/// The motor that is farthest above the one opposite, where it is beyond the limit. A fault that was there before the trim
/// was learned shows only here.
fn at_odds(motors: &[Motor], limit: f64) -> Option<Passed> {
    let above = motors.iter().enumerate().filter_map(|(i, motor)| {
        let opposite = motors.get(motor.opposite as usize)?;
        let of = |motor: &Motor| motor.difference.known_after(IMBALANCE_S);
        Some((i, of(motor)? - of(opposite)?))
    });
    let (motor, above) = above.max_by(|(_, a), (_, b)| a.total_cmp(b))?;
    Passed::by(motors, Measure::PairImbalance, motor, above, limit)
}

impl Passed {
    /// A motor that is so much above or below where it should be, where that is beyond the limit.
    fn by(
        motors: &[Motor],
        measure: Measure,
        motor: usize,
        above: f64,
        limit: f64,
    ) -> Option<Passed> {
        let margin = margin(motors.get(motor)?.command);
        (above.abs() > limit).then_some(Passed {
            measure,
            value: above.abs(),
            limit,
            motor: Some(MotorFinding {
                motor,
                side: if above > 0.0 { Side::High } else { Side::Low },
                mean_margin: margin,
                least_margin: margin,
            }),
        })
    }
}

impl Watch {
    /// A finding that is open stays so until the flight ends, with what was passed first.
    fn push(&mut self, t_s: f64, level: Level, limit: Option<Limit>, passed: Option<Passed>) {
        let (Some(Limit { after_s, .. }), Some(passed)) = (limit, passed) else {
            self.passed_since_s = None;
            return;
        };
        let from_s = *self.passed_since_s.get_or_insert(t_s);
        let value_pct = 100.0 * passed.value;
        if let Some(finding) = &mut self.finding {
            finding.to_s = t_s;
            if finding.measure == passed.measure {
                finding.peak_pct = match passed.measure {
                    Measure::Reserve => finding.peak_pct.min(value_pct),
                    _ => finding.peak_pct.max(value_pct),
                };
            }
        } else if t_s - from_s >= after_s - ROUNDING_S {
            self.finding = Some(Finding {
                level,
                from_s,
                raised_s: t_s,
                to_s: t_s,
                measure: passed.measure,
                threshold_pct: 100.0 * passed.limit,
                peak_pct: value_pct,
                motor: passed.motor,
                ..Finding::NONE
            });
        }
    }
}
