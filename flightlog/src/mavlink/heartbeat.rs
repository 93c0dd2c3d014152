//! Messages out of packets, and what a heartbeat says of the vehicle that sends it.

use ::mavlink::Message;

use super::{
    Packet, Version,
    dialect::{MavAutopilot, MavLandedState, MavMessage, MavState},
};
use crate::{
    Vehicle,
    mav_type::{MavType, mav_type},
};

/// The component that is the autopilot.
pub(super) const AUTOPILOT: u8 = 1;
impl Packet<'_> {
    /// The message; `None` where a field holds a value that the dialect does not know.
    ///
    /// # Example
    /// ```
    /// # mod vehicle { include!(concat!(env!("CARGO_MANIFEST_DIR"), "/doc/vehicle.rs")); }
    /// # use flightlog::mavlink::{Version, dialect::*};
    /// # use vehicle::packet;
    /// # let (mut autopilot, heartbeat) = vehicle::autopilot();
    /// # let heartbeat = autopilot.packet(Version::V2, 1, &heartbeat);
    /// assert!(matches!(packet(&heartbeat).message(), Some(MavMessage::HEARTBEAT(_))));
    /// ```
    pub fn message(&self) -> Option<MavMessage> {
        MavMessage::parse(self.version.into(), self.id, self.payload).ok()
    }
}

impl From<Version> for ::mavlink::MavlinkVersion {
    fn from(version: Version) -> Self {
        match version {
            Version::V1 => Self::V1,
            Version::V2 => Self::V2,
        }
    }
}

/// The vehicle that a heartbeat speaks for; `None` for other messages and for what is no vehicle, such as ground
/// stations, gimbals and radios, whose heartbeats have an armed flag too.
///
/// # Example
/// ```
/// # mod vehicle { include!(concat!(env!("CARGO_MANIFEST_DIR"), "/doc/vehicle.rs")); }
/// # use flightlog::mavlink::{Sender, Version, dialect::*, vehicle_of};
/// # use vehicle::packet;
/// # let (mut autopilot, heartbeat) = vehicle::autopilot();
/// # let heartbeat = autopilot.packet(Version::V2, 1, &heartbeat);
/// let vehicle = vehicle_of(&packet(&heartbeat)).ok_or("no vehicle")?;
/// assert_eq!((vehicle.motors, vehicle.firmware.as_deref()), (Some(4), Some("ArduPilot")));
///
/// // A ground station beats too, and is no vehicle.
/// let ground_station = Sender::new(190).packet(Version::V2, 255, &MavMessage::HEARTBEAT(HEARTBEAT_DATA::default()));
/// assert!(vehicle_of(&packet(&ground_station)).is_none());
/// # Ok::<(), &str>(())
/// ```
pub fn vehicle_of(packet: &Packet<'_>) -> Option<Vehicle> {
    if packet.component != AUTOPILOT || packet.id != 0 {
        return None;
    }
    let Some(MavMessage::HEARTBEAT(heartbeat)) = packet.message() else {
        return None;
    };
    if heartbeat.autopilot == MavAutopilot::MAV_AUTOPILOT_INVALID {
        return None;
    }
    let number = heartbeat.mavtype as i64;
    let firmware = match heartbeat.autopilot {
        MavAutopilot::MAV_AUTOPILOT_ARDUPILOTMEGA => Some("ArduPilot".to_owned()),
        MavAutopilot::MAV_AUTOPILOT_PX4 => Some("PX4".to_owned()),
        _ => None,
    };
    let mut vehicle = Vehicle {
        source: format!("HEARTBEAT, type {number}"),
        firmware,
        ..Vehicle::default()
    };
    if let Some(MavType { kind, name, motors }) = mav_type(number) {
        vehicle.kind = kind;
        vehicle.frame = Some(name.to_owned());
        vehicle.motors = motors;
    }
    Some(vehicle)
}

/// Whether a vehicle is in the air, by what it says of itself.
///
/// EXTENDED_SYS_STATE says so in words. Without it, the state of the heartbeat is what tells: ArduPilot's is
/// "standby" while landed and "active", or "critical" after a failsafe, while not.
///
/// # Example
/// ```
/// use flightlog::mavlink::{dialect::{MavLandedState, MavState}, is_in_air};
///
/// assert!(is_in_air(true, Some(MavState::MAV_STATE_ACTIVE), None));
/// assert!(!is_in_air(true, Some(MavState::MAV_STATE_ACTIVE), Some(MavLandedState::MAV_LANDED_STATE_ON_GROUND)));
/// assert!(!is_in_air(false, Some(MavState::MAV_STATE_ACTIVE), None));
/// ```
pub fn is_in_air(armed: bool, state: Option<MavState>, landed: Option<MavLandedState>) -> bool {
    use MavLandedState::{
        MAV_LANDED_STATE_IN_AIR as IN_AIR, MAV_LANDED_STATE_LANDING as LANDING,
        MAV_LANDED_STATE_ON_GROUND as ON_GROUND, MAV_LANDED_STATE_TAKEOFF as TAKE_OFF,
    };
    use MavState::{
        MAV_STATE_ACTIVE as ACTIVE, MAV_STATE_CRITICAL as CRITICAL,
        MAV_STATE_EMERGENCY as EMERGENCY,
    };
    armed
        && match landed {
            Some(IN_AIR | LANDING | TAKE_OFF) => true,
            Some(ON_GROUND) => false,
            _ => matches!(state, Some(ACTIVE | CRITICAL | EMERGENCY)),
        }
}
