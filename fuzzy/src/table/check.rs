//! Verification of the indices of a table.

use super::{
    ClosedForm, Conjunctions, Dimension, FuzzySet, Input, LOWER_BOUNDS, LayeredSet, Op, Output,
    Table, TypeReduction,
};

/// The error for damaged exported data: the name of the array with an index out of bounds.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct DamagedArray(pub &'static str);

impl core::fmt::Display for DamagedArray {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        write!(
            f,
            "damaged table: an index in `{}` is out of bounds",
            self.0
        )
    }
}

impl core::error::Error for DamagedArray {}

/// Returns an error that names the array unless the condition is true.
fn require(holds: bool, array: &'static str) -> Result<(), DamagedArray> {
    holds.then_some(()).ok_or(DamagedArray(array))
}

/// Returns whether a range of indices is inside an array of the given length.
fn within(first: u32, end: u32, length: usize) -> bool {
    first <= end && end as usize <= length
}

impl Table<'_> {
    /// Returns whether the fields of an output for type reduction are valid: either its value is not an interval, or
    /// its type reduction is valid and the output with its lower bounds exists.
    fn has_lower_bounds(&self, output: &Output) -> bool {
        let is_valid = (output.reduction as usize) <= TypeReduction::ALL.len();
        let lower = self.outputs.get(output.lower as usize);
        let is_lower = lower.is_some_and(|lower| lower.reduction == LOWER_BOUNDS);
        matches!(output.reduction, 0 | LOWER_BOUNDS) || (is_valid && is_lower)
    }

    /// Verifies every index and size, so that an evaluation cannot panic. Exported tables always pass; a table that was
    /// edited or corrupted may not.
    ///
    /// # Errors
    /// The first array with an index out of bounds.
    pub fn check(&self) -> Result<(), DamagedArray> {
        let literals = self.sizes.degrees as usize;
        let inputs = self.inputs.len();

        for input in self.inputs {
            require(
                input.low.is_finite()
                    && input.high.is_finite()
                    && within(input.first_cut, input.end_cut, self.cuts.len())
                    && within(input.first_curve, input.end_curve, self.curves.len())
                    && (self.starts.is_empty() || self.starts_of(input).is_some())
                    && (literals == 0 || self.fits_literals(input, literals)),
                "inputs",
            )?;
        }
        let last = self.starts.last().copied().unwrap_or(0);
        require(
            self.starts.is_sorted() && last as usize <= self.lines.len(),
            "starts",
        )?;
        for curve in self.curves {
            require(
                within(curve.first_point, curve.end_point, self.points.len())
                    && within(curve.first_hedge, curve.end_hedge, self.hedges.len()),
                "curves",
            )?;
        }
        for action in self.actions {
            require(
                action.strength < self.sizes.strengths
                    && (action.output as usize) < self.outputs.len(),
                "actions",
            )?;
        }
        match self.conjunctions {
            Conjunctions::Uniform {
                actions_per_cell,
                first_action,
                ..
            } => self.check_uniform(u64::from(actions_per_cell), u64::from(first_action))?,
            Conjunctions::Dense => self.check_dense()?,
            Conjunctions::Trie => self.check_trie(literals)?,
        }
        for program in self.programs {
            require(
                within(program.first_step, program.end_step, self.steps.len())
                    && within(program.first_action, program.end_action, self.actions.len())
                    && within(program.first_hedge, program.end_hedge, self.hedges.len())
                    && self.fits_stack(program.first_step as usize..program.end_step as usize),
                "programs",
            )?;
        }
        for block in self.blocks {
            let rules = block.end_program.saturating_sub(block.first_program);
            require(
                within(block.first_program, block.end_program, self.programs.len())
                    && rules <= self.sizes.partial,
                "blocks",
            )?;
        }
        for step in self.steps {
            let has_literal = matches!(step.op, Op::PUSH | Op::AND_LITERAL | Op::OR_LITERAL);
            require(!has_literal || (step.literal as usize) < literals, "steps")?;
        }
        let kinds = self
            .outputs
            .iter()
            .map(|output| output.reduction == LOWER_BOUNDS);
        require(kinds.is_sorted(), "outputs")?;
        for output in self.outputs {
            let strengths = output.end_strength.saturating_sub(output.first_strength) as usize;
            let numbers = output.end.saturating_sub(output.first) as usize;
            let form = output.form();
            let length = match form {
                ClosedForm::Partition | ClosedForm::ScaledPartition => self.pairs.len(),
                ClosedForm::Layers => self.layered_sets.len(),
                ClosedForm::Moments => self.moments.len(),
                ClosedForm::WeightedAverage | ClosedForm::WeightedSum => self.consequents.len(),
                ClosedForm::Tsukamoto => self.curves.len(),
                ClosedForm::Cut | ClosedForm::Scaled => self.sets.len(),
                ClosedForm::Integrated => 0,
            };
            let of_all = self.sizes.strengths as usize;
            require(
                within(output.first_strength, output.end_strength, of_all)
                    && within(output.first, output.end, length)
                    && (form != ClosedForm::Partition || 2 * numbers < strengths)
                    && self.has_lower_bounds(output),
                "outputs",
            )?;
            if form == ClosedForm::Layers {
                require(numbers == 1, "outputs")?;
                self.check_layers(&self.layered_sets[output.first as usize], strengths)?;
            }
            if let ClosedForm::Cut | ClosedForm::Scaled = form {
                require(numbers == 1, "outputs")?;
                self.check_set(&self.sets[output.first as usize], strengths)?;
            }
        }
        for term in self.set_terms {
            let span = within(term.first_flank, term.end_flank, self.flanks.len());
            require(span, "set_terms")?;
        }
        for flank in self.flanks {
            let span = within(flank.first_knot, flank.end_knot, self.knots.len());
            require(span, "flanks")?;
        }
        for consequent in self.consequents {
            let span = within(consequent.first, consequent.end, self.coefficients.len())
                && within(
                    consequent.first_code,
                    consequent.end_code,
                    self.points.len(),
                );
            require(span, "consequents")?;
        }
        for coefficient in self.coefficients {
            require((coefficient.input as usize) < inputs, "coefficients")?;
        }
        Ok(())
    }

    /// Verifies the layers of an output that has `strengths` firing strengths.
    fn check_layers(&self, set: &LayeredSet, strengths: usize) -> Result<(), DamagedArray> {
        require(
            within(set.first_base, set.end_base, self.bases.len())
                && within(set.first_layer, set.end_layer, self.layers.len()),
            "layered_sets",
        )?;
        let bases = &self.bases[set.first_base as usize..set.end_base as usize];
        require(bases.len() < self.sizes.stack as usize, "bases")?;
        for (index, base) in bases.iter().enumerate() {
            let is_earlier = base.others as usize <= index;
            require(is_earlier && (base.strength as usize) < strengths, "bases")?;
        }
        for four in &self.layers[set.first_layer as usize..set.end_layer as usize] {
            let has_bases = four.bases.iter().all(|base| *base as usize <= bases.len());
            require(has_bases && (four.strength as usize) < strengths, "layers")?;
        }
        Ok(())
    }

    /// Verifies the set of an output that has `strengths` firing strengths.
    fn check_set(&self, set: &FuzzySet, strengths: usize) -> Result<(), DamagedArray> {
        let terms = set.end_term.saturating_sub(set.first_term) as usize;
        require(
            within(set.first_section, set.end_section, self.sections.len())
                && within(set.first_term, set.end_term, self.set_terms.len())
                && terms <= strengths,
            "sets",
        )?;
        for section in &self.sections[set.first_section as usize..set.end_section as usize] {
            let span = within(section.first_strand, section.end_strand, self.strands.len());
            require(span, "sections")?;
            let strands = section.first_strand as usize..section.end_strand as usize;
            for strand in &self.strands[strands] {
                let index = (strand.strength as usize) < terms;
                require(
                    index && (strand.flank as usize) < self.flanks.len(),
                    "strands",
                )?;
            }
        }
        Ok(())
    }

    fn check_uniform(&self, actions_per_cell: u64, first_action: u64) -> Result<(), DamagedArray> {
        let mut last_cell = 0;
        for axis in self.axes {
            let cuts = self
                .cuts
                .get(axis.first_cut as usize..axis.end_cut as usize);
            let cuts = cuts.ok_or(DamagedArray("axes"))?;
            // Infinity is padding and does not start an interval.
            let intervals = 1 + cuts.iter().filter(|cut| **cut < f64::INFINITY).count();
            let lines = self.lines.get(axis.first_line as usize..);
            let lines = lines.and_then(|lines| lines.get(..2 * intervals));
            let offset = lines.and_then(|lines| lines.iter().map(|line| line.literal).max());
            last_cell += u64::from(offset.ok_or(DamagedArray("axes"))?);
            require((axis.input as usize) < self.inputs.len(), "axes")?;
        }
        require(last_cell <= u64::from(u32::MAX), "axes")?;
        let end = (last_cell + 1).saturating_mul(actions_per_cell);
        require(
            first_action.saturating_add(end) <= self.actions.len() as u64,
            "actions",
        )?;
        let cells = 1u64.checked_shl(self.axes.len() as u32);
        let fits = cells.is_some_and(|cells| cells <= u64::from(self.sizes.partial));
        require(self.axes.len() == 2 || fits, "axes")
    }

    fn check_dense(&self) -> Result<(), DamagedArray> {
        let partial = self.sizes.partial as usize;
        let (mut last_cell, mut most) = (0, 1usize);
        for (i, dimension) in self.dimensions.iter().enumerate() {
            let input = self.inputs.get(dimension.input as usize);
            let alive = input.and_then(|input| self.alive_at_most(input));
            let (mut last, mut alive) = alive.ok_or(DamagedArray("dimensions"))?;
            if dimension.any != Dimension::NONE {
                last = last.max(dimension.any);
                alive += 1;
            }
            let offset = u64::from(last) * u64::from(dimension.stride);
            last_cell = u64::saturating_add(last_cell, offset);
            require(alive < self.sizes.alive as usize, "dimensions")?;
            if i + 1 < self.dimensions.len() {
                most = most.saturating_mul(alive.max(1));
                // The evaluation writes one element more than it counts.
                require(most < partial, "dimensions")?;
            }
        }
        let end = self.cells.last().map_or(usize::MAX, |end| *end as usize);
        require(
            partial > 0
                && last_cell <= u64::from(u32::MAX)
                && last_cell + 1 < self.cells.len() as u64
                && self.cells.is_sorted()
                && end <= self.actions.len(),
            "cells",
        )
    }

    fn check_trie(&self, literals: usize) -> Result<(), DamagedArray> {
        let mut edges = 0;
        for (i, node) in self.nodes.iter().enumerate() {
            edges += node.end_edge.saturating_sub(node.first_edge) as usize;
            require(
                within(node.first_action, node.end_action, self.actions.len())
                    && within(node.first_edge, node.end_edge, self.edges.len())
                    && edges <= self.edges.len(),
                "nodes",
            )?;
            for edge in &self.edges[node.first_edge as usize..node.end_edge as usize] {
                // Edges lead to later nodes only, so no path contains a cycle.
                require(
                    edge.node as usize > i
                        && (edge.node as usize) < self.nodes.len()
                        && (edge.literal as usize) < literals,
                    "edges",
                )?;
            }
        }
        require(!self.nodes.is_empty() && self.sizes.partial > 0, "nodes")
    }

    /// Returns the limits, as indices in `lines`, of the intervals of an input.
    fn starts_of(&self, input: &Input) -> Option<&[u32]> {
        let intervals = input.end_cut.checked_sub(input.first_cut)? as usize + 1;
        let starts = self.starts.get(input.first_start as usize..)?;
        starts.get(..=intervals)
    }

    /// Returns whether the indices of the literals of an input are below `literals`.
    fn fits_literals(&self, input: &Input, literals: usize) -> bool {
        let first = u64::from(input.first_literal);
        let fits = |literal: u32| first + u64::from(literal) < literals as u64;
        let lines = self.starts_of(input).and_then(|starts| {
            let (first, last) = (starts.first()?, starts.last()?);
            self.lines.get(*first as usize..*last as usize)
        });
        let curves = input.first_curve as usize..input.end_curve as usize;
        let curves = self.curves.get(curves).unwrap_or_default();
        curves.iter().all(|curve| fits(curve.literal))
            && lines.is_some_and(|lines| lines.iter().all(|line| fits(line.literal)))
    }

    /// Returns the last literal of an input, and the maximum number of literals that can be above 0 at the same value.
    fn alive_at_most(&self, input: &Input) -> Option<(u32, usize)> {
        let curves = input.first_curve as usize..input.end_curve as usize;
        let curves = self.curves.get(curves)?;
        let mut last = curves.iter().map(|curve| curve.literal).max().unwrap_or(0);
        let mut most = 0;
        for ends in self.starts_of(input)?.windows(2) {
            let lines = self.lines.get(ends[0] as usize..ends[1] as usize)?;
            most = most.max(lines.len());
            last = lines.iter().map(|line| line.literal).fold(last, u32::max);
        }
        Some((last, most + curves.len()))
    }

    /// Returns whether a program has at least two degrees on the stack for each AND and OR, and never exceeds the size
    /// of the stack.
    fn fits_stack(&self, steps: core::ops::Range<usize>) -> bool {
        let mut depth = 0usize;
        let steps = self.steps.get(steps).unwrap_or_default();
        steps.iter().all(|step| {
            match step.op {
                Op::PUSH => depth += 1,
                Op::AND | Op::OR if depth < 2 => return false,
                Op::AND | Op::OR => depth -= 1,
                _ => {}
            }
            depth <= self.sizes.stack as usize
        })
    }
}
