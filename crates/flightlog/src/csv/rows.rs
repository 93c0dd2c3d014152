//! The rows of a flight CSV.

mod refusal;

use csv::ByteRecord;

use super::{Layout, cell, problem, unit_of};
use crate::outputs::{LONGEST_PULSE_US, PULSES_US};
use crate::signal::{Label, SET_BACK_S};
use crate::{Commands, Intervals, ReadError, Report, Series};

/// Fractions that are outside 0 to 1 by at most this are rounding errors or slightly exceeded limits.
const MAX_OUTSIDE: f64 = 0.5;
/// A motor whose fractions are mostly below 0 by more than this has another scale.
const MAX_BELOW: f64 = 0.1;
const HELP_FRACTIONS: &str = "name columns of pulse widths in us `pwm1`.. and add the limits; divide percent by 100; for DShot see docs/flight-csv.md";
const HELP_NEGATIVE: &str =
    "commands are fractions from 0 to 1: 0 is the lowest command, 1 the highest";
const HELP_LONG: &str = "write numbers with a decimal point, since a comma separates cells, and as many cells in every row as in the header";
const HELP_SHORT: &str = "give every row a cell for each column, empty where the value is unknown";
/// The largest accepted distance of a time from 0, in seconds. Any 64-bit count of microseconds is within it after
/// conversion to seconds. If a single damaged time beyond this limit were accepted, all later times would seem to go
/// back.
const FURTHEST_S: f64 = 1e14;

fn is_far_outside(command: f64) -> bool {
    !command.is_nan() && !(-MAX_OUTSIDE..=1.0 + MAX_OUTSIDE).contains(&command)
}

pub(super) struct RowCollector {
    pub(super) commands: Commands,
    pub(super) series: Series,
    air_changes: Vec<(f64, bool)>,
    has_air: bool,
    first_s: f64,
    last_s: f64,
    last_was_short: Option<(u64, String)>,
    /// The offset that is added to times since the clock restarted.
    offset_s: f64,
    /// The time of the previous row, if it went back.
    back_s: Option<f64>,
    /// The number of rows that are left out because their time goes back.
    went_back: u64,
    first_back: Option<u64>,
    /// The first cell that is not a number: line and reason.
    first_damaged: Option<(u64, String)>,
    pub(super) boots_s: Vec<f64>,
    pub(super) rebooted_in_air_s: Vec<f64>,
    /// Whether all times so far are whole numbers.
    is_whole: bool,
    /// The first row of motor commands with a later time than the row before: line and both times.
    first_step: Option<(u64, f64, f64)>,
    /// The number of rows of motor commands with the same time as the previous row.
    repeated: usize,
    /// The line and the time of the first of these rows.
    first_repeated: Option<(u64, f64)>,
    /// Counts for each motor.
    counts: Vec<CommandCounts>,
    /// The beginning of the names of motor columns: `pwm` or `motor`.
    stem: &'static str,
    /// The error of the first unusable cell.
    refused: Option<ReadError>,
}

/// Counts of the cells of a column of commands that are neither empty nor 0.
#[derive(Clone, Default)]
struct CommandCounts {
    known: usize,
    /// The number of cells that are not a pulse width in us, or that are negative fractions.
    outside: usize,
    /// The line and the value of the first of these cells.
    first: Option<(u64, f64)>,
}

impl RowCollector {
    pub(super) fn new(layout: &Layout) -> Self {
        let kept = layout.signals.iter().filter(|(.., keep)| *keep);
        let labels = kept.map(|(_, name, _)| Label {
            name: name.clone(),
            unit: unit_of(name).into(),
            source: format!("column `{name}`"),
        });
        Self {
            commands: Commands::new(layout.motors.len()),
            series: Series::new(labels.collect()),
            air_changes: Vec::new(),
            has_air: layout.in_air.is_some(),
            first_s: f64::INFINITY,
            last_s: f64::NEG_INFINITY,
            last_was_short: None,
            offset_s: 0.0,
            back_s: None,
            went_back: 0,
            first_back: None,
            first_damaged: None,
            boots_s: Vec::new(),
            rebooted_in_air_s: Vec::new(),
            is_whole: true,
            first_step: None,
            repeated: 0,
            first_repeated: None,
            counts: vec![CommandCounts::default(); layout.motors.len()],
            stem: layout.stem,
            refused: None,
        }
    }

    pub(super) fn add(
        &mut self,
        layout: &Layout,
        record: &ByteRecord,
        lines: u64,
        report: &mut Report,
    ) {
        let Some(position) = record.position() else {
            return;
        };
        if report.leaves_out(false) {
            return;
        }
        let line = lines + position.line();
        if let Some((short, text)) = self.last_was_short.take() {
            self.refuse(short, text, HELP_SHORT);
        }
        match self.try_add(layout, record, line, report) {
            Ok(()) => report.messages += 1,
            Err(why) => {
                report.bad(&format!("line {line}: {why}"));
                let is_short = record.len() < layout.columns;
                let has_values = record.iter().any(|bytes| !cell(bytes).is_empty());
                self.last_was_short = (is_short && has_values).then_some((line, why));
            }
        }
    }

    /// Whether the last row has too few cells, as in a file that is cut off.
    pub(super) fn is_cut_off(&self) -> bool {
        self.last_was_short.is_some()
    }

    fn try_add(
        &mut self,
        layout: &Layout,
        record: &ByteRecord,
        line: u64,
        report: &mut Report,
    ) -> Result<(), String> {
        if record.len() < layout.columns {
            return Err(format!("{} of {} columns", record.len(), layout.columns));
        }
        let has_more = record
            .iter()
            .skip(layout.cells)
            .any(|bytes| !cell(bytes).is_empty());
        if has_more && self.first_s.is_infinite() {
            let text = format!(
                "{} cells, but the header has {}",
                record.len(),
                layout.cells
            );
            self.refuse(line, text, HELP_LONG);
        }
        let t_s = self.time(layout, record, line)?;
        if t_s.abs() > FURTHEST_S {
            return Err(format!("the time is beyond {FURTHEST_S} s"));
        }
        self.is_whole &= t_s.fract() == 0.0;
        let t_s = self.on_one_clock(t_s, line)?;
        // A row with a damaged cell is kept with an unknown value: without the row, the flight would be shorter.
        let mut damaged = None;
        let mut read = |column: &usize| match number(record, *column) {
            Ok(value) => value,
            Err(why) => {
                damaged.get_or_insert(why);
                f64::NAN
            }
        };
        let commands: Vec<f64> = layout.motors.iter().map(&mut read).collect();
        let mut signals = Vec::new();
        for (column, _, keep) in &layout.signals {
            let value = read(column);
            signals.extend(keep.then_some(value));
        }
        if let Some(why) = damaged {
            self.first_damaged
                .get_or_insert_with(|| (line, why.clone()));
            report.bad(&format!("line {line}: {why}"));
        }
        self.look_at_units(layout, &commands, line);
        let mut took_off_or_landed = false;
        if let Some(column) = layout.in_air
            && let Some(state) = self.state(record, column, line)?
        {
            let before = self.is_in_air();
            report.state(&mut self.air_changes, t_s, Some(state));
            took_off_or_landed = self.is_in_air() != before;
        }
        report.row(commands.len() + signals.len(), false);
        self.first_s = self.first_s.min(t_s);
        self.last_s = t_s;
        // A row without any command, which only marks a take-off or a landing, is not a sample of the motors.
        let is_between = took_off_or_landed && commands.iter().all(|command| command.is_nan());
        if !commands.is_empty() && !is_between {
            match self.commands.t_s().last() {
                Some(&before_s) if before_s == t_s => {
                    self.repeated += 1;
                    self.first_repeated.get_or_insert((line, t_s));
                }
                Some(&before_s) => {
                    self.first_step.get_or_insert((line, before_s, t_s));
                }
                None => {}
            }
            self.commands.push(t_s, commands);
        }
        if !signals.is_empty() {
            self.series.push(t_s, signals);
        }
        Ok(())
    }

    /// Marks the file as refused; the first reason is kept.
    fn refuse(&mut self, line: u64, text: String, help: &str) {
        self.refused
            .get_or_insert_with(|| problem(line, text, help));
    }

    /// The time of a row; an error for a row without one, because skipping that row would make the flight shorter.
    fn time(&mut self, layout: &Layout, record: &ByteRecord, line: u64) -> Result<f64, String> {
        if let Ok(t_s) = number(record, layout.time)
            && t_s.is_finite()
        {
            return Ok(t_s);
        }
        // Spreadsheets may end a table with rows of empty cells.
        if record.iter().all(|bytes| cell(bytes).is_empty()) {
            return Err("all cells are empty".into());
        }
        let bytes = cell(record.get(layout.time).unwrap_or_default());
        let text = match bytes.is_empty() {
            true => "`t_s` is empty".to_owned(),
            false => format!(
                "`t_s` is `{}`, not a time in seconds",
                String::from_utf8_lossy(bytes)
            ),
        };
        let is_clock = bytes.iter().any(u8::is_ascii_digit) && bytes.contains(&b':');
        let help = match is_clock {
            true => "write the seconds since the first row, such as 0.25, instead of a time of day",
            false => "give every row a time, or delete the row",
        };
        self.refuse(line, text.clone(), help);
        Err(text)
    }

    /// Whether the vehicle is in the air; `None` if the cell is empty.
    fn state(
        &mut self,
        record: &ByteRecord,
        column: usize,
        line: u64,
    ) -> Result<Option<bool>, String> {
        match number(record, column) {
            Ok(0.0) => Ok(Some(false)),
            Ok(1.0) => Ok(Some(true)),
            Ok(value) if value.is_nan() => Ok(None),
            _ => {
                let bytes = cell(record.get(column).unwrap_or_default());
                let text = format!(
                    "`in_air` is `{}`, not 0 or 1",
                    String::from_utf8_lossy(bytes)
                );
                let help = "write 1 in the air and 0 on the ground, and leave the cell empty where it is unknown";
                self.refuse(line, text.clone(), help);
                Err(text)
            }
        }
    }

    /// Detects commands in a unit that contradicts the names of their columns.
    fn look_at_units(&mut self, layout: &Layout, commands: &[f64], line: u64) {
        if layout.stem == "motor"
            && let Some(motor) = commands.iter().position(|command| is_far_outside(*command))
        {
            let (number, command) = (motor + 1, commands[motor]);
            let text = format!("`motor{number}` is {command}, not a fraction from 0 to 1");
            self.refuse(line, text, HELP_FRACTIONS);
        }
        let is_outside = |raw: f64| match layout.stem {
            "pwm" => !(PULSES_US.least..=LONGEST_PULSE_US).contains(&raw),
            _ => raw < -MAX_BELOW,
        };
        for (counts, &raw) in self.counts.iter_mut().zip(commands) {
            // 0 is the output for a motor that is off.
            if raw.is_nan() || raw == 0.0 {
                continue;
            }
            counts.known += 1;
            if is_outside(raw) {
                counts.outside += 1;
                counts.first.get_or_insert((line, raw));
            }
        }
    }

    /// The first and last time of the rows; without rows, an empty span.
    pub(super) fn span_s(&self) -> (f64, f64) {
        (self.first_s, self.last_s)
    }

    /// Converts a time to the clock of the first row. If the time goes back for two rows or more, the clock was
    /// restarted, as after a reboot; the converted times then continue from the last time before the restart.
    fn on_one_clock(&mut self, t_s: f64, line: u64) -> Result<f64, String> {
        let now_s = t_s + self.offset_s;
        if now_s >= self.last_s {
            self.back_s = None;
            return Ok(now_s);
        }
        let before_s = self.back_s.replace(t_s);
        match before_s.filter(|before_s| *before_s <= t_s && self.last_s - now_s > SET_BACK_S) {
            Some(before_s) => {
                self.back_s = None;
                self.offset_s = self.last_s - before_s;
                self.boots_s.push(self.last_s);
                if self.is_in_air() {
                    self.rebooted_in_air_s.push(self.last_s);
                }
                // From 1e9 s on, rounding of the sum could make a time go back.
                Ok((t_s + self.offset_s).max(self.last_s))
            }
            None => {
                self.went_back += 1;
                self.first_back.get_or_insert(line);
                Err("the time goes back".into())
            }
        }
    }

    fn is_in_air(&self) -> bool {
        self.air_changes
            .last()
            .map_or(!self.has_air, |(_, state)| *state)
    }

    /// The times in the air; `None` if the column exists but is empty. If the log ended in the air, `end_s` is the end
    /// of the last of these times, which may be after the last row.
    pub(super) fn in_air(&self, end_s: Option<f64>) -> Option<Intervals> {
        if self.has_air && self.air_changes.is_empty() {
            return None;
        }
        let rule = match self.has_air {
            true => "column `in_air`",
            false => "there is no column `in_air`: every row counts",
        };
        let before = !self.has_air;
        let last_change_s = self
            .air_changes
            .last()
            .map_or(self.first_s, |(t_s, _)| *t_s);
        let end_s = end_s.filter(|end_s| *end_s >= last_change_s);
        let (first_s, last_s) = (self.first_s, end_s.unwrap_or(self.last_s));
        let air = Intervals::from_changes(&self.air_changes, before, first_s, last_s, rule);
        Some(match self.has_air {
            true => air,
            false => air.assumed(),
        })
    }
}

/// The number in a cell; NaN for an empty cell and for the text `nan`.
fn number(record: &ByteRecord, column: usize) -> Result<f64, String> {
    let bytes = cell(record.get(column).unwrap_or_default());
    if bytes.is_empty() {
        return Ok(f64::NAN);
    }
    let text = String::from_utf8_lossy(bytes);
    match text.parse::<f64>() {
        Ok(value) if value.is_infinite() => Err(format!("`{text}` is not finite")),
        Ok(value) => Ok(value),
        Err(_) => Err(format!("`{text}` is not a number")),
    }
}
