//! FCL, the Fuzzy Control Language of IEC 61131-7, as jFuzzyLogic and fuzzylite write it.

pub(crate) use read::read;
pub(crate) use write::write;

mod extent;
mod lex;
mod read;
mod rules;
mod term;
mod variables;
mod write;
