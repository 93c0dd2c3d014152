//! What people read of rule sets and flights, whatever program shows it.
//!
//! Findings drawn in their text ([`diagnostics`]); an assessment in words ([`words`], [`finding`]), as one JSON document
//! ([`document`]), as one HTML page ([`page`]) and as tables ([`steps`], [`table`]). It gives text and opens no file.

mod charts;
mod curve;
mod decision;
pub mod diagnostics;
pub mod document;
pub mod finding;
pub mod moment;
pub mod page;
mod panel;
mod parts;
pub mod steps;
pub mod table;
mod timeline;
pub mod words;

pub use charts::{SIGNALS, options};
pub use curve::Stretch;

/// The example of the README, run.
#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct Readme;
