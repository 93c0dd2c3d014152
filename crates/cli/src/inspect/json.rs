//! The JSON document of `inspect`: the flight without its samples.

use flagred_flightlog::{
    Event, Flight, Format, Gap, Geometry, Intervals, Motor, Range, Report, Statistics, Vehicle,
};
use serde::Serialize;

/// Version of this document's form.
const SCHEMA: &str = "flagred.inspect/1";

#[derive(Serialize)]
pub(crate) struct Document<'a> {
    schema: &'static str,
    log: &'a str,
    format: Format,
    vehicle: &'a Vehicle,
    motors: &'a [Motor],
    geometry: Option<&'a Geometry>,
    range: Option<&'a Range>,
    effective_range: &'a Range,
    effective_range_doubt: Option<&'a str>,
    assumed: &'a [String],
    clock: Clock<'a>,
    commands: Commands,
    statistics: Option<Statistics>,
    armed: Option<&'a Intervals>,
    in_air: Option<&'a Intervals>,
    signals: Vec<Signal<'a>>,
    modes: &'a [Event],
    messages: &'a [Event],
    header: &'a [(String, String)],
    not_available: Vec<Gap>,
    read: &'a Report,
}

#[derive(Serialize)]
struct Clock<'a> {
    first_s: Option<f64>,
    last_s: Option<f64>,
    utc_at_zero_s: Option<f64>,
    boots_s: &'a [f64],
}

#[derive(Serialize)]
struct Commands {
    rows: usize,
    rate_hz: Option<f64>,
}

#[derive(Serialize)]
struct Signal<'a> {
    name: &'a str,
    unit: &'a str,
    source: &'a str,
    samples: usize,
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
            effective_range: &flight.effective,
            effective_range_doubt: flight.effective_doubt.as_deref(),
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
