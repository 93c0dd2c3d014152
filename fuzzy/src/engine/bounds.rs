//! Stages with interval type-2 terms: one compiled stage computes both bounds of the firing strengths, and a type
//! reduction computes the interval of each output.
//!
//! AND, OR, the hedges and weights never decrease when a degree increases, and NOT reverses the order. So the
//! upper bound of a firing strength is computed like an ordinary firing strength, from the upper degrees of most
//! terms and the lower degrees of the terms below an odd number of NOTs. For the lower bound, upper and lower
//! degrees are exchanged. A model with type-2 terms is therefore converted to an ordinary model, in which each
//! output that is an interval has a second output, with the lower bounds. The second outputs follow all other
//! outputs and have no outcomes.
//!
//! The table computes the intervals of weighted outputs and of fuzzy sets with a closed form, so that they can be
//! exported. The intervals of all other fuzzy sets are computed here.

use alloc::{boxed::Box, format, string::String, vec::Vec};

use super::strategy::{method, prepared_set};
use super::{CompiledOutput, Outcome, RowBuffers, Stage, StageScratch, State};
use crate::defuzzify::{ConsequentOperators, Method, Reduction, Strengths};
use crate::model::{
    Defuzzifier, MembershipFunction, Model, Output, Term, TypeReduction, type2::Bound,
};
use crate::rule::{Condition, Proposition};
use crate::table::{LOWER_BOUNDS, SetDefuzzifier};

/// The type reductions of a stage that the table does not compute.
#[derive(Debug, Clone)]
pub(super) struct Bounds {
    reductions: Vec<SetReduction>,
}

/// The type reduction of a fuzzy set.
#[derive(Debug, Clone)]
struct SetReduction {
    output: usize,
    /// The index of the output with the lower bounds of the firing strengths.
    lower: usize,
    method: TypeReduction,
    reduction: Reduction,
}

impl Stage {
    /// Compiles a valid model in which no output reads another output.
    pub(super) fn new(model: &Model) -> Self {
        if !model
            .outputs
            .iter()
            .any(|output| model.has_interval(output))
        {
            return Stage::plain(model, &[]);
        }
        let outputs = model.outputs.iter();
        let closed: Vec<bool> = outputs
            .map(|output| model.has_interval(output) && has_closed_form(model, output))
            .collect();
        let intervals = model.outputs.iter().zip(&closed).enumerate();
        let intervals = intervals.filter(|(_, (output, _))| model.has_interval(output));
        let intervals = intervals.zip(model.outputs.len()..);
        let reduced = intervals
            .clone()
            .filter(|((_, (output, closed)), _)| **closed && !output.type_reduction.is_number())
            .flat_map(|((upper, _), lower)| [upper, lower]);
        let reduced: Vec<usize> = reduced.collect();
        let mut stage = Stage::plain(&with_both_bounds(model, &closed), &reduced);
        let mut reductions = Vec::new();
        for ((output, (of_model, is_closed)), lower) in intervals {
            let operators = model.operators_of_output(of_model);
            let operators = ConsequentOperators {
                implication: operators.implication,
                aggregation: operators.aggregation,
            };
            let method = of_model.type_reduction;
            if !is_closed && let Some(reduction) = Reduction::new(of_model, operators) {
                reductions.push(SetReduction {
                    output,
                    lower,
                    method,
                    reduction,
                });
            }
            let outputs = &mut stage.arrays.outputs;
            if let Some(upper) = outputs.get_mut(output) {
                (upper.reduction, upper.lower) = (method.code(), lower as u32);
            }
            if let Some(lower) = outputs.get_mut(lower) {
                lower.reduction = LOWER_BOUNDS;
            }
        }
        Stage {
            single: super::SingleRowMethod::Bounds(Box::new(Bounds { reductions })),
            ..stage
        }
    }

    /// Returns the type reductions of the stage; `None` if no output of the stage is an interval.
    pub(super) fn bounds(&self) -> Option<&Bounds> {
        match &self.single {
            super::SingleRowMethod::Bounds(bounds) => Some(bounds),
            _ => None,
        }
    }
}

/// Returns whether the table computes the type reduction of a fuzzy set: a single value from the areas and centroids
/// of both sets, an interval from prepared sets.
fn has_closed_form(model: &Model, output: &Output) -> bool {
    let operators = model.operators_of_output(output);
    let is_closed = |bound: Bound| {
        let output = only(output, bound);
        match output.type_reduction.is_number() {
            true => !matches!(method(&output, operators, |_| None), Method::Integrated(_)),
            false => prepared_set(&output, operators, SetDefuzzifier::Centroid).is_some(),
        }
    };
    output.defuzzifier == Defuzzifier::Centroid
        && is_closed(Bound::Upper)
        && is_closed(Bound::Lower)
}

/// Returns an output with only the lower, or only the upper membership functions of its terms.
fn only(output: &Output, bound: Bound) -> Output {
    let mut only = output.clone();
    for term in &mut only.variable.terms {
        *term = term.only(bound);
    }
    only
}

/// Returns a model without type-2 terms. Each output that is an interval has the upper bounds of its firing strengths, and
/// a second output, at the end, has the lower bounds. Fuzzy sets that are not `closed` have singletons in place of their
/// terms, because only their firing strengths are used.
fn with_both_bounds(model: &Model, closed: &[bool]) -> Model {
    let mut both = model.clone();
    let mut lower_names: Vec<(&str, &str, String)> = Vec::new();
    for (variable, changed) in model.inputs.iter().zip(&mut both.inputs) {
        for term in &mut changed.terms {
            term.lower = None;
        }
        for term in variable.terms.iter().filter(|term| term.lower.is_some()) {
            let mut lower = term.only(Bound::Lower);
            lower.name = unused_name(&term.name, changed.terms.iter().map(|term| &term.name));
            lower_names.push((&variable.name, &term.name, lower.name.clone()));
            changed.terms.push(lower);
        }
    }
    // For each output that is an interval: its name, and the name of its second output.
    let mut lower_outputs: Vec<(&str, String)> = Vec::new();
    for (index, (output, is_closed)) in model.outputs.iter().zip(closed).enumerate() {
        if !model.has_interval(output) {
            continue;
        }
        let names = both.outputs.iter().map(|output| &output.variable.name);
        let name = unused_name(&output.variable.name, names);
        let Some(upper) = both.outputs.get_mut(index) else {
            continue;
        };
        let mut lower;
        if *is_closed {
            *upper = only(output, Bound::Upper);
            lower = only(output, Bound::Lower);
        } else if output.defuzzifier.is_weighted() {
            lower = output.clone();
            // The second output needs no numbers of its own, because the numbers of the first output are used.
            replace_terms(&mut lower, &MembershipFunction::Constant { value: 0.0 });
        } else {
            let at = upper.variable.low;
            replace_terms(upper, &MembershipFunction::Singleton { at });
            lower = upper.clone();
        }
        lower.variable.name.clone_from(&name);
        both.outputs.push(lower);
        lower_outputs.push((&output.variable.name, name));
    }
    let mut lower_rules = Vec::new();
    for (rule, changed) in model.rules.iter().zip(&mut both.rules) {
        let mut lower = rule.clone();
        lower.rule.consequents.retain_mut(|consequent| {
            let mut outputs = lower_outputs.iter();
            let found = outputs.find(|(name, _)| *name == consequent.output.text);
            found.is_some_and(|(_, name)| {
                consequent.output.text.clone_from(name);
                true
            })
        });
        if !model.reads_type2(rule) {
            // Both bounds of the firing strength are equal.
            changed.rule.consequents.append(&mut lower.rule.consequents);
            continue;
        }
        for (rule, bound) in [(&mut *changed, Bound::Upper), (&mut lower, Bound::Lower)] {
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
        if !lower.rule.consequents.is_empty() {
            lower_rules.push(lower);
        }
    }
    both.rules.append(&mut lower_rules);
    both
}

fn replace_terms(output: &mut Output, membership_function: &MembershipFunction) {
    for term in &mut output.variable.terms {
        *term = Term {
            name: core::mem::take(&mut term.name),
            membership_function: membership_function.clone(),
            height: 1.0,
            lower: None,
        };
    }
}

/// Returns a name that is not among the given names.
fn unused_name<'n>(name: &str, used: impl Iterator<Item = &'n String> + Clone) -> String {
    let mut unused = format!("lower {name}");
    while used.clone().any(|used| *used == unused) {
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
    /// Returns the maximum number of cuts of an evaluation, not counting a fixed number per firing strength.
    pub(super) fn cuts(&self) -> usize {
        let cuts = self.reductions.iter().map(|one| one.reduction.cuts());
        cuts.max().unwrap_or(0)
    }

    /// Evaluates a stage with both bounds of its firing strengths.
    #[inline(never)]
    pub(super) fn outcomes(
        &self,
        stage: &Stage,
        scratch: &mut StageScratch,
        inputs: &[f64],
        outcomes: &mut [Outcome],
    ) {
        stage.outcomes_by(scratch, inputs, outcomes, super::fire_rules);
        let StageScratch { table, workspace } = scratch;
        for one in &self.reductions {
            let (Some(outcome), Some(output)) = (
                outcomes.get_mut(one.output),
                stage.arrays.outputs.get(one.output),
            ) else {
                continue;
            };
            let of = |index: usize| Some(strengths(stage.outputs.get(index)?, table));
            let (Some(lower), Some(upper), State::Defined(_)) =
                (of(one.lower), of(one.output), outcome.state)
            else {
                continue;
            };
            let ends = one.reduction.interval(one.method, lower, upper, workspace);
            let state = ends.map(|ends| one.method.state(output, ends));
            outcome.state = state.unwrap_or(State::NoRuleFired);
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

#[cfg(test)]
#[path = "bounds_tests.rs"]
mod tests;
