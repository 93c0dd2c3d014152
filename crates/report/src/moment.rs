//! The state of a flight at one time, with an explanation, for programs in which the user moves a time cursor.

use std::collections::BTreeMap;

use flagred::{
    estimator::Estimator,
    flight::{Assessment, NamedStep, Step},
};
use flagred_flightlog::Flight;
use fuzzy::engine::{ExplainedInput, FiredRule};
use serde::Serialize;

/// The state of a flight at a given time.
#[derive(Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Moment<'a> {
    /// The requested time, in seconds.
    t_s: f64,
    /// The flight mode.
    mode: Option<&'a str>,
    /// The latest step before the requested time, if it is recent.
    step: Option<NamedStep<'a>>,
    /// If the risk is interpolated, the distance to the nearest inputs that rules cover, in shares of their ranges.
    filled_from: Option<f64>,
    /// Whether an input was outside its range.
    clamped: bool,
    /// The inputs with the degrees of their terms; empty if an input that the risk depends on is unknown.
    inputs: Vec<ExplainedInput>,
    /// The units of the inputs, by name; inputs without a unit are omitted.
    units: BTreeMap<&'a str, &'a str>,
    /// The rules that fire, strongest first.
    rules: Vec<FiredRule>,
}

/// Returns the state at a time, in seconds on the log's clock.
pub fn moment<'a>(
    flight: &'a Flight,
    estimator: &'a Estimator,
    assessed: &'a Assessment,
    t_s: f64,
) -> Moment<'a> {
    let step = latest(estimator, assessed, t_s);
    let estimate = step.and_then(|step| step.estimate);
    let explained = step.and_then(|step| explain(estimator, step));
    let (inputs, rules) = explained.unwrap_or_default();
    let modes = flight.modes.iter().take_while(|mode| mode.t_s() <= t_s);
    let known = estimator.model().inputs.iter();
    Moment {
        t_s,
        mode: modes.last().map(|mode| mode.what.as_str()),
        step: step.map(|step| step.by_name(assessed)),
        filled_from: estimate.and_then(|estimate| estimate.filled_from),
        clamped: estimate.is_some_and(|estimate| estimate.clamped),
        inputs,
        units: known
            .filter_map(|input| Some((input.name.as_str(), input.unit.as_deref()?)))
            .collect(),
        rules,
    }
}

/// The latest step at or before a time; `None` if samples are missing between that step and the time.
fn latest<'a>(estimator: &Estimator, assessed: &'a Assessment, t_s: f64) -> Option<&'a Step> {
    let after = assessed.steps.partition_point(|step| step.t_s <= t_s);
    let step = assessed.steps.get(after.checked_sub(1)?)?;
    let longest_gap_s = estimator.profile().sampling.longest_gap_s;
    let longest_s = longest_gap_s.max(2.0 * assessed.widened_step_s.unwrap_or(0.0));
    (t_s - step.t_s <= longest_s).then_some(step)
}

/// The degrees of terms and rules; `None` if an input that the risk depends on is unknown. Other unknown inputs are
/// omitted, with the rules that depend on them.
fn explain(estimator: &Estimator, step: &Step) -> Option<(Vec<ExplainedInput>, Vec<FiredRule>)> {
    let (model, profile) = (estimator.model(), estimator.profile());
    let mut unknown: Vec<&str> = Vec::new();
    let values = model.inputs.iter().map(|variable| {
        let name = variable.name.as_str();
        let place = profile.inputs.iter().position(|input| input.name == name)?;
        let value = step.inputs.get(place).filter(|value| value.is_finite());
        Some(value.copied().unwrap_or_else(|| {
            unknown.push(name);
            variable.low
        }))
    });
    let values: Vec<f64> = values.collect::<Option<_>>()?;
    let is_known = |output: &str| {
        let reads_unknown = |input: &&str| unknown.contains(input);
        unknown.is_empty() || !model.inputs_of(output).iter().any(reads_unknown)
    };
    if !is_known(&profile.output) {
        return None;
    }
    let explanation = estimator.engine().explain(&values).ok()?;
    let (mut inputs, mut rules) = (explanation.inputs, explanation.rules);
    inputs.retain(|input| !unknown.contains(&input.name.as_str()));
    rules.retain(|fired| {
        let rule = model.rules.get(fired.rule);
        let mut concluded = rule.into_iter().flat_map(|rule| &rule.rule.consequents);
        concluded.all(|consequent| is_known(&consequent.output.text))
    });
    Some((inputs, rules))
}

#[cfg(test)]
mod tests {
    use super::*;

    const LOG: &str = "## pwm_low_us: 1000\n## pwm_high_us: 2000\nt_s,pwm1,pwm2,pwm3,pwm4,in_air\n";

    fn at(times: &[f64]) -> Vec<serde_json::Value> {
        let mut log = LOG.to_owned();
        for i in 0..600 {
            // The log has a gap from 20 to 30 s.
            let t_s = f64::from(i) * 0.05 + if i < 400 { 0.0 } else { 10.0 };
            log += &format!("{t_s},1500,15{:02},1500,1500,1\n", i % 60);
        }
        let options = flagred_flightlog::Options::default();
        let flight = flagred_flightlog::read(log.as_bytes(), &options).unwrap();
        let estimator = flagred::shipped::flagred();
        let assessed = flagred::log::assess(&flight, &estimator, Some(0.1));
        let moments = times
            .iter()
            .map(|t_s| moment(&flight, &estimator, &assessed, *t_s));
        moments
            .map(|moment| serde_json::to_value(moment).unwrap())
            .collect()
    }

    #[test]
    fn a_moment_has_its_step_and_the_rules_that_fired() {
        let [moment] = &at(&[10.04])[..] else {
            panic!("one moment")
        };
        assert_eq!(moment["step"]["t_s"], 10.0);
        assert!(moment["step"]["risk"].is_number());
        let rules = moment["rules"].as_array().unwrap();
        assert_eq!(rules[0]["rule"], moment["step"]["dominant_rule"]);
        assert_eq!(moment["inputs"].as_array().unwrap().len(), 5);
        let given = &moment["inputs"][0];
        let name = given["name"].as_str().unwrap();
        assert_eq!(given["given"], moment["step"]["inputs"][name]);
    }

    #[test]
    fn a_moment_before_the_first_step_or_in_a_hole_is_unknown() {
        for moment in at(&[-1.0, 25.0]) {
            assert!(moment["step"].is_null() && moment["rules"] == serde_json::json!([]));
        }
    }
}
