//! The interval in which a membership function changes. It becomes the range of a variable that has none.

use fuzzy::model::MembershipFunction;

/// The interval in which a membership function changes; unbounded flanks are cut off where they are below 0.0004.
pub(super) fn extent(function: &MembershipFunction) -> (f64, f64) {
    use MembershipFunction as Of;
    match *function {
        Of::Triangle { left, right, .. }
        | Of::Trapezoid { left, right, .. }
        | Of::PiShape { left, right, .. }
        | Of::Rectangle { left, right } => (left, right),
        Of::LeftShoulder { top, foot } | Of::ZShape { top, foot } => (top, foot),
        Of::RightShoulder { foot, top } | Of::SShape { foot, top } => (foot, top),
        Of::Singleton { at } | Of::Constant { value: at } => (at, at),
        Of::Piecewise { ref points } => {
            let first = points.first().map_or(0.0, |point| point.0);
            (first, points.last().map_or(first, |point| point.0))
        }
        Of::Gaussian { mean, sd } => (mean - 4.0 * sd, mean + 4.0 * sd),
        Of::Gaussian2 {
            left_mean,
            left_sd,
            right_mean,
            right_sd,
        } => (left_mean - 4.0 * left_sd, right_mean + 4.0 * right_sd),
        Of::Bell {
            center,
            width,
            slope,
        } => {
            let half = width * 5000_f64.powf(0.5 / slope);
            (center - half, center + half)
        }
        Of::Sigmoid { inflection, slope } => around(inflection, slope),
        Of::SigmoidDifference {
            left_inflection,
            left_slope,
            right_inflection,
            right_slope,
        }
        | Of::SigmoidProduct {
            left_inflection,
            left_slope,
            right_inflection,
            right_slope,
        } => {
            let (left, right) = (
                around(left_inflection, left_slope),
                around(right_inflection, right_slope),
            );
            (left.0.min(right.0), left.1.max(right.1))
        }
        Of::Cosine { center, width } | Of::Spike { center, width } => {
            (center - 0.5 * width, center + 0.5 * width)
        }
        Of::Concave { inflection, end } => (inflection.min(end), inflection.max(end)),
        _ => (f64::INFINITY, f64::NEG_INFINITY),
    }
}

fn around(inflection: f64, slope: f64) -> (f64, f64) {
    let half = 8.5 / slope.abs();
    (inflection - half, inflection + half)
}
