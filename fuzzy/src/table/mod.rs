//! A compiled rule set as plain arrays. Evaluating it needs neither an allocator nor the standard library.
//!
//! An [`Engine`](crate::Engine) owns such arrays. Exported as `static` data, they form the same table on board and give
//! bitwise the same results. Indices into an array are absolute. Structs have the memory layout of C.
//!
//! A table is compiled from a model, not written by hand: its arrays contain indices into one another. [`Table::check`]
//! verifies these indices.
//!
//! # A worked example: three triangles, two rules, and their arrays
//! ```
//! use fuzzy::table::ClosedForm;
//!
//! let model: fuzzy::Model = "
//! fuzzy: 1
//! name: fan
//! inputs: {heat: {range: [0, 10], partition: [low, medium, high]}}
//! outputs: {speed: {range: [0, 10], partition: [slow, medium, fast]}}
//! rules: [IF heat IS low THEN speed IS slow, IF heat IS high THEN speed IS fast]
//! ".parse()?;
//! let engine = fuzzy::Engine::new(&model)?;
//! let table = engine.table().ok_or("the model chains")?;
//!
//! // Rules read two terms, `low` and `high`: literals 0 and 1. The terms bend at 5 and 10; infinity is padding.
//! assert_eq!(table.cuts, [5.0, 10.0, f64::INFINITY, f64::INFINITY]);
//! // Each interval between cuts has two lines. Below 5, `low` has the degree base + rise (x - foot) / run.
//! let low = table.lines[0];
//! assert_eq!((low.literal, low.base, low.rise, low.foot, low.run), (0, 0.0, 1.0, 5.0, -5.0));
//!
//! // A cell for each literal, with the rule and the firing strength that it raises: 0 of `slow`, 2 of `fast`.
//! let actions = table.actions.iter().map(|action| (action.rule, action.strength));
//! assert_eq!(actions.collect::<Vec<_>>(), [(0, 0), (1, 2)]);
//!
//! // The output's terms sum to 1, so the centroid has a closed form: two terms in each pair. `slow` cut at h has the area
//! // 5 h - 2.5 h^2, `medium` 10 h - 5 h^2, less an overlap of width 5 where both fire.
//! assert_eq!(table.outputs[0].form(), ClosedForm::Partition);
//! assert_eq!(table.pairs[0].area, [[5.0, 10.0], [-2.5, -5.0]]);
//! assert_eq!(table.pairs[0].width, [5.0, 5.0]);
//!
//! // A heat of 8 has the degree 0.6 in `high`, so `fast` is cut at 0.6: its area is 2.1, its moment about the middle 6.6.
//! assert_eq!(engine.evaluate(&[8.0])?[0].value(), Some(5.0 + 6.6 / 2.1));
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! # Terminology
//!
//! | term in this module | meaning in the literature |
//! |---|---|
//! | literal | a proposition "input is term", with its hedges |
//! | alive | a literal whose support contains the value |
//! | partial | the conjunction of the first literals of an antecedent, while it is above 0 |
//! | action | a consequent: the rule, its weight, and the firing strength that it raises |
//! | flank | a part of a membership function that only rises or only falls; its tail is the integral from its foot |
//! | knot | a node of the tabulated integral of a curved flank |
//! | section, strand | a part of the output's range on which terms keep their order; a flank on it |
//! | layer, base | the part of a set between two alpha-levels; the lower of the two levels |

use core::ops::DerefMut;

mod actions;
mod activation;
mod arrays;
mod blocks;
pub(crate) mod chain;
mod check;
mod closed;
pub(crate) mod closed_reduction;
mod conjunctions;
mod firing;
pub(crate) mod flank;
mod input;
mod layers;
pub(crate) mod numeric;
pub(crate) mod operators;
mod outcome;
mod raising;
pub(crate) mod reduction;
pub(crate) mod results;
mod rules;
pub(crate) mod set;

pub use actions::StrongestRule;
pub use activation::{Activation, Comparison, MIN_STRENGTH};
pub(crate) use arrays::{Arrays, arrays_from_fields};
pub use arrays::{Table, arrays};
pub use blocks::{Block, Method};
pub use chain::{Chain, Ends, Stage, StageIndices, StageRuleCriterion, Values};
pub use check::DamagedArray;
pub use closed::{ClosedForm, Coefficient, Consequent, Moment, Pair};
pub(crate) use closed::{centroid, finite};
pub use conjunctions::PartialConjunction;
pub use flank::{Flank, Knot};
#[cfg(test)]
pub(crate) use input::degrees_in_rows;
pub use input::{Curve, Input, Line, Point};
pub use layers::{Base, LayeredSet, Layers};
pub use operators::{Aggregation, Conjunction, Disjunction, Hedge, Implication};
pub use outcome::{Outcome, State};
pub use reduction::TypeReduction;
pub use rules::{Action, AntecedentStep, Axis, Dimension, Edge, Node, Op, Program};
pub use set::{FuzzySet, OfMaxima, Section, SetDefuzzifier, SetTerm, Strand};

pub use crate::shape::ShapeKind;

use crate::rows::{each, set};
use closed::{closed, closed_outlined, partition};
pub(crate) use closed::{number, value_in_row};
pub(crate) use firing::{fire, fire_row, has_cells_alone};
use operators::{larger, smaller};
pub(crate) use raising::{concluded_by, raised_by};
use results::InputFlags;
pub(crate) use results::Results;

/// The data structure that finds the firing rules among those that are plain ANDs of terms of
/// different inputs.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Conjunctions {
    /// A table with a cell for each combination of terms. On each axis exactly two terms are evaluated.
    Uniform {
        /// The number of actions of each cell.
        actions_per_cell: u32,
        /// The index of the first action of the first cell.
        first_action: u32,
        /// Whether any action sums firing strengths.
        sums: bool,
    },
    /// A table with a cell for each combination of terms.
    Dense,
    /// A trie whose paths are the terms of the rules.
    #[default]
    Trie,
}

/// The sizes of the scratch memory that an evaluation needs.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
#[repr(C)]
pub struct Sizes {
    /// The number of literals; 0 if no rule reads their degrees by index.
    pub degrees: u32,
    /// The maximum number of terms of an input that can have a degree above 0 at the same value, plus two.
    pub alive: u32,
    /// The maximum number of cells or edges that are stored at the same time.
    pub partial: u32,
    /// The larger of two numbers: the depth of the deepest program, and one more than the number of bases of the
    /// largest layered set.
    pub stack: u32,
    /// The number of firing strengths of all outputs, plus one that no output uses.
    pub strengths: u32,
}

/// An output: its range, and the method that reduces its firing strengths to a number.
#[doc(hidden)] // Exported data.
#[derive(Debug, Clone, Copy, PartialEq)]
#[repr(C)]
pub struct Output {
    /// The lower end of the range.
    pub low: f64,
    /// The upper end of the range.
    pub high: f64,
    /// The value if no rule fires; NaN if the output is then undefined.
    pub default_value: f64,
    /// The code of the output's [closed form](Output::form).
    pub form: u32,
    /// The index of the first element in the array of that form.
    pub first: u32,
    /// The index after the last element in that array.
    pub end: u32,
    /// The index of the first firing strength.
    pub first_strength: u32,
    /// The index after the last firing strength.
    pub end_strength: u32,
    /// 1 if a value outside the range is clamped to it, else 0. Only Takagi-Sugeno and Tsukamoto outputs can
    /// leave their range.
    pub clamps: u32,
    /// The code of the [`TypeReduction`]: 1 plus the index in [`TypeReduction::ALL`]. 0 if the value is not an interval,
    /// [`LOWER_BOUNDS`] if the output has only the lower bounds of the firing strengths of another output.
    pub reduction: u32,
    /// The index of the output with the lower bounds of the firing strengths, if the value is an interval.
    pub lower: u32,
}

/// The code of an output that has only the lower bounds of the firing strengths of another output. Such outputs come
/// after all others and have no outcomes.
#[doc(hidden)] // Exported data.
pub const LOWER_BOUNDS: u32 = u32::MAX;

/// The working memory of an evaluation, with the [`Sizes`] of the table: slices or vectors of numbers, partial
/// conjunctions and strongest rules.
#[derive(Debug, Clone)]
pub struct Buffers<N, P, S> {
    /// One element per input.
    pub values: N,
    /// [`Sizes::degrees`] elements.
    pub degrees: N,
    /// [`Sizes::alive`] elements.
    pub alive: P,
    /// [`Sizes::partial`] elements.
    pub partial: P,
    /// [`Sizes::partial`] elements.
    pub next: P,
    /// [`Sizes::stack`] elements.
    pub stack: N,
    /// [`Sizes::strengths`] elements.
    pub strengths: N,
    /// One element per output, including outputs without outcomes.
    pub strongest: S,
}

/// Working memory that is borrowed from the caller.
pub type Scratch<'m> =
    Buffers<&'m mut [f64], &'m mut [PartialConjunction], &'m mut [StrongestRule]>;

impl Output {
    /// Returns the method that computes the value of the output.
    #[inline(always)]
    pub fn form(&self) -> ClosedForm {
        ClosedForm::from_code(self.form)
    }

    /// Returns the value, clamped to the range if [`Output::clamps`] is set.
    #[inline(always)]
    fn clamped(&self, value: f64) -> f64 {
        match self.clamps {
            0 => value,
            _ => larger(self.low, smaller(self.high, value)),
        }
    }

    /// Returns the middle of the range. Moments are relative to it, to avoid cancellation.
    #[inline(always)]
    pub(crate) fn origin(&self) -> f64 {
        self.low + 0.5 * (self.high - self.low)
    }
}

impl Table<'_> {
    /// Returns the number of outcomes: all outputs except those that have only lower bounds of firing strengths.
    pub const fn outcomes(&self) -> usize {
        let (mut count, mut i) = (0, 0);
        while i < self.outputs.len() {
            if self.outputs[i].reduction != LOWER_BOUNDS {
                count += 1;
            }
            i += 1;
        }
        count
    }

    /// Evaluates one value per input into the [outcomes](Table::outcomes), one per output. It does not allocate. It does
    /// not panic if [`Table::check`] succeeds and the scratch memory has the sizes of the table.
    ///
    /// A value outside the range of its input is clamped to it; the outcome reports that. If a value is NaN or
    /// infinite, every outcome is [`State::InputNotFinite`].
    ///
    /// # Example: the speed of a fan as a function of temperature
    /// ```
    /// use fuzzy::{Engine, model::{Model, Output, MembershipFunction, Variable}, rule};
    /// use fuzzy::table::{Outcome, PartialConjunction, Scratch, StrongestRule};
    ///
    /// let model = Model::builder("fan")
    ///     .input(Variable::new("temperature", 0.0, 40.0).term("hot", MembershipFunction::RightShoulder { foot: 20.0, top: 30.0 }))
    ///     .output(Output::new(Variable::new("speed", 0.0, 100.0).term("fast", MembershipFunction::RightShoulder { foot: 50.0, top: 100.0 })))
    ///     .rule(rule::parse("IF temperature IS hot THEN speed IS fast")?)
    ///     .build();
    /// let engine = Engine::new(&model)?;
    /// let table = engine.table().ok_or("the model chains")?;
    /// let sizes = table.sizes;
    /// let mut scratch = Scratch {
    ///     values: &mut [0.0],
    ///     degrees: &mut vec![0.0; sizes.degrees as usize],
    ///     alive: &mut vec![PartialConjunction::NONE; sizes.alive as usize],
    ///     partial: &mut vec![PartialConjunction::NONE; sizes.partial as usize],
    ///     next: &mut vec![PartialConjunction::NONE; sizes.partial as usize],
    ///     stack: &mut vec![0.0; sizes.stack as usize],
    ///     strengths: &mut vec![0.0; sizes.strengths as usize],
    ///     strongest: &mut [StrongestRule::NONE],
    /// };
    /// let mut outcomes = [Outcome::UNDEFINED];
    /// table.evaluate(&mut scratch, &[27.5], &mut outcomes);
    /// assert_eq!(outcomes[..], engine.evaluate(&[27.5])?[..]);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn evaluate(&self, scratch: &mut Scratch<'_>, inputs: &[f64], outcomes: &mut [Outcome]) {
        evaluate_row(
            self,
            &mut scratch.rows(),
            inputs,
            outcomes,
            fire_row,
            |_, _| None,
        );
    }
}

impl Scratch<'_> {
    /// Returns the same memory as rows of one number each.
    #[inline(always)]
    pub(crate) fn rows(
        &mut self,
    ) -> Buffers<&mut [[f64; 1]], &mut [PartialConjunction], &mut [StrongestRule]> {
        Buffers {
            values: self.values.as_chunks_mut().0,
            degrees: self.degrees.as_chunks_mut().0,
            alive: &mut *self.alive,
            partial: &mut *self.partial,
            next: &mut *self.next,
            stack: self.stack.as_chunks_mut().0,
            strengths: self.strengths.as_chunks_mut().0,
            strongest: &mut *self.strongest,
        }
    }
}

/// Implements [`Table::evaluate`]. `integrate` returns the value of an output without a closed form, given its index
/// and its firing strengths. `fire` fires the rules, as [`fire_row`] does.
#[inline(always)]
pub(crate) fn evaluate_row<A, N, P, S>(
    table: &A,
    scratch: &mut Buffers<N, P, S>,
    inputs: &[f64],
    outcomes: &mut [Outcome],
    fire: impl FnOnce(&A, &mut Buffers<N, P, S>),
    mut integrate: impl FnMut(usize, &[f64]) -> Option<f64>,
) where
    A: Arrays,
    N: DerefMut<Target = [[f64; 1]]>,
    P: DerefMut<Target = [PartialConjunction]>,
    S: DerefMut<Target = [StrongestRule]>,
{
    let inputs = inputs.as_chunks().0.iter().copied();
    let input_flags = clamp(table, inputs, &mut scratch.values);
    fire(table, scratch);
    let mut in_row = |index: usize, output: &Output, _, strengths: &[[f64; 1]]| {
        let strengths = strengths.as_flattened();
        value_in_row(table, index, output, strengths, &mut integrate)
    };
    let mut results = Results::NONE;
    for (index, outcome) in (0..table.outputs().len()).zip(outcomes) {
        fill(
            table,
            scratch,
            (index, input_flags),
            &mut in_row,
            &mut results,
        );
        *outcome = results.outcome(0);
        let output = &table.outputs()[index];
        if output.reduction != 0 && matches!(outcome.state, State::Defined(_)) {
            let given = (&scratch.values[..], &scratch.strengths[..]);
            let state = reduction::reduced(table, output, given, &mut scratch.stack);
            outcome.state = state.unwrap_or(outcome.state);
        }
    }
}

/// Evaluates `L` rows of input values into the results of each output; the table must not have blocks. `in_row`
/// returns the value in one row of an output that [`closed`] does not support, given its index, the row and the
/// firing strengths of all rows.
#[inline(always)]
pub(crate) fn evaluate_rows<A, N, P, S, const L: usize, const CELLS: bool>(
    table: &A,
    scratch: &mut Buffers<N, P, S>,
    inputs: impl Iterator<Item = [f64; L]>,
    mut in_row: impl FnMut(usize, &Output, usize, &[[f64; L]]) -> Option<f64>,
    results: &mut [Results<L>],
) where
    A: Arrays,
    N: DerefMut<Target = [[f64; L]]>,
    P: DerefMut<Target = [PartialConjunction<L>]>,
    S: DerefMut<Target = [StrongestRule<L>]>,
{
    let input_flags = clamp(table, inputs, &mut scratch.values);
    fire::<_, _, _, _, L, CELLS>(table, scratch);
    for (index, results) in (0..table.outputs().len()).zip(results) {
        fill(table, scratch, (index, input_flags), &mut in_row, results);
    }
}

/// Clamps each value to the range of its input, including values that are not finite.
#[inline(always)]
pub(crate) fn clamp<A: Arrays, const L: usize>(
    table: &A,
    inputs: impl Iterator<Item = [f64; L]>,
    values: &mut [[f64; L]],
) -> InputFlags<L> {
    let mut input_flags = InputFlags {
        clamped: [0; L],
        infinite: [0; L],
    };
    for ((input, inside), values) in table.inputs().iter().zip(values).zip(inputs) {
        let nearest = each(|row| larger(smaller(values[row], input.high), input.low));
        for row in 0..L {
            input_flags.clamped[row] |= u64::from(nearest[row] != values[row]);
        }
        // The loop above flags every value that is not finite as clamped. Clamping is rare, so this check is usually
        // skipped.
        if input_flags.clamped.iter().fold(0, |any, one| any | one) != 0 {
            for (infinite, value) in input_flags.infinite.iter_mut().zip(&values) {
                *infinite |= u64::from(!value.is_finite());
            }
        }
        *inside = nearest;
    }
    input_flags
}

/// Writes the results of an output after the rules have fired.
#[inline(always)]
fn fill<A, N, P, S, const L: usize>(
    table: &A,
    scratch: &mut Buffers<N, P, S>,
    (index, input_flags): (usize, InputFlags<L>),
    in_row: &mut impl FnMut(usize, &Output, usize, &[[f64; L]]) -> Option<f64>,
    results: &mut Results<L>,
) where
    A: Arrays,
    N: DerefMut<Target = [[f64; L]]>,
    S: DerefMut<Target = [StrongestRule<L>]>,
{
    let output = &table.outputs()[index];
    let StrongestRule { strength, rule } = &scratch.strongest[index];
    let strengths = output.first_strength as usize..output.end_strength as usize;
    let strengths = &scratch.strengths[strengths];
    let (inputs, values) = (&scratch.values, &mut results.values);
    let bases = &mut scratch.stack;
    let is_known = if output.form() == ClosedForm::Partition {
        partition(table, output, strengths, values, Pair::cut);
        true
    } else if L == 1 {
        closed_outlined(table, output, strengths, bases, inputs, values)
    } else {
        closed(table, output, strengths, bases, inputs, values)
    };
    if !is_known {
        set(values, |row| {
            let fires = strength[row] > 0.0;
            let value = fires.then(|| in_row(index, output, row, strengths));
            value.flatten().unwrap_or(f64::NAN)
        });
    }
    results.default_values.fill(output.default_value);
    results.coverage = *strength;
    results.rules = *rule;
    results.input_flags = input_flags;
}
