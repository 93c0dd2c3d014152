//! `--jsonl`: events as JSON, one object per line.

use std::io;

use flagred::{
    estimator::Estimator,
    flight::{Verdict, VerdictWord},
    monitor::Update,
    verdict::Level,
};
use schemars::JsonSchema;
use serde::Serialize;

use super::{
    lines::teller,
    session::{Doubts, End, Event, FlightSummary, Lost, Session, StopReason},
};
use flagred_report::document::FindingDocument;

/// The versions of the layouts. They change when a name is removed or changes its meaning.
const SCHEMA: &str = "flagred.watch/1";
const FLEET_SCHEMA: &str = "flagred.watch-all/1";

/// What a line says; names are those of docs/json.md.
#[derive(Serialize, JsonSchema)]
#[schemars(inline)]
#[serde(tag = "event", rename_all = "snake_case")]
#[expect(
    clippy::large_enum_variant,
    reason = "a line is printed as soon as it is made"
)]
pub(crate) enum EventLine<'a> {
    /// The first line.
    Started {
        #[schemars(extend("const" = SCHEMA))]
        schema: &'static str,
        /// Where packets are received.
        endpoint: &'a str,
        /// The name of the profile.
        profile: &'a str,
    },
    /// A sample in the air was assessed.
    Risk(Risk<'a>),
    /// A finding ended.
    Finding(FindingDocument<'a>),
    /// The vehicle landed.
    Landed(FlownLine<'a>),
    /// The vehicle was in the air when it was last known.
    LostInAir {
        #[serde(flatten)]
        flown: FlownLine<'a>,
        /// What was lost.
        why: Lost,
    },
    /// The flight is not followed to its end.
    LeftInAir {
        #[serde(flatten)]
        flown: FlownLine<'a>,
        /// Why it is not followed.
        why: StopReason,
    },
    /// The watch ended.
    Ended {
        /// The worst verdict of the flights; one lost in the air is not GOOD.
        worst: VerdictWord,
        /// Why there is no verdict.
        reason: Option<String>,
        /// Bytes that belong to no packet.
        skipped_bytes: u64,
        /// Packets that were damaged.
        bad_checksums: u64,
        /// Packets with a message that is not known.
        unknown_messages: u64,
        /// Signed packets that could not be verified without a key.
        signed: u64,
        /// Packets refused because they are not signed (`--key`).
        unsigned: u64,
        /// Packets refused because their signature is wrong or came before (`--key`).
        bad_signatures: u64,
        /// What was not believed.
        not_believed: Doubts,
        /// Packets that could not be sent.
        unsent: u64,
        /// Lines that a slow reader did not get.
        dropped_lines: u64,
    },
    /// Any other event.
    #[serde(untagged)]
    Plain(&'a Event),
}

impl<'a> EventLine<'a> {
    /// Returns the first line.
    pub(crate) fn started(endpoint: &'a str, profile: &'a str) -> EventLine<'a> {
        EventLine::Started {
            schema: SCHEMA,
            endpoint,
            profile,
        }
    }
}

#[derive(Serialize, JsonSchema)]
#[schemars(inline)]
pub(crate) struct Risk<'a> {
    #[serde(flatten)]
    update: &'a Update,
    /// The mean margin over all motors and the window of the profile.
    margin: Option<f64>,
    /// The standard deviation of the commands over all motors and the window of the profile.
    spread: Option<f64>,
    /// The effective command of each motor; null where it is unknown.
    #[schemars(with = "Vec<Option<f64>>")]
    motors: &'a [f64],
    /// Why the risk is unknown.
    unknown: Option<String>,
}

/// What was seen of a flight.
#[derive(Serialize, JsonSchema)]
#[schemars(inline)]
pub(crate) struct FlownLine<'a> {
    /// The latest time on the clock of the vehicle, in seconds.
    t_s: Option<f64>,
    #[serde(flatten)]
    verdict: &'a Verdict,
    /// The level of what was seen; null where too little was.
    level_seen: Option<Level>,
    /// The highest risk that was seen, in %.
    risk_max: Option<f64>,
}

impl<'a> FlownLine<'a> {
    fn new(flown: &'a FlightSummary) -> Self {
        FlownLine {
            t_s: flown.t_s,
            verdict: &flown.verdict,
            level_seen: flown.level_seen,
            risk_max: flown.risk_max,
        }
    }
}

/// A line of `--jsonl`.
#[derive(Serialize, JsonSchema)]
#[schemars(rename = "WatchLine")]
pub(crate) struct Line<'a> {
    /// The receiver's clock, in seconds since the start.
    at_s: f64,
    #[serde(flatten)]
    line: EventLine<'a>,
}

/// A line of `--all --jsonl`.
#[derive(Serialize, JsonSchema)]
#[serde(untagged)]
#[expect(
    clippy::large_enum_variant,
    reason = "a line is printed as soon as it is made"
)]
pub(crate) enum FleetLine<'a> {
    /// The first line.
    Started {
        #[schemars(extend("const" = FLEET_SCHEMA))]
        schema: &'static str,
        /// Where packets are received.
        endpoints: &'a [String],
        /// The name of the profile.
        profile: &'a str,
    },
    /// A message about an endpoint.
    Note {
        /// The receiver's clock, in seconds since the start.
        at_s: f64,
        /// The message.
        note: &'a str,
    },
    /// An event of one vehicle.
    Event {
        /// Its system, and the address or endpoint where it is heard: `7@192.0.2.5:14550`.
        vehicle: String,
        /// A line of `flagred.watch/1`.
        watch: Line<'a>,
    },
    /// The summary of one vehicle, at the end; the gravest comes first.
    Summary {
        /// As in its events.
        vehicle: &'a str,
        /// The worst verdict of its flights.
        verdict: VerdictWord,
        /// Why there is no verdict.
        reason: Option<String>,
        /// What to do about it.
        help: Option<&'static str>,
        /// The highest risk that was seen, in %.
        risk_max: Option<f64>,
        /// The share of its packets that was lost.
        #[schemars(range(min = 0, max = 1))]
        lost_share: f64,
    },
    /// The last line.
    Ended {
        /// The worst verdict of all vehicles.
        worst: VerdictWord,
        /// The number of vehicles with a summary.
        vehicles: usize,
        /// Heartbeats of vehicles beyond the 1,000 that are followed at a time.
        heartbeats_refused: u64,
        /// Vehicles that are gone and beyond the 10,000 of the summary.
        vehicles_left_out: u64,
        /// Lines that a slow reader did not get.
        dropped_lines: u64,
    },
}

impl<'a> FleetLine<'a> {
    /// Returns the first line.
    pub(crate) fn started(endpoints: &'a [String], profile: &'a str) -> FleetLine<'a> {
        FleetLine::Started {
            schema: FLEET_SCHEMA,
            endpoints,
            profile,
        }
    }
}

/// Returns the line of an event; `None` for samples on the ground, which have no risk.
pub(crate) fn line<'a>(
    at_s: f64,
    event: &'a Event,
    session: &'a Session<'_>,
    estimator: &'a Estimator,
) -> Option<Line<'a>> {
    let view = session.view();
    let line = match event {
        Event::Risk { update } => {
            let view = view.filter(|view| view.is_in_air)?;
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
            End::Landed => EventLine::Landed(FlownLine::new(flown)),
            End::Lost(why) => EventLine::LostInAir {
                flown: FlownLine::new(flown),
                why: *why,
            },
            End::LeftInAir(why) => EventLine::LeftInAir {
                flown: FlownLine::new(flown),
                why: *why,
            },
        },
        event => EventLine::Plain(event),
    };
    Some(Line::new(at_s, line))
}

/// Serialises a line.
pub(crate) fn text(line: &impl Serialize) -> io::Result<String> {
    Ok(serde_json::to_string(line)? + "\n")
}

impl<'a> Line<'a> {
    /// Creates a line with the time of the receiver's clock.
    pub(crate) fn new(at_s: f64, line: EventLine<'a>) -> Line<'a> {
        let at_s = rounded(at_s);
        Line { at_s, line }
    }
}

/// Rounds a time to milliseconds.
pub(crate) fn rounded(at_s: f64) -> f64 {
    (at_s * 1e3).round() / 1e3
}
