//! A second implementation of the definitions in the documents, independent of the libraries: direct, slow, in `f64`.
//!
//! [`rules`] evaluates a rule set as docs/rule-sets.md defines it, and [`type2`] evaluates one with interval type-2
//! terms. [`flight`] follows a flight as docs/profiles.md defines it: it keeps every sample and computes every window
//! from scratch.

pub mod balance;
pub mod elevated;
pub mod flight;
pub mod inputs;
pub mod integral;
pub mod levels;
mod number;
mod operators;
pub mod rules;
mod sets;
mod shapes;
pub mod type2;
pub mod window;
pub mod yaw;
