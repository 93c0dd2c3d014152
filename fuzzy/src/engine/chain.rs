//! Evaluates a model whose outputs read other outputs, stage by stage.

use alloc::vec::Vec;

use super::{Engine, Outcome, Scratch, Stage, State};
use crate::model::chain;

/// How the stages of a model that chains fit together.
#[derive(Debug, Clone)]
pub(super) struct Chain {
    /// Of the first stage.
    first: Place,
    later: Vec<Later>,
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
    reads: Vec<usize>,
    /// The index in the model of each of its outputs.
    outputs: Vec<usize>,
    /// The index in the model of each of its rules.
    rules: Vec<usize>,
}

impl Place {
    fn of(stage: &chain::Stage<'_>) -> Self {
        Place {
            reads: stage.reads.clone(),
            outputs: stage.outputs.clone(),
            rules: stage.rules.clone(),
        }
    }
}

impl Chain {
    pub(super) fn new(first: &chain::Stage<'_>, later: &[chain::Stage<'_>]) -> Self {
        let later = later.iter().map(|stage| Later {
            place: Place::of(stage),
            stage: Stage::new(&stage.model),
        });
        Chain {
            first: Place::of(first),
            later: later.collect(),
        }
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
        values[..inputs.len()].copy_from_slice(inputs);
        let stages = chain.later.iter().zip(later);
        let stages = stages.map(|(later, scratch)| (&later.place, &later.stage, scratch));
        for (place, stage, scratch) in
            core::iter::once((&chain.first, &self.first, first)).chain(stages)
        {
            let all = inputs.len() + place.reads.len();
            let mut unknown = None;
            let mut clamped = false;
            for (value, read) in values[inputs.len()..].iter_mut().zip(&place.reads) {
                let outcome = outcomes[*read];
                clamped |= outcome.clamped;
                match outcome.value() {
                    Some(known) => *value = known,
                    None => unknown = Some(outcome.state),
                }
            }
            let own = &mut own[..place.outputs.len()];
            match unknown {
                None => stage.outcomes(scratch, &values[..all], own),
                // Its default value is for inputs without a rule; here the inputs are not known.
                Some(State::InputNotFinite) => own.fill(Outcome {
                    state: State::InputNotFinite,
                    ..Outcome::UNDEFINED
                }),
                Some(_) => own.fill(Outcome::UNDEFINED),
            }
            for (output, own) in place.outputs.iter().zip(own) {
                outcomes[*output] = Outcome {
                    dominant: own.dominant.map(|rule| place.rules[rule]),
                    clamped: own.clamped || clamped,
                    ..*own
                };
                keep(*output, &mut outcomes[*output]);
            }
        }
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
            if let Some(own) = place.outputs.iter().position(|own| *own == output) {
                let reads = scratch.values.get_mut(inputs.len()..)?.iter_mut();
                for (value, read) in reads.zip(&place.reads) {
                    *value = scratch.outcomes.get(*read)?.value()?;
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
