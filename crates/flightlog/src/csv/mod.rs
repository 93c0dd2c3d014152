//! Flight CSV: `t_s`, the motor commands and any signals; see `docs/flight-csv.md`.

mod header;
mod layout;
mod rows;
mod write;

use std::cell::Cell;
use std::io::{self, Read};

use csv::{ByteRecord, ReaderBuilder};

use self::header::{apply_header, entry_without_sign, read_header};
use self::layout::Layout;
use self::rows::RowCollector;
use crate::error::io_error;
use crate::geometry;
use crate::input::Input;
use crate::signal::preferred;
use crate::{Flight, Format, Options, ReadError};

/// The lines that are neither empty nor comments.
fn content(start: &[u8]) -> impl Iterator<Item = &[u8]> {
    let start = start.strip_prefix(BOM).unwrap_or(start);
    let lines = start.split(|&byte| byte == b'\n').map(<[u8]>::trim_ascii);
    lines.filter(|line| !line.is_empty() && !line.starts_with(b"#"))
}

fn cells(line: &[u8]) -> impl Iterator<Item = &[u8]> {
    line.split(|&byte| byte == b',').map(cell)
}

/// Whether the first line that is not a comment names a column `t_s`.
pub(crate) fn has_times(start: &[u8]) -> bool {
    let mut header = content(start).next().into_iter().flat_map(cells);
    header.any(|name| name == b"t_s")
}

/// Whether a text looks like a table: the first line names several columns, and the next line has as many cells. The
/// table may be a flight CSV, or a table whose column of times has another name.
pub(crate) fn looks_like(start: &[u8]) -> bool {
    let mut lines = content(start);
    let (Some(header), row) = (lines.next(), lines.next()) else {
        return false;
    };
    let is_name =
        |name: &[u8]| name.len() <= 64 && !name.iter().any(|byte| b":{}[]<>;".contains(byte));
    let columns = cells(header).count();
    let is_table = columns > 1
        && cells(header).all(is_name)
        && row.is_some_and(|row| cells(row).count() == columns);
    // A line for spreadsheets, such as `sep=,`, is refused with advice.
    let is_unsigned = entry_without_sign(start).is_some() || header.starts_with(b"sep=");
    let names_times = || content(start).any(|line| cells(line).any(|name| name == b"t_s"));
    is_table || has_times(start) || (is_unsigned && names_times())
}

const BOM: &[u8] = b"\xef\xbb\xbf";

/// The content of a cell without white space around it and without surrounding quotes, however many.
fn cell(bytes: &[u8]) -> &[u8] {
    let mut bytes = bytes.trim_ascii();
    while let [b'"', inner @ .., b'"'] = bytes {
        bytes = inner.trim_ascii();
    }
    bytes
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
        .from_reader(BoundedReader {
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
        return Err(problem(
            lines + 1,
            "the line with the column names is missing",
            HELP,
        ));
    }
    let layout = Layout::new(&record, lines + 1, options)?;
    let mut rows = RowCollector::new(&layout);
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
        // A comment without a line end is parsed as an empty row.
        if next.as_slice().is_empty() && next.len() <= 1 {
            continue;
        }
        rows.add(&layout, &record, lines, &mut flight.report);
        std::mem::swap(&mut record, &mut next);
        end = reader.position().byte();
    }
    drop(reader);
    // A last row without a line end may be cut off inside a number.
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
    flight.report.truncated |= rows.is_cut_off();
    let is_ours = header::is_ours(&header);
    if record.position().is_none() && !is_ours {
        let help = "write a row for each sample below the names of the columns";
        return Err(problem(
            lines + 1,
            "the table has a header, but no rows",
            help,
        ));
    }
    if let Some(refused) = rows.refusal(is_ours, flight.report.messages) {
        return Err(refused);
    }
    let other_unit = rows.other_unit().filter(|_| !is_ours);
    let (from_s, last_s) = rows.span_s();
    let end_s = header::end_s(&header)?;
    let span_s = from_s..=end_s.map_or(last_s, |end_s| end_s.max(last_s));
    flight.motors = layout.motors();
    flight.in_air = rows.in_air(end_s);
    flight.commands = rows.commands;
    flight.boots_s = rows.boots_s;
    flight.rebooted_in_air_s = rows.rebooted_in_air_s;
    flight.series = preferred(vec![rows.series]);
    if let Some(refused) = battery_fraction(&flight, lines + 1).filter(|_| !is_ours) {
        return Err(refused);
    }
    let declared = apply_header(&mut flight, header, &layout, span_s)?;
    flight.range = options.range_or_given(flight.range);
    // If the limits are unknown, the meaning of the commands is unknown too, and only fractions are refused.
    if let Some((raw, refused)) = other_unit
        && (flight.range.is_some() || (0.0..=1.0).contains(&raw))
    {
        return Err(refused);
    }
    flight.geometry = geometry::find(&flight, &declared);
    Ok(flight)
}

/// The error for a state of charge from 0 to 1 in place of percent: no vehicle flies with a battery below 1 %.
fn battery_fraction(flight: &Flight, line: u64) -> Option<ReadError> {
    let signal = flight.signal("battery_remaining_pct")?;
    let known = || {
        signal
            .values
            .iter()
            .copied()
            .filter(|value| value.is_finite())
    };
    let most = known().fold(0.0, f64::max);
    if !(0.1..=1.0).contains(&most) || known().all(|value| value.fract() == 0.0) {
        return None;
    }
    let text = "all values of `battery_remaining_pct` are from 0 to 1, but it is in percent";
    Some(problem(
        line,
        text,
        "write percent: multiply the values by 100",
    ))
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

/// The maximum length of a row in bytes, with the comments above it. A file with longer header lines is not recognised
/// as a flight CSV.
const LONGEST_ROW: usize = 1_000_000;

fn too_long(line: u64) -> ReadError {
    let text = format!("the row is longer than {LONGEST_ROW} bytes");
    problem(
        line,
        text,
        "end every row with a line end: a row is one sample",
    )
}

/// Limits the bytes that are read for a row, which otherwise could fill the memory.
struct BoundedReader<'a, 'r> {
    input: &'a mut Input<'r>,
    left: &'a Cell<usize>,
}

impl Read for BoundedReader<'_, '_> {
    fn read(&mut self, to: &mut [u8]) -> io::Result<usize> {
        if self.left.get() == 0 {
            return Err(io::ErrorKind::InvalidData.into());
        }
        let count = self.input.read(to)?;
        self.left.set(self.left.get().saturating_sub(count));
        Ok(count)
    }
}

/// The unit from the suffix of a name, as in `roll_deg`.
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
