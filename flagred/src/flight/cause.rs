//! Why the risk is high: the input, its term and the rule that raise it most.

use alloc::{string::String, vec::Vec};
use core::ops::Deref;

use fuzzy::{
    Model,
    engine::{Degree, Explanation, Share},
    rule::{Condition, Proposition},
};

use crate::{
    estimator::Estimator,
    sample::Estimate,
    source::Signal,
    verdict::{self, Level, Measure},
};

/// A finding of a flight, with its cause.
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
#[non_exhaustive]
pub struct Finding {
    /// When, what and how grave. Its motor is known only where a motor is the cause.
    #[cfg_attr(feature = "serde", serde(flatten))]
    pub found: verdict::Finding,
    /// What raised the risk; `None` where no rule did, as for a notice or an interpolated risk.
    pub cause: Option<Cause>,
}

impl Deref for Finding {
    type Target = verdict::Finding;

    fn deref(&self) -> &verdict::Finding {
        &self.found
    }
}

/// What raised the risk when a level was reached: of the rules that fired, the one with the largest share of the risk above
/// half of its value, `share (centre of its term - risk / 2)`.
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
#[non_exhaustive]
pub struct Cause {
    /// The input of the rule that distinguishes it: of the propositions of its antecedent, that of the fewest rules. In a chain it may
    /// be an output that the rule reads.
    pub input: String,
    /// Its value.
    pub value: f64,
    /// The term, with its hedges.
    pub term: String,
    /// The rule's index in the model; serialised, rules count from 1.
    #[cfg_attr(feature = "serde", serde(serialize_with = "crate::verdict::from_one"))]
    pub rule: usize,
}

impl Cause {
    /// The cause of an estimate at values of the inputs, in the order of the profile.
    pub(super) fn of(estimator: &Estimator, inputs: &[f64], estimate: &Estimate) -> Option<Cause> {
        if estimate.filled_from.is_some() {
            return None;
        }
        let model = estimator.model();
        let explanation = estimator.explain(inputs)?;
        let output = explanation
            .outputs
            .iter()
            .find(|output| output.name == estimator.profile().output)?;
        let value = output.value?;
        let centre = |share: &Share| centre(model, &output.name, &share.term);
        // Against half of the risk: of rules that conclude the same, the one with the largest share counts.
        let raises = |share: &Share| share.share * (centre(share) - value / 2.0);
        let shares = output.rules.iter();
        let highest = shares.max_by(|a, b| raises(a).total_cmp(&raises(b)))?;
        let condition = &model.rules.get(highest.rule)?.rule.condition;
        let proposition = distinguishing(model, condition, &explanation)?;
        let input = &proposition.variable.text;
        let (value, _) = read(&explanation, input)?;
        Some(Cause {
            input: input.clone(),
            value,
            term: term(proposition),
            rule: highest.rule,
        })
    }

    /// Whether its input tells how near motors are to a limit.
    pub(super) fn is_motor(&self, estimator: &Estimator) -> bool {
        let mut inputs = estimator.profile().inputs.iter();
        let input = inputs.find(|input| input.name == self.input);
        input.is_some_and(|input| {
            matches!(
                input.source.signal,
                Signal::MotorMargin | Signal::MotorMarginLowSide | Signal::MotorMarginHighSide
            )
        })
    }
}

/// The centre of the part of a term that is inside the range of its output.
fn centre(model: &Model, output: &str, term: &str) -> f64 {
    const STEPS: u32 = 200;
    let outputs = model.outputs.iter().map(|output| &output.variable);
    let Some(variable) = outputs.into_iter().find(|variable| variable.name == output) else {
        return 0.0;
    };
    let Some(term) = variable.terms.iter().find(|known| known.name == term) else {
        return 0.0;
    };
    let (mut area, mut moment) = (0.0, 0.0);
    for i in 0..=STEPS {
        let x = variable.low + (variable.high - variable.low) * f64::from(i) / f64::from(STEPS);
        let degree = term.membership(x);
        area += degree;
        moment += degree * x;
    }
    if area > 0.0 { moment / area } else { 0.0 }
}

/// Of the propositions of an antecedent that hold, the one that the fewest rules have: a guard such as
/// `at_limit IS none` is in many.
fn distinguishing<'m>(
    model: &'m Model,
    condition: &'m Condition,
    explanation: &Explanation,
) -> Option<&'m Proposition> {
    let holds = |proposition: &&Proposition| {
        let degree = read(explanation, &proposition.variable.text)
            .zip(proposition.term.as_ref())
            .and_then(|((_, terms), term)| terms.iter().find(|degree| degree.term == term.text));
        !proposition.hedges.is_empty() || degree.is_some_and(|degree| degree.degree > 0.0)
    };
    let rules_with = |proposition: &Proposition| {
        let conditions = model.rules.iter().map(|rule| &rule.rule.condition);
        let has = |condition: &&Condition| propositions(condition).contains(&proposition);
        conditions.filter(has).count()
    };
    let propositions = propositions(condition).into_iter();
    propositions.filter(holds).min_by_key(|p| rules_with(p))
}

/// The value of an input, or of an output that rules read, and the degree of each of its terms.
fn read<'e>(explanation: &'e Explanation, name: &str) -> Option<(f64, &'e [Degree])> {
    let inputs = explanation.inputs.iter();
    let inputs = inputs.map(|one| (&one.name, Some(one.given), &*one.terms));
    let outputs = explanation.outputs.iter();
    let outputs = outputs.map(|one| (&one.name, one.value, &*one.terms));
    let (_, value, terms) = inputs.chain(outputs).find(|one| one.0 == name)?;
    Some((value?, terms))
}

fn propositions(condition: &Condition) -> Vec<&Proposition> {
    match condition {
        Condition::Is(proposition) => alloc::vec![proposition],
        Condition::Not(inner) => propositions(inner),
        Condition::And(parts) | Condition::Or(parts) => {
            parts.iter().flat_map(propositions).collect()
        }
    }
}

/// A term with its hedges: `not very low`.
fn term(proposition: &Proposition) -> String {
    let hedges = proposition.hedges.iter().map(|hedge| hedge.word());
    let term = proposition.term.iter().map(|term| term.text.as_str());
    hedges.chain(term).collect::<Vec<&str>>().join(" ")
}

/// The cause of the open finding: that of its worst level.
#[derive(Debug, Clone, Default)]
pub(super) struct Open {
    worst: Option<(Level, Option<Cause>)>,
}

impl Open {
    /// The finding is of a level, which may be worse than before.
    pub(super) fn raise(&mut self, level: Level, cause: impl FnOnce() -> Option<Cause>) {
        if self.worst.as_ref().is_none_or(|(worst, _)| level > *worst) {
            self.worst = Some((level, cause()));
        }
    }

    /// A finding with its cause. A risk names a motor only where the cause is that motors are near a limit.
    pub(super) fn explain(&self, found: verdict::Finding, estimator: &Estimator) -> Finding {
        if !is_of_risk(&found) {
            return Finding { found, cause: None };
        }
        let cause = self.worst.as_ref().and_then(|(_, cause)| cause.clone());
        let is_motor = cause
            .as_ref()
            .is_some_and(|cause| cause.is_motor(estimator));
        let motor = found.motor.filter(|_| is_motor);
        Finding {
            found: verdict::Finding { motor, ..found },
            cause,
        }
    }

    /// No finding of the risk is open.
    pub(super) fn end(&mut self) {
        self.worst = None;
    }
}

/// Whether a finding is one of the risk, and no notice.
pub(super) fn is_of_risk(found: &verdict::Finding) -> bool {
    matches!(found.measure, Measure::Risk | Measure::ElevatedRisk)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{profile::Profile, shipped};
    use alloc::format;

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

    fn cause(rules: &str, inputs: [f64; 2]) -> (Cause, bool) {
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
        let rules = fuzzy::yaml::parse(rules).unwrap().model;
        let estimator = Estimator::new(&profile, &rules).unwrap();
        let estimate = estimator.at(&inputs).unwrap();
        let cause = Cause::of(&estimator, &inputs, &estimate).unwrap();
        let is_motor = cause.is_motor(&estimator);
        (cause, is_motor)
    }

    #[test]
    fn the_cause_is_the_rule_that_raises_the_risk_most_without_its_guard() {
        for (inputs, expected, motor) in [
            ([0.0, 0.6], "shake 0.6 violent, rule 2", false),
            ([0.1, 0.9], "shake 0.9 violent, rule 2", false),
            ([0.9, 0.5], "at_limit 0.9 much, rule 0", true),
            ([0.0, 0.0], "shake 0 calm, rule 1", false),
        ] {
            let (cause, is_motor) = cause(RULES, inputs);
            let Cause {
                input,
                value,
                term,
                rule,
            } = cause;
            assert_eq!(format!("{input} {value} {term}, rule {rule}"), expected);
            assert_eq!(is_motor, motor, "{expected}");
        }
    }

    #[test]
    fn a_term_is_told_with_its_hedges() {
        let rules = fuzzy::yaml::parse(RULES).unwrap().model;
        let condition = &rules.rules[3].rule.condition;
        assert_eq!(term(propositions(condition)[0]), "very violent");
    }

    #[test]
    fn in_a_chain_the_cause_may_be_an_output() {
        let (head, _) = RULES.split_once("rules:").unwrap();
        let strain = "outputs: {strain: {range: [0, 1], partition: {small: 0.3, large: 0.7}}, risk";
        let rules = head.replace("outputs: {risk", strain)
            + "rules:
  - IF at_limit IS much THEN risk IS high
  - IF shake IS violent THEN strain IS large
  - IF shake IS calm THEN strain IS small
  - IF strain IS large AND at_limit IS none THEN risk IS high
";
        let (cause, is_motor) = cause(&rules, [0.0, 1.0]);
        assert_eq!((cause.input.as_str(), cause.rule), ("strain", 3));
        assert!((cause.value - 0.736_666_666).abs() < 1e-6 && !is_motor);
    }

    #[test]
    fn an_interpolated_risk_has_no_cause() {
        let estimator = shipped::flagred_paper();
        let inputs = [0.0, 0.0];
        let estimate = estimator.at(&inputs).unwrap();
        assert!(estimate.filled_from.is_some());
        assert_eq!(Cause::of(&estimator, &inputs, &estimate), None);
    }
}
