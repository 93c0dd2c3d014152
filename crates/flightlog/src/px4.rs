//! The kind of vehicle, its motors and the range of their commands, from PX4's parameters.

mod allocation;

pub(crate) use allocation::Allocation;

use crate::mav_type::{MavType, mav_type};
use crate::parameters::Parameters;
use crate::{Motor, Range, Vehicle, VehicleKind, identity};

/// Raw commands above this are counts of a bus, not pulse widths in us.
const LONGEST_PULSE_US: f64 = 2200.0;
/// Full command of an ESC on DroneCAN (UAVCAN), 13 bits
/// (<https://dronecan.github.io/Specification/7._List_of_standard_data_types/#rawcommand>).
const UAVCAN_FULL: f64 = 8191.0;

/// Full throttle of DShot in `actuator_outputs` of PX4: 2047 minus the 48 values that are special commands.
const DSHOT_FULL: f64 = 1999.0;

/// The vehicle from MAV_TYPE (or the type in vehicle_status) and the build information.
pub(crate) fn vehicle(
    parameters: &Parameters,
    system_type: Option<f64>,
    firmware: Option<String>,
) -> Vehicle {
    let of = |number: Option<f64>, source: &str| {
        let number = number? as i64;
        Some((mav_type(number)?, format!("{source} = {number}")))
    };
    let found = of(parameters.get("MAV_TYPE"), "MAV_TYPE")
        .or_else(|| of(system_type, "vehicle_status.system_type"));
    let mut vehicle = Vehicle {
        firmware,
        source: "the log has no MAV_TYPE".into(),
        ..Vehicle::default()
    };
    identity::add(&mut vehicle, parameters);
    let Some((MavType { kind, name, motors }, source)) = found else {
        return vehicle;
    };
    vehicle.kind = kind;
    vehicle.source = source;
    vehicle.motors = motors;
    vehicle.frame = Some(match parameters.get("SYS_AUTOSTART") {
        Some(airframe) => format!("{name}, airframe {airframe}"),
        None => name.into(),
    });
    count_rotors(&mut vehicle, parameters);
    vehicle
}

/// The version from `ver_sw_release`: major, minor, patch and kind, one byte each.
pub(crate) fn firmware(release: u32) -> String {
    let [major, minor, patch, kind] = release.to_be_bytes();
    let kind = match kind {
        255 => "",
        192.. => " (RC)",
        128.. => " (beta)",
        64.. => " (alpha)",
        _ => " (dev)",
    };
    format!("PX4 v{major}.{minor}.{patch}{kind}")
}

/// The number of rotors from CA_ROTOR_COUNT (1.13 and later), which the type of the vehicle may contradict.
pub(crate) fn rotor_count(parameters: &Parameters) -> Option<u16> {
    let count = parameters.get("CA_ROTOR_COUNT")?;
    (1.0..=12.0).contains(&count).then_some(count as u16)
}

/// Replaces the number of motors and the type of a vehicle if CA_ROTOR_COUNT contradicts them.
pub(crate) fn count_rotors(vehicle: &mut Vehicle, parameters: &Parameters) {
    let Some(count) = rotor_count(parameters) else {
        return;
    };
    if vehicle.kind == VehicleKind::Multirotor
        && vehicle.motors.is_some_and(|reported| reported != count)
    {
        vehicle.motors = Some(count);
        vehicle.frame = Some(format!("multirotor with {count} rotors"));
    }
}

/// The motors of `actuator_motors`, and the range of its commands.
pub(crate) fn actuator_motors(parameters: &Parameters, used: u16) -> (Vec<Motor>, Range) {
    let (count, source) = match rotor_count(parameters) {
        Some(count) => (count, format!("CA_ROTOR_COUNT = {count}")),
        None => (
            used,
            "controls in use (the log has no CA_ROTOR_COUNT)".into(),
        ),
    };
    let motors = (1..=count)
        .map(|number| Motor {
            number,
            output: format!("actuator_motors.control[{}]", number - 1),
            source: source.clone(),
        })
        .collect();
    let range = Range {
        low: 0.0,
        high: 1.0,
        unit: "1",
        source: "actuator_motors is a fraction".into(),
    };
    (motors, range)
}

/// Motors whose commands are computed from torque and thrust set points, and the range of these commands.
pub(crate) fn computed_motors(motors: usize) -> (Vec<Motor>, Range) {
    let motors = (1..=motors).map(|number| Motor {
        number: number as u16,
        output: format!("computed control[{}]", number - 1),
        source: "vehicle_torque_setpoint, vehicle_thrust_setpoint and CA_ROTORn parameters".into(),
    });
    let range = Range {
        low: 0.0,
        high: 1.0,
        unit: "1",
        source: "computed commands are fractions".into(),
    };
    (motors.collect(), range)
}

/// The motors of an instance of `actuator_outputs`, each with the index of its output: the outputs named by
/// PWM_MAIN_FUNCn or PWM_AUX_FUNCn (from 1.13), otherwise the first `count` outputs.
pub(crate) fn actuator_outputs(
    parameters: &Parameters,
    instance: u8,
    count: Option<u16>,
) -> Vec<(Motor, usize)> {
    let motor = |number: u16, index: usize, source: String| {
        let output = format!("actuator_outputs[{instance}].output[{index}]");
        (
            Motor {
                number,
                output,
                source,
            },
            index,
        )
    };
    let group = bank(instance);
    let functions = if has_static_mixer(parameters) { 0 } else { 16 };
    let mut motors: Vec<_> = (0..functions)
        .filter_map(|index| {
            let name = format!("PWM_{group}_FUNC{}", index + 1);
            let function = parameters.get(&name)?;
            let number = (101.0..=112.0)
                .contains(&function)
                .then_some(function - 100.0)?;
            Some(motor(number as u16, index, format!("{name} = {function}")))
        })
        .collect();
    if !motors.is_empty() {
        motors.sort_by_key(|(motor, _)| motor.number);
        return motors;
    }
    (1..=count.unwrap_or(0))
        .map(|number| {
            let source = "MAV_TYPE, the first outputs of the instance that drives motors";
            motor(number, usize::from(number) - 1, source.into())
        })
        .collect()
}

/// Whether PX4 1.13 uses static mixers, as older versions do: the parameters of single outputs
/// exist, but have no effect.
fn has_static_mixer(parameters: &Parameters) -> bool {
    parameters.get("SYS_CTRL_ALLOC") == Some(0.0)
}

/// The bank of outputs of an instance of `actuator_outputs`.
fn bank(instance: u8) -> &'static str {
    match instance {
        0 => "MAIN",
        _ => "AUX",
    }
}

/// The range of `actuator_outputs`, from the build, the parameters of the bank, and the smallest and largest command
/// except 0; `first` is the index of the output of a motor.
pub(crate) fn output_range(
    parameters: &Parameters,
    instance: u8,
    first: usize,
    (smallest, largest): (f64, f64),
    hardware: &str,
) -> Option<Range> {
    let range = |low, high, unit, source: String| Range {
        low,
        high,
        unit,
        source,
    };
    if largest > LONGEST_PULSE_US {
        let source = "raw commands of UAVCAN ESCs".into();
        return Some(range(0.0, UAVCAN_FULL, "raw", source));
    }
    // Before PX4 1.14 (which logs actuator_motors), DShot commands are counts of the throttle, and the limits of pulses
    // are not used.
    let is_dshot = parameters
        .get("DSHOT_CONFIG")
        .is_some_and(|rate| rate > 0.0);
    if is_dshot && smallest < crate::outputs::PULSES_US.least && largest <= DSHOT_FULL {
        let least = parameters
            .get("DSHOT_MIN")
            .filter(|least| (0.0..0.9).contains(least))?;
        let is_both_ways = parameters.get("DSHOT_3D_ENABLE").is_some_and(|on| on > 0.0);
        let low = (least * DSHOT_FULL).round();
        let source = format!("DShot, from DSHOT_MIN = {} of the throttle", least as f32);
        return (!is_both_ways).then(|| range(low, DSHOT_FULL, "raw", source));
    }
    let bank = bank(instance);
    let output = first + 1;
    let of_output = |end: &str| {
        let own = parameters.get(&format!("PWM_{bank}_{end}{output}"));
        // -1 means the value of the whole bank.
        let own = own.filter(|&value| value > 0.0);
        let of_bank = parameters
            .get(&format!("PWM_{bank}_{end}"))
            .or_else(|| parameters.get(&format!("PWM_{end}")));
        match has_static_mixer(parameters) {
            true => of_bank.or(own),
            false => own.or(of_bank),
        }
    };
    if let (Some(low), Some(high)) = (of_output("MIN"), of_output("MAX"))
        && crate::outputs::PULSES_US.allow((low, high))
    {
        let source = match has_static_mixer(parameters) {
            true => format!("PWM_{bank}_MIN/MAX or PWM_MIN/MAX (SYS_CTRL_ALLOC = 0)"),
            false => format!("PWM_{bank}_MIN/MAX of output {output}, or PWM_MIN/MAX"),
        };
        return Some(range(low, high, "us", source));
    }
    match hardware {
        // RPMMIN and RPMMAX in the driver of Yuneec's TAP ESCs, which has no parameters.
        "TAP_V1" | "TAP_V2" => Some(range(1200.0, 1900.0, "us", "the TAP ESC driver".into())),
        _ if hardware.contains("SITL") => Some(range(
            1000.0,
            2000.0,
            "us",
            "the simulator's outputs".into(),
        )),
        _ => None,
    }
}

/// Returns the name of a `nav_state` of vehicle_status.
pub(crate) fn nav_state(number: i64) -> String {
    const NAMES: &[&str] = &[
        "MANUAL",
        "ALTCTL",
        "POSCTL",
        "AUTO_MISSION",
        "AUTO_LOITER",
        "AUTO_RTL",
        "",
        "",
        "",
        "",
        "ACRO",
        "",
        "DESCEND",
        "TERMINATION",
        "OFFBOARD",
        "STAB",
        "",
        "AUTO_TAKEOFF",
        "AUTO_LAND",
        "AUTO_FOLLOW_TARGET",
        "AUTO_PRECLAND",
        "ORBIT",
        "AUTO_VTOL_TAKEOFF",
    ];
    crate::parameters::name_of(NAMES, number, "state")
}

/// Name of a mode in HEARTBEAT.custom_mode: main mode in byte 2, sub-mode of AUTO in byte 3.
pub(crate) fn custom_mode(number: u32) -> String {
    const MAIN: &[&str] = &[
        "",
        "MANUAL",
        "ALTCTL",
        "POSCTL",
        "AUTO",
        "ACRO",
        "OFFBOARD",
        "STABILIZED",
        "RATTITUDE",
    ];
    const AUTO: &[&str] = &[
        "",
        "AUTO_READY",
        "AUTO_TAKEOFF",
        "AUTO_LOITER",
        "AUTO_MISSION",
        "AUTO_RTL",
        "AUTO_LAND",
        "",
        "AUTO_FOLLOW_TARGET",
        "AUTO_PRECLAND",
    ];
    let [_, _, main, auto] = number.to_le_bytes();
    match main {
        4 => crate::parameters::name_of(AUTO, auto.into(), "AUTO"),
        _ => crate::parameters::name_of(MAIN, main.into(), "mode"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn parameters(pairs: &[(&str, f64)]) -> Parameters {
        pairs.iter().copied().collect()
    }

    #[test]
    fn version_numbers_are_decoded() {
        assert_eq!(firmware(17_301_759), "PX4 v1.8.0");
        assert_eq!(firmware(17_367_168), "PX4 v1.9.0 (beta)");
        assert_eq!(firmware(17_760_256), "PX4 v1.15.0 (dev)");
    }

    #[test]
    fn generations_of_range_parameters() {
        let old = [("PWM_MIN", 1075.0), ("PWM_MAX", 1950.0)];
        let bank = [
            ("PWM_MAIN_MIN", 1000.0),
            ("PWM_MAIN_MAX", 1900.0),
            ("PWM_MAIN_MIN1", -1.0),
        ];
        let own = [("PWM_MAIN_MIN1", 1100.0), ("PWM_MAIN_MAX1", 1900.0)];
        let mixer = [
            ("SYS_CTRL_ALLOC", 0.0),
            ("PWM_MAIN_MIN", 1075.0),
            ("PWM_MAIN_MAX", 1950.0),
            ("PWM_MAIN_MIN1", 1000.0),
            ("PWM_MAIN_MAX1", 2000.0),
        ];
        let aux = [("PWM_AUX_MIN3", 1050.0), ("PWM_AUX_MAX3", 1950.0)];
        for (pairs, instance, first, low) in [
            (&old[..], 0, 0, 1075.0),
            (&bank[..], 0, 0, 1000.0),
            (&own[..], 0, 0, 1100.0),
            (&mixer[..], 0, 0, 1075.0),
            (&aux[..], 1, 2, 1050.0),
        ] {
            let range =
                output_range(&parameters(pairs), instance, first, (900.0, 1800.0), "X").unwrap();
            assert_eq!((range.low, range.unit), (low, "us"), "{}", range.source);
        }
        let none = parameters(&[]);
        assert_eq!(
            output_range(&none, 0, 0, (900.0, 1800.0), "PX4_FMU_V5"),
            None
        );
        assert_eq!(
            output_range(&none, 0, 0, (900.0, 1800.0), "SITL")
                .unwrap()
                .high,
            2000.0
        );
        assert_eq!(
            output_range(&none, 1, 0, (200.0, 5200.0), "X")
                .unwrap()
                .high,
            8191.0
        );
    }

    #[test]
    fn the_range_of_dshot_is_that_of_the_throttle() {
        let dshot = [
            ("DSHOT_CONFIG", 600.0),
            ("DSHOT_MIN", 0.055),
            ("PWM_MAIN_MIN", 1075.0),
            ("PWM_MAIN_MAX", 1950.0),
        ];
        let of = |pairs: &[(&str, f64)], seen| {
            let found = output_range(&parameters(pairs), 0, 0, seen, "X");
            found.map(|range| (range.low, range.high, range.unit))
        };
        assert_eq!(of(&dshot, (110.0, 1999.0)), Some((110.0, 1999.0, "raw")));
        // The values are not those of DShot, so the commands are pulses of another bank.
        assert_eq!(of(&dshot, (900.0, 1800.0)), Some((1075.0, 1950.0, "us")));
        // Without the minimum, or if the throttle works in both directions, there is no range.
        assert_eq!(of(&dshot[..1], (110.0, 1999.0)), None);
        let both_ways = [dshot[0], dshot[1], ("DSHOT_3D_ENABLE", 1.0)];
        assert_eq!(of(&both_ways, (110.0, 1999.0)), None);
    }

    #[test]
    fn functions_determine_the_motors() {
        let found = actuator_outputs(
            &parameters(&[("PWM_AUX_FUNC1", 102.0), ("PWM_AUX_FUNC4", 101.0)]),
            1,
            Some(4),
        );
        let found: Vec<_> = found
            .iter()
            .map(|(motor, index)| (motor.number, *index))
            .collect();
        assert_eq!(found, [(1, 3), (2, 0)]);
    }
}
