//! Parameters of an autopilot, from its log or its telemetry.

use std::collections::BTreeMap;

/// Parameters by name. For a log, the first value of each is kept, because failure tests and automatic tuning change
/// parameters in flight.
#[derive(Debug, Default)]
pub(crate) struct Parameters {
    values: BTreeMap<String, f64>,
    left_out: u64,
}

/// The parameter of ArduPilot that selects what is logged.
pub(crate) const LOG_BITMASK: &str = "LOG_BITMASK";
/// The maximum number of parameters that are kept; vehicles have up to about 2,000.
const MAX_PARAMETERS: usize = 1 << 14;
/// The maximum length of a name in bytes; autopilots allow 16.
const LONGEST_NAME: usize = 64;

impl Parameters {
    pub(crate) fn insert(&mut self, name: &str, value: f64) {
        if !value.is_finite() || self.values.contains_key(name) {
            return;
        }
        match self.values.len() < MAX_PARAMETERS && name.len() <= LONGEST_NAME {
            true => _ = self.values.insert(name.to_owned(), value),
            false => self.left_out += 1,
        }
    }

    /// Replaces the value of a parameter, if the parameter is known.
    pub(crate) fn set(&mut self, name: &str, value: f64) {
        if let Some(known) = self.values.get_mut(name) {
            *known = value;
        }
    }

    pub(crate) fn get(&self, name: &str) -> Option<f64> {
        self.values.get(name).copied()
    }

    /// The number of values that were not kept, because there were too many names or a name was too long.
    pub(crate) fn left_out(&self) -> u64 {
        self.left_out
    }

    /// The known parameters that an assessment depends on: range and limits of the motors, frame, gains of the control
    /// loops, and the selection of what is logged. `source` is the message that contains them.
    pub(crate) fn of_motors(&self, source: &str) -> Vec<Parameter> {
        let throttle = format!("RC{}", self.get("RCMAP_THROTTLE").unwrap_or(3.0));
        let kept = self
            .values
            .iter()
            .filter(|(name, _)| is_of_motors(name, &throttle));
        let kept = kept.map(|(name, value)| Parameter {
            name: name.clone(),
            value: *value,
            source: source.to_owned(),
        });
        kept.collect()
    }

    pub(crate) fn pair(&self, low: &str, high: &str) -> Option<(f64, f64)> {
        Some((self.get(low)?, self.get(high)?)).filter(|(low, high)| high > low)
    }
}

impl<'a> FromIterator<(&'a str, f64)> for Parameters {
    fn from_iter<T: IntoIterator<Item = (&'a str, f64)>>(pairs: T) -> Self {
        let mut parameters = Self::default();
        for (name, value) in pairs {
            parameters.insert(name, value);
        }
        parameters
    }
}

/// A parameter of the autopilot.
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[non_exhaustive]
pub struct Parameter {
    /// The name of the parameter.
    pub name: String,
    /// The first value, because failure tests and automatic tuning change parameters in flight.
    pub value: f64,
    /// The message that contains the parameter, such as `PARM` or `PARAM_VALUE`.
    pub source: String,
}

/// Whether a parameter concerns the motors or the control loops that command them. Parameters that assign
/// outputs to motors are excluded, because the assignment is recorded with each motor.
fn is_of_motors(name: &str, throttle: &str) -> bool {
    const BEGINNINGS: [&str; 15] = [
        "MOT_PWM_",
        "MOT_SPIN_",
        "MOT_THST_",
        "MOT_TCRV_",
        "FRAME",
        "THR_M",
        "RCMAP_THROTTLE",
        "ATC_RAT_",
        "ATC_ANG_",
        "PWM_M",
        "MC_ROLL",
        "MC_PITCH",
        "MC_YAW",
        "CA_ROTOR_COUNT",
        LOG_BITMASK,
    ];
    let begins = |beginning: &&str| name.starts_with(beginning);
    let is_throttle = matches!(name.strip_prefix(throttle), Some("_MIN" | "_MAX"));
    is_throttle || BEGINNINGS.iter().any(begins) && !name.contains("_FUNC")
}

/// Returns the name of a number in a table that may have gaps. If the number has no name, returns
/// `what` and the number.
pub(crate) fn name_of(names: &[&str], number: i64, what: &str) -> String {
    let name = usize::try_from(number)
        .ok()
        .and_then(|index| names.get(index));
    match name {
        Some(name) if !name.is_empty() => (*name).into(),
        _ => format!("{what} {number}"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn parameters_of_motors_and_gains_are_kept_in_order_of_their_names() {
        let all = [
            ("SERVO3_FUNCTION", 35.0),
            ("RC3_MIN", 1100.0),
            ("RC2_MIN", 1100.0),
            ("MOT_SPIN_MAX", 0.95),
            ("ATC_RAT_RLL_P", 0.135),
            ("PWM_MAIN_FUNC1", 101.0),
            ("BATT_CAPACITY", 5000.0),
            ("MOT_SPIN_MAX", 0.9),
        ];
        let kept = all.into_iter().collect::<Parameters>().of_motors("PARM");
        let kept: Vec<_> = kept
            .iter()
            .map(|kept| (kept.name.as_str(), kept.value))
            .collect();
        let expected = [
            ("ATC_RAT_RLL_P", 0.135),
            ("MOT_SPIN_MAX", 0.95),
            ("RC3_MIN", 1100.0),
        ];
        assert_eq!(kept, expected);
    }
}
