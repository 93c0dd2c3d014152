//! The shapes of membership functions.

use alloc::{string::String, vec::Vec};

mod membership;
mod validate;
pub use validate::ShapeError;

/// A membership function's shape, with its parameters in the unit of the variable.
#[derive(Debug, Clone, PartialEq)]
pub enum Shape {
    /// 0 at `left`, 1 at `peak`, 0 at `right`, straight between; `left = peak` is a closed shoulder.
    Triangle {
        /// Where it leaves 0.
        left: f64,
        /// Where it is 1.
        peak: f64,
        /// Where it is 0 again.
        right: f64,
    },
    /// 0 at `left`, 1 from `left_top` to `right_top`, 0 at `right`, straight between.
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
    LeftShoulder {
        /// Up to here it is 1.
        top: f64,
        /// From here on it is 0.
        foot: f64,
    },
    /// 0 up to `foot`, straight up to 1 at `top`.
    RightShoulder {
        /// Up to here it is 0.
        foot: f64,
        /// From here on it is 1.
        top: f64,
    },
    /// 1 from `left` to `right`, ends included, else 0.
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
    Piecewise {
        /// `(x, degree)` with x never falling; two points of one x are a step.
        points: Vec<(f64, f64)>,
    },
    /// `exp(-(x - mean)^2 / (2 sd^2))`.
    Gaussian {
        /// The mean.
        mean: f64,
        /// The standard deviation, over 0.
        sd: f64,
    },
    /// Gaussian flanks around a plateau of 1 from `left_mean` to `right_mean`.
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
    Bell {
        /// The middle.
        center: f64,
        /// Half the width at degree 0.5.
        width: f64,
        /// The steepness of the flanks.
        slope: f64,
    },
    /// `1 / (1 + exp(-slope (x - inflection)))`.
    Sigmoid {
        /// Where it is 0.5.
        inflection: f64,
        /// Its steepness; negative falls.
        slope: f64,
    },
    /// `|sigmoid1 - sigmoid2|`.
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
    SShape {
        /// Up to here it is 0.
        foot: f64,
        /// From here on it is 1.
        top: f64,
    },
    /// 1 up to `top`, two parabolas down to 0 at `foot`.
    ZShape {
        /// Up to here it is 1.
        top: f64,
        /// From here on it is 0.
        foot: f64,
    },
    /// An S from `left` to `left_top`, 1, a Z from `right_top` to `right`.
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
    Cosine {
        /// The middle.
        center: f64,
        /// The whole width.
        width: f64,
    },
    /// `exp(-|10 (x - center) / width|)`.
    Spike {
        /// The middle.
        center: f64,
        /// The width.
        width: f64,
    },
    /// `(end - inflection) / (2 end - inflection - x)` up to `end` where `inflection <= end`, mirrored
    /// otherwise; 1 beyond `end`.
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
