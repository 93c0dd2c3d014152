//! FLL, the FuzzyLite Language: sections of lines `key: value`.

pub(crate) use read::read;

mod handover;
mod read;
mod term;
