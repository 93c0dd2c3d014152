//! MAVLink as a vehicle speaks it, live or in a telemetry log: packets out of bytes, and what a vehicle's packets
//! tell about its motors.
//!
//! Nothing here opens a port: bytes come in, packets and bytes to send go out, and time is passed in.

mod packet;
//mod requests;
mod send;
mod stream;
//mod vehicle;

/// The messages, as the MAVLink project defines them for ArduPilot; they hold those common to all autopilots.
pub use ::mavlink::dialects::ardupilotmega as dialect;

pub use packet::{Next, Packet, Version, Why, next_packet};
//pub use requests::{MOTOR_RATE_HZ, Requests};
pub use send::Sender;
pub use stream::{Skipped, Stream};
//pub use vehicle::{News, Setup, Vehicle, is_in_air, vehicle_of};
