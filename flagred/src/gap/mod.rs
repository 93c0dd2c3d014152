//! Filling the gaps of a decision map by spatial interpolation.
//!
//! Learned rules cover what was flown. Where the antecedent that dominates has no rule, the coverage (the
//! largest firing strength) of a cell is low and its value an accident of far-off rules; such cells are filled
//! from the covered rest of the map. Distances are in shares of each input's range, so that no input counts more
//! because of its unit.

mod cells;
#[cfg(feature = "std")]
mod fill;
#[cfg(feature = "std")]
mod harmonic;
#[cfg(feature = "std")]
mod inverse_distance;
#[cfg(feature = "std")]
mod map;
#[cfg(feature = "std")]
mod nearest;
#[cfg(feature = "std")]
mod neighbours;
#[cfg(feature = "std")]
mod thin_plate;

pub use cells::{FilledCells, Run};
#[cfg(feature = "std")]
pub use fill::{GapMethod, GapSettings};
#[cfg(feature = "std")]
pub use map::FilledMap;

/// A value read from a filled map.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Reading {
    /// The value.
    pub value: f64,
    /// How far the nearest covered cell is, in shares of the inputs' ranges; 0 within the covered part.
    pub distance: f64,
}

/// Whether a coverage is below the one from which on a cell counts as covered. Half way between two peaks, where both
/// terms should be at 0.5, rounding leaves one of them a hair below it.
pub fn is_gap(coverage: f64, coverage_below: f64) -> bool {
    coverage < coverage_below - 1e-9 * coverage_below
}
