//! The formulas of membership functions, by number and parameters.

use libm::{cos, exp, fabs, pow};

/// The formula of a membership function. What each takes as its parameters is in the order of the fields of the
/// [`Shape`](crate::model::Shape) of that name; a triangle is a trapezoid.
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
}

impl Kind {
    /// The degree at `x` with these parameters, in [0, 1] and never NaN; `points` are those of a piecewise shape.
    pub(crate) fn membership(self, parameters: &[f64; 4], points: &[[f64; 2]], x: f64) -> f64 {
        if x.is_nan() {
            return 0.0;
        }
        let [a, b, c, d] = *parameters;
        into_unit(match self {
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

/// Into [0, 1]; NaN, which only parameters that make no shape can give, becomes 0.
pub(crate) fn into_unit(degree: f64) -> f64 {
    if degree >= 1.0 {
        1.0
    } else if degree > 0.0 {
        degree
    } else {
        0.0
    }
}

fn indicator(inside: bool) -> f64 {
    if inside { 1.0 } else { 0.0 }
}

/// 0 up to `foot`, straight up to 1 at `top`; `foot = top` is a step that is 1 at `top`.
fn rising(x: f64, foot: f64, top: f64) -> f64 {
    if x >= top {
        1.0
    } else if x <= foot {
        0.0
    } else {
        (x - foot) / (top - foot)
    }
}

/// 1 up to `top`, straight down to 0 at `foot`; `foot = top` is a step that is 1 at `top`.
fn falling(x: f64, top: f64, foot: f64) -> f64 {
    if x <= top {
        1.0
    } else if x >= foot {
        0.0
    } else {
        (x - foot) / (top - foot)
    }
}

fn trapezoid(x: f64, left: f64, left_top: f64, right_top: f64, right: f64) -> f64 {
    if x < left_top {
        rising(x, left, left_top)
    } else {
        falling(x, right_top, right)
    }
}

/// Straight between the points, measured from the lower one so that small degrees are exact.
pub(crate) fn piecewise(points: impl Iterator<Item = (f64, f64)>, x: f64) -> f64 {
    if x.is_nan() {
        return 0.0;
    }
    into_unit(along(points, x))
}

fn along(points: impl Iterator<Item = (f64, f64)>, x: f64) -> f64 {
    let (mut at_step, mut before) = (f64::NEG_INFINITY, None);
    for (px, py) in points {
        if px > x {
            return match before {
                None => py,
                Some(_) if at_step > f64::NEG_INFINITY => at_step,
                Some((bx, by)) => between((bx, by), (px, py), x),
            };
        }
        if px == x {
            at_step = at_step.max(py);
        }
        before = Some((px, py));
    }
    match before {
        Some(_) if at_step > f64::NEG_INFINITY => at_step,
        Some((_, last)) => last,
        None => 0.0,
    }
}

/// The degree at `x` on the line through `a` and `b`.
fn between(a: (f64, f64), b: (f64, f64), x: f64) -> f64 {
    let (low, high) = if a.1 <= b.1 { (a, b) } else { (b, a) };
    low.1 + (high.1 - low.1) * ((x - low.0) / (high.0 - low.0))
}

fn gaussian(x: f64, mean: f64, sd: f64) -> f64 {
    let z = (x - mean) / sd;
    exp(-0.5 * z * z)
}

fn sigmoid(x: f64, inflection: f64, slope: f64) -> f64 {
    if slope == 0.0 {
        return 0.5;
    }
    1.0 / (1.0 + exp(-slope * (x - inflection)))
}

/// 0 up to `foot`, `2 t^2` to the middle, `1 - 2 (1 - t)^2` to `top`, with `t = (x - foot) / (top - foot)`.
fn s_shape(x: f64, foot: f64, top: f64) -> f64 {
    smooth_step(rising(x, foot, top))
}

fn z_shape(x: f64, top: f64, foot: f64) -> f64 {
    smooth_step(falling(x, top, foot))
}

fn smooth_step(t: f64) -> f64 {
    if t <= 0.5 {
        2.0 * t * t
    } else {
        1.0 - 2.0 * (1.0 - t) * (1.0 - t)
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
