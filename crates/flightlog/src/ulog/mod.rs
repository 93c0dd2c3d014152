//! Reads PX4 ULog files: a header, then messages, each with a length, a letter and a body
//! (<https://docs.px4.io/main/en/dev_log/ulog_file_format.html>).
//!
//! Messages have no checksum, so each is checked in other ways: its letter, the length of its topic, and whether
//! another message follows.

mod collect;
mod format;
mod outputs;
mod plan;
mod signals;
mod topics;

use std::io;

use self::collect::Collector;
use crate::input::Input;
use crate::{Flight, Options};

const MAGIC: [u8; 7] = *b"ULog\x01\x12\x35";
const FILE_HEAD: usize = 16;
/// The length of the header of a message in bytes: its length (16 bits) and its letter.
const HEAD: usize = 3;
const LONGEST: usize = HEAD + u16::MAX as usize;
/// Body of a synchronisation message.
const SYNC: [u8; 8] = [0x2f, 0x73, 0x13, 0x20, 0x25, 0x0c, 0xbb, 0x12];

/// The names and units of the signals that these logs can contain.
pub(crate) fn known_signals() -> impl Iterator<Item = (&'static str, &'static str)> {
    let signals = signals::SPECS.iter().flat_map(|spec| spec.signals);
    signals.map(|(_, name, unit)| (*name, *unit))
}

/// Whether a file starts like a ULog file or, if its header is damaged, contains the definition of a topic.
pub(crate) fn looks_like(start: &[u8]) -> bool {
    const DEFINITION: &[u8] = b":uint64_t timestamp;";
    start.starts_with(&MAGIC)
        || start
            .windows(DEFINITION.len())
            .any(|bytes| bytes == DEFINITION)
}

pub(crate) fn read(input: &mut Input<'_>, options: &Options) -> io::Result<Flight> {
    let mut scanner = Scanner {
        collector: Collector::new(options),
        at: 0,
        appended: Vec::new(),
    };
    input.scan(|window, at_end| scanner.scan(window, at_end))?;
    Ok(scanner.collector.finish())
}

struct Scanner<'o> {
    collector: Collector<'o>,
    /// The number of bytes before the window.
    at: u64,
    /// The offsets at which data was appended after the log had been closed (crash dumps), ascending.
    appended: Vec<u64>,
}

impl Scanner<'_> {
    /// Reads the messages of a window and returns the number of processed bytes.
    fn scan(&mut self, window: &[u8], at_end: bool) -> usize {
        let mut at = 0;
        if self.at == 0 && window.starts_with(&MAGIC) && window.len() >= FILE_HEAD {
            if let Some(start_us) = window[8..FILE_HEAD].first_chunk() {
                self.collector.started(u64::from_le_bytes(*start_us));
            }
            at = FILE_HEAD;
        }
        // Except at the end, the window contains a whole message and the header of the next.
        let sure = match at_end {
            true => window.len(),
            false => window.len().saturating_sub(LONGEST + HEAD),
        };
        while at < sure {
            let room = if at_end { usize::MAX } else { sure - at };
            at += self.step(&window[at..], self.at + at as u64, room);
        }
        let used = at.min(window.len());
        self.at += used as u64;
        used
    }

    /// Handles the start of `bytes`, at `offset` in the file; returns the number of bytes handled. After `room` bytes,
    /// damage cannot be distinguished from a message that continues after the window.
    fn step(&mut self, bytes: &[u8], offset: u64, room: usize) -> usize {
        // At the offset of appended data a new message starts, even if the previous message is not complete.
        let next = self.appended.iter().find(|&&start| start > offset);
        let limit = next.and_then(|start| usize::try_from(start - offset).ok());
        let within = &bytes[..limit.unwrap_or(bytes.len()).min(bytes.len())];
        let report = &mut self.collector.report;
        match self.collector.topics.message(within) {
            Some(message) if message.len() <= within.len() => {
                let letter = within[2];
                let body = &message[HEAD..];
                report.messages += 1;
                if let (b'B', Some(starts)) = (letter, body.get(16..40)) {
                    self.appended = flagged_starts(body, starts);
                }
                self.collector.message(letter, body);
                message.len()
            }
            _ => {
                let skip = self.next_message(within).min(room);
                let report = &mut self.collector.report;
                report.skipped_bytes += skip as u64;
                let ends = skip == within.len();
                if ends && limit.is_none() {
                    report.truncated = true;
                    report.because(|| "the log ends inside a message".into());
                } else {
                    report.because(|| "bytes that belong to no message".into());
                }
                skip
            }
        }
    }

    /// The offset of the next message that is certainly not damaged.
    fn next_message(&self, bytes: &[u8]) -> usize {
        (1..bytes.len())
            .find(|&at| self.collector.topics.certain(&bytes[at..]))
            .unwrap_or(bytes.len())
    }
}

/// The offsets of appended data, if the flags indicate that there is any.
fn flagged_starts(body: &[u8], starts: &[u8]) -> Vec<u64> {
    if body.get(8).is_none_or(|flags| flags & 1 == 0) {
        return Vec::new();
    }
    starts
        .chunks_exact(8)
        .filter_map(|chunk| Some(u64::from_le_bytes(*chunk.first_chunk()?)))
        .filter(|&start| start > 0)
        .collect()
}
