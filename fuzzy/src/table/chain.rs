//! A rule set in which outputs read other outputs, as plain arrays: the arrays of its stages are concatenated.

use super::{
    Conjunctions, Curve, DamagedArray, Hedge, Outcome, Point, Scratch, Sizes, State, Table,
    concluded_by, raised_by,
};

/// A stage: outputs that are evaluated in one pass.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[repr(C)]
pub struct Stage {
    /// The code of the data structure that finds the firing rules: see [`Conjunctions::code`].
    pub conjunctions: u32,
    /// The number of actions per cell; uniform tables only.
    pub actions_per_cell: u32,
    /// The index of the first action of the first cell; uniform tables only.
    pub first_action: u32,
    /// 1 if an action sums firing strengths, else 0; uniform tables only.
    pub sums: u32,
    /// The sizes of the scratch memory of the stage.
    pub sizes: Sizes,
    /// The number of outputs that the stage reads. Their indices are in [`Chain::indices`].
    pub reads: u32,
    /// The number of outputs of the stage. Their indices in the model follow in [`Chain::indices`].
    pub outputs: u32,
    /// The number of rules of the stage. Their indices in the model follow in [`Chain::indices`].
    pub rules: u32,
    /// The end of the stage's part of each array. The part begins at the end of the previous
    /// stage's part.
    pub ends: Ends,
}

macro_rules! define {
    ($($(#[$doc:meta])* $array:ident: $item:ident,)*) => {
        /// The end of a stage in each array of the chain.
        #[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
        #[repr(C)]
        pub struct Ends {
            $($(#[$doc])* pub $array: u32,)*
        }

        impl<'a> Table<'a> {
            /// Returns the table of a stage.
            fn part(&self, stage: &Stage, first: Ends) -> Option<Table<'a>> {
                Some(Table {
                    and: self.and,
                    or: self.or,
                    conjunctions: Conjunctions::from_code([
                        stage.conjunctions,
                        stage.actions_per_cell,
                        stage.first_action,
                        stage.sums,
                    ])?,
                    least_strength: self.least_strength,
                    sizes: stage.sizes,
                    $($array: self.$array.get(first.$array as usize..stage.ends.$array as usize)?,)*
                })
            }
        }
    };
}
super::arrays!(define!);

impl Conjunctions {
    /// Returns the code in plain data: the variant, followed by the fields of a uniform table.
    pub const fn code(self) -> [u32; 4] {
        match self {
            Conjunctions::Uniform {
                actions_per_cell,
                first_action,
                sums,
            } => [0, actions_per_cell, first_action, sums as u32],
            Conjunctions::Dense => [1, 0, 0, 0],
            Conjunctions::Trie => [2, 0, 0, 0],
        }
    }

    /// Returns the variant with the given code; `None` if the code is invalid.
    pub const fn from_code(code: [u32; 4]) -> Option<Conjunctions> {
        let [which, actions_per_cell, first_action, sums] = code;
        Some(match which {
            0 => Conjunctions::Uniform {
                actions_per_cell,
                first_action,
                sums: sums != 0,
            },
            1 => Conjunctions::Dense,
            2 => Conjunctions::Trie,
            _ => return None,
        })
    }
}

/// The indices in the model of the outputs and rules of a stage.
#[derive(Debug, Clone, Copy)]
pub struct StageIndices<'a> {
    /// The index in the model of each output that the stage reads. In [`Values::inputs`], the values of these
    /// outputs follow the values of the inputs.
    pub reads: &'a [u32],
    /// The index in the model of each output of the stage.
    pub outputs: &'a [u32],
    /// The index in the model of each rule of the stage.
    pub rules: &'a [u32],
}

/// The stages of a rule set in the order of evaluation.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Chain<'a> {
    /// The concatenated arrays of all stages. The curves are followed by the terms of the propositions about
    /// outputs, in the order of the propositions.
    pub table: Table<'a>,
    /// The stages.
    pub stages: &'a [Stage],
    /// For each stage, the indices in the model of the outputs that it reads, of its outputs, and of its rules.
    pub indices: &'a [u32],
}

/// The memory that an evaluation needs in addition to the scratch memory.
#[derive(Debug)]
pub struct Values<'m> {
    /// The values of the inputs of the model, followed by the values of the outputs that a stage reads.
    pub inputs: &'m mut [f64],
    /// The outcomes of a stage. There must be room for as many outcomes as the model has outputs.
    pub own: &'m mut [Outcome],
}

/// The criterion for selecting a rule.
#[derive(Debug, Clone, Copy)]
pub enum StageRuleCriterion {
    /// Selects the rule that most raises an output with this value: see [`Table::raised_by`].
    Raises(f64),
    /// Selects the rule that contributes most to a proposition about the output. The number is the index of the
    /// proposition among all propositions about outputs.
    Concludes(usize),
}

impl<'a> Chain<'a> {
    /// Iterates over the tables of the stages, each with the indices of the stage in the model. It ends at the first
    /// damaged stage.
    pub fn parts(self) -> impl Iterator<Item = (Table<'a>, StageIndices<'a>)> {
        let mut first = Ends::default();
        let mut unread = self.indices;
        self.stages.iter().map_while(move |stage| {
            let mut take = |count: u32| {
                let (taken, rest) = unread.split_at_checked(count as usize)?;
                unread = rest;
                Some(taken)
            };
            let indices = StageIndices {
                reads: take(stage.reads)?,
                outputs: take(stage.outputs)?,
                rules: take(stage.rules)?,
            };
            let table = self.table.part(stage, first)?;
            first = stage.ends;
            Some((table, indices))
        })
    }

    /// Returns the maximum number of outputs that a stage reads.
    pub const fn most_reads(&self) -> usize {
        let (mut most, mut i) = (0, 0);
        while i < self.stages.len() {
            if self.stages[i].reads > most {
                most = self.stages[i].reads;
            }
            i += 1;
        }
        most as usize
    }

    /// Verifies every index and size, as [`Table::check`] does, for a rule set with `inputs` inputs.
    ///
    /// # Errors
    /// The first array with an index out of bounds.
    pub fn check(&self, inputs: usize) -> Result<(), DamagedArray> {
        let require = |holds: bool, array| holds.then_some(()).ok_or(DamagedArray(array));
        let outputs = self.table.outcomes();
        let is_output = |output: &u32| (*output as usize) < outputs;
        require(self.parts().count() == self.stages.len(), "stages")?;
        for (table, indices) in self.parts() {
            table.check()?;
            let sizes = [table.sizes, self.table.sizes].map(|sizes| {
                let Sizes {
                    degrees,
                    alive,
                    partial,
                    stack,
                    strengths,
                } = sizes;
                [degrees, alive, partial, stack, strengths]
            });
            let fits = sizes[0].iter().zip(&sizes[1]).all(|(own, all)| own <= all);
            require(
                fits && table.inputs.len() == inputs.saturating_add(indices.reads.len())
                    && table.outcomes() == indices.outputs.len(),
                "stages",
            )?;
            let mut of_model = indices.reads.iter().chain(indices.outputs);
            require(of_model.all(is_output), "indices")?;
        }
        let first = self.first_conclusion();
        let conclusions = self.table.curves.get(first..).unwrap_or(&[]);
        let (points, hedges) = (self.table.points.len(), self.table.hedges.len());
        require(
            conclusions.iter().all(|curve| {
                let of_points = curve.first_point <= curve.end_point;
                let of_hedges = curve.first_hedge <= curve.end_hedge;
                of_points
                    && of_hedges
                    && curve.end_point as usize <= points
                    && curve.end_hedge as usize <= hedges
            }),
            "curves",
        )
    }

    fn first_conclusion(&self) -> usize {
        self.stages
            .last()
            .map_or(0, |last| last.ends.curves as usize)
    }

    /// Evaluates one value per input into one outcome per output of the model, as [`Table::evaluate`] does. The scratch
    /// memory must have the sizes of the table.
    pub fn evaluate(
        &self,
        scratch: &mut Scratch<'_>,
        values: &mut Values<'_>,
        inputs: &[f64],
        outcomes: &mut [Outcome],
    ) {
        let Values { inputs: read, own } = values;
        for (table, indices) in self.parts() {
            let Some(mut scratch) = fitted(scratch, &table) else {
                return;
            };
            let given = (inputs, &mut **read, &mut **own);
            let evaluate = |inputs: &[f64], own: &mut [Outcome]| {
                table.evaluate(&mut scratch, inputs, own);
            };
            stage(indices, given, outcomes, evaluate, &mut |_, _| {});
        }
    }

    /// Searches for a rule, and calls `found` with its index in evaluation order (which counts the rules of all stages)
    /// and the degrees of the literals of its stage. `outcomes` must be the outcomes at `inputs`.
    pub fn rule_of<R>(
        &self,
        scratch: &mut Scratch<'_>,
        values: &mut Values<'_>,
        (inputs, outcomes): (&[f64], &[Outcome]),
        (output, criterion): (usize, StageRuleCriterion),
        found: impl FnOnce(usize, &[f64]) -> Option<R>,
    ) -> Option<R> {
        let mut rules = 0;
        for (table, indices) in self.parts() {
            let own = indices
                .outputs
                .iter()
                .position(|own| *own as usize == output);
            let Some(own) = own else {
                rules += indices.rules.len();
                continue;
            };
            let all = values.inputs.get_mut(..table.inputs.len())?;
            let (given, reads) = all.split_at_mut_checked(inputs.len())?;
            given.copy_from_slice(inputs);
            for (value, read) in reads.iter_mut().zip(indices.reads) {
                *value = outcomes.get(*read as usize)?.value()?;
            }
            let mut scratch = fitted(scratch, &table)?;
            let rule = match criterion {
                StageRuleCriterion::Raises(value) => {
                    raised_by(&table, &mut scratch.rows(), all, (own, value), |_, _| None)
                }
                StageRuleCriterion::Concludes(number) => {
                    let curve = self.table.curves.get(self.first_conclusion() + number)?;
                    let degree = |x: f64| self.degree(curve, x);
                    concluded_by(&table, &mut scratch.rows(), all, (own, degree), |_, _| None)
                }
            };
            return found(rules + rule?, scratch.degrees);
        }
        None
    }

    /// Converts the index of a rule in evaluation order to its index in the model.
    pub fn rule(&self, index: usize) -> Option<usize> {
        let rules = self.parts().flat_map(|(_, indices)| indices.rules);
        rules.map(|rule| *rule as usize).nth(index)
    }

    /// Returns those outputs without a closed form that other outputs read or that have the index `risk`.
    pub fn outputs_without_closed_form(self, risk: usize) -> impl Iterator<Item = usize> + use<'a> {
        let is_read = move |output: u32| {
            let mut reads = self.parts().flat_map(|(_, indices)| indices.reads);
            output as usize == risk || reads.any(|read| *read == output)
        };
        let all = self
            .parts()
            .flat_map(|(table, indices)| table.outputs.iter().zip(indices.outputs));
        let open = all.filter(|(of, _)| of.form() == super::ClosedForm::Integrated);
        open.map(|(_, output)| *output)
            .filter(move |output| is_read(*output))
            .map(|output| output as usize)
    }

    fn degree(&self, curve: &Curve, x: f64) -> f64 {
        let span = |first: u32, end: u32| first as usize..end as usize;
        let points: Option<&[Point]> = self
            .table
            .points
            .get(span(curve.first_point, curve.end_point));
        let hedges: Option<&[Hedge]> = self
            .table
            .hedges
            .get(span(curve.first_hedge, curve.end_hedge));
        match (points, hedges) {
            (Some(points), Some(hedges)) => {
                let mut degree = [0.0];
                curve.degrees(points, hedges, &[x], &mut degree);
                degree[0]
            }
            _ => 0.0,
        }
    }
}

/// Returns the part of the scratch memory that a stage needs; `None` if the memory is too small.
fn fitted<'s>(scratch: &'s mut Scratch<'_>, table: &Table<'_>) -> Option<Scratch<'s>> {
    let sizes = table.sizes;
    Some(Scratch {
        values: scratch.values.get_mut(..table.inputs.len())?,
        degrees: scratch.degrees.get_mut(..sizes.degrees as usize)?,
        alive: scratch.alive.get_mut(..sizes.alive as usize)?,
        partial: scratch.partial.get_mut(..sizes.partial as usize)?,
        next: scratch.next.get_mut(..sizes.partial as usize)?,
        stack: scratch.stack.get_mut(..sizes.stack as usize)?,
        strengths: scratch.strengths.get_mut(..sizes.strengths as usize)?,
        strongest: scratch.strongest.get_mut(..table.outputs.len())?,
    })
}

/// Evaluates a stage: reads the values of other outputs from `outcomes`, and writes the outcomes of the stage to
/// `outcomes`. `keep` may change an outcome before other outputs read it.
pub(crate) fn stage(
    indices: StageIndices<'_>,
    (inputs, values, own): (&[f64], &mut [f64], &mut [Outcome]),
    outcomes: &mut [Outcome],
    evaluate: impl FnOnce(&[f64], &mut [Outcome]),
    keep: &mut impl FnMut(usize, &mut Outcome),
) {
    let (mut unknown, mut clamped) = (None, false);
    for (value, given) in values.iter_mut().zip(inputs) {
        *value = *given;
    }
    let reads = values.iter_mut().skip(inputs.len()).zip(indices.reads);
    for (value, read) in reads {
        let Some(outcome) = outcomes.get(*read as usize) else {
            return;
        };
        clamped |= outcome.clamped;
        match outcome.value() {
            Some(known) => *value = known,
            None => unknown = Some(outcome.state),
        }
    }
    let all = values.get(..inputs.len() + indices.reads.len());
    let (Some(all), Some(own)) = (all, own.get_mut(..indices.outputs.len())) else {
        return;
    };
    match unknown {
        None => evaluate(all, own),
        // The default value applies to inputs for which no rule fires; here the inputs are unknown.
        Some(State::InputNotFinite) => own.fill(Outcome {
            state: State::InputNotFinite,
            ..Outcome::UNDEFINED
        }),
        Some(_) => own.fill(Outcome::UNDEFINED),
    }
    for (output, own) in indices.outputs.iter().zip(own) {
        let rule_of_model = |rule: usize| indices.rules.get(rule).map(|rule| *rule as usize);
        if let Some(outcome) = outcomes.get_mut(*output as usize) {
            *outcome = Outcome {
                dominant_rule: own.dominant_rule.and_then(rule_of_model),
                clamped: own.clamped || clamped,
                ..*own
            };
            keep(*output as usize, outcome);
        }
    }
}
