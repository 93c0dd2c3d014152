//! The JSON document of `inspect`: the flight without its samples.

use flagred_flightlog::{
    Event, Flight, Format, Gap, Geometry, Intervals, Motor, Range, Report, Statistics, Vehicle,
};
use schemars::JsonSchema;
use serde::Serialize;

/// The version of the JSON document.
const SCHEMA: &str = "flagred.inspect/1";

#[derive(Serialize, JsonSchema)]
pub(crate) struct Document<'a> {
    #[schemars(extend("const" = SCHEMA))]
    schema: &'static str,
    /// The path of the log, as given on the command line.
    log: &'a str,
    /// The kind of log, such as `ArduPilot DataFlash`.
    format: Format,
    vehicle: &'a Vehicle,
    /// The motors in order of their number.
    motors: &'a [Motor],
    geometry: Option<&'a Geometry>,
    /// The range of the raw commands.
    range: Option<&'a Range>,
    /// The part of the range that is used in flight, as fractions of it.
    effective_range: &'a Range,
    /// The reason why the whole range is used as the effective range although the log reports
    /// limits.
    effective_range_doubt: Option<&'a str>,
    /// Assumptions about motors, their commands and ranges that the log does not report, as texts.
    assumed: &'a [String],
    clock: Clock<'a>,
    commands: Commands,
    /// Statistics of margin and command over the time in the air; null if the log lacks the
    /// required data.
    statistics: Option<Statistics>,
    /// The times in which the motors were armed.
    armed: Option<&'a Intervals>,
    /// The times in which the vehicle was in the air.
    in_air: Option<&'a Intervals>,
    /// All signals except the motor commands.
    signals: Vec<Signal<'a>>,
    /// The flight modes, each with the time at which it was entered.
    modes: &'a [Event],
    /// The text messages of the autopilot.
    messages: &'a [Event],
    /// The keys and values in the header of a flight CSV.
    header: &'a [(String, String)],
    /// The data that the log lacks.
    not_available: Vec<Gap>,
    /// The amount of data that was read, and the damage that was found.
    read: &'a Report,
}

#[derive(Serialize, JsonSchema)]
struct Clock<'a> {
    /// The first timestamp of the log, in seconds.
    first_s: Option<f64>,
    /// The last timestamp of the log, in seconds.
    last_s: Option<f64>,
    /// UTC at time 0, in seconds since 1970.
    utc_at_zero_s: Option<f64>,
    /// The times at which the autopilot rebooted.
    boots_s: &'a [f64],
}

#[derive(Serialize, JsonSchema)]
struct Commands {
    /// The number of rows.
    rows: usize,
    /// The number of rows per second, excluding pauses.
    rate_hz: Option<f64>,
}

#[derive(Serialize, JsonSchema)]
struct Signal<'a> {
    /// The name of the signal, which includes the unit.
    name: &'a str,
    /// The unit; empty if there is none.
    unit: &'a str,
    /// The message or field of the log that contains the signal.
    source: &'a str,
    /// The number of known values.
    samples: usize,
    /// The number of known values per second, excluding pauses.
    rate_hz: Option<f64>,
}

impl<'a> Document<'a> {
    pub(crate) fn new(log: &'a str, flight: &'a Flight) -> Self {
        let span_s = flight.time_span_s();
        Self {
            schema: SCHEMA,
            log,
            format: flight.format,
            vehicle: &flight.vehicle,
            motors: &flight.motors,
            geometry: flight.geometry.as_ref(),
            range: flight.range.as_ref(),
            effective_range: &flight.effective_range,
            effective_range_doubt: flight.effective_range_doubt.as_deref(),
            assumed: &flight.assumed,
            clock: Clock {
                first_s: span_s.map(|span| span.0),
                last_s: span_s.map(|span| span.1),
                utc_at_zero_s: flight.utc_at_zero_s,
                boots_s: &flight.boots_s,
            },
            commands: Commands {
                rows: flight.commands.len(),
                rate_hz: flight.command_rate_hz(),
            },
            statistics: flight.statistics().ok(),
            armed: flight.armed.as_ref(),
            in_air: flight.in_air.as_ref(),
            signals: flight.signals().map(signal).collect(),
            modes: &flight.modes,
            messages: &flight.messages,
            header: &flight.header,
            not_available: flight.gaps(),
            read: &flight.report,
        }
    }
}

fn signal(signal: flagred_flightlog::Signal<'_>) -> Signal<'_> {
    Signal {
        name: &signal.label.name,
        unit: &signal.label.unit,
        source: &signal.label.source,
        samples: signal.known(),
        rate_hz: signal.rate_hz(),
    }
}
