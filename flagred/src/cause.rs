//! The cause of a level: the rule that raises the risk most, and the input that best explains it.

use crate::channel::{Channel, Input, Motors, Observed};

/// A proposition (`input IS term`) in the antecedent of a rule, as plain data.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[repr(C)]
pub struct Proposition {
    /// The index of the rule, among the rules of all stages if outputs read other outputs.
    pub rule: u32,
    /// The index of the input in the profile; for an output that is read, the number of inputs plus its index.
    pub input: u32,
    /// The index of the proposition's degree among the degrees of all literals, if rules read degrees by index.
    pub literal: u32,
}

/// The cause of the risk when a level was reached: a rule and one of its propositions, as indices. The rule is the
/// one that raises the risk most ([`Table::raised_by`](fuzzy::table::Table::raised_by)) among all rules that fired.
/// Among the true propositions in the antecedent of that rule, the proposition is the one that the fewest rules share.
/// If this proposition is about an output, the search continues with the rule that contributes most to the term of
/// this output, and so on until a proposition is about an input.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Cause {
    /// The index of the rule in the rule set.
    pub rule: usize,
    /// The index of the input in the profile.
    pub input: usize,
    /// The value of that input.
    pub value: f64,
    /// The index of the proposition in [`Plan::propositions`](crate::board::Plan::propositions). Exported profiles contain
    /// the texts for the pilot under the same index.
    pub proposition: usize,
}

/// The propositions of all rules.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Propositions<'a> {
    pub(crate) all: &'a [Proposition],
}

/// The rule that is searched for.
#[derive(Debug, Clone, Copy)]
pub(crate) enum RuleQuery {
    /// The rule that raises an output of this value most.
    Raises(f64),
    /// The rule that contributes most to the truth of this proposition about an output.
    Concludes(usize),
}

impl Propositions<'_> {
    /// Returns the cause of a risk for given values of the inputs, in the order of the profile. `find_rule` finds the
    /// rule for an output. It passes this rule and the degrees of the literals to a function that selects a proposition
    /// of the rule. If the proposition is about an output, the search continues with that output. The rule index in the
    /// cause counts the rules of all stages.
    pub(crate) fn cause(
        &self,
        inputs: &[f64],
        (mut output, risk_pct): (usize, f64),
        outputs: usize,
        mut find_rule: impl FnMut(
            usize,
            RuleQuery,
            &dyn Fn(usize, &[f64]) -> Option<usize>,
        ) -> Option<usize>,
    ) -> Option<Cause> {
        let mut requested = RuleQuery::Raises(risk_pct);
        // A chain has no cycles, so it is at most this long.
        for _ in 0..outputs {
            let proposition = find_rule(output, requested, &|rule, degrees| {
                self.of_rule(rule, degrees)
            })?;
            let antecedent = self.all.get(proposition)?;
            let (rule, input) = (antecedent.rule as usize, antecedent.input as usize);
            if let Some(value) = inputs.get(input) {
                return Some(Cause {
                    rule,
                    input,
                    value: *value,
                    proposition,
                });
            }
            output = input - inputs.len();
            requested = RuleQuery::Concludes(proposition);
        }
        None
    }

    /// Returns the first true proposition of a rule, or its first proposition if none is true. `degrees` are the
    /// degrees of the literals; they are empty if all rules are plain ANDs, because every proposition of a rule that
    /// fires is then true.
    fn of_rule(&self, rule: usize, degrees: &[f64]) -> Option<usize> {
        let holds = |antecedent: &Proposition| {
            let degree = degrees.get(antecedent.literal as usize);
            degree.is_none_or(|degree| *degree > 0.0)
        };
        let of_rule = || {
            let all = self.all.iter().enumerate();
            all.filter(|(_, antecedent)| antecedent.rule as usize == rule)
        };
        let holding = of_rule().find(|(_, antecedent)| holds(antecedent));
        holding.or_else(|| of_rule().next()).map(|(index, _)| index)
    }
}

/// Whether an input measures the distance of a motor to a limit.
pub(crate) fn is_of_limits(
    (channels, inputs): (&[Channel], &[Input]),
    input: usize,
    motor: usize,
) -> bool {
    let channel = inputs
        .get(input)
        .and_then(|input| channels.get(input.channel));
    channel.is_some_and(|channel| {
        let is_meant = match channel.motors {
            Motors::One(one) => one as usize == motor,
            _ => true,
        };
        let of = channel.observed;
        is_meant
            && matches!(
                of,
                Observed::Margin | Observed::LowSide | Observed::HighSide
            )
    })
}

state! { struct Cause { rule, input, value, proposition } }
