//! Finding the rule that raises an output most.

use core::ops::DerefMut;

use super::actions::{FiringConsumer, StrongestRule, fires};
use super::closed::closed;
use super::conjunctions::PartialConjunction;
use super::firing::fire_row_by_any;
use super::{Action, Arrays, Buffers, ClosedForm, Output, Scratch, Table, clamp, value_in_row};

impl Table<'_> {
    /// Returns the index of the rule that raises an output most, without allocating. Among the rules that fire, it is
    /// the one with the largest `strength (alone - (low + value) / 2)`; among equal rules it is the first. `value` is
    /// the value of the output, `alone` its value if only this rule fired, and `low` the lower end of its range. `None`
    /// if no rule fires.
    ///
    /// The comparison is with the midpoint between `low` and the value, rather than with the value, so that the
    /// strongest of several rules with the same conclusion is selected.
    ///
    /// Afterwards the scratch memory contains the degrees of the literals.
    pub fn raised_by(
        &self,
        scratch: &mut Scratch<'_>,
        inputs: &[f64],
        output: usize,
        value: f64,
    ) -> Option<usize> {
        raised_by(
            self,
            &mut scratch.rows(),
            inputs,
            (output, value),
            |_, _| None,
        )
    }
}

/// Implements [`Table::raised_by`], with `integrate` as in [`evaluate`](super::evaluate).
pub(crate) fn raised_by<A, N, P, S>(
    table: &A,
    scratch: &mut Buffers<N, P, S>,
    inputs: &[f64],
    (output, value): (usize, f64),
    mut integrate: impl FnMut(usize, &[f64]) -> Option<f64>,
) -> Option<usize>
where
    A: Arrays,
    N: DerefMut<Target = [[f64; 1]]>,
    P: DerefMut<Target = [PartialConjunction]>,
    S: DerefMut<Target = [StrongestRule]>,
{
    let middle = 0.5 * (table.outputs().get(output)?.low + value);
    let score = |alone: f64| alone - middle;
    most(table, scratch, inputs, (output, &score), &mut integrate)
}

/// Returns the index of the rule that contributes most to a degree of an output. Among the rules that fire, it is the
/// one with the largest `strength degree(alone)`, where `alone` is the value of the output if only this rule fired.
/// If that product is 0 for all rules, it is the strongest rule.
pub(crate) fn concluded_by<A, N, P, S>(
    table: &A,
    scratch: &mut Buffers<N, P, S>,
    inputs: &[f64],
    (output, degree): (usize, impl Fn(f64) -> f64),
    mut integrate: impl FnMut(usize, &[f64]) -> Option<f64>,
) -> Option<usize>
where
    A: Arrays,
    N: DerefMut<Target = [[f64; 1]]>,
    P: DerefMut<Target = [PartialConjunction]>,
    S: DerefMut<Target = [StrongestRule]>,
{
    const NOT_AT_ALL: f64 = 1e-9;
    let score = |alone: f64| degree(alone).max(NOT_AT_ALL);
    most(table, scratch, inputs, (output, &score), &mut integrate)
}

/// Returns the index of the rule with the largest product of its firing strength and `score(alone)`, where `alone` is
/// the value of the output if only this rule fired.
fn most<A, N, P, S>(
    table: &A,
    scratch: &mut Buffers<N, P, S>,
    inputs: &[f64],
    (output, score): (usize, &dyn Fn(f64) -> f64),
    integrate: &mut dyn FnMut(usize, &[f64]) -> Option<f64>,
) -> Option<usize>
where
    A: Arrays,
    N: DerefMut<Target = [[f64; 1]]>,
    P: DerefMut<Target = [PartialConjunction]>,
    S: DerefMut<Target = [StrongestRule]>,
{
    let inputs = inputs.as_chunks().0.iter().copied();
    let input_flags = clamp(table, inputs, &mut scratch.values);
    if input_flags.infinite != [0] {
        return None;
    }
    let of: &Output = table.outputs().get(output)?;
    let (search, strengths, _) = scratch.split();
    let (values, first) = (search.values(), of.first_strength);
    let strengths = strengths.get_mut(first as usize..of.end_strength as usize)?;
    strengths.fill([0.0]);
    let score = |strength: u32| {
        // In a damaged table the firing strength may belong to a different output.
        let index = strength.checked_sub(first)? as usize;
        *strengths.get_mut(index)? = [1.0];
        let mut value = [f64::NAN];
        // No memory for the bases of layers is available, because the firing rules use it.
        let alone = if of.form() == ClosedForm::Layers {
            let set = table.layered_sets().get(of.first as usize)?;
            Some(of.centroid(set.of_single_term(table, index as u32)))
        } else if closed(table, of, strengths, &mut [], values, &mut value) {
            Some(value[0])
        } else {
            value_in_row(table, output, of, strengths.as_flattened(), &mut *integrate)
        };
        *strengths.get_mut(index)? = [0.0];
        alone.filter(|value| !value.is_nan()).map(score)
    };
    let mut largest = LargestIncrease {
        least: table.least_strength(),
        output: output as u32,
        score,
        most: None,
    };
    fire_row_by_any(table, search, &mut largest);
    largest.most.map(|(_, rule)| rule as usize)
}

/// A consumer of the firing rules, which records the rule that raises an output most.
struct LargestIncrease<F> {
    least: f64,
    output: u32,
    /// The score of the value that the output has if only the firing strength with this index is 1 and all others are
    /// 0.
    score: F,
    /// The largest increase so far, and the rule that causes it.
    most: Option<(f64, u32)>,
}

impl<F: FnMut(u32) -> Option<f64>> FiringConsumer<1> for LargestIncrease<F> {
    fn act(&mut self, actions: &[Action], _row: usize, degree: f64) {
        for action in actions {
            let strength = fires(action.weight * degree, self.least);
            self.act_with(core::slice::from_ref(action), |_| strength);
        }
    }

    fn act_with(&mut self, actions: &[Action], strength: impl Fn(usize) -> f64) {
        let strength = strength(0);
        for action in actions.iter().filter(|action| action.output == self.output) {
            if strength > 0.0
                && let Some(score) = (self.score)(action.strength)
            {
                let raises = strength * score;
                // The result does not depend on the order in which rules fire.
                let is_more = |(most, rule): (f64, u32)| {
                    raises > most || raises == most && action.rule < rule
                };
                if self.most.is_none_or(is_more) {
                    self.most = Some((raises, action.rule));
                }
            }
        }
    }
}
