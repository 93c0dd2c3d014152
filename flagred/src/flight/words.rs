//! The words of a finding for the pilot: what happened, what it means and what to do.
//!
//! A finding about a risk has the words of the profile for the input that raised it ([`Profile::findings`]); an input
//! without an entry is described by its name, term and description. The words of all other findings are in this file.
//! docs/findings.md lists them.
//!
//! [`Profile::findings`]: crate::profile::Profile::findings

use alloc::{
    format,
    string::{String, ToString},
};

use fuzzy::model::Variable;

use super::{Finding, RiskInterval};
use crate::{
    estimator::Estimator,
    margin::Side,
    profile::Profile,
    verdict::{Measure, MotorFinding},
};

/// The words of a finding for the pilot.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Words {
    /// A stable identifier for use by programs: lower-case letters, digits and `_`.
    pub code: String,
    /// A few words, for messages limited to 50 characters. The second part can be left out, because
    /// the first part is also true without it.
    pub brief: [String; 2],
    /// What happened, and what it means.
    pub text: String,
    /// What to do.
    pub advice: String,
}

impl Finding {
    /// The words of the finding for the pilot, with its numbers filled in. Motors are numbered by their index + 1.
    ///
    /// # Example
    /// ```
    /// use flagred::{flight::Assessor, monitor::{Craft, Sample}, shipped};
    ///
    /// let estimator = shipped::flagred();
    /// let mut assessor = Assessor::new(&estimator, Craft::new(4), None)?;
    /// for i in 0..1500 {
    ///     let t_s = f64::from(i) * 0.02;
    ///     let motors = if t_s < 20.0 { [0.5; 4] } else { [1.0, 0.0, 1.0, 0.0] };
    ///     assessor.push(&Sample { t_s, motors: &motors, in_air: Some(true), signals: &[] });
    /// }
    /// let words = assessor.finish().findings[0].words(&estimator);
    /// assert_eq!(words.code, "motor_at_limit");
    /// assert!(words.text.ends_with("The risk reached 95 %."), "{}", words.text);
    /// # Ok::<(), flagred::monitor::MonitorError>(())
    /// ```
    pub fn words(&self, estimator: &Estimator) -> Words {
        let Words {
            code,
            mut brief,
            text,
            advice,
        } = match &self.cause {
            Some(cause) => Words::of_cause(estimator, &cause.input, &cause.term),
            None => Words::of_measure(estimator.profile(), self.measure),
        };
        let mut text = self.filled(&text);
        if self.is_of_risk() {
            if let (Some(_), Some(motor)) = (&self.cause, &self.motor) {
                let limit = side(motor.side, "lower", "upper");
                let number = motor.number;
                brief = [format!("{limit} limit"), format!(", motor {number}")];
                text += &format!(" Motor {number} was closest to its {limit} limit.");
            }
            text += &self.reached();
        }
        Words {
            code,
            brief: brief.map(|part| self.filled(&part)),
            text,
            advice: self.filled(&advice),
        }
    }

    /// Whether the finding is about the risk.
    pub fn is_of_risk(&self) -> bool {
        matches!(self.measure, Measure::Risk | Measure::ElevatedRisk)
    }

    /// The sentence about the highest value, such as ` The risk reached 93 %.`
    fn reached(&self) -> String {
        let of = match &self.risk_output {
            Some(risk) => format!(" `{risk}`"),
            None => String::new(),
        };
        format!(" The {}{of} reached {:.0} %.", self.measure, self.value_pct)
    }

    /// Returns a sentence that warns that the threshold is within the interval of the highest risk, so that more
    /// samples could change the level. `None` if the interval is unknown or above the threshold.
    pub fn uncertainty(&self) -> Option<String> {
        let RiskInterval { low_pct, high_pct } = self.risk_interval?;
        (low_pct < self.threshold_pct).then(|| {
            format!(
                "the threshold of {} % is within the interval of the risk, {low_pct:.0} to {high_pct:.0} %",
                number(self.threshold_pct)
            )
        })
    }

    /// A text with its placeholders in braces replaced by the numbers of the finding.
    fn filled(&self, text: &str) -> String {
        let mut text = text.to_string();
        let mut fill = |name: &str, value: &dyn Fn() -> String| {
            if text.contains(name) {
                text = text.replace(name, &value());
            }
        };
        if let Some(cause) = &self.cause {
            fill("{percent}", &|| format!("{:.0}", 100.0 * cause.value));
            fill("{value}", &|| number(cause.value));
        }
        fill("{peak}", &|| format!("{:.0}", self.value_pct));
        fill("{threshold}", &|| format!("{:.0}", self.threshold_pct));
        let motor = self.motor.as_ref();
        fill("{motor}", &|| {
            motor.map_or_else(|| "a motor".into(), name_of)
        });
        fill("{side}", &|| {
            let side = motor.map(|motor| side(motor.side, "below", "above"));
            side.unwrap_or("beside").into()
        });
        text
    }
}

impl Words {
    /// The words for an input that belongs to a term, with the placeholders `{value}` and
    /// `{percent}`.
    pub fn of_cause(estimator: &Estimator, input: &str, term: &str) -> Words {
        let mut known = estimator.profile().findings.iter();
        if let Some(words) = known.find(|words| words.input == input) {
            return Words {
                code: words.code.clone(),
                brief: [words.brief.clone(), String::new()],
                text: words.text.clone(),
                advice: words.advice.clone(),
            };
        }
        let mut inputs = estimator.model().inputs.iter();
        let variable = inputs.find(|variable| variable.name == input);
        let unit = variable.and_then(|variable| variable.unit.as_deref());
        let unit = unit.map_or(String::new(), |unit| format!(" {unit}"));
        let description = variable.and_then(first_phrase);
        let description = description.map_or(String::new(), |phrase| format!(" ({phrase})"));
        Words {
            code: code(input),
            brief: [input.into(), format!(" {term}")],
            text: format!("{input} was {term}: {{value}}{unit}{description}."),
            advice: advice(estimator.profile()).into(),
        }
    }

    /// The words of a finding that is not about the risk, or of a risk that no rule raised, with the placeholders
    /// `{peak}`, `{threshold}`, `{motor}` and `{side}`.
    pub fn of_measure(profile: &Profile, measure: Measure) -> Words {
        let (code, brief, text, advice) = match measure {
            Measure::Risk | Measure::ElevatedRisk => (
                "risk_interpolated",
                ["interpolated", ""],
                "No rule applies to this moment, so the risk is interpolated between rules.",
                advice(profile),
            ),
            Measure::CommandNoise => (
                "command_noise",
                ["command noise {peak} %", ""],
                "The motor commands are noisy, by {peak} % of their range: vibration, or gains that are too high.",
                "This alone is not a danger. After landing, check propellers, mounts and filters.",
            ),
            Measure::Reserve => (
                "low_thrust_reserve",
                ["thrust reserve {peak} %", ""],
                "The motors ran close to full thrust: on average only {peak} % of their range was left, less than {threshold} %. \
                 Gusts and climbs need that reserve.",
                "Land soon. Before the next flight, reduce payload or charge the battery.",
            ),
            Measure::Imbalance => (
                "imbalance",
                ["imbalance {peak} %", ", {motor}"],
                "The motors share the load differently from earlier in the flight, by {peak} % of their range. The motor to check \
                 is {motor}, whose share is now {side} its earlier share.",
                "Land. After landing, check {motor}, and whether the load has shifted.",
            ),
            Measure::PairImbalance => (
                "pair_imbalance",
                ["pair imbalance {peak} %", ", {motor}"],
                "The commands of two opposite motors differ by {peak} % of their range. The motor to check is {motor}, whose \
                 command is {side} that of the opposite motor: it may be weak, or the load may be off centre.",
                "Land. After landing, check {motor}, and the position of battery and payload.",
            ),
            Measure::WeakMotor => (
                "weak_motor",
                ["{motor} weak: +{peak} %", ""],
                "The command of {motor} rose by {peak} % of its range, compared with the other motors: this motor gives less thrust \
                 than before.",
                "Land now. After landing, check {motor}: propeller, motor, speed controller and wiring.",
            ),
            Measure::IdleInAir => (
                "motors_idle_in_air",
                ["motors idle in the air", ""],
                "The motors had idled for 3 s while the autopilot reported that the vehicle was in the air: it fell.",
                "Before the next flight, find out why the motors stopped: kill switch, failsafe, power.",
            ),
        };
        Words {
            code: code.into(),
            brief: brief.map(String::from),
            text: text.into(),
            advice: advice.into(),
        }
    }
}

/// The advice for a risk whose input has no words of its own.
fn advice(profile: &Profile) -> &'static str {
    match profile.reads_motors() {
        true => "Reduce speed or land until the risk falls. After landing, look for the cause.",
        false => "Reduce speed or stop until the risk falls. After that, look for the cause.",
    }
}

/// Names a motor: `motor 3`, or `motor 3 or 8` if the commands do not show which one.
fn name_of(motor: &MotorFinding) -> String {
    let or = motor.or_number.map(|number| format!(" or {number}"));
    format!("motor {}{}", motor.number, or.unwrap_or_default())
}

fn side(side: Side, low: &'static str, high: &'static str) -> &'static str {
    match side {
        Side::Lower => low,
        Side::Upper => high,
    }
}

/// A number rounded to 3 decimals.
fn number(value: f64) -> String {
    format!("{}", libm::round(value * 1e3) / 1e3 + 0.0)
}

/// Converts a name to a code of lower-case letters, digits and `_`.
fn code(name: &str) -> String {
    let letter = |c: char| match c.to_ascii_lowercase() {
        c if c.is_ascii_alphanumeric() => c,
        _ => '_',
    };
    name.chars().map(letter).collect()
}

/// The description of an input up to its first comma, beginning with a lower-case letter as inside a sentence.
fn first_phrase(input: &Variable) -> Option<String> {
    let description = input.description.as_deref()?;
    let phrase = description.split([',', '.', ';']).next()?;
    let mut letters = phrase.chars();
    Some(match (letters.next(), letters.clone().next()) {
        (Some(first), Some(second)) if !second.is_uppercase() => {
            first.to_lowercase().chain(letters).collect()
        }
        _ => phrase.into(),
    })
}
