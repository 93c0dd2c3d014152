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
    pub const ARC: Kind = Kind(20);
    pub const SEMI_ELLIPSE: Kind = Kind(21);
    pub const FUNCTION: Kind = Kind(22);

    /// Returns the degree at `x`: see [`Kind::memberships`].
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
            Kind::TRIANGLE => set(degrees, |i| known(trapezoid(x(i), a, b, b, c), x(i))),
            Kind::TRAPEZOID => set(degrees, |i| known(trapezoid(x(i), a, b, c, d), x(i))),
            Kind::LEFT_SHOULDER => set(degrees, |i| known(falling(x(i), a, b), x(i))),
            Kind::RIGHT_SHOULDER => set(degrees, |i| known(rising(x(i), a, b), x(i))),
            Kind::GAUSSIAN => set(degrees, |i| degree(gaussian(x(i), a, b), x(i))),
            Kind::SIGMOID => set(degrees, |i| degree(sigmoid(x(i), a, b), x(i))),
            Kind::S_SHAPE => set(degrees, |i| degree(s_shape(x(i), a, b), x(i))),
            Kind::Z_SHAPE => set(degrees, |i| degree(z_shape(x(i), a, b), x(i))),
            Kind::CONSTANT => set(degrees, |i| degree(a, x(i))),
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
            Kind::RECTANGLE => indicator(a <= x && x <= b),
            Kind::SINGLETON => indicator(x == a),
            Kind::PIECEWISE => along(points.iter().map(|[x, y]| (*x, *y)), x),
            Kind::GAUSSIAN2 => {
                let left = if x < a { gaussian(x, a, b) } else { 1.0 };
                let right = if x > c { gaussian(x, c, d) } else { 1.0 };
                left * right
            }
            Kind::BELL => 1.0 / (1.0 + pow(fabs((x - a) / b), 2.0 * c)),
            Kind::SIGMOID_DIFFERENCE => fabs(sigmoid(x, a, b) - sigmoid(x, c, d)),
            Kind::SIGMOID_PRODUCT => sigmoid(x, a, b) * sigmoid(x, c, d),
            Kind::PI_SHAPE if x < b => s_shape(x, a, b),
            Kind::PI_SHAPE => z_shape(x, c, d),
            Kind::COSINE if fabs(x - a) <= 0.5 * b => {
                let turns = (x - a) / b;
                0.5 * (1.0 + cos(2.0 * core::f64::consts::PI * turns))
            }
            Kind::SPIKE => exp_of_minus(fabs(10.0 * (x - a) / b)),
            Kind::CONCAVE => concave(x, a, b),
            Kind::ARC => arc(x, a, b),
            Kind::SEMI_ELLIPSE if a < x && x < b => {
                let t = (x - a) / (b - a);
                2.0 * sqrt(t * (1.0 - t))
            }
            Kind::FUNCTION => evaluate(points, |_| x),
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
