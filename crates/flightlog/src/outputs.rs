//! Servo outputs of ArduPilot, before it is known which of them drive motors.

use crate::Commands;
use crate::signal::{BackstepDetector, Order};

/// The value of an output that was not logged in a row, or is damaged.
const MISSING: u16 = u16::MAX;
/// Pulses longer than this are damaged, in us.
pub(crate) const LONGEST_PULSE_US: f64 = 3000.0;

/// Limits (lowest, highest) of a range of commands, and its minimum width, in the unit of the range. Ranges outside
/// these limits are implausible; a range that is too wide or too narrow would hide a motor at its limit.
pub(crate) struct Bounds {
    pub(crate) least: f64,
    pub(crate) most: f64,
    pub(crate) width: f64,
}

/// The pulse widths that servos and speed controllers accept, in us.
pub(crate) const PULSES_US: Bounds = Bounds {
    least: 500.0,
    most: 2500.0,
    width: 100.0,
};

/// The effective range, as fractions of the full range.
pub(crate) const FRACTIONS: Bounds = Bounds {
    least: 0.0,
    most: 1.0,
    width: 0.1,
};

impl Bounds {
    pub(crate) fn allow(&self, (low, high): (f64, f64)) -> bool {
        low >= self.least && high <= self.most && high - low >= self.width
    }
}

/// The number of outputs, from the first, that are examined for motors if nothing else names the motors.
const MAX_CANDIDATES: usize = 8;
/// The minimum standard deviation of an output that may be a motor, in us.
const MIN_MOVE_US: f64 = 20.0;
/// The minimum correlation of an output that may be a motor with the mean of the first four outputs.
const TOGETHER: f64 = 0.6;

/// Rows of pulse widths, with one column for each output.
#[derive(Debug, Default)]
pub(crate) struct Outputs {
    t_s: Vec<f64>,
    /// One column for each output, at the index `number - 1`. A column is shorter than `t_s` if the last rows do not
    /// contain the output, and empty if all its values were 0.
    columns: Vec<Vec<u16>>,
    set_back: BackstepDetector,
}

impl Outputs {
    /// Adds the values (output from 1, pulse in us) of a message. Outputs above 14 arrive in separate messages, which
    /// complete the row that the `first` message began. Returns whether a row had to be dropped because its time goes
    /// back.
    pub(crate) fn add(
        &mut self,
        t_s: f64,
        first: bool,
        values: impl Iterator<Item = (u16, f64)>,
    ) -> bool {
        let mut order = Order::Last;
        if first || self.t_s.is_empty() {
            order = Order::of(&self.t_s, t_s);
            self.set_back.see(order, t_s, self.t_s.last());
            match order {
                Order::Last => {}
                Order::Replaces => self.pop(),
                Order::Back => return true,
            }
            self.t_s.push(t_s);
        }
        let row = self.t_s.len() - 1;
        for (output, value) in values {
            let index = usize::from(output.saturating_sub(1));
            if self.columns.len() <= index {
                self.columns.resize_with(index + 1, Vec::new);
            }
            let Some(column) = self.columns.get_mut(index) else {
                continue;
            };
            // Most outputs are always 0: their columns stay empty.
            if value == 0.0 && column.is_empty() {
                continue;
            }
            let before = if column.is_empty() { 0 } else { MISSING };
            column.resize(row, before);
            column.push(match value {
                value if (0.0..=LONGEST_PULSE_US).contains(&value) => value as u16,
                _ => MISSING,
            });
        }
        order != Order::Last
    }

    /// Shifts the times of all rows.
    pub(crate) fn shift(&mut self, by_s: f64) {
        self.t_s.iter_mut().for_each(|t_s| *t_s += by_s);
        self.set_back.shift(by_s);
    }

    /// The times at which the clock restarted, ascending: the given boots, and the times at which the clock was set
    /// back and rows were therefore dropped.
    pub(crate) fn restarts_s(&self, boots_s: &[f64]) -> Vec<f64> {
        let mut restarts_s = [self.set_back.at_s(), boots_s].concat();
        restarts_s.sort_by(f64::total_cmp);
        restarts_s
    }

    /// Estimates the number of motors, for logs in which nothing else determines it: the largest `n` of 8, 6 and 4
    /// for which the first `n` outputs move together; `None` if the first 4 do not.
    pub(crate) fn estimate_motor_count(&self) -> Option<u16> {
        let row = |row: usize| -> [f64; MAX_CANDIDATES] {
            std::array::from_fn(|output| {
                let column = self.columns.get(output);
                match column.and_then(|column| column.get(row)) {
                    Some(&pulse) if pulse != MISSING => f64::from(pulse),
                    _ => 0.0,
                }
            })
        };
        let count = self.t_s.len();
        let first = |row: &[f64; MAX_CANDIDATES]| row[..4].iter().sum::<f64>() / 4.0;
        let mean = |value: &dyn Fn(&[f64; MAX_CANDIDATES]) -> f64| {
            (0..count).map(|i| value(&row(i))).sum::<f64>() / count as f64
        };
        let first_mean = mean(&first);
        let is_motor = |output: usize| {
            let own_mean = mean(&|row| row[output]);
            let variance = mean(&|row| (row[output] - own_mean).powi(2));
            let first_variance = mean(&|row| (first(row) - first_mean).powi(2));
            let covariance = mean(&|row| (row[output] - own_mean) * (first(row) - first_mean));
            variance.sqrt() > MIN_MOVE_US
                && covariance > TOGETHER * (variance * first_variance).sqrt()
        };
        let alike = (0..MAX_CANDIDATES)
            .take_while(|&output| is_motor(output))
            .count();
        match alike {
            8 => Some(8),
            6 | 7 => Some(6),
            4 | 5 => Some(4),
            _ => None,
        }
    }

    fn pop(&mut self) {
        self.t_s.pop();
        for column in &mut self.columns {
            column.truncate(self.t_s.len());
        }
    }

    /// The commands of the motors on these outputs.
    pub(crate) fn commands(self, outputs: &[u16]) -> Commands {
        let mut commands = Commands::new(outputs.len());
        let columns: Vec<Option<&Vec<u16>>> = outputs
            .iter()
            .map(|output| self.columns.get(usize::from(*output).checked_sub(1)?))
            .map(|column| column.filter(|column| !column.is_empty()))
            .collect();
        // Without any logged output there are no commands.
        if columns.iter().all(Option::is_none) {
            return commands;
        }
        for (row, &t_s) in self.t_s.iter().enumerate() {
            let value = |column: &Option<&Vec<u16>>| match column.and_then(|c| c.get(row)) {
                Some(&value) if value != MISSING => f64::from(value),
                _ => f64::NAN,
            };
            commands.push(t_s, columns.iter().map(value));
        }
        commands
    }
}
