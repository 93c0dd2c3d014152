//! What the JSON documents of several commands share.

use serde::Serialize;

/// A motor and the output that drives it.
#[derive(Serialize)]
pub(crate) struct Motor<'a> {
    number: u16,
    output: &'a str,
    source: &'a str,
}

impl<'a> From<&'a flightlog::Motor> for Motor<'a> {
    fn from(motor: &'a flightlog::Motor) -> Self {
        Motor {
            number: motor.number,
            output: &motor.output,
            source: &motor.source,
        }
    }
}

/// A range of commands.
#[derive(Serialize)]
pub(crate) struct Range<'a> {
    low: f64,
    high: f64,
    unit: &'a str,
    source: &'a str,
}

impl<'a> From<&'a flightlog::Range> for Range<'a> {
    fn from(range: &'a flightlog::Range) -> Self {
        Range {
            low: range.low,
            high: range.high,
            unit: range.unit,
            source: &range.source,
        }
    }
}

/// How the reading went.
#[derive(Serialize)]
pub(crate) struct Read<'a> {
    bytes: u64,
    messages: u64,
    skipped_bytes: u64,
    bad_messages: u64,
    truncated: bool,
    reason: Option<&'a str>,
}

impl<'a> From<&'a flightlog::Report> for Read<'a> {
    fn from(report: &'a flightlog::Report) -> Self {
        Read {
            bytes: report.bytes,
            messages: report.messages,
            skipped_bytes: report.skipped_bytes,
            bad_messages: report.bad_messages,
            truncated: report.truncated,
            reason: report.reason.as_deref(),
        }
    }
}
