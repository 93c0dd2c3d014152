//! Why a level was raised: the rule that raises the risk most, and the input that its antecedent is about.

use crate::channel::{Channel, Input, Motors, Observed};

/// A proposition of a rule, as plain data: which input it is about.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[repr(C)]
pub struct Proposition {
    /// The index of the rule, among those of all stages where outputs read others.
    pub rule: u32,
    /// The index of the input of the profile; of an output that is read, the number of inputs and its index.
    pub input: u32,
    /// The index of its degree among those of all literals, where rules read them by index.
    pub literal: u32,
}

/// What raised the risk when a level was reached, in indices: of the rules that fired, the one that raises it most
/// ([`Table::raised_by`](fuzzy::table::Table::raised_by)), and of the propositions of its antecedent that hold the one that
/// the fewest rules have. Where that one is about an output, the rule is the one that most says so.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Cause {
    /// The rule in the rule set.
    pub rule: usize,
    /// The input in the profile.
    pub input: usize,
    /// The value of that input.
    pub value: f64,
    /// The proposition in [`Plan::propositions`](crate::board::Plan::propositions). Exported profiles have it in words.
    pub proposition: usize,
}

/// The propositions of all rules, and what belongs to them.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Propositions<'a> {
    pub(crate) all: &'a [Proposition],
    /// The index in the model of each rule; empty where rules have their places in the model.
    pub(crate) rules: &'a [u32],
}

/// Which rule is asked for.
#[derive(Debug, Clone, Copy)]
pub(crate) enum Asked {
    /// The one that raises an output of this value most.
    Raises(f64),
    /// The one that says most that a proposition about an output holds.
    Concludes(usize),
}

impl Propositions<'_> {
    /// The cause of a risk at values of the inputs, in the order of the profile. `ask` finds the rule of an output, and with it
    /// and the degrees of the literals the proposition that it is to give. Where that is about an output, the cause is that
    /// of this output.
    pub(crate) fn cause(
        &self,
        inputs: &[f64],
        (mut output, risk_pct): (usize, f64),
        outputs: usize,
        mut ask: impl FnMut(usize, Asked, &dyn Fn(usize, &[f64]) -> Option<usize>) -> Option<usize>,
    ) -> Option<Cause> {
        let mut asked = Asked::Raises(risk_pct);
        // A chain has no circles, and is not longer.
        for _ in 0..outputs {
            let proposition = ask(output, asked, &|rule, degrees| self.of_rule(rule, degrees))?;
            let said = self.all.get(proposition)?;
            let (rule, input) = (said.rule as usize, said.input as usize);
            if let Some(value) = inputs.get(input) {
                let rule = self.rules.get(rule).map_or(rule, |rule| *rule as usize);
                return Some(Cause {
                    rule,
                    input,
                    value: *value,
                    proposition,
                });
            }
            output = input - inputs.len();
            asked = Asked::Concludes(proposition);
        }
        None
    }

    /// The first of a rule's propositions that holds. `degrees` are those of the literals; empty where all rules are plain
    /// ANDs: then each proposition of a rule that fires holds.
    fn of_rule(&self, rule: usize, degrees: &[f64]) -> Option<usize> {
        let holds = |said: &Proposition| {
            let degree = degrees.get(said.literal as usize);
            degree.is_none_or(|degree| *degree > 0.0)
        };
        let of_rule = || {
            let all = self.all.iter().enumerate();
            all.filter(|(_, said)| said.rule as usize == rule)
        };
        let holding = of_rule().find(|(_, said)| holds(said));
        holding.or_else(|| of_rule().next()).map(|(index, _)| index)
    }
}

/// Whether an input tells how near a motor is to a limit.
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
