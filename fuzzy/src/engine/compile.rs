//! From names to indices, with every problem of the model found at once.

use alloc::{
    collections::{BTreeMap, BTreeSet},
    format,
    string::String,
    sync::Arc,
    vec,
    vec::Vec,
};

use super::arrays::OwnedTable;
use super::lanes::Lanes;
use super::literal::{Literal, Literals};
use super::problem::{CompileError, Problem};
use super::rules::Draft;
use super::{CompiledOutput, Engine, Input};
use crate::defuzzify::weighted::Consequents;
use crate::defuzzify::{Defuzzify, Merging};
use crate::model::{Model, NoRuleFires, Output, Shape, Term, Variable};
use crate::rule::{Condition, Hedge, Proposition};
use crate::table::{Action, Op, Step};

impl Engine {
    /// Compiles a model: names become indices, rules a table, output terms closed forms.
    ///
    /// # Errors
    /// Every problem of the model that keeps it from being evaluated on every finite input.
    ///
    /// # Example: all problems at once
    /// ```
    /// use fuzzy::{Engine, Model, model::{Output, Variable}, rule};
    ///
    /// let model = Model::builder("fan")
    ///     .input(Variable::new("heat", 100.0, 0.0))
    ///     .output(Output::new(Variable::new("speed", 0.0, 9.0)))
    ///     .rule(rule::parse("IF heat IS high THEN speed IS fast")?)
    ///     .build();
    /// let error = Engine::new(&model).unwrap_err();
    /// assert_eq!(error.problems.len(), 3, "the range is upside down, and both terms are unknown: {error}");
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn new(model: &Model) -> Result<Self, CompileError> {
        let mut compiler = Compiler {
            model,
            problems: Vec::new(),
            literals: BTreeMap::new(),
        };
        compiler.variables();
        compiler.literals();
        let drafts = compiler.drafts();
        let engine = compiler.engine(drafts);
        if compiler.problems.is_empty() {
            Ok(engine)
        } else {
            Err(CompileError {
                problems: compiler.problems,
            })
        }
    }
}

/// Input, term and hedges in the order in which they apply.
type LiteralKey = (usize, Option<usize>, Vec<Hedge>);

struct Compiler<'m> {
    model: &'m Model,
    problems: Vec<Problem>,
    /// Numbered by input, term and hedges, whatever the order of the rules.
    literals: BTreeMap<LiteralKey, u32>,
}

impl Compiler<'_> {
    fn variables(&mut self) {
        let model = self.model;
        if model.outputs.is_empty() {
            self.problems.push(Problem::NoOutputs);
        }
        self.duplicates("the inputs", model.inputs.iter().map(|v| &v.name));
        let outputs = model.outputs.iter().map(|o| &o.variable.name);
        self.duplicates("the outputs", outputs);
        for input in &model.inputs {
            self.variable(input);
            for term in &input.terms {
                if matches!(term.shape, Shape::Linear { .. }) {
                    self.misfit(input, term, "`linear` is no membership function");
                }
            }
        }
        for output in &model.outputs {
            self.variable(&output.variable);
            if let NoRuleFires::Value(value) = output.when_no_rule_fires
                && !(output.variable.low..=output.variable.high).contains(&value)
            {
                self.problems.push(Problem::DefaultOutsideRange {
                    output: output.variable.name.clone(),
                });
            }
            if let Some(sampling) = output.samples
                && sampling.samples < 2
            {
                self.problems.push(Problem::TooFewSamples {
                    output: output.variable.name.clone(),
                    samples: sampling.samples,
                });
            }
        }
    }

    /// What inputs and outputs have in common.
    fn variable(&mut self, variable: &Variable) {
        let name = &variable.name;
        let span = variable.high - variable.low;
        if !(span > 0.0 && (2.0 * span).is_finite()) {
            self.problems.push(Problem::Range {
                variable: name.clone(),
            });
        }
        self.duplicates(&format!("`{name}`"), variable.terms.iter().map(|t| &t.name));
        for term in &variable.terms {
            if let Err(error) = term.shape.validate() {
                self.problems.push(Problem::Shape {
                    variable: name.clone(),
                    term: term.name.clone(),
                    error,
                });
            }
            if !(term.height > 0.0 && term.height <= 1.0) {
                self.problems.push(Problem::Height {
                    variable: name.clone(),
                    term: term.name.clone(),
                });
            }
        }
    }

    fn duplicates<'n>(&mut self, place: &str, names: impl Iterator<Item = &'n String>) {
        let mut seen = BTreeSet::new();
        for name in names {
            if !seen.insert(name) {
                self.problems.push(Problem::Duplicate {
                    name: name.clone(),
                    place: place.into(),
                });
            }
        }
    }

    fn misfit(&mut self, variable: &Variable, term: &Term, why: &'static str) {
        self.problems.push(Problem::Misfit {
            variable: variable.name.clone(),
            term: term.name.clone(),
            why,
        });
    }

    fn unknown(&mut self, rule: usize, name: &str, kind: impl Into<String>) {
        self.problems.push(Problem::Unknown {
            rule,
            name: name.into(),
            kind: kind.into(),
        });
    }

    /// Finds and numbers all literals of all rules.
    fn literals(&mut self) {
        let model = self.model;
        for (index, rule) in model.rules.iter().enumerate() {
            self.find_literals(index, &rule.rule.condition);
        }
        for (id, number) in self.literals.values_mut().zip(0..) {
            *id = number;
        }
    }

    fn find_literals(&mut self, rule: usize, condition: &Condition) {
        match condition {
            Condition::Is(proposition) => {
                if let Some(key) = self.key(Some(rule), proposition) {
                    self.literals.insert(key, 0);
                }
            }
            Condition::Not(inner) => self.find_literals(rule, inner),
            Condition::And(all) | Condition::Or(all) => {
                if all.is_empty() {
                    self.problems.push(Problem::EmptyRule { rule });
                }
                for condition in all {
                    self.find_literals(rule, condition);
                }
            }
        }
    }

    /// What a proposition names; its problems are noted for `rule`.
    fn key(&mut self, rule: Option<usize>, proposition: &Proposition) -> Option<LiteralKey> {
        let model = self.model;
        let variable = &proposition.variable.text;
        let Some(input) = model.inputs.iter().position(|v| &v.name == variable) else {
            if let Some(rule) = rule {
                self.unknown(rule, variable, "input");
            }
            return None;
        };
        let term = match &proposition.term {
            None if proposition.hedges.contains(&Hedge::Any) => None,
            None => {
                if let Some(rule) = rule {
                    self.problems.push(Problem::NoTerm {
                        rule,
                        variable: variable.clone(),
                    });
                }
                return None;
            }
            Some(name) => {
                let found = position(&model.inputs[input].terms, &name.text);
                if let (None, Some(rule)) = (found, rule) {
                    self.unknown(rule, &name.text, format!("term of `{variable}`"));
                }
                Some(found?)
            }
        };
        let hedges = proposition.hedges.iter().rev().copied().collect();
        Some((input, term, hedges))
    }

    fn literal(&mut self, proposition: &Proposition) -> u32 {
        let key = self.key(None, proposition);
        key.and_then(|key| self.literals.get(&key).copied())
            .unwrap_or(0)
    }

    /// The rules as literals, steps and actions, in an order that is that of their content: the order of
    /// lines in a rule set changes no bit of an answer.
    fn drafts(&mut self) -> Vec<Draft> {
        let model = self.model;
        let inputs_of: Vec<usize> = self.literals.keys().map(|key| key.0).collect();
        let mut drafts = Vec::new();
        for (index, rule) in model.rules.iter().enumerate() {
            let rule = &rule.rule;
            if !(0.0..=1.0).contains(&rule.weight) {
                self.problems.push(Problem::Weight { rule: index });
            }
            if rule.consequents.is_empty() {
                self.problems.push(Problem::EmptyRule { rule: index });
            }
            let mut steps = Vec::new();
            self.condition(&rule.condition, &mut steps);
            let mut actions = Vec::new();
            for consequent in &rule.consequents {
                let name = &consequent.output.text;
                let found = model.outputs.iter().position(|o| &o.variable.name == name);
                let Some(output) = found else {
                    self.unknown(index, name, "output");
                    continue;
                };
                let variable = &model.outputs[output].variable;
                let Some(term) = position(&variable.terms, &consequent.term.text) else {
                    self.unknown(index, &consequent.term.text, format!("term of `{name}`"));
                    continue;
                };
                actions.push(Action {
                    weight: rule.weight,
                    strength: term as u32,
                    output: output as u32,
                    rule: index as u32,
                    sums: 0,
                });
            }
            drafts.push(Draft {
                literals: plain(&steps, &inputs_of),
                steps,
                actions,
            });
        }
        let content = |draft: &Draft| {
            let actions = draft.actions.iter();
            actions
                .map(|a| (a.output, a.strength, a.weight.to_bits()))
                .collect::<Vec<_>>()
        };
        drafts.sort_by_cached_key(|draft| {
            (draft.literals.clone(), draft.steps.clone(), content(draft))
        });
        drafts
    }

    fn condition(&mut self, condition: &Condition, steps: &mut Vec<Step>) {
        match condition {
            Condition::Is(proposition) => steps.push(Step {
                op: Op::PUSH,
                literal: self.literal(proposition),
            }),
            Condition::Not(inner) => {
                self.condition(inner, steps);
                steps.push(Step {
                    op: Op::NOT,
                    literal: 0,
                });
            }
            Condition::And(all) => self.joined(all, steps, (Op::AND_LITERAL, Op::AND)),
            Condition::Or(any) => self.joined(any, steps, (Op::OR_LITERAL, Op::OR)),
        }
    }

    fn joined(
        &mut self,
        conditions: &[Condition],
        steps: &mut Vec<Step>,
        (with_literal, with_top): (Op, Op),
    ) {
        for (i, condition) in conditions.iter().enumerate() {
            match condition {
                Condition::Is(proposition) if i > 0 => {
                    steps.push(Step {
                        op: with_literal,
                        literal: self.literal(proposition),
                    });
                }
                _ => {
                    self.condition(condition, steps);
                    if i > 0 {
                        steps.push(Step {
                            op: with_top,
                            literal: 0,
                        });
                    }
                }
            }
        }
    }

    fn engine(&mut self, mut drafts: Vec<Draft>) -> Engine {
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
                shape: Shape::Constant { value: 1.0 },
                height: 1.0,
            };
            by_input[*input].push(Literal {
                term: term.map_or_else(always, |t| model.inputs[*input].terms[t].clone()),
                hedges: hedges.clone(),
            });
        }
        let mut first = 0;
        let mut inputs = Vec::new();
        let mut literals = Vec::new();
        for (variable, of_input) in model.inputs.iter().zip(&by_input) {
            let count = of_input.len() as u32;
            literals.push(Literals::new(
                first,
                of_input.clone(),
                variable.low,
                variable.high,
            ));
            first += count;
            inputs.push(Input {
                name: Arc::from(variable.name.as_str()),
                low: variable.low,
                high: variable.high,
            });
        }
        let operators = model.operators;
        Engine {
            lanes: Lanes::new(operators.and, &inputs, &by_input, &drafts, &outputs),
            arrays: OwnedTable::new(operators, &inputs, &literals, &drafts, &outputs),
            inputs,
            outputs,
        }
    }

    /// Compiles an output and gives the drafts' actions on it the indices of their firing strengths.
    fn output(
        &mut self,
        index: usize,
        output: &Output,
        first_strength: usize,
        drafts: &mut [Draft],
    ) -> CompiledOutput {
        let variable = &output.variable;
        let operators = self.model.operators;
        let merging = Merging::of(output.defuzzifier, operators);
        let actions = || drafts.iter().flat_map(|draft| &draft.actions);
        let here = |action: &&Action| action.output as usize == index;
        let mut counts = vec![0; variable.terms.len()];
        for action in actions().filter(here) {
            counts[action.strength as usize] += 1;
        }
        let used: Vec<bool> = counts.iter().map(|count| *count > 0).collect();
        let defuzzify = self.defuzzify(output, &used);
        if merging != Merging::Apart {
            counts.fill(1);
        }
        let mut offsets = vec![0];
        for count in counts {
            offsets.push(offsets.last().copied().unwrap_or(0) + count);
        }
        let mut next = match defuzzify.ranks() {
            Some((_, ranks)) => ranks.to_vec(),
            None => offsets.clone(),
        };
        for action in drafts.iter_mut().flat_map(|draft| &mut draft.actions) {
            if action.output as usize == index {
                let term = action.strength as usize;
                action.strength = (first_strength + next[term]) as u32;
                action.sums = u32::from(merging == Merging::Sum);
                if merging == Merging::Apart {
                    next[term] += 1;
                }
            }
        }
        let last = offsets.last().copied().unwrap_or(0);
        let count = defuzzify.ranks().map_or(last, |(count, _)| count);
        CompiledOutput {
            name: Arc::from(variable.name.as_str()),
            low: variable.low,
            high: variable.high,
            when_no_rule_fires: output.when_no_rule_fires,
            strengths: first_strength..first_strength + count,
            offsets,
            defuzzify,
        }
    }

    fn defuzzify(&mut self, output: &Output, used: &[bool]) -> Defuzzify {
        let variable = &output.variable;
        let operators = self.model.operators;
        if output.defuzzifier.is_weighted() {
            let mut consequents = Consequents::default();
            for term in &variable.terms {
                let mut strangers = Vec::new();
                let input = |name: &str| self.model.inputs.iter().position(|v| v.name == name);
                let is_consequent = consequents.push(&term.shape, input, |name| {
                    strangers.push(String::from(name))
                });
                for name in strangers {
                    self.problems.push(Problem::UnknownCoefficient {
                        output: variable.name.clone(),
                        term: term.name.clone(),
                        name,
                    });
                }
                if !is_consequent {
                    let why = "a weighted defuzzifier takes `constant`, `linear` and `singleton`";
                    self.misfit(variable, term, why);
                }
            }
            return Defuzzify::weighted(output, operators, consequents);
        }
        let defuzzify = Defuzzify::fuzzy(output, operators);
        for (term, used) in variable.terms.iter().zip(used) {
            let why = match term.shape {
                Shape::Linear { .. } => "`linear` takes a weighted defuzzifier",
                Shape::Singleton { .. } => {
                    "a singleton has no area: it takes a weighted defuzzifier"
                }
                _ => continue,
            };
            if *used {
                self.misfit(variable, term, why);
            }
        }
        for (index, (term, used)) in variable.terms.iter().zip(used).enumerate() {
            let area = !matches!(term.shape, Shape::Linear { .. } | Shape::Singleton { .. });
            if *used && area && defuzzify.is_empty(index) {
                self.problems.push(Problem::OutsideRange {
                    variable: variable.name.clone(),
                    term: term.name.clone(),
                });
            }
        }
        defuzzify
    }
}

/// The literals of a plain AND of different inputs, ascending; `None` of another condition.
fn plain(steps: &[Step], inputs_of: &[usize]) -> Option<Vec<u32>> {
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
