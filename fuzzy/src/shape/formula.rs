//! The formulas of membership functions, each identified by a number, as used by tables in firmware.

use libm::{cos, fabs, pow, sqrt};

use crate::formula::evaluate;
use crate::rows::set;

use super::{
    exponential::exp_of_minus,
    smooth::{gaussian, s_shape, sigmoid, z_shape},
    straight::{along, falling, indicator, into_unit, rising, trapezoid},
};

/// The formula of a membership function. Its parameters are in the order of the fields of the `MembershipFunction`
/// variant of the same name.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[repr(transparent)]
pub struct ShapeKind(pub u32);

#[expect(missing_docs, reason = "each is the shape of that name")]
impl ShapeKind {
    pub const TRAPEZOID: ShapeKind = ShapeKind(0);
    pub const LEFT_SHOULDER: ShapeKind = ShapeKind(1);
    pub const RIGHT_SHOULDER: ShapeKind = ShapeKind(2);
    pub const RECTANGLE: ShapeKind = ShapeKind(3);
    pub const SINGLETON: ShapeKind = ShapeKind(4);
    pub const PIECEWISE: ShapeKind = ShapeKind(5);
    pub const GAUSSIAN: ShapeKind = ShapeKind(6);
    pub const GAUSSIAN2: ShapeKind = ShapeKind(7);
    pub const BELL: ShapeKind = ShapeKind(8);
    pub const SIGMOID: ShapeKind = ShapeKind(9);
    pub const SIGMOID_DIFFERENCE: ShapeKind = ShapeKind(10);
    pub const SIGMOID_PRODUCT: ShapeKind = ShapeKind(11);
    pub const S_SHAPE: ShapeKind = ShapeKind(12);
    pub const Z_SHAPE: ShapeKind = ShapeKind(13);
    pub const PI_SHAPE: ShapeKind = ShapeKind(14);
    pub const COSINE: ShapeKind = ShapeKind(15);
    pub const SPIKE: ShapeKind = ShapeKind(16);
    pub const CONCAVE: ShapeKind = ShapeKind(17);
    pub const CONSTANT: ShapeKind = ShapeKind(18);
    pub const TRIANGLE: ShapeKind = ShapeKind(19);
    pub const ARC: ShapeKind = ShapeKind(20);
    pub const SEMI_ELLIPSE: ShapeKind = ShapeKind(21);
    pub const FUNCTION: ShapeKind = ShapeKind(22);

    /// Returns the degree at `x`: see [`ShapeKind::memberships`].
    pub(crate) fn membership(self, parameters: &[f64; 4], points: &[[f64; 2]], x: f64) -> f64 {
        let mut degrees = [0.0];
        self.memberships(parameters, points, &[x], &mut degrees);
        let [degree] = degrees;
        degree
    }

    /// Computes the degrees at several values, in [0, 1] and never NaN. `points` are the points of a piecewise shape,
    /// or the code of a formula. The most common shapes do not branch, so that vector instructions can process several
    /// values.
    #[inline(always)]
    pub(crate) fn memberships<const L: usize>(
        self,
        parameters: &[f64; 4],
        points: &[[f64; 2]],
        values: &[f64; L],
        degrees: &mut [f64; L],
    ) {
        let [a, b, c, d] = *parameters;
        let known = |degree: f64, x: f64| if x.is_nan() { 0.0 } else { degree };
        let degree = |degree: f64, x: f64| into_unit(known(degree, x));
        let x = |row: usize| values[row];
        match self {
            ShapeKind::TRIANGLE => set(degrees, |i| known(trapezoid(x(i), a, b, b, c), x(i))),
            ShapeKind::TRAPEZOID => set(degrees, |i| known(trapezoid(x(i), a, b, c, d), x(i))),
            ShapeKind::LEFT_SHOULDER => set(degrees, |i| known(falling(x(i), a, b), x(i))),
            ShapeKind::RIGHT_SHOULDER => set(degrees, |i| known(rising(x(i), a, b), x(i))),
            ShapeKind::GAUSSIAN => set(degrees, |i| degree(gaussian(x(i), a, b), x(i))),
            ShapeKind::SIGMOID => set(degrees, |i| degree(sigmoid(x(i), a, b), x(i))),
            ShapeKind::S_SHAPE => set(degrees, |i| degree(s_shape(x(i), a, b), x(i))),
            ShapeKind::Z_SHAPE => set(degrees, |i| degree(z_shape(x(i), a, b), x(i))),
            ShapeKind::CONSTANT => set(degrees, |i| degree(a, x(i))),
            _ => set(degrees, |i| {
                degree(self.other(parameters, points, x(i)), x(i))
            }),
        }
    }

    /// Returns the degree of a shape whose computation branches.
    #[inline(never)]
    fn other(self, parameters: &[f64; 4], points: &[[f64; 2]], x: f64) -> f64 {
        let [a, b, c, d] = *parameters;
        match self {
            ShapeKind::RECTANGLE => indicator(a <= x && x <= b),
            ShapeKind::SINGLETON => indicator(x == a),
            ShapeKind::PIECEWISE => along(points.iter().map(|[x, y]| (*x, *y)), x),
            ShapeKind::GAUSSIAN2 => {
                let left = if x < a { gaussian(x, a, b) } else { 1.0 };
                let right = if x > c { gaussian(x, c, d) } else { 1.0 };
                left * right
            }
            ShapeKind::BELL => 1.0 / (1.0 + pow(fabs((x - a) / b), 2.0 * c)),
            ShapeKind::SIGMOID_DIFFERENCE => fabs(sigmoid(x, a, b) - sigmoid(x, c, d)),
            ShapeKind::SIGMOID_PRODUCT => sigmoid(x, a, b) * sigmoid(x, c, d),
            ShapeKind::PI_SHAPE if x < b => s_shape(x, a, b),
            ShapeKind::PI_SHAPE => z_shape(x, c, d),
            ShapeKind::COSINE if fabs(x - a) <= 0.5 * b => {
                let turns = (x - a) / b;
                0.5 * (1.0 + cos(2.0 * core::f64::consts::PI * turns))
            }
            ShapeKind::SPIKE => exp_of_minus(fabs(10.0 * (x - a) / b)),
            ShapeKind::CONCAVE => concave(x, a, b),
            ShapeKind::ARC => arc(x, a, b),
            ShapeKind::SEMI_ELLIPSE if a < x && x < b => {
                let t = (x - a) / (b - a);
                2.0 * sqrt(t * (1.0 - t))
            }
            ShapeKind::FUNCTION => evaluate(points, |_| x),
            _ => 0.0,
        }
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

fn arc(x: f64, start: f64, end: f64) -> f64 {
    let t = if start <= end {
        rising(x, start, end)
    } else {
        falling(x, end, start)
    };
    sqrt(t * (2.0 - t))
}
