//! Evaluation of many rows, passed as columns.

use alloc::{vec, vec::Vec};
use core::ops::Range;

use super::arrays::OwnedTable;
use super::{Engine, EvaluateError, Outcome, Scratch, Stage, StageScratch};
use crate::rows::each;
use crate::table::{self, Results};

/// The number of rows that are evaluated together: enough to fill several of the widest vectors and to keep the overhead
/// per block small, but few enough for the degrees to stay in the cache.
pub(crate) const ROWS: usize = 64;

/// Batches with fewer rows are evaluated row by row, which is faster.
const MIN_ROWS: usize = 16;

/// The number of rows per task.
#[cfg(feature = "parallel")]
const ROWS_PER_TASK: usize = 4096;

impl Engine {
    /// Evaluates one column of values per input, and returns the outcomes row by row: those of row i have the indices
    /// `i * outputs..(i + 1) * outputs`.
    ///
    /// Each outcome is bitwise equal to that of [`Engine::evaluate`]. The feature `parallel` distributes the rows over
    /// the threads of the current rayon pool. The outcome of a row for which no rule fires is
    /// [`State::NoRuleFired`](super::State::NoRuleFired), even if the model treats that as an error.
    ///
    /// # Errors
    /// The number of columns differs from the number of inputs, or the columns differ in length.
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

    /// Works like [`Engine::evaluate_batch`], but writes the outcomes to `outcomes`, which has one element per row and
    /// output.
    ///
    /// # Errors
    /// Fails like [`Engine::evaluate_batch`], and if the number of outcomes is wrong.
    pub fn evaluate_batch_into(
        &self,
        columns: &[&[f64]],
        outcomes: &mut [Outcome],
    ) -> Result<(), EvaluateError> {
        let rows = self.fits_columns(columns, outcomes)?;
        let outputs = self.outputs.len();
        let task = |memory: &mut Memory, first: usize, outcomes: &mut [Outcome]| {
            let range = first..first + outcomes.len() / outputs;
            if memory.rows.is_none() {
                // The outcomes are written directly, because `Results` cannot store intervals.
                for (row, outcomes) in range.zip(outcomes.chunks_exact_mut(outputs)) {
                    memory.take_row(columns, row);
                    self.outcomes(&mut memory.row, &memory.values, outcomes);
                }
                return;
            }
            self.evaluate_rows(memory, columns, range, |rows, output, results| {
                let place = (rows.start - first) * outputs + output;
                let places = outcomes[place..].iter_mut().step_by(outputs);
                for (row, place) in places.take(rows.len()).enumerate() {
                    *place = results.outcome(row);
                }
            });
        };
        #[cfg(feature = "parallel")]
        if rows > ROWS_PER_TASK {
            use rayon::prelude::*;
            outcomes
                .par_chunks_mut(ROWS_PER_TASK * outputs)
                .enumerate()
                .for_each_init(
                    || self.memory(ROWS_PER_TASK),
                    |memory, (index, outcomes)| task(memory, index * ROWS_PER_TASK, outcomes),
                );
            return Ok(());
        }
        task(&mut self.memory(rows), 0, outcomes);
        Ok(())
    }

    /// Evaluates the rows, and writes only the values of the outputs, into one column per output. A row without a
    /// value gets NaN. Each value is bitwise equal to [`Outcome::value`] of [`Engine::evaluate`].
    ///
    /// # Errors
    /// Fails like [`Engine::evaluate_batch`], and if `values` does not have one column per output, or its columns differ
    /// in length from those of the inputs.
    ///
    /// # Example: a column of temperatures
    /// ```
    /// use fuzzy::{Engine, Model};
    ///
    /// let model: Model = "
    /// fuzzy: 1
    /// name: fan
    /// inputs: {heat: {range: [0, 40], terms: {high: {right_shoulder: [20, 30]}}}}
    /// outputs: {speed: {range: [0, 9], partition: [slow, fast]}}
    /// rules: [IF heat IS high THEN speed IS fast]
    /// ".parse()?;
    /// let engine = Engine::new(&model)?;
    /// let mut speed = [0.0; 3];
    /// engine.evaluate_columns(&[&[10.0, 30.0, 40.0]], &mut [&mut speed])?;
    /// assert!(speed[0].is_nan()); // no rule fires
    /// assert_eq!(Some(speed[1]), engine.evaluate(&[30.0])?[0].value());
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn evaluate_columns(
        &self,
        columns: &[&[f64]],
        values: &mut [&mut [f64]],
    ) -> Result<(), EvaluateError> {
        let rows = self.rows_of(columns)?;
        if values.len() != self.outputs.len() {
            return Err(EvaluateError::WrongNumberOfOutputs {
                expected: self.outputs.len(),
                got: values.len(),
            });
        }
        if let Some(column) = values.iter().find(|column| column.len() != rows) {
            return Err(EvaluateError::ColumnsOfDifferentLengths {
                first: rows,
                other: column.len(),
            });
        }
        let task = |memory: &mut Memory, first: usize, values: &mut [&mut [f64]]| {
            let length = values.first().map_or(0, |column| column.len());
            let range = first..first + length;
            self.evaluate_rows(memory, columns, range, |rows, output, results| {
                let places = &mut values[output][rows.start - first..rows.end - first];
                for (row, place) in places.iter_mut().enumerate() {
                    *place = results.value(row);
                }
            });
        };
        #[cfg(feature = "parallel")]
        if rows > ROWS_PER_TASK {
            use rayon::prelude::*;
            let mut tasks: Vec<Vec<&mut [f64]>> = Vec::new();
            tasks.resize_with(rows.div_ceil(ROWS_PER_TASK), Vec::new);
            for column in values {
                for (task, part) in tasks.iter_mut().zip(column.chunks_mut(ROWS_PER_TASK)) {
                    task.push(part);
                }
            }
            tasks.into_par_iter().enumerate().for_each_init(
                || self.memory(ROWS_PER_TASK),
                |memory, (index, mut values)| task(memory, index * ROWS_PER_TASK, &mut values),
            );
            return Ok(());
        }
        task(&mut self.memory(rows), 0, values);
        Ok(())
    }

    /// Returns the number of rows, after checking that there is one column per input, all of the same length, and one
    /// outcome per row and output.
    pub(super) fn fits_columns(
        &self,
        columns: &[&[f64]],
        outcomes: &[Outcome],
    ) -> Result<usize, EvaluateError> {
        let rows = self.rows_of(columns)?;
        if outcomes.len() != rows * self.outputs.len() {
            return Err(EvaluateError::WrongNumberOfOutputs {
                expected: rows * self.outputs.len(),
                got: outcomes.len(),
            });
        }
        Ok(rows)
    }

    /// Returns the common length of the columns. There must be one column per input.
    fn rows_of(&self, columns: &[&[f64]]) -> Result<usize, EvaluateError> {
        if columns.len() != self.inputs.len() {
            return Err(EvaluateError::WrongNumberOfInputs {
                expected: self.inputs.len(),
                got: columns.len(),
            });
        }
        let rows = columns.first().map_or(0, |column| column.len());
        match columns.iter().find(|column| column.len() != rows) {
            None => Ok(rows),
            Some(column) => Err(EvaluateError::ColumnsOfDifferentLengths {
                first: rows,
                other: column.len(),
            }),
        }
    }

    /// Allocates the working memory of [`Engine::evaluate_rows`] for a number of rows.
    pub(crate) fn memory(&self, rows: usize) -> Memory {
        let stage = &self.first;
        // Models with chains, rule blocks or interval type-2 terms are evaluated row by row.
        let is_plain =
            self.chain.is_none() && stage.arrays.blocks.is_empty() && stage.bounds().is_none();
        Memory {
            rows: (is_plain && rows >= MIN_ROWS).then(|| {
                let arrays = stage.batch.as_ref().unwrap_or(&stage.arrays);
                RowsScratch {
                    stage: stage.scratch(arrays),
                    of_row: vec![0.0; arrays.sizes.strengths as usize],
                }
            }),
            row: self.scratch(),
            values: vec![0.0; self.inputs.len()],
            outcomes: vec![Outcome::default(); self.outputs.len()],
            results: vec![Results::NONE; self.outputs.len()],
        }
    }

    /// Evaluates the rows of `range` in blocks, and calls `put` with the indices of each block, the index of an output
    /// and its results.
    pub(crate) fn evaluate_rows(
        &self,
        memory: &mut Memory,
        columns: &[&[f64]],
        range: Range<usize>,
        mut put: impl FnMut(Range<usize>, usize, &Results<ROWS>),
    ) {
        let Memory {
            rows: several,
            row: scratch,
            values,
            outcomes,
            results,
        } = memory;
        for first in range.clone().step_by(ROWS) {
            let rows = first..range.end.min(first + ROWS);
            match several {
                Some(several) if rows.len() >= MIN_ROWS => {
                    self.first.results(several, columns, rows.clone(), results);
                }
                _ => {
                    for row in rows.clone() {
                        for (value, column) in values.iter_mut().zip(columns) {
                            *value = column[row];
                        }
                        self.outcomes(scratch, values, outcomes);
                        for (results, outcome) in results.iter_mut().zip(&*outcomes) {
                            results.set(row - first, outcome);
                        }
                    }
                }
            }
            for (output, results) in results.iter().enumerate() {
                put(rows.clone(), output, results);
            }
        }
    }
}

/// The working memory of a batch.
pub(crate) struct Memory {
    /// Memory for a block of rows, if the model supports evaluation in blocks.
    rows: Option<RowsScratch>,
    /// Memory for the evaluation of a single row.
    row: Scratch,
    /// The values of the inputs in a single row.
    values: Vec<f64>,
    /// The outcomes of a single row.
    outcomes: Vec<Outcome>,
    /// The results, one element per output.
    results: Vec<Results<ROWS>>,
}

impl Memory {
    /// Copies the values of a row.
    fn take_row(&mut self, columns: &[&[f64]], row: usize) {
        for (value, column) in self.values.iter_mut().zip(columns) {
            *value = column[row];
        }
    }
}

struct RowsScratch {
    stage: StageScratch<ROWS>,
    /// The firing strengths of one of the rows.
    of_row: Vec<f64>,
}

/// Returns the values of one column in the rows of a block. Missing rows are filled with the value of the first row.
#[inline(always)]
fn rows_in(column: &[f64]) -> [f64; ROWS] {
    <[f64; ROWS]>::try_from(column)
        .unwrap_or_else(|_| each(|row| column.get(row).or(column.first()).map_or(0.0, |x| *x)))
}

impl Stage {
    /// Evaluates between 1 and [`ROWS`] rows into the results of each output.
    fn results(
        &self,
        memory: &mut RowsScratch,
        columns: &[&[f64]],
        rows: Range<usize>,
        results: &mut [Results<ROWS>],
    ) {
        match &self.batch {
            Some(arrays) => self.dispatch::<false>(arrays, memory, columns, rows, results),
            // Uniform tables have their own compiled copy of the function, because they gain most from wide vectors.
            None if cfg!(feature = "simd") && table::has_cells_alone(&self.arrays) => {
                self.dispatch::<true>(&self.arrays, memory, columns, rows, results);
            }
            None => self.dispatch::<false>(&self.arrays, memory, columns, rows, results),
        }
    }

    /// Runs the copy of the evaluation that was compiled for the widest vectors of the processor. All copies perform
    /// the same operations, so their results are bitwise equal.
    fn dispatch<const CELLS: bool>(
        &self,
        arrays: &OwnedTable,
        memory: &mut RowsScratch,
        columns: &[&[f64]],
        rows: Range<usize>,
        results: &mut [Results<ROWS>],
    ) {
        #[cfg(feature = "simd")]
        fearless_simd::dispatch!(
            fearless_simd::Level::new(),
            _ => self.evaluate_block::<CELLS>(arrays, memory, columns, rows, results)
        );
        #[cfg(not(feature = "simd"))]
        self.evaluate_block::<CELLS>(arrays, memory, columns, rows, results);
    }

    #[inline(always)]
    fn evaluate_block<const CELLS: bool>(
        &self,
        arrays: &OwnedTable,
        memory: &mut RowsScratch,
        columns: &[&[f64]],
        rows: Range<usize>,
        results: &mut [Results<ROWS>],
    ) {
        let RowsScratch { stage, of_row } = memory;
        let StageScratch {
            table, workspace, ..
        } = stage;
        table::evaluate_rows::<_, _, _, _, ROWS, CELLS>(
            arrays,
            table,
            columns.iter().map(|column| rows_in(&column[rows.clone()])),
            |index, output, row, strengths| {
                for (strength, strengths) in of_row.iter_mut().zip(strengths) {
                    *strength = strengths[row];
                }
                let of_row = of_row.get(..strengths.len())?;
                table::value_in_row(arrays, index, output, of_row, |index, strengths| {
                    self.integrate(index, strengths, workspace)
                })
            },
            results,
        );
    }
}
