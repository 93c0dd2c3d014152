//! Reads ArduPilot DataFlash logs, in binary form here and as text in [`text`].
//!
//! A binary log is a sequence of records: `A3 95`, a type, and as many bytes as the FMT record of that type defines.
//! Records have no checksum, so a record is accepted only if another one follows it; see
//! <https://ardupilot.org/dev/docs/code-overview-adding-a-new-log-message.html>.

mod collect;
mod format;
mod plan;
mod signals;
mod state_events;
pub(crate) mod text;
mod untimed;

use std::io;

use self::collect::Collector;
use self::format::{Cells, FMT, Format};
use crate::input::Input;
use crate::{Flight, Options};

const HEAD: [u8; 2] = [0xa3, 0x95];
/// The length of FMT records, the only length known before the log is read.
const FMT_LENGTH: usize = 89;
/// The maximum length of a record, which is stored in one byte.
const LONGEST: usize = 255;

/// The names and units of the signals that these logs can contain.
pub(crate) fn known_signals() -> impl Iterator<Item = (&'static str, &'static str)> {
    let signals = signals::SPECS.iter().flat_map(|spec| spec.signals);
    signals.map(|(_, name, unit)| (*name, *unit))
}

/// Whether the start of a file contains a DataFlash definition.
pub(crate) fn looks_like(start: &[u8]) -> bool {
    start.starts_with(&[HEAD[0], HEAD[1], FMT])
        || start
            .windows(8)
            .any(|bytes| bytes.starts_with(&HEAD) && bytes.ends_with(b"FMT\0"))
}

pub(crate) fn read(input: &mut Input<'_>, options: &Options) -> io::Result<Flight> {
    let mut scanner = Scanner::new(options);
    input.scan(|window, at_end| scanner.scan(window, at_end))?;
    Ok(scanner
        .collector
        .finish(Flight::empty(crate::Format::DataFlash)))
}

struct Scanner<'o> {
    collector: Collector<'o>,
    /// The length of the records of each type; 0 for types without a definition.
    lengths: [u8; 256],
    wanted: [bool; 256],
}

impl<'o> Scanner<'o> {
    fn new(options: &'o Options) -> Self {
        let mut lengths = [0; 256];
        lengths[usize::from(FMT)] = FMT_LENGTH as u8;
        let mut wanted = [false; 256];
        wanted[usize::from(FMT)] = true;
        Self {
            collector: Collector::new(options),
            lengths,
            wanted,
        }
    }

    /// Reads the records of a window and returns the number of processed bytes: all bytes except a record that may
    /// continue after the window; at the end of the log, all bytes.
    fn scan(&mut self, window: &[u8], at_end: bool) -> usize {
        // Except at the end, the window contains two whole records and the header of the next.
        let sure = match at_end {
            true => window.len(),
            false => window.len().saturating_sub(2 * LONGEST + HEAD.len()),
        };
        let mut at = 0;
        let mut length = self.length(window);
        let mut messages = 0;
        while at < sure {
            let end = at + length;
            let next = self.length(window.get(end..).unwrap_or_default());
            if length == 0 || next == 0 {
                at += self.step(&window[at..], sure - at, at_end);
                length = self.length(window.get(at..).unwrap_or_default());
                continue;
            }
            // The usual case: a record, followed by another one.
            messages += 1;
            length = next;
            let type_id = window[at + 2];
            if self.wanted[usize::from(type_id)] {
                self.take(type_id, &window[at + 3..end]);
                if type_id == FMT {
                    length = self.length(&window[end..]);
                }
            }
            at = end;
        }
        self.collector.report.messages += messages;
        at.min(window.len())
    }

    /// Processes the start of `bytes`, which is not a record or is a record that no other record follows; returns the
    /// number of processed bytes. Up to `sure`, damage can be distinguished from a record that continues after the
    /// window.
    fn step(&mut self, bytes: &[u8], sure: usize, at_end: bool) -> usize {
        let found = self.record(bytes);
        let report = &mut self.collector.report;
        match found {
            ScanResult::Record { type_id, payload } => {
                report.messages += 1;
                if self.wanted[usize::from(type_id)] {
                    self.take(type_id, payload);
                }
                3 + payload.len()
            }
            ScanResult::Cut => {
                report.truncated = true;
                report.because(|| "the log ends inside a message".into());
                report.skipped_bytes += bytes.len() as u64;
                bytes.len()
            }
            ScanResult::Damage { skip } => {
                let skip = if at_end { skip } else { skip.min(sure) };
                report.skipped_bytes += skip as u64;
                report.because(|| "bytes that belong to no message".into());
                skip
            }
        }
    }

    fn take(&mut self, type_id: u8, payload: &[u8]) {
        if type_id != FMT {
            return self.collector.message(type_id, Cells::Binary(payload));
        }
        let Some(format) = Format::from_payload(payload) else {
            return self.collector.report.bad("a definition that is not valid");
        };
        let (type_id, length) = (format.type_id, format.length);
        if self.collector.define(format) && type_id != FMT {
            self.lengths[usize::from(type_id)] = u8::try_from(length).unwrap_or(0);
            self.wanted[usize::from(type_id)] = self.collector.wants(type_id);
        }
    }

    /// Classifies the start of `bytes`.
    fn record<'a>(&self, bytes: &'a [u8]) -> ScanResult<'a> {
        let length = self.length(bytes);
        if bytes.len() < 3 && HEAD.starts_with(&bytes[..bytes.len().min(2)]) {
            return ScanResult::Cut;
        }
        if length == 0 {
            return ScanResult::Damage {
                skip: self.next_head(bytes, 1, bytes.len()),
            };
        }
        let (Some(payload), Some(&type_id)) = (bytes.get(3..length), bytes.get(2)) else {
            return ScanResult::Cut;
        };
        if bytes.len() == length || self.starts(&bytes[length..]) {
            return ScanResult::Record { type_id, payload };
        }
        // No record follows. If a record that starts inside this one is itself followed by another, then bytes of this
        // one are missing; otherwise the next record is damaged.
        let inner = self.next_head(bytes, 1, length);
        if inner < length && self.starts(&bytes[inner + self.length(&bytes[inner..])..]) {
            return ScanResult::Damage { skip: inner };
        }
        ScanResult::Record { type_id, payload }
    }

    /// The length of the record that starts here; 0 if none does.
    fn length(&self, bytes: &[u8]) -> usize {
        match bytes {
            [a, b, type_id, ..] if [*a, *b] == HEAD => self.lengths[usize::from(*type_id)].into(),
            _ => 0,
        }
    }

    /// Whether a record starts here, or the log ends.
    fn starts(&self, bytes: &[u8]) -> bool {
        self.length(bytes) > 0 || HEAD.starts_with(&bytes[..bytes.len().min(2)])
    }

    /// The position of the next record, from `from` and before `to`; `to` if there is none.
    fn next_head(&self, bytes: &[u8], from: usize, to: usize) -> usize {
        (from..to)
            .find(|&at| {
                let length = self.length(&bytes[at..]);
                length > 0 && at + length <= bytes.len()
            })
            .unwrap_or(to)
    }
}

enum ScanResult<'a> {
    Record {
        type_id: u8,
        payload: &'a [u8],
    },
    /// The log ends before the record does.
    Cut,
    Damage {
        skip: usize,
    },
}
