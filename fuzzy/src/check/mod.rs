//! What is wrong with a model, and what its author should know about it.

pub mod names;
