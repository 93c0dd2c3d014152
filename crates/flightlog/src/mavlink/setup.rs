//! Determines the outputs that drive the motors of a live vehicle, and their limits, from its parameters; lists the
//! parameters that are still needed.

use super::outputs::{KnownOutputs, motors_expected};
use super::servo::{OUTPUTS_PER_PORT, bank, field, px4_motors};
use super::telemetry::Pulses;
use crate::outputs::LONGEST_PULSE_US;
use crate::{
    Geometry, Motor, PulseRange, Range, Vehicle, ardupilot, geometry, parameters::Parameters,
};

/// The values of an output that is not driven (0) or whose pulse width is unknown.
const NO_PULSE: [u16; 2] = [0, u16::MAX];
/// The number of outputs of PX4's AUX bank on any board.
const AUX_OUTPUTS: usize = 8;

/// Motors and the range of their commands, each with its source.
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[non_exhaustive]
pub struct Setup {
    /// The motors in order of their number.
    pub motors: Vec<Motor>,
    /// How much each motor rolls, pitches and yaws the vehicle; `None` if unknown.
    pub geometry: Option<Geometry>,
    /// The range of the commands, 0 % to 100 %.
    pub range: Range,
    /// The part of the range that is used in flight, as fractions of the whole range.
    pub effective_range: Range,
    /// The assumptions for values that the vehicle did not report, as texts; empty without assumptions.
    pub assumed: Vec<String>,
    /// The number of motors that the vehicle reported.
    #[cfg_attr(feature = "serde", serde(skip))]
    expected: Option<usize>,
    /// The output of each motor, from 1.
    #[cfg_attr(feature = "serde", serde(skip))]
    pub(super) outputs: Vec<usize>,
}

impl Setup {
    /// Determines motors and ranges from the known parameters, with assumptions for missing ones.
    pub(super) fn of(
        parameters: &Parameters,
        vehicle: &Vehicle,
        is_px4: bool,
        given: Option<PulseRange>,
    ) -> Setup {
        let known = KnownOutputs::of(parameters, vehicle, is_px4, given);
        let (motors, outputs): (Vec<Motor>, Vec<u16>) = known.motors.into_iter().unzip();
        Setup {
            expected: known.expected.map(usize::from),
            geometry: geometry::of(&motors, &known.declared),
            outputs: outputs.iter().map(|&output| usize::from(output)).collect(),
            motors,
            range: known.range,
            effective_range: known.effective,
            assumed: known.assumed,
        }
    }

    /// The number of motors that the vehicle reported; outputs may be known for fewer motors.
    pub fn motors_expected(&self) -> Option<usize> {
        self.expected
    }

    /// Whether the same packets result in the same commands and the same geometry. Equivalent setups may differ in
    /// their texts.
    pub fn is_equivalent(&self, other: &Setup) -> bool {
        let limits = |of: &Setup| {
            let (range, used) = (&of.range, &of.effective_range);
            [range.low, range.high, used.low, used.high]
        };
        let numbers = |of: &Setup| {
            of.motors
                .iter()
                .map(|motor| motor.number)
                .collect::<Vec<_>>()
        };
        (self.outputs == other.outputs && are_alike(&limits(self), &limits(other)))
            && numbers(self) == numbers(other)
            && same_factors(self.geometry.as_ref(), other.geometry.as_ref())
    }

    /// Converts pulses to commands on the effective range, 0..1, one value for each motor; NaN is unknown.
    pub fn effective_commands(&self, pulses: &Pulses, commands: &mut [f64]) {
        for (command, &output) in commands.iter_mut().zip(&self.outputs) {
            let index = output.checked_sub(1);
            let pulse = index.and_then(|index| {
                let port = pulses.0.get(index / OUTPUTS_PER_PORT)?;
                port.get(index % OUTPUTS_PER_PORT)
            });
            *command = match pulse {
                Some(pulse)
                    if !NO_PULSE.contains(pulse) && f64::from(*pulse) <= LONGEST_PULSE_US =>
                {
                    let fraction = self.range.fraction(f64::from(*pulse));
                    self.effective_range.fraction(fraction)
                }
                _ => f64::NAN,
            };
        }
    }

    /// The port whose SERVO_OUTPUT_RAW message completes the commands of all motors.
    pub(super) fn last_port(&self) -> usize {
        let last = self.outputs.iter().max().copied().unwrap_or(1);
        last.saturating_sub(1) / OUTPUTS_PER_PORT
    }
}

/// Whether two geometries have the same factors, apart from rounding.
fn same_factors(one: Option<&Geometry>, other: Option<&Geometry>) -> bool {
    let factors = |geometry: Option<&Geometry>| {
        geometry.map_or(Vec::new(), |geometry| geometry.factors.concat())
    };
    are_alike(&factors(one), &factors(other))
}

/// Whether numbers are the same, apart from rounding: parameters have single precision.
fn are_alike(one: &[f64], other: &[f64]) -> bool {
    let alike = |(a, b): (&f64, &f64)| (a - b).abs() <= 1e-6 * a.abs().max(1.0);
    one.len() == other.len() && one.iter().zip(other).all(alike)
}

/// The parameters that determine the motors and their range and that are not known yet.
pub(super) fn missing(parameters: &Parameters, vehicle: &Vehicle, is_px4: bool) -> Vec<String> {
    let mut names = if is_px4 {
        wanted_of_px4(parameters, vehicle)
    } else {
        wanted_of_ardupilot(parameters, vehicle)
    };
    names.retain(|name| parameters.get(name).is_none());
    names
}

fn wanted_of_ardupilot(parameters: &Parameters, vehicle: &Vehicle) -> Vec<String> {
    let fixed = [
        "MOT_PWM_MIN",
        "MOT_PWM_MAX",
        "MOT_SPIN_MIN",
        "MOT_SPIN_MAX",
        "FRAME_CLASS",
        "FRAME_TYPE",
    ];
    let mut names: Vec<String> = fixed.iter().map(|&name| name.to_owned()).collect();
    let functions = |outputs: std::ops::RangeInclusive<usize>| {
        outputs.map(|output| format!("SERVO{output}_FUNCTION"))
    };
    names.extend(functions(1..=16));
    let first_known = functions(1..=16).all(|name| parameters.get(&name).is_some());
    let found = ardupilot::motors(parameters, vehicle, field).len();
    if first_known && vehicle.motors.is_some_and(|all| found < usize::from(all)) {
        // Some motors are still unknown, so they are on outputs that only some vehicles have.
        names.extend(functions(17..=32));
    }
    let unset = |name| parameters.get(name).is_some_and(|value| value <= 0.0);
    if unset("MOT_PWM_MIN") || unset("MOT_PWM_MAX") {
        // Without these limits the range is that of the throttle channel.
        names.push("RCMAP_THROTTLE".to_owned());
        if let Some(channel) = parameters.get("RCMAP_THROTTLE") {
            names.extend(["MIN", "MAX"].map(|end| format!("RC{channel}_{end}")));
        }
    }
    names
}

/// The parameters of PX4 to request. Before PARAM_ERROR existed, PX4 did not answer requests for missing parameters,
/// so functions are requested until all motors are found.
fn wanted_of_px4(parameters: &Parameters, vehicle: &Vehicle) -> Vec<String> {
    let motors = px4_motors(parameters);
    let count = "CA_ROTOR_COUNT".to_owned();
    let expected = motors_expected(parameters, vehicle, true);
    let all = expected.map_or(usize::MAX, usize::from);
    let ends = ["MIN", "MAX"];
    let Some((_, output)) = motors.first().filter(|_| motors.len() >= all) else {
        let main = (1..=OUTPUTS_PER_PORT).map(|output| format!("PWM_MAIN_FUNC{output}"));
        let aux = (1..=AUX_OUTPUTS).map(|output| format!("PWM_AUX_FUNC{output}"));
        // Versions before 1.13 have other parameters, for one bank or for all banks.
        let old = ends.map(|end| format!("PWM_MAIN_{end}"));
        let older = ends.map(|end| format!("PWM_{end}"));
        let first = std::iter::once(count).chain(main).chain(aux);
        return first.chain(old).chain(older).collect();
    };
    let (bank, index) = bank(*output);
    let bank = ["MAIN", "AUX"][usize::from(bank).min(1)];
    let limits = ends.map(|end| format!("PWM_{bank}_{end}{}", index + 1));
    let rotors = (0..motors.len()).flat_map(|rotor| {
        let parts = ["PX", "PY", "PZ", "AX", "AY", "AZ", "KM", "CT"];
        parts.map(|part| format!("CA_ROTOR{rotor}_{part}"))
    });
    limits.into_iter().chain([count]).chain(rotors).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn vehicle(motors: u16) -> Vehicle {
        Vehicle {
            motors: Some(motors),
            ..Vehicle::default()
        }
    }

    fn parameters(known: &[(&str, f64)]) -> Parameters {
        known.iter().copied().collect()
    }

    #[test]
    fn px4_motors_are_found_by_function_in_both_banks() {
        let known = parameters(&[
            ("PWM_MAIN_FUNC1", 102.0),
            ("PWM_MAIN_FUNC2", 0.0),
            ("PWM_MAIN_FUNC4", 101.0),
            ("PWM_AUX_FUNC3", 103.0),
            ("PWM_AUX_FUNC4", 201.0),
            ("PWM_MAIN_MIN4", 1100.0),
            ("PWM_MAIN_MAX4", 1900.0),
        ]);
        let missing = missing(&known, &vehicle(3), true);
        assert!(missing.iter().all(|name| name.starts_with("CA_ROTOR")));
        let setup = Setup::of(&known, &vehicle(3), true, None);
        assert_eq!(setup.outputs, [4, 1, 19]);
        assert_eq!(setup.last_port(), 1);
        assert_eq!(setup.motors[2].output, "servo3_raw of port 1");
        assert_eq!((setup.range.low, setup.range.high), (1100.0, 1900.0));
        assert_eq!(
            (setup.effective_range.low, setup.effective_range.high),
            (0.0, 1.0)
        );
        assert_eq!(setup.assumed, Vec::<String>::new());
    }

    #[test]
    fn functions_of_px4_are_requested_until_all_motors_are_found_then_their_limits() {
        let nothing = missing(&parameters(&[]), &vehicle(4), true);
        assert!(nothing.contains(&"PWM_MAIN_FUNC16".to_owned()));
        assert!(nothing.contains(&"PWM_AUX_FUNC8".to_owned()));
        assert!(nothing.contains(&"PWM_MIN".to_owned()));
        let functions = [101.0, 102.0, 103.0, 104.0].into_iter().zip(1..);
        let names: Vec<(String, f64)> = functions
            .map(|(function, n)| (format!("PWM_AUX_FUNC{n}"), function))
            .collect();
        let known: Parameters = names.iter().map(|(name, f)| (name.as_str(), *f)).collect();
        let asked_for = missing(&known, &vehicle(4), true);
        assert_eq!(
            asked_for[..4],
            [
                "PWM_AUX_MIN1",
                "PWM_AUX_MAX1",
                "CA_ROTOR_COUNT",
                "CA_ROTOR0_PX"
            ]
        );
        assert_eq!(asked_for.len(), 3 + 4 * 8);
    }

    #[test]
    fn px4_without_output_functions_has_motors_on_the_first_outputs() {
        let old = parameters(&[("PWM_MIN", 1075.0), ("PWM_MAX", 1950.0)]);
        let setup = Setup::of(&old, &vehicle(4), true, None);
        assert_eq!(setup.outputs, [1, 2, 3, 4]);
        assert_eq!((setup.range.low, setup.range.high), (1075.0, 1950.0));
        assert_eq!(setup.assumed, ["motors 1 to 4 on outputs 1 to 4"]);
        let unknown = Setup::of(&parameters(&[]), &vehicle(4), true, None);
        assert_eq!(unknown.assumed.len(), 2);
    }

    #[test]
    fn ardupilot_motors_on_outputs_over_16_are_found() {
        let mut names: Vec<(String, f64)> = (1..=16)
            .map(|n| {
                (
                    format!("SERVO{n}_FUNCTION"),
                    if n > 12 { f64::from(n) + 20.0 } else { 0.0 },
                )
            })
            .collect();
        let known = |names: &[(String, f64)]| -> Parameters {
            names.iter().map(|(name, f)| (name.as_str(), *f)).collect()
        };
        let of = |names: &[(String, f64)], motors| missing(&known(names), &vehicle(motors), false);
        assert!(!of(&names, 4).contains(&"SERVO17_FUNCTION".to_owned()));
        assert!(of(&names, 6).contains(&"SERVO17_FUNCTION".to_owned()));
        names.extend([
            ("SERVO17_FUNCTION".to_owned(), 37.0),
            ("SERVO18_FUNCTION".to_owned(), 38.0),
        ]);
        let setup = Setup::of(&known(&names), &vehicle(6), false, None);
        assert_eq!(setup.outputs, [13, 14, 15, 16, 17, 18]);
        assert_eq!(setup.last_port(), 1);
        assert_eq!(setup.motors[5].output, "servo2_raw of port 1");
        assert!(!of(&names, 6).iter().any(|name| name.contains("FUNCTION")));
    }
}
