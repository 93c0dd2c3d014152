//! Evaluates a model whose outputs read other outputs, stage by stage.

use alloc::vec::Vec;

use super::arrays::OwnedTable;
use super::{Engine, Outcome, Scratch, Stage};
use crate::model::chain;
use crate::table;

/// How the stages of a model that chains fit together.
#[derive(Debug, Clone)]
pub(super) struct Chain {
    /// Of the first stage.
    first: Place,
    later: Vec<Later>,
    /// The same as plain arrays: a [`table::Chain`].
    pub(super) flat: OwnedTable,
    pub(super) stages: Vec<table::Stage>,
    pub(super) places: Vec<u32>,
}

/// A stage after the first one.
#[derive(Debug, Clone)]
pub(super) struct Later {
    place: Place,
    pub(super) stage: Stage,
}

/// What a stage is in the whole model.
#[derive(Debug, Clone)]
struct Place {
    /// The outputs that it reads. Their values stand after those of the inputs.
    reads: Vec<u32>,
    /// The index in the model of each of its outputs.
    outputs: Vec<u32>,
    /// The index in the model of each of its rules.
    rules: Vec<u32>,
}

impl Place {
    fn of(stage: &chain::Stage<'_>) -> Self {
        let indices = |all: &[usize]| all.iter().map(|index| *index as u32).collect();
        Place {
            reads: indices(&stage.reads),
            outputs: indices(&stage.outputs),
            rules: indices(&stage.rules),
        }
    }

    fn lend(&self) -> table::chain::Place<'_> {
        table::chain::Place {
            reads: &self.reads,
            outputs: &self.outputs,
            rules: &self.rules,
        }
    }
}

impl Chain {
    pub(super) fn new(first: (&chain::Stage<'_>, &Stage), later: &[chain::Stage<'_>]) -> Self {
        let (place, first) = (Place::of(first.0), first.1);
        let later = later.iter().map(|stage| Later {
            place: Place::of(stage),
            stage: Stage::new(&stage.model),
        });
        let mut chain = Chain {
            first: place,
            later: later.collect(),
            flat: OwnedTable::default(),
            stages: Vec::new(),
            places: Vec::new(),
        };
        let (mut flat, mut stages, mut places) = (OwnedTable::default(), Vec::new(), Vec::new());
        for (place, stage) in chain.stages(first) {
            let [conjunctions, actions_a_cell, first_action, sums] =
                stage.arrays.conjunctions.code();
            flat.append(&stage.arrays);
            stages.push(table::Stage {
                conjunctions,
                actions_a_cell,
                first_action,
                sums,
                sizes: stage.arrays.sizes,
                reads: place.reads.len() as u32,
                outputs: place.outputs.len() as u32,
                rules: place.rules.len() as u32,
                ends: flat.ends(),
            });
            for indices in [&place.reads, &place.outputs, &place.rules] {
                places.extend_from_slice(indices);
            }
        }
        (chain.flat, chain.stages, chain.places) = (flat, stages, places);
        chain
    }

    pub(super) fn later(&self) -> &[Later] {
        &self.later
    }

    /// The stages in the order of their evaluation, each with what it is in the model.
    fn stages<'a>(&'a self, first: &'a Stage) -> impl Iterator<Item = (&'a Place, &'a Stage)> {
        let later = self.later.iter().map(|later| (&later.place, &later.stage));
        core::iter::once((&self.first, first)).chain(later)
    }

    /// The most outputs that a stage reads.
    pub(super) fn most_reads(&self) -> usize {
        let reads = self.later.iter().map(|later| later.place.reads.len());
        reads.max().unwrap_or(0)
    }
}

impl Engine {
    /// [`Engine::outcomes`](super::Engine) of a model that chains. `keep` may change the outcome of an output before others read
    /// it.
    // Apart from the evaluation of one stage, so that this one costs nothing where there is no chain.
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
        let stages = stages.map(|(later, scratch)| (&later.place, &later.stage, scratch));
        for (place, stage, scratch) in
            core::iter::once((&chain.first, &self.first, first)).chain(stages)
        {
            let given = (inputs, &mut values[..], &mut own[..]);
            let evaluate = |inputs: &[f64], own: &mut [Outcome]| {
                stage.outcomes(scratch, inputs, own);
            };
            table::chain::stage(place.lend(), given, outcomes, evaluate, &mut keep);
        }
    }

    /// The compiled arrays of a model in which an output [reads](crate::Model::reads) another one, to be evaluated without
    /// this engine or written out; `None` of another one, which is a [`table`](Engine::table).
    pub fn chain(&self) -> Option<table::Chain<'_>> {
        let chain = self.chain.as_deref()?;
        Some(table::Chain {
            table: chain.flat.table(),
            stages: &chain.stages,
            places: &chain.places,
        })
    }
}

impl Engine {
    /// The stage of an output in a model that chains: its number, the output's place in it, and the number of rules of the
    /// stages before it. The scratch memory has the values that it reads; `None` where one of them is unknown.
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
        for (number, (place, stage)) in chain.stages(&self.first).enumerate() {
            if let Some(own) = place.outputs.iter().position(|own| *own as usize == output) {
                let reads = scratch.values.get_mut(inputs.len()..)?.iter_mut();
                for (value, read) in reads.zip(&place.reads) {
                    *value = scratch.outcomes.get(*read as usize)?.value()?;
                }
                return Some((number, stage, own, rules));
            }
            rules += place.rules.len();
        }
        None
    }
}

#[cfg(test)]
mod tests;
