//! Many evaluations at once, over columns.

use alloc::{vec, vec::Vec};
use core::ops::Range;

use super::{Engine, EvaluateError, Outcome, Scratch};

/// Rows that one thread takes at a time.
#[cfg(feature = "parallel")]
const ROWS_A_TASK: usize = 4096;

impl Engine {
    /// Evaluates one column of values for each input, and gives the outcomes row by row: those of row i
    /// stand at `i * outputs..(i + 1) * outputs`.
    ///
    /// Each outcome has the bits that [`Engine::evaluate`] gives for its row, also with the feature `parallel`,
    /// which splits the rows over the threads of the current rayon pool. A row in which no rule fires says so
    /// ([`State::NoRuleFired`](super::State::NoRuleFired)) also where the author made that an error: one row
    /// takes nothing from the others.
    ///
    /// # Errors
    /// Not one column for each input, or columns of different lengths.
    ///
    /// # Example: two rows
    /// ```
    /// # use fuzzy::model::{Model, Output, MembershipFunction, Variable};
    /// # use fuzzy::rule::{Condition, Rule};
    /// # let model = Model::builder("m")
    /// #     .input(Variable::new("x", 0.0, 1.0).term("low", MembershipFunction::Triangle { left: 0.0, peak: 0.0, right: 0.5 }))
    /// #     .input(Variable::new("y", 0.0, 1.0))
    /// #     .output(Output::new(Variable::new("z", 0.0, 1.0).term("small", MembershipFunction::Rectangle { left: 0.0, right: 0.5 })))
    /// #     .rule(Rule::new(Condition::is("x", "low"), "z", "small")).build();
    /// use fuzzy::Engine;
    ///
    /// let engine = Engine::new(&model)?;
    /// let (x, y) = ([0.1, 0.9], [0.5, 0.5]);
    /// let outcomes = engine.evaluate_batch(&[&x, &y])?;
    /// assert_eq!(outcomes[0].value(), Some(0.25));
    /// assert_eq!(outcomes[1].value(), None);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn evaluate_batch(&self, columns: &[&[f64]]) -> Result<Vec<Outcome>, EvaluateError> {
        let rows = columns.first().map_or(0, |column| column.len());
        let mut outcomes = vec![Outcome::default(); rows * self.outputs.len()];
        self.evaluate_batch_into(columns, &mut outcomes)?;
        Ok(outcomes)
    }

    /// [`Engine::evaluate_batch`] into outcomes that the caller owns: one for each row and output.
    ///
    /// # Errors
    /// As [`Engine::evaluate_batch`]; and not one place for each row and output.
    ///
    /// # Example: outcomes that are used again and again
    /// ```
    /// use fuzzy::{Engine, engine::Outcome};
    ///
    /// # let model = fuzzy::yaml::parse(include_str!(concat!(env!("CARGO_MANIFEST_DIR"), "/../rules/flagred-paper.yaml")))?.model;
    /// let engine = Engine::new(&model)?;
    /// let mut outcomes = [Outcome::default(); 2];
    /// let (margin, spread) = ([0.4, f64::NAN], [0.1, 0.1]);
    /// engine.evaluate_batch_into(&[&margin, &spread], &mut outcomes)?;
    /// assert!(outcomes[0].value() < Some(10.0));
    /// assert_eq!(outcomes[1].value(), None, "an unknown margin is no margin");
    /// assert!(engine.evaluate_batch_into(&[&margin, &spread], &mut outcomes[..1]).is_err());
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn evaluate_batch_into(
        &self,
        columns: &[&[f64]],
        outcomes: &mut [Outcome],
    ) -> Result<(), EvaluateError> {
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
        self.rows(&mut self.scratch(), columns, 0, outcomes);
        Ok(())
    }

    /// Evaluates the rows from `first` on, as many as `outcomes` has room for.
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

    /// Evaluates the rows of `range` and calls `put` with the outcomes of each.
    pub(crate) fn evaluate_rows(
        &self,
        scratch: &mut Scratch,
        columns: &[&[f64]],
        range: Range<usize>,
        mut put: impl FnMut(&[Outcome]),
    ) {
        if let Some(lanes) = &self.lanes {
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
