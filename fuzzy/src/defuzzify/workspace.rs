//! Scratch memory of the integrator, and a bound on its work.

use alloc::vec::Vec;

use super::curves::{Part, Run};

/// Scratch memory of the caller. An evaluation never grows it.
#[derive(Debug)]
pub(crate) struct Workspace {
    /// The cuts of a stretch.
    pub(super) cuts: Vec<f64>,
    /// The most cuts of a stretch. The vector's capacity depends on the allocator.
    pub(super) most_cuts: usize,
    pub(super) runs: Vec<Run>,
    pub(super) parts: Vec<Part>,
    pub(crate) steps: Steps,
}

/// The work of integrations, about one membership a step.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Steps {
    pub(crate) taken: u64,
    /// An integration that would take more ends early, and its value means nothing.
    pub(crate) most: u64,
}

impl Steps {
    const UNBOUNDED: Steps = Steps {
        taken: 0,
        most: u64::MAX,
    };

    /// Takes steps, and returns whether there were enough left.
    pub(super) fn take(&mut self, steps: usize) -> bool {
        self.taken = self.taken.saturating_add(steps as u64);
        !self.are_spent()
    }

    pub(crate) fn are_spent(&self) -> bool {
        self.taken > self.most
    }
}

/// About so many memberships of each term are evaluated to integrate a piece with a curve.
pub(super) const STEPS_OF_A_CURVE: usize = 16;

impl Workspace {
    /// Workspace for `activations` and `cuts` at once.
    pub(crate) fn new(activations: usize, cuts: usize) -> Self {
        let most_cuts = cuts.max(activations + 2);
        Workspace {
            cuts: Vec::with_capacity(most_cuts),
            most_cuts,
            runs: Vec::with_capacity(activations),
            parts: Vec::with_capacity(activations),
            steps: Steps::UNBOUNDED,
        }
    }
}

/// Has the same capacities, and is empty. A derived clone would have no spare capacity.
impl Clone for Workspace {
    fn clone(&self) -> Self {
        Workspace::new(self.parts.capacity(), self.most_cuts)
    }
}
