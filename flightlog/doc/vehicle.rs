// What examples about a live vehicle start from: a quadrotor in the air that sends heartbeats.

use flightlog::mavlink::{Next, Packet, Sender, Telemetry, Version, dialect::*, next_packet, vehicle_of};

pub fn packet(bytes: &[u8]) -> Packet<'_> {
    let Next::Packet(packet) = next_packet(bytes) else {
        panic!("no packet")
    };
    packet
}

pub fn autopilot() -> (Sender, MavMessage) {
    let heartbeat = MavMessage::HEARTBEAT(HEARTBEAT_DATA {
        mavtype: MavType::MAV_TYPE_QUADROTOR,
        autopilot: MavAutopilot::MAV_AUTOPILOT_ARDUPILOTMEGA,
        base_mode: MavModeFlag::MAV_MODE_FLAG_SAFETY_ARMED,
        system_status: MavState::MAV_STATE_ACTIVE,
        ..HEARTBEAT_DATA::default()
    });
    (Sender::new(1), heartbeat)
}

/// The autopilot, its heartbeat as a message and as it was heard, and what follows the vehicle from there on.
pub fn followed() -> (Sender, MavMessage, Vec<u8>, Telemetry) {
    let (mut autopilot, heartbeat) = autopilot();
    let heard = autopilot.packet(Version::V2, 1, &heartbeat);
    let vehicle = vehicle_of(&packet(&heard)).expect("it tells its kind");
    let telemetry = Telemetry::new(&packet(&heard), vehicle);
    (autopilot, heartbeat, heard, telemetry)
}
