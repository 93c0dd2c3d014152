//! Evaluation of columns of values to columns of outcomes: in blocks, on many threads, interruptible by Ctrl-C.

use std::{
    sync::Arc,
    time::{Duration, Instant},
};

use fuzzy::{
    Engine,
    engine::{self, EvaluateError, Sequence},
};
use pyo3::prelude::*;
use rayon::{ThreadPool, prelude::*};

use crate::{
    errors::data_error,
    outcome::{Columns, Ends, Reasons, rule_number},
    threads,
};

/// The number of rows in a block, chosen so that their outcomes fit into the cache.
const BLOCK: usize = 1024;

/// Evaluates several tables one after another. If an output keeps its previous value when no rule fires, the value is
/// also kept from the end of one table to the start of the next.
pub(crate) struct Evaluator<'e> {
    engine: &'e Engine,
    sequence: Option<Sequence<'e>>,
    pool: Option<Arc<ThreadPool>>,
    threads: Option<usize>,
    with_reasons: bool,
}

/// The part of the results that receives the outcomes of one block of rows.
struct Block<'a> {
    first: usize,
    outputs: Vec<BlockOutput<'a>>,
}

struct BlockOutput<'a> {
    value: &'a mut [f64],
    ends: Option<(&'a mut [f64], &'a mut [f64])>,
    reasons: Option<(&'a mut [f64], &'a mut [i32], &'a mut [bool])>,
}

impl<'e> Evaluator<'e> {
    /// # Errors
    /// If `threads` is 0.
    pub(crate) fn new(
        engine: &'e Engine,
        threads: Option<usize>,
        with_reasons: bool,
    ) -> PyResult<Self> {
        threads::checked(threads)?;
        let keeps_previous = engine.model().keeps_previous();
        Ok(Evaluator {
            engine,
            sequence: keeps_previous.then(|| Sequence::new(engine)),
            pool: None,
            threads,
            with_reasons,
        })
    }

    /// Returns the outcomes of each output. All columns must have `rows` values. The interpreter is released during the
    /// evaluation.
    pub(crate) fn run(
        &mut self,
        py: Python<'_>,
        rows: usize,
        columns: &[&[f64]],
    ) -> PyResult<Vec<Columns>> {
        if columns.is_empty() {
            let message = "the rule set has no inputs, so it takes no rows";
            return Err(data_error(message, Some("call it without values".into())));
        }
        let model = self.engine.model();
        let outputs = model.outputs.iter();
        let mut results: Vec<Columns> = outputs
            .map(|output| Columns {
                value: vec![0.0; rows],
                reasons: self.with_reasons.then(|| Reasons {
                    ends: model.has_interval(output).then(|| Ends {
                        low: vec![0.0; rows],
                        high: vec![0.0; rows],
                    }),
                    coverage: vec![0.0; rows],
                    dominant_rule: vec![0; rows],
                    clamped: vec![false; rows],
                }),
            })
            .collect();
        let mut blocks = blocks(rows, &mut results);
        if rows > BLOCK && self.threads != Some(1) && self.sequence.is_none() && self.pool.is_none()
        {
            self.pool = Some(threads::pool(self.threads)?);
        }
        // A group of blocks takes about this long; Ctrl-C is checked after each group.
        const CHECK_INTERVAL: Duration = Duration::from_millis(50);
        let (mut from, mut at_once) = (0, 16);
        while from < blocks.len() {
            let to = blocks.len().min(from + at_once);
            let begun = Instant::now();
            let group = &mut blocks[from..to];
            let evaluator = &mut *self;
            py.detach(move || evaluator.group(columns, group))
                .map_err(|error| data_error(error, None))?;
            py.check_signals()?;
            if begun.elapsed() < CHECK_INTERVAL {
                at_once *= 2;
            }
            from = to;
        }
        drop(blocks);
        Ok(results)
    }

    fn group(&mut self, columns: &[&[f64]], group: &mut [Block<'_>]) -> Result<(), EvaluateError> {
        let engine = self.engine;
        let each = |block: &mut Block<'_>| {
            block.fill(columns, |part, outcomes| {
                engine.evaluate_batch_into(part, outcomes)
            })
        };
        match (&mut self.sequence, &self.pool) {
            (Some(sequence), _) => group.iter_mut().try_for_each(|block| {
                block.fill(columns, |part, outcomes| {
                    sequence.evaluate_batch_into(part, outcomes)
                })
            }),
            (None, Some(pool)) => pool.install(|| group.par_iter_mut().try_for_each(each)),
            (None, None) => group.iter_mut().try_for_each(each),
        }
    }
}

/// Divides the result into blocks of rows.
fn blocks(rows: usize, results: &mut [Columns]) -> Vec<Block<'_>> {
    let mut blocks: Vec<Block<'_>> = (0..rows.div_ceil(BLOCK))
        .map(|i| Block {
            first: i * BLOCK,
            outputs: Vec::new(),
        })
        .collect();
    for result in results {
        let (ends, reasons) = match &mut result.reasons {
            None => (None, None),
            Some(reasons) => (
                reasons.ends.as_mut(),
                Some((
                    &mut reasons.coverage,
                    &mut reasons.dominant_rule,
                    &mut reasons.clamped,
                )),
            ),
        };
        let mut ends = ends.map(|ends| ends.low.chunks_mut(BLOCK).zip(ends.high.chunks_mut(BLOCK)));
        let mut reasons = reasons.map(|(coverage, rules, clamped)| {
            coverage
                .chunks_mut(BLOCK)
                .zip(rules.chunks_mut(BLOCK))
                .zip(clamped.chunks_mut(BLOCK))
        });
        for (block, value) in blocks.iter_mut().zip(result.value.chunks_mut(BLOCK)) {
            let reasons = reasons.as_mut().and_then(Iterator::next);
            block.outputs.push(BlockOutput {
                value,
                ends: ends.as_mut().and_then(Iterator::next),
                reasons: reasons.map(|((coverage, rule), clamped)| (coverage, rule, clamped)),
            });
        }
    }
    blocks
}

impl Block<'_> {
    fn fill(
        &mut self,
        columns: &[&[f64]],
        evaluate: impl FnOnce(&[&[f64]], &mut [engine::Outcome]) -> Result<(), EvaluateError>,
    ) -> Result<(), EvaluateError> {
        let rows = self.outputs.first().map_or(0, |output| output.value.len());
        let part = self.first..self.first + rows;
        let part: Vec<&[f64]> = columns
            .iter()
            .map(|column| column.get(part.clone()).unwrap_or_default())
            .collect();
        let each = self.outputs.len();
        let mut outcomes = vec![engine::Outcome::default(); rows * each];
        evaluate(&part, &mut outcomes)?;
        for (i, output) in self.outputs.iter_mut().enumerate() {
            let outcomes = outcomes.iter().skip(i).step_by(each);
            for (to, outcome) in output.value.iter_mut().zip(outcomes.clone()) {
                *to = outcome.value().unwrap_or(f64::NAN);
            }
            if let Some((low, high)) = &mut output.ends {
                for ((low, high), outcome) in
                    low.iter_mut().zip(high.iter_mut()).zip(outcomes.clone())
                {
                    *low = outcome.low().unwrap_or(f64::NAN);
                    *high = outcome.high().unwrap_or(f64::NAN);
                }
            }
            let Some((coverage, rule, clamped)) = &mut output.reasons else {
                continue;
            };
            let to = coverage
                .iter_mut()
                .zip(rule.iter_mut())
                .zip(clamped.iter_mut());
            for (((coverage, rule), clamped), outcome) in to.zip(outcomes) {
                *coverage = outcome.coverage;
                *rule = rule_number(outcome.dominant_rule);
                *clamped = outcome.clamped;
            }
        }
        Ok(())
    }
}
