//! A compiled rule set as plain arrays, evaluated where there is neither an allocator nor a standard library.
//!
//! An [`Engine`](crate::Engine) owns such arrays and evaluates through them; written out as `static` data they are the
//! same table in firmware, and give the same bits. Numbers that point into an array count from its beginning. Structures
//! have the layout of C, so that a table can also be written in C.
//!
//! A table is made by compiling a model, not by hand: the arrays lean on each other. [`Table::check`] tells whether they do.

use core::ops::DerefMut;

mod check;
mod closed;
mod firing;
mod input;
pub(crate) mod operators;
mod outcome;
mod rules;

pub use check::Broken;
pub(crate) use closed::centroid;
pub use closed::{Coefficient, Consequence, Moment, Pair, Set};
pub use firing::{Partial, Strongest};
#[cfg(test)]
pub(crate) use input::degrees;
pub use input::{Curve, Input, Line};
pub use operators::{Aggregation, Conjunction, Disjunction, Hedge, Implication};
pub use outcome::{Outcome, State};
pub use rules::{Action, Axis, Dimension, Edge, Node, Op, Program, Step};

pub use crate::shape::Kind;

use closed::closed;
use firing::fire;
use operators::{larger, smaller};

/// A compiled rule set. See the [module](self).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Table<'a> {
    /// AND.
    pub and: Conjunction,
    /// OR.
    pub or: Disjunction,
    /// How the rules that are plain ANDs are found.
    pub conjunctions: Conjunctions,
    /// What an evaluation needs to work in.
    pub sizes: Sizes,
    /// The inputs.
    pub inputs: &'a [Input],
    /// Where the intervals of inputs begin.
    pub cuts: &'a [f64],
    /// Where, in the lines, those of each interval begin.
    pub starts: &'a [u32],
    /// Terms of inputs, as straight lines on intervals.
    pub lines: &'a [Line],
    /// Terms of inputs that are curved or hedged.
    pub curves: &'a [Curve],
    /// The corners of curves made of straight lines: `(x, degree)`.
    pub points: &'a [[f64; 2]],
    /// The hedges of curves.
    pub hedges: &'a [Hedge],
    /// The inputs of a uniform table, in its order.
    pub axes: &'a [Axis],
    /// The inputs of a dense table, in its order.
    pub dimensions: &'a [Dimension],
    /// Where, in the actions, those of each cell of a dense table begin, and where the last one's end.
    pub cells: &'a [u32],
    /// The nodes of a trie.
    pub nodes: &'a [Node],
    /// Its edges.
    pub edges: &'a [Edge],
    /// What rules do.
    pub actions: &'a [Action],
    /// The rules that are not plain ANDs.
    pub programs: &'a [Program],
    /// Their steps.
    pub steps: &'a [Step],
    /// The outputs.
    pub outputs: &'a [Output],
    /// Closed forms of partitions.
    pub pairs: &'a [Pair],
    /// Closed forms of sums of products.
    pub moments: &'a [Moment],
    /// Takagi-Sugeno consequents.
    pub consequences: &'a [Consequence],
    /// Their coefficients.
    pub coefficients: &'a [Coefficient],
}

/// How the rules that are plain ANDs of terms of different inputs are found.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Conjunctions {
    /// A cell for each combination of terms, and two terms alive on each axis.
    Uniform {
        /// How many actions each cell has.
        actions_a_cell: u32,
        /// The first of them.
        first_action: u32,
        /// Whether strengths are summed anywhere.
        sums: bool,
    },
    /// A cell for each combination of terms.
    Dense,
    /// Rules as paths of terms.
    #[default]
    Trie,
}

/// What an evaluation needs to work in.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
#[repr(C)]
pub struct Sizes {
    /// The degrees of literals; 0 where they are not needed by their index.
    pub degrees: u32,
    /// The most terms of an input alive at once, and two more.
    pub alive: u32,
    /// The most cells or edges on the way.
    pub partial: u32,
    /// The deepest program.
    pub stack: u32,
    /// The heights of all outputs, and one that belongs to none.
    pub heights: u32,
}

/// An output: its range, and how its heights become a number.
#[derive(Debug, Clone, Copy, PartialEq)]
#[repr(C)]
pub struct Output {
    /// The lower end of its range.
    pub low: f64,
    /// The upper end of its range.
    pub high: f64,
    /// The value where no rule fires; NaN where it is undefined there.
    pub otherwise: f64,
    /// Its closed form.
    pub set: Set,
    /// Where, in the array of that form, its numbers begin ...
    pub first: u32,
    /// ... and end.
    pub end: u32,
    /// Where, in the heights, its own begin ...
    pub first_height: u32,
    /// ... and end.
    pub end_height: u32,
}

/// What an evaluation works in, of the [`Sizes`] of the table: numbers, ANDs on their way and strongest rules, lent as
/// slices or owned as vectors.
#[derive(Debug, Clone)]
pub struct Rooms<N, P, S> {
    /// One for each input.
    pub values: N,
    /// As many as [`Sizes::degrees`].
    pub degrees: N,
    /// As many as [`Sizes::alive`].
    pub alive: P,
    /// As many as [`Sizes::partial`].
    pub partial: P,
    /// As many as [`Sizes::partial`].
    pub next: P,
    /// As many as [`Sizes::stack`].
    pub stack: N,
    /// As many as [`Sizes::heights`].
    pub heights: N,
    /// One for each output.
    pub strongest: S,
}

/// What an evaluation works in: memory of the caller.
pub type Scratch<'m> = Rooms<&'m mut [f64], &'m mut [Partial], &'m mut [Strongest]>;

impl Output {
    /// The middle of the range, from which moments are measured, against cancellation.
    #[inline(always)]
    pub(crate) fn origin(&self) -> f64 {
        self.low + 0.5 * (self.high - self.low)
    }
}

impl Table<'_> {
    /// Evaluates one value for each input into one outcome for each output. A table whose [`check`](Table::check) finds
    /// nothing, with scratch of its sizes, never panics and does not allocate.
    ///
    /// A value outside its input's range is taken as the range's end, and the outcome says so. A value that is NaN or
    /// infinite makes every outcome [`State::InputNotFinite`].
    ///
    /// # Example: the bits of the engine, in memory of one's own
    /// ```
    /// use fuzzy::table::{Outcome, Partial, Scratch, Strongest};
    ///
    /// # let model = fuzzy::yaml::parse(include_str!(concat!(env!("CARGO_MANIFEST_DIR"), "/../rules/flagred-paper.yaml")))?.model;
    /// let engine = fuzzy::Engine::new(&model)?;
    /// let table = engine.table();
    /// let sizes = table.sizes;
    /// let mut scratch = Scratch {
    ///     values: &mut [0.0; 2],
    ///     degrees: &mut vec![0.0; sizes.degrees as usize],
    ///     alive: &mut vec![Partial::NONE; sizes.alive as usize],
    ///     partial: &mut vec![Partial::NONE; sizes.partial as usize],
    ///     next: &mut vec![Partial::NONE; sizes.partial as usize],
    ///     stack: &mut vec![0.0; sizes.stack as usize],
    ///     heights: &mut vec![0.0; sizes.heights as usize],
    ///     strongest: &mut [Strongest::NONE],
    /// };
    /// let mut outcomes = [Outcome::UNDEFINED];
    /// table.evaluate(&mut scratch, &[0.05, 0.2], &mut outcomes);
    /// assert_eq!(outcomes[..], engine.evaluate(&[0.05, 0.2])?);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn evaluate(&self, scratch: &mut Scratch<'_>, inputs: &[f64], outcomes: &mut [Outcome]) {
        evaluate(self, scratch, inputs, outcomes, |_, _, _| None);
    }
}

/// The arrays of a table, one at a time. An engine that lent all of its arrays at once, as a [`Table`], would gather
/// forty numbers for every evaluation, of which most models need a few.
pub(crate) trait Arrays {
    fn and(&self) -> Conjunction;
    fn or(&self) -> Disjunction;
    fn conjunctions(&self) -> Conjunctions;
    fn inputs(&self) -> &[Input];
    fn cuts(&self) -> &[f64];
    fn starts(&self) -> &[u32];
    fn lines(&self) -> &[Line];
    fn curves(&self) -> &[Curve];
    fn points(&self) -> &[[f64; 2]];
    fn hedges(&self) -> &[Hedge];
    fn axes(&self) -> &[Axis];
    fn dimensions(&self) -> &[Dimension];
    fn cells(&self) -> &[u32];
    fn nodes(&self) -> &[Node];
    fn edges(&self) -> &[Edge];
    fn actions(&self) -> &[Action];
    fn programs(&self) -> &[Program];
    fn steps(&self) -> &[Step];
    fn outputs(&self) -> &[Output];
    fn pairs(&self) -> &[Pair];
    fn moments(&self) -> &[Moment];
    fn consequences(&self) -> &[Consequence];
    fn coefficients(&self) -> &[Coefficient];
}

/// [`Arrays`] of a structure that has fields of these names.
macro_rules! arrays_of_fields {
    ($owner:ty) => {
        $crate::table::arrays_of_fields! { @ $owner;
            inputs ($crate::table::Input),
            cuts (f64),
            starts (u32),
            lines ($crate::table::Line),
            curves ($crate::table::Curve),
            points ([f64; 2]),
            hedges ($crate::table::Hedge),
            axes ($crate::table::Axis),
            dimensions ($crate::table::Dimension),
            cells (u32),
            nodes ($crate::table::Node),
            edges ($crate::table::Edge),
            actions ($crate::table::Action),
            programs ($crate::table::Program),
            steps ($crate::table::Step),
            outputs ($crate::table::Output),
            pairs ($crate::table::Pair),
            moments ($crate::table::Moment),
            consequences ($crate::table::Consequence),
            coefficients ($crate::table::Coefficient)
        }
    };
    (@ $owner:ty; $($field:ident ($item:ty)),*) => {
        impl $crate::table::Arrays for $owner {
            #[inline(always)]
            fn and(&self) -> $crate::table::Conjunction {
                self.and
            }
            #[inline(always)]
            fn or(&self) -> $crate::table::Disjunction {
                self.or
            }
            #[inline(always)]
            fn conjunctions(&self) -> $crate::table::Conjunctions {
                self.conjunctions
            }
            $(
                #[inline(always)]
                fn $field(&self) -> &[$item] {
                    &self.$field
                }
            )*
        }
    };
}
pub(crate) use arrays_of_fields;

arrays_of_fields!(Table<'_>);

/// [`Table::evaluate`] where outputs have no closed form: `open` gives the value of such an output by its index,
/// from its heights and the values of the inputs.
#[inline(always)]
pub(crate) fn evaluate<A, N, P, S>(
    table: &A,
    scratch: &mut Rooms<N, P, S>,
    inputs: &[f64],
    outcomes: &mut [Outcome],
    mut open: impl FnMut(usize, &[f64], &[f64]) -> Option<f64>,
) where
    A: Arrays,
    N: DerefMut<Target = [f64]>,
    P: DerefMut<Target = [Partial]>,
    S: DerefMut<Target = [Strongest]>,
{
    let mut clamped = false;
    for ((&value, input), place) in inputs
        .iter()
        .zip(table.inputs())
        .zip(scratch.values.iter_mut())
    {
        if !value.is_finite() {
            outcomes.fill(Outcome {
                state: State::InputNotFinite,
                ..Outcome::default()
            });
            return;
        }
        *place = larger(input.low, smaller(input.high, value));
        clamped |= *place != value;
    }
    fire(table, scratch);
    for (index, (output, outcome)) in table.outputs().iter().zip(outcomes).enumerate() {
        let (coverage, dominant) = scratch.strongest[index].rule();
        *outcome = Outcome {
            state: state(table, index, output, coverage, scratch, &mut open),
            coverage,
            dominant,
            clamped,
        };
    }
}

#[inline(always)]
fn state<A: Arrays, N: DerefMut<Target = [f64]>, P, S>(
    table: &A,
    index: usize,
    output: &Output,
    strongest: f64,
    scratch: &mut Rooms<N, P, S>,
    open: &mut impl FnMut(usize, &[f64], &[f64]) -> Option<f64>,
) -> State {
    if strongest > 0.0 {
        let range = output.first_height as usize..output.end_height as usize;
        let heights = &mut scratch.heights[range];
        if strongest < TINY && output.set.is_fuzzy() {
            for height in heights.iter_mut() {
                *height *= FROM_TINY;
            }
        }
        let value = match output.set {
            Set::OPEN => open(index, heights, &scratch.values),
            _ => closed(table, output, heights, &scratch.values),
        };
        if let Some(value) = value {
            return State::Defined(value);
        }
    }
    if output.otherwise.is_nan() {
        State::NoRuleFired
    } else {
        State::Default(output.otherwise)
    }
}

/// Below this, areas would lose digits to underflow. Where all strengths are so small, only their ratios
/// count: every set is cut so low that its slopes are vertical to the last digit, so all of them can be
/// multiplied by [`FROM_TINY`].
pub(crate) const TINY: f64 = 1e-200;
/// 2^500: multiplying by it rounds nothing.
pub(crate) const FROM_TINY: f64 = 3.273_390_607_896_142e150;
