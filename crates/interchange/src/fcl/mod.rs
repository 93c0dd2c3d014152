//! FCL, the Fuzzy Control Language of IEC 61131-7, in the dialects of jFuzzyLogic and fuzzylite.

pub(crate) use read::read;
pub(crate) use write::write;

mod extent;
mod lex;
mod read;
mod rules;
mod term;
mod variables;
mod write;
