//! FML, the Fuzzy Markup Language of IEEE 1855, as written by JFML, and its older form without a namespace.

pub(crate) use read::read;
pub(crate) use write::write;

mod read;
mod term;
mod write;
