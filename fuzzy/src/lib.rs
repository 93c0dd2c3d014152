//! A configurable fuzzy inference engine: Mamdani and Takagi-Sugeno, exact, allocation-free.
//!
//! The stages, each a module: text ([`rule`], `yaml`) to [`model`] (what an author wrote), to
//! `check` (findings), to `engine` (compiled, immutable), to an outcome with its reasons.
#![cfg_attr(not(feature = "std"), no_std)]

extern crate alloc;

pub mod check;
mod defuzzify;
pub mod diagnostic;
pub mod engine;
pub mod format;
pub mod learn;
pub mod map;
pub mod model;
mod operators;
pub mod rule;
pub mod tree;
#[cfg(feature = "yaml")]
pub mod yaml;

pub use engine::Engine;
pub use model::Model;

/// The example of COMPARE.md, run.
#[cfg(all(doctest, feature = "yaml"))]
#[doc = include_str!("../../COMPARE.md")]
struct Compare;
