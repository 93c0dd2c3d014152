//! The shapes of membership functions. What a shape is stands in this file alone: its formula, which has a number and is
//! all that a table in firmware knows of it; and, where there is an allocator, in three places that the compiler asks for,
//! its variant in [`MembershipFunction`], its line in the table of spellings, and its outline.
//!
//! Formulas that several shapes share are in `straight` and `smooth`.

#[cfg(feature = "alloc")]
use alloc::{format, string::String, vec, vec::Vec};

#[cfg(feature = "alloc")]
use libm::log;
use libm::{cos, exp, fabs, pow};

#[cfg(feature = "alloc")]
mod form;
mod smooth;
mod straight;
#[cfg(test)]
mod tests;
#[cfg(feature = "alloc")]
mod validate;

#[cfg(feature = "alloc")]
pub(crate) use form::{Form, Parts, Role};
#[cfg(feature = "alloc")]
use smooth::{flank, gaussian_flank, sigmoid_flanks};
use smooth::{gaussian, s_shape, sigmoid, z_shape};
use straight::{along, falling, indicator, into_unit, rising, trapezoid};
#[cfg(feature = "alloc")]
pub use validate::MembershipError;

/// The formula of a membership function. What it takes as its parameters is in the order of the fields of the `MembershipFunction` of
/// that name.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[repr(transparent)]
pub struct Kind(pub u32);

#[expect(missing_docs, reason = "each is the shape of that name")]
impl Kind {
    pub const TRAPEZOID: Kind = Kind(0);
    pub const LEFT_SHOULDER: Kind = Kind(1);
    pub const RIGHT_SHOULDER: Kind = Kind(2);
    pub const RECTANGLE: Kind = Kind(3);
    pub const SINGLETON: Kind = Kind(4);
    pub const PIECEWISE: Kind = Kind(5);
    pub const GAUSSIAN: Kind = Kind(6);
    pub const GAUSSIAN2: Kind = Kind(7);
    pub const BELL: Kind = Kind(8);
    pub const SIGMOID: Kind = Kind(9);
    pub const SIGMOID_DIFFERENCE: Kind = Kind(10);
    pub const SIGMOID_PRODUCT: Kind = Kind(11);
    pub const S_SHAPE: Kind = Kind(12);
    pub const Z_SHAPE: Kind = Kind(13);
    pub const PI_SHAPE: Kind = Kind(14);
    pub const COSINE: Kind = Kind(15);
    pub const SPIKE: Kind = Kind(16);
    pub const CONCAVE: Kind = Kind(17);
    pub const CONSTANT: Kind = Kind(18);
    pub const TRIANGLE: Kind = Kind(19);

    /// The degree at `x` with these parameters, in [0, 1] and never NaN; `points` are those of a piecewise shape.
    pub(crate) fn membership(self, parameters: &[f64; 4], points: &[[f64; 2]], x: f64) -> f64 {
        if x.is_nan() {
            return 0.0;
        }
        let [a, b, c, d] = *parameters;
        into_unit(match self {
            Kind::TRIANGLE => trapezoid(x, a, b, b, c),
            Kind::TRAPEZOID => trapezoid(x, a, b, c, d),
            Kind::LEFT_SHOULDER => falling(x, a, b),
            Kind::RIGHT_SHOULDER => rising(x, a, b),
            Kind::RECTANGLE => indicator(a <= x && x <= b),
            Kind::SINGLETON => indicator(x == a),
            Kind::PIECEWISE => along(points.iter().map(|[x, y]| (*x, *y)), x),
            Kind::GAUSSIAN => gaussian(x, a, b),
            Kind::GAUSSIAN2 if x < a => gaussian(x, a, b),
            Kind::GAUSSIAN2 if x > c => gaussian(x, c, d),
            Kind::GAUSSIAN2 => 1.0,
            Kind::BELL => 1.0 / (1.0 + pow(fabs((x - a) / b), 2.0 * c)),
            Kind::SIGMOID => sigmoid(x, a, b),
            Kind::SIGMOID_DIFFERENCE => fabs(sigmoid(x, a, b) - sigmoid(x, c, d)),
            Kind::SIGMOID_PRODUCT => sigmoid(x, a, b) * sigmoid(x, c, d),
            Kind::S_SHAPE => s_shape(x, a, b),
            Kind::Z_SHAPE => z_shape(x, a, b),
            Kind::PI_SHAPE if x < b => s_shape(x, a, b),
            Kind::PI_SHAPE => z_shape(x, c, d),
            Kind::COSINE if fabs(x - a) <= 0.5 * b => {
                let turns = (x - a) / b;
                0.5 * (1.0 + cos(2.0 * core::f64::consts::PI * turns))
            }
            Kind::SPIKE => exp(-fabs(10.0 * (x - a) / b)),
            Kind::CONCAVE => concave(x, a, b),
            Kind::CONSTANT => a,
            _ => 0.0,
        })
    }
}

fn concave(x: f64, inflection: f64, end: f64) -> f64 {
    if inflection <= end {
        if x < end {
            (end - inflection) / (2.0 * end - inflection - x)
        } else {
            1.0
        }
    } else if x > end {
        (inflection - end) / (inflection - 2.0 * end + x)
    } else {
        1.0
    }
}

/// A membership function's shape, with its parameters in the unit of the variable.
///
/// # Example: a part of a range that people call warm
/// ```
/// use fuzzy::model::MembershipFunction;
///
/// let warm = MembershipFunction::Trapezoid { left: 15.0, left_top: 20.0, right_top: 25.0, right: 30.0 };
/// assert_eq!(warm.membership(22.0), 1.0);
/// assert_eq!(warm.membership(16.0), 0.2);
/// ```
#[cfg(feature = "alloc")]
#[derive(Debug, Clone, PartialEq)]
pub enum MembershipFunction {
    /// 0 at `left`, 1 at `peak`, 0 at `right`, straight between; `left = peak` is a closed shoulder.
    /// MATLAB's `trimf`.
    Triangle {
        /// Where it leaves 0.
        left: f64,
        /// Where it is 1.
        peak: f64,
        /// Where it is 0 again.
        right: f64,
    },
    /// 0 at `left`, 1 from `left_top` to `right_top`, 0 at `right`, straight between.
    /// MATLAB's `trapmf`.
    Trapezoid {
        /// Where it leaves 0.
        left: f64,
        /// Where it reaches 1.
        left_top: f64,
        /// Where it leaves 1.
        right_top: f64,
        /// Where it is 0 again.
        right: f64,
    },
    /// 1 up to `top`, straight down to 0 at `foot`.
    /// MATLAB's `linzmf`.
    LeftShoulder {
        /// Up to here it is 1.
        top: f64,
        /// From here on it is 0.
        foot: f64,
    },
    /// 0 up to `foot`, straight up to 1 at `top`.
    /// MATLAB's `linsmf`.
    RightShoulder {
        /// Up to here it is 0.
        foot: f64,
        /// From here on it is 1.
        top: f64,
    },
    /// 1 from `left` to `right`, ends included, else 0.
    /// fuzzylite's `Rectangle`.
    Rectangle {
        /// The left end.
        left: f64,
        /// The right end.
        right: f64,
    },
    /// 1 at `at` alone.
    Singleton {
        /// The one value.
        at: f64,
    },
    /// Straight between the points, the first and last degree held beyond them.
    /// fuzzylite's `Discrete`.
    Piecewise {
        /// `(x, degree)` with x never falling; two points of one x are a step.
        points: Vec<(f64, f64)>,
    },
    /// `exp(-(x - mean)^2 / (2 sd^2))`.
    /// MATLAB's `gaussmf`.
    Gaussian {
        /// The mean.
        mean: f64,
        /// The standard deviation, over 0.
        sd: f64,
    },
    /// Gaussian flanks around a plateau of 1 from `left_mean` to `right_mean`.
    /// MATLAB's `gauss2mf`.
    Gaussian2 {
        /// Where the plateau begins.
        left_mean: f64,
        /// The standard deviation of the left flank.
        left_sd: f64,
        /// Where the plateau ends.
        right_mean: f64,
        /// The standard deviation of the right flank.
        right_sd: f64,
    },
    /// `1 / (1 + |(x - center) / width|^(2 slope))`.
    /// MATLAB's `gbellmf`.
    Bell {
        /// The middle.
        center: f64,
        /// Half the width at degree 0.5.
        width: f64,
        /// The steepness of the flanks.
        slope: f64,
    },
    /// `1 / (1 + exp(-slope (x - inflection)))`.
    /// MATLAB's `sigmf`.
    Sigmoid {
        /// Where it is 0.5.
        inflection: f64,
        /// Its steepness; negative falls.
        slope: f64,
    },
    /// `|sigmoid1 - sigmoid2|`.
    /// MATLAB's `dsigmf`.
    SigmoidDifference {
        /// Inflection of the left sigmoid.
        left_inflection: f64,
        /// Slope of the left sigmoid.
        left_slope: f64,
        /// Inflection of the right sigmoid.
        right_inflection: f64,
        /// Slope of the right sigmoid.
        right_slope: f64,
    },
    /// `sigmoid1 sigmoid2`.
    /// MATLAB's `psigmf`.
    SigmoidProduct {
        /// Inflection of the left sigmoid.
        left_inflection: f64,
        /// Slope of the left sigmoid.
        left_slope: f64,
        /// Inflection of the right sigmoid.
        right_inflection: f64,
        /// Slope of the right sigmoid.
        right_slope: f64,
    },
    /// 0 up to `foot`, two parabolas up to 1 at `top`.
    /// MATLAB's `smf`.
    SShape {
        /// Up to here it is 0.
        foot: f64,
        /// From here on it is 1.
        top: f64,
    },
    /// 1 up to `top`, two parabolas down to 0 at `foot`.
    /// MATLAB's `zmf`.
    ZShape {
        /// Up to here it is 1.
        top: f64,
        /// From here on it is 0.
        foot: f64,
    },
    /// An S from `left` to `left_top`, 1, a Z from `right_top` to `right`.
    /// MATLAB's `pimf`.
    PiShape {
        /// Where it leaves 0.
        left: f64,
        /// Where it reaches 1.
        left_top: f64,
        /// Where it leaves 1.
        right_top: f64,
        /// Where it is 0 again.
        right: f64,
    },
    /// `(1 + cos(2 pi (x - center) / width)) / 2` within half a width of the center, else 0.
    /// fuzzylite's `Cosine`.
    Cosine {
        /// The middle.
        center: f64,
        /// The whole width.
        width: f64,
    },
    /// `exp(-|10 (x - center) / width|)`.
    /// fuzzylite's `Spike`.
    Spike {
        /// The middle.
        center: f64,
        /// The width.
        width: f64,
    },
    /// `(end - inflection) / (2 end - inflection - x)` up to `end` where `inflection <= end`, mirrored
    /// otherwise; 1 beyond `end`.
    /// fuzzylite's `Concave`.
    Concave {
        /// Where it is 0.5.
        inflection: f64,
        /// Where it reaches 1.
        end: f64,
    },
    /// The same degree everywhere; in a Takagi-Sugeno output, the constant `z` itself.
    Constant {
        /// The degree, or `z`.
        value: f64,
    },
    /// Takagi-Sugeno outputs only: `z = constant + sum(coefficient input)`.
    Linear {
        /// A coefficient for each input named; the others count 0.
        coefficients: Vec<(String, f64)>,
        /// The constant part.
        constant: f64,
    },
}

// The name of each shape in a rule set, its parameters from left to right, and a line for the schema. Where all
// parameters are places, they may be written as a list. `piecewise` and `linear` are written in ways of their own.
#[cfg(feature = "alloc")]
form::forms! {
    Triangle "triangle" TRIANGLE [left: Ascending, peak: Ascending, right: Ascending]
        "0 at left, 1 at peak, 0 at right";
    Trapezoid "trapezoid" TRAPEZOID [left: Ascending, left_top: Ascending, right_top: Ascending, right: Ascending]
        "1 from left_top to right_top, 0 outside left and right";
    LeftShoulder "left_shoulder" LEFT_SHOULDER [top: Ascending, foot: Ascending]
        "1 up to top, 0 from foot on";
    RightShoulder "right_shoulder" RIGHT_SHOULDER [foot: Ascending, top: Ascending]
        "0 up to foot, 1 from top on";
    Rectangle "rectangle" RECTANGLE [left: Ascending, right: Ascending]
        "1 from left to right";
    Singleton "singleton" SINGLETON [at: Ascending]
        "1 at one value alone";
    Gaussian "gaussian" GAUSSIAN [mean: Ascending, sd: Positive]
        "exp(-(x - mean)^2 / (2 sd^2))";
    Gaussian2 "gaussian2" GAUSSIAN2 [left_mean: Ascending, left_sd: Positive, right_mean: Ascending, right_sd: Positive]
        "Gaussian flanks around 1 from left_mean to right_mean";
    Bell "bell" BELL [center: Ascending, width: Positive, slope: Positive]
        "1 / (1 + |(x - center) / width|^(2 slope))";
    Sigmoid "sigmoid" SIGMOID [inflection: Number, slope: Number]
        "1 / (1 + exp(-slope (x - inflection)))";
    SigmoidDifference "sigmoid_difference" SIGMOID_DIFFERENCE [left_inflection: Number, left_slope: Number, right_inflection: Number, right_slope: Number]
        "The difference of two sigmoids, without its sign";
    SigmoidProduct "sigmoid_product" SIGMOID_PRODUCT [left_inflection: Number, left_slope: Number, right_inflection: Number, right_slope: Number]
        "The product of two sigmoids";
    SShape "s_shape" S_SHAPE [foot: Ascending, top: Ascending]
        "Two parabolas up from 0 at foot to 1 at top";
    ZShape "z_shape" Z_SHAPE [top: Ascending, foot: Ascending]
        "Two parabolas down from 1 at top to 0 at foot";
    PiShape "pi_shape" PI_SHAPE [left: Ascending, left_top: Ascending, right_top: Ascending, right: Ascending]
        "An S up to left_top, 1, a Z down from right_top";
    Cosine "cosine" COSINE [center: Ascending, width: Positive]
        "A bump of a cosine, width wide";
    Spike "spike" SPIKE [center: Ascending, width: Positive]
        "exp(-|10 (x - center) / width|)";
    Concave "concave" CONCAVE [inflection: Number, end: Number]
        "(end - inflection) / (2 end - inflection - x) up to end, 1 beyond it";
    Constant "constant" CONSTANT [value: Ascending]
        "The same degree everywhere; in a Takagi-Sugeno output, the value itself";
}

#[cfg(feature = "alloc")]
impl MembershipFunction {
    /// The degree of membership of `x`, always in [0, 1] and never NaN.
    ///
    /// The formula of each shape stands at its variant. Everywhere:
    /// - at a vertical edge (`left = peak`, the ends of a rectangle, a step of a piecewise shape) the
    ///   higher degree holds, so a shoulder reads 1 at its peak;
    /// - at minus and plus infinity it is the limit;
    /// - not a number belongs to no term: degree 0;
    /// - `Linear` is no membership function: degree 0; a `Constant` outside [0, 1] is cut to it.
    ///
    /// Straight edges are divided out, `(x - foot) / (top - foot)`: exactly 0 at the foot, exactly 1 at the
    /// top, and near the foot exact to the last bit. `exp`, `pow` and `cos` are `libm`'s, so the same `x` has
    /// the same bits on every machine.
    pub fn membership(&self, x: f64) -> f64 {
        match self {
            MembershipFunction::Piecewise { .. } if x.is_nan() => 0.0,
            MembershipFunction::Piecewise { points } => into_unit(along(points.iter().copied(), x)),
            _ => {
                let (kind, parameters) = self.kind();
                kind.membership(&parameters, &[], x)
            }
        }
    }
}

/// How a shape runs, as far as an exact integral must know.
#[cfg(feature = "alloc")]
enum Outline {
    /// Straight between corners `(x, degree)`, x never falling, the first and last degree held beyond them.
    Straight(Vec<(f64, f64)>),
    /// Smooth between these places, in no order, and close enough to each other that none hides a narrow flank. Those
    /// that are no finite numbers do not count.
    Smooth(Vec<f64>),
}

#[cfg(feature = "alloc")]
impl MembershipFunction {
    /// Why parameters that are right one by one still make no shape.
    fn misfit(&self) -> Option<String> {
        match *self {
            MembershipFunction::Concave { inflection, end } if inflection == end => {
                Some(format!("`inflection` and `end` are both {end}"))
            }
            _ => None,
        }
    }

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
                // Closer to the middle as well: |t|^(2 slope) is rough there where the slope is low.
                let near = (1..40).map(|halvings| width * libm::exp2(-f64::from(halvings)));
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
                // Where the two sigmoids are equal their difference has a kink.
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
            MembershipFunction::Constant { value } => Straight(vec![(0.0, into_unit(value))]),
            MembershipFunction::Linear { .. } => Smooth(vec![]),
        }
    }

    /// The corners of a shape made of straight lines, `(x, degree)` with x never falling and the first
    /// and last degree held beyond them; `None` for a curved shape.
    pub fn corners(&self) -> Option<Vec<(f64, f64)>> {
        match self.outline() {
            Outline::Straight(corners) => Some(corners),
            Outline::Smooth(_) => None,
        }
    }

    /// The places at which to cut an integral over the shape.
    pub(crate) fn cuts(&self) -> Vec<f64> {
        let mut cuts = match self.outline() {
            Outline::Straight(corners) => corners.iter().map(|corner| corner.0).collect(),
            Outline::Smooth(places) => places,
        };
        cuts.retain(|x| x.is_finite());
        cuts
    }
}
