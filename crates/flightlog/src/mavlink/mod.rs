//! MAVLink, live and in telemetry logs: packets out of bytes, and the state of a vehicle out of its
//! packets.
//!
//! Nothing here opens a port: bytes and the time come in, packets and bytes to send go out.

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
#[cfg(feature = "mavlink")]
mod signing;
mod stream;
#[cfg(feature = "mavlink")]
mod telemetry;

/// The messages, as the MAVLink project defines them for ArduPilot; they hold those common to all autopilots.
#[cfg(feature = "mavlink")]
pub use ::mavlink::dialects::ardupilotmega as dialect;

#[cfg(feature = "mavlink")]
pub use heartbeat::vehicle_of;
pub use packet::{Next, Packet, Version, Why, next_packet};
#[cfg(feature = "mavlink")]
pub use requests::{MOTOR_RATE_HZ, Requests, parameters_known};
#[cfg(feature = "mavlink")]
pub use send::Sender;
#[cfg(feature = "mavlink")]
pub use setup::Setup;
#[cfg(feature = "mavlink")]
pub use signing::Key;
pub use stream::{Skipped, Stream};
#[cfg(feature = "mavlink")]
pub use telemetry::{News, Pulses, Telemetry};
