//! Building models in code instead of YAML.

use alloc::{boxed::Box, string::String, vec::Vec};

use super::{
    Activation, Aggregation, Block, Defuzzifier, MIN_STRENGTH, MembershipFunction, Model,
    NoRuleFires, Operators, Output, Rule, Sampling, Term, TypeReduction, Variable, between_peaks,
    even_peaks,
};
use crate::rule::{self, Condition, Consequent, Proposition};

impl Model {
    /// Starts a model that is built in code.
    ///
    /// # Example: a tip that depends only on the service
    /// ```
    /// use fuzzy::model::{Model, Output, MembershipFunction, Variable};
    /// use fuzzy::rule::{Condition, Rule};
    /// use fuzzy::Engine;
    ///
    /// let model = Model::builder("tip")
    ///     .input(
    ///         Variable::new("service", 0.0, 10.0)
    ///             .term("poor", MembershipFunction::LeftShoulder { top: 2.0, foot: 8.0 })
    ///             .term("good", MembershipFunction::RightShoulder { foot: 2.0, top: 8.0 }),
    ///     )
    ///     .output(Output::new(
    ///         Variable::new("tip", 0.0, 20.0)
    ///             .unit("%")
    ///             .term("small", MembershipFunction::Triangle { left: 0.0, peak: 5.0, right: 10.0 })
    ///             .term("large", MembershipFunction::Triangle { left: 10.0, peak: 15.0, right: 20.0 }),
    ///     ))
    ///     .rule(Rule::new(Condition::is("service", "poor"), "tip", "small"))
    ///     .rule(Rule::new(Condition::is("service", "good"), "tip", "large"))
    ///     .build();
    ///
    /// let engine = Engine::new(&model)?;
    /// let outcome = engine.evaluate(&[9.0])?;
    /// assert_eq!(outcome[0].value(), Some(15.0));
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn builder(name: impl Into<String>) -> ModelBuilder {
        ModelBuilder {
            model: Model {
                name: name.into(),
                description: None,
                inputs: Vec::new(),
                outputs: Vec::new(),
                operators: Operators::default(),
                activation: Activation::General,
                least_strength: MIN_STRENGTH,
                blocks: Vec::new(),
                rules: Vec::new(),
                allow: Vec::new(),
                provenance: Vec::new(),
            },
        }
    }
}

/// A builder for a [`Model`], created by [`Model::builder`].
#[derive(Debug, Clone)]
pub struct ModelBuilder {
    model: Model,
}

impl ModelBuilder {
    /// Sets the description, which states the purpose of the rule set.
    #[must_use]
    pub fn description(mut self, text: impl Into<String>) -> Self {
        self.model.description = Some(text.into());
        self
    }

    /// Adds an input.
    #[must_use]
    pub fn input(mut self, variable: Variable) -> Self {
        self.model.inputs.push(variable);
        self
    }

    /// Adds an output.
    #[must_use]
    pub fn output(mut self, output: Output) -> Self {
        self.model.outputs.push(output);
        self
    }

    /// Sets the operators. Without this call they are Mamdani's.
    #[must_use]
    pub fn operators(mut self, operators: Operators) -> Self {
        self.model.operators = operators;
        self
    }

    /// Sets the activation method, which selects the rules that fire. Without this call all rules fire. Blocks have
    /// their own methods.
    #[must_use]
    pub fn activation(mut self, activation: Activation) -> Self {
        self.model.activation = activation;
        self
    }

    /// Sets the least firing strength: rules below it do not fire.
    #[must_use]
    pub fn least_strength(mut self, least: f64) -> Self {
        self.model.least_strength = least;
        self
    }

    /// Adds a rule block. Rules added after this call belong to it.
    #[must_use]
    pub fn block(mut self, block: Block) -> Self {
        self.model.blocks.push(block);
        self
    }

    /// Adds a rule to the latest block, or to the model if it has no blocks.
    #[must_use]
    pub fn rule(mut self, rule: rule::Rule) -> Self {
        let block = self.model.blocks.len().saturating_sub(1);
        let rule = Rule::from(rule);
        self.model.rules.push(Rule { block, ..rule });
        self
    }

    /// Returns the model. It is validated later, when an engine is compiled from it.
    pub fn build(self) -> Model {
        self.model
    }
}

impl From<rule::Rule> for Rule {
    fn from(rule: rule::Rule) -> Self {
        Rule {
            rule,
            block: 0,
            confidence: None,
            support: None,
            against: Vec::new(),
            note: None,
        }
    }
}

impl Variable {
    /// Creates a variable over `[low, high]` without terms.
    pub fn new(name: impl Into<String>, low: f64, high: f64) -> Self {
        Variable {
            name: name.into(),
            description: None,
            unit: None,
            low,
            high,
            terms: Vec::new(),
        }
    }

    /// Sets the unit of the values.
    #[must_use]
    pub fn unit(mut self, unit: impl Into<String>) -> Self {
        self.unit = Some(unit.into());
        self
    }

    /// Adds terms evenly spaced over the range: triangles, with shoulders at the ends. Their degrees sum to 1.
    ///
    /// # Example
    /// ```
    /// use fuzzy::model::Variable;
    ///
    /// let heat = Variable::new("heat", 0.0, 100.0).partition(["low", "medium", "high"]);
    /// let at_25: Vec<f64> = heat.terms.iter().map(|term| term.membership(25.0)).collect();
    /// assert_eq!(at_25, [0.5, 0.5, 0.0]);
    /// ```
    #[must_use]
    pub fn partition<'a>(self, names: impl IntoIterator<Item = &'a str>) -> Self {
        let names: Vec<&str> = names.into_iter().collect();
        let peaks: Vec<f64> = even_peaks(self.low, self.high, names.len()).collect();
        self.partition_at(names.into_iter().zip(peaks))
    }

    /// Adds terms with these peaks, from left to right: triangles, with shoulders at the ends. Their degrees sum to 1.
    ///
    /// # Example
    /// ```
    /// use fuzzy::model::Variable;
    ///
    /// let heat = Variable::new("heat", 0.0, 100.0).partition_at([("low", 10.0), ("high", 30.0)]);
    /// assert_eq!(heat.terms[1].membership(15.0), 0.25);
    /// ```
    #[must_use]
    pub fn partition_at<'a>(mut self, peaks: impl IntoIterator<Item = (&'a str, f64)>) -> Self {
        let peaks: Vec<(&str, f64)> = peaks.into_iter().collect();
        self.terms.extend(between_peaks(&peaks));
        self
    }

    /// Adds a term of height 1.
    #[must_use]
    pub fn term(
        mut self,
        name: impl Into<String>,
        membership_function: MembershipFunction,
    ) -> Self {
        self.terms.push(Term {
            name: name.into(),
            membership_function,
            height: 1.0,
            lower: None,
        });
        self
    }
}

impl Term {
    /// Returns the degree of membership of `x`, in [0, 1]: the height of the term times the degree of its membership
    /// function.
    pub fn membership(&self, x: f64) -> f64 {
        self.height * self.membership_function.membership(x)
    }
}

impl Output {
    /// Returns whether the aggregated set consists of single points: all terms are singletons, and the defuzzifier
    /// takes fuzzy sets.
    pub(crate) fn is_discrete(&self) -> bool {
        let mut terms = self.variable.terms.iter();
        !self.defuzzifier.is_weighted() && terms.all(|term| term.membership_function.at().is_some())
    }

    /// Creates an output with the exact centroid as defuzzifier, undefined where no rule fires.
    pub fn new(variable: Variable) -> Self {
        Output {
            variable,
            defuzzifier: Defuzzifier::Centroid,
            samples: None,
            when_no_rule_fires: NoRuleFires::Undefined,
            aggregation: None,
            clamp: false,
            type_reduction: TypeReduction::Exact,
        }
    }

    /// Sets the aggregation, which combines the consequents of this output.
    #[must_use]
    pub fn aggregation(mut self, aggregation: Aggregation) -> Self {
        self.aggregation = Some(aggregation);
        self
    }

    /// Clamps values of this output to its range.
    #[must_use]
    pub fn clamp(mut self) -> Self {
        self.clamp = true;
        self
    }

    /// Sets the type reduction, for interval type-2 terms.
    #[must_use]
    pub fn type_reduction(mut self, type_reduction: TypeReduction) -> Self {
        self.type_reduction = type_reduction;
        self
    }

    /// Sets the defuzzifier.
    #[must_use]
    pub fn defuzzifier(mut self, defuzzifier: Defuzzifier) -> Self {
        self.defuzzifier = defuzzifier;
        self
    }

    /// Integrates by sampling, to reproduce the results of another program.
    #[must_use]
    pub fn samples(mut self, sampling: Sampling) -> Self {
        self.samples = Some(sampling);
        self
    }

    /// Sets the value of this output where no rule fires.
    #[must_use]
    pub fn when_no_rule_fires(mut self, what: NoRuleFires) -> Self {
        self.when_no_rule_fires = what;
        self
    }
}

impl rule::Rule {
    /// Creates `IF condition THEN output IS term` with weight 1.
    ///
    /// # Example
    /// ```
    /// use fuzzy::rule::{Condition, Rule};
    ///
    /// let rule = Rule::new(Condition::is("heat", "high"), "speed", "fast").then("lamp", "on").with(0.5);
    /// assert_eq!(rule.to_string(), "IF heat IS high THEN speed IS fast AND lamp IS on WITH 0.5");
    /// ```
    pub fn new(condition: Condition, output: &str, term: &str) -> Self {
        rule::Rule {
            condition,
            consequents: Vec::from([Consequent::is_hedged(output, &[], term)]),
            weight: 1.0,
        }
    }

    /// Appends `AND output IS term` to the conclusion.
    #[must_use]
    pub fn then(self, output: &str, term: &str) -> Self {
        self.then_hedged(output, &[], term)
    }

    /// Appends `AND output IS hedge* term` to the conclusion.
    #[must_use]
    pub fn then_hedged(mut self, output: &str, hedges: &[rule::Hedge], term: &str) -> Self {
        self.consequents
            .push(Consequent::is_hedged(output, hedges, term));
        self
    }

    /// Sets the weight, as `WITH weight` does.
    #[must_use]
    pub fn with(mut self, weight: f64) -> Self {
        self.weight = weight;
        self
    }
}

impl Consequent {
    /// Creates `output IS hedge* term`.
    pub fn is_hedged(output: &str, hedges: &[rule::Hedge], term: &str) -> Self {
        Consequent {
            output: output.into(),
            hedges: hedges.to_vec(),
            term: term.into(),
        }
    }
}

impl Condition {
    /// Creates `variable IS term`.
    pub fn is(variable: &str, term: &str) -> Self {
        Condition::is_hedged(variable, &[], term)
    }

    /// Creates `variable IS hedge* term`.
    pub fn is_hedged(variable: &str, hedges: &[rule::Hedge], term: &str) -> Self {
        Condition::Is(Proposition {
            variable: variable.into(),
            hedges: hedges.to_vec(),
            term: Some(term.into()),
        })
    }

    /// Returns `self AND other`.
    #[must_use]
    pub fn and(self, other: Condition) -> Self {
        match self {
            Condition::And(mut all) => {
                all.push(other);
                Condition::And(all)
            }
            first => Condition::And(Vec::from([first, other])),
        }
    }

    /// Returns `self OR other`.
    #[must_use]
    pub fn or(self, other: Condition) -> Self {
        match self {
            Condition::Or(mut any) => {
                any.push(other);
                Condition::Or(any)
            }
            first => Condition::Or(Vec::from([first, other])),
        }
    }

    /// Returns `NOT self`.
    #[must_use]
    pub fn negated(self) -> Self {
        Condition::Not(Box::new(self))
    }
}
