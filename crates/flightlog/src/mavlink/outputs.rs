//! Motors, ranges and geometry from the parameters of a vehicle, with assumptions for missing ones. Live links and
//! telemetry logs use the same rules, so that a recording is assessed with the same assumptions as the live flight.

use super::servo::{bank, field, px4_motors};
use crate::geometry::DeclaredLayout;
use crate::parameters::Parameters;
use crate::{Motor, PulseRange, Range, Vehicle, ardupilot, px4};

/// The motors and the range of their commands, from parameters.
pub(crate) struct KnownOutputs {
    /// The motors in order of their number, and the output of each, from 1.
    pub(crate) motors: Vec<(Motor, u16)>,
    /// The number of motors that the vehicle reported; `None` if it did not report it.
    #[cfg(feature = "mavlink")]
    pub(crate) expected: Option<u16>,
    pub(crate) range: Range,
    pub(crate) effective: Range,
    /// Whether `effective` is assumed.
    pub(crate) is_effective_assumed: bool,
    pub(crate) declared: DeclaredLayout,
    /// The assumptions for values that the vehicle did not report, as texts.
    pub(crate) assumed: Vec<String>,
}

/// The number of motors that the vehicle reported; `None` if it did not report it.
pub(super) fn motors_expected(
    parameters: &Parameters,
    vehicle: &Vehicle,
    is_px4: bool,
) -> Option<u16> {
    let rotors = is_px4.then(|| px4::rotor_count(parameters)).flatten();
    rotors.or(vehicle.motors)
}

impl KnownOutputs {
    /// Determines motors and ranges. If no parameter names the motors, they are assumed to be on the first outputs,
    /// and the type of the vehicle determines their number. If the range of the commands is unknown, the range `given`
    /// by the user is used, or else the default of the autopilot.
    pub(crate) fn of(
        parameters: &Parameters,
        vehicle: &Vehicle,
        is_px4: bool,
        given: Option<PulseRange>,
    ) -> Self {
        let expected = motors_expected(parameters, vehicle, is_px4);
        let (motors, first_outputs) = match is_px4 {
            true => motors_of_px4(parameters, expected),
            false => (
                ardupilot::motors(parameters, vehicle, field),
                !ardupilot::has_functions(parameters),
            ),
        };
        let known_range = match is_px4 {
            true => {
                let (bank, index) = bank(motors.first().map_or(1, |(_, output)| *output));
                px4::output_range(parameters, bank, index, (f64::INFINITY, 0.0), "")
            }
            false => ardupilot::pwm_range(parameters),
        };
        let mut assumed = Vec::new();
        if first_outputs && !motors.is_empty() {
            let count = motors.len();
            assumed.push(format!("motors 1 to {count} on outputs 1 to {count}"));
        }
        let range = known_range.unwrap_or_else(|| match given {
            Some(given) => {
                assumed.push(given.assumed());
                given.range()
            }
            None => {
                assumed.push("commands from 1000 to 2000 us".to_owned());
                assumed_range(1000.0, 2000.0, "us")
            }
        });
        let is_effective_assumed = !is_px4 && !ardupilot::has_limits(parameters);
        let effective = match (is_px4, is_effective_assumed) {
            (true, _) => crate::flight::whole_range("PX4 has no tighter limits"),
            (false, false) => ardupilot::effective_range(parameters),
            (false, true) => {
                assumed.push("effective range 0.15 to 0.95".to_owned());
                assumed_range(0.15, 0.95, "1")
            }
        };
        Self {
            motors,
            #[cfg(feature = "mavlink")]
            expected,
            range,
            effective,
            is_effective_assumed,
            declared: match is_px4 {
                true => DeclaredLayout::of_px4(parameters),
                false => DeclaredLayout::of_ardupilot(parameters, vehicle),
            },
            assumed,
        }
    }
}

/// The motors, and whether they are assumed to be on the first outputs because no parameter names them.
fn motors_of_px4(parameters: &Parameters, expected: Option<u16>) -> (Vec<(Motor, u16)>, bool) {
    let named = px4_motors(parameters);
    if !named.is_empty() {
        return (named, false);
    }
    let source = match px4::rotor_count(parameters) {
        Some(count) => format!("CA_ROTOR_COUNT = {count}, the first outputs"),
        None => "MAV_TYPE, the first outputs".to_owned(),
    };
    let first = ardupilot::numbered_motors(expected.unwrap_or(0), field, &source);
    (first, true)
}

fn assumed_range(low: f64, high: f64, unit: &'static str) -> Range {
    Range {
        low,
        high,
        unit,
        source: "assumed".to_owned(),
    }
}
