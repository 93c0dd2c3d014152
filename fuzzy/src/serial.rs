//! Serialization of models and results. In results, rules are numbered from 1, as in messages.

use alloc::string::ToString;

use serde::{Deserialize, Deserializer, Serialize, Serializer, de::Error, ser::SerializeStruct};

use crate::{
    diagnostic::Findings,
    format,
    model::Model,
    table::{Outcome, State},
    tree::Node,
};

/// Serializes the index of a rule as its number.
pub(crate) fn rule_number<S: Serializer>(index: &usize, serializer: S) -> Result<S::Ok, S::Error> {
    (index + 1).serialize(serializer)
}

/// Serializes indices of rules as their numbers.
#[cfg(feature = "check")]
pub(crate) fn rule_numbers<S: Serializer>(
    indices: &[usize],
    serializer: S,
) -> Result<S::Ok, S::Error> {
    serializer.collect_seq(indices.iter().map(|index| index + 1))
}

/// Serializes as `{value, state, coverage, dominant_rule, clamped}`. `value` is null if there is no value, and
/// `dominant_rule` is null if no rule fired. The outcome of an output with interval type-2 terms also has `low` and
/// `high`.
impl Serialize for Outcome {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let state = match self.state {
            State::Defined(_) | State::Interval { .. } => "defined",
            State::Default(_) => "default",
            State::Previous(_) => "previous",
            State::NoRuleFired => "no_rule_fired",
            State::InputNotFinite => "input_not_finite",
        };
        let is_interval = matches!(self.state, State::Interval { .. });
        let count = if is_interval { 7 } else { 5 };
        let mut fields = serializer.serialize_struct("Outcome", count)?;
        fields.serialize_field("value", &self.value())?;
        if is_interval {
            fields.serialize_field("low", &self.low())?;
            fields.serialize_field("high", &self.high())?;
        }
        fields.serialize_field("state", state)?;
        fields.serialize_field("coverage", &self.coverage)?;
        fields.serialize_field("dominant_rule", &self.dominant_rule.map(|index| index + 1))?;
        fields.serialize_field("clamped", &self.clamped)?;
        fields.end()
    }
}

/// Serializes like a rule set file, except that inputs, outputs, terms and blocks are lists of entries with a `name`:
/// their order is significant, and many formats sort keys. Both forms can be deserialized.
impl Serialize for Model {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        format::write_lists(self).serialize(serializer)
    }
}

impl<'de> Deserialize<'de> for Model {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        let tree = Node::deserialize(deserializer)?;
        let reported = |findings| D::Error::custom(Findings(findings).to_string());
        Ok(format::read(&tree).map_err(reported)?.model)
    }
}
