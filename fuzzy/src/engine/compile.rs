//! From names to indices, with every problem of the model found at once.

use alloc::{collections::BTreeMap, string::String, sync::Arc, vec::Vec};

use super::condition::Step;
use super::{Action, CompiledOutput, CompiledRule, Engine, Input, Literal};
use crate::defuzzify::polyline::Polylines;
use crate::model::{
    Aggregation, Defuzzifier, Model, NoRuleFires, Output, Shape, ShapeError, Term, Variable,
};
use crate::rule::{Condition, Hedge, Proposition};

/// Why a model makes no engine: every problem found.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct CompileError {
    /// The problems, in the order of the model; at least one.
    pub problems: Vec<Problem>,
}

impl core::fmt::Display for CompileError {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        for (i, problem) in self.problems.iter().enumerate() {
            if i > 0 {
                f.write_str("; ")?;
            }
            problem.fmt(f)?;
        }
        Ok(())
    }
}

impl core::error::Error for CompileError {}

/// One reason why a model makes no engine. `rule` is an index into [`Model::rules`]; messages count from 1.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum Problem {
    /// There is nothing to compute.
    #[error("the model has no outputs")]
    NoOutputs,
    /// Two variables of one kind, or two terms of one variable, share a name.
    #[error("`{name}` is defined twice in {place}")]
    Duplicate {
        /// The name.
        name: String,
        /// Where: `the inputs`, `the outputs` or a variable.
        place: String,
    },
    /// A range that is empty or not finite.
    #[error("the range of `{variable}` is not from a finite number up to a larger one")]
    Range {
        /// The variable.
        variable: String,
    },
    /// Parameters that make no membership function.
    #[error("term `{term}` of `{variable}`: {error}")]
    Shape {
        /// The variable.
        variable: String,
        /// The term.
        term: String,
        /// What is wrong with it.
        error: ShapeError,
    },
    /// A height outside (0, 1].
    #[error("term `{term}` of `{variable}`: the height is not in (0, 1]")]
    Height {
        /// The variable.
        variable: String,
        /// The term.
        term: String,
    },
    /// A shape that the output's defuzzifier cannot use, or that no input can have.
    #[error("term `{term}` of `{variable}`: {why}")]
    Misfit {
        /// The variable.
        variable: String,
        /// The term.
        term: String,
        /// Why it does not fit.
        why: &'static str,
    },
    /// A term that is 0 on all of its output's range, where it can say nothing.
    #[error("term `{term}` of `{variable}` is 0 on the whole range")]
    OutsideRange {
        /// The variable.
        variable: String,
        /// The term.
        term: String,
    },
    /// A rule names an input, an output or a term that the model does not have.
    #[error("rule {} names `{name}`, which is no {kind}", rule + 1)]
    Unknown {
        /// The rule.
        rule: usize,
        /// The name.
        name: String,
        /// `input`, `output` or `term of ...`.
        kind: String,
    },
    /// A proposition without a term whose hedges do not end it.
    #[error(
        "rule {} says nothing of `{variable}`: a term, or the hedge `any`, is missing",
        rule + 1
    )]
    NoTerm {
        /// The rule.
        rule: usize,
        /// The input.
        variable: String,
    },
    /// A rule with no consequent, or an empty AND or OR.
    #[error("rule {} is empty", rule + 1)]
    EmptyRule {
        /// The rule.
        rule: usize,
    },
    /// A weight outside [0, 1].
    #[error("the weight of rule {} is not in [0, 1]", rule + 1)]
    Weight {
        /// The rule.
        rule: usize,
    },
    /// A value for where no rule fires that lies outside the output's range.
    #[error("the value of `{output}` where no rule fires is not in its range")]
    DefaultOutsideRange {
        /// The output.
        output: String,
    },
    /// A combination that the engine does not have.
    #[error("output `{output}`: {why}")]
    Unsupported {
        /// The output.
        output: String,
        /// What it is.
        why: &'static str,
    },
}

impl Engine {
    /// Compiles a model: names become indices, conditions flat programs, output terms lines between cuts.
    ///
    /// # Errors
    /// Every problem of the model that keeps it from being evaluated on every finite input.
    pub fn new(model: &Model) -> Result<Self, CompileError> {
        let mut compiler = Compiler {
            model,
            problems: Vec::new(),
            literals: Vec::new(),
            literal_ids: BTreeMap::new(),
        };
        let engine = compiler.engine();
        if compiler.problems.is_empty() {
            Ok(engine)
        } else {
            Err(CompileError {
                problems: compiler.problems,
            })
        }
    }
}

struct Compiler<'m> {
    model: &'m Model,
    problems: Vec<Problem>,
    literals: Vec<Literal>,
    literal_ids: BTreeMap<(usize, Option<usize>, Vec<Hedge>), u32>,
}

impl Compiler<'_> {
    fn engine(&mut self) -> Engine {
        let model = self.model;
        if model.outputs.is_empty() {
            self.problems.push(Problem::NoOutputs);
        }
        self.duplicates("the inputs", model.inputs.iter().map(|v| &v.name));
        self.duplicates(
            "the outputs",
            model.outputs.iter().map(|o| &o.variable.name),
        );
        for input in &model.inputs {
            self.variable(input);
        }
        let mut outputs = Vec::new();
        let mut first_place = 0;
        for output in &model.outputs {
            let compiled = self.output(output, first_place);
            first_place += compiled.places.last().copied().unwrap_or(0);
            outputs.push(compiled);
        }
        let mut engine = Engine {
            inputs: model
                .inputs
                .iter()
                .map(|v| Input {
                    name: v.name.as_str().into(),
                    low: v.low,
                    high: v.high,
                })
                .collect(),
            literals: Vec::new(),
            steps: Vec::new(),
            rules: Vec::new(),
            actions: Vec::new(),
            outputs,
            operators: model.operators,
            places: first_place,
        };
        for (index, rule) in model.rules.iter().enumerate() {
            let rule = &rule.rule;
            if !(0.0..=1.0).contains(&rule.weight) {
                self.problems.push(Problem::Weight { rule: index });
            }
            if rule.consequents.is_empty() {
                self.problems.push(Problem::EmptyRule { rule: index });
            }
            let first_step = engine.steps.len();
            self.condition(index, &rule.condition, &mut engine.steps);
            let first_action = engine.actions.len();
            for consequent in &rule.consequents {
                let found = model
                    .outputs
                    .iter()
                    .position(|o| o.variable.name == consequent.output.text);
                let Some(output) = found else {
                    self.unknown(index, &consequent.output.text, "output".into());
                    continue;
                };
                let variable = &model.outputs[output].variable;
                let found = position(&variable.terms, &consequent.term.text);
                let Some(term) = found else {
                    let kind = alloc::format!("term of `{}`", variable.name);
                    self.unknown(index, &consequent.term.text, kind);
                    continue;
                };
                let place = engine.outputs[output].first_place + term;
                engine.actions.push(Action { output, place });
            }
            engine.rules.push(CompiledRule {
                first_step,
                end_step: engine.steps.len(),
                first_action,
                end_action: engine.actions.len(),
                weight: rule.weight,
                index,
            });
        }
        engine.literals = core::mem::take(&mut self.literals);
        engine
    }

    fn duplicates<'n>(&mut self, place: &str, names: impl Iterator<Item = &'n String>) {
        let mut seen = Vec::new();
        for name in names {
            if seen.contains(&name) {
                self.problems.push(Problem::Duplicate {
                    name: name.clone(),
                    place: place.into(),
                });
            }
            seen.push(name);
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
        let place = alloc::format!("`{name}`");
        self.duplicates(&place, variable.terms.iter().map(|t| &t.name));
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

    fn output(&mut self, output: &Output, first_place: usize) -> CompiledOutput {
        let variable = &output.variable;
        self.variable(variable);
        if let NoRuleFires::Value(value) = output.when_no_rule_fires
            && !(variable.low..=variable.high).contains(&value)
        {
            self.problems.push(Problem::DefaultOutsideRange {
                output: variable.name.clone(),
            });
        }
        if output.defuzzifier != Defuzzifier::Centroid || output.samples.is_some() {
            self.unsupported(variable, "this defuzzifier");
        }
        let merged = self.model.operators.aggregation == Aggregation::Maximum;
        if !merged {
            self.unsupported(variable, "this aggregation");
        }
        let polylines = Polylines::new(&variable.terms, variable.low, variable.high);
        if polylines.is_none() {
            self.unsupported(variable, "curved terms");
        }
        CompiledOutput {
            name: Arc::from(variable.name.as_str()),
            low: variable.low,
            high: variable.high,
            when_no_rule_fires: output.when_no_rule_fires,
            first_place,
            places: (0..=variable.terms.len()).collect(),
            polylines: polylines.unwrap_or_default(),
        }
    }

    fn unsupported(&mut self, variable: &Variable, why: &'static str) {
        self.problems.push(Problem::Unsupported {
            output: variable.name.clone(),
            why,
        });
    }

    fn unknown(&mut self, rule: usize, name: &str, kind: String) {
        self.problems.push(Problem::Unknown {
            rule,
            name: name.into(),
            kind,
        });
    }

    fn condition(&mut self, rule: usize, condition: &Condition, steps: &mut Vec<Step>) {
        match condition {
            Condition::Is(proposition) => {
                steps.push(Step::Push(self.literal(rule, proposition)));
            }
            Condition::Not(inner) => {
                self.condition(rule, inner, steps);
                steps.push(Step::Not);
            }
            Condition::And(all) => {
                self.joined(rule, all, steps, Step::AndLiteral, Step::And);
            }
            Condition::Or(any) => {
                self.joined(rule, any, steps, Step::OrLiteral, Step::Or);
            }
        }
    }

    fn joined(
        &mut self,
        rule: usize,
        conditions: &[Condition],
        steps: &mut Vec<Step>,
        with_literal: fn(u32) -> Step,
        with_top: Step,
    ) {
        let Some((first, others)) = conditions.split_first() else {
            self.problems.push(Problem::EmptyRule { rule });
            return;
        };
        self.condition(rule, first, steps);
        for other in others {
            if let Condition::Is(proposition) = other {
                steps.push(with_literal(self.literal(rule, proposition)));
            } else {
                self.condition(rule, other, steps);
                steps.push(with_top);
            }
        }
    }

    /// The index of a proposition's literal; the same for the same input, term and hedges.
    fn literal(&mut self, rule: usize, proposition: &Proposition) -> u32 {
        let model = self.model;
        let variable = &proposition.variable.text;
        let Some(input) = model.inputs.iter().position(|v| &v.name == variable) else {
            self.unknown(rule, variable, "input".into());
            return 0;
        };
        let terms = &model.inputs[input].terms;
        let term = match &proposition.term {
            None => {
                if !proposition.hedges.contains(&Hedge::Any) {
                    self.problems.push(Problem::NoTerm {
                        rule,
                        variable: variable.clone(),
                    });
                }
                None
            }
            Some(name) => {
                let found = position(terms, &name.text);
                if found.is_none() {
                    let kind = alloc::format!("term of `{variable}`");
                    self.unknown(rule, &name.text, kind);
                }
                found
            }
        };
        let literals = &mut self.literals;
        let key = (input, term, proposition.hedges.clone());
        *self.literal_ids.entry(key).or_insert_with(|| {
            literals.push(Literal {
                input,
                term: term.and_then(|t| terms.get(t)).map_or(
                    Term {
                        name: String::new(),
                        shape: Shape::Constant { value: 1.0 },
                        height: 1.0,
                    },
                    Term::clone,
                ),
                hedges: proposition.hedges.iter().rev().copied().collect(),
            });
            literals.len() as u32 - 1
        })
    }
}

fn position(terms: &[Term], name: &str) -> Option<usize> {
    terms.iter().position(|t| t.name == name)
}
