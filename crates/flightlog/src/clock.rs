//! The clock of a log: decides which timestamps to accept, and detects reboots of the autopilot.

/// The largest step back from one message to the next that is always accepted, in seconds. It is longer than
/// [`FORWARD_S`], because the previous message may be the damaged one.
const BACK_S: f64 = -2.5;
/// The largest step forward from one message to the next that is always accepted, in seconds.
const FORWARD_S: f64 = 2.0;
/// The longest step from one message to the next that is accepted in slow logs, in seconds.
const SLOWEST_S: f64 = 60.0;
/// A clock that goes back by more than this, in seconds, was restarted.
const BOOT_STEP_S: f64 = -10.0;
/// The longest pause of a log, in seconds. A time further ahead is damaged, however many messages contain it.
const LONGEST_PAUSE_S: f64 = 7.0 * 86_400.0;
/// The latest plausible time of a clock, in seconds: about three times the time since 1970.
const LATEST_S: f64 = 5e9;

/// The maximum number of boots of a log that are recorded.
const MAX_BOOTS: usize = 1000;

/// The decision how to treat a message, based on its timestamp.
#[derive(Debug, PartialEq)]
pub(crate) enum TimestampDecision {
    /// Accept the message, at this time.
    At(f64),
    /// The time of the message jumps: hold the message until the next one confirms or refutes its time.
    Wait,
    /// The held message was right: accept it at the first time, and the current one at the second time.
    Confirmed(f64, f64),
    /// The held message was wrong: drop it, and accept this one.
    Refuted(f64),
    /// The held message was wrong: drop it, and hold this one.
    RefutedWait,
}

/// Detects damaged timestamps and boots. A single message whose time jumps is damaged. If the next message agrees with
/// it, there is a pause in the log or, if the time goes back, another boot: the clock then continues from the end of
/// the previous boot.
#[derive(Debug)]
pub(crate) struct Clock {
    offset_s: f64,
    first_s: Option<f64>,
    last_s: Option<f64>,
    waiting_s: Option<f64>,
    /// The longest step that is currently accepted, a multiple of the previous step.
    longest_s: f64,
    boot_hint: bool,
    boots_s: Vec<f64>,
}

impl Default for Clock {
    fn default() -> Self {
        Self {
            offset_s: 0.0,
            first_s: None,
            last_s: None,
            waiting_s: None,
            longest_s: SLOWEST_S,
            boot_hint: false,
            boots_s: Vec::new(),
        }
    }
}

impl Clock {
    /// Notes that the log restarts here, because its definitions are repeated.
    pub(crate) fn expect_boot(&mut self) {
        self.boot_hint = true;
    }

    pub(crate) fn boots_s(&self) -> &[f64] {
        &self.boots_s
    }

    /// The offset that is added to the times of this boot.
    pub(crate) fn offset_s(&self) -> f64 {
        self.offset_s
    }

    /// The first accepted time.
    pub(crate) fn first_s(&self) -> Option<f64> {
        self.first_s
    }

    /// The latest accepted time, on the clock that continues across boots.
    pub(crate) fn now_s(&self) -> Option<f64> {
        self.last_s.map(|last| last + self.offset_s)
    }

    pub(crate) fn check(&mut self, t_s: f64) -> TimestampDecision {
        let hint = std::mem::take(&mut self.boot_hint);
        let last_s = self.last_s;
        if let Some(last_s) = last_s {
            if hint && t_s < last_s + BACK_S {
                self.waiting_s = None;
                self.boot(last_s);
                self.last_s = Some(t_s);
                return TimestampDecision::At(t_s + self.offset_s);
            }
            if self.follows(last_s, t_s) {
                let t_s = t_s + self.offset_s;
                return match self.waiting_s.take() {
                    Some(_) => TimestampDecision::Refuted(t_s),
                    None => TimestampDecision::At(t_s),
                };
            }
        }
        match self.waiting_s.replace(t_s) {
            None => TimestampDecision::Wait,
            Some(first_s) if is_possible(last_s, t_s) && self.follows(first_s, t_s) => {
                self.waiting_s = None;
                self.first_s.get_or_insert(first_s);
                if let Some(last_s) = last_s.filter(|last_s| first_s - last_s < BOOT_STEP_S) {
                    self.boot(last_s);
                }
                TimestampDecision::Confirmed(first_s + self.offset_s, t_s + self.offset_s)
            }
            Some(_) => {
                self.longest_s = (2.0 * self.longest_s).min(SLOWEST_S);
                TimestampDecision::RefutedWait
            }
        }
    }

    /// Returns whether a message at `t_s` can follow one at `last_s`. If it can, accepts it as the latest message.
    fn follows(&mut self, last_s: f64, t_s: f64) -> bool {
        let step_s = t_s - last_s;
        let follows = (BACK_S..=self.longest_s).contains(&step_s);
        if follows {
            self.longest_s = (2.0 * step_s).clamp(FORWARD_S, SLOWEST_S);
            self.last_s = Some(t_s);
        }
        follows
    }

    /// Whether a timestamp is plausible after the latest accepted one; the first timestamp always
    /// is.
    #[cfg(feature = "mavlink")]
    pub(crate) fn is_next(&self, t_s: f64) -> bool {
        self.last_s
            .is_none_or(|last_s| (BACK_S..=self.longest_s).contains(&(t_s - last_s)))
    }

    /// Whether the maximum number of boots was reached.
    pub(crate) fn is_full(&self) -> bool {
        self.boots_s.len() >= MAX_BOOTS
    }

    fn boot(&mut self, last_s: f64) {
        self.offset_s += last_s;
        if !self.is_full() {
            self.boots_s.push(self.offset_s);
        }
    }
}

/// Seconds since boot from a 32-bit count of microseconds, which wraps around after 71 minutes. Of the possible
/// times, the one nearest to the last accepted time is returned.
pub(crate) fn seconds_of(micros: u32, last_s: Option<f64>) -> f64 {
    const ROUND_S: f64 = 4_294.967_296;
    let t_s = f64::from(micros) * 1e-6;
    let rounds = last_s.map_or(0.0, |last_s| ((last_s - t_s) / ROUND_S).round().max(0.0));
    t_s + rounds * ROUND_S
}

/// The latest time, in seconds, of a log whose messages may arrive late. A message that is far ahead of all others is
/// damaged.
#[derive(Debug)]
pub(crate) struct Latest {
    latest_s: Option<f64>,
    waiting_s: Option<f64>,
    longest_pause_s: f64,
}

impl Latest {
    pub(crate) fn new(longest_pause_s: f64) -> Self {
        Self {
            latest_s: None,
            waiting_s: None,
            longest_pause_s,
        }
    }

    pub(crate) fn time_s(&self) -> Option<f64> {
        self.latest_s
    }

    /// Whether to accept a time. A time too far after all earlier ones is damaged, unless the next such time agrees
    /// with it.
    pub(crate) fn accept(&mut self, t_s: f64) -> bool {
        let latest_s = *self.latest_s.get_or_insert(t_s);
        let agrees = |with_s: f64| t_s - with_s <= self.longest_pause_s;
        let witness = |waiting_s: f64| t_s >= waiting_s && agrees(waiting_s);
        if !agrees(latest_s) && !self.waiting_s.is_some_and(witness) {
            self.waiting_s = Some(t_s);
            return false;
        }
        self.latest_s = Some(latest_s.max(t_s));
        true
    }
}

/// Whether a log may continue at this time after a pause: neither the time nor the pause is impossibly large.
fn is_possible(last_s: Option<f64>, t_s: f64) -> bool {
    t_s < LATEST_S && last_s.is_none_or(|last_s| t_s - last_s < LONGEST_PAUSE_S)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Returns the times of the messages that are kept, in order.
    fn times_kept(times: &[f64]) -> Vec<f64> {
        let mut clock = Clock::default();
        let mut kept = Vec::new();
        for &t in times {
            match clock.check(t) {
                TimestampDecision::At(t) | TimestampDecision::Refuted(t) => kept.push(t),
                TimestampDecision::Confirmed(a, b) => kept.extend([a, b]),
                TimestampDecision::Wait | TimestampDecision::RefutedWait => {}
            }
        }
        kept
    }

    #[test]
    fn damage_pauses_and_boots_are_distinguished() {
        let cases: &[(&str, &[f64], &[f64])] = &[
            ("plain", &[5.0, 5.1, 5.2], &[5.0, 5.1, 5.2]),
            ("one wild time", &[5.0, 5.1, 9e9, 5.2], &[5.0, 5.1, 5.2]),
            (
                "one time that goes back",
                &[5.0, 5.1, 0.0, 5.2],
                &[5.0, 5.1, 5.2],
            ),
            (
                "two wild times",
                &[5.0, 5.1, 9e9, 7e5, 5.2],
                &[5.0, 5.1, 5.2],
            ),
            ("wild at the start", &[9e9, 5.0, 5.1], &[5.0, 5.1]),
            ("a pause", &[5.0, 5.1, 90.0, 90.1], &[5.0, 5.1, 90.0, 90.1]),
            (
                "a boot",
                &[25.0, 25.5, 2.0, 2.5, 3.0],
                &[25.0, 25.5, 27.5, 28.0, 28.5],
            ),
        ];
        for (name, times, expected) in cases {
            assert_eq!(times_kept(times), *expected, "{name}");
        }
    }

    #[test]
    fn late_times_are_accepted_and_times_far_ahead_are_not() {
        let mut latest = Latest::new(60.0);
        let reported: Vec<bool> = [100.0, 3.0, 1e6, 101.0, 5e6, 5.00001e6, 102.0]
            .into_iter()
            .map(|t_s| latest.accept(t_s))
            .collect();
        assert_eq!(reported, [true, true, false, true, false, true, true]);
    }

    #[test]
    fn a_repeated_definition_announces_a_boot() {
        let mut clock = Clock::default();
        clock.check(6.0);
        clock.check(6.5);
        clock.expect_boot();
        assert_eq!(clock.check(2.0), TimestampDecision::At(8.5));
        assert_eq!(clock.boots_s(), [6.5]);
        assert_eq!(clock.now_s(), Some(8.5));
    }
}
