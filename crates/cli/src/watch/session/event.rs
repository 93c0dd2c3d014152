//! Events of a watch.

use flagred::{
    flight::{Cause, Finding, Verdict},
    monitor::Update,
    verdict::{Level, MotorFinding},
};
use flagred_flightlog::{Parameter, Vehicle, VehicleKind, mavlink::Setup};
use schemars::JsonSchema;
use serde::{Serialize, Serializer};

use super::{Doubt, Source};

/// Something to tell. Serialised it is a line of `--jsonl`, with the names of docs/json.md.
#[derive(Debug, Clone, Serialize, JsonSchema)]
#[schemars(inline)]
#[serde(tag = "event", rename_all = "snake_case")]
#[expect(
    clippy::large_enum_variant,
    reason = "the large ones are the risks of samples, which are most of them"
)]
pub(crate) enum Event {
    /// A vehicle was found.
    Found {
        /// Its MAVLink system.
        system: u8,
        #[serde(flatten, serialize_with = "about")]
        #[schemars(with = "About<'_>")]
        vehicle: Vehicle,
    },
    /// The vehicle sends motor commands: it is believed, and nobody else in its name.
    Locked {
        system: u8,
        /// The sender's address and port; null on a serial port.
        #[schemars(with = "Option<String>")]
        address: Source,
    },
    /// The vehicle that is followed is given up for another one.
    GivenUp { system: u8 },
    /// It is heard from another address after it had fallen silent.
    SenderChanged {
        system: u8,
        #[schemars(with = "Option<String>")]
        from: Source,
        #[schemars(with = "Option<String>")]
        to: Source,
    },
    /// Something in its name is not believed; told once of each kind.
    Doubt {
        what: Doubt,
        system: u8,
        component: u8,
        /// The sender's address and port; null on a serial port.
        #[schemars(with = "Option<String>")]
        address: Source,
    },
    /// Another watch of the vehicle is heard, or none any more; and whether this one speaks.
    AnotherWatch {
        system: u8,
        /// The component that sends the risk too; null where it is not heard any more.
        component: Option<u8>,
        /// Whether this watch sends warnings.
        speaks: bool,
    },
    /// Another vehicle is on the link; it is not followed.
    AnotherVehicle { system: u8 },
    /// The vehicle that was found is no multirotor; there is nothing to say about it.
    NotAMultirotor {
        system: u8,
        #[serde(flatten, serialize_with = "about")]
        #[schemars(with = "About<'_>")]
        vehicle: Vehicle,
    },
    /// Motors and limits are known, or assumed; again where they became known better.
    Ready {
        #[serde(flatten)]
        setup: Setup,
        /// The parameters that they rest on, and gains, as far as they are known.
        parameters: Vec<Parameter>,
    },
    /// Motor commands come too rarely since somebody else asked for less, or the link became too slow; with the station
    /// that asked, where the vehicle told it.
    Slowed {
        /// Motor commands a second.
        rate_hz: f64,
        /// The rate that was requested.
        wanted_hz: f64,
        system: Option<u8>,
        component: Option<u8>,
    },
    /// Something in words.
    Note { text: String },
    /// Nothing comes any more.
    Lost { what: Silent },
    /// It comes again.
    Back {
        what: Silent,
        /// The seconds of silence.
        after_s: f64,
    },
    /// The vehicle started anew.
    Rebooted,
    /// A flight began.
    TookOff {
        /// The time on the clock of the vehicle, in seconds.
        t_s: f64,
    },
    /// The level changed in flight, with the words, the motor and the cause of the finding that it rests on. It is unknown where the
    /// risk became unknown while an alarm stood.
    Level {
        t_s: f64,
        /// The new level; null where the risk became unknown while an alarm stood.
        level: Option<Level>,
        /// The level before; null where it was unknown.
        before: Option<Level>,
        /// The text to the ground station, at most 50 characters.
        text: String,
        /// What kind of finding it rests on: a stable word for programs.
        code: Option<String>,
        /// What to do.
        advice: Option<String>,
        motor: Option<MotorFinding>,
        cause: Option<Cause>,
    },
    /// A sample was assessed. Its line also has how things stand.
    #[serde(skip)]
    Risk { update: Update },
    /// A finding ended. Its line has it in words, too.
    #[serde(skip)]
    Ended { finding: Finding },
    /// A flight is over, or what was seen of it. Its line is called after its end.
    #[serde(skip)]
    Over { end: End, flown: FlightSummary },
}

/// A vehicle in an event.
#[derive(Serialize, JsonSchema)]
struct About<'a> {
    /// What kind it is, such as `multirotor`.
    kind: VehicleKind,
    /// Frame or type name.
    frame: Option<&'a str>,
    /// Firmware with version.
    firmware: Option<&'a str>,
}

fn about<S: Serializer>(vehicle: &Vehicle, serializer: S) -> Result<S::Ok, S::Error> {
    let about = About {
        kind: vehicle.kind,
        frame: vehicle.frame.as_deref(),
        firmware: vehicle.firmware.as_deref(),
    };
    about.serialize(serializer)
}

/// How a flight ended, or the part of it that was received.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum End {
    /// The vehicle landed.
    Landed,
    /// The vehicle was in the air when contact was lost.
    Lost(Lost),
    /// The vehicle is still in the air and is received.
    LeftInAir(StopReason),
}

/// What was lost in the air.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub(crate) enum Lost {
    Link,
    MotorCommands,
    /// The vehicle rebooted.
    Reboot,
}

/// Why a flight is not followed to its end.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub(crate) enum StopReason {
    /// The watch ended.
    WatchEnded,
    /// Motors or limits became known too late to assess the flight so far anew: the rest is a flight of its own.
    SetUpAnew,
}

/// A flight, or the part of it that was received.
#[derive(Debug, Clone)]
pub(crate) struct FlightSummary {
    /// The latest time of the vehicle's clock.
    pub(crate) t_s: Option<f64>,
    pub(crate) verdict: Verdict,
    /// The level of the received part; `None` if it was too short.
    pub(crate) level_seen: Option<Level>,
    pub(crate) risk_max: Option<f64>,
}

/// What fell silent.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub(crate) enum Silent {
    Link,
    MotorCommands,
}
