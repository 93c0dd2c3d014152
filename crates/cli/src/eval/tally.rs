//! Counts of rows, for the report at the end.

use super::{Plan, errors::Errors};
use crate::{output::print_note, table::Extent};

/// Maximum number of bad rows that are reported individually.
const SHOWN: usize = 20;

/// The number of rows with some property, and the first of them.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct RowCount {
    count: u64,
    first_line: u64,
}

impl RowCount {
    pub(super) fn add(&mut self, line: u64) {
        self.merge(RowCount {
            count: 1,
            first_line: line,
        });
    }

    pub(super) fn count(self) -> u64 {
        self.count
    }

    pub(super) fn first_line(self) -> Option<u64> {
        (self.count > 0).then_some(self.first_line)
    }

    /// Adds rows that come later.
    pub(super) fn merge(&mut self, later: RowCount) {
        if self.count == 0 {
            self.first_line = later.first_line;
        }
        self.count += later.count;
    }
}

/// Counts of rows by their problems, and the errors of the outputs.
pub(super) struct Tally {
    pub(super) rows: u64,
    bad: RowCount,
    /// Whether a row differs from the header in its number of cells.
    pub(super) has_misfit: bool,
    /// The problems of the first bad rows.
    shown: Vec<String>,
    /// Rows with an unknown input.
    pub(super) unknown: RowCount,
    /// For each output: rows in which no rule fires for it.
    pub(super) silent: Vec<RowCount>,
    /// For each input: rows in which it is outside its range.
    pub(super) clamped: Vec<RowCount>,
    /// For each input: the extent of its values.
    pub(super) extents: Vec<Extent>,
    /// For each output: its errors against measured values.
    pub(super) errors: Vec<Errors>,
}

impl Tally {
    pub(super) fn new(plan: &Plan) -> Tally {
        Tally {
            rows: 0,
            bad: RowCount::default(),
            has_misfit: false,
            shown: Vec::new(),
            unknown: RowCount::default(),
            silent: vec![RowCount::default(); plan.engine.output_names().len()],
            clamped: vec![RowCount::default(); plan.engine.input_names().len()],
            extents: vec![Extent::NONE; plan.engine.input_names().len()],
            errors: vec![Errors::default(); plan.engine.output_names().len()],
        }
    }

    pub(super) fn add_bad(&mut self, line: u64, problem: &str) {
        self.bad.add(line);
        if self.shown.len() < SHOWN {
            self.shown.push(format!("line {line}: {problem}"));
        }
    }

    /// Adds the counts of later rows.
    pub(super) fn merge(&mut self, later: Tally) {
        self.rows += later.rows;
        self.bad.merge(later.bad);
        self.has_misfit |= later.has_misfit;
        let free = SHOWN - self.shown.len();
        self.shown.extend(later.shown.into_iter().take(free));
        self.unknown.merge(later.unknown);
        for (rows, later) in self.silent.iter_mut().zip(later.silent) {
            rows.merge(later);
        }
        for (rows, later) in self.clamped.iter_mut().zip(later.clamped) {
            rows.merge(later);
        }
        for (extent, later) in self.extents.iter_mut().zip(later.extents) {
            *extent = extent.and(later);
        }
        for (errors, later) in self.errors.iter_mut().zip(later.errors) {
            errors.merge(later);
        }
    }

    /// Returns whether every written row has a value for all outputs.
    pub(super) fn is_complete(&self, plan: &Plan) -> bool {
        let all_read = self.bad.count == 0 || plan.skip_bad_rows;
        all_read && self.unknown.count == 0 && self.silent.iter().all(|rows| rows.count == 0)
    }

    /// Prints the counts on standard error.
    pub(super) fn print_notes(&self, plan: &Plan) {
        if self.rows == 0 {
            print_note(&format!("`{}` has a header, but no rows", plan.header.file));
        }
        let of = |rows: RowCount| format!("{} of {} rows", rows.count, self.rows);
        let first = |rows: RowCount| format!("first in line {}", rows.first_line);
        for bad in &self.shown {
            print_note(bad);
        }
        if self.bad.count > 0 {
            let more = self.bad.count - self.shown.len() as u64;
            if more > 0 {
                print_note(&format!("and {more} more"));
            }
            let what = match plan.skip_bad_rows {
                true => "left out",
                false => "no value in",
            };
            print_note(&format!("{what} {}: they cannot be read", of(self.bad)));
            if self.has_misfit {
                print_note(&format!("help: {}", plan.header.misfit_help()));
            }
        }
        if self.unknown.count > 0 {
            print_note(&format!(
                "no value in {}: an input is unknown ({})",
                of(self.unknown),
                first(self.unknown)
            ));
        }
        for (output, rows) in plan.engine.output_names().zip(&self.silent) {
            if rows.count > 0 {
                let why = match plan.has_formula(output) {
                    true => "no rule fires, or a formula has no finite value",
                    false => "no rule fires",
                };
                print_note(&format!(
                    "`{output}` has no value in {}: {why} ({})",
                    of(*rows),
                    first(*rows)
                ));
            }
        }
        for (output, errors) in plan.engine.output_names().zip(&self.errors) {
            errors.print_notes(output);
        }
        let inputs = &plan.engine.model().inputs;
        for (input, extent) in inputs.iter().zip(&self.extents) {
            if let Some(warning) = extent.warning(input) {
                print_note(&warning);
            }
        }
        for (input, rows) in inputs.iter().zip(&self.clamped) {
            if rows.count > 0 {
                print_note(&format!(
                    "`{}` is outside its range from {} to {} in {} and clamped to it ({})",
                    input.name,
                    input.low,
                    input.high,
                    of(*rows),
                    first(*rows)
                ));
            }
        }
    }
}
