//! Rows of a table, evaluated and written as CSV.

use csv::ByteRecord;
use fuzzy::engine::{Enclosure, IntervalOutcome, Outcome, Sequence, State};

use super::{ExplanationColumn, Plan, tally::Tally, uncertain};
use crate::{
    failure::Failure,
    output::{self, cell},
    table::{Cell, Extent, Reader},
};

/// Maximum number of rows in a block.
const ROWS: usize = 4096;
/// A block ends after this number of bytes of text, because rows may be long.
const BLOCK_BYTES: usize = 16_000_000;

/// Rows that are read, evaluated and written together.
#[derive(Default)]
pub(super) struct Block {
    /// The rows, followed by spare records for reading.
    records: Vec<ByteRecord>,
    rows: usize,
    /// The rows as CSV.
    pub(super) written: Vec<u8>,
}

impl Block {
    /// Reads rows, and returns whether there may be more.
    pub(super) fn read(&mut self, reader: &mut Reader) -> csv::Result<bool> {
        self.records.resize_with(ROWS, ByteRecord::new);
        self.rows = 0;
        let mut bytes = 0;
        for record in &mut self.records {
            if !reader.read_byte_record(record)? {
                return Ok(false);
            }
            self.rows += 1;
            bytes += record.as_slice().len();
            if bytes > BLOCK_BYTES {
                break;
            }
        }
        Ok(true)
    }
}

/// Evaluates blocks of rows in its own memory.
pub(super) struct Evaluator<'p> {
    plan: &'p Plan,
    /// Set if outputs of the rule set keep their previous value.
    sequence: Option<Sequence<'p>>,
    /// Set if inputs are uncertain.
    enclosure: Option<Enclosure<'p>>,
    /// The values of each input.
    columns: Vec<Vec<f64>>,
    /// The half-widths of each input, if inputs are uncertain.
    half_widths: Vec<Vec<f64>>,
    /// The outcomes of the first row, then those of the second, and so on.
    outcomes: Vec<Outcome>,
    /// The problem of each row, if it has one.
    problems: Vec<Option<String>>,
}

impl<'p> Evaluator<'p> {
    pub(super) fn new(plan: &'p Plan) -> Evaluator<'p> {
        Evaluator {
            plan,
            sequence: (plan.engine.model().keeps_previous()).then(|| Sequence::new(&plan.engine)),
            enclosure: (!plan.half_widths.is_empty()).then(|| plan.engine.enclosure()),
            columns: vec![Vec::new(); plan.inputs.len()],
            half_widths: vec![Vec::new(); plan.half_widths.len()],
            outcomes: Vec::new(),
            problems: Vec::new(),
        }
    }

    /// Evaluates the rows of a block, and returns the counts for the report.
    pub(super) fn evaluate(&mut self, block: &mut Block) -> Result<Tally, Failure> {
        let plan = self.plan;
        let records = block.records.get(..block.rows).unwrap_or_default();
        self.columns.iter_mut().for_each(Vec::clear);
        self.half_widths.iter_mut().for_each(Vec::clear);
        self.problems.clear();
        for record in records {
            let problem = self.read(record);
            self.problems.push(problem);
        }
        let columns: Vec<&[f64]> = self.columns.iter().map(Vec::as_slice).collect();
        let extents = columns
            .iter()
            .map(|values| Extent::of(values.iter().copied()));
        let extents = extents.collect();
        let outputs = plan.engine.output_names().len();
        self.outcomes
            .resize(block.rows * outputs, Outcome::default());
        let outcomes = &mut self.outcomes;
        match &mut self.sequence {
            None => plan.engine.evaluate_batch_into(&columns, outcomes),
            Some(sequence) => sequence.evaluate_batch_into(&columns, outcomes),
        }
        .map_err(Failure::unreadable)?;

        let mut tally = Tally::new(plan);
        tally.rows = block.rows as u64;
        tally.extents = extents;
        block.written.clear();
        let mut writer = plan.writer(&mut block.written);
        let outcomes = self.outcomes.chunks_exact(outputs);
        for (row, (record, outcomes)) in records.iter().zip(outcomes).enumerate() {
            let line = record.position().map_or(0, csv::Position::line);
            let problem = self.problems.get(row).and_then(Option::as_deref);
            tally.has_misfit |= plan
                .header
                .misfit(record)
                .is_some_and(|(_, is_count)| is_count);
            match problem {
                Some(problem) => {
                    tally.add_bad(line, problem);
                    if plan.skip_bad_rows {
                        continue;
                    }
                }
                None => self.count(&mut tally, (row, record), outcomes, line),
            }
            self.write(&mut writer, row, record, outcomes)?;
        }
        writer.flush()?;
        drop(writer);
        Ok(tally)
    }

    /// Reads the inputs of a row, and returns the problem with it, if any. Unknown inputs, and all inputs of a bad row, are NaN.
    fn read(&mut self, record: &ByteRecord) -> Option<String> {
        let header = &self.plan.header;
        let misfit = header.misfit(record);
        let is_whole = misfit.is_none();
        let mut problems: Vec<String> = misfit.into_iter().map(|(problem, _)| problem).collect();
        for (values, column) in self.columns.iter_mut().zip(&self.plan.inputs) {
            // If a row has the wrong number of cells, its cells may be in the wrong columns.
            let text = match is_whole {
                true => record.get(*column).unwrap_or_default(),
                false => b"",
            };
            let value = match Cell::of(text) {
                Cell::Number(number) => number,
                Cell::Unknown => f64::NAN,
                Cell::Bad => {
                    problems.push(format!(
                        "column `{}`: {}",
                        header.name(*column),
                        Cell::problem(text)
                    ));
                    f64::NAN
                }
            };
            values.push(value);
        }
        for (all, half_width) in self.half_widths.iter_mut().zip(&self.plan.half_widths) {
            let here = uncertain::in_row(*half_width, record, header);
            all.push(here.unwrap_or_else(|problem| {
                problems.push(problem);
                f64::NAN
            }));
        }
        if !record.as_slice().is_ascii() {
            let mut cells = record.iter().enumerate();
            if let Some((column, _)) = cells.find(|(_, text)| str::from_utf8(text).is_err()) {
                problems.push(format!(
                    "column `{}`: not UTF-8; save the table as UTF-8",
                    header.name(column)
                ));
            }
        }
        if problems.is_empty() {
            return None;
        }
        for values in &mut self.columns {
            if let Some(value) = values.last_mut() {
                *value = f64::NAN;
            }
        }
        Some(problems.join("; "))
    }

    fn count(
        &self,
        tally: &mut Tally,
        (row, record): (usize, &ByteRecord),
        outcomes: &[Outcome],
        line: u64,
    ) {
        if outcomes
            .first()
            .is_some_and(|outcome| outcome.state == State::InputNotFinite)
        {
            tally.unknown.add(line);
            return;
        }
        for ((outcome, column), errors) in outcomes
            .iter()
            .zip(&self.plan.measured)
            .zip(&mut tally.errors)
        {
            let measured = column.and_then(|column| record.get(column));
            match (outcome.value(), measured.map(Cell::of)) {
                (Some(computed), Some(Cell::Number(measured))) => {
                    errors.add(line, computed, measured);
                }
                (_, Some(Cell::Unknown | Cell::Bad)) => errors.add_unmeasured(line),
                _ => {}
            }
        }
        for (outcome, silent) in outcomes.iter().zip(&mut tally.silent) {
            if outcome.state == State::NoRuleFired {
                silent.add(line);
            }
        }
        if outcomes.first().is_some_and(|outcome| outcome.clamped) {
            for input in self.clamped(row) {
                if let Some(rows) = tally.clamped.get_mut(input) {
                    rows.add(line);
                }
            }
        }
    }

    /// The inputs of a row that are outside their range.
    fn clamped(&self, row: usize) -> impl Iterator<Item = usize> {
        let inputs = self.plan.engine.model().inputs.iter().zip(&self.columns);
        let outside = inputs.enumerate().filter(move |(_, (input, values))| {
            values
                .get(row)
                .is_some_and(|value| *value < input.low || *value > input.high)
        });
        outside.map(|(index, _)| index)
    }

    /// Writes a row: its own cells, the values of the outputs, and the requested columns.
    fn write(
        &self,
        writer: &mut csv::Writer<&mut Vec<u8>>,
        row: usize,
        record: &ByteRecord,
        outcomes: &[Outcome],
    ) -> csv::Result<()> {
        let mut number = zmij::Buffer::new();
        for column in 0..self.plan.header.names.len() {
            let text = record.get(column).unwrap_or_default();
            writer.write_field(output::copied(text, self.plan.is_terminal))?;
        }
        let enclosed = self.enclosed(row);
        for (output, (outcome, is_interval)) in
            outcomes.iter().zip(&self.plan.intervals).enumerate()
        {
            let ends = match (&self.enclosure, &enclosed) {
                (None, _) => [outcome.low(), outcome.high()],
                (Some(_), None) => [None; 2],
                (Some(_), Some(enclosed)) => {
                    let values = enclosed.get(output).and_then(|outcome| outcome.values);
                    let ends = values.map(|values| [values.low, values.high].map(Some));
                    ends.unwrap_or_default()
                }
            };
            let ends = ends.into_iter().filter(|_| *is_interval);
            for value in std::iter::once(outcome.value()).chain(ends) {
                let value = value.filter(|value| value.is_finite());
                let value = value.map_or("", |value| digits(&mut number, value));
                writer.write_field(value)?;
            }
        }
        for with in &self.plan.with {
            match with {
                ExplanationColumn::Coverage => {
                    for outcome in outcomes {
                        let is_known = outcome.state != State::InputNotFinite;
                        let coverage = if is_known {
                            digits(&mut number, outcome.coverage)
                        } else {
                            ""
                        };
                        writer.write_field(coverage)?;
                    }
                }
                ExplanationColumn::Rule => {
                    for outcome in outcomes {
                        let rule = outcome
                            .dominant_rule
                            .map_or(String::new(), |rule| (rule + 1).to_string());
                        writer.write_field(rule)?;
                    }
                }
                ExplanationColumn::Clamped => {
                    let is_clamped = outcomes.first().is_some_and(|outcome| outcome.clamped);
                    let inputs = self.clamped(row).filter(|_| is_clamped);
                    let names =
                        inputs.filter_map(|input| self.plan.engine.input_names().nth(input));
                    writer.write_field(names.collect::<Vec<_>>().join("|"))?;
                }
                ExplanationColumn::Error => {
                    let error = self.error(row, outcomes, enclosed.as_deref());
                    writer.write_field(cell(&error).as_bytes())?;
                }
            }
        }
        writer.write_record(None::<&[u8]>)
    }

    /// Returns the intervals of the outputs; `None` if no input is uncertain, or if an input or half-width is unknown.
    fn enclosed(&self, row: usize) -> Option<Vec<IntervalOutcome>> {
        let enclosure = self.enclosure.as_ref()?;
        let at = |values: &Vec<f64>| values.get(row).copied().unwrap_or(f64::NAN);
        let half_widths = self.half_widths.iter().map(at);
        uncertain::enclose(enclosure, self.columns.iter().map(at).zip(half_widths))
    }

    /// Returns the reason why a row, or one of its outputs, has no value, or may have none.
    fn error(
        &self,
        row: usize,
        outcomes: &[Outcome],
        enclosed: Option<&[IntervalOutcome]>,
    ) -> String {
        if let Some(Some(problem)) = self.problems.get(row) {
            return problem.clone();
        }
        let engine = &self.plan.engine;
        let unknown = engine.input_names().zip(&self.columns);
        let unknown =
            unknown.filter(|(_, values)| values.get(row).is_some_and(|value| value.is_nan()));
        let unknown = unknown.map(|(name, _)| format!("`{name}` is unknown"));
        let unbounded = engine.input_names().zip(&self.half_widths);
        let unbounded =
            unbounded.filter(|(_, widths)| widths.get(row).is_some_and(|width| width.is_nan()));
        let unbounded = unbounded.map(|(name, _)| format!("the half-width of `{name}` is unknown"));
        let silent = engine.output_names().zip(outcomes);
        let silent = silent.filter(|(_, outcome)| outcome.state == State::NoRuleFired);
        let silent = silent.map(|(name, outcome)| match outcomes.len() {
            _ if outcome.coverage > 0.0 && self.plan.has_formula(name) => {
                format!("a formula of `{name}` has no finite value")
            }
            1 => "no rule fires".to_owned(),
            _ => format!("no rule fires for `{name}`"),
        });
        let partly = engine.output_names().zip(enclosed.unwrap_or_default());
        let partly = partly.zip(outcomes).filter(|((_, enclosed), outcome)| {
            enclosed.may_be_undefined && outcome.state != State::NoRuleFired
        });
        let partly = partly.map(|((name, _), _)| match outcomes.len() {
            1 => "no rule fires for some values within the half-widths".to_owned(),
            _ => format!("no rule fires for `{name}` for some values within the half-widths"),
        });
        unknown
            .chain(unbounded)
            .chain(silent)
            .chain(partly)
            .collect::<Vec<_>>()
            .join("; ")
    }
}

/// Returns the fewest digits that read back as the same number.
fn digits(buffer: &mut zmij::Buffer, value: f64) -> &str {
    let digits = buffer.format_finite(value);
    digits.strip_suffix(".0").unwrap_or(digits)
}
