//! The clock of a log: which time stamps to believe, and where it starts again.

/// Steps from one message to the next that need no second witness, in seconds. Back must
/// reach further than forward: the message before may be the damaged one.
const PLAIN_STEP_S: std::ops::RangeInclusive<f64> = -2.5..=2.0;
/// How far after a message that jumped the next one bears witness to it, in seconds.
const WITNESS_STEP_S: std::ops::RangeInclusive<f64> = -1.0..=60.0;
/// A clock that goes back by more than this, in seconds, started anew.
const BOOT_STEP_S: f64 = -10.0;

/// What to do with a message of some time.
#[derive(Debug, PartialEq)]
pub(crate) enum Placed {
    /// Take it, at this time.
    At(f64),
    /// Its time jumps: keep it until the next message tells whether that was true.
    Wait,
    /// The message that waited was right: take it at the first time, this one at the second.
    Confirmed(f64, f64),
    /// The message that waited was wrong: drop it, take this one.
    Refuted(f64),
    /// The message that waited was wrong, and this one waits now.
    RefutedWait,
}

/// Sorts out damaged time stamps and boots. One message with a time that jumps is
/// damage; two in a row that agree are a pause in the log or, when the time goes back,
/// another boot: then the clock goes on from where the boot before ended.
#[derive(Debug, Default)]
pub(crate) struct Clock {
    offset_s: f64,
    first_s: Option<f64>,
    last_s: Option<f64>,
    waiting_s: Option<f64>,
    boot_hint: bool,
    boots_s: Vec<f64>,
}

impl Clock {
    /// The log starts again here (its definitions are repeated).
    pub(crate) fn expect_boot(&mut self) {
        self.boot_hint = true;
    }

    pub(crate) fn boots_s(&self) -> &[f64] {
        &self.boots_s
    }

    /// The first believed time.
    pub(crate) fn first_s(&self) -> Option<f64> {
        self.first_s
    }

    /// The latest believed time, on the clock that goes on over boots.
    pub(crate) fn now_s(&self) -> Option<f64> {
        self.last_s.map(|last| last + self.offset_s)
    }

    pub(crate) fn place(&mut self, t_s: f64) -> Placed {
        let Some(last_s) = self.last_s else {
            // The very first time stamp has nothing to agree with but the second.
            return match self.waiting_s.replace(t_s) {
                None => Placed::Wait,
                Some(first_s) if WITNESS_STEP_S.contains(&(t_s - first_s)) => {
                    self.waiting_s = None;
                    self.first_s = Some(first_s);
                    self.last_s = Some(t_s);
                    Placed::Confirmed(first_s, t_s)
                }
                Some(_) => Placed::RefutedWait,
            };
        };
        let hint = std::mem::take(&mut self.boot_hint);
        if hint && t_s - last_s < *PLAIN_STEP_S.start() {
            self.waiting_s = None;
            self.boot(last_s);
            self.last_s = Some(t_s);
            return Placed::At(t_s + self.offset_s);
        }
        if PLAIN_STEP_S.contains(&(t_s - last_s)) {
            self.last_s = Some(t_s);
            let t_s = t_s + self.offset_s;
            return match self.waiting_s.take() {
                Some(_) => Placed::Refuted(t_s),
                None => Placed::At(t_s),
            };
        }
        match self.waiting_s.replace(t_s) {
            Some(first_s) if WITNESS_STEP_S.contains(&(t_s - first_s)) => {
                self.waiting_s = None;
                if first_s - last_s < BOOT_STEP_S {
                    self.boot(last_s);
                }
                self.last_s = Some(t_s);
                Placed::Confirmed(first_s + self.offset_s, t_s + self.offset_s)
            }
            Some(_) => Placed::RefutedWait,
            None => Placed::Wait,
        }
    }

    fn boot(&mut self, last_s: f64) {
        self.offset_s += last_s;
        self.boots_s.push(self.offset_s);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Times at which messages end up; `None` for those thrown away.
    fn places(times: &[f64]) -> Vec<f64> {
        let mut clock = Clock::default();
        let mut placed = Vec::new();
        for &t in times {
            match clock.place(t) {
                Placed::At(t) | Placed::Refuted(t) => placed.push(t),
                Placed::Confirmed(a, b) => placed.extend([a, b]),
                Placed::Wait | Placed::RefutedWait => {}
            }
        }
        placed
    }

    #[test]
    fn damage_pauses_and_boots() {
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
            assert_eq!(places(times), *expected, "{name}");
        }
    }

    #[test]
    fn a_repeated_definition_announces_a_boot() {
        let mut clock = Clock::default();
        clock.place(5.0);
        clock.place(5.5);
        clock.expect_boot();
        assert_eq!(clock.place(2.0), Placed::At(7.5));
        assert_eq!(clock.boots_s(), [5.5]);
        assert_eq!(clock.now_s(), Some(7.5));
    }
}
