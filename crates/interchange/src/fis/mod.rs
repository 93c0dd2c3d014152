//! FIS, MATLAB's Fuzzy Inference System: sections `[System]`, `[Input1]`, `[Output1]`, `[Rules]` with lines
//! `Key=value`.

pub(crate) use read::read;
pub(crate) use write::write;

mod read;
mod rules;
mod term;
mod type2;
mod write;
