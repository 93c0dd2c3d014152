//! The verdict of a flight, or the reason why there is none.

use alloc::{format, string::String};
use core::fmt;

use crate::{
    monitor::{MonitorError, Unknown},
    verdict::Level,
};

/// How risky a flight was.
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[cfg_attr(feature = "schema", schemars(with = "super::serialize::VerdictFields"))]
pub enum Verdict {
    /// The level of the most severe finding; GOOD without findings.
    Known(Level),
    /// No verdict (NA), with the reason.
    NotAvailable(Reason),
}

impl Verdict {
    /// The worse of the verdicts of two flights. A flight that was lost in the air is worse than GOOD; a flight that
    /// has no verdict for another reason is ignored unless neither flight has a verdict.
    ///
    /// ```
    /// use flagred::{flight::{Reason, Verdict}, verdict::Level};
    ///
    /// let good = Verdict::Known(Level::Good);
    /// let short = Verdict::NotAvailable(Reason::NoSamples);
    /// assert_eq!(good.clone().worst(short), good);
    /// assert_eq!(good.clone().worst(good.clone().lost_in_air()).to_string(), "NA");
    /// ```
    pub fn worst(self, other: Verdict) -> Verdict {
        match self.severity_rank() >= other.severity_rank() {
            true => self,
            false => other,
        }
    }

    /// The verdict of a flight whose end was not observed: if the observed part was GOOD, the
    /// verdict is unknown.
    pub fn lost_in_air(self) -> Verdict {
        match self {
            Verdict::Known(level) if level > Level::Info => self,
            _ => Verdict::NotAvailable(Reason::LostInAir),
        }
    }

    fn severity_rank(&self) -> u8 {
        match self {
            Verdict::NotAvailable(Reason::NoFlight) => 0,
            Verdict::NotAvailable(Reason::LostInAir | Reason::SetBackInAir { .. }) => 3,
            Verdict::NotAvailable(_) => 1,
            Verdict::Known(Level::Good | Level::Info) => 2,
            Verdict::Known(Level::Warn) => 4,
            Verdict::Known(Level::Fail) => 5,
        }
    }
}

impl fmt::Display for Verdict {
    /// `GOOD`, `WARN`, `FAIL` or `NA`.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Verdict::Known(level) => level.fmt(f),
            Verdict::NotAvailable(_) => f.pad("NA"),
        }
    }
}

/// The reason why a flight has no verdict.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum Reason {
    /// The log lacks something that an assessment needs.
    #[cfg(feature = "flightlog")]
    #[error("{0}")]
    Log(flagred_flightlog::Gap),
    /// The profile cannot be used on this flight.
    #[error("{0}")]
    Monitor(#[from] MonitorError),
    /// The risk was unknown for most of the time in the air.
    #[error("{explanation}")]
    RiskUnknown {
        /// The reason that applied for the longest time.
        unknown: Unknown,
        /// The same reason in words.
        explanation: String,
        /// Advice, if there is any.
        help: Option<&'static str>,
    },
    /// The command of a motor was unknown in the air for longer than the profile's `longest_gap_s`, or for more than a sixteenth
    /// of the time.
    #[error("{}", motor_unknown((.motor, .others), .command, (.from_s, .to_s), .unknown_s))]
    MotorUnknown {
        /// The number of the motor; of several motors, the one whose command was unknown first.
        motor: usize,
        /// Whether the commands of other motors were unknown too.
        others: bool,
        /// The first unknown command of that motor, if it is a number far outside 0 to 1.
        command: Option<f64>,
        /// The start of the time with unknown commands, in seconds.
        from_s: f64,
        /// The end of that time, in seconds.
        to_s: f64,
        /// The total time for which the command was unknown between `from_s` and `to_s`, in
        /// seconds.
        unknown_s: f64,
    },
    /// The whole flight is within the seconds after take-off and before landing that are not
    /// judged.
    #[error(
        "the flight is too short, {in_air_s:.1} s in the air: the first {quiet_s} s and the end of a flight are not judged"
    )]
    TooShort {
        /// The time in the air, in seconds.
        in_air_s: f64,
        /// The time after take-off in which nothing is judged, in seconds.
        quiet_s: f64,
    },
    /// There were too few samples in the air.
    #[error("the flight has too few samples")]
    NoSamples,
    /// The samples of a flight without motors are further apart than the profile's `longest_gap_s`, so every
    /// sample follows a gap.
    #[error(
        "the samples are {step_s} s apart, but the profile counts more than {longest_gap_s} s as a gap"
    )]
    SamplesFarApart {
        /// The most frequent distance between samples, in seconds.
        step_s: f64,
        /// The profile's `longest_gap_s`, in seconds.
        longest_gap_s: f64,
    },
    /// The vehicle was in the air when its last message arrived, or it rebooted in the air.
    #[error("the vehicle was lost in the air")]
    LostInAir,
    /// The clock goes back in the air: the autopilot rebooted, or its clock was set back.
    #[error("the clock goes back in the air at {at_s:.1} s")]
    SetBackInAir {
        /// The time at which the clock went back, in seconds.
        at_s: f64,
    },
    /// Samples in the air had times that are not later than the time of the previous sample.
    #[error("{ignored} samples in the air were ignored: their times are unknown or go back")]
    SamplesIgnored {
        /// The number of ignored samples.
        ignored: u64,
    },
    /// No flight was observed.
    #[error("no flight was observed")]
    NoFlight,
    /// The vehicle sent messages, but never the commands of its motors.
    #[error("the vehicle did not send motor outputs (SERVO_OUTPUT_RAW)")]
    NoMotorOutputs,
}

fn motor_unknown(
    (motor, others): (&usize, &bool),
    command: &Option<f64>,
    (from_s, to_s): (&f64, &f64),
    unknown_s: &f64,
) -> String {
    let whose = match others {
        true => format!("the command of motor {motor}, then of others,"),
        false => format!("the command of motor {motor}"),
    };
    let why = match command {
        Some(command) => format!("is `{command}`, not a fraction from 0 to 1,"),
        None => "is unknown".into(),
    };
    let when = match *unknown_s < 0.95 * (to_s - from_s) {
        true => format!("for {unknown_s:.1} s between {from_s:.1} and {to_s:.1} s"),
        false => format!("from {from_s:.1} to {to_s:.1} s"),
    };
    format!("{whose} {why} in the air {when}")
}

impl Reason {
    /// Advice for the pilot on how to get a verdict for the next flight.
    pub fn help(&self) -> Option<&'static str> {
        match self {
            #[cfg(feature = "flightlog")]
            Reason::Log(gap) => gap.help(),
            Reason::Monitor(MonitorError::NoSignal { .. }) => Some(
                "`flagred inspect` lists the signals of a log; `if_missing` of an input is its value on a vehicle that never sends it",
            ),
            Reason::RiskUnknown { help, .. } => *help,
            Reason::MotorUnknown { command, .. } => Some(match command {
                Some(_) => {
                    "scale the commands: 0 is the lower limit of the motor, 1 the upper limit"
                }
                None => {
                    "a motor without commands can hide any risk: log the commands of all motors"
                }
            }),
            Reason::NoMotorOutputs => Some(
                "ArduPilot: set SRx_RC_CHAN of the port to 25; PX4: `mavlink stream -d PORT -s SERVO_OUTPUT_RAW_0 -r 25`; `flagred watch` without `--all` requests them",
            ),
            Reason::LostInAir => {
                Some("the log on board shows how the flight ended: `flagred assess`")
            }
            Reason::SetBackInAir { .. } => Some(
                "the data after this time are missing or uncertain: look for a restart of the autopilot, or for a damaged clock",
            ),
            Reason::SamplesIgnored { .. } => {
                Some("give each sample a later time than the previous one, in seconds")
            }
            Reason::SamplesFarApart { .. } => Some(
                "`longest_gap_s` of the profile has to be longer than the time between samples; if `t_s` is in milliseconds, divide it by 1000",
            ),
            Reason::TooShort { .. } => Some(
                "if the flight was longer, check that the log is complete and that its times are in seconds",
            ),
            Reason::Monitor(_) | Reason::NoSamples | Reason::NoFlight => None,
        }
    }
}
