//! Stages with interval type-2 terms: two compiled stages give the bounds of the firing strengths, and a type reduction
//! computes the interval of each output.
//!
//! AND, OR, the hedges and weights never decrease when a degree increases, and NOT reverses the order. So the upper bound
//! of a firing strength is an ordinary firing strength of upper degrees, in which terms below an odd number of NOTs have
//! their lower degrees; the lower bound is the opposite. A model with type-2 terms is therefore split into two models
//! without such terms, and both are compiled like any other model.

use alloc::{boxed::Box, format, string::String, vec::Vec};

use super::arrays::OwnedTable;
use super::{CompiledOutput, Outcome, RowBuffers, Stage, StageScratch, State};
use crate::defuzzify::{ConsequentOperators, Reduction, Strengths, WeightedNumber};
use crate::model::{
    Defuzzifier, MembershipFunction, Model, Output, TypeReduction, Variable, type2::Bound,
};
use crate::rule::{Condition, Proposition};
use crate::table::operators::{larger, smaller};
use crate::table::{self, Arrays};

/// The parts of a stage that compute intervals. The stage itself has the upper bounds of the firing strengths.
#[derive(Debug, Clone)]
pub(super) struct Bounds {
    /// The stage that has the lower bounds of the firing strengths.
    lower: Stage,
    /// The type reduction of each output; `None` for outputs that no type-2 term affects.
    reductions: Vec<Option<(TypeReduction, Reduction)>>,
}

/// The working memory of [`Bounds`].
#[derive(Debug)]
pub(super) struct BoundsScratch {
    lower: StageScratch,
    points: Vec<WeightedNumber>,
}

/// Keeps the capacity, so that evaluations with the clone do not allocate either.
impl Clone for BoundsScratch {
    fn clone(&self) -> Self {
        BoundsScratch {
            lower: self.lower.clone(),
            points: Vec::with_capacity(self.points.capacity()),
        }
    }
}

impl Stage {
    /// Compiles a valid model in which no output reads another output.
    pub(super) fn new(model: &Model) -> Self {
        if !model
            .outputs
            .iter()
            .any(|output| model.has_interval(output))
        {
            return Stage::plain(model);
        }
        let reduction = |output: &Output| {
            let operators = model.operators_of_output(output);
            let operators = ConsequentOperators {
                implication: operators.implication,
                aggregation: operators.aggregation,
            };
            let has_interval = model.has_interval(output);
            has_interval.then(|| (output.type_reduction, Reduction::new(output, operators)))
        };
        let bounds = Bounds {
            lower: Stage::plain(&bound(model, Bound::Lower)),
            reductions: model.outputs.iter().map(reduction).collect(),
        };
        Stage {
            single: super::SingleRowMethod::Bounds(Box::new(bounds)),
            ..Stage::plain(&bound(model, Bound::Upper))
        }
    }

    /// Returns the parts that compute intervals; `None` if no output of the stage is an interval.
    pub(super) fn bounds(&self) -> Option<&Bounds> {
        match &self.single {
            super::SingleRowMethod::Bounds(bounds) => Some(bounds),
            _ => None,
        }
    }
}

/// Returns a model without type-2 terms whose firing strengths are a bound of those of `model`. Its fuzzy outputs that are
/// intervals have singletons in place of their terms, because only their firing strengths are used.
fn bound(model: &Model, bound: Bound) -> Model {
    let mut only = model.clone();
    let mut lower_names: Vec<(&str, &str, String)> = Vec::new();
    for (variable, changed) in model.inputs.iter().zip(&mut only.inputs) {
        changed.terms = variable
            .terms
            .iter()
            .map(|term| term.only(Bound::Upper))
            .collect();
        for term in variable.terms.iter().filter(|term| term.lower.is_some()) {
            let mut lower = term.only(Bound::Lower);
            lower.name = unused_name(changed, &term.name);
            lower_names.push((&variable.name, &term.name, lower.name.clone()));
            changed.terms.push(lower);
        }
    }
    for rule in &mut only.rules {
        rename(&mut rule.rule.condition, bound, &|proposition| {
            let term = proposition.term.as_mut()?;
            let mut names = lower_names.iter();
            let (.., name) = names.find(|(variable, upper, _)| {
                *variable == proposition.variable.text && *upper == term.text
            })?;
            term.text.clone_from(name);
            Some(())
        });
    }
    for (output, changed) in model.outputs.iter().zip(&mut only.outputs) {
        if !model.has_interval(output) || output.defuzzifier.is_weighted() {
            continue;
        }
        changed.defuzzifier = Defuzzifier::Centroid;
        for term in &mut changed.variable.terms {
            term.membership_function = MembershipFunction::Singleton {
                at: output.variable.low,
            };
            (term.height, term.lower) = (1.0, None);
        }
    }
    only
}

/// Returns a name that no term of a variable has.
fn unused_name(variable: &Variable, name: &str) -> String {
    let is_used = |name: &str| variable.terms.iter().any(|term| term.name == name);
    let mut unused = format!("lower {name}");
    while is_used(&unused) {
        unused.insert_str(0, "lower ");
    }
    unused
}

/// Calls `to_lower` for the propositions of a condition that need the lower degree of their term.
fn rename(
    condition: &mut Condition,
    bound: Bound,
    to_lower: &impl Fn(&mut Proposition) -> Option<()>,
) {
    match condition {
        Condition::Is(proposition) => {
            if bound.through(&proposition.hedges) == Bound::Lower {
                to_lower(proposition);
            }
        }
        Condition::Not(inner) => rename(inner, bound.opposite(), to_lower),
        Condition::And(parts) | Condition::Or(parts) => {
            for part in parts {
                rename(part, bound, to_lower);
            }
        }
    }
}

impl Bounds {
    pub(super) fn scratch(&self) -> BoundsScratch {
        let terms = self.lower.outputs.iter().map(|output| output.offsets.len());
        BoundsScratch {
            lower: self.lower.scratch(&self.lower.arrays),
            points: Vec::with_capacity(terms.max().unwrap_or(0)),
        }
    }

    /// Returns the maximum number of cuts of an evaluation, in addition to a fixed number per firing strength.
    pub(super) fn cuts(&self) -> usize {
        let reductions = self.reductions.iter().flatten();
        let cuts = reductions.map(|(_, reduction)| reduction.cuts());
        cuts.max().unwrap_or(0)
    }

    /// Evaluates a stage with its upper and its lower firing strengths.
    #[inline(never)]
    pub(super) fn outcomes(
        &self,
        stage: &Stage,
        scratch: &mut StageScratch,
        inputs: &[f64],
        outcomes: &mut [Outcome],
    ) {
        stage.outcomes_by(scratch, inputs, outcomes, super::fire_rules);
        let StageScratch {
            table: upper,
            workspace,
            bounds,
        } = scratch;
        let Some(BoundsScratch { lower, points }) = bounds.as_deref_mut() else {
            return;
        };
        let lower = &mut lower.table;
        let values = inputs.as_chunks().0.iter().copied();
        table::clamp(&self.lower.arrays, values, &mut lower.values);
        super::fire_rules(&self.lower.arrays, lower);
        let of_outputs = stage.outputs.iter().zip(&self.lower.outputs);
        let reductions = self.reductions.iter().zip(of_outputs).zip(outcomes);
        for (index, ((reduction, (of_upper, of_lower)), outcome)) in reductions.enumerate() {
            let (Some((method, reduction)), State::Defined(_)) = (reduction, outcome.state) else {
                continue;
            };
            let number = |term: usize| number(&stage.arrays, index, term, upper);
            let strengths = (strengths(of_lower, lower), strengths(of_upper, upper));
            let (of_lower_rules, of_upper_rules) = strengths;
            let interval = reduction.interval(
                *method,
                of_lower_rules,
                of_upper_rules,
                number,
                workspace,
                points,
            );
            outcome.state = match interval {
                None => State::NoRuleFired,
                Some((low, high)) => {
                    let end = |end: f64| match of_upper.clamps {
                        true => larger(of_upper.low, smaller(of_upper.high, end)),
                        false => end,
                    };
                    match method {
                        TypeReduction::NieTan | TypeReduction::BegianMelekMendel => {
                            State::Defined(end(low))
                        }
                        TypeReduction::Exact | TypeReduction::WuMendel => State::Interval {
                            low: end(low),
                            high: end(high),
                        },
                    }
                }
            };
        }
    }
}

fn strengths<'a>(output: &'a CompiledOutput, buffers: &'a RowBuffers<1>) -> Strengths<'a> {
    let strengths = buffers.strengths.get(output.strengths.clone());
    Strengths {
        strengths: strengths.unwrap_or_default().as_flattened(),
        offsets: &output.offsets,
    }
}

/// Returns the number of a term of a Takagi-Sugeno output; NaN for any other output.
fn number(arrays: &OwnedTable, output: usize, term: usize, buffers: &RowBuffers<1>) -> f64 {
    let consequent = arrays.outputs.get(output).and_then(|output| {
        let range = output.first as usize..output.end as usize;
        arrays.consequents().get(range)?.get(term)
    });
    consequent.map_or(f64::NAN, |consequent| {
        table::number(arrays, consequent, &buffers.values)
    })
}

#[cfg(test)]
#[path = "bounds_tests.rs"]
mod tests;
