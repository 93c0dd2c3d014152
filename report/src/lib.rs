//! What people read of rule sets and flights, whatever program shows it.
//!
//! Findings drawn in their text ([`diagnostics`]); an assessment in words ([`words`], [`finding`]), as one JSON document
//! ([`document`]) and as one HTML page ([`page`]). It gives text and opens no file.

mod charts;
mod decision;
pub mod diagnostics;
pub mod document;
pub mod finding;

pub mod page;
mod panel;
pub mod words;

pub use charts::SIGNALS;

/// The example of the README, run.
#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct Readme;
