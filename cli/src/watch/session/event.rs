//! What a watch tells.

use flagred::{
    flight::{Finding, Verdict},
    monitor::Update,
    verdict::Level,
};
use flightlog::{Vehicle, mavlink::Setup};

use super::{Doubt, Source};

/// Something to tell.
#[derive(Debug, Clone)]
pub(crate) enum Event {
    /// A vehicle was found.
    Found { system: u8, vehicle: Vehicle },
    /// The vehicle sends motor commands: it is believed, and nobody else in its name.
    Locked { system: u8, source: Source },
    /// The vehicle that is followed is given up for another one.
    GivenUp { system: u8 },
    /// It is heard from another address after it had fallen silent.
    SenderChanged {
        system: u8,
        from: Source,
        to: Source,
    },
    /// Something in its name is not believed; told once of each kind.
    Doubt {
        what: Doubt,
        system: u8,
        component: u8,
        source: Source,
    },
    /// Another watch of the vehicle is heard, or none any more; and whether this one speaks.
    AnotherWatch {
        system: u8,
        component: Option<u8>,
        speaks: bool,
    },
    /// Another vehicle is on the link; it is not followed.
    Another { system: u8 },
    /// The vehicle that was found is no multirotor; there is nothing to say about it.
    NotAMultirotor { system: u8, vehicle: Vehicle },
    /// Motors and limits are known, or assumed; again where they became known better.
    Ready { setup: Setup },
    /// Something in words.
    Note { text: String },
    /// Nothing comes any more.
    Lost { what: Silent },
    /// It comes again.
    Back { what: Silent, after_s: f64 },
    /// The vehicle started anew.
    Rebooted,
    /// A flight began.
    TookOff { t_s: f64 },
    /// A sample was assessed.
    Risk { update: Update },
    /// The level changed in flight.
    Level {
        t_s: f64,
        level: Level,
        text: String,
        /// What the level rests on; `None` where it is good.
        finding: Option<Finding>,
    },
    /// A finding ended.
    Ended { finding: Finding },
    /// A flight is over, or what was seen of it.
    Over { end: End, flown: Flown },
}

/// How a flight, or what was seen of it, ended.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum End {
    /// The vehicle landed.
    Landed,
    /// It was in the air when it was last known.
    Lost(Lost),
    /// It is still in the air, and is heard.
    Left(Left),
}

/// What was lost in the air.
#[derive(Debug, Clone, Copy, PartialEq, Eq, serde::Serialize)]
#[serde(rename_all = "snake_case")]
pub(crate) enum Lost {
    Link,
    MotorCommands,
    /// The vehicle rebooted.
    Reboot,
}

/// Why a flight is not followed to its end.
#[derive(Debug, Clone, Copy, PartialEq, Eq, serde::Serialize)]
#[serde(rename_all = "snake_case")]
pub(crate) enum Left {
    /// The watch ended.
    WatchEnded,
    /// Motors or limits became known better: the rest is assessed as a flight of its own.
    SetUpAnew,
}

/// What was seen of a flight.
#[derive(Debug, Clone)]
pub(crate) struct Flown {
    /// The latest time of the vehicle's clock.
    pub(crate) t_s: Option<f64>,
    pub(crate) verdict: Verdict,
    /// The level of what was seen; `None` where too little was.
    pub(crate) level_seen: Option<Level>,
    pub(crate) risk_max: Option<f64>,
}

/// What fell silent.
#[derive(Debug, Clone, Copy, PartialEq, Eq, serde::Serialize)]
#[serde(rename_all = "snake_case")]
pub(crate) enum Silent {
    Link,
    #[serde(rename = "motor_commands")]
    Motors,
}
