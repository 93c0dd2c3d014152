//! The kind and identity of an ArduPilot vehicle.

use crate::geometry::tables;
use crate::parameters::Parameters;
use crate::{Vehicle, VehicleKind, identity};

/// The vehicle from the texts of the log (`ArduCopter V4.5.1 (...)`, `Frame: QUAD/X`)
/// and its parameters.
pub(crate) fn vehicle<'a>(
    texts: impl Iterator<Item = &'a str> + Clone,
    parameters: &Parameters,
) -> Vehicle {
    let firmware = texts.clone().find(|text| kind_of_firmware(text).is_some());
    let class = parameters.get("FRAME_CLASS").map(|class| class as i64);
    let frame = texts
        .clone()
        .filter_map(|text| text.strip_prefix("Frame: "))
        .map(str::to_owned)
        .next()
        .or_else(|| tables::name_of_class(class?).map(str::to_owned));
    let id = texts.into_iter().find(|text| is_board_id(text));
    let (mut kind, mut source) = match firmware {
        Some(text) => (
            kind_of_firmware(text).unwrap_or_default(),
            format!("message `{text}`"),
        ),
        None => kind_of_parameters(parameters),
    };
    if kind == VehicleKind::Multirotor && matches!(class, Some(6 | 8 | 9 | 11 | 13)) {
        kind = VehicleKind::Helicopter;
        source = format!("FRAME_CLASS = {}", class.unwrap_or_default());
    }
    if kind == VehicleKind::Plane && parameters.get("Q_ENABLE").is_some_and(|on| on > 0.0) {
        kind = VehicleKind::Vtol;
        source.push_str(" and Q_ENABLE");
    }
    let mut vehicle = Vehicle {
        kind,
        source,
        motors: frame.as_deref().and_then(motors_of_frame),
        frame,
        firmware: firmware.map(str::to_owned),
        ..Vehicle::default()
    };
    if let Some(id) = id {
        identity::name(&mut vehicle, id.to_owned(), BOARD);
    }
    identity::add(&mut vehicle, parameters);
    vehicle
}

/// The source of a vehicle id that the board wrote as a text.
pub(crate) const BOARD: &str = "message of the board";

/// Whether a text contains the board name and the 96 bits of its serial number: `Pixhawk4 0047002B 34385105 36363539`.
fn is_board_id(text: &str) -> bool {
    let mut words = text.split(' ');
    let name = words.next().is_some_and(|name| !name.is_empty());
    let is_hex = |word: &str| word.len() == 8 && word.bytes().all(|b| b.is_ascii_hexdigit());
    name && words.clone().count() == 3 && words.all(is_hex)
}

fn kind_of_firmware(text: &str) -> Option<VehicleKind> {
    const NAMES: &[(&str, VehicleKind)] = &[
        ("ArduCopter", VehicleKind::Multirotor),
        ("APM:Copter", VehicleKind::Multirotor),
        ("ArduPlane", VehicleKind::Plane),
        ("APM:Plane", VehicleKind::Plane),
        ("ArduRover", VehicleKind::Rover),
        ("APM:Rover", VehicleKind::Rover),
        ("Rover V", VehicleKind::Rover),
        ("ArduSub", VehicleKind::Submarine),
        ("AntennaTracker", VehicleKind::Other),
        ("Blimp", VehicleKind::Other),
    ];
    NAMES
        .iter()
        .find(|(name, _)| text.starts_with(name))
        .map(|(_, kind)| *kind)
}

/// The kind of vehicle, from parameters that only vehicles of this kind have.
fn kind_of_parameters(parameters: &Parameters) -> (VehicleKind, String) {
    const SIGNS: &[(&str, VehicleKind)] = &[
        ("ATC_RAT_RLL_P", VehicleKind::Multirotor),
        ("RATE_RLL_P", VehicleKind::Multirotor),
        ("TECS_CLMB_MAX", VehicleKind::Plane),
        ("CRUISE_SPEED", VehicleKind::Rover),
    ];
    SIGNS
        .iter()
        .find(|(name, _)| parameters.get(name).is_some())
        .map(|(name, kind)| (*kind, format!("parameter {name}")))
        .unwrap_or((
            VehicleKind::Unknown,
            "the log does not contain the firmware".into(),
        ))
}

/// Number of motors of a frame, by its name or class in the log.
fn motors_of_frame(frame: &str) -> Option<u16> {
    tables::motors_of_class(tables::parse(frame)?.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn parameters(pairs: &[(&str, f64)]) -> Parameters {
        pairs.iter().copied().collect()
    }

    #[test]
    fn a_board_names_itself_by_its_serial_number() {
        for (text, is_id) in [
            ("Pixhawk4 0047002B 34385105 36363539", true),
            ("ArduCopter V4.7.0-dev (15f9bed0)", false),
            ("PX4: 11112222 NuttX: 33334444", false),
            ("Pixhawk4 0047002B 34385105 3636353", false),
        ] {
            let vehicle = vehicle([text].into_iter(), &parameters(&[]));
            assert_eq!(vehicle.id.as_deref(), is_id.then_some(text));
        }
    }

    #[test]
    fn firmware_and_frame_determine_the_kind_of_vehicle() {
        let class = |class| parameters(&[("FRAME_CLASS", class)]);
        let q = parameters(&[("Q_ENABLE", 1.0)]);
        for (text, parameters, kind) in [
            ("ArduCopter V4.7.0", class(1.0), VehicleKind::Multirotor),
            ("ArduCopter V4.7.0", class(6.0), VehicleKind::Helicopter),
            ("ArduPlane V4.5.0", class(1.0), VehicleKind::Plane),
            ("ArduPlane V4.5.0", q, VehicleKind::Vtol),
            ("Hello", class(1.0), VehicleKind::Unknown),
        ] {
            let found = vehicle([text].into_iter(), &parameters);
            assert_eq!(found.kind, kind, "{text}");
        }
        let named = vehicle(["ArduCopter V3", "Frame: HEXA/X"].into_iter(), &class(1.0));
        assert_eq!(named.frame.as_deref(), Some("HEXA/X"));
        assert_eq!(motors_of_frame("HEXA/X"), Some(6));
    }
}
