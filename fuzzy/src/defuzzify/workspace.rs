//! Scratch memory of the integrator, and a limit on its work.

use alloc::vec::Vec;

use super::curves::{ActivatedTerm, Run};

/// Scratch memory that the caller provides. Evaluations never reallocate it.
#[derive(Debug)]
pub(crate) struct Workspace {
    /// The cuts of an interval.
    pub(super) cuts: Vec<f64>,
    /// The maximum number of cuts of an interval. The capacity of `cuts` may be larger, depending on the allocator.
    pub(super) most_cuts: usize,
    pub(super) runs: Vec<Run>,
    pub(super) parts: Vec<ActivatedTerm>,
    /// Straight pieces: their ends, and the degrees there. The capacity is 0 unless there is a type reduction.
    pub(super) lines: Vec<[f64; 4]>,
    pub(crate) steps: Steps,
}

/// The work of integrations; a step is about one evaluation of a membership function.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Steps {
    pub(crate) taken: u64,
    /// The maximum number of steps. An integration that would exceed it ends early, and its value is invalid.
    pub(crate) most: u64,
}

impl Steps {
    const UNBOUNDED: Steps = Steps {
        taken: 0,
        most: u64::MAX,
    };

    /// Adds steps, and returns whether their number is still within the limit.
    pub(super) fn take(&mut self, steps: usize) -> bool {
        self.taken = self.taken.saturating_add(steps as u64);
        !self.are_spent()
    }

    pub(crate) fn are_spent(&self) -> bool {
        self.taken > self.most
    }
}

/// The maximum number of straight pieces that a type reduction stores, of the lower and the upper set together. If there
/// are more, the pieces are computed again in each step of the search.
const MAX_LINES: usize = 256;

/// The approximate number of times that each term is evaluated to integrate a curved piece.
pub(super) const STEPS_OF_A_CURVE: usize = 16;

impl Workspace {
    /// Allocates memory for a number of activated terms and a number of cuts.
    pub(crate) fn new(activations: usize, cuts: usize) -> Self {
        let most_cuts = cuts.max(activations + 2);
        Workspace {
            cuts: Vec::with_capacity(most_cuts),
            most_cuts,
            runs: Vec::with_capacity(activations),
            parts: Vec::with_capacity(activations),
            lines: Vec::new(),
            steps: Steps::UNBOUNDED,
        }
    }

    /// Allocates memory for the straight pieces of a type reduction.
    pub(crate) fn with_lines(mut self) -> Self {
        self.lines.reserve_exact(MAX_LINES);
        self
    }
}

/// Creates an empty workspace with the same capacities. A derived clone would have no spare capacity.
impl Clone for Workspace {
    fn clone(&self) -> Self {
        let new = Workspace::new(self.parts.capacity(), self.most_cuts);
        match self.lines.capacity() {
            0 => new,
            _ => new.with_lines(),
        }
    }
}
