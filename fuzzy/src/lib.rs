//! A fuzzy inference engine: Mamdani and Takagi-Sugeno, exact, without allocation in evaluation.
//!
//! A rule set is text or a [`Model`] built in code. An [`Engine`] is compiled from it once, never changes, and evaluates
//! inputs to outcomes: a value, or the statement that no rule fires.
//!
//! ```
//! use fuzzy::{Engine, Model};
//!
//! let model: Model = "
//! fuzzy: 1
//! name: washing machine
//! inputs:
//!   load: {range: [0, 8], unit: kg, partition: [small, medium, large]}
//!   dirt: {range: [0, 100], unit: '%', partition: [low, high]}
//! outputs:
//!   time: {range: [20, 120], unit: min, partition: [short, medium, long]}
//! rules:
//!   - IF load IS small AND dirt IS low THEN time IS short
//!   - IF load IS medium OR dirt IS high THEN time IS medium
//!   - IF load IS large AND dirt IS high THEN time IS long
//! ".parse()?;
//! let engine = Engine::new(&model)?;
//!
//! let outcomes = engine.evaluate_named([("load", 6.5), ("dirt", 80.0)])?;
//! assert!(outcomes["time"].value() > Some(70.0));
//!
//! // Why?
//! let explanation = engine.explain(&[6.5, 80.0])?;
//! assert_eq!(explanation.rules[0].text, "IF load IS medium OR dirt IS high THEN time IS medium");
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! - [`yaml::parse`] reads a rule set with the span of each part; [`Findings`] are all errors of a text or model. [`Source`]
//!   is a text whose tree, rule set and engine are made once.
//! - [`Model::builder`] makes a model in code; [`rule`] is the rule language.
//! - [`Engine::evaluate_with`] evaluates into outcomes of the caller: use it in loops, where the allocations of
//!   [`Engine::evaluate`] take longer than the evaluation. [`map`] evaluates a grid.
//! - `check` analyses a rule set: gaps, contradictions, jumps. `learn` makes rules from data.
//!
//! # Features
//! - `std` and `yaml` (default): the standard library; rule sets as YAML, and `Model: FromStr`.
//! - `serde`: models in any format that serde knows; outcomes, explanations and findings as data.
//! - `check`, `learn`: the modules of these names.
//! - `simd`: batches and common single calls with wide vectors; `parallel`: batches and maps on all cores.
//! - `alloc` alone builds without `std`; without any feature only compiled tables are left, which need `core`.
#![cfg_attr(not(feature = "std"), no_std)]

#[cfg(feature = "alloc")]
extern crate alloc;

#[cfg(feature = "check")]
pub mod check;
#[cfg(feature = "alloc")]
mod defuzzify;
#[cfg(feature = "alloc")]
pub mod diagnostic;
#[cfg(feature = "drawing")]
pub mod drawing;
#[cfg(feature = "alloc")]
pub mod engine;
#[cfg(feature = "serde")]
mod fields;
#[cfg(feature = "alloc")]
mod foreign;
#[cfg(feature = "alloc")]
pub mod format;
mod formula;
#[cfg(feature = "learn")]
pub mod learn;
#[cfg(feature = "alloc")]
pub mod map;
#[cfg(feature = "alloc")]
pub mod model;
mod rows;
#[cfg(feature = "alloc")]
pub mod rule;
#[cfg(feature = "serde")]
mod serial;
mod shape;
#[cfg(all(feature = "std", feature = "yaml"))]
mod source;
#[cfg_attr(
    not(feature = "alloc"),
    allow(
        dead_code,
        unused_imports,
        reason = "what only compiling a model needs"
    )
)]
pub mod table;
/// Public for the crate `flagred`, which reads its profiles as trees; not part of the API.
#[cfg(feature = "alloc")]
#[doc(hidden)]
pub mod tree;
#[cfg(feature = "alloc")]
mod validate;
#[cfg(feature = "yaml")]
pub mod yaml;

#[cfg(feature = "alloc")]
pub use diagnostic::{Diagnostic, Findings};
#[cfg(feature = "alloc")]
pub use engine::{Engine, Outcome};
#[cfg(feature = "alloc")]
pub use model::Model;
#[cfg(all(feature = "std", feature = "yaml"))]
pub use source::Source;
#[cfg(feature = "alloc")]
pub use validate::validate;

/// The example of COMPARE.md, run.
#[cfg(all(doctest, feature = "yaml"))]
#[doc = include_str!("../../COMPARE.md")]
struct Compare;
