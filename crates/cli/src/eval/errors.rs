//! Errors of the computed outputs compared with measured values.

use fuzzy::drawing::short;

use super::tally::RowCount;
use crate::output::print_note;

/// The number of worst rows that are listed.
const WORST: usize = 5;

/// The errors of an output: computed minus measured.
#[derive(Debug, Clone, Default)]
pub(super) struct Errors {
    rows: u64,
    /// The number of rows without a measured value, and the first of them.
    unmeasured: RowCount,
    sum: f64,
    sum_of_squares: f64,
    /// Line, computed and measured value of the rows with the largest errors, the largest first.
    worst: Vec<(u64, f64, f64)>,
}

impl Errors {
    pub(super) fn add(&mut self, line: u64, computed: f64, measured: f64) {
        let error = computed - measured;
        self.merge(Errors {
            rows: 1,
            sum: error,
            sum_of_squares: error * error,
            worst: vec![(line, computed, measured)],
            ..Errors::default()
        });
    }

    /// Counts a row whose measured value is not a number.
    pub(super) fn add_unmeasured(&mut self, line: u64) {
        self.unmeasured.add(line);
    }

    /// Adds the errors of later rows.
    pub(super) fn merge(&mut self, later: Errors) {
        self.rows += later.rows;
        self.unmeasured.merge(later.unmeasured);
        self.sum += later.sum;
        self.sum_of_squares += later.sum_of_squares;
        let size = |(_, computed, measured): &(u64, f64, f64)| (computed - measured).abs();
        for row in later.worst {
            // Among equal errors the earlier row comes first.
            let place = self
                .worst
                .partition_point(|other| size(other) >= size(&row));
            if place < WORST {
                self.worst.insert(place, row);
                self.worst.truncate(WORST);
            }
        }
    }

    /// Prints the errors on standard error if there are measured values.
    pub(super) fn print_notes(&self, output: &str) {
        if let Some(line) = self.unmeasured.first_line() {
            let rows = match self.unmeasured.count() {
                1 => "1 row".to_owned(),
                count => format!("{count} rows"),
            };
            print_note(&format!(
                "`{output}` is not compared in {rows}, whose measured value is not a number (first in line {line})"
            ));
        }
        if self.rows == 0 {
            return;
        }
        let rows = self.rows as f64;
        let (rms, mean) = ((self.sum_of_squares / rows).sqrt(), self.sum / rows);
        print_note(&format!(
            "`{output}` against its measured values in {} rows: RMS error {}, mean error {} (computed less measured)",
            self.rows,
            short(rms),
            short(mean)
        ));
        for (line, computed, measured) in self.worst.iter().filter(|(_, c, m)| c != m) {
            let (computed, measured) = (short(*computed), short(*measured));
            print_note(&format!(
                "  line {line}: {computed} computed, {measured} measured"
            ));
        }
    }
}
