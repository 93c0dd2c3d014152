//! FML, the Fuzzy Markup Language of IEEE 1855, as JFML writes it, and its older form without a namespace.

pub(crate) use read::read;
pub(crate) use write::write;

mod read;
mod term;
mod write;
