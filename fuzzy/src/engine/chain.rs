//! Stage-by-stage evaluation of a model whose outputs read other outputs.

use alloc::vec::Vec;

use super::arrays::OwnedTable;
use super::{Engine, Outcome, Scratch, Stage};
use crate::model::chain;
use crate::table;

/// The stages of a model with chains, and the outputs that connect them.
#[derive(Debug, Clone)]
pub(super) struct Chain {
    /// The indices, in the model, of the outputs and rules of the first stage.
    first: OwnedStageIndices,
    later: Vec<LaterStage>,
    /// The same stages as plain arrays. This field and the next two contain the fields of a [`table::Chain`].
    pub(super) flat: OwnedTable,
    pub(super) stages: Vec<table::Stage>,
    pub(super) indices: Vec<u32>,
}

/// A stage after the first one.
#[derive(Debug, Clone)]
pub(super) struct LaterStage {
    indices: OwnedStageIndices,
    pub(super) stage: Stage,
}

/// The indices, in the model, of the outputs and rules of a stage.
#[derive(Debug, Clone)]
struct OwnedStageIndices {
    /// The index in the model of each output that the stage reads. The values of these outputs are stored after
    /// the values of the inputs.
    reads: Vec<u32>,
    /// The index in the model of each output of the stage.
    outputs: Vec<u32>,
    /// The index in the model of each rule of the stage.
    rules: Vec<u32>,
}

impl OwnedStageIndices {
    fn of(stage: &chain::Stage<'_>) -> Self {
        let indices = |all: &[usize]| all.iter().map(|index| *index as u32).collect();
        OwnedStageIndices {
            reads: indices(&stage.reads),
            outputs: indices(&stage.outputs),
            rules: indices(&stage.rules),
        }
    }

    fn as_slices(&self) -> table::chain::StageIndices<'_> {
        table::chain::StageIndices {
            reads: &self.reads,
            outputs: &self.outputs,
            rules: &self.rules,
        }
    }
}

impl Chain {
    pub(super) fn new(first: (&chain::Stage<'_>, &Stage), later: &[chain::Stage<'_>]) -> Self {
        let (indices, first) = (OwnedStageIndices::of(first.0), first.1);
        let later = later.iter().map(|stage| LaterStage {
            indices: OwnedStageIndices::of(stage),
            stage: Stage::new(&stage.model),
        });
        let mut chain = Chain {
            first: indices,
            later: later.collect(),
            flat: OwnedTable::default(),
            stages: Vec::new(),
            indices: Vec::new(),
        };
        let (mut flat, mut stages, mut all) = (OwnedTable::default(), Vec::new(), Vec::new());
        for (indices, stage) in chain.stages(first) {
            let [conjunctions, actions_per_cell, first_action, sums] =
                stage.arrays.conjunctions.code();
            flat.append(&stage.arrays);
            stages.push(table::Stage {
                conjunctions,
                actions_per_cell,
                first_action,
                sums,
                sizes: stage.arrays.sizes,
                reads: indices.reads.len() as u32,
                outputs: indices.outputs.len() as u32,
                rules: indices.rules.len() as u32,
                ends: flat.ends(),
            });
            for part in [&indices.reads, &indices.outputs, &indices.rules] {
                all.extend_from_slice(part);
            }
        }
        (chain.flat, chain.stages, chain.indices) = (flat, stages, all);
        chain
    }

    pub(super) fn later(&self) -> &[LaterStage] {
        &self.later
    }

    /// Returns the stages in the order of evaluation, each with the indices of its outputs and rules in the model.
    fn stages<'a>(
        &'a self,
        first: &'a Stage,
    ) -> impl Iterator<Item = (&'a OwnedStageIndices, &'a Stage)> {
        let later = self
            .later
            .iter()
            .map(|later| (&later.indices, &later.stage));
        core::iter::once((&self.first, first)).chain(later)
    }

    /// Returns the maximum number of outputs that a stage reads.
    pub(super) fn most_reads(&self) -> usize {
        let reads = self.later.iter().map(|later| later.indices.reads.len());
        reads.max().unwrap_or(0)
    }
}

impl Engine {
    /// Implements [`Engine::outcomes`](super::Engine) for a model with chains. `keep` may change the outcome of an
    /// output before other outputs read it.
    // This function is separate from the evaluation of a single stage, so that models without chains do not become
    // slower.
    #[inline(never)]
    pub(super) fn chained(
        &self,
        chain: &Chain,
        scratch: &mut Scratch,
        inputs: &[f64],
        outcomes: &mut [Outcome],
        mut keep: impl FnMut(usize, &mut Outcome),
    ) {
        let Scratch {
            first,
            later,
            values,
            own,
            ..
        } = scratch;
        let stages = chain.later.iter().zip(later);
        let stages = stages.map(|(later, scratch)| (&later.indices, &later.stage, scratch));
        for (indices, stage, scratch) in
            core::iter::once((&chain.first, &self.first, first)).chain(stages)
        {
            let given = (inputs, &mut values[..], &mut own[..]);
            let evaluate = |inputs: &[f64], own: &mut [Outcome]| {
                stage.outcomes(scratch, inputs, own);
            };
            table::chain::stage(indices.as_slices(), given, outcomes, evaluate, &mut keep);
        }
    }

    /// Returns the compiled arrays of a model in which an output [reads](crate::Model::reads) another one, to evaluate
    /// them without this engine or to write them to a file. `None` for any other model, whose arrays are returned by
    /// [`Engine::table`].
    pub fn chain(&self) -> Option<table::Chain<'_>> {
        let chain = self.chain.as_deref()?;
        Some(table::Chain {
            table: chain.flat.table(),
            stages: &chain.stages,
            indices: &chain.indices,
        })
    }
}

impl Engine {
    /// Finds the stage of an output in a model with chains. Returns the number of the stage, the stage, the index of
    /// the output in it, and the number of rules of all earlier stages. The values that the stage reads are stored in
    /// the scratch memory; `None` if one of them is undefined.
    pub(super) fn stage_of<'a>(
        &'a self,
        chain: &'a Chain,
        scratch: &mut Scratch,
        inputs: &[f64],
        output: usize,
    ) -> Option<(usize, &'a Stage, usize, usize)> {
        let mut outcomes = core::mem::take(&mut scratch.outcomes);
        self.chained(chain, scratch, inputs, &mut outcomes, |_, _| {});
        scratch.outcomes = outcomes;
        let mut rules = 0;
        for (number, (indices, stage)) in chain.stages(&self.first).enumerate() {
            if let Some(own) = indices
                .outputs
                .iter()
                .position(|own| *own as usize == output)
            {
                let reads = scratch.values.get_mut(inputs.len()..)?.iter_mut();
                for (value, read) in reads.zip(&indices.reads) {
                    *value = scratch.outcomes.get(*read as usize)?.value()?;
                }
                return Some((number, stage, own, rules));
            }
            rules += indices.rules.len();
        }
        None
    }
}

#[cfg(test)]
mod tests;
