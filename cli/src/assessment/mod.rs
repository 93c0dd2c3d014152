//! The assessment of a flight in words, as a document, and as a picture of characters.

pub(crate) mod document;
mod picture;
pub(crate) mod words;
