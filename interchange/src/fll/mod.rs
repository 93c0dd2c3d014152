//! FLL, the FuzzyLite Language: sections of lines `key: value`.

pub(crate) use read::read;
pub(crate) use write::write;

mod activation;
mod handover;
mod read;
mod term;
mod write;
