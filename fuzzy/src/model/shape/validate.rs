//! Which parameters make a shape.

use alloc::{format, string::String};

use super::Shape;

/// Why the parameters of a shape make no membership function.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("{message}")]
pub struct ShapeError {
    message: String,
    /// The parameter to blame by name, or `point 3`, for those who know where it was written.
    pub(crate) blamed: String,
}

fn wrong(blamed: &str, message: String) -> Result<(), ShapeError> {
    Err(ShapeError {
        message,
        blamed: blamed.into(),
    })
}

impl Shape {
    /// Whether the parameters make a membership function: finite, in order, widths over 0.
    ///
    /// # Errors
    /// The first parameter that cannot be, by its name.
    ///
    /// # Example: the corners of a triangle stand in order
    /// ```
    /// use fuzzy::model::Shape;
    ///
    /// let shape = Shape::Triangle { left: 0.0, peak: 2.0, right: 1.0 };
    /// assert_eq!(shape.validate().unwrap_err().to_string(), "`peak` 2 is over `right` 1");
    /// ```
    pub fn validate(&self) -> Result<(), ShapeError> {
        match *self {
            Shape::Triangle { left, peak, right } => {
                ordered(&[("left", left), ("peak", peak), ("right", right)])
            }
            Shape::Trapezoid {
                left,
                left_top,
                right_top,
                right,
            }
            | Shape::PiShape {
                left,
                left_top,
                right_top,
                right,
            } => ordered(&[
                ("left", left),
                ("left_top", left_top),
                ("right_top", right_top),
                ("right", right),
            ]),
            Shape::LeftShoulder { top, foot } | Shape::ZShape { top, foot } => {
                ordered(&[("top", top), ("foot", foot)])
            }
            Shape::RightShoulder { foot, top } | Shape::SShape { foot, top } => {
                ordered(&[("foot", foot), ("top", top)])
            }
            Shape::Rectangle { left, right } => ordered(&[("left", left), ("right", right)]),
            Shape::Singleton { at } => finite("at", at),
            Shape::Piecewise { ref points } => piecewise(points),
            Shape::Gaussian { mean, sd } => finite("mean", mean).and(positive("sd", sd)),
            Shape::Gaussian2 {
                left_mean,
                left_sd,
                right_mean,
                right_sd,
            } => ordered(&[("left_mean", left_mean), ("right_mean", right_mean)])
                .and(positive("left_sd", left_sd))
                .and(positive("right_sd", right_sd)),
            Shape::Bell {
                center,
                width,
                slope,
            } => finite("center", center)
                .and(positive("width", width))
                .and(positive("slope", slope)),
            Shape::Sigmoid { inflection, slope } => {
                finite("inflection", inflection).and(finite("slope", slope))
            }
            Shape::SigmoidDifference {
                left_inflection,
                left_slope,
                right_inflection,
                right_slope,
            }
            | Shape::SigmoidProduct {
                left_inflection,
                left_slope,
                right_inflection,
                right_slope,
            } => finite("left_inflection", left_inflection)
                .and(finite("left_slope", left_slope))
                .and(finite("right_inflection", right_inflection))
                .and(finite("right_slope", right_slope)),
            Shape::Cosine { center, width } | Shape::Spike { center, width } => {
                finite("center", center).and(positive("width", width))
            }
            Shape::Concave { inflection, end } => {
                finite("inflection", inflection)?;
                finite("end", end)?;
                if inflection == end {
                    return wrong("end", format!("`inflection` and `end` are both {end}"));
                }
                Ok(())
            }
            Shape::Constant { value } => finite("value", value),
            Shape::Linear {
                ref coefficients,
                constant,
            } => {
                for (input, coefficient) in coefficients {
                    finite(input, *coefficient)?;
                }
                finite("constant", constant)
            }
        }
    }
}

fn finite(name: &str, value: f64) -> Result<(), ShapeError> {
    // Twice the value must be finite too: spans between parameters must not overflow.
    if (2.0 * value).is_finite() {
        Ok(())
    } else if value.is_finite() {
        wrong(name, format!("`{name}` is too large a number"))
    } else {
        wrong(name, format!("`{name}` is {value}, not a finite number"))
    }
}

fn positive(name: &str, value: f64) -> Result<(), ShapeError> {
    finite(name, value)?;
    if value > 0.0 {
        Ok(())
    } else {
        wrong(name, format!("`{name}` is {value}, not over 0"))
    }
}

fn ordered(parameters: &[(&str, f64)]) -> Result<(), ShapeError> {
    for (name, value) in parameters {
        finite(name, *value)?;
    }
    for pair in parameters.windows(2) {
        if let [(before, low), (after, high)] = pair
            && low > high
        {
            return wrong(after, format!("`{before}` {low} is over `{after}` {high}"));
        }
    }
    Ok(())
}

fn piecewise(points: &[(f64, f64)]) -> Result<(), ShapeError> {
    if points.is_empty() {
        return wrong("", "there are no points".into());
    }
    let mut before = f64::NEG_INFINITY;
    for (i, &(x, degree)) in points.iter().enumerate() {
        let blamed = format!("point {i}");
        if let Err(error) = finite("x", x) {
            return wrong(&blamed, error.message);
        }
        if !(0.0..=1.0).contains(&degree) {
            return wrong(
                &blamed,
                format!("the degree {degree} at {x} is not in [0, 1]"),
            );
        }
        if before > x {
            return wrong(&blamed, format!("the point at {x} stands behind {before}"));
        }
        before = x;
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;
    use alloc::{string::ToString, vec};

    #[test]
    fn says_which_parameter() {
        let message = |shape: Shape| shape.validate().unwrap_err().to_string();
        assert_eq!(
            message(Shape::Gaussian { mean: 1.0, sd: 0.0 }),
            "`sd` is 0, not over 0"
        );
        assert_eq!(
            message(Shape::Bell {
                center: f64::NAN,
                width: 1.0,
                slope: 1.0
            }),
            "`center` is NaN, not a finite number"
        );
        assert_eq!(
            message(Shape::Piecewise {
                points: vec![(0.0, 0.5), (1.0, 1.5)]
            }),
            "the degree 1.5 at 1 is not in [0, 1]"
        );
        assert_eq!(
            message(Shape::Piecewise {
                points: vec![(1.0, 0.5), (0.0, 0.5)]
            }),
            "the point at 0 stands behind 1"
        );
        assert_eq!(
            message(Shape::Concave {
                inflection: 1.0,
                end: 1.0
            }),
            "`inflection` and `end` are both 1"
        );
        assert_eq!(
            message(Shape::Rectangle {
                left: -1.7e308,
                right: 1.7e308
            }),
            "`left` is too large a number"
        );
    }
}
