//! The shapes of membership functions. To add a shape, add a variant of [`MembershipFunction`] and a row in the
//! table of shapes, both in this file, a formula in `formula`, and an outline in `outline`.
//!
//! Formulas that several shapes share are in `straight`, `smooth` and `exponential`.

#[cfg(feature = "alloc")]
use alloc::{string::String, vec, vec::Vec};

mod exponential;
#[cfg(feature = "alloc")]
mod form;
mod formula;
mod inverse;
#[cfg(feature = "alloc")]
mod outline;
#[cfg(feature = "alloc")]
mod slope;
mod smooth;
mod straight;
#[cfg(test)]
mod tests;
#[cfg(feature = "alloc")]
mod validate;

#[cfg(feature = "alloc")]
use crate::formula::Formula;
#[cfg(feature = "alloc")]
pub use form::Role;
#[cfg(feature = "alloc")]
pub(crate) use form::{ShapeForm, ShapeParts};
pub use formula::ShapeKind;
#[cfg(feature = "alloc")]
use straight::{along, into_unit};
#[cfg(feature = "alloc")]
pub use validate::MembershipError;

/// A membership function: a shape with its parameters, in the unit of the variable.
///
/// # Example: the values that count as warm
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
    /// 0 at `left`, 1 at `peak` and 0 at `right`, with straight lines between them. `left = peak` or `peak = right`
    /// gives a vertical edge. MATLAB's `trimf`.
    Triangle {
        /// The value at which the degree starts to rise from 0.
        left: f64,
        /// The value at which the degree is 1.
        peak: f64,
        /// The value at which the degree returns to 0.
        right: f64,
    },
    /// 0 at `left`, 1 from `left_top` to `right_top` and 0 at `right`, with straight lines between them. MATLAB's
    /// `trapmf`.
    Trapezoid {
        /// The value at which the degree starts to rise from 0.
        left: f64,
        /// The value at which the degree reaches 1.
        left_top: f64,
        /// The value at which the degree starts to fall from 1.
        right_top: f64,
        /// The value at which the degree returns to 0.
        right: f64,
    },
    /// 1 up to `top`, then a straight line to 0 at `foot`. MATLAB's `linzmf`.
    LeftShoulder {
        /// The last value at which the degree is 1.
        top: f64,
        /// The first value at which the degree is 0.
        foot: f64,
    },
    /// 0 up to `foot`, then a straight line to 1 at `top`. MATLAB's `linsmf`.
    RightShoulder {
        /// The last value at which the degree is 0.
        foot: f64,
        /// The first value at which the degree is 1.
        top: f64,
    },
    /// 1 from `left` to `right`, including both ends, else 0. fuzzylite's `Rectangle`.
    Rectangle {
        /// The left end.
        left: f64,
        /// The right end.
        right: f64,
    },
    /// 1 only at `at`, else 0.
    Singleton {
        /// The value at which the degree is 1.
        at: f64,
    },
    /// Straight lines between points. Before the first and after the last point, the degree is constant. fuzzylite's
    /// `Discrete`.
    Piecewise {
        /// The points `(x, degree)`, with non-decreasing x. Two points with the same x are a step.
        points: Vec<(f64, f64)>,
    },
    /// `exp(-(x - mean)^2 / (2 sd^2))`. MATLAB's `gaussmf`.
    Gaussian {
        /// The mean.
        mean: f64,
        /// The standard deviation, above 0.
        sd: f64,
    },
    /// The product of two halves. The left half is a Gaussian up to `left_mean` and 1 beyond it; the right half is 1 up
    /// to `right_mean` and a Gaussian beyond it. The product is 1 from `left_mean` to `right_mean`; if `left_mean` is
    /// the larger one, it is below 1 everywhere. MATLAB's `gauss2mf`, fuzzylite's `GaussianProduct`.
    Gaussian2 {
        /// The end of the left flank.
        left_mean: f64,
        /// The standard deviation of the left flank.
        left_sd: f64,
        /// The start of the right flank.
        right_mean: f64,
        /// The standard deviation of the right flank.
        right_sd: f64,
    },
    /// `1 / (1 + |(x - center) / width|^(2 slope))`. MATLAB's `gbellmf`.
    Bell {
        /// The middle.
        center: f64,
        /// Half of the width at degree 0.5.
        width: f64,
        /// The steepness of the flanks.
        slope: f64,
    },
    /// `1 / (1 + exp(-slope (x - inflection)))`. MATLAB's `sigmf`.
    Sigmoid {
        /// The value at which the degree is 0.5.
        inflection: f64,
        /// The steepness; the degree falls if the slope is negative.
        slope: f64,
    },
    /// `|sigmoid1 - sigmoid2|`. MATLAB's `dsigmf`.
    SigmoidDifference {
        /// The inflection of the left sigmoid.
        left_inflection: f64,
        /// The slope of the left sigmoid.
        left_slope: f64,
        /// The inflection of the right sigmoid.
        right_inflection: f64,
        /// The slope of the right sigmoid.
        right_slope: f64,
    },
    /// `sigmoid1 sigmoid2`. MATLAB's `psigmf`.
    SigmoidProduct {
        /// The inflection of the left sigmoid.
        left_inflection: f64,
        /// The slope of the left sigmoid.
        left_slope: f64,
        /// The inflection of the right sigmoid.
        right_inflection: f64,
        /// The slope of the right sigmoid.
        right_slope: f64,
    },
    /// 0 up to `foot`, then two parabolas up to 1 at `top`. MATLAB's `smf`.
    SShape {
        /// The last value at which the degree is 0.
        foot: f64,
        /// The first value at which the degree is 1.
        top: f64,
    },
    /// 1 up to `top`, then two parabolas down to 0 at `foot`. MATLAB's `zmf`.
    ZShape {
        /// The last value at which the degree is 1.
        top: f64,
        /// The first value at which the degree is 0.
        foot: f64,
    },
    /// An S-shape from `left` to `left_top`, 1 up to `right_top`, and a Z-shape from there to `right`. MATLAB's `pimf`.
    PiShape {
        /// The value at which the degree starts to rise from 0.
        left: f64,
        /// The value at which the degree reaches 1.
        left_top: f64,
        /// The value at which the degree starts to fall from 1.
        right_top: f64,
        /// The value at which the degree returns to 0.
        right: f64,
    },
    /// `(1 + cos(2 pi (x - center) / width)) / 2` within half a width of the center, else 0. fuzzylite's `Cosine`.
    Cosine {
        /// The middle.
        center: f64,
        /// The full width.
        width: f64,
    },
    /// `exp(-|10 (x - center) / width|)`. fuzzylite's `Spike`.
    Spike {
        /// The middle.
        center: f64,
        /// The width.
        width: f64,
    },
    /// `(end - inflection) / (2 end - inflection - x)` up to `end`, and 1 beyond it, if `inflection <= end`; otherwise
    /// mirrored. fuzzylite's `Concave`.
    Concave {
        /// The value at which the degree is 0.5.
        inflection: f64,
        /// The value at which the degree reaches 1.
        end: f64,
    },
    /// `sqrt(t (2 - t))` with `t = (x - start) / (end - start)`, a quarter of an ellipse: 0 up to `start` and 1 beyond
    /// `end`; mirrored if `end` is below `start`. fuzzylite's `Arc`.
    Arc {
        /// The value at which the degree starts to rise from 0.
        start: f64,
        /// The value at which the degree reaches 1.
        end: f64,
    },
    /// `2 sqrt(t (1 - t))` with `t = (x - left) / (right - left)`, the upper half of an ellipse, else 0. fuzzylite's
    /// `SemiEllipse`.
    SemiEllipse {
        /// The value at which the degree starts to rise from 0.
        left: f64,
        /// The value at which the degree returns to 0.
        right: f64,
    },
    /// The same degree for all values; in a Takagi-Sugeno output, the constant `z`.
    Constant {
        /// The degree, or `z`.
        value: f64,
    },
    /// A formula over the variable itself. The degree is its value clamped to [0, 1], or 0 if the value is undefined.
    /// In a Takagi-Sugeno output, the formula is over inputs and other outputs, and its value is `z`. fuzzylite's
    /// `Function`.
    Function {
        /// The formula.
        formula: Formula,
    },
    /// Takagi-Sugeno outputs only: `z = constant + sum(coefficient input)`.
    Linear {
        /// The coefficients by the names of the inputs; all other inputs have the coefficient 0.
        coefficients: Vec<(String, f64)>,
        /// The constant part.
        constant: f64,
    },
}

// The name of each shape in a rule set, its parameters from left to right, and a description for the schema. If all
// parameters are positions, they may be written as a list. `piecewise`, `function` and `linear` have their own syntax.
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
        "1 at a single value, 0 elsewhere";
    Gaussian "gaussian" GAUSSIAN [mean: Ascending, sd: Positive]
        "exp(-(x - mean)^2 / (2 sd^2))";
    Gaussian2 "gaussian2" GAUSSIAN2 [left_mean: Number, left_sd: Positive, right_mean: Number, right_sd: Positive]
        "A gaussian flank up to left_mean, 1 from left_mean to right_mean, a gaussian flank beyond it; the product of both halves";
    Bell "bell" BELL [center: Ascending, width: Positive, slope: Positive]
        "1 / (1 + |(x - center) / width|^(2 slope))";
    Sigmoid "sigmoid" SIGMOID [inflection: Number, slope: Number]
        "1 / (1 + exp(-slope (x - inflection)))";
    SigmoidDifference "sigmoid_difference" SIGMOID_DIFFERENCE [left_inflection: Number, left_slope: Number, right_inflection: Number, right_slope: Number]
        "The absolute difference of two sigmoids";
    SigmoidProduct "sigmoid_product" SIGMOID_PRODUCT [left_inflection: Number, left_slope: Number, right_inflection: Number, right_slope: Number]
        "The product of two sigmoids";
    SShape "s_shape" S_SHAPE [foot: Ascending, top: Ascending]
        "Rises from 0 at foot to 1 at top, as two parabolas";
    ZShape "z_shape" Z_SHAPE [top: Ascending, foot: Ascending]
        "Falls from 1 at top to 0 at foot, as two parabolas";
    PiShape "pi_shape" PI_SHAPE [left: Ascending, left_top: Ascending, right_top: Ascending, right: Ascending]
        "Rises to 1 like s_shape up to left_top, falls like z_shape from right_top";
    Cosine "cosine" COSINE [center: Ascending, width: Positive]
        "One period of a raised cosine, from 0 over 1 at center to 0, width wide";
    Spike "spike" SPIKE [center: Ascending, width: Positive]
        "exp(-|10 (x - center) / width|)";
    Concave "concave" CONCAVE [inflection: Number, end: Number]
        "(end - inflection) / (2 end - inflection - x) up to end, 1 beyond end";
    Arc "arc" ARC [start: Number, end: Number]
        "A quarter of an ellipse from 0 at start to 1 at end";
    SemiEllipse "semi_ellipse" SEMI_ELLIPSE [left: Ascending, right: Ascending]
        "The upper half of an ellipse from left to right";
    Constant "constant" CONSTANT [value: Ascending]
        "The same degree everywhere; in a Takagi-Sugeno output, the value of the consequent";
}

#[cfg(feature = "alloc")]
impl MembershipFunction {
    /// Returns the name, role and value of each parameter, in the order in which they are written. Piecewise and
    /// linear shapes and formulas have no fixed number of parameters; the list is empty for them.
    pub fn parameters(&self) -> Vec<(&'static str, Role, f64)> {
        match self.parts() {
            ShapeParts::Fixed(form, values) => {
                let named = form.parameters.iter().zip(values);
                named
                    .map(|(&(name, role), value)| (name, role, value))
                    .collect()
            }
            _ => Vec::new(),
        }
    }

    /// Returns the same shape with different values of [`MembershipFunction::parameters`], in the same order.
    ///
    /// # Errors
    /// The number of values is wrong, or they do not define a membership function.
    ///
    /// # Example: move a Gaussian
    /// ```
    /// use fuzzy::model::MembershipFunction;
    ///
    /// let warm = MembershipFunction::Gaussian { mean: 20.0, sd: 3.0 };
    /// assert_eq!(warm.with_parameters(&[22.0, 3.0])?, MembershipFunction::Gaussian { mean: 22.0, sd: 3.0 });
    /// assert!(warm.with_parameters(&[22.0, -3.0]).is_err());
    /// # Ok::<(), fuzzy::model::MembershipError>(())
    /// ```
    pub fn with_parameters(&self, values: &[f64]) -> Result<Self, MembershipError> {
        let (form, count) = match self.parts() {
            ShapeParts::Fixed(form, _) => (Some(form), form.parameters.len()),
            _ => (None, 0),
        };
        let wrong_number = || MembershipError::count(count, values.len());
        let built = form
            .and_then(|form| (form.build)(values))
            .ok_or_else(wrong_number)?;
        built.validate()?;
        Ok(built)
    }

    /// Returns the value of a singleton; `None` for any other shape.
    pub(crate) fn at(&self) -> Option<f64> {
        match self {
            MembershipFunction::Singleton { at } => Some(*at),
            _ => None,
        }
    }

    /// Returns the value of a constant, or of a linear function or formula that reads no variable; `None` otherwise.
    #[must_use]
    pub fn number(&self) -> Option<f64> {
        match self {
            MembershipFunction::Constant { value } => Some(*value),
            MembershipFunction::Linear {
                coefficients,
                constant,
            } if coefficients.is_empty() => Some(*constant),
            MembershipFunction::Function { formula } if formula.variables().next().is_none() => {
                let value = formula.evaluate(|_| f64::NAN);
                value.is_finite().then_some(value)
            }
            _ => None,
        }
    }

    /// Returns the names of the variables that a linear function or a formula reads.
    pub(crate) fn reads(&self) -> Vec<&str> {
        match self {
            MembershipFunction::Linear { coefficients, .. } => {
                coefficients.iter().map(|(name, _)| &**name).collect()
            }
            MembershipFunction::Function { formula } => formula.variables().collect(),
            _ => Vec::new(),
        }
    }

    /// Returns the degree of membership of `x`, which is always in [0, 1] and never NaN.
    ///
    /// The formula of each shape is documented at its variant. In addition:
    /// - At a vertical edge (`left = peak`, the ends of a rectangle, a step of a piecewise shape) the result is the
    ///   higher degree, so a triangle is 1 at its peak.
    /// - At minus and plus infinity the result is the limit.
    /// - For NaN the result is 0.
    /// - `Linear` is not a membership function; the result is 0. A `Constant` outside [0, 1] is clamped.
    ///
    /// Straight edges are computed as `(x - foot) / (top - foot)`, which is exactly 0 at the foot, exactly 1 at the
    /// top, and accurate to the last bit near the foot. The exponential function is computed in this crate, and `pow`
    /// and `cos` by `libm`, so the result for an `x` is bitwise equal on every machine.
    pub fn membership(&self, x: f64) -> f64 {
        match self {
            MembershipFunction::Piecewise { .. } if x.is_nan() => 0.0,
            MembershipFunction::Piecewise { points } => into_unit(along(points.iter().copied(), x)),
            MembershipFunction::Function { formula } => {
                ShapeKind::FUNCTION.membership(&[0.0; 4], formula.code(), x)
            }
            _ => {
                let (kind, parameters) = self.kind();
                kind.membership(&parameters, &[], x)
            }
        }
    }
}
