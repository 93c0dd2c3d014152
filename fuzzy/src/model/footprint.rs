//! Footprints of interval type-2 terms: the upper and the lower membership function around an ordinary one.

use alloc::{format, string::String};

use super::{Formula, LowerFunction, MembershipFunction, ShapeParts};

/// An upper membership function, and the lower one with its height.
pub(crate) type Footprint = (MembershipFunction, LowerFunction);

/// The reason why a membership function has no footprint.
#[derive(Debug, Clone, PartialEq)]
pub(crate) enum NoFootprint {
    /// Footprints of this kind of membership function are not supported.
    Unsupported(String),
    /// The distance is so large that the lower membership function would be 0 everywhere, or would have another form.
    /// The field is the limit; the distance must be below it.
    TooLarge(f64),
}

/// Moves a valid membership function to the left and to the right by up to `by`: the upper membership function
/// is the maximum of all shifted copies, and the lower one is their minimum.
///
/// A vertical edge at or beyond an end of the `range` does not move, because the range has no values beyond the
/// edge. `variable` is the name of the variable, which a formula for a bound contains.
pub(crate) fn blurred(
    function: &MembershipFunction,
    by: f64,
    range: (f64, f64),
    variable: &str,
) -> Result<Footprint, NoFootprint> {
    use MembershipFunction as F;
    let both = |upper: F, lower: F| Ok((upper, normal(lower)));
    match *function {
        F::Triangle { left, peak, right } => straight([left, peak, peak, right], by, range),
        F::Trapezoid {
            left,
            left_top,
            right_top,
            right,
        } => straight([left, left_top, right_top, right], by, range),
        F::Rectangle { left, right } => straight([left, left, right, right], by, range),
        F::LeftShoulder { top, foot } => {
            let moved = |by: f64| F::LeftShoulder {
                top: top + by,
                foot: foot + by,
            };
            both(moved(by), moved(-by))
        }
        F::RightShoulder { foot, top } => {
            let moved = |by: f64| F::RightShoulder {
                foot: foot + by,
                top: top + by,
            };
            both(moved(-by), moved(by))
        }
        F::SShape { foot, top } => {
            let moved = |by: f64| F::SShape {
                foot: foot + by,
                top: top + by,
            };
            both(moved(-by), moved(by))
        }
        F::ZShape { top, foot } => {
            let moved = |by: f64| F::ZShape {
                top: top + by,
                foot: foot + by,
            };
            both(moved(by), moved(-by))
        }
        F::Sigmoid { inflection, slope } => {
            let by = if slope < 0.0 { -by } else { by };
            let moved = |by: f64| F::Sigmoid {
                inflection: inflection + by,
                slope,
            };
            both(moved(-by), moved(by))
        }
        F::PiShape {
            left,
            left_top,
            right_top,
            right,
        } => {
            let moved = |by: f64| F::PiShape {
                left: left - by,
                left_top: left_top - by,
                right_top: right_top + by,
                right: right + by,
            };
            let most = 0.5 * (right_top - left_top);
            (by < most)
                .then_some(())
                .ok_or(NoFootprint::TooLarge(most))?;
            both(moved(by), moved(-by))
        }
        F::Gaussian2 {
            left_mean,
            left_sd,
            right_mean,
            right_sd,
        } => {
            let moved = |by: f64| F::Gaussian2 {
                left_mean: left_mean - by,
                left_sd,
                right_mean: right_mean + by,
                right_sd,
            };
            let most = 0.5 * (right_mean - left_mean);
            (by < most)
                .then_some(())
                .ok_or(NoFootprint::TooLarge(most))?;
            both(moved(by), moved(-by))
        }
        F::Gaussian { mean, sd } => uncertain_gaussian((mean - by, mean + by), (sd, sd), variable),
        _ => Err(unsupported(function)),
    }
}

/// Moves the corners of a trapezoid. If the flanks of the lower trapezoid would cross, the lower membership function
/// is a triangle of smaller height.
fn straight(corners: [f64; 4], by: f64, (low, high): (f64, f64)) -> Result<Footprint, NoFootprint> {
    use MembershipFunction as F;
    let [left, left_top, right_top, right] = corners;
    if left == left_top && left <= low {
        let (top, foot) = (right_top, right);
        return blurred(&F::LeftShoulder { top, foot }, by, (low, high), "");
    }
    if right == right_top && right >= high {
        let (foot, top) = (left, left_top);
        return blurred(&F::RightShoulder { foot, top }, by, (low, high), "");
    }
    let upper = F::Trapezoid {
        left: left - by,
        left_top: left_top - by,
        right_top: right_top + by,
        right: right + by,
    };
    let most = 0.5 * (right - left);
    (by < most)
        .then_some(())
        .ok_or(NoFootprint::TooLarge(most))?;
    let (left, right) = (left + by, right - by);
    let (inner_left, inner_right) = (left_top + by, right_top - by);
    if inner_left < inner_right {
        let lower = F::Trapezoid {
            left,
            left_top: inner_left,
            right_top: inner_right,
            right,
        };
        return Ok((upper, normal(lower)));
    }
    // The flanks have the lengths `rise` and `fall`, and meet at `height`.
    let (rise, fall) = (left_top + by - left, right - (right_top - by));
    let height = ((right - left) / (rise + fall)).min(1.0);
    if !(left < right && height > 0.0) {
        return Err(NoFootprint::TooLarge(most));
    }
    let peak = (left + height * rise).clamp(left, right);
    let membership_function = F::Triangle { left, peak, right };
    Ok((
        upper,
        LowerFunction {
            membership_function,
            height,
        },
    ))
}

/// Returns the bounds of all Gaussians whose mean and standard deviation lie in these intervals. `variable` is the name
/// of the variable, which the formula of the lower bound contains.
pub(crate) fn uncertain_gaussian(
    mean: (f64, f64),
    sd: (f64, f64),
    variable: &str,
) -> Result<Footprint, NoFootprint> {
    use MembershipFunction as F;
    if mean.0 == mean.1 {
        let gaussian = |sd: f64| F::Gaussian { mean: mean.0, sd };
        return Ok((gaussian(sd.1), normal(gaussian(sd.0))));
    }
    let upper = F::Gaussian2 {
        left_mean: mean.0,
        left_sd: sd.1,
        right_mean: mean.1,
        right_sd: sd.1,
    };
    // The smallest degree is that of the farthest mean.
    let half = 0.5 * (mean.1 - mean.0);
    let name = variable.replace('\\', "\\\\").replace('"', "\\\"");
    let text = format!(
        "exp(-((abs(\"{name}\" - {middle}) + {half}) / {sd})^2 / 2)",
        middle = bracketed(mean.0 + half),
        sd = sd.0
    );
    let Ok(formula) = text.parse::<Formula>() else {
        return Err(NoFootprint::Unsupported(format!(
            "a Gaussian over the variable `{variable}`"
        )));
    };
    Ok((upper, normal(F::Function { formula })))
}

/// Formats a number as an operand of a formula; a negative number is put in brackets.
fn bracketed(number: f64) -> String {
    if number < 0.0 {
        format!("({number})")
    } else {
        format!("{number}")
    }
}

/// Returns the lower membership function of MATLAB's `fismftype2` for a valid upper one. It is scaled by `scale`. Its
/// left flank starts to rise where the upper membership function has the degree `left_lag`, and its right flank ends
/// where the upper one has the degree `right_lag`.
pub(crate) fn lagging(
    function: &MembershipFunction,
    scale: f64,
    (left_lag, right_lag): (f64, f64),
) -> Result<LowerFunction, NoFootprint> {
    use MembershipFunction as F;
    let toward = |foot: f64, top: f64, lag: f64| foot + lag * (top - foot);
    let membership_function = match *function {
        _ if left_lag == 0.0 && right_lag == 0.0 => function.clone(),
        F::Triangle { left, peak, right } => F::Triangle {
            left: toward(left, peak, left_lag),
            peak,
            right: toward(right, peak, right_lag),
        },
        F::Trapezoid {
            left,
            left_top,
            right_top,
            right,
        } => F::Trapezoid {
            left: toward(left, left_top, left_lag),
            left_top,
            right_top,
            right: toward(right, right_top, right_lag),
        },
        F::LeftShoulder { top, foot } => F::LeftShoulder {
            top,
            foot: toward(foot, top, right_lag),
        },
        F::RightShoulder { foot, top } => F::RightShoulder {
            foot: toward(foot, top, left_lag),
            top,
        },
        F::SShape { top, .. } => F::SShape {
            foot: function.inverse(left_lag),
            top,
        },
        F::ZShape { top, .. } => F::ZShape {
            top,
            foot: function.inverse(right_lag),
        },
        F::PiShape {
            left,
            left_top,
            right_top,
            right,
        } => F::PiShape {
            left: F::SShape {
                foot: left,
                top: left_top,
            }
            .inverse(left_lag),
            left_top,
            right_top,
            right: F::ZShape {
                top: right_top,
                foot: right,
            }
            .inverse(right_lag),
        },
        _ => return Err(unsupported(function)),
    };
    Ok(LowerFunction {
        membership_function,
        height: scale,
    })
}

fn normal(membership_function: MembershipFunction) -> LowerFunction {
    LowerFunction {
        membership_function,
        height: 1.0,
    }
}

fn unsupported(function: &MembershipFunction) -> NoFootprint {
    let name = match function.parts() {
        ShapeParts::Fixed(form, _) => form.name,
        ShapeParts::Points(_) => "piecewise",
        ShapeParts::Formula(_) => "function",
        ShapeParts::Linear(..) => "linear",
    };
    NoFootprint::Unsupported(format!("a `{name}`"))
}

#[cfg(test)]
mod tests {
    use super::*;
    use MembershipFunction as F;
    use proptest::prelude::*;

    const RANGE: (f64, f64) = (0.0, 40.0);

    #[test]
    fn blurred_terms_equal_values_computed_by_hand() {
        let triangle = F::Triangle {
            left: 4.0,
            peak: 8.0,
            right: 16.0,
        };
        let (upper, lower) = blurred(&triangle, 1.5, RANGE, "x").unwrap();
        let expected = F::Trapezoid {
            left: 2.5,
            left_top: 6.5,
            right_top: 9.5,
            right: 17.5,
        };
        assert_eq!(upper, expected);
        // The flanks are 4 and 8 wide, together 12, but only 9 are left for them, so the height is 9 / 12.
        let expected = F::Triangle {
            left: 5.5,
            peak: 8.5,
            right: 14.5,
        };
        assert_eq!(lower.membership_function, expected);
        assert_eq!(lower.height, 0.75);
        assert_eq!(
            blurred(&triangle, 6.0, RANGE, "x"),
            Err(NoFootprint::TooLarge(6.0))
        );
        let spike = F::Spike {
            center: 1.0,
            width: 2.0,
        };
        assert_eq!(
            blurred(&spike, 0.1, RANGE, "x"),
            Err(NoFootprint::Unsupported("a `spike`".into()))
        );
        // A vertical edge at the end of the range is not moved.
        let at_the_end = F::Triangle {
            left: 0.0,
            peak: 0.0,
            right: 10.0,
        };
        let (upper, lower) = blurred(&at_the_end, 1.0, RANGE, "x").unwrap();
        assert_eq!((upper.membership(0.0), upper.membership(6.0)), (1.0, 0.5));
        assert_eq!(lower.membership_function.membership(0.0), 0.9);
    }

    #[test]
    fn uncertain_means_and_deviations_equal_values_computed_by_hand() {
        let (upper, lower) = uncertain_gaussian((-1.0, 3.0), (2.0, 4.0), "wind \"x\"").unwrap();
        let degree = |x: f64, mean: f64, sd: f64| libm::exp(-0.5 * ((x - mean) / sd).powi(2));
        for x in [-9.0_f64, -1.0, 0.5, 1.0, 2.0, 3.0, 7.0] {
            let nearest = x.clamp(-1.0, 3.0);
            let farthest = if x > 1.0 { -1.0 } else { 3.0 };
            assert!((upper.membership(x) - degree(x, nearest, 4.0)).abs() < 1e-15);
            let lower = lower.membership_function.membership(x);
            assert!((lower - degree(x, farthest, 2.0)).abs() < 1e-15, "{x}");
        }
    }

    #[test]
    fn lags_equal_values_computed_by_hand() {
        let of = |function: F, lag| lagging(&function, 0.8, lag).unwrap();
        let triangle = F::Triangle {
            left: 0.0,
            peak: 4.0,
            right: 6.0,
        };
        let lower = of(triangle.clone(), (0.25, 0.5));
        let expected = F::Triangle {
            left: 1.0,
            peak: 4.0,
            right: 5.0,
        };
        assert_eq!((lower.membership_function, lower.height), (expected, 0.8));
        let rising = F::SShape {
            foot: 0.0,
            top: 4.0,
        };
        let F::SShape { foot, .. } = of(rising.clone(), (0.125, 0.9)).membership_function else {
            panic!()
        };
        assert_eq!((foot, rising.membership(foot)), (1.0, 0.125));
        let bell = F::Bell {
            center: 0.0,
            width: 1.0,
            slope: 2.0,
        };
        assert_eq!(of(bell.clone(), (0.0, 0.0)).membership_function, bell);
        assert!(lagging(&bell, 1.0, (0.1, 0.0)).is_err());
    }

    fn any_function() -> impl Strategy<Value = F> {
        (0..9u8, proptest::array::uniform4(-5.0..45.0f64)).prop_map(|(kind, mut at)| {
            at.sort_by(f64::total_cmp);
            let [left, left_top, right_top, right] = at;
            let sd = left_top - left + 0.01;
            match kind {
                0 => F::Triangle {
                    left,
                    peak: left_top,
                    right,
                },
                1 => F::Trapezoid {
                    left,
                    left_top,
                    right_top,
                    right,
                },
                2 => F::LeftShoulder {
                    top: left,
                    foot: right,
                },
                3 => F::RightShoulder {
                    foot: left,
                    top: right,
                },
                4 => F::Rectangle { left, right },
                5 => F::Gaussian { mean: left_top, sd },
                6 => F::Sigmoid {
                    inflection: left,
                    slope: right_top - 20.0,
                },
                7 => F::PiShape {
                    left,
                    left_top,
                    right_top,
                    right,
                },
                _ => F::Gaussian2 {
                    left_mean: left_top,
                    left_sd: sd,
                    right_mean: right_top,
                    right_sd: 2.0 * sd,
                },
            }
        })
    }

    proptest! {
        /// At each value, a blurred term spans the degrees that the original term has at all values within the
        /// distance `by`.
        #[test]
        fn blurred_degrees_are_those_of_near_values(function in any_function(), by in 0.0..8.0f64, x in 0.0..40.0f64) {
            let Ok((upper, lower)) = blurred(&function, by, (-10.0, 50.0), "x") else {
                return Ok(());
            };
            prop_assert_eq!(upper.validate(), Ok(()));
            prop_assert_eq!(lower.membership_function.validate(), Ok(()));
            let near = (0..=2000).map(|i| function.membership(x + by * (f64::from(i) / 1000.0 - 1.0)));
            let (least, most) = near.fold((1.0, 0.0), |(low, high), degree| (degree.min(low), degree.max(high)));
            let (low, high) = (lower.height * lower.membership_function.membership(x), upper.membership(x));
            prop_assert!(low <= least + 1e-12 && high >= most - 1e-12, "{low} {least} {most} {high}");
            // None of these functions has a minimum inside an interval, so its least degree is at one of the ends.
            let least = function.membership(x - by).min(function.membership(x + by));
            prop_assert!((low - least).abs() < 1e-9, "{low} {least}");
        }

        #[test]
        fn a_lower_function_is_nowhere_above(function in any_function(), x in -5.0..45.0f64, lag in (0.0..1.0f64, 0.0..1.0f64)) {
            if let Ok(lower) = lagging(&function, 1.0, lag) {
                let degrees = (lower.membership_function.membership(x), function.membership(x));
                prop_assert!(degrees.0 <= degrees.1 + 1e-12, "{degrees:?}");
            }
        }
    }
}
