//! Which parameters make a shape.

use alloc::{format, string::String, vec::Vec};

use super::{Parts, Role, Shape};

/// Why the parameters of a shape make no membership function.
///
/// # Example: a bell without a width
/// ```
/// use fuzzy::model::{Shape, ShapeError};
///
/// let refused: ShapeError = Shape::Gaussian { mean: 20.0, sd: 0.0 }.validate().unwrap_err();
/// assert_eq!(refused.to_string(), "`sd` is 0, not over 0");
/// ```
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
        match self.parts() {
            Parts::Fixed(form, values) => {
                let of = |role: Role| {
                    let all = form.parameters.iter().zip(&values);
                    all.filter(move |((_, r), _)| *r == role)
                        .map(|((name, _), value)| (*name, *value))
                };
                ordered(&of(Role::Place).collect::<Vec<_>>())?;
                of(Role::Positive).try_for_each(|(name, value)| positive(name, value))?;
                of(Role::Number).try_for_each(|(name, value)| finite(name, value))?;
            }
            Parts::Points(points) => piecewise(points)?,
            Parts::Linear(coefficients, constant) => {
                for (input, coefficient) in coefficients {
                    finite(input, *coefficient)?;
                }
                finite("constant", constant)?;
            }
        }
        self.misfit()
            .map_or(Ok(()), |(blamed, message)| wrong(blamed, message))
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
