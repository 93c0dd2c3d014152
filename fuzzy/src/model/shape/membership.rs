//! `Shape::membership`: the degree to which a number belongs to a term.

use super::Shape;
use crate::table::{Kind, into_unit, piecewise};

impl Shape {
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
    ///
    /// # Example: a shoulder is 1 up to its top
    /// ```
    /// use fuzzy::model::Shape;
    ///
    /// let low = Shape::LeftShoulder { top: 0.1, foot: 0.3 };
    /// assert_eq!(low.membership(0.0), 1.0);
    /// assert_eq!(low.membership(0.1), 1.0);
    /// assert!((low.membership(0.25) - 0.25).abs() < 1e-15);
    /// assert_eq!(low.membership(f64::NAN), 0.0);
    /// ```
    pub fn membership(&self, x: f64) -> f64 {
        match self {
            Shape::Piecewise { points } => piecewise(points.iter().copied(), x),
            _ => {
                let (kind, parameters) = self.kind();
                kind.membership(&parameters, &[], x)
            }
        }
    }

    /// The shape's formula and its parameters; the points of a piecewise shape are apart.
    pub(crate) fn kind(&self) -> (Kind, [f64; 4]) {
        match *self {
            Shape::Triangle { left, peak, right } => (Kind::TRAPEZOID, [left, peak, peak, right]),
            Shape::Trapezoid {
                left,
                left_top,
                right_top,
                right,
            } => (Kind::TRAPEZOID, [left, left_top, right_top, right]),
            Shape::LeftShoulder { top, foot } => (Kind::LEFT_SHOULDER, [top, foot, 0.0, 0.0]),
            Shape::RightShoulder { foot, top } => (Kind::RIGHT_SHOULDER, [foot, top, 0.0, 0.0]),
            Shape::Rectangle { left, right } => (Kind::RECTANGLE, [left, right, 0.0, 0.0]),
            Shape::Singleton { at } => (Kind::SINGLETON, [at, 0.0, 0.0, 0.0]),
            Shape::Piecewise { .. } => (Kind::PIECEWISE, [0.0; 4]),
            Shape::Gaussian { mean, sd } => (Kind::GAUSSIAN, [mean, sd, 0.0, 0.0]),
            Shape::Gaussian2 {
                left_mean,
                left_sd,
                right_mean,
                right_sd,
            } => (Kind::GAUSSIAN2, [left_mean, left_sd, right_mean, right_sd]),
            Shape::Bell {
                center,
                width,
                slope,
            } => (Kind::BELL, [center, width, slope, 0.0]),
            Shape::Sigmoid { inflection, slope } => (Kind::SIGMOID, [inflection, slope, 0.0, 0.0]),
            Shape::SigmoidDifference {
                left_inflection,
                left_slope,
                right_inflection,
                right_slope,
            } => (
                Kind::SIGMOID_DIFFERENCE,
                [left_inflection, left_slope, right_inflection, right_slope],
            ),
            Shape::SigmoidProduct {
                left_inflection,
                left_slope,
                right_inflection,
                right_slope,
            } => (
                Kind::SIGMOID_PRODUCT,
                [left_inflection, left_slope, right_inflection, right_slope],
            ),
            Shape::SShape { foot, top } => (Kind::S_SHAPE, [foot, top, 0.0, 0.0]),
            Shape::ZShape { top, foot } => (Kind::Z_SHAPE, [top, foot, 0.0, 0.0]),
            Shape::PiShape {
                left,
                left_top,
                right_top,
                right,
            } => (Kind::PI_SHAPE, [left, left_top, right_top, right]),
            Shape::Cosine { center, width } => (Kind::COSINE, [center, width, 0.0, 0.0]),
            Shape::Spike { center, width } => (Kind::SPIKE, [center, width, 0.0, 0.0]),
            Shape::Concave { inflection, end } => (Kind::CONCAVE, [inflection, end, 0.0, 0.0]),
            Shape::Constant { value } => (Kind::CONSTANT, [value, 0.0, 0.0, 0.0]),
            Shape::Linear { .. } => (Kind::CONSTANT, [0.0; 4]),
        }
    }

    /// The corners of a shape made of straight lines, `(x, degree)` with x never falling and the first
    /// and last degree held beyond them; `None` for a curved shape.
    ///
    /// # Example: a triangle has three corners
    /// ```
    /// use fuzzy::model::Shape;
    ///
    /// let low = Shape::Triangle { left: 0.0, peak: 1.0, right: 3.0 };
    /// assert_eq!(low.corners().unwrap(), [(0.0, 0.0), (1.0, 1.0), (3.0, 0.0)]);
    /// assert!(Shape::Gaussian { mean: 0.0, sd: 1.0 }.corners().is_none());
    /// ```
    pub fn corners(&self) -> Option<alloc::vec::Vec<(f64, f64)>> {
        use alloc::vec;
        Some(match *self {
            Shape::Triangle { left, peak, right } => vec![(left, 0.0), (peak, 1.0), (right, 0.0)],
            Shape::Trapezoid {
                left,
                left_top,
                right_top,
                right,
            } => vec![(left, 0.0), (left_top, 1.0), (right_top, 1.0), (right, 0.0)],
            Shape::LeftShoulder { top, foot } => vec![(top, 1.0), (foot, 0.0)],
            Shape::RightShoulder { foot, top } => vec![(foot, 0.0), (top, 1.0)],
            Shape::Rectangle { left, right } => {
                vec![(left, 0.0), (left, 1.0), (right, 1.0), (right, 0.0)]
            }
            Shape::Singleton { at } => vec![(at, 0.0), (at, 1.0), (at, 0.0)],
            Shape::Piecewise { ref points } => points.clone(),
            Shape::Constant { value } => vec![(0.0, into_unit(value))],
            _ => return None,
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use alloc::vec;

    const INFINITY: f64 = f64::INFINITY;
    const NEG_INFINITY: f64 = f64::NEG_INFINITY;
    const NAN: f64 = f64::NAN;

    /// Every row: x and the exact degree.
    fn table(shape: Shape, rows: &[(f64, f64)]) {
        shape.validate().unwrap();
        for &(x, degree) in rows {
            let got = shape.membership(x);
            assert!(
                (got - degree).abs() <= 1e-15,
                "{shape:?} at {x}: {got} instead of {degree}"
            );
        }
        assert_eq!(shape.membership(NAN), 0.0, "{shape:?}");
        if let Some(corners) = shape.corners() {
            for &(x, _) in rows {
                assert_eq!(
                    piecewise(corners.iter().copied(), x),
                    shape.membership(x),
                    "{shape:?} at {x}"
                );
            }
        }
    }

    #[test]
    fn triangle() {
        let shape = |left, peak, right| Shape::Triangle { left, peak, right };
        table(
            shape(0.0, 1.0, 3.0),
            &[
                (NEG_INFINITY, 0.0),
                (-1.0, 0.0),
                (0.0, 0.0),
                (0.25, 0.25),
                (1.0, 1.0),
                (2.0, 0.5),
                (2.5, 0.25),
                (3.0, 0.0),
                (4.0, 0.0),
                (INFINITY, 0.0),
            ],
        );
        // A closed shoulder: 1 at its peak, 0 beyond.
        table(
            shape(0.0, 0.0, 0.1),
            &[(-1e-300, 0.0), (0.0, 1.0), (0.05, 0.5), (0.1, 0.0)],
        );
        table(
            shape(0.0, 2.0, 2.0),
            &[(0.0, 0.0), (1.0, 0.5), (2.0, 1.0), (2.5, 0.0)],
        );
        table(shape(1.0, 1.0, 1.0), &[(0.5, 0.0), (1.0, 1.0), (1.5, 0.0)]);
    }

    #[test]
    fn trapezoid_and_shoulders() {
        table(
            Shape::Trapezoid {
                left: 0.0,
                left_top: 2.0,
                right_top: 3.0,
                right: 7.0,
            },
            &[
                (NEG_INFINITY, 0.0),
                (0.0, 0.0),
                (0.5, 0.25),
                (2.0, 1.0),
                (2.5, 1.0),
                (3.0, 1.0),
                (4.0, 0.75),
                (7.0, 0.0),
                (INFINITY, 0.0),
            ],
        );
        table(
            Shape::Trapezoid {
                left: 1.0,
                left_top: 1.0,
                right_top: 2.0,
                right: 2.0,
            },
            &[(0.9, 0.0), (1.0, 1.0), (1.5, 1.0), (2.0, 1.0), (2.1, 0.0)],
        );
        table(
            Shape::LeftShoulder {
                top: 1.0,
                foot: 3.0,
            },
            &[
                (NEG_INFINITY, 1.0),
                (0.0, 1.0),
                (1.0, 1.0),
                (2.5, 0.25),
                (3.0, 0.0),
                (INFINITY, 0.0),
            ],
        );
        table(
            Shape::LeftShoulder {
                top: 1.0,
                foot: 1.0,
            },
            &[(0.0, 1.0), (1.0, 1.0), (1.1, 0.0)],
        );
        table(
            Shape::RightShoulder {
                foot: 1.0,
                top: 3.0,
            },
            &[
                (NEG_INFINITY, 0.0),
                (1.0, 0.0),
                (1.5, 0.25),
                (3.0, 1.0),
                (INFINITY, 1.0),
            ],
        );
        table(
            Shape::RightShoulder {
                foot: 1.0,
                top: 1.0,
            },
            &[(0.9, 0.0), (1.0, 1.0), (2.0, 1.0)],
        );
    }

    #[test]
    fn rectangle_singleton_piecewise_constant() {
        table(
            Shape::Rectangle {
                left: 1.0,
                right: 2.0,
            },
            &[
                (NEG_INFINITY, 0.0),
                (0.9, 0.0),
                (1.0, 1.0),
                (2.0, 1.0),
                (2.1, 0.0),
                (INFINITY, 0.0),
            ],
        );
        table(
            Shape::Singleton { at: 1.0 },
            &[
                (NEG_INFINITY, 0.0),
                (0.9, 0.0),
                (1.0, 1.0),
                (1.1, 0.0),
                (INFINITY, 0.0),
            ],
        );
        // Up, a step down in which the higher degree holds, a step up, a last degree that holds.
        table(
            Shape::Piecewise {
                points: vec![
                    (0.0, 0.25),
                    (1.0, 0.75),
                    (1.0, 0.5),
                    (2.0, 0.0),
                    (2.0, 1.0),
                    (4.0, 0.5),
                ],
            },
            &[
                (NEG_INFINITY, 0.25),
                (0.0, 0.25),
                (0.5, 0.5),
                (1.0, 0.75),
                (1.5, 0.25),
                (2.0, 1.0),
                (3.0, 0.75),
                (4.0, 0.5),
                (INFINITY, 0.5),
            ],
        );
        table(
            Shape::Constant { value: 0.3 },
            &[(NEG_INFINITY, 0.3), (0.0, 0.3), (INFINITY, 0.3)],
        );
    }

    #[test]
    fn gaussians() {
        let at_one_sd = 0.606_530_659_712_633_4; // exp(-1/2)
        let at_two_sd = 0.135_335_283_236_612_7; // exp(-2)
        table(
            Shape::Gaussian { mean: 1.0, sd: 2.0 },
            &[
                (NEG_INFINITY, 0.0),
                (-3.0, at_two_sd),
                (-1.0, at_one_sd),
                (1.0, 1.0),
                (3.0, at_one_sd),
                (5.0, at_two_sd),
                (INFINITY, 0.0),
            ],
        );
        table(
            Shape::Gaussian2 {
                left_mean: 1.0,
                left_sd: 0.5,
                right_mean: 2.0,
                right_sd: 3.0,
            },
            &[
                (NEG_INFINITY, 0.0),
                (0.5, at_one_sd),
                (1.0, 1.0),
                (1.5, 1.0),
                (2.0, 1.0),
                (5.0, at_one_sd),
                (8.0, at_two_sd),
                (INFINITY, 0.0),
            ],
        );
    }

    #[test]
    fn bell_and_sigmoids() {
        table(
            Shape::Bell {
                center: 1.0,
                width: 2.0,
                slope: 1.0,
            },
            &[
                (NEG_INFINITY, 0.0),
                (-3.0, 0.2),
                (-1.0, 0.5),
                (1.0, 1.0),
                (3.0, 0.5),
                (7.0, 0.1),
                (INFINITY, 0.0),
            ],
        );
        let third = 3.0_f64.ln();
        table(
            Shape::Sigmoid {
                inflection: 2.0,
                slope: 1.0,
            },
            &[
                (NEG_INFINITY, 0.0),
                (2.0 - third, 0.25),
                (2.0, 0.5),
                (2.0 + third, 0.75),
                (INFINITY, 1.0),
            ],
        );
        table(
            Shape::Sigmoid {
                inflection: 2.0,
                slope: -1.0,
            },
            &[
                (NEG_INFINITY, 1.0),
                (2.0 + third, 0.25),
                (2.0, 0.5),
                (INFINITY, 0.0),
            ],
        );
        table(
            Shape::SigmoidDifference {
                left_inflection: 0.0,
                left_slope: 1.0,
                right_inflection: third,
                right_slope: 1.0,
            },
            &[
                (NEG_INFINITY, 0.0),
                (0.0, 0.25),
                (third, 0.25),
                (INFINITY, 0.0),
            ],
        );
        table(
            Shape::SigmoidProduct {
                left_inflection: 0.0,
                left_slope: 1.0,
                right_inflection: 0.0,
                right_slope: -1.0,
            },
            &[
                (NEG_INFINITY, 0.0),
                (0.0, 0.25),
                (third, 3.0 / 16.0),
                (-third, 3.0 / 16.0),
                (INFINITY, 0.0),
            ],
        );
    }

    #[test]
    fn s_z_and_pi() {
        table(
            Shape::SShape {
                foot: 0.0,
                top: 4.0,
            },
            &[
                (NEG_INFINITY, 0.0),
                (0.0, 0.0),
                (1.0, 0.125),
                (2.0, 0.5),
                (3.0, 0.875),
                (4.0, 1.0),
                (INFINITY, 1.0),
            ],
        );
        table(
            Shape::ZShape {
                top: 0.0,
                foot: 4.0,
            },
            &[
                (NEG_INFINITY, 1.0),
                (0.0, 1.0),
                (1.0, 0.875),
                (2.0, 0.5),
                (3.0, 0.125),
                (4.0, 0.0),
                (INFINITY, 0.0),
            ],
        );
        table(
            Shape::PiShape {
                left: 0.0,
                left_top: 2.0,
                right_top: 3.0,
                right: 5.0,
            },
            &[
                (NEG_INFINITY, 0.0),
                (0.0, 0.0),
                (0.5, 0.125),
                (1.0, 0.5),
                (2.0, 1.0),
                (3.0, 1.0),
                (4.5, 0.125),
                (5.0, 0.0),
                (INFINITY, 0.0),
            ],
        );
        table(
            Shape::PiShape {
                left: 1.0,
                left_top: 1.0,
                right_top: 1.0,
                right: 1.0,
            },
            &[(0.9, 0.0), (1.0, 1.0), (1.1, 0.0)],
        );
    }

    #[test]
    fn cosine_spike_concave() {
        table(
            Shape::Cosine {
                center: 1.0,
                width: 4.0,
            },
            &[
                (NEG_INFINITY, 0.0),
                (-1.0, 0.0),
                (0.0, 0.5),
                (1.0, 1.0),
                (2.0, 0.5),
                (3.0, 0.0),
                (3.5, 0.0),
                (INFINITY, 0.0),
            ],
        );
        let tenth = 0.367_879_441_171_442_33; // exp(-1)
        table(
            Shape::Spike {
                center: 1.0,
                width: 10.0,
            },
            &[
                (NEG_INFINITY, 0.0),
                (0.0, tenth),
                (1.0, 1.0),
                (2.0, tenth),
                (INFINITY, 0.0),
            ],
        );
        table(
            Shape::Concave {
                inflection: 1.0,
                end: 3.0,
            },
            &[
                (NEG_INFINITY, 0.0),
                (-3.0, 0.25),
                (1.0, 0.5),
                (2.0, 2.0 / 3.0),
                (3.0, 1.0),
                (INFINITY, 1.0),
            ],
        );
        table(
            Shape::Concave {
                inflection: 3.0,
                end: 1.0,
            },
            &[
                (NEG_INFINITY, 1.0),
                (1.0, 1.0),
                (2.0, 2.0 / 3.0),
                (3.0, 0.5),
                (7.0, 0.25),
                (INFINITY, 0.0),
            ],
        );
    }

    #[test]
    fn parameters_that_make_no_shape_still_give_no_nan() {
        for shape in [
            Shape::Gaussian { mean: NAN, sd: 0.0 },
            Shape::Bell {
                center: 0.0,
                width: 0.0,
                slope: NAN,
            },
            Shape::Concave {
                inflection: 1.0,
                end: INFINITY,
            },
            Shape::Piecewise { points: vec![] },
            Shape::Constant { value: NAN },
        ] {
            for x in [NEG_INFINITY, -1.0, 0.0, 1.0, INFINITY, NAN] {
                let degree = shape.membership(x);
                assert!((0.0..=1.0).contains(&degree), "{shape:?} at {x}: {degree}");
            }
        }
    }
}
