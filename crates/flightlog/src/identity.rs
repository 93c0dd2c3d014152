//! The identity of a vehicle: serial number of its board, MAVLink system id, number of boots.

use crate::Vehicle;
use crate::parameters::Parameters;

/// The parameters that contain the MAVLink system id: in ArduPilot up to 4.6, in later ArduPilot, and in PX4.
const SYSTEM_ID: [&str; 3] = ["SYSID_THISMAV", "MAV_SYSID", "MAV_SYS_ID"];

/// Adds the identity from parameters. A serial number that a person entered is used only if the board reports none.
pub(crate) fn add(vehicle: &mut Vehicle, parameters: &Parameters) {
    let whole = |name: &str| {
        let value = parameters.get(name)?;
        (value >= 1.0 && value.fract() == 0.0 && value <= f64::from(u32::MAX))
            .then_some(value as u32)
    };
    if vehicle.id.is_none()
        && let Some(number) = whole("BRD_SERIAL_NUM")
    {
        name(vehicle, number.to_string(), "BRD_SERIAL_NUM");
    }
    let system_id = SYSTEM_ID.into_iter().find_map(whole);
    vehicle.system_id = system_id.and_then(|id| u8::try_from(id).ok());
    vehicle.boot_count = whole("STAT_BOOTCNT");
}

/// Sets the id of the vehicle and its source.
pub(crate) fn name(vehicle: &mut Vehicle, id: String, source: &str) {
    vehicle.id = Some(id);
    vehicle.id_source = Some(source.to_owned());
}

/// The id in AUTOPILOT_VERSION and the name of its field: `uid2`, in the form in which PX4 logs it as `sys_uuid`, or
/// else `uid`. An id of zeros counts as unknown.
pub(crate) fn of_version(uid: &[u8], uid2: &[u8]) -> Option<(String, &'static str)> {
    let hexadecimal = |bytes: &mut dyn Iterator<Item = &u8>| -> String {
        bytes.map(|byte| format!("{byte:02x}")).collect()
    };
    let is_known = |bytes: &[u8]| bytes.iter().any(|&byte| byte != 0);
    if is_known(uid2) {
        return Some((hexadecimal(&mut uid2.iter()), "AUTOPILOT_VERSION.uid2"));
    }
    // A 64-bit number, lowest byte first.
    is_known(uid).then(|| (hexadecimal(&mut uid.iter().rev()), "AUTOPILOT_VERSION.uid"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn parameters_contain_vehicle_number_and_boots() {
        let mut vehicle = Vehicle::default();
        let pairs = [
            ("SYSID_THISMAV", 7.0),
            ("STAT_BOOTCNT", 812.0),
            ("BRD_SERIAL_NUM", 31.0),
        ];
        add(&mut vehicle, &pairs.into_iter().collect());
        assert_eq!(
            (vehicle.system_id, vehicle.boot_count),
            (Some(7), Some(812))
        );
        assert_eq!(vehicle.id.as_deref(), Some("31"));
        assert_eq!(vehicle.id_source.as_deref(), Some("BRD_SERIAL_NUM"));
    }

    #[test]
    fn missing_identity_is_unknown() {
        let mut vehicle = Vehicle::default();
        let pairs = [
            ("MAV_SYS_ID", 300.0),
            ("STAT_BOOTCNT", 0.5),
            ("BRD_SERIAL_NUM", 0.0),
        ];
        add(&mut vehicle, &pairs.into_iter().collect());
        assert_eq!(vehicle, Vehicle::default());
    }

    #[test]
    fn the_serial_number_of_a_board_precedes_a_given_name() {
        let mut vehicle = Vehicle::default();
        name(&mut vehicle, "0002".into(), "sys_uuid");
        add(
            &mut vehicle,
            &[("BRD_SERIAL_NUM", 31.0)].into_iter().collect(),
        );
        assert_eq!(vehicle.id.as_deref(), Some("0002"));
    }

    #[test]
    fn the_long_id_comes_first_and_zeros_are_ignored() {
        let of = |uid: &[u8], uid2: &[u8]| of_version(uid, uid2).map(|(id, _)| id);
        assert_eq!(of(&[1, 2], &[0, 0xAB]).as_deref(), Some("00ab"));
        assert_eq!(of(&[1, 2], &[0, 0]).as_deref(), Some("0201"));
        assert_eq!(of(&[0, 0], &[0, 0]), None);
    }
}
