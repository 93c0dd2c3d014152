//! Events of a watch.

use flagred::{
    flight::{Cause, Finding, Verdict},
    monitor::Update,
    verdict::{Level, MotorFinding},
};
use flagred_flightlog::{Parameter, Vehicle, VehicleKind, mavlink::Setup};
use schemars::JsonSchema;
use serde::{Serialize, Serializer};

use super::{Source, UntrustedPacket};

/// An event of a watch. Its serialised form is a line of `--jsonl`; `docs/json.md` describes the fields.
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
        /// The MAVLink system id of the vehicle.
        system: u8,
        #[serde(flatten, serialize_with = "about")]
        #[schemars(with = "VehicleDescription<'_>")]
        vehicle: Vehicle,
    },
    /// The vehicle sends motor commands and is trusted; other senders with its system id are not.
    Locked {
        system: u8,
        /// The sender's address and port; null on a serial port.
        #[schemars(with = "Option<String>")]
        address: Source,
    },
    /// The vehicle is no longer followed, because another one is followed instead.
    GivenUp { system: u8 },
    /// After a silence, the vehicle is received from another address.
    SenderChanged {
        system: u8,
        #[schemars(with = "Option<String>")]
        from: Source,
        #[schemars(with = "Option<String>")]
        to: Source,
    },
    /// Packets with the system id of the vehicle are not trusted; reported once for each kind.
    Doubt {
        what: UntrustedPacket,
        system: u8,
        component: u8,
        /// The sender's address and port; null on a serial port.
        #[schemars(with = "Option<String>")]
        address: Source,
    },
    /// Another watch of the same vehicle is received, or is no longer received.
    AnotherWatch {
        system: u8,
        /// The MAVLink component of the other watch; null if it is no longer received.
        component: Option<u8>,
        /// Whether this watch sends warnings.
        #[serde(rename = "speaks")]
        is_sending: bool,
    },
    /// Another vehicle is on the link; it is not followed.
    AnotherVehicle { system: u8 },
    /// The vehicle is not a multirotor, so it is not followed.
    NotAMultirotor {
        system: u8,
        #[serde(flatten, serialize_with = "about")]
        #[schemars(with = "VehicleDescription<'_>")]
        vehicle: Vehicle,
    },
    /// Motors and limits are known or assumed. The event is repeated when more about them becomes known.
    Ready {
        #[serde(flatten)]
        setup: Setup,
        /// The parameters that determine motors and limits, and the gains, as far as they are known.
        parameters: Vec<Parameter>,
    },
    /// The rate of motor commands is too low, because another station requested a lower rate or the link is too slow.
    /// The station is included if the vehicle reported it.
    Slowed {
        /// The number of motor commands per second.
        rate_hz: f64,
        /// The rate that was requested.
        wanted_hz: f64,
        system: Option<u8>,
        component: Option<u8>,
    },
    /// A message as text.
    Note { text: String },
    /// The link or the motor commands are lost.
    Lost { what: SilentSource },
    /// The link or the motor commands are back.
    Back {
        what: SilentSource,
        /// The duration of the silence, in seconds.
        after_s: f64,
    },
    /// The vehicle rebooted.
    Rebooted,
    /// A flight began.
    TookOff {
        /// The time on the clock of the vehicle, in seconds.
        t_s: f64,
    },
    /// The level changed in flight, with the texts, the motor and the cause of the finding behind it. The new level is
    /// unknown if the risk became unknown during an alarm.
    Level {
        t_s: f64,
        /// The new level; null if the risk became unknown during an alarm.
        level: Option<Level>,
        /// The previous level; null if it was unknown.
        before: Option<Level>,
        /// The text to the ground station, at most 50 characters.
        text: String,
        /// The code of the finding behind the level: a stable identifier for use by programs.
        code: Option<String>,
        /// What to do.
        advice: Option<String>,
        motor: Option<MotorFinding>,
        cause: Option<Cause>,
    },
    /// A sample was assessed. Its line also contains the current state.
    #[serde(skip)]
    Risk { update: Update },
    /// A finding ended. Its line also contains the finding as text.
    #[serde(skip)]
    Ended { finding: Finding },
    /// A flight, or the observed part of it, is over. The kind of its line in the output depends on how the flight
    /// ended.
    #[serde(skip)]
    Over { end: End, flown: FlightSummary },
}

/// The description of a vehicle in an event.
#[derive(Serialize, JsonSchema)]
struct VehicleDescription<'a> {
    /// The kind of vehicle, such as `multirotor`.
    kind: VehicleKind,
    /// Frame or type name.
    frame: Option<&'a str>,
    /// Firmware with version.
    firmware: Option<&'a str>,
}

fn about<S: Serializer>(vehicle: &Vehicle, serializer: S) -> Result<S::Ok, S::Error> {
    let about = VehicleDescription {
        kind: vehicle.kind,
        frame: vehicle.frame.as_deref(),
        firmware: vehicle.firmware.as_deref(),
    };
    about.serialize(serializer)
}

/// The way in which a flight, or the received part of it, ended.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum End {
    /// The vehicle landed.
    Landed,
    /// The vehicle was in the air when contact was lost.
    Lost(ContactLoss),
    /// The vehicle is still in the air and still received, but the flight is no longer followed.
    LeftInAir(StopReason),
}

/// The reason why contact was lost in the air.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub(crate) enum ContactLoss {
    Link,
    MotorCommands,
    /// The vehicle rebooted.
    Reboot,
}

/// The reason why a flight is not followed to its end.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub(crate) enum StopReason {
    /// The watch ended while the vehicle was in the air.
    WatchEnded,
    /// Motors or limits became known too late to assess the flight again from its beginning: the
    /// rest is assessed as a separate flight.
    #[serde(rename = "set_up_anew")]
    Reconfigured,
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

/// The source that fell silent.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub(crate) enum SilentSource {
    Link,
    MotorCommands,
}
