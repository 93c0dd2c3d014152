//! The derivatives of membership functions, in closed form, so that the maximum of a sum is accurate to the last
//! digits.

use core::f64::consts::PI;

use libm::{fabs, pow, sin};

use super::{
    MembershipFunction,
    exponential::exp_of_minus,
    smooth::{gaussian, sigmoid},
};

/// The slope of a formula is computed as a difference over this fraction of an interval without kinks.
const SHARE: f64 = 0.125;

impl MembershipFunction {
    /// Returns the derivative of the degree at `x`; at a kink, the derivative on one of the two sides. `width` is the
    /// width of an interval around `x` without kinks. The slope of a formula is computed as a difference over a
    /// fraction of this interval.
    pub(crate) fn slope(&self, x: f64, width: f64) -> f64 {
        match *self {
            MembershipFunction::Triangle { left, peak, right } => {
                trapezoid(x, [left, peak, peak, right])
            }
            MembershipFunction::Trapezoid {
                left,
                left_top,
                right_top,
                right,
            } => trapezoid(x, [left, left_top, right_top, right]),
            MembershipFunction::LeftShoulder { top, foot } => straight(x, (top, 1.0), (foot, 0.0)),
            MembershipFunction::RightShoulder { foot, top } => straight(x, (foot, 0.0), (top, 1.0)),
            MembershipFunction::Piecewise { ref points } => {
                let lines = points.iter().zip(points.iter().skip(1));
                lines.map(|(a, b)| straight(x, *a, *b)).sum()
            }
            MembershipFunction::Gaussian { mean, sd } => gaussian_slope(x, mean, sd),
            MembershipFunction::Gaussian2 {
                left_mean,
                left_sd,
                right_mean,
                right_sd,
            } => {
                let half = |is_flank: bool, mean: f64, sd: f64| match is_flank {
                    true => (gaussian(x, mean, sd), gaussian_slope(x, mean, sd)),
                    false => (1.0, 0.0),
                };
                product(
                    half(x < left_mean, left_mean, left_sd),
                    half(x > right_mean, right_mean, right_sd),
                )
            }
            MembershipFunction::Bell {
                center,
                width,
                slope,
            } => {
                let power = pow(fabs((x - center) / width), 2.0 * slope);
                let sum = 1.0 + power;
                // At the middle and far away from it, the quotient may be undefined; the slope is then 0.
                let share = power / sum / sum;
                if share > 0.0 && sum < f64::INFINITY {
                    -2.0 * slope * share / (x - center)
                } else {
                    0.0
                }
            }
            MembershipFunction::Sigmoid { inflection, slope } => {
                sigmoid_slope(x, inflection, slope)
            }
            MembershipFunction::SigmoidDifference {
                left_inflection: a,
                left_slope,
                right_inflection: b,
                right_slope,
            } => {
                let slope = sigmoid_slope(x, a, left_slope) - sigmoid_slope(x, b, right_slope);
                // A sigmoid increases with `slope (x - inflection)`. The difference of these terms is accurate even if
                // both sigmoids round to 1.
                let left_is_higher = left_slope * (x - a) >= right_slope * (x - b);
                if left_is_higher { slope } else { -slope }
            }
            MembershipFunction::SigmoidProduct {
                left_inflection: a,
                left_slope,
                right_inflection: b,
                right_slope,
            } => product(
                (sigmoid(x, a, left_slope), sigmoid_slope(x, a, left_slope)),
                (sigmoid(x, b, right_slope), sigmoid_slope(x, b, right_slope)),
            ),
            MembershipFunction::SShape { foot, top } => smooth(x, foot, top),
            MembershipFunction::ZShape { top, foot } => -smooth(x, top, foot),
            MembershipFunction::PiShape {
                left,
                left_top,
                right_top,
                right,
            } => smooth(x, left, left_top) - smooth(x, right_top, right),
            MembershipFunction::Cosine { center, width } => {
                if fabs(x - center) < 0.5 * width {
                    -PI / width * sin(2.0 * PI * ((x - center) / width))
                } else {
                    0.0
                }
            }
            MembershipFunction::Spike { center, width } => {
                let falls = 10.0 / width * exp_of_minus(fabs(10.0 * (x - center) / width));
                if x < center { falls } else { -falls }
            }
            MembershipFunction::Concave { inflection, end } => {
                // The degree is (end - inflection) / r, where r decreases from 2 (end - inflection) at the inflection
                // to end - inflection at the end.
                let (size, r) = (end - inflection, 2.0 * end - inflection - x);
                let is_flank = if size >= 0.0 { x < end } else { x > end };
                if is_flank { size / r / r } else { 0.0 }
            }
            MembershipFunction::Arc { start, end } => {
                let t = (x - start) / (end - start);
                if 0.0 < t && t < 1.0 {
                    (1.0 - t) / libm::sqrt(t * (2.0 - t)) / (end - start)
                } else {
                    0.0
                }
            }
            MembershipFunction::SemiEllipse { left, right } => {
                let t = (x - left) / (right - left);
                if 0.0 < t && t < 1.0 {
                    (1.0 - 2.0 * t) / libm::sqrt(t * (1.0 - t)) / (right - left)
                } else {
                    0.0
                }
            }
            MembershipFunction::Function { .. } => {
                let step = SHARE * width;
                let difference = |step: f64| self.membership(x + step) - self.membership(x - step);
                (8.0 * difference(0.5 * step) - difference(step)) / (6.0 * step)
            }
            MembershipFunction::Rectangle { .. }
            | MembershipFunction::Singleton { .. }
            | MembershipFunction::Constant { .. }
            | MembershipFunction::Linear { .. } => 0.0,
        }
    }
}

/// Returns the slope of the line between two points; 0 outside of them.
fn straight(x: f64, a: (f64, f64), b: (f64, f64)) -> f64 {
    if a.0 < x && x < b.0 {
        (b.1 - a.1) / (b.0 - a.0)
    } else {
        0.0
    }
}

fn trapezoid(x: f64, [left, left_top, right_top, right]: [f64; 4]) -> f64 {
    straight(x, (left, 0.0), (left_top, 1.0)) + straight(x, (right_top, 1.0), (right, 0.0))
}

/// Returns the slope of the product of two degrees, each passed with its slope.
fn product(a: (f64, f64), b: (f64, f64)) -> f64 {
    a.1 * b.0 + a.0 * b.1
}

fn gaussian_slope(x: f64, mean: f64, sd: f64) -> f64 {
    -(x - mean) / sd / sd * gaussian(x, mean, sd)
}

/// Returns the slope of a sigmoid with the slope parameter `k` and the degree `s`: `k s (1 - s)`. `1 - s` is computed
/// as the sigmoid with the opposite slope parameter.
fn sigmoid_slope(x: f64, inflection: f64, slope: f64) -> f64 {
    slope * sigmoid(x, inflection, slope) * sigmoid(x, inflection, -slope)
}

/// Returns the slope of two parabolas that rise from `foot` to `top`.
fn smooth(x: f64, foot: f64, top: f64) -> f64 {
    let t = (x - foot) / (top - foot);
    if 0.0 < t && t < 1.0 {
        4.0 * t.min(1.0 - t) / (top - foot)
    } else {
        0.0
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Compares the slopes with difference quotients at values without a kink.
    #[test]
    fn slopes_equal_differences() {
        let shapes = [
            "{triangle: [0.1, 3.1, 7.1]}",
            "{trapezoid: [0.1, 2.1, 5.1, 9.1]}",
            "{left_shoulder: [2.1, 7.1]}",
            "{right_shoulder: [2.1, 7.1]}",
            "{rectangle: [2.1, 7.1]}",
            "{piecewise: [[0.1, 0.2], [3.1, 0.9], [3.1, 0.4], [8.1, 0.1]]}",
            "{gaussian: {mean: 4.1, sd: 1.3}}",
            "{gaussian2: {left_mean: 3.1, left_sd: 1.3, right_mean: 6.1, right_sd: 2}}",
            "{gaussian2: {left_mean: 6.1, left_sd: 1.3, right_mean: 3.1, right_sd: 2}}",
            "{bell: {center: 4.1, width: 2, slope: 1.3}}",
            "{bell: {center: 4.1, width: 2, slope: 0.4}}",
            "{sigmoid: {inflection: 4.1, slope: -1.7}}",
            "{sigmoid_difference: {left_inflection: 2.1, left_slope: 2, right_inflection: 7.1, right_slope: 3}}",
            "{sigmoid_product: {left_inflection: 2.1, left_slope: 2, right_inflection: 7.1, right_slope: -3}}",
            "{s_shape: [2.1, 7.1]}",
            "{z_shape: [2.1, 7.1]}",
            "{pi_shape: [0.1, 3.1, 5.1, 9.1]}",
            "{cosine: {center: 4.1, width: 6}}",
            "{spike: {center: 4.1, width: 6}}",
            "{concave: {inflection: 3.1, end: 7.1}}",
            "{concave: {inflection: 7.1, end: 3.1}}",
            "{arc: {start: 1.1, end: 7.1}}",
            "{arc: {start: 7.1, end: 1.1}}",
            "{semi_ellipse: [1.1, 7.1]}",
            "{function: sin(y) / 3 + 0.5}",
        ];
        for shape in shapes {
            let text = [
                "{fuzzy: 1, name: t, inputs: {x: {range: [0, 1], partition: [a, b]}}, ",
                "outputs: {y: {range: [0, 10], terms: {t: ",
                shape,
                "}}}, rules: [IF x IS a THEN y IS t]}",
            ];
            let model: crate::Model = text.concat().parse().unwrap();
            let of = &model.outputs[0].variable.terms[0].membership_function;
            let mut steepest: f64 = 0.0;
            for i in 0..40 {
                let x = 0.06 + 0.25 * f64::from(i);
                let step = 1e-5;
                let difference = (of.membership(x + step) - of.membership(x - step)) / (2.0 * step);
                let slope = of.slope(x, 0.01);
                assert!(
                    (slope - difference).abs() < 1e-7,
                    "{shape} at {x}: {slope}, not {difference}"
                );
                steepest = steepest.max(slope.abs());
            }
            assert!(steepest > 0.1 || shape.contains("rectangle"), "{shape}");
        }
    }

    #[test]
    fn a_saturated_sigmoid_still_rises() {
        let sigmoid = MembershipFunction::Sigmoid {
            inflection: 0.0,
            slope: 1.0,
        };
        assert_eq!(sigmoid.membership(50.0), 1.0);
        let slope = sigmoid.slope(50.0, 1.0);
        assert!((slope / libm::exp(-50.0) - 1.0).abs() < 1e-14, "{slope}");
    }

    #[test]
    fn the_slope_at_the_middle_of_a_bell_is_0() {
        for slope in [0.3, 1.0, 2.5] {
            let bell = MembershipFunction::Bell {
                center: 0.0,
                width: 1.0,
                slope,
            };
            assert_eq!(bell.slope(0.0, 1.0), 0.0, "{slope}");
            assert!(bell.slope(1e300, 1.0).abs() < 1e-300, "{slope}");
        }
    }
}
