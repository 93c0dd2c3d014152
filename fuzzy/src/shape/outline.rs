//! The outlines of membership functions: the corners of shapes made of straight lines, and for curved shapes the
//! positions at which an exact integral is split.

use alloc::{vec, vec::Vec};

use libm::{log, pow};

use super::{
    MembershipFunction,
    smooth::{flank, gaussian_flank, sigmoid_flanks},
    straight::into_unit,
};

/// The outline of a shape, as far as an exact integral needs it.
enum Outline {
    /// Straight lines between corners `(x, degree)`, with non-decreasing x. Before the first and after the last corner,
    /// the degree is constant.
    Straight(Vec<(f64, f64)>),
    /// A curve that is smooth between these positions. The positions are unordered, and so close to each other that
    /// an integral does not miss a flank. Positions that are not finite are ignored.
    Smooth(Vec<f64>),
}

impl MembershipFunction {
    fn outline(&self) -> Outline {
        use Outline::{Smooth, Straight};
        match *self {
            MembershipFunction::Triangle { left, peak, right } => {
                Straight(vec![(left, 0.0), (peak, 1.0), (right, 0.0)])
            }
            MembershipFunction::Trapezoid {
                left,
                left_top,
                right_top,
                right,
            } => Straight(vec![
                (left, 0.0),
                (left_top, 1.0),
                (right_top, 1.0),
                (right, 0.0),
            ]),
            MembershipFunction::LeftShoulder { top, foot } => {
                Straight(vec![(top, 1.0), (foot, 0.0)])
            }
            MembershipFunction::RightShoulder { foot, top } => {
                Straight(vec![(foot, 0.0), (top, 1.0)])
            }
            MembershipFunction::Rectangle { left, right } => {
                Straight(vec![(left, 0.0), (left, 1.0), (right, 1.0), (right, 0.0)])
            }
            MembershipFunction::Singleton { at } => Straight(vec![(at, 0.0), (at, 1.0), (at, 0.0)]),
            MembershipFunction::Piecewise { ref points } => Straight(points.clone()),
            MembershipFunction::Gaussian { mean, sd } => {
                Smooth([gaussian_flank(mean, -sd), gaussian_flank(mean, sd)].concat())
            }
            MembershipFunction::Gaussian2 {
                left_mean,
                left_sd,
                right_mean,
                right_sd,
            } => Smooth(
                [
                    gaussian_flank(left_mean, -left_sd),
                    gaussian_flank(right_mean, right_sd),
                ]
                .concat(),
            ),
            MembershipFunction::Bell {
                center,
                width,
                slope,
            } => {
                let reach = |level: f64| pow((1.0 - level) / level, 0.5 / slope);
                // If the exponent 2 slope of |t|^(2 slope) is small, the curve has a sharp bend in the middle, so
                // further positions close to the middle are needed.
                let edge = if slope < 0.75 { 40 } else { 0 };
                let near = (1..edge).map(|halvings| width * libm::exp2(-f64::from(halvings)));
                Smooth(
                    [
                        flank(center, -width, reach),
                        flank(center, width, reach),
                        near.flat_map(|distance| [center - distance, center + distance])
                            .collect(),
                    ]
                    .concat(),
                )
            }
            MembershipFunction::Sigmoid { inflection, slope } => {
                Smooth(sigmoid_flanks(inflection, slope))
            }
            MembershipFunction::SigmoidDifference {
                left_inflection,
                left_slope,
                right_inflection,
                right_slope,
            }
            | MembershipFunction::SigmoidProduct {
                left_inflection,
                left_slope,
                right_inflection,
                right_slope,
            } => {
                // The difference of the two sigmoids has a kink where they are equal.
                let equal = (left_slope * left_inflection - right_slope * right_inflection)
                    / (left_slope - right_slope);
                Smooth(
                    [
                        sigmoid_flanks(left_inflection, left_slope),
                        sigmoid_flanks(right_inflection, right_slope),
                        vec![equal],
                    ]
                    .concat(),
                )
            }
            MembershipFunction::SShape { foot: a, top: b }
            | MembershipFunction::ZShape { top: a, foot: b } => Smooth(vec![a, 0.5 * (a + b), b]),
            MembershipFunction::PiShape {
                left,
                left_top,
                right_top,
                right,
            } => Smooth(vec![
                left,
                0.5 * (left + left_top),
                left_top,
                right_top,
                0.5 * (right_top + right),
                right,
            ]),
            MembershipFunction::Cosine { center, width } => {
                Smooth(vec![center - 0.5 * width, center, center + 0.5 * width])
            }
            MembershipFunction::Spike { center, width } => {
                let reach = |level: f64| -0.1 * log(level);
                Smooth([flank(center, -width, reach), flank(center, width, reach)].concat())
            }
            MembershipFunction::Concave { inflection, end } => Smooth(vec![
                inflection,
                end,
                end - 5.0 * (end - inflection),
                end - 25.0 * (end - inflection),
            ]),
            MembershipFunction::Arc { start, end } => Smooth(vec![start, end]),
            MembershipFunction::SemiEllipse { left, right } => {
                Smooth(vec![left, 0.5 * (left + right), right])
            }
            MembershipFunction::Constant { value } => Straight(vec![(0.0, into_unit(value))]),
            // Formulas need no positions: their integration splits the range evenly.
            MembershipFunction::Function { .. } | MembershipFunction::Linear { .. } => {
                Smooth(vec![])
            }
        }
    }

    /// Returns the corners `(x, degree)` of a shape made of straight lines, with non-decreasing x. Before the first and
    /// after the last corner, the degree is constant. `None` for a curved shape.
    pub fn corners(&self) -> Option<Vec<(f64, f64)>> {
        match self.outline() {
            Outline::Straight(corners) => Some(corners),
            Outline::Smooth(_) => None,
        }
    }

    /// Returns the positions at which to split an integral over the membership function.
    pub(crate) fn cuts(&self) -> Vec<f64> {
        let mut cuts = match self.outline() {
            Outline::Straight(corners) => corners.iter().map(|corner| corner.0).collect(),
            Outline::Smooth(positions) => positions,
        };
        cuts.retain(|x| x.is_finite());
        cuts
    }
}
