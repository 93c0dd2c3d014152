//! Which rule raises an output most, and what its antecedent says.

use alloc::{collections::BTreeMap, string::String, vec::Vec};

use super::compile::Compiler;
use super::{Engine, Scratch, StageScratch};
use crate::rule::Proposition;
use crate::table;

/// A proposition of a rule's antecedent.
#[derive(Debug, Clone, PartialEq, Eq)]
#[non_exhaustive]
pub struct Said {
    /// The index of the rule.
    pub rule: usize,
    /// The index of the input.
    pub input: usize,
    /// The term with its hedges: `very hot`.
    pub term: String,
    /// The index of its degree in [`Scratch::degrees`].
    pub literal: usize,
    /// The number of rules that have the same proposition.
    pub rules: usize,
}

impl Engine {
    /// The index of the rule that raises an output most: [`Table::raised_by`](table::Table::raised_by). `None` where no rule
    /// fires, a value is not finite, the output is unknown, or outputs read others.
    ///
    /// # Example: why is the fan fast?
    /// ```
    /// use fuzzy::{Engine, Model};
    ///
    /// let model: Model = "
    /// fuzzy: 1
    /// name: fan
    /// inputs:
    ///   heat: {range: [0, 40], partition: [low, high]}
    ///   damp: {range: [0, 100], partition: [dry, wet]}
    /// outputs: {speed: {range: [0, 9], partition: [slow, fast]}}
    /// rules:
    ///   - IF heat IS low THEN speed IS slow
    ///   - IF heat IS high THEN speed IS fast
    ///   - IF damp IS wet THEN speed IS fast
    /// ".parse()?;
    /// let engine = Engine::new(&model)?;
    /// let speed = engine.evaluate(&[10.0, 80.0])?[0].value().ok_or("no value")?;
    /// let rule = engine.raised_by(&mut engine.scratch(), &[10.0, 80.0], 0, speed);
    /// assert_eq!(rule, Some(2));
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn raised_by(
        &self,
        scratch: &mut Scratch,
        inputs: &[f64],
        output: usize,
        value: f64,
    ) -> Option<usize> {
        if inputs.len() != self.inputs.len() || self.chain.is_some() {
            return None;
        }
        let StageScratch {
            table: buffers,
            workspace,
        } = &mut scratch.first;
        let stage = &self.first;
        table::raised_by(
            &stage.arrays,
            buffers,
            inputs,
            (output, value),
            |index, strengths| stage.integrate(index, strengths, workspace),
        )
    }

    /// The propositions of all rules, in the order of the rules; within a rule, those of the fewest rules first. A
    /// proposition that many rules have says little about one of them.
    pub fn propositions(&self) -> Vec<Said> {
        let model = self.model();
        let compiler = Compiler::new(model);
        let mut all = Vec::new();
        for (rule, found) in model.rules.iter().enumerate() {
            found.rule.condition.visit(&mut |proposition| {
                if let Some((input, ..)) = compiler.key(proposition) {
                    let said = Said {
                        rule,
                        input,
                        term: term(proposition),
                        literal: compiler.literal(proposition) as usize,
                        rules: 0,
                    };
                    if all.last() != Some(&said) {
                        all.push(said);
                    }
                }
            });
        }
        let mut rules_of: BTreeMap<usize, Vec<usize>> = BTreeMap::new();
        for said in &all {
            rules_of.entry(said.literal).or_default().push(said.rule);
        }
        for said in &mut all {
            if let Some(rules) = rules_of.get_mut(&said.literal) {
                rules.dedup();
                said.rules = rules.len();
            }
        }
        all.sort_by_key(|said| (said.rule, said.rules));
        all
    }
}

impl Scratch {
    /// The degrees of the literals at the latest evaluation; empty where all rules are plain ANDs that a table finds. Then
    /// every proposition of a rule that fires holds.
    pub fn degrees(&self) -> &[f64] {
        &self.first.table.degrees
    }
}

/// A term with its hedges: `not very low`.
fn term(proposition: &Proposition) -> String {
    let hedges = proposition.hedges.iter().map(|hedge| hedge.word());
    let term = proposition.term.iter().map(|term| term.text.as_str());
    hedges.chain(term).collect::<Vec<&str>>().join(" ")
}
