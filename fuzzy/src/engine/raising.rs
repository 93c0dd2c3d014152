//! The rule that raises an output most, and the propositions of its antecedent.

use alloc::{collections::BTreeMap, string::String, vec::Vec};

use super::chain::Chain;
use super::compile::Compiler;
use super::literal::Literal;
use super::{Engine, Scratch, Stage, StageScratch};
use crate::model::{
    MembershipFunction, Term, Variable,
    chain::{self, stages},
};
use crate::rule::Proposition;
use crate::table;

/// A proposition in the antecedent of a rule.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub struct AntecedentProposition {
    /// The index of the rule in evaluation order, which counts the rules of all stages. It equals `rule` if no output
    /// reads another one.
    pub evaluation_index: usize,
    /// The index of the rule among the rules of the model.
    pub rule: usize,
    /// The index of the input. For an output that is read, the number of inputs plus the index of the output.
    pub input: usize,
    /// The term with its hedges: `very hot`.
    pub term: String,
    /// The index of the degree of the proposition in [`Scratch::degrees`].
    pub literal: usize,
    /// The number of rules that contain the same proposition.
    pub rules: usize,
    /// The term, if the proposition is about an output.
    read: Option<Literal>,
}

impl Engine {
    /// Returns the rule that raises an output most, as [`Table::raised_by`](table::Table::raised_by) defines it. The
    /// result is an index in evaluation order, like [`AntecedentProposition::evaluation_index`]. `None` if no rule
    /// fires, a value is not finite, there is no such output, or the model has [type-2
    /// terms](crate::Model::has_type2_terms).
    ///
    /// # Example: the rule that makes the fan fast
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
        self.rule_of(scratch, inputs, output, RuleCriterion::Raises(value))
    }

    /// Returns the rule that contributes most to a proposition about an output, as an index in evaluation order. This
    /// is the firing rule of that output with the largest product of its firing strength and the degree that the
    /// proposition would have if only this rule fired. `None` if the proposition is about an input.
    pub fn concluded_by(
        &self,
        scratch: &mut Scratch,
        inputs: &[f64],
        proposition: &AntecedentProposition,
    ) -> Option<usize> {
        let output = proposition.input.checked_sub(self.inputs.len())?;
        self.rule_of(
            scratch,
            inputs,
            output,
            RuleCriterion::Concludes(proposition.read.as_ref()?),
        )
    }

    fn rule_of(
        &self,
        scratch: &mut Scratch,
        inputs: &[f64],
        output: usize,
        criterion: RuleCriterion<'_>,
    ) -> Option<usize> {
        if inputs.len() != self.inputs.len() || self.model.has_type2_terms() {
            return None;
        }
        let Some(chain) = &self.chain else {
            return rule_of(&self.first, &mut scratch.first, inputs, output, criterion);
        };
        let (number, stage, own, rules) = self.stage_of(chain, scratch, inputs, output)?;
        let Scratch {
            first,
            later,
            values,
            requested,
            ..
        } = scratch;
        *requested = number;
        let own_scratch = match number.checked_sub(1) {
            None => first,
            Some(later_number) => later.get_mut(later_number)?,
        };
        let inputs = values.get(..stage.arrays.inputs.len())?;
        let rule = rule_of(stage, own_scratch, inputs, own, criterion)?;
        Some(rules + rule)
    }

    /// Returns the propositions of all rules, in the order of the rules. Within a rule, propositions that occur in few
    /// rules come first, because a proposition that occurs in many rules does not characterise any of them.
    pub fn propositions(&self) -> Vec<AntecedentProposition> {
        let (first, later) = stages(self.model());
        let mut all = Vec::new();
        let mut evaluated = 0;
        for stage in core::iter::once(&first).chain(&later) {
            let mut of_stage = self.propositions_of(stage, evaluated);
            let mut rules_of: BTreeMap<usize, Vec<usize>> = BTreeMap::new();
            for proposition in &of_stage {
                rules_of
                    .entry(proposition.literal)
                    .or_default()
                    .push(proposition.rule);
            }
            for proposition in &mut of_stage {
                if let Some(rules) = rules_of.get_mut(&proposition.literal) {
                    rules.dedup();
                    proposition.rules = rules.len();
                }
            }
            of_stage.sort_by_key(|proposition| (proposition.rule, proposition.rules));
            all.append(&mut of_stage);
            evaluated += stage.rules.len();
        }
        all
    }

    /// Returns the propositions of the rules of a stage; `first_index` is the evaluation index of its first rule.
    fn propositions_of(
        &self,
        stage: &chain::Stage<'_>,
        first_index: usize,
    ) -> Vec<AntecedentProposition> {
        let model = &*stage.model;
        let compiler = Compiler::new(model);
        let inputs = self.inputs.len();
        let mut all = Vec::new();
        let rules = model.rules.iter().zip(&stage.rules);
        for (evaluation_index, (found, rule)) in (first_index..).zip(rules) {
            found.rule.condition.visit(&mut |proposition| {
                let Some((input, ..)) = compiler.key(proposition) else {
                    return;
                };
                let read = input.checked_sub(inputs);
                let read = read.and_then(|read| stage.reads.get(read));
                let proposition = AntecedentProposition {
                    evaluation_index,
                    rule: *rule,
                    input: read.map_or(input, |output| inputs + output),
                    read: read.and_then(|_| literal(model.inputs.get(input)?, proposition)),
                    term: term(proposition),
                    literal: compiler.literal(proposition) as usize,
                    rules: 0,
                };
                if all.last() != Some(&proposition) {
                    all.push(proposition);
                }
            });
        }
        all
    }
}

/// The criterion by which a rule is selected.
#[derive(Clone, Copy)]
enum RuleCriterion<'a> {
    Raises(f64),
    Concludes(&'a Literal),
}

fn rule_of(
    stage: &Stage,
    scratch: &mut StageScratch,
    inputs: &[f64],
    output: usize,
    criterion: RuleCriterion<'_>,
) -> Option<usize> {
    let StageScratch {
        table: buffers,
        workspace,
        ..
    } = scratch;
    let arrays = &stage.arrays;
    let integrate = |index: usize, strengths: &[f64]| stage.integrate(index, strengths, workspace);
    match criterion {
        RuleCriterion::Raises(value) => {
            table::raised_by(arrays, buffers, inputs, (output, value), integrate)
        }
        RuleCriterion::Concludes(literal) => {
            let degree = |x: f64| {
                let hedges = literal.hedges.iter();
                hedges.fold(literal.term.membership(x), |degree, hedge| hedge.of(degree))
            };
            table::concluded_by(arrays, buffers, inputs, (output, degree), integrate)
        }
    }
}

/// Returns the term of a proposition about a variable, with its hedges. For `any` without a term, returns a rectangle
/// over the whole range.
fn literal(variable: &Variable, proposition: &Proposition) -> Option<Literal> {
    let term = match &proposition.term {
        Some(name) => {
            let mut terms = variable.terms.iter();
            terms.find(|term| term.name == name.text)?.clone()
        }
        None => Term {
            name: String::new(),
            membership_function: MembershipFunction::Rectangle {
                left: variable.low,
                right: variable.high,
            },
            height: 1.0,
            lower: None,
        },
    };
    Some(Literal {
        term,
        hedges: proposition.hedges.iter().rev().copied().collect(),
    })
}

impl Chain {
    /// Appends a curve for the term of each proposition about an output, after the curves of all stages.
    pub(super) fn conclusions(&mut self, propositions: &[AntecedentProposition]) {
        for literal in propositions
            .iter()
            .filter_map(|proposition| proposition.read.as_ref())
        {
            self.flat.curve(0, &literal.term, &literal.hedges);
        }
    }
}

impl Scratch {
    /// Returns the degrees of the literals in the latest evaluation. The slice is empty if all rules are plain ANDs
    /// that a table looks up; in that case every proposition of a firing rule has a degree above 0.
    pub fn degrees(&self) -> &[f64] {
        let stage = match self.requested.checked_sub(1) {
            None => Some(&self.first),
            Some(later) => self.later.get(later),
        };
        stage.map_or(&[], |stage| stage.table.degrees.as_flattened())
    }
}

/// Formats the term of a proposition with its hedges: `not very low`.
fn term(proposition: &Proposition) -> String {
    let hedges = proposition.hedges.iter().map(|hedge| hedge.word());
    let term = proposition.term.iter().map(|term| term.text.as_str());
    hedges.chain(term).collect::<Vec<&str>>().join(" ")
}
