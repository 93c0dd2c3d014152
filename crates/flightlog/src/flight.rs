//! `Flight`, the type into which logs of every format are read.

use crate::{Geometry, Intervals, Parameter, Report, Series, Signal};

/// The format of a flight log.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[cfg_attr(feature = "schema", schemars(with = "String"))]
#[non_exhaustive]
pub enum Format {
    /// ArduPilot DataFlash, binary (`.bin`).
    DataFlash,
    /// ArduPilot DataFlash as text (`.log`).
    DataFlashText,
    /// PX4 ULog (`.ulg`).
    ULog,
    /// MAVLink telemetry with timestamps (`.tlog`).
    Tlog,
    /// Flight CSV.
    Csv,
}

impl std::fmt::Display for Format {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(match self {
            Self::DataFlash => "ArduPilot DataFlash",
            Self::DataFlashText => "ArduPilot DataFlash text",
            Self::ULog => "PX4 ULog",
            Self::Tlog => "MAVLink tlog",
            Self::Csv => "flight CSV",
        })
    }
}

/// The kind of vehicle.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[cfg_attr(feature = "schema", schemars(with = "String"))]
#[non_exhaustive]
pub enum VehicleKind {
    /// A multirotor: quad, hexa, octa, X8, tri, Y6 ...
    Multirotor,
    /// A helicopter, single or coaxial rotor.
    Helicopter,
    /// A fixed-wing plane.
    Plane,
    /// A plane that can hover: quadplane, tailsitter, tilt rotor.
    Vtol,
    /// A rover or a boat.
    Rover,
    /// A submarine.
    Submarine,
    /// Something else: antenna tracker, airship ...
    Other,
    /// The kind is not recorded in the log.
    #[default]
    Unknown,
}

impl VehicleKind {
    /// Advice for a user who wrote an unknown kind of vehicle.
    pub(crate) const NAMES_HELP: &str = "write `multirotor`, `helicopter`, `plane`, `VTOL plane`, `rover`, `submarine` and `other vehicle`";

    /// The kind with the given name, in lower or upper case.
    pub(crate) fn from_name(name: &str) -> Option<Self> {
        [
            Self::Multirotor,
            Self::Helicopter,
            Self::Plane,
            Self::Vtol,
            Self::Rover,
            Self::Submarine,
            Self::Other,
            Self::Unknown,
        ]
        .into_iter()
        .find(|kind| kind.to_string().eq_ignore_ascii_case(name))
    }
}

impl std::fmt::Display for VehicleKind {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(match self {
            Self::Multirotor => "multirotor",
            Self::Helicopter => "helicopter",
            Self::Plane => "plane",
            Self::Vtol => "VTOL plane",
            Self::Rover => "rover",
            Self::Submarine => "submarine",
            Self::Other => "other vehicle",
            Self::Unknown => "unknown vehicle",
        })
    }
}

/// The properties of the vehicle that the log contains.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[non_exhaustive]
pub struct Vehicle {
    /// The kind of vehicle.
    pub kind: VehicleKind,
    /// The source of the kind, such as `MSG "ArduCopter V4.5.1"`.
    pub source: String,
    /// The name of the frame or type, such as `QUAD/X`.
    pub frame: Option<String>,
    /// The number of motors, if the frame determines it.
    pub motors: Option<u16>,
    /// The firmware with its version.
    pub firmware: Option<String>,
    /// An identifier that distinguishes this vehicle from others: the serial number of the board, or `vehicle_id` of a
    /// flight CSV.
    pub id: Option<String>,
    /// The source of [`Vehicle::id`], such as `sys_uuid`.
    pub id_source: Option<String>,
    /// The MAVLink system id. It is 1 on a new autopilot, so several vehicles share it unless their owners change it.
    pub system_id: Option<u8>,
    /// The number of boots in the life of the autopilot, as ArduPilot counts them (`STAT_BOOTCNT`).
    pub boot_count: Option<u32>,
}

/// One motor, and the output that drives it.
#[derive(Debug, Clone, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[non_exhaustive]
pub struct Motor {
    /// The motor number of the autopilot, from 1.
    #[cfg_attr(feature = "schema", schemars(range(min = 1)))]
    pub number: u16,
    /// The name of the output in the log, such as `C3` or `actuator_motors.control[2]`.
    pub output: String,
    /// The source of the assignment, such as `SERVO3_FUNCTION = 35`.
    pub source: String,
}

/// A range of commands, and its source.
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Range {
    /// The lower end.
    pub low: f64,
    /// The upper end, above `low`.
    pub high: f64,
    /// The unit of both ends: `us`, `1` (a fraction) or `raw` (counts of a bus).
    pub unit: &'static str,
    /// The source of the range, such as `MOT_PWM_MIN/MAX`.
    pub source: String,
}

impl Range {
    /// The position of `value` in the range as a fraction, clipped to 0..1.
    ///
    /// # Example
    /// ```
    /// use flagred_flightlog::Range;
    ///
    /// let range = Range { low: 1100.0, high: 1900.0, unit: "us", source: "MOT_PWM_MIN/MAX".into() };
    /// assert_eq!((range.fraction(1300.0), range.fraction(2100.0)), (0.25, 1.0));
    /// ```
    pub fn fraction(&self, value: f64) -> f64 {
        ((value - self.low) / (self.high - self.low)).clamp(0.0, 1.0)
    }
}

/// Motor commands: one row for each logged sample, with one raw value for each motor, on their own time base.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Commands {
    t_s: Vec<f64>,
    raw: Vec<f64>,
    motors: usize,
}

impl Commands {
    pub(crate) fn new(motors: usize) -> Self {
        Self {
            motors,
            ..Self::default()
        }
    }

    /// Adds a row. Missing values are stored as unknown; values beyond the number of motors are dropped.
    pub(crate) fn push(&mut self, t_s: f64, row: impl IntoIterator<Item = f64>) {
        self.t_s.push(t_s);
        self.raw.extend(
            row.into_iter()
                .chain(std::iter::repeat(f64::NAN))
                .take(self.motors),
        );
    }

    /// Number of motors.
    pub(crate) fn motors(&self) -> usize {
        self.motors
    }

    /// Whether all values are unknown.
    pub(crate) fn are_unknown(&self) -> bool {
        self.raw.iter().all(|raw| raw.is_nan())
    }

    /// The times of the rows, in seconds on the log's clock.
    pub fn t_s(&self) -> &[f64] {
        &self.t_s
    }

    /// The number of rows.
    pub fn len(&self) -> usize {
        self.t_s.len()
    }

    /// Whether no motor command was logged.
    pub fn is_empty(&self) -> bool {
        self.t_s.is_empty()
    }

    /// Iterates over the rows in order of time: the time in seconds and the raw value of each motor, in the unit of
    /// [`Flight::range`]. NaN is an unknown value.
    pub fn rows(&self) -> impl ExactSizeIterator<Item = (f64, &[f64])> {
        // A flight without motors has no rows, so the width is never 0 here.
        let rows = self.raw.chunks_exact(self.motors.max(1));
        self.t_s.iter().copied().zip(rows)
    }
}

/// A message, or a change of the flight mode, with its time.
#[derive(Debug, Clone, PartialEq, Eq)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[cfg_attr(
    feature = "schema",
    schemars(with = "crate::serialize::EventFields<'_, T>", rename = "Event")
)]
pub struct Event<T = String> {
    /// The time in microseconds on the log's clock.
    pub t_us: i64,
    /// The message or the mode.
    pub what: T,
}

impl<T> Event<T> {
    pub(crate) fn new(t_s: f64, what: T) -> Self {
        Self {
            t_us: (t_s * 1e6).round() as i64,
            what,
        }
    }

    /// The time in seconds on the log's clock.
    pub fn t_s(&self) -> f64 {
        self.t_us as f64 * 1e-6
    }
}

/// A flight, read from a log.
///
/// Times are in seconds on the log's own clock and never decrease within a series. The clock of ArduPilot and PX4
/// logs counts from boot. The clock of telemetry counts from boot too, or from the first packet if the motor
/// commands contain no times. A CSV file contains its own times. If a log contains several boots of the
/// autopilot, the clock continues from the end of the previous boot; [`Flight::boots_s`] contains the start of
/// each boot except the first.
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
#[non_exhaustive]
pub struct Flight {
    /// The format of the log.
    pub format: Format,
    /// The vehicle.
    pub vehicle: Vehicle,
    /// The motors in order of their number, one for each column of `commands`.
    pub motors: Vec<Motor>,
    /// How much each motor rolls, pitches and yaws the vehicle; `None` if neither the log nor the commands determine
    /// it.
    pub geometry: Option<Geometry>,
    /// The range of the raw commands, 0 % to 100 %; `None` if the log does not record it.
    pub range: Option<Range>,
    /// The part of the range that is used in flight, as fractions of the range. A motor at the upper end of this part
    /// is saturated, even though the range extends further.
    pub effective_range: Range,
    /// The reason why the whole range is used although the log contains limits.
    pub effective_range_doubt: Option<String>,
    /// The assumptions about motors, commands and ranges that replace information missing from the log, as texts.
    /// `flagred watch` makes the same assumptions for a live vehicle. Empty without assumptions.
    pub assumed: Vec<String>,
    /// The parameters of the autopilot that determine motors and ranges, and the gains, if the log contains them.
    pub parameters: Vec<Parameter>,
    /// The motor commands.
    pub commands: Commands,
    /// All other signals.
    pub series: Vec<Series>,
    /// The flight modes, each from the time at which it was entered.
    pub modes: Vec<Event>,
    /// The texts that the autopilot wrote into the log.
    pub messages: Vec<Event>,
    /// The times in which the motors were armed; `None` if the log does not record them.
    pub armed: Option<Intervals>,
    /// The times in which the vehicle was in the air; `None` if the log does not record them. Landings of less than a
    /// second are ignored, because land detectors chatter.
    pub in_air: Option<Intervals>,
    /// The UTC time at time 0 of the log's clock, in seconds since 1970; `None` if unknown.
    pub utc_at_zero_s: Option<f64>,
    /// The times of all boots of the autopilot within the log except the first boot; empty if it booted once.
    pub boots_s: Vec<f64>,
    /// The times in the air at which the clock restarted, as after a reboot, or was set back. Data after them may be
    /// missing from the log.
    pub rebooted_in_air_s: Vec<f64>,
    /// The header lines of a CSV file as keys and values, in their order.
    pub header: Vec<(String, String)>,
    /// The amounts of data and of damage in the log.
    pub report: Report,
}

impl Flight {
    pub(crate) fn empty(format: Format) -> Self {
        Self {
            format,
            vehicle: Vehicle::default(),
            motors: Vec::new(),
            geometry: None,
            range: None,
            effective_range: whole_range("the log contains no tighter limits"),
            effective_range_doubt: None,
            assumed: Vec::new(),
            parameters: Vec::new(),
            commands: Commands::default(),
            series: Vec::new(),
            modes: Vec::new(),
            messages: Vec::new(),
            armed: None,
            in_air: None,
            utc_at_zero_s: None,
            boots_s: Vec::new(),
            rebooted_in_air_s: Vec::new(),
            header: Vec::new(),
            report: Report::default(),
        }
    }

    /// All signals.
    pub fn signals(&self) -> impl Iterator<Item = Signal<'_>> {
        self.series.iter().flat_map(Series::signals)
    }

    /// The signal with the given name.
    pub fn signal(&self, name: &str) -> Option<Signal<'_>> {
        self.signals().find(|signal| signal.label.name == name)
    }

    /// The command on the full range, 0..1: `c = (raw - low) / (high - low)`, clipped. `None` if the value or the range
    /// is unknown.
    ///
    /// A PX4 motor that is commanded to stop is NaN in the log file; it is read as 0.
    pub fn command(&self, raw: f64) -> Option<f64> {
        let range = self.range.as_ref()?;
        raw.is_finite().then(|| range.fraction(raw))
    }

    /// The command on the effective range, 0..1: `e = (c - lo) / (hi - lo)`, clipped, where `c` is [`Flight::command`]
    /// and `lo`, `hi` are [`Flight::effective_range`].
    ///
    /// ```
    /// let log = "\
    /// ## pwm_low_us: 1000
    /// ## pwm_high_us: 2000
    /// ## effective_low: 0.15
    /// ## effective_high: 0.95
    /// t_s,pwm1
    /// 0,1550
    /// ";
    /// let flight = flagred_flightlog::read(log.as_bytes(), &flagred_flightlog::Options::default())?;
    /// assert_eq!(flight.command(1550.0), Some(0.55));
    /// assert!((flight.effective_command(1550.0).unwrap() - 0.5).abs() < 1e-12);
    /// # Ok::<(), flagred_flightlog::ReadError>(())
    /// ```
    pub fn effective_command(&self, raw: f64) -> Option<f64> {
        self.command(raw).map(|c| self.effective_range.fraction(c))
    }

    /// Whether the vehicle was in the air at `t_s`; `None` if the log does not record it.
    pub fn is_in_air(&self, t_s: f64) -> Option<bool> {
        self.in_air.as_ref().map(|spans| spans.contains(t_s))
    }

    /// The first and last time of the motor commands and the signals.
    pub fn time_span_s(&self) -> Option<(f64, f64)> {
        std::iter::once(self.commands.t_s())
            .chain(self.series.iter().map(Series::t_s))
            .filter_map(|t_s| Some((*t_s.first()?, *t_s.last()?)))
            .reduce(|a, b| (a.0.min(b.0), a.1.max(b.1)))
    }

    /// The rate of rows of motor commands in Hz, ignoring pauses; `None` with fewer than two rows.
    pub fn command_rate_hz(&self) -> Option<f64> {
        crate::signal::rate_hz(self.commands.t_s())
    }
}

pub(crate) fn whole_range(why: &str) -> Range {
    Range {
        low: 0.0,
        high: 1.0,
        unit: "1",
        source: format!("the whole range: {why}"),
    }
}
