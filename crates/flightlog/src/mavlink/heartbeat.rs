//! The vehicle that a heartbeat describes.

use super::{
    Packet,
    decoder::{AUTOPILOT, Decoder, filled},
};
use crate::Vehicle;

/// The vehicle that a heartbeat describes; `None` for other messages, and for components that are not vehicles, such as
/// ground stations, gimbals and radios, whose heartbeats have an armed flag too.
pub fn vehicle_of(packet: &Packet<'_>) -> Option<Vehicle> {
    if packet.component != AUTOPILOT || packet.id != 0 {
        return None;
    }
    let mut decoder = Decoder::default();
    decoder.message(packet.component, packet.id, &filled(packet));
    decoder.is_known().then(|| decoder.vehicle())
}
