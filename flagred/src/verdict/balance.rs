//! The balance of the motors: detects a motor that works harder than before, and whether all motors work as before.
//!
//! A motor that loses thrust is commanded higher until the vehicle is level again. Its own command rises most if the
//! yaw part is included: this part distinguishes it from the opposite motor and from the other motor of its arm.

use super::{Limit, Measure, MotorFinding};
use crate::{
    average::Average,
    margin::{Side, margin},
    motor::{Motor, less_yaw},
};

/// The time constant of the recent difference of a motor from the mean, in seconds.
const LATELY_S: f64 = 5.0;
/// The time constant of the trims, in seconds.
const TRIM_S: f64 = 30.0;
/// The time constant of the mean command, in seconds.
const LOAD_S: f64 = 3.0;

/// The time for which the trim is learned before anything is compared with it, in seconds.
const TRIM_KNOWN_AFTER_S: f64 = 10.0;

/// The minimum share of all shifts that one weak motor must explain. If the vehicle leans towards a motor, the share of
/// that motor is 2/3.
const ONE_MOTOR: f64 = 0.75;

/// Shifts that differ by less than this count as equal.
const EQUAL_TOLERANCE: f64 = 0.02;

/// If the spread between the motors exceeds the spread during the last seconds by at least this, the motors do not slow
/// down together.
const MAX_SPREAD_INCREASE: f64 = 0.05;

/// The balance of one flight. The averages of each motor are in [`Motor`].
#[derive(Debug, Clone)]
pub(super) struct Balance {
    load: Average,
    has_recovered: bool,
    slow_down_together: bool,
}

/// A motor that is out of balance.
pub(super) struct UnbalancedMotor {
    pub(super) measure: Measure,
    /// The deviation, on the effective range.
    pub(super) value: f64,
    pub(super) limit: f64,
    pub(super) motor: MotorFinding,
}

/// The results for one sample.
#[derive(Default)]
pub(super) struct BalanceFindings {
    pub(super) weak: Option<UnbalancedMotor>,
    pub(super) imbalance: Option<UnbalancedMotor>,
}

impl Balance {
    pub(super) const NONE: Balance = Balance {
        load: Average::NONE,
        has_recovered: false,
        slow_down_together: false,
    };

    /// Whether all motors work as they did before the alarm or, if no trim had been learned by then, work equally hard.
    pub(super) fn has_recovered(&self) -> bool {
        self.has_recovered
    }

    /// Whether all motors slow down together, as they do at touch-down.
    pub(super) fn slow_down_together(&self) -> bool {
        self.slow_down_together
    }

    /// Processes a sample in which all commands are known. Trims are learned only while there is no alarm.
    pub(super) fn push(
        &mut self,
        motors: &mut [Motor],
        held_s: f64,
        limit: Limit,
        is_calm: bool,
    ) -> BalanceFindings {
        let limit = limit.value;
        let mean = motors.iter().map(|m| m.command).sum::<f64>() / motors.len() as f64;
        let load = self.load.known_after(LOAD_S);
        self.slow_down_together = load.is_some_and(|load| mean < load / 2.0) && is_together(motors);
        if !mean.is_finite() {
            return BalanceFindings::default();
        }
        self.load.add(mean, held_s, LOAD_S);
        for motor in motors.iter_mut() {
            motor.difference.add(motor.command - mean, held_s, LATELY_S);
            let is_at_zero = motor.command <= 0.0;
            motor.at_zero_s = if is_at_zero {
                motor.at_zero_s + held_s
            } else {
                0.0
            };
        }
        let is_settled = is_settled(motors);
        let has_trim = motors.iter().all(|m| m.trim.known_s >= TRIM_KNOWN_AFTER_S);
        let is_near = |motors: &[Motor]| motors.iter().all(|m| m.shift().abs() < limit / 2.0);
        if is_calm && (!has_trim || is_settled && is_near(motors)) {
            for motor in motors.iter_mut() {
                motor.trim.add(motor.command - mean, held_s, TRIM_S);
            }
        }
        let is_known = has_trim && is_settled;
        let is_alike = motors.iter().all(|m| m.difference.value.abs() < limit);
        self.has_recovered = is_settled && if has_trim { is_near(motors) } else { is_alike };
        let weak = weak(motors, limit / 2.0).filter(|_| is_known);
        let imbalance = match &weak {
            Some(_) => None,
            None => from_trim(motors, limit)
                .filter(|_| is_known)
                .or_else(|| unbalanced_motor(motors, 2.0 * limit)),
        };
        BalanceFindings { weak, imbalance }
    }
}

/// Whether the motors differ from each other no more than they did in the last seconds. In a fall they differ more.
pub(super) fn is_together(motors: &[Motor]) -> bool {
    let count = motors.len() as f64;
    let mean = motors.iter().map(|m| m.command).sum::<f64>() / count;
    let spread = |value: &dyn Fn(&Motor) -> f64| {
        let squares = motors.iter().map(|motor| value(motor) * value(motor));
        libm::sqrt(squares.sum::<f64>() / count)
    };
    let now = spread(&|motor| motor.command - mean);
    let lately = spread(&|motor| motor.difference.value);
    let is_apart = now >= lately + MAX_SPREAD_INCREASE;
    !is_settled(motors) || !is_apart
}

/// Whether the recent difference of every motor is averaged over at least [`LATELY_S`].
fn is_settled(motors: &[Motor]) -> bool {
    motors.iter().all(|m| m.difference.known_s >= LATELY_S)
}

/// The motor that is above its trim, if that explains the shifts of all motors: by the mixer, a motor `i` that loses
/// thrust shifts the commands by column `i` of the projection onto roll, pitch, yaw and thrust.
fn weak(motors: &[Motor], limit: f64) -> Option<UnbalancedMotor> {
    let (motor, shift) = highest(motors, Motor::shift, None)?;
    let count = motors.len() as f64;
    let own = (count - 1.0).min(3.0) / count;
    let all: f64 = motors.iter().map(|m| m.shift() * m.shift()).sum();
    let explains = shift * shift >= ONE_MOTOR * own * all;
    (shift > limit && explains).then(|| {
        // On a coaxial arm, the command of the other motor may rise nearly as much. Then both motors are named.
        let next = highest(motors, Motor::shift, Some(motor));
        let other = next.filter(|(_, next)| !is_ahead(shift, *next));
        UnbalancedMotor {
            measure: Measure::WeakMotor,
            value: shift,
            limit,
            motor: named(motors, motor, Side::Upper, other.map(|(other, _)| other)),
        }
    })
}

/// The motor that is out of balance, if the command of a motor, without its yaw part, deviates from the trim by more
/// than the limit.
fn from_trim(motors: &[Motor], limit: f64) -> Option<UnbalancedMotor> {
    let farthest = less_yaw(motors, Motor::shift).fold(0.0, |most: f64, x| most.max(x.abs()));
    let motor = responsible_motor(motors, Motor::shift)?;
    (farthest > limit).then_some(UnbalancedMotor {
        measure: Measure::Imbalance,
        value: farthest,
        limit,
        motor,
    })
}

/// A motor whose command exceeds that of the opposite one by more than the limit. Only this check detects a fault that was
/// present before the trim was learned.
fn unbalanced_motor(motors: &[Motor], limit: f64) -> Option<UnbalancedMotor> {
    let lately = |motor: &Motor| motor.difference.value;
    let above = less_yaw(motors, lately)
        .zip(motors)
        .filter_map(|(own, motor)| {
            let opposite = less_yaw(motors, lately).nth(motor.opposite as usize)?;
            Some(own - opposite)
        });
    let farthest = above.fold(0.0, f64::max);
    let motor = responsible_motor(motors, lately)?;
    (farthest > limit && is_settled(motors)).then_some(UnbalancedMotor {
        measure: Measure::PairImbalance,
        value: farthest,
        limit,
        motor,
    })
}

/// Returns the motor that gives too little thrust: the motor with the largest value if it is clearly above all
/// others; otherwise the motor that stopped first, or the one with the largest value if none stopped. Two motors are
/// returned if they cannot be distinguished.
fn responsible_motor(
    motors: &[Motor],
    value: impl Fn(&Motor) -> f64 + Copy,
) -> Option<MotorFinding> {
    let (highest_one, most) = highest(motors, value, None)?;
    let next = highest(motors, value, Some(highest_one));
    let is_alone = next.is_none_or(|(_, next)| is_ahead(most, next));
    let at_zero = |motor: &Motor| motor.at_zero_s;
    let stopped = highest(motors, at_zero, None).filter(|(_, at_zero_s)| *at_zero_s > 0.0);
    if let (false, Some((first, at_zero_s))) = (is_alone, stopped) {
        let other = highest(motors, at_zero, Some(first));
        let other = other.filter(|(_, other_s)| *other_s >= at_zero_s);
        return Some(named(
            motors,
            first,
            Side::Lower,
            other.map(|(other, _)| other),
        ));
    }
    let other = next.filter(|(_, next)| most - next < EQUAL_TOLERANCE);
    let other = other.map(|(other, _)| other);
    Some(named(motors, highest_one, Side::Upper, other))
}

/// Whether the largest value is clearly above the next one.
fn is_ahead(most: f64, next: f64) -> bool {
    most - next >= most / 3.0
}

/// The motor with the largest value, the first of equal ones; `except` is skipped.
fn highest(
    motors: &[Motor],
    value: impl Fn(&Motor) -> f64,
    except: Option<usize>,
) -> Option<(usize, f64)> {
    let values = motors.iter().map(value).enumerate();
    let values = values.filter(|(motor, _)| Some(*motor) != except);
    values.reduce(|most, next| if next.1 > most.1 { next } else { most })
}

fn named(motors: &[Motor], motor: usize, side: Side, or: Option<usize>) -> MotorFinding {
    let margin = motors.get(motor).map_or(0.0, |motor| margin(motor.command));
    MotorFinding {
        number: motor + 1,
        or_number: or.map(|or| or + 1),
        side,
        margin_mean: margin,
        margin_min: margin,
    }
}

state! { struct Balance { load, has_recovered, slow_down_together } }
