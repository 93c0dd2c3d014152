//! Filling the gaps of a decision map by spatial interpolation.
//!
//! Learned rules cover the conditions that were flown. If the dominant antecedent has no rule, the coverage (the
//! largest firing strength) is low and the value depends on rules that are far away. Such points are filled from the
//! covered part of the map.
//!
//! Filled values are computed from knots at which the rules are well defined: the peaks of the terms, and the points
//! halfway between two peaks, where the gap of a missing rule ends ([`Filling`]). So they do not depend on the
//! resolution of the map.

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

/// Whether a point with this coverage is a gap: whether the coverage is below `coverage_below`, with a relative tolerance
/// of 1e-9. Halfway between two peaks, the degrees of both terms should be 0.5, but rounding may leave one slightly below.
///
/// # Example
/// ```
/// use flagred::gap::is_gap;
///
/// assert!(is_gap(0.3, 0.5) && !is_gap(0.5, 0.5)); assert!(!is_gap(0.5 - 1e-16, 0.5), "a rounding error is not a gap");
/// ```
pub fn is_gap(coverage: f64, coverage_below: f64) -> bool {
    coverage < coverage_below - 1e-9 * coverage_below
}
