//! A compiled rule set as plain data, and its evaluation in lent memory.

use fuzzy::table::{Chain, Damaged, Outcome, Partial, Scratch, Stage, Strongest, Table, Values};

/// A compiled rule set, as plain data.
#[derive(Debug, Clone, Copy)]
pub struct Rules<'a> {
    /// The rule set; where outputs read others, the arrays of all stages.
    pub table: Table<'a>,
    /// The stages of a rule set in which outputs read others; else empty. See [`Chain`].
    pub stages: &'a [Stage],
    /// See [`Chain::places`].
    pub places: &'a [u32],
}

impl<'a> Rules<'a> {
    /// The rule set, where outputs read others.
    pub(super) const fn chain(&self) -> Option<Chain<'a>> {
        match self.stages {
            [] => None,
            stages => Some(Chain {
                table: self.table,
                stages,
                places: self.places,
            }),
        }
    }

    /// The number of inputs.
    pub const fn inputs(&self) -> usize {
        match self.stages {
            [] => self.table.inputs.len(),
            // The first stage reads no output.
            [first, ..] => first.ends.inputs as usize,
        }
    }

    /// Verifies every index and size. Exported rule sets pass.
    ///
    /// # Errors
    /// The first array with an index out of bounds.
    pub fn check(&self) -> Result<(), Damaged> {
        match self.chain() {
            None => self.table.check(),
            Some(chain) => chain.check(self.inputs()),
        }
    }

    /// The most inputs of a stage: those of the rule set, and the outputs that it reads.
    pub const fn most_inputs(&self) -> usize {
        let reads = match self.chain() {
            None => 0,
            Some(chain) => chain.most_reads(),
        };
        self.inputs().saturating_add(reads)
    }

    /// The numbers that are handed over between stages.
    const fn stage_inputs(&self) -> usize {
        match self.stages {
            [] => 0,
            _ => self.most_inputs(),
        }
    }

    // Saturating: a damaged table asks for more memory than there is, and never for less than it uses.

    /// The number of numbers that an [`Evaluator`] works with.
    pub const fn numbers(&self) -> usize {
        let sizes = self.table.sizes;
        (sizes.degrees as usize)
            .saturating_add(sizes.stack as usize)
            .saturating_add(sizes.strengths as usize)
            .saturating_add(self.most_inputs())
            .saturating_add(self.stage_inputs())
    }

    /// The number of partial conjunctions that an [`Evaluator`] works with.
    pub const fn partials(&self) -> usize {
        let sizes = self.table.sizes;
        (sizes.partial as usize)
            .saturating_mul(2)
            .saturating_add(sizes.alive as usize)
    }

    /// An upper bound, in bytes, for an evaluator, its memory and the rules, where pieces are aligned to at most 16 bytes.
    pub const fn bytes(&self) -> usize {
        const ALIGNED: usize = 15;
        let output = size_of::<Strongest>() + 2 * size_of::<Outcome>();
        (size_of::<Rules<'_>>() + size_of::<Evaluator<'_>>() + 8 * ALIGNED)
            .saturating_add(self.table.outputs.len().saturating_mul(output))
            .saturating_add(self.numbers().saturating_mul(size_of::<f64>()))
            .saturating_add(self.partials().saturating_mul(size_of::<Partial>()))
    }
}

/// The memory of an [`Evaluator`], in pieces.
#[derive(Debug)]
#[doc(hidden)] // For the C interface.
pub struct RuleMemory<'m> {
    /// [`Rules::numbers`].
    pub numbers: &'m mut [f64],
    /// [`Rules::partials`].
    pub partials: &'m mut [Partial],
    /// One for each output.
    pub strongest: &'m mut [Strongest],
    /// One for each output.
    pub outcomes: &'m mut [Outcome],
    /// One for each output.
    pub own: &'m mut [Outcome],
}

/// Evaluates a rule set in lent memory.
#[derive(Debug)]
#[doc(hidden)] // For the C interface. `flagred export --rust` writes a function.
pub struct Evaluator<'a> {
    pub(super) rules: &'a Rules<'a>,
    pub(super) scratch: Scratch<'a>,
    /// Of the stages.
    pub(super) values: Values<'a>,
    pub(super) outcomes: &'a mut [Outcome],
}

impl<'a> Evaluator<'a> {
    /// `None` where the memory does not have the sizes of the rules.
    pub fn new(rules: &'a Rules<'a>, memory: RuleMemory<'a>) -> Option<Evaluator<'a>> {
        let RuleMemory {
            mut numbers,
            mut partials,
            strongest,
            outcomes,
            own,
        } = memory;
        let sizes = rules.table.sizes;
        let outputs = rules.table.outputs.len();
        let fits = [strongest.len(), outcomes.len(), own.len()] == [outputs; 3];
        let evaluator = Evaluator {
            rules,
            scratch: Scratch {
                values: take(&mut numbers, rules.most_inputs())?,
                degrees: take(&mut numbers, sizes.degrees as usize)?,
                stack: take(&mut numbers, sizes.stack as usize)?,
                strengths: take(&mut numbers, sizes.strengths as usize)?,
                alive: take(&mut partials, sizes.alive as usize)?,
                partial: take(&mut partials, sizes.partial as usize)?,
                next: take(&mut partials, sizes.partial as usize)?,
                strongest,
            },
            values: Values {
                inputs: take(&mut numbers, rules.stage_inputs())?,
                own,
            },
            outcomes,
        };
        (fits && numbers.is_empty() && partials.is_empty()).then_some(evaluator)
    }

    /// One outcome for each output; `None` where there is not one value for each input.
    pub fn evaluate(&mut self, inputs: &[f64]) -> Option<&[Outcome]> {
        if inputs.len() != self.rules.inputs() {
            return None;
        }
        let Evaluator {
            rules,
            scratch,
            values,
            outcomes,
        } = self;
        match rules.chain() {
            None => rules.table.evaluate(scratch, inputs, outcomes),
            Some(chain) => chain.evaluate(scratch, values, inputs, outcomes),
        }
        Some(outcomes)
    }
}

/// Takes the first items off a slice.
pub(super) fn take<'m, T>(rest: &mut &'m mut [T], count: usize) -> Option<&'m mut [T]> {
    let (taken, left) = core::mem::take(rest).split_at_mut_checked(count)?;
    *rest = left;
    Some(taken)
}
