//! Compilation of a validated model: names are resolved to indices.

use alloc::{boxed::Box, collections::BTreeMap, string::String, sync::Arc, vec, vec::Vec};

use super::arrays::OwnedTable;
use super::chain::Chain;
use super::literal::{Literal, Literals};
use super::rules::{FiringOperators, IndexedRule};
use super::strategy::{SingleRowMethod, StrengthCombination, method, prepared_set};
use super::{CompiledOutput, Engine, Input, NamedOutput, Stage};
use crate::defuzzify::Method;
use crate::diagnostic::Findings;
use crate::model::{
    Activation, MembershipFunction, Model, NoRuleFires, Output, Term, Variable,
    chain::stages,
    document::{Document, Spans},
};
use crate::rule::{Condition, Hedge, Proposition};
use crate::table::{Action, AntecedentStep, Op, SetDefuzzifier};
use crate::validate::validate;

impl Engine {
    /// Compiles a model: resolves names to indices, and converts rules to a table and output terms to closed forms.
    ///
    /// # Errors
    /// All errors that [`validate`](crate::validate()) finds in the model.
    ///
    /// # Example: all errors are reported together
    /// ```
    /// use fuzzy::{Engine, Model, model::{Output, Variable}};
    ///
    /// let model = Model::builder("fan")
    ///     .input(Variable::new("heat", 0.0, 100.0).partition(["low", "high"]))
    ///     .output(Output::new(Variable::new("speed", 0.0, 9.0).partition(["slow", "fast"])))
    ///     .rule("IF heat IS hihg THEN speed IS fsat".parse()?)
    ///     .build();
    /// let findings = Engine::new(&model).unwrap_err();
    /// assert_eq!(findings.to_string(), "\
    /// error[unknown-term]: rule 1: input `heat` has no term `hihg`
    ///   help: did you mean `high`?
    /// error[unknown-term]: rule 1: output `speed` has no term `fsat`
    ///   help: did you mean `fast`?");
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn new(model: &Model) -> Result<Self, Findings> {
        let invalid = validate(model, &Spans::default());
        if !invalid.is_empty() {
            return Err(Findings(invalid));
        }
        Ok(Engine::compile(model))
    }

    /// Compiles a model that is known to be valid.
    pub(crate) fn compile(model: &Model) -> Self {
        let (first, later) = stages(model);
        let inputs = model.inputs.iter().map(Input::of);
        let outputs = model.outputs.iter().map(|output| NamedOutput {
            name: Arc::from(output.variable.name.as_str()),
            must_fire: output.when_no_rule_fires == NoRuleFires::Error,
        });
        let of_first = Stage::new(&first.model);
        let is_chain = !later.is_empty();
        let chain = is_chain.then(|| Box::new(Chain::new((&first, &of_first), &later)));
        let mut engine = Engine {
            inputs: inputs.collect(),
            outputs: outputs.collect(),
            first: of_first,
            chain,
            model: Arc::new(model.clone()),
        };
        if is_chain && !model.has_type2_terms() {
            let propositions = engine.propositions();
            if let Some(chain) = &mut engine.chain {
                chain.conclusions(&propositions);
            }
        }
        engine
    }
}

impl Document {
    /// Compiles the model; `text` is the text that it was read from.
    ///
    /// # Errors
    /// Fails like [`validate`](Self::validate).
    pub fn compile(&self, text: &str) -> Result<Engine, Findings> {
        self.validate(text)?;
        Ok(Engine::compile(&self.model))
    }
}

impl Stage {
    /// Compiles a valid model in which no output reads another output. Of type-2 terms, only the upper membership
    /// functions are compiled. `reduced` lists the outputs whose sets are prepared for a type reduction.
    pub(super) fn plain(model: &Model, reduced: &[usize]) -> Self {
        let mut compiler = Compiler::new(model);
        compiler.reduced = reduced;
        let firing = FiringOperators::of(model);
        let drafts = compiler.drafts();
        compiler.stage(drafts, &firing)
    }
}

impl Input {
    fn of(variable: &Variable) -> Self {
        Input {
            name: Arc::from(variable.name.as_str()),
            low: variable.low,
            high: variable.high,
        }
    }
}

/// The key of a literal: input, term, and hedges in the order in which they are applied.
pub(super) type LiteralKey = (usize, Option<usize>, Vec<Hedge>);

/// The compiler of a valid model, in which every name is defined.
pub(super) struct Compiler<'m> {
    pub(super) model: &'m Model,
    /// The index of each input by its name.
    inputs: BTreeMap<&'m str, usize>,
    /// The index of each literal. They are numbered by input, term and hedges, independently of the order of the rules.
    pub(super) literals: BTreeMap<LiteralKey, u32>,
    /// The indices of the outputs whose sets are prepared because a type reduction integrates parts of them.
    reduced: &'m [usize],
}

impl<'m> Compiler<'m> {
    pub(super) fn new(model: &'m Model) -> Self {
        let inputs = model.inputs.iter().zip(0..);
        let mut compiler = Compiler {
            model,
            inputs: inputs.map(|(input, i)| (input.name.as_str(), i)).collect(),
            literals: BTreeMap::new(),
            reduced: &[],
        };
        compiler.literals();
        compiler
    }

    /// Collects and numbers the literals of all rules.
    fn literals(&mut self) {
        let model = self.model;
        for rule in model.rules.iter().filter(|rule| model.is_enabled(rule)) {
            rule.rule.condition.visit(&mut |proposition| {
                let key = self.key(proposition);
                self.literals.extend(key.map(|key| (key, 0)));
            });
        }
        for (id, number) in self.literals.values_mut().zip(0..) {
            *id = number;
        }
    }

    pub(super) fn key(&self, proposition: &Proposition) -> Option<LiteralKey> {
        let inputs = &self.model.inputs;
        let input = *self.inputs.get(proposition.variable.text.as_str())?;
        let term = match &proposition.term {
            Some(name) => Some(position(&inputs.get(input)?.terms, &name.text)?),
            None => None,
        };
        let hedges = proposition.hedges.iter().rev().copied().collect();
        Some((input, term, hedges))
    }

    pub(super) fn literal(&self, proposition: &Proposition) -> u32 {
        let key = self.key(proposition);
        key.and_then(|key| self.literals.get(&key).copied())
            .unwrap_or(0)
    }

    /// Returns the rules as literals, steps and actions, sorted by their content, so that the order of rules in a rule
    /// set does not affect the bits of a result. Rules with an activation method keep their order, because some methods
    /// depend on it.
    pub(super) fn drafts(&self) -> Vec<IndexedRule> {
        let model = self.model;
        let inputs_of: Vec<usize> = self.literals.keys().map(|key| key.0).collect();
        let mut drafts = Vec::new();
        for (index, rule) in model.rules.iter().enumerate() {
            if !model.is_enabled(rule) {
                continue;
            }
            let (block, activation) = (rule.block, model.activation_of(rule));
            let rule = &rule.rule;
            let mut steps = Vec::new();
            self.condition(&rule.condition, &mut steps);
            // Consequents with the same hedges share a draft.
            let mut by_hedges: BTreeMap<Vec<Hedge>, Vec<Action>> = BTreeMap::new();
            for consequent in &rule.consequents {
                let name = &consequent.output.text;
                let outputs = model.outputs.iter();
                let found = outputs.zip(0..).find(|(o, _)| o.variable.name == *name);
                let Some((output, number)) = found else {
                    continue;
                };
                let term = position(&output.variable.terms, &consequent.term.text);
                let hedges: Vec<Hedge> = consequent.hedges.iter().rev().copied().collect();
                let actions = by_hedges.entry(hedges).or_default();
                actions.extend(term.map(|term| Action {
                    weight: rule.weight,
                    strength: term as u32,
                    output: number,
                    rule: index as u32,
                    sums: 0,
                }));
            }
            let kept = (activation != Activation::General).then_some(index);
            // A rule without consequents in this stage may still affect the activation method of its block.
            if by_hedges.is_empty() {
                by_hedges.insert(Vec::new(), Vec::new());
            }
            for (hedges, actions) in by_hedges {
                let draft = IndexedRule {
                    literals: plain(&steps, &inputs_of).filter(|_| hedges.is_empty()),
                    steps: steps.clone(),
                    weight: rule.weight,
                    hedges,
                    actions,
                    rule: index,
                    block,
                };
                drafts.push((kept, draft));
            }
        }
        let content = |draft: &IndexedRule| {
            let actions = draft.actions.iter();
            actions
                .map(|a| (a.output, a.strength, a.weight.to_bits()))
                .collect::<Vec<_>>()
        };
        drafts.sort_by_cached_key(|(kept, draft)| {
            let hedged = (draft.hedges.clone(), draft.weight.to_bits());
            (
                *kept,
                draft.literals.clone(),
                draft.steps.clone(),
                hedged,
                content(draft),
            )
        });
        drafts.into_iter().map(|(_, draft)| draft).collect()
    }

    fn condition(&self, condition: &Condition, steps: &mut Vec<AntecedentStep>) {
        match condition {
            Condition::Is(proposition) => steps.push(AntecedentStep {
                op: Op::PUSH,
                literal: self.literal(proposition),
            }),
            Condition::Not(inner) => {
                self.condition(inner, steps);
                steps.push(AntecedentStep {
                    op: Op::NOT,
                    literal: 0,
                });
            }
            Condition::And(all) => self.joined(all, steps, (Op::AND_LITERAL, Op::AND)),
            Condition::Or(any) => self.joined(any, steps, (Op::OR_LITERAL, Op::OR)),
        }
    }

    fn joined(
        &self,
        conditions: &[Condition],
        steps: &mut Vec<AntecedentStep>,
        (with_literal, with_top): (Op, Op),
    ) {
        for (i, condition) in conditions.iter().enumerate() {
            match condition {
                Condition::Is(proposition) if i > 0 => {
                    steps.push(AntecedentStep {
                        op: with_literal,
                        literal: self.literal(proposition),
                    });
                }
                _ => {
                    self.condition(condition, steps);
                    if i > 0 {
                        steps.push(AntecedentStep {
                            op: with_top,
                            literal: 0,
                        });
                    }
                }
            }
        }
    }

    fn stage(&self, mut drafts: Vec<IndexedRule>, firing: &FiringOperators) -> Stage {
        let model = self.model;
        let mut outputs = Vec::new();
        let mut first_strength = 0;
        for (index, output) in model.outputs.iter().enumerate() {
            let compiled = self.output(index, output, first_strength, &mut drafts);
            first_strength = compiled.strengths.end;
            outputs.push(compiled);
        }
        let mut by_input = vec![Vec::new(); model.inputs.len()];
        for (input, term, hedges) in self.literals.keys() {
            let always = || Term {
                name: String::new(),
                membership_function: MembershipFunction::Constant { value: 1.0 },
                height: 1.0,
                lower: None,
            };
            by_input[*input].push(Literal {
                term: term.map_or_else(always, |t| model.inputs[*input].terms[t].clone()),
                hedges: hedges.clone(),
            });
        }
        let mut first = 0;
        let mut inputs = Vec::new();
        let (mut literals, mut formulas) = (Vec::new(), Vec::new());
        for (variable, of_input) in model.inputs.iter().zip(&by_input) {
            let count = of_input.len() as u32;
            literals.push(Literals::new(
                first,
                of_input.clone(),
                variable.low,
                variable.high,
            ));
            formulas.push(Literals::by_formula(first, of_input.clone()));
            first += count;
            inputs.push(Input::of(variable));
        }
        let arrays = OwnedTable::new(firing, &inputs, &literals, &drafts, &outputs);
        Stage {
            batch: OwnedTable::programs_alone(firing, &inputs, &formulas, &drafts, &outputs),
            single: SingleRowMethod::of(&arrays),
            arrays,
            outputs,
        }
    }

    /// Compiles an output, and assigns firing strengths to the drafts' actions on it.
    pub(super) fn output(
        &self,
        index: usize,
        output: &Output,
        first_strength: usize,
        drafts: &mut [IndexedRule],
    ) -> CompiledOutput {
        let variable = &output.variable;
        let operators = self.model.operators_of_output(output);
        let set = match self.reduced.contains(&index) {
            true => prepared_set(output, operators, SetDefuzzifier::Centroid).map(Method::Prepared),
            false => None,
        };
        let input = |name: &str| self.inputs.get(name).copied();
        let method = set.unwrap_or_else(|| method(output, operators, input));
        let combination = StrengthCombination::of(&method, operators);
        let actions = || drafts.iter().flat_map(|draft| &draft.actions);
        let here = |action: &&Action| action.output as usize == index;
        let mut counts = vec![0; variable.terms.len()];
        for action in actions().filter(here) {
            counts[action.strength as usize] += 1;
        }
        if combination != StrengthCombination::Separate {
            counts.fill(1);
        }
        let mut offsets = vec![0];
        for count in counts {
            offsets.push(offsets.last().copied().unwrap_or(0) + count);
        }
        let last = offsets.last().copied().unwrap_or(0);
        let (mut next, count) = match &method {
            Method::Partition(partition) => (partition.ranks().to_vec(), partition.strengths()),
            Method::Layered(_)
            | Method::Moments(_)
            | Method::Prepared(_)
            | Method::Integrated(_)
            | Method::Sugeno { .. }
            | Method::Tsukamoto(_) => (offsets.clone(), last),
        };
        for action in drafts.iter_mut().flat_map(|draft| &mut draft.actions) {
            if action.output as usize == index {
                let term = action.strength as usize;
                action.strength = (first_strength + next[term]) as u32;
                action.sums = u32::from(combination == StrengthCombination::Sum);
                if combination == StrengthCombination::Separate {
                    next[term] += 1;
                }
            }
        }
        CompiledOutput {
            low: variable.low,
            high: variable.high,
            when_no_rule_fires: output.when_no_rule_fires,
            strengths: first_strength..first_strength + count,
            offsets,
            clamps: output.clamp,
            method,
        }
    }
}

/// Returns the literals of a plain AND of different inputs, in ascending order; `None` for any other condition.
fn plain(steps: &[AntecedentStep], inputs_of: &[usize]) -> Option<Vec<u32>> {
    let (first, others) = steps
        .split_first()
        .filter(|(first, _)| first.op == Op::PUSH)?;
    let mut literals = Vec::from([first.literal]);
    for step in others {
        if step.op != Op::AND_LITERAL {
            return None;
        }
        literals.push(step.literal);
    }
    literals.sort_unstable();
    let input = |literal: &u32| inputs_of.get(*literal as usize);
    let different = literals.windows(2).all(|pair| match pair {
        [a, b] => input(a) != input(b),
        _ => true,
    });
    different.then_some(literals)
}

fn position(terms: &[Term], name: &str) -> Option<usize> {
    terms.iter().position(|t| t.name == name)
}
