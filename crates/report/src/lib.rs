//! Output for people about rule sets and flights, shared by all programs.
//!
//! It displays findings in their text ([`diagnostics`]), and describes an assessment in words ([`words`],
//! [`finding`]), as one JSON document ([`document`]), as one HTML page ([`page`]) and as tables ([`steps`],
//! [`table`]). All functions return or write text; none opens a file.

pub mod available;
mod charts;
mod clock;
mod curve;
mod decision;
pub mod diagnostics;
pub mod document;
pub mod finding;
mod head;
pub mod moment;
mod names;
pub mod page;
mod panel;
mod parts;
mod sources;
pub mod steps;
mod subject;
pub mod table;
mod timeline;
mod track;
pub mod words;

pub use charts::{options, signals};
pub use curve::Stretch;

/// Runs the example of the README.
#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct Readme;
