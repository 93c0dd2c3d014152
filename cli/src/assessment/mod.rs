//! The assessment of a flight: its samples through the monitor, the result in words and as a document.

pub(crate) mod document;
pub(crate) mod follow;
pub(crate) mod words;
