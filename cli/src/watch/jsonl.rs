//! `--jsonl`: what happens, one object a line.

use std::io;

use flagred::{
    estimator::Estimator,
    flight::{Cause, Verdict},
    monitor::Update,
    verdict::{Level, MotorFinding},
};
use flightlog::{Motor, Range, Vehicle};
use serde::Serialize;

use super::{
    lines::teller,
    session::{Doubt, Doubts, End, Event, Flown, Left, Lost, Session, Silent, Source},
};
use crate::assessment::document::{FindingDocument, numbered};

/// What an event adds to its kind and time; names are those of docs/json.md.
#[derive(Serialize)]
#[serde(tag = "event", rename_all = "snake_case")]
pub(crate) enum EventLine<'a> {
    Started {
        schema: &'static str,
        endpoint: &'a str,
        profile: &'a str,
    },
    Found(About<'a>),
    Locked {
        system: u8,
        address: Source,
    },
    GivenUp {
        system: u8,
    },
    SenderChanged {
        system: u8,
        from: Source,
        to: Source,
    },
    Doubt {
        what: Doubt,
        system: u8,
        component: u8,
        address: Source,
    },
    AnotherWatch {
        system: u8,
        component: Option<u8>,
        speaks: bool,
    },
    AnotherVehicle {
        system: u8,
    },
    NotAMultirotor(About<'a>),
    Ready {
        motors: &'a [Motor],
        range: &'a Range,
        effective_range: &'a Range,
        assumed: &'a [String],
    },
    Note {
        text: &'a str,
    },
    Lost {
        what: Silent,
    },
    Back {
        what: Silent,
        after_s: f64,
    },
    Rebooted,
    TookOff {
        t_s: f64,
    },
    Risk(Risk<'a>),
    Level {
        t_s: f64,
        level: Level,
        text: &'a str,
        /// Those of the finding that the level rests on.
        cause: Option<&'a Cause>,
        motor: Option<MotorFinding>,
    },
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
}

#[derive(Serialize)]
pub(crate) struct About<'a> {
    system: u8,
    kind: String,
    frame: Option<&'a str>,
    firmware: Option<&'a str>,
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
        Event::Found { system, vehicle } => EventLine::Found(About::new(*system, vehicle)),
        Event::Locked { system, source } => EventLine::Locked {
            system: *system,
            address: *source,
        },
        Event::GivenUp { system } => EventLine::GivenUp { system: *system },
        Event::SenderChanged { system, from, to } => EventLine::SenderChanged {
            system: *system,
            from: *from,
            to: *to,
        },
        Event::Doubt {
            what,
            system,
            component,
            source,
        } => EventLine::Doubt {
            what: *what,
            system: *system,
            component: *component,
            address: *source,
        },
        Event::AnotherWatch {
            system,
            component,
            speaks,
        } => EventLine::AnotherWatch {
            system: *system,
            component: *component,
            speaks: *speaks,
        },
        Event::Another { system } => EventLine::AnotherVehicle { system: *system },
        Event::NotAMultirotor { system, vehicle } => {
            EventLine::NotAMultirotor(About::new(*system, vehicle))
        }
        Event::Ready { setup } => EventLine::Ready {
            motors: &setup.motors,
            range: &setup.range,
            effective_range: &setup.effective,
            assumed: &setup.assumed,
        },
        Event::Note { text } => EventLine::Note { text },
        Event::Lost { what } => EventLine::Lost { what: *what },
        Event::Back { what, after_s } => EventLine::Back {
            what: *what,
            after_s: *after_s,
        },
        Event::Rebooted => EventLine::Rebooted,
        Event::TookOff { t_s } => EventLine::TookOff { t_s: *t_s },
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
        Event::Level {
            t_s,
            level,
            text,
            finding,
        } => EventLine::Level {
            t_s: *t_s,
            level: *level,
            text,
            cause: finding.as_ref().and_then(|finding| finding.cause.as_ref()),
            motor: finding.as_ref().and_then(|finding| {
                let motors = view.as_ref()?.setup?.motors.as_slice();
                numbered(finding, motors).motor
            }),
        },
        Event::Ended { finding } => {
            let teller = teller(view.as_ref(), estimator);
            EventLine::Finding(FindingDocument::new(finding, teller))
        }
        Event::Over { end, flown } => match end {
            End::Landed => EventLine::Landed(FlownLine::new(flown, None)),
            End::Lost(lost) => EventLine::LostInAir(FlownLine::new(flown, Some(*lost))),
            End::Left(left) => EventLine::LeftInAir(FlownLine::new(flown, Some(*left))),
        },
    };
    json_line(at_s, line).map(Some)
}

/// A line as one object.
pub(crate) fn json_line(at_s: f64, line: EventLine<'_>) -> io::Result<String> {
    let text = serde_json::to_string(&At {
        at_s: (at_s * 1e3).round() / 1e3,
        line,
    })?;
    Ok(text + "\n")
}

impl<'a> About<'a> {
    fn new(system: u8, vehicle: &'a Vehicle) -> Self {
        About {
            system,
            kind: vehicle.kind.to_string(),
            frame: vehicle.frame.as_deref(),
            firmware: vehicle.firmware.as_deref(),
        }
    }
}
