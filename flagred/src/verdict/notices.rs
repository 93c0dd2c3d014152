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

/// What is passed: the value in %, its limit, and the motor it is about.
struct Passed {
    value_pct: f64,
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
        let above = |value: f64, limit: Limit| value > limit.value;
        let noise = self.noise_squared.known_after(NOISE_S).map(libm::sqrt);
        let noise = noise.zip(settings.noise);
        let passed = noise.filter(|(v, limit)| above(*v, *limit)).map(plain);
        self.watches[0].push(
            t_s,
            (Level::Info, Measure::CommandNoise),
            settings.noise,
            passed,
        );
        let reserve = self.reserve.known_after(RESERVE_S).zip(settings.reserve);
        let passed = reserve.filter(|(v, limit)| *v < limit.value).map(plain);
        self.watches[1].push(
            t_s,
            (Level::Warn, Measure::Reserve),
            settings.reserve,
            passed,
        );
        let imbalance = imbalance(motors, mean, held_s, settings.imbalance);
        let is_known = t_s - since_s >= TRIM_KNOWN_AFTER_S;
        let passed = imbalance.filter(|_| is_known);
        self.watches[2].push(
            t_s,
            (Level::Warn, Measure::Imbalance),
            settings.imbalance,
            passed,
        );
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

fn plain((value, _): (f64, Limit)) -> Passed {
    Passed {
        value_pct: 100.0 * value,
        motor: None,
    }
}

/// The motor that is farthest from its own trim, where it is beyond the limit. The trim is the motor's mean difference from
/// the mean of all; it stands still while a motor is half way to the limit.
fn imbalance(motors: &mut [Motor], mean: f64, held_s: f64, limit: Option<Limit>) -> Option<Passed> {
    let limit = limit?;
    let mut farthest: Option<(usize, f64)> = None;
    for (i, motor) in motors.iter_mut().enumerate() {
        let difference = motor.less_yaw - mean;
        motor.difference.add(difference, held_s, IMBALANCE_S);
        let from_trim = motor.difference.value - motor.trim.value;
        if motor.trim.known_s < TRIM_KNOWN_AFTER_S || from_trim.abs() < limit.value / 2.0 {
            motor.trim.add(difference, held_s, TRIM_S);
        }
        if farthest.is_none_or(|(_, most)| from_trim.abs() > most.abs()) {
            farthest = Some((i, from_trim));
        }
    }
    let (motor, from_trim) = farthest.filter(|(_, most)| most.abs() > limit.value)?;
    let margin = margin(motors.get(motor)?.command);
    Some(Passed {
        value_pct: 100.0 * from_trim.abs(),
        motor: Some(MotorFinding {
            motor,
            side: if from_trim > 0.0 {
                Side::High
            } else {
                Side::Low
            },
            mean_margin: margin,
            least_margin: margin,
        }),
    })
}

impl Watch {
    /// A finding that is open stays so until the flight ends.
    fn push(
        &mut self,
        t_s: f64,
        (level, measure): (Level, Measure),
        limit: Option<Limit>,
        passed: Option<Passed>,
    ) {
        let (Some(limit), Some(Passed { value_pct, motor })) = (limit, passed) else {
            self.passed_since_s = None;
            return;
        };
        let from_s = *self.passed_since_s.get_or_insert(t_s);
        if let Some(finding) = &mut self.finding {
            finding.to_s = t_s;
            finding.peak_pct = match measure {
                Measure::Reserve => finding.peak_pct.min(value_pct),
                _ => finding.peak_pct.max(value_pct),
            };
        } else if t_s - from_s >= limit.after_s - ROUNDING_S {
            self.finding = Some(Finding {
                level,
                from_s,
                raised_s: t_s,
                to_s: t_s,
                measure,
                threshold_pct: 100.0 * limit.value,
                peak_pct: value_pct,
                motor,
                ..Finding::NONE
            });
        }
    }
}
