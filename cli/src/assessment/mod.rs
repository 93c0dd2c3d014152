//! The assessment of a flight in words and as a document.

pub(crate) mod document;
pub(crate) mod words;
