//! Messages without a time, as firmware before 3.2 logs them.

use super::format::Cells;

/// The maximum size of the pending messages in bytes, with an allowance for each message, so that a log without any time
/// does not fill the memory.
const MAX_BYTES: usize = 1 << 24;
const BYTES_PER_MESSAGE: usize = 64;

/// A message that is pending until its time is known.
pub(super) enum PendingMessage {
    Binary(u8, Vec<u8>),
    /// The cells, joined by commas; no cell contains a comma.
    Text(u8, String),
}

impl PendingMessage {
    pub(super) fn new(type_id: u8, cells: Cells<'_>) -> Self {
        match cells {
            Cells::Binary(payload) => Self::Binary(type_id, payload.to_vec()),
            Cells::Text(cells) => Self::Text(type_id, cells.join(",")),
        }
    }

    fn bytes(&self) -> usize {
        BYTES_PER_MESSAGE
            + match self {
                Self::Binary(_, payload) => payload.len(),
                Self::Text(_, cells) => cells.len(),
            }
    }

    pub(super) fn give(&self, take: impl FnOnce(u8, Cells<'_>)) {
        match self {
            Self::Binary(type_id, payload) => take(*type_id, Cells::Binary(payload)),
            Self::Text(type_id, cells) => {
                let cells: Vec<&str> = cells.split(',').collect();
                take(*type_id, Cells::Text(&cells));
            }
        }
    }
}

/// Assigns times to messages without one, spread evenly between the surrounding messages with a time (usually GPS at
/// 5 Hz).
#[derive(Default)]
pub(super) struct UntimedMessages {
    pending: Vec<PendingMessage>,
    pending_bytes: usize,
    /// The number of pending messages before the first message with a time.
    before_first: usize,
    /// The time of the last message with a time.
    last_s: Option<f64>,
    /// The interval at which messages were last spread, in seconds.
    step_s: f64,
}

impl UntimedMessages {
    /// Keeps a message until its time is known; returns `false` if there are too many already.
    pub(super) fn keep(&mut self, type_id: u8, cells: Cells<'_>) -> bool {
        let has_room = self.pending_bytes < MAX_BYTES;
        if has_room {
            let pending = PendingMessage::new(type_id, cells);
            self.pending_bytes += pending.bytes();
            self.pending.push(pending);
        }
        has_room
    }

    pub(super) fn is_empty(&self) -> bool {
        self.pending.is_empty()
    }

    /// Notes that the first message with a time was read, but is not confirmed yet.
    pub(super) fn mark_first(&mut self) {
        self.before_first = self.pending.len();
    }

    /// Notes that the first message with a time is confirmed, at the time `first_s`.
    pub(super) fn confirm_first(&mut self, first_s: f64) {
        self.last_s.get_or_insert(first_s);
    }

    /// Returns the pending messages, evenly spaced in time up to the message at `t_s`, which follows them. Messages before
    /// the first message with a time get the same spacing as those after it.
    pub(super) fn timed_before(
        &mut self,
        t_s: f64,
    ) -> impl Iterator<Item = (f64, PendingMessage)> + use<> {
        let from_s = self.last_s.replace(t_s).unwrap_or(t_s).min(t_s);
        let before = std::mem::take(&mut self.before_first);
        let after = self.pending.len().saturating_sub(before);
        if after > 0 {
            self.step_s = (t_s - from_s) / (after + 1) as f64;
        }
        self.spread(from_s, before)
    }

    /// Returns the messages after the last message with a time; none if there was no such message.
    pub(super) fn timed_at_end(&mut self) -> impl Iterator<Item = (f64, PendingMessage)> + use<> {
        if self.last_s.is_none() {
            self.pending.clear();
        }
        self.spread(self.last_s.unwrap_or_default(), 0)
    }

    /// Spreads the pending messages in time. The first `before` of them precede the message with the time `from_s`;
    /// the others follow it.
    fn spread(
        &mut self,
        from_s: f64,
        before: usize,
    ) -> impl Iterator<Item = (f64, PendingMessage)> + use<> {
        let step_s = self.step_s;
        self.pending_bytes = 0;
        std::mem::take(&mut self.pending)
            .into_iter()
            .enumerate()
            .map(move |(index, pending)| {
                let steps = match index < before {
                    true => -((before - index) as f64),
                    false => (index - before + 1) as f64,
                };
                (from_s + step_s * steps, pending)
            })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn keep(untimed: &mut UntimedMessages, count: usize) {
        for _ in 0..count {
            assert!(untimed.keep(1, Cells::Binary(&[])));
        }
    }

    fn times(timed: impl Iterator<Item = (f64, PendingMessage)>) -> Vec<f64> {
        timed.map(|(t_s, _)| t_s).collect()
    }

    #[test]
    fn messages_are_spread_between_those_with_a_time() {
        let mut untimed = UntimedMessages::default();
        keep(&mut untimed, 2);
        untimed.mark_first();
        keep(&mut untimed, 1);
        untimed.confirm_first(10.0);
        assert_eq!(times(untimed.timed_before(12.0)), [8.0, 9.0, 11.0]);
        keep(&mut untimed, 3);
        assert_eq!(times(untimed.timed_before(14.0)), [12.5, 13.0, 13.5]);
        keep(&mut untimed, 2);
        assert_eq!(times(untimed.timed_at_end()), [14.5, 15.0]);
    }

    #[test]
    fn without_any_time_nothing_has_a_time() {
        let mut untimed = UntimedMessages::default();
        keep(&mut untimed, 2);
        assert!(times(untimed.timed_at_end()).is_empty());
    }
}
