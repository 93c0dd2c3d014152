//! Report on the reading of a log: amount of data and damage.

/// Report on the reading of a log.
///
/// `bytes` counts the log itself, after decompression.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
#[non_exhaustive]
pub struct Report {
    /// Bytes of the log that were read.
    pub bytes: u64,
    /// Complete messages, kept or not (rows in a CSV file).
    pub messages: u64,
    /// Bytes that belong to no message.
    pub skipped_bytes: u64,
    /// Messages that were recognised and rejected as damaged.
    pub bad_messages: u64,
    /// The log ends inside a message, or the compressed stream ends early.
    pub truncated: bool,
    /// The first reason for which bytes were skipped or a message was rejected.
    pub reason: Option<String>,
}

impl Report {
    /// Whether nothing was skipped, rejected or cut off.
    pub fn is_clean(&self) -> bool {
        self.skipped_bytes == 0 && self.bad_messages == 0 && !self.truncated
    }

    /// Counts a rejected message.
    pub(crate) fn bad(&mut self, why: &str) {
        self.bad_messages += 1;
        self.because(|| why.into());
    }

    /// Counts a row that is dropped because its time goes back.
    pub(crate) fn dropped_row(&mut self, dropped: bool) {
        if dropped {
            self.bad("a time that goes back");
        }
    }

    pub(crate) fn because(&mut self, reason: impl FnOnce() -> String) {
        if self.reason.is_none() {
            self.reason = Some(reason());
        }
    }
}
