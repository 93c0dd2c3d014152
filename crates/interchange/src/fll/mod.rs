//! FLL, the FuzzyLite Language: sections with lines `key: value`.

pub(crate) use read::read;
pub(crate) use write::write;

mod activation;
pub(crate) mod conventions;
pub(crate) mod output_conditions;
mod read;
pub(crate) mod term;
mod write;
