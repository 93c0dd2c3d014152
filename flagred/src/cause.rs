//! Why a level was raised: the rule that raises the risk most, and the input that its antecedent is about.

use crate::channel::{Channel, Input, Motors, Observed};

/// A proposition of a rule, as plain data: which input it is about.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[repr(C)]
pub struct Proposition {
    /// The index of the rule.
    pub rule: u32,
    /// The index of the input of the profile.
    pub input: u32,
    /// The index of its degree among those of all literals, where rules read them by index.
    pub literal: u32,
}

/// What raised the risk when a level was reached, in indices: of the rules that fired, the one that raises it most
/// ([`Table::raised_by`](fuzzy::table::Table::raised_by)), and of the propositions of its antecedent that hold the one that
/// the fewest rules have.
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

/// The cause where a rule raises the risk most, at values of the inputs in the order of the profile. `degrees` are those of
/// the literals; empty where all rules are plain ANDs: then each proposition of a rule that fires holds.
pub(crate) fn cause(
    propositions: &[Proposition],
    degrees: &[f64],
    rule: usize,
    inputs: &[f64],
) -> Option<Cause> {
    let holds = |said: &Proposition| {
        let degree = degrees.get(said.literal as usize);
        degree.is_none_or(|degree| *degree > 0.0)
    };
    let of_rule = || {
        let all = propositions.iter().enumerate();
        all.filter(|(_, said)| said.rule as usize == rule)
    };
    let holding = of_rule().find(|(_, said)| holds(said));
    let (proposition, said) = holding.or_else(|| of_rule().next())?;
    let input = said.input as usize;
    Some(Cause {
        rule,
        input,
        value: *inputs.get(input)?,
        proposition,
    })
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
