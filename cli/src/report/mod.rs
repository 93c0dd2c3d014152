//! Reports: one HTML file that opens offline, and the picture of risk over time as SVG.

mod charts;
mod decision;
mod page;
mod panel;

pub(crate) use charts::SIGNALS;
pub(crate) use page::{Subject, comparison, report, svg};
