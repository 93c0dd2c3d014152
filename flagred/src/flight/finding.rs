//! The findings of a flight, with the names of their causes.

use alloc::string::{String, ToString};
use core::{fmt, ops::Deref};

use super::RiskInterval;
use crate::{estimator::Estimator, monitor::RiskFinding, verdict};

/// A finding of a flight, with its cause by name.
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[non_exhaustive]
pub struct Finding {
    /// The time, measure and level of the finding. Its motor is known only if a motor is the cause.
    #[cfg_attr(feature = "serde", serde(flatten))]
    pub found: verdict::Finding,
    /// The cause of the risk; `None` if no rule raised it, as for a notice or an interpolated risk.
    pub cause: Option<Cause>,
    /// The interval of the highest risk of the finding, from the uncertainty of its inputs. `None` if steps are not kept,
    /// for other measures than the risk, and if the uncertainty is unknown.
    #[cfg_attr(feature = "serde", serde(flatten))]
    pub risk_interval: Option<RiskInterval>,
    /// The output that is the risk, if it is one of [`Profile::other_risks`](crate::profile::Profile::other_risks).
    #[cfg_attr(feature = "serde", serde(skip_serializing_if = "Option::is_none"))]
    #[cfg_attr(feature = "schema", schemars(with = "String"))]
    pub risk_output: Option<String>,
}

impl Deref for Finding {
    type Target = verdict::Finding;

    fn deref(&self) -> &verdict::Finding {
        &self.found
    }
}

impl Finding {
    /// Adds the names of the cause to a finding.
    pub(super) fn new(found: verdict::Finding, estimator: &Estimator) -> Finding {
        let cause = found.cause.and_then(|cause| {
            let (input, term) = estimator.propositions().nth(cause.proposition)?;
            Some(Cause {
                input: input.to_string(),
                value: cause.value,
                term: term.to_string(),
                rule: cause.rule,
            })
        });
        Finding {
            found,
            cause,
            risk_interval: None,
            risk_output: None,
        }
    }

    /// A finding about another risk of the profile.
    pub(super) fn of_other_risk(of_risk: &RiskFinding, estimator: &Estimator) -> Finding {
        let other = estimator.others().get(of_risk.risk).unwrap_or(estimator);
        Finding {
            risk_output: Some(other.profile().output.clone()),
            ..Finding::new(of_risk.found, other)
        }
    }
}

/// The cause of the risk when a level was reached: [`verdict::Cause`] by name.
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[non_exhaustive]
pub struct Cause {
    /// The input that distinguishes the rule. Of the true propositions in the rule's antecedent, the one that the
    /// fewest rules share is about this input.
    pub input: String,
    /// The value of that input.
    pub value: f64,
    /// The term, with its hedges.
    pub term: String,
    /// The index of the rule in the model; serialised as its number, from 1.
    #[cfg_attr(feature = "serde", serde(serialize_with = "crate::verdict::from_one"))]
    #[cfg_attr(feature = "schema", schemars(range(min = 1)))]
    pub rule: usize,
}

impl fmt::Display for Cause {
    /// Writes the input and the term, such as `unsteady_now violent`.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{} {}", self.input, self.term)
    }
}

state! {
    struct Finding { found, cause, risk_interval, risk_output }
    struct Cause { input, value, term, rule }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{
        board::OwnedMemory, cause::is_of_limits, estimator::Memory, profile::Profile, shipped,
    };
    use alloc::{format, vec::Vec};

    const RULES: &str = "
fuzzy: 1
name: shaken
inputs:
  shake: {range: [0, 1], partition: {calm: 0, violent: 1}}
  at_limit: {range: [0, 1], partition: {none: 0, much: 1}}
outputs: {risk: {range: [0, 100], partition: [low, medium, high]}}
operators: {and: product, or: maximum, implication: product, aggregation: sum}
rules:
  - IF at_limit IS much THEN risk IS high
  - IF shake IS calm AND at_limit IS none THEN risk IS low
  - IF at_limit IS none AND shake IS violent THEN risk IS high
  - IF shake IS very violent AND at_limit IS none THEN risk IS medium
";

    fn estimator() -> Estimator {
        let profile = "
flagred: 1
name: shaken
rules: shaken
inputs:
  at_limit: {share_below: 0.01, of: motor_margin}
  shake: {std: {mean: motor_command}}
"
        .parse::<Profile>()
        .unwrap();
        let rules = fuzzy::yaml::parse(RULES).unwrap().model;
        Estimator::new(&profile, &rules).unwrap()
    }

    /// The cause for given values of the inputs, according to the engine and to the exported plan.
    fn cause(estimator: &Estimator, inputs: [f64; 2]) -> Option<String> {
        let risk_pct = estimator.at(&inputs).unwrap().risk_pct;
        let found = estimator.cause(&inputs, risk_pct, &mut Memory::of(estimator));
        let plan = estimator.plan().unwrap();
        let mut memory = OwnedMemory::new(&plan, 4);
        assert_eq!(memory.monitor(&plan).unwrap().cause_at(&inputs), found);
        let found = verdict::Finding {
            cause: found,
            ..verdict::Finding::NONE
        };
        let cause = Finding::new(found, estimator).cause?;
        Some(format!("{cause} {}, rule {}", cause.value, cause.rule))
    }

    #[test]
    fn the_cause_is_the_rule_that_raises_the_risk_most_without_its_guard() {
        let estimator = estimator();
        for (inputs, expected) in [
            ([0.0, 0.6], "shake violent 0.6, rule 2"),
            ([0.1, 0.9], "shake violent 0.9, rule 2"),
            ([0.9, 0.5], "at_limit much 0.9, rule 0"),
            ([0.0, 0.0], "shake calm 0, rule 1"),
        ] {
            assert_eq!(cause(&estimator, inputs).as_deref(), Some(expected));
        }
    }

    /// The risk depends on the output `strain`, and `strain` on the inputs. The rules for little
    /// strain fire more strongly.
    #[test]
    fn the_cause_is_found_through_a_chain() {
        let rules = "
fuzzy: 1
name: chained
inputs:
  shake: {range: [0, 1], partition: {calm: 0, violent: 1}}
  at_limit: {range: [0, 1], partition: {none: 0, much: 1}}
outputs:
  strain: {range: [0, 10], partition: [low, high]}
  risk: {range: [0, 100], partition: [low, high]}
operators: {and: product, or: maximum, implication: product, aggregation: sum}
rules:
  - IF at_limit IS much THEN risk IS high
  - IF strain IS somewhat high AND at_limit IS none THEN risk IS high
  - IF at_limit IS none AND strain IS low THEN risk IS low
  - IF at_limit IS none THEN strain IS low WITH 0.95
  - IF shake IS violent THEN strain IS high WITH 0.9
  - IF shake IS calm THEN strain IS low
";
        let rules = fuzzy::yaml::parse(rules).unwrap().model;
        let estimator = Estimator::new(estimator().profile(), &rules).unwrap();
        let cause = |inputs: [f64; 2]| {
            let risk_pct = estimator.at(&inputs).unwrap().risk_pct;
            let plan = estimator.plan().unwrap();
            let mut memory = OwnedMemory::new(&plan, 4);
            let on_board = memory.monitor(&plan).unwrap().at(&inputs).unwrap();
            assert_eq!(on_board.risk_pct.to_bits(), risk_pct.to_bits());
            cause(&estimator, inputs).unwrap()
        };
        assert_eq!(cause([0.0, 0.9]), "shake violent 0.9, rule 4");
        assert_eq!(cause([0.9, 0.1]), "at_limit much 0.9, rule 0");
        assert_eq!(cause([0.0, 0.0]), "shake calm 0, rule 5");
        let all: Vec<String> = estimator
            .propositions()
            .map(|(input, term)| format!("{input} {term}"))
            .collect();
        assert!(all.contains(&"strain somewhat high".into()), "{all:?}");
    }

    /// One rule contains a term with a hedge, and an alternative that is not true.
    #[test]
    fn a_term_is_reported_with_its_hedges_and_only_where_it_applies() {
        let rules = RULES.replace(
            "shake IS violent THEN",
            "(at_limit IS much OR shake IS very violent) THEN",
        );
        let rules = fuzzy::yaml::parse(&rules).unwrap().model;
        let estimator = Estimator::new(estimator().profile(), &rules).unwrap();
        assert_eq!(
            cause(&estimator, [0.0, 0.9]).as_deref(),
            Some("shake very violent 0.9, rule 2")
        );
        let all: Vec<String> = estimator
            .propositions()
            .map(|(input, term)| format!("{input} {term}"))
            .collect();
        assert_eq!(all[..2], ["at_limit much", "shake calm"]);
    }

    #[test]
    fn only_findings_about_motor_limits_name_a_motor() {
        let estimator = shipped::flagred();
        let plan = estimator.plan().unwrap();
        let about = (0..6).map(|input| is_of_limits((plan.channels, plan.inputs), input, 0));
        assert_eq!(
            about.collect::<Vec<_>>(),
            [false, false, false, false, true, true]
        );
    }
}
