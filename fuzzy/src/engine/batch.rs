//! Evaluations of many rows, given as columns.

use alloc::{vec, vec::Vec};
use core::ops::Range;

use super::{Engine, EvaluateError, Outcome, Scratch};

/// The number of rows in a task.
#[cfg(feature = "parallel")]
const ROWS_A_TASK: usize = 4096;

impl Engine {
    /// Evaluates a column of values for each input, and returns the outcomes row by row: those of row i have the indices
    /// `i * outputs..(i + 1) * outputs`.
    ///
    /// Each outcome has the bits of [`Engine::evaluate`]. The feature `parallel` splits the rows over the threads of the
    /// current rayon pool. A row where no rule fires is [`State::NoRuleFired`](super::State::NoRuleFired), also where the
    /// model makes that an error.
    ///
    /// # Errors
    /// The number of columns is not that of the inputs, or their lengths differ.
    ///
    /// # Example: two temperatures
    /// ```
    /// use fuzzy::{Engine, model::{Model, Output, MembershipFunction, Variable}, rule};
    ///
    /// let model = Model::builder("heater")
    ///     .input(Variable::new("room", 0.0, 20.0).term("cold", MembershipFunction::LeftShoulder { top: 0.0, foot: 10.0 }))
    ///     .output(Output::new(Variable::new("power", 0.0, 100.0).term("high", MembershipFunction::Rectangle { left: 50.0, right: 100.0 })))
    ///     .rule(rule::parse("IF room IS cold THEN power IS high")?)
    ///     .build();
    /// let engine = Engine::new(&model)?;
    /// let outcomes = engine.evaluate_batch(&[&[5.0, 15.0]])?;
    /// assert_eq!(outcomes[0].value(), Some(75.0));
    /// assert_eq!(outcomes[1].value(), None); // no rule fires
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn evaluate_batch(&self, columns: &[&[f64]]) -> Result<Vec<Outcome>, EvaluateError> {
        let rows = columns.first().map_or(0, |column| column.len());
        let mut outcomes = vec![Outcome::default(); rows * self.outputs.len()];
        self.evaluate_batch_into(columns, &mut outcomes)?;
        Ok(outcomes)
    }

    /// [`Engine::evaluate_batch`] into outcomes of the caller, one for each row and output.
    ///
    /// # Errors
    /// As [`Engine::evaluate_batch`], or the number of outcomes is wrong.
    pub fn evaluate_batch_into(
        &self,
        columns: &[&[f64]],
        outcomes: &mut [Outcome],
    ) -> Result<(), EvaluateError> {
        let rows = self.fits_columns(columns, outcomes)?;
        #[cfg(feature = "parallel")]
        if rows > ROWS_A_TASK {
            use rayon::prelude::*;
            outcomes
                .par_chunks_mut(ROWS_A_TASK * self.outputs.len())
                .enumerate()
                .for_each_init(
                    || self.scratch(),
                    |scratch, (task, outcomes)| {
                        self.rows(scratch, columns, task * ROWS_A_TASK, outcomes);
                    },
                );
            return Ok(());
        }
        #[cfg(not(feature = "parallel"))]
        let _ = rows;
        self.rows(&mut self.scratch(), columns, 0, outcomes);
        Ok(())
    }

    /// The number of rows: there is a column for each input, all of a length, and an outcome for each row and output.
    pub(super) fn fits_columns(
        &self,
        columns: &[&[f64]],
        outcomes: &[Outcome],
    ) -> Result<usize, EvaluateError> {
        if columns.len() != self.inputs.len() {
            return Err(EvaluateError::WrongNumberOfInputs {
                expected: self.inputs.len(),
                got: columns.len(),
            });
        }
        let rows = columns.first().map_or(0, |column| column.len());
        if let Some(column) = columns.iter().find(|column| column.len() != rows) {
            return Err(EvaluateError::ColumnsOfDifferentLengths {
                first: rows,
                other: column.len(),
            });
        }
        if outcomes.len() != rows * self.outputs.len() {
            return Err(EvaluateError::WrongNumberOfOutputs {
                expected: rows * self.outputs.len(),
                got: outcomes.len(),
            });
        }
        Ok(rows)
    }

    /// Evaluates the rows that begin at index `first`, as many as `outcomes` holds.
    fn rows(
        &self,
        scratch: &mut Scratch,
        columns: &[&[f64]],
        first: usize,
        outcomes: &mut [Outcome],
    ) {
        let mut rows = outcomes.chunks_exact_mut(self.outputs.len());
        let range = first..first + rows.len();
        self.evaluate_rows(scratch, columns, range, |outcomes| {
            if let Some(row) = rows.next() {
                row.copy_from_slice(outcomes);
            }
        });
    }

    /// Evaluates the rows of `range` and calls `put` with the outcomes of each row.
    pub(crate) fn evaluate_rows(
        &self,
        scratch: &mut Scratch,
        columns: &[&[f64]],
        range: Range<usize>,
        mut put: impl FnMut(&[Outcome]),
    ) {
        if let (None, Some(lanes)) = (&self.chain, &self.first.lanes) {
            lanes.rows(columns, range, |outcome| put(&[outcome]));
            return;
        }
        let mut row = vec![0.0; columns.len()];
        let mut outcomes = vec![Outcome::default(); self.outputs.len()];
        for i in range {
            for (value, column) in row.iter_mut().zip(columns) {
                *value = column[i];
            }
            self.outcomes(scratch, &row, &mut outcomes);
            put(&outcomes);
        }
    }
}
