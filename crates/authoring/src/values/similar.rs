//! A membership function of another shape that covers about the same part of a range.

use fuzzy::model::{MembershipFunction, Term, Variable};

use crate::structure::rounded;

/// The shapes that [`set_shape`](super::set_shape) can give to a term.
pub const SHAPES: [&str; 12] = [
    "triangle",
    "trapezoid",
    "left_shoulder",
    "right_shoulder",
    "gaussian",
    "bell",
    "sigmoid",
    "s_shape",
    "z_shape",
    "pi_shape",
    "rectangle",
    "singleton",
];

/// A membership function of another shape that covers about the same part of the range; `None` if it is not one of
/// [`SHAPES`].
pub(super) fn similar(term: &Term, of: &Variable, shape: &str) -> Option<MembershipFunction> {
    use MembershipFunction as Shape;
    const STEPS: usize = 1000;
    let width = of.high - of.low;
    let at = |i: usize| of.low + width * (i as f64 / STEPS as f64);
    let degree = |i: usize| term.membership_function.membership(at(i));
    let highest = (0..=STEPS).map(degree).fold(0.0, f64::max);
    // Returns the first and the last position whose degree is at least `share` of the highest degree.
    let reaching = |share: f64| {
        let mut there = (0..=STEPS).filter(|i| degree(*i) >= share * highest && highest > 0.0);
        let first = there.next()?;
        Some((at(first), at(there.next_back().unwrap_or(first))))
    };
    let round = |x: f64| rounded(x, of);
    let (start, stop) = reaching(0.02).unwrap_or((of.low, of.high));
    let (half_start, half_stop) = reaching(0.5).unwrap_or((start, stop));
    let (top_start, top_stop) = reaching(0.98).unwrap_or((start, stop));
    let [start, stop, half_start, half_stop, top_start, top_stop] =
        [start, stop, half_start, half_stop, top_start, top_stop].map(round);
    let middle = round((top_start + top_stop) / 2.0);
    let half_width = round((half_stop - half_start) / 2.0).max(round(width / 100.0));
    Some(match shape {
        "triangle" => Shape::Triangle {
            left: start,
            peak: middle,
            right: stop,
        },
        "trapezoid" => Shape::Trapezoid {
            left: start,
            left_top: top_start,
            right_top: top_stop,
            right: stop,
        },
        "pi_shape" => Shape::PiShape {
            left: start,
            left_top: top_start,
            right_top: top_stop,
            right: stop,
        },
        "left_shoulder" => Shape::LeftShoulder {
            top: top_stop,
            foot: stop,
        },
        "z_shape" => Shape::ZShape {
            top: top_stop,
            foot: stop,
        },
        "right_shoulder" => Shape::RightShoulder {
            foot: start,
            top: top_start,
        },
        "s_shape" => Shape::SShape {
            foot: start,
            top: top_start,
        },
        "rectangle" => Shape::Rectangle {
            left: half_start,
            right: half_stop,
        },
        "singleton" => Shape::Singleton { at: middle },
        // A Gaussian has half its height at 1.18 standard deviations.
        "gaussian" => Shape::Gaussian {
            mean: middle,
            sd: round(half_width / 1.18),
        },
        "bell" => Shape::Bell {
            center: middle,
            width: half_width,
            slope: 2.0,
        },
        // The sigmoid falls if the term is highest at the lower end of the range, but not at the upper end.
        "sigmoid" => match top_start <= of.low && top_stop < of.high {
            true => Shape::Sigmoid {
                inflection: half_stop,
                slope: -steepness(stop - top_stop, width),
            },
            false => Shape::Sigmoid {
                inflection: half_start,
                slope: steepness(top_start - start, width),
            },
        },
        _ => return None,
    })
}

/// The slope of a sigmoid that rises from 0.02 to 0.98 over a length, to three digits.
fn steepness(length: f64, width: f64) -> f64 {
    let slope = 7.8 / length.max(width / 100.0);
    format!("{slope:.2e}").parse().unwrap_or(slope)
}
