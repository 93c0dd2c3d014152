//! What becomes of a flight: followed sample by sample, and told in words, as a document, as a picture of characters.

pub(crate) mod document;
pub(crate) mod follow;
mod picture;
pub(crate) mod words;
