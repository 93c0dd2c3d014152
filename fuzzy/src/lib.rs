//! A configurable fuzzy inference engine: Mamdani and Takagi-Sugeno, exact, allocation-free.
//!
//! The stages, each a module: text ([`rule`], `yaml`) to [`model`] (what an author wrote), to
//! `check` (findings), to `engine` (compiled, immutable), to an outcome with its reasons.
#![cfg_attr(not(feature = "std"), no_std)]

#[cfg(feature = "alloc")]
extern crate alloc;

#[cfg(feature = "alloc")]
pub mod check;
#[cfg(feature = "alloc")]
mod defuzzify;
#[cfg(feature = "alloc")]
pub mod diagnostic;
#[cfg(feature = "drawing")]
pub mod drawing;
#[cfg(feature = "alloc")]
pub mod engine;
#[cfg(feature = "alloc")]
pub mod format;
#[cfg(feature = "alloc")]
pub mod learn;
#[cfg(feature = "alloc")]
pub mod map;
#[cfg(feature = "alloc")]
pub mod model;
#[cfg(feature = "alloc")]
pub mod rule;
mod shape;
#[cfg_attr(
    not(feature = "alloc"),
    allow(
        dead_code,
        unused_imports,
        reason = "what only compiling a model needs"
    )
)]
pub mod table;
#[cfg(feature = "alloc")]
pub mod tree;
#[cfg(feature = "yaml")]
pub mod yaml;

#[cfg(feature = "alloc")]
pub use engine::Engine;
#[cfg(feature = "alloc")]
pub use model::Model;

/// The example of COMPARE.md, run.
#[cfg(all(doctest, feature = "yaml"))]
#[doc = include_str!("../../COMPARE.md")]
struct Compare;
