//! Shared code of shapes made of straight lines.

use core::hint::select_unpredictable;

/// Clamps a degree to [0, 1]. NaN, which only invalid parameters can cause, is replaced by 0.
#[inline(always)]
pub(super) fn into_unit(degree: f64) -> f64 {
    let degree = if degree > 0.0 { degree } else { 0.0 };
    if degree < 1.0 { degree } else { 1.0 }
}

pub(super) fn indicator(inside: bool) -> f64 {
    if inside { 1.0 } else { 0.0 }
}

/// 0 up to `foot`, then a straight line to 1 at `top`; `foot = top` is a step that is 1 at `top`.
#[inline(always)]
pub(super) fn rising(x: f64, foot: f64, top: f64) -> f64 {
    part(x - foot, top - foot)
}

/// 1 up to `top`, then a straight line to 0 at `foot`; `foot = top` is a step that is 1 at `top`.
#[inline(always)]
pub(super) fn falling(x: f64, top: f64, foot: f64) -> f64 {
    part(foot - x, foot - top)
}

/// [`rising`] below `left_top`, [`falling`] above it.
#[inline(always)]
pub(super) fn trapezoid(x: f64, left: f64, left_top: f64, right_top: f64, right: f64) -> f64 {
    let rises = x < left_top;
    let length = select_unpredictable(rises, x - left, right - x);
    let run = select_unpredictable(rises, left_top - left, right - right_top);
    part(length, run)
}

/// Returns `length / run`, clamped to [0, 1] without a branch. At a step, where `run` is 0, the quotient is infinite,
/// or NaN if `length` is 0; the result is then 1.
#[inline(always)]
fn part(length: f64, run: f64) -> f64 {
    let part = length / run;
    let part = if part < 1.0 { part } else { 1.0 };
    if part > 0.0 { part } else { 0.0 }
}

/// Interpolates between the points. Differences are measured from the lower point, so that small degrees are accurate.
pub(super) fn along(points: impl Iterator<Item = (f64, f64)>, x: f64) -> f64 {
    let (mut at_step, mut before) = (f64::NEG_INFINITY, None);
    for (px, py) in points {
        if px > x {
            return match before {
                None => py,
                Some(_) if at_step > f64::NEG_INFINITY => at_step,
                Some((bx, by)) => between((bx, by), (px, py), x),
            };
        }
        if px == x {
            at_step = at_step.max(py);
        }
        before = Some((px, py));
    }
    match before {
        Some(_) if at_step > f64::NEG_INFINITY => at_step,
        Some((_, last)) => last,
        None => 0.0,
    }
}

/// Returns the degree at `x` on the line through `a` and `b`.
fn between(a: (f64, f64), b: (f64, f64), x: f64) -> f64 {
    let (low, high) = if a.1 <= b.1 { (a, b) } else { (b, a) };
    low.1 + (high.1 - low.1) * ((x - low.0) / (high.0 - low.0))
}
