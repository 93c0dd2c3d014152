//! Shared code of curved shapes: formulas, and the values at which a flank reaches certain degrees.

use core::hint::select_unpredictable;

#[cfg(feature = "alloc")]
use alloc::{vec, vec::Vec};

#[cfg(feature = "alloc")]
use libm::{log, sqrt};

use super::exponential::exp_of_minus;
use super::straight::{falling, rising};

#[inline(always)]
pub(super) fn gaussian(x: f64, mean: f64, sd: f64) -> f64 {
    let z = (x - mean) / sd;
    exp_of_minus(0.5 * z * z)
}

#[inline(always)]
pub(super) fn sigmoid(x: f64, inflection: f64, slope: f64) -> f64 {
    // The argument of the exponential is at most 0 on both sides of the inflection, so `e` is at most 1.
    let t = slope * (x - inflection);
    let e = exp_of_minus(libm::fabs(t));
    let degree = select_unpredictable(t >= 0.0, 1.0, e) / (1.0 + e);
    select_unpredictable(slope == 0.0, 0.5, degree)
}

/// 0 up to `foot`, `2 t^2` up to the middle and `1 - 2 (1 - t)^2` up to `top`, with `t = (x - foot) / (top - foot)`.
#[inline(always)]
pub(super) fn s_shape(x: f64, foot: f64, top: f64) -> f64 {
    smooth_step(rising(x, foot, top))
}

#[inline(always)]
pub(super) fn z_shape(x: f64, top: f64, foot: f64) -> f64 {
    smooth_step(falling(x, top, foot))
}

#[inline(always)]
fn smooth_step(t: f64) -> f64 {
    let (below, above) = (2.0 * t * t, 1.0 - 2.0 * (1.0 - t) * (1.0 - t));
    select_unpredictable(t <= 0.5, below, above)
}

/// The degrees at which a curve is split, so that an integral does not miss a narrow term.
#[cfg(feature = "alloc")]
const LEVELS: [f64; 11] = [
    1e-14, 1e-9, 1e-6, 1e-3, 0.03, 0.2, 0.5, 0.8, 0.97, 0.999, 0.999_999,
];

/// Returns the middle of a shape, followed by the values at which its flank reaches the levels. The
/// distance of a value from the middle is `width * reach(level)`.
#[cfg(feature = "alloc")]
pub(super) fn flank(middle: f64, width: f64, reach: impl Fn(f64) -> f64) -> Vec<f64> {
    let mut places = vec![middle];
    places.extend(LEVELS.map(|level| middle + width * reach(level)));
    places
}

/// Returns the positions on one flank of a Gaussian; `sd` is negative for the left flank. The flank reaches a level at
/// a distance of `sqrt(-2 ln level)` standard deviations from the mean.
#[cfg(feature = "alloc")]
pub(super) fn gaussian_flank(mean: f64, sd: f64) -> Vec<f64> {
    flank(mean, sd, |level| sqrt(-2.0 * log(level)))
}

/// Returns the positions on both sides of a sigmoid; none if its slope is 0, because it is then constant.
#[cfg(feature = "alloc")]
pub(super) fn sigmoid_flanks(inflection: f64, slope: f64) -> Vec<f64> {
    if slope == 0.0 {
        return vec![];
    }
    let reach = |level: f64| log(level / (1.0 - level)) / slope;
    [
        flank(inflection, 1.0, reach),
        flank(inflection, -1.0, reach),
    ]
    .concat()
}
