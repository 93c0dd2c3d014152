//! What a log does not hold, so that a question about it has no answer.

use crate::{Flight, VehicleKind};

/// Rows a second below which a spread over a window means little.
const SLOWEST_HZ: f64 = 5.0;

/// Something the log does not hold: the reason why a value is not available (NA).
///
/// # Example: a log too coarse for a spread
/// ```
/// let log = "t_s,motor1,motor2,motor3,motor4\n0,0.4,0.4,0.4,0.4\n1,0.4,0.5,0.4,0.4\n2,0.4,0.4,0.4,0.4\n";
/// let flight = flightlog::read(log.as_bytes(), &flightlog::Options::default())?;
/// let gaps: Vec<String> = flight.gaps().iter().map(ToString::to_string).collect();
/// assert!(gaps.contains(&"motor commands are logged at 1.0 Hz, too slow for a spread".into()), "{gaps:?}");
/// # Ok::<(), flightlog::ReadError>(())
/// ```
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum Gap {
    /// The vehicle is known, and is no multirotor.
    #[error("the vehicle is a {kind}, not a multirotor ({from})")]
    NotAMultirotor {
        /// What it is.
        kind: VehicleKind,
        /// How that is known.
        from: String,
    },
    /// No output is known to drive a motor.
    #[error("the log does not say which outputs drive the motors")]
    NoMotors,
    /// Some motors are known, but others are missing.
    #[error("outputs are known for {found} of the {expected} motors only")]
    MotorsMissing {
        /// Motors whose outputs are known.
        found: usize,
        /// Motors that the vehicle has, by its frame and the numbers of the known ones.
        expected: usize,
    },
    /// Motors are known, but their commands were not logged, or not while in the air.
    #[error("the commands of the motors are not in the log")]
    NoCommands,
    /// The range of the motor commands is unknown.
    #[error("the range of the motor commands is not in the log")]
    NoRange,
    /// The motors were never armed.
    #[error("the motors were never armed")]
    NeverArmed,
    /// The vehicle never left the ground while motor commands were logged.
    #[error("the vehicle was never in the air")]
    NeverInAir,
    /// The log does not tell when the vehicle was in the air.
    #[error("the log does not tell when the vehicle was in the air")]
    AirUnknown,
    /// Attitude and its set point are not both logged.
    #[error("attitude and its set point are not both in the log")]
    NoAttitude,
    /// Motor commands come too rarely for a spread.
    #[error("motor commands are logged at {rate_hz:.1} Hz, too slow for a spread")]
    TooSlow {
        /// Rows a second.
        rate_hz: f64,
    },
}

impl Gap {
    /// What the pilot can do so that the next log holds it.
    ///
    /// # Example
    /// ```
    /// use flightlog::Gap;
    ///
    /// assert!(Gap::NoRange.help().is_some_and(|help| help.contains("MOT_PWM_MIN/MAX")));
    /// assert_eq!(Gap::NeverInAir.help(), None);
    /// ```
    pub fn help(&self) -> Option<&'static str> {
        match self {
            Self::NotAMultirotor { .. }
            | Self::MotorsMissing { .. }
            | Self::NeverArmed
            | Self::NeverInAir => None,
            Self::NoMotors => Some(
                "ArduPilot: log from boot, so that the SERVOn_FUNCTION parameters are in it; CSV: name the columns pwm1.. or motor1..",
            ),
            Self::NoCommands => {
                Some("ArduPilot: set bit 10 (RCOUT) of LOG_BITMASK; PX4: log actuator_motors")
            }
            Self::NoRange => Some(
                "ArduPilot: log from boot, so that MOT_PWM_MIN/MAX are in it; CSV: add `# pwm_low_us:` and `# pwm_high_us:`",
            ),
            Self::AirUnknown => {
                Some("ArduPilot: EV messages, PX4: vehicle_land_detected, CSV: a column `in_air`")
            }
            Self::NoAttitude => Some(
                "ArduPilot: set bit 0 or 1 (attitude) of LOG_BITMASK; PX4: log vehicle_attitude and vehicle_attitude_setpoint",
            ),
            Self::TooSlow { .. } => Some(
                "use the log on the vehicle instead of telemetry, or raise the rate: ArduPilot LOG_BITMASK bit 0 (fast attitude) or SRx_RC_CHAN for telemetry, PX4 SDLOG_PROFILE",
            ),
        }
    }

    pub(crate) fn stops_statistics(&self) -> bool {
        !matches!(
            self,
            Self::NoAttitude | Self::TooSlow { .. } | Self::MotorsMissing { .. }
        )
    }
}

impl Flight {
    /// Everything this log does not hold, the gravest first; empty for a log that can
    /// answer every question. For a vehicle that is no multirotor, that is the one answer.
    ///
    /// ```
    /// let log = "t_s,motor1\n0,0.5\n1,0.4\n2,0.4\n";
    /// let flight = flightlog::read(log.as_bytes(), &flightlog::Options::default())?;
    /// let gaps: Vec<String> = flight.gaps().iter().map(ToString::to_string).collect();
    /// assert_eq!(gaps, [
    ///     "attitude and its set point are not both in the log",
    ///     "motor commands are logged at 1.0 Hz, too slow for a spread",
    /// ]);
    /// # Ok::<(), flightlog::ReadError>(())
    /// ```
    pub fn gaps(&self) -> Vec<Gap> {
        if !matches!(
            self.vehicle.kind,
            VehicleKind::Multirotor | VehicleKind::Unknown
        ) {
            // The other questions are about multirotors.
            return vec![Gap::NotAMultirotor {
                kind: self.vehicle.kind,
                from: self.vehicle.source.clone(),
            }];
        }
        let mut gaps = Vec::new();
        if self.motors.is_empty() {
            gaps.push(Gap::NoMotors);
        } else if self.commands.is_empty() {
            gaps.push(Gap::NoCommands);
        }
        let numbers = self.motors.iter().map(|motor| motor.number).max();
        let expected = self.vehicle.motors.or(numbers).map(usize::from);
        let found = self.motors.len();
        if let Some(expected) = expected.filter(|&expected| expected > found && found > 0) {
            gaps.push(Gap::MotorsMissing { found, expected });
        }
        if self.range.is_none() && !self.motors.is_empty() {
            gaps.push(Gap::NoRange);
        }
        let never = |intervals: &crate::Intervals| intervals.spans.is_empty();
        match (&self.armed, &self.in_air) {
            (Some(armed), _) if never(armed) => gaps.push(Gap::NeverArmed),
            (_, Some(in_air)) if never(in_air) => gaps.push(Gap::NeverInAir),
            (_, None) => gaps.push(Gap::AirUnknown),
            _ => {}
        }
        let attitude = ["roll_des_deg", "roll_deg", "pitch_des_deg", "pitch_deg"];
        if attitude.iter().any(|name| self.signal(name).is_none()) {
            gaps.push(Gap::NoAttitude);
        }
        if let Some(rate_hz) = self.command_rate_hz().filter(|&rate| rate < SLOWEST_HZ) {
            gaps.push(Gap::TooSlow { rate_hz });
        }
        gaps
    }
}
