//! Reads DataFlash logs as text (`.log`): one message per line, which begins with its name.

use std::collections::HashMap;
use std::io::{self, BufRead, Read};

use super::collect::Collector;
use super::format::{Cells, FMT, Format};
use crate::input::Input;
use crate::{Flight, Options};

/// The maximum length of a line in bytes; longer lines are damaged and skipped.
const LONGEST_LINE: u64 = 4096;

/// The maximum number of lines that are stored from before the first definition; these lines contain the name of the
/// firmware.
const GREETINGS: usize = 20;

/// Whether one of the first lines defines a message.
pub(crate) fn looks_like(start: &[u8]) -> bool {
    start
        .split(|&byte| byte == b'\n')
        .take(200)
        .any(|line| line.starts_with(b"FMT,"))
}

pub(crate) fn read(input: &mut Input<'_>, options: &Options) -> io::Result<Flight> {
    let mut reader = Lines {
        collector: Collector::new(options),
        types: HashMap::new(),
    };
    let mut line = Vec::new();
    loop {
        line.clear();
        let read = input.take(LONGEST_LINE).read_until(b'\n', &mut line)?;
        if read == 0 {
            break;
        }
        if line.len() as u64 == LONGEST_LINE && !line.ends_with(b"\n") {
            let skipped = LONGEST_LINE + skip_line(input)?;
            let report = &mut reader.collector.report;
            report.skipped_bytes += skipped;
            report.bad(&format!("a line longer than {LONGEST_LINE} bytes"));
            continue;
        }
        reader.line(&line);
    }
    Ok(reader
        .collector
        .finish(Flight::empty(crate::Format::DataFlashText)))
}

/// Skips the rest of a line and returns its length.
fn skip_line(input: &mut Input<'_>) -> io::Result<u64> {
    let mut skipped = 0;
    loop {
        let seen = input.fill_buf()?;
        let end = seen.iter().position(|&byte| byte == b'\n');
        let count = end.map_or(seen.len(), |end| end + 1);
        input.consume(count);
        skipped += count as u64;
        if end.is_some() || count == 0 {
            return Ok(skipped);
        }
    }
}

struct Lines<'o> {
    collector: Collector<'o>,
    /// The type of each message by its name.
    types: HashMap<String, u8>,
}

impl Lines<'_> {
    fn line(&mut self, bytes: &[u8]) {
        let text = String::from_utf8_lossy(bytes);
        let trimmed = text.trim();
        if trimmed.is_empty() {
            return;
        }
        if self.types.is_empty() && !trimmed.starts_with("FMT,") {
            if self.collector.greetings.len() < GREETINGS {
                self.collector.greetings.push(trimmed.to_owned());
            }
            return;
        }
        let mut cells = trimmed.split(',').map(str::trim);
        let name = cells.next().unwrap_or_default();
        let cells: Vec<&str> = cells.collect();
        if name == "FMT" {
            return self.define(&cells, bytes.len());
        }
        let Some(&type_id) = self.types.get(name) else {
            self.collector.report.skipped_bytes += bytes.len() as u64;
            let report = &mut self.collector.report;
            report.because(|| "a line without a definition".into());
            return;
        };
        if let Err(why) = self.collector.check(type_id, &cells) {
            let ends = !text.ends_with('\n');
            self.collector.report.truncated |= ends;
            return self
                .collector
                .report
                .bad(&format!("a line of `{name}` {why}"));
        }
        self.collector.report.messages += 1;
        self.collector.message(type_id, Cells::Text(&cells));
    }

    /// Stores the definition in a line `FMT, type, length, name, kinds, label, label, ...`.
    fn define(&mut self, cells: &[&str], bytes: usize) {
        let format = match cells {
            [type_id, length, name, kinds, labels @ ..] if !name.is_empty() => (type_id.parse())
                .ok()
                .zip(length.parse().ok())
                .map(|(type_id, length)| {
                    Format::new(type_id, length, name, kinds, &labels.join(","))
                }),
            _ => None,
        };
        let Some(format) = format else {
            self.collector.report.skipped_bytes += bytes as u64;
            return self.collector.report.bad("a definition that is not valid");
        };
        self.collector.report.messages += 1;
        let (type_id, name) = (format.type_id, format.name.clone());
        if self.collector.define(format) && type_id != FMT {
            // A type has one name at a time, so there are at most 256 entries.
            self.types.retain(|_, known| *known != type_id);
            self.types.insert(name, type_id);
        }
    }
}
