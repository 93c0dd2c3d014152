//! The reasons why rules do not fire.

use alloc::{
    string::{String, ToString},
    vec::Vec,
};
use core::fmt;

use super::{
    Engine, EvaluateError, Explanation,
    explain::{ConditionContext, degree_of},
};
use crate::{
    model::{Operators, Rule, concludes, type2::Bound},
    rule::Condition,
};

/// A rule that does not fire at a point, with the reason.
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[non_exhaustive]
pub struct SilentRule {
    /// The index of the rule in the model; serialised as the rule number, which counts from 1.
    #[cfg_attr(
        feature = "serde",
        serde(serialize_with = "crate::serial::rule_number")
    )]
    #[cfg_attr(feature = "schema", schemars(range(min = 1)))]
    pub rule: usize,
    /// The text of the rule.
    pub text: String,
    /// The reason why the rule does not fire.
    #[cfg_attr(feature = "serde", serde(flatten))]
    pub silence: Silence,
}

/// The reason why a rule does not fire.
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[cfg_attr(feature = "serde", serde(tag = "reason", rename_all = "snake_case"))]
#[non_exhaustive]
pub enum Silence {
    /// A part of the condition has degree 0; this is the first such part.
    Condition {
        /// The text of the part.
        condition: String,
    },
    /// An output that the rule reads has no value.
    NoValue {
        /// The name of that output.
        output: String,
    },
    /// The block of the rule is not enabled.
    Disabled,
    /// The weight of the rule is 0.
    Weight,
    /// The activation method excludes the rule, or its strength is below the least strength.
    Activation {
        /// The degree of the condition times the weight.
        strength: f64,
    },
}

impl fmt::Display for Silence {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Silence::Condition { condition } => write!(f, "the degree of `{condition}` is 0"),
            Silence::NoValue { output } => write!(f, "`{output}`, which it reads, has no value"),
            Silence::Disabled => f.write_str("its block is not enabled"),
            Silence::Weight => f.write_str("its weight is 0"),
            Silence::Activation { strength } => {
                let strength = libm::round(strength * 1e5) / 1e5;
                write!(
                    f,
                    "its firing strength {strength} is below `least_strength`, or the activation method does not select the rule"
                )
            }
        }
    }
}

impl Engine {
    /// Returns the rules that do not fire at the point of an explanation, each with the reason.
    ///
    /// # Errors
    /// The explanation belongs to a different model.
    ///
    /// # Example: a condition of degree 0
    /// ```
    /// use fuzzy::{Engine, Model};
    ///
    /// let model: Model = "
    /// fuzzy: 1
    /// name: fan
    /// inputs: {heat: {range: [0, 40], partition: [low, high]}, damp: {range: [0, 1], partition: [dry, wet]}}
    /// outputs: {speed: {range: [0, 9], partition: [slow, fast]}}
    /// rules: [IF heat IS low THEN speed IS slow, IF damp IS wet AND heat IS high THEN speed IS fast]
    /// ".parse()?;
    /// let engine = Engine::new(&model)?;
    /// let silent = engine.silent(&engine.explain(&[0.0, 0.5])?)?;
    /// assert_eq!(silent[0].rule, 1);
    /// assert_eq!(silent[0].silence.to_string(), "the degree of `heat IS high` is 0");
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn silent(&self, explanation: &Explanation) -> Result<Vec<SilentRule>, EvaluateError> {
        let model = self.model();
        let inputs: Vec<f64> = explanation.inputs.iter().map(|input| input.given).collect();
        let outcomes = self.outcomes_at(&inputs)?;
        let context = ConditionContext {
            model,
            inputs: &explanation.inputs,
            outcomes: &outcomes,
        };
        let fires = |index: usize| explanation.rules.iter().any(|rule| rule.rule == index);
        let rules = model.rules.iter().enumerate();
        let silent = rules.filter(|(index, _)| !fires(*index));
        let silent = silent.map(|(index, rule)| SilentRule {
            rule: index,
            text: rule.rule.to_string(),
            silence: silence(rule, &context),
        });
        Ok(silent.collect())
    }
}

fn silence(rule: &Rule, context: &ConditionContext<'_>) -> Silence {
    let model = context.model;
    if !model.is_enabled(rule) {
        return Silence::Disabled;
    }
    if rule.rule.weight == 0.0 {
        return Silence::Weight;
    }
    let concluded = || {
        model
            .outputs
            .iter()
            .filter(|output| concludes(rule, output))
    };
    if !concluded().any(|output| context.is_evaluated(&output.variable.name)) {
        let mut reads = concluded().flat_map(|output| model.reads(&output.variable.name));
        let unknown = reads.find(|name| {
            context
                .variable(name)
                .is_none_or(|(_, value)| value.is_none())
        });
        return Silence::NoValue {
            output: unknown.unwrap_or_default().into(),
        };
    }
    let operators = model.operators_of(rule);
    let degree = degree_of(&rule.rule.condition, operators, context, Bound::Upper);
    let strength = rule.rule.weight * degree;
    if strength > 0.0 {
        return Silence::Activation { strength };
    }
    let condition = zero(&rule.rule.condition, operators, context);
    Silence::Condition {
        condition: condition.to_string(),
    }
}

/// Returns the first part of degree 0 of an AND; the condition itself if it is not an AND or has no such part.
fn zero<'c>(
    condition: &'c Condition,
    operators: Operators,
    context: &ConditionContext<'_>,
) -> &'c Condition {
    let Condition::And(parts) = condition else {
        return condition;
    };
    let mut parts = parts.iter();
    let first = parts.find(|part| degree_of(part, operators, context, Bound::Upper) <= 0.0);
    first.map_or(condition, |part| zero(part, operators, context))
}
