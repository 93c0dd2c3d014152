//! MAVLink, live and in telemetry logs: decodes bytes to packets, and packets to the state of a vehicle.
//!
//! Nothing here opens a port. The caller passes bytes and the time, and receives packets and bytes to send.

mod checksum;
pub(crate) mod decoder;
#[cfg(feature = "mavlink")]
mod heartbeat;
pub(crate) mod outputs;
pub(crate) mod packet;
#[cfg(feature = "mavlink")]
mod requests;
#[cfg(feature = "mavlink")]
mod send;
pub(crate) mod servo;
#[cfg(feature = "mavlink")]
mod setup;
pub(crate) mod signals;
#[cfg(feature = "mavlink")]
mod signing;
mod stream;
#[cfg(feature = "mavlink")]
mod telemetry;

/// The messages that the MAVLink project defines for ArduPilot, including those common to all autopilots.
#[cfg(feature = "mavlink")]
pub use ::mavlink::dialects::ardupilotmega as dialect;

#[cfg(feature = "mavlink")]
pub use heartbeat::vehicle_of;
pub use packet::{Packet, PacketScan, SkipReason, Version, next_packet};
#[cfg(feature = "mavlink")]
pub use requests::{MOTOR_RATE_HZ, Requests, parameters_known};
#[cfg(feature = "mavlink")]
pub use send::Sender;
#[cfg(feature = "mavlink")]
pub use setup::Setup;
#[cfg(feature = "mavlink")]
pub use signing::Key;
pub use stream::{SkipCounts, Stream};
#[cfg(feature = "mavlink")]
pub use telemetry::{Pulses, Telemetry, TelemetryChange};
