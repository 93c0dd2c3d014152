//! What reading found, and what it could not read.

/// How the reading of a log went.
///
/// `bytes` counts the log itself, after decompression.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
#[non_exhaustive]
pub struct Report {
    /// Bytes of the log that were read.
    pub bytes: u64,
    /// Messages that were found whole, asked for or not (rows, in a CSV file).
    pub messages: u64,
    /// Bytes that belong to no message.
    pub skipped_bytes: u64,
    /// Messages that were recognised and then thrown away as damaged.
    pub bad_messages: u64,
    /// The log ends inside a message, or the compressed stream ends early.
    pub truncated: bool,
    /// Why something was skipped or thrown away: the first reason that was met.
    pub reason: Option<String>,
}

impl Report {
    /// Nothing was skipped, thrown away or cut off.
    ///
    /// ```
    /// assert!(flightlog::Report::default().is_clean());
    /// ```
    pub fn is_clean(&self) -> bool {
        self.skipped_bytes == 0 && self.bad_messages == 0 && !self.truncated
    }

    /// Counts a message that is thrown away.
    pub(crate) fn bad(&mut self, why: &str) {
        self.bad_messages += 1;
        self.because(|| why.into());
    }

    /// Counts a row that is dropped because times go back there.
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
