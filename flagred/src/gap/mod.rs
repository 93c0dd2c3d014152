//! Filling the gaps of a decision map by spatial interpolation.
//!
//! Learned rules cover what was flown. Where the antecedent that dominates has no rule, the coverage (the
//! largest firing strength) is low and the value an accident of far-off rules; such places are filled from the covered
//! rest of the map.
//!
//! What is filled in is made of what rules say where they are sure of it: at the peaks of the terms, and half way between
//! two, where the gap of a missing rule ends ([`Filling`]). So it does not depend on how finely a map is drawn.

#[cfg(feature = "std")]
mod complete;
#[cfg(feature = "std")]
mod field;
mod filled;
#[cfg(feature = "std")]
mod filling;
#[cfg(feature = "std")]
mod harmonic;
#[cfg(feature = "std")]
mod inverse_distance;
#[cfg(feature = "std")]
mod knots;
#[cfg(feature = "std")]
mod map;
#[cfg(feature = "std")]
mod metric;
#[cfg(feature = "std")]
mod neighbours;
#[cfg(feature = "std")]
mod settings;
#[cfg(feature = "std")]
mod thin_plate;

pub use filled::{FilledKnots, Reading};
#[cfg(feature = "std")]
pub use filling::Filling;
#[cfg(feature = "std")]
pub use map::FilledMap;
#[cfg(feature = "std")]
pub use settings::{GapMethod, GapSettings};

/// Whether a coverage is below the one from which on a place counts as covered. Half way between two peaks, where both
/// terms should be at 0.5, rounding leaves one of them a hair below it.
///
/// # Example
/// ```
/// use flagred::gap::is_gap;
///
/// assert!(is_gap(0.3, 0.5) && !is_gap(0.5, 0.5));
/// assert!(!is_gap(0.5 - 1e-16, 0.5), "rounding is no gap");
/// ```
pub fn is_gap(coverage: f64, coverage_below: f64) -> bool {
    coverage < coverage_below - 1e-9 * coverage_below
}
