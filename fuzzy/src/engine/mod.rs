//! The compiled model: immutable, and evaluated without allocation.
//!
//! The steps from a model to an outcome, for the rules `IF heat IS low THEN speed IS slow` and
//! `IF heat IS high THEN speed IS fast`, with three triangles for each variable from 0 to 10:
//!
//! 1. `compile` assigns a number to each proposition: `heat IS low` is literal 0, `heat IS high` is literal 1. Rules become
//!    drafts that contain indices, and each output gets firing strengths: 0 to 2 for `slow`, `medium` and `fast`.
//! 2. `strategy` chooses how the output is computed and how rules fire. Here the output is a partition, and all rules are in
//!    a table with one axis and two cells.
//! 3. `rules` and `arrays` store the result in the arrays of a [`Table`]; its [module](table) shows them for this example.
//! 4. An evaluation at 8 computes the degrees of the two literals (0 and 0.6), sets the firing strengths to (0, 0, 0.6), and
//!    computes the centroid 8.14 in `table/closed.rs`.

use alloc::{boxed::Box, sync::Arc, vec, vec::Vec};
use core::ops::Range;

use smallvec::{SmallVec, smallvec};

use crate::defuzzify::workspace::Workspace;
use crate::defuzzify::{IntegratedSet, Method, Strengths};
use crate::model::{Model, NoRuleFires};
use crate::table::{self, Buffers, PartialConjunction, StrongestRule, Table};
use aligned::AlignedRows;
use arrays::OwnedTable;
use chain::Chain;
use strategy::SingleRowMethod;

mod aligned;
mod arrays;
pub(crate) mod batch;
mod bounds;
mod chain;
mod compile;
mod error;
mod explain;
mod explanation;
mod literal;
mod named;
mod raising;
mod rules;
mod sequence;
mod silent;
mod strategy;
mod uncertain;
#[cfg(feature = "simd")]
mod vectors;
mod what_if;

pub(crate) use crate::table::operators;
pub use crate::table::{Outcome, State};
pub use error::EvaluateError;
pub use explanation::{Degree, ExplainedInput, ExplainedOutput, Explanation, FiredRule, Share};
pub use named::NamedOutcomes;
pub use raising::AntecedentProposition;
pub use sequence::Sequence;
pub use silent::{Silence, SilentRule};
pub use uncertain::{Enclosure, Interval, IntervalOutcome};
pub use what_if::{Change, Effect};

/// A compiled model. It is immutable and can be shared by any number of threads.
///
/// # Example: compile a model and evaluate it
/// ```
/// use fuzzy::{Engine, Model};
///
/// let model: Model = "
/// fuzzy: 1
/// name: fan
/// inputs: {heat: {range: [0, 40], partition: [low, high]}}
/// outputs: {speed: {range: [0, 9], partition: [slow, fast]}}
/// rules: [IF heat IS low THEN speed IS slow, IF heat IS high THEN speed IS fast]
/// ".parse()?;
/// let engine = Engine::new(&model)?;
/// let speed = engine.evaluate(&[30.0])?[0];
/// assert!(speed.value() > Some(4.5));
/// assert_eq!(speed.dominant_rule, Some(1)); // the second rule
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug, Clone)]
pub struct Engine {
    /// The model that the engine was compiled from.
    model: Arc<Model>,
    inputs: Vec<Input>,
    outputs: Vec<NamedOutput>,
    /// The outputs that read no other output: all outputs, unless the model has chains.
    first: Stage,
    /// The remaining outputs, which are evaluated after the outputs that they read.
    chain: Option<Box<Chain>>,
}

/// The outcomes of an evaluation, one per output in the order of the model; up to 8 are stored without allocation.
pub type Outcomes = SmallVec<[Outcome; 8]>;

/// Outputs that are evaluated in one pass.
#[derive(Debug, Clone)]
struct Stage {
    outputs: Vec<CompiledOutput>,
    /// The compiled rules and outputs.
    arrays: OwnedTable,
    /// The same rules, compiled to programs; only if that makes a batch faster.
    batch: Option<OwnedTable>,
    /// The method that fires the rules for a single row.
    single: SingleRowMethod,
}

#[derive(Debug, Clone)]
struct Input {
    name: Arc<str>,
    low: f64,
    high: f64,
}

#[derive(Debug, Clone)]
struct NamedOutput {
    name: Arc<str>,
    /// Whether evaluation returns an error if no rule fires.
    must_fire: bool,
}

#[derive(Debug, Clone)]
struct CompiledOutput {
    low: f64,
    high: f64,
    when_no_rule_fires: NoRuleFires,
    /// The index range of the output's firing strengths.
    strengths: Range<usize>,
    /// The offset of each term's firing strengths within `strengths`, followed by the end of the last term's firing
    /// strengths.
    offsets: Vec<usize>,
    /// Whether values outside the output's range are clamped to it.
    clamps: bool,
    method: Method,
}

/// The working memory of an evaluation, created by [`Engine::scratch`] and then reused.
#[derive(Debug, Clone)]
pub struct Scratch {
    first: StageScratch,
    /// The memory of the later stages, if the model has chains.
    later: Vec<StageScratch>,
    /// The values of the inputs, then of the outputs that a later stage reads.
    values: Vec<f64>,
    /// The outcomes of one stage, if the model has chains.
    own: Vec<Outcome>,
    /// The outcomes of all outputs of the model, used to search for a rule.
    outcomes: Vec<Outcome>,
    /// The number of the stage that was examined in the latest search for a rule.
    requested: usize,
}

#[derive(Debug, Clone)]
struct StageScratch<const L: usize = 1> {
    table: RowBuffers<L>,
    /// Memory for outputs without a closed form.
    workspace: Workspace,
}

#[cfg(feature = "check")]
impl Scratch {
    /// Limits the steps of further integrations. Integrations that need more steps end early, and their values are
    /// invalid.
    pub(crate) fn bound_steps(&mut self, most: u64) {
        for workspace in self.workspaces() {
            workspace.steps = crate::defuzzify::workspace::Steps { taken: 0, most };
        }
    }

    /// Returns the number of integration steps since they were limited, and whether the limit sufficed.
    pub(crate) fn steps(&mut self) -> (u64, bool) {
        let steps = self.workspaces().map(|workspace| workspace.steps);
        steps.fold((0, true), |(sum, enough), steps| {
            let sum = steps.taken.saturating_add(sum);
            (sum, enough && !steps.are_spent())
        })
    }

    fn workspaces(&mut self) -> impl Iterator<Item = &mut Workspace> {
        let stages = core::iter::once(&mut self.first).chain(&mut self.later);
        stages.map(|stage| &mut stage.workspace)
    }
}

type RowBuffers<const L: usize> =
    Buffers<AlignedRows<L>, Vec<PartialConjunction<L>>, Vec<StrongestRule<L>>>;

impl Engine {
    /// Returns the index of an input; `None` if there is no input with the given name.
    pub fn input(&self, name: &str) -> Option<usize> {
        self.inputs.iter().position(|input| &*input.name == name)
    }

    /// Returns the index of an output; `None` if there is no output with the given name.
    pub fn output(&self, name: &str) -> Option<usize> {
        self.outputs.iter().position(|output| &*output.name == name)
    }

    /// Returns the names of the inputs, in the order of their values.
    pub fn input_names(&self) -> impl ExactSizeIterator<Item = &str> {
        self.inputs.iter().map(|input| &*input.name)
    }

    /// Returns the names of the outputs, in the order of their outcomes.
    pub fn output_names(&self) -> impl ExactSizeIterator<Item = &str> {
        self.outputs.iter().map(|output| &*output.name)
    }

    /// Returns the model the engine was compiled from.
    #[must_use]
    pub fn model(&self) -> &Model {
        &self.model
    }

    /// Returns the name and the lower and upper limit of each input.
    pub(crate) fn ranges(&self) -> impl Iterator<Item = (&Arc<str>, f64, f64)> {
        self.inputs.iter().map(|v| (&v.name, v.low, v.high))
    }

    /// Allocates working memory for [`Engine::evaluate_with`]. Each thread needs its own.
    pub fn scratch(&self) -> Scratch {
        let Some(chain) = &self.chain else {
            return Scratch {
                first: self.first.scratch(&self.first.arrays),
                later: Vec::new(),
                values: Vec::new(),
                own: Vec::new(),
                outcomes: Vec::new(),
                requested: 0,
            };
        };
        let later = chain
            .later()
            .iter()
            .map(|later| later.stage.scratch(&later.stage.arrays));
        Scratch {
            first: self.first.scratch(&self.first.arrays),
            later: later.collect(),
            values: vec![0.0; self.inputs.len() + chain.most_reads()],
            own: vec![Outcome::default(); self.outputs.len()],
            outcomes: vec![Outcome::default(); self.outputs.len()],
            requested: 0,
        }
    }

    /// Returns the compiled arrays, which can be evaluated without this engine or written to a file: see [`table`].
    /// `None` if an output [reads](Model::reads) another one, because a table has only one stage. A table cannot
    /// evaluate outputs whose set is [`ClosedForm::Integrated`](table::ClosedForm::Integrated); only the engine can.
    pub fn table(&self) -> Option<Table<'_>> {
        let is_table = self.chain.is_none();
        is_table.then(|| self.first.arrays.table())
    }

    /// Evaluates one value per input, in the order of the model, and returns one outcome per output.
    ///
    /// This allocates working memory, which takes longer than a small evaluation, except for the rule sets that the
    /// feature `simd` evaluates as a plane. In loops use [`Engine::evaluate_with`].
    ///
    /// A value outside the range of its input is clamped to it; the outcome reports that.
    /// If a value is NaN or infinite, every outcome is [`State::InputNotFinite`].
    ///
    /// # Errors
    /// The number of values differs from the number of inputs, or no rule fires for an output with
    /// `when_no_rule_fires: error`.
    ///
    /// # Example: a defined value, an undefined one, and an input outside its range
    /// ```
    /// use fuzzy::{Engine, Model, engine::State};
    ///
    /// let model: Model = "
    /// fuzzy: 1
    /// name: fan
    /// inputs: {heat: {range: [0, 40], terms: {high: {right_shoulder: [20, 30]}}}}
    /// outputs: {speed: {range: [0, 9], partition: [slow, fast]}}
    /// rules: [IF heat IS high THEN speed IS fast]
    /// ".parse()?;
    /// let engine = Engine::new(&model)?;
    /// assert!(matches!(engine.evaluate(&[25.0])?[0].state, State::Defined(_)));
    /// assert_eq!(engine.evaluate(&[15.0])?[0].state, State::NoRuleFired);
    /// assert!(engine.evaluate(&[45.0])?[0].clamped);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn evaluate(&self, inputs: &[f64]) -> Result<Outcomes, EvaluateError> {
        let mut outcomes: Outcomes = smallvec![Outcome::default(); self.outputs.len()];
        self.fits(inputs, &outcomes)?;
        if self.chain.is_some() || !self.first.single.by_plane(inputs, &mut outcomes) {
            self.outcomes(&mut self.scratch(), inputs, &mut outcomes);
        }
        self.must_fire(&outcomes)?;
        Ok(outcomes)
    }

    /// Works like [`Engine::evaluate`], but does not allocate: the outcomes are written to `outcomes`, which has one
    /// element per output.
    ///
    /// # Errors
    /// Fails like [`Engine::evaluate`], and if the length of `outcomes` differs from the number of outputs.
    ///
    /// # Example: a loop that does not allocate
    /// ```
    /// # use fuzzy::{Engine, Model};
    /// use fuzzy::engine::Outcome;
    ///
    /// # let model: Model = "{fuzzy: 1, name: fan, inputs: {heat: {range: [0, 40], partition: [low, high]}},
    /// #     outputs: {speed: {range: [0, 9], partition: [slow, fast]}}, rules: [IF heat IS high THEN speed IS fast]}".parse()?;
    /// let engine = Engine::new(&model)?;
    /// let mut scratch = engine.scratch();
    /// let mut outcomes = [Outcome::default()];
    /// for heat in [10.0, 20.0, 30.0] {
    ///     engine.evaluate_with(&mut scratch, &[heat], &mut outcomes)?;
    ///     assert!(outcomes[0].value().is_some());
    /// }
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn evaluate_with(
        &self,
        scratch: &mut Scratch,
        inputs: &[f64],
        outcomes: &mut [Outcome],
    ) -> Result<(), EvaluateError> {
        self.fits(inputs, outcomes)?;
        self.outcomes(scratch, inputs, outcomes);
        self.must_fire(outcomes)
    }

    /// Checks that there is one value per input and one outcome per output.
    #[inline(always)]
    fn fits(&self, inputs: &[f64], outcomes: &[Outcome]) -> Result<(), EvaluateError> {
        if inputs.len() != self.inputs.len() {
            return Err(EvaluateError::WrongNumberOfInputs {
                expected: self.inputs.len(),
                got: inputs.len(),
            });
        }
        if outcomes.len() != self.outputs.len() {
            return Err(EvaluateError::WrongNumberOfOutputs {
                expected: self.outputs.len(),
                got: outcomes.len(),
            });
        }
        Ok(())
    }

    /// Returns an error if no rule fires for an output that must have a value.
    #[inline(always)]
    fn must_fire(&self, outcomes: &[Outcome]) -> Result<(), EvaluateError> {
        for (output, outcome) in self.outputs.iter().zip(outcomes) {
            if output.must_fire && outcome.state == State::NoRuleFired {
                return Err(EvaluateError::NoRuleFired {
                    output: Arc::clone(&output.name),
                });
            }
        }
        Ok(())
    }

    /// Evaluates one value per input into one outcome per output; the caller has checked the lengths.
    #[inline(always)]
    fn outcomes(&self, scratch: &mut Scratch, inputs: &[f64], outcomes: &mut [Outcome]) {
        match &self.chain {
            None => self.first.outcomes(&mut scratch.first, inputs, outcomes),
            Some(chain) => self.chained(chain, scratch, inputs, outcomes, |_, _| {}),
        }
    }
}

impl Stage {
    /// Allocates working memory to evaluate `L` rows with these arrays.
    fn scratch<const L: usize>(&self, arrays: &OwnedTable) -> StageScratch<L> {
        let sizes = arrays.sizes;
        let strengths = sizes.strengths as usize;
        let integrated = self.outputs.iter().filter_map(CompiledOutput::integrated);
        let bounds = self.bounds();
        let cuts = integrated.map(IntegratedSet::cuts);
        let cuts = cuts.chain(bounds.map(bounds::Bounds::cuts));
        StageScratch {
            table: Buffers {
                values: AlignedRows::new(arrays.inputs.len()),
                degrees: AlignedRows::new(sizes.degrees as usize),
                alive: vec![PartialConjunction::NONE; sizes.alive as usize],
                partial: vec![PartialConjunction::NONE; sizes.partial as usize],
                next: vec![PartialConjunction::NONE; sizes.partial as usize],
                stack: AlignedRows::new(sizes.stack as usize),
                // At least eight, because clearing the first eight inline is faster than a call.
                strengths: AlignedRows::new(strengths.next_multiple_of(8)),
                strongest: vec![StrongestRule::NONE; self.outputs.len()],
            },
            // Each term adds cuts where it crosses the two levels of its implication, while rising and while falling.
            workspace: {
                let cuts = 5 * strengths + cuts.max().unwrap_or(0);
                let workspace = Workspace::new(strengths, cuts);
                match bounds {
                    None => workspace,
                    Some(_) => workspace.with_lines(),
                }
            },
        }
    }

    #[inline(always)]
    fn outcomes(&self, scratch: &mut StageScratch, inputs: &[f64], outcomes: &mut [Outcome]) {
        match &self.single {
            #[cfg(feature = "simd")]
            SingleRowMethod::Plane(_) => {
                self.single.by_plane(inputs, outcomes);
            }
            #[cfg(feature = "simd")]
            SingleRowMethod::Vectors(uniform) => {
                self.outcomes_by(scratch, inputs, outcomes, |_, buffers| {
                    let strongest = uniform.fire(&buffers.values, &mut buffers.strengths);
                    buffers.strongest.fill(strongest);
                });
            }
            SingleRowMethod::Cells => {
                self.outcomes_by(scratch, inputs, outcomes, |arrays, buffers| {
                    table::fire::<_, _, _, _, 1, true>(arrays, buffers);
                })
            }
            SingleRowMethod::Rules => self.outcomes_by(scratch, inputs, outcomes, fire_rules),
            SingleRowMethod::Bounds(bounds) => bounds.outcomes(self, scratch, inputs, outcomes),
        }
    }

    #[inline(never)]
    fn outcomes_by(
        &self,
        scratch: &mut StageScratch,
        inputs: &[f64],
        outcomes: &mut [Outcome],
        fire: impl FnOnce(&OwnedTable, &mut RowBuffers<1>),
    ) {
        let StageScratch {
            table: buffers,
            workspace,
        } = scratch;
        let integrate =
            |index: usize, strengths: &[f64]| self.integrate(index, strengths, workspace);
        table::evaluate_row(&self.arrays, buffers, inputs, outcomes, fire, integrate);
    }

    fn integrate(&self, index: usize, strengths: &[f64], workspace: &mut Workspace) -> Option<f64> {
        let output = self.outputs.get(index)?;
        let strengths = Strengths {
            strengths,
            offsets: &output.offsets,
        };
        output.integrated()?.value(strengths, workspace)
    }
}

/// Fires rules of any kind in one row. All callers share one compiled copy, which is large.
fn fire_rules(arrays: &OwnedTable, buffers: &mut RowBuffers<1>) {
    table::fire_row(arrays, buffers);
}

impl CompiledOutput {
    /// Returns the integrator of an output without a closed form.
    fn integrated(&self) -> Option<&IntegratedSet> {
        match &self.method {
            Method::Integrated(integrated) => Some(integrated),
            Method::Partition(_)
            | Method::Layered(_)
            | Method::Moments(_)
            | Method::Prepared(_)
            | Method::Sugeno { .. }
            | Method::Tsukamoto(_) => None,
        }
    }
}

#[cfg(test)]
mod blocks_tests;
#[cfg(test)]
mod tests;
