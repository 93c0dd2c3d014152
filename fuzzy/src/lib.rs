//! A fuzzy inference engine for Mamdani and Takagi-Sugeno rule sets. It is exact, and can evaluate without allocation.
//!
//! A rule set is a text, or a [`Model`] built in code. An [`Engine`] is compiled from it once and is immutable.
//! For given inputs it returns an outcome per output: a value, or the information that no rule fires.
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
//! - [`yaml::parse`] reads a rule set with the position of each part; [`Findings`] contains all errors of a text or
//!   model. [`Source`] is a text that caches its tree, rule set and engine.
//! - [`Model::builder`] builds a model in code; [`rule`] is the rule language.
//! - [`Engine::evaluate_with`] evaluates into a buffer of the caller. Use it in loops: the allocations of
//!   [`Engine::evaluate`] take longer than the evaluation. [`map`] evaluates a grid.
//! - `check` analyses a rule set: gaps, contradictions, jumps. `learn` derives rules from data.
//!
//! # Features
//! - `std` and `yaml` (default): the standard library; rule sets as YAML, and `Model: FromStr`.
//! - `serde`: models in any format that serde supports; outcomes, explanations and findings as data.
//! - `check`, `learn`: the modules of these names.
//! - `drawing`: drawings of rule sets, as SVG and as text; `schema`: JSON Schemas of the serialised types.
//! - `simd`: wide vectors for batches and for single evaluations of common rule sets; `parallel`: batches and maps on
//!   all cores.
//! - `alloc` without `std` builds models and engines for `no_std`; without any feature only compiled tables are
//!   available, which need only `core`.
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
        reason = "only compiling a model needs them"
    )
)]
pub mod table;
/// Public only for the crate `flagred`, which parses its profiles to trees. Not part of the API.
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

/// Runs the examples of COMPARE.md as doc tests.
#[cfg(all(doctest, feature = "yaml"))]
#[doc = include_str!("../../COMPARE.md")]
struct Compare;
