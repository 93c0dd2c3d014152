//! Flight CSV: `t_s`, the motor commands and any signals; see `docs/flight-csv.md`.

mod header;
mod write;

use std::cell::Cell;
use std::collections::HashSet;
use std::io::{self, Read};

use csv::{ByteRecord, ReaderBuilder};

use self::header::{apply_header, read_header};
use crate::error::io_error;
use crate::geometry;
use crate::input::Input;
use crate::signal::{Label, preferred};
use crate::{Commands, Flight, Format, Intervals, Motor, Options, ReadError, Report, Series};

/// Whether the first line that is no comment names a column `t_s`.
pub(crate) fn looks_like(start: &[u8]) -> bool {
    let start = start.strip_prefix(BOM).unwrap_or(start);
    start
        .split(|&byte| byte == b'\n')
        .map(<[u8]>::trim_ascii)
        .find(|line| !line.is_empty() && !line.starts_with(b"#"))
        .is_some_and(|line| {
            line.split(|&byte| byte == b',')
                .any(|name| cell(name) == b"t_s")
        })
}

const BOM: &[u8] = b"\xef\xbb\xbf";

/// A cell without white space and quotes around it.
fn cell(bytes: &[u8]) -> &[u8] {
    let bytes = bytes.trim_ascii();
    match bytes {
        [b'"', inner @ .., b'"'] => inner.trim_ascii(),
        _ => bytes,
    }
}

pub(crate) fn read(input: &mut Input<'_>, options: &Options) -> Result<Flight, ReadError> {
    let mut flight = Flight::empty(Format::Csv);
    let (header, lines) = read_header(input)?;
    let start = input.taken();
    let left = Cell::new(LONGEST_ROW);
    let mut reader = ReaderBuilder::new()
        .flexible(true)
        .has_headers(false)
        .comment(Some(b'#'))
        .from_reader(Bounded {
            input: &mut *input,
            left: &left,
        });
    let mut record = ByteRecord::new();
    let broken = |error, line| match left.get() {
        0 => too_long(line),
        _ => io_error(io::Error::other::<csv::Error>(error)),
    };
    let first = reader.read_byte_record(&mut record);
    if !first.map_err(|error| broken(error, lines + 1))? {
        return Err(problem(lines + 1, "there is no line of column names", HELP));
    }
    let layout = Layout::new(&record, lines + 1, options)?;
    let mut rows = Rows::new(&layout);
    let mut next = ByteRecord::new();
    let mut end = reader.position().byte();
    record = ByteRecord::new();
    loop {
        left.set(LONGEST_ROW);
        let line = lines + reader.position().line();
        let more = reader.read_byte_record(&mut next);
        if !more.map_err(|error| broken(error, line))? {
            break;
        }
        // A comment without a line end reads as a row of nothing.
        if next.as_slice().is_empty() && next.len() <= 1 {
            continue;
        }
        rows.add(&layout, &record, lines, &mut flight.report);
        std::mem::swap(&mut record, &mut next);
        end = reader.position().byte();
    }
    drop(reader);
    // A last row without a line end may be torn inside a number.
    let is_torn = start + end == input.taken() && !input.is_at_line_end();
    match record.position().filter(|_| is_torn) {
        Some(torn) => {
            flight.report.truncated = true;
            flight.report.skipped_bytes += end - torn.byte();
            let line = lines + torn.line();
            let reason = || format!("line {line}: the last row has no line end");
            flight.report.because(reason);
        }
        None => rows.add(&layout, &record, lines, &mut flight.report),
    }
    flight.report.truncated |= rows.last_was_short;
    if let Some(refused) = rows.refused.take().or_else(|| rows.milliseconds()) {
        return Err(refused);
    }
    flight.motors = layout.motors();
    flight.in_air = rows.in_air(header::end_s(&header)?);
    flight.commands = rows.commands;
    flight.boots_s = rows.boots_s;
    flight.rebooted_in_air_s = rows.rebooted_in_air_s;
    flight.series = preferred(vec![rows.series]);
    let declared = apply_header(&mut flight, header, &layout)?;
    flight.range = options.range_or_given(flight.range);
    flight.geometry = geometry::find(&flight, &declared);
    Ok(flight)
}

/// A fraction this far outside 0 to 1 comes from rounding, or from limits that are slightly exceeded.
const MOST_OUTSIDE: f64 = 0.5;
const HELP_FRACTIONS: &str = "name pulse widths in us `pwm1`.. and add their limits; divide percent by 100; docs/flight-csv.md has DShot";

fn is_far_outside(command: f64) -> bool {
    !command.is_nan() && !(-MOST_OUTSIDE..=1.0 + MOST_OUTSIDE).contains(&command)
}

const HELP: &str = "a flight CSV has the columns `t_s` and `pwm1`.. (us) or `motor1`.. (0 to 1)";

fn problem(line: u64, problem: impl Into<String>, help: &str) -> ReadError {
    ReadError::Csv {
        path: String::new(),
        line,
        problem: problem.into(),
        help: help.into(),
    }
    .with_path("the log")
}

/// Bytes of a row, with the comments above it. Longer header lines are not taken for a flight CSV.
const LONGEST_ROW: usize = 1_000_000;
const MOST_COLUMNS: usize = 4096;
/// On either side of 0. Logs that count microseconds in 64 bits are within it, and so is what they are converted to. One damaged
/// time beyond it would make all later ones go back.
const FURTHEST_S: f64 = 1e14;
/// ArduPilot's frames have up to 12 motors, its outputs 32.
const MOST_MOTORS: usize = 32;

/// A clock that goes back by more than this, in seconds, was started again.
const BACK_S: f64 = 2.0;
/// The smallest step between motor commands that is taken for milliseconds.
const LEAST_STEP_MS: f64 = 2.0;
const LEAST_STEPS: usize = 5;

fn too_long(line: u64) -> ReadError {
    let text = format!("the row is longer than {LONGEST_ROW} bytes");
    problem(line, text, "a row is one sample: end it with a line end")
}

/// Reads no more than the bytes that are left for a row, which otherwise would fill the memory.
struct Bounded<'a, 'r> {
    input: &'a mut Input<'r>,
    left: &'a Cell<usize>,
}

impl Read for Bounded<'_, '_> {
    fn read(&mut self, to: &mut [u8]) -> io::Result<usize> {
        if self.left.get() == 0 {
            return Err(io::ErrorKind::InvalidData.into());
        }
        let count = self.input.read(to)?;
        self.left.set(self.left.get().saturating_sub(count));
        Ok(count)
    }
}

/// What the columns hold.
struct Layout {
    time: usize,
    /// Column of each motor, in order.
    motors: Vec<usize>,
    /// `pwm` or `motor`.
    stem: &'static str,
    in_air: Option<usize>,
    /// Column and name of each signal, and whether it is kept.
    signals: Vec<(usize, String, bool)>,
    /// Columns that a row must have.
    columns: usize,
}

impl Layout {
    fn new(names: &ByteRecord, line: u64, options: &Options) -> Result<Self, ReadError> {
        let names: Vec<String> = names
            .iter()
            .map(|name| String::from_utf8_lossy(cell(name)).into_owned())
            .collect();
        if names.len() > MOST_COLUMNS {
            let text = format!(
                "there are {} columns, more than {MOST_COLUMNS}",
                names.len()
            );
            return Err(problem(
                line,
                text,
                "leave out columns that no profile needs",
            ));
        }
        let mut seen = HashSet::new();
        for name in names.iter().filter(|name| !name.is_empty()) {
            if !seen.insert(name) {
                let text = format!("the column `{name}` is there twice");
                return Err(problem(line, text, "give each column a name of its own"));
            }
        }
        let find = |name: &str| names.iter().position(|other| other == name);
        let Some(time) = find("t_s") else {
            return Err(problem(line, "there is no column `t_s`", HELP));
        };
        let [pwm, motor] = ["pwm", "motor"].map(|stem| numbered(&names, stem));
        if !pwm.is_empty() && !motor.is_empty() {
            let text = "there are both `pwm` and `motor` columns";
            return Err(problem(line, text, "keep one kind of them"));
        }
        let (stem, mut motors) = match pwm.is_empty() {
            false => ("pwm", pwm),
            true => ("motor", motor),
        };
        motors.sort_unstable();
        if motors.len() > MOST_MOTORS {
            let text = format!("there are {} motors, more than {MOST_MOTORS}", motors.len());
            return Err(problem(line, text, "name other columns otherwise"));
        }
        for (index, &(number, _)) in motors.iter().enumerate() {
            if number != index as u64 + 1 {
                let text = format!(
                    "there is a column `{stem}{number}` but no `{stem}{}`",
                    index + 1
                );
                return Err(problem(line, text, "number the motors from 1 without gaps"));
            }
        }
        let motors: Vec<usize> = motors.into_iter().map(|(_, column)| column).collect();
        let in_air = find("in_air");
        let signals = names
            .iter()
            .enumerate()
            .filter(|(column, name)| {
                *column != time
                    && Some(*column) != in_air
                    && !motors.contains(column)
                    && !name.is_empty()
            })
            .map(|(column, name)| (column, name.clone(), options.wants(name)))
            .collect();
        Ok(Self {
            columns: names
                .iter()
                .rposition(|name| !name.is_empty())
                .map_or(0, |last| last + 1),
            time,
            motors,
            stem,
            in_air,
            signals,
        })
    }

    fn motors(&self) -> Vec<Motor> {
        (1..=self.motors.len())
            .map(|number| {
                let name = format!("{}{number}", self.stem);
                Motor {
                    number: u16::try_from(number).unwrap_or(u16::MAX),
                    source: format!("column `{name}`"),
                    output: name,
                }
            })
            .collect()
    }
}

/// Columns named `stem` and a number, with their numbers.
fn numbered(names: &[String], stem: &str) -> Vec<(u64, usize)> {
    let number = |name: &String| name.strip_prefix(stem)?.parse().ok();
    names
        .iter()
        .enumerate()
        .filter_map(|(column, name)| Some((number(name)?, column)))
        .collect()
}

struct Rows {
    commands: Commands,
    series: Series,
    air_changes: Vec<(f64, bool)>,
    has_air: bool,
    first_s: f64,
    last_s: f64,
    last_was_short: bool,
    /// What is added to the times since the clock started again.
    offset_s: f64,
    /// The time of the row before, where it went back.
    back_s: Option<f64>,
    boots_s: Vec<f64>,
    rebooted_in_air_s: Vec<f64>,
    /// The line of the second row, and whether all times so far are whole numbers.
    second_line: u64,
    is_whole: bool,
    /// The first cell that has another unit.
    refused: Option<ReadError>,
}

impl Rows {
    fn new(layout: &Layout) -> Self {
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
            last_was_short: false,
            offset_s: 0.0,
            back_s: None,
            boots_s: Vec::new(),
            rebooted_in_air_s: Vec::new(),
            second_line: 0,
            is_whole: true,
            refused: None,
        }
    }

    fn add(&mut self, layout: &Layout, record: &ByteRecord, lines: u64, report: &mut Report) {
        let Some(position) = record.position() else {
            return;
        };
        if report.leaves_out(false) {
            return;
        }
        let line = lines + position.line();
        self.last_was_short = false;
        match self.try_add(layout, record, line, report) {
            Ok(()) => {
                report.messages += 1;
                if report.messages == 2 {
                    self.second_line = line;
                }
            }
            Err(why) => {
                report.bad(&format!("line {line}: {why}"));
                self.last_was_short = record.len() < layout.columns;
            }
        }
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
        let t_s = number(record, layout.time)?;
        if !t_s.is_finite() {
            return Err("the time is missing".into());
        }
        if t_s.abs() > FURTHEST_S {
            return Err(format!("the time is beyond {FURTHEST_S} s"));
        }
        self.is_whole &= t_s.fract() == 0.0;
        let t_s = self.on_one_clock(t_s)?;
        let read = |column: &usize| number(record, *column);
        let commands: Vec<f64> = layout.motors.iter().map(read).collect::<Result<_, _>>()?;
        if layout.stem == "motor"
            && let Some(motor) = commands.iter().position(|command| is_far_outside(*command))
        {
            let text = format!(
                "`motor{}` is {}, not a fraction from 0 to 1",
                motor + 1,
                commands[motor]
            );
            self.refused
                .get_or_insert_with(|| problem(line, text, HELP_FRACTIONS));
        }
        let mut signals = Vec::new();
        for (column, _, keep) in &layout.signals {
            let value = read(column)?;
            signals.extend(keep.then_some(value));
        }
        let mut took_off_or_landed = false;
        if let Some(column) = layout.in_air {
            let state = read(&column)?;
            if !state.is_nan() {
                let before = self.is_in_air();
                report.state(&mut self.air_changes, t_s, Some(state > 0.5));
                took_off_or_landed = self.is_in_air() != before;
            }
        }
        report.row(commands.len() + signals.len(), false);
        self.first_s = self.first_s.min(t_s);
        self.last_s = t_s;
        // A row without any command that tells of a take-off or a landing is between two samples of the motors.
        let is_between = took_off_or_landed && commands.iter().all(|command| command.is_nan());
        if !commands.is_empty() && !is_between {
            self.commands.push(t_s, commands);
        }
        if !signals.is_empty() {
            self.series.push(t_s, signals);
        }
        Ok(())
    }

    /// The time on the clock of the first row. A clock that goes back for two rows or more was started again, as after a
    /// reboot, and continues at the end of the time before.
    fn on_one_clock(&mut self, t_s: f64) -> Result<f64, String> {
        let now_s = t_s + self.offset_s;
        if now_s >= self.last_s {
            self.back_s = None;
            return Ok(now_s);
        }
        let before_s = self.back_s.replace(t_s);
        match before_s.filter(|before_s| *before_s <= t_s && self.last_s - now_s > BACK_S) {
            Some(before_s) => {
                self.back_s = None;
                self.offset_s = self.last_s - before_s;
                self.boots_s.push(self.last_s);
                if self.is_in_air() {
                    self.rebooted_in_air_s.push(self.last_s);
                }
                Ok(t_s + self.offset_s)
            }
            None => Err("the time goes back".into()),
        }
    }

    fn is_in_air(&self) -> bool {
        self.air_changes
            .last()
            .map_or(!self.has_air, |(_, state)| *state)
    }

    /// Times that look like milliseconds or microseconds: whole numbers, and most steps between motor commands at least 2.
    fn milliseconds(&self) -> Option<ReadError> {
        let times = self.commands.t_s();
        let steps = times.windows(2).map(|pair| pair[1] - pair[0]);
        let mut steps: Vec<f64> = steps.filter(|step| *step > 0.0).collect();
        steps.sort_by(f64::total_cmp);
        let middle = *steps.get(steps.len() / 2)?;
        (self.is_whole && steps.len() >= LEAST_STEPS && middle >= LEAST_STEP_MS).then(|| {
            let text = format!(
                "`t_s` goes from {} to {} in one row, and is in seconds",
                times[0], times[1]
            );
            problem(self.second_line, text, "divide milliseconds by 1000")
        })
    }

    /// `None` where the column is there and empty. The log may go on after the last row.
    fn in_air(&self, end_s: Option<f64>) -> Option<Intervals> {
        if self.has_air && self.air_changes.is_empty() {
            return None;
        }
        let rule = match self.has_air {
            true => "column `in_air`",
            false => "there is no column `in_air`: every row counts as in the air",
        };
        let before = !self.has_air;
        let last_change_s = self
            .air_changes
            .last()
            .map_or(self.first_s, |(t_s, _)| *t_s);
        let end_s = end_s.filter(|end_s| *end_s >= last_change_s);
        let (first_s, last_s) = (self.first_s, end_s.unwrap_or(self.last_s));
        Some(Intervals::from_changes(
            &self.air_changes,
            before,
            first_s,
            last_s,
            rule,
        ))
    }
}

/// The number in a cell: NaN for an empty one and for `nan`.
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

/// The unit by the end of a name, as in `roll_deg`.
fn unit_of(name: &str) -> &'static str {
    const UNITS: &[(&str, &str)] = &[
        ("_deg_s", "deg/s"),
        ("_m_s2", "m/s2"),
        ("_m_s", "m/s"),
        ("_deg", "deg"),
        ("_pct", "%"),
        ("_mah", "mAh"),
        ("_us", "us"),
        ("_hz", "Hz"),
        ("_v", "V"),
        ("_a", "A"),
        ("_m", "m"),
        ("_s", "s"),
    ];
    UNITS
        .iter()
        .find(|(end, _)| name.ends_with(end))
        .map_or("", |(_, unit)| unit)
}
