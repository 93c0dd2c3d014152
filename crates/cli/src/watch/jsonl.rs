//! `--jsonl`: what happens, one object a line.

use std::io;

use flagred::{estimator::Estimator, flight::Verdict, monitor::Update, verdict::Level};
use serde::Serialize;

use super::{
    lines::teller,
    session::{Doubts, End, Event, Flown, Left, Lost, Session},
};
use flagred_report::document::FindingDocument;

/// A line; names are those of docs/json.md.
#[derive(Serialize)]
#[serde(tag = "event", rename_all = "snake_case")]
pub(crate) enum EventLine<'a> {
    Started {
        schema: &'static str,
        endpoint: &'a str,
        profile: &'a str,
    },
    Risk(Risk<'a>),
    Finding(FindingDocument<'a>),
    Landed(FlownLine<'a, ()>),
    LostInAir(FlownLine<'a, Lost>),
    LeftInAir(FlownLine<'a, Left>),
    Ended {
        worst: String,
        /// Why there is no verdict.
        reason: Option<String>,
        skipped_bytes: u64,
        bad_checksums: u64,
        unknown_messages: u64,
        signed: u64,
        unsigned: u64,
        bad_signatures: u64,
        not_believed: Doubts,
        unsent: u64,
        dropped_lines: u64,
    },
    /// Any other event says all by itself.
    #[serde(untagged)]
    Plain(&'a Event),
}

#[derive(Serialize)]
pub(crate) struct Risk<'a> {
    #[serde(flatten)]
    update: &'a Update,
    margin: Option<f64>,
    spread: Option<f64>,
    /// Effective commands.
    motors: &'a [f64],
    /// Why the risk is unknown.
    unknown: Option<String>,
}

/// What was seen of a flight.
#[derive(Serialize)]
pub(crate) struct FlownLine<'a, W> {
    t_s: Option<f64>,
    #[serde(flatten)]
    verdict: &'a Verdict,
    /// Why the end was not seen; absent from a landing.
    #[serde(skip_serializing_if = "Option::is_none")]
    why: Option<W>,
    level_seen: Option<Level>,
    risk_max: Option<f64>,
}

impl<'a, W> FlownLine<'a, W> {
    fn new(flown: &'a Flown, why: Option<W>) -> Self {
        FlownLine {
            t_s: flown.t_s,
            verdict: &flown.verdict,
            why,
            level_seen: flown.level_seen,
            risk_max: flown.risk_max,
        }
    }
}

/// A line with the receiver's time.
#[derive(Serialize)]
struct At<'a> {
    at_s: f64,
    #[serde(flatten)]
    line: EventLine<'a>,
}

/// An event as one object; `None` for samples on the ground, which have no risk.
pub(crate) fn json(
    at_s: f64,
    event: &Event,
    session: &Session<'_>,
    estimator: &Estimator,
) -> io::Result<Option<String>> {
    let view = session.view();
    let line = match event {
        Event::Risk { update } => {
            let Some(view) = view.filter(|view| view.is_in_air) else {
                return Ok(None);
            };
            let why = update.risk.err();
            EventLine::Risk(Risk {
                update,
                margin: view.margin,
                spread: view.spread,
                motors: view.motors,
                unknown: why.map(|unknown| unknown.explain(estimator.profile())),
            })
        }
        Event::Ended { finding } => {
            let teller = teller(view.as_ref(), estimator);
            EventLine::Finding(FindingDocument::new(finding, teller))
        }
        Event::Over { end, flown } => match end {
            End::Landed => EventLine::Landed(FlownLine::new(flown, None)),
            End::Lost(lost) => EventLine::LostInAir(FlownLine::new(flown, Some(*lost))),
            End::Left(left) => EventLine::LeftInAir(FlownLine::new(flown, Some(*left))),
        },
        event => EventLine::Plain(event),
    };
    json_line(at_s, line).map(Some)
}

/// A line as one object.
pub(crate) fn json_line(at_s: f64, line: EventLine<'_>) -> io::Result<String> {
    let text = serde_json::to_string(&At {
        at_s: rounded(at_s),
        line,
    })?;
    Ok(text + "\n")
}

/// A time to the millisecond.
pub(crate) fn rounded(at_s: f64) -> f64 {
    (at_s * 1e3).round() / 1e3
}
