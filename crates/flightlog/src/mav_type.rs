//! MAV_TYPE, the type of a vehicle in MAVLink and PX4
//! (<https://mavlink.io/en/messages/common.html#MAV_TYPE>).

use crate::VehicleKind;

/// A kind of vehicle.
pub(crate) struct MavType {
    pub(crate) kind: VehicleKind,
    pub(crate) name: &'static str,
    /// The number of motors, if the type determines it.
    pub(crate) motors: Option<u16>,
}

/// The meaning of a MAV_TYPE; `None` for a generic vehicle and for types that are not vehicles, such as a ground
/// station or a gimbal.
pub(crate) fn mav_type(number: i64) -> Option<MavType> {
    use VehicleKind::{Helicopter, Multirotor, Other, Plane, Rover, Submarine, Vtol};
    let (kind, name, motors) = match number {
        1 => (Plane, "fixed wing", None),
        2 => (Multirotor, "quadrotor", Some(4)),
        3 => (Helicopter, "coaxial helicopter", None),
        4 => (Helicopter, "helicopter", None),
        5 => (Other, "antenna tracker", None),
        7 => (Other, "airship", None),
        8 => (Other, "balloon", None),
        9 => (Other, "rocket", None),
        10 => (Rover, "rover", None),
        11 => (Rover, "boat", None),
        12 => (Submarine, "submarine", None),
        13 => (Multirotor, "hexarotor", Some(6)),
        14 => (Multirotor, "octorotor", Some(8)),
        15 => (Multirotor, "tricopter", Some(3)),
        16 => (Other, "flapping wing", None),
        17 => (Other, "kite", None),
        19..=25 => (Vtol, "VTOL", None),
        28 => (Other, "parafoil", None),
        29 => (Multirotor, "dodecarotor", Some(12)),
        35 => (Multirotor, "decarotor", Some(10)),
        _ => return None,
    };
    Some(MavType { kind, name, motors })
}
