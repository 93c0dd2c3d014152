//! Validation of the parameters of a shape.

use alloc::{format, string::String};

use super::{MembershipFunction, Role, ShapeParts};

/// The error for parameters that do not define a membership function.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct MembershipError {
    message: String,
    /// The suggestion for how to correct the parameters.
    pub(crate) help: &'static str,
    /// The index of the invalid parameter, point or coefficient.
    pub(crate) parameter: Option<usize>,
}

impl MembershipError {
    pub(super) fn count(expected: usize, got: usize) -> Self {
        MembershipError {
            message: format!("the shape has {expected} parameters, not {got}"),
            help: "write all parameters of the shape",
            parameter: None,
        }
    }
}

impl core::fmt::Display for MembershipError {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        f.write_str(&self.message)
    }
}

impl core::error::Error for MembershipError {}

fn wrong(parameter: usize, message: String, help: &'static str) -> Result<(), MembershipError> {
    Err(MembershipError {
        message,
        help,
        parameter: Some(parameter),
    })
}

impl MembershipFunction {
    /// Checks that the parameters define a membership function: finite, in order, and widths above 0.
    ///
    /// # Errors
    /// The first invalid parameter, by its name.
    ///
    /// # Example: the corners of a triangle must be in ascending order
    /// ```
    /// use fuzzy::model::MembershipFunction;
    ///
    /// let shape = MembershipFunction::Triangle { left: 0.0, peak: 2.0, right: 1.0 };
    /// assert_eq!(shape.validate().unwrap_err().to_string(), "`peak` (2) is greater than `right` (1)");
    /// ```
    pub fn validate(&self) -> Result<(), MembershipError> {
        match self.parts() {
            ShapeParts::Fixed(form, values) => {
                let mut before: Option<(&str, f64)> = None;
                for (i, (&(name, role), &value)) in form.parameters.iter().zip(&values).enumerate()
                {
                    finite(i, name, value)?;
                    match (role, before) {
                        (Role::Ascending, Some((left, low))) if low > value => {
                            let message =
                                format!("`{left}` ({low}) is greater than `{name}` ({value})");
                            let help = "write the positions in ascending order; equal positions are allowed";
                            return wrong(i, message, help);
                        }
                        (Role::Ascending, _) => before = Some((name, value)),
                        (Role::Positive, _) if value <= 0.0 => {
                            let message =
                                format!("`{name}` is {value}, but must be greater than 0");
                            return wrong(i, message, "write a number greater than 0");
                        }
                        _ => {}
                    }
                }
            }
            ShapeParts::Points(points) => piecewise(points)?,
            ShapeParts::Formula(_) => {}
            ShapeParts::Linear(coefficients, constant) => {
                for (i, (input, coefficient)) in coefficients.iter().enumerate() {
                    finite(i, input, *coefficient)?;
                }
                finite(coefficients.len(), "constant", constant)?;
            }
        }
        let help = "write two different numbers";
        self.misfit()
            .map_or(Ok(()), |message| wrong(0, message, help))
    }

    /// Returns the message for parameters that are valid individually but not in combination.
    fn misfit(&self) -> Option<String> {
        match *self {
            MembershipFunction::Concave { inflection, end } if inflection == end => {
                Some(format!("`inflection` and `end` are both {end}"))
            }
            MembershipFunction::Arc { start, end } if start == end => {
                Some(format!("`start` and `end` are both {start}"))
            }
            MembershipFunction::SemiEllipse { left, right } if left == right => {
                Some(format!("`left` and `right` are both {left}"))
            }
            _ => None,
        }
    }
}

fn finite(i: usize, name: &str, value: f64) -> Result<(), MembershipError> {
    // Twice the value must be finite too, so that distances between parameters do not overflow.
    if (2.0 * value).is_finite() {
        Ok(())
    } else if value.is_finite() {
        wrong(
            i,
            format!("`{name}` is too large"),
            "write a smaller number",
        )
    } else {
        let message = format!("`{name}` is {value}, not a finite number");
        wrong(i, message, "write a finite number")
    }
}

fn piecewise(points: &[(f64, f64)]) -> Result<(), MembershipError> {
    if points.is_empty() {
        return Err(MembershipError {
            message: "there are no points".into(),
            help: "write each point as a pair of x and degree: `piecewise: [[x, degree], [x, degree]]`",
            parameter: None,
        });
    }
    let mut before = f64::NEG_INFINITY;
    for (i, &(x, degree)) in points.iter().enumerate() {
        finite(i, "x", x)?;
        if !(0.0..=1.0).contains(&degree) {
            let message = format!("the degree {degree} at {x} is outside [0, 1]");
            return wrong(i, message, "write a degree from 0 to 1");
        }
        if before > x {
            let message = format!("the points are not in ascending order: {x} follows {before}");
            return wrong(i, message, "write the points in ascending order of x");
        }
        before = x;
    }
    Ok(())
}
