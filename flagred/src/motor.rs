//! The state of each motor: its command, the command without yaw, and its noise.

use crate::{
    average::Average,
    effort::{self, Efforts, Factors},
    margin::{Side, margin},
};

/// The noise of commands is computed from means over periods of this length, in seconds, so that it hardly depends on
/// the rate of the log.
pub(crate) const BIN_S: f64 = 0.1;

/// The number of the bin that contains `t_s`.
fn bin_of(t_s: f64) -> f64 {
    const ROUNDING: f64 = 1e-6;
    libm::floor(t_s / BIN_S + ROUNDING)
}

/// Commands up to this far outside [0, 1] are rounding errors or slightly exceeded limits. Commands further outside
/// have another unit, such as microseconds or percent.
#[cfg_attr(not(feature = "std"), expect(unreachable_pub))]
pub const MAX_OUTSIDE: f64 = 0.5;

/// Marks the absence of a motor, in place of its index.
const NONE: u32 = u32::MAX;

/// The state of one motor.
#[derive(Debug, Clone, Copy)]
pub struct Motor {
    /// The effective command of the motor in the latest sample; NaN is unknown.
    pub(crate) command: f64,
    /// The command without the part that commands yaw.
    pub(crate) less_yaw: f64,
    /// The yaw factor of the motor; 0 if the geometry is unknown.
    yaw: f64,
    /// The contribution of one unit of the command to each effort; zeros if the geometry is unknown.
    share: Efforts,
    /// The index of the opposite motor; `u32::MAX` if there is none or the geometry is unknown.
    pub(crate) opposite: u32,
    /// The sum of the commands in the current bin; NaN if one of them is unknown.
    bin_sum: f64,
    /// The mean of the commands in the previous bin; NaN is unknown.
    bin_before: f64,
    /// The difference between the command and the mean of all motors, averaged over the last seconds.
    pub(crate) difference: Average,
    /// The difference between the command and the mean of all motors while the flight is calm, averaged over a longer
    /// time.
    pub(crate) trim: Average,
    /// The time for which the command has been 0, in seconds.
    pub(crate) at_zero_s: f64,
    /// The margins of the motor while a threshold is reached. The record restarts when WARN or FAIL begins to be reached.
    pub(crate) record: MotorRecord,
}

/// The margins of a motor over a period.
#[derive(Debug, Clone, Copy)]
pub(crate) struct MotorRecord {
    pub(crate) samples: u32,
    pub(crate) margin_mean: f64,
    pub(crate) margin_min: f64,
    pub(crate) side: Side,
}

/// The values of all motors together at one time.
#[derive(Debug, Clone, Copy)]
pub(crate) struct MotorTotals {
    pub(crate) efforts: Efforts,
    /// The noise of the commands if this sample completed a bin; otherwise NaN.
    pub(crate) noise: f64,
    /// The bin that contains the sample.
    pub(crate) bin: f64,
}

/// The bin that contains the latest sample.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Bin {
    index: f64,
    samples: u32,
}

impl Motor {
    /// Memory for a motor, all zeros.
    pub(crate) const IDLE: Motor = Motor {
        command: 0.0,
        less_yaw: 0.0,
        yaw: 0.0,
        share: [0.0; 4],
        opposite: 0,
        bin_sum: 0.0,
        bin_before: 0.0,
        difference: Average::NONE,
        trim: Average::NONE,
        at_zero_s: 0.0,
        record: MotorRecord {
            samples: 0,
            margin_mean: 0.0,
            margin_min: 0.0,
            side: Side::Lower,
        },
    };

    /// A motor without known values.
    pub const UNKNOWN: Motor = Motor {
        command: f64::NAN,
        less_yaw: f64::NAN,
        bin_before: f64::NAN,
        opposite: NONE,
        record: MotorRecord::NONE,
        ..Motor::IDLE
    };

    /// The change of the motor's command from its trim, relative to the mean of all motors.
    pub(crate) fn shift(&self) -> f64 {
        self.difference.value - self.trim.value
    }

    /// A motor with an effective command.
    #[cfg(test)]
    pub(crate) fn at(command: f64) -> Motor {
        Motor {
            command,
            less_yaw: command,
            ..Motor::UNKNOWN
        }
    }
}

impl MotorRecord {
    pub(crate) const NONE: MotorRecord = MotorRecord {
        samples: 0,
        margin_mean: 0.0,
        margin_min: f64::INFINITY,
        side: Side::Upper,
    };

    pub(crate) fn add(&mut self, e: f64) {
        if !e.is_finite() {
            return;
        }
        let margin = margin(e);
        self.samples += 1;
        self.margin_mean += (margin - self.margin_mean) / f64::from(self.samples);
        if margin < self.margin_min {
            self.margin_min = margin;
            self.side = Side::of(e);
        }
    }
}

/// Sets the factors of each motor. If a motor has no factors, or if the factors do not separate the efforts, returns
/// false and changes nothing: yaw is then not removed.
pub(crate) fn set_geometry(motors: &mut [Motor], factors: &[Factors]) -> bool {
    let normal = effort::normal(factors.iter().copied());
    let column = |factors| effort::column(&normal, factors);
    let is_known = factors.len() == motors.len() && factors.iter().all(|f| column(f).is_some());
    for (motor, factors) in motors.iter_mut().zip(factors) {
        if let (true, Some(share)) = (is_known, column(factors)) {
            (motor.yaw, motor.share) = (factors[2], share);
        }
    }
    for (i, motor) in motors.iter_mut().enumerate().filter(|_| is_known) {
        motor.opposite = opposite(factors, i).map_or(NONE, |opposite| opposite as u32);
    }
    is_known
}

/// Returns the motor opposite the given one. If two motors are on the opposite arm, it is the one that turns the same
/// way as the given motor.
fn opposite(factors: &[Factors], motor: usize) -> Option<usize> {
    const SAME_PLACE: f64 = 0.1;
    let [roll, pitch, yaw] = *factors.get(motor)?;
    let is_in_the_middle = roll.abs() < SAME_PLACE && pitch.abs() < SAME_PLACE;
    let faces = |factors: &Factors| {
        (factors[0] + roll).abs() < SAME_PLACE && (factors[1] + pitch).abs() < SAME_PLACE
    };
    let all = factors.iter().enumerate();
    let facing = all.filter(|(_, factors)| !is_in_the_middle && faces(factors));
    let turns = |other: f64| (other - yaw).abs();
    let nearest = facing.min_by(|(_, a), (_, b)| turns(a[2]).total_cmp(&turns(b[2])));
    nearest.map(|(opposite, _)| opposite)
}

/// The values of the motors, without the part that commands yaw.
pub(crate) fn less_yaw(
    motors: &[Motor],
    value: impl Fn(&Motor) -> f64 + Copy,
) -> impl Iterator<Item = f64> {
    let yaw: f64 = motors.iter().map(|m| m.share[2] * value(m)).sum();
    motors
        .iter()
        .map(move |motor| value(motor) - motor.yaw * yaw)
}

/// Clears the commands and keeps the geometry; within a flight the trims are kept too.
pub(crate) fn clear(motors: &mut [Motor], keeps_trims: bool) {
    for motor in motors {
        let Motor {
            yaw,
            share,
            opposite,
            trim,
            record,
            ..
        } = *motor;
        *motor = Motor {
            yaw,
            share,
            opposite,
            trim: if keeps_trims { trim } else { Average::NONE },
            record,
            ..Motor::UNKNOWN
        };
    }
}

/// Clears the trims, because a new flight may begin.
pub(crate) fn forget_trims(motors: &mut [Motor]) {
    for motor in motors {
        motor.trim = Average::NONE;
    }
}

/// The command that a monitor uses for a motor: clamped to [0, 1] if it is at most [`MAX_OUTSIDE`] outside, as is done
/// when logs are read; otherwise NaN (unknown).
///
/// ```
/// use flagred::monitor::counted;
///
/// assert_eq!((counted(1.0000001), counted(-0.1), counted(0.3)), (1.0, 0.0, 0.3));
/// assert!(counted(1500.0).is_nan() && counted(f64::NAN).is_nan());
/// ```
#[cfg_attr(not(feature = "std"), expect(unreachable_pub))]
pub fn counted(command: f64) -> f64 {
    match (-MAX_OUTSIDE..=1.0 + MAX_OUTSIDE).contains(&command) {
        true => command.clamp(0.0, 1.0),
        false => f64::NAN,
    }
}

/// Stores the effective command of each motor at `t_s`; missing commands are unknown.
pub(crate) fn take(motors: &mut [Motor], bin: &mut Bin, t_s: f64, commands: &[f64]) -> MotorTotals {
    let noise = bin.begin(t_s, motors);
    let commands = commands.iter().map(|command| counted(*command));
    let commands = commands.chain(core::iter::repeat(f64::NAN));
    let mut efforts = [0.0; 4];
    let mut has_geometry = false;
    for (motor, command) in motors.iter_mut().zip(commands) {
        motor.command = command;
        motor.bin_sum += command;
        for (effort, share) in efforts.iter_mut().zip(motor.share) {
            *effort += share * command;
            has_geometry |= share != 0.0;
        }
    }
    // Without a geometry no yaw is removed, even if a motor is unknown.
    let yaw = if has_geometry { efforts[2] } else { 0.0 };
    for motor in motors.iter_mut() {
        motor.less_yaw = motor.command - motor.yaw * yaw;
    }
    if !has_geometry {
        efforts = effort::UNKNOWN;
    }
    MotorTotals {
        efforts,
        noise,
        bin: bin.index,
    }
}

impl Bin {
    pub(crate) const NONE: Bin = Bin {
        index: f64::NEG_INFINITY,
        samples: 0,
    };

    /// Adds a sample to its bin. If this completes the previous bin, returns the noise of that bin: `sqrt(mean over motors
    /// of (step^2) / 2)`, with the steps from the bin before it. Otherwise, or if the step of a motor is unknown, NaN.
    fn begin(&mut self, t_s: f64, motors: &mut [Motor]) -> f64 {
        let index = bin_of(t_s);
        let mut noise = f64::NAN;
        if index != self.index {
            let mut squares = 0.0;
            for motor in motors.iter_mut() {
                let mean = motor.bin_sum / f64::from(self.samples);
                let step = mean - motor.bin_before;
                squares += step * step;
                motor.bin_before = mean;
                motor.bin_sum = 0.0;
            }
            noise = libm::sqrt(squares / motors.len() as f64 / 2.0);
            *self = Bin { index, samples: 0 };
        }
        self.samples += 1;
        noise
    }
}

state! {
    struct Motor {
        command, less_yaw, yaw, share, opposite, bin_sum, bin_before, difference, trim, at_zero_s, record
    }
    struct MotorRecord { samples, margin_mean, margin_min, side }
    struct Bin { index, samples }
}
