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
    /// Its path, as given.
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
    /// Why the used part counts as the whole range although the log reports limits.
    effective_range_doubt: Option<&'a str>,
    /// What is assumed of motors, their commands and ranges because the log does not report it, in words.
    assumed: &'a [String],
    clock: Clock<'a>,
    commands: Commands,
    /// Margin and command over the time in the air; null where the log lacks what they need.
    statistics: Option<Statistics>,
    /// When the motors were armed.
    armed: Option<&'a Intervals>,
    /// When the vehicle was in the air.
    in_air: Option<&'a Intervals>,
    /// All signals but the motor commands.
    signals: Vec<Signal<'a>>,
    /// The flight modes, from the time each was entered.
    modes: &'a [Event],
    /// The texts of the autopilot.
    messages: &'a [Event],
    /// The keys and values in the header of a flight CSV.
    header: &'a [(String, String)],
    /// What the log lacks.
    not_available: Vec<Gap>,
    /// The amount of data read, and damage.
    read: &'a Report,
}

#[derive(Serialize, JsonSchema)]
struct Clock<'a> {
    /// The first time of the log, in seconds.
    first_s: Option<f64>,
    /// The last time of the log, in seconds.
    last_s: Option<f64>,
    /// UTC at time 0, in seconds since 1970.
    utc_at_zero_s: Option<f64>,
    /// The times at which the autopilot booted again.
    boots_s: &'a [f64],
}

#[derive(Serialize, JsonSchema)]
struct Commands {
    /// The number of rows.
    rows: usize,
    /// The rows a second, without pauses.
    rate_hz: Option<f64>,
}

#[derive(Serialize, JsonSchema)]
struct Signal<'a> {
    /// Its name, with the unit in it.
    name: &'a str,
    /// Its unit; empty where it has none.
    unit: &'a str,
    /// The message or field of the log that it comes from.
    source: &'a str,
    /// The number of values.
    samples: usize,
    /// The values a second, without pauses.
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
        samples: signal.values.len(),
        rate_hz: signal.rate_hz(),
    }
}
