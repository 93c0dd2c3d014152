//! A rule set in which outputs read others, as plain arrays: the arrays of its stages one after the other.

use super::{
    Conjunctions, Curve, Damaged, Hedge, Outcome, Point, Scratch, Sizes, State, Table,
    concluded_by, raised_by,
};

/// Outputs that are evaluated at once.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[repr(C)]
pub struct Stage {
    /// How its rules are found: see [`Conjunctions::code`].
    pub conjunctions: u32,
    /// Of a uniform table.
    pub actions_a_cell: u32,
    /// Of a uniform table.
    pub first_action: u32,
    /// Of a uniform table; not 0 where an action sums.
    pub sums: u32,
    /// The sizes of its scratch memory.
    pub sizes: Sizes,
    /// The number of outputs that it reads. Their indices stand in the places of the chain.
    pub reads: u32,
    /// The number of its outputs. Their indices in the model follow.
    pub outputs: u32,
    /// The number of its rules. Their indices in the model follow.
    pub rules: u32,
    /// Where its part of each array ends. It begins where that of the stage before ends.
    pub ends: Ends,
}

macro_rules! define {
    ($($(#[$doc:meta])* $array:ident: $item:ident,)*) => {
        /// Where a stage ends in each array of the chain.
        #[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
        #[repr(C)]
        pub struct Ends {
            $($(#[$doc])* pub $array: u32,)*
        }

        impl<'a> Table<'a> {
            /// The part of a stage.
            fn part(&self, stage: &Stage, first: Ends) -> Option<Table<'a>> {
                Some(Table {
                    and: self.and,
                    or: self.or,
                    conjunctions: Conjunctions::from_code([
                        stage.conjunctions,
                        stage.actions_a_cell,
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
    /// Its code as plain data: which one, then what a uniform table has.
    pub const fn code(self) -> [u32; 4] {
        match self {
            Conjunctions::Uniform {
                actions_a_cell,
                first_action,
                sums,
            } => [0, actions_a_cell, first_action, sums as u32],
            Conjunctions::Dense => [1, 0, 0, 0],
            Conjunctions::Trie => [2, 0, 0, 0],
        }
    }

    /// From its code.
    pub const fn from_code(code: [u32; 4]) -> Option<Conjunctions> {
        let [which, actions_a_cell, first_action, sums] = code;
        Some(match which {
            0 => Conjunctions::Uniform {
                actions_a_cell,
                first_action,
                sums: sums != 0,
            },
            1 => Conjunctions::Dense,
            2 => Conjunctions::Trie,
            _ => return None,
        })
    }
}

/// What a stage is in the whole rule set.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Place<'a> {
    /// The outputs that it reads. Their values stand after those of the inputs.
    pub(crate) reads: &'a [u32],
    /// The index in the model of each of its outputs.
    pub(crate) outputs: &'a [u32],
    /// The index in the model of each of its rules.
    pub(crate) rules: &'a [u32],
}

/// The stages of a rule set in the order of their evaluation.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Chain<'a> {
    /// The arrays of all stages, each one after those of the stage before. The curves end with the terms that propositions
    /// about outputs name, in their order.
    pub table: Table<'a>,
    /// The stages.
    pub stages: &'a [Stage],
    /// For each stage the outputs that it reads, its outputs, and its rules, by their indices in the model.
    pub places: &'a [u32],
}

/// The memory of an evaluation beside the scratch memory.
#[derive(Debug)]
pub struct Values<'m> {
    /// The values of the inputs, then of the outputs that a stage reads.
    pub inputs: &'m mut [f64],
    /// One for each output of a stage.
    pub own: &'m mut [Outcome],
}

/// Which rule is looked for.
#[derive(Debug, Clone, Copy)]
pub enum Sought {
    /// The one that raises an output of this value most: [`Table::raised_by`].
    Raises(f64),
    /// The one that says most that a proposition about the output holds, by its number among the propositions about outputs.
    Concludes(usize),
}

impl<'a> Chain<'a> {
    /// The stages with what they are in the rule set; damaged ones are left out.
    fn parts(self) -> impl Iterator<Item = (Table<'a>, Place<'a>)> {
        let mut first = Ends::default();
        let mut places = self.places;
        self.stages.iter().map_while(move |stage| {
            let mut take = |count: u32| {
                let (taken, rest) = places.split_at_checked(count as usize)?;
                places = rest;
                Some(taken)
            };
            let place = Place {
                reads: take(stage.reads)?,
                outputs: take(stage.outputs)?,
                rules: take(stage.rules)?,
            };
            let table = self.table.part(stage, first)?;
            first = stage.ends;
            Some((table, place))
        })
    }

    /// The most outputs that a stage reads.
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

    /// Verifies every index and size, as [`Table::check`], for a rule set with so many inputs.
    ///
    /// # Errors
    /// The first array with an index out of bounds.
    pub fn check(&self, inputs: usize) -> Result<(), Damaged> {
        let require = |holds: bool, array| holds.then_some(()).ok_or(Damaged(array));
        let outputs = self.table.outputs.len();
        let is_output = |output: &u32| (*output as usize) < outputs;
        require(self.parts().count() == self.stages.len(), "stages")?;
        for (table, place) in self.parts() {
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
                fits && table.inputs.len() == inputs.saturating_add(place.reads.len())
                    && table.outputs.len() == place.outputs.len(),
                "stages",
            )?;
            let mut of_model = place.reads.iter().chain(place.outputs);
            require(of_model.all(is_output), "places")?;
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

    /// Evaluates one value for each input into one outcome for each output of the model, as [`Table::evaluate`]. The scratch
    /// memory has the sizes of the table.
    pub fn evaluate(
        &self,
        scratch: &mut Scratch<'_>,
        values: &mut Values<'_>,
        inputs: &[f64],
        outcomes: &mut [Outcome],
    ) {
        let Values { inputs: read, own } = values;
        for (table, place) in self.parts() {
            let Some(mut scratch) = fitted(scratch, &table) else {
                return;
            };
            let given = (inputs, &mut **read, &mut **own);
            let evaluate = |inputs: &[f64], own: &mut [Outcome]| {
                table.evaluate(&mut scratch, inputs, own);
            };
            stage(place, given, outcomes, evaluate, &mut |_, _| {});
        }
    }

    /// Gives to `found` the place of the rule that is looked for, among those of all stages, and the degrees of the literals
    /// of its stage. `outcomes` are those of the inputs.
    pub fn rule_of<R>(
        &self,
        scratch: &mut Scratch<'_>,
        values: &mut Values<'_>,
        (inputs, outcomes): (&[f64], &[Outcome]),
        (output, sought): (usize, Sought),
        found: impl FnOnce(usize, &[f64]) -> Option<R>,
    ) -> Option<R> {
        let mut rules = 0;
        for (table, place) in self.parts() {
            let own = place.outputs.iter().position(|own| *own as usize == output);
            let Some(own) = own else {
                rules += place.rules.len();
                continue;
            };
            let all = values.inputs.get_mut(..table.inputs.len())?;
            let (given, reads) = all.split_at_mut_checked(inputs.len())?;
            given.copy_from_slice(inputs);
            for (value, read) in reads.iter_mut().zip(place.reads) {
                *value = outcomes.get(*read as usize)?.value()?;
            }
            let mut scratch = fitted(scratch, &table)?;
            let rule = match sought {
                Sought::Raises(value) => {
                    raised_by(&table, &mut scratch.rows(), all, (own, value), |_, _| None)
                }
                Sought::Concludes(number) => {
                    let curve = self.table.curves.get(self.first_conclusion() + number)?;
                    let degree = |x: f64| self.degree(curve, x);
                    concluded_by(&table, &mut scratch.rows(), all, (own, degree), |_, _| None)
                }
            };
            return found(rules + rule?, scratch.degrees);
        }
        None
    }

    /// The index in the model of the rule of a place.
    pub fn rule(&self, place: usize) -> Option<usize> {
        let rules = self.parts().flat_map(|(_, place)| place.rules);
        rules.map(|rule| *rule as usize).nth(place)
    }

    /// The outputs that have no closed form and are read, or are `risk`.
    pub fn open(self, risk: usize) -> impl Iterator<Item = usize> + use<'a> {
        let is_read = move |output: u32| {
            let mut reads = self.parts().flat_map(|(_, place)| place.reads);
            output as usize == risk || reads.any(|read| *read == output)
        };
        let all = self
            .parts()
            .flat_map(|(table, place)| table.outputs.iter().zip(place.outputs));
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

/// The part of a scratch memory that a stage needs.
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

/// Evaluates a stage: what it reads is handed over from the outcomes of all outputs, and its own ones are put there. `keep` may
/// change them before others read them.
pub(crate) fn stage(
    place: Place<'_>,
    (inputs, values, own): (&[f64], &mut [f64], &mut [Outcome]),
    outcomes: &mut [Outcome],
    evaluate: impl FnOnce(&[f64], &mut [Outcome]),
    keep: &mut impl FnMut(usize, &mut Outcome),
) {
    let (mut unknown, mut clamped) = (None, false);
    for (value, given) in values.iter_mut().zip(inputs) {
        *value = *given;
    }
    let reads = values.iter_mut().skip(inputs.len()).zip(place.reads);
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
    let all = values.get(..inputs.len() + place.reads.len());
    let (Some(all), Some(own)) = (all, own.get_mut(..place.outputs.len())) else {
        return;
    };
    match unknown {
        None => evaluate(all, own),
        // Its default value is for inputs without a rule; here the inputs are not known.
        Some(State::InputNotFinite) => own.fill(Outcome {
            state: State::InputNotFinite,
            ..Outcome::UNDEFINED
        }),
        Some(_) => own.fill(Outcome::UNDEFINED),
    }
    for (output, own) in place.outputs.iter().zip(own) {
        let rule_of_model = |rule: usize| place.rules.get(rule).map(|rule| *rule as usize);
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
