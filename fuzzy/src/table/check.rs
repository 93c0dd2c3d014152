//! Whether the arrays of a table lean on each other as they must.

use super::{Conjunctions, Op, Scratch, Set, Table};

/// What is wrong with a table: the array in which a number points beyond what it points into.
///
/// # Example: rules that lost an output
/// ```
/// use fuzzy::table::{Broken, Table};
///
/// # let model = fuzzy::yaml::parse(include_str!(concat!(env!("CARGO_MANIFEST_DIR"), "/../rules/flagred-paper.yaml")))?.model;
/// let engine = fuzzy::Engine::new(&model)?;
/// let Err(Broken(array)) = Table { outputs: &[], ..engine.table() }.check() else { return Err("whole".into()) };
/// assert_eq!(array, "actions");
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Broken(pub &'static str);

impl core::fmt::Display for Broken {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        write!(f, "the table is damaged: its {} point beyond it", self.0)
    }
}

impl core::error::Error for Broken {}

impl Table<'_> {
    /// Whether every number that points into an array points to a place in it, and every size is enough: then an
    /// evaluation does not panic. Tables that were exported pass; one that was changed by hand or damaged may not.
    ///
    /// # Errors
    /// The first array with a number that points beyond.
    ///
    /// # Example: a table whose lines were cut short
    /// ```
    /// use fuzzy::table::Table;
    ///
    /// # let model = fuzzy::yaml::parse(include_str!(concat!(env!("CARGO_MANIFEST_DIR"), "/../rules/flagred-paper.yaml")))?.model;
    /// # let engine = fuzzy::Engine::new(&model)?;
    /// let table = engine.table();
    /// assert_eq!(table.check(), Ok(()));
    /// let damaged = Table { lines: &table.lines[1..], ..table }.check().unwrap_err();
    /// assert_eq!(damaged.to_string(), "the table is damaged: its axes point beyond it");
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn check(&self) -> Result<(), Broken> {
        let within = |first: u32, end: u32, length: usize| first <= end && end as usize <= length;
        let holds = |holds: bool, array| holds.then_some(()).ok_or(Broken(array));
        let literals = self.sizes.degrees as usize;
        let inputs = self.inputs.len();

        holds(
            self.inputs.iter().all(|input| {
                let intervals = input.end_cut.saturating_sub(input.first_cut) as usize + 1;
                within(input.first_cut, input.end_cut, self.cuts.len())
                    && within(input.first_curve, input.end_curve, self.curves.len())
                    && (self.starts.is_empty()
                        || input.first_start as usize + intervals < self.starts.len())
            }),
            "inputs",
        )?;
        let last = self.starts.last().copied().unwrap_or(0);
        holds(
            self.starts.is_sorted() && last as usize <= self.lines.len(),
            "starts of intervals",
        )?;
        holds(
            self.curves.iter().all(|curve| {
                within(curve.first_point, curve.end_point, self.points.len())
                    && within(curve.first_hedge, curve.end_hedge, self.hedges.len())
            }),
            "curves",
        )?;
        let needs_degrees = !self.programs.is_empty() || self.conjunctions == Conjunctions::Trie;
        holds(!needs_degrees || self.literals_fit(literals), "literals")?;

        holds(
            self.actions.iter().all(|action| {
                action.place < self.sizes.heights && (action.output as usize) < self.outputs.len()
            }),
            "actions",
        )?;
        self.check_conjunctions(inputs, literals)?;
        holds(
            self.programs.iter().all(|program| {
                within(program.first_step, program.end_step, self.steps.len())
                    && within(program.first_action, program.end_action, self.actions.len())
                    && self.fits_stack(program.first_step as usize..program.end_step as usize)
            }),
            "programs",
        )?;
        holds(
            self.steps.iter().all(|step| {
                let has_literal = matches!(step.op, Op::PUSH | Op::AND_LITERAL | Op::OR_LITERAL);
                !has_literal || (step.literal as usize) < literals
            }),
            "steps",
        )?;
        holds(
            self.outputs.iter().all(|output| {
                let heights = output.end_height.saturating_sub(output.first_height) as usize;
                let numbers = output.end.saturating_sub(output.first) as usize;
                let length = match output.set {
                    Set::PARTITION => self.pairs.len(),
                    Set::MOMENTS => self.moments.len(),
                    Set::WEIGHTED_AVERAGE | Set::WEIGHTED_SUM => self.consequences.len(),
                    _ => 0,
                };
                within(
                    output.first_height,
                    output.end_height,
                    self.sizes.heights as usize,
                ) && within(output.first, output.end, length)
                    && (output.set != Set::PARTITION || 2 * numbers < heights)
            }),
            "outputs",
        )?;
        holds(
            self.consequences
                .iter()
                .all(|c| within(c.first, c.end, self.coefficients.len())),
            "consequences",
        )?;
        holds(
            self.coefficients
                .iter()
                .all(|c| (c.input as usize) < inputs),
            "coefficients",
        )
    }

    /// Whether scratch has the sizes of the table.
    ///
    /// # Example: room for one of two inputs
    /// ```
    /// # use fuzzy::table::{Partial, Scratch, Strongest};
    /// # let model = fuzzy::yaml::parse(include_str!(concat!(env!("CARGO_MANIFEST_DIR"), "/../rules/flagred-paper.yaml")))?.model;
    /// # let engine = fuzzy::Engine::new(&model)?;
    /// # let sizes = engine.table().sizes;
    /// # let mut degrees = vec![0.0; sizes.degrees as usize];
    /// # let mut stack = vec![0.0; sizes.stack as usize];
    /// # let mut heights = vec![0.0; sizes.heights as usize];
    /// # let mut alive = vec![Partial::NONE; sizes.alive as usize];
    /// # let mut partial = vec![Partial::NONE; sizes.partial as usize];
    /// # let mut next = partial.clone();
    /// # let mut strongest = [Strongest::NONE];
    /// # let (degrees, stack, heights) = (&mut degrees[..], &mut stack[..], &mut heights[..]);
    /// # let (alive, partial, next) = (&mut alive[..], &mut partial[..], &mut next[..]);
    /// # let strongest = &mut strongest[..];
    /// let values = &mut [0.0];
    /// let scratch = Scratch { values, degrees, alive, partial, next, stack, heights, strongest };
    /// assert!(!engine.table().fits(&scratch));
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn fits(&self, scratch: &Scratch<'_>) -> bool {
        let Scratch {
            values,
            degrees,
            alive,
            partial,
            next,
            stack,
            heights,
            strongest,
        } = scratch;
        values.len() == self.inputs.len()
            && degrees.len() == self.sizes.degrees as usize
            && alive.len() == self.sizes.alive as usize
            && partial.len() == self.sizes.partial as usize
            && next.len() == self.sizes.partial as usize
            && stack.len() == self.sizes.stack as usize
            && heights.len() == self.sizes.heights as usize
            && strongest.len() == self.outputs.len()
    }

    /// Whether every literal of an input is among so many.
    fn literals_fit(&self, literals: usize) -> bool {
        self.inputs.iter().all(|input| {
            let fits = |literal: u32| (input.first_literal as usize + literal as usize) < literals;
            let curves = input.first_curve as usize..input.end_curve as usize;
            let intervals = input.end_cut.saturating_sub(input.first_cut) as usize + 1;
            let first = input.first_start as usize;
            let ends = self
                .starts
                .get(first)
                .zip(self.starts.get(first + intervals));
            let lines =
                ends.and_then(|(start, end)| self.lines.get(*start as usize..*end as usize));
            let curves = self.curves.get(curves).unwrap_or_default();
            curves.iter().all(|curve| fits(curve.literal))
                && lines.is_some_and(|lines| lines.iter().all(|line| fits(line.literal)))
        })
    }

    fn check_conjunctions(&self, inputs: usize, literals: usize) -> Result<(), Broken> {
        let holds = |holds: bool, array| holds.then_some(()).ok_or(Broken(array));
        let actions = self.actions.len();
        let partial = self.sizes.partial as usize;
        match self.conjunctions {
            Conjunctions::Uniform {
                actions_a_cell,
                first_action,
                ..
            } => {
                let mut reach = 0usize;
                for axis in self.axes {
                    let cuts = self
                        .cuts
                        .get(axis.first_cut as usize..axis.end_cut as usize);
                    let real = cuts.map(|cuts| cuts.iter().filter(|cut| cut.is_finite()).count());
                    let lines = real.and_then(|real| {
                        let first = axis.first_line as usize;
                        self.lines.get(first..first + 2 * (real + 1))
                    });
                    holds((axis.input as usize) < inputs, "axes")?;
                    let most = lines.and_then(|lines| lines.iter().map(|l| l.literal).max());
                    reach += most.ok_or(Broken("axes"))? as usize;
                }
                let last = (reach + 1).saturating_mul(actions_a_cell as usize);
                let room = 1usize.checked_shl(self.axes.len() as u32);
                holds(
                    first_action as usize + last <= actions
                        && room.is_some_and(|room| self.axes.len() == 2 || room <= partial),
                    "cells",
                )
            }
            Conjunctions::Dense => {
                let (mut reach, mut most) = (0usize, 1usize);
                for (i, dimension) in self.dimensions.iter().enumerate() {
                    let input = self.inputs.get(dimension.input as usize);
                    let input = input.ok_or(Broken("dimensions"))?;
                    let (last, alive) = self.alive_at_most(input);
                    let any = (dimension.any != u32::MAX).then_some(dimension.any);
                    let last = any.map_or(last, |any| last.max(any));
                    reach += last as usize * dimension.stride as usize;
                    let alive = alive + usize::from(any.is_some());
                    holds(alive < self.sizes.alive as usize, "dimensions")?;
                    if i + 1 < self.dimensions.len() {
                        most = most.saturating_mul(alive.max(1));
                        // One more is written than counted.
                        holds(most < partial, "dimensions")?;
                    }
                }
                let ordered = self.cells.windows(2).all(|pair| pair[0] <= pair[1]);
                let end = self.cells.last().map_or(usize::MAX, |end| *end as usize);
                holds(
                    partial > 0 && reach + 1 < self.cells.len() && ordered && end <= actions,
                    "cells",
                )
            }
            Conjunctions::Trie => {
                let nodes = self.nodes.iter().enumerate().all(|(i, node)| {
                    let edges = node.first_edge as usize..node.end_edge as usize;
                    // Ever further down, so that no path comes back.
                    let edges = self.edges.get(edges);
                    let deeper =
                        |node: u32| node as usize > i && (node as usize) < self.nodes.len();
                    node.first_action <= node.end_action
                        && node.end_action as usize <= actions
                        && edges.is_some_and(|edges| {
                            edges
                                .iter()
                                .all(|e| deeper(e.node) && (e.literal as usize) < literals)
                        })
                });
                holds(
                    nodes && !self.nodes.is_empty() && partial > self.edges.len(),
                    "nodes",
                )
            }
        }
    }

    /// The last literal of an input, and the most of them alive at once.
    fn alive_at_most(&self, input: &super::Input) -> (u32, usize) {
        let curves = input.first_curve as usize..input.end_curve as usize;
        let curves = self.curves.get(curves).unwrap_or_default();
        let mut last = curves.iter().map(|curve| curve.literal).max().unwrap_or(0);
        let mut most = 0;
        let intervals = input.end_cut.saturating_sub(input.first_cut) as usize + 1;
        let first = input.first_start as usize;
        let starts = self
            .starts
            .get(first..=first + intervals)
            .unwrap_or_default();
        for ends in starts.windows(2) {
            let lines = self.lines.get(ends[0] as usize..ends[1] as usize);
            let lines = lines.unwrap_or_default();
            most = most.max(lines.len());
            last = lines.iter().map(|line| line.literal).fold(last, u32::max);
        }
        (last, most + curves.len())
    }

    /// Whether a program neither takes from an empty stack nor needs more than there is.
    fn fits_stack(&self, steps: core::ops::Range<usize>) -> bool {
        let mut depth = 0usize;
        self.steps
            .get(steps)
            .unwrap_or_default()
            .iter()
            .all(|step| {
                match step.op {
                    Op::PUSH => depth += 1,
                    Op::AND | Op::OR => match depth.checked_sub(1) {
                        Some(less) => depth = less,
                        None => return false,
                    },
                    _ => {}
                }
                depth <= self.sizes.stack as usize
            })
    }
}
