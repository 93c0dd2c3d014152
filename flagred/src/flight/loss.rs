//! Losses of data in the air: motors without a command, and samples without a valid time.

use super::Reason;
use crate::monitor::Unknown;

/// The largest share of lost data with which a verdict can be GOOD. It applies to the time in the air without the command
/// of a motor, and to the samples that were ignored because of their times. A larger loss can hide a FAIL, however often
/// the motor is known in between.
const LARGEST_SHARE: f64 = 1.0 / 16.0;

/// The data that was lost in the air so far.
#[derive(Debug, Clone, Default)]
pub(super) struct Losses {
    /// The latest period with unknown motor commands; `None` as soon as the known time within and after the period
    /// is as long as the unknown time.
    latest: Option<MotorLoss>,
    longest: Option<MotorLoss>,
    /// All periods with unknown motor commands, merged into one.
    all: Option<MotorLoss>,
    /// The time at which the clock went back, in seconds.
    set_back_s: Option<f64>,
    taken: u64,
    ignored: u64,
}

/// A period in which the command of a motor was unknown, once or several times.
#[derive(Debug, Clone, Copy)]
struct MotorLoss {
    /// The index of the first such motor.
    motor: usize,
    /// Whether the commands of other motors were unknown too.
    others: bool,
    /// The command of that motor, if it is a number far outside [0, 1].
    command: Option<f64>,
    from_s: f64,
    to_s: f64,
    unknown_s: f64,
    /// The time for which the command was unknown minus the time for which it was known in between, in seconds.
    lost_s: f64,
}

impl Losses {
    /// Counts a sample whose time is unknown or goes back.
    pub(super) fn ignore_sample(&mut self) {
        self.ignored += 1;
    }

    /// Records that the clock goes back after a sample at `at_s`.
    pub(super) fn set_clock_back(&mut self, at_s: f64) {
        self.set_back_s.get_or_insert(at_s);
    }

    /// Adds a sample that represents the `held_s` seconds before `t_s`, with the reasons why risks are unknown in this
    /// period.
    ///
    /// Known time is subtracted from the latest loss, so that a few damaged samples never add up to a long loss.
    pub(super) fn take_sample(
        &mut self,
        mut unknown: impl Iterator<Item = Unknown>,
        t_s: f64,
        held_s: f64,
    ) {
        self.taken += 1;
        let of_motor = unknown.find_map(|reason| match reason {
            Unknown::NoCommand { motor } => Some((motor, None)),
            Unknown::CommandOutside { motor, command } => Some((motor, Some(command))),
            _ => None,
        });
        let Some(of_motor) = of_motor else {
            if let Some(latest) = &mut self.latest {
                latest.lost_s -= held_s;
            }
            self.latest = self.latest.filter(|latest| latest.lost_s > 0.0);
            return;
        };
        MotorLoss::add(&mut self.all, of_motor, (t_s, held_s));
        let latest = MotorLoss::add(&mut self.latest, of_motor, (t_s, held_s));
        if self
            .longest
            .is_none_or(|longest| latest.lost_s > longest.lost_s)
        {
            self.longest = Some(latest);
        }
    }

    /// The reason why a flight of this length is not GOOD although it has no findings; `None` if it can be GOOD.
    pub(super) fn reason(&self, in_air_s: f64, longest_gap_s: f64) -> Option<Reason> {
        if let Some(at_s) = self.set_back_s {
            return Some(Reason::SetBackInAir { at_s });
        }
        let ignored = self.ignored;
        if ignored as f64 > LARGEST_SHARE * (self.taken + ignored) as f64 {
            return Some(Reason::SamplesIgnored { ignored });
        }
        let long = self.longest.filter(|loss| loss.lost_s > longest_gap_s);
        let frequent = || {
            self.all
                .filter(|loss| loss.unknown_s > LARGEST_SHARE * in_air_s)
        };
        long.or_else(frequent).map(|loss| loss.reason())
    }
}

impl MotorLoss {
    /// Adds `held_s` seconds without the command of a motor before `t_s`, and returns the updated loss.
    fn add(
        loss: &mut Option<MotorLoss>,
        (motor, command): (usize, Option<f64>),
        (t_s, held_s): (f64, f64),
    ) -> MotorLoss {
        let loss = loss.get_or_insert(MotorLoss {
            motor,
            others: false,
            command,
            from_s: t_s - held_s,
            to_s: t_s,
            unknown_s: 0.0,
            lost_s: 0.0,
        });
        loss.others |= loss.motor != motor;
        loss.to_s = t_s;
        loss.unknown_s += held_s;
        loss.lost_s += held_s;
        *loss
    }

    fn reason(&self) -> Reason {
        Reason::MotorUnknown {
            motor: self.motor + 1,
            others: self.others,
            command: self.command,
            from_s: self.from_s,
            to_s: self.to_s,
            unknown_s: self.unknown_s,
        }
    }
}

state! {
    struct Losses { latest, longest, all, set_back_s, taken, ignored }
    struct MotorLoss { motor, others, command, from_s, to_s, unknown_s, lost_s }
}
