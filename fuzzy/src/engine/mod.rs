//! The compiled model: immutable, evaluated without allocation.
//!
//! From a model to an answer, with the rules `IF heat IS low THEN speed IS slow` and `IF heat IS high THEN speed IS fast` over
//! three triangles each, from 0 to 10:
//!
//! 1. `compile` gives each proposition a number: `heat IS low` is literal 0, `heat IS high` literal 1. Rules become drafts of
//!    indices, and each output gets firing strengths: 0 to 2 for `slow`, `medium` and `fast`.
//! 2. `strategy` chooses how the output is computed and how rules fire. Here the output is a partition, and all rules are in
//!    a table of one axis with two cells.
//! 3. `rules` and `arrays` lay all that out as the arrays of a [`Table`]; its [module](table) shows them for this example.
//! 4. An evaluation at 8 finds the degrees of the two literals alive there (0 and 0.6), raises the firing strengths to
//!    (0, 0, 0.6) and has `table/closed.rs` compute the centroid 8.14.

use alloc::{boxed::Box, sync::Arc, vec, vec::Vec};
use core::ops::Range;

use smallvec::{SmallVec, smallvec};

use crate::defuzzify::workspace::Workspace;
use crate::defuzzify::{Integrated, Method, Strengths};
use crate::model::{Model, NoRuleFires};
use crate::table::{self, Buffers, Partial, Strongest, Table};
use aligned::Rows;
use arrays::OwnedTable;
use chain::Chain;
use strategy::Single;

mod aligned;
mod arrays;
pub(crate) mod batch;
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
#[cfg(feature = "simd")]
mod vectors;
mod what_if;

pub(crate) use crate::table::operators;
pub use crate::table::{Outcome, State};
pub use error::EvaluateError;
pub use explanation::{Degree, ExplainedInput, ExplainedOutput, Explanation, FiredRule, Share};
pub use named::NamedOutcomes;
pub use raising::Said;
pub use sequence::Sequence;
pub use silent::{Silence, SilentRule};
pub use what_if::{Change, Effect};

/// A compiled model: immutable, and shared by any number of threads.
///
/// # Example: from a model to an answer
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
    /// What it was compiled from.
    model: Arc<Model>,
    inputs: Vec<Input>,
    outputs: Vec<NamedOutput>,
    /// The outputs that read no other output: all of them, unless the model chains.
    first: Stage,
    /// The other outputs, which are evaluated after those they read.
    chain: Option<Box<Chain>>,
}

/// The outcomes of an evaluation, one for each output in the order of the model; up to 8 without an allocation.
pub type Outcomes = SmallVec<[Outcome; 8]>;

/// Outputs that are evaluated at once.
#[derive(Debug, Clone)]
struct Stage {
    outputs: Vec<CompiledOutput>,
    /// What is evaluated.
    arrays: OwnedTable,
    /// The same rules, all of them as programs, where a batch is faster with them.
    batch: Option<OwnedTable>,
    /// How the rules fire on a single row.
    single: Single,
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
    /// Whether evaluation is an error where no rule fires.
    must_fire: bool,
}

#[derive(Debug, Clone)]
struct CompiledOutput {
    low: f64,
    high: f64,
    when_no_rule_fires: NoRuleFires,
    /// The span of its firing strengths.
    strengths: Range<usize>,
    /// The offset in that span of each term's firing strengths, and the end of the last term's.
    offsets: Vec<usize>,
    /// Whether a value outside the range is clamped to it.
    clamps: bool,
    method: Method,
}

/// Working memory of an evaluation: made once by [`Engine::scratch`], then reused.
#[derive(Debug, Clone)]
pub struct Scratch {
    first: StageScratch,
    /// Of the later stages of a model that chains.
    later: Vec<StageScratch>,
    /// The values of the inputs, then of the outputs that a later stage reads.
    values: Vec<f64>,
    /// The outcomes of a stage of a model that chains.
    own: Vec<Outcome>,
    /// Those of all its outputs, where a rule is looked for.
    outcomes: Vec<Outcome>,
    /// The stage in which a rule was looked for last.
    asked: usize,
}

#[derive(Debug, Clone)]
struct StageScratch<const L: usize = 1> {
    table: RowBuffers<L>,
    /// For outputs that have no closed form.
    workspace: Workspace,
}

#[cfg(feature = "check")]
impl Scratch {
    /// Bounds the steps of further integrations: those that would take more end early, and their values mean nothing.
    pub(crate) fn bound_steps(&mut self, most: u64) {
        for workspace in self.workspaces() {
            workspace.steps = crate::defuzzify::workspace::Steps { taken: 0, most };
        }
    }

    /// The steps of integrations since they were bounded, and whether there were enough.
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

type RowBuffers<const L: usize> = Buffers<Rows<L>, Vec<Partial<L>>, Vec<Strongest<L>>>;

impl Engine {
    /// The index of an input.
    pub fn input(&self, name: &str) -> Option<usize> {
        self.inputs.iter().position(|input| &*input.name == name)
    }

    /// The index of an output.
    pub fn output(&self, name: &str) -> Option<usize> {
        self.outputs.iter().position(|output| &*output.name == name)
    }

    /// The names of the inputs, in the order of their values.
    pub fn input_names(&self) -> impl ExactSizeIterator<Item = &str> {
        self.inputs.iter().map(|input| &*input.name)
    }

    /// The names of the outputs, in the order of their outcomes.
    pub fn output_names(&self) -> impl ExactSizeIterator<Item = &str> {
        self.outputs.iter().map(|output| &*output.name)
    }

    /// The model it was compiled from.
    #[must_use]
    pub fn model(&self) -> &Model {
        &self.model
    }

    /// Name, lower and upper end of each input.
    pub(crate) fn ranges(&self) -> impl Iterator<Item = (&Arc<str>, f64, f64)> {
        self.inputs.iter().map(|v| (&v.name, v.low, v.high))
    }

    /// Working memory for [`Engine::evaluate_with`]; each thread needs its own.
    pub fn scratch(&self) -> Scratch {
        let Some(chain) = &self.chain else {
            return Scratch {
                first: self.first.scratch(&self.first.arrays),
                later: Vec::new(),
                values: Vec::new(),
                own: Vec::new(),
                outcomes: Vec::new(),
                asked: 0,
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
            asked: 0,
        }
    }

    /// The compiled arrays, to be evaluated without this engine or written out: see [`table`]. `None` where an output
    /// [reads](Model::reads) another one, because a table has one stage. Outputs whose set is
    /// [`ClosedForm::Integrated`](table::ClosedForm::Integrated) have no closed form, and only the engine knows their values.
    pub fn table(&self) -> Option<Table<'_>> {
        self.chain.is_none().then(|| self.first.arrays.table())
    }

    /// Evaluates one value for each input, in the order of the model, and gives one outcome for each output.
    ///
    /// It allocates working memory, which takes longer than a small evaluation, except for the rule sets that the feature `simd`
    /// evaluates as a plane. In a loop use [`Engine::evaluate_with`].
    ///
    /// A value outside its input's range is clamped to it, and the outcome says so.
    /// A value that is NaN or infinite makes every outcome [`State::InputNotFinite`].
    ///
    /// # Errors
    /// Not one value for each input; or no rule fires for an output whose model says that this is an error.
    ///
    /// # Example: a value, no value, and an input outside its range
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

    /// [`Engine::evaluate`] without allocation: `outcomes` has one element for each output.
    ///
    /// # Errors
    /// As [`Engine::evaluate`]; and not one element for each output.
    ///
    /// # Example: in a loop that must not allocate
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

    /// Whether there is one value for each input and one outcome for each output.
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

    /// An error where no rule fires for an output that must have a value.
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

    /// Evaluates as many values as there are inputs into as many outcomes as there are outputs.
    #[inline(always)]
    fn outcomes(&self, scratch: &mut Scratch, inputs: &[f64], outcomes: &mut [Outcome]) {
        match &self.chain {
            None => self.first.outcomes(&mut scratch.first, inputs, outcomes),
            Some(chain) => self.chained(chain, scratch, inputs, outcomes, |_, _| {}),
        }
    }
}

impl Stage {
    /// Working memory for an evaluation of `L` rows by these arrays.
    fn scratch<const L: usize>(&self, arrays: &OwnedTable) -> StageScratch<L> {
        let sizes = arrays.sizes;
        let strengths = sizes.strengths as usize;
        let integrated = self.outputs.iter().filter_map(CompiledOutput::integrated);
        let cuts = integrated.map(Integrated::cuts);
        StageScratch {
            table: Buffers {
                values: Rows::new(arrays.inputs.len()),
                degrees: Rows::new(sizes.degrees as usize),
                alive: vec![Partial::NONE; sizes.alive as usize],
                partial: vec![Partial::NONE; sizes.partial as usize],
                next: vec![Partial::NONE; sizes.partial as usize],
                stack: Rows::new(sizes.stack as usize),
                // Cleared eight at a time.
                strengths: Rows::new(strengths.next_multiple_of(8)),
                strongest: vec![Strongest::NONE; self.outputs.len()],
            },
            // A term passes two levels of its implication, each rising and falling.
            workspace: Workspace::new(strengths, 5 * strengths + cuts.max().unwrap_or(0)),
        }
    }

    #[inline(always)]
    fn outcomes(&self, scratch: &mut StageScratch, inputs: &[f64], outcomes: &mut [Outcome]) {
        match &self.single {
            #[cfg(feature = "simd")]
            Single::Plane(_) => {
                self.single.by_plane(inputs, outcomes);
            }
            #[cfg(feature = "simd")]
            Single::Vectors(uniform) => {
                self.outcomes_by(scratch, inputs, outcomes, |_, buffers| {
                    let strongest = uniform.fire(&buffers.values, &mut buffers.strengths);
                    buffers.strongest.fill(strongest);
                });
            }
            Single::Cells => self.outcomes_by(scratch, inputs, outcomes, |arrays, buffers| {
                table::fire::<_, _, _, _, 1, true>(arrays, buffers);
            }),
            Single::Rules => self.outcomes_by(scratch, inputs, outcomes, |arrays, buffers| {
                table::fire_row(arrays, buffers);
            }),
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

impl CompiledOutput {
    /// The integrator of an output without a closed form.
    fn integrated(&self) -> Option<&Integrated> {
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
