//! Validation of activation methods, the least strength, and rule blocks.

use alloc::{collections::BTreeMap, format, string::String};
use core::ops::Range;

use super::{Validator, or};
use crate::{
    diagnostic::duplicate,
    model::{Activation, Implication, MIN_STRENGTH, Model, concludes, document::Spans},
    tree::percentage_advice,
};

impl Validator<'_> {
    pub(super) fn blocks(&mut self, spans: &Spans) {
        let Model {
            blocks,
            rules,
            least_strength,
            activation,
            ..
        } = self.model;
        if !(MIN_STRENGTH..=1.0).contains(least_strength) {
            let message = format!(
                "`least_strength` is {least_strength}, which is outside [{MIN_STRENGTH:e}, 1]"
            );
            let help = match *least_strength {
                percent if percent > 1.0 && percent <= 100.0 => format!(
                    "a firing strength is between 0 and 1: for {percent} %, write `{}`",
                    percent / 100.0
                ),
                small if small < MIN_STRENGTH => format!(
                    "remove `least_strength`: the default {MIN_STRENGTH:e} excludes only firing strengths that are rounding errors"
                ),
                _ => format!("write a number from {MIN_STRENGTH:e} to 1"),
            };
            self.error("value-outside-range", &spans.least_strength, message, &help);
        }
        self.activation("the rule set", *activation, &spans.activation);
        let mut seen: BTreeMap<&str, Range<usize>> = BTreeMap::new();
        for (i, block) in blocks.iter().enumerate() {
            let here = spans.blocks.get(i).cloned().unwrap_or_default();
            if block.name.is_empty() {
                let message = String::from("a block has no name");
                let help = "write a name before the colon";
                self.error("empty-name", &here.name, message, help);
            }
            if let Some(first) = seen.insert(&block.name, here.name.clone()) {
                let finding = duplicate(
                    "block",
                    &block.name,
                    "the rule set",
                    here.name.clone(),
                    first,
                );
                self.findings.push(finding);
            }
            let place = or(&here.activation, &here.name).clone();
            self.activation(&format!("block `{}`", block.name), block.activation, &place);
        }
        let last = blocks.len().max(1);
        let mut latest = 0;
        for (i, rule) in rules.iter().enumerate() {
            let message = if rule.block >= last {
                format!(
                    "rule {} is in block {}, which does not exist",
                    i + 1,
                    rule.block + 1
                )
            } else if rule.block < latest {
                format!(
                    "rule {} belongs to an earlier block than the rule before it",
                    i + 1
                )
            } else {
                latest = rule.block;
                continue;
            };
            let help = "order the rules of a model by their blocks";
            let here = spans.rules.get(i).map_or(0..0, |rule| rule.whole.clone());
            self.error("wrong-block", &here, message, help);
        }
        self.one_implication(spans);
    }

    fn activation(&mut self, what: &str, activation: Activation, here: &Range<usize>) {
        let (rules, strength) = match activation {
            Activation::General | Activation::Proportional => return,
            Activation::First { rules, at_least } | Activation::Last { rules, at_least } => {
                (rules, at_least)
            }
            Activation::Highest { rules } | Activation::Lowest { rules } => (rules, 0.0),
            Activation::Threshold { strength, .. } => (1, strength),
        };
        if rules == 0 {
            let message = format!("the activation of {what} selects 0 rules");
            let help = "write 1 or more, or `enabled: false` in a block";
            self.error("wrong-parameter", here, message, help);
        }
        if !(0.0..=1.0).contains(&strength) {
            let message =
                format!("the threshold {strength} in the activation of {what} is outside [0, 1]");
            let help = percentage_advice(strength);
            let help = help.as_deref().unwrap_or("write a number from 0 to 1");
            self.error("value-outside-range", here, message, help);
        }
    }

    /// Requires that all blocks whose rules conclude the same fuzzy output have the same implication.
    fn one_implication(&mut self, spans: &Spans) {
        let model = self.model;
        for output in &model.outputs {
            if output.defuzzifier.is_weighted() {
                continue;
            }
            let mut first: Option<(&str, Implication)> = None;
            for (i, rule) in model.rules.iter().enumerate() {
                let Some(block) = model.blocks.get(rule.block) else {
                    continue;
                };
                if !block.enabled || !concludes(rule, output) {
                    continue;
                }
                let (name, implication) = *first.get_or_insert((&block.name, block.implication));
                if implication == block.implication {
                    continue;
                }
                let message = format!(
                    "blocks `{name}` and `{}` have the same output `{}`, but different implications",
                    block.name, output.variable.name
                );
                let help =
                    "give both blocks the same implication, or give each block its own output";
                let here = spans.rules.get(i).map_or(0..0, |rule| rule.whole.clone());
                self.error("different-implications", &here, message, help);
                break;
            }
        }
    }
}
