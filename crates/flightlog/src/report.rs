//! The report on reading a log: amount of data, damage, and omitted data.

use std::fmt;

/// A report on reading a log.
///
/// Bytes are counted after decompression.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[non_exhaustive]
pub struct Report {
    /// The number of bytes of the log that were read.
    pub bytes: u64,
    /// The number of complete messages, kept or not (rows in a CSV file).
    pub messages: u64,
    /// The number of bytes that are not part of any message.
    pub skipped_bytes: u64,
    /// The number of messages that were recognised and rejected as damaged.
    pub bad_messages: u64,
    /// Whether the log ends inside a message, or the compressed stream ends early.
    pub truncated: bool,
    /// The first reason why bytes were skipped or a message was rejected.
    pub reason: Option<String>,
    /// The amounts of data that were left out because a limit was reached.
    pub left_out: LeftOutCounts,
    #[cfg_attr(feature = "serde", serde(skip))]
    pub(crate) stored: StoredCounts,
}

/// Amounts of data that were left out because a limit was reached. No real flight reaches a limit; damaged and
/// malicious logs may.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[non_exhaustive]
pub struct LeftOutCounts {
    /// Texts after the first 10,000.
    pub texts: u64,
    /// Changes of the flight mode after the first 10,000.
    pub modes: u64,
    /// Values of parameters after the first 16,384 names, and those with names longer than 64 bytes.
    pub parameters: u64,
    /// Changes of the armed state and of the in-air state after the first 10,000 of each, if they are derived from the
    /// commands. The time after them does not count as in the air.
    pub changes: u64,
    /// Messages after the flight has reached a limit: 67,108,864 numbers, 10,000 changes of the armed or in-air state,
    /// or 1,000 boots. The flight ends there.
    pub messages: u64,
}

impl LeftOutCounts {
    /// Whether the whole log was kept.
    pub fn is_empty(&self) -> bool {
        *self == Self::default()
    }
}

impl fmt::Display for LeftOutCounts {
    /// The omitted data, such as `12 texts and 3 flight modes`.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let counts = [
            (self.texts, "texts"),
            (self.modes, "flight modes"),
            (self.parameters, "values of parameters"),
            (self.changes, "changes of the armed or in-air state"),
            (self.messages, "messages after the flight that was read"),
        ];
        let counts = counts.iter().filter(|(count, _)| *count > 0);
        for (i, (count, what)) in counts.enumerate() {
            let before = if i > 0 { ", " } else { "" };
            write!(f, "{before}{count} {what}")?;
        }
        Ok(())
    }
}

/// The maximum number of texts that are kept.
const MAX_TEXTS: usize = 10_000;
/// The maximum number of flight mode changes that are kept.
const MAX_MODES: usize = 10_000;
/// The maximum number of values that are kept in all rows, including their times: about three hours of commands and
/// attitude at 400 Hz.
const MAX_NUMBERS: u64 = 1 << 26;
/// The maximum number of changes of the armed or in-air state that are kept.
const MAX_CHANGES: u64 = 10_000;

/// The amounts of data that are kept so far. All rows and all changes count together.
#[derive(Debug, Clone, Default)]
pub(crate) struct StoredCounts {
    numbers: u64,
    changes: u64,
}

/// Instances are always equal: the amounts depend on the options for reading, but reports must be equal for any
/// options.
impl PartialEq for StoredCounts {
    fn eq(&self, _: &StoredCounts) -> bool {
        true
    }
}

impl Eq for StoredCounts {}

impl Report {
    /// Whether nothing was skipped, rejected or cut off. Data beyond the limits does not count as damage: see
    /// [`Report::left_out`].
    pub fn is_clean(&self) -> bool {
        self.skipped_bytes == 0 && self.bad_messages == 0 && !self.truncated
    }

    /// Counts a rejected message.
    pub(crate) fn bad(&mut self, why: &str) {
        self.bad_messages += 1;
        self.because(|| why.into());
    }

    /// Counts a row of `numbers` values, with its time; `dropped` means that a row is dropped because its time goes
    /// back.
    pub(crate) fn row(&mut self, numbers: usize, dropped: bool) {
        self.stored.numbers += numbers as u64 + 1;
        if dropped {
            self.bad("a time that goes back");
        }
    }

    /// Counts a change of the armed or in-air state.
    pub(crate) fn change(&mut self) {
        self.stored.changes += 1;
    }

    /// Appends a state that is reported repeatedly to `states` if it changed.
    pub(crate) fn state(&mut self, states: &mut Vec<(f64, bool)>, t_s: f64, state: Option<bool>) {
        let last = states.last().map(|(_, last)| *last);
        if let Some(state) = state.filter(|state| last != Some(*state)) {
            self.change();
            states.push((t_s, state));
        }
    }

    /// Returns whether the flight has reached a limit: the maximum number of values or of changes or, if `of_boots`
    /// is true, of boots. If so, the current message counts as left out.
    pub(crate) fn leaves_out(&mut self, of_boots: bool) -> bool {
        let StoredCounts { numbers, changes } = self.stored;
        let is_full = of_boots || numbers >= MAX_NUMBERS || changes >= MAX_CHANGES;
        self.left_out.messages += u64::from(is_full);
        is_full
    }

    /// Keeps a text unless there are too many; then it is only counted.
    pub(crate) fn text<T>(&mut self, texts: &mut Vec<T>, text: T) {
        keep(texts, text, MAX_TEXTS, &mut self.left_out.texts);
    }

    /// Keeps a flight mode unless there are too many; then it is only counted.
    pub(crate) fn mode<T>(&mut self, modes: &mut Vec<T>, mode: T) {
        keep(modes, mode, MAX_MODES, &mut self.left_out.modes);
    }

    pub(crate) fn because(&mut self, reason: impl FnOnce() -> String) {
        if self.reason.is_none() {
            self.reason = Some(reason());
        }
    }
}

fn keep<T>(kept: &mut Vec<T>, item: T, most: usize, left_out: &mut u64) {
    match kept.len() < most {
        true => kept.push(item),
        false => *left_out += 1,
    }
}
