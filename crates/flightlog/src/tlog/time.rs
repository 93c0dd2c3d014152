//! The vehicle's clock in a telemetry log, whose own timestamps are times of reception.

use crate::clock::{Clock, TimestampDecision, seconds_of};
use crate::field::NumberType;
use crate::mavlink::decoder::{Payload, ServoOutputs, number};

/// Messages that begin with the milliseconds since boot: ATTITUDE and ATTITUDE_TARGET.
const BOOT_MS: [u32; 2] = [30, 83];
/// The time in a message is accepted if it differs by at most this from the time of the latest motor commands, in
/// seconds.
const LATE_S: f64 = 5.0;

/// The clock of one vehicle. It follows the times in the motor commands; between commands, it advances with the
/// times of reception.
#[derive(Default)]
pub(super) struct VehicleTime {
    clock: Clock,
    /// The latest motor commands: the time of reception, and their own time.
    latest: Option<(f64, f64)>,
    /// Commands whose time jumps, held until the next commands show whether that time is damaged.
    waiting: Option<(f64, ServoOutputs)>,
}

/// Motor commands and their times.
#[derive(Default)]
pub(super) struct TimedCommands {
    /// The rows to accept now, in order.
    pub(super) rows: [Option<(f64, ServoOutputs)>; 2],
    /// Whether a row with a damaged time was dropped.
    pub(super) dropped: bool,
    /// The offset of the vehicle's clock from the time of reception; `None` unless these are the first commands that
    /// contain a time.
    pub(super) ahead_s: Option<f64>,
}

impl VehicleTime {
    /// Processes motor commands that were received at `received_s`.
    pub(super) fn commands(&mut self, received_s: f64, outputs: ServoOutputs) -> TimedCommands {
        if outputs.time_us == 0 {
            let rows = [Some((self.guess_s(received_s), outputs)), None];
            return TimedCommands {
                rows,
                ..TimedCommands::default()
            };
        }
        let last_s = self.clock.now_s().or(self.waiting.map(|(t_s, _)| t_s));
        let stamp_s = seconds_of(outputs.time_us, last_s);
        let checked = self.clock.check(stamp_s);
        let waited = self.waiting.take();
        let (rows, dropped) = match checked {
            TimestampDecision::At(t_s) => ([Some((t_s, outputs)), None], false),
            TimestampDecision::Refuted(t_s) => ([Some((t_s, outputs)), None], true),
            TimestampDecision::Confirmed(first_s, t_s) => {
                let first = waited.map(|(_, outputs)| (first_s, outputs));
                ([first, Some((t_s, outputs))], false)
            }
            TimestampDecision::Wait | TimestampDecision::RefutedWait => {
                self.waiting = Some((stamp_s, outputs));
                ([None, None], checked == TimestampDecision::RefutedWait)
            }
        };
        let latest_s = rows.iter().flatten().last().map(|(t_s, _)| *t_s);
        let before = self.latest;
        self.latest = latest_s.map(|t_s| (received_s, t_s)).or(before);
        TimedCommands {
            rows,
            dropped,
            ahead_s: latest_s
                .filter(|_| before.is_none())
                .map(|t_s| t_s - received_s),
        }
    }

    fn guess_s(&self, received_s: f64) -> f64 {
        self.latest.map_or(received_s, |(then_s, commands_s)| {
            commands_s + (received_s - then_s).max(0.0)
        })
    }

    /// Whether the vehicle's clock is known.
    pub(super) fn is_known(&self) -> bool {
        self.latest.is_some()
    }

    /// Whether the maximum number of boots was reached.
    pub(super) fn is_full(&self) -> bool {
        self.clock.is_full()
    }

    /// The start of each boot except the first.
    pub(super) fn boots_s(&self) -> &[f64] {
        self.clock.boots_s()
    }

    /// The time of a message without motor commands; while the vehicle's clock is unknown, the time of reception.
    pub(super) fn other(&self, received_s: f64, id: u32, payload: &Payload) -> f64 {
        let guess_s = self.guess_s(received_s);
        let Some((_, commands_s)) = self.latest else {
            return guess_s;
        };
        let own = BOOT_MS
            .contains(&id)
            .then(|| number(payload, 0, NumberType::U32));
        // `self.clock` continues across boots, while the time in a message restarts.
        let own_s = own.flatten().map(|ms| ms * 1e-3 + self.clock.offset_s());
        own_s
            .filter(|own_s| (own_s - commands_s).abs() <= LATE_S)
            .unwrap_or(guess_s)
    }
}
