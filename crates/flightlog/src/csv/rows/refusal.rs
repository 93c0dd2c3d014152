//! Reasons why the rows of a flight CSV are refused as a whole: other units, other clocks, a wrong order.

use super::{HELP_NEGATIVE, RowCollector, problem};
use crate::ReadError;

const HELP_PULSES: &str = "name columns of fractions from 0 to 1 `motor1`..; divide percent by 100 first; for DShot see docs/flight-csv.md";
/// Whole-number times in `t_s` count as milliseconds or microseconds if the median step between motor commands is at
/// least this.
const MIN_STEP_MS: f64 = 2.0;
const MIN_STEPS: usize = 5;
/// Whole-number times in `t_s` count as microseconds if the median step between motor commands is at least this (1000
/// us, that is, 1 kHz).
const MIN_STEP_US: f64 = 1000.0;

impl RowCollector {
    /// The reason why the file is refused; `None` if it is accepted. If this crate wrote the file (`is_ours`), only
    /// unusable cells are a reason, because the clock is known to be in seconds.
    pub(in crate::csv) fn refusal(&mut self, is_ours: bool, messages: u64) -> Option<ReadError> {
        let refused = self.refused.take();
        let most_go_back = self.first_back.filter(|_| self.went_back > messages);
        let backwards = most_go_back.map(|line| {
            let text = format!("the time goes back, as in {} rows", self.went_back);
            problem(line, text, "sort the rows by `t_s`")
        });
        let without_numbers = self.first_damaged.clone();
        let without_numbers =
            without_numbers
                .filter(|_| self.commands.are_unknown())
                .map(|(line, why)| {
                    problem(
                        line,
                        why,
                        "write numbers with a decimal point and without a unit",
                    )
                });
        let backwards = backwards.or(without_numbers);
        let of_clock = || self.milliseconds().or_else(|| self.coarse());
        refused.or_else(|| backwards.or_else(of_clock).filter(|_| !is_ours))
    }

    /// An error for a column whose cells are mostly not pulse widths, or mostly negative fractions: if the column were
    /// accepted, the motor would seem to be at a limit all the time. A few such cells count as damage. Also returns the
    /// value of the first such cell.
    pub(in crate::csv) fn other_unit(&self) -> Option<(f64, ReadError)> {
        let mut columns = (1..).zip(&self.counts);
        let (number, counts) = columns.find(|(_, counts)| counts.outside > counts.known / 2)?;
        let (line, raw) = counts.first?;
        let (what, help) = match self.stem {
            "pwm" => ("a pulse width in us", HELP_PULSES),
            _ => ("a fraction from 0 to 1", HELP_NEGATIVE),
        };
        let text = format!("`{}{number}` is {raw}, not {what}", self.stem);
        Some((raw, problem(line, text, help)))
    }

    /// An error for times that look like milliseconds or microseconds: whole numbers whose median step between
    /// motor commands is at least 2.
    fn milliseconds(&self) -> Option<ReadError> {
        let times = self.commands.t_s();
        let steps = times.windows(2).map(|pair| pair[1] - pair[0]);
        let mut steps: Vec<f64> = steps.filter(|step| *step > 0.0).collect();
        steps.sort_by(f64::total_cmp);
        let middle = *steps.get(steps.len() / 2)?;
        let (line, from, to) = self.first_step?;
        (self.is_whole && steps.len() >= MIN_STEPS && middle >= MIN_STEP_MS).then(|| {
            let text = format!("`t_s` jumps from {from} to {to} in one row, but is in seconds");
            let help = match middle < MIN_STEP_US {
                true => "divide milliseconds by 1000; rows that are seconds apart are too few for an assessment",
                false => "divide microseconds by 1000000",
            };
            problem(line, text, help)
        })
    }

    /// An error for whole numbers that repeat: milliseconds at 1 kHz and above, or a clock of whole seconds. The two
    /// cannot be distinguished, so the rows are not spread over time. Fractions that repeat need no spreading, because
    /// windows are longer than the resolution of such a clock.
    fn coarse(&self) -> Option<ReadError> {
        let (line, t_s) = self.first_repeated?;
        (self.is_whole && self.repeated >= MIN_STEPS).then(|| {
            let text = format!(
                "`t_s` is {t_s} as in the row before, and a whole number in every row: the clock is too coarse"
            );
            problem(line, text, "write seconds with decimals; divide milliseconds by 1000")
        })
    }
}
