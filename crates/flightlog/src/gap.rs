//! Information that is missing from a log.

use crate::parameters::LOG_BITMASK;
use crate::{Flight, Format, VehicleKind};

/// The rate of motor commands in Hz below which their spread over a window is not meaningful.
const SLOWEST_HZ: f64 = 5.0;

/// The minimum number of motors of a multirotor: a tricopter has three.
const MIN_MOTORS: usize = 3;

/// Whether motor outputs are logged, as RCOU or, before ArduCopter 3.2, as MOT.
fn logs_motors(log_bitmask: u32) -> bool {
    log_bitmask & (1 << 10) != 0
}

fn without_motors(log_bitmask: Option<u32>) -> String {
    let without = log_bitmask.filter(|mask| !logs_motors(*mask));
    without.map_or(String::new(), |mask| {
        format!(": LOG_BITMASK is {mask}, without bit 10")
    })
}

/// Information that is missing from the log: the reason why a value is not available (NA).
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[cfg_attr(feature = "schema", schemars(with = "crate::serialize::GapFields"))]
#[non_exhaustive]
pub enum Gap {
    /// The vehicle is known and is not a multirotor.
    #[error("the vehicle is a {kind}, not a multirotor ({from})")]
    NotAMultirotor {
        /// The kind of vehicle.
        kind: VehicleKind,
        /// The source of the kind.
        from: String,
    },
    /// The log ends after its header.
    #[error("the log contains no messages")]
    NoMessages,
    /// No output is known to drive a motor.
    #[error("the log does not record which outputs drive the motors")]
    NoMotors {
        /// The format of the log.
        format: Format,
    },
    /// The outputs are known for only some of the motors.
    #[error("outputs are known for {found} of the {expected} motors only")]
    MotorsMissing {
        /// The number of motors whose outputs are known.
        found: usize,
        /// The number of motors that the vehicle has, according to its frame and the numbers of the known motors.
        expected: usize,
    },
    /// Fewer motors are known than the smallest multirotor has.
    #[error("the log has {found} motor{}, but a multirotor has at least {MIN_MOTORS}", if *found == 1 { "" } else { "s" })]
    TooFewMotors {
        /// The number of motors whose outputs are known.
        found: usize,
    },
    /// Motors are known, but their commands were not logged.
    #[error("the commands of the motors are not in the log{}", without_motors(*log_bitmask))]
    NoCommands {
        /// The format of the log.
        format: Format,
        /// `LOG_BITMASK` of ArduPilot, if the log contains it.
        log_bitmask: Option<u32>,
    },
    /// Motor commands were logged, but none of them in the air.
    #[error("no motor command was logged while the vehicle was in the air")]
    NoCommandsInAir,
    /// The range of the motor commands is unknown.
    #[error("the range of the motor commands is not in the log")]
    NoRange {
        /// The format of the log.
        format: Format,
    },
    /// The motors were never armed.
    #[error("the motors were never armed")]
    NeverArmed,
    /// The vehicle never left the ground while motor commands were logged.
    #[error("the vehicle was never in the air")]
    NeverInAir {
        /// The format of the log.
        format: Format,
    },
    /// The log does not record when the vehicle was in the air.
    #[error("the log does not report when the vehicle was in the air")]
    AirUnknown {
        /// The format of the log.
        format: Format,
    },
    /// The attitude, its set point or both were not logged.
    #[error("the attitude or its set point is not in the log")]
    NoAttitude,
    /// The rate of motor commands is too low to compute a spread.
    #[error("motor commands are logged at {rate_hz:.1} Hz, too slow for a spread")]
    TooSlow {
        /// The rate in Hz.
        rate_hz: f64,
        /// The format of the log.
        format: Format,
    },
}

impl Gap {
    /// Advice for the pilot: how to record the missing information in the next log of this kind.
    ///
    /// # Example
    /// ```
    /// let flight = flagred_flightlog::read("t_s,pwm1,pwm2,pwm3\n0,1500,1500,1500\n".as_bytes(), &flagred_flightlog::Options::default())?;
    /// let gap = &flight.gaps()[0];
    /// assert_eq!(gap.to_string(), "the range of the motor commands is not in the log");
    /// assert_eq!(gap.help(), Some("add `# pwm_low_us:` and `# pwm_high_us:` above the names"));
    /// # Ok::<(), flagred_flightlog::ReadError>(())
    /// ```
    pub fn help(&self) -> Option<&'static str> {
        use Format::{Csv, DataFlash, DataFlashText, Tlog, ULog};
        Some(match self {
            Self::NotAMultirotor { .. } | Self::NoCommandsInAir | Self::NeverArmed => return None,
            Self::NoMessages => "the download or copy may have failed: download the log again",
            Self::MotorsMissing { .. } => {
                "log the outputs of all motors; in a flight CSV add the columns that are missing, or correct `frame` or `motors`"
            }
            Self::NeverInAir { format } => match format {
                Csv => {
                    "column `in_air` is 0 in every row: write 1 in the air, or leave the column out if every row counts"
                }
                _ => return None,
            },
            Self::TooFewMotors { .. } => {
                "a flight CSV has a column for each motor: pwm1, pwm2 .. or motor1, motor2 ..; for another vehicle use a profile that reads no motor"
            }
            Self::NoMotors { format } => match format {
                DataFlash | DataFlashText => {
                    "log from boot, so that the SERVOn_FUNCTION parameters are in the log"
                }
                ULog => "log from boot, so that MAV_TYPE or CA_ROTOR_COUNT is in the log",
                Tlog => {
                    "let the ground station load all parameters while it records, or use the log on the vehicle"
                }
                Csv => {
                    "name the columns of the motors pwm1.. (us) or motor1.. (0 to 1), in lower-case letters; to assess a flight with a profile that reads no motor, they are not needed"
                }
            },
            Self::NoCommands {
                format,
                log_bitmask,
            } => match format {
                DataFlash | DataFlashText if log_bitmask.is_some_and(logs_motors) => {
                    "bit 10 (RCOUT) of LOG_BITMASK is set, so the part of the log with RCOU messages is missing: download it again, or log a flight"
                }
                DataFlash | DataFlashText => {
                    "add 1024 to LOG_BITMASK, bit 10: RCOUT, or MOTORS before ArduCopter 3.2"
                }
                ULog => "log actuator_motors, or before PX4 1.13 actuator_outputs (SDLOG_PROFILE)",
                Tlog => {
                    "let the ground station request SERVO_OUTPUT_RAW (ArduPilot: SRx_RC_CHAN), or use the log on the vehicle"
                }
                Csv => "add the columns pwm1.. (us) or motor1.. (0 to 1)",
            },
            Self::NoRange { format } => match format {
                DataFlash | DataFlashText => {
                    "log from boot, so that MOT_PWM_MIN/MAX or RC3_MIN/MAX are in the log, or give the range of the outputs: `flagred assess --range LOW HIGH`"
                }
                ULog => {
                    "the limits are not among the parameters of the log (PWM_MAIN_MIN/MAX, or those of single outputs): give the range of the outputs, `flagred assess --range LOW HIGH`"
                }
                Tlog => {
                    "let the ground station load all parameters while it records, or use the log on the vehicle"
                }
                Csv => "add `# pwm_low_us:` and `# pwm_high_us:` above the names",
            },
            Self::AirUnknown { format } => match format {
                DataFlash | DataFlashText => "log from boot, with EV messages",
                ULog => "log vehicle_land_detected",
                Tlog => "record HEARTBEAT, and EXTENDED_SYS_STATE for PX4",
                Csv => "add a column in_air",
            },
            Self::NoAttitude => {
                "ArduPilot: set bit 0 or 1 (attitude) of LOG_BITMASK; PX4: log vehicle_attitude and vehicle_attitude_setpoint; flight CSV: add the columns roll_deg, roll_des_deg and so on"
            }
            Self::TooSlow { format, .. } => match format {
                DataFlash | DataFlashText => "set bit 0 (fast attitude) of LOG_BITMASK",
                ULog => "choose a higher logging rate with SDLOG_PROFILE",
                Tlog => {
                    "use the log on the vehicle, or raise the rate of SERVO_OUTPUT_RAW (ArduPilot: SRx_RC_CHAN)"
                }
                Csv => {
                    "convert the log of the vehicle again at a higher rate; if `t_s` is in milliseconds, divide it by 1000"
                }
            },
        })
    }

    pub(crate) fn stops_statistics(&self) -> bool {
        !matches!(
            self,
            Self::NoAttitude
                | Self::TooSlow { .. }
                | Self::MotorsMissing { .. }
                | Self::TooFewMotors { .. }
        )
    }
}

impl Flight {
    /// All information that is missing from this log, most important first; empty for a complete log. A vehicle that
    /// is not a multirotor has only the gap [`Gap::NotAMultirotor`].
    ///
    /// ```
    /// let log = "t_s,motor1,motor2,motor3\n0,0.5,0.5,0.5\n1,0.4,0.4,0.4\n2,0.4,0.4,0.4\n";
    /// let flight = flagred_flightlog::read(log.as_bytes(), &flagred_flightlog::Options::default())?;
    /// let gaps: Vec<String> = flight.gaps().iter().map(ToString::to_string).collect();
    /// assert_eq!(gaps, [
    ///     "the attitude or its set point is not in the log",
    ///     "motor commands are logged at 1.0 Hz, too slow for a spread",
    /// ]);
    /// # Ok::<(), flagred_flightlog::ReadError>(())
    /// ```
    pub fn gaps(&self) -> Vec<Gap> {
        if !matches!(
            self.vehicle.kind,
            VehicleKind::Multirotor | VehicleKind::Unknown
        ) {
            // The other gaps concern multirotors only.
            return vec![Gap::NotAMultirotor {
                kind: self.vehicle.kind,
                from: self.vehicle.source.clone(),
            }];
        }
        let format = self.format;
        if self.report.messages == 0 && format != Format::Csv {
            return vec![Gap::NoMessages];
        }
        let mut gaps = Vec::new();
        if self.motors.is_empty() {
            gaps.push(Gap::NoMotors { format });
        } else if self.commands.is_empty() {
            let mut parameters = self.parameters.iter();
            let mask = parameters.find(|parameter| parameter.name == LOG_BITMASK);
            let log_bitmask = mask.map(|mask| mask.value as i64 as u32);
            gaps.push(Gap::NoCommands {
                format,
                log_bitmask,
            });
        }
        let numbers = self.motors.iter().map(|motor| motor.number).max();
        let expected = self.vehicle.motors.or(numbers).map(usize::from);
        let found = self.motors.len();
        if let Some(expected) = expected.filter(|&expected| expected > found && found > 0) {
            gaps.push(Gap::MotorsMissing { found, expected });
        } else if (1..MIN_MOTORS).contains(&found) {
            gaps.push(Gap::TooFewMotors { found });
        }
        if self.range.is_none() && !self.motors.is_empty() {
            gaps.push(Gap::NoRange { format });
        }
        gaps.extend(self.gap_of_air());
        if crate::ATTITUDE
            .iter()
            .any(|name| self.signal(name).is_none())
        {
            gaps.push(Gap::NoAttitude);
        }
        if let Some(rate_hz) = self.command_rate_hz().filter(|&rate| rate < SLOWEST_HZ) {
            gaps.push(Gap::TooSlow { rate_hz, format });
        }
        gaps
    }

    /// The reason why no time in the air is known. This is the only gap that prevents an assessment by a profile
    /// without motor inputs.
    ///
    /// ```
    /// let log = "t_s,load_kg\n0,900\n0.1,950\n";
    /// let flight = flagred_flightlog::read(log.as_bytes(), &flagred_flightlog::Options::default())?;
    /// assert_eq!(flight.gap_of_air(), None); // without a column `in_air` every row counts
    /// # Ok::<(), flagred_flightlog::ReadError>(())
    /// ```
    pub fn gap_of_air(&self) -> Option<Gap> {
        let format = self.format;
        let never = |intervals: &crate::Intervals| intervals.spans.is_empty();
        match (&self.armed, &self.in_air) {
            (Some(armed), _) if never(armed) => Some(Gap::NeverArmed),
            (_, Some(in_air)) if never(in_air) => Some(Gap::NeverInAir { format }),
            (_, None) => Some(Gap::AirUnknown { format }),
            _ => None,
        }
    }
}
