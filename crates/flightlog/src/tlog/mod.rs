//! Reads MAVLink telemetry logs (`.tlog`): each packet, of version 1 or 2, is preceded by microseconds since 1970 (8
//! bytes, big-endian). The times of a flight are those of the vehicle's clock, which the motor commands contain. If
//! the commands contain no times, the times of the flight are the times of reception, from 0 at the first packet.

mod collect;
mod time;

use std::io;

use self::collect::Collector;
use crate::input::Input;
use crate::mavlink::packet::{LONGEST as LONGEST_PACKET, Packet};
use crate::mavlink::signals::SPECS;
use crate::{Flight, Options};

/// The length of a timestamp in bytes.
const STAMP: usize = 8;
const LONGEST: usize = STAMP + LONGEST_PACKET;
/// The range of plausible timestamps, in microseconds since 1970: the years 2000 to 2100.
const STAMPS_US: std::ops::Range<u64> = 946_684_800_000_000..4_102_444_800_000_000;

/// The names and units of the signals that these logs can contain.
pub(crate) fn known_signals() -> impl Iterator<Item = (&'static str, &'static str)> {
    let signals = SPECS.iter().flat_map(|spec| spec.signals);
    signals.map(|(_, name, unit)| (*name, *unit))
}

/// Whether a timestamp, followed by a packet with a right checksum, begins at one of the first bytes.
pub(crate) fn looks_like(start: &[u8]) -> bool {
    let start = &start[..start.len().min(16 * LONGEST)];
    (0..start.len()).any(|at| {
        start[at..].len() > STAMP
            && matches!(start[at + STAMP], 0xfd | 0xfe)
            && record(&start[at..]).is_some_and(|(_, packet)| packet.sound == Some(true))
    })
}

pub(crate) fn read(input: &mut Input<'_>, options: &Options) -> io::Result<Flight> {
    let mut collector = Collector::new(options);
    input.scan(|window, at_end| scan(&mut collector, window, at_end))?;
    Ok(collector.finish())
}

/// Reads the packets of a window and returns the number of processed bytes.
fn scan(collector: &mut Collector<'_>, window: &[u8], at_end: bool) -> usize {
    // Except at the end, the window contains a whole packet and the start of the next.
    let sure = match at_end {
        true => window.len(),
        false => window.len().saturating_sub(2 * LONGEST),
    };
    let mut at = 0;
    while at < sure {
        let rest = &window[at..];
        match accepted_record(rest) {
            Some((stamp_us, packet)) => {
                collector.report.messages += 1;
                collector.packet(stamp_us, &packet);
                at += STAMP + packet.bytes.len();
            }
            None => {
                let skip = match at_end {
                    true => next(rest),
                    // A packet may start at the end of the window.
                    false => next(rest).min(sure - at),
                };
                let report = &mut collector.report;
                // A packet that is complete except for its checksum was damaged.
                let broken =
                    record(rest).is_some_and(|(_, packet)| STAMP + packet.bytes.len() == skip);
                report.bad_messages += u64::from(broken);
                report.skipped_bytes += skip as u64;
                if skip == rest.len() && !broken {
                    report.truncated = true;
                    report.because(|| "the log ends inside a message".into());
                } else {
                    report.because(|| {
                        "packets with a wrong checksum, or bytes that are not packets".into()
                    });
                }
                at += skip;
            }
        }
    }
    at.min(window.len())
}

/// The timestamp and the packet at the start of `bytes`.
fn record(bytes: &[u8]) -> Option<(u64, Packet<'_>)> {
    let (stamp, rest) = bytes.split_first_chunk()?;
    Some((u64::from_be_bytes(*stamp), Packet::at(rest)?))
}

/// The record at the start of `bytes`, if its checksum is right. The checksum of a packet of another dialect cannot be
/// verified; it is accepted if its timestamp is plausible and a packet follows.
fn accepted_record(bytes: &[u8]) -> Option<(u64, Packet<'_>)> {
    let (stamp_us, packet) = record(bytes)?;
    let is_accepted = packet.sound.unwrap_or_else(|| {
        let rest = &bytes[STAMP + packet.bytes.len()..];
        let next = rest
            .get(STAMP)
            .is_none_or(|magic| matches!(magic, 0xfd | 0xfe));
        STAMPS_US.contains(&stamp_us) && next
    });
    is_accepted.then_some((stamp_us, packet))
}

/// The offset of the next record that is certainly not damaged.
fn next(bytes: &[u8]) -> usize {
    let starts = |at: &usize| {
        bytes
            .get(at + STAMP)
            .is_some_and(|magic| matches!(magic, 0xfd | 0xfe))
            && record(&bytes[*at..]).is_some_and(|(_, packet)| packet.sound == Some(true))
    };
    (1..bytes.len()).find(starts).unwrap_or(bytes.len())
}
