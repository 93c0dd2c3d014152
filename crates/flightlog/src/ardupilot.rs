//! The motors, the range of their commands and the flight modes of ArduPilot, from its parameters.

mod vehicle;

pub(crate) use vehicle::{BOARD, vehicle};

use crate::outputs::{FRACTIONS, PULSES_US};
use crate::parameters::{Parameters, name_of};
use crate::{Flight, Intervals, Motor, Range, Vehicle, VehicleKind};

/// Whether the log has a SERVOn_FUNCTION parameter. Firmware before 3.5 has none.
pub(crate) fn has_functions(parameters: &Parameters) -> bool {
    (1..=32).any(|output| parameters.get(&format!("SERVO{output}_FUNCTION")).is_some())
}

/// Motor number of a SERVOn_FUNCTION: 33..40 are motors 1..8, 82..85 are 9..12,
/// 160..179 are 13..32.
fn motor_of_function(function: i64) -> Option<u16> {
    let number = match function {
        33..=40 => function - 32,
        82..=85 => function - 73,
        160..=179 => function - 147,
        _ => return None,
    };
    u16::try_from(number).ok()
}

/// The motors of a vehicle in order of their numbers, each with the number of its output, from 1. The parameters
/// SERVOn_FUNCTION assign outputs to motors. If the log has no such parameter (firmware before 3.5), each motor is on
/// the output with the same number, and the frame determines the number of motors. `name` returns the name of an
/// output in the log.
pub(crate) fn motors(
    parameters: &Parameters,
    vehicle: &Vehicle,
    name: impl Fn(u16) -> String,
) -> Vec<(Motor, u16)> {
    if !has_functions(parameters) {
        let known_by = match &vehicle.frame {
            Some(frame) => format!("frame {frame}"),
            None => "the first outputs whose commands move together".into(),
        };
        let source = format!("{known_by} (the log has no SERVOn_FUNCTION)");
        return match vehicle.motors.unwrap_or(0) {
            TRI => [1, 2, REAR_OF_TRI]
                .map(|number| (motor(number, name(number), &source), number))
                .into(),
            count => numbered_motors(count, name, &source),
        };
    }
    let mut motors: Vec<(Motor, u16)> = (1..=32)
        .filter_map(|output| {
            let parameter = format!("SERVO{output}_FUNCTION");
            let function = parameters.get(&parameter)?;
            let number = motor_of_function(function as i64)?;
            let source = format!("{parameter} = {function}");
            let is_servo = vehicle.motors == Some(TRI) && number == SERVO_OF_TRI;
            (!is_servo).then(|| (motor(number, name(output), &source), output))
        })
        .collect();
    motors.sort_by_key(|(motor, output)| (motor.number, *output));
    motors
}

/// Motors 1 to `motors`, on the outputs with the same numbers.
pub(crate) fn numbered_motors(
    motors: u16,
    name: impl Fn(u16) -> String,
    source: &str,
) -> Vec<(Motor, u16)> {
    (1..=motors)
        .map(|number| (motor(number, name(number), source), number))
        .collect()
}

fn motor(number: u16, output: String, source: &str) -> Motor {
    Motor {
        number,
        output,
        source: source.into(),
    }
}

/// The number of motors of a tricopter, which are the motors 1, 2 and 4.
const TRI: u16 = 3;
/// The motor number of the rear motor of a tricopter.
const REAR_OF_TRI: u16 = 4;
/// The motor number of the servo that tilts the rear motor of a tricopter.
const SERVO_OF_TRI: u16 = 7;

/// The maximum number of changes of the armed state, and of the in-air state, that are kept if they are derived from
/// the commands.
const MAX_CHANGES: usize = 10_000;

/// Armed and in-air times derived from the commands, for logs without events: armed while any motor runs, in the air
/// while the mean command is above 0.2. Changes beyond [`MAX_CHANGES`] are counted in `left_out`.
pub(crate) fn air_from_commands(
    flight: &Flight,
    left_out: &mut u64,
) -> (Option<Intervals>, Option<Intervals>) {
    let (Some(range), Some(&last_s)) = (&flight.range, flight.commands.t_s().last()) else {
        return (None, None);
    };
    let first_s = flight.commands.t_s().first().copied().unwrap_or_default();
    let running = |row: &[f64], _| row.iter().any(|&raw| raw > range.low + 1.0);
    // A motor whose command is unknown may be running, so an unknown command does not end a flight.
    let flying = |row: &[f64], before: bool| {
        let known: Vec<f64> = row.iter().filter_map(|&raw| flight.command(raw)).collect();
        known.iter().sum::<f64>() > 0.2 * known.len() as f64 || before && known.len() < row.len()
    };
    let mut intervals = |state: &dyn Fn(&[f64], bool) -> bool, rule: &str| {
        let rule = format!("{rule} (the log contains no events for this state)");
        let mut changes: Vec<(f64, bool)> = Vec::new();
        let (mut last, mut end_s) = (None, None);
        for (t_s, row) in flight.commands.rows() {
            let state = state(row, last == Some(true));
            if last.replace(state) == Some(state) {
                continue;
            }
            if changes.len() < MAX_CHANGES {
                changes.push((t_s, state));
            } else {
                end_s.get_or_insert(t_s);
                *left_out += 1;
            }
        }
        let end_s = end_s.unwrap_or(last_s);
        Intervals::from_changes(&changes, false, first_s, end_s, rule)
    };
    (
        Some(intervals(&running, "any motor above its lowest command")),
        Some(intervals(&flying, "mean command above 0.2 of the range").assumed()),
    )
}

/// A flight mode as the log records it: by number or by name.
#[derive(Debug, Clone, PartialEq)]
pub(crate) enum Mode {
    Number(i64),
    Name(String),
}

impl Mode {
    /// The name of the mode. The same number means different modes on different vehicles.
    pub(crate) fn name(self, kind: VehicleKind) -> String {
        match (self, kind) {
            (Self::Name(name), _) => name,
            (Self::Number(number), VehicleKind::Multirotor | VehicleKind::Helicopter) => {
                name_of(COPTER_MODES, number, "mode")
            }
            (Self::Number(number), _) => format!("mode {number}"),
        }
    }
}

/// Flight modes of ArduCopter by their numbers.
const COPTER_MODES: &[&str] = &[
    "STABILIZE",
    "ACRO",
    "ALT_HOLD",
    "AUTO",
    "GUIDED",
    "LOITER",
    "RTL",
    "CIRCLE",
    "",
    "LAND",
    "",
    "DRIFT",
    "",
    "SPORT",
    "FLIP",
    "AUTOTUNE",
    "POSHOLD",
    "BRAKE",
    "THROW",
    "AVOID_ADSB",
    "GUIDED_NOGPS",
    "SMART_RTL",
    "FLOWHOLD",
    "FOLLOW",
    "ZIGZAG",
    "SYSTEMID",
    "AUTOROTATE",
    "AUTO_RTL",
    "TURTLE",
];

/// Full range of the motor outputs: MOT_PWM_MIN/MAX if both are above 0, otherwise RCn_MIN/MAX of the throttle channel
/// n. `None` if these are not pulse widths of a speed controller.
pub(crate) fn pwm_range(parameters: &Parameters) -> Option<Range> {
    let range = |(low, high), source| Range {
        low,
        high,
        unit: "us",
        source,
    };
    let own = parameters
        .pair("MOT_PWM_MIN", "MOT_PWM_MAX")
        .filter(|(low, _)| *low > 0.0);
    if let Some(own) = own {
        return PULSES_US
            .allow(own)
            .then(|| range(own, "MOT_PWM_MIN/MAX".into()));
    }
    let (channel, from) = match parameters.get("RCMAP_THROTTLE") {
        Some(channel) => (channel as i64, "by RCMAP_THROTTLE"),
        None => (3, "is 3 by default"),
    };
    let radio = parameters.pair(&format!("RC{channel}_MIN"), &format!("RC{channel}_MAX"))?;
    if !PULSES_US.allow(radio) {
        return None;
    }
    let source =
        format!("RC{channel}_MIN/MAX: MOT_PWM_MIN/MAX are not set, the throttle channel {from}");
    Some(range(radio, source))
}

/// The reason why MOT_SPIN_MIN and MOT_SPIN_MAX, if both are set, cannot be limits of the commands.
pub(crate) fn effective_doubt(parameters: &Parameters) -> Option<String> {
    let [low, high] = ["MOT_SPIN_MIN", "MOT_SPIN_MAX"].map(|name| parameters.get(name));
    let (low, high) = low.zip(high)?;
    (!FRACTIONS.allow((low, high)))
        .then(|| format!("MOT_SPIN_MIN/MAX, {low} and {high}, are not valid limits"))
}

/// Whether the parameters contain limits of the commands, even implausible ones.
pub(crate) fn has_limits(parameters: &Parameters) -> bool {
    let is_known = |name: &str| parameters.get(name).is_some();
    is_known("MOT_SPIN_MIN") && is_known("MOT_SPIN_MAX") || is_known("THR_MIN")
}

/// The part of the range that is used in flight: MOT_SPIN_MIN to MOT_SPIN_MAX. Before firmware 3.4, the lower limit is
/// `low = THR_MIN / 1000`. The upper limit is `low + MOT_THST_MAX (1 - low)` in firmware 3.3, and MOT_TCRV_MAXPCT
/// percent of the whole range in 3.1 and 3.2 if the thrust curve is enabled.
pub(crate) fn effective_range(parameters: &Parameters) -> Range {
    let range = |low, high, source: String| Range {
        low,
        high,
        unit: "1",
        source,
    };
    if let Some(doubt) = effective_doubt(parameters) {
        return crate::flight::whole_range(&doubt);
    }
    if let Some((low, high)) = parameters.pair("MOT_SPIN_MIN", "MOT_SPIN_MAX") {
        return range(low, high, "MOT_SPIN_MIN/MAX".into());
    }
    let low = parameters.get("THR_MIN").map(|value| value / 1000.0);
    let Some(low) = low.filter(|&low| FRACTIONS.allow((low, 1.0))) else {
        return crate::flight::whole_range("the log has no MOT_SPIN_MIN/MAX and no THR_MIN");
    };
    let curve_is_used = parameters.get("MOT_TCRV_ENABLE").is_none_or(|on| on > 0.0);
    let curve = parameters.get("MOT_TCRV_MAXPCT").filter(|_| curve_is_used);
    let (high, source) = match (parameters.get("MOT_THST_MAX"), curve) {
        (Some(share), _) => (low + share * (1.0 - low), "THR_MIN and MOT_THST_MAX"),
        (None, Some(percent)) => (percent / 100.0, "THR_MIN and MOT_TCRV_MAXPCT"),
        (None, None) => (1.0, "THR_MIN"),
    };
    match FRACTIONS.allow((low, high)) {
        true => range(low, high, source.into()),
        false => range(
            low,
            1.0,
            format!("THR_MIN; the values of {source} are not valid limits"),
        ),
    }
}

/// `(share, excess)`: an upper limit is in force if at most this share of the commands exceeds it by more than
/// `excess`, a fraction of the range. A few damaged samples are thus ignored.
const ABOVE: (f64, f64) = (1e-4, 0.006);

/// The effective range of a flight. Before firmware 3.4, an upper limit may be set but have no effect: it is ignored
/// if the commands exceed it.
pub(crate) fn range_in_force(parameters: &Parameters, flight: &Flight) -> Range {
    let effective = effective_range(parameters);
    let is_new = parameters.pair("MOT_SPIN_MIN", "MOT_SPIN_MAX").is_some();
    if is_new || flight.range.is_none() || effective.high >= 1.0 {
        return effective;
    }
    let (mut all, mut above) = (0_u64, 0_u64);
    for (t_s, row) in flight.commands.rows() {
        if flight.is_in_air(t_s) == Some(false) {
            continue;
        }
        for command in row.iter().filter_map(|&raw| flight.command(raw)) {
            all += 1;
            above += u64::from(command > effective.high + ABOVE.1);
        }
    }
    if above as f64 <= ABOVE.0 * all as f64 {
        return effective;
    }
    Range {
        high: 1.0,
        source: format!("{}; the commands exceed the upper limit", effective.source),
        ..effective
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn parameters(pairs: &[(&str, f64)]) -> Parameters {
        pairs.iter().copied().collect()
    }

    /// Impossible limits are ignored, because they would hide a motor at its limit.
    #[test]
    fn impossible_limits_are_ignored() {
        for (low, high) in [
            (100.0, 1100.0),
            (1000.0, 5e4),
            (1500.0, 1501.0),
            (2000.0, 1000.0),
        ] {
            let set = parameters(&[("MOT_PWM_MIN", low), ("MOT_PWM_MAX", high)]);
            assert_eq!(pwm_range(&set), None, "{low} {high}");
        }
        for (low, high) in [(-0.1, 0.95), (0.1, 7.0), (0.5, 0.55)] {
            let set = parameters(&[("MOT_SPIN_MIN", low), ("MOT_SPIN_MAX", high)]);
            let range = effective_range(&set);
            assert_eq!((range.low, range.high), (0.0, 1.0));
            assert!(
                range.source.contains("are not valid limits"),
                "{}",
                range.source
            );
        }
    }

    #[test]
    fn functions_determine_the_motors() {
        for (function, motor) in [
            (32, None),
            (33, Some(1)),
            (40, Some(8)),
            (41, None),
            (82, Some(9)),
            (85, Some(12)),
            (160, Some(13)),
        ] {
            assert_eq!(motor_of_function(function), motor, "{function}");
        }
    }

    #[test]
    fn the_first_value_of_a_parameter_counts() {
        let found = motors(
            &parameters(&[
                ("SERVO1_FUNCTION", 34.0),
                ("SERVO5_FUNCTION", 33.0),
                ("SERVO1_FUNCTION", 1.0),
            ]),
            &Vehicle::default(),
            |output| format!("C{output}"),
        );
        let found: Vec<_> = found
            .iter()
            .map(|(m, output)| (m.number, m.output.as_str(), *output))
            .collect();
        assert_eq!(found, [(1, "C5", 5), (2, "C1", 1)]);
    }

    #[test]
    fn range_comes_from_the_motors_or_the_throttle_stick() {
        let own = [("MOT_PWM_MIN", 1100.0), ("MOT_PWM_MAX", 1900.0)];
        let radio = [
            ("RC3_MIN", 1000.0),
            ("RC3_MAX", 2000.0),
            ("MOT_PWM_MIN", 0.0),
        ];
        let mapped = [
            ("RCMAP_THROTTLE", 1.0),
            ("RC1_MIN", 1094.0),
            ("RC1_MAX", 1934.0),
        ];
        for (pairs, low, high) in [
            (&own[..], 1100.0, 1900.0),
            (&radio[..], 1000.0, 2000.0),
            (&mapped[..], 1094.0, 1934.0),
        ] {
            let range = pwm_range(&parameters(pairs)).unwrap();
            assert_eq!((range.low, range.high), (low, high), "{}", range.source);
        }
        assert_eq!(pwm_range(&parameters(&[("RC3_MIN", 1000.0)])), None);
    }

    #[test]
    fn effective_range_by_generation() {
        let new = parameters(&[("MOT_SPIN_MIN", 0.15), ("MOT_SPIN_MAX", 0.95)]);
        assert_eq!(effective_range(&new).high, 0.95);
        for (limit, high) in [
            (("THR_MAX", 1000.0), 1.0),
            (("MOT_TCRV_MAXPCT", 93.0), 0.93),
            (("MOT_THST_MAX", 0.95), 0.13 + 0.95 * 0.87),
            (("MOT_THST_MAX", 1.5), 1.0),
        ] {
            let old = effective_range(&parameters(&[("THR_MIN", 130.0), limit]));
            assert_eq!((old.low, old.high), (0.13, high), "{}", old.source);
        }
        let unused = [
            ("THR_MIN", 130.0),
            ("MOT_TCRV_ENABLE", 0.0),
            ("MOT_TCRV_MAXPCT", 93.0),
        ];
        assert_eq!(effective_range(&parameters(&unused)).high, 1.0);
        let none = effective_range(&parameters(&[]));
        assert_eq!((none.low, none.high), (0.0, 1.0));
    }
}
