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
    lines::finding_context,
    session::{ContactLoss, End, Event, FlightSummary, Session, StopReason, UntrustedCounts},
};
use flagred_report::document::FindingDocument;

// The versions of the layouts increase when a name is removed or changes its meaning.
/// The layout of `--jsonl`.
const SCHEMA: &str = "flagred.watch/1";
/// The layout of `--all --jsonl`.
const FLEET_SCHEMA: &str = "flagred.watch-all/1";

/// The content of a line. `docs/json.md` describes its fields.
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
        /// The endpoint at which packets are received.
        endpoint: &'a str,
        /// The name of the profile.
        profile: &'a str,
    },
    /// A sample in the air was assessed.
    Risk(Risk<'a>),
    /// A finding ended.
    Finding(FindingDocument<'a>),
    /// The vehicle landed.
    Landed(ObservedFlightLine<'a>),
    /// The vehicle was in the air when contact was lost.
    LostInAir {
        #[serde(flatten)]
        flown: ObservedFlightLine<'a>,
        /// The reason why contact was lost: the link, the motor commands, or a reboot of the vehicle.
        why: ContactLoss,
    },
    /// The vehicle is still in the air, but the flight is no longer followed.
    LeftInAir {
        #[serde(flatten)]
        flown: ObservedFlightLine<'a>,
        /// The reason why the flight is no longer followed.
        why: StopReason,
    },
    /// The watch ended.
    Ended {
        /// The worst verdict of the flights; the verdict of a flight that was lost in the air is not GOOD.
        worst: VerdictWord,
        /// The reason why there is no verdict.
        reason: Option<String>,
        /// The number of bytes that do not belong to a packet.
        skipped_bytes: u64,
        /// The number of damaged packets.
        bad_checksums: u64,
        /// The number of packets with an unknown message.
        unknown_messages: u64,
        /// The number of signed packets, which could not be verified without a key.
        signed: u64,
        /// The number of packets refused because they are not signed (`--key`).
        unsigned: u64,
        /// The number of packets refused because their signature is wrong or repeated (`--key`).
        bad_signatures: u64,
        /// The counts of packets that were not trusted.
        not_believed: UntrustedCounts,
        /// The number of packets that could not be sent.
        unsent: u64,
        /// The number of lines that were dropped because the reader was too slow.
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
    /// The reason why the risk is unknown.
    unknown: Option<String>,
}

/// The observed part of a flight.
#[derive(Serialize, JsonSchema)]
#[schemars(inline)]
pub(crate) struct ObservedFlightLine<'a> {
    /// The latest time on the clock of the vehicle, in seconds.
    t_s: Option<f64>,
    #[serde(flatten)]
    verdict: &'a Verdict,
    /// The level of the observed part; null if it was too short.
    level_seen: Option<Level>,
    /// The highest observed risk, in %.
    risk_max: Option<f64>,
}

impl<'a> ObservedFlightLine<'a> {
    fn new(flown: &'a FlightSummary) -> Self {
        ObservedFlightLine {
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
        /// The endpoints at which packets are received.
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
        /// The system id of the vehicle, and the address or endpoint at which its packets arrive: `7@192.0.2.5:14550`.
        vehicle: String,
        /// A line of `flagred.watch/1`.
        watch: Line<'a>,
    },
    /// The summary of one vehicle, printed at the end, the most severe first.
    Summary {
        /// The vehicle, as in its events.
        vehicle: &'a str,
        /// The worst verdict of the vehicle's flights.
        verdict: VerdictWord,
        /// The reason why there is no verdict.
        reason: Option<String>,
        /// Advice on how to get a verdict.
        help: Option<&'static str>,
        /// The highest observed risk, in %.
        risk_max: Option<f64>,
        /// The share of the vehicle's packets that were lost.
        #[schemars(range(min = 0, max = 1))]
        lost_share: f64,
    },
    /// The last line.
    Ended {
        /// The worst verdict of all vehicles.
        worst: VerdictWord,
        /// The number of vehicles with a summary.
        vehicles: usize,
        /// The number of heartbeats that were ignored because they came from further vehicles while 1,000 vehicles were
        /// already followed.
        heartbeats_refused: u64,
        /// The number of vehicles that are no longer received and are missing from the summary,
        /// which lists at most 10,000.
        vehicles_left_out: u64,
        /// The number of lines that were dropped because the reader was too slow.
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
            let context = finding_context(view.as_ref(), estimator);
            EventLine::Finding(FindingDocument::new(finding, context))
        }
        Event::Over { end, flown } => match end {
            End::Landed => EventLine::Landed(ObservedFlightLine::new(flown)),
            End::Lost(why) => EventLine::LostInAir {
                flown: ObservedFlightLine::new(flown),
                why: *why,
            },
            End::LeftInAir(why) => EventLine::LeftInAir {
                flown: ObservedFlightLine::new(flown),
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
