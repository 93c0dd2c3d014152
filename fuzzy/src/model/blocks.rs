//! Rule blocks: rules with their own operators and activation method.

use alloc::string::String;

use super::{Model, Operators, Output, Rule};
use crate::table::{Activation, Conjunction, Disjunction, Implication};

/// A rule block: rules that share operators and an activation method.
///
/// # Example: two blocks; in the second one only the first rule that fires counts
/// ```
/// use fuzzy::{Engine, Model};
///
/// let model: Model = "
/// fuzzy: 1
/// name: fan
/// inputs: {heat: {range: [0, 40], partition: [low, high]}}
/// outputs:
///   speed: {range: [0, 9], partition: [slow, fast]}
///   lamp: {range: [0, 1], partition: [off, on]}
/// blocks:
///   cooling:
///     rules: [IF heat IS low THEN speed IS slow, IF heat IS high THEN speed IS fast]
///   warning:
///     activation: {first: 1}
///     rules: [IF heat IS high THEN lamp IS on, IF heat IS any THEN lamp IS off]
/// ".parse()?;
/// let engine = Engine::new(&model)?;
/// let lamp = engine.evaluate(&[30.0])?[1];
/// assert_eq!(lamp.dominant_rule, Some(2)); // `lamp IS on`; the rule after it does not fire
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct Block {
    /// The name of the block.
    pub name: String,
    /// The purpose of the block, as free text.
    pub description: Option<String>,
    /// Whether the rules of the block are evaluated.
    pub enabled: bool,
    /// The conjunction for AND.
    pub and: Conjunction,
    /// The disjunction for OR.
    pub or: Disjunction,
    /// The implication, which cuts or scales a consequent by the firing strength.
    pub implication: Implication,
    /// The activation method, which selects the rules of the block that fire.
    pub activation: Activation,
}

impl Block {
    /// Creates an enabled block without rules, with Mamdani's operators.
    pub fn new(name: impl Into<String>) -> Self {
        Block {
            name: name.into(),
            description: None,
            enabled: true,
            and: Conjunction::default(),
            or: Disjunction::default(),
            implication: Implication::default(),
            activation: Activation::default(),
        }
    }
}

impl Model {
    /// Returns whether a rule is evaluated: its block is enabled, or it has no block.
    pub fn is_enabled(&self, rule: &Rule) -> bool {
        self.block_of(rule).is_none_or(|block| block.enabled)
    }

    /// Returns the operators of a rule: those of its block, and the aggregation of the rule set.
    pub fn operators_of(&self, rule: &Rule) -> Operators {
        match self.block_of(rule) {
            None => self.operators,
            Some(block) => Operators {
                and: block.and,
                or: block.or,
                implication: block.implication,
                aggregation: self.operators.aggregation,
            },
        }
    }

    /// Returns the operators of an output: the implication of the rules that conclude it, and its aggregation.
    pub fn operators_of_output(&self, output: &Output) -> Operators {
        let mut rules = self.rules.iter();
        let concludes = |rule: &&Rule| self.is_enabled(rule) && concludes(rule, output);
        let operators = rules.find(concludes).map(|rule| self.operators_of(rule));
        let operators = operators.unwrap_or(self.operators);
        Operators {
            aggregation: output.aggregation.unwrap_or(operators.aggregation),
            ..operators
        }
    }

    /// Returns the activation method of a rule.
    pub fn activation_of(&self, rule: &Rule) -> Activation {
        let block = self.block_of(rule);
        block.map_or(self.activation, |block| block.activation)
    }

    fn block_of(&self, rule: &Rule) -> Option<&Block> {
        self.blocks.get(rule.block)
    }
}

/// Returns whether a rule has a consequent about an output.
pub(crate) fn concludes(rule: &Rule, output: &Output) -> bool {
    let mut consequents = rule.rule.consequents.iter();
    consequents.any(|consequent| consequent.output.text == output.variable.name)
}
