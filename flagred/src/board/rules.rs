//! A compiled rule set as plain data, and its evaluation in memory that the caller provides.

use fuzzy::table::{
    Chain, DamagedArray, Outcome, PartialConjunction, Scratch, Stage, StrongestRule, Table, Values,
};

/// A compiled rule set, as plain data.
#[derive(Debug, Clone, Copy)]
pub struct Rules<'a> {
    /// The rule set; if outputs read other outputs, the arrays of all stages.
    pub table: Table<'a>,
    /// The stages of a rule set whose outputs read other outputs; otherwise empty. See [`Chain`].
    pub stages: &'a [Stage],
    /// See [`Chain::indices`].
    pub indices: &'a [u32],
}

impl<'a> Rules<'a> {
    /// The rule set as a chain, if outputs read other outputs.
    pub(super) const fn chain(&self) -> Option<Chain<'a>> {
        match self.stages {
            [] => None,
            stages => Some(Chain {
                table: self.table,
                stages,
                indices: self.indices,
            }),
        }
    }

    /// The number of inputs.
    pub const fn inputs(&self) -> usize {
        match self.stages {
            [] => self.table.inputs.len(),
            // The first stage reads only inputs.
            [first, ..] => first.ends.inputs as usize,
        }
    }

    /// The number of outputs that have outcomes.
    pub const fn outputs(&self) -> usize {
        self.table.outcomes()
    }

    /// Verifies every index and size. Exported rule sets pass.
    ///
    /// # Errors
    /// Returns the first array that has an index out of bounds.
    pub fn check(&self) -> Result<(), DamagedArray> {
        match self.chain() {
            None => self.table.check(),
            Some(chain) => chain.check(self.inputs()),
        }
    }

    /// The largest number of inputs of a stage: the inputs of the rule set and the outputs that the stage reads.
    pub const fn most_inputs(&self) -> usize {
        let reads = match self.chain() {
            None => 0,
            Some(chain) => chain.most_reads(),
        };
        self.inputs().saturating_add(reads)
    }

    /// The number of values that are passed between stages.
    const fn stage_inputs(&self) -> usize {
        match self.stages {
            [] => 0,
            _ => self.most_inputs(),
        }
    }

    // The sums saturate. For a damaged table, the result may be more memory than exists, but it is
    // never less than an evaluation uses.

    /// The number of floating-point numbers that an [`Evaluator`] needs.
    pub const fn numbers(&self) -> usize {
        let sizes = self.table.sizes;
        (sizes.degrees as usize)
            .saturating_add(sizes.stack as usize)
            .saturating_add(sizes.strengths as usize)
            .saturating_add(self.most_inputs())
            .saturating_add(self.stage_inputs())
    }

    /// The number of partial conjunctions that an [`Evaluator`] needs.
    pub const fn partials(&self) -> usize {
        let sizes = self.table.sizes;
        (sizes.partial as usize)
            .saturating_mul(2)
            .saturating_add(sizes.alive as usize)
    }

    /// An upper bound for the total size of an evaluator, its memory and the rules, in bytes, if no part of them needs
    /// an alignment of more than 16 bytes.
    pub const fn bytes(&self) -> usize {
        const ALIGNED: usize = 15;
        (size_of::<Rules<'_>>() + size_of::<Evaluator<'_>>() + 8 * ALIGNED)
            .saturating_add(
                self.table
                    .outputs
                    .len()
                    .saturating_mul(size_of::<StrongestRule>()),
            )
            .saturating_add(self.outputs().saturating_mul(2 * size_of::<Outcome>()))
            .saturating_add(self.numbers().saturating_mul(size_of::<f64>()))
            .saturating_add(
                self.partials()
                    .saturating_mul(size_of::<PartialConjunction>()),
            )
    }
}

/// The memory of an [`Evaluator`], in parts.
#[derive(Debug)]
#[doc(hidden)] // For the C interface.
pub struct RuleMemory<'m> {
    /// The floating-point numbers; their count is [`Rules::numbers`].
    pub numbers: &'m mut [f64],
    /// The partial conjunctions; their count is [`Rules::partials`].
    pub partials: &'m mut [PartialConjunction],
    /// The strongest rule of each output of the table.
    pub strongest: &'m mut [StrongestRule],
    /// The outcome of each output; the length is [`Rules::outputs`].
    pub outcomes: &'m mut [Outcome],
    /// The outcomes of one stage of a chain; the length is [`Rules::outputs`].
    pub own: &'m mut [Outcome],
}

/// Evaluates a rule set in memory that the caller provides.
#[derive(Debug)]
#[doc(hidden)] // For the C interface. For Rust, `flagred export --rust` writes a function instead.
pub struct Evaluator<'a> {
    pub(super) rules: &'a Rules<'a>,
    pub(super) scratch: Scratch<'a>,
    /// The values passed between stages.
    pub(super) values: Values<'a>,
    pub(super) outcomes: &'a mut [Outcome],
}

impl<'a> Evaluator<'a> {
    /// Creates an evaluator; `None` if the memory does not have the sizes that the rules require.
    pub fn new(rules: &'a Rules<'a>, memory: RuleMemory<'a>) -> Option<Evaluator<'a>> {
        let RuleMemory {
            mut numbers,
            mut partials,
            strongest,
            outcomes,
            own,
        } = memory;
        let sizes = rules.table.sizes;
        let fits = strongest.len() == rules.table.outputs.len()
            && [outcomes.len(), own.len()] == [rules.outputs(); 2];
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

    /// Evaluates the rules and returns one outcome for each output; `None` unless there is one value for each input.
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

/// Takes the first `count` items off a slice.
pub(super) fn take<'m, T>(rest: &mut &'m mut [T], count: usize) -> Option<&'m mut [T]> {
    let (taken, left) = core::mem::take(rest).split_at_mut_checked(count)?;
    *rest = left;
    Some(taken)
}
