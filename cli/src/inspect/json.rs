//! The JSON document of `inspect`.

use flightlog::{Flight, Intervals};
use serde::Serialize;

use crate::json::{Motor, Range, Read};

/// Version of this document's form.
const SCHEMA: &str = "flagred.inspect/1";

#[derive(Serialize)]
pub(super) struct Document<'a> {
    schema: &'static str,
    log: &'a str,
    format: String,
    vehicle: Vehicle<'a>,
    motors: Vec<Motor<'a>>,
    geometry: Option<Geometry<'a>>,
    range: Option<Range<'a>>,
    effective_range: Range<'a>,
    clock: Clock<'a>,
    commands: Commands,
    statistics: Option<Statistics>,
    armed: Option<Spans<'a>>,
    in_air: Option<Spans<'a>>,
    signals: Vec<Signal<'a>>,
    modes: Vec<Event<'a>>,
    messages: Vec<Event<'a>>,
    header: Vec<(&'a str, &'a str)>,
    not_available: Vec<Missing>,
    read: Read<'a>,
}

#[derive(Serialize)]
struct Vehicle<'a> {
    kind: String,
    frame: Option<&'a str>,
    firmware: Option<&'a str>,
    source: &'a str,
}

#[derive(Serialize)]
struct Geometry<'a> {
    frame: Option<&'a str>,
    basis: String,
    source: &'a str,
    doubt: Option<&'a str>,
    /// Roll, pitch and yaw of each motor, in the order of `motors`.
    factors: &'a [[f64; 3]],
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
struct Statistics {
    samples: usize,
    margin_mean: f64,
    margin_min: f64,
    margin_std: f64,
    margin_mean_of_min: f64,
    command_mean: f64,
    command_std: f64,
}

#[derive(Serialize)]
struct Spans<'a> {
    duration_s: f64,
    rule: &'a str,
    spans_s: Vec<(f64, f64)>,
    ends_with_log: bool,
}

#[derive(Serialize)]
struct Signal<'a> {
    name: &'a str,
    unit: &'a str,
    source: &'a str,
    samples: usize,
    rate_hz: Option<f64>,
}

#[derive(Serialize)]
struct Event<'a> {
    t_s: f64,
    what: &'a str,
}

#[derive(Serialize)]
struct Missing {
    reason: String,
    help: Option<&'static str>,
}

impl<'a> Document<'a> {
    pub(super) fn new(log: &'a str, flight: &'a Flight) -> Self {
        let span_s = flight.time_span_s();
        Self {
            schema: SCHEMA,
            log,
            format: flight.format.to_string(),
            vehicle: Vehicle {
                kind: flight.vehicle.kind.to_string(),
                frame: flight.vehicle.frame.as_deref(),
                firmware: flight.vehicle.firmware.as_deref(),
                source: &flight.vehicle.source,
            },
            motors: flight.motors.iter().map(Motor::from).collect(),
            geometry: flight.geometry.as_ref().map(|geometry| Geometry {
                frame: geometry.frame.as_deref(),
                basis: geometry.basis.to_string(),
                source: &geometry.source,
                doubt: geometry.doubt.as_deref(),
                factors: &geometry.factors,
            }),
            range: flight.range.as_ref().map(Range::from),
            effective_range: Range::from(&flight.effective),
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
            statistics: flight.statistics().ok().map(statistics),
            armed: flight.armed.as_ref().map(spans),
            in_air: flight.in_air.as_ref().map(spans),
            signals: flight.signals().map(signal).collect(),
            modes: flight.modes.iter().map(event).collect(),
            messages: flight.messages.iter().map(event).collect(),
            header: flight
                .header
                .iter()
                .map(|(key, value)| (key.as_str(), value.as_str()))
                .collect(),
            not_available: flight
                .gaps()
                .iter()
                .map(|gap| Missing {
                    reason: gap.to_string(),
                    help: gap.help(),
                })
                .collect(),
            read: Read::from(&flight.report),
        }
    }
}

fn statistics(of: flightlog::Statistics) -> Statistics {
    Statistics {
        samples: of.samples,
        margin_mean: of.margin_mean,
        margin_min: of.margin_min,
        margin_std: of.margin_std,
        margin_mean_of_min: of.margin_mean_of_min,
        command_mean: of.command_mean,
        command_std: of.command_std,
    }
}

fn spans(intervals: &Intervals) -> Spans<'_> {
    Spans {
        duration_s: intervals.duration_s(),
        rule: &intervals.rule,
        spans_s: intervals
            .spans
            .iter()
            .map(|span| (span.start_s, span.end_s))
            .collect(),
        ends_with_log: intervals
            .spans
            .last()
            .is_some_and(|span| span.ends_with_log),
    }
}

fn signal(signal: flightlog::Signal<'_>) -> Signal<'_> {
    Signal {
        name: &signal.label.name,
        unit: &signal.label.unit,
        source: &signal.label.source,
        samples: signal.values.len(),
        rate_hz: signal.rate_hz(),
    }
}

fn event(event: &flightlog::Event) -> Event<'_> {
    Event {
        t_s: event.t_s(),
        what: &event.what,
    }
}
