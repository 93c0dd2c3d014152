//! A compiled rule set as plain arrays. Evaluating it needs neither an allocator nor a standard library.
//!
//! An [`Engine`](crate::Engine) owns such arrays. Exported as `static` data they are the same table on board, and give the
//! same bits. Indices into an array are absolute. Structures have the layout of C.
//!
//! A table is made by compiling a model, not by hand: its arrays index into one another. [`Table::check`] verifies the
//! indices.

use core::ops::DerefMut;

mod activation;
mod arrays;
mod blocks;
mod check;
mod closed;
mod firing;
pub(crate) mod flank;
mod input;
pub(crate) mod numeric;
pub(crate) mod operators;
mod outcome;
mod raising;
mod rules;
pub(crate) mod set;

pub use activation::{Activation, Comparison, LEAST_STRENGTH};
pub(crate) use arrays::{Arrays, arrays_from_fields};
pub use arrays::{Table, arrays};
pub use blocks::{Block, Method};
pub use check::Damaged;
pub use closed::{ClosedForm, Coefficient, Consequent, Moment, Pair};
pub(crate) use closed::{centroid, finite};
pub use firing::{Partial, Strongest};
pub use flank::{Flank, Knot};
#[cfg(test)]
pub(crate) use input::degrees;
pub use input::{Curve, Input, Line, Point};
pub use operators::{Aggregation, Conjunction, Disjunction, Hedge, Implication};
pub use outcome::{Outcome, State};
pub use rules::{Action, Axis, Dimension, Edge, Node, Op, Program, Step};
pub use set::{FuzzySet, Section, SetDefuzzifier, SetTerm, Strand};

pub use crate::shape::Kind;

use closed::closed;
use firing::fire;
use operators::{larger, smaller};
pub(crate) use raising::{concluded_by, raised_by};

/// How the rules that are plain ANDs of terms of different inputs are found.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Conjunctions {
    /// A table with a cell for each combination of terms. On each axis exactly two terms are read.
    Uniform {
        /// The number of actions of each cell.
        actions_a_cell: u32,
        /// The index of the first action of the first cell.
        first_action: u32,
        /// Whether any action sums firing strengths.
        sums: bool,
    },
    /// A table with a cell for each combination of terms.
    Dense,
    /// A trie whose paths are the terms of rules.
    #[default]
    Trie,
}

/// The sizes of the scratch memory that an evaluation needs.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
#[repr(C)]
pub struct Sizes {
    /// The number of literals; 0 where no rule reads their degrees by index.
    pub degrees: u32,
    /// The most terms of an input with a degree over 0 at once, and two more.
    pub alive: u32,
    /// The most cells or edges held at once.
    pub partial: u32,
    /// The depth of the deepest program.
    pub stack: u32,
    /// The number of firing strengths of all outputs, and one that belongs to no output.
    pub strengths: u32,
}

/// An output: its range, and how firing strengths become a number.
#[doc(hidden)] // Exported data.
#[derive(Debug, Clone, Copy, PartialEq)]
#[repr(C)]
pub struct Output {
    /// The lower end of its range.
    pub low: f64,
    /// The upper end of its range.
    pub high: f64,
    /// The value where no rule fires; NaN where the output is undefined there.
    pub default_value: f64,
    /// The closed form of its defuzzifier.
    pub form: ClosedForm,
    /// Its span in the array of that form.
    pub first: u32,
    /// The end of that span.
    pub end: u32,
    /// Its span in the firing strengths.
    pub first_strength: u32,
    /// The end of that span.
    pub end_strength: u32,
    /// 1 where a value outside the range is clamped to it, which only Takagi-Sugeno outputs can have; else 0.
    pub clamps: u32,
}

/// The memory an evaluation works in, of the [`Sizes`] of the table: slices or vectors of numbers, partial conjunctions
/// and strongest rules.
#[derive(Debug, Clone)]
pub struct Buffers<N, P, S> {
    /// One for each input.
    pub values: N,
    /// [`Sizes::degrees`].
    pub degrees: N,
    /// [`Sizes::alive`].
    pub alive: P,
    /// [`Sizes::partial`].
    pub partial: P,
    /// [`Sizes::partial`].
    pub next: P,
    /// [`Sizes::stack`].
    pub stack: N,
    /// [`Sizes::strengths`].
    pub strengths: N,
    /// One for each output.
    pub strongest: S,
}

/// The memory of the caller that an evaluation works in.
pub type Scratch<'m> = Buffers<&'m mut [f64], &'m mut [Partial], &'m mut [Strongest]>;

impl Output {
    /// The value, clamped to the range where the author says so.
    #[inline(always)]
    fn clamped(&self, value: f64) -> f64 {
        match self.clamps {
            0 => value,
            _ => larger(self.low, smaller(self.high, value)),
        }
    }

    /// The middle of the range. Moments are measured from there, against cancellation.
    #[inline(always)]
    pub(crate) fn origin(&self) -> f64 {
        self.low + 0.5 * (self.high - self.low)
    }
}

impl Table<'_> {
    /// Evaluates one value for each input into one outcome for each output. It does not allocate, and does not panic where
    /// [`Table::check`] passes and the scratch memory has the sizes of the table.
    ///
    /// A value outside its input's range is clamped to the range, and the outcome says so. A value that is NaN or
    /// infinite makes every outcome [`State::InputNotFinite`].
    ///
    /// # Example: a fan's speed from the temperature
    /// ```
    /// use fuzzy::{Engine, model::{Model, Output, MembershipFunction, Variable}, rule};
    /// use fuzzy::table::{Outcome, Partial, Scratch, Strongest};
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
    ///     alive: &mut vec![Partial::NONE; sizes.alive as usize],
    ///     partial: &mut vec![Partial::NONE; sizes.partial as usize],
    ///     next: &mut vec![Partial::NONE; sizes.partial as usize],
    ///     stack: &mut vec![0.0; sizes.stack as usize],
    ///     strengths: &mut vec![0.0; sizes.strengths as usize],
    ///     strongest: &mut [Strongest::NONE],
    /// };
    /// let mut outcomes = [Outcome::UNDEFINED];
    /// table.evaluate(&mut scratch, &[27.5], &mut outcomes);
    /// assert_eq!(outcomes[..], engine.evaluate(&[27.5])?);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn evaluate(&self, scratch: &mut Scratch<'_>, inputs: &[f64], outcomes: &mut [Outcome]) {
        evaluate(self, scratch, inputs, outcomes, |_, _| None);
    }
}

/// [`Table::evaluate`], with `integrate` giving the value of an output without a closed form from its index and its firing
/// strengths.
#[inline(always)]
pub(crate) fn evaluate<A, N, P, S>(
    table: &A,
    scratch: &mut Buffers<N, P, S>,
    inputs: &[f64],
    outcomes: &mut [Outcome],
    mut integrate: impl FnMut(usize, &[f64]) -> Option<f64>,
) where
    A: Arrays,
    N: DerefMut<Target = [f64]>,
    P: DerefMut<Target = [Partial]>,
    S: DerefMut<Target = [Strongest]>,
{
    let Some(clamped) = clamp(table, inputs, &mut scratch.values) else {
        outcomes.fill(Outcome {
            state: State::InputNotFinite,
            ..Outcome::default()
        });
        return;
    };
    fire(table, scratch);
    for (index, (output, outcome)) in table.outputs().iter().zip(outcomes).enumerate() {
        let (coverage, dominant) = scratch.strongest[index].rule();
        *outcome = Outcome {
            state: state(table, index, output, coverage, scratch, &mut integrate),
            coverage,
            dominant,
            clamped,
        };
    }
}

/// Clamps each value to the range of its input, and returns whether any was outside; `None` where one is not finite.
#[inline(always)]
fn clamp<A: Arrays>(table: &A, inputs: &[f64], clamped: &mut [f64]) -> Option<bool> {
    let mut any = false;
    for ((&value, input), clamped) in inputs.iter().zip(table.inputs()).zip(clamped) {
        if !value.is_finite() {
            return None;
        }
        *clamped = larger(input.low, smaller(input.high, value));
        any |= *clamped != value;
    }
    Some(any)
}

#[inline(always)]
fn state<A: Arrays, N: DerefMut<Target = [f64]>, P, S>(
    table: &A,
    index: usize,
    output: &Output,
    strongest: f64,
    scratch: &Buffers<N, P, S>,
    integrate: &mut impl FnMut(usize, &[f64]) -> Option<f64>,
) -> State {
    if strongest > 0.0 {
        let range = output.first_strength as usize..output.end_strength as usize;
        let strengths = &scratch.strengths[range];
        let value = match output.form {
            ClosedForm::NONE => integrate(index, strengths),
            _ => closed(table, output, strengths, &scratch.values),
        };
        if let Some(value) = value {
            return State::Defined(value);
        }
    }
    if output.default_value.is_nan() {
        State::NoRuleFired
    } else {
        State::Default(output.default_value)
    }
}
